"""Substeps that follow the net as it is: which threads are taut, or may be before the next look.

At every look at the mouth, `MEASURE_INTERVAL` apart, the threads are counted that are taut, or would be at the end of
the interval if their ends flew straight on, with an `ALLOWANCE`. What meets at a node of these, and of the cord once
the winches run, bounds the spectrum as it does in `formulas.longest_step`, where all threads count:

    omega^2 <= 2 max over the nodes of (sum k) / m

A single thread always counts, for any may snap taut, and so does a surface with a spring, which any node may meet; and
the substep is never shorter than the one for the net with every thread taut. Where nodes may reach the target in the
interval, none moves further relative to its surface in a substep than `stepping.WAY_SHARE` of its least dimension.

No forecast is trusted. In every substep the threads that are taut are held against it; where one was not expected and
the sum at its ends asks for a shorter substep, the rest of the interval is walked with that. And of the threads that
were taut in truth, all of an interval taken together, the bound over the substep is kept: its least is
`solver.margin_least`.

Checked  tests/net_capture/test_following.py
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from fmu_src.interface import Term
from fmu_src.net_capture.pace import Clock, Pace, Traits
from fmu_src.net_capture.pace.meeting import EXPECTED, SEEN, SETS, make_meeting
from fmu_src.net_capture.planes import (
    DAMPING,
    INVERSE_MASS,
    LANES,
    LENGTH,
    MASS,
    NODE_PLANES,
    SHOWN,
    SHOWN_RATE,
    STIFFNESS,
    STRIP_NUMBERS,
    STRIP_WORDS,
    A,
    B,
)
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.net_capture.stepping import MEASURE_INTERVAL, WAY_SHARE
from fmu_src.rows import count, output, peak, state
from orbital.kernel import kernel
from orbital.vectors import dot

ALLOWANCE = 1.0
"""Of the bullets' speed: by so much the ends of a thread are expected to come apart faster than they do now, for a snap
may throw a light node. One that was not expected is seen, so it is a matter of how often that is."""
KEEP = 0.9
"""Share of the present number of substeps above which a smaller one is not worth the change."""


@kernel
def now(p):
    """Grid time since the shot [s].

    Checked  tests/net_capture/test_following.py
    """
    return p.pace_time + (p.grid - p.pace_grid) * p.solver_substep


@kernel
def reach(p, end):
    """Number of the substep, with its fraction, at which a time of the tool's clock lies [1], at the present substep.

    Checked  tests/net_capture/test_following.py
    """
    return p.pace_grid + (end - p.start_time - p.pace_time) / p.solver_substep


@kernel
def due(p):
    """Whether mouth and capture are to be looked at now.

    Checked  tests/net_capture/test_following.py
    """
    return p.grid == p.pace_next


@kernel
def looks(p):
    """How often they have been looked at [1], this time included.

    Checked  tests/net_capture/test_following.py
    """
    return p.pace_looks + 1


@kernel
def wanted(p):
    """Longest substep that is wanted now [s].

    Checked  tests/net_capture/test_following.py
    """
    return max(p.pace_wanted, p.pace_finest)


@kernel
def settle(p, step):
    """Substep with which the rest of the interval is walked [s]: a whole number of them, none longer than `step` [s].

    Checked  tests/net_capture/test_following.py
    """
    left = (p.pace_next - p.grid) * p.solver_substep
    time = now(p)
    if p.grid == p.pace_next:
        p.pace_looks += 1
        left = MEASURE_INTERVAL
        time = p.pace_looks * MEASURE_INTERVAL
    number = max(math.ceil(left / step - 1e-9), 1)
    present = math.ceil(left / p.solver_substep - 1e-9)
    if KEEP * present < number < present:
        number = present
    p.pace_late = 0
    p.pace_time = time
    p.pace_grid = p.grid
    p.pace_next = p.grid + number
    return left / number


def refuses(scene: Scene) -> Iterator[Refusal]:
    """A scheme without a bound, which leaves nothing to follow."""
    if not scene.parts["solver"].checks.follows:
        expected = f'must be "fixed" with {scene.terms["solver"]}, which has no bound that substeps could follow'
        yield Refusal("solver.substeps", "following", expected)


def make(composition: Any) -> Pace:
    """Kernels for the composition's net, scheme, cord and target; ValueError with a scheme whose step stays."""
    if not composition.needs.follows:
        raise ValueError(f"substeps cannot follow the net with the scheme {composition.terms['solver']}")
    memory, lanes, needs = composition.memory, composition.lanes, composition.needs
    node_plane, strips, properties, own, reals_of = (
        memory.node_plane,
        memory.strips,
        memory.properties,
        memory.own,
        memory.reals,
    )
    load, splat, where, bits, width = lanes.load, lanes.splat, lanes.where, lanes.bits, lanes.width
    allow, longest_step, meet_strip = composition.meeting.allow, needs.longest_step, composition.meeting.meet_strip
    first_plane = NODE_PLANES + needs.planes
    has_contact, has_closing = composition.contact is not None, composition.closing is not None
    everywhere = composition.everywhere
    swings = composition.target is not None and composition.target.hinge is not None
    reach = composition.target.hinge.reach if swings else None
    from fmu_src.lanes import highest, lowest, peek, poke

    stiffen = composition.closing.stiffen if has_closing else None

    @kernel
    def note(p, reals, table, numbers, words, strip, taut):
        """Threads of a strip that are taut in this substep: new ones count, and whether they were expected.

        Checked  tests/net_capture/test_following.py
        """
        at = words.size - SETS * p.strips + strip
        seen = np.uint64(peek(words, at + SEEN * p.strips))
        fresh = taut & ~seen
        if fresh == np.uint64(0):
            return
        poke(words, at + SEEN * p.strips, np.int64(seen | fresh))
        meet_strip(p, reals, table, numbers, strip, SEEN, fresh)
        p.solver_margin_least = min(p.solver_margin_least, p.pace_seen / p.solver_substep)
        expected = np.uint64(peek(words, at + EXPECTED * p.strips))
        fresh &= ~expected
        if fresh != np.uint64(0):
            poke(words, at + EXPECTED * p.strips, np.int64(expected | fresh))
            meet_strip(p, reals, table, numbers, strip, EXPECTED, fresh)
            p.solver_unexpected += 1
            if wanted(p) < p.solver_substep:
                p.pace_late = 1

    @kernel
    def may_be_taut(p, reals, a, b, lanes, length):
        """Threads of a strip that are taut, or are after the interval if their ends fly straight on, a bit each.

        A length on a straight way is longest at one of its ends.

        Checked  tests/net_capture/test_following.py
        """
        slots = p.node_slots
        short = max(length - ALLOWANCE * p.bullets_speed * MEASURE_INTERVAL, 0.0)
        limit = splat(short * short)
        span = splat(MEASURE_INTERVAL)
        found = np.uint64(0)
        for j in range(0, np.int64(highest(np.uint64(lanes))) + 1, width):
            here = splat(0.0)
            there = splat(0.0)
            for axis in range(3):
                m = a + j + (SHOWN + axis) * slots
                n = b + j + (SHOWN + axis) * slots
                d = load(reals, n) - load(reals, m)
                m += (SHOWN_RATE - SHOWN) * slots
                n += (SHOWN_RATE - SHOWN) * slots
                e = d + span * (load(reals, n) - load(reals, m))
                here = here + d * d
                there = there + e * e
            found |= bits(where(there > here, there, here) > limit) << np.uint64(j)
        return found & np.uint64(lanes)

    @kernel
    def single(p, work):
        """What a thread asks for that is taut all by itself, least of all: omega^2 = k (1/m_a + 1/m_b).

        Checked  tests/net_capture/test_following.py
        """
        table, numbers = strips(p, work), properties(p, work)
        inverse = node_plane(p, work, INVERSE_MASS)
        p.pace_single = math.inf
        p.pace_single_bound = math.inf
        for strip in range(p.strips):
            s = STRIP_WORDS * strip
            q = STRIP_NUMBERS * strip
            these = np.uint64(table[s + LANES])
            while these != np.uint64(0):
                i = np.int64(lowest(these))
                these &= these - np.uint64(1)
                light = 0.5 * (np.float64(inverse[table[s + A] + i]) + np.float64(inverse[table[s + B] + i]))
                stiffness, damping = numbers[q + STIFFNESS] * light, numbers[q + DAMPING] * light
                pressing, resisting = everywhere(p)
                bound = longest_step(stiffness + pressing, damping + resisting)
                p.pace_single_bound = min(p.pace_single_bound, bound)
                p.pace_single = min(p.pace_single, allow(p, stiffness, damping))

    @kernel
    def fastest(p, work):
        """Largest speed relative to a point within the envelope [m/s] of the nodes that may come there in the interval.

        Checked  tests/net_capture/test_following.py
        """
        mass = node_plane(p, work, MASS)
        if swings:
            turning = math.sqrt(dot(p.hinge_rates[0:3], p.hinge_rates[0:3])) * p.envelope_radius
            turning += abs(p.hinge_rates[3]) * reach(p)
        else:
            least = min(p.target_inertia[0], p.target_inertia[1], p.target_inertia[2])
            turning = math.sqrt(dot(p.target_spin, p.target_spin)) / least * p.envelope_radius
        found = 0.0
        for node in range(p.node_slots):
            if mass[node] > 0.0:
                away = 0.0
                speed = 0.0
                for axis in range(3):
                    d = np.float64(node_plane(p, work, SHOWN + axis)[node]) - p.target_place[axis]
                    v = np.float64(node_plane(p, work, SHOWN_RATE + axis)[node]) - p.target_drift[axis]
                    away += d * d
                    speed += v * v
                speed = math.sqrt(speed) + turning
                if math.sqrt(away) < p.envelope_radius + 2.0 * MEASURE_INTERVAL * speed:
                    found = max(found, speed)
        return found

    @kernel
    def look(p, work):
        """Step that the coming interval allows [s]; the nodes as shown.

        Checked  tests/net_capture/test_following.py
        """
        reals, words = reals_of(work), own(p, work)
        table, numbers = strips(p, work), properties(p, work)
        at = words.size - SETS * p.strips
        for i in range(first_plane * p.node_slots, (first_plane + 2 * SETS) * p.node_slots):
            reals[i] = 0.0
        p.solver_bound_now = p.pace_single_bound
        p.pace_wanted = p.pace_single
        p.pace_seen = p.pace_single_bound
        if has_closing:
            stiffen(p, work, MEASURE_INTERVAL)
        for strip in range(p.strips):
            s = STRIP_WORDS * strip
            length = numbers[STRIP_NUMBERS * strip + LENGTH]
            found = may_be_taut(p, reals, table[s + A], table[s + B], table[s + LANES], length)
            words[at + EXPECTED * p.strips + strip] = np.int64(found)
            words[at + SEEN * p.strips + strip] = 0
            meet_strip(p, reals, table, numbers, strip, EXPECTED, found)
        p.pace_finest = MEASURE_INTERVAL / p.measure_every
        if has_contact:
            speed = fastest(p, work)
            way = WAY_SHARE * p.target_thickness
            if speed * p.pace_finest > way:
                p.pace_finest = way / speed
            if speed * p.pace_wanted > way:
                p.pace_wanted = way / speed
        return wanted(p)

    @kernel
    def start(p, work):
        """Nothing noted yet.

        Checked  tests/net_capture/test_following.py
        """
        single(p, work)
        p.pace_time = 0.0
        p.pace_grid = 0
        p.pace_next = 0
        p.pace_looks = -1
        p.solver_unexpected = 0
        p.solver_margin_least = math.inf
        p.solver_substep_least = math.inf
        p.solver_substep_most = 0.0

    return Pace(note, start, look, wanted, settle)


PART = Term(
    "that follow the threads which are taut or may be: as long as the net as it is allows, and nodes near the target",
    (
        output("solver.substep", "s", "substep in use"),
        output("solver.bound_now", "s", "stability bound of what is taut or may be before the next look"),
        peak("solver.substep_least", "s", "shortest substep so far"),
        peak("solver.substep_most", "s", "longest substep so far"),
        output("solver.substep_mean", "s", "mean substep so far"),
        peak("solver.margin_least", "1", "least bound of the threads that were taut in truth, over the substep"),
        count("solver.unexpected", "how often threads of a strip went taut that were not expected to"),
        state("pace_time", "s", "grid time at which the substep was last set"),
        count("pace_grid", "substep at which that was", "state"),
        count("pace_next", "substep of the next look", "state"),
        count("pace_looks", "looks so far", "state"),
        count("pace_late", "whether a shorter substep is wanted before the next look", "state"),
        state("pace_wanted", "s", "substep that the threads allow which are expected to be taut"),
        state("pace_finest", "s", "substep that the net would need with every thread taut, and no node too fast"),
        state("pace_seen", "s", "stability bound of the threads that were taut since the last look"),
        state("pace_single", "s", "substep that any thread by itself allows"),
        state("pace_single_bound", "s", "stability bound of any thread by itself"),
    ),
    make=make,
    refuses=refuses,
    checks=Traits(Clock(now, reach, due, looks), make_meeting, 2 * SETS, SETS),
)
