"""What is told of a line of nodes: its tensions, how it lies, its energy and the power of that."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.tethered_deorbit.environment import Environment
from fmu_src.tethered_deorbit.idle import nothing
from fmu_src.tethered_deorbit.layout import CAPACITY, WIDTH
from fmu_src.tethered_deorbit.nodes.pieces import pull, stored, stored_by_length, unloaded
from orbital.frames import relative_to_orbital
from orbital.hill import hill_jacobi
from orbital.kernel import kernel
from orbital.vectors import Array, norm


class Watch(NamedTuple):
    """Kernels that keep the largest tension along the line; as they stand, of a line that has one.

    begin(record)              a macro step begins
    note(record, state)        a step of the integrator has ended in this state, in the coordinates of the step
    """

    begin: Callable[..., Any] = nothing
    note: Callable[..., Any] = nothing


class Books(NamedTuple):
    """Kernels; see `Bodies` for the last two.

    hardest(record, state, since) -> (tension, piece)   that pulls hardest, after the attachments are found [N]
    publish(record, state)                      outputs of the line; the attachments are in `state.ends`
    energy(record, state, turning) -> E         [J]
    differentiate(record, state, rate, turning, change) -> E'   rates of its outputs; power [W]
    """

    watch: Watch
    hardest: Callable[..., Any]
    publish: Callable[..., Any]
    energy: Callable[..., Any]
    differentiate: Callable[..., Any]


def make_books(
    place: int,
    heat: int,
    span: Callable[..., Any],
    find_ends: Callable[..., Any],
    seen: Callable[..., Any],
    environment: Environment,
) -> Books:
    """The kernels.

    place, heat   of the first node and of the dashpots' heat in the state
    span, find_ends   kernels of pieces and attachments
    seen              kernel of `Bodies`

    Checked  tests/tethered_deorbit/test_nodes.py
    """

    @kernel
    def hardest(record: Any, state: Array, since: float) -> tuple[float, int]:
        """Largest tension [N] and the piece that has it, counted from 1 at the chaser; after `find_ends`.

        since         since the inputs in force began to move        [s]

        Checked  tests/tethered_deorbit/test_nodes.py
        """
        most, where = 0.0, 0
        for piece in range(record[0].lumped_nodes + 1):
            length, rate = span(record, state, piece)
            force, _, _ = pull(record, piece, length, rate, since)
            if force > most:
                most, where = force, piece + 1
        return most, where

    @kernel
    def begin(record: Any) -> None:
        """Nothing has pulled yet.

        Checked  tests/tethered_deorbit/test_nodes.py: the largest along the line
        """
        record[0].state_nodes_peak = 0.0
        record[0].state_nodes_peak_piece = 0

    @kernel
    def note(record: Any, state: Array) -> None:
        """Keep the largest so far.

        Checked  tests/tethered_deorbit/test_nodes.py: the largest along the line
        """
        r = record[0]
        there = seen(record, state, r.state_step)
        find_ends(record, there)
        most, where = hardest(record, there, r.state_since + r.state_step)
        if most > r.state_nodes_peak:
            r.state_nodes_peak = most
            r.state_nodes_peak_piece = where

    @kernel
    def publish(record: Any, state: Array) -> None:
        """Tensions [N], shape [m] and heat [J].

        Checked  tests/tethered_deorbit/test_nodes.py
        """
        r = record[0]
        room, ends, count = r.state_node_room, r.state_ends, r.lumped_nodes
        r.lumped_mass = count * r.state_node_mass
        r.lumped_most_tension, r.lumped_most_piece = hardest(record, state, r.state_shown_since)
        r.lumped_peak_tension, r.lumped_peak_piece = r.state_nodes_peak, r.state_nodes_peak_piece
        if r.lumped_most_tension > r.lumped_peak_tension:
            r.lumped_peak_tension, r.lumped_peak_piece = r.lumped_most_tension, r.lumped_most_piece
        r.lumped_length = 0.0
        for piece in range(count + 1):
            length, rate = span(record, state, piece)
            r.lumped_length += length
            if piece == count:
                r.lumped_target_tension, _, _ = pull(record, piece, length, rate, r.state_shown_since)
        r.lumped_heat = state[heat]
        chord, offset = room[0], room[1]
        for i in range(3):
            chord[i] = ends[2][i] - ends[0][i]
        square = chord[0] * chord[0] + chord[1] * chord[1] + chord[2] * chord[2]
        r.lumped_deflection = 0.0
        for node in range(CAPACITY):
            for i in range(3):
                r.lumped_node_position[node][i] = state[place + WIDTH * node + i] if node < count else 0.0
            if node >= count:
                continue
            along = 0.0
            for i in range(3):
                offset[i] = r.lumped_node_position[node][i] - ends[0][i]
                along += offset[i] * chord[i]
            for i in range(3):
                offset[i] -= along / square * chord[i]
            r.lumped_deflection = max(r.lumped_deflection, norm(offset))

    @kernel
    def energy(record: Any, state: Array, turning: float) -> float:
        """Energy of the line [J]: elastic, and what the motion of its nodes adds to that of the pair.

            sum of stored + m sum of hill_jacobi(x_i) - (M + N m) hill_jacobi(x_g)

        x_i the place of a node from the pair's centre of mass, x_g that of the centre of mass of all.

        state         inertial; the basis of the frame is in the record
        turning       rate of the frame                              [rad/s]

        Source   Koenig's theorem, for any form of second degree
        Checked  tests/tethered_deorbit/test_nodes.py: energy
        """
        r = record[0]
        room, mass = r.state_node_room, r.state_node_mass
        position, velocity, mean, drift = room[2], room[3], room[4], room[5]
        find_ends(record, state)
        total = 0.0
        for piece in range(r.lumped_nodes + 1):
            length, _ = span(record, state, piece)
            total += stored(record, piece, length, r.state_shown_since)
        whole = r.state_total_mass + r.lumped_nodes * mass
        for i in range(3):
            mean[i] = 0.0
            drift[i] = 0.0
        for node in range(r.lumped_nodes):
            at = place + WIDTH * node
            for i in range(3):
                room[0][i] = state[at + i] + r.state_chaser_share * state[6 + i]
                room[1][i] = state[at + 3 + i] + r.state_chaser_share * state[9 + i]
            relative_to_orbital(position, velocity, r.state_basis, turning, room[0], room[1])
            total += mass * hill_jacobi(position, velocity, turning)
            for i in range(3):
                mean[i] += mass * position[i] / whole
                drift[i] += mass * velocity[i] / whole
        return float(total - whole * hill_jacobi(mean, drift, turning))

    @kernel
    def power_of(place_of: Array, change_of: Array, turning: float, change: float) -> float:
        """Rate of `hill_jacobi` [W/kg] of a place and velocity p, q (6,) whose rates are q', p' (6,), in this order.

            q.q' + n^2 (z z' - 3 x x') + n n' (z^2 - 3 x^2)

        turning, change   n, n' of the frame                     [rad/s], [rad/s2]

        Checked  tests/tethered_deorbit/test_nodes.py, against differences
        """
        x, z = place_of[0], place_of[2]
        kinetic = place_of[3] * change_of[0] + place_of[4] * change_of[1] + place_of[5] * change_of[2]
        tidal = turning * turning * (z * change_of[5] - 3.0 * x * change_of[3])
        return float(kinetic + tidal + turning * change * (z * z - 3.0 * x * x))

    @kernel
    def differentiate(record: Any, state: Array, rate: Array, turning: float, change: float) -> float:
        """Rate of the heat; power of the line's energy [W].

        rate          along axes at rest; `state.vector`, row 2, has the acceleration of the frame's origin

        Valid    a pair that loses no mass
        Checked  tests/tethered_deorbit/test_nodes.py, against differences
        """
        r = record[0]
        room, mass = r.state_node_room, r.state_node_mass
        motion, moving, mean, drift = r.state_node_motion[0], r.state_node_motion[1], room[2], room[3]
        place_of, mean_of, mean_change = r.state_node_motion[2], r.state_node_motion[3], r.state_node_motion[4]
        find_ends(record, state)
        r.rate_lumped_heat = rate[heat]
        total = 0.0
        for piece in range(r.lumped_nodes + 1):
            length, speed = span(record, state, piece)
            _, spring, _ = pull(record, piece, length, speed, 0.0)
            total += spring * speed
            if piece == 0:
                _, unwinding = unloaded(record, piece, 0.0)
                total += stored_by_length(record, length, 0.0) * unwinding
        whole = r.state_total_mass + r.lumped_nodes * mass
        for i in range(6):
            mean_of[i] = 0.0
            mean_change[i] = 0.0
        for node in range(r.lumped_nodes):
            at = place + WIDTH * node
            for i in range(3):
                mean[i] = state[at + i] + r.state_chaser_share * state[6 + i]
                motion[i] = state[at + 3 + i] + r.state_chaser_share * state[9 + i]
                motion[3 + i] = rate[at + 3 + i] + r.state_chaser_share * rate[9 + i]
            relative_to_orbital(moving[0:3], drift, r.state_basis, turning, mean, motion[0:3])
            for i in range(3):
                place_of[i] = moving[i]
                place_of[3 + i] = drift[i]
            environment.relative_rates(r.state_basis, state[0:3], state[3:6], r.state_vector[2], motion, moving)
            total += mass * power_of(place_of, moving, turning, change)
            for i in range(6):
                mean_of[i] += mass * place_of[i] / whole
                mean_change[i] += mass * moving[i] / whole
        return float(total - whole * power_of(mean_of, mean_change, turning, change))

    return Books(Watch(begin, note), hardest, publish, energy, differentiate)
