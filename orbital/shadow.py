"""The Earth's shadow: a cylinder behind it, or the two cones of a Sun that is a disc."""

from __future__ import annotations

import math

from orbital.kernel import kernel
from orbital.vectors import Array, dot, norm

LIT, PENUMBRA, UMBRA = range(3)


@kernel
def cylinder_zone(position: Array, sun: Array, radius: float) -> int:
    """LIT, or UMBRA inside the cylinder behind the Earth.

        r . s < 0  and  |r - (r . s) s| < R,   s a unit vector to the Sun

    position      r      from the Earth's centre                 [m]        (3,)
    sun                  place of the Sun                        [m]        (3,)
    radius        R      of the Earth                            [m]

    Valid    a Sun far away and without extent
    Source   Vallado, Fundamentals of astrodynamics and applications (2013), section 5.3.2
    Checked  tests/orbital/test_shadow.py
    """
    along = dot(position, sun) / norm(sun)
    if along < 0.0 and dot(position, position) - along * along < radius * radius:
        return UMBRA
    return LIT


@kernel
def disc_angles(position: Array, sun: Array, radius: float, sun_radius: float) -> tuple[float, float, float]:
    """Half-angles of the discs of Sun and Earth as seen from a place, and the angle between their centres [rad].

        a = asin(R_s/|s - r|),   b = asin(R/r),   c = angle of -r and s - r

    Source   Montenbruck and Gill, Satellite orbits (2000), section 3.4.2
    Checked  tests/orbital/test_shadow.py
    """
    x, y, z = sun[0] - position[0], sun[1] - position[1], sun[2] - position[2]
    away, height = math.sqrt(x * x + y * y + z * z), norm(position)
    cosine = -(x * position[0] + y * position[1] + z * position[2]) / (away * height)
    apart = math.acos(max(-1.0, min(1.0, cosine)))
    return math.asin(sun_radius / away), math.asin(min(1.0, radius / height)), apart


@kernel
def cone_zone(position: Array, sun: Array, radius: float, sun_radius: float) -> int:
    """LIT, PENUMBRA where the Earth hides part of the Sun, or UMBRA where it hides all of it.

    position      r      from the Earth's centre                 [m]        (3,)
    sun           s      place of the Sun                        [m]        (3,)
    radius        R      of the Earth                            [m]
    sun_radius    R_s    of the Sun                              [m]

    Valid    a round Earth without air, below the end of its umbra (1.4 million km): farther away there is none
    Source   `disc_angles`: c >= a + b, else c <= b - a
    Checked  tests/orbital/test_shadow.py
    """
    a, b, c = disc_angles(position, sun, radius, sun_radius)
    if c >= a + b:
        return LIT
    return UMBRA if c <= b - a else PENUMBRA


@kernel
def lit_share(position: Array, sun: Array, radius: float, sun_radius: float) -> float:
    """Share of the Sun's disc that the Earth does not hide [-].

        1 - A/(pi a^2),   A = a^2 acos(x/a) + b^2 acos((c - x)/b) - c y
        x = (c^2 + a^2 - b^2)/(2 c),   y = sqrt(a^2 - x^2)

    The arguments as in `cone_zone`.

    Valid    discs of even brightness; no darkening towards the Sun's rim, no refraction
    Source   Montenbruck and Gill (2000), eq. 3.87 to 3.94
    Checked  tests/orbital/test_shadow.py, against points counted on the disc
    """
    a, b, c = disc_angles(position, sun, radius, sun_radius)
    if c >= a + b:
        return 1.0
    if c <= b - a:
        return 0.0
    if c <= a - b:
        return 1.0 - b * b / (a * a)
    x = (c * c + a * a - b * b) / (2.0 * c)
    y = math.sqrt(max(0.0, a * a - x * x))
    hidden = a * a * math.acos(max(-1.0, min(1.0, x / a))) + b * b * math.acos(max(-1.0, min(1.0, (c - x) / b))) - c * y
    return max(0.0, min(1.0, 1.0 - hidden / (math.pi * a * a)))
