"""A line whose vibration has died: the tow is that of one whose vibration is followed, and steps follow the orbit."""

import math
from collections.abc import Mapping

import numpy as np
import pytest
from numpy.polynomial import Chebyshev, Polynomial

from fmu_src.instance import Instance
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL
from fmu_src.tethered_deorbit.levels.course import slow_solution
from fmu_src.tethered_deorbit.model import make_entry
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from orbital.oscillators import line_stiffness, reduced_mass
from tests.plain import PlainInstance, plain

__all__ = ["plain"]

TERMS = {"reel": "locked", "thrust": "along_track"}
SETTLED = TERMS | {"level": "settled"}
TABLE_2 = {"thrust.level": -0.01, "start.separation": 10.0}
STIFFNESS = line_stiffness(60e9, 1e-3, 12.0)
REDUCED = reduced_mass(2000.0, 1000.0)
SEEN = ("tether.tension", "tether.angle", "separation", "center.semi_major_axis", "tether.tension_peak")


def tow(terms: Mapping[str, str], **parameters: float) -> Instance:
    return Instance(MODEL, terms, TABLE_2 | {k.replace("__", "."): v for k, v in parameters.items()}).initialise()


def rows(i: Instance, until: float, step: float) -> np.ndarray:
    found = []
    while i.time < until:
        i.step(step)
        found.append([i[name] for name in SEEN])
    return np.array(found)


def test_a_day_is_that_of_a_line_whose_vibration_is_followed() -> None:
    """Both within what `level = settled` states; the first tugs to the last bit, at a thirtieth of the steps."""
    followed, stepped_over = tow(TERMS), tow(SETTLED)
    beside = np.abs(rows(stepped_over, 86400.0, 600.0) - rows(followed, 86400.0, 600.0)).max(axis=0)
    assert (beside < [3e-9, 3e-9, 3e-10, 1e-6, 5e-8]).all(), beside
    assert stepped_over["tether.tug_count"] == followed["tether.tug_count"] == 38
    assert [stepped_over[f"tug[1].{x}"] for x in ("time", "speed")] == [
        followed[f"tug[1].{x}"] for x in ("time", "speed")
    ]
    assert stepped_over["tether.impulse"] == pytest.approx(followed["tether.impulse"], rel=1e-9)
    assert 30 * stepped_over["solver.steps"] < followed["solver.steps"]
    assert stepped_over["level.settled"]
    assert stepped_over["level.times_settled"] == 1
    # within an hour of the last tug, 20 time constants of the vibration
    assert followed["tug[1].time"] < stepped_over["level.settled_since"] < 6000.0


def test_the_same_bits_whatever_the_macro_step() -> None:
    one, many = tow(SETTLED), tow(SETTLED)
    one.step(12000.0)
    rows(many, 12000.0, 7.5)
    for name in (*SEEN[:4], "tether.impulse", "solver.steps", "level.settled_since", "approach.distance"):
        assert one[name] == many[name], name


def test_tension_over_an_orbit_at_rest() -> None:
    """Noise of the tension below 1e-6 N, asked of a taut orbit from the equilibrium."""
    i = Instance(MODEL, SETTLED, TABLE_2 | {"start.condition": HANDED_OVER})
    rate = math.sqrt(EARTH_MU / (EARTH_EQUATORIAL_RADIUS + 800e3) ** 3)
    tension = 3.0 * rate * rate * 12.0 * REDUCED
    angle = math.radians(7.40452)
    i.array("start_relative_position")[:2] = (12.0 + tension / STIFFNESS) * np.array([math.cos(angle), math.sin(angle)])
    i.initialise()
    i.step(600.0)
    seen = rows(i, 600.0 + 6060.0, 15.0)[:, 0]
    assert i["level.settled"]
    times = np.linspace(-1.0, 1.0, len(seen))
    noise = seen - Chebyshev.fit(times, seen, 30)(times)
    assert noise.std() < 1e-9
    assert seen.mean() == pytest.approx(tension, rel=1e-3)


def test_a_changed_thrust_shakes_the_line_again() -> None:
    """What changes the load at once is followed by resolved steps, until the vibration has died anew."""
    ends = []
    for terms in (TERMS, SETTLED):
        i = tow(terms)
        i.step(20000.0)
        i["thrust.offset"] = -0.5
        i.step(60.0)
        if terms is SETTLED:
            assert not i["level.settled"]
            assert i["level.times_settled"] == 1
        i.step(940.0)
        ends.append([*(i[name] for name in SEEN), i["tether.tug_count"]])
    assert i["level.settled"]
    assert i["level.times_settled"] == 2
    assert np.abs(np.subtract(*ends)) == pytest.approx(0.0, abs=1e-7)


def test_derivatives_of_a_settled_line() -> None:
    i = tow(SETTLED)
    i.step(20000.0)
    i.differentiate()
    before, told, steps = i["tether.tension"], i.rate("tether.tension"), i["solver.steps"]
    i.refresh()
    assert (i["tether.tension"], i["solver.steps"]) == (before, steps)
    assert i["level.settled"]
    i.step(0.5)
    later = i["tether.tension"]
    i.differentiate()
    assert (later - before) / 0.5 == pytest.approx(0.5 * (told + i.rate("tether.tension")), abs=2e-9)
    assert abs(told) > 1e-5
    load = i["tether.tension"] / STIFFNESS
    assert i["tether.length"] - 12.0 == pytest.approx(load, rel=1e-3)


@pytest.mark.parametrize("changed", [{"tether.damping_ratio": 0.0}, {"tether.youngs_modulus": 1e6}])
def test_where_nothing_can_settle_the_steps_stay(changed: Mapping[str, float]) -> None:
    """No damping, no rest; and a line as soft as that swings with the orbit. The same bits as without the level."""
    i, j = (Instance(MODEL, terms, TABLE_2 | changed).initialise() for terms in (TERMS, SETTLED))
    for tow_ in (i, j):
        tow_.step(20000.0)
    assert not j["level.times_settled"]
    assert [i[name] for name in (*SEEN, "solver.steps")] == [j[name] for name in (*SEEN, "solver.steps")]


def test_a_line_that_cannot_settle_is_refused() -> None:
    for reel in ("linear", "commanded", "libration"):
        with pytest.raises(ValueError, match=f"no line settles with reel = '{reel}'"):
            make_entry(SETTLED | {"reel": reel})


def test_a_line_settles_while_a_tank_empties(plain: None) -> None:
    """It moves the mass that is there: by the one of the begin its course would be off by what was lost."""
    angle = math.radians(20.0)
    place = (12.0 * math.cos(angle), 12.0 * math.sin(angle), 0.0)
    i = PlainInstance(
        MODEL,
        {"reel": "locked", "thrust": "along_track", "engine": "chemical", "level": "settled"},
        {"thrust.level": -0.01, "thrust.specific_impulse": 0.001, "engine.propellant": 1500.0,
         "start.condition": HANDED_OVER, "start_relative_position": place},
    )  # fmt: skip
    i.step(600.0)
    assert i["chaser.propellant"] == pytest.approx(0.01 / (0.001 * 9.80665) * 600.0)
    assert i["level.settled"]
    mass = reduced_mass(2000.0 - i["chaser.propellant"], 1000.0)
    load = i["tether.tension"] / STIFFNESS
    assert i["tether.length"] - 12.0 == pytest.approx(load, rel=1e-3)
    swing = 3.0 * (EARTH_MU / (EARTH_EQUATORIAL_RADIUS + 800e3) ** 3) * math.cos(i["tether.angle"]) ** 2
    assert i["tether.tension"] == pytest.approx(mass * 12.0 * swing, rel=0.25)


def test_slow_solution() -> None:
    """Put into m x'' + c x' + k x = P it leaves what P''' alone adds, and nothing under a load that is a parabola."""
    mass, damping, stiffness = 3.0, 0.7, 50.0
    for turn in (0.0, 0.02):
        load, x = Polynomial([2.0, 0.3, -0.05, turn]), np.zeros(4)
        slow_solution(x, *load.coef, mass, damping, stiffness)
        course = Polynomial(x)
        left = mass * course.deriv(2) + damping * course.deriv() + stiffness * course - load
        lag = damping / stiffness
        third = (2.0 * mass * lag / stiffness - lag**3) * 6.0 * turn
        assert left(np.linspace(0.0, 2.0, 5)) == pytest.approx(-third, abs=1e-14)
