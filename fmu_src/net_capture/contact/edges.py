"""The shortest way of a thread between two nodes where the straight one cuts the target.

The body is a convex polyhedron, round ones of many faces (`shapes.Shape.faces`). A way goes from face to face over the
edges between them. Which these are is found in the plane of the straight way when that first cuts the body
(`section.py`), and is remembered from then on; over these edges it is made the shortest (`shortest.py`). From each end
it is straight to the last of its faces that the end can see; an end that no longer sees the first of them has come
round an edge to another, which is put before.

Where the way has come to a corner, an end of an edge, and would go on, it slides over it: on the other side of a corner
it is over the other edges that meet there. Each such step makes it shorter, as a cord would slide, and none brings it
to the other side of the body. So of several shortest ways, one on each side of a corner, it is the one on the side
where the thread lay.

Valid    convex bodies, at each of whose corners three faces meet; up to half way round them
Checked  tests/net_capture/test_wrapping.py
"""

from __future__ import annotations

import math
from typing import Any

from fmu_src.net_capture.contact.chain import KEPT, LOST, make_chain
from fmu_src.net_capture.contact.hidden import make_elsewhere, make_hide
from fmu_src.net_capture.contact.section import MOST, make_section
from fmu_src.net_capture.contact.shortest import HIGH, LOW, SLOPE, TAU, along, make_shortest
from orbital.kernel import kernel
from orbital.vectors import dot

ROUNDS = 24
"""Edges that a way may leave or come to in one search."""
PUSH = 1e-9
"""Slope with which a way pushes past the end of an edge."""
PARALLEL = 1e-9
"""Sine of the angle of an edge to a face that never meets it."""
ALIKE = 1e-8
"""Square of the sine of the angle between faces that have no edge."""
TOGETHER = 1e-6
"""Metres between two bends that are at one corner."""
SAME = 1e-12
"""Metres by which two ways differ that are one: one that has come back to the shortest goes to and fro at a corner."""
BEYOND = 1e-4
"""Metres from a corner over which it has slid, where a way begins."""


def make_way(hulls: Any = None) -> Any:
    """Kernel `find(p, edges) -> edges` of the way from `wrap_a` to `wrap_b` in body axes, by the faces `wrap_chain`
    over which it went before, one more than edges; 0: none are known.

    hulls     of a union (`shapes.Hulls`): what an edge is within another body is no edge, see `hide`, and over its end
              the way slides onto no face that is covered; for `wrap_leans` see `make_section`

    Checked  tests/net_capture/test_wrapping.py
    """
    leans = hulls is not None
    hide = make_hide(hulls)
    section, settle = make_section(leans), make_shortest()
    cut, upright, over = section.cut, section.upright, section.over

    @kernel
    def lay(p, j, one, other):
        """Number j of the way's edges, between two faces: its direction, its ends, the faces there, and where the way
        begins to cross it. Whether these faces share an edge.

            foot = (h_1 - c h_2) n_1 / s2 + (h_2 - c h_1) n_2 / s2,   c = n_1 . n_2,   s2 = 1 - c2

        Checked  tests/net_capture/test_wrapping.py
        """
        planes, edge, foot, pair = p.wrap_planes, p.wrap_edges[j], p.wrap_feet[j], p.wrap_pairs[j]
        squared = 0.0
        for i in range(3):
            k, m = (i + 1) % 3, (i + 2) % 3
            edge[i] = planes[one, k] * planes[other, m] - planes[one, m] * planes[other, k]
            squared += edge[i] * edge[i]
        if squared < ALIKE:
            return False
        alike = dot(planes[one, 0:3], planes[other, 0:3])
        height, height_other = planes[one, 3] - p.wrap_inset, planes[other, 3] - p.wrap_inset
        middle = 0.0
        for i in range(3):
            edge[i] /= math.sqrt(squared)
            foot[i] = (height - alike * height_other) * planes[one, i] / squared
            foot[i] += (height_other - alike * height) * planes[other, i] / squared
        for i in range(3):
            middle += edge[i] * (0.5 * (p.wrap_a[i] + p.wrap_b[i]) - foot[i])
        low, high = -math.inf, math.inf
        pair[0] = one
        pair[1] = other
        beside = False
        for k in range(p.wrap_faces):
            if k != one and k != other:
                rises = dot(planes[k, 0:3], edge)
                below = planes[k, 3] - p.wrap_inset - dot(planes[k, 0:3], foot)
                if rises > PARALLEL and below < high * rises:
                    high = below / rises
                    pair[3] = k
                elif rises < -PARALLEL and below < low * rises:
                    low = below / rises
                    pair[2] = k
                beside = beside or (leans and abs(rises) <= PARALLEL and below < -TOGETHER)
        p.wrap_spans[j, LOW] = low
        p.wrap_spans[j, HIGH] = high
        hide(p, j)
        low = p.wrap_spans[j, LOW]
        high = p.wrap_spans[j, HIGH]
        p.wrap_spans[j, TAU] = min(max(middle, low), high)
        return low <= high + TOGETHER and not beside

    chain = make_chain(lay, leans, make_elsewhere(hulls))
    sees, trim, lift, lengthen = chain.sees, chain.trim, chain.lift, chain.lengthen
    uncover, bare = chain.uncover, chain.bare

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
        if pair[2] == corner:
            span[TAU] = min(span[LOW] + BEYOND, span[HIGH])
        else:
            span[TAU] = max(span[HIGH] - BEYOND, span[LOW])

    @kernel
    def join(p, edges, j):
        """Two edges, number j and the next, meet at a corner over which the way has slid: the edge between the faces
        before and after takes their place.

        Checked  tests/net_capture/test_wrapping.py
        """
        one, middle, other = p.wrap_pairs[j, 0], p.wrap_pairs[j, 1], p.wrap_pairs[j + 1, 1]
        shift(p, edges, j + 2, -1)
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
        lay(p, j, one, face)
        lay(p, j + 1, face, other)
        begin(p, j, other)
        begin(p, j + 1, one)

    @kernel
    def draws_in(p, j):
        """Whether the way, which is at the corner where edge number j and the next meet, is shorter over both of them:
        where the angles of the faces that it goes over there, from its piece before to the edge, between the edges, and
        from there to the piece after, are less than half a turn. Then it is put where these faces laid flat have it,

            r = a b sin(A) / (a sin(x) + b sin(A - x))

        from the corner along an edge at an angle x from the piece before, A all three angles, a and b those pieces.

        Checked  tests/net_capture/test_wrapping.py
        """
        inward = p.wrap_spans[j, TAU] - p.wrap_spans[j, LOW]
        inward = 1.0 if inward < p.wrap_spans[j, HIGH] - p.wrap_spans[j, TAU] else -1.0
        onward = p.wrap_spans[j + 1, TAU] - p.wrap_spans[j + 1, LOW]
        onward = 1.0 if onward < p.wrap_spans[j + 1, HIGH] - p.wrap_spans[j + 1, TAU] else -1.0
        turns = p.wrap_up
        turns[0] = -inward * along(p, j, j)
        turns[1] = inward * onward * dot(p.wrap_edges[j], p.wrap_edges[j + 1])
        turns[2] = onward * along(p, j + 2, j + 1)
        c, d, e = turns[0], turns[1], turns[2]
        s = math.sqrt(max(1.0 - c * c, 0.0))
        t = math.sqrt(max(1.0 - d * d, 0.0))
        u = math.sqrt(max(1.0 - e * e, 0.0))
        to_second = s * d + c * t
        from_first = t * e + d * u
        whole = to_second * e + (c * d - s * t) * u
        if whole <= 0.0:
            return False
        before, after = p.wrap_pieces[j, 3], p.wrap_pieces[j + 2, 3]
        far = before * after * whole / (before * s + after * from_first)
        p.wrap_spans[j, TAU] = p.wrap_spans[j, LOW] + far if inward > 0.0 else p.wrap_spans[j, HIGH] - far
        far = before * after * whole / (before * to_second + after * u)
        p.wrap_spans[j + 1, TAU] = p.wrap_spans[j + 1, LOW] + far if onward > 0.0 else p.wrap_spans[j + 1, HIGH] - far
        for k in range(2):
            span = p.wrap_spans[j + k]
            span[TAU] = min(max(span[TAU], span[LOW]), span[HIGH])
        return True

    @kernel
    def barred(p, face):
        """Whether the way may not slide over the end of an edge onto a face there, because that lies in another
        body, or the end does (face -1).

        Checked  tests/net_capture/test_union_wrapping.py
        """
        covered = False
        if leans:
            covered = face < 0 or p.wrap_covered[face] > 0
        return covered

    @kernel
    def slide(p, edges):
        """Slide over a corner if the way has come to one; how many edges it goes over then, or 0 where it has not.

        Checked  tests/net_capture/test_wrapping.py
        """
        for j in range(edges - 1):
            if p.wrap_pieces[j + 1, 3] < TOGETHER:
                if draws_in(p, j):
                    return edges
                join(p, edges, j)
                return edges - 1
        for j in range(edges):
            span, pair = p.wrap_spans[j], p.wrap_pairs[j]
            if span[TAU] <= span[LOW] and span[SLOPE] > PUSH:
                face = pair[2]
            elif span[TAU] >= span[HIGH] and span[SLOPE] < -PUSH:
                face = pair[3]
            else:
                continue
            if barred(p, face):
                continue
            if j + 1 < edges and p.wrap_pairs[j + 1, 0] == pair[1] and p.wrap_pairs[j + 1, 1] == face:
                join(p, edges, j)
                return edges - 1
            if j > 0 and p.wrap_pairs[j - 1, 1] == pair[0] and p.wrap_pairs[j - 1, 0] == face:
                join(p, edges, j - 1)
                return edges - 1
            if edges < MOST:
                part(p, edges, j, face)
                return edges + 1
        return 0

    @kernel
    def lay_all(p, edges):
        """Lay the edges between the faces of `wrap_chain`; whether there are all.

        Checked  tests/net_capture/test_wrapping.py
        """
        whole = edges > 0
        for j in range(edges):
            whole = lay(p, j, p.wrap_chain[j], p.wrap_chain[j + 1]) and whole
        return whole

    @kernel
    def on_bare(p, edges):
        """Leave out faces between others that lie in another body, where those before and after them have an edge, and
        lay the way; how many edges it has, 0 where one is not there.

        Checked  tests/net_capture/test_union_wrapping.py
        """
        if leans:
            for j in range(edges + 1):
                p.wrap_whole[j] = p.wrap_chain[j]
            left = uncover(p, edges)
            if left == edges or lay_all(p, left):
                edges = left
            else:
                for j in range(edges + 1):
                    p.wrap_chain[j] = p.wrap_whole[j]
        return edges if lay_all(p, edges) else 0

    @kernel
    def note(p, edges):
        """Put the faces between the way's edges into `wrap_chain`.

        Checked  tests/net_capture/test_wrapping.py
        """
        p.wrap_chain[0] = p.wrap_pairs[0, 0]
        for j in range(edges):
            p.wrap_chain[j + 1] = p.wrap_pairs[j, 1]

    @kernel
    def presses(p):
        """Whether a way over one edge, which a straight one would miss, presses on it: both its pieces together point
        into the body. Else it has lifted off.

        Checked  tests/net_capture/test_hooked_threads.py
        """
        one, other = p.wrap_planes[p.wrap_pairs[0, 0]], p.wrap_planes[p.wrap_pairs[0, 1]]
        outward = 0.0
        for i in range(3):
            outward += (p.wrap_pieces[1, i] - p.wrap_pieces[0, i]) * (one[i] + other[i])
        return outward < 0.0

    @kernel
    def find(p, edges):
        """How many edges the way bends over, 0: it is straight. Its points are `wrap_bends[0 : edges + 2]`, both ends
        included, its pieces `wrap_pieces[0 : edges + 1]`, direction and length [m]; its faces are in `wrap_chain`.

        Where it is known how it lay, it goes on from there though the straight way has left the body, until it has
        lifted off it: what is thin has been crossed by then, and the thread still lies on the other side. Where it can
        not go on from there it begins anew, or is let go; `wrap_lost` tells, see `chain`.

        Checked  tests/net_capture/test_wrapping.py, test_hooked_threads.py
        """
        known = edges > 0
        p.wrap_lost = KEPT
        rounds = ROUNDS
        if leans:
            p.wrap_slid = 0
            rounds = 2 if p.wrap_once > 0 else ROUNDS
        first, last, middle = cut(p)
        if first < 0:
            if not known:
                return 0
            edges = lift(p, edges)
            if edges == 0 and sees(p, p.wrap_chain[0], p.wrap_a) and sees(p, p.wrap_chain[0], p.wrap_b):
                return 0
            edges = on_bare(p, lengthen(p, edges))
            if edges == 0:
                p.wrap_lost = LOST
                return 0
        elif edges > 0:
            edges = on_bare(p, lengthen(p, trim(p, edges)))
        if first >= 0 and edges == 0:
            if known:
                p.wrap_lost = LOST
            if not upright(p, first, last, middle):
                return 0
            edges = trim(p, over(p, first, last, middle))
            if leans:
                edges = bare(p, uncover(p, edges))
                if not lay_all(p, edges):
                    return 0
            else:
                lay_all(p, edges)
        for i in range(3):
            p.wrap_bends[0, i] = p.wrap_a[i]
        least = math.inf
        for n in range(rounds):
            for i in range(3):
                p.wrap_bends[edges + 1, i] = p.wrap_b[i]
            way = settle(p, edges)
            if abs(way - least) <= SAME:
                break
            least = min(least, way)
            slid = slide(p, edges) if n + 1 < rounds else 0
            if slid == 0:
                break
            if leans:
                p.wrap_slid = 1
            note(p, slid)
            edges = trim(p, slid) if first >= 0 else lift(p, slid)
            if edges == 0 and first < 0:
                return 0
            if edges < slid:
                if not lay_all(p, edges) and (leans or first < 0):
                    p.wrap_lost = LOST if known else KEPT
                    return 0
        note(p, edges)
        if first < 0 and edges == 1 and not presses(p):
            return 0
        return edges

    return find
