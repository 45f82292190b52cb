"""How fast the outputs change, and by how much with the inputs: worked out only when somebody asks."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fmu_src.tethered_deorbit.law import Reel
from fmu_src.tethered_deorbit.tether import length_acceleration, line_length
from orbital.constants import EARTH_MU
from orbital.frames import orbital_basis
from orbital.kernel import kernel
from orbital.twobody import semi_major_axis, two_body_acceleration
from orbital.vectors import Array, dot, matrix_vector, norm


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


def make_differentiate(inertial: Callable[..., Any], reel: Reel) -> Callable[..., Any]:
    """The kernel that fills the rates and partial derivatives of the outputs.

    inertial      kernel (record, state, rate, since): rate of the state along inertial axes
    """

    @kernel
    def differentiate(record: Any, state: Array, rate: Array, separation: float, speed: float) -> None:
        """Rates at one instant, at which the inputs in force begin to move.

        state         R, V, rho, rho'  of `layout`, inertial     (13,)
        rate          room for its rate                          (13,)
        separation    s      of the centres of mass              [m]
        speed         s'     its rate, which is the line's       [m/s]

            a' = 2 a^2/mu V.(A - g),   E' = M V.(A - g),   g = -mu R/|R|^3
            (energy.relative)' = m_r (q.q' - 3 n^2 x x' + n^2 z z' + n n' (z^2 - 3 x^2)) + that of the line

        The acceleration that is not the Kepler orbit's is a difference of accelerations, good to 1e-15 m/s^2.

        Checked  tests/tethered_deorbit/test_derivatives.py
        """
        r = record[0]
        inertial(record, state, rate, 0.0)
        acceleration = length_acceleration(state[6:9], state[9:12], rate[9:12], separation, speed)
        length = line_length(record, separation)
        r.rate_length_rate = acceleration
        r.rate_tension = 0.0
        r.partial_tension = 0.0
        r.partial_energy = 0.0
        r.partial_jump = 0.0
        line = 0.0
        if r.state_taut:
            tension = reel.tension(record, length, speed, 0.0)
            slope = reel.tension_rate(record, length, speed, acceleration, 0.0)
            by_tension, by_energy = reel.partials(record, length, speed)
            if tension > 0.0 or (tension == 0.0 and slope > 0.0):
                r.rate_tension = slope
                r.partial_tension = by_tension
            r.partial_energy = by_energy
            line = reel.energy_rate(record, length, speed, 0.0)
        center, velocity = state[0:3], state[3:6]
        for i in range(3):
            r.rate_center_velocity[i] = rate[3 + i]
            r.rate_chaser_velocity[i] = rate[3 + i] - r.state_target_share * rate[9 + i]
            r.rate_target_velocity[i] = rate[3 + i] + r.state_chaser_share * rate[9 + i]
        room, other = r.state_vector[0], r.state_vector[1]
        for i in range(3):
            room[i] = center[i] - r.state_target_share * state[6 + i]
            other[i] = velocity[i] - r.state_target_share * state[9 + i]
        r.rate_chaser_radius = rate_of_radius(room, other)
        for i in range(3):
            room[i] = center[i] + r.state_chaser_share * state[6 + i]
            other[i] = velocity[i] + r.state_chaser_share * state[9 + i]
        r.rate_target_radius = rate_of_radius(room, other)
        r.rate_altitude = rate_of_radius(center, velocity)
        two_body_acceleration(room, center, EARTH_MU)
        for i in range(3):
            room[i] = rate[3 + i] - room[i]
        power = dot(velocity, room)
        semi = semi_major_axis(center, velocity, EARTH_MU)
        r.rate_semi_major_axis = 2.0 * semi * semi / EARTH_MU * power
        r.rate_energy_orbital = r.state_total_mass * power
        orbital_basis(r.state_basis, center, velocity)
        # rate[0:6] has been read: from here on it is room.
        matrix_vector(room, r.state_basis, state[6:9])
        matrix_vector(other, r.state_basis, state[9:12])
        acting = r.state_vector[2]
        for i in range(3):
            acting[i] = rate[3 + i]
            rate[i] = room[i]
        n, change = relative_rates(r.state_basis, center, velocity, acting, rate[6:12], rate[0:6])
        x, y, z = room[0], room[1], room[2]
        u, v, w = other[0] + n * y, other[1] - n * x, other[2]
        for i in range(3):
            r.rate_relative_velocity[i] = rate[i]
        r.rate_angle = (x * rate[4] - y * rate[3]) / (x * x + y * y) if x * x + y * y > 0.0 else 0.0
        kinetic = u * rate[0] + v * rate[1] + w * rate[2]
        tidal = n * n * (z * rate[5] - 3.0 * x * rate[3]) + n * change * (z * z - 3.0 * x * x)
        r.rate_energy_relative = r.state_reduced_mass * (kinetic + tidal) + line

    return differentiate
