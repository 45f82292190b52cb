"""Sun-synchronous orbits: the inclination at which the Earth's flattening turns the node once a year.

Debris worth removing crowds there, so a scene may name an altitude and leave the inclination to this. The rate used is
first order in J2, as in mission tables; higher harmonics shift the inclination by some hundredths of a degree.
"""

import math

from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_J2, EARTH_MU, SUN_MEAN_MOTION


def node_rate(semi_major_axis: float, inclination: float, eccentricity: float = 0.0) -> float:
    """Secular rate of the ascending node by J2 [rad/s], positive eastward.

        d raan/dt = -(3/2) J2 n (R/p)^2 cos i,   p = a (1 - e^2),   n = sqrt(mu/a^3)

    semi_major_axis  a   of the mean orbit                       [m]
    inclination      i   to the equator                          [rad]
    eccentricity     e                                           [-]

    Valid    first order in J2, averaged over a revolution, 0 <= e < 1
    Source   Vallado, Fundamentals of astrodynamics and applications (2013), eq. 9-38
    Checked  tests/orbital/test_sunsync.py, against the averaged equations of motion
    """
    latus = semi_major_axis * (1.0 - eccentricity**2)
    n = math.sqrt(EARTH_MU / semi_major_axis**3)
    return -1.5 * EARTH_J2 * n * (EARTH_EQUATORIAL_RADIUS / latus) ** 2 * math.cos(inclination)


def sun_synchronous_inclination(semi_major_axis: float, eccentricity: float = 0.0) -> float:
    """Inclination [rad] at which the node follows the mean Sun, above pi/2.

        cos i = -2 w_sun a^(7/2) (1 - e^2)^2 / (3 J2 R^2 sqrt(mu))

    semi_major_axis  a   of the mean orbit                       [m]
    eccentricity     e                                           [-]

    Valid    up to 5974 km altitude on a circle; higher up no inclination will do, and ValueError says so
    Source   `node_rate` set equal to the mean motion of the Sun
    Checked  tests/orbital/test_sunsync.py; 98.603 deg at 800 km
    """
    cosine = SUN_MEAN_MOTION / node_rate(semi_major_axis, 0.0, eccentricity)
    if not -1.0 <= cosine <= 0.0:
        raise ValueError(
            f"no sun-synchronous orbit: a = {semi_major_axis} m, e = {eccentricity} would need cos i = {cosine}"
        )
    return math.acos(cosine)


def sun_synchronous_semi_major_axis(inclination: float, eccentricity: float = 0.0) -> float:
    """Semi-major axis [m] at which an orbit of the given inclination is sun-synchronous.

        a = (-3 J2 R^2 sqrt(mu) cos i / (2 w_sun (1 - e^2)^2))^(2/7)

    inclination      i   above pi/2                              [rad]
    eccentricity     e                                           [-]

    Valid    retrograde orbits; ValueError otherwise. That the orbit clears the Earth is not checked
    Source   inverse of `sun_synchronous_inclination`
    Checked  tests/orbital/test_sunsync.py
    """
    cosine = math.cos(inclination)
    if not (math.pi / 2.0 < inclination <= math.pi and 0.0 <= eccentricity < 1.0):
        raise ValueError(f"no sun-synchronous orbit: i = {inclination} rad, e = {eccentricity}; it must be retrograde")
    top = -3.0 * EARTH_J2 * EARTH_EQUATORIAL_RADIUS**2 * math.sqrt(EARTH_MU) * cosine
    bottom = 2.0 * SUN_MEAN_MOTION * (1.0 - eccentricity**2) ** 2
    return float((top / bottom) ** (2.0 / 7.0))
