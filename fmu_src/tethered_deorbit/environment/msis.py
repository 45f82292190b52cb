"""Air whose density is read off a table of harmonics: see `air_table`."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from fmu_src.tethered_deorbit.air_table import COUNT, DEGREE, LOW, SPACING
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_FLATTENING
from orbital.kernel import kernel
from orbital.vectors import Array, cross, dot, norm

POLAR_RADIUS = EARTH_EQUATORIAL_RADIUS * (1.0 - EARTH_FLATTENING)
SQUEEZED = EARTH_FLATTENING * (2.0 - EARTH_FLATTENING)
"""Square of the ellipsoid's eccentricity [-]."""


def make_density(reader: Any) -> Callable[..., Any]:
    """The kernel `density(record, position)` [kg/m^3]; after the Earth's axis and the Sun have been pointed to.

    reader        of the table

    Checked  tests/tethered_deorbit/test_msis.py, against pymsis
    """

    @kernel
    def density(record: Any, position: Array) -> float:
        """Density of the air at a place [kg/m^3].

        position      from the Earth's centre, along the axes of the step [m] (3,)

        Valid    100 to 1000 km; 1 % of what the model says there in the mean over longitude
        Source   the formula of `air_table`; Emmert et al., Earth and Space Science 8 (2021) e2020EA001321
        Checked  tests/tethered_deorbit/test_msis.py
        """
        r = record[0]
        rows = reader(r)
        pole, east = r.state_pole, r.state_perturbing[0]
        radius = norm(position)
        z = dot(position, pole) / radius
        cross(east, pole, r.state_sun)
        scale = 1.0 / (norm(east) * radius)
        y = dot(position, east) * scale
        along = dot(position, r.state_sun) - z * radius * dot(r.state_sun, pole)
        x = along * scale
        ground = POLAR_RADIUS / math.sqrt(1.0 - SQUEEZED * (1.0 - z * z))
        place = (radius - ground - LOW) / SPACING
        inside = min(max(place, 0.0), COUNT - 1.0)
        first = min(int(inside), COUNT - 2)
        t = inside - first
        u = 1.0 - t
        a, d = u * u * u / 6.0, t * t * t / 6.0
        b, c = 2.0 / 3.0 - t * t * (1.0 - 0.5 * t), 2.0 / 3.0 - u * u * (1.0 - 0.5 * u)
        beyond = place - inside
        if beyond != 0.0:
            slope_a, slope_d = -0.5 * u * u, 0.5 * t * t
            slope_b, slope_c = t * (1.5 * t - 2.0), -u * (1.5 * u - 2.0)
            a += beyond * slope_a
            b += beyond * slope_b
            c += beyond * slope_c
            d += beyond * slope_d
        total, column, real, imaginary, start = 0.0, 0, 1.0, 0.0, 1.0
        for m in range(DEGREE + 1):
            before, slope = 0.0, start
            for degree in range(m, DEGREE + 1):
                for _ in range(2 if m > 0 else 1):
                    part = imaginary if _ == 1 else real
                    value = (
                        a * rows[first, column]
                        + b * rows[first + 1, column]
                        + c * rows[first + 2, column]
                        + d * rows[first + 3, column]
                    )
                    total += value * slope * part
                    column += 1
                nearer = ((2.0 * degree + 1.0) * z * slope - (degree + m) * before) / (degree - m + 1.0)
                before, slope = slope, nearer
            real, imaginary = real * x - imaginary * y, real * y + imaginary * x
            start *= 2.0 * m + 1.0
        return math.exp(total)

    return density
