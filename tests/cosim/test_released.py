"""Where two bodies go that no line holds: their nearest return, and their apsides."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from dcone_cosim.phases.passive import conic
from dcone_cosim.phases.released import apsides, nearest_return
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU


def test_nearest_return_of_two_orbits() -> None:
    """Between rows a minute apart: against a search over the orbits themselves."""
    r = EARTH_EQUATORIAL_RADIUS + 500e3
    v = float(np.sqrt(EARTH_MU / r))
    first = np.array([r, 0.0, 0.0]), np.array([0.0, v, 0.0])
    second = np.array([r + 20.0, 5.0, 3.0]), np.array([0.4, v - 0.03, 0.2])
    time = np.arange(0.0, 12000.0, 60.0)
    (p, u), (q, w) = conic(*first, time), conic(*second, time)

    def apart(t: float) -> float:
        (a, _), (b, _) = conic(*first, np.array([t])), conic(*second, np.array([t]))
        return float(np.linalg.norm(b - a))

    found = nearest_return(time, q - p, w - u)
    assert found is not None
    best = minimize_scalar(
        apart, bounds=(found.after - 90.0, found.after + 90.0), method="bounded", options={"xatol": 1e-6}
    )
    assert found.distance == pytest.approx(best.fun, rel=1e-4)
    assert found.after == pytest.approx(best.x, abs=0.1)
    assert found.after > 100.0
    assert found.distance < min(apart(t) for t in time[2:] if apart(t - 60.0) > apart(t) < apart(t + 60.0))


def test_none_of_what_drifts_apart() -> None:
    time = np.linspace(0.0, 100.0, 11)
    away = np.outer(1.0 + time, [1.0, 0.0, 0.0])
    assert nearest_return(time, away, np.tile([1.0, 0.0, 0.0], (11, 1))) is None


def test_apsides() -> None:
    low, high = EARTH_EQUATORIAL_RADIUS + 200e3, EARTH_EQUATORIAL_RADIUS + 600e3
    axis = 0.5 * (low + high)
    speed = float(np.sqrt(EARTH_MU * (2.0 / high - 1.0 / axis)))
    found = apsides(np.array([0.0, high, 0.0]), np.array([0.0, 0.0, speed]))
    assert found == pytest.approx((axis, (high - low) / (high + low), 200e3, 600e3), rel=1e-9)
