"""A test of the closed net: it is pulled at its vertex, and either holds or slips off.

Once the target is captured, or the net has settled, a load of a given direction rises over a time, stays, and falls
again over the same time. It comes from outside, as a test bench's does: no body takes its reaction, its impulse and its
work are booked.

    F(t) = F0 min(t / ramp, 1, (2 ramp + duration - t) / ramp)    for 0 < t < 2 ramp + duration

Held: the target is still captured when the load is gone. Where the net can not be drawn together behind its target, and
grips it or lies over it like a lid, the load may come at a time instead; then it has held if more than half of what
was inside the net of the target is there still in the end. Told is also how far the net has moved about the target, in
the target's own axes, and which threads bore most at the end of the whole load.

Source   ours
Checked  tests/net_capture/test_pull_off.py
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

from fmu_src.extremes import Extreme, times
from fmu_src.interface import Term, Variable
from fmu_src.net_capture.bearing import MOST, make_bearing
from fmu_src.net_capture.enclosure import make_share
from fmu_src.net_capture.planes import FX, SHOWN, X
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.rows import at_least_zero, choice, count, output, peak, positive, state, vector
from orbital.kernel import kernel
from orbital.rotations import rotate_inverse
from orbital.vectors import dot

AFTER = ("captured", "settled", "time")
AFTER_SETTLED, AFTER_TIME = 1, 2
STILL_INSIDE = 0.5
"""Of what was inside when the load began, that must be inside when it is gone."""
STANDS = ("waiting", "pulled", "held", "slipped_off")
WAITING, PULLED, HELD, SLIPPED_OFF = range(len(STANDS))


class PullOff(NamedTuple):
    """Kernels of the test.

    start(p)              nothing pulled yet
    pull(p, work)         add the load at the vertex, for a substep
    pull_shown(p, work)   the same for the positions shown
    go_on(p, work)        book the work of the substep just taken
    look(p, work, time)   begin when it is time, and tell how it ended; the nodes as shown
    show(p, work, late)   what is told, `late` the time by which booked impulses end before now [s]
    """

    start: Any
    pull: Any
    pull_shown: Any
    go_on: Any
    look: Any
    show: Any


@kernel
def load(p, time):
    """Load [N] at a time since the shot [s].

    Checked  tests/net_capture/test_pull_off.py
    """
    if p.pull_off_t_start < 0.0:
        return 0.0
    since = time - p.pull_off_t_start
    left = 2.0 * p.pull_off_ramp + p.pull_off_duration - since
    return p.pull_off_force * max(0.0, min(1.0, since / p.pull_off_ramp, left / p.pull_off_ramp))


def make(composition: Any) -> PullOff:
    """Kernels for the composition's net, target and clock."""
    memory, rouse, now = composition.memory, composition.rouse, composition.clock.now
    node_plane, apex = memory.node_plane, memory.apex
    tell_threads, share_inside = make_bearing(composition), make_share(composition)

    def make_vertex(place: int) -> Any:
        """Kernel of the vertex by the positions in the planes from `place` on."""

        @kernel
        def vertex(p, work, out):
            """out = the vertex [m].

            Checked  tests/net_capture/test_pull_off.py
            """
            for axis in range(3):
                plane = node_plane(p, work, place + axis)
                out[axis] = 0.0
                for i in range(p.apex_nodes):
                    out[axis] += plane[apex(p, work)[i]] / p.apex_nodes

        return vertex

    vertex_now, vertex_shown = make_vertex(X), make_vertex(SHOWN)

    @kernel
    def add_force(p, work, force):
        """Add a load [N] to the nodes of the vertex, shared evenly.

        Checked  tests/net_capture/test_pull_off.py
        """
        for axis in range(3):
            plane = node_plane(p, work, FX + axis)
            for i in range(p.apex_nodes):
                plane[apex(p, work)[i]] += force * p.pull_off_way[axis] / p.apex_nodes

    @kernel
    def add_impulse(p, out, moment, at, force, span):
        """Add to impulse [N s] and its moment about the origin [N m s] what a load [N] gives at a place in a time [s].

        Checked  tests/net_capture/test_pull_off.py
        """
        for axis in range(3):
            y, z = (axis + 1) % 3, (axis + 2) % 3
            out[axis] += span * force * p.pull_off_way[axis]
            moment[axis] += span * force * (at[y] * p.pull_off_way[z] - at[z] * p.pull_off_way[y])

    @kernel
    def pull(p, work):
        """Add the load, and book its impulse over the substep.

        Checked  tests/net_capture/test_pull_off.py
        """
        force = load(p, now(p))
        if force > 0.0:
            for i in range(p.apex_nodes):
                rouse(p, work, apex(p, work)[i])
            add_force(p, work, force)
            vertex_now(p, work, p.pull_off_at)
            add_impulse(p, p.pull_off_booked, p.pull_off_moment, p.pull_off_at, force, p.solver_substep)

    @kernel
    def pull_shown(p, work):
        """Add the load to what is shown.

        Checked  tests/net_capture/test_pull_off.py
        """
        add_force(p, work, load(p, now(p)))

    @kernel
    def go_on(p, work):
        """Work [J] of the substep just taken, by the mean of the loads at both its ends.

        Checked  tests/net_capture/test_pull_off.py
        """
        force = load(p, now(p))
        before = load(p, now(p) - p.solver_substep)
        if before > 0.0:
            way = p.scratch[0:3]
            for axis in range(3):
                way[axis] = p.pull_off_at[axis]
            vertex_now(p, work, p.pull_off_at)
            for axis in range(3):
                way[axis] = p.pull_off_at[axis] - way[axis]
            p.pull_off_work += 0.5 * (before + force) * dot(way, p.pull_off_way)

    @kernel
    def stand(p, work):
        """Into the scratch: centre of mass of the net (0 to 2) and vertex (3 to 5) from the target's, in its axes [m].

        Checked  tests/net_capture/test_pull_off.py
        """
        net, tip = p.scratch[0:3], p.scratch[3:6]
        vertex_shown(p, work, tip)
        for axis in range(3):
            net[axis] = p.catch_position[axis] - p.target_place[axis]
            tip[axis] -= p.target_place[axis]
        rotate_inverse(net, p.target_pose, net)
        rotate_inverse(tip, p.target_pose, tip)

    @kernel
    def aim(p, work):
        """Direction of the load: as told, or from the vertex to the chaser as it is now.

        Checked  tests/net_capture/test_pull_off.py
        """
        for axis in range(3):
            p.pull_off_way[axis] = p.pull_off_direction[axis]
        if dot(p.pull_off_way, p.pull_off_way) == 0.0:
            vertex_shown(p, work, p.pull_off_way)
            for axis in range(3):
                p.pull_off_way[axis] = p.chaser_place[axis] - p.pull_off_way[axis]
        length = math.sqrt(dot(p.pull_off_way, p.pull_off_way))
        for axis in range(3):
            p.pull_off_way[axis] /= length

    @kernel
    def look(p, work, time):
        """Begin when captured or settled for so long, or at the time; tell how it ended.

        Checked  tests/net_capture/test_pull_off.py
        """
        if p.pull_off_stands == WAITING:
            waits = p.captured == 0 or (p.pull_off_after == AFTER_SETTLED and p.settled == 0)
            if p.pull_off_after == AFTER_TIME:
                waits = time < p.pull_off_time
            if waits:
                p.pull_off_ready = -1.0
            elif p.pull_off_ready < 0.0:
                p.pull_off_ready = time
            if p.pull_off_ready >= 0.0 and time >= p.pull_off_ready + p.pull_off_delay:
                p.pull_off_stands = PULLED
                p.pull_off_t_start = time
                p.pull_off_fresh = 1
                p.pull_off_inside[0] = share_inside(p, work)
                aim(p, work)
        elif p.pull_off_stands == PULLED:
            over = time >= p.pull_off_t_start + 2.0 * p.pull_off_ramp + p.pull_off_duration
            if p.pull_off_after != AFTER_TIME and p.captured == 0:
                p.pull_off_stands = SLIPPED_OFF
            elif over:
                p.pull_off_inside[1] = share_inside(p, work)
                gone = p.pull_off_inside[1] <= STILL_INSIDE * p.pull_off_inside[0]
                p.pull_off_stands = SLIPPED_OFF if p.pull_off_after == AFTER_TIME and gone else HELD

    @kernel
    def show(p, work, late):
        """What is told of the load, of the way of the net and of its threads.

        Checked  tests/net_capture/test_pull_off.py
        """
        force = load(p, now(p))
        p.pull_off_load = force
        vertex_shown(p, work, p.scratch[0:3])
        for axis in range(3):
            p.pull_off_impulse[axis] = p.pull_off_booked[axis]
            p.pull_off_angular_impulse[axis] = p.pull_off_moment[axis]
        add_impulse(p, p.pull_off_impulse, p.pull_off_angular_impulse, p.scratch[0:3], force, late)
        if p.pull_off_stands == WAITING:
            return
        stand(p, work)
        if p.pull_off_fresh != 0:
            p.pull_off_fresh = 0
            for i in range(6):
                p.pull_off_begun[i] = p.scratch[i]
        way = p.scratch[6:9]
        rotate_inverse(way, p.target_pose, p.pull_off_way)
        p.pull_off_drawn = 0.0
        for axis in range(3):
            p.pull_off_slip[axis] = p.scratch[axis] - p.pull_off_begun[axis]
            p.pull_off_drawn += way[axis] * (p.scratch[3 + axis] - p.pull_off_begun[3 + axis])
        p.pull_off_drawn_max = max(p.pull_off_drawn_max, p.pull_off_drawn)
        if p.pull_off_stands == PULLED:
            if p.thread_tension_peak > p.pull_off_tension_max:
                p.pull_off_tension_max = p.thread_tension_peak
                p.pull_off_tension_index = p.thread_peak_index
            if force >= p.pull_off_force:
                tell_threads(p, work)

    @kernel
    def start(p):
        """Nothing pulled yet.

        Checked  tests/net_capture/test_pull_off.py
        """
        p.pull_off_t_start = -1.0
        p.pull_off_ready = -1.0
        p.pull_off_stands = WAITING
        p.pull_off_fresh = 0
        p.pull_off_inside[0] = -1.0
        p.pull_off_inside[1] = -1.0
        p.pull_off_work = 0.0
        p.pull_off_drawn_max = 0.0
        p.pull_off_tension_max = 0.0
        p.pull_off_tension_index = 0
        for axis in range(3):
            p.pull_off_booked[axis] = 0.0
            p.pull_off_moment[axis] = 0.0

    return PullOff(start, pull, pull_shown, go_on, look, show)


def refuses(scene: Scene) -> Iterator[Refusal]:
    """What never comes, and what its books do not know."""
    if scene.values["pull_off.after"] == AFTER_SETTLED and "settling" not in scene.terms:
        yield Refusal("pull_off.after", "settled", "needs the table [capture.settling]")
    if scene.terms.get("substeps", "fixed") != "fixed":
        expected = 'must be "fixed": the impulse of [capture.pull_off] is booked in substeps of one length'
        yield Refusal("solver.substeps", f'"{scene.terms["substeps"]}"', expected)


PART = Term(
    "test of the closed net: it is pulled at its vertex, and holds or slips off",
    (
        positive("pull_off.force", "N", "with which the vertex is pulled", 10.0),
        vector(
            "pull_off.direction",
            "1",
            "of that force, orbital frame; zero: from the vertex to the chaser, as they stand when it begins",
            "parameter",
        ),
        choice("pull_off.after", "what has to come before", AFTER),
        at_least_zero("pull_off.time", "s", "since the shot, for after time", 15.0),
        at_least_zero("pull_off.delay", "s", "after that until the force begins", 0.0),
        positive("pull_off.ramp", "s", "in which it rises, and falls in the end", 2.0),
        at_least_zero("pull_off.duration", "s", "of the whole force", 5.0),
        Variable(
            "pull_off.stands",
            "1",
            "output",
            "how the test stands",
            0,
            kind="Integer",
            minimum=0,
            maximum=len(STANDS) - 1,
            choices=STANDS,
        ),
        peak("pull_off.t_start", "s", "when the force began, since the shot; -1 before"),
        output("pull_off.load", "N", "with which the vertex is pulled now"),
        vector("pull_off.impulse", "N.s", "that the load has given, orbital frame: momentum grows by it"),
        vector("pull_off.angular_impulse", "N.m.s", "its moment about the frame's origin"),
        output("pull_off.work", "J", "of the load so far"),
        vector("pull_off.slip", "m", "way of the net's centre of mass about the target since then, the target's axes"),
        output("pull_off.drawn", "m", "way of the vertex about the target since then, along the load"),
        peak("pull_off.drawn_max", "m", "the most of that"),
        peak("pull_off.inside[#]", "1", "share of the target inside as it began and in the end; -1 before", shape=(2,)),
        peak("pull_off.tension_max", "N", "largest tension of a thread while the net was pulled"),
        count("pull_off.tension_index", "which thread that was, counted from 1"),
        peak(
            "pull_off.hardest[#].tension",
            "N",
            "largest tensions when last looked at under the whole load",
            shape=(MOST,),
        ),
        count("pull_off.hardest[#].thread", "which threads those were, counted from 1", shape=(MOST,)),
        peak("pull_off.hardest[#].position[#]", "m", "middles of those threads, the target's axes", shape=(MOST, 3)),
        state("pull_off_way[#]", "1", "direction of the load", shape=(3,)),
        state("pull_off_at[#]", "m", "the vertex at the begin of a substep that is pulled", shape=(3,)),
        state("pull_off_booked[#]", "N.s", "impulse up to half a substep back", shape=(3,)),
        state("pull_off_moment[#]", "N.m.s", "its moment up to then", shape=(3,)),
        state("pull_off_begun[#]", "m", "net and vertex about the target when it began", shape=(6,)),
        state("pull_off_ready", "s", "since when what has to come before has been there"),
        count("pull_off_fresh", "whether it has only just begun", "state"),
    ),
    needs=("target", "contact", "closing"),
    make=make,
    refuses=refuses,
    extremes=(
        Extreme(
            "a tug that tears at the vertex",
            "a thousand times the load of the test, at once",
            "energy_gained",
            {"pull_off.force": times("pull_off.force", 1e3), "pull_off.ramp": 1e-3},
        ),
    ),
)
