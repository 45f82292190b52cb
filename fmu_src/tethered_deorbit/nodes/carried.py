"""What the nodes of a line add to the bodies at its ends: they turn with the axes of a step, and bound its length and
its error."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fmu_src.tethered_deorbit.bodies import Bodies
from fmu_src.tethered_deorbit.idle import nothing
from fmu_src.tethered_deorbit.layout import WIDTH
from fmu_src.tethered_deorbit.nodes.books import Books
from fmu_src.tethered_deorbit.nodes.pieces import unloaded, whole
from fmu_src.tethered_deorbit.tolerances import ROUNDING
from fmu_src.tethered_deorbit.turning import add_turning_to, turn_vectors_back
from orbital.kernel import kernel
from orbital.vectors import Array, dot, norm

NEARING = 0.5
"""Share of the time in which a slack piece can at the soonest be tight, that a step may take."""


def carried_by(
    bodies: Bodies, place: int, heat: int, span: Callable[..., Any], find_ends: Callable[..., Any], books: Books
) -> Bodies:
    """The bodies with the nodes between them.

    place, heat   of the first node and of the dashpots' heat in the state
    span, find_ends   kernels of pieces and attachments

    Checked  tests/tethered_deorbit/test_nodes.py
    """

    seen = bodies.seen

    @kernel
    def add_turning(record: Any, state: Array, rate: Array, sign: float) -> None:
        """What the turning of the axes adds to the rates, those of the nodes among them.

        Checked  tests/tethered_deorbit/test_nodes.py: axes change nothing
        """
        bodies.add_turning(record, state, rate, sign)
        add_turning_to(record, state, rate, sign, place, place + WIDTH * record[0].lumped_nodes)

    @kernel
    def turn_back(record: Any, time: float, state: Array) -> None:
        """Along axes at rest.

        Checked  tests/tethered_deorbit/test_nodes.py: axes change nothing
        """
        bodies.turn_back(record, time, state)
        size = WIDTH * record[0].lumped_nodes
        turn_vectors_back(record, time, state[place : place + size], size)

    @kernel
    def go_on(record: Any, time: float, state: Array, rate: Array) -> None:
        """From the end of a step to the begin of the next: its axes at rest.

        Checked  tests/tethered_deorbit/test_nodes.py: axes change nothing
        """
        r = record[0]
        size = WIDTH * r.lumped_nodes
        if r.state_taut:
            turn_vectors_back(record, time, rate[place : place + size], size)
            add_turning_to(record, state, rate, 1.0, place, place + size)
        bodies.go_on(record, time, state, rate)

    @kernel
    def longest(record: Any, state: Array) -> float:
        """Longest step [s]: over the fastest motion of the line, unless all pieces are slack and stay so for longer.

        A piece that lacks d to be tight is so at the soonest after d/|v|, v the relative velocity of its ends.

        Checked  tests/tethered_deorbit/test_nodes.py: a slack line costs little
        """
        r = record[0]
        soonest = bodies.longest(record, state)
        there = seen(record, state, 0.0)
        find_ends(record, there)
        for piece in range(r.lumped_nodes + 1):
            if not whole(record, piece):
                continue
            length, _ = span(record, there, piece)
            rest, _ = unloaded(record, piece, r.state_since)
            if not length < rest:
                soonest = 0.0
            speed = norm(r.state_node_room[1])
            if speed > 0.0 and rest - length < soonest * speed:
                soonest = (rest - length) / speed
        return float(max(r.state_nodes_reach, NEARING * soonest))

    @kernel
    def squared_error(record: Any, state: Array, error: Array) -> float:
        """Square of the error's size, of bodies and nodes [-].

            sum of (e/tol_s)^2, (e'/(tol_s w))^2,   w of the line's fastest motion
            (e_Q/(m sum of |v| tol_s w))^2, of the heat: what the tolerance of the velocities leaves of the energy

        Checked  tests/tethered_deorbit/test_nodes.py: tolerances rule the error
        """
        r = record[0]
        square = float(bodies.squared_error(record, state, error))
        allowed = ROUNDING * abs(state[heat])
        for node in range(r.lumped_nodes):
            at = place + WIDTH * node
            apart = r.solver_tolerance_separation + ROUNDING * norm(state[at : at + 3])
            rate = r.solver_tolerance_separation * r.state_nodes_fastest + ROUNDING * norm(state[at + 3 : at + WIDTH])
            square += dot(error[at : at + 3], error[at : at + 3]) / (apart * apart)
            square += dot(error[at + 3 : at + WIDTH], error[at + 3 : at + WIDTH]) / (rate * rate)
            allowed += r.state_node_mass * rate * norm(state[at + 3 : at + WIDTH])
        if allowed > 0.0:
            square += error[heat] * error[heat] / (allowed * allowed)
        return square

    @kernel
    def energy(record: Any, state: Array, turning: float) -> float:
        """Energy of attitudes and line [J].

        Checked  tests/tethered_deorbit/test_nodes.py: energy
        """
        return float(bodies.energy(record, state, turning) + books.energy(record, state, turning))

    @kernel
    def differentiate(record: Any, state: Array, rate: Array, turning: float, change: float) -> float:
        """Rates of outputs; power [W].

        Checked  tests/tethered_deorbit/test_nodes.py, against differences
        """
        power = bodies.differentiate(record, state, rate, turning, change)
        return float(power + books.differentiate(record, state, rate, turning, change))

    return bodies._replace(
        pull=nothing,
        add_turning=add_turning,
        turn_back=turn_back,
        go_on=go_on,
        longest=longest,
        squared_error=squared_error,
        energy=energy,
        differentiate=differentiate,
    )
