"""A line that slips against the friction of its drum: closed forms, its book of energy, sticking, and its end."""

import math

import pytest

from fmu_src.instance import ModelFault
from fmu_src.tethered_deorbit.interface import MODEL
from orbital.oscillators import line_stiffness, natural_frequency
from tests.plain import PlainInstance, plain
from tests.tethered_deorbit.test_winch import FREE, MASS, apart

__all__ = ["plain"]

pytestmark = pytest.mark.usefixtures("plain")
LINE = {"tether.youngs_modulus": 60e9, "tether.rest_length": 12.0, "tether.damping_ratio": 0.0}
STIFFNESS = line_stiffness(60e9, 1e-3, 12.0)
SPEED, FRICTION = 0.2, 20.0


def brake(zeta: float = 0.0, **changed: float) -> PlainInstance:
    """A pair that flies apart at 0.2 m/s, its line just taut."""
    values = LINE | apart(12.0, SPEED) | {"tether.damping_ratio": zeta, "reel.brake_force": FRICTION}
    return PlainInstance(MODEL, {"reel": "brake", **FREE}, values | {f"reel.{k}": v for k, v in changed.items()})


def test_a_pair_that_flies_apart_is_stopped() -> None:
    """s = m_r v^2/(2 F) of a stiff line; exactly (m_r v^2/2 - F^2 L/(2 EA))/(F + F^2/EA), with the stretch of it."""
    i = brake()
    while i["tether.length_rate"] > 0.0:
        i.step(0.05)
    slipped = i["reel.paid_out"] - 12.0
    simple = MASS * SPEED**2 / (2.0 * FRICTION)
    stretched = FRICTION**2 / (2.0 * STIFFNESS)
    strain = FRICTION / (12.0 * STIFFNESS)
    assert slipped == pytest.approx((0.5 * MASS * SPEED**2 - stretched) / (FRICTION * (1.0 + strain)), rel=1e-8)
    assert slipped == pytest.approx(simple, rel=1e-2)
    assert i["reel.heat"] == pytest.approx(FRICTION * (1.0 + 0.5 * strain) * slipped, rel=1e-8)
    assert i["tug[1].peak"] == pytest.approx(FRICTION, rel=1e-8)


def test_time_to_stop() -> None:
    """A quarter of the line's swing up to F, then at F/m_r: t = asin(F/sqrt(k m) v)/w + m_r v'/F with v' left."""
    i = brake()
    frequency = natural_frequency(STIFFNESS, MASS)
    share = FRICTION / (STIFFNESS * SPEED / frequency)
    left = SPEED * math.sqrt(1.0 - share**2)
    stopped = math.asin(share) / frequency + MASS * left / FRICTION
    i.step(stopped - 0.01)
    assert i["reel.rate"] > 0.0
    assert i["tether.tension"] == FRICTION
    assert i["tether.length_rate"] == pytest.approx(FRICTION / MASS * 0.01, rel=1e-3)
    i.step(0.02)
    assert i["reel.rate"] == 0.0
    assert i["tether.tension"] < FRICTION


@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.5])
def test_book_of_energy(zeta: float) -> None:
    """All that the pair loses is in brake and dashpot."""
    i = brake(zeta)
    before = i["energy.relative"]
    i.step(20.0)
    lost = before - i["energy.relative"]
    assert lost > 0.5 * before
    assert i["reel.heat"] + i["tether.heat"] == pytest.approx(lost, abs=(1e-8 if zeta == 0.0 else 1e-6) * before)
    assert i["tether.tension_peak"] <= FRICTION * (1.0 + 1e-8)


@pytest.mark.parametrize("zeta", [0.0, 0.05])
def test_below_the_friction_it_is_a_locked_line(zeta: float) -> None:
    """The same bits as far as nothing slips."""
    i = brake(zeta, brake_force=1e4)
    values = LINE | apart(12.0, SPEED) | {"tether.damping_ratio": zeta}
    locked = PlainInstance(MODEL, {"reel": "locked", **FREE}, values)
    for _ in range(10):
        i.step(0.3)
        locked.step(0.3)
        assert i["tether.tension"] == pytest.approx(locked["tether.tension"], rel=1e-9, abs=1e-9)
    assert i["reel.heat"] == 0.0


def test_at_its_end_the_line_is_held() -> None:
    """With 0.2 m left the friction takes F 0.2 m; the rest is a snap of a line that is fast."""
    i = brake(length_most=12.2)
    i.step(3.0)
    assert i["reel.paid_out"] == pytest.approx(12.2, abs=1e-6)
    k = line_stiffness(60e9, 1e-3, 12.2)
    left = 0.5 * MASS * SPEED**2 - FRICTION * 0.2 - 0.5 * FRICTION**2 / STIFFNESS
    # it begins stretched by F
    peak = math.sqrt(FRICTION**2 + 2.0 * k * left)
    assert i["tug[1].peak"] == pytest.approx(peak, rel=1e-3)
    assert peak > 10.0 * FRICTION


def test_friction_by_an_input() -> None:
    """More friction while it slips lets it stick; less lets it slip again."""
    i = brake()
    i.step(1.0)
    assert i["tether.tension"] == FRICTION
    i.differentiate()
    assert i.partial("tether.tension", "reel.brake_offset") == 1.0
    i["reel.brake_offset"] = -5.0
    i.step(1.0)
    assert i["tether.tension"] == FRICTION - 5.0
    i["reel.brake_offset"] = -FRICTION - 1.0
    i.step(1.0)
    speed = i["tether.length_rate"]
    i.step(1.0)
    assert i["tether.tension_peak"] <= 1e-6
    assert i["tether.length_rate"] == pytest.approx(speed, rel=1e-6)


@pytest.mark.parametrize("zeta", [0.0, 0.05])
def test_outputs_have_their_derivatives(zeta: float) -> None:
    i = brake(zeta)
    i.step(1.0)
    assert i["reel.rate"] > 0.0
    i.differentiate()
    names = ("reel.paid_out", "reel.rate", "reel.heat", "tether.heat", "energy.relative", "tether.tension")
    rates = {name: i.rate(name) for name in names}
    before = {name: i[name] for name in names}
    h = 1e-4
    i.step(h)
    middle = {name: i[name] for name in names}
    i.step(h)
    for name, rate in rates.items():
        slope = (-3.0 * before[name] + 4.0 * middle[name] - i[name]) / (2.0 * h)
        assert rate == pytest.approx(slope, rel=1e-4, abs=1e-7), name


def test_refusals() -> None:
    with pytest.raises(ModelFault, match=r"tether\.rest_length"):
        brake(length_most=11.0)
    with pytest.raises(ModelFault, match=r"reel\.brake_force"):
        brake(brake_force=0.0)
