"""Many revolutions of a dumbbell at once: orbit, swing and impulse are those of one that is stepped over them."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmu_src.instance import Instance, ModelFault
from fmu_src.tethered_deorbit.interface import MODEL
from fmu_src.tethered_deorbit.levels import libration
from fmu_src.tethered_deorbit.model import make_entry
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from tests.validation import Validated, closed_form

TERMS = {"reel": "locked", "thrust": "along_track", "ends": "watched"}
AVERAGED = TERMS | {"level": "averaged"}
TABLE_2 = {"thrust.level": -0.01, "start.separation": 10.0}
DAY = 86400.0
AXIS = EARTH_EQUATORIAL_RADIUS + 800e3
RATE = math.sqrt(EARTH_MU / AXIS**3)
LENGTH, PUSH = 12.0, 0.01 / 2000.0 / 12.0
swing, along_swing, place_of, energy_of = (
    kernel.py_func for kernel in (libration.swing, libration.along_swing, libration.place_of, libration.energy_of)
)


def tow(**parameters: float) -> Instance:
    return Instance(MODEL, AVERAGED, TABLE_2 | {k.replace("__", "."): v for k, v in parameters.items()}).initialise()


@pytest.mark.parametrize(("amplitude", "push"), [(61.0, PUSH), (20.0, -PUSH), (1.0, 0.0)])
def test_a_swing_is_that_of_its_equation(amplitude: float, push: float) -> None:
    """Period, action, mean tension and where it is on the way, against an integration."""
    slowing, out, waves = 1e-12, np.zeros(libration.SIZE), np.zeros((2, libration.WAVES))
    energy = libration.potential.py_func(math.radians(amplitude), RATE**2, push, slowing)
    assert swing(out, waves, energy, LENGTH, RATE, push, slowing, True)
    left = out[libration.MIDDLE] - out[libration.WIDTH]

    def motion(time: float, y: np.ndarray) -> tuple[float, ...]:
        s, c = math.sin(y[0]), math.cos(y[0])
        back = -(3.0 * RATE**2 * s - push) * c - slowing
        return y[1], back, LENGTH * (y[1] ** 2 + 3.0 * RATE**2 * c * c + push * s), y[1] ** 2

    period = out[libration.PERIOD]
    found = solve_ivp(motion, (0.0, period), (left, 0.0, 0.0, 0.0), rtol=1e-12, atol=1e-16, dense_output=True)
    end = found.y[:, -1]
    assert end[0] == pytest.approx(left, abs=1e-9)
    assert end[1] == pytest.approx(0.0, abs=1e-11)
    assert out[libration.MEAN] * period == pytest.approx(end[2], rel=1e-9)
    assert out[libration.ACTION] == pytest.approx(end[3], rel=1e-7)
    for share in (0.1, 0.37, 0.8):
        there = found.sol(share * period)
        x = place_of(waves, share * period, period)
        assert out[libration.MIDDLE] - out[libration.WIDTH] * math.cos(x) == pytest.approx(there[0], abs=1e-9)
        assert along_swing(waves, 1, x) == pytest.approx(there[2], rel=1e-8)
    again = energy_of(out, waves, 1.1 * end[3], energy, LENGTH, RATE, push, slowing)
    assert swing(out, waves, again, LENGTH, RATE, push, slowing, False)
    assert out[libration.ACTION] == pytest.approx(1.1 * end[3], rel=1e-9)


def test_closed_forms_of_a_swing() -> None:
    """Rest at 7.4045 degrees, small swings of 3523.75 s, mean tension 3 n^2 l m at rest."""
    rest = libration.rest_angle.py_func(RATE**2, PUSH, 0.0)
    assert math.degrees(rest) == pytest.approx(7.40452, abs=1e-5)
    out, waves = np.zeros(libration.SIZE), np.zeros((2, libration.WAVES))
    energy = libration.potential.py_func(rest + 1e-3, RATE**2, PUSH, 0.0)
    assert swing(out, waves, energy, LENGTH, RATE, PUSH, 0.0, False)
    assert out[libration.PERIOD] == pytest.approx(3523.75, abs=0.01)
    assert out[libration.MEAN] == pytest.approx(3.0 * RATE**2 * LENGTH, rel=1e-5)
    beyond = libration.potential.py_func(math.radians(91.0), RATE**2, 0.0, 0.0)
    assert not swing(out, waves, 1.01 * beyond, LENGTH, RATE, 0.0, 0.0, False)


@pytest.mark.parametrize("days", [5, pytest.param(30, marks=pytest.mark.evidence)])
def test_days_at_once_are_those_which_are_stepped(days: int) -> None:
    leaping, stepping = tow(), tow(level__average_tolerance=0.0)
    before = []
    for i in (leaping, stepping):
        i.step(DAY)
        before.append(i["solver.steps"])
        i.step((days - 1) * DAY)
    assert leaping["level.now"] == 4
    assert stepping["level.averaged"] == 0.0
    assert leaping["solver.steps"] - before[0] < 30 < 1000 * days < stepping["solver.steps"] - before[1]
    assert leaping["level.revolutions"] == pytest.approx(leaping["level.averaged"] * RATE / math.tau, rel=3e-3)
    times = [leaping[f"level.{mode}"] for mode in ("free", "followed", "mapped", "dumbbell", "averaged")]
    assert sum(times) == pytest.approx(days * DAY, abs=1e-5)
    for name, within in (
        ("center.semi_major_axis", 0.02 * days / 30.0),
        ("tether.angle", 0.01), ("tether.tension", 1e-3), ("separation", 1e-6),
        ("chaser.propellant", 1e-12), ("energy.relative", 1e-3), ("tether.tension_peak", 3e-5),
        ("tether.tension_least", 3e-5),
    ):  # fmt: skip
        assert leaping[name] == pytest.approx(stepping[name], abs=within), name
    assert leaping["tether.impulse"] == pytest.approx(stepping["tether.impulse"], rel=5e-6)
    apart = leaping.array("center_position") - stepping.array("center_position")
    assert np.linalg.norm(apart) < 1e-7 * (days - 1) * DAY * RATE * AXIS
    assert leaping["level.average_error"] < 1e-4


def eccentricity(i: Instance) -> np.ndarray:
    position, velocity = i.array("center_position"), i.array("center_velocity")
    return np.cross(velocity, np.cross(position, velocity)) / EARTH_MU - position / np.linalg.norm(position)


def test_eccentricity_of_a_spiral() -> None:
    """Under a thrust along the track it grows as v^1.5 and stays where it points."""
    ends, before = [], 0.0
    for allowed in (0.1, 0.0):
        loose = {"solver.tolerance_orbit": 1e-3, "solver.tolerance_separation": 1e-6, "solver.tolerance_stretch": 1e-7}
        values = (
            TABLE_2 | loose | {"thrust.level": -0.03, "orbit.eccentricity": 5e-4, "level.average_tolerance": allowed}
        )
        i = Instance(MODEL, AVERAGED, values).initialise()
        i.step(DAY)
        before = float(np.linalg.norm(eccentricity(i)))
        i.step(200.0 * DAY)
        ends.append(eccentricity(i))
        assert (i["level.revolutions"] > 1000.0) == (allowed > 0.0)
        speed = math.sqrt(EARTH_MU / i["center.semi_major_axis"])
    assert np.linalg.norm(ends[0] - ends[1]) < 1e-2 * np.linalg.norm(ends[1])
    grown = (speed / math.sqrt(EARTH_MU / AXIS)) ** 1.5
    assert grown > 1.03
    assert np.linalg.norm(ends[1]) == pytest.approx(grown * before, rel=0.02)


def test_it_comes_down_when_the_closed_form_says(validated: Validated) -> None:
    """From 800 to 790 km: (v_1 - v_0) M/F, the run's end found within a leap."""
    i = tow(ends__altitude=790e3)
    with pytest.raises(ModelFault):
        i.step(60.0 * DAY)
    first, last = (math.sqrt(EARTH_MU / (EARTH_EQUATORIAL_RADIUS + h)) for h in (800e3, 790e3))
    falls, spiral = (last - first) * 3000.0 / 0.01, closed_form("(v_1 - v_0) M/F")
    validated(spiral, "averaged tow: when it is down from 800 to 790 km", i["ends.time"], falls, "s", rel=1e-3)


def test_where_its_bound_is_exceeded_it_is_stepped() -> None:
    """On an ellipse; and undamped, where tugs may come."""
    for changed in ({"orbit__eccentricity": 0.05, "orbit__altitude": 1200e3}, {"tether__damping_ratio": 0.0}):
        i = tow(**changed)
        i.step(3.0 * DAY)
        assert i["level.averaged"] == 0.0, changed
        assert i["tether.tug_count"] > 10


@pytest.mark.parametrize(
    ("more", "said"),
    [({"oblateness": "J2"}, "cannot go together with oblateness"), ({"thrust": "tether"}, "thrust = 'tether'"),
     ({"environment": "none"}, "environment = 'none'"), ({"target": "rigid"}, "target = 'rigid'")],
)  # fmt: skip
def test_what_it_cannot_carry_is_refused(more: Mapping[str, str], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        make_entry(AVERAGED | more)
