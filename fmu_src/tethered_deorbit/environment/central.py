"""The Earth as a point mass: gravity on the pair, as what it does to the centre of mass and to the relative vector."""

from __future__ import annotations

import math
from typing import Any

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.environment import Environment
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.interface import BAD_CHORD, BAD_ORBIT
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from orbital.frames import orbital_basis, relative_to_inertial
from orbital.kepler import elements_to_state
from orbital.kernel import kernel
from orbital.twobody import (
    differential_gravity,
    mean_motion,
    semi_major_axis,
    specific_energy,
    two_body_acceleration,
)
from orbital.vectors import Array, dot, norm

CHORD_ITERATIONS = 60


@kernel
def begin(record: Any) -> None:
    """Mean motion of the reference orbit, which is also the pace of what happens on it [rad/s].

    Checked  tests/tethered_deorbit/test_start.py
    """
    r = record[0]
    r.state_mean_motion = mean_motion(EARTH_EQUATORIAL_RADIUS + r.orbit_altitude, EARTH_MU)
    r.state_pace = r.state_mean_motion


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
def place(record: Any, position: Array, velocity: Array) -> float:
    """The reference orbit's point at the start [m], [m/s], inertial, and its orbital frame: see `Environment`.

    Source   `orbital.kepler.elements_to_state`, `orbital.frames.orbital_basis`
    Checked  tests/tethered_deorbit/test_start.py
    """
    r = record[0]
    _orbit_state(record, position, velocity, r.orbit_true_anomaly)
    rate: float = orbital_basis(r.state_basis, position, velocity)
    return rate


@kernel
def add_gravity(record: Any, state: Array, rate: Array) -> None:
    """Rate of the state under gravity alone [m/s, m/s^2]; writes all twelve components.

        r_c = R - (m_t/M) rho,   r_t = R + (m_c/M) rho
        R''   = g(R) + (m_c (g(r_c) - g(R)) + m_t (g(r_t) - g(R))) / M
        rho'' = (g(r_t) - g(R)) - (g(r_c) - g(R))

    state         R, V, rho, rho'  of `layout`                   (12,)

    The two differences are each formed without cancellation and have opposite signs: nothing is lost in between.

    Valid    point masses about a point mass, any length of line
    Source   Newton for two bodies; Battin's f(q) in `orbital.twobody`
    Checked  tests/tethered_deorbit/test_terms.py, against the difference of two accelerations in 50 digits
    """
    r = record[0]
    position = state[0:3]
    chaser = rate[0:3]
    target = rate[6:9]
    center = rate[3:6]
    for i in range(3):
        chaser[i] = -r.state_target_share * state[6 + i]
        target[i] = r.state_chaser_share * state[6 + i]
    differential_gravity(chaser, position, chaser, EARTH_MU)
    differential_gravity(target, position, target, EARTH_MU)
    two_body_acceleration(center, position, EARTH_MU)
    for i in range(3):
        center[i] += r.state_chaser_share * chaser[i] + r.state_target_share * target[i]
        rate[9 + i] = target[i] - chaser[i]
        rate[i] = state[3 + i]
        rate[6 + i] = state[9 + i]


@kernel
def gravity_apart(position: Array, offset: Array, out: Array) -> None:
    """out = gravity at the end of an offset less that where it starts [m/s^2], without cancellation.

    Source   `orbital.twobody.differential_gravity`
    Checked  tests/tethered_deorbit/test_nodes.py
    """
    differential_gravity(out, position, offset, EARTH_MU)


@kernel
def along_track(record: Any, state: Array) -> tuple[float, float, float]:
    """Direction of the chaser's along-track, as long as its velocity across the vertical [m/s].

        u = h x r,   h = r x v,   so u/(r.r) = v - r (r.v)/(r.r)

    state         R, V, rho, rho'  of `layout`                   (12,)

    Valid    r and v of the chaser not parallel
    Source   the frame of `orbital.frames`
    Checked  tests/tethered_deorbit/test_terms.py; test_uncompiled.py: its work round an ellipse
    """
    share = record[0].state_target_share
    x, y, z = state[0] - share * state[6], state[1] - share * state[7], state[2] - share * state[8]
    u, v, w = state[3] - share * state[9], state[4] - share * state[10], state[5] - share * state[11]
    radial = (x * u + y * v + z * w) / (x * x + y * y + z * z)
    return u - radial * x, v - radial * y, w - radial * z


@kernel
def gradient(position: Array) -> float:
    """What the gradient of gravity turns a body by, over its moments of inertia [1/(m2 s2)]: 3 mu/r^5.

    Source   `orbital.rigid.gradient_torque`
    Checked  tests/tethered_deorbit/test_rigid.py
    """
    square = dot(position, position)
    return 3.0 * EARTH_MU / (square * square * math.sqrt(square))


@kernel
def fallen(position: Array) -> float:
    """Distance [m] from the Earth's centre of what has come below the equatorial radius, or -1.

    Checked  tests/tethered_deorbit/test_robust.py
    """
    radius = norm(position)
    return radius if radius < EARTH_EQUATORIAL_RADIUS else -1.0


@kernel
def frame(record: Any, position: Array, velocity: Array) -> float:
    """The orbital frame of a point: see `Environment`.

    Source   `orbital.frames.orbital_basis`
    Checked  tests/tethered_deorbit/test_start.py
    """
    rate: float = orbital_basis(record[0].state_basis, position, velocity)
    return rate


@kernel
def publish(record: Any) -> None:
    """Radii, altitude, osculating axis [m] and orbital energy [J], from the outputs of both bodies and the centre.

    Checked  tests/tethered_deorbit/test_start.py
    """
    r = record[0]
    r.chaser_radius = norm(r.chaser_position)
    r.target_radius = norm(r.target_position)
    r.altitude = norm(r.center_position) - EARTH_EQUATORIAL_RADIUS
    r.center_semi_major_axis = semi_major_axis(r.center_position, r.center_velocity, EARTH_MU)
    r.energy_orbital = r.state_total_mass * specific_energy(r.center_position, r.center_velocity, EARTH_MU)


@kernel
def rate_of_radius(position: Array, velocity: Array) -> float:
    """Rate of change of a distance from the origin [m/s].

        r' = r . v / |r|

    position      r                                              [m]    (3,)
    velocity      v                                              [m/s]  (3,)

    Valid    |r| > 0
    Source   derivative of |r|
    Checked  tests/tethered_deorbit/test_derivatives.py
    """
    return dot(position, velocity) / norm(position)


@kernel
def relative_rates(
    basis: Array, position: Array, velocity: Array, acceleration: Array, relative: Array, out: Array
) -> tuple[float, float]:
    """Rates of relative position and velocity as seen from the orbital frame; returns the frame's rate and its change.

        w    = (r f_n / h, 0, n),   n = h / r^2,   n' = f_t / r - 2 n r' / r
        p'   = C rho' - w x p
        q'   = C rho'' - w x C rho' - (0, 0, n') x p - (0, 0, n) x p'

    basis         C      of the frame, rows                      [-]      (3, 3)
    position      r      of the frame's origin, inertial         [m]      (3,)
    velocity             of the frame's origin, inertial         [m/s]    (3,)
    acceleration  f      of the frame's origin, inertial; f_t and f_n along axes 2 and 3   [m/s^2]  (3,)
    relative      rho', rho''  inertial                          [m/s]    (6,)
    out           p on entry; then q', and p' behind it          (6,)

    The turning of the orbital plane, w_1, is part of p' and of the components' own turning, but not of q, which is
    defined without it.

    Valid    r and v not parallel
    Source   derivative of `relative_to_orbital`
    Checked  tests/tethered_deorbit/test_derivatives.py
    """
    radius = norm(position)
    across = dot(basis[1], velocity)
    n = across / radius
    tilt = dot(basis[2], acceleration) / across
    change = (dot(basis[1], acceleration) - 2.0 * n * dot(basis[0], velocity)) / radius
    x, y, z = out[0], out[1], out[2]
    u, v, w = dot(basis[0], relative[0:3]), dot(basis[1], relative[0:3]), dot(basis[2], relative[0:3])
    out[3] = u + n * y
    out[4] = v - n * x + tilt * z
    out[5] = w - tilt * y
    out[0] = dot(basis[0], relative[3:6]) + n * v + change * y + n * out[4]
    out[1] = dot(basis[1], relative[3:6]) - n * u + tilt * w - change * x - n * out[3]
    out[2] = dot(basis[2], relative[3:6]) - tilt * v
    return n, change


@kernel
def differentiate(record: Any, state: Array, rate: Array, shed: float) -> None:
    """Rates of what `publish` fills, at one instant.

        e' = V.(A - g) - g.(R' - V),   a' = 2 a^2/mu e',   E' = M e' + M' e,   g = -mu R/|R|^3,   e the energy per mass

    R' differs from V where mass leaves.

    state, rate   R, V, rho, rho'  of `layout`, inertial         (12,)
    shed          M'     rate of the pair's mass                 [kg/s]

    The acceleration that is not the Kepler orbit's is a difference of accelerations, good to 1e-15 m/s^2.

    Checked  tests/tethered_deorbit/test_derivatives.py
    """
    r = record[0]
    center, velocity = state[0:3], state[3:6]
    room, other = r.state_vector[0], r.state_vector[1]
    for i in range(3):
        room[i] = center[i] - r.state_target_share * state[6 + i]
        other[i] = velocity[i] - r.state_target_share * state[9 + i]
    r.rate_chaser_radius = rate_of_radius(room, other)
    for i in range(3):
        room[i] = center[i] + r.state_chaser_share * state[6 + i]
        other[i] = velocity[i] + r.state_chaser_share * state[9 + i]
    r.rate_target_radius = rate_of_radius(room, other)
    r.rate_altitude = rate_of_radius(center, rate[0:3])
    two_body_acceleration(room, center, EARTH_MU)
    fallen_by = 0.0
    for i in range(3):
        fallen_by += room[i] * (rate[i] - velocity[i])
        room[i] = rate[3 + i] - room[i]
    power = dot(velocity, room) - fallen_by
    semi = semi_major_axis(center, velocity, EARTH_MU)
    r.rate_semi_major_axis = 2.0 * semi * semi / EARTH_MU * power
    r.rate_energy_orbital = r.state_total_mass * power
    r.rate_energy_orbital += shed * specific_energy(center, velocity, EARTH_MU)


def make_central(interface: Interface) -> Environment:
    """The kernels for a record of this interface."""
    altitude_slot, separation_slot = interface.references["orbit.altitude"], interface.references["start.separation"]

    @kernel
    def check(record: Any) -> int:
        """Fault of an orbit whose perigee lies below the equatorial radius, or 0.

        Checked  tests/tethered_deorbit/test_robust.py
        """
        r = record[0]
        if not (EARTH_EQUATORIAL_RADIUS + r.orbit_altitude) * (1.0 - r.orbit_eccentricity) > EARTH_EQUATORIAL_RADIUS:
            return blame(record, BAD_ORBIT, altitude_slot, r.orbit_altitude)
        return 0

    @kernel
    def same_orbit(record: Any, state: Array) -> int:
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
            return blame(record, BAD_CHORD, separation_slot, r.start_separation)
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

    return Environment(
        begin,
        check,
        place,
        same_orbit,
        add_gravity,
        gravity_apart,
        along_track,
        gradient,
        fallen,
        frame,
        publish,
        differentiate,
        relative_rates,
    )
