"""The equations of the pair, put together from its terms."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fmu_src.tethered_deorbit.aocs import Aocs
from fmu_src.tethered_deorbit.bodies import Bodies
from fmu_src.tethered_deorbit.environment import Environment
from fmu_src.tethered_deorbit.environment.perturbed import Perturbing
from fmu_src.tethered_deorbit.law import Reel
from fmu_src.tethered_deorbit.layout import StateLayout
from fmu_src.tethered_deorbit.level import Held
from fmu_src.tethered_deorbit.thrust import Thrust
from fmu_src.tethered_deorbit.turning import add_turning
from orbital.kernel import kernel, view
from orbital.vectors import Array


def make_equations(
    environment: Environment,
    perturbing: Perturbing,
    reel: Reel,
    thrust: Thrust,
    bodies: Bodies,
    aocs: Aocs,
    held: Held,
    layout: StateLayout,
) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """The kernels `inertial(record, state, rate, since, elapsed)` and `derivative(record, state, rate, elapsed)`."""
    impulse, felt = layout.impulse, bodies.felt

    # `derivative` is where the time goes: as a call of its own, which a second caller would make it, it costs 10 %.
    @view
    def inertial(record: Any, state: Array, rate: Array, since: float, elapsed: float) -> None:
        """rate = rate of the state along inertial axes, or axes at rest in which it stands just now.

        state, rate   of `layout`
        since         since the inputs in force began to move        [s]
        elapsed       for which the axes have turned                 [s]

        To be called after `Bodies.stand`.

        Source   the environment's gravity, the thrust, the bodies' turning and the pull of the line; dJ/dt = T
        Checked  tests/consistency/test_table2.py, tests/tethered_deorbit/test_extremes.py: J
        """
        thrust.weigh(record, state)
        environment.add_gravity(record, state, rate)
        perturbing.add(record, state, rate, since, elapsed)
        bodies.move(record, state, rate)
        thrust.add(record, state, rate, since, elapsed)
        aocs.add(record, state, rate, elapsed)
        rate[impulse] = 0.0
        reel.see(record, state)
        if record[0].state_taut:
            separation, length, speed = bodies.measure(record, state)
            if held.settled(record):
                tension = held.tension(record, state, rate, separation, length, speed, elapsed)
            else:
                tension = reel.tension(record, length, speed, since)
            bodies.pull(record, state, rate, tension, separation)
            rate[impulse] = tension
            reel.drive(record, state, rate, length, speed, tension, since)
        else:
            reel.drive(record, state, rate, 0.0, 0.0, 0.0, since)

    @kernel
    def derivative(record: Any, state: Array, rate: Array, elapsed: float) -> None:
        """rate = rate of the state in the coordinates of the step, along its axes, which turn with a taut line.

        elapsed       since the begin of the step                    [s]
        The others as in `inertial`.

        Checked  tests/consistency/test_table2.py, tests/tethered_deorbit/test_turning.py
        """
        as_it_is = felt(record, state, elapsed)
        inertial(record, as_it_is, rate, record[0].state_since + elapsed, elapsed)
        bodies.enter_rate(record, state, as_it_is, rate)
        if record[0].state_taut:
            add_turning(record, state, rate, -1.0)
            bodies.add_turning(record, state, rate, -1.0)

    return inertial, derivative
