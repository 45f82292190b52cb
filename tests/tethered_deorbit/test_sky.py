"""Sun, Moon, light and shadow, and the higher zonal harmonics, on a tow: against Newton's law for each body in long
doubles, an orbit of its own by scipy and astropy, and closed forms."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from astropy.coordinates import get_body_barycentric, solar_system_ephemeris
from astropy.time import Time, TimeDelta
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from fmu_src.instance import Instance
from fmu_src.tethered_deorbit.environment.perturbed import make_perturbing
from fmu_src.tethered_deorbit.interface import MODEL
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_J2, EARTH_J3, EARTH_J4, EARTH_MU, STANDARD_GRAVITY
from tests.plain import PlainInstance, plain
from tests.validation import Validated, closed_form, other_code

__all__ = ["plain"]

TERMS = {
    "reel": "locked",
    "thrust": "along_track",
    "engine": "electric",
    "oblateness": "J4",
    "third_bodies": "sun_and_moon",
    "shadow": "cone",
    "sunlight": "pressure",
    "power": "solar",
}
DAY, AU, SUN_MU, MOON_MU, R = 86400.0, 149597870700.0, 1.3271244004127942e20, 4.902800118e12, EARTH_EQUATORIAL_RADIUS
EPOCH = "2026-03-05 06:00"
SINCE_J2000 = (Time(EPOCH).jd1 - 2451545.0 + Time(EPOCH).jd2) * DAY
MASSES = 2000.0, 1000.0
AREAS, COEFFICIENT = (15.0, 40.0), 1.4
STATE = np.array([5e6, -4e6, 3e6, 5e3, 5e3, -1e3, 7e3, -3e3, 9e3, 0.01, 0.02, -0.005])

LEGENDRE = {n: np.polynomial.legendre.leg2poly([0.0] * n + [1.0]) for n in (2, 3, 4)}
"""Coefficients of P_n, by rising power."""


def zonals(position: Any) -> Any:
    """Third and fourth harmonic with the second, as the gradient of mu/r sum J_n (R/r)^n P_n, written out by cases."""
    x = np.asarray(position, np.longdouble)
    r = np.sqrt(x @ x)
    s = x[2] / r
    out = np.zeros(3, np.longdouble)
    for n, j in ((2, EARTH_J2), (3, EARTH_J3), (4, EARTH_J4)):
        p = LEGENDRE[n]
        value = sum(np.longdouble(c) * s**k for k, c in enumerate(p))
        slope = sum(k * np.longdouble(c) * s ** (k - 1) for k, c in enumerate(p) if k)
        strength = np.longdouble(EARTH_MU) * np.longdouble(j) * np.longdouble(R) ** n
        out += strength * (
            (n + 1) * value * x / r ** (n + 3) - slope / r ** (n + 1) * (np.eye(3)[2] / r - s * x / r**2)
        )
    return out


def attraction(position: Any, body: Any, mu: float) -> Any:
    x, s = np.asarray(position, np.longdouble), np.asarray(body, np.longdouble)
    return mu * ((s - x) / np.sqrt((s - x) @ (s - x)) ** 3 - s / np.sqrt(s @ s) ** 3)


def light(sun: Any, area: float, mass: float) -> Any:
    far = np.linalg.norm(sun)
    return -1361.0 / 299792458.0 * (AU / far) ** 2 * COEFFICIENT * area / mass * sun / far


def added(terms: Mapping[str, str], turning: Any, elapsed: float, time: float = 3000.0) -> tuple[Any, Any]:
    """What disturbs the pair in STATE at a time, in inertial axes, found in axes that have turned; and the record."""
    record = MODEL.interface(terms).make_record()
    record["state_total_mass"] = sum(MASSES)
    record["state_chaser_share"], record["state_target_share"] = (mass / sum(MASSES) for mass in MASSES)
    record["state_turning"][0] = turning
    record["state_begin"] = time - elapsed
    for name, value in (("orbit_epoch", SINCE_J2000), ("sunlight_coefficient", COEFFICIENT)):
        if name in record.dtype.names:
            record[name] = value
    for name, value in zip(("sunlight_chaser_area", "sunlight_target_area"), AREAS, strict=True):
        if name in record.dtype.names:
            record[name] = value
    perturbing = make_perturbing(MODEL.interface(terms))
    record = record.view(np.recarray)
    perturbing.begin(record)
    back, rate = Rotation.from_rotvec(turning * elapsed), np.zeros(20)
    there = np.concatenate([back.inv().apply(STATE.reshape(-1, 3)).ravel(), np.zeros(8)])
    perturbing.add(record, there, rate, elapsed, elapsed)
    return back.apply(rate[:12].reshape(-1, 3)).ravel(), record


@pytest.mark.usefixtures("plain")
@pytest.mark.parametrize("leaves", ["all", "third_bodies", "sunlight", "oblateness"])
def test_each_body_moves_as_newton_says(validated: Validated, leaves: str) -> None:
    """rho'' is the difference of both accelerations, R'' their mean by mass: to 1e-12 of the difference, which two
    accelerations in doubles would lose."""
    kept = {"reel": "locked"} | {
        group: TERMS[group]
        for group in ("oblateness", "third_bodies", "shadow", "sunlight")
        if leaves in ("all", group) or (leaves, group) == ("sunlight", "shadow")
    }
    rate, record = added(kept, np.zeros(3), 0.0)
    share = MASSES[1] / sum(MASSES)
    accelerations = []
    for mass, area, along in ((MASSES[0], AREAS[0], -share), (MASSES[1], AREAS[1], 1.0 - share)):
        place = np.asarray(STATE[0:3], np.longdouble) + np.longdouble(along) * STATE[6:9]
        total = np.zeros(3, np.longdouble)
        if "oblateness" in kept:
            total += zonals(place)
        if "third_bodies" in kept:
            sun, moon = record["state_sun"][0], record["state_moon"][0]
            total += attraction(place, sun, SUN_MU) + attraction(place, moon, MOON_MU)
        if "sunlight" in kept:
            total += light(record["state_sun"][0], area, mass)
        accelerations.append(total)
    apart, mean = accelerations[1] - accelerations[0], (1.0 - share) * accelerations[0] + share * accelerations[1]
    newton = other_code("Newton's law for each body, in 64 bits of mantissa")
    for what, found, told in (("the line", rate[9:12], apart), ("the centre", rate[3:6], mean)):
        told = told.astype(float)
        within = 1e-12 * float(np.linalg.norm(told))
        validated(newton, f"what disturbs the orbit ({leaves}) on {what}", found, told, "m/s2", abs=np.full(3, within))
    turned, _ = added(kept, np.array([2e-3, -3e-3, 1e-3]), 40.0)
    assert turned[9:] == pytest.approx(rate[9:], rel=1e-7, abs=1e-9 * np.linalg.norm(rate[9:]))
    assert turned[3:6] == pytest.approx(rate[3:6], rel=1e-9, abs=1e-9 * np.linalg.norm(rate[3:6]))


def places(body: str, days: float) -> Any:
    """Place of a body by astropy [m], as a spline over time [s]."""
    times = np.arange(-0.1, days + 0.1, 0.05) * DAY
    with solar_system_ephemeris.set("builtin"):
        at = Time(EPOCH, scale="utc") + TimeDelta(times, format="sec")
        there, here = (get_body_barycentric(name, at) for name in (body, "earth"))
    import erfa

    epoch = Time(EPOCH, scale="utc").tt
    return CubicSpline(times, (erfa.pmat06(epoch.jd1, epoch.jd2) @ (there.xyz - here.xyz).to_value("m")).T)


def share_of_the_sun(x: Any, sun: Any) -> float:
    """By counting, on a fan of rays to the disc: 1 in the light, 0 in the umbra."""
    away = sun - x
    height, apart = np.linalg.norm(x), np.linalg.norm(away)
    if x @ away > 0.0:
        return 1.0
    b, a = math.asin(R / height), math.asin(6.957e8 / apart)
    c = math.acos(-(x @ away) / height / apart)
    if c > a + b:
        return 1.0
    rows = np.linspace(-1.0, 1.0, 401)[:, None]
    y, z = np.broadcast_arrays(rows, rows.T)
    disc = y**2 + z**2 < 1.0
    return float(np.mean(((c + a * y) ** 2 + (a * z) ** 2 > b * b)[disc]))


def test_an_orbit_by_scipy_and_astropy(validated: Validated) -> None:
    """Three days on a geostationary orbit in eclipse season, the thruster off: both centres against an orbit of the
    pair's own mass, with Sun and Moon by astropy."""
    days = 3.0
    values = {
        "thrust.level": 0.0, "orbit.altitude": 35786e3, "orbit.inclination": 0.0, "orbit.epoch": SINCE_J2000,
        "start.separation": 10.0, "sunlight.coefficient": COEFFICIENT,
        "sunlight.chaser_area": AREAS[0], "sunlight.target_area": AREAS[1],
    }  # fmt: skip
    i = Instance(MODEL, TERMS, values).initialise()
    begin = np.concatenate([i.array("center_position"), i.array("center_velocity")])
    energy, axis = i["energy.orbital"], i["center.semi_major_axis"]
    for _ in range(3):
        i.step(days * DAY / 3.0)
    sun, moon = places("sun", days), places("moon", days)

    def slope(t: float, y: Any) -> Any:
        x = y[:3]
        total = -EARTH_MU * x / np.linalg.norm(x) ** 3 + zonals(x).astype(float)
        total += attraction(x, sun(t), SUN_MU).astype(float) + attraction(x, moon(t), MOON_MU).astype(float)
        total += share_of_the_sun(x, sun(t)) * light(sun(t), sum(AREAS), sum(MASSES))
        return np.concatenate([y[3:], total])

    end = solve_ivp(slope, (0.0, days * DAY), begin, method="DOP853", rtol=1e-11, atol=1e-3, max_step=600.0).y[:, -1]
    moved = float(np.linalg.norm(end[:3] - turned_by(begin, days * DAY, axis)))
    assert moved > 3e4
    place, within = i.array("center_position"), np.full(3, 1e-5 * moved)
    what = "geostationary orbit with all that disturbs it: place after three days"
    validated(other_code("scipy's DOP853 with Sun and Moon by astropy"), what, place, end[:3], "m", abs=within)
    assert i["energy.orbital"] != energy
    assert i["shadow.count"] == 3
    assert i["shadow.lit"] == 1.0
    assert i["sunlight.target_force"] == pytest.approx(np.linalg.norm(light(sun(days * DAY), AREAS[1], 1.0)), rel=1e-3)


def turned_by(state: Any, time: float, axis: float) -> Any:
    """Place on the circle that the pair would be on alone."""
    angle = math.sqrt(EARTH_MU / axis**3) * time
    normal = np.cross(state[:3], state[3:])
    return Rotation.from_rotvec(angle * normal / np.linalg.norm(normal)).apply(state[:3])


@pytest.mark.usefixtures("plain")
@pytest.mark.parametrize("above", [False, True])
def test_share_of_an_orbit_in_shadow(validated: Validated, above: bool) -> None:
    """A cylinder over a circle at 800 km: acos(sqrt(1 - (R/r)^2)/cos(beta))/pi of it, 34.8 % at beta = 0; none above
    62.7 deg. And nothing is left of an earlier epoch."""
    terms = {"reel": "locked", "shadow": "cylinder"}
    i = PlainInstance(MODEL, terms, {"orbit.epoch": 0.0, "start.separation": 10.0, "orbit.inclination": 0.5 * math.pi})
    i["orbit.epoch"] = SINCE_J2000
    i.initialise()
    sun = i.record["state_sun"][0]
    declination, node = math.asin(sun[2] / np.linalg.norm(sun)), math.atan2(sun[1], sun[0])
    beta = math.radians(63.0) if above else math.radians(20.0)
    # the plane of a polar orbit makes with the Sun the angle beta: sin(beta) = cos(declination) sin(node difference)
    i["orbit.raan"] = node - math.asin(math.sin(beta) / math.cos(declination))
    i.initialise()
    radius = R + 800e3
    period = 2.0 * math.pi * math.sqrt(radius**3 / EARTH_MU)
    i.step(period)
    inside = math.sqrt(1.0 - (R / radius) ** 2) / math.cos(beta)
    expected = math.acos(inside) / math.pi if inside < 1.0 else 0.0
    assert math.acos(math.sqrt(1.0 - (R / radius) ** 2)) / math.pi == pytest.approx(0.348, abs=5e-4)
    formula = closed_form("acos(sqrt(1 - (R/r)^2)/cos(beta))/pi")
    validated(formula, "share of a circle in the Earth's shadow", i["shadow.time"] / period, expected, "1", abs=1e-4)
    assert i["shadow.count"] in ((0,) if above else (1, 2))


@pytest.mark.usefixtures("plain")
def test_time_in_the_penumbra_too(validated: Validated) -> None:
    """From the outer edge of one penumbra to that of the other, by the angle at which the discs touch."""
    i = PlainInstance(
        MODEL, {"reel": "locked", "shadow": "cone"},
        {"orbit.epoch": SINCE_J2000, "start.separation": 10.0, "orbit.inclination": 0.5 * math.pi},
    )  # fmt: skip
    sun = np.array(i.record["state_sun"][0])
    i["orbit.raan"] = math.atan2(sun[1], sun[0])
    i.initialise()
    radius, far = R + 800e3, np.linalg.norm(sun)
    period = 2.0 * math.pi * math.sqrt(radius**3 / EARTH_MU)

    def touch(angle: float) -> float:
        """Room between the discs, `angle` from the middle of the shadow."""
        x = radius * np.array([-math.cos(angle), math.sin(angle)])
        away = np.array([far, 0.0]) - x
        apart = math.acos(-(x @ away) / radius / np.linalg.norm(away))
        return apart - math.asin(R / radius) - math.asin(6.957e8 / float(np.linalg.norm(away)))

    i.step(period)
    share, expected = i["shadow.time"] / period, brentq(touch, 0.5, 1.5) / math.pi
    validated(
        closed_form("angle at which two discs touch"),
        "share of a circle in the penumbra",
        share,
        expected,
        "1",
        abs=5e-5,
    )


def test_a_thruster_on_solar_power() -> None:
    """In shadow it gives what batteries give; its propellant says how long it was in the light."""
    values = {
        "thrust.level": -0.1, "orbit.altitude": 800e3, "orbit.inclination": 0.4, "orbit.epoch": SINCE_J2000,
        "start.separation": 10.0, "engine.power_limit": 6000.0, "power.battery_share": 0.2,
    }  # fmt: skip
    i = Instance(MODEL, TERMS, values).initialise()
    most = 2.0 * 0.6 * 6000.0 / (3000.0 * STANDARD_GRAVITY)
    seen = set()
    for _ in range(60):
        i.step(200.0)
        seen.add((round(i["shadow.lit"]), round(i["thrust.force"] / most, 6)))
        assert i["engine.limited"] == (i["shadow.lit"] < 1.0)
    assert seen == {(1, round(-0.1 / most, 6)), (0, -0.2)}
    lit = 12000.0 - i["shadow.time"]
    used = (0.1 * lit + 0.2 * most * i["shadow.time"]) / (3000.0 * STANDARD_GRAVITY)
    assert i["chaser.propellant"] == pytest.approx(used, rel=1e-9)
    assert 0.25 < i["shadow.time"] / 12000.0 < 0.4


@pytest.mark.usefixtures("plain")
def test_higher_harmonics_keep_energy_and_its_rate() -> None:
    i = PlainInstance(
        MODEL, {"reel": "locked", "oblateness": "J4"}, {"orbit.inclination": 1.0, "start.separation": 10.0}
    )
    before = i["energy.orbital"]
    i.step(1500.0)
    i.differentiate()
    assert i["energy.orbital"] == pytest.approx(before, rel=1e-13)
    assert abs(i.rate("energy.orbital")) < 1e-9 * abs(before) * 1e-3
