"""The chaser's thruster: a signed force along one of three directions, and the propellant that it takes."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.acting import IDLE, Acting, together
from fmu_src.tethered_deorbit.burn import STEADY, make_burn
from fmu_src.tethered_deorbit.engine import make_engine
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.idle import no_fault, nothing, zero
from fmu_src.tethered_deorbit.interface import BAD_PARAMETER
from fmu_src.tethered_deorbit.layout import ATTITUDE, PAIR, StateLayout
from fmu_src.tethered_deorbit.plume import make_plume
from fmu_src.tethered_deorbit.turning import turn_vectors_back
from orbital.constants import STANDARD_GRAVITY
from orbital.kernel import kernel
from orbital.rotations import rotate_inverse
from orbital.vectors import Array, cross, matrix_vector


@kernel
def no_force(record: Any) -> tuple[float, float]:
    """A force of zero that does not move."""
    return 0.0, 0.0


class Thrust(NamedTuple):
    """Kernels of one direction; as it stands, those of an FMU without a thruster, of which nothing is compiled.

    reset(record)                     nothing used yet
    add(record, state, rate, since, elapsed)   add the thrust to the rate of the state, `since` [s] after its force was
                                      set, and `elapsed` after the begin of the step, for which axes have turned
    weigh(record, state)              masses of the pair in a state
    lose(record, state, rate, sign)   what their loss does to the rate of the centre of mass, with a sign
    shed(record, rate) -> M'          how fast the pair's mass changes, from the rate of the state [kg/s]
    lighten(record, state, rate, n) -> power   what the loss of its inertia adds: see `engine.Engine`
    asked(record) -> (force, rate)    what level and input say [N], [N/s]
    leave(record, duration)           write the value the input has reached after a time back to it
    check(record) -> fault            whether the input can be
    start(record) -> fault            whether the engine can
    account(record, time)             book the propellant used up to `time`, before the force changes
    put(record, force, rate)          put a force in force, to move at a rate
    publish(record, state, time)      propellant used up to `time`, and what else is to be seen of it
    publish_rate(record, time)        and how fast it is used
    acting                            what the thruster does by itself
    """

    reset: Callable[..., Any] = nothing
    add: Callable[..., Any] = nothing
    weigh: Callable[..., Any] = nothing
    lose: Callable[..., Any] = nothing
    shed: Callable[..., Any] = zero
    lighten: Callable[..., Any] = zero
    asked: Callable[..., Any] = no_force
    leave: Callable[..., Any] = nothing
    check: Callable[..., Any] = no_fault
    start: Callable[..., Any] = no_fault
    account: Callable[..., Any] = nothing
    put: Callable[..., Any] = nothing
    publish: Callable[..., Any] = nothing
    publish_rate: Callable[..., Any] = nothing
    acting: Acting = IDLE


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
    terms: Mapping[str, str],
    place: Callable[..., Any],
    along_track: Callable[..., Any],
    along_line: Callable[..., Any],
    layout: StateLayout,
    interface: Interface,
) -> Thrust:
    """A thruster on the chaser.

        R'' += F u/M,   rho'' -= F u/m_c,   F = level + offset,   propellant = integral of |F|/(Isp g0)

    The force may move at a constant rate; the integral is then exact, also where the force turns round.

    Without an engine masses stay constant. The propellant of a tow from 800 to 200 km at 3000 s is 1.1 % of the pair's
    mass; keeping it aboard makes the tow 0.6 % longer than `orbital.references.spiral_time` with its exhaust speed
    says. With an engine or burns F is what these leave of it, and the propellant a component of the state.

    terms         those of "thrust", "burn", "engine" and "plume", as far as there are any
    place         kernel of the environment: the orbit's point at the start
    along_track   kernel of it that gives the first direction
    along_line    kernel of the bodies that gives the third
    layout        where the propellant stands in the state
    interface     whose record it is for

    Valid    any; on a chaser that turns it acts at chaser.thruster, on a point at its centre of mass
    Source   fmu_src/tethered_deorbit/README.md, What is computed
    Checked  tests/tethered_deorbit/test_terms.py, test_ramps.py
    """
    if "thrust" not in terms:
        return Thrust()
    direction = {"along_track": along_track, "velocity": _along_velocity, "tether": along_line}[terms["thrust"]]
    at_rest = terms["environment"] == "none" and terms["thrust"] == "along_track"  # an axis, which no state turns with
    burn = make_burn(terms, place, interface)
    engine = make_engine(terms, layout, interface)
    plume = make_plume(terms, interface)
    offset_slot = interface.references["thrust.offset"]
    spent, shaped, keeps = layout.spent, burn is not STEADY or engine.real, layout.spent < layout.reel
    beams, turns = "plume" in terms, terms["chaser"] != "point"
    q_at = PAIR + (ATTITUDE if terms["target"] != "point" else 0)
    mass = "state_chaser_mass" if engine.real else "chaser_mass"

    @kernel
    def turn(record: Any, state: Array, rate: Array, factor: float, x: float, y: float, z: float) -> None:
        """Add the torque of a thrust beside the chaser's centre of mass.

            w' += I^-1 (p x A^T F),   p chaser.thruster

        factor        by which (x, y, z) is the force            [N]

        Checked  tests/tethered_deorbit/test_aocs.py: a thruster off the centre
        """
        r = record[0]
        p, push, torque = r.chaser_thruster, r.state_push[0], r.state_push[1]
        if p[0] == 0.0 and p[1] == 0.0 and p[2] == 0.0:
            return
        torque[0], torque[1], torque[2] = factor * x, factor * y, factor * z
        rotate_inverse(push, state[q_at : q_at + 4], torque)
        cross(torque, p, push)
        matrix_vector(push, r.state_chaser_inverse, torque)
        for i in range(3):
            rate[q_at + 4 + i] += push[i]

    @kernel
    def force_at(record: Any, since: float) -> tuple[float, float]:
        """Force in use [N] and its rate [N/s], some time after the inputs in force began to move [s].

        Checked  tests/tethered_deorbit/test_ramps.py, test_burn.py, test_engine.py
        """
        r = record[0]
        force, rate = r.state_thrust + r.state_thrust_rate * since, r.state_thrust_rate
        if not shaped:
            return force, rate
        share, change = burn.share(record, r.state_begin - r.state_since + since)
        given = engine.limited(record, force)
        return given * share, given * change + (rate * share if given == force else 0.0)

    @kernel
    def add(record: Any, state: Array, rate: Array, since: float, elapsed: float) -> None:
        """Add the thrust along its direction to the rates of centre of mass and relative vector [m/s^2].

            V' += F u/M,   rho'' -= F u/m_c,   u a unit vector

        state, rate   of `layout`
        since         since the force was set                    [s]
        elapsed       for which the axes have turned             [s]

        Valid    any; without a direction there is no thrust
        Source   Newton's second law
        Checked  tests/tethered_deorbit/test_terms.py, test_uncompiled.py
        """
        r = record[0]
        force, _ = force_at(record, since)
        x, y, z = direction(record, state)
        if at_rest:
            axis = r.state_vector[3]
            axis[0], axis[1], axis[2] = x, y, z
            turn_vectors_back(record, -elapsed, axis, 3)
            x, y, z = axis[0], axis[1], axis[2]
        length = math.sqrt(x * x + y * y + z * z)
        if length > 0.0:
            on_center = force / (r.state_total_mass * length)
            on_chaser = force / (r[mass] * length)
            rate[3] += on_center * x
            rate[4] += on_center * y
            rate[5] += on_center * z
            rate[9] -= on_chaser * x
            rate[10] -= on_chaser * y
            rate[11] -= on_chaser * z
        if keeps:
            rate[spent] = abs(force) / (r.thrust_specific_impulse * STANDARD_GRAVITY)
            engine.lose(record, state, rate, 1.0)
        plume.add(record, state, rate, force, x, y, z)
        if turns and length > 0.0:
            turn(record, state, rate, force / length, x, y, z)

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

    released = "release" in terms

    @kernel
    def asked(record: Any) -> tuple[float, float]:
        """What level and input say: force [N] and its rate [N/s]; nothing where it stopped as the line was cut.

        Checked  tests/tethered_deorbit/test_ramps.py, test_release.py
        """
        r = record[0]
        if released:
            if r.state_released and r.release_stops_thrust:
                return 0.0, 0.0
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
    def publish(record: Any, state: Array, time: float) -> None:
        """Write the propellant used up to a time [s] to its output [kg], and what else is to be seen.

        Checked  tests/tethered_deorbit/test_ramps.py, test_burn.py, test_engine.py, test_plume.py
        """
        r = record[0]
        if keeps:
            r.chaser_propellant = state[spent]
            publish_rate(record, time)
        else:
            r.chaser_propellant = used(record, time)
        if beams:
            force, _ = force_at(record, time - (r.state_begin - r.state_since))
            x, y, z = direction(record, state)
            plume.publish(record, state, force, x, y, z)

    @kernel
    def publish_rate(record: Any, time: float) -> None:
        """Write how fast propellant is used [kg/s], and the force and what it draws.

            |F|/(Isp g0)

        time          at which                                   [s]

        Checked  tests/tethered_deorbit/test_derivatives.py, against differences; test_burn.py, test_engine.py
        """
        r = record[0]
        since = time - (r.state_begin - r.state_since)
        force, change = force_at(record, since)
        r.rate_propellant = abs(force) / (r.thrust_specific_impulse * STANDARD_GRAVITY)
        if keeps:
            r.thrust_force, r.rate_thrust_force = force, change
            share, _ = burn.share(record, time)
            asked = r.state_thrust + r.state_thrust_rate * since
            engine.publish(record, force, change, asked if share > 0.0 else 0.0)

    return Thrust(
        reset=reset,
        add=add,
        weigh=engine.weigh,
        lose=engine.lose,
        shed=engine.shed,
        lighten=engine.lighten,
        asked=asked,
        leave=leave,
        check=check,
        start=engine.check,
        account=account,
        put=put,
        publish=publish,
        publish_rate=publish_rate,
        acting=together((burn.acting, engine.acting)),
    )
