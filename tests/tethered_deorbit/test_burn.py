"""Burns at times of their own and on arcs of the orbit: what they spend, when, and how they shake the line."""

import math
from typing import Any

import pytest
from scipy.integrate import quad

from fmu_src.instance import ModelFault
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU, STANDARD_GRAVITY
from tests.plain import PlainInstance, plain

__all__ = ["plain"]
pytestmark = pytest.mark.usefixtures("plain")

CHASER, TARGET, LENGTH, FORCE = 2500.0, 1500.0, 1000.0, 2009.0
STIFFNESS = 60e9 * math.pi * 5e-3**2 / 4.0 / LENGTH
REDUCED = CHASER * TARGET / (CHASER + TARGET)
OMEGA = math.sqrt(STIFFNESS / REDUCED)
PERIOD = math.tau / OMEGA
STEADY = FORCE * TARGET / (CHASER + TARGET)
"""Tension of the line when nothing vibrates."""
FLOW = FORCE / (3000.0 * STANDARD_GRAVITY)
EDGES = {"step": 0, "ramp": 1, "notch": 2}


def tug(**more: Any) -> PlainInstance:
    """A tug on a kilometre of undamped line that is just taut, without a field."""
    return PlainInstance(
        MODEL,
        {"reel": "locked", "environment": "none", "thrust": "along_track", "burn": "timed"},
        {
            "start.condition": HANDED_OVER,
            "start_relative_position": (0.0, -LENGTH, 0.0),
            "chaser.mass": CHASER,
            "target.mass": TARGET,
            "tether.rest_length": LENGTH,
            "tether.diameter": 5e-3,
            "tether.damping_ratio": 0.0,
            "thrust.level": FORCE,
            **more,
        },
    )


def vibration(i: PlainInstance, load: float) -> float:
    """Speed with which the line vibrates about where a load stretches it [m/s]."""
    stretch = i["tether.length"] - LENGTH - load / STIFFNESS
    return math.hypot(i["tether.length_rate"], OMEGA * stretch)


def test_a_pulse_of_one_period_leaves_no_vibration() -> None:
    """No duration given: that of the pair on its line. The peak is twice the steady load."""
    i = tug()
    i.step(1.5 * PERIOD)
    assert abs(i["tether.length_rate"]) < 1e-9
    assert i["tug[1].peak"] == pytest.approx(2.0 * STEADY, rel=1e-9)
    assert i["chaser.propellant"] == pytest.approx(FLOW * PERIOD, rel=1e-12)


def test_half_a_period_leaves_the_most() -> None:
    i = tug(**{"burn.duration": 0.5 * PERIOD})
    i.step(2.0 * PERIOD)
    assert abs(i["tether.length_rate"]) == pytest.approx(2.0 * FORCE / (CHASER * OMEGA), rel=1e-9)


@pytest.mark.parametrize(
    ("edge", "rise", "left"),
    [
        ("step", 1.0, FORCE / (CHASER * OMEGA)),
        ("ramp", PERIOD, 0.0),
        # a ramp of half a period leaves sinc(pi/2) of what a step does
        ("ramp", 0.5 * PERIOD, FORCE / (CHASER * OMEGA) * 2.0 / math.pi),
        ("notch", 1.0, 0.0),
    ],
)
def test_how_the_thrust_comes_decides_what_vibrates(edge: str, rise: float, left: float) -> None:
    i = tug(**{"burn.duration": 1e3, "burn.edge": EDGES[edge], "burn.rise": rise})
    i.step(40.0)
    assert i["thrust.force"] == FORCE
    assert vibration(i, STEADY) == pytest.approx(left, abs=1e-8 * FORCE / (CHASER * OMEGA))


@pytest.mark.parametrize("edge", EDGES)
@pytest.mark.parametrize("duration", [10.0, 40.0])
def test_a_burn_spends_its_duration_whatever_its_edges(edge: str, duration: float) -> None:
    """Also where a ramp is let go before it has come; a notch is at 1 within 1.5e-4 by then, and never pushes back."""
    i = tug(**{"burn.start": 3.0, "burn.duration": duration, "burn.edge": EDGES[edge], "burn.rise": 20.0})
    for _ in range(9):
        i.step(10.0)
    assert i["thrust.force"] == 0.0
    within = 1e-6 if (edge, duration) == ("notch", 10.0) else 1e-9
    assert i["chaser.propellant"] == pytest.approx(FLOW * duration, rel=within)


def test_thrust_never_turns_round_by_an_edge() -> None:
    """A notched pulse of one radian: what its filter asks for would be negative."""
    i = tug(**{"burn.duration": 1.0 / OMEGA, "burn.edge": EDGES["notch"]})
    least = 0.0
    for _ in range(60):
        i.step(0.1)
        least = min(least, i["thrust.force"])
    assert least == 0.0


def test_the_shape_of_a_notched_burn() -> None:
    i = tug(**{"burn.duration": 1e3, "burn.edge": EDGES["notch"]})
    i.step(1.0 / OMEGA)
    assert i["thrust.force"] == pytest.approx(FORCE * (1.0 - 2.0 / math.e), rel=1e-12)
    spent, _ = quad(lambda x: (1.0 - 2.0 * x * math.exp(-x)) / OMEGA, 0.0, 1.0)
    assert i["chaser.propellant"] == pytest.approx(FLOW * spent, rel=1e-10)
    i.differentiate()
    # d/dx (1 - 2 x exp(-x)) is zero at x = 1
    assert i.rate("thrust.force") == pytest.approx(0.0, abs=1e-9 * FORCE)
    i.step(0.5 / OMEGA)
    i.differentiate()
    assert i.rate("thrust.force") == pytest.approx(FORCE * OMEGA * math.exp(-1.5), rel=1e-12)


def test_pulse_after_pulse() -> None:
    values = {"burn.start": 5.0, "burn.duration": 2.0, "burn.interval": 10.0, "burn.count": 3}
    whole, pieces = tug(**values), tug(**values)
    whole.step(100.0)
    burning = []
    for n in range(200):
        pieces.step(0.5)
        if pieces["thrust.force"]:
            burning.append(0.5 * (n + 1))
    assert whole["chaser.propellant"] == pytest.approx(FLOW * 6.0, rel=1e-12)
    assert burning == [5.0, 5.5, 6.0, 6.5, 15.0, 15.5, 16.0, 16.5, 25.0, 25.5, 26.0, 26.5]
    for name in ("chaser.propellant", "tether.length", "tether.length_rate", "tether.tug_count"):
        assert whole[name] == pieces[name]


def test_a_moving_input_moves_what_burns() -> None:
    """The level rises by 1 N/s while a pulse of 2 s burns: its impulse is the integral."""
    i = tug(**{"thrust.level": 10.0, "burn.start": 1.0, "burn.duration": 2.0})
    i.set_rates({"thrust.offset": 1.0})
    i.step(5.0)
    assert i["chaser.propellant"] == pytest.approx((10.0 * 2.0 + 4.0) / (3000.0 * STANDARD_GRAVITY), rel=1e-12)


@pytest.mark.parametrize(
    "values",
    [
        {"burn.duration": 10.0, "burn.interval": 10.0},
        {"burn.duration": 10.0, "burn.interval": 11.0, "burn.edge": EDGES["ramp"], "burn.rise": 1.0},
    ],
)
def test_burns_that_overlap_are_refused(values: dict[str, Any]) -> None:
    with pytest.raises(ModelFault, match="out of its bounds"):
        tug(**values)
    tug(**values, **{"burn.count": 1})


def test_a_reel_without_stiffness_has_no_period() -> None:
    terms = {"reel": "commanded", "environment": "none", "thrust": "along_track", "burn": "timed"}
    start = {"start.condition": HANDED_OVER, "start_relative_position": (0.0, 10.0, 0.0)}
    with pytest.raises(ModelFault, match="out of its bounds"):
        PlainInstance(MODEL, terms, start)
    PlainInstance(MODEL, terms, {**start, "burn.duration": 1.0})
    with pytest.raises(ModelFault, match="out of its bounds"):
        PlainInstance(MODEL, terms, {**start, "burn.duration": 1.0, "burn.edge": EDGES["notch"]})


RADIUS = EARTH_EQUATORIAL_RADIUS + 800e3
TURN = math.tau * math.sqrt(RADIUS**3 / EARTH_MU)


def on_arcs(**more: Any) -> PlainInstance:
    """Two bodies on a circle, their line slack or taut, with thrust too small to change it."""
    terms = {"reel": "commanded", "thrust": "along_track", "burn": "arcs"}
    values = {"start.condition": 1, "thrust.level": 1e-6, "burn.half_width": math.radians(20.0), **more}
    return PlainInstance(MODEL, terms, values)


@pytest.mark.parametrize(
    ("about", "first", "share"),
    [("perigee", 340.0, 40.0), ("apogee", 160.0, 40.0), ("both", 160.0, 80.0)],
)
@pytest.mark.parametrize("tension", [0.0, 1e-3])
def test_arcs(about: str, first: float, share: float, tension: float) -> None:
    """From 90 degrees past the perigee on: the arc is burnt from its begin to its end, once in a turn."""
    names = ("perigee", "apogee", "both")
    i = on_arcs(**{"burn.about": names.index(about), "orbit.true_anomaly": 0.5 * math.pi, "reel.tension": tension})
    seen = []
    for n in range(72):
        i.step(TURN / 72.0)
        seen.append((90.0 + 5.0 * (n + 1), bool(i["thrust.force"])))
        if seen[-1][1] and len(seen) > 1 and not seen[-2][1]:
            begun = seen[-1][0] % 360.0
            assert any(0.0 <= begun - edge <= 5.0 for edge in (first, 340.0))
    flow = 1e-6 / (3000.0 * STANDARD_GRAVITY)
    assert i["chaser.propellant"] == pytest.approx(flow * TURN * share / 360.0, rel=1e-6)
    assert 5 * sum(on for _, on in seen) == pytest.approx(share, abs=10.0)


def test_arcs_while_a_line_is_taut() -> None:
    """A pair that hangs on a soft line: the axes of its steps turn with it, and the arcs stay where they are."""
    i = PlainInstance(
        MODEL,
        {"reel": "locked", "thrust": "along_track", "burn": "arcs"},
        {
            "start.condition": HANDED_OVER,
            "start_relative_position": (12.03, 0.0, 0.0),
            "tether.rest_length": 12.0,
            "tether.youngs_modulus": 1.2e7,
            "orbit.true_anomaly": 0.5 * math.pi,
            "thrust.level": 1e-6,
            "burn.half_width": math.radians(20.0),
        },
    )
    turned = 0.0
    for _ in range(12):
        i.step(TURN / 12.0)
        turned = max(turned, abs(i.record[0].state_turning[2]) * i.record[0].state_step)
    assert i["tether.taut"]
    assert turned > 0.0
    flow = 1e-6 / (3000.0 * STANDARD_GRAVITY)
    assert i["chaser.propellant"] == pytest.approx(flow * TURN * 40.0 / 360.0, rel=1e-5)


def test_arcs_do_not_depend_on_macro_steps() -> None:
    whole, pieces = on_arcs(), on_arcs()
    whole.step(TURN)
    for _ in range(25):
        pieces.step(TURN / 25.0)
    assert whole["chaser.propellant"] == pytest.approx(pieces["chaser.propellant"], rel=1e-12)


def test_without_an_orbit_there_are_no_arcs() -> None:
    terms = {"reel": "commanded", "environment": "none", "thrust": "along_track", "burn": "arcs"}
    with pytest.raises(ModelFault, match="needs an orbit"):
        PlainInstance(MODEL, terms, {"start.condition": HANDED_OVER, "start_relative_position": (0.0, 10.0, 0.0)})
