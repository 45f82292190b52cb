"""The state at the start, from one of four named conditions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.bodies import Bodies
from fmu_src.tethered_deorbit.environment import Environment
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.interface import HANDED_OVER, NO_LINE, SAME_ORBIT, VBAR
from orbital.frames import relative_to_inertial, state_to_inertial
from orbital.kernel import kernel
from orbital.vectors import Array, norm


def make_start(environment: Environment, bodies: Bodies, interface: Interface) -> Callable[..., Any]:
    """The kernel `start_state(record, state, longest) -> fault` for one environment and two bodies."""
    position_slot = interface.references["start.relative_position[1]"]

    @kernel
    def centres(record: Any, state: Array) -> int:
        """Fill R, V, rho, rho' from the parameters [m, m/s] (12,); returns 0 or a fault.

        Checked  tests/tethered_deorbit/test_start.py
        """
        r = record[0]
        if r.start_condition == HANDED_OVER and not norm(r.start_relative_position) > 0.0:
            return blame(record, NO_LINE, position_slot, 0.0)
        if r.start_condition == SAME_ORBIT:
            return int(environment.same_orbit(record, state))
        position, velocity = r.state_vector[0], r.state_vector[1]
        rate = environment.place(record, position, velocity)
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

    @kernel
    def start_state(record: Any, state: Array, longest: float) -> int:
        """Fill the state from the parameters [m, m/s], attitudes included; returns 0 or a fault.

            same_orbit      both on the reference orbit, a chord apart
            vbar            rho = (0, +-s, 0) in the orbital frame of the centre of mass, at rest in it
            equal_velocity  the same rho, rho' = 0 in inertial axes
            handed_over     centre of mass and relative vector as given in the orbital frame of the orbit's point

        The plus sign holds when the target leads.

        longest       longest line for the first three               [m]

        Valid    what the environment has: no orbit, no same_orbit and no vbar
        Source   fmu_src/tethered_deorbit/README.md, What is computed
        Checked  tests/tethered_deorbit/test_start.py
        """
        code: int = environment.check(record)
        if code == 0:
            code = centres(record, state)
        if code == 0:
            code = bodies.place(record, state, longest)
        return code

    return start_state
