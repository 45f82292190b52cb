"""Which pairs of threads may come to touch: a list, and for each pair how far its nodes may go before it is looked at.

Every node has a reach when the list is made. From then on the way w goes on in each substep by the largest of

    h |u - u0| / reach   over all nodes,   u0 the mean velocity when the list was made

so no node is ever further than w times its reach from where it was, relative to the others' common flight. The list has
all pairs that are nearer than their radii and twice their reach, and it is made anew once w is 1. A pair that was found
a gap g apart need not be looked at before w has grown by g over the reach of both its threads. Nothing is assumed of
accelerations: this holds whatever pulls.

A long list costs more in every substep, a short one is soon used up: how many substeps it is to last follows from what
making and looking through the last one took.

Pairs that overlapped when they came in, at the start, keep that mark from list to list until they have parted.

Source   Verlet's list of neighbours (Phys. Rev. 159, 1967), with sorting along one axis (Baraff 1992)
Checked  tests/net_capture/test_near_pairs.py
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from fmu_src.net_capture.formulas import round_diameter, thread_area
from fmu_src.net_capture.planes import (
    INVERSE_MASS,
    LANES,
    LENGTH,
    LONGEST_ROW,
    STRIP_NUMBERS,
    STRIP_WORDS,
    THREAD_MASS,
    A,
    B,
    U,
    X,
)
from fmu_src.net_capture.self_contact.segments import closest
from orbital.kernel import kernel, view

ROOM, LEAST_ROOM = 16, 1024
"""Pairs for which there is room: so many for each thread, and so many more."""
KICK, NEW, RATE, PER_REACH, SPEED, PLANES = 0, 3, 6, 7, 8, 9
"""Node planes: change of velocity by contact in the last substep, and so far in this one [m/s], three each; stiffness
over mass of what touches [1/s2]; one over the reach [1/m]; square of the speed in the last substep [m2/s2]."""
CLEAR, TOUCHES, LEFT_OUT = range(3)
"""States of a pair: apart; in contact a substep ago; overlapping since the start, and left alone."""
FIRST_LIFE, LONGEST_LIFE = 32.0, 2000.0
"""Substeps for which a list is meant to last."""
FLOOR_STEPS = 4.0
"""Substeps of the fastest node, that any node may go at least."""
FLOOR_RADII = 1.0
"""Radii that any node may go at least."""
JUST_NOW = 1.2 / FLOOR_STEPS
"""Of its reach, that a node moved at most in the substep before a list is made: a pair that went through in it is
looked at."""
DEARER = 4.0
"""What looking at a pair costs over comparing two boxes."""


class Pairs(NamedTuple):
    """Kernels of the list.

    words(p)               whole numbers of work memory
    start(p, work)         radii of all threads, and the first list, whose overlapping pairs are left out
    go_on(p, work)         the way w on by a substep, and a new list where that is used up
    stride(p, work)        by how much w would go on now [1]
    nodes, states, dues    views of the list: threads of each pair (packed), their states, from which w on they are due
    ends(p, work)          view: nodes of each thread, first and other
    radii(p, work)         view: radius [m] and reach [m] of each thread, one after another
    """

    words: Any
    start: Any
    go_on: Any
    stride: Any
    nodes: Any
    states: Any
    dues: Any
    ends: Any
    radii: Any


def make_pairs(composition: Any, first_plane: int) -> Pairs:
    """Kernels for the composition's net and what is rigged to it; node planes of the part from `first_plane` on."""
    # after the scheme's own parts are known, see `schemes.asleep`
    from fmu_src.lanes import whole
    from fmu_src.net_capture.schemes.asleep import make_asleep

    memory, lanes, masks = composition.memory, composition.lanes, composition.traits.masks
    node_plane, strips, properties, own = memory.node_plane, memory.strips, memory.properties, memory.own
    reals_of, bring = memory.reals, make_asleep(composition).bring
    load, store, splat, where, width, lane = (
        lanes.load, lanes.store, lanes.splat, lanes.where, lanes.width, lanes.lane,
    )  # fmt: skip
    density_of = composition.density_of
    has_bending = composition.bending is not None
    bending_words = composition.bending.words if has_bending else None
    per_reach_plane, speed_plane = first_plane + PER_REACH, first_plane + SPEED

    @kernel
    def room(p):
        """Pairs for which there is room [1].

        Checked  tests/net_capture/test_near_pairs.py
        """
        return ROOM * p.thread_numbers + LEAST_ROOM

    @kernel
    def words(p):
        """Whole numbers of work memory [1]: twelve for each thread, six for each pair.

        Checked  tests/net_capture/test_near_pairs.py
        """
        return 12 * p.thread_numbers + 6 * room(p)

    @kernel
    def begin(p):
        """Where they begin.

        Checked  tests/net_capture/test_near_pairs.py
        """
        at = p.work_size - masks * p.strips - words(p)
        if has_bending:
            at -= bending_words(p)
        return at

    @view
    def ends(p, work):
        """Nodes of each thread, first and other."""
        return whole(work)[begin(p) : begin(p) + 2 * p.thread_numbers]

    @view
    def order(p, work):
        """Threads in the order of their boxes along an axis."""
        return whole(work)[begin(p) + 2 * p.thread_numbers : begin(p) + 3 * p.thread_numbers]

    @view
    def heads(p, work):
        """The first pair of each thread among those of which the state is kept, -1 for none."""
        return whole(work)[begin(p) + 3 * p.thread_numbers : begin(p) + 4 * p.thread_numbers]

    @view
    def radii(p, work):
        """Radius and reach of each thread [m]."""
        return work[begin(p) + 4 * p.thread_numbers : begin(p) + 6 * p.thread_numbers]

    @view
    def boxes(p, work):
        """Least and largest coordinates of where each thread may come [m], six each."""
        return work[begin(p) + 6 * p.thread_numbers : begin(p) + 12 * p.thread_numbers]

    @view
    def nodes(p, work):
        """Both threads of each pair, packed."""
        return whole(work)[begin(p) + 12 * p.thread_numbers : begin(p) + 12 * p.thread_numbers + room(p)]

    @view
    def dues(p, work):
        """Way from which on each pair is to be looked at."""
        first = begin(p) + 12 * p.thread_numbers + room(p)
        return work[first : first + room(p)]

    @view
    def states(p, work):
        """State of each pair."""
        first = begin(p) + 12 * p.thread_numbers + 2 * room(p)
        return whole(work)[first : first + room(p)]

    @view
    def kept(p, work):
        """Pairs of the last list that had a state: the pair, its state, and the next of the same first thread."""
        first = begin(p) + 12 * p.thread_numbers + 3 * room(p)
        return whole(work)[first : first + 3 * room(p)]

    @kernel
    def start(p, work):
        """Radii of all threads, and the first list.

        Checked  tests/net_capture/test_near_pairs.py
        """
        table, numbers = strips(p, work), properties(p, work)
        at, size = ends(p, work), radii(p, work)
        count = 0
        for strip in range(p.strips):
            s = STRIP_WORDS * strip
            q = STRIP_NUMBERS * strip
            radius = 0.5 * p.self_contact_thickness
            if radius == 0.0:
                radius = 0.5 * round_diameter(thread_area(numbers[q + THREAD_MASS], density_of(p, strip), numbers[q + LENGTH]))
            for j in range(LONGEST_ROW):
                if (table[s + LANES] >> j) & 1:
                    at[2 * count] = table[s + A] + j
                    at[2 * count + 1] = table[s + B] + j
                    size[2 * count] = radius
                    order(p, work)[count] = count
                    count += 1
        p.self_contact_count = count
        p.self_contact_life = FIRST_LIFE
        p.self_contact_listed = 0
        p.self_contact_looked = 0
        p.self_contact_full = 0
        build(p, work, True)

    @kernel
    def mean_velocity(p, work):
        """Mean velocity of all nodes into `self_contact_drift` [m/s].

        Checked  tests/net_capture/test_near_pairs.py
        """
        inverse = node_plane(p, work, INVERSE_MASS)
        for axis in range(3):
            total = 0.0
            found = 0
            plane = node_plane(p, work, U + axis)
            for node in range(p.node_slots):
                if inverse[node] > 0.0:
                    total += plane[node]
                    found += 1
            p.self_contact_drift[axis] = total / found

    @kernel
    def speeds(p, work):
        """Squares of the nodes' speeds against that [m2/s2] into their plane; the largest.

        Checked  tests/net_capture/test_near_pairs.py
        """
        speed, inverse = node_plane(p, work, speed_plane), node_plane(p, work, INVERSE_MASS)
        fastest = 0.0
        for node in range(p.node_slots):
            squared = 0.0
            if inverse[node] > 0.0:
                for axis in range(3):
                    going = node_plane(p, work, U + axis)[node] - p.self_contact_drift[axis]
                    squared += going * going
            speed[node] = squared
            fastest = max(fastest, squared)
        return fastest

    @kernel
    def spread(p, work):
        """Reach of every node and thread, and the boxes in which these may come.

        Checked  tests/net_capture/test_near_pairs.py
        """
        mean_velocity(p, work)
        fastest = math.sqrt(speeds(p, work))
        h = p.solver_substep
        size, at, box = radii(p, work), ends(p, work), boxes(p, work)
        speed, per_reach = node_plane(p, work, speed_plane), node_plane(p, work, per_reach_plane)
        inverse = node_plane(p, work, INVERSE_MASS)
        thickest = 0.0
        for i in range(p.self_contact_count):
            thickest = max(thickest, size[2 * i])
        floor = max(FLOOR_RADII * thickest, FLOOR_STEPS * h * fastest)
        for node in range(p.node_slots):
            reach = floor + p.self_contact_life * h * math.sqrt(speed[node])
            per_reach[node] = 1.0 / reach if inverse[node] > 0.0 else 0.0
        for i in range(p.self_contact_count):
            one, other = at[2 * i], at[2 * i + 1]
            reach = 1.0 / min(per_reach[one], per_reach[other])
            size[2 * i + 1] = reach
            for axis in range(3):
                plane = node_plane(p, work, X + axis)
                box[6 * i + axis] = min(plane[one], plane[other]) - size[2 * i] - 2.0 * reach
                box[6 * i + 3 + axis] = max(plane[one], plane[other]) + size[2 * i] + 2.0 * reach

    @kernel
    def along(p, work):
        """The axis along which boxes overlap least, for what they span together.

        Checked  tests/net_capture/test_near_pairs.py
        """
        box = boxes(p, work)
        best = 0
        least = math.inf
        for axis in range(3):
            low = math.inf
            high = -math.inf
            covered = 0.0
            for i in range(p.self_contact_count):
                low = min(low, box[6 * i + axis])
                high = max(high, box[6 * i + 3 + axis])
                covered += box[6 * i + 3 + axis] - box[6 * i + axis]
            if covered < least * (high - low):
                least = covered / (high - low)
                best = axis
        return best

    @kernel
    def sort(p, work, axis):
        """Threads in the order of where their boxes begin: Shell's sort, quick on what is nearly in order.

        Checked  tests/net_capture/test_near_pairs.py
        """
        row, box = order(p, work), boxes(p, work)
        gap = 1
        while gap < p.self_contact_count // 3:
            gap = 3 * gap + 1
        while gap > 0:
            for k in range(gap, p.self_contact_count):
                thread = row[k]
                value = box[6 * thread + axis]
                m = k
                while m >= gap and box[6 * row[m - gap] + axis] > value:
                    row[m] = row[m - gap]
                    m -= gap
                row[m] = thread
            gap //= 3

    @kernel
    def keep(p, work):
        """Put aside the pairs of the last list that have a state.

        Checked  tests/net_capture/test_near_pairs.py
        """
        head, pair, state, aside = heads(p, work), nodes(p, work), states(p, work), kept(p, work)
        for i in range(p.self_contact_count):
            head[i] = -1
        found = 0
        for n in range(p.self_contact_listed):
            if state[n] != CLEAR:
                thread = pair[n] >> 32
                aside[3 * found] = pair[n]
                aside[3 * found + 1] = state[n]
                aside[3 * found + 2] = head[thread]
                head[thread] = found
                found += 1

    @kernel
    def recall(p, work, pair):
        """State that a pair had in the last list.

        Checked  tests/net_capture/test_near_pairs.py
        """
        aside = kept(p, work)
        n = heads(p, work)[pair >> 32]
        while n >= 0:
            if aside[3 * n] == pair:
                return aside[3 * n + 1]
            n = aside[3 * n + 2]
        return CLEAR

    @kernel
    def apart(p, work, one, other):
        """Distance of two threads [m]; less than 0 if they share a node.

        Checked  tests/net_capture/test_near_pairs.py
        """
        at = ends(p, work)
        a, b, c, d = at[2 * one], at[2 * one + 1], at[2 * other], at[2 * other + 1]
        if a == c or a == d or b == c or b == d:
            return -1.0
        x, y, z = node_plane(p, work, X), node_plane(p, work, X + 1), node_plane(p, work, X + 2)
        _, _, squared = closest(
            x[b] - x[a], y[b] - y[a], z[b] - z[a], x[d] - x[c], y[d] - y[c], z[d] - z[c], x[a] - x[c], y[a] - y[c], z[a] - z[c],
        )  # fmt: skip
        return math.sqrt(squared)

    @kernel
    def enter(p, work, one, other, first):
        """Put a pair on the list if it may come to touch; False if there is no room.

        Checked  tests/net_capture/test_near_pairs.py
        """
        gap = apart(p, work, one, other)
        if gap < 0.0:
            return True
        size = radii(p, work)
        reach = size[2 * one + 1] + size[2 * other + 1]
        gap -= size[2 * one] + size[2 * other]
        if gap >= 2.0 * reach:
            return True
        n = p.self_contact_listed
        if n == room(p):
            return False
        pair = (min(one, other) << 32) | max(one, other)
        nodes(p, work)[n] = pair
        dues(p, work)[n] = gap / reach - JUST_NOW
        state = CLEAR
        if gap < 0.0:
            state = LEFT_OUT if first else recall(p, work, pair)
        states(p, work)[n] = state
        p.self_contact_listed = n + 1
        return True

    @kernel
    def sweep(p, work, axis, first):
        """List all pairs that may come to touch; False if there is no room for them.

        Checked  tests/net_capture/test_near_pairs.py
        """
        row, box = order(p, work), boxes(p, work)
        second, third = (axis + 1) % 3, (axis + 2) % 3
        p.self_contact_listed = 0
        p.self_contact_swept = 0
        for m in range(p.self_contact_count):
            one = 6 * row[m]
            end = box[one + 3 + axis]
            for k in range(m + 1, p.self_contact_count):
                other = 6 * row[k]
                if box[other + axis] > end:
                    break
                p.self_contact_swept += 1
                if box[other + second] > box[one + 3 + second] or box[one + second] > box[other + 3 + second]:
                    continue
                if box[other + third] > box[one + 3 + third] or box[one + third] > box[other + 3 + third]:
                    continue
                if not enter(p, work, row[m], row[k], first):
                    return False
        return True

    @kernel
    def build(p, work, first):
        """Make the list; where there is no room for it, one that lasts half as long.

        first     whether all that overlaps is to be left out

        Checked  tests/net_capture/test_near_pairs.py
        """
        for row in range(p.node_slots // p.row_pitch):
            bring(p, reals_of(work), own(p, work), row)
        keep(p, work)
        p.self_contact_way = 0.0
        while True:
            spread(p, work)
            axis = along(p, work)
            sort(p, work, axis)
            if sweep(p, work, axis, first):
                break
            if p.self_contact_life < 1.0:
                p.self_contact_full = 1
                break
            p.self_contact_life *= 0.5
        p.self_contact_looked = 0

    @kernel
    def stride(p, work, store_them):
        """By how much the way goes on with the last substep [1]: largest of all speeds, before or after, over reach.

        store_them    whether speeds are kept for the next time

        Checked  tests/net_capture/test_near_pairs.py
        """
        reals, slots = reals_of(work), p.node_slots
        a, b, c = splat(p.self_contact_drift[0]), splat(p.self_contact_drift[1]), splat(p.self_contact_drift[2])
        most = splat(0.0)
        for i in range(0, slots, width):
            x, y, z = load(reals, i + U * slots) - a, load(reals, i + (U + 1) * slots) - b, load(reals, i + (U + 2) * slots) - c
            speed = x * x + y * y + z * z
            before = load(reals, i + speed_plane * slots)
            larger = where(before < speed, speed, before)
            per_reach = load(reals, i + per_reach_plane * slots)
            ratio = larger * per_reach * per_reach
            most = where(most < ratio, ratio, most)
            if store_them:
                store(reals, i + speed_plane * slots, speed)
        largest = 0.0
        for i in range(width):
            largest = max(largest, lane(most, np.int64(i)))
        return p.solver_substep * math.sqrt(largest)

    @kernel
    def go_on(p, work):
        """The way on by a substep, and a new list where that is used up.

        Checked  tests/net_capture/test_near_pairs.py
        """
        p.self_contact_stride = stride(p, work, True)
        p.self_contact_way += p.self_contact_stride
        if p.self_contact_way >= 1.0:
            if DEARER * p.self_contact_looked < p.self_contact_swept:
                p.self_contact_life = min(1.25 * p.self_contact_life, LONGEST_LIFE)
            else:
                p.self_contact_life = max(0.8 * p.self_contact_life, 1.0)
            build(p, work, False)
            p.self_contact_stride = stride(p, work, False)
            p.self_contact_lists += 1

    return Pairs(words, start, go_on, stride, nodes, states, dues, ends, radii)
