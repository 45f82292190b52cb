"""A line made fast off the target's centre of mass: tight at rest length + distance, as stiff as its own length."""

import math

import numpy as np
import pytest

from fmu_src.instance import Instance, ModelFault
from fmu_src.tethered_deorbit.interface import BAD_PARAMETER, HANDED_OVER, MODEL, START_STRETCHED
from tests.validation import Validated, closed_form

LOCKED, LINEAR, COMMANDED = ({"reel": reel, "thrust": "along_track"} for reel in ("locked", "linear", "commanded"))
REST, ATTACHED = 12.0, 2.5
REDUCED = 2000.0 / 3.0
AREA = math.pi * 1e-3**2 / 4.0
MEAN_MOTION = math.sqrt(3.986004418e14 / 7178137.0**3)


def hanging(terms: dict[str, str], separation: float, **parameters: float) -> Instance:
    """A pair on the vertical, at rest in the turning frame, without thrust."""
    given = {"start.condition": HANDED_OVER, "thrust.level": 0.0, "target.attachment_distance": ATTACHED}
    i = Instance(MODEL, terms, given | {name.replace("__", "."): value for name, value in parameters.items()})
    i.array("start_relative_position")[:] = separation, 0.0, 0.0
    return i.initialise()


def thrown(**parameters: float) -> Instance:
    """The same pair, two metres from tight, parting at 20 mm/s, up to where its first tug is over."""
    i = Instance(
        MODEL,
        LOCKED,
        {"start.condition": HANDED_OVER, "thrust.level": 0.0, "tether.damping_ratio": 0.0}
        | {name.replace("__", "."): value for name, value in parameters.items()},
    )
    i.array("start_relative_position")[:] = REST + ATTACHED - 2.0, 0.0, 0.0
    i.array("start_relative_velocity")[:] = 0.02, 0.0, 0.0
    i.initialise()
    while i["tether.tug_count"] == 0 or i["tether.taut"]:
        i.step(1.0)
    return i


def test_the_first_tug_comes_when_the_attachments_are_a_rest_length_apart(validated: Validated) -> None:
    """At the instant and speed of a longer line between the centres, for a slack line is not felt; its peak is that of
    the shorter line, T = sqrt(k m_r v^2) with k = EA/l0 and the tide's preload left out (0.5 %)."""
    short, long = (
        thrown(tether__rest_length=REST, target__attachment_distance=ATTACHED),
        thrown(tether__rest_length=REST + ATTACHED),
    )
    assert short["tug[1].time"] == pytest.approx(long["tug[1].time"], abs=1e-9)
    assert short["tug[1].speed"] == pytest.approx(long["tug[1].speed"], rel=1e-9)
    speed = short["tug[1].speed"]
    for i, length in ((short, REST), (long, REST + ATTACHED)):
        formula, expected = closed_form("v sqrt(EA m_r/l0)"), speed * math.sqrt(60e9 * AREA / length * REDUCED)
        what = f"first tug of a line of {length:g} m: peak"
        validated(formula, what, i["tug[1].peak"], expected, "N", rel=5e-3)
    assert short["tug[1].peak"] > 1.05 * long["tug[1].peak"]
    near = thrown(tether__rest_length=REST)
    assert near["tug[1].time"] < 0.1 * short["tug[1].time"]


@pytest.mark.parametrize("terms", [LOCKED, LINEAR, COMMANDED])
def test_length_is_between_the_attachments(terms: dict[str, str]) -> None:
    i = hanging(terms, 13.0)
    for _ in range(3):
        assert i["separation"] - i["tether.length"] == pytest.approx(ATTACHED, rel=1e-14)
        assert i["separation"] == pytest.approx(float(np.linalg.norm(i.array("relative_position"))), rel=1e-14)
        i.step(10.0)


def test_at_rest_the_tide_pulls_by_the_distance_of_the_centres(validated: Validated) -> None:
    """T = 3 n^2 m_r s, and the line is longer by T l0 / EA."""
    tide = 3.0 * MEAN_MOTION**2 * REDUCED
    stiffness = 60e9 * AREA / REST
    stretch = tide * (REST + ATTACHED) / (stiffness - tide)
    i = hanging(LOCKED, REST + ATTACHED + stretch, tether__damping_ratio=0.3)
    i.step(60.0)
    expected = tide * (REST + ATTACHED + stretch)
    formula = closed_form("3 n^2 m_r s")
    validated(formula, "line made fast 2.5 m off: tension at rest", i["tether.tension"], expected, "N", rel=1e-5)
    assert i["tether.tension"] != pytest.approx(tide * REST, rel=1e-1)
    formula, found = closed_form("T l0/EA"), i["tether.length"] - REST
    validated(formula, "line made fast 2.5 m off: stretch at rest", found, stretch, "m", rel=1e-4)


def test_a_working_reel_rests_at_its_commanded_length() -> None:
    """Nothing moves where T_ff = 3 n^2 m_r (l_c + a), at any gain; on a ramp the law holds at the instant."""
    i = hanging(LINEAR, REST + ATTACHED)
    i.step(600.0)
    assert i["tether.length"] == pytest.approx(REST, abs=2e-5)
    assert hanging(LINEAR, REST + ATTACHED - 0.01)["tether.length"] != pytest.approx(REST, abs=2e-5)
    n = float(i.record["state_mean_motion"][0])
    i.set_rates({"reel.length_offset": -0.01})
    i.step(20.0)
    commanded = REST - 0.2
    law = 3.0 * n * n * REDUCED * (commanded + ATTACHED)
    law += 4.155e-3 * (i["tether.length"] - commanded) + 2.366 * i["tether.length_rate"]
    assert i["tether.tension"] == pytest.approx(law, rel=1e-12)
    assert i["tether.tension"] != pytest.approx(law - 3.0 * n * n * REDUCED * ATTACHED, rel=1e-2)


def test_a_swing_keeps_its_energy() -> None:
    """Jacobi integral of the relative motion and EA (l - l0)^2 / (2 l0), through bounces of an undamped line."""
    i = Instance(
        MODEL,
        LOCKED,
        {
            "start.condition": HANDED_OVER,
            "thrust.level": 0.0,
            "tether.damping_ratio": 0.0,
            "target.attachment_distance": ATTACHED,
        },
    )
    i.array("start_relative_position")[:] = 13.0, 6.4, 0.5
    i.array("start_relative_velocity")[:] = 0.01, -0.01, 0.0
    i.initialise()
    stored = []
    start = i["energy.relative"]
    for _ in range(400):
        i.step(0.25)
        if i["tether.taut"]:
            stretch = i["tether.length"] - REST
            stored.append(0.5 * 60e9 * AREA / REST * stretch**2)
            p, v = i.array("relative_position"), i.array("relative_velocity")
            n2 = MEAN_MOTION**2
            motion = REDUCED * (0.5 * float(v @ v) - 1.5 * n2 * p[0] ** 2 + 0.5 * n2 * p[2] ** 2)
            assert i["energy.relative"] == pytest.approx(motion + stored[-1], rel=1e-6)
        assert i["energy.relative"] == pytest.approx(start, rel=1e-5)
    assert max(stored) > 5e-3


def test_the_start_counts_it() -> None:
    def start(**parameters: float) -> Instance:
        given = {name.replace("__", "."): value for name, value in parameters.items()}
        return Instance(MODEL, LOCKED, {"target.attachment_distance": ATTACHED} | given)

    assert start(start__separation=14.4).initialise()["tether.taut"] == 0
    for fault, parameters in (
        (START_STRETCHED, {"start__separation": 14.6}),
        (START_STRETCHED, {"start__separation": 12.5, "target__attachment_distance": 0.0}),
        (BAD_PARAMETER, {"start__separation": 2.4}),
        (BAD_PARAMETER, {"target__attachment_distance": -1.0}),
        (BAD_PARAMETER, {"target__attachment_distance": math.nan}),
        (BAD_PARAMETER, {"target__attachment_distance": math.inf}),
    ):
        i = start(**parameters)
        with pytest.raises(ModelFault):
            i.initialise()
        assert i.record["fault_code"][0] == fault
