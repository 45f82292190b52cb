"""What is seen of the pair at a communication point."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from fmu_src.tethered_deorbit.bodies import Bodies
from fmu_src.tethered_deorbit.environment import Environment
from fmu_src.tethered_deorbit.environment.perturbed import Perturbing
from fmu_src.tethered_deorbit.interface import TUGS
from fmu_src.tethered_deorbit.law import Reel
from fmu_src.tethered_deorbit.layout import StateLayout
from orbital.frames import relative_to_orbital
from orbital.hill import hill_jacobi
from orbital.kernel import kernel
from orbital.vectors import Array


@kernel
def clear_tugs(record: Any) -> None:
    """Empty the ring: no tug has been.

    Checked  tests/tethered_deorbit/test_macro_step.py
    """
    r = record[0]
    for i in range(TUGS):
        r.tug_time[i] = 0.0
        r.tug_peak[i] = 0.0
        r.tug_speed[i] = 0.0
    r.tether_tug_count = 0
    r.state_tug_begun = 0
    r.state_tug_peak = 0.0


@kernel
def begin_tug(record: Any, time: float, speed: float) -> None:
    """Keep in mind that the line has gone taut: it becomes a tug as soon as it pulls.

    time          when the line went taut                        [s]
    speed         rate of lengthening then                       [m/s]

    Checked  tests/tethered_deorbit/test_tugs.py
    """
    r = record[0]
    r.state_tug_begun = 1
    r.state_tug_time = time
    r.state_tug_speed = speed
    r.state_tug_peak = 0.0


@kernel
def note_pull(record: Any, tension: float) -> None:
    """Carry the largest tension [N] of the present tug; the first above zero puts it at the head of the ring.

    The oldest tug then falls out of it.

    Checked  tests/tethered_deorbit/test_tugs.py, test_macro_step.py
    """
    r = record[0]
    if not tension > 0.0:
        return
    if r.state_tug_begun == 0:
        r.tug_peak[0] = max(r.state_tug_peak, tension)
        return
    r.state_tug_begun = 0
    for i in range(TUGS - 1):
        j = TUGS - 1 - i
        r.tug_time[j] = r.tug_time[j - 1]
        r.tug_peak[j] = r.tug_peak[j - 1]
        r.tug_speed[j] = r.tug_speed[j - 1]
    r.tug_time[0] = r.state_tug_time
    r.tug_peak[0] = tension
    r.tug_speed[0] = r.state_tug_speed
    r.tether_tug_count += 1


def make_publish(
    reel: Reel, environment: Environment, perturbing: Perturbing, bodies: Bodies, layout: StateLayout
) -> Callable[..., Any]:
    """The kernel that fills the outputs from a state; those that remember (tugs, peak) are kept elsewhere."""
    impulse, by_length = layout.impulse, reel.by_length

    @kernel
    def publish(
        record: Any, state: Array, separation: float, length: float, rate: float, since: float, time: float
    ) -> None:
        """Outputs at one instant; `state` as in `layout`, and `state.taut`, the line's condition there.

        separation    s      of the centres of mass              [m]
        length, rate  of the line                                [m], [m/s]
        since         time   since the inputs in force began to move  [s]
        time                 since the start of the instance     [s]

        energy.relative = m_r (hill_jacobi + k d^2/(2 m_r)) + that of the bodies' turning,   d = l - l0 while taut (a
        locked reel's elastic energy)

        Checked  tests/tethered_deorbit/test_start.py
        """
        r = record[0]
        position, velocity = state[6:9], state[9:12]
        r.separation = separation
        r.tether_length = length
        r.tether_length_rate = rate
        r.tether_impulse = state[impulse]
        r.tether_taut = r.state_taut
        reel.see(record, state)
        r.tether_tension = max(0.0, reel.tension(record, length, rate, since)) if r.state_taut or by_length else 0.0
        for i in range(3):
            r.center_position[i] = state[i]
            r.center_velocity[i] = state[3 + i]
            r.chaser_position[i] = state[i] - r.state_target_share * position[i]
            r.chaser_velocity[i] = state[3 + i] - r.state_target_share * velocity[i]
            r.target_position[i] = state[i] + r.state_chaser_share * position[i]
            r.target_velocity[i] = state[3 + i] + r.state_chaser_share * velocity[i]
        environment.publish(record)
        perturbing.publish(record, time)
        turning = environment.frame(record, r.center_position, r.center_velocity)
        relative_to_orbital(r.relative_position, r.relative_velocity, r.state_basis, turning, position, velocity)
        r.tether_angle = math.atan2(r.relative_position[1], r.relative_position[0])
        r.energy_relative = r.state_reduced_mass * hill_jacobi(r.relative_position, r.relative_velocity, turning)
        bodies.publish(record, state)
        r.energy_relative += bodies.energy(record, state, turning)
        if r.state_taut:
            r.energy_relative += reel.energy(record, length, since)
        reel.publish(record, state, length, rate)

    return publish
