"""A winch: its book of energy, its limits, its samples, and one run against an integration by scipy."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmu_src.instance import ModelFault
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL
from orbital.oscillators import dashpot, line_stiffness
from tests.plain import PlainInstance, plain
from tests.validation import Validated, closed_form

__all__ = ["plain"]

pytestmark = pytest.mark.usefixtures("plain")
FREE = {"environment": "none"}
MASS = 2000.0 / 3.0
SOFT = {"tether.youngs_modulus": 6e9, "tether.rest_length": 12.0}
EXTENSIONAL = line_stiffness(6e9, 1e-3, 1.0)


def apart(distance: float, speed: float = 0.0, across: float = 0.0) -> dict[str, Any]:
    """Handed over along axis 2, without a field."""
    return {
        "start.condition": HANDED_OVER,
        "start_relative_position": [0.0, distance, 0.0],
        "start_relative_velocity": [across, speed, 0.0],
    }


def winch(law: str, parameters: dict[str, Any], **terms: str) -> PlainInstance:
    return PlainInstance(MODEL, {"reel": law, **FREE, **terms}, parameters)


def schedule(*points: tuple[float, float]) -> dict[str, Any]:
    filled = [*points, *[points[-1]] * (16 - len(points))]
    return {"reel_schedule_time": [t for t, _ in filled], "reel_schedule_length": [s for _, s in filled]}


ZIGZAG = schedule((0.0, 12.0), (4.0, 11.9), (12.0, 12.4), (20.0, 11.9))
ROOMY = {"reel.rate_limit": 10.0, "reel.acceleration_limit": 10.0, "reel.force_limit": 1e6, "reel.power_limit": 1e6}
SWUNG = SOFT | ZIGZAG | ROOMY | apart(12.002, 0.03, 0.2) | {"reel.sample_time": 0.5}
"""Taut for a while, slack, and taut again, while the length goes to and fro."""


@pytest.mark.parametrize(("zeta", "closed"), [(0.0, 1e-8), (0.05, 1e-6)])
def test_book_of_energy(validated: Validated, zeta: float, closed: float) -> None:
    """What the motor gives is what pair and line gain and the dashpot takes, to 1e-8 of what went through it; with a
    dashpot, whose heat has no say in the size of the steps, to 1e-6."""
    i = winch("schedule", SWUNG | {"tether.damping_ratio": zeta})
    before, through, last, largest = i["energy.relative"], 0.0, 0.0, 0.0
    for _ in range(40):
        i.step(0.5)
        through += abs(i["reel.work"] - last)
        last, largest = i["reel.work"], max(largest, i["tether.tension_peak"])
    gained = i["energy.relative"] - before
    what = "winch on a line that tugs: work of its motor"
    book = closed_form("what pair and line gain, and the dashpot takes")
    validated(book, what, i["reel.work"], gained + i["tether.heat"], "J", abs=closed * through)
    assert (i["tether.heat"] > 1e-20) == (zeta > 0.0)
    assert abs(gained) > 1e-2 * through
    assert i["tether.tug_count"] >= 1


def test_a_line_winds_up_its_stretch() -> None:
    """Hauled in under a pull the line takes its stretch onto the drum: without T_e^2/(2 EA) the book is off by that."""
    i = winch("schedule", SWUNG | {"tether.damping_ratio": 0.0})
    before = i["energy.relative"]
    left, now = 0.0, 0.0
    for _ in range(200):
        i.step(0.01)
        then, now = now, 0.5 * i["tether.tension"] ** 2 / EXTENSIONAL * -i["reel.rate"]
        left += 0.005 * (then + now)
    without = i["reel.work"] - left
    assert abs(without - (i["energy.relative"] - before)) > 100.0 * 1e-8 * abs(i["reel.work"])
    assert without - (i["energy.relative"] - before) == pytest.approx(-left, rel=1e-2)


def test_work_is_tension_times_way() -> None:
    """The book is no tautology: the work is that of T + T_e^2/(2 EA) along what is wound, by the trapezoidal rule."""
    i = winch("schedule", SWUNG)
    total, step, now = 0.0, 0.02, 0.0
    for _ in range(500):
        i.step(step)
        stretch = i["tether.length"] - i["reel.paid_out"]
        elastic = EXTENSIONAL * stretch / i["reel.paid_out"]
        force = i["tether.tension"] + (elastic**2 / (2.0 * EXTENSIONAL) if i["tether.taut"] else 0.0)
        power = -force * i["reel.rate"]
        assert i["reel.power"] == pytest.approx(power, rel=1e-9, abs=1e-12)
        total += 0.5 * step * (now + power)
        now = power
    assert abs(total) > 0.1
    assert i["reel.work"] == pytest.approx(total, rel=2e-3)


LIMITS = {
    "reel.rate_limit": 0.08,
    "reel.acceleration_limit": 0.05,
    "reel.force_limit": 3.0,
    "reel.power_limit": 0.13,
    "reel.length_least": 11.7,
    "reel.length_most": 12.8,
}
WILD = schedule((0.0, 12.0), (2.0, 11.0), (6.0, 9.0), (9.0, 9.0), (30.0, 16.0), (45.0, 15.0))


def test_limits_hold_at_every_instant() -> None:
    """Asked for more than any limit allows, winch and line stay within all of them."""
    i = winch("schedule", SOFT | WILD | LIMITS | apart(12.003, 0.02, 0.1) | {"reel.sample_time": 0.5})
    reached = dict.fromkeys(LIMITS, 0.0)
    rate = 0.0
    for _ in range(900):
        i.step(0.05)
        seen = {
            "reel.rate_limit": abs(i["reel.rate"]) / 0.08,
            "reel.force_limit": i["tether.tension"] / 3.0 if i["reel.rate"] < 0.0 else 0.0,
            "reel.power_limit": abs(i["tether.tension"] * i["reel.rate"]) / 0.13,
            "reel.length_least": 11.7 / i["reel.paid_out"],
            "reel.length_most": i["reel.paid_out"] / 12.8,
            # it may stall, but not leap
            "reel.acceleration_limit": abs(i["reel.rate"] - rate) / 0.05 / 0.05 if i["reel.rate"] else 0.0,
        }
        rate = i["reel.rate"]
        for name, share in seen.items():
            assert share <= 1.0 + 1e-9, name
            reached[name] = max(reached[name], share)
    assert min(reached.values()) > 0.7, reached
    assert i["reel.limited"] > 10


def test_without_limits_nothing_is_cut() -> None:
    i = winch("schedule", SOFT | ZIGZAG | ROOMY | apart(11.5))
    i.step(30.0)
    assert i["reel.limited"] == 0
    assert i["reel.paid_out"] == pytest.approx(11.9, abs=1e-3)


def test_samples_are_on_the_instance_s_own_clock() -> None:
    """Macro steps of 0.7, 1, 6 and 60 s: the same bits."""
    start = SWUNG | {"reel.sample_time": 0.35}
    names = ("tether.tension", "reel.paid_out", "reel.work", "tether.heat", "separation", "tether.impulse")
    found = []
    for step in (0.7, 1.0, 6.0, 60.0):
        i = winch("schedule", start)
        count = round(42.0 / step) if step < 42.0 else 0
        for _ in range(count):
            i.step(step)
        i.step(60.0 - count * step)
        found.append([i[name] for name in names])
    assert found[1] == found[2] == found[3]
    # 0.7 s does not add up to 60 s in binary
    assert found[0] == pytest.approx(found[3], rel=1e-9)


def test_outputs_have_their_derivatives() -> None:
    i = winch("schedule", SWUNG)
    i.step(2.2)
    assert i["tether.taut"]
    i.differentiate()
    rates = {
        "reel.paid_out": i["reel.rate"],
        "reel.work": i["reel.power"],
        "reel.rate": i.rate("reel.rate"),
        "reel.power": i.rate("reel.power"),
        "tether.heat": i.rate("tether.heat"),
        "tether.tension": i.rate("tether.tension"),
        "energy.relative": i.rate("energy.relative"),
    }
    before = {name: i[name] for name in rates}
    h = 1e-3
    i.step(h)
    middle = {name: i[name] for name in rates}
    i.step(h)
    for name, rate in rates.items():
        # to second order, one-sided
        slope = (-3.0 * before[name] + 4.0 * middle[name] - i[name]) / (2.0 * h)
        assert rate == pytest.approx(slope, rel=1e-3, abs=1e-9), name


def test_against_an_independent_integration() -> None:
    """A constant tension, sampled: motion and control written out here and integrated by scipy between samples."""
    h, held, zeta = 0.25, 2.0, 0.05
    i = winch(
        "constant_tension",
        SOFT | apart(12.001, 0.02) | {"reel.held_tension": held, "reel.sample_time": h, "tether.damping_ratio": zeta},
    )

    def tension(x: Any) -> float:
        length, speed, rest, winding = x[:4]
        k = EXTENSIONAL / rest
        return float(k * (length - rest) + dashpot(zeta, k, MASS) * (speed - winding))

    x, added = np.array([12.001, 0.02, 12.0, 0.0, 0.0]), 0.0
    for _ in range(40):
        pull = max(0.0, tension(x))
        assert pull > 0.0, "taut throughout"
        error = pull - held
        added = min(max(added + error / 6.0, -held), held)
        wanted = x[1] + (error + added) / (EXTENSIONAL / x[2] * 3.0 * h + 2.0 * dashpot(zeta, EXTENSIONAL / x[2], MASS))
        speeding = min(max((wanted - x[3]) / h, -0.1), 0.1)

        def slope(_: float, y: Any, a: float = speeding) -> Any:
            force = tension(y)
            return [y[1], -force / MASS, y[3], a, force]

        x = solve_ivp(slope, (0.0, h), x, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
        i.step(h)
        assert i["tether.length"] == pytest.approx(x[0], abs=1e-9)
        assert i["reel.paid_out"] == pytest.approx(x[2], abs=1e-9)
        assert i["tether.tension"] == pytest.approx(tension(x), abs=1e-6)
    assert i["tether.impulse"] == pytest.approx(x[4], rel=1e-8)


@pytest.mark.parametrize(
    ("wrong", "blamed"),
    [
        ({"reel.length_least": 13.0, "reel.length_most": 12.5}, "reel.length_least"),
        ({"reel.length_least": 12.5}, "tether.rest_length"),
        ({"reel.sample_time": 0.0}, "reel.sample_time"),
        ({"reel.power_limit": -1.0}, "reel.power_limit"),
    ],
)
def test_refusals(wrong: dict[str, float], blamed: str) -> None:
    with pytest.raises(ModelFault, match=blamed.replace(".", r"\.")):
        winch("schedule", SOFT | ZIGZAG | apart(11.0) | wrong)


def test_a_pair_in_orbit_keeps_its_book() -> None:
    """The Jacobi integral changes by what the motor gives and the dashpot takes, to the gradient's next order."""
    start = {
        "start.condition": HANDED_OVER,
        "start_relative_position": [12.0 * math.cos(0.3), 12.0 * math.sin(0.3), 0.0],
        "reel.sample_time": 20.0,
        "tether.youngs_modulus": 6e7,
        "tether.rest_length": 12.0 - 0.007,
    }
    i = PlainInstance(MODEL, {"reel": "libration"}, start)
    before = i["energy.relative"]
    i.step(1500.0)
    gained = i["energy.relative"] - before
    assert i["reel.work"] == pytest.approx(gained + i["tether.heat"], rel=3e-6)
    assert abs(gained) > 1e-4


def test_a_stalled_motor_does_not_break_the_line() -> None:
    """The line breaks where its own strength is exceeded, and not where another part acts."""
    start = SOFT | WILD | LIMITS | apart(12.003, 0.02, 0.1) | {"reel.sample_time": 0.5, "break.flies_on": 1}
    for strength, breaks in ((100.0, False), (9.5, True)):
        i = winch("schedule", start | {"break.strength": strength}, **{"break": "breaks"})
        i.step(10.0)
        assert i["reel.limited"] > 3
        assert bool(i["break.broken"]) == breaks
        assert i["tug[1].peak"] <= strength * (1.0 + 1e-6)
