"""The tether while the net is cast: slack, but a tension signal (a reel's) may be injected where it is made fast; or
drawn off its spool against friction and, from some length on, a brake.

    T = F + B where out >= brake_at,   while more is drawn off than ever was; otherwise 0

Valid    a line without stretch and mass; at its whole length the run says `tether_taut` and holds nothing back
Source   Coulomb friction; ours
Checked  tests/net_capture/test_pay_out.py
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial
from typing import Any, NamedTuple

from fmu_src.extremes import Extreme
from fmu_src.interface import Term, Variable
from fmu_src.net_capture.planes import FX, SHOWN, X
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.rows import at_least_zero, count, output, positive, state
from orbital.kernel import kernel
from orbital.vectors import dot

SCHEME = "leapfrog"
"""That lets a tether drag."""


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
    """Length paid out and its rate, from the measured positions and velocities.

    Checked  tests/net_capture/test_energy_book.py, tests/cosim/test_capture_reel.py
    """
    squared = 0.0
    product = 0.0
    for axis in range(3):
        d = p.vertex_position[axis] - p.chaser_position[axis]
        squared += d * d
        product += d * (p.vertex_velocity[axis] - p.chaser_velocity[axis])
    p.tether_paid_out = math.sqrt(squared)
    p.tether_rate = product / p.tether_paid_out if squared > 0.0 else 0.0


def make(composition: Any, drags: bool = False) -> Tether:
    """Kernels of the tether at the vertex of the composition's net.

    drags    it is drawn off against friction
    """
    if drags and composition.terms["solver"] != SCHEME:
        raise ValueError(f"net_capture: a tether that drags needs solver = {SCHEME!r}")
    memory, rouse = composition.memory, composition.rouse
    node_plane, apex = memory.node_plane, memory.apex

    @kernel
    def drag(p, away):
        """Tension [N] of friction and brake at a distance from the chaser to the vertex [m].

        Checked  tests/net_capture/test_pay_out.py
        """
        if away <= p.tether_out:
            return 0.0
        return p.tether_friction + (p.tether_brake_force if away >= p.tether_brake_at else 0.0)

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
            if p.tether_vertex_tension == 0.0 and not drags:
                return
            if wake:
                for i in range(p.apex_nodes):
                    rouse(p, work, apex(p, work)[i])
            away = towards_chaser(p, work)
            if wake and p.tether_grid != p.grid:
                p.tether_reach = away
                p.tether_grid = p.grid
            tension = p.tether_vertex_tension
            if drags:
                p.tether_drag = drag(p, away)
                tension += p.tether_drag
            if away > 0.0:
                for axis in range(3):
                    p.tether_pull[axis] = tension * p.tether_way[axis] / away
                    force = node_plane(p, work, FX + axis)
                    for i in range(p.apex_nodes):
                        force[apex(p, work)[i]] += p.tether_pull[axis] / p.apex_nodes

        return pull

    now, shown = make_towards(X), make_towards(SHOWN)

    @kernel
    def reel_in(p, work):
        """The tension times what the line has come in.

        Friction keeps the tension that it had at the begin of the substep. Where the line turns back within it, at an
        acceleration a after a share u of the substep h, the loss falls by up to F a h^2/2: of second order, and what
        the bodies got, so the book closes.

        Checked  tests/net_capture/test_energy_book.py
        """
        if p.tether_vertex_tension != 0.0 or drags:
            before = p.tether_reach
            p.tether_reach = now(p, work)
            p.tether_grid = p.grid
            p.tether_work += p.tether_vertex_tension * (before - p.tether_reach)
            if drags:
                p.tether_friction_loss += p.tether_drag * (p.tether_reach - before)
                p.tether_out = max(p.tether_out, before)

    @kernel
    def begin(p):
        """Nothing pulled and nothing drawn off yet.

        Checked  tests/net_capture/test_pay_out.py
        """
        start(p)
        if drags:
            p.tether_friction_loss = 0.0
            p.tether_drag = 0.0
            p.tether_out = 0.0

    pull, pull_shown = make_pull(now, True), make_pull(shown, False)
    return Tether(pull, pull_shown, begin, book, kick_chaser, pull_chaser, reel_in, shown, measure)


def refuses(scene: Scene) -> Iterator[Refusal]:
    """A scheme that takes several stages in a substep: what is drawn off is known at its ends only."""
    scheme = scene.terms.get("solver", SCHEME)
    if scheme != SCHEME:
        yield Refusal("solver.scheme", f'"{scheme}"', f'knows no tether that drags; it needs "{SCHEME}"')


ROWS = (
    positive("tether.length", "m", "length that can be paid out", 100.0),
    Variable("tether.vertex_tension", "N", "input", "tension at the vertex, towards the chaser", nominal=1.0),
    output("tether.paid_out", "m", "distance from the chaser to the vertex"),
    output("tether.rate", "m/s", "rate of that distance"),
    output("tether.work", "J", "work done by the tension signal so far"),
    state("tether_reach", "m", "distance from the chaser to the vertex at the begin of a substep that is pulled"),
    count("tether_grid", "which substep that is", "state"),
    state("tether_impulse[#]", "N.s", "what the vertex has taken in this substep", shape=(3,)),
    state("tether_way[#]", "m", "from the vertex to the chaser", shape=(3,)),
    state("tether_pull[#]", "N", "tension at the vertex, towards the chaser", shape=(3,)),
)

PART = Term("tether that pays out freely; a tension signal may be injected where it is made fast", ROWS, make=make)
DRAGGING = Term(
    "tether drawn off its spool against friction and, from some length on, a brake",
    (
        *ROWS,
        at_least_zero("tether.friction", "N", "tension at which it is drawn off", 1.0),
        at_least_zero("tether.brake_force", "N", "tension that the brake adds", 0.0),
        at_least_zero("tether.brake_at", "m", "length drawn off from which the brake holds", 0.0),
        output(
            "tether.friction_loss",
            "J",
            "taken by friction and brake so far; a substep keeps its tension to its end, so the one in which the line "
            "turns back gives a little of it back: an error of the scheme, of second order",
        ),
        state("tether_drag", "N", "tension of friction and brake in this substep"),
        state("tether_out", "m", "most that was drawn off before this substep"),
    ),
    make=partial(make, drags=True),
    refuses=refuses,
    extremes=(
        Extreme("a spool that hardly turns", "the line stops the net", "energy_gained", {"tether.friction": 10.0}),
        Extreme(
            "a brake of a kilonewton",
            "it would throw the vertex back within a substep",
            "energy_gained",
            {"tether.brake_force": 1e3, "tether.brake_at": 0.0},
        ),
    ),
)
