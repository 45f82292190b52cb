"""A reel that gives the tension it is told: constant, on a ramp, through zero."""

import math

import pytest

from fmu_src.instance import Instance, ModelFault
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL

TERMS = {"reel": "commanded", "thrust": "along_track"}
REDUCED = 2000.0 / 3.0


def pair(tension: float = 0.0) -> Instance:
    """Two bodies on the vertical, at rest in the turning frame, without thrust."""
    i = Instance(MODEL, TERMS, {"start.condition": HANDED_OVER, "thrust.level": 0.0, "reel.tension": tension})
    i.array("start_relative_position")[:] = 12.0, 0.0, 0.0
    return i.initialise()


def test_nothing_asked_is_a_slack_line() -> None:
    i = pair()
    i.step(100.0)
    assert (i["tether.taut"], i["tether.tension"], i["tether.tug_count"]) == (0, 0.0, 0)
    assert i["tether.length"] > 12.0


def test_constant_tension() -> None:
    """l'' = -T/m_r beside the tide, which a line without command feels as well; T t^2 / (2 m_r) in the length."""
    pulled, loose = pair(0.5), pair()
    assert (pulled["tether.taut"], pulled["tether.tension"], pulled["tether.tug_count"]) == (1, 0.5, 1)
    for i in (pulled, loose):
        i.differentiate()
    change = pulled.rate("tether.length_rate") - loose.rate("tether.length_rate")
    assert change == pytest.approx(-0.5 / REDUCED, rel=1e-12)
    for i in (pulled, loose):
        i.step(20.0)
    shorter = loose["tether.length"] - pulled["tether.length"]
    assert shorter == pytest.approx(0.5 * 20.0**2 / (2.0 * REDUCED), rel=1e-3)
    assert shorter != pytest.approx(0.505 * 20.0**2 / (2.0 * REDUCED), rel=1e-3)
    assert pulled["tether.tension_peak"] == pulled["tug[1].peak"] == 0.5


def test_ramp_through_zero() -> None:
    """1 N down to -1 N in 10 s: the line pulls for 5 s, with an impulse of 2.5 N s, and never pushes."""
    i, loose = pair(1.0), pair()
    i.set_rates({"reel.tension": -0.2})
    i.step(10.0)
    loose.step(10.0)
    assert (i["tether.taut"], i["tether.tension"], i["reel.tension"]) == (0, 0.0, -1.0)
    gained = loose["tether.length_rate"] - i["tether.length_rate"]
    assert gained == pytest.approx(2.5 / REDUCED, rel=1e-4)
    assert gained != pytest.approx(2.525 / REDUCED, rel=1e-3)
    assert i["tether.tension_peak"] == 1.0


def test_ramp_out_of_zero() -> None:
    """The tug begins where the command crosses zero; from zero itself, at once."""
    i = pair(-1.0)
    i.step(3.0)
    i.set_rates({"reel.tension": 0.4})
    i.step(10.0)
    assert (i["tether.taut"], i["tether.tug_count"]) == (1, 1)
    assert i["tug[1].time"] == pytest.approx(5.5, abs=1e-9)
    assert i["tether.tension"] == i["tug[1].peak"] == pytest.approx(3.0, rel=1e-14)
    i = pair()
    i.set_rates({"reel.tension": 0.4})
    i.step(10.0)
    assert (i["tug[1].time"], i["tether.tug_count"]) == (0.0, 1)
    assert i["tether.tension"] == pytest.approx(4.0, rel=1e-14)


def test_a_changed_command_is_one_tug() -> None:
    i = pair(0.5)
    for command in (0.6, 0.2, 0.7):
        i["reel.tension"] = command
        i.refresh()
        assert i["tether.tension"] == command
        i.step(5.0)
    assert i["tether.tug_count"] == 1
    assert i["tug[1].peak"] == 0.7
    i["reel.tension"] = 0.0
    i.step(5.0)
    i["reel.tension"] = 0.1
    i.step(5.0)
    assert (i["tether.tug_count"], i["tug[1].time"], i["tug[1].peak"]) == (2, 20.0, 0.1)


def test_commands_that_are_none() -> None:
    i = pair(0.5)
    i["reel.tension"] = math.nan
    with pytest.raises(ModelFault, match=r"reel\.tension"):
        i.step(1.0)
    assert "reel.length_offset" not in i.interface.references
