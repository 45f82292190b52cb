"""Where the net's thread goes straight on: joints of two pieces, over a node within a thread or across a knot."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from fmu_src.net_capture.planes import (
    LANES,
    LENGTH,
    LONGEST_ROW,
    SHOWN,
    STRIP_NUMBERS,
    STRIP_WORDS,
    A,
    B,
)
from orbital.kernel import kernel, view

STRAIGHT = math.cos(math.radians(2.0))
"""Two pieces that turn by less go straight on."""
JOINT_WORDS = 5
"""Three nodes, and the unloaded lengths of both pieces."""
THREAD_WORDS, ENDS = 3, 2
"""Nodes and strip of a thread, and for each of its ends the next at that node: while joints are sought."""


class Joints(NamedTuple):
    """Kernels of the joints of a net.

    words(p)            whole numbers of work memory, before those of the pace
    find(p, work)       list them, of the net laid out, whose places as meant stand in the planes shown; how many
    nodes(p, work)      their nodes in the first three of JOINT_WORDS each
    lengths(p, work)    the same words as numbers: unloaded lengths of both pieces in the last two [m]
    """

    words: Any
    find: Any
    nodes: Any
    lengths: Any


def make_joints(composition: Any) -> Joints:
    """Kernels for the composition's net."""
    memory, masks = composition.memory, composition.traits.masks
    node_plane, strips, properties = memory.node_plane, memory.strips, memory.properties
    from fmu_src.lanes import whole

    @kernel
    def words(p):
        """Whole numbers of work memory [1]: no more joints than pieces of thread.

        Checked  tests/net_capture/test_bending.py
        """
        return (JOINT_WORDS + THREAD_WORDS + ENDS) * p.thread_numbers + p.node_slots

    @kernel
    def joints_at(p):
        """Where the joints begin in the work memory.

        Checked  tests/net_capture/test_bending.py
        """
        return p.work_size - masks * p.strips - words(p)

    @view
    def nodes(p, work):
        """Their nodes, and room for two lengths, JOINT_WORDS each.

        Checked  tests/net_capture/test_bending.py
        """
        return whole(work)[joints_at(p) : joints_at(p) + JOINT_WORDS * p.thread_numbers]

    @view
    def lengths(p, work):
        """The same words as numbers: lengths stand in the last two of each joint [m].

        Checked  tests/net_capture/test_bending.py
        """
        return work[joints_at(p) : joints_at(p) + JOINT_WORDS * p.thread_numbers]

    @view
    def aside(p, work):
        """What is needed while joints are sought.

        Checked  tests/net_capture/test_bending.py
        """
        first = joints_at(p) + JOINT_WORDS * p.thread_numbers
        return whole(work)[first : first + (THREAD_WORDS + ENDS) * p.thread_numbers + p.node_slots]

    @kernel
    def list_ends(p, work):
        """List the net's pieces of thread, and of each node those that end there.

        Checked  tests/net_capture/test_bending.py
        """
        notes, table = aside(p, work), strips(p, work)
        heads = (THREAD_WORDS + ENDS) * p.thread_numbers
        for node in range(p.node_slots):
            notes[heads + node] = -1
        thread = 0
        for strip in range(p.net_strips):
            s = STRIP_WORDS * strip
            for lane in range(LONGEST_ROW):
                if (table[s + LANES] >> lane) & 1:
                    at = (THREAD_WORDS + ENDS) * thread
                    for end in range(ENDS):
                        node = table[s + (A if end == 0 else B)] + lane
                        notes[at + end] = node
                        notes[at + THREAD_WORDS + end] = notes[heads + node]
                        notes[heads + node] = ENDS * thread + end
                    notes[at + ENDS] = strip
                    thread += 1

    @kernel
    def slope(p, work, node, one, other):
        """Cosine of the angle between the ways from a node to two others, in the net as meant.

        Checked  tests/net_capture/test_bending.py
        """
        product = 0.0
        first = 0.0
        second = 0.0
        for axis in range(3):
            plane = node_plane(p, work, SHOWN + axis)
            d = np.float64(plane[one]) - np.float64(plane[node])
            e = np.float64(plane[other]) - np.float64(plane[node])
            product += d * e
            first += d * d
            second += e * e
        return product / math.sqrt(first * second) if first > 0.0 < second else 1.0

    @kernel
    def find(p, work):
        """List all joints; how many there are [1].

        Checked  tests/net_capture/test_bending.py
        """
        list_ends(p, work)
        notes, found, long, numbers = aside(p, work), nodes(p, work), lengths(p, work), properties(p, work)
        heads = (THREAD_WORDS + ENDS) * p.thread_numbers
        count = 0
        for node in range(p.node_slots):
            one = notes[heads + node]
            while one >= 0:
                at = (THREAD_WORDS + ENDS) * (one // ENDS)
                first = notes[at + 1 - one % ENDS]
                other = notes[at + THREAD_WORDS + one % ENDS]
                following = other
                while other >= 0:
                    to = (THREAD_WORDS + ENDS) * (other // ENDS)
                    last = notes[to + 1 - other % ENDS]
                    if slope(p, work, node, first, last) < -STRAIGHT:
                        j = JOINT_WORDS * count
                        found[j] = first
                        found[j + 1] = node
                        found[j + 2] = last
                        long[j + 3] = numbers[STRIP_NUMBERS * notes[at + ENDS] + LENGTH]
                        long[j + 4] = numbers[STRIP_NUMBERS * notes[to + ENDS] + LENGTH]
                        count += 1
                    other = notes[to + THREAD_WORDS + other % ENDS]
                one = following
        return count

    return Joints(words, find, nodes, lengths)
