"""How an orbit decays in the air, averaged over its revolutions: what lifetime a body has."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU, EARTH_ROTATION_RATE

Densities = Callable[[npt.NDArray[np.float64]], npt.NDArray[np.float64]]
POINTS = 128
"""Eccentric anomalies over which a revolution is averaged; enough while the density falls by e over at least 5 km."""


def mean_rates(
    axis: float, eccentricity: float, ballistic: float, density: Densities, cosine: float
) -> tuple[float, float]:
    """Mean rates of the semi-major axis [m/s] and of the eccentricity [1/s] by drag.

        da/dt = -(n/2 pi) d a^2 int rho (1 + e cos E)^(3/2) (1 - e cos E)^(-1/2) dE
        dx/dt = -(n/2 pi) d a^2 int rho ((1 + e cos E)/(1 - e cos E))^(1/2) (cos E + e) dE,   x = a e
        d = F c_d A/m,   F = (1 - r_p w cos i/v_p)^2,   e' = (x' - e a')/a

    axis, eccentricity   a, e                                    [m], [-]
    ballistic     c_d A/m                                        [m^2/kg]
    density       rho    of altitudes over the equatorial radius (n,) [m], (n,) [kg/m^3]
    cosine        cos i  of the inclination                      [-]

    Valid    0 <= e < 1, a round Earth, a decay that is slow beside a revolution
    Source   King-Hele, Satellite orbits in an atmosphere (1987), eq. 4.14 to 4.17
    Checked  tests/orbital/test_decay.py, against an integration of the motion itself
    """
    angle = 2.0 * math.pi * (np.arange(POINTS) + 0.5) / POINTS
    c = np.cos(angle)
    rate = math.sqrt(EARTH_MU / axis**3)
    perigee = axis * (1.0 - eccentricity)
    speed = math.sqrt(EARTH_MU / axis * (1.0 + eccentricity) / (1.0 - eccentricity))
    wind = (1.0 - perigee * EARTH_ROTATION_RATE * cosine / speed) ** 2
    rho = density(axis * (1.0 - eccentricity * c) - EARTH_EQUATORIAL_RADIUS)
    ratio = np.sqrt((1.0 + eccentricity * c) / (1.0 - eccentricity * c))
    factor = -rate * wind * ballistic * axis**2
    fall = factor * float(np.mean(rho * ratio * (1.0 + eccentricity * c)))
    x = factor * float(np.mean(rho * ratio * (c + eccentricity)))
    return fall, (x - eccentricity * fall) / axis


def lifetime(
    axis: float,
    eccentricity: float,
    ballistic: float,
    density: Densities,
    cosine: float,
    low: float,
    longest: float,
) -> float:
    """Time until the perigee is as low as `low` [s]; infinite if that takes longer than `longest` [s].

    low           altitude at which it ends                      [m]
    The others as in `mean_rates`.

    Valid    as there; air that stays as it is
    Source   `mean_rates`, stepped with scipy's LSODA
    Checked  tests/orbital/test_decay.py
    """
    from scipy.integrate import solve_ivp

    def slope(_: float, y: npt.NDArray[np.float64]) -> list[float]:
        return list(mean_rates(float(y[0]), max(0.0, float(y[1])), ballistic, density, cosine))

    def height(_: float, y: npt.NDArray[np.float64]) -> float:
        return float(y[0] * (1.0 - max(0.0, y[1])) - EARTH_EQUATORIAL_RADIUS - low)

    if height(0.0, np.array([axis, eccentricity])) <= 0.0:
        return 0.0
    height.terminal = True  # type: ignore[attr-defined]
    found = solve_ivp(
        slope, (0.0, longest), [axis, eccentricity], method="LSODA", events=height, rtol=1e-6, atol=[1.0, 1e-9]
    )
    events = found.t_events
    return float(events[0][0]) if events is not None and len(events[0]) else math.inf
