"""The Earth's field against SGP4, an independent analytical theory, where that is installed (`pip install sgp4`)."""

import math
from typing import Any

import numpy as np
import pytest

from fmu_src.instance import Instance
from fmu_src.tethered_deorbit.interface import MODEL
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU

pytestmark = pytest.mark.evidence
HOUR, DAY = 3600.0, 86400.0
CASES = [(800.0, 98.603), (800.0, 51.6), (1400.0, 120.0)]
"""Altitude [km] and inclination [deg]."""


def satellite(api: Any, altitude: float, inclination: float) -> Any:
    """Of SGP4 on a nearly circular orbit, without drag."""
    axis = EARTH_EQUATORIAL_RADIUS + 1e3 * altitude
    a_minute = 60.0 * math.sqrt(EARTH_MU / axis**3)
    found = api.Satrec()
    found.sgp4init(api.WGS84, "i", 1, 27000.0, 0.0, 0.0, 0.0, 1e-4, 0.0, math.radians(inclination), 0.0, a_minute, 0.5)
    return found


def elements(position: np.ndarray, velocity: np.ndarray) -> dict[str, float]:
    """Of the Kepler orbit through a state (3,), (3,) [m], [m/s], by FMI name."""
    momentum = np.cross(position, velocity)
    h, r = float(np.linalg.norm(momentum)), float(np.linalg.norm(position))
    node = np.array([-momentum[1], momentum[0], 0.0])
    node /= np.linalg.norm(node)
    ahead = np.cross(momentum / h, node)
    eccentric = np.cross(velocity, momentum) / EARTH_MU - position / r
    axis = 1.0 / (2.0 / r - float(velocity @ velocity) / EARTH_MU)
    of_perigee = math.atan2(eccentric @ ahead, eccentric @ node)
    return {
        "orbit.altitude": axis - EARTH_EQUATORIAL_RADIUS,
        "orbit.eccentricity": float(np.linalg.norm(eccentric)),
        "orbit.inclination": math.acos(momentum[2] / h),
        "orbit.raan": math.atan2(node[1], node[0]),
        "orbit.argument_of_perigee": of_perigee,
        "orbit.true_anomaly": math.remainder(math.atan2(position @ ahead, position @ node) - of_perigee, math.tau),
    }


def node_of(position: np.ndarray, velocity: np.ndarray) -> float:
    momentum = np.cross(position, velocity)
    return math.atan2(momentum[0], -momentum[1])


@pytest.mark.parametrize(("altitude", "inclination"), CASES)
def test_a_day_over_a_flattened_earth_is_that_of_sgp4(altitude: float, inclination: float) -> None:
    """A tow without thrust begins in a state that SGP4 tells: places within 1 km over a day, and the node's drift, both
    fitted over it, to 5e-5; without J2 the node stands still."""
    api = pytest.importorskip("sgp4.api", reason="SGP4 is not installed: pip install sgp4")
    theirs = satellite(api, altitude, inclination)
    start = [1e3 * np.array(v) for v in theirs.sgp4_tsince(0.0)[1:]]
    values = elements(*start) | {"thrust.level": 0.0, "start.separation": 10.0}
    i = Instance(MODEL, {"reel": "locked", "thrust": "along_track", "oblateness": "J4"}, values).initialise()
    assert np.linalg.norm(i.array("center_position") - start[0]) < 2.0  # half-way, not the centre of mass
    times, nodes, apart = [], [], 0.0
    for k in range(1, 289):
        i.step(DAY / 288.0)
        place, rate = (1e3 * np.array(v) for v in theirs.sgp4_tsince(k * DAY / 288.0 / 60.0)[1:])
        apart = max(apart, float(np.linalg.norm(i.array("center_position") - place)))
        times.append(k * DAY / 288.0)
        nodes.append((node_of(i.array("center_position"), i.array("center_velocity")), node_of(place, rate)))
    mine, its = (np.polyfit(times, np.unwrap(row), 1)[0] for row in np.array(nodes).T)
    print(f"{altitude:g} km, {inclination:g} deg: node {mine:.8g} and {its:.8g} rad/s, apart at most {apart:.4g} m")
    assert abs(its) > 1e-7
    assert mine == pytest.approx(its, rel=5e-5)
    assert apart < 1e3
