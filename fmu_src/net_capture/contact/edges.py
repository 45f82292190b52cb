"""The shortest way of a thread between two nodes where the straight one cuts the target.

The body is a convex polyhedron, round ones of many faces (`shapes.Shape.faces`). In the plane of the straight way and
of where the thread lay before, the way goes over some edges (`section.py`); over these it is made the shortest
(`shortest.py`). Where it has come to a corner, an end of an edge, and would go on, it slides over it: on the other side
of a corner the way is over the other edges that meet there. Each such step makes it shorter, as a cord would slide, and
none brings it to the other side of the body. From each end the way is straight to the last face that the end can see.

Of several shortest ways, one on each side of a corner, it is so the one on the side where the thread lay.

Valid    convex bodies, at each of whose corners three faces meet
Checked  tests/net_capture/test_wrapping.py
"""

from __future__ import annotations

import math
from typing import Any

from fmu_src.net_capture.contact.section import MOST, make_section
from fmu_src.net_capture.contact.shortest import HIGH, LOW, SLOPE, TAU, make_shortest
from orbital.kernel import kernel
from orbital.vectors import dot

ROUNDS = 24
"""Edges that a way may leave or come to in one search."""
PUSH = 1e-9
"""Slope with which a way pushes past the end of an edge."""
TOGETHER = 1e-7
"""Metres between two bends that are at one corner."""
ABOVE = 1e-9
"""Metres above a face from where it is seen."""
BEYOND = 1e-4
"""Metres from a corner over which it has slid, where a way begins."""


def make_way() -> Any:
    """Kernel `find(p, known) -> edges` of the way from `wrap_a` to `wrap_b` in body axes, by the side on which the
    thread lay, the point `wrap_side`, where that is known.

    Checked  tests/net_capture/test_wrapping.py
    """
    section, settle = make_section(), make_shortest()
    cut, upright, over = section.cut, section.upright, section.over

    @kernel
    def lay(p, j, one, other):
        """Number j of the way's edges, between two faces and through the point in `wrap_feet`: its direction, its ends,
        and the faces there.

        Checked  tests/net_capture/test_wrapping.py
        """
        planes, edge, foot = p.wrap_planes, p.wrap_edges[j], p.wrap_feet[j]
        squared = 0.0
        for i in range(3):
            k, m = (i + 1) % 3, (i + 2) % 3
            edge[i] = planes[one, k] * planes[other, m] - planes[one, m] * planes[other, k]
            squared += edge[i] * edge[i]
        for i in range(3):
            edge[i] /= math.sqrt(squared) if squared > 0.0 else 1.0
        low = -math.inf
        high = math.inf
        pair = p.wrap_pairs[j]
        pair[0] = one
        pair[1] = other
        pair[2] = -1
        pair[3] = -1
        for k in range(p.wrap_faces):
            if k != one and k != other:
                rises = dot(planes[k, 0:3], edge)
                below = planes[k, 3] - p.wrap_inset - dot(planes[k, 0:3], foot)
                if rises > 0.0 and below < high * rises:
                    high = below / rises
                    pair[3] = k
                elif rises < 0.0 and below < low * rises:
                    low = below / rises
                    pair[2] = k
        p.wrap_spans[j, TAU] = 0.0
        p.wrap_spans[j, LOW] = min(low, 0.0)
        p.wrap_spans[j, HIGH] = max(high, 0.0)

    @kernel
    def shift(p, edges, j, by):
        """Move the way's edges from number j on by one place, to make room (1) or to leave out that before j (-1).

        Checked  tests/net_capture/test_wrapping.py
        """
        for n in range(edges - j):
            k = edges - 1 - n if by > 0 else j + n
            for i in range(4):
                p.wrap_pairs[k + by, i] = p.wrap_pairs[k, i]
                p.wrap_spans[k + by, i] = p.wrap_spans[k, i]
                if i < 3:
                    p.wrap_feet[k + by, i] = p.wrap_feet[k, i]
                    p.wrap_edges[k + by, i] = p.wrap_edges[k, i]

    @kernel
    def begin(p, j, corner):
        """The way crosses edge number j a little way from the corner at one of its ends.

        Checked  tests/net_capture/test_wrapping.py
        """
        span, pair = p.wrap_spans[j], p.wrap_pairs[j]
        upward = pair[2] == corner
        span[TAU] = min(BEYOND, span[HIGH]) if upward else max(-BEYOND, span[LOW])

    @kernel
    def join(p, edges, j):
        """Two edges, number j and the next, meet at a corner over which the way has slid: the edge between the faces
        before and after takes their place.

        Checked  tests/net_capture/test_wrapping.py
        """
        one, middle, other = p.wrap_pairs[j, 0], p.wrap_pairs[j, 1], p.wrap_pairs[j + 1, 1]
        shift(p, edges, j + 2, -1)
        for i in range(3):
            p.wrap_feet[j, i] = p.wrap_bends[j + 1, i]
        lay(p, j, one, other)
        begin(p, j, middle)

    @kernel
    def part(p, edges, j, face):
        """The way has slid over the end of edge number j onto a face there: its two edges with those of before take
        that one's place.

        Checked  tests/net_capture/test_wrapping.py
        """
        one, other = p.wrap_pairs[j, 0], p.wrap_pairs[j, 1]
        shift(p, edges, j + 1, 1)
        for i in range(3):
            p.wrap_feet[j, i] = p.wrap_bends[j + 1, i]
            p.wrap_feet[j + 1, i] = p.wrap_bends[j + 1, i]
        lay(p, j, one, face)
        lay(p, j + 1, face, other)
        begin(p, j, other)
        begin(p, j + 1, one)

    @kernel
    def slide(p, edges):
        """Slide over a corner if the way has come to one; how many edges it goes over then, or 0 where it has not.

        Checked  tests/net_capture/test_wrapping.py
        """
        for j in range(edges - 1):
            if p.wrap_pieces[j + 1, 3] < TOGETHER and p.wrap_pairs[j, 1] == p.wrap_pairs[j + 1, 0]:
                for i in range(3):
                    p.wrap_bends[j + 1, i] = 0.5 * (p.wrap_bends[j + 1, i] + p.wrap_bends[j + 2, i])
                join(p, edges, j)
                return edges - 1
        for j in range(edges):
            span, pair = p.wrap_spans[j], p.wrap_pairs[j]
            face = -1
            if span[TAU] <= span[LOW] and span[SLOPE] > PUSH:
                face = pair[2]
            elif span[TAU] >= span[HIGH] and span[SLOPE] < -PUSH:
                face = pair[3]
            if face < 0:
                continue
            if j + 1 < edges and p.wrap_pairs[j + 1, 0] == pair[1] and p.wrap_pairs[j + 1, 1] == face:
                join(p, edges, j)
                return edges - 1
            if j > 0 and p.wrap_pairs[j - 1, 1] == pair[0] and p.wrap_pairs[j - 1, 0] == face:
                for i in range(3):
                    p.wrap_bends[j, i] = p.wrap_bends[j + 1, i]
                join(p, edges, j - 1)
                return edges - 1
            if edges < MOST:
                part(p, edges, j, face)
                return edges + 1
        return 0

    @kernel
    def sees(p, face, end):
        """Whether an end of the thread is above a face.

        Checked  tests/net_capture/test_wrapping.py
        """
        plane = p.wrap_planes[face]
        return dot(plane[0:3], end) - plane[3] + p.wrap_inset > ABOVE

    @kernel
    def trim(p, edges):
        """Leave out edges before the first face and after the last that an end can see: from there the way is straight.

        Checked  tests/net_capture/test_wrapping.py
        """
        while edges > 1 and sees(p, p.wrap_pairs[edges - 1, 0], p.wrap_b):
            edges -= 1
        while edges > 1 and sees(p, p.wrap_pairs[0, 1], p.wrap_a):
            shift(p, edges, 1, -1)
            edges -= 1
        return edges

    @kernel
    def highest(p, edges):
        """Put the bend that is farthest from the straight way into `wrap_side`.

        Checked  tests/net_capture/test_wrapping.py
        """
        most = -1.0
        for j in range(1, edges + 1):
            along = 0.0
            away = 0.0
            for i in range(3):
                from_a = p.wrap_bends[j, i] - p.wrap_a[i]
                along += from_a * p.wrap_line[i]
                away += from_a * from_a
            if away - along * along > most:
                most = away - along * along
                for i in range(3):
                    p.wrap_side[i] = p.wrap_bends[j, i]

    @kernel
    def end(p, edges):
        """The way ends at the thread's other node.

        Checked  tests/net_capture/test_wrapping.py
        """
        for i in range(3):
            p.wrap_bends[edges + 1, i] = p.wrap_b[i]

    @kernel
    def find(p, known):
        """How many edges the way bends over, 0: it is straight. Its points are `wrap_bends[0 : edges + 2]`, both ends
        included, its pieces `wrap_pieces[0 : edges + 1]`, direction and length [m]; its side is in `wrap_side`.

        Checked  tests/net_capture/test_wrapping.py
        """
        first, last, middle = cut(p)
        if first < 0 or not upright(p, first, last, known):
            return 0
        edges = over(p, first, last, middle)
        for j in range(edges):
            lay(p, j, p.wrap_chain[j], p.wrap_chain[j + 1])
        for i in range(3):
            p.wrap_bends[0, i] = p.wrap_a[i]
        for _ in range(ROUNDS):
            edges = trim(p, edges)
            end(p, edges)
            settle(p, edges)
            slid = slide(p, edges)
            if slid == 0:
                break
            edges = slid
        highest(p, edges)
        return edges

    return find
