"""Far from Table 2: nothing becomes a NaN, energy behaves, and what cannot be is refused with its reason."""

import math

import numpy as np
import pytest

from fmu_src.instance import Instance, ModelFault
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL

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


def refused(match: str, parameters: dict[str, float], step: float = 0.0, terms: dict[str, str] = TERMS) -> Instance:
    i = Instance(MODEL, terms, parameters)
    with pytest.raises(ModelFault, match=match):
        i.initialise().step(step)
    assert np.isfinite(i.record["fault_value"]).all()
    return i


def test_refusals() -> None:
    refused("perigee", {"orbit.eccentricity": 0.2})
    refused("start stretched", {"start.separation": 12.5})
    refused("start stretched", {"start.separation": 12.5, "start.condition": 1})
    refused("chord", {"start.separation": 1e6, "tether.rest_length": 2e6})
    refused("no direction", {"start.condition": HANDED_OVER})
    refused("not positive", {"reel.length_offset": -12.0})
    refused("bounds", {"target.mass": 0.0})
    refused("bounds", {"thrust.offset": math.inf})
    refused("bounds", {"tether.youngs_modulus": math.nan})
    refused("bounds", {"start.condition": 7})
    refused("ended", {"orbit.altitude": 100e3, "thrust.level": -1000.0}, 5e4)
    for good in ({"orbit.eccentricity": 0.1}, {"start.separation": 11.9}):
        Instance(MODEL, TERMS, good).initialise().step(10.0)


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
