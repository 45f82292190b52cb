"""Air, light and shadow against brahe, an independent library of orbit dynamics, where that is installed
(`pip install brahe`); nothing is fetched: its Sun is a series, and its Earth turns without tables."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmu_src.instance import Instance
from fmu_src.tethered_deorbit.interface import MODEL
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from tests.validation import Validated, other_code

pytestmark = pytest.mark.evidence
TERMS = {"reel": "locked"}
BASE, ALTITUDE, SCALE = 2.418e-11, 300e3, 53.628e3
"""Density [kg/m3] at an altitude, and its scale height [m]: standard atmosphere at 300 km, Vallado 2013, table 8-4."""
AREA, COEFFICIENT = 12.0, 2.2
AIR = {
    "orbit.altitude": ALTITUDE,
    "orbit.inclination": math.radians(51.6),
    "orbit.raan": 0.7,
    "start.separation": 10.0,
    "air.base_density": BASE,
    "air.base_altitude": ALTITUDE,
    "air.scale_height": SCALE,
    "air.chaser_area": 2.0 * AREA,
    "air.target_area": AREA,
}
"""Both bodies have as much area for each kilogram, so that the line has no part in it."""


@pytest.fixture
def brahe() -> Any:
    return pytest.importorskip("brahe", reason="brahe is not installed: pip install brahe")


def state(i: Instance, body: str) -> np.ndarray:
    return np.concatenate([i.array(f"{body}_position"), i.array(f"{body}_velocity")])


def test_drag_of_both_bodies_is_that_of_brahe(brahe: Any, validated: Validated) -> None:
    """At one density, in air that turns with the Earth, to what both take for its rate; in air at rest another."""
    i = Instance(MODEL, TERMS | {"air": "exponential"}, AIR).initialise()
    i.step(1000.0)
    for body, mass, area in (("chaser", 2000.0, 2.0 * AREA), ("target", 1000.0, AREA)):
        x = state(i, body)
        density = BASE * math.exp(-(np.linalg.norm(x[:3]) - EARTH_EQUATORIAL_RADIUS - ALTITUDE) / SCALE)
        theirs = mass * np.linalg.norm(brahe.accel_drag(x, density, mass, area, COEFFICIENT, np.eye(3)))
        print(f"drag of the {body}: {i[f'air.{body}_drag']:.9g} N, brahe {theirs:.9g} N")
        validated(other_code("brahe"), f"drag of the {body}", i[f"air.{body}_drag"], float(theirs), "N", rel=1e-6)
        still = 0.5 * density * COEFFICIENT * area * float(x[3:] @ x[3:])
        assert still != pytest.approx(theirs, rel=1e-2)


def test_an_orbit_decays_as_with_accelerations_of_brahe(brahe: Any, validated: Validated) -> None:
    """Half a day at 300 km: the fall of the axis, and the place at the end, against scipy's DOP853 on brahe's gravity
    of a point and drag; without air the axis stays."""
    i = Instance(MODEL, TERMS | {"air": "exponential"}, AIR).initialise()
    start = np.concatenate([i.array("center_position"), i.array("center_velocity")])
    axis, ratio = i["center.semi_major_axis"], AREA / 1000.0
    turn = np.eye(3)

    def change(_: float, x: np.ndarray) -> np.ndarray:
        density = BASE * math.exp(-(np.linalg.norm(x[:3]) - EARTH_EQUATORIAL_RADIUS - ALTITUDE) / SCALE)
        pull = brahe.accel_point_mass_gravity(x[:3], np.zeros(3), EARTH_MU)
        return np.concatenate([x[3:], pull + brahe.accel_drag(x, density, 1.0, ratio, COEFFICIENT, turn)])

    span = 43200.0
    found = solve_ivp(change, (0.0, span), start, "DOP853", rtol=1e-11, atol=1e-6)
    place, rate = found.y[:3, -1], found.y[3:, -1]
    its = 1.0 / (2.0 / float(np.linalg.norm(place)) - float(rate @ rate) / EARTH_MU)
    i.step(span)
    off = float(np.linalg.norm(i.array("center_position") - place))
    print(f"fall of the axis: {axis - i['center.semi_major_axis']:.7g} m, brahe {axis - its:.7g} m; apart {off:.3g} m")
    assert axis - its > 1000.0
    source, fall = other_code("brahe's accelerations, scipy DOP853"), axis - i["center.semi_major_axis"]
    validated(source, "fall of the axis by drag at 300 km in half a day", fall, axis - its, "m", rel=1e-4)
    validated(source, "way from where drag leaves it after half a day", off, 0.0, "m", abs=5.0)


@pytest.mark.parametrize(("shape", "theirs"), [("cone", "eclipse_conical"), ("cylinder", "eclipse_cylindrical")])
@pytest.mark.parametrize("raan", [1.2, 2.6])
def test_shadow_is_that_of_brahe(brahe: Any, validated: Validated, shape: str, theirs: str, raan: float) -> None:
    """Five revolutions at 800 km from J2000.0, where both have one frame: share of the Sun that is seen every two
    seconds, and the time in shadow."""
    values = {"orbit.epoch": 0.0, "orbit.raan": raan, "start.separation": 10.0}
    i = Instance(MODEL, TERMS | {"shadow": shape}, values).initialise()
    begin = brahe.Epoch.from_datetime(2000, 1, 1, 12, 0, 0.0, 0.0, brahe.TimeSystem.UTC)
    lit = []
    while i.time < 30000.0:
        i.step(2.0)
        sun = brahe.sun_position(begin + i.time)
        lit.append((i["shadow.lit"], getattr(brahe, theirs)(i.array("center_position"), sun)))
    mine, its = np.array(lit).T
    dark = 2.0 * float((its < 1.0).sum())
    print(f"{shape}, node {raan:g}: in shadow {i['shadow.time']:.6g} s, brahe {dark:.6g} s, off at most "
          f"{np.abs(mine - its).max():.3g}, in the mean {np.abs(mine - its).mean():.3g}")  # fmt: skip
    assert dark > 5000.0
    source = other_code("brahe")
    validated(source, f"five revolutions, shadow a {shape}: time in it", i["shadow.time"], dark, "s", abs=12.0)
    assert np.abs(mine - its).mean() < 1e-3


def test_light_presses_as_of_brahe(brahe: Any, validated: Validated) -> None:
    """1.3 times P A (AU/d)^2, by the same constants, away from the Sun."""
    values = {"orbit.epoch": 0.0, "orbit.raan": 0.0, "start.separation": 10.0}
    i = Instance(MODEL, TERMS | {"shadow": "cone", "sunlight": "pressure"}, values).initialise()
    i.step(10.0)
    assert i["shadow.lit"] == 1.0
    begin = brahe.Epoch.from_datetime(2000, 1, 1, 12, 0, 0.0, 0.0, brahe.TimeSystem.UTC)
    sun = brahe.sun_position(begin + 10.0)
    theirs = brahe.accel_solar_radiation_pressure(i.array("chaser_position"), sun, 1.0, 1.3, 10.0, 4.540e-6)
    print(f"light on the chaser: {i['sunlight.chaser_force']:.8g} N, brahe {np.linalg.norm(theirs):.8g} N")
    source, force = other_code("brahe"), float(np.linalg.norm(theirs))
    validated(source, "force of light on the chaser", i["sunlight.chaser_force"], force, "N", rel=1e-3)
