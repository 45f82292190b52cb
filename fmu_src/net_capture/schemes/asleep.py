"""Rows asleep: what nothing pulls is left alone until it must be looked at.

A node that nothing pulls flies freely, so of a strip that is slack the instant is known before which none
of its threads can be taut. Until then the strip is not looked at, and its rows stay where they are in memory, each with
the substep to which its positions belong (`STAMP`); they are flown there when next needed. A kick wakes the strips of
the row, and so do the cord and a tension at the vertex; a row that may be within reach of the target is flown and
looked at in every substep. What is shown is flown in a copy, so that the bits do not depend on when outputs are read.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from fmu_src.net_capture.planes import STRIP_WORDS, A, B, P, U, X
from fmu_src.net_capture.stepping import LONGEST_SLEEP
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
SURE = 0.999
"""Share of the sleep worked out that is slept: more than all rounding."""


class Asleep(NamedTuple):
    """Kernels of the rows' sleep; `words` are those that `own_words` asks for.

    own_words(p)                       whole numbers that rows, strips and their lists take [1]
    find_neighbours(p, work)           list the strips of every row; all are awake
    fly_row(p, reals, row, first, steps)   a row so many substeps on from the one of that number, through which nothing
                                       pulls it
    bring(p, reals, words, row)        a row to the present substep
    sleep(p, reals, a, b, lanes, length)   substeps for which a slack strip stays so [1]
    mark(p, words, row, node, lanes)   something pulls these lanes of a row: its turn is in this substep
    wake_strips(p, words, rows, row)   look at all strips of a row in the next substep
    """

    own_words: Any
    find_neighbours: Any
    fly_row: Any
    bring: Any
    sleep: Any
    mark: Any
    wake_strips: Any


def make_asleep(composition: Any) -> Asleep:
    """Kernels for the composition's memory, gravity and precision."""
    memory, lanes, gravity = composition.memory, composition.lanes, composition.gravity
    load, splat, where, root, lane = lanes.load, lanes.splat, lanes.where, lanes.root, lanes.lane
    strips, own, width, ramp = memory.strips, memory.own, lanes.width, lanes.ramp
    begin_flight, fly_group, bends, stray_apart = (
        gravity.begin_flight,
        gravity.fly_group,
        gravity.bends,
        gravity.stray_apart,
    )
    from fmu_src.lanes import highest, peek, poke

    @kernel
    def own_words(p):
        """Whole numbers that rows, strips and their lists take [1].

        Checked  tests/net_capture/test_sleep.py
        """
        listed = 2 * p.strips  # a strip at most twice, for its two rows
        return ROW_WORDS * (p.node_slots // p.row_pitch) + SLEEP_WORDS * p.strips + listed

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
    def fly_row(p, reals, row, first, steps):
        """A row's positions so many substeps on from the one of that number, through which nothing pulls it.

        Checked  tests/net_capture/test_sleep.py
        """
        begin_flight(p, p.flight, first, steps)
        for i in range(row * p.row_pitch, (row + 1) * p.row_pitch, width):
            fly_group(reals, i, p.node_slots, p.flight, X, P, U)

    @kernel
    def bring(p, reals, words, row):
        """A row's positions to the present substep.

        Checked  tests/net_capture/test_sleep.py
        """
        stamp = peek(words, ROW_WORDS * row + STAMP)
        if stamp != p.grid:
            fly_row(p, reals, row, stamp, p.grid - stamp)
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
            reach -= stray_apart(p, length, math.sqrt(largest), LONGEST_SLEEP * p.solver_substep)
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

    return Asleep(own_words, find_neighbours, fly_row, bring, sleep, mark, wake_strips)


def make_rouse(composition: Any) -> Any:
    """Kernel `rouse(p, work, node)`, see `schemes.Needs`."""
    asleep, own, reals_of = make_asleep(composition), composition.memory.own, composition.memory.reals
    bring, mark = asleep.bring, asleep.mark

    @kernel
    def rouse(p, work, node):
        """A node that is to be pulled stands where it is now, and is kicked in this substep.

        Checked  tests/net_capture/test_sleep.py
        """
        row = node // p.row_pitch
        bring(p, reals_of(work), own(p, work), row)
        mark(p, own(p, work), row, node, np.uint64(1))

    return rouse


def make_rouse_all(composition: Any) -> Any:
    """Kernel `rouse_all(p, work)`, see `schemes.Needs`."""
    asleep, own, reals_of = make_asleep(composition), composition.memory.own, composition.memory.reals
    bring, mark = asleep.bring, asleep.mark

    @kernel
    def rouse_all(p, work):
        """All rows stand where they are now, and are kicked in this substep.

        Checked  tests/net_capture/test_air.py
        """
        pitch = p.row_pitch
        whole = np.uint64(0xFFFFFFFFFFFFFFFF) >> np.uint64(64 - pitch)
        for row in range(p.node_slots // pitch):
            bring(p, reals_of(work), own(p, work), row)
            mark(p, own(p, work), row, row * pitch, whole)

    return rouse_all
