"""A tow from event to event: tugs and vibrations in closed form are those that are followed, in far fewer steps."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmu_src.instance import Instance
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL
from fmu_src.tethered_deorbit.levels import vibration
from fmu_src.tethered_deorbit.model import make_entry
from orbital.oscillators import (
    damped_snap_peak,
    line_stiffness,
    reduced_mass,
    snap_duration,
    snap_peak,
    snap_restitution,
)
from tests.plain import PlainInstance, plain
from tests.validation import Validated, closed_form, other_code

__all__ = ["plain"]

TERMS = {"reel": "locked", "thrust": "along_track"}
MAPPED = TERMS | {"level": "event_map"}
TABLE_2 = {"thrust.level": -0.01, "start.separation": 10.0}
STIFFNESS = line_stiffness(60e9, 1e-3, 12.0)
REDUCED = reduced_mass(2000.0, 1000.0)
MODES = ("free", "followed", "mapped", "dumbbell")


def tow(terms: Mapping[str, str], **parameters: float) -> Instance:
    return Instance(MODEL, terms, TABLE_2 | {k.replace("__", "."): v for k, v in parameters.items()}).initialise()


def tugs(i: Instance, until: float, step: float = 60.0) -> np.ndarray:
    """Time, peak and speed of every tug up to a time [s]."""
    found: dict[int, tuple[float, ...]] = {}
    while i.time < until:
        i.step(min(step, until - i.time))
        count = int(i["tether.tug_count"])
        for place in range(1, min(count, 16) + 1):
            found[count - place + 1] = tuple(i[f"tug[{place}].{x}"] for x in ("time", "peak", "speed"))
    return np.array([found[number] for number in sorted(found)])


def spent(i: Instance) -> dict[str, float]:
    return {mode: i[f"level.{mode}"] for mode in MODES}


def test_a_day_is_that_which_is_followed() -> None:
    followed, mapped = tow(TERMS), tow(MAPPED)
    beside, own = tugs(followed, 86400.0), tugs(mapped, 86400.0)
    assert own.shape == beside.shape == (38, 3)
    assert np.abs(own[:, 0] - beside[:, 0]).max() < 1e-4
    assert np.abs(own[:-2, 1] / beside[:-2, 1] - 1.0).max() < 1e-6
    assert np.abs(own[:, 1] - beside[:, 1]).max() < 1e-6
    assert 40 * mapped["solver.steps"] < followed["solver.steps"]
    for name, within in (("tether.impulse", 2e-5), ("tether.tension", 1e-8), ("tether.angle", 1e-6),
                         ("separation", 1e-10), ("center.semi_major_axis", 1e-5)):  # fmt: skip
        assert mapped[name] == pytest.approx(followed[name], abs=within), name
    times = spent(mapped)
    assert sum(times.values()) == pytest.approx(86400.0, abs=1e-6)
    assert times["followed"] == 0.0
    assert 150.0 < times["mapped"] < 250.0
    assert mapped["level.now"] == 3
    assert mapped["level.settled"]
    # within two time constants of the vibration per decade, from 0.6 N to 4e-8 N
    assert own[-1, 0] < mapped["level.settled_since"] < own[-1, 0] + 400.0
    assert mapped["level.error"] < 2e-5


def test_the_same_bits_whatever_the_macro_step() -> None:
    one, many = tow(MAPPED), tow(MAPPED)
    one.step(7000.0)
    tugs(many, 7000.0, 3.5)
    for name in ("tether.tension", "tether.impulse", "tether.angle", "separation", "solver.steps", "tug[1].peak"):
        assert one[name] == many[name], name
    assert spent(one) == pytest.approx(spent(many), abs=1e-9)


def test_within_a_tug() -> None:
    """Tension, its impulse and its range inside a tug are those of one that is followed."""
    instances = tow(TERMS, tether__damping_ratio=0.01), tow(MAPPED, tether__damping_ratio=0.01)
    rows = []
    for i in instances:
        i.step(1119.0)
        seen = []
        for _ in range(10):
            i.step(0.2)
            seen.append([i[name] for name in ("tether.tension", "tether.tension_peak", "tether.tension_least",
                                              "tether.impulse", "tether.length_rate", "energy.relative")])  # fmt: skip
        rows.append(np.array(seen))
    assert rows[0][:, 0].max() > 3.0
    assert np.abs(rows[0] - rows[1]).max(axis=0) == pytest.approx(0.0, abs=2e-7)


def test_energy_of_undamped_tugs(validated: Validated) -> None:
    """750 tugs in ten days without thrust: the Jacobi integral stays within 1e-5 of itself, 1e-8 a tug."""
    i = tow(MAPPED, tether__damping_ratio=0.0, thrust__level=0.0, start__condition=2)
    begin = i["energy.relative"]
    i.step(864000.0)
    assert i["tether.tug_count"] > 500
    what = "event to event, ten days of undamped tugs: integral of the relative motion"
    validated(closed_form("the Jacobi integral stays"), what, i["energy.relative"], begin, "J", rel=1e-5)


def test_a_changed_thrust_begins_anew() -> None:
    """In the middle of a tug, and at rest."""
    ends = []
    for terms in (TERMS, MAPPED):
        i = tow(terms)
        i.step(1119.5)
        i["thrust.offset"] = -0.5
        i.step(3000.0)
        i["thrust.offset"] = -0.1
        i.step(20000.0)
        ends.append([i[name] for name in ("tether.tension", "tether.impulse", "separation", "tether.tug_count")])
    assert np.abs(np.subtract(*ends)) == pytest.approx(0.0, abs=2e-5)
    assert sum(spent(i).values()) == pytest.approx(24119.5, abs=1e-6)


def test_where_the_bound_is_exceeded_it_is_followed() -> None:
    """A bound of zero lets nothing be mapped: the first tugs to the last bit; a soft line is followed by itself."""
    followed, asked = tow(TERMS), tow(MAPPED, level__peak_error=0.0)
    for i in (followed, asked):
        i.step(4000.0)
    names = [f"tug[{k}].{x}" for k in (1, 2, 3) for x in ("time", "peak")]
    assert [asked[name] for name in names] == [followed[name] for name in names]
    assert spent(asked)["mapped"] == 0.0
    soft = tow(MAPPED, tether__youngs_modulus=1e6)
    soft.step(20000.0)
    assert spent(soft)["followed"] > 0.0 == spent(soft)["mapped"]


@pytest.mark.parametrize(
    ("more", "said"),
    [({"target": "rigid"}, "target = 'rigid'"), ({"break": "breaks"}, "cannot go together with break"),
     ({"chaser": "rigid"}, "chaser = 'rigid'"), ({"reel": "commanded"}, "no line settles")],
)  # fmt: skip
def test_what_it_cannot_carry_is_refused(more: Mapping[str, str], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        make_entry(MAPPED | more)


@pytest.mark.usefixtures("plain")
@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.3, 0.6])
def test_a_snap_without_a_field(validated: Validated, zeta: float) -> None:
    """Peak, duration and restitution of one tug, against their closed forms; nothing else acts on it."""
    speed = 2e-3
    i = PlainInstance(
        MODEL,
        {"reel": "locked", "environment": "none", "level": "event_map"},
        {"start.condition": HANDED_OVER, "start_relative_position": (0.0, 11.9999, 0.0),
         "start_relative_velocity": (0.0, speed, 0.0), "tether.damping_ratio": zeta},
    )  # fmt: skip
    i.step(3.0)
    peak = snap_peak(speed, STIFFNESS, REDUCED) if zeta == 0.0 else damped_snap_peak(speed, STIFFNESS, REDUCED, zeta)
    formula, what = closed_form("one damped half swing"), "event to event, a snap without a field"
    back = snap_restitution(zeta)
    validated(formula, f"{what}: peak", i["tug[1].peak"], peak, "N", rel=1e-8)
    validated(formula, f"{what}: duration", i["level.mapped"], snap_duration(STIFFNESS, REDUCED, zeta), "s", rel=1e-8)
    validated(formula, f"{what}: speed after it", i["tether.length_rate"], -speed * back, "m/s", rel=1e-8)
    validated(formula, f"{what}: impulse", i["tether.impulse"], REDUCED * speed * (1.0 + back), "N.s", rel=1e-8)


@pytest.mark.usefixtures("plain")
def test_a_pair_that_whirls_is_followed() -> None:
    """At 0.03 rad/s its bound is 1.2e-3, of turning and of what holds it: followed with less allowed, else mapped."""
    peaks = []
    for allowed in (1e-3, 2e-3):
        i = PlainInstance(
            MODEL,
            {"reel": "locked", "environment": "none", "level": "event_map"},
            {"start.condition": HANDED_OVER, "start_relative_position": (0.0, 11.999, 0.0),
             "start_relative_velocity": (0.36, 0.05, 0.0), "level.peak_error": allowed},
        )  # fmt: skip
        i.step(2.0)
        peaks.append(i["tug[1].peak"])
        assert (i["level.mapped"] > 0.0) == (allowed == 2e-3)
    assert i["level.error"] == pytest.approx(4.0 * 2.0 * 0.03**2 * REDUCED / STIFFNESS, rel=0.02)
    assert peaks[1] == pytest.approx(peaks[0], rel=1e-3 * i["level.error"])


def test_a_hard_push_across_the_line_is_followed() -> None:
    i = tow(MAPPED, thrust__level=-1e4)
    i.step(300.0)
    assert i["tether.tug_count"] > 1
    assert i["level.mapped"] == 0.0 < i["level.followed"]


def test_a_free_vibration(validated: Validated) -> None:
    """Against its equation, and its integral."""
    mass, damping, stiffness, begin = 667.0, 160.0, 3900.0, (-3e-6, 2e-3)
    found = solve_ivp(
        lambda t, y: (y[1], -(damping * y[1] + stiffness * y[0]) / mass, y[0]),
        (0.0, 7.0), (*begin, 0.0), rtol=1e-12, atol=1e-16,
    ).y[:, -1]  # fmt: skip
    own = vibration.vibration_at.py_func(*begin, mass, damping, stiffness, 7.0)
    scipy, what = other_code("scipy RK45"), "event to event, a line's vibration after 7 s"
    validated(scipy, f"{what}: stretch", own[0], found[0], "m", rel=1e-8)
    validated(scipy, f"{what}: its rate", own[1], found[1], "m/s", rel=1e-8)
    swept = vibration.swept.py_func(*begin, *own, mass, damping, stiffness)
    validated(scipy, f"{what}: integral of the stretch", swept, found[2], "m.s", rel=1e-8)
    assert math.isclose(vibration.vibration_at.py_func(0.0, 0.0, mass, 9e9, stiffness, 1.0)[0], 0.0)
