"""Which pairs of threads may come to touch: a list, and for each pair how far its nodes may go before it is looked at.

Every node has a reach when the list is made. From then on the way w goes on in each substep by the largest of

    h |u - u0| / reach   over all nodes,   u0 the mean velocity when the list was made

so no node is ever further than w times its reach from where it was, relative to the others' common flight. The list has
all pairs that are nearer than their radii and their reach, and it is made anew once w is 1. A pair that was found
a gap g apart need not be looked at before w has grown by g over the reach of both its threads. Nothing is assumed of
accelerations: this holds whatever pulls.

Pairs stand in buckets by when they are due, so a substep costs what those take that may touch in it. A list for longer
holds more pairs to be looked at, and one for less is sooner made anew: how many substeps it is to last follows from
what both took the last time.

Pairs that overlapped when they came in, at the start, keep that mark from list to list until they have parted.

Source   Verlet's list of neighbours (Phys. Rev. 159, 1967), with sorting along one axis (Baraff 1992)
Checked  tests/net_capture/test_near_pairs.py
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from fmu_src.net_capture.formulas import round_diameter, thread_area
from fmu_src.net_capture.planes import LANES, LENGTH, LONGEST_ROW, STRIP_NUMBERS, STRIP_WORDS, THREAD_MASS, A, B, X
from fmu_src.net_capture.self_contact.reaches import FLOOR_STEPS, make_reaches
from fmu_src.net_capture.self_contact.room import Room, make_room
from fmu_src.net_capture.self_contact.segments import closest
from orbital.kernel import kernel

CLEAR, TOUCHES, LEFT_OUT = range(3)
"""States of a pair: apart; in contact a substep ago; overlapping since the start, and left alone."""
FIRST_LIFE, LONGEST_LIFE = 32.0, 2000.0
"""Substeps for which a list is meant to last."""
JUST_NOW = 1.2 / FLOOR_STEPS
"""Of its reach, that a node moved at most in the substep before a list is made: a pair that went through in it is
looked at."""
BUCKETS = 64
"""Into which the way that a list lasts is divided."""
DEARER = 4.0
"""What looking at a pair costs over comparing two boxes."""


class Pairs(NamedTuple):
    """Kernels of the list.

    room                   its memory
    start(p, work)         radii of all threads, and the first list, whose overlapping pairs are left out
    go_on(p, work)         the way w on by the last substep, and a new list where that is used up
    bucket(way)            in which a pair stands that is due then
    """

    room: Room
    start: Any
    go_on: Any
    bucket: Any


def make_pairs(composition: Any) -> Pairs:
    """Kernels for the composition's net and what is rigged to it."""
    # after the scheme's own parts are known, see `schemes.asleep`
    from fmu_src.net_capture.schemes.asleep import make_asleep

    memory, density_of = composition.memory, composition.density_of
    node_plane, strips, properties, own = memory.node_plane, memory.strips, memory.properties, memory.own
    reals_of, bring = memory.reals, make_asleep(composition).bring
    room = make_room(composition)
    places, ends, order, heads, radii, boxes = room.pairs, room.ends, room.order, room.heads, room.radii, room.boxes
    nodes, dues, states, kept, following = room.nodes, room.dues, room.states, room.kept, room.following
    spread, along, sort, stride = make_reaches(composition, room)

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
                area = thread_area(numbers[q + THREAD_MASS], density_of(p, strip), numbers[q + LENGTH])
                radius = 0.5 * round_diameter(area)
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
        p.self_contact_gone = p.grid
        build(p, work, True)

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
        if a in (c, d) or b in (c, d):
            return -1.0
        x, y, z = node_plane(p, work, X), node_plane(p, work, X + 1), node_plane(p, work, X + 2)
        _, _, squared = closest(
            x[b] - x[a], y[b] - y[a], z[b] - z[a],
            x[d] - x[c], y[d] - y[c], z[d] - z[c],
            x[a] - x[c], y[a] - y[c], z[a] - z[c],
        )  # fmt: skip
        return math.sqrt(squared)

    @kernel
    def bucket(way):
        """In which a pair stands that is due then, see `BUCKETS`; in the last one if that is later.

        Checked  tests/net_capture/test_near_pairs.py
        """
        return int(min(max(way * BUCKETS, 0.0), BUCKETS - 1.0))

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
        if gap >= reach:
            return True
        n = p.self_contact_listed
        if n == places(p):
            return False
        pair = (min(one, other) << 32) | max(one, other)
        nodes(p, work)[n] = pair
        due = gap / reach - JUST_NOW
        dues(p, work)[n] = due
        following(p, work)[n] = p.self_contact_bucket[bucket(due)]
        p.self_contact_bucket[bucket(due)] = n
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
        p.self_contact_reached = 0
        for n in range(BUCKETS):
            p.self_contact_bucket[n] = -1
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
    def go_on(p, work):
        """The way on by the last substep, unless it has been, and a new list where that is used up: whoever asks first,
        for what is shown or for the next substep, finds the nodes at the same places.

        Checked  tests/net_capture/test_near_pairs.py
        """
        if p.self_contact_gone == p.grid:
            return
        p.self_contact_gone = p.grid
        p.self_contact_stride = stride(p, work, True)
        p.self_contact_way += p.self_contact_stride
        if p.self_contact_way >= 1.0:
            if DEARER * p.self_contact_looked > p.self_contact_swept + DEARER * p.self_contact_listed:
                p.self_contact_life = max(0.8 * p.self_contact_life, 1.0)
            elif 2 * p.self_contact_listed < places(p):
                p.self_contact_life = min(1.25 * p.self_contact_life, LONGEST_LIFE)
            build(p, work, False)
            p.self_contact_stride = stride(p, work, False)
            p.self_contact_lists += 1

    return Pairs(room, start, go_on, bucket)
