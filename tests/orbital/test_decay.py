"""Decay averaged over revolutions, against the motion itself by scipy."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_J2, EARTH_MU, EARTH_ROTATION_RATE
from orbital.decay import lifetime, mean_orbit, mean_rates

COSINE = math.cos(1.0)


def air(altitude: Any) -> Any:
    return 3e-9 * np.exp((150e3 - altitude) / 25e3)


@pytest.mark.parametrize("eccentricity", [0.0, 0.02])
def test_it_is_the_motion_itself_in_the_mean(eccentricity: float) -> None:
    """Until 120 km: the lifetime of the averaged orbit is that of the orbit, to a revolution or so."""
    axis, ballistic = EARTH_EQUATORIAL_RADIUS + 190e3 + eccentricity * 6.57e6, 0.02
    speed = math.sqrt(EARTH_MU / axis * (1.0 + eccentricity) / (1.0 - eccentricity))
    begin = [axis * (1.0 - eccentricity), 0.0, 0.0, 0.0, speed * COSINE, speed * math.sin(1.0)]

    def slope(t: float, y: Any) -> Any:
        r = np.linalg.norm(y[:3])
        wind = y[3:] - EARTH_ROTATION_RATE * np.array([-y[1], y[0], 0.0])
        drag = -0.5 * ballistic * air(r - EARTH_EQUATORIAL_RADIUS) * np.linalg.norm(wind) * wind
        return np.concatenate([y[3:], -EARTH_MU * y[:3] / r**3 + drag])

    def low(t: float, y: Any) -> float:
        return float(np.linalg.norm(y[:3]) - EARTH_EQUATORIAL_RADIUS - 120e3)

    low.terminal = True  # type: ignore[attr-defined]
    true = solve_ivp(slope, (0.0, 30.0 * 86400.0), begin, method="DOP853", rtol=1e-9, atol=1.0, events=low)
    told = lifetime(axis, eccentricity, ballistic, air, COSINE, 120e3, 1e9)
    assert told == pytest.approx(true.t[-1], rel=0.02, abs=5400.0)
    assert told > 4.0 * 5400.0


def test_a_circle_falls_as_its_closed_form() -> None:
    axis, density = 6.778e6, 3.7e-12
    fall, rounder = mean_rates(axis, 0.0, 0.01, lambda h: np.full_like(h, density), COSINE)
    speed = math.sqrt(EARTH_MU / axis)
    wind = (1.0 - axis * EARTH_ROTATION_RATE * COSINE / speed) ** 2
    assert fall == pytest.approx(-math.sqrt(EARTH_MU * axis) * density * 0.01 * wind, rel=1e-12)
    assert rounder == pytest.approx(0.0, abs=1e-25)
    assert math.isinf(lifetime(axis, 0.0, 0.01, lambda h: np.zeros_like(h), COSINE, 120e3, 1e9))


def flattened(t: float, y: Any, ballistic: float) -> Any:
    """The motion itself, with J2 by its potential, whose gradient is taken by differences, and drag."""
    r = math.hypot(*y[:3])

    def potential(x: float, w: float, z: float) -> float:
        far = math.sqrt(x * x + w * w + z * z)
        bulge = EARTH_J2 * (EARTH_EQUATORIAL_RADIUS / far) ** 2 * 0.5 * (3.0 * (z / far) ** 2 - 1.0)
        return EARTH_MU / far * bulge

    h, pull = 100.0, np.zeros(3)
    for k in range(3):
        up, down = np.array(y[:3]), np.array(y[:3])
        up[k] += h
        down[k] -= h
        pull[k] = (potential(*down) - potential(*up)) * -0.5 / h
    wind = y[3:] - EARTH_ROTATION_RATE * np.array([-y[1], y[0], 0.0])
    drag = -0.5 * ballistic * air(r - EARTH_EQUATORIAL_RADIUS) * math.hypot(*wind) * wind
    return np.concatenate([y[3:], -EARTH_MU * y[:3] / r**3 - pull + drag])


@pytest.mark.parametrize(("low", "high", "ballistic"), [(160e3, 560e3, 0.01), (170e3, 180e3, 0.002)])
def test_a_lifetime_does_not_hang_on_the_instant(low: float, high: float, ballistic: float) -> None:
    """Round a flattened Earth, from eight instants of a revolution and one of the next day: each within 3 % of what is
    left by the motion itself, of which the osculating elements tell a fifth more or less and worse."""
    axis, e = EARTH_EQUATORIAL_RADIUS + 0.5 * (low + high), 0.5 * (high - low)
    e /= axis
    turn, up = np.array([COSINE, math.sin(1.0)]), 0.7
    along = np.array([math.cos(up), *(math.sin(up) * turn)])
    across = np.array([-math.sin(up), *(math.cos(up) * turn)])
    speed = math.sqrt(EARTH_MU / axis * (1.0 + e) / (1.0 - e))
    begin = np.concatenate([axis * (1.0 - e) * along, speed * across])

    def down(t: float, y: Any, *_: Any) -> float:
        return math.hypot(*y[:3]) - EARTH_EQUATORIAL_RADIUS - 120e3

    down.terminal = True  # type: ignore[attr-defined]
    looks = [*np.linspace(0.0, 5400.0, 8), 60e3]
    true = solve_ivp(
        flattened, (0.0, 1e6), begin, "DOP853", t_eval=looks, events=down, args=(ballistic,), rtol=1e-8, atol=0.1
    )
    assert len(true.t) == len(looks)
    end, worst = true.t_events[0][0], 0.0
    for t, y in zip(true.t, true.y.T, strict=True):
        normal = np.cross(y[:3], y[3:])
        cosine = normal[2] / np.linalg.norm(normal)
        told = lifetime(*mean_orbit(y[:3], y[3:]), ballistic, air, cosine, 120e3, 1e9)
        assert told == pytest.approx(end - t, rel=0.03)
        radius = np.linalg.norm(y[:3])
        breathing = 1.0 / (2.0 / radius - y[3:] @ y[3:] / EARTH_MU)
        vector = np.cross(y[3:], normal) / EARTH_MU - y[:3] / radius
        osculating = lifetime(breathing, float(np.linalg.norm(vector)), ballistic, air, cosine, 120e3, 1e9)
        worst = max(worst, abs(osculating / (end - t) - 1.0))
    assert worst > 0.2


def test_mean_orbit_is_that_of_all_its_places() -> None:
    """Of an eccentric orbit without air as well; its perigee is as low as the bodies get, but for where that lies."""
    begin = np.array([0.0, 6.7e6, 1e6, -9.6e3, 0.0, 300.0])
    true = solve_ivp(flattened, (0.0, 20e3), begin, "DOP853", args=(0.0,), t_eval=np.linspace(0.0, 20e3, 9), rtol=1e-10)
    densely = solve_ivp(
        flattened, (0.0, 20e3), begin, "DOP853", args=(0.0,), t_eval=np.linspace(0.0, 20e3, 9999), rtol=1e-10
    )
    found = np.array([mean_orbit(y[:3], y[3:]) for y in true.y.T])
    perigees = found[:, 0] * (1.0 - found[:, 1])
    assert np.ptp(perigees) < 10.0
    assert perigees[0] == pytest.approx(min(np.linalg.norm(y[:3]) for y in densely.y.T), abs=1500.0)
    assert found[0, 1] > 0.3
    with pytest.raises(ValueError, match="no bound orbit"):
        mean_orbit(begin[:3], 2.0 * begin[3:])
