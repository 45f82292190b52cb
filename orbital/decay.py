"""How an orbit decays in the air, averaged over its revolutions: what lifetime a body has."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_J2, EARTH_MU, EARTH_ROTATION_RATE

Densities = Callable[[npt.NDArray[np.float64]], npt.NDArray[np.float64]]
POINTS = 128
"""Eccentric anomalies over which a revolution is averaged; enough while the density falls by e over at least 5 km."""


SAMPLES = 256
"""Places of a revolution, even in angle, over which it is averaged."""


def mean_orbit(position: npt.NDArray[np.float64], velocity: npt.NDArray[np.float64]) -> tuple[float, float]:
    """Semi-major axis [m] and eccentricity of the conic that a revolution round the flattened Earth is in the mean.

        a = <a'> + <r - r'>,   a e = <a'> |<e'>| - 2 <(r - r') cos f>

    a' and e' are the osculating axis and vector of eccentricity, which breathe twice a revolution by kilometres, <> is
    their mean over one, and r' the conic of these means at the place's angle f from perigee, above which the flattening
    lifts or lowers perigee and apogee. The motion is integrated with J2, by scipy's DOP853.

    position, velocity   from the centre, along the equator and the axis  (3,) [m], [m/s]

    Valid    bound orbits; the air acts slowly beside a revolution; what J3 does over months is left out (perigee: 7 km)
    Source   the averages themselves, in place of Brouwer's or Kozai's series
    Raises   ValueError where the orbit is not bound
    Checked  tests/orbital/test_decay.py: the same from all over an orbit, and the lifetime of the motion itself
    """
    from scipy.integrate import solve_ivp

    def slope(_: float, y: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        x, square = y[:3], float(y[:3] @ y[:3])
        sine = y[2] ** 2 / square
        strength = 1.5 * EARTH_J2 * EARTH_EQUATORIAL_RADIUS**2 / square
        pull = x * (1.0 + strength * (1.0 - 5.0 * sine))
        pull[2] += 2.0 * strength * y[2]
        return np.concatenate([y[3:], -EARTH_MU / square**1.5 * pull])

    radius = float(np.linalg.norm(position))
    axis = 1.0 / (2.0 / radius - float(velocity @ velocity) / EARTH_MU)
    if not axis > 0.0:
        raise ValueError(f"no bound orbit: semi-major axis {axis:.6g} m")
    period = 2.0 * math.pi * math.sqrt(axis**3 / EARTH_MU)
    begin = np.concatenate([position, velocity])
    found = solve_ivp(slope, (0.0, 2.2 * period), begin, method="DOP853", dense_output=True, rtol=1e-10, atol=1e-3)
    motion = found.sol
    assert motion is not None, "it is asked for"
    time = np.linspace(0.0, 2.2 * period, 8 * SAMPLES)
    turning = np.cross(position, velocity)
    x, y = (motion(time)[:3].T @ way / np.linalg.norm(way) for way in (position, np.cross(turning, position)))
    angle = np.unwrap(np.arctan2(y, x))
    # from apogee to apogee: what turns the apsides does so in between
    lowest = np.cross(velocity, turning) / EARTH_MU - position / radius
    apogee = math.atan2(
        float(np.cross(turning, position) @ lowest), float(turning @ turning) ** 0.5 * float(position @ lowest)
    )
    apogee = (apogee + math.pi) % (2.0 * math.pi)
    time = np.interp(apogee + np.linspace(0.0, 2.0 * math.pi, SAMPLES), angle, time)
    period = float(time[-1] - time[0])
    places, speeds = np.split(motion(time).T, 2, axis=1)
    distance, momentum = np.linalg.norm(places, axis=1), np.cross(places, speeds)
    vectors = np.cross(speeds, momentum) / EARTH_MU - places / distance[:, None]
    axis = float(np.trapezoid(1.0 / (2.0 / distance - np.sum(speeds**2, axis=1) / EARTH_MU), time)) / period
    vector = np.trapezoid(vectors, time, axis=0) / period
    eccentricity = float(np.linalg.norm(vector))
    first = vector / eccentricity if eccentricity > 0.0 else position / radius
    normal = np.mean(momentum, axis=0)
    second = np.cross(normal / np.linalg.norm(normal), first)
    angle = np.unwrap(np.arctan2(places @ second, places @ first))
    conic = axis * (1.0 - eccentricity**2) / (1.0 + eccentricity * np.cos(angle))
    turned = angle[-1] - angle[0]
    higher = float(np.trapezoid(distance - conic, angle)) / turned
    tilted = 2.0 * float(np.trapezoid((distance - conic) * np.cos(angle), angle)) / turned
    return axis + higher, (axis * eccentricity - tilted) / (axis + higher)


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
