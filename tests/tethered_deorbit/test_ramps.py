"""Inputs that move within a macro step, against closed forms: thrust, propellant, rest length, commanded length."""

import math
from typing import Any

import numpy as np
import pytest

from fmu_src.instance import Instance, ModelFault
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL, NO_LENGTH, VBAR
from orbital import oscillators
from orbital.constants import STANDARD_GRAVITY
from tests.validation import Validated, closed_form

LOCKED = {"reel": "locked", "thrust": "along_track"}
LINEAR = {"reel": "linear", "thrust": "along_track"}
MASS, REDUCED = 3000.0, 2000.0 / 3.0


def free(level: float = -1.0) -> Instance:
    """Two bodies on a line far too long to matter."""
    free_flight = {"start.condition": VBAR, "tether.rest_length": 1e3, "thrust.level": level}
    return Instance(MODEL, LOCKED, free_flight).initialise()


def hanging(terms: dict[str, str], length: float, **more: float) -> Instance:
    """A pair on the vertical, at rest in the turning frame, without thrust."""
    parameters = {"start.condition": HANDED_OVER, "thrust.level": 0.0}
    i = Instance(MODEL, terms, parameters | {k.replace("__", "."): v for k, v in more.items()})
    i.array("start_relative_position")[:] = length, 0.0, 0.0
    return i.initialise()


def outputs(i: Instance) -> dict[str, bytes]:
    return {v.field: i.record[v.field].tobytes() for v in i.interface.variables if v.causality == "output"}


def test_speed_gained_under_a_ramp() -> None:
    """(Integral of F)/M for the centre of mass; the force at either end of the step, held, must not do."""
    gained = {}
    for name, offset, rate in (("none", 1.0, 0.0), ("ramp", 0.0, 0.3), ("first", 0.0, 0.0), ("last", 3.0, 0.0)):
        i = free()
        i["thrust.offset"] = offset
        i.set_rates({"thrust.offset": rate})
        i.step(10.0)
        gained[name] = i.array("center_velocity").copy()
        if name == "ramp":
            assert i["thrust.offset"] == pytest.approx(3.0, rel=1e-15)
    # -1 N to 2 N in 10 s
    expected = (-1.0 + 2.0) / 2.0 * 10.0 / MASS
    way = gained["none"] / np.linalg.norm(gained["none"])
    assert (gained["ramp"] - gained["none"]) @ way == pytest.approx(expected, rel=1e-4)
    for wrong in ("first", "last"):
        assert (gained[wrong] - gained["none"]) @ way != pytest.approx(expected, rel=0.5)


@pytest.mark.parametrize(("level", "impulse"), [(-1.0, (1.0 + 4.0) / 0.6), (1.0, 25.0), (-4.0, 25.0)])
def test_propellant_of_a_ramp(validated: Validated, level: float, impulse: float) -> None:
    """Integral of |F|, also where the force turns round on the way; then as ever."""
    i = free(level)
    i.set_rates({"thrust.offset": 0.3})
    i.step(10.0)
    exhaust = 3000.0 * STANDARD_GRAVITY
    formula = closed_form("integral of |F| over v_e")
    validated(formula, "thrust on a ramp: propellant", i["chaser.propellant"], impulse / exhaust, "kg", rel=1e-13)
    assert i["chaser.propellant"] != pytest.approx(abs(level + 1.5) * 10.0 / exhaust * 1.01, rel=1e-3)
    i.step(7.0)
    assert i["chaser.propellant"] == pytest.approx((impulse + 7.0 * abs(level + 3.0)) / exhaust, rel=1e-13)


def settled() -> Instance:
    i = hanging(LOCKED, 12.0000066, tether__damping_ratio=0.3)
    i.step(60.0)
    assert i["tether.taut"]
    return i


def test_hauling_in_a_locked_line(validated: Validated) -> None:
    """The stretch is a damped vibration that begins with the speed of the rest length.

    m_r s'' + c s' + k s = P,   s = l - l0(t),   s'(0) = -dl0/dt,   T = k s + c s'
    """
    speed, zeta = 1e-3, 0.3
    stiffness = oscillators.line_stiffness(60e9, 1e-3, 12.0)
    frequency = oscillators.natural_frequency(stiffness, REDUCED)
    damped = frequency * math.sqrt(1.0 - zeta * zeta)

    def expected(t: float, way: float = 1.0) -> float:
        decay = way * speed * math.exp(-zeta * frequency * t)
        stretch = decay * math.sin(damped * t) / damped
        rate = decay * math.cos(damped * t) - zeta * frequency * stretch
        return rest + stiffness * stretch + 2.0 * zeta * math.sqrt(stiffness * REDUCED) * rate

    for t in (0.1, 0.3, 0.6, 0.9):
        i = settled()
        rest = i["tether.tension"]
        i.set_rates({"reel.length_offset": -speed})
        i.step(t)
        formula = closed_form("damped vibration that begins with the speed of the rest length")
        what = f"line that is hauled in: tension after {t:g} s"
        validated(formula, what, i["tether.tension"], expected(t), "N", rel=1e-3)
        assert i["tether.tension"] != pytest.approx(expected(t, -1.0), rel=1e-2)
        assert i["reel.length_offset"] == pytest.approx(-speed * t, rel=1e-15)
        assert i["tether.tug_count"] == 1


def test_a_ramp_is_the_limit_of_stairs() -> None:
    """Thrust and length in mid-value stairs come to the ramp with the square of their width."""
    rates = {"thrust.offset": -2e-3, "reel.length_offset": 1e-3}
    start = {"reel__proportional_gain": 0.02, "reel__derivative_gain": 4.0}

    def stairs(count: int, place: float) -> float:
        i = hanging(LINEAR, 12.3, **start)
        for k in range(count):
            for name, rate in rates.items():
                i[name] = rate * (k + place) * 240.0 / count
            i.step(240.0 / count)
        return i["tether.length"]

    i = hanging(LINEAR, 12.3, **start)
    i.set_rates(rates)
    i.step(240.0)
    errors = [stairs(n, 0.5) - i["tether.length"] for n in (8, 16)]
    assert errors[0] / errors[1] == pytest.approx(4.0, abs=0.4)
    assert abs(stairs(16, 0.0) - i["tether.length"]) > 10.0 * abs(errors[1])


def test_working_reel_follows_its_length_on_the_way() -> None:
    """Commanded length and feed-forward at the end of a step are those of that instant, and stay there."""
    i = hanging(LINEAR, 12.0)
    i["reel.length_offset"] = -0.5
    i.set_rates({"reel.length_offset": 0.01})
    i.step(20.0)
    n = float(i.record["state_mean_motion"][0])

    def law(offset: float) -> float:
        length = 12.0 + offset
        feed = 3.0 * n * n * REDUCED * length
        return feed + 4.155e-3 * (i["tether.length"] - length) + 2.366 * i["tether.length_rate"]

    assert i["tether.tension"] == pytest.approx(law(-0.3), rel=1e-12)
    assert i["tether.tension"] != pytest.approx(law(-0.5), rel=1e-3)
    i.refresh()
    assert i["tether.tension"] == pytest.approx(law(-0.3), rel=1e-12)
    i.step(1.0)
    assert i["tether.tension"] == pytest.approx(law(-0.3), rel=1e-12)


@pytest.mark.parametrize("rates", [{}, {"reel.length_offset": -1e-4, "thrust.offset": 1e-3}])
def test_a_ramp_does_not_see_what_ran_ahead(rates: dict[str, float]) -> None:
    """Whatever the macro steps before, and however far the trajectory had run past them, the ramp begins alike."""

    def run(steps: tuple[float, ...]) -> Instance:
        i = hanging(LOCKED, 12.00001)
        for step in steps:
            i.step(step)
        i.set_rates(rates)
        i.step(2.0)
        i.step(50.0)
        return i

    expected = outputs(run((20.0, 10.0, 0.5)))
    peak = "tether_tension_peak"  # of the last macro step alone
    assert {**outputs(run((30.5,))), peak: b""} == {**expected, peak: b""}
    assert outputs(run((30.5, 1e-3))) != expected


def test_two_ramps_make_one() -> None:
    def run(count: int, rate: float) -> Any:
        i = hanging(LOCKED, 12.00001)
        for _ in range(count):
            i.set_rates({"reel.length_offset": rate, "thrust.offset": 1e-3})
            i.step(8.0 / count)
        return i["tether.length"], i["tether.tug_count"], i["tug[1].peak"], i["reel.length_offset"]

    assert run(1, -1e-3) == pytest.approx(run(4, -1e-3), rel=1e-9)
    assert run(1, -1e-3) != pytest.approx(run(4, -1.01e-3), rel=1e-9)


def test_lines_that_would_vanish_on_the_way() -> None:
    i = hanging(LOCKED, 11.9)
    i.set_rates({"reel.length_offset": -1.3})
    with pytest.raises(ModelFault, match=r"not positive \(reel.length_offset, value -1"):
        i.step(10.0)
    assert i.record["fault_code"][0] == NO_LENGTH
    i = hanging(LOCKED, 11.9)
    i.set_rates({"reel.length_offset": 1.3})
    i.step(10.0)
    assert i["reel.length_offset"] == 13.0


def test_rates_are_for_one_step() -> None:
    i = free()
    i.set_rates({"thrust.offset": 0.3})
    i.step(10.0)
    i.step(10.0)
    assert i["thrust.offset"] == pytest.approx(3.0)
    with pytest.raises(ValueError, match="no input with a rate"):
        i.set_rates({"thrust.level": 0.3})
