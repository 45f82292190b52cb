"""Work memory of threads that touch each other: what is kept of each thread, and of each pair of them."""

from __future__ import annotations

from typing import Any, NamedTuple

from orbital.kernel import kernel, view

ROOM, LEAST_ROOM = 20, 20000
"""Pairs for which there is room: so many for each thread, and so many more; all of a small net."""


class Room(NamedTuple):
    """Kernels that find it; views are slices, to be used where they were called.

    words(p)           whole numbers of work memory [1]
    pairs(p)           pairs for which there is room [1]
    ends(p, work)      view: nodes of each thread, first and other
    order(p, work)     view: threads in the order of their boxes along an axis
    heads(p, work)     view: the first pair of each thread among those of which the state is kept, -1 for none
    radii(p, work)     view: radius and reach of each thread [m]
    boxes(p, work)     view: least and largest coordinates of where each thread may come [m], six each
    nodes(p, work)     view: both threads of each pair on the list, packed
    dues(p, work)      view: way from which on it is to be looked at [1]
    states(p, work)    view: its state
    following(p, work)   view: the next pair in the same bucket, -1 for none
    kept(p, work)      view: pairs of the last list that had a state: the pair, that state, and the next of the same
                       first thread
    """

    words: Any
    pairs: Any
    ends: Any
    order: Any
    heads: Any
    radii: Any
    boxes: Any
    nodes: Any
    dues: Any
    states: Any
    following: Any
    kept: Any


def make_room(composition: Any) -> Room:
    """Kernels for the composition's memory: behind the scheme's own, before that of bending and of the pace."""
    from fmu_src.lanes import whole

    masks, bending = composition.traits.masks, composition.bending
    has_bending = bending is not None
    bending_words = bending.words if has_bending else None

    @kernel
    def pairs(p):
        """Pairs for which there is room [1].

        Checked  tests/net_capture/test_near_pairs.py
        """
        count = p.thread_numbers
        return min(ROOM * count + LEAST_ROOM, count * (count - 1) // 2)

    @kernel
    def words(p):
        """Whole numbers of work memory [1]: twelve for each thread, seven for each pair.

        Checked  tests/net_capture/test_near_pairs.py
        """
        return 12 * p.thread_numbers + 7 * pairs(p)

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
        """Nodes of each thread, first and other.

        Checked  tests/net_capture/test_near_pairs.py
        """
        return whole(work)[begin(p) : begin(p) + 2 * p.thread_numbers]

    @view
    def order(p, work):
        """Threads in the order of their boxes along an axis.

        Checked  tests/net_capture/test_near_pairs.py
        """
        return whole(work)[begin(p) + 2 * p.thread_numbers : begin(p) + 3 * p.thread_numbers]

    @view
    def heads(p, work):
        """The first pair of each thread among those of which the state is kept, -1 for none.

        Checked  tests/net_capture/test_near_pairs.py
        """
        return whole(work)[begin(p) + 3 * p.thread_numbers : begin(p) + 4 * p.thread_numbers]

    @view
    def radii(p, work):
        """Radius and reach of each thread [m].

        Checked  tests/net_capture/test_near_pairs.py
        """
        return work[begin(p) + 4 * p.thread_numbers : begin(p) + 6 * p.thread_numbers]

    @view
    def boxes(p, work):
        """Least and largest coordinates of where each thread may come [m], six each.

        Checked  tests/net_capture/test_near_pairs.py
        """
        return work[begin(p) + 6 * p.thread_numbers : begin(p) + 12 * p.thread_numbers]

    @view
    def nodes(p, work):
        """Both threads of each pair, packed.

        Checked  tests/net_capture/test_near_pairs.py
        """
        return whole(work)[begin(p) + 12 * p.thread_numbers : begin(p) + 12 * p.thread_numbers + pairs(p)]

    @view
    def dues(p, work):
        """Way from which on each pair is to be looked at.

        Checked  tests/net_capture/test_near_pairs.py
        """
        first = begin(p) + 12 * p.thread_numbers + pairs(p)
        return work[first : first + pairs(p)]

    @view
    def states(p, work):
        """State of each pair.

        Checked  tests/net_capture/test_near_pairs.py
        """
        first = begin(p) + 12 * p.thread_numbers + 2 * pairs(p)
        return whole(work)[first : first + pairs(p)]

    @view
    def kept(p, work):
        """Pairs of the last list that had a state: the pair, its state, and the next of the same first thread.

        Checked  tests/net_capture/test_near_pairs.py
        """
        first = begin(p) + 12 * p.thread_numbers + 3 * pairs(p)
        return whole(work)[first : first + 3 * pairs(p)]

    @view
    def following(p, work):
        """The next pair in the same bucket.

        Checked  tests/net_capture/test_near_pairs.py
        """
        first = begin(p) + 12 * p.thread_numbers + 6 * pairs(p)
        return whole(work)[first : first + pairs(p)]

    return Room(words, pairs, ends, order, heads, radii, boxes, nodes, dues, states, following, kept)
