"""The state at the start, from one of four named conditions."""

from __future__ import annotations

import math
from typing import Any

from fmu_src.tethered_deorbit.faults import base_slot, blame
from fmu_src.tethered_deorbit.interface import (
    BAD_CHORD,
    BAD_ORBIT,
    BAD_PARAMETER,
    HANDED_OVER,
    NO_LINE,
    SAME_ORBIT,
    START_STRETCHED,
    VBAR,
)
from fmu_src.tethered_deorbit.tether import line_length
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from orbital.frames import orbital_basis, relative_to_inertial, state_to_inertial
from orbital.kepler import elements_to_state
from orbital.kernel import kernel
from orbital.vectors import Array, norm

CHORD_ITERATIONS = 60

ALTITUDE, SEPARATION, RELATIVE_POSITION = (
    base_slot(name) for name in ("orbit.altitude", "start.separation", "start.relative_position[1]")
)


@kernel
def _orbit_state(record: Any, position: Array, velocity: Array, anomaly: float) -> None:
    """Position [m] and velocity [m/s] of a point of the reference orbit, inertial; both are written.

    anomaly       true                                           [rad]

    Source   `orbital.kepler.elements_to_state`
    Checked  tests/tethered_deorbit/test_start.py
    """
    r = record[0]
    elements_to_state(
        position,
        velocity,
        EARTH_EQUATORIAL_RADIUS + r.orbit_altitude,
        r.orbit_eccentricity,
        r.orbit_inclination,
        r.orbit_raan,
        r.orbit_argument_of_perigee,
        anomaly,
        EARTH_MU,
    )


@kernel
def _half_angle(record: Any) -> float:
    """Half the difference in true anomaly [rad] of two points of the orbit a given chord apart, or -1 if there is none.

        s = 2 p sin(d/2) sqrt(1 + 2 e cos nu cos(d/2) + e^2 cos^2(d/2)) / (w1 w2),   w = 1 + e cos(nu -+ d/2)

    by repeated substitution; nu is the anomaly half-way. On a circle s = 2 a sin(d/2).

    Valid    chords of at most a tenth of the semi-latus rectum
    Source   difference of two points of a conic, in the anomalies' sum and difference
    Checked  tests/tethered_deorbit/test_start.py
    """
    r = record[0]
    e, nu = r.orbit_eccentricity, r.orbit_true_anomaly
    latus = (EARTH_EQUATORIAL_RADIUS + r.orbit_altitude) * (1.0 - e * e)
    half = 0.0
    for _ in range(CHORD_ITERATIONS):
        c = e * math.cos(half)
        weight = (1.0 + e * math.cos(nu - half)) * (1.0 + e * math.cos(nu + half))
        sine = 0.5 * r.start_separation * weight / (latus * math.sqrt(1.0 + c * (2.0 * math.cos(nu) + c)))
        if not sine < 0.05:
            return -1.0
        half = math.asin(sine)
    return half


@kernel
def _same_orbit(record: Any, state: Array) -> int:
    """Both bodies on the reference orbit, the chord apart, the centre of the anomalies at the orbit's point.

    The relative state is formed in the axes of the half-way point, in closed form:

        rho  = 2 p sin(d/2)/(w1 w2) (e sin nu cos(d/2), 1 + e cos nu cos(d/2))      radial, transverse
        rho' = -2 sqrt(mu/p) sin(d/2) (1, 0)

    state         R, V, rho, rho'  of `layout`, written          (12,)

    Returns 0 or a fault.

    On a circle that is at rest in the orbital frame, as the reference has it.

    Valid    as `_half_angle`
    Source   difference of two points of a conic, and of their velocities
    Checked  tests/tethered_deorbit/test_start.py
    """
    r = record[0]
    half = _half_angle(record)
    if half < 0.0:
        return blame(record, BAD_CHORD, SEPARATION, r.start_separation)
    e, nu = r.orbit_eccentricity, r.orbit_true_anomaly
    latus = (EARTH_EQUATORIAL_RADIUS + r.orbit_altitude) * (1.0 - e * e)
    sign = 1.0 if r.start_leading == 0 else -1.0
    _orbit_state(record, state[0:3], state[3:6], nu)
    orbital_basis(r.state_basis, state[0:3], state[3:6])
    weight = (1.0 + e * math.cos(nu - half)) * (1.0 + e * math.cos(nu + half))
    size = sign * 2.0 * latus * math.sin(half) / weight
    position, velocity = r.state_vector[0], r.state_vector[1]
    position[0] = size * e * math.sin(nu) * math.cos(half)
    position[1] = size * (1.0 + e * math.cos(nu) * math.cos(half))
    position[2] = 0.0
    velocity[0] = -sign * 2.0 * math.sqrt(EARTH_MU / latus) * math.sin(half)
    velocity[1] = 0.0
    velocity[2] = 0.0
    relative_to_inertial(state[6:9], state[9:12], r.state_basis, 0.0, position, velocity)
    _orbit_state(record, state[0:3], state[3:6], nu - sign * half)
    for i in range(6):
        state[i] += r.state_target_share * state[6 + i]
    return 0


@kernel
def start_state(record: Any, state: Array, longest: float) -> int:
    """Fill the state [m, m/s] (12,) from the parameters; returns 0 or a fault.

        same_orbit      both on the reference orbit, a chord apart
        vbar            rho = (0, +-s, 0) in the orbital frame of the centre of mass, at rest in it
        equal_velocity  the same rho, rho' = 0 in inertial axes
        handed_over     centre of mass and relative vector as given in the orbital frame of the orbit's point

    The plus sign holds when the target leads.

    longest       longest line for the first three               [m]

    Valid    perigee above the equatorial radius
    Source   fmu_src/tethered_deorbit/README.md, What is computed
    Checked  tests/tethered_deorbit/test_start.py
    """
    r = record[0]
    if not (EARTH_EQUATORIAL_RADIUS + r.orbit_altitude) * (1.0 - r.orbit_eccentricity) > EARTH_EQUATORIAL_RADIUS:
        return blame(record, BAD_ORBIT, ALTITUDE, r.orbit_altitude)
    if r.start_condition == HANDED_OVER:
        if not norm(r.start_relative_position) > 0.0:
            return blame(record, NO_LINE, RELATIVE_POSITION, 0.0)
    else:
        if not line_length(record, r.start_separation) > 0.0:
            return blame(record, BAD_PARAMETER, SEPARATION, r.start_separation)
        if line_length(record, r.start_separation) > longest:
            return blame(record, START_STRETCHED, SEPARATION, r.start_separation)
    if r.start_condition == SAME_ORBIT:
        return int(_same_orbit(record, state))
    position, velocity = r.state_vector[0], r.state_vector[1]
    _orbit_state(record, position, velocity, r.orbit_true_anomaly)
    rate = orbital_basis(r.state_basis, position, velocity)
    if r.start_condition == HANDED_OVER:
        state_to_inertial(
            state[0:3],
            state[3:6],
            position,
            velocity,
            r.state_basis,
            rate,
            r.start_center_position,
            r.start_center_velocity,
        )
        relative_to_inertial(
            state[6:9], state[9:12], r.state_basis, rate, r.start_relative_position, r.start_relative_velocity
        )
        return 0
    for i in range(3):
        state[i] = position[i]
        state[3 + i] = velocity[i]
    offset, rest = r.state_vector[2], r.state_vector[3]
    for i in range(3):
        offset[i] = 0.0
        rest[i] = 0.0
    offset[1] = r.start_separation if r.start_leading == 0 else -r.start_separation
    relative_to_inertial(
        state[6:9], state[9:12], r.state_basis, rate if r.start_condition == VBAR else 0.0, offset, rest
    )
    return 0
