"""Engines: masses that fall, power that limits, a tank that empties. Judged by Newton for each body on its own."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmu_src.instance import ModelFault
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL
from orbital.constants import EARTH_MU, STANDARD_GRAVITY
from tests.plain import PlainInstance, plain
from tests.validation import Validated, closed_form, other_code

__all__ = ["plain"]
pytestmark = pytest.mark.usefixtures("plain")

CHASER, TARGET, FORCE, IMPULSE = 2000.0, 1000.0, 400.0, 300.0
EXHAUST = IMPULSE * STANDARD_GRAVITY
FLOW = FORCE / EXHAUST


def free(engine: str, **more: Any) -> PlainInstance:
    return PlainInstance(
        MODEL,
        {"reel": "commanded", "environment": "none", "thrust": "along_track", "engine": engine},
        {
            "start.condition": HANDED_OVER,
            "start_relative_position": (0.0, -50.0, 0.0),
            "thrust.level": FORCE,
            "engine.propellant": 1000.0,
            "thrust.specific_impulse": IMPULSE,
            **more,
        },
    )


def test_the_rocket_equation(validated: Validated) -> None:
    """A chaser that pulls nothing: v = v_e ln(m0/m). The target stays, and the centre of mass follows from both."""
    i = free("chemical")
    i.step(4000.0)
    left = CHASER - FLOW * 4000.0
    assert i["chaser.propellant"] == pytest.approx(FLOW * 4000.0, rel=1e-13)
    assert i["engine.propellant_left"] == pytest.approx(1000.0 - FLOW * 4000.0, rel=1e-12)
    speed = EXHAUST * math.log(CHASER / left)
    rocket = closed_form("v_e ln(m0/m), Tsiolkovsky")
    validated(rocket, "chaser that burns its propellant: speed", i["chaser.velocity[2]"], speed, "m/s", rel=1e-11)
    assert abs(i["target.velocity[2]"]) < 1e-9
    assert i["target.position[2]"] == pytest.approx(i.record[0].target_position[1])
    burnt = 4000.0
    travelled = EXHAUST * (burnt - left / FLOW * math.log(CHASER / left))
    assert i["chaser.position[2]"] - i["target.position[2]"] == pytest.approx(50.0 + travelled, rel=1e-10)
    share = left / (left + TARGET)
    center = i["target.position[2]"] + share * (50.0 + travelled)
    assert i["center.position[2]"] == pytest.approx(center, rel=1e-10)


def test_towed_on_an_orbit_as_newton_says_of_each(validated: Validated) -> None:
    """Two absolute bodies, their own masses, in scipy: a constant pull, thrust along-track, half the tank used."""
    tension, time = 100.0, 1500.0
    i = PlainInstance(
        MODEL,
        {"reel": "commanded", "thrust": "along_track", "engine": "chemical"},
        {
            "start.condition": HANDED_OVER,
            "start_relative_position": (0.0, 5000.0, 0.0),
            "reel.tension": tension,
            "thrust.level": -FORCE,
            "engine.propellant": 1000.0,
            "thrust.specific_impulse": IMPULSE,
            "orbit.inclination": 0.0,
        },
    )
    begin = np.concatenate(
        [np.array(i.array(n)) for n in ("chaser_position", "chaser_velocity", "target_position", "target_velocity")]
    )

    def motion(t: float, y: Any) -> Any:
        chaser, v, target, w = y[0:3], y[3:6], y[6:9], y[9:12]
        mass = CHASER - FLOW * t
        line = (target - chaser) / np.linalg.norm(target - chaser)
        along = np.cross(np.cross(chaser, v), chaser)
        thrust = -FORCE * along / np.linalg.norm(along)
        a = -EARTH_MU * chaser / np.linalg.norm(chaser) ** 3 + (tension * line + thrust) / mass
        b = -EARTH_MU * target / np.linalg.norm(target) ** 3 - tension * line / TARGET
        return np.concatenate([v, a, w, b])

    done = solve_ivp(motion, (0.0, time), begin, method="DOP853", rtol=1e-13, atol=1e-9)
    for _ in range(5):
        i.step(time / 5)
    source, places = other_code("scipy's DOP853, Newton's law for each body"), []
    for name, at in (("chaser_position", 0), ("target_position", 6)):
        places.append(float(np.linalg.norm(i.array(name) - done.y[at : at + 3, -1])))
    validated(source, "tow by a chaser that grows lighter: place after 25 min", places, 0.0, "m", abs=1e-3)
    for name, at in (("chaser_velocity", 3), ("target_velocity", 9)):
        assert np.linalg.norm(i.array(name) - done.y[at : at + 3, -1]) < 1e-6
    i.differentiate()
    slope = motion(time, done.y[:, -1])
    for n in range(3):
        assert i.rate(f"chaser.velocity[{n + 1}]") == pytest.approx(slope[3 + n], abs=1e-8)


def test_a_tank_that_empties() -> None:
    i = free("chemical", **{"engine.propellant": 50.0})
    i.step(1000.0)
    assert i["thrust.force"] == 0.0
    assert i["chaser.propellant"] == pytest.approx(50.0, rel=1e-9)
    assert i["engine.propellant_left"] == pytest.approx(0.0, abs=1e-7)
    assert i["chaser.velocity[2]"] == pytest.approx(EXHAUST * math.log(CHASER / (CHASER - 50.0)), rel=1e-9)


def test_power_limits_the_thrust() -> None:
    """|F| = 2 eta P/(Isp g0): 500 W at 60 % and 3000 s are 20.4 mN."""
    ion = {"thrust.specific_impulse": 3000.0, "engine.power_limit": 500.0, "engine.efficiency": 0.6}
    i = free("electric", **ion, **{"thrust.level": -1.0})
    i.step(100.0)
    most = 2.0 * 0.6 * 500.0 / (3000.0 * STANDARD_GRAVITY)
    assert most == pytest.approx(0.0204, rel=2e-3)
    assert (i["thrust.force"], i["engine.limited"]) == (pytest.approx(-most, rel=1e-14), 1)
    assert i["engine.power"] == pytest.approx(500.0, rel=1e-14)
    i = free("electric", **ion, **{"thrust.level": -0.01})
    i.step(100.0)
    assert (i["thrust.force"], i["engine.limited"]) == (-0.01, 0)
    assert i["engine.power"] == pytest.approx(0.01 * 3000.0 * STANDARD_GRAVITY / 1.2, rel=1e-14)


def test_power_limits_no_thrust_that_is_not_asked_for() -> None:
    """Not with an empty tank, nor between two burns; in one it does."""
    ion = {"thrust.specific_impulse": 3000.0, "engine.power_limit": 500.0, "engine.efficiency": 0.6}
    i = free("electric", **ion, **{"thrust.level": -1.0, "engine.propellant": 5e-5})
    i.step(10.0)
    assert (i["thrust.force"] < 0.0, i["engine.limited"]) == (True, 1)
    i.step(100.0)
    assert (i["thrust.force"], i["engine.limited"]) == (0.0, 0)
    burns = {"burn.start": 10.0, "burn.duration": 20.0, "burn.edge": 1, "burn.rise": 4.0}
    terms = {"reel": "commanded", "environment": "none", "thrust": "along_track", "engine": "electric", "burn": "timed"}
    start = {"start.condition": HANDED_OVER, "start_relative_position": (0.0, -50.0, 0.0), "thrust.level": -1.0}
    i = PlainInstance(MODEL, terms, start | ion | burns)
    seen = []
    for _ in range(5):
        i.step(8.0)
        seen.append((i["thrust.force"] < 0.0, i["engine.limited"]))
    assert seen == [(False, 0), (True, 1), (True, 1), (True, 1), (False, 0)]


def test_rates_of_what_an_engine_shows() -> None:
    """Against differences, while the thrust asked for moves, forward and back."""
    values = {"engine.power_limit": 1e7, "thrust.specific_impulse": 3000.0}
    for level in (2.0, -2.0):
        i = free("electric", **{**values, "thrust.level": level})
        i.set_rates({"thrust.offset": 0.1})
        i.step(10.0)
        i.differentiate()
        names = ("engine.power", "engine.propellant_left", "thrust.force")
        before, slopes = [i[name] for name in names], [i.rate(name) for name in names]
        i.set_rates({"thrust.offset": 0.1})
        i.step(1e-2)
        for name, value, slope in zip(names, before, slopes, strict=True):
            assert (i[name] - value) / 1e-2 == pytest.approx(slope, rel=1e-2), name
        assert slopes[0] * level > 0.0
        assert slopes[1] < 0.0


def turning(**more: Any) -> PlainInstance:
    """A chaser of 800 kg m2 about every axis, 72 of them in the tank, whose thruster stands 0.1 m beside its centre."""
    return PlainInstance(
        MODEL,
        {"reel": "commanded", "environment": "none", "thrust": "along_track", "engine": "chemical", "chaser": "rigid"},
        {
            "start.condition": HANDED_OVER,
            "start_relative_position": (0.0, -50.0, 0.0),
            "thrust.level": FORCE,
            "engine.propellant": 200.0,
            "engine.tank_radius": 0.6,
            "thrust.specific_impulse": IMPULSE,
            "chaser_inertia": (800.0, 800.0, 800.0, 0.0, 0.0, 0.0),
            "chaser_thruster": (0.001, 0.0, 0.0),
            **more,
        },
    )


def test_the_inertia_falls_as_the_tank_empties() -> None:
    """About one axis, in scipy: angle'' = F p cos(angle)/(I - m' t k^2)."""
    i = turning()
    time = 300.0
    i.step(time)

    def turned(t: float, y: Any) -> Any:
        return y[1], FORCE * 1e-3 * math.cos(y[0]) / (800.0 - FLOW * t * 0.36)

    found = solve_ivp(turned, (0.0, time), (0.0, 0.0), rtol=1e-11, atol=1e-13).y[:, -1]
    assert i["chaser.rate[3]"] == pytest.approx(found[1], rel=1e-8)
    assert 2.0 * math.atan2(i["chaser.attitude[4]"], i["chaser.attitude[1]"]) == pytest.approx(found[0], rel=1e-8)
    whole = turning(**{"engine.tank_radius": 0.0})
    whole.step(time)
    assert i["chaser.rate[3]"] > 1.004 * whole["chaser.rate[3]"]


def test_an_empty_chaser_is_a_body() -> None:
    with pytest.raises(ModelFault, match="inertia"):
        turning(**{"engine.tank_radius": 2.1})


@pytest.mark.parametrize("turns", [False, True])
def test_rates_of_what_masses_move(turns: bool) -> None:
    """Against central differences, on an orbit, where propellant is a hundredth of the pair in a minute."""
    terms = {"reel": "commanded", "thrust": "along_track", "engine": "chemical"}
    terms |= {"chaser": "rigid"} if turns else {}
    more: dict[str, Any] = {"chaser_inertia": (2e5, 2.2e5, 1.9e5, 0.0, 0.0, 0.0), "engine.tank_radius": 10.0,
                            "chaser_start_rate": (0.2, -0.1, 0.5)} if turns else {}  # fmt: skip
    i = PlainInstance(
        MODEL,
        terms,
        {
            "thrust.level": 2000.0,
            "thrust.specific_impulse": 100.0,
            "engine.propellant": 900.0,
            "start.condition": HANDED_OVER,
            "start_relative_position": (-300.0, 100.0, 50.0),
            **more,
        },
    )
    names = ["energy.orbital", "energy.relative", "altitude", "center.semi_major_axis"]
    names += ["chaser.spin_energy", "chaser.spin[1]", "chaser.spin[3]"] if turns else []
    h = 2e-3
    i.step(20.0 - h)
    before, place = [i[name] for name in names], i.array("center_position").copy()
    i.step(h)
    i.differentiate()
    slopes = [i.rate(name) for name in names]
    values = [i[name] for name in names]
    told = [i.rate(f"center.position[{k}]") for k in (1, 2, 3)]
    aside = max(abs(rate - speed) for rate, speed in zip(told, i.array("center_velocity"), strict=True))
    assert aside > 0.05  # m/s: what leaves the pair leaves it at one end
    i.step(h)
    assert (i.array("center_position") - place) / (2.0 * h) == pytest.approx(told, rel=0.0, abs=1e-5)
    for name, first, value, slope in zip(names, before, values, slopes, strict=True):
        noise = 1e-14 * abs(value) / h
        assert (i[name] - first) / (2.0 * h) == pytest.approx(slope, rel=1e-6, abs=noise + 1e-9), name


def test_a_tank_is_part_of_the_chaser() -> None:
    with pytest.raises(ModelFault, match="out of its bounds"):
        free("chemical", **{"engine.propellant": CHASER})


def test_nothing_is_left_of_an_earlier_run() -> None:
    i = free("chemical", **{"engine.propellant": 50.0})
    i.step(1000.0)
    i.initialise()
    assert (i["chaser.propellant"], i["thrust.force"], i["engine.propellant_left"]) == (0.0, FORCE, 50.0)
    i.step(100.0)
    assert i["chaser.velocity[2]"] == pytest.approx(EXHAUST * math.log(CHASER / (CHASER - FLOW * 100.0)), rel=1e-11)
