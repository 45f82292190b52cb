"""Air by NRLMSIS 2.1, as a table that travels in the FMU: harmonics of latitude and local time at each altitude.

    ln rho(h, z, tau) = sum_k B_k(h) sum_lm d^m P_l/dz^m (z) (c_klm Re + s_klm Im) (x + i y)^m,   l <= 6

x, y and z are the components of the place's direction along the Sun's meridian, east of it and along the axis; B_k are
cubic B-splines of the altitude, so that the density is smooth to its second derivative. The altitude is the distance
from the Earth's centre less that of the WGS 84 ellipsoid in the same direction, which is the height over it within 6 m.
What the model says of longitude is averaged over the day, the season stays that of the epoch.

Checked  tests/tethered_deorbit/test_msis.py
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from fmu_src.interface import Laid, Undesigned
from fmu_src.tables import Table
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_FLATTENING

Rows = npt.NDArray[np.float64]
LOW, SPACING, COUNT = 100e3, 10e3, 91
"""Altitudes of the table: 100 to 1000 km. Beyond them ln rho goes on straight."""
DEGREE = 6
COLUMNS = (DEGREE + 1) ** 2
VERSION = 2.1
NAME = "air.harmonics"
TABLE = Table(NAME, "1", "ln of the density [kg/m^3]: a row per B-spline of the altitude, a column per harmonic", 2)
PLACES = 12
"""Places of an orbit, and times of the day, over which a mean profile is taken."""
HOURS = 8
"""Times of the day over which longitude is averaged."""


def _modes() -> list[tuple[int, int, bool]]:
    """Degree, order, and whether it is the imaginary part, of each column."""
    return [
        (degree, m, odd)
        for m in range(DEGREE + 1)
        for degree in range(m, DEGREE + 1)
        for odd in ((False, True)[: 1 + (m > 0)])
    ]


def harmonics(x: Rows, y: Rows, z: Rows) -> Rows:
    """Values of all harmonics (n, 49) in directions (n,) each, with numpy's own polynomials."""
    columns = []
    for degree, m, odd in _modes():
        polynomial = np.polynomial.legendre.Legendre.basis(degree)
        slope = (polynomial.deriv(m) if m else polynomial)(z)
        power = (x + 1j * y) ** m
        columns.append(slope * (power.imag if odd else power.real))
    return np.stack(columns, axis=1)


def ground(latitude: Rows) -> Rows:
    """Distance of the WGS 84 ellipsoid from the Earth's centre [m], at geocentric latitudes [rad]."""
    squeezed = EARTH_FLATTENING * (2.0 - EARTH_FLATTENING)
    polar = EARTH_EQUATORIAL_RADIUS * (1.0 - EARTH_FLATTENING)
    return np.asarray(polar / np.sqrt(1.0 - squeezed * np.cos(latitude) ** 2))


def geodetic(latitude: Rows, radius: Rows) -> tuple[Rows, Rows]:
    """Latitude [rad] and height [m] over the WGS 84 ellipsoid, of geocentric latitudes [rad] and distances [m].

        z = (N (1 - e^2) + h) sin(phi),   p = (N + h) cos(phi),   N = R/sqrt(1 - e^2 sin^2(phi))

    Source   Vallado (2013), algorithm 12, by turns; four leave 1e-11 rad
    Checked  tests/tethered_deorbit/test_msis.py, against astropy
    """
    squeezed = EARTH_FLATTENING * (2.0 - EARTH_FLATTENING)
    p, z = radius * np.cos(latitude), radius * np.sin(latitude)
    found = latitude
    for _ in range(6):
        curved = EARTH_EQUATORIAL_RADIUS / np.sqrt(1.0 - squeezed * np.sin(found) ** 2)
        found = np.arctan2(z + squeezed * curved * np.sin(found), p)
    curved = EARTH_EQUATORIAL_RADIUS / np.sqrt(1.0 - squeezed * np.sin(found) ** 2)
    height = p * np.cos(found) + z * np.sin(found) - curved * (1.0 - squeezed * np.sin(found) ** 2)
    return np.asarray(found), np.asarray(height)


def densities(
    altitudes: Rows, latitude: Rows, hour: Rows, epoch: float, f107: float, f107_average: float, ap: float
) -> Rows:
    """ln of the density [kg/m^3] (n, altitudes), in the mean over the day; `Undesigned` without pymsis.

    altitudes            distance from the centre less that of the ellipsoid [m]
    latitude, hour       geocentric [rad], local solar [rad] from noon (n,)
    epoch                UTC since 2000-01-01 12:00 [s]
    f107, f107_average, ap   of the day before, of 81 days [sfu]; planetary index
    """
    try:
        import pymsis
    except ImportError:
        raise Undesigned("air.law", "nrlmsis", "needs pymsis: pip install 'dcone-cosim[air]'") from None
    day = (np.datetime64("2000-01-01T12:00:00") + np.timedelta64(round(epoch), "s")).astype("datetime64[D]")
    size, count = len(latitude), len(altitudes)
    across, radius = np.repeat(latitude, count), np.repeat(ground(latitude), count) + np.tile(altitudes, size)
    north, height = geodetic(across, radius)
    found = np.zeros((size, count))
    for k in range(HOURS):
        minutes = 1440 * k // HOURS
        east = np.degrees(hour) + 180.0 - 360.0 * minutes / 1440.0
        out = pymsis.calculate(
            np.full(size * count, day + np.timedelta64(minutes, "m")),
            np.repeat(np.remainder(east, 360.0), count),
            np.degrees(north),
            height / 1e3,
            # all of them: it would fetch what it is not given
            f107s=np.full(size * count, f107),
            f107as=np.full(size * count, f107_average),
            aps=np.full((size * count, 7), ap),
            version=VERSION,
        )
        found += np.log(out[:, pymsis.Variable.MASS_DENSITY].reshape(size, count))
    return found / HOURS


def _grid() -> tuple[Rows, Rows, Rows]:
    """Latitudes, hours [rad] and weights by which all harmonics are told apart."""
    z, weight = (np.asarray(row, float) for row in np.polynomial.legendre.leggauss(2 * DEGREE + 2))
    hour = 2.0 * math.pi * np.arange(2 * DEGREE + 4) / (2 * DEGREE + 4)
    latitude, hours = np.meshgrid(np.arcsin(z), hour, indexing="ij")
    return latitude.ravel(), hours.ravel(), np.repeat(weight, len(hour))


def _altitudes() -> Rows:
    """Of the table [m]."""
    return np.asarray(LOW + SPACING * np.arange(COUNT), dtype=float)


def _splines(values: Rows) -> Rows:
    """Coefficients of natural cubic B-splines (n + 2, ...) through values at even spaces (n, ...)."""
    n = len(values)
    matrix = np.zeros((n + 2, n + 2))
    for i in range(n):
        matrix[i + 1, i : i + 3] = 1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0
    matrix[0, :3] = matrix[-1, -3:] = 1.0, -2.0, 1.0
    edge = np.zeros((1, *values.shape[1:]))
    return np.linalg.solve(matrix, np.concatenate([edge, values, edge]))


def table(epoch: float, f107: float, f107_average: float, ap: float) -> Rows:
    """The table (93, 49). Arguments as in `densities`."""
    latitude, hour, weight = _grid()
    altitudes = _altitudes()
    z, across = np.sin(latitude), np.cos(latitude)
    basis = harmonics(across * np.cos(hour), across * np.sin(hour), z)
    values = densities(altitudes, latitude, hour, epoch, f107, f107_average, ap)
    root = np.sqrt(weight)[:, None]
    fitted = np.linalg.lstsq(root * basis, root * values, rcond=None)[0]
    return _splines(np.asarray(fitted.T, dtype=float))


def lay(values: Mapping[str, float], sources: Mapping[str, Any]) -> Laid:
    """The table of the scene's epoch and indices."""
    return Laid(
        {NAME: table(values["orbit.epoch"], *(values[f"air.{name}"] for name in ("f107", "f107_average", "ap")))}, {}
    )


def mean_profile(values: Mapping[str, float]) -> Callable[[Rows], Rows]:
    """Density [kg/m^3] of altitudes over the equatorial radius [m], as `orbital.decay` counts them: the mean over an
    orbit of that inclination, wherever its perigee and its node are."""
    along = 2.0 * math.pi * (np.arange(PLACES) + 0.5) / PLACES
    turned = 2.0 * math.pi * np.arange(PLACES) / PLACES
    up, hours = np.meshgrid(np.arcsin(np.sin(values["orbit.inclination"]) * np.sin(along)), turned, indexing="ij")
    latitude, hour = up.ravel(), hours.ravel()
    altitudes = _altitudes()
    indices = (values[f"air.{name}"] for name in ("f107", "f107_average", "ap"))
    found = densities(altitudes, latitude, hour, values["orbit.epoch"], *indices)
    higher = EARTH_EQUATORIAL_RADIUS - ground(latitude)
    rows = [np.interp(altitudes + more, altitudes, row) for more, row in zip(higher, found, strict=True)]
    mean = np.log(np.mean(np.exp(rows), axis=0))
    return lambda altitude: np.exp(np.interp(altitude, altitudes, mean))
