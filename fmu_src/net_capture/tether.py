"""The tether while the net is cast: slack, but a tension signal (a reel's) may be injected where it is made fast."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from fmu_src.interface import Term, Variable
from fmu_src.net_capture.planes import FX, SHOWN, X
from fmu_src.rows import count, output, positive, state
from orbital.kernel import kernel
from orbital.vectors import dot


class Tether(NamedTuple):
    """Kernels of the tether.

    pull(p, work)          add the tension at the vertex, for a substep
    pull_shown(p, work)    the same for the positions shown
    start(p)               nothing pulled yet
    book(p, duration)      impulse that the vertex takes in a time at the tension of the last `pull` [s]
    kick_chaser(p)         acceleration of the chaser over a substep, from what is booked, into `p.pull` [m/s2]
    pull_chaser(p)         the same at an instant, from the last `pull` alone
    reel_in(p, work)       book the work of the reel over the substep just taken
    reach(p, work)         distance from the chaser to the vertex as shown [m]
    measure(p)             what is reported
    """

    pull: Any
    pull_shown: Any
    start: Any
    book: Any
    kick_chaser: Any
    pull_chaser: Any
    reel_in: Any
    reach: Any
    measure: Any


@kernel
def start(p):
    """Nothing pulled yet.

    Checked  tests/net_capture/test_schemes.py
    """
    p.tether_work = 0.0
    p.tether_grid = -1
    for axis in range(3):
        p.tether_impulse[axis] = 0.0


@kernel
def book(p, duration):
    """Impulse [N s] that the vertex takes in a time at the present tension [s]: the chaser takes the same at the end of
    the substep, however many stages it has.

    Checked  tests/net_capture/test_schemes.py
    """
    for axis in range(3):
        p.tether_impulse[axis] += duration * p.tether_pull[axis]


@kernel
def kick_chaser(p):
    """Acceleration of the chaser over the substep whose impulse is booked, into `p.pull` [m/s2].

    Checked  tests/net_capture/test_schemes.py
    """
    for axis in range(3):
        p.pull[axis] = -p.tether_impulse[axis] / (p.solver_substep * p.chaser_mass)
        p.tether_impulse[axis] = 0.0


@kernel
def pull_chaser(p):
    """Acceleration of the chaser under the tension at the vertex [m/s2].

    Checked  tests/net_capture/test_energy_book.py
    """
    for axis in range(3):
        p.pull[axis] = -p.tether_pull[axis] / p.chaser_mass


@kernel
def measure(p):
    """Length paid out, from the measured positions.

    Checked  tests/net_capture/test_energy_book.py
    """
    squared = 0.0
    for axis in range(3):
        d = p.vertex_position[axis] - p.chaser_position[axis]
        squared += d * d
    p.tether_paid_out = math.sqrt(squared)


def make(composition: Any) -> Tether:
    """Kernels of the tether at the vertex of the composition's net."""
    memory, rouse = composition.memory, composition.rouse
    node_plane, apex = memory.node_plane, memory.apex

    def make_towards(place: int) -> Any:
        """Kernel of the way from the vertex to the chaser, by the positions in the planes from `place` on."""

        @kernel
        def towards_chaser(p, work):
            """Vector from the vertex to the chaser into `tether_way`; returns its length [m].

            Checked  tests/net_capture/test_energy_book.py
            """
            for axis in range(3):
                plane = node_plane(p, work, place + axis)
                at = 0.0
                for i in range(p.apex_nodes):
                    at += plane[apex(p, work)[i]] / p.apex_nodes
                p.tether_way[axis] = p.chaser_place[axis] - at
            return math.sqrt(dot(p.tether_way, p.tether_way))

        return towards_chaser

    def make_pull(towards_chaser: Any, wake: bool) -> Any:
        """Kernel of the tension at the vertex, towards the chaser; `wake`: its nodes stand in rows that may sleep."""

        @kernel
        def pull(p, work):
            """Add the tension at the vertex, towards the chaser [N].

            Checked  tests/net_capture/test_energy_book.py
            """
            for axis in range(3):
                p.tether_pull[axis] = 0.0
            if p.tether_vertex_tension == 0.0:
                return
            if wake:
                for i in range(p.apex_nodes):
                    rouse(p, work, apex(p, work)[i])
            away = towards_chaser(p, work)
            if wake and p.tether_grid != p.grid:
                p.tether_reach = away
                p.tether_grid = p.grid
            if away > 0.0:
                for axis in range(3):
                    p.tether_pull[axis] = p.tether_vertex_tension * p.tether_way[axis] / away
                    force = node_plane(p, work, FX + axis)
                    for i in range(p.apex_nodes):
                        force[apex(p, work)[i]] += p.tether_pull[axis] / p.apex_nodes

        return pull

    now, shown = make_towards(X), make_towards(SHOWN)

    @kernel
    def reel_in(p, work):
        """The tension times what the line has come in.

        Checked  tests/net_capture/test_energy_book.py
        """
        if p.tether_vertex_tension != 0.0:
            before = p.tether_reach
            p.tether_reach = now(p, work)
            p.tether_grid = p.grid
            p.tether_work += p.tether_vertex_tension * (before - p.tether_reach)

    pull, pull_shown = make_pull(now, True), make_pull(shown, False)
    return Tether(pull, pull_shown, start, book, kick_chaser, pull_chaser, reel_in, shown, measure)


PART = Term(
    "tether that pays out freely; a tension signal may be injected where it is made fast",
    (
        positive("tether.length", "m", "length that can be paid out", 100.0),
        Variable("tether.vertex_tension", "N", "input", "tension at the vertex, towards the chaser", nominal=1.0),
        output("tether.paid_out", "m", "distance from the chaser to the vertex"),
        output("tether.work", "J", "work done by the tension signal so far"),
        state("tether_reach", "m", "distance from the chaser to the vertex at the begin of a substep that is pulled"),
        count("tether_grid", "which substep that is", "state"),
        state("tether_impulse[#]", "N.s", "what the vertex has taken in this substep", shape=(3,)),
        state("tether_way[#]", "m", "from the vertex to the chaser", shape=(3,)),
        state("tether_pull[#]", "N", "tension at the vertex, towards the chaser", shape=(3,)),
    ),
    make=make,
)
