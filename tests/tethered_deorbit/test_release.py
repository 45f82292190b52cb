"""A line that is cut: when, and that both bodies then fall freely."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from fmu_src.instance import ModelFault
from fmu_src.tethered_deorbit.interface import MODEL
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from orbital.kepler import propagate
from tests.plain import PlainInstance, plain
from tests.validation import Validated, closed_form

__all__ = ["plain"]
pytestmark = pytest.mark.usefixtures("plain")


def tow(when: str, **values: Any) -> PlainInstance:
    told = {"thrust.level": -20.0, "start.separation": 11.9, "tether.youngs_modulus": 6e6}
    return PlainInstance(
        MODEL,
        {"reel": "locked", "thrust": "along_track", "release": when},
        told | {k.replace("__", "."): v for k, v in values.items()},
    )


@pytest.mark.parametrize("stops", [True, False])
def test_cut_at_a_time_both_fall_freely(stops: bool) -> None:
    i = tow("time", release__at=97.5, release__stops_thrust=stops)
    i.step(97.0)
    assert i["tether.taut"]
    assert not i["release.released"]
    i.step(3.0)
    assert i["release.released"]
    assert i["release.time"] == 97.5
    begin = {
        body: [np.array(i.array(f"{body}_{what}")) for what in ("position", "velocity")]
        for body in ("chaser", "target")
    }
    i.step(300.0)
    assert i["tether.tension_peak"] == 0.0
    for body, (position, velocity) in begin.items():
        there, speed = np.zeros(3), np.zeros(3)
        propagate(there, speed, position, velocity, 300.0, EARTH_MU)
        off = np.linalg.norm(i.array(f"{body}_position") - there)
        free = stops or body == "target"
        assert off < 1e-5 if free else off == pytest.approx(0.5 * 20.0 / 2000.0 * 300.0**2, rel=0.05)
    spent = 20.0 * (97.5 if stops else 400.0) / (3000.0 * 9.80665)
    assert i["chaser.propellant"] == pytest.approx(spent, rel=1e-12)


@pytest.mark.parametrize("step", [100.0, 10000.0])
@pytest.mark.parametrize(("level", "at"), [(-200.0, 97.5), (-2.0, 900.0), (-0.5, 900.0)])
def test_the_nearest_return_is_told_whatever_the_step(
    validated: Validated, step: float, level: float, at: float
) -> None:
    """Against a search over the two conics of the cut, and nothing before they have passed. In the first case they were
    nearer before the cut, in the second the first pass is the nearest, in the third the last."""
    i = tow("time", release__at=at, thrust__level=level, tether__damping_ratio=0.1)
    begin = tow("time", release__at=at, thrust__level=level, tether__damping_ratio=0.1)
    begin.step(at)
    states = [[np.array(begin.array(f"{body}_{what}")) for what in ("position", "velocity")]
              for body in ("chaser", "target")]  # fmt: skip

    def apart(elapsed: float) -> float:
        places = np.zeros((2, 3))
        for place, (position, velocity) in zip(places, states, strict=True):
            propagate(place, np.zeros(3), position, velocity, float(elapsed), EARTH_MU)
        return float(np.linalg.norm(places[1] - places[0]))

    grid = np.arange(0.0, 20000.0 - at, 10.0)
    seen = np.array([apart(t) for t in grid])
    turns = [k for k in range(1, len(grid) - 1) if seen[k - 1] > seen[k] <= seen[k + 1]]
    assert turns
    low = min(turns, key=lambda k: seen[k])
    best = minimize_scalar(apart, bounds=(grid[low - 1], grid[low + 1]), method="bounded", options={"xatol": 1e-6})
    assert not begin["release.returned"]
    assert begin["release.return_distance"] == 0.0
    while i.time < 20000.0:
        i.step(step)
    assert i["release.returned"]
    within = 2e-3 if level == -200.0 else 1e-5
    conics, told = closed_form("two conics from the cut"), i["release.return_distance"]
    validated(conics, f"nearest return after a cut at {at:g} s", told, best.fun, "m", abs=within)
    assert i["release.return_time"] == pytest.approx(at + best.x, abs=0.5)
    assert (i["approach.distance"] < i["release.return_distance"] - 0.1) == (level == -200.0)


@pytest.mark.parametrize(("when", "low"), [("altitude", 799.9e3), ("perigee", 780e3)])
def test_cut_where_it_is_low_enough(when: str, low: float) -> None:
    i = tow(when, thrust__level=-900.0, **{f"release__{when}": low})
    states = []
    for _ in range(80):
        i.step(2.0)
        states.append((i["release.released"], height(i) if when == "perigee" else i["altitude"]))
    cut = next(k for k, (released, _) in enumerate(states) if released)
    assert 0 < cut < 79
    assert states[cut - 1][1] > low
    assert states[cut][1] < low + 1.0
    assert 2.0 * cut < i["release.time"] <= 2.0 * (cut + 1)


def height(i: Any) -> float:
    """Of the perigee, from outputs."""
    r, v = i.array("center_position"), i.array("center_velocity")
    e = np.cross(v, np.cross(r, v)) / EARTH_MU - r / np.linalg.norm(r)
    return float(i["center.semi_major_axis"] * (1.0 - np.linalg.norm(e)) - EARTH_EQUATORIAL_RADIUS)


def test_a_line_that_would_be_cut_at_once_is_refused() -> None:
    with pytest.raises(ModelFault, match="cut as the tow begins"):
        tow("altitude", release__altitude=801e3)
    i = tow("time", release__at=0.0)
    i.step(1.0)
    assert i["release.released"]
    assert i["release.time"] == 0.0
    assert math.isfinite(i["separation"])


def test_a_line_that_is_cut_slack_never_goes_taut() -> None:
    i = tow("time", release__at=0.5, release__stops_thrust=False)
    i.step(0.2)
    assert not i["tether.taut"]
    for _ in range(20):
        i.step(10.0)
        assert i["tether.tension_peak"] == 0.0
    assert i["tether.tug_count"] == 0
    assert i["separation"] > 12.0
