"""Towed rigid bodies: how many steps they take, how they start, what they show, and what is refused."""

import itertools
import math
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fmu_src.instance import Instance, ModelFault
from fmu_src.tethered_deorbit import events, model
from fmu_src.tethered_deorbit.interface import BAD_ATTITUDE, BAD_INERTIA, HANDED_OVER, MODEL, START_STRETCHED
from tests.plain import PlainInstance, plain
from tests.tethered_deorbit.rigid_pairs import (
    ARM,
    BOTH,
    FIELD_FREE,
    INERTIA,
    MEAN_MOTION,
    ON_ORBIT,
    REDUCED,
    REST,
    TUMBLING,
    matrix,
    pair,
    relative,
    uncompiled,
)

__all__ = ["plain"]


def hanging(target: str) -> dict[str, Any]:
    """A pair upright on its taut line; a target that turns has its attachment below it, spins about the line at 5 deg/s
    and swings."""
    arm = 0.0 if target == "point" else 1.0
    values: dict[str, Any] = {
        "start.condition": HANDED_OVER,
        "start_relative_position": [REST + 1e-5 + arm, 0.0, 0.0],
        "thrust.level": -0.01,
    }
    if target != "point":
        values |= {
            "target_inertia": [6666.7, 2666.7, 6666.7, 0.0, 0.0, 0.0],
            "target_attachment": [0.0, -arm, 0.0],
            "target_start_attitude": [math.sqrt(0.5), 0.0, 0.0, -math.sqrt(0.5)],
            "target_start_rate": [0.0, math.radians(5.0), math.radians(0.1)],
        }
    if target == "box":
        values["target_size"] = [4.0, 2.0 * arm, 4.0]
    return values


@uncompiled
@pytest.mark.parametrize("target", ["rigid", "box"])
def test_a_tumbling_target_takes_the_steps_of_a_point(target: str) -> None:
    """Its attachment goes round, and the steps do not have to follow it: in plain coordinates they were 2.5 times as
    many."""
    counts = []
    for kind in ("point", target):
        i = Instance(MODEL, ON_ORBIT | {"target": kind})
        for name, value in hanging(kind).items():
            if isinstance(value, list):
                i.array(name)[:] = value
            else:
                i[name] = value
        i.initialise()
        i.step(250.0)
        assert (i["tether.taut"], i["tether.tug_count"]) == (1, 1)
        counts.append(i["solver.steps"] + i["solver.rejected"])
    assert counts[1] < 1.3 * counts[0]


@uncompiled
def test_the_slope_of_the_tension_is_that_of_its_course(monkeypatch: pytest.MonkeyPatch) -> None:
    """What says where a step is to be searched for a change: over each step, against the difference of its ends."""
    ends: list[tuple[float, float, float, float]] = []

    def watched(*arguments: Any) -> events.Events:
        made = make_events(*arguments)

        def signals(record: Any, state: Any, rate: Any, elapsed: float) -> Any:
            found = made.signals(record, state, rate, elapsed)
            ends.append((record[0].state_begin, elapsed, found[events.TENSION], found[events.TENSION_SLOPE]))
            return found

        return made._replace(signals=signals)

    make_events = events.make_events
    monkeypatch.setattr(model, "make_events", watched)
    i = PlainInstance(MODEL, ON_ORBIT, hanging("rigid") | {"tether.damping_ratio": 1.0})
    i.step(60.0)
    late = [(a, b) for a, b in itertools.pairwise(ends) if a[0] == b[0] > 20.0 and a[1] == 0.0 < b[1]]
    changes = np.array([b[2] - a[2] for a, b in late])
    by_slope = np.array([0.5 * b[1] * (a[3] + b[3]) for a, b in late])
    assert len(late) > 20
    assert by_slope == pytest.approx(changes, abs=1e-2 * float(np.abs(changes).max()))


@uncompiled
def test_what_a_rate_is_relative_to() -> None:
    """Inertial space; the orbital frame, n about axis 3; the line of centres as it turns."""
    attitude = Rotation.from_euler("xyz", (0.3, -0.5, 0.7))
    x, y, z, w = attitude.as_quat()
    place, speed = np.array([3.0, 9.0, 2.0]), np.array([0.02, -0.01, 0.03])
    frame = np.array([0.0, 0.0, MEAN_MOTION])
    inertial = speed + np.cross(frame, place)
    expected = {0: np.zeros(3), 1: frame, 2: np.cross(place, inertial) / (place @ place)}
    for choice, turning in expected.items():
        arrays = {
            "target_start_attitude": (w, x, y, z),
            "target_start_rate": (0.01, 0.02, 0.03),
            "start_relative_position": place,
            "start_relative_velocity": speed,
        }
        i = pair(ON_ORBIT, arrays, target__rate_frame=choice, orbit__inclination=0.0)
        wanted = np.array([0.01, 0.02, 0.03]) + attitude.inv().apply(turning)
        assert i.array("target_rate") == pytest.approx(wanted, abs=1e-13)
        assert matrix(i) == pytest.approx(attitude.as_matrix(), abs=1e-13)
        assert i.array("target_spin") == pytest.approx(attitude.apply(INERTIA @ wanted), rel=1e-12)
        assert i["target.spin_energy"] == pytest.approx(0.5 * wanted @ INERTIA @ wanted, rel=1e-12)


@uncompiled
def test_length_is_between_the_attachments() -> None:
    i = pair(BOTH, TUMBLING)
    i.step(5.0)
    place, _ = relative(i)
    vector = place + matrix(i) @ ARM - matrix(i, "chaser") @ np.array([0.1, 1.1, -0.2])
    assert i["tether.length"] == pytest.approx(float(np.linalg.norm(vector)), rel=1e-12)
    assert i["separation"] == pytest.approx(float(np.linalg.norm(place)), rel=1e-12)


@uncompiled
def test_macro_steps_change_nothing() -> None:
    """The same bits for steps of 0.7 and of 70 s, through tugs, in which axes turn and attitudes are set to length."""
    ends = []
    for step, count in ((0.7, 300), (70.0, 3)):
        i = pair(ON_ORBIT, TUMBLING, thrust__level=-2.0)
        for _ in range(count):
            i.step(step)
        ends.append([i[f"tug[{k}].{what}"] for k in range(1, 5) for what in ("time", "peak")])
        ends[-1] += i.array("target_attitude").tolist()
    assert ends[0][:8] == ends[1][:8]
    assert ends[0] == pytest.approx(ends[1], rel=1e-12)


@uncompiled
@pytest.mark.parametrize(
    "terms", [ON_ORBIT, pytest.param(ON_ORBIT | {"chaser": "rigid"}, marks=pytest.mark.evidence), BOTH]
)
def test_rates_of_outputs(terms: dict[str, str]) -> None:
    """Against differences of fourth order, slack and taut."""
    for apart in (9.0, 15.0):
        arrays = TUMBLING | {"start_relative_position": (2.0, apart, 1.0)}
        i = pair(terms, arrays, tether__youngs_modulus=6e6)
        i.step(0.5)
        names = [n for n, _, v, _ in i.interface.scalars() if v.causality == "output" and v.rate]
        seen, step = [], 0.02
        for k in range(5):
            i.step(step)
            seen.append({name: i[name] for name in names})
            if k == 2:
                i.differentiate()
                rates = {name: i.rate(name) for name in names}
        assert bool(i["tether.taut"]) == (apart > 12.0)
        assert {"target.attitude[1]", "target.spin[2]", "target.spin_energy", "separation"} <= set(names)
        for name in names:
            if name.startswith(("center", "altitude", "energy.orbital")) or name.endswith(("radius", "tion[1]")):
                continue
            v = [s[name] for s in seen]
            difference = (v[0] - 8.0 * v[1] + 8.0 * v[3] - v[4]) / (12.0 * step)
            noise = 3e-15 * max(abs(x) for x in v) / step
            assert rates[name] == pytest.approx(difference, rel=2e-6, abs=1e-9 + noise), name


@uncompiled
@pytest.mark.parametrize(
    ("arrays", "code"),
    [
        ({"target_inertia": (1.0, 1.0, 3.0, 0.0, 0.0, 0.0)}, BAD_INERTIA),
        ({"target_inertia": (1.0, 1.0, 1.0, 2.0, 0.0, 0.0)}, BAD_INERTIA),
        ({"target_inertia": (math.nan, 1.0, 1.0, 0.0, 0.0, 0.0)}, BAD_INERTIA),
        ({"target_start_attitude": (1.0, 1.0, 0.0, 0.0)}, BAD_ATTITUDE),
    ],
)
def test_what_no_body_has_is_refused(arrays: dict[str, Any], code: int) -> None:
    with pytest.raises(ModelFault, match=next(f.text for f in MODEL.faults if f.code == code)[:20]):
        pair(FIELD_FREE, arrays)


@uncompiled
def test_a_start_is_stretched_between_the_attachments() -> None:
    """12 m apart with the attachments 1.8 m inside, the line is slack; pointing outwards it would be stretched."""
    values = {"start.condition": 2, "start.separation": 12.0, "tether.rest_length": 11.0}
    for y, refused in ((-1.8, False), (1.8, True)):
        i = Instance(MODEL, FIELD_FREE, values)
        i.array("target_attachment")[:] = 0.0, y, 0.0
        if refused:
            with pytest.raises(ModelFault, match=next(f.text for f in MODEL.faults if f.code == START_STRETCHED)[:20]):
                i.initialise()
        else:
            i.initialise()
            assert i["tether.length"] == pytest.approx(10.2, rel=1e-14)


@pytest.mark.evidence
def test_a_linear_reel_feeds_forward_the_tide_on_the_centres() -> None:
    """At its commanded length, aligned and at rest, the line has 3 n^2 m_r (l_c + a), a the length of the arm."""
    arm = 1.5
    values = {"start.condition": HANDED_OVER, "reel.length": 11.0, "thrust.level": 0.0}
    i = Instance(MODEL, {"reel": "linear", "thrust": "along_track", "target": "rigid"}, values)
    i.array("target_attachment")[:] = -arm, 0.0, 0.0
    i.array("start_relative_position")[:] = 11.0 + arm, 0.0, 0.0
    i.initialise()
    assert i["tether.length"] == pytest.approx(11.0, rel=1e-12)
    assert i["tether.tension"] == pytest.approx(3.0 * MEAN_MOTION**2 * REDUCED * (11.0 + arm), rel=1e-9)
