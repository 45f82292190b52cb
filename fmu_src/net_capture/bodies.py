"""Round which of several convex bodies a thread bends: that round which its way is the longest.

A union is made of convex bodies (`shapes/hulls.py`). Round the whole of it the shortest way is at least as long as that
round any of them, so of these ways the longest is the nearest to it from below, and it is continuous where the thread
goes over from one body to another: no energy comes or goes there. A thread that truly bends over two bodies at once is
taken for one that bends over the one which asks more of it, and lies in the other as deep as that lets it. The way is
continuous there, its slope is not: a light node in such a kink swings across it within few substeps and gains energy,
3 % of all in the scene `big-panel-wrapped`.

Of every body that lies across a thread it is remembered on which side it lies, over up to `SLOTS` of them. A body that
comes to lie across a thread which bends already is met on the side of that bend, if the thread may have come there, and
else on that of its own faces. A way round a body that a taut thread could not have come to
in a substep is one that has gone through it, and this body alone is left out until the thread is clear of it.

Checked  tests/net_capture/test_union_wrapping.py
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from fmu_src.net_capture.lying import Lie
from fmu_src.net_capture.near import BENT, CHAIN_WORDS, FACE_BITS, FINE, JUMP, PACKED, SHARE, WAY
from fmu_src.net_capture.planes import P, X
from fmu_src.net_capture.shapes.hulls import FIRST, MIDDLE, NUMBER, RADIUS
from orbital.kernel import kernel

SLOTS = 4
"""Bodies across one thread that are remembered."""
SLOT = 2 + CHAIN_WORDS
"""Whole numbers of each: its number from 1 on, less than 0 where the thread has gone through it and 0 for none; over
how many edges it bends, and the faces between them."""
KEPT = 1 + SLOTS * SLOT
"""Whole numbers kept of each thread behind those that any has: the body round which it bends, from 1 on, and these."""


class Rounds(NamedTuple):
    """Kernels of a thread among several bodies; what they find stands as `Lie` says.

    seek(p, work, words, at, a, b, length)             how it lies now, and keep that; which body it bent round before,
                                                       from 1 on, is in `wrap_round` then
    again(p, work, words, at, a, b, place, rate)       how it lies by these planes, round the same body
    """

    seek: Any
    again: Any


def make_bodies(composition: Any, kept: int, lie: Lie, remember: Any) -> Rounds:
    """Kernels for the composition's target, behind so many whole numbers kept of each thread."""
    hulls, rubs = composition.target.shape.hulls, remember is not None
    bodies_of, planes_of = hulls.bodies, hulls.planes
    find, stand, straight_of, reckon, lose = lie.find, lie.stand, lie.straight, lie.reckon, lie.lose

    @kernel
    def take(p, body):
        """Faces of a body into `wrap_planes`, unless they are there.

        Checked  tests/net_capture/test_union_wrapping.py
        """
        if p.wrap_body == body:
            return
        rows, planes = bodies_of(p), planes_of(p)
        first = int(rows[body, FIRST])
        p.wrap_faces = int(rows[body, NUMBER])
        for face in range(p.wrap_faces):
            for i in range(4):
                p.wrap_planes[face, i] = planes[first + face, i]
            p.wrap_covered[face] = int(planes[first + face, 4])
        p.wrap_body = body

    @kernel
    def slot_of(p, words, at, body):
        """Where a body is remembered, -1: nowhere; 0 as the body finds a free place.

        Checked  tests/net_capture/test_union_wrapping.py
        """
        for s in range(SLOTS):
            place = at + (kept + 1 + SLOT * s) * p.wrap_numbers
            if abs(words[place]) == body + 1 or (body < 0 and words[place] == 0):
                return place
        return -1

    @kernel
    def recall(p, words, place):
        """Over how many edges the thread bends there, the faces between them into `wrap_chain`.

        Checked  tests/net_capture/test_union_wrapping.py
        """
        edges = words[place + p.wrap_numbers]
        for j in range(edges + 1):
            word = words[place + (2 + j // PACKED) * p.wrap_numbers]
            p.wrap_chain[j] = (word >> (FACE_BITS * (j % PACKED))) & ((1 << FACE_BITS) - 1)
        return edges

    @kernel
    def keep(p, words, place, mark, edges):
        """Keep how the thread lies over a body.

        Checked  tests/net_capture/test_union_wrapping.py
        """
        words[place] = mark
        words[place + p.wrap_numbers] = edges
        for n in range(CHAIN_WORDS):
            words[place + (2 + n) * p.wrap_numbers] = 0
        for j in range(edges + 1):
            word = p.wrap_chain[j] << (FACE_BITS * (j % PACKED))
            words[place + (2 + j // PACKED) * p.wrap_numbers] |= word

    @kernel
    def apart(p, body, straight):
        """How far the straight thread is from the sphere round a body, at least [m].

        Checked  tests/net_capture/test_union_wrapping.py
        """
        row = bodies_of(p)[body]
        squared = 0.0
        for i in range(3):
            away = 0.5 * (p.wrap_a[i] + p.wrap_b[i]) - row[MIDDLE + i]
            squared += away * away
        return math.sqrt(squared) - row[RADIUS] - 0.5 * straight

    @kernel
    def meet(p, work, a, b, expected, bent):
        """Over how many edges a thread goes round a body that it has only just met: on the side of its faces, or, where
        it bends round another already and may have come there, on the side of that bend.

        expected   length of its way as it was to be now              [m]
        bent       whether it bends round another

        Checked  tests/net_capture/test_union_wrapping.py
        """
        if bent:
            p.wrap_leans = 1
            edges = find(p, 0)
            p.wrap_leans = 0
            if edges > 0:
                _, way, going, _, _ = reckon(p, work, a, b, X, P, edges)
                if way <= expected + JUMP + SHARE * p.solver_substep * abs(going):
                    return edges
        return find(p, 0)

    @kernel
    def lean(p, edges):
        """Where the way bends, from one end of the thread, into `wrap_lean` [m].

        Checked  tests/net_capture/test_union_wrapping.py
        """
        for i in range(3):
            p.wrap_lean[i] = p.wrap_bends[(edges + 1) // 2, i] - p.wrap_a[i]

    @kernel
    def seek(p, work, words, at, a, b, length):
        """How a thread lies now among all bodies.

        at         where its state stands
        length     of the thread, unstretched                    [m]

        Checked  tests/net_capture/test_union_wrapping.py
        """
        stand(p, work, a, b, X)
        straight = straight_of(p)
        held = words[at + kept * p.wrap_numbers]
        bent = words[at] == BENT
        expected = FINE * words[at + WAY * p.wrap_numbers] if bent else straight
        best = -1
        last = -1
        longest = 0.0
        clear = math.inf
        p.wrap_round = held
        for n in range(-1, bodies_of(p).shape[0]):
            body = n if n >= 0 else held - 1
            if body < 0 or (n >= 0 and n == held - 1):
                continue
            place = slot_of(p, words, at, body)
            off = apart(p, body, straight)
            edges = 0
            if off <= 0.0 or place >= 0:
                take(p, body)
                if place < 0:
                    edges = meet(p, work, a, b, expected, best >= 0)
                else:
                    edges = recall(p, words, place)
                    if rubs and n < 0:
                        remember(p)
                    before = edges
                    edges = find(p, before if words[place] > 0 else 0)
                    if words[place] > 0:
                        lose(p, before, edges, expected > length)
                off = p.wrap_clear
                if place >= 0 or off == 0.0:
                    last = body
            if edges == 0:
                clear = min(clear, off)
                if place >= 0:
                    words[place] = 0
                continue
            clear = 0.0
            if place >= 0 and words[place] < 0:
                continue
            if place < 0:
                place = slot_of(p, words, at, -1)
                if place < 0:
                    p.wrap_passed_slack += 1
                    continue
            _, way, going, _, _ = reckon(p, work, a, b, X, P, edges)
            within = JUMP + (SHARE if bent else SHARE + 2.0) * p.solver_substep * abs(going)
            if way > length and way > expected + within:
                keep(p, words, place, -1 - body, edges)
                p.wrap_passed += 1
                continue
            keep(p, words, place, 1 + body, edges)
            if n < 0:
                lean(p, edges)
            if way > longest:
                longest = way
                best = body
        p.wrap_clear = clear
        words[at + kept * p.wrap_numbers] = best + 1
        if best < 0:
            return 0, straight, 0.0, 0.0, 0.0
        edges = recall(p, words, slot_of(p, words, at, best))
        if last != best:
            take(p, best)
            edges = find(p, edges)
            if edges == 0:
                return 0, straight, 0.0, 0.0, 0.0
        return reckon(p, work, a, b, X, P, edges)

    @kernel
    def again(p, work, words, at, a, b, place, rate):
        """How a thread lies by these planes, round the body round which it bends.

        Checked  tests/net_capture/test_union_wrapping.py
        """
        body = words[at + kept * p.wrap_numbers] - 1
        take(p, body)
        edges = recall(p, words, slot_of(p, words, at, body))
        stand(p, work, a, b, place)
        if rubs:
            remember(p)
        edges = find(p, edges)
        if edges == 0:
            return 0, straight_of(p), 0.0, 0.0, 0.0
        return reckon(p, work, a, b, place, rate, edges)

    return Rounds(seek, again)
