"""The visits of a thread's way to convex bodies, in order, and what is kept of them from one substep to the next.

Checked  tests/net_capture/test_visits.py
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from fmu_src.interface import Variable
from fmu_src.net_capture.contact.section import FACES, MOST
from fmu_src.net_capture.near import CHAIN_WORDS, FACE_BITS, FINE, PACKED
from fmu_src.rows import count, state
from orbital.kernel import kernel

OTHERS = 256
"""Bodies near one thread that are looked at."""
VISITS = 16
"""Visits of one thread, and bodies through which it has gone, that are remembered."""
SLOT = 2 + CHAIN_WORDS + 6
"""Whole numbers of each: the number of its body from 1 on, less than 0 where the thread has gone through it and 0 for
none; over how many edges it bends, the faces between them, and its first and last bend, body axes, `FINE` to one."""
KEPT = VISITS * SLOT
"""Whole numbers kept of each thread behind those that any has."""


class VisitList(NamedTuple):
    """Kernels of the list.

    recall(p, words, at)         the list as it is kept
    keep(p, words, at)           keep it
    remember(p, body)            the thread has gone through a body
    make_room(p, v)              for one more visit at place v of the list
    leave(p, v)                  take one off
    unite(p)                     make those one that join
    part(p, v, bends, skipped)   part a visit; the place between both
    name(p)                      the edges of the way by their bodies and faces, into `wrap_names`
    owner(p, bend)               which visit a bend belongs to, -1: it is an end; how many bends of that come before
    """

    recall: Any
    keep: Any
    remember: Any
    make_room: Any
    leave: Any
    unite: Any
    part: Any
    name: Any
    owner: Any


def rows() -> Iterator[Variable]:
    """Rows of a way round several bodies."""
    yield count("visits", "of the way of a thread", "state")
    yield count("visits_passed", "bodies through which it has gone", "state")
    yield count("visits_lost", "whether one of them could not go on", "state")
    yield count("visits_moved", "whether one has slid over a corner", "state")
    yield count("visits_left", "whether one has slid over a corner, or come to its end", "state")
    yield state("visit_left[#]", "m", "where the way bent there, body axes", shape=(3,))
    yield count("visit_body[#]", "which body each is to, counted from 0", "state", shape=(VISITS,))
    yield count("visit_edges[#]", "over how many of its edges", "state", shape=(VISITS,))
    yield count("visit_barred[#]", "bend that is held at a concave corner, counted from 1", "state", shape=(VISITS,))
    yield count("visit_chain[#][#]", "the faces between them", "state", shape=(VISITS, MOST + 1))
    yield count("visit_passed[#]", "bodies through which the thread has gone", "state", shape=(VISITS,))
    yield count("wrap_others_near", "bodies near a thread that are looked at", "state")
    yield count("wrap_others[#]", "which these are, counted from 0", "state", shape=(OTHERS,))
    yield state("visit_ends[#][#]", "m", "first and last bend of each, raised, body axes", shape=(VISITS, 6))
    yield state("joint_edges[#][#]", "1", "directions of the edges of all, body axes", shape=(MOST, 3))
    yield count("joint_shut[#][#]", "whether a way slides over no end of them", "state", shape=(MOST, 2))
    yield state("joint_feet[#][#]", "m", "points on them, body axes", shape=(MOST, 3))
    yield state("joint_spans[#][#]", "m", "where the way crosses them and both ends, slope there", shape=(MOST, 4))
    yield state("wrap_from[#]", "m", "where the way begins, body axes", shape=(3,))
    yield state("wrap_to[#]", "m", "where it ends, body axes", shape=(3,))


def make_visit_list() -> VisitList:
    """Kernels of the list."""

    @kernel
    def recall(p, words, at):
        """The list of visits as it is kept.

        at        where that stands

        Checked  tests/net_capture/test_visits.py
        """
        pitch = p.wrap_numbers
        p.visits = 0
        p.visits_passed = 0
        for s in range(VISITS):
            place = at + SLOT * s * pitch
            mark = words[place]
            if mark == 0:
                return
            if mark < 0:
                p.visit_passed[p.visits_passed] = -1 - mark
                p.visits_passed += 1
                continue
            v = p.visits
            edges = words[place + pitch]
            p.visit_body[v] = mark - 1
            p.visit_edges[v] = edges
            p.visit_barred[v] = 0
            for j in range(edges + 1):
                word = words[place + (2 + j // PACKED) * pitch]
                p.visit_chain[v, j] = (word >> (FACE_BITS * (j % PACKED))) & ((1 << FACE_BITS) - 1)
            for i in range(6):
                p.visit_ends[v, i] = FINE * words[place + (2 + CHAIN_WORDS + i) * pitch]
            p.visits += 1

    @kernel
    def keep(p, words, at):
        """Keep the list of visits.

        Checked  tests/net_capture/test_visits.py
        """
        pitch = p.wrap_numbers
        for s in range(VISITS):
            place = at + SLOT * s * pitch
            words[place] = 0
            if s < p.visits:
                words[place] = p.visit_body[s] + 1
                words[place + pitch] = p.visit_edges[s]
                for n in range(CHAIN_WORDS):
                    words[place + (2 + n) * pitch] = 0
                for j in range(p.visit_edges[s] + 1):
                    word = p.visit_chain[s, j] << (FACE_BITS * (j % PACKED))
                    words[place + (2 + j // PACKED) * pitch] |= word
                for i in range(6):
                    words[place + (2 + CHAIN_WORDS + i) * pitch] = np.int64(p.visit_ends[s, i] / FINE)
            elif s < p.visits + p.visits_passed:
                words[place] = -1 - p.visit_passed[s - p.visits]

    @kernel
    def remember(p, body):
        """The thread has gone through a body; one more than are remembered is counted anew in each substep.

        Checked  tests/net_capture/test_visits.py
        """
        if p.visits + p.visits_passed < VISITS:
            p.visit_passed[p.visits_passed] = body
            p.visits_passed += 1

    @kernel
    def move(p, source, target):
        """Copy a visit to another place of the list.

        Checked  tests/net_capture/test_visits.py
        """
        p.visit_body[target] = p.visit_body[source]
        p.visit_edges[target] = p.visit_edges[source]
        p.visit_barred[target] = p.visit_barred[source]
        for j in range(p.visit_edges[source] + 1):
            p.visit_chain[target, j] = p.visit_chain[source, j]
        for i in range(6):
            p.visit_ends[target, i] = p.visit_ends[source, i]

    @kernel
    def make_room(p, v):
        """Make room for one more visit at place v of the list.

        Checked  tests/net_capture/test_visits.py
        """
        for n in range(p.visits, v, -1):
            move(p, n - 1, n)
        p.visits += 1

    @kernel
    def leave(p, v):
        """Take a visit off the list.

        Checked  tests/net_capture/test_visits.py
        """
        for n in range(v, p.visits - 1):
            move(p, n + 1, n)
        p.visits -= 1

    @kernel
    def unite(p):
        """Make visits that follow one another to one body, over faces that join, one: so the way may slide over the
        corner between them.

        Checked  tests/net_capture/test_visits.py
        """
        for v in range(p.visits - 1, 0, -1):
            edges, more = p.visit_edges[v - 1], p.visit_edges[v]
            joins = p.visit_chain[v - 1, edges] == p.visit_chain[v, 0] and edges + more <= MOST
            if joins and p.visit_body[v - 1] == p.visit_body[v]:
                for j in range(1, more + 1):
                    p.visit_chain[v - 1, edges + j] = p.visit_chain[v, j]
                p.visit_edges[v - 1] = edges + more
                for i in range(3):
                    p.visit_ends[v - 1, 3 + i] = p.visit_ends[v, 3 + i]
                leave(p, v)

    @kernel
    def part(p, v, bends, skipped):
        """Part a visit: before and after so many of its bends, and so many left out, of which either may be none; the
        place on the list between both. The first ends at `wrap_a` then, the second begins at `wrap_b`.

        Checked  tests/net_capture/test_visits.py
        """
        after = p.visit_edges[v] - bends - skipped
        if bends > 0 and after > 0:
            make_room(p, v)
        second = v + 1 if bends > 0 else v
        if after > 0:
            for j in range(after + 1):
                p.visit_chain[second, j] = p.visit_chain[second, bends + skipped + j]
            p.visit_edges[second] = after
        if bends > 0:
            p.visit_edges[v] = bends
        for i in range(3):
            if bends > 0:
                p.visit_ends[v, 3 + i] = p.wrap_a[i]
            if after > 0:
                p.visit_ends[second, i] = p.wrap_b[i]
        if bends == 0 and after == 0:
            leave(p, v)
        return second

    @kernel
    def name(p):
        """The edges of the way by their bodies and faces, into `wrap_names`.

        Checked  tests/net_capture/test_visits.py
        """
        n = 0
        for v in range(p.visits):
            for j in range(p.visit_edges[v]):
                faces = FACES * p.visit_chain[v, j] + p.visit_chain[v, j + 1]
                p.wrap_names[n] = FACES * FACES * p.visit_body[v] + faces
                n += 1

    @kernel
    def owner(p, bend):
        """Which visit a bend belongs to, counted from 0, and how many bends of that come before it; -1: an end.

        Checked  tests/net_capture/test_visits.py
        """
        before = bend - 1
        for v in range(p.visits):
            if before < 0:
                return -1, 0
            if before < p.visit_edges[v]:
                return v, before
            before -= p.visit_edges[v]
        return -1, 0

    return VisitList(recall, keep, remember, make_room, leave, unite, part, name, owner)
