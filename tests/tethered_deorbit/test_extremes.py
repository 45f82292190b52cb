"""Largest and least tension of a macro step, impulse, and closest approach, whatever the macro step."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fmu_src.instance import Instance
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL
from orbital import oscillators, references
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from tests.validation import Validated, closed_form

LOCKED = {"reel": "locked", "thrust": "along_track"}
COMMANDED = {"reel": "commanded", "thrust": "along_track"}
REDUCED = oscillators.reduced_mass(2000.0, 1000.0)
STIFFNESS = oscillators.line_stiffness(60e9, 1e-3, 12.0)
RATE = math.sqrt(EARTH_MU / (EARTH_EQUATORIAL_RADIUS + 800e3) ** 3)


def hanging(stretch: float, zeta: float = 0.0) -> Instance:
    parameters = {"start.condition": HANDED_OVER, "thrust.level": 0.0, "tether.damping_ratio": zeta}
    i = Instance(MODEL, LOCKED, parameters)
    i.array("start_relative_position")[:] = 12.0 + stretch, 0.0, 0.0
    return i.initialise()


@pytest.mark.parametrize("step", [2.0, 3.7, 60.0, 1000.0])
def test_range_of_a_vibration(validated: Validated, step: float) -> None:
    """T = P + (k s - P) cos(w t), P the pull of the tide: between 2 P - k s and k s in every whole period."""
    pull = references.equilibrium_tension(RATE, 12.0, REDUCED)
    period = math.tau / oscillators.natural_frequency(STIFFNESS, REDUCED)
    i = hanging(1.5 * pull / STIFFNESS)
    assert i["tether.tension_peak"] == i["tether.tension_least"] == i["tether.tension"]
    seen = []
    for _ in range(5):
        i.step(step)
        seen.append((i["tether.tension_peak"], i["tether.tension_least"]))
        assert i["tether.tension_least"] <= i["tether.tension"] <= i["tether.tension_peak"]
    if step > period:
        most, least = np.transpose(seen)
        formula = closed_form("P + (k s - P) cos(w t), P the tide's pull")
        validated(formula, "line that vibrates: largest tension", most, 1.5 * pull, "N", rel=2e-4)
        validated(formula, "line that vibrates: least tension", least, 0.5 * pull, "N", rel=5e-4)
    assert i["tether.tension_least"] != pytest.approx(0.505 * pull, rel=5e-4)


def test_range_over_a_long_step_is_that_of_the_short_ones() -> None:
    """Through slack and taut, to what the tolerance of the stretch is worth; slack makes the least zero."""
    for zeta, parts in ((0.05, 400), (0.5, 400)):
        whole, short = hanging(2e-5, zeta), hanging(2e-5, zeta)
        for length in (1.0, 40.0, 300.0):
            whole.step(length)
            least, largest, slack = math.inf, 0.0, False
            for _ in range(parts):
                short.step(length / parts)
                least = min(least, short["tether.tension_least"])
                largest = max(largest, short["tether.tension_peak"])
                slack = slack or not short["tether.taut"]
            assert whole["tether.tension_peak"] == pytest.approx(largest, abs=2e-7)
            assert whole["tether.tension_least"] == pytest.approx(least, abs=2e-7)
            assert whole["tether.tension_peak"] > whole["tether.tension_least"]
            assert not slack or whole["tether.tension_least"] == 0.0


def test_range_of_a_ramp() -> None:
    i = Instance(MODEL, COMMANDED, {"reel.tension": 0.5}).initialise()
    for rate, least, largest in (
        (0.02, 0.5, 0.7),
        (-0.01, 0.6, 0.7),
        (-0.1, 0.0, 0.6),
        (0.2, 0.0, 1.6),
        (0.0, 1.6, 1.6),
    ):
        i.set_rates({"reel.tension": rate})
        i.step(10.0)
        assert i["tether.tension_least"] == pytest.approx(least, rel=1e-14)
        assert i["tether.tension_peak"] == pytest.approx(largest, rel=1e-14)


def test_impulse_is_the_momentum_the_line_has_passed_on(validated: Validated) -> None:
    """Along a line at rest in inertial axes and far from the Earth: m_r times the change of the rate of parting."""
    parameters = {"start.condition": HANDED_OVER, "thrust.level": 0.0, "orbit.altitude": 1e8}
    i = Instance(MODEL, LOCKED, parameters | {"tether.damping_ratio": 0.3})
    n = math.sqrt(EARTH_MU / (EARTH_EQUATORIAL_RADIUS + 1e8) ** 3)
    i.array("start_relative_position")[:] = 11.9999, 0.0, 0.0
    i.array("start_relative_velocity")[:] = 0.5, -n * 11.9999, 0.0
    i.initialise()
    before = i["tether.length_rate"]
    i.step(0.01)
    i.step(2.0)
    assert (i["tether.taut"], i["tether.tug_count"]) == (0, 1)
    passed = REDUCED * (before - i["tether.length_rate"])
    change = closed_form("m_r times the change of speed")
    validated(change, "tug at 0.5 m/s: impulse of the line", i["tether.impulse"], passed, "N s", rel=1e-7)
    assert i["tether.impulse"] != pytest.approx(1.000001 * passed, rel=1e-7)
    assert 300.0 < passed < 700.0


def test_impulse_has_the_tension_for_its_rate() -> None:
    i = hanging(2e-5, 0.05)
    i.step(3.3)
    i.differentiate()
    assert i.rate("tether.impulse") == i["tether.tension"] > 0.0


def drifting(speed: float) -> Instance:
    """Two bodies far from the Earth that pass each other, slack, at 3 m, half-way through 10 s at this speed."""
    parameters = {"start.condition": HANDED_OVER, "thrust.level": 0.0, "orbit.altitude": 1e8}
    i = Instance(MODEL, LOCKED, parameters | {"tether.rest_length": 100.0})
    n = math.sqrt(EARTH_MU / (EARTH_EQUATORIAL_RADIUS + 1e8) ** 3)
    place, velocity = np.array([3.0, 5.0 * speed, 0.0]), np.array([0.0, -speed, 0.0])
    i.array("start_relative_position")[:] = place
    i.array("start_relative_velocity")[:] = velocity - np.cross([0.0, 0.0, n], place)
    return i.initialise()


@pytest.mark.parametrize("step", [0.25, 7.0, 100.0])
def test_closest_approach_of_two_bodies_that_pass(validated: Validated, step: float) -> None:
    """A straight line at constant speed passes at its impact parameter, here 3 m, after 5 s."""
    i = drifting(2.0)
    assert (i["approach.distance"], i["approach.time"]) == (i["separation"], 0.0)
    i.step(step)
    if step < 5.0:
        assert (i["approach.distance"], i["approach.time"]) == (i["separation"], step)
    while i.time < 20.0:
        i.step(step)
    straight = closed_form("straight line at constant speed")
    validated(straight, "bodies that pass: closest approach", i["approach.distance"], 3.0, "m", abs=1e-5)
    validated(straight, "bodies that pass: its time", i["approach.time"], 5.0, "s", abs=1e-4)
    assert i["approach.distance"] != pytest.approx(3.001, abs=1e-5)


def test_closest_approach_is_kept_and_beaten() -> None:
    """Same bits whatever the macro step, also when the inputs change; least over all that is seen at short steps."""
    parameters = {"thrust.level": 0.05, "start.condition": 1}
    coarse, fine = (Instance(MODEL, LOCKED, parameters).initialise() for _ in range(2))
    seen = [fine["separation"]]
    for change in (0.0, 0.02, -0.3):
        coarse["thrust.offset"] = fine["thrust.offset"] = change
        coarse.step(900.0)
        for _ in range(900):
            fine.step(1.0)
            seen.append(fine["separation"])
        for name in ("approach.distance", "approach.time", "tether.impulse"):
            assert coarse[name] == fine[name]
        assert 0.0 <= min(seen) - fine["approach.distance"] < 1e-3
        assert abs(fine["approach.time"] - float(np.argmin(seen))) < 1.0
