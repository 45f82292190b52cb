"""Flattening and air: energy and angular momentum, the drift of the node, the decay of an orbit."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fmu_src.instance import Instance
from fmu_src.tethered_deorbit.environment.perturbed import make_perturbing
from fmu_src.tethered_deorbit.interface import MODEL
from fmu_src.tethered_deorbit.model import make_entry
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU, EARTH_ROTATION_RATE, SUN_MEAN_MOTION
from orbital.sunsync import node_rate
from tests.validation import Validated, closed_form

TERMS = {
    "reel": "locked",
    "thrust": "along_track",
    "level": "settled",
    "oblateness": "J2",
    "air": "exponential",
}
DAY = 86400.0


def tow(area: float = 0.0, **parameters: float) -> Instance:
    told = {"thrust.level": 0.0, "start.separation": 10.0, "air.chaser_area": area, "air.target_area": area}
    return Instance(MODEL, TERMS, told | {k.replace("__", "."): v for k, v in parameters.items()}).initialise()


def momentum(i: Instance) -> Any:
    return np.cross(i.array("center_position"), i.array("center_velocity"))


def test_flattening_keeps_energy_and_polar_momentum(validated: Validated) -> None:
    i = tow(orbit__inclination=1.0)
    before, turned = i["energy.orbital"], momentum(i)
    kepler = -EARTH_MU * 3000.0 / (2.0 * i["center.semi_major_axis"])
    assert abs(before - kepler) > 1e-4 * abs(kepler)
    i.step(0.5 * DAY)
    kept, axis = closed_form("conservation of energy"), closed_form("a field about an axis has no torque along it")
    validated(kept, "orbit with J2: energy after half a day", i["energy.orbital"], before, "J", rel=1e-12)
    validated(axis, "orbit with J2: polar momentum after half a day", momentum(i)[2], turned[2], "m2/s", rel=1e-12)
    assert np.linalg.norm(momentum(i) - turned) > 1e-3 * np.linalg.norm(turned)


def test_a_sun_synchronous_node_follows_the_sun(validated: Validated) -> None:
    """98.603 deg at 800 km: to first order in J2, which leaves a thousandth."""
    i = tow(orbit__inclination=math.radians(98.603))
    nodes, axes = [], []
    for _ in range(288):
        i.step(300.0)
        x, y, _ = momentum(i)
        nodes.append(math.atan2(x, -y))
        axes.append(i["center.semi_major_axis"])
    drift = np.polyfit(300.0 * np.arange(288), np.unwrap(nodes), 1)[0]
    expected = node_rate(float(np.mean(axes)), math.radians(98.603))
    validated(
        closed_form("-3/2 n J2 (R/a)^2 cos i"), "orbit with J2: drift of the node", drift, expected, "rad/s", rel=2e-3
    )
    assert drift == pytest.approx(SUN_MEAN_MOTION, rel=8e-3)


def test_an_orbit_decays_by_drag(validated: Validated) -> None:
    """Beside the same tow without drag: da/dt = -(2 a^2 v/mu) rho c_d A u^2/(2 M), u = v - w r over the equator, along
    the undisturbed orbit, which the flattening lets breathe by kilometres."""
    told = {"orbit__altitude": 400e3, "orbit__inclination": 0.0}
    dragged, free = tow(10.0, **told), tow(0.0, **told)
    fall = still = 0.0
    for _ in range(360):
        for i in (dragged, free):
            i.step(60.0)
        axis, radius = free["center.semi_major_axis"], EARTH_EQUATORIAL_RADIUS + free["altitude"]
        speed = float(np.linalg.norm(free.array("center_velocity")))
        density = 3.725e-12 * math.exp(-(free["altitude"] - 400e3) / 58515.0)
        slope = 2.0 * axis**2 * speed / EARTH_MU * 0.5 * density * 2.2 * 20.0 / 3000.0 * 60.0
        fall += slope * (speed - EARTH_ROTATION_RATE * radius) ** 2
        still += slope * speed**2
    found = free["center.semi_major_axis"] - dragged["center.semi_major_axis"]
    formula = closed_form("int (2 a^2 v/mu) rho c_d A u^2/(2 M) dt")
    validated(formula, "fall of the axis by drag at 400 km in 6 h", found, fall, "m", rel=5e-3)
    assert found != pytest.approx(still, rel=5e-2)
    for body in ("chaser", "target"):
        height = dragged[f"{body}.radius"] - EARTH_EQUATORIAL_RADIUS
        wind = dragged.array(f"{body}_velocity") - np.cross(
            [0.0, 0.0, EARTH_ROTATION_RATE], dragged.array(f"{body}_position")
        )
        force = 0.5 * 3.725e-12 * math.exp(-(height - 400e3) / 58515.0) * 2.2 * 10.0 * (wind @ wind)
        assert dragged[f"air.{body}_drag"] == pytest.approx(force, rel=1e-9)


def test_rate_of_the_energy() -> None:
    i = tow(10.0, orbit__altitude=300e3)
    i.step(5000.0)
    i.differentiate()
    before, told = i["energy.orbital"], i.rate("energy.orbital")
    i.step(60.0)
    i.differentiate()
    change = (i["energy.orbital"] - before) / 60.0
    assert change == pytest.approx(0.5 * (told + i.rate("energy.orbital")), rel=1e-3)
    assert told < 0.0


def test_axes_change_nothing() -> None:
    """In axes that have turned the Earth's axis has turned the other way: the rates are those at rest, turned along."""
    state = np.array([5e6, -4e6, 3e6, 5e3, 5e3, -1e3, 7.0, -3.0, 9.0, 0.01, 0.02, -0.005])
    record = MODEL.interface(TERMS).make_record()
    record["state_total_mass"] = 3000.0
    record["state_chaser_share"], record["state_target_share"] = 2.0 / 3.0, 1.0 / 3.0
    add, found = make_perturbing(MODEL.interface(TERMS)).add, []
    for turning, elapsed in ((np.zeros(3), 0.0), (np.array([2e-3, -3e-3, 1e-3]), 40.0)):
        record["state_turning"][0] = turning
        back = Rotation.from_rotvec(turning * elapsed)
        there, rate = back.inv().apply(state.reshape(-1, 3)).ravel(), np.zeros(12)
        add(record, there, rate, elapsed, elapsed)
        found.append(back.apply(rate.reshape(-1, 3)).ravel())
    assert found[0][9:] == pytest.approx(found[1][9:], rel=1e-9)
    assert found[0][3:6] == pytest.approx(found[1][3:6], rel=1e-12)
    assert np.linalg.norm(found[0][3:6]) > 1e-3


@pytest.mark.parametrize("term", ["oblateness", "air"])
def test_without_an_orbit_nothing_disturbs_it(term: str) -> None:
    with pytest.raises(ValueError, match=f"{term} = .* needs an orbit"):
        make_entry({"reel": "locked", "environment": "none", term: TERMS[term]})
