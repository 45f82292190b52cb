"""The Sun's light: the Earth's shadow, which the pair passes through, and the pressure of what it is lit by."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from fmu_src.tethered_deorbit.acting import Acting
from fmu_src.tethered_deorbit.environment.disturbing import Disturbing
from orbital.constants import (
    ASTRONOMICAL_UNIT,
    EARTH_EQUATORIAL_RADIUS,
    SOLAR_RADIATION_PRESSURE,
    SUN_RADIUS,
)
from orbital.kernel import kernel
from orbital.shadow import LIT, PENUMBRA, cone_zone, cylinder_zone, lit_share
from orbital.vectors import Array, dot, norm

LOOK, FAR_LOOK = 0.05, 0.25
"""Angle by which the pair may go on between two looks for the shadow, near its edges and far from them [rad]; in low
orbit that takes 50 s and four minutes."""


def make_shadow(shape: str, point_sky: Callable[..., Any]) -> tuple[Disturbing, Acting]:
    """The shadow as a `cylinder` or a `cone`, and when the pair enters and leaves it.

    Steps end at its edges, found in the motion of the centre of mass, and begin anew there: light comes and goes by
    jumps, or with the jump of its slope at the edges of a penumbra.

    point_sky     as in `sky.make_point_sky`

    Valid    both bodies in the light at once: 20 km of line pass an edge within 3 s. A shadow that is grazed for less
             than a twentieth of a radian of the orbit may be missed
    Checked  tests/tethered_deorbit/test_sky.py
    """
    cone = shape == "cone"

    @kernel
    def zone(record: Any, position: Array) -> int:
        """Where a place [m] lies, seen from which the Sun has been pointed to.

        Checked  tests/orbital/test_shadow.py
        """
        if cone:
            return int(cone_zone(position, record[0].state_sun, EARTH_EQUATORIAL_RADIUS, SUN_RADIUS))
        return int(cylinder_zone(position, record[0].state_sun, EARTH_EQUATORIAL_RADIUS))

    @kernel
    def light_up(record: Any, position: Array) -> None:
        """How much of the Sun is seen from a place [m], in the zone that it was last found in.

        Checked  tests/tethered_deorbit/test_sky.py
        """
        r = record[0]
        if cone and r.state_zone == PENUMBRA:
            r.state_lit = lit_share(position, r.state_sun, EARTH_EQUATORIAL_RADIUS, SUN_RADIUS)
        else:
            r.state_lit = 1.0 if r.state_zone == LIT else 0.0

    @kernel
    def add(record: Any, state: Array, rate: Array) -> None:
        """See `light_up`.

        Checked  tests/tethered_deorbit/test_sky.py
        """
        light_up(record, state[0:3])

    @kernel
    def publish(record: Any, time: float) -> None:
        """Light, and time in shadow up to now [s].

        Checked  tests/tethered_deorbit/test_sky.py: share of the orbit
        """
        r = record[0]
        light_up(record, r.center_position)
        r.shadow_lit = r.state_lit
        r.shadow_time = r.state_dark_time + (time - r.state_dark_since if r.state_zone != LIT else 0.0)
        r.shadow_count = r.state_shadows

    @kernel
    def begin(record: Any, state: Array) -> int:
        """In which zone the tow begins.

        Checked  tests/tethered_deorbit/test_sky.py
        """
        r = record[0]
        point_sky(record, 0.0, 0.0)
        r.state_zone = zone(record, state[0:3])
        r.state_shadows = 1 if r.state_zone != LIT else 0
        r.state_dark_since = 0.0
        r.state_dark_time = 0.0
        light_up(record, state[0:3])
        return 0

    @kernel
    def longest(record: Any, state: Array) -> float:
        """Longest step [s]: half the way to the edge of the shadow, as far as that is within the two bounds.

        Checked  tests/tethered_deorbit/test_sky.py
        """
        r = record[0]
        point_sky(record, r.state_begin, 0.0)
        radius = norm(state[0:3])
        cosine = -dot(state[0:3], r.state_sun) / (radius * norm(r.state_sun))
        from_axis = math.acos(max(-1.0, min(1.0, cosine)))
        room = abs(from_axis - math.asin(min(1.0, EARTH_EQUATORIAL_RADIUS / radius)))
        return float(min(FAR_LOOK, max(LOOK, 0.5 * room)) * radius / norm(state[3:6]))

    @kernel
    def holds(record: Any, state: Array, since: float) -> bool:
        """Whether it is where it was.

        Checked  tests/tethered_deorbit/test_sky.py
        """
        r = record[0]
        elapsed = since - r.state_since
        point_sky(record, r.state_begin + elapsed, elapsed)
        return bool(zone(record, state[0:3]) == r.state_zone)

    @kernel
    def act(record: Any, state: Array, time: float, by_state: bool) -> int:
        """Enter another zone, if it is one.

        Checked  tests/tethered_deorbit/test_sky.py
        """
        r = record[0]
        point_sky(record, time, 0.0)
        found = zone(record, state[0:3])
        if r.state_zone == LIT and found != LIT:
            r.state_dark_since = time
            r.state_shadows += 1
        elif r.state_zone != LIT and found == LIT:
            r.state_dark_time += time - r.state_dark_since
        r.state_zone = found
        light_up(record, state[0:3])
        return 0

    return Disturbing(add, publish), Acting(begin=begin, longest=longest, holds=holds, act=act)


@kernel
def pressure(record: Any) -> float:
    """Of the light where the pair is [Pa]: P (AU/d)^2 times the share that is seen.

    Checked  tests/tethered_deorbit/test_sky.py
    """
    r = record[0]
    far = ASTRONOMICAL_UNIT * ASTRONOMICAL_UNIT / dot(r.state_sun, r.state_sun)
    return float(SOLAR_RADIATION_PRESSURE * far * r.state_lit)


@kernel
def add_pressure(record: Any, state: Array, rate: Array) -> None:
    """Add the pressure of the light on both bodies to the rate of the pair [m/s^2]; after the shadow.

        F = -P c A s,   R'' += (F_c + F_t)/M,   rho'' += F_t/m_t - F_c/m_c,   s a unit vector to the Sun

    state, rate   R, V, rho, rho'  of `layout`                   (12,)

    Valid    bodies that show the light the same area from all sides; parallel light
    Source   Montenbruck and Gill, Satellite orbits (2000), section 3.4
    Checked  tests/tethered_deorbit/test_sky.py
    """
    r = record[0]
    push = -pressure(record) * r.sunlight_coefficient / (math.sqrt(dot(r.state_sun, r.state_sun)) * r.state_total_mass)
    both = push * (r.sunlight_chaser_area + r.sunlight_target_area)
    apart = push * (r.sunlight_target_area / r.state_target_share - r.sunlight_chaser_area / r.state_chaser_share)
    for i in range(3):
        rate[3 + i] += both * r.state_sun[i]
        rate[9 + i] += apart * r.state_sun[i]


@kernel
def publish_pressure(record: Any, time: float) -> None:
    """Forces of the light [N].

    Checked  tests/tethered_deorbit/test_sky.py
    """
    r = record[0]
    force = pressure(record) * r.sunlight_coefficient
    r.sunlight_chaser_force = force * r.sunlight_chaser_area
    r.sunlight_target_force = force * r.sunlight_target_area


PRESSURE = Disturbing(add_pressure, publish_pressure)
