"""Decay averaged over revolutions, against the motion itself by scipy."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU, EARTH_ROTATION_RATE
from orbital.decay import lifetime, mean_rates

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
