"""Two bodies without a field, by every scheme: the thrust pulse of one period, lines damped hard, what is conserved."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmu_src.instance import Instance, ModelFault
from fmu_src.tethered_deorbit.interface import EQUAL_VELOCITY, HANDED_OVER, MODEL, SAME_ORBIT, VBAR
from orbital.oscillators import dashpot, line_stiffness, natural_frequency, reduced_mass
from tests.plain import PlainInstance, plain
from tests.validation import Validated, closed_form, other_code

__all__ = ["plain"]

uncompiled = pytest.mark.usefixtures("plain")
SCHEMES = ("dop853", "gauss", "radau")
each = pytest.mark.parametrize("scheme", SCHEMES)
COARSE = {"radau": {"solver.tolerance_separation": 3e-8, "solver.tolerance_stretch": 3e-8}}
"""A scheme of order 5 need not be asked for the last digit: plain Python is slow."""

FORCE, CHASER, TARGET = 2009.0, 2500.0, 1500.0
PAIR = {"chaser.mass": CHASER, "target.mass": TARGET, "thrust.level": -FORCE}
LINE = {"tether.rest_length": 1000.0, "tether.diameter": 5e-3, "tether.damping_ratio": 0.0, "start.separation": 1000.0}
STIFFNESS = line_stiffness(60e9, 5e-3, 1000.0)
FREQUENCY = natural_frequency(STIFFNESS, reduced_mass(CHASER, TARGET))
PERIOD = math.tau / FREQUENCY
STEADY = FORCE * TARGET / (CHASER + TARGET)
"""Tension of the line that tows without a vibration [N]."""
FREQUENCY_OF_12 = natural_frequency(line_stiffness(60e9, 1e-3, 12.0), reduced_mass(2000.0, 1000.0))
LEFT = 1.433722
"""Relative speed that a pulse of half a period leaves, 2 F/(m_c omega) [m/s]."""


def free(scheme: str, parameters: dict[str, Any], thrust: str = "tether", reel: str = "locked") -> PlainInstance:
    terms = {"reel": reel, "thrust": thrust, "environment": "none", "solver": scheme}
    return PlainInstance(MODEL, terms, COARSE.get(scheme, {}) | parameters)


def pulse(scheme: str, periods: float, force: float = FORCE) -> Instance:
    """The chaser pulls away from a line that is just taut, for so many periods of it; then the thrust is off."""
    i = free(scheme, PAIR | LINE | {"thrust.level": -force})
    i.step(periods * PERIOD)
    i["thrust.offset"] = force
    return i


@each
@uncompiled
def test_a_pulse_of_one_period_leaves_no_vibration(validated: Validated, scheme: str) -> None:
    """Peak twice the steady load; nothing left of it afterwards; a pulse 1 % longer leaves 3 %."""
    validated(closed_form("E pi d^2/(4 l)"), "line of 1000 m, 5 mm, 60 GPa: EA/L", STIFFNESS, 1178.097, "N/m", abs=1e-3)
    i, twice = pulse(scheme, 1.0), closed_form("2 F m_t/(m_c + m_t)")
    what = "pulse of one line period, 2009 N: peak, twice the steady load"
    validated(twice, what, i["tug[1].peak"], 2.0 * STEADY, "N", rel=1e-6)
    assert i["tug[1].peak"] != pytest.approx(2.02 * STEADY, rel=1e-6)
    i.step(0.3 * PERIOD)
    nothing = closed_form("no vibration is left")
    what = "pulse of one line period: relative speed left"
    validated(nothing, what, i["tether.length_rate"], 0.0, "m/s", abs=1e-6 * LEFT)
    what = "pulse of one line period: tension afterwards"
    validated(nothing, what, i["tether.tension_peak"], 0.0, "N", abs=1e-6 * STEADY)
    longer = pulse(scheme, 1.01)
    longer.step(0.3 * PERIOD)
    assert abs(longer["tether.length_rate"]) > 0.01 * LEFT


@each
@uncompiled
def test_a_pulse_of_half_a_period_leaves_most(validated: Validated, scheme: str) -> None:
    """The line is let go where it pulls hardest, twice the steady load: the bodies close at 2 F/(m_c omega)."""
    assert pytest.approx(LEFT, rel=1e-6) == 2.0 * FORCE / (CHASER * FREQUENCY)
    i, twice = pulse(scheme, 0.5), closed_form("2 F m_t/(m_c + m_t)")
    validated(twice, "pulse of half a period: tension at its end", i["tether.tension"], 2.0 * STEADY, "N", rel=1e-6)
    i.step(0.3 * PERIOD)
    assert not i["tether.taut"]
    what, left = "pulse of half a period: relative speed left, the most", -i["tether.length_rate"]
    validated(closed_form("2 F/(m_c omega)"), what, left, LEFT, "m/s", rel=1e-6)
    assert -i["tether.length_rate"] != pytest.approx(1.00001 * LEFT, rel=1e-6)


@each
@uncompiled
def test_momentum_and_centre_of_mass(validated: Validated, scheme: str) -> None:
    """M V = F t and R = F t^2/(2 M), whatever the line does; the chaser pulls against axis 2."""
    i = free(scheme, PAIR | LINE)
    time = 1.3 * PERIOD
    i.step(time)
    momentum = CHASER * i.array("chaser_velocity") + TARGET * i.array("target_velocity")
    mass = CHASER + TARGET
    assert not momentum[[0, 2]].any()
    what = "tow without a field: momentum after 1.3 periods"
    validated(closed_form("F t"), what, momentum[1], -FORCE * time, "N s", rel=1e-12)
    assert mass * i.array("center_velocity") == pytest.approx(momentum, rel=1e-13)
    center = i.array("center_position")
    assert not center[[0, 2]].any()
    what = "tow without a field: way of the centre of mass"
    validated(closed_form("F t^2/(2 M)"), what, center[1], -0.5 * FORCE / mass * time**2, "m", rel=1e-12)
    assert i["tether.impulse"] == pytest.approx(TARGET * i["target.velocity[2]"] * -1.0, rel=1e-9)
    assert i["chaser.velocity[2]"] != pytest.approx(i["target.velocity[2]"], rel=1e-2)


STIFF = {"tether.youngs_modulus": 1e12, "tether.rest_length": 1.0, "tether.diameter": 1e-3}


def rates(stiffness: float, zeta: float) -> tuple[float, float]:
    """Both rates of decay of an overdamped line of Table 2's pair [1/s]."""
    omega = natural_frequency(stiffness, reduced_mass(2000.0, 1000.0))
    root = math.sqrt(zeta * zeta - 1.0)
    return omega * (zeta - root), omega * (zeta + root)


@pytest.mark.parametrize("zeta", [2.0, 10.0])
@each
@uncompiled
def test_overdamped_snap(validated: Validated, scheme: str, zeta: float) -> None:
    """x = v (e^-pt - e^-qt)/(q - p): the peak is c v at once, and it lets go where x'' = 0, at 2 ln(q/p)/(q - p)."""
    speed, stiffness = 0.1, line_stiffness(1e12, 1e-3, 1.0)
    start = {"start_relative_position": [0.0, 0.999, 0.0], "start_relative_velocity": [0.0, speed, 0.0]}
    line = STIFF | {"tether.damping_ratio": zeta, "thrust.level": 0.0, "start.condition": HANDED_OVER}
    i = free(scheme, line | start | {"solver.tolerance_stretch": 1e-11, "solver.tolerance_separation": 1e-10})
    slow, fast = rates(stiffness, zeta)
    lasting = 2.0 * math.log(fast / slow) / (fast - slow)
    i.step(0.01 + 0.5 * lasting)
    assert i["tether.taut"]
    assert i["tug[1].time"] == pytest.approx(0.01, abs=1e-9)
    damping = dashpot(zeta, stiffness, reduced_mass(2000.0, 1000.0))
    validated(closed_form("c v"), "overdamped snap: peak", i["tug[1].peak"], damping * speed, "N", rel=1e-6)
    assert i["tug[1].peak"] != pytest.approx(1.001 * damping * speed, rel=1e-6)
    i.step(lasting)
    assert not i["tether.taut"]
    left = speed * (fast * math.exp(-fast * lasting) - slow * math.exp(-slow * lasting)) / (fast - slow)
    formula = closed_form("v (q e^-qt - p e^-pt)/(q - p) at t = 2 ln(q/p)/(q - p)")
    validated(formula, "overdamped snap: speed after", i["tether.length_rate"], left, "m/s", rel=1e-5)
    assert i["tether.length_rate"] != pytest.approx(1.001 * left, rel=1e-5)


def pulled(scheme: str, time: float, zeta: float = 10.0, force: float = 10.0) -> Instance:
    """A stiff line, just taut and damped hard, from the moment at which the chaser begins to pull."""
    start = {"start.condition": EQUAL_VELOCITY, "start.separation": 1.0, "thrust.level": -force}
    i = free(scheme, STIFF | start | {"tether.damping_ratio": zeta, "solver.tolerance_stretch": 1e-11})
    i.step(time)
    return i


@each
@uncompiled
def test_overdamped_line_is_drawn_tight(validated: Validated, scheme: str) -> None:
    """k x = T_s (1 - (q e^-pt - p e^-qt)/(q - p)) of a line that was just taut."""
    stiffness, time = line_stiffness(1e12, 1e-3, 1.0), 0.4
    i = pulled(scheme, time)
    slow, fast = rates(stiffness, 10.0)
    steady = 10.0 / 3.0
    grown = 1.0 - (fast * math.exp(-slow * time) - slow * math.exp(-fast * time)) / (fast - slow)
    assert 0.3 < grown < 0.7
    formula = closed_form("T_s (1 - (q e^-pt - p e^-qt)/(q - p))")
    elastic = stiffness * (i["tether.length"] - 1.0)
    validated(formula, "overdamped line drawn tight: elastic tension", elastic, steady * grown, "N", rel=1e-4)
    assert stiffness * (i["tether.length"] - 1.0) != pytest.approx(1.01 * steady * grown, rel=1e-4)


@uncompiled
def test_what_is_stiff_costs_radau_nothing() -> None:
    """An hour of towing on that line in hundreds of steps; an explicit one takes as many for two seconds."""
    i = pulled("radau", 3600.0)
    assert i["tether.tension"] == pytest.approx(10.0 / 3.0, rel=1e-5)
    assert i["solver.steps"] < 500
    assert pulled("dop853", 2.0)["solver.steps"] > 450


@uncompiled
def test_spinning_pair() -> None:
    """Two bodies that whirl about each other on a line that swings: energy and angular momentum stay."""
    spin = {"start_relative_position": [12.0005, 0.0, 0.0], "start_relative_velocity": [0.0, 0.6, 0.1]}
    i = free("gauss", spin | {"start.condition": HANDED_OVER, "thrust.level": 0.0, "tether.damping_ratio": 0.0})
    assert i["tether.taut"]

    def moment() -> Any:
        return np.cross(i.array("relative_position"), i.array("relative_velocity"))

    energy, begin = i["energy.relative"], moment()
    kinetic = 0.5 * reduced_mass(2000.0, 1000.0) * 0.37
    assert energy == pytest.approx(kinetic + 0.5 * line_stiffness(60e9, 1e-3, 12.0) * 0.0005**2, rel=1e-9)
    i.step(20.0)
    assert i["tether.angle"] == pytest.approx(math.atan2(*i.array("relative_position")[1::-1]))
    assert i["tether.angle"] > 0.9
    assert i["energy.relative"] == pytest.approx(energy, rel=1e-12)
    assert moment() == pytest.approx(begin, rel=1e-11)
    damped = free("gauss", spin | {"start.condition": HANDED_OVER, "thrust.level": 0.0, "tether.damping_ratio": 0.05})
    damped.step(20.0)
    assert damped["energy.relative"] != pytest.approx(energy, rel=1e-7)


@uncompiled
def test_axes_turn_by_a_quarter_of_a_radian_at_most() -> None:
    """A pair that whirls steadily has nothing that holds a step of radau down, but that the axes turn with it."""
    stretch = 0.0025 * 12.0 / (FREQUENCY_OF_12**2 - 0.0025)
    whirl = {"start_relative_position": [12.0 + stretch, 0.0, 0.0], "start_relative_velocity": [0.0, 0.6, 0.0]}
    whirl["start_relative_velocity"][1] += 0.05 * stretch
    i = free("radau", whirl | {"start.condition": HANDED_OVER, "thrust.level": 0.0, "tether.damping_ratio": 1.0})
    i.step(400.0)
    assert i["separation"] == pytest.approx(12.0 + stretch, abs=1e-9)
    assert math.remainder(i["tether.angle"] - 20.0, math.tau) == pytest.approx(0.0, abs=1e-9)
    assert 20.0 / 0.25 < i["solver.steps"] < 160


@uncompiled
def test_frame_and_outputs() -> None:
    """Axes at rest: what is handed over is what is seen. Of an orbit nothing is there, and nothing is not a number."""
    given = {
        "start_center_position": [3.0, -1.0, 2.0],
        "start_center_velocity": [0.1, 0.2, -0.3],
        "start_relative_position": [1.0, 2.0, 3.0],
        "start_relative_velocity": [0.01, -0.02, 0.03],
    }
    i = free("dop853", given | {"start.condition": HANDED_OVER, "thrust.level": 3.0}, thrust="along_track")
    for what in ("center", "relative"):
        for of in ("position", "velocity"):
            assert i.array(f"{what}_{of}") == pytest.approx(given[f"start_{what}_{of}"], rel=1e-15)
    absent = {"altitude", "center.semi_major_axis", "chaser.radius", "target.radius", "energy.orbital"}
    names = set(i.interface.references)
    assert not absent & names
    assert not [name for name in names if name.startswith("orbit.")]
    assert absent < set(MODEL.interface({"reel": "locked"}).references)
    i.step(10.0)
    assert i.array("relative_velocity") == pytest.approx([0.01, -0.02 - 10.0 * 3.0 / 2000.0, 0.03], rel=1e-12)
    assert i.array("center_velocity") == pytest.approx([0.1, 0.2 + 10.0 * 3.0 / 3000.0, -0.3], rel=1e-12)
    i.differentiate()
    for name in names:
        assert math.isfinite(i[name]), name
    assert all(
        math.isfinite(i.rate(v.element_names()[0])) for v in i.interface.variables if v.causality == "output" and v.rate
    )
    resting = free("dop853", {"start.condition": EQUAL_VELOCITY, "thrust.level": 3.0}, thrust="velocity")
    resting.step(10.0)
    assert not resting.array("center_velocity").any(), "a body at rest has no direction along its velocity"


@uncompiled
def test_derivatives() -> None:
    """Rates of the outputs against differences, on a taut line."""
    spin = {"start_relative_position": [12.0005, 0.3, 0.0], "start_relative_velocity": [0.0, 0.6, 0.1]}
    i = free("dop853", spin | {"start.condition": HANDED_OVER, "thrust.level": 0.3}, thrust="along_track")
    h, names = (
        1e-3,
        ("tether.angle", "energy.relative", "relative.position[1]", "relative.velocity[2]", "tether.tension"),
    )
    told, seen = {}, []
    for k in range(5):
        seen.append([i[name] for name in names])
        if k == 2:
            i.differentiate()
            told = {name: i.rate(name) for name in names}
        i.step(h)
    for name, (a, b, _, c, d) in zip(names, zip(*seen, strict=True), strict=True):
        assert told[name] == pytest.approx((a - 8.0 * b + 8.0 * c - d) / (12.0 * h), rel=1e-6), name
        assert told[name] != pytest.approx(1.001 * (a - 8.0 * b + 8.0 * c - d) / (12.0 * h), rel=1e-6), name


@pytest.mark.parametrize("condition", [SAME_ORBIT, VBAR])
@uncompiled
def test_no_start_on_an_orbit(condition: int) -> None:
    with pytest.raises(ModelFault, match=r"start\.condition needs an orbit"):
        free("dop853", {"start.condition": condition})
    assert free("dop853", {})["separation"] == 10.0


@pytest.mark.parametrize(("reel", "settles"), [("linear", 0.0), ("commanded", 0.5)])
@uncompiled
def test_controlled_reels(reel: str, settles: float) -> None:
    """Without a tide there is no feed-forward: at the commanded length a reel at rest pulls with nothing."""
    own: dict[str, Any] = {"reel.length": 10.0} if reel == "linear" else {"reel.tension": 0.5}
    i = free("dop853", own | {"start.condition": EQUAL_VELOCITY, "thrust.level": 0.0}, reel=reel)
    assert i["tether.tension"] == settles
    i.step(20.0)
    assert i["separation"] == pytest.approx(10.0 - 0.5 * settles / reduced_mass(2000.0, 1000.0) * 400.0, rel=1e-12)


@each
@uncompiled
def test_a_command_that_moves(scheme: str) -> None:
    """Tension from -0.2 N at 0.1 N/s: taut after two seconds; J = 0.05 t^2 from there, and they close by J/m_r."""
    i = free(scheme, {"start.condition": EQUAL_VELOCITY, "thrust.level": 0.0, "reel.tension": -0.2}, reel="commanded")
    i.set_rates({"reel.tension": 0.1})
    i.step(5.0)
    assert i["tug[1].time"] == pytest.approx(2.0, rel=1e-12)
    assert i["tether.impulse"] == pytest.approx(0.45, rel=1e-10)
    assert -i["tether.length_rate"] == pytest.approx(0.45 / reduced_mass(2000.0, 1000.0), rel=1e-9)
    assert i["tether.impulse"] != pytest.approx(0.4501, rel=1e-10)


@pytest.mark.evidence
def test_compiled(request: pytest.FixtureRequest) -> None:
    """The FMU's own code, without a field and with an implicit scheme, gives what plain Python gives."""

    def tow(make: Callable[..., Instance]) -> Any:
        terms = {"reel": "locked", "thrust": "tether", "environment": "none", "solver": "radau"}
        i = make(MODEL, terms, PAIR | LINE | COARSE["radau"] | {"tether.damping_ratio": 0.4})
        if make is Instance:
            i.initialise()
        i.step(0.4 * PERIOD)
        return np.array([i["tether.tension"], i["tug[1].peak"], i["tether.impulse"], i["solver.steps"]])

    compiled = tow(Instance)
    request.getfixturevalue("plain")
    assert compiled == pytest.approx(tow(PlainInstance), rel=1e-11)


@uncompiled
def test_a_thrust_along_an_axis_stays_there_while_the_line_turns(validated: Validated) -> None:
    """A light target swings on the line of a heavy chaser that speeds up along axis 2: an elastic pendulum."""
    gravity, mass, length, axial = 0.1, 1.0, 12.0, 20.0
    stiffness = axial / length
    values = {"chaser.mass": 1e5, "target.mass": mass, "thrust.level": 1e5 * gravity, "tether.damping_ratio": 0.0}
    values |= {"tether.youngs_modulus": axial / (0.25e-6 * math.pi), "start.condition": HANDED_OVER}
    start = (1.2 * length * math.sin(0.5), -1.2 * length * math.cos(0.5), 0.0)
    i = free("dop853", values | {"start_relative_position": start}, thrust="along_track")

    def swing(_: float, s: Any) -> Any:
        distance = math.hypot(s[0], s[1])
        pull = max(0.0, stiffness * (distance - length)) / distance * (1.0 / mass + 1e-5)
        return s[2], s[3], -pull * s[0], -gravity - pull * s[1]

    i.step(15.0)
    assert i["tether.tug_count"] > 0
    peer = solve_ivp(swing, (0.0, 15.0), (*start[:2], 0.0, 0.0), "DOP853", rtol=1e-12, atol=1e-12).y[:2, -1]
    found = [i["relative.position[1]"], i["relative.position[2]"]]
    what = "elastic pendulum in a thrust along an axis: place after 15 s"
    validated(other_code("scipy's DOP853"), what, found, peer, "m", abs=1e-7)
