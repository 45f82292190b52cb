"""Where Sun and Moon stand, and how far the Earth has turned: series of low precision, of the time alone.

Times are counted from 2000-01-01 12:00 in UTC, in days of 86400 s. Axes are the mean equator and equinox of an epoch,
which stay as they are. So what uses this needs no file of positions, begins at any epoch and never ends.
"""

from __future__ import annotations

import math

import numpy as np

from orbital.constants import ASTRONOMICAL_UNIT, DAY
from orbital.kernel import kernel
from orbital.vectors import Array

CENTURY = 36525.0 * DAY
TT_LESS_UTC = 69.184
"""Terrestrial time less UTC since 2017 [s]; sixty years ago it was 35 s less, in which the Moon moves by 0.005 deg."""
DEGREE = math.pi / 180.0

_PRECESSION = 5028.796195 / 3600.0, 1.1054348 / 3600.0
"""General precession in longitude [deg] per century and its square. Capitaine, Wallace and Chapront, Astronomy and
Astrophysics 412 (2003) 567."""

# Multiples of elongation D, anomalies M (Sun) and M' (Moon), argument of latitude F; amplitude of the sine in longitude
# [1e-6 deg]; of the cosine in distance [m]. Terms of 0.002 deg and more.
_LONGITUDE = np.array((
    (0, 0, 1, 0, 6288774, -20905355), (2, 0, -1, 0, 1274027, -3699111), (2, 0, 0, 0, 658314, -2955968),
    (0, 0, 2, 0, 213618, -569925), (0, 1, 0, 0, -185116, 48888), (0, 0, 0, 2, -114332, -3149),
    (2, 0, -2, 0, 58793, 246158), (2, -1, -1, 0, 57066, -152138), (2, 0, 1, 0, 53322, -170733),
    (2, -1, 0, 0, 45758, -204586), (0, 1, -1, 0, -40923, -129620), (1, 0, 0, 0, -34720, 108743),
    (0, 1, 1, 0, -30383, 104755), (2, 0, 0, -2, 15327, 10321), (0, 0, 1, 2, -12528, 0), (0, 0, 1, -2, 10980, 79661),
    (4, 0, -1, 0, 10675, -34782), (0, 0, 3, 0, 10034, -23210), (4, 0, -2, 0, 8548, -21636),
    (2, 1, -1, 0, -7888, 24208), (2, 1, 0, 0, -6766, 30824), (1, 0, -1, 0, -5163, -8379), (1, 1, 0, 0, 4987, -16675),
    (2, -1, 1, 0, 4036, -12831), (2, 0, 2, 0, 3994, -10445), (4, 0, 0, 0, 3861, -11650), (2, 0, -3, 0, 3665, 14403),
    (0, 1, -2, 0, -2689, -7003), (2, 0, -1, 2, -2602, 0), (2, -1, -2, 0, 2390, 10056), (1, 0, 1, 0, -2348, 6322),
    (2, -2, 0, 0, 2236, -9884), (0, 1, 2, 0, -2120, 5751), (0, 2, 0, 0, -2069, 0), (2, -2, -1, 0, 2048, -4950),
), dtype=float)  # fmt: skip

# The same in latitude [1e-6 deg].
_LATITUDE = np.array((
    (0, 0, 0, 1, 5128122), (0, 0, 1, 1, 280602), (0, 0, 1, -1, 277693), (2, 0, 0, -1, 173237), (2, 0, -1, 1, 55413),
    (2, 0, -1, -1, 46271), (2, 0, 0, 1, 32573), (0, 0, 2, 1, 17198), (2, 0, 1, -1, 9266), (0, 0, 2, -1, 8822),
    (2, -1, 0, -1, 8216), (2, 0, -2, -1, 4324), (2, 0, 1, 1, 4200), (2, 1, 0, -1, -3359), (2, -1, -1, 1, 2463),
    (2, -1, 0, 1, 2211), (2, -1, -1, -1, 2065), (0, 1, -1, -1, -1870),
), dtype=float)  # fmt: skip


@kernel
def _centuries(time: float) -> float:
    """Julian centuries of terrestrial time since J2000.

    time          UTC since 2000-01-01 12:00                     [s]

    Checked  tests/orbital/test_sky.py
    """
    return (time + TT_LESS_UTC) / CENTURY


@kernel
def _to_equator(out: Array, longitude: float, latitude: float, distance: float, time: float, epoch: float) -> None:
    """out = place [m] in the equator and equinox of the epoch, from the ecliptic and equinox of date [deg].

    The ecliptic itself turns by 0.013 deg per century, which is left out.

    Checked  tests/orbital/test_sky.py
    """
    t, t0 = _centuries(time), _centuries(epoch)
    longitude -= _PRECESSION[0] * (t - t0) + _PRECESSION[1] * (t * t - t0 * t0)
    tilt = (23.4392911 - 0.0130042 * t0) * DEGREE
    longitude *= DEGREE
    latitude *= DEGREE
    x, y, z = (
        math.cos(latitude) * math.cos(longitude),
        math.cos(latitude) * math.sin(longitude),
        math.sin(latitude),
    )
    out[0] = distance * x
    out[1] = distance * (y * math.cos(tilt) - z * math.sin(tilt))
    out[2] = distance * (y * math.sin(tilt) + z * math.cos(tilt))


@kernel
def sun_place(out: Array, time: float, epoch: float) -> None:
    """out = place of the Sun from the Earth's centre [m], geometric, mean equator and equinox of the epoch.

    time, epoch   UTC since 2000-01-01 12:00                     [s]

    Valid    1950 to 2050: direction within 0.01 deg, distance within 1e-4; aberration (0.006 deg) is left out
    Source   Meeus, Astronomical algorithms (1998), chapter 25
    Checked  tests/orbital/test_sky.py, against astropy's built-in ephemeris
    """
    t = _centuries(time)
    anomaly = (357.52911 + 35999.05029 * t) * DEGREE
    center = (
        (1.914602 - 0.004817 * t) * math.sin(anomaly)
        + (0.019993 - 0.000101 * t) * math.sin(2.0 * anomaly)
        + 0.000289 * math.sin(3.0 * anomaly)
    )
    longitude = 280.46646 + (36000.76983 + 0.0003032 * t) * t + center
    e = 0.016708634 - 0.000042037 * t
    distance = 1.000001018 * (1.0 - e * e) / (1.0 + e * math.cos(anomaly + center * DEGREE))
    _to_equator(out, longitude, 0.0, distance * ASTRONOMICAL_UNIT, time, epoch)


@kernel
def moon_place(out: Array, time: float, epoch: float) -> None:
    """out = place of the Moon from the Earth's centre [m], geometric, mean equator and equinox of the epoch.

    time, epoch   UTC since 2000-01-01 12:00                     [s]

    Valid    1950 to 2050: direction within 0.02 deg, 0.006 deg in the mean; distance within 1e-4
    Source   Meeus (1998), chapter 47: the largest terms of ELP-2000/82
    Checked  tests/orbital/test_sky.py, against astropy's built-in ephemeris
    """
    t = _centuries(time)
    mean = 218.3164477 + (481267.88123421 - 0.0015786 * t) * t
    elongation = (297.8501921 + (445267.1114034 - 0.0018819 * t) * t) * DEGREE
    sun = (357.5291092 + (35999.0502909 - 0.0001536 * t) * t) * DEGREE
    moon = (134.9633964 + (477198.8675055 + 0.0087414 * t) * t) * DEGREE
    node = (93.2720950 + (483202.0175233 - 0.0036539 * t) * t) * DEGREE
    e = 1.0 - 0.002516 * t
    longitude, latitude, distance = 0.0, 0.0, 385000560.0
    for i in range(_LONGITUDE.shape[0]):
        row = _LONGITUDE[i]
        angle = row[0] * elongation + row[1] * sun + row[2] * moon + row[3] * node
        weight = 1.0 if row[1] == 0.0 else (e if abs(row[1]) == 1.0 else e * e)
        longitude += weight * row[4] * math.sin(angle)
        distance += weight * row[5] * math.cos(angle)
    for i in range(_LATITUDE.shape[0]):
        row = _LATITUDE[i]
        angle = row[0] * elongation + row[1] * sun + row[2] * moon + row[3] * node
        latitude += (1.0 if row[1] == 0.0 else e) * row[4] * math.sin(angle)
    longitude += 3958.0 * math.sin((119.75 + 131.849 * t) * DEGREE) + 1962.0 * math.sin(mean * DEGREE - node)
    latitude -= 2235.0 * math.sin(mean * DEGREE)
    _to_equator(out, mean + 1e-6 * longitude, 1e-6 * latitude, distance, time, epoch)


@kernel
def greenwich_angle(time: float, epoch: float) -> float:
    """Angle from the mean equinox of the epoch to the meridian of Greenwich along the equator [rad], not reduced.

        ERA(t) + p(t_0),   ERA = 2 pi (0.7790572732640 + 1.00273781191135448 d)

    time, epoch   UTC since 2000-01-01 12:00                     [s]

    Valid    UT1 for UTC: 0.004 deg; to 0.01 deg in the first year after the epoch
    Source   IERS Conventions 2010, eq. 5.15; precession in right ascension of Capitaine et al. (2003), linear part
    Checked  tests/orbital/test_sky.py, against astropy
    """
    days = time / DAY
    turned = 0.7790572732640 + (days - math.floor(days)) + 0.00273781191135448 * days
    return 2.0 * math.pi * turned + (4612.156534 / 3600.0 * _centuries(epoch)) * DEGREE
