"""Far from Table 2: nothing becomes a NaN, energy behaves, and what cannot be is refused with its reason."""

import math
import re
from typing import Any

import numpy as np
import pytest

from fmu_src.instance import Instance, ModelFault
from fmu_src.tethered_deorbit.interface import (
    BAD_ATTITUDE,
    BAD_CHORD,
    BAD_INERTIA,
    BAD_ORBIT,
    BAD_PARAMETER,
    BAD_SCHEDULE,
    BODIES_MET,
    BROKE,
    CAME_CLOSE,
    CAME_DOWN,
    ENDS_AT_START,
    GROUND,
    HANDED_OVER,
    MODEL,
    NO_ARCS,
    NO_ATTITUDE,
    NO_BODY,
    NO_LENGTH,
    NO_LINE,
    NO_ORBIT,
    NO_VERTICAL,
    NOT_FINITE,
    PERIGEE_LOW,
    PERIGEE_RAISED,
    RELEASED_AT_START,
    START_STRETCHED,
    STEP_NOT_MET,
    TIME_GAP,
    TOO_MANY_EVENTS,
    TOO_MANY_TURNS,
    VBAR,
    WRAPPED_UP,
)

TERMS = {"reel": "locked", "thrust": "along_track"}
DAY = 86400.0

EXTREMES: dict[str, tuple[dict[str, float], float]] = {
    "undamped": ({"tether.damping_ratio": 0.0}, 10 * DAY),
    "near critical": ({"tether.damping_ratio": 0.9}, DAY),
    "over critical": ({"tether.damping_ratio": 3.0}, DAY / 8),
    "10 km": ({"tether.rest_length": 1e4, "start.separation": 9.9e3}, DAY),
    "steel": ({"tether.youngs_modulus": 200e9, "tether.diameter": 0.01}, DAY / 8),
    "thousandfold stiffness": ({"tether.youngs_modulus": 60e12}, DAY / 8),
    "8 t": ({"target.mass": 8000.0}, DAY),
    "1 kg": ({"target.mass": 1.0}, DAY / 8),
    "GEO": ({"orbit.altitude": 35786e3}, DAY),
    "GTO": ({"orbit.altitude": 18e6, "orbit.eccentricity": 0.7}, DAY),
    "10 N": ({"thrust.level": -10.0}, DAY / 8),
    "pushed together": ({"thrust.level": 1.0}, DAY / 8),
    "slack for days": ({"thrust.level": 0.0}, 10 * DAY),
}


@pytest.mark.parametrize("name", EXTREMES)
def test_extremes_stay_finite(name: str) -> None:
    parameters, end = EXTREMES[name]
    i = Instance(MODEL, TERMS, parameters).initialise()
    for _ in range(3):
        i.step(end / 3)
        for field in i.record.dtype.names:
            assert np.isfinite(i.record[field]).all(), field
    if name != "pushed together":
        stretch = i["tether.length"] / i["tether.rest_length"] - 1.0
        assert stretch < 0.01
    assert (i["tether.tug_count"] == 0) == (name == "slack for days")


@pytest.mark.parametrize("step", [1e-3, 1e5])
def test_macro_steps(step: float) -> None:
    i = Instance(MODEL, TERMS).initialise()
    for _ in range(3):
        i.step(step)
    assert math.isfinite(i["tether.tension"])


FAST = [1e160, 0.0, 0.0]
LINE = [5.0, 0.0, 0.0]
REFUSED: list[tuple[int, dict[str, Any], float]] = [
    (NOT_FINITE, {"orbit.inclination": math.nan}, 0.0),
    (
        NOT_FINITE,
        {"start.condition": HANDED_OVER, "start_relative_position": LINE, "start_relative_velocity": FAST},
        1.0,
    ),
    (TIME_GAP, {}, -1.0),
    (TIME_GAP, {}, math.nan),
    (GROUND, {"orbit.altitude": 100e3, "thrust.level": -1000.0}, 5e4),
    (BAD_ORBIT, {"orbit.eccentricity": 0.2}, 0.0),
    (BAD_ORBIT, {"orbit.altitude": -1.0}, 0.0),
    (BAD_CHORD, {"start.separation": 1e6, "tether.rest_length": 2e6}, 0.0),
    (START_STRETCHED, {"start.separation": 12.5}, 0.0),
    (START_STRETCHED, {"start.separation": 12.5, "start.condition": VBAR}, 0.0),
    (NO_LENGTH, {"reel.length_offset": -12.0}, 0.0),
    (NO_LENGTH, {"reel.length_offset": math.inf}, 0.0),
    (NO_LINE, {"start.condition": HANDED_OVER}, 0.0),
    (BAD_PARAMETER, {"chaser.mass": 0.0}, 0.0),
    (BAD_PARAMETER, {"target.mass": math.nan}, 0.0),
    (BAD_PARAMETER, {"solver.tolerance_orbit": 0.0}, 0.0),
    (BAD_PARAMETER, {"solver.tolerance_separation": -1e-10}, 0.0),
    (BAD_PARAMETER, {"solver.tolerance_stretch": 0.0}, 0.0),
    (BAD_PARAMETER, {"start.condition": 7}, 0.0),
    (BAD_PARAMETER, {"start.leading": 2}, 0.0),
    (BAD_PARAMETER, {"start.separation": 0.0}, 0.0),
    (BAD_PARAMETER, {"tether.youngs_modulus": math.nan}, 0.0),
    (BAD_PARAMETER, {"tether.diameter": 0.0}, 0.0),
    (BAD_PARAMETER, {"tether.damping_ratio": -0.1}, 0.0),
    (BAD_PARAMETER, {"thrust.level": math.nan}, 0.0),
    (BAD_PARAMETER, {"thrust.offset": math.inf}, 0.0),
    (BAD_PARAMETER, {"thrust.specific_impulse": 0.0}, 0.0),
]
"""Fault, what is set (a parameter or a field), and the macro step that meets it; 0 at the start."""

ELSEWHERE = {
    TOO_MANY_EVENTS: "test_uncompiled.py",
    STEP_NOT_MET: "test_steps_too_short_for_the_time",
    NO_ORBIT: "test_field_free.py",
    BAD_INERTIA: "test_rigid_outputs.py",
    BAD_ATTITUDE: "test_rigid_outputs.py",
    TOO_MANY_TURNS: "test_wrapping.py",
    BODIES_MET: "test_wrapping.py",
    **dict.fromkeys(
        (CAME_DOWN, PERIGEE_LOW, PERIGEE_RAISED, CAME_CLOSE, WRAPPED_UP, BROKE, ENDS_AT_START), "test_ends.py"
    ),
    NO_ARCS: "test_burn.py",
    NO_ATTITUDE: "test_aocs.py",
    NO_VERTICAL: "test_regulator.py",
    BAD_SCHEDULE: "test_winding.py",
    RELEASED_AT_START: "test_release.py",
    NO_BODY: "test_hulls.py",
}


@pytest.mark.parametrize(("code", "parameters", "step"), REFUSED)
def test_refusals(code: int, parameters: dict[str, Any], step: float) -> None:
    """Each with its own code and text, the offending value never a NaN, and a good value in its place goes through."""
    i = Instance(MODEL, TERMS)
    for name, value in parameters.items():
        if isinstance(value, list):
            i.array(name)[:] = value
        else:
            i[name] = value
    text = next(f.text for f in MODEL.faults if f.code == code)
    if step != 0.0:
        i.initialise()
    with pytest.raises(ModelFault, match=re.escape(text)):
        i.step(step) if step != 0.0 else i.initialise()
    assert i.record["fault_code"][0] == code
    assert np.isfinite(i.record["fault_value"]).all()
    assert np.isfinite(i.record["fault_time"]).all()


def test_every_fault_is_reached() -> None:
    assert {code for code, _, _ in REFUSED} | set(ELSEWHERE) == {f.code for f in MODEL.faults}


def test_steps_too_short_for_the_time() -> None:
    """After most of a year a line asks for steps of which half could no longer be told from rounding; a softer one
    does not, and none does on the first day."""
    short = {"start.separation": 0.1, "tether.rest_length": 12.0, "thrust.level": 0.0, "tether.damping_ratio": 10.0}
    for modulus, end, refused in ((1e14, 2e7, True), (1e14, 1e5, False), (1e10, 2e7, False)):
        i = Instance(MODEL, TERMS, short | {"tether.youngs_modulus": modulus, "tether.diameter": 1.0}).initialise()
        i.step(end)
        i["reel.length_offset"] = i["tether.length"] - 12.0 - 1e-9
        if refused:
            with pytest.raises(ModelFault, match="cannot be met"):
                i.step(1e-3)
            assert i.record["fault_code"][0] == STEP_NOT_MET
        else:
            i.step(1e-3)


def test_refused_while_running() -> None:
    """An input that goes bad stops the run at that communication point and names it."""
    for name, value, code in (
        ("thrust.offset", math.nan, BAD_PARAMETER),
        ("reel.length_offset", math.nan, BAD_PARAMETER),
        ("reel.length_offset", -12.0, NO_LENGTH),
    ):
        i = Instance(MODEL, TERMS).initialise()
        i.step(10.0)
        i[name] = value
        with pytest.raises(ModelFault):
            i.step(10.0)
        assert (i.record["fault_code"][0], i.record["fault_time"][0]) == (code, 10.0)
    i = Instance(MODEL, TERMS).initialise()
    with pytest.raises(ModelFault, match="bounds"):
        i._call(9, 0.0, 0.0)  # no such command


def test_good_values_beside_the_refused() -> None:
    for good in ({"orbit.eccentricity": 0.1}, {"start.separation": 11.9}, {"reel.length_offset": -1.0}):
        Instance(MODEL, TERMS, good).initialise().step(10.0)
    Instance(MODEL, TERMS).initialise(1e12).step(64.0)


def test_grazing() -> None:
    """A line that is touched for a moment, deep inside a long free step, is found; a nanometre longer, it is not."""
    drift = {"thrust.level": 0.0, "start.condition": 2, "tether.damping_ratio": 0.0}
    free = Instance(MODEL, TERMS, drift | {"tether.rest_length": 1e3}).initialise()
    separations = []
    for _ in range(12000):
        free.step(1.0)
        separations.append(free.record["separation"][0])
    s = np.array(separations)
    tops = np.flatnonzero((s[1:-1] > s[:-2]) & (s[1:-1] >= s[2:])) + 1
    assert len(tops)
    top = tops[0]
    peak = s[top] + (s[top + 1] - s[top - 1]) ** 2 / (8.0 * (2.0 * s[top] - s[top - 1] - s[top + 1]))
    for short, count in ((1e-6, 1), (1e-8, 1), (-1e-8, 0)):
        i = Instance(MODEL, TERMS, drift | {"tether.rest_length": peak - short}).initialise()
        i.step(top + 60.0)
        assert i["tether.tug_count"] == count
        if count:
            assert i["tug[1].time"] == pytest.approx(top + 1, abs=60.0)
