"""A line of lumped nodes in a tow: what it makes of the law of the reel, of the bodies, and of what is noted.

    m y_i'' = T_(i+1) u_(i+1) - T_i u_i + m (g(r_t + y_i) - g(r_t)) - m F_t/m_t

y_i is the place of node i from the target, T_i and u_i pull and direction of the piece before it, F_t the pull on the
target. Gravity differences are formed without cancellation. The bodies feel the two pieces at the ends:

    R'' += (F_c + F_t)/M,   rho'' += F_t/m_t - F_c/m_c
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.integrators.dop853 import reach
from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.acting import Acting, together
from fmu_src.tethered_deorbit.bodies import Bodies
from fmu_src.tethered_deorbit.environment import Environment
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.idle import zero
from fmu_src.tethered_deorbit.interface import NO_LENGTH
from fmu_src.tethered_deorbit.kinematics import distance_acceleration, turning_share
from fmu_src.tethered_deorbit.law import Reel
from fmu_src.tethered_deorbit.layout import GATHERED, MOVED, WIDTH, StateLayout
from fmu_src.tethered_deorbit.nodes.books import Watch, make_books
from fmu_src.tethered_deorbit.nodes.carried import carried_by
from fmu_src.tethered_deorbit.nodes.parting import Parting, make_parting
from fmu_src.tethered_deorbit.nodes.pieces import fastest, pull, slopes, stored_by_length, tune, unloaded
from fmu_src.tethered_deorbit.nodes.places import make_lay, make_span
from orbital.kernel import kernel
from orbital.vectors import Array, norm


class Noded(NamedTuple):
    """Law and bodies of a line of nodes, what is noted of it, and how it parts."""

    reel: Reel
    bodies: Bodies
    watch: Watch
    parting: Parting


def make_nodes(
    reel: Reel,
    bodies: Bodies,
    environment: Environment,
    beside: Callable[..., Any],
    layout: StateLayout,
    interface: Interface,
) -> Noded:
    """The kernels for a locked reel.

    beside        kernel of `Perturbing`

    Checked  tests/tethered_deorbit/test_nodes.py
    """
    place, impulse = layout.reel, layout.impulse
    heat, end_of_nodes = impulse + GATHERED, layout.reel + MOVED
    offset_slot = interface.references["reel.length_offset"]
    span, lay, gravity = make_span(place, bodies.beyond), make_lay(place, bodies.beyond), environment.gravity_apart
    stand, ends = bodies.stand, bodies.ends
    chaser_end, twist_chaser, twist_target = bodies.chaser_end, bodies.twist_chaser, bodies.twist_target

    @kernel
    def find_ends(record: Any, state: Array) -> None:
        """Attachments and their rates into `state.ends`, of a state as it is.

        Checked  tests/tethered_deorbit/test_nodes.py, test_nodes_on_bodies.py
        """
        stand(record, state)
        ends(record, state, record[0].state_ends)

    books = make_books(place, heat, span, find_ends, bodies.seen, environment)

    @kernel
    def prepare(record: Any, value: float, rate: float, duration: float) -> int:
        """Put an unloaded length in force: that of the chaser's piece; returns 0 or a fault.

        Checked  tests/tethered_deorbit/test_nodes.py: line wound out
        """
        r = record[0]
        code: int = reel.prepare(record, value, rate, duration)
        if code != 0:
            return code
        tune(record)
        begins, _ = unloaded(record, 0, 0.0)
        shortest = min(begins, begins + rate * duration)
        if not shortest > 0.0:
            return blame(record, NO_LENGTH, offset_slot, shortest)
        r.state_nodes_fastest, share = fastest(record, shortest)
        r.state_nodes_reach = reach(share) / r.state_nodes_fastest
        return 0

    @kernel
    def taut(record: Any, length: float, rate: float) -> bool:
        """Whether the attachments are farther apart than the line is long unloaded: then it pulls wherever its nodes
        are.

        Checked  tests/tethered_deorbit/test_nodes.py: tugs
        """
        return bool(length > record[0].state_length)

    @kernel
    def onset(record: Any, length: float, rate: float, since: float) -> float:
        """By how much they are [m].

        Checked  tests/tethered_deorbit/test_nodes.py: tugs
        """
        r = record[0]
        return float(length - (r.state_length + r.state_command_rate * since))

    @kernel
    def onset_rate(record: Any, length: float, rate: float, acceleration: float, since: float) -> float:
        """Its time derivative [m/s].

        Checked  tests/tethered_deorbit/test_nodes.py: tugs
        """
        return float(rate - record[0].state_command_rate)

    @kernel
    def see(record: Any, state: Array) -> None:
        """Keep the attachments, and the chaser's piece.

        Checked  tests/tethered_deorbit/test_nodes.py
        """
        r = record[0]
        find_ends(record, state)
        r.state_end_length, r.state_end_speed = span(record, state, 0)

    @kernel
    def see_change(record: Any, state: Array, rate: Array, turned: float) -> None:
        """And how its rate changes; after `see`.

        Checked  tests/tethered_deorbit/test_nodes.py, against differences
        """
        r = record[0]
        room = r.state_node_room
        for i in range(3):
            room[2][i] = rate[place + 3 + i] + rate[9 + i]
            room[3][i] = state[place + 3 + i] + state[9 + i]
        chaser_end(record, state, rate, room[2])
        length, speed = r.state_end_length, r.state_end_speed
        r.state_end_acceleration = distance_acceleration(room[0], room[1], room[2], length, speed)
        r.state_end_acceleration += turned * turning_share(record, room[0], room[3], length)

    @kernel
    def tension(record: Any, length: float, rate: float, since: float) -> float:
        """That of the chaser's piece [N], as last seen; what is shown is of the same instant.

        Checked  tests/tethered_deorbit/test_nodes.py
        """
        record[0].state_shown_since = since
        force, _, _ = pull(record, 0, record[0].state_end_length, record[0].state_end_speed, since)
        return float(force)

    @kernel
    def tension_rate(record: Any, length: float, rate: float, acceleration: float, since: float) -> float:
        """Its time derivative [N/s].

        Checked  tests/tethered_deorbit/test_nodes.py, against differences
        """
        r = record[0]
        by_length, by_rate, by_unloaded = slopes(record, r.state_end_length, r.state_end_speed, since)
        _, moving = unloaded(record, 0, since)
        return float(by_length * r.state_end_speed + by_rate * r.state_end_acceleration + by_unloaded * moving)

    @kernel
    def partials(record: Any, length: float, rate: float) -> tuple[float, float]:
        """Derivatives of tension [N/m] and energy [J/m] by the offset of the unloaded length, at since = 0.

        Checked  tests/tethered_deorbit/test_nodes.py, against differences
        """
        r = record[0]
        _, _, by_unloaded = slopes(record, r.state_end_length, r.state_end_speed, 0.0)
        return by_unloaded, stored_by_length(record, r.state_end_length, 0.0)

    @kernel
    def drive(
        record: Any, state: Array, rate: Array, length: float, speed: float, tension: float, since: float
    ) -> None:
        """Rates of nodes, bodies, impulse and heat by the pull of all pieces; `see` has been before.

            heat' = sum of (T - f) (dl/dt - dl_0/dt)

        Checked  tests/tethered_deorbit/test_nodes.py: momentum, energy, gravity
        """
        r = record[0]
        count = r.lumped_nodes
        room = r.state_node_room
        vector, center = room[0], room[3]
        for i in range(3):
            center[i] = state[i] + r.state_chaser_share * state[6 + i]
        for i in range(place + WIDTH * count, end_of_nodes):
            rate[i] = 0.0
        for node in range(count):
            at = place + WIDTH * node
            for i in range(3):
                rate[at + i] = state[at + 3 + i]
            gravity(center, state[at : at + 3], rate[at + 3 : at + 6])
            beside(record, state, state[at : at + 3], state[at + 3 : at + 6], rate[at + 3 : at + 6])
        rate[heat] = 0.0
        lightness = 1.0 / r.state_node_mass
        chaser_mass = r.state_chaser_share * r.state_total_mass
        target_mass = r.state_target_share * r.state_total_mass
        for piece in range(count + 1):
            distance, parting = span(record, state, piece)
            force, spring, _ = pull(record, piece, distance, parting, since)
            if piece == 0:
                rate[impulse] = force
            if not spring > 0.0:
                continue
            _, moving = unloaded(record, piece, since)
            rate[heat] += (force - spring) * (parting - moving)
            force /= norm(vector)
            if piece == 0:
                twist_chaser(record, state, rate, force * vector[0], force * vector[1], force * vector[2])
            if piece == count:
                twist_target(record, state, rate, force * vector[0], force * vector[1], force * vector[2])
            before, after = place + WIDTH * (piece - 1) + 3, place + WIDTH * piece + 3
            for i in range(3):
                along = force * vector[i]
                if piece > 0:
                    rate[before + i] += lightness * along
                else:
                    rate[3 + i] += along / r.state_total_mass
                    rate[9 + i] -= along / chaser_mass
                if piece < count:
                    rate[after + i] -= lightness * along
                else:
                    rate[3 + i] -= along / r.state_total_mass
                    rate[9 + i] -= along / target_mass
                    for node in range(count):
                        rate[place + WIDTH * node + 3 + i] += along / target_mass

    @kernel
    def publish(record: Any, state: Array, length: float, speed: float) -> None:
        """Outputs of the line; after `see`.

        Checked  tests/tethered_deorbit/test_nodes.py
        """
        reel.publish(record, state, length, speed)
        books.publish(record, state)

    @kernel
    def begin(record: Any, state: Array) -> int:
        """Nodes as the line lies at the start; no heat yet.

        Checked  tests/tethered_deorbit/test_nodes.py: a slack start, a straight one
        """
        for i in range(place, end_of_nodes):
            state[i] = 0.0
        state[heat] = 0.0
        find_ends(record, state)
        environment.frame(record, state[0:3], state[3:6])
        record[0].lumped_parted_piece = 0
        record[0].lumped_parted_energy = 0.0
        lay(record, state)
        return 0

    law = reel._replace(
        prepare=prepare,
        taut=taut,
        tension=tension,
        tension_rate=tension_rate,
        onset=onset,
        onset_rate=onset_rate,
        energy=zero,
        energy_rate=zero,
        partials=partials,
        acting=together((Acting(begin=begin), reel.acting)),
        see=see,
        see_change=see_change,
        drive=drive,
        publish=publish,
        by_length=True,
    )
    parts = make_parting(span, find_ends, books.hardest)
    return Noded(law, carried_by(bodies, place, heat, span, find_ends, books), books.watch, parts)
