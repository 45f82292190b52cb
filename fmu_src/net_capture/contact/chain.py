"""Faces over which a way goes, as its ends come to see others.

From each end the way is straight to the last of its faces that the end can see; an end that no longer sees the first of
them has come round an edge to another, which is put before.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from fmu_src.net_capture.contact.section import MOST
from fmu_src.net_capture.contact.shortest import TAU
from orbital.kernel import kernel
from orbital.vectors import dot

ABOVE = 1e-9
"""Metres above a face from where it is seen."""
IN_PLANE = 1e-6
"""Metres below a face from where it is taken for seen, among several bodies."""

MORE = 6
"""Edges that may come to a way round one of several bodies in one search."""
MANY = 4
"""Edges from which on a way may go round more than half of a body."""
KEPT, LOST, WOUND = range(3)
"""Of a way that was known: it went on, could not go on, or goes on over more edges than are kept."""


class Chain(NamedTuple):
    """Kernels that work on `wrap_chain`, the faces of a way over so many edges; all but `sees` return how many edges
    there are then.

    sees(p, face, end)     whether an end of the thread is above a face
    trim(p, edges)         leave out what both ends see past, of all faces
    lift(p, edges)         leave out faces from which the way has lifted off, one after another
    lengthen(p, edges)     put faces where an end does not see the outermost one
    uncover(p, edges)      leave out faces that lie in another body
    bare(p, edges)         leave out outermost faces behind edges that lie in other bodies
    """

    sees: Any
    trim: Any
    lift: Any
    lengthen: Any
    uncover: Any
    bare: Any


def make_chain(lay: Any, several: bool, elsewhere: Any) -> Chain:
    """Kernels; `lay(p, j, one, other)` of `edges` puts an edge between two faces; `elsewhere` is that of `hidden`.

    several    whether an end may be a bend round another body, in the plane of a face
    """
    least = -IN_PLANE if several else ABOVE

    @kernel
    def sees(p, face, end):
        """Whether an end of the thread is above a face.

        Checked  tests/net_capture/test_wrapping.py
        """
        plane = p.wrap_planes[face]
        return dot(plane[0:3], end) - plane[3] + p.wrap_inset > least

    @kernel
    def lift(p, edges):
        """Leave out the first face while one end sees the next, and the last while the other sees that before: the way
        lifts off the edge between. However far it goes round the body, no farther faces are asked. Works on
        `wrap_chain`; how many edges are left, 0: one face alone.

        Checked  tests/net_capture/test_hooked_threads.py
        """
        first = 0
        while first < edges and sees(p, p.wrap_chain[first + 1], p.wrap_a):
            first += 1
        last = edges
        while last > first and sees(p, p.wrap_chain[last - 1], p.wrap_b):
            last -= 1
        for j in range(first, last + 1):
            p.wrap_chain[j - first] = p.wrap_chain[j]
        return last - first

    @kernel
    def trim(p, edges):
        """Leave out faces before the last one that one end sees, and after the first that the other sees: up to there
        the way is straight. Of a way that may go round more than half the body these would be farther turns, and faces
        are left out one after another. Works on `wrap_chain`; how many edges are left, 0: one face alone.

        Checked  tests/net_capture/test_wrapping.py, test_hooked_threads.py
        """
        if edges >= MANY:
            return lift(p, edges)
        first = 0
        for j in range(edges, 0, -1):
            if sees(p, p.wrap_chain[j], p.wrap_a):
                first = j
                break
        last = edges
        for j in range(first, edges):
            if sees(p, p.wrap_chain[j], p.wrap_b):
                last = j
                break
        for j in range(first, last + 1):
            p.wrap_chain[j - first] = p.wrap_chain[j]
        return last - first

    @kernel
    def come_in(p, end, point):
        """Face through which the straight line from an end of the thread to a point comes in, -1: none.

        Checked  tests/net_capture/test_wrapping.py
        """
        found = -1
        latest = -1.0
        for k in range(p.wrap_faces):
            plane = p.wrap_planes[k]
            above = dot(plane[0:3], end) - plane[3] + p.wrap_inset
            there = dot(plane[0:3], point) - plane[3] + p.wrap_inset
            if above > ABOVE and there < above and above / (above - there) > latest:
                latest = above / (above - there)
                found = k
        return found

    @kernel
    def covers(p, face, end, point):
        """Whether a face lies in another body, or does where the straight line from an end of the thread to a point
        comes in through it, so that no way comes over it there: the other is in the way then.

        Checked  tests/net_capture/test_union_wrapping.py, test_shell_wrapping.py
        """
        covered = False
        if several:
            covered = p.wrap_covered[face] > 0
            if not covered:
                plane, place = p.wrap_planes[face], p.wrap_moving
                above = dot(plane[0:3], end) - plane[3] + p.wrap_inset
                there = dot(plane[0:3], point) - plane[3] + p.wrap_inset
                for i in range(3):
                    place[i] = end[i] + above / (above - there) * (point[i] - end[i])
                covered = elsewhere(p, end, place, face)
        return covered

    @kernel
    def hidden(p, one, other):
        """Whether the edge between two faces lies in other bodies, so that no way comes over it.

        Checked  tests/net_capture/test_visits.py
        """
        gone = False
        if several:
            gone = not lay(p, 0, one, other) and (p.wrap_pairs[0, 2] < 0 or p.wrap_pairs[0, 3] < 0)
        return gone

    @kernel
    def bare(p, edges):
        """Leave out the first face and the last while the edge that they have with the next lies in other bodies. Works
        on `wrap_chain`; how many edges are left.

        Checked  tests/net_capture/test_visits.py
        """
        chain = p.wrap_chain
        first = 0
        while first < edges and hidden(p, chain[first], chain[first + 1]):
            first += 1
        last = edges
        while last > first and hidden(p, chain[last - 1], chain[last]):
            last -= 1
        for j in range(first, last + 1):
            chain[j - first] = chain[j]
        return last - first

    @kernel
    def lengthen(p, edges):
        """Put faces before the first that one end does not see, and after the last that the other does not. Works on
        `wrap_chain`; how many edges there are then, 0 where no such face joins. Where it is wound over more edges than
        are kept, its last piece cuts the body, and the way is taken for shorter; then `wrap_lost` is 2.

        Checked  tests/net_capture/test_wrapping.py
        """
        chain, point = p.wrap_chain, p.wrap_up
        most = min(edges + MORE, MOST) if several else MOST
        for way in range(2):
            end, other = (p.wrap_a, p.wrap_b) if way == 0 else (p.wrap_b, p.wrap_a)
            before = edges
            while not sees(p, chain[0 if way == 0 else edges], end):
                if edges == MOST:
                    p.wrap_lost = WOUND
                    break
                if edges == most:
                    return 0
                for i in range(3):
                    point[i] = other[i]
                if edges > 0:
                    near = 0 if way == 0 else edges - 1
                    if not lay(p, 0, chain[near], chain[near + 1]):
                        return 0
                    for i in range(3):
                        point[i] = p.wrap_feet[0, i] + p.wrap_spans[0, TAU] * p.wrap_edges[0, i]
                    if several:
                        if edges == before and p.wrap_once > 0:
                            for i in range(3):
                                point[i] = p.wrap_bent[way, i]
                face = come_in(p, end, point)
                if face < 0:
                    return 0
                if covers(p, face, end, point) or hidden(p, face, chain[0 if way == 0 else edges]):
                    break
                edges += 1
                if way == 0:
                    for j in range(edges, 0, -1):
                        chain[j] = chain[j - 1]
                    chain[0] = face
                else:
                    chain[edges] = face
        return edges

    @kernel
    def uncover(p, edges):
        """Leave out faces between others that lie in another body. Works on `wrap_chain`; how many edges are left.

        Checked  tests/net_capture/test_union_wrapping.py
        """
        left = 0
        for j in range(1, edges + 1):
            if j == edges or p.wrap_covered[p.wrap_chain[j]] == 0:
                left += 1
                p.wrap_chain[left] = p.wrap_chain[j]
        return left

    return Chain(sees, trim, lift, lengthen, uncover, bare)
