"""Leapfrog: velocities live half a substep before positions, so one evaluation of the forces serves.

    v(n + 1/2) = v(n - 1/2) + h a(x(n)),   x(n + 1) = x(n) + h v(n + 1/2)

Dashpots see the velocity predicted for the instant of the positions, v(n - 1/2) plus half the last kick: half a substep
back they would make the scheme one of first order.

Order 2 with damping, where no thread changes between slack and taut. Stable up to `explicit_step_limit` of
`orbital.oscillators`.

Rows asleep. A node that nothing pulls flies freely, so of a strip that is slack the instant is known before which none
of its threads can be taut. Until then the strip is not looked at, and its rows stay where they are in memory, each with
the substep to which its positions belong (`STAMP`); they are flown there when next needed. A kick wakes the strips of
the row, and so do the cord and a tension at the vertex; a row that may be within reach of the target is flown and
looked at in every substep. What is shown is flown in a copy, so that the bits do not depend on when outputs are read.

Rows are taken in order. Each strip belongs to the first of its two rows, so when a row's turn has come all its forces
are there: it is kicked and drifted at once, while it is still in the first cache.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fmu_src.interface import Term
from fmu_src.net_capture.planes import (
    FIRST,
    FX,
    INVERSE_MASS,
    LANES,
    LENGTH,
    SHOWN,
    SHOWN_BACK,
    SHOWN_RATE,
    SQUARED,
    STRIP_NUMBERS,
    STRIP_WORDS,
    A,
    B,
    P,
    U,
    X,
)
from fmu_src.net_capture.schemes import Needs, Scheme
from fmu_src.net_capture.stepping import LONGEST_SLEEP
from fmu_src.net_capture.threads import make_threads
from orbital.kernel import kernel

STAMP, NEXT, KICKED, TOUCHED, CLEAR, STRIPS, OWN_END, STRIPS_END, ROW_WORDS = range(9)
"""Columns of the rows: substep that its positions belong to; when it is next looked at; lanes that the last kick moved;
lanes that something pulls now; until when the target is out of its reach; its strips in the list of neighbours, those
that belong to it first."""
WAKE, QUIET, TAUT, ROW_A, ROW_B, SLEEP_WORDS = range(6)
"""Columns of a strip's sleep: when it is next looked at; for how many looks on end it has been slack; lanes that were
taut a substep ago; rows of its two ends."""

QUIET_LOOKS = 8
"""Slack looks on end before it is worth working out how long a strip may sleep: that costs as much as four looks."""
LAG = 0.5
SURE = 0.999
"""Share of the sleep worked out that is slept: more than all rounding."""


def make(composition: Any) -> Scheme:
    """Kernels of the scheme with the composition's gravity, contact and pulls."""
    memory, lanes, gravity = composition.memory, composition.lanes, composition.gravity
    contact, pulls = composition.contact, composition.pulls
    threads = make_threads(composition, P, U)
    taut_lanes, pull, pull_shown = threads.taut, threads.pull, threads.pull_shown
    load, store, splat, where, root, lane = lanes.load, lanes.store, lanes.splat, lanes.where, lanes.root, lanes.lane
    strips, properties, own, reals_of = memory.strips, memory.properties, memory.own, memory.reals
    node_plane = memory.node_plane
    width, ramp = lanes.width, lanes.ramp
    from fmu_src.lanes import highest, lowest, peek, poke

    group = np.uint64((1 << width) - 1)

    kick_group, coast_group, fly_group = gravity.kick_group, gravity.coast_group, gravity.fly_group
    begin_flight, stray, accelerate = gravity.begin_flight, gravity.stray, gravity.accelerate
    bends, rate_of = gravity.bends, gravity.rate
    has_contact = contact is not None
    begin_step, touch_row, clear_steps, hurries = (
        (contact.begin_step, contact.touch_row, contact.clear_steps, contact.hurries) if has_contact else [None] * 4
    )
    pull_nodes, pull_nodes_shown, book = pulls.pull, pulls.pull_shown, pulls.book

    @kernel
    def own_words(p):
        """Whole numbers that rows, strips and their lists take [1].

        Checked  tests/net_capture/test_sleep.py
        """
        return (
            ROW_WORDS * (p.node_slots // p.row_pitch) + (SLEEP_WORDS + 2) * p.strips
        )  # a strip is listed twice at most

    @kernel
    def find_neighbours(p, work):
        """List the strips of every row, those that begin in it first; all awake.

        Checked  tests/net_capture/test_sleep.py
        """
        table = strips(p, work)
        words = own(p, work)
        rows = p.node_slots // p.row_pitch
        listed = ROW_WORDS * rows + SLEEP_WORDS * p.strips
        at = 0
        for row in range(rows):
            words[ROW_WORDS * row + TOUCHED] = 0
            words[ROW_WORDS * row + STRIPS_END] = 0
            words[ROW_WORDS * row + OWN_END] = 0
        for q in range(p.strips):
            a = table[STRIP_WORDS * q + A] // p.row_pitch
            b = table[STRIP_WORDS * q + B] // p.row_pitch
            words[ROW_WORDS * min(a, b) + OWN_END] += 1
            words[ROW_WORDS * max(a, b) + STRIPS_END] += 1 if a != b else 0
        for row in range(rows):
            r = ROW_WORDS * row
            words[r + STAMP] = 0
            words[r + NEXT] = 0
            words[r + KICKED] = -1
            words[r + CLEAR] = 0
            words[r + STRIPS] = at
            of_it, others = words[r + OWN_END], words[r + STRIPS_END]
            words[r + OWN_END] = at
            words[r + STRIPS_END] = at + of_it
            at += of_it + others
        for q in range(p.strips):
            a = table[STRIP_WORDS * q + A] // p.row_pitch
            b = table[STRIP_WORDS * q + B] // p.row_pitch
            z = ROW_WORDS * rows + SLEEP_WORDS * q
            words[z + WAKE] = 0
            words[z + QUIET] = 0
            words[z + TAUT] = 0
            words[z + ROW_A] = a
            words[z + ROW_B] = b
            r = ROW_WORDS * min(a, b)
            words[listed + words[r + OWN_END]] = q
            words[r + OWN_END] += 1
            if a != b:
                r = ROW_WORDS * max(a, b)
                words[listed + words[r + STRIPS_END]] = q
                words[r + STRIPS_END] += 1

    @kernel
    def begin(p, work):
        """Velocities half a substep back, from those of the start; all rows awake.

        Checked  tests/net_capture/test_sleep.py
        """
        find_neighbours(p, work)
        half = 0.5 * p.solver_substep
        for axis in range(3):
            for i in range(p.node_slots):
                node_plane(p, work, P + axis)[i] = node_plane(p, work, U + axis)[i]
                node_plane(p, work, SHOWN + axis)[i] = node_plane(p, work, X + axis)[i]
                node_plane(p, work, SHOWN_RATE + axis)[i] = node_plane(p, work, U + axis)[i]
        pull_shown(p, work)
        pull_nodes_shown(p, work)
        add_gravity(p, work, SHOWN_RATE)
        for axis in range(3):
            for i in range(p.node_slots):
                change = half * node_plane(p, work, FX + axis)[i] * node_plane(p, work, INVERSE_MASS)[i]
                node_plane(p, work, U + axis)[i] -= change
                node_plane(p, work, FX + axis)[i] = 0.0

    @kernel
    def add_gravity(p, work, rate):
        """Add gravity's apparent force [N] at the positions shown and the velocities in the planes from `rate` on.

        Checked  tests/net_capture/test_sleep.py
        """
        at = p.scratch[0:3]
        speed = p.scratch[3:6]
        out = p.scratch[6:9]
        inverse = node_plane(p, work, INVERSE_MASS)
        for i in range(p.node_slots):
            if inverse[i] > 0.0:
                for axis in range(3):
                    at[axis] = node_plane(p, work, SHOWN + axis)[i]
                    speed[axis] = node_plane(p, work, rate + axis)[i]
                accelerate(p, out, at, speed)
                for axis in range(3):
                    node_plane(p, work, FX + axis)[i] += out[axis] / inverse[i]

    @kernel
    def fly_row(p, reals, row, steps):
        """A row's positions so many substeps on, through which nothing pulls it.

        Checked  tests/net_capture/test_sleep.py
        """
        begin_flight(p, p.flight, steps)
        for i in range(row * p.row_pitch, (row + 1) * p.row_pitch, width):
            fly_group(reals, i, p.node_slots, p.flight, X, P, U)

    @kernel
    def bring(p, reals, words, row):
        """A row's positions to the present substep.

        Checked  tests/net_capture/test_sleep.py
        """
        late = p.grid - peek(words, ROW_WORDS * row + STAMP)
        if late != 0:
            fly_row(p, reals, row, late)
            poke(words, ROW_WORDS * row + STAMP, p.grid)

    @kernel
    def sleep(p, reals, a, b, lanes, length):
        """Substeps for which a strip that is slack stays so [1], at least 1.

            |d + w t| = L,   t = (sqrt((d.w)^2 + w^2 (L^2 - d^2)) - d.w) / w^2

        L is shorter by how far a free flight may leave the straight line in the longest sleep.

        Checked  tests/net_capture/test_sleep.py
        """
        slots = p.node_slots
        end = np.int64(highest(np.uint64(lanes))) + 1
        count = splat(np.float64(end))
        zero = splat(0.0)
        tiny = splat(1e-30)
        reach = length
        if bends:
            fastest = zero
            for j in range(0, end, width):
                m = a + j + P * slots
                n = b + j + P * slots
                u = load(reals, n) - load(reals, m)
                v = load(reals, n + slots) - load(reals, m + slots)
                w = load(reals, n + 2 * slots) - load(reals, m + 2 * slots)
                speed = u * u + v * v + w * w
                fastest = where(ramp() + splat(np.float64(j)) < count, where(speed > fastest, speed, fastest), fastest)
            largest = 0.0
            for i in range(width):
                largest = max(largest, lane(fastest, np.int64(i)))
            reach -= stray(p, length, math.sqrt(largest), LONGEST_SLEEP * p.solver_substep)
            if reach <= 0.0:
                return 1
        squared = splat(reach * reach)
        soonest = splat(1e9)
        for j in range(0, end, width):
            m = a + j
            n = b + j
            x = load(reals, n) - load(reals, m)
            y = load(reals, n + slots) - load(reals, m + slots)
            z = load(reals, n + 2 * slots) - load(reals, m + 2 * slots)
            m += P * slots
            n += P * slots
            u = load(reals, n) - load(reals, m)
            v = load(reals, n + slots) - load(reals, m + slots)
            w = load(reals, n + 2 * slots) - load(reals, m + 2 * slots)
            left = squared - (x * x + y * y + z * z)
            along = x * u + y * v + z * w
            speed = u * u + v * v + w * w
            speed = where(speed > tiny, speed, tiny)
            under = along * along + speed * left
            time = (root(where(under > zero, under, zero)) - along) / speed
            time = where(time < soonest, time, soonest)
            soonest = where(ramp() + splat(np.float64(j)) < count, time, soonest)
        least = 1e9
        for i in range(width):
            least = min(least, lane(soonest, np.int64(i)))
        steps = SURE * least / p.solver_substep
        return max(int(min(steps, LONGEST_SLEEP)), 1)

    @kernel
    def mark(p, words, row, node, lanes):
        """Something pulls these lanes of a row, counted from a node: its turn is in this substep.

        Checked  tests/net_capture/test_sleep.py
        """
        r = ROW_WORDS * row
        here = np.int64(lanes << np.uint64(node - row * p.row_pitch))
        poke(words, r + TOUCHED, peek(words, r + TOUCHED) | here)
        poke(words, r + NEXT, p.grid)

    @kernel
    def look_at_strip(p, reals, table, numbers, words, z, strip):
        """Forces of one strip [W taken by its dashpots], and when to look at it again.

        z         where the words of its sleep stand

        Checked  tests/net_capture/test_sleep.py
        """
        s = STRIP_WORDS * strip
        q = STRIP_NUMBERS * strip
        a = peek(table, s + A)
        b = peek(table, s + B)
        in_a = peek(words, z + ROW_A)
        in_b = peek(words, z + ROW_B)
        bring(p, reals, words, in_a)
        bring(p, reals, words, in_b)
        taut = taut_lanes(reals, p.node_slots, X, a, b, peek(table, s + LANES), peek(numbers, q + SQUARED))
        earlier = np.uint64(peek(words, z + TAUT))
        poke(words, z + WAKE, p.grid + 1)
        poke(words, z + TAUT, np.int64(taut))
        if taut != np.uint64(0):
            poke(words, z + QUIET, 0)
            mark(p, words, in_a, a, taut)
            mark(p, words, in_b, b, taut)
            return pull(p, reals, p.node_slots, numbers, q, a, b, peek(table, s + FIRST), taut, earlier)
        quiet = peek(words, z + QUIET) + 1
        poke(words, z + QUIET, quiet)
        if quiet > QUIET_LOOKS:
            steps = sleep(p, reals, a, b, peek(table, s + LANES), peek(numbers, q + LENGTH))
            poke(words, z + WAKE, p.grid + steps)
        return 0.0

    @kernel
    def wake_strips(p, words, rows, row):
        """Look at all strips of a row in the next substep: its nodes fly otherwise than was reckoned.

        Checked  tests/net_capture/test_sleep.py
        """
        following = p.grid + 1
        sleeps = ROW_WORDS * rows
        listed = sleeps + SLEEP_WORDS * p.strips
        for n in range(peek(words, ROW_WORDS * row + STRIPS), peek(words, ROW_WORDS * row + STRIPS_END)):
            z = sleeps + SLEEP_WORDS * peek(words, listed + n)
            poke(words, z + QUIET, 0)
            if peek(words, z + WAKE) > following:
                poke(words, z + WAKE, following)
            owner = ROW_WORDS * min(peek(words, z + ROW_A), peek(words, z + ROW_B)) + NEXT
            if peek(words, owner) > following:
                poke(words, owner, following)

    @kernel
    def drift(p, reals, first, end):
        """Nodes that nothing pulls, a substep on.

        Checked  tests/net_capture/test_sleep.py
        """
        step = splat(p.solver_substep)
        for i in range(first, end, width):
            for axis in range(3):
                at = i + axis * p.node_slots
                store(reals, at, load(reals, at) + step * load(reals, at + U * p.node_slots))

    @kernel
    def kick_row(p, reals, row, lanes, n):
        """Drift the row, and kick the lanes that are pulled, or were a substep ago: their predicted velocities change
        once more. Under gravity that bends all are kicked.

        Checked  tests/net_capture/test_sleep.py
        """
        first = row * p.row_pitch
        if bends:
            for i in range(first, first + p.row_pitch, width):
                kick_group(reals, i, p.node_slots, p.solver_substep, n)
        else:
            drift(p, reals, first, first + p.row_pitch)
            here = lanes & (np.uint64(0xFFFFFFFFFFFFFFFF) >> np.uint64(64 - p.row_pitch))
            while here != np.uint64(0):
                j = lowest(here) // np.uint64(width) * np.uint64(width)
                here &= ~(group << j)
                kick_group(reals, first + np.int64(j), p.node_slots, p.solver_substep, n)

    @kernel
    def step(p, work):
        """Forces, kick, drift and contact of every row that is awake.

        Checked  tests/net_capture/test_sleep.py
        """
        reals = reals_of(work)
        words = own(p, work)
        table = strips(p, work)
        numbers = properties(p, work)
        rows = p.node_slots // p.row_pitch
        listed = ROW_WORDS * rows + SLEEP_WORDS * p.strips
        n = rate_of(p)
        power = 0.0
        pull_nodes(p, work)
        book(p, p.solver_substep)
        hurried = False
        if has_contact:
            hurried = hurries(p)
            begin_step(p, n)
        for row in range(rows):
            r = ROW_WORDS * row
            if hurried:
                words[r + CLEAR] = 0
            elif words[r + NEXT] > p.grid and (not has_contact or words[r + CLEAR] > p.grid):
                continue
            following = p.grid + LONGEST_SLEEP
            for m in range(words[r + STRIPS], words[r + OWN_END]):
                strip = peek(words, listed + m)
                z = ROW_WORDS * rows + SLEEP_WORDS * strip
                if peek(words, z + WAKE) <= p.grid:
                    power += look_at_strip(p, reals, table, numbers, words, z, strip)
                following = min(following, peek(words, z + WAKE))
            touched = words[r + TOUCHED]
            near = False
            if has_contact:
                # of a row that begins to be pulled, or pulled more than any was, nothing is known
                near = words[r + CLEAR] <= p.grid
                near = near or (touched != 0 and (words[r + KICKED] == 0 or p.contact_force > p.contact_reckoned))
            if touched != 0:
                bring(p, reals, words, row)
                kick_row(p, reals, row, np.uint64(touched | words[r + KICKED]), n)
                words[r + KICKED] = touched
                words[r + TOUCHED] = 0
                words[r + STAMP] = p.grid + 1
                wake_strips(p, words, rows, row)
                following = p.grid + 1
            elif words[r + KICKED] != 0:
                bring(p, reals, words, row)
                for j in range(0, p.row_pitch, width):
                    coast_group(reals, row * p.row_pitch + j, p.node_slots, p.solver_substep, n)
                words[r + KICKED] = 0
            if has_contact and near:
                if touched == 0:
                    fly_row(p, reals, row, p.grid + 1 - words[r + STAMP])
                    words[r + STAMP] = p.grid + 1
                clear = 0
                hit = touch_row(p, work, row * p.row_pitch, n)
                if hit > 0:
                    words[r + KICKED] = -1
                    wake_strips(p, words, rows, row)
                    following = p.grid + 1
                elif hit < 0:
                    clear = clear_steps(p, work, row * p.row_pitch, touched != 0)
                words[r + CLEAR] = p.grid + 1 + clear
            words[r + NEXT] = following
        p.thread_loss += p.solver_substep * power

    @kernel
    def place(p, work):
        """Positions and velocities of now into the planes shown, and the velocities of half a substep back.

        Checked  tests/net_capture/test_sleep.py
        """
        reals = reals_of(work)
        words = own(p, work)
        slots = p.node_slots
        for row in range(slots // p.row_pitch):
            late = p.grid - words[ROW_WORDS * row + STAMP]
            first = row * p.row_pitch
            if late != 0:
                begin_flight(p, p.flight, late)
                for i in range(first, first + p.row_pitch, width):
                    fly_group(reals, i, slots, p.flight, SHOWN, SHOWN_RATE, SHOWN_BACK)
            else:
                for i in range(first, first + p.row_pitch, width):
                    for axis in range(3):
                        at = i + axis * slots
                        store(reals, at + SHOWN * slots, load(reals, at))
                        store(reals, at + SHOWN_RATE * slots, load(reals, at + P * slots))
                        store(reals, at + SHOWN_BACK * slots, load(reals, at + U * slots))

    @kernel
    def show(p, work):
        """The same with the velocities of now, and those with which the next substep begins.

        Checked  tests/net_capture/test_sleep.py
        """
        place(p, work)
        pull_shown(p, work)
        pull_nodes_shown(p, work)
        half = 0.5 * p.solver_substep
        inverse = node_plane(p, work, INVERSE_MASS)
        if bends:
            for axis in range(3):
                for i in range(p.node_slots):
                    change = half * node_plane(p, work, FX + axis)[i] * inverse[i]
                    node_plane(p, work, SHOWN_RATE + axis)[i] = node_plane(p, work, SHOWN_BACK + axis)[i] + change
            add_gravity(p, work, SHOWN_RATE)
        for axis in range(3):
            for i in range(p.node_slots):
                change = half * node_plane(p, work, FX + axis)[i] * inverse[i]
                now = node_plane(p, work, SHOWN_BACK + axis)[i] + change
                node_plane(p, work, SHOWN_RATE + axis)[i] = now
                node_plane(p, work, SHOWN_BACK + axis)[i] = now + change
                node_plane(p, work, FX + axis)[i] = 0.0

    return Scheme(LAG, own_words, begin, step, place, threads.stored, show)


def make_rouse(composition: Any) -> Any:
    """Kernel `rouse(p, work, node)`: a node that is to be pulled stands where it is now, and is kicked in this step."""
    memory, lanes, gravity = composition.memory, composition.lanes, composition.gravity
    own, reals_of, width = memory.own, memory.reals, lanes.width
    begin_flight, fly_group = gravity.begin_flight, gravity.fly_group

    @kernel
    def rouse(p, work, node):
        """A node that is to be pulled stands where it is now, and is kicked in this substep.

        Checked  tests/net_capture/test_sleep.py
        """
        words = own(p, work)
        row = node // p.row_pitch
        r = ROW_WORDS * row
        late = p.grid - words[r + STAMP]
        if late != 0:
            begin_flight(p, p.flight, late)
            for i in range(row * p.row_pitch, (row + 1) * p.row_pitch, width):
                fly_group(reals_of(work), i, p.node_slots, p.flight, X, P, U)
            words[r + STAMP] = p.grid
        words[r + TOUCHED] |= np.int64(1) << np.int64(node - row * p.row_pitch)
        words[r + NEXT] = p.grid

    return rouse


PART = Term(
    "leapfrog with predicted velocities: order 2, dashpots included; rows that nothing pulls are left alone",
    make=make,
    checks=Needs(make_rouse, 0),
)
