"""How fast the outputs change, and by how much with the inputs: worked out only when somebody asks."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fmu_src.tethered_deorbit.bodies import Bodies
from fmu_src.tethered_deorbit.environment import Environment
from fmu_src.tethered_deorbit.environment.perturbed import Perturbing
from fmu_src.tethered_deorbit.law import Reel
from fmu_src.tethered_deorbit.thrust import Thrust
from orbital.hill import hill_jacobi
from orbital.kernel import kernel
from orbital.vectors import Array, matrix_vector


def make_differentiate(
    inertial: Callable[..., Any],
    reel: Reel,
    thrust: Thrust,
    environment: Environment,
    perturbing: Perturbing,
    bodies: Bodies,
) -> Callable[..., Any]:
    """The kernel that fills the rates and partial derivatives of the outputs.

    inertial      kernel (record, state, rate, since, elapsed): rate of the state along inertial axes
    """

    @kernel
    def differentiate(record: Any, state: Array, rate: Array, separation: float, length: float, speed: float) -> None:
        """Rates at one instant, at which the inputs in force begin to move.

        state         of `layout`, inertial
        rate          room for its rate
        separation    s      of the centres of mass              [m]
        length, speed        of the line, and its rate           [m], [m/s]

            (energy.relative)' = m_r (q.q' - 3 n^2 x x' + n^2 z z' + n n' (z^2 - 3 x^2)) + that of the line and of the
                                 bodies' turning

        What an orbit alone has is the environment's.

        Checked  tests/tethered_deorbit/test_derivatives.py
        """
        r = record[0]
        bodies.stand(record, state)
        inertial(record, state, rate, 0.0, 0.0)
        acceleration, apart, _ = bodies.second(record, state, rate, separation, length, speed, 0.0)
        reel.see(record, state)
        reel.see_change(record, state, rate, 0.0)
        r.rate_length_rate = acceleration
        r.rate_separation = apart
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
        reel.differentiate(record, length, speed, acceleration)
        center, velocity = state[0:3], state[3:6]
        for i in range(3):
            r.rate_center_velocity[i] = rate[3 + i]
        thrust.lose(record, state, rate, -1.0)
        for i in range(3):
            r.rate_chaser_velocity[i] = rate[3 + i] - r.state_target_share * rate[9 + i]
            r.rate_target_velocity[i] = rate[3 + i] + r.state_chaser_share * rate[9 + i]
        thrust.lose(record, state, rate, 1.0)
        environment.differentiate(record, state, rate)
        perturbing.differentiate(record, state[0:3], state[3:6])
        lost = thrust.shed(record, rate)
        r.rate_energy_orbital += lost * r.energy_orbital / r.state_total_mass
        environment.frame(record, center, velocity)
        room, other = r.state_vector[0], r.state_vector[1]
        # rate[0:6] has been read: from here on it is room.
        matrix_vector(room, r.state_basis, state[6:9])
        matrix_vector(other, r.state_basis, state[9:12])
        acting = r.state_vector[2]
        for i in range(3):
            acting[i] = rate[3 + i]
            rate[i] = room[i]
        n, change = environment.relative_rates(r.state_basis, center, velocity, acting, rate[6:12], rate[0:6])
        x, y, z = room[0], room[1], room[2]
        u, v, w = other[0] + n * y, other[1] - n * x, other[2]
        for i in range(3):
            r.rate_relative_velocity[i] = rate[i]
        r.rate_angle = (x * rate[4] - y * rate[3]) / (x * x + y * y) if x * x + y * y > 0.0 else 0.0
        kinetic = u * rate[0] + v * rate[1] + w * rate[2]
        tidal = n * n * (z * rate[5] - 3.0 * x * rate[3]) + n * change * (z * z - 3.0 * x * x)
        r.rate_energy_relative = r.state_reduced_mass * (kinetic + tidal) + line
        # m_r = m_c m_t/(m_c + m_t): what the chaser loses takes of it the square of the target's share
        other[0], other[1], other[2] = u, v, w
        r.rate_energy_relative += lost * r.state_target_share * r.state_target_share * hill_jacobi(room, other, n)
        r.rate_energy_relative += bodies.differentiate(record, state, rate, n, change)
        r.rate_energy_relative += thrust.lighten(record, state, rate, n)

    return differentiate
