"""Where the nodes of a line are: in the state, between the attachments, and at the start.

Node i, counted from 0 at the chaser, has six components behind `place`: its position from the target's centre of mass
and the rate of it, inertial. On the target no thrust acts, so that no thrust comes into the motion of a node.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from fmu_src.tethered_deorbit.kinematics import distance_rate
from fmu_src.tethered_deorbit.layout import WIDTH
from fmu_src.tethered_deorbit.nodes.pieces import unloaded
from orbital.kernel import kernel
from orbital.vectors import Array, cross, dot, norm

CLOSE = 1.0 - 1e-12
"""Length of the pieces of a slack arc over that unloaded [1]: none is stretched by rounding."""
HALVINGS = 60


def make_span(place: int, beyond: str) -> Callable[..., Any]:
    """The kernel `span(record, state, piece) -> (length [m], its rate [m/s])`.

    place         of the first node in the state
    beyond        as of `Bodies`
    """

    @kernel
    def span(record: Any, state: Array, piece: int) -> tuple[float, float]:
        """Length of a piece and its rate; its vector, towards the target, and the rate of that are left in
        `state.node_room`, rows 0 and 1. The attachments are in `state.ends`.

        At a target that is a point the line is made fast at a distance from it, straight on from the last piece.

        Checked  tests/tethered_deorbit/test_nodes.py
        """
        r = record[0]
        vector, velocity, ends = r.state_node_room[0], r.state_node_room[1], r.state_ends
        first, last = place + WIDTH * (piece - 1), place + WIDTH * piece
        for i in range(3):
            if piece < r.lumped_nodes:
                vector[i] = state[last + i]
                velocity[i] = state[last + 3 + i]
            else:
                vector[i] = ends[2][i]
                velocity[i] = ends[3][i]
        for i in range(3):
            if piece > 0:
                vector[i] -= state[first + i]
                velocity[i] -= state[first + 3 + i]
            else:
                vector[i] -= ends[0][i]
                velocity[i] -= ends[1][i]
        distance = norm(vector)
        rate: float = distance_rate(vector, velocity, distance)
        if piece == r.lumped_nodes:
            return distance - r[beyond], rate
        return distance, rate

    return span


@kernel
def sum_of_arc(record: Any, half: float) -> tuple[float, float]:
    """End [m] of a chain of unloaded pieces, each turned by the same angle on the one before, along and across.

        sum of l_j (cos t_j, sin t_j),   t_j = (N - 2 j) half

    half          of that angle                                  [rad]

    Checked  tests/tethered_deorbit/test_nodes.py: a slack start
    """
    along = across = 0.0
    count = record[0].lumped_nodes
    for piece in range(count + 1):
        length, _ = unloaded(record, piece, 0.0)
        along += length * math.cos((count - 2 * piece) * half)
        across += length * math.sin((count - 2 * piece) * half)
    return along, across


@kernel
def bow(record: Any, chord: float) -> float:
    """Half the angle [rad] between two pieces of an arc of the unloaded line over a chord [m]; zero where that is no
    shorter than the line.

    Source   halving: the chord falls as the arc bends, up to a closed ring
    Checked  tests/tethered_deorbit/test_nodes.py: a slack start
    """
    low, high = 0.0, math.pi / (record[0].lumped_nodes + 1.0)
    along, across = sum_of_arc(record, low)
    if chord >= math.hypot(along, across):
        return 0.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        along, across = sum_of_arc(record, middle)
        if math.hypot(along, across) > chord:
            low = middle
        else:
            high = middle
    return float(0.5 * (low + high))


def make_lay(place: int, beyond: str) -> Callable[..., Any]:
    """The kernel `lay(record, state)` that places the nodes at the start.

    place         of the first in the state
    beyond        as of `Bodies`
    """

    @kernel
    def lay(record: Any, state: Array) -> None:
        """Nodes on the straight line between the attachments, or, where it is slack, on an arc of unloaded pieces.

        The arc bows in the plane of the orbit, towards line x axis 3 of the orbital frame; of a line along that axis,
        towards axis 1. Nodes turn with the line and share its rate of lengthening:

            y' = v_t + w x (y - y_t) + ((y - y_t) . u) (s'/s) u,   w = d x d'/s^2

        `state.ends` has the attachments, `state.basis` the frame.

        Checked  tests/tethered_deorbit/test_nodes.py: a slack start, a straight one
        """
        r = record[0]
        room, ends, basis = r.state_node_room, r.state_ends, r.state_basis
        unit, side, turning, stretching = room[0], room[1], room[2], room[3]
        for i in range(3):
            unit[i] = ends[2][i] - ends[0][i]
            stretching[i] = ends[3][i] - ends[1][i]
        chord = norm(unit)
        for i in range(3):
            unit[i] /= chord
        cross(turning, unit, stretching)
        for i in range(3):
            turning[i] /= chord
        lengthening = dot(unit, stretching) / chord
        cross(side, unit, basis[2])
        if not norm(side) > 1.0e-3:
            across = dot(basis[0], unit)
            for i in range(3):
                side[i] = basis[0][i] - across * unit[i]
        wide = norm(side)
        for i in range(3):
            side[i] /= wide
        # the line of a point target ends short of it, on the line of centres
        reaching = chord - r[beyond]
        half = bow(record, reaching / CLOSE)
        whole, askew = sum_of_arc(record, half)
        size = math.hypot(whole, askew)
        cosine, sine = whole / size, askew / size
        scale = reaching / size if half == 0.0 else CLOSE
        along = across = 0.0
        velocity, offset = room[4], room[5]
        for node in range(r.lumped_nodes):
            length, _ = unloaded(record, node, 0.0)
            angle = (r.lumped_nodes - 2 * node) * half
            along += scale * length * (math.cos(angle) * cosine + math.sin(angle) * sine)
            across += scale * length * (math.sin(angle) * cosine - math.cos(angle) * sine)
            for i in range(3):
                offset[i] = (along - chord) * unit[i] + across * side[i]
            cross(velocity, turning, offset)
            first = place + WIDTH * node
            for i in range(3):
                state[first + i] = ends[2][i] + offset[i]
                state[first + 3 + i] = ends[3][i] + velocity[i] + lengthening * (along - chord) * unit[i]

    return lay
