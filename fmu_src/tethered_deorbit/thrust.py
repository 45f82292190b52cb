"""The chaser's thruster: a signed force along one of three directions, and the propellant it takes."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.acting import IDLE, Acting
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.interface import BAD_PARAMETER
from orbital.constants import STANDARD_GRAVITY
from orbital.kernel import kernel
from orbital.vectors import Array


@kernel
def nothing(*arguments: Any) -> None:
    """Does nothing, whatever it is given."""


@kernel
def no_force(record: Any) -> tuple[float, float]:
    """A force of zero that does not move."""
    return 0.0, 0.0


@kernel
def no_fault(record: Any) -> int:
    """Nothing is wrong."""
    return 0


class Thrust(NamedTuple):
    """Kernels of one direction; as it stands, those of an FMU without a thruster, of which nothing is compiled.

    reset(record)                     nothing used yet
    add(record, state, rate, since)   add the thrust to the rate of the state, `since` [s] after its force was set
    asked(record) -> (force, rate)    what level and input say [N], [N/s]
    leave(record, duration)           write the value the input has reached after a time back to it
    check(record) -> fault            whether the input can be
    account(record, time)             book the propellant used up to `time`, before the force changes
    put(record, force, rate)          put a force in force, to move at a rate
    publish(record, time)             propellant used up to `time`
    publish_rate(record)              and how fast it is used
    acting                            what the thruster does by itself
    """

    reset: Callable[..., Any] = nothing
    add: Callable[..., Any] = nothing
    asked: Callable[..., Any] = no_force
    leave: Callable[..., Any] = nothing
    check: Callable[..., Any] = no_fault
    account: Callable[..., Any] = nothing
    put: Callable[..., Any] = nothing
    publish: Callable[..., Any] = nothing
    publish_rate: Callable[..., Any] = nothing
    acting: Acting = IDLE


@kernel
def _add_along(record: Any, rate: Array, since: float, x: float, y: float, z: float) -> None:
    """Add the thrust along a direction of any length to the rates of centre of mass and relative vector [m/s^2].

        V' += F u/M,   rho'' -= F u/m_c,   u = (x, y, z)/|(x, y, z)|

    rate          of R, V, rho, rho'  of `layout`                (12,)
    since         since the force was set                        [s]

    Valid    any; without a direction there is no thrust
    Source   Newton's second law
    Checked  tests/tethered_deorbit/test_terms.py
    """
    r = record[0]
    length = math.sqrt(x * x + y * y + z * z)
    if length > 0.0:
        force = r.state_thrust + r.state_thrust_rate * since
        on_center = force / (r.state_total_mass * length)
        on_chaser = force / (r.chaser_mass * length)
        rate[3] += on_center * x
        rate[4] += on_center * y
        rate[5] += on_center * z
        rate[9] -= on_chaser * x
        rate[10] -= on_chaser * y
        rate[11] -= on_chaser * z


@kernel
def _along_velocity(record: Any, state: Array) -> tuple[float, float, float]:
    """Direction of the chaser's inertial velocity [m/s].

        u = v

    state         R, V, rho, rho'  of `layout`                   (12,)

    Valid    at rest it has no direction, and there is no thrust
    Source   v = V - (m_t/M) rho'
    Checked  tests/tethered_deorbit/test_terms.py; test_uncompiled.py: its work round an ellipse
    """
    share = record[0].state_target_share
    return state[3] - share * state[9], state[4] - share * state[10], state[5] - share * state[11]


DIRECTIONS = ("along_track", "velocity", "tether")


def make_thrust(
    name: str, along_track: Callable[..., Any], along_line: Callable[..., Any], interface: Interface
) -> Thrust:
    """A thruster on the chaser.

        R'' += F u/M,   rho'' -= F u/m_c,   F = level + offset,   propellant = integral of |F|/(Isp g0)

    The force may move at a constant rate; the integral is then exact, also where the force turns round.

    Masses stay constant. The propellant of a tow from 800 to 200 km at 3000 s is 1.1 % of the pair's mass; keeping it
    aboard makes the tow 0.6 % longer than `orbital.references.spiral_time` with its exhaust speed says.

    name          of the direction: along_track, velocity or tether
    along_track   kernel of the environment that gives this one
    along_line    kernel of the bodies that gives the third
    interface     whose record it is for

    Valid    point masses: no torque, no plume on the target
    Source   fmu_src/tethered_deorbit/README.md, What is computed
    Checked  tests/tethered_deorbit/test_terms.py, test_ramps.py
    """
    direction = {"along_track": along_track, "velocity": _along_velocity, "tether": along_line}[name]
    offset_slot = interface.references["thrust.offset"]

    @kernel
    def add(record: Any, state: Array, rate: Array, since: float) -> None:
        """Add the thrust along its direction to the rate of the state.

        state, rate   R, V, rho, rho'  of `layout`               (12,)
        since         since the force was set                    [s]

        Source   as `_add_along`
        Checked  tests/tethered_deorbit/test_terms.py, test_uncompiled.py
        """
        x, y, z = direction(record, state)
        _add_along(record, rate, since, x, y, z)

    @kernel
    def reset(record: Any) -> None:
        """No force, and nothing used yet.

        Checked  tests/tethered_deorbit/test_macro_step.py: nothing is left of an earlier run
        """
        r = record[0]
        r.state_thrust = 0.0
        r.state_thrust_rate = 0.0
        r.state_propellant = 0.0
        r.state_propellant_since = 0.0

    @kernel
    def used(record: Any, time: float) -> float:
        """Propellant [kg] up to a time: what was booked, and since then the integral of |F| over a straight line.

            |F| t/(Isp g0),   |F1 + F2| t/(2 Isp g0),   or (F1^2 + F2^2)/(2 |F'| Isp g0) where F turns round

        time                 t counts from the last change of the force   [s]

        Source   area under a straight line, on either side of its zero
        Checked  tests/tethered_deorbit/test_ramps.py: the propellant of a ramp
        """
        r = record[0]
        since = time - r.state_propellant_since
        exhaust = r.thrust_specific_impulse * STANDARD_GRAVITY
        force, rate = r.state_thrust, r.state_thrust_rate
        if rate == 0.0:
            constant: float = r.state_propellant + abs(force) / exhaust * since
            return constant
        last = force + rate * since
        if force * last >= 0.0:
            impulse = 0.5 * abs(force + last) * since
        else:
            impulse = (force * force + last * last) / (2.0 * abs(rate))
        mass: float = r.state_propellant + impulse / exhaust
        return mass

    @kernel
    def asked(record: Any) -> tuple[float, float]:
        """What level and input say: force [N] and its rate [N/s].

        Checked  tests/tethered_deorbit/test_ramps.py
        """
        r = record[0]
        return r.thrust_level + r.thrust_offset, r.rate_thrust_offset

    @kernel
    def leave(record: Any, duration: float) -> None:
        """Write the value the input has reached after a time [s] back to it.

        Checked  tests/tethered_deorbit/test_ramps.py
        """
        r = record[0]
        r.thrust_offset += r.rate_thrust_offset * duration

    @kernel
    def check(record: Any) -> int:
        """Fault of an input that is not finite, or 0.

        Checked  tests/tethered_deorbit/test_robust.py
        """
        r = record[0]
        if not math.isfinite(r.thrust_offset + r.rate_thrust_offset):
            return blame(record, BAD_PARAMETER, offset_slot, r.thrust_offset)
        return 0

    @kernel
    def account(record: Any, time: float) -> None:
        """Book the propellant used up to a time [s].

        Checked  tests/tethered_deorbit/test_ramps.py: the propellant of a ramp, and then as ever
        """
        r = record[0]
        r.state_propellant = used(record, time)
        r.state_propellant_since = time

    @kernel
    def put(record: Any, force: float, rate: float) -> None:
        """Put a force [N] in force, to move at a rate [N/s].

        Checked  tests/tethered_deorbit/test_ramps.py: the speed gained
        """
        r = record[0]
        r.state_thrust = force
        r.state_thrust_rate = rate

    @kernel
    def publish(record: Any, time: float) -> None:
        """Write the propellant used up to a time [s] to its output [kg].

        Checked  tests/tethered_deorbit/test_ramps.py
        """
        record[0].chaser_propellant = used(record, time)

    @kernel
    def publish_rate(record: Any) -> None:
        """Write how fast propellant is used [kg/s].

            |F|/(Isp g0)

        Checked  tests/tethered_deorbit/test_derivatives.py, against differences
        """
        r = record[0]
        r.rate_propellant = abs(r.state_thrust) / (r.thrust_specific_impulse * STANDARD_GRAVITY)

    return Thrust(
        reset=reset,
        add=add,
        asked=asked,
        leave=leave,
        check=check,
        account=account,
        put=put,
        publish=publish,
        publish_rate=publish_rate,
    )
