"""The way of a thread round several convex bodies, one after another: each is a *visit*, over some edges of one body.

Between two visits the way is straight, from the last bend of one to the first of the next. So each visit is a way round
one body between bends of its neighbours, or an end of the thread, and `contact/edges.py` finds over which edges it
goes; then all edges of all visits together are made the shortest way (`contact/shortest.py`). The faces of a visit are
found as if its neighbours' bends stood a little out of the surface, so that faces of two bodies in one plane are seen
as one.

A body may be visited more than once: one that stands on a plate comes between two visits of that.

Checked  tests/net_capture/test_union_wrapping.py, test_visits.py
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from fmu_src.net_capture.contact.chain import LOST, WOUND
from fmu_src.net_capture.contact.edges import PUSH
from fmu_src.net_capture.contact.section import FACES_MET, LEAN, MOST
from fmu_src.net_capture.contact.shortest import HIGH, LOW, SLOPE, TAU, make_shortest
from fmu_src.net_capture.lying import Lie
from fmu_src.net_capture.shapes.hulls import FIRST, NUMBER
from fmu_src.net_capture.visit_list import VISITS, VisitList
from orbital.kernel import kernel
from orbital.vectors import dot

ROUNDS = 8
"""Times that the edges of all visits are looked for in one search."""
ON = 1e-3
"""Metres that a bend may be from a face that goes on as that over which it lies."""
AWAY = -0.5
"""Cosine of the angle by which a face may look another way than that in whose place it comes."""
RAISED = 1e-6
"""Metres by which bends stand out for their neighbours."""
STRAIGHT = 1e-9
"""Sine of an angle by which a way does not bend."""


class Visits(NamedTuple):
    """Kernels of the way round the visits of the list.

    relax(p) -> edges            make the way from `wrap_from` to `wrap_to` round all visits the shortest, leaving out
                                 those from which it has lifted off; over how many edges it bends
    length(p, edges) -> way      of the way [m]
    ends(p, piece, edges)        both ends of a piece of it, raised, into `wrap_a` and `wrap_b`
    take(p, body)                faces of a body into `wrap_planes`
    insert(p, piece, edges, body, side) -> done    visit a body that lies across a piece of the way
    replace(p, bend, edges, body) -> done          visit a body in place of the edge at this bend
    """

    relax: Any
    length: Any
    ends: Any
    take: Any
    insert: Any
    replace: Any


def make_visits(hulls: Any, lie: Lie, listed: VisitList) -> Visits:
    """Kernels for the bodies of a union, on a list of visits."""
    make_room, leave, unite = listed.make_room, listed.leave, listed.unite
    part, owner = listed.part, listed.owner
    bodies_of, planes_of, find, settle = hulls.bodies, hulls.planes, lie.find, make_shortest()

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
    def between(p, v):
        """Both ends of the way round a visit, into `wrap_a` and `wrap_b`.

        Checked  tests/net_capture/test_visits.py
        """
        for i in range(3):
            p.wrap_a[i] = p.visit_ends[v - 1, 3 + i] if v > 0 else p.wrap_from[i]
            p.wrap_b[i] = p.visit_ends[v + 1, i] if v + 1 < p.visits else p.wrap_to[i]

    @kernel
    def raised(p, bend, out):
        """A bend of the way, raised, body axes [m].

        Checked  tests/net_capture/test_visits.py
        """
        squared = 0.0
        for i in range(3):
            out[i] = p.wrap_pieces[bend - 1, i] - p.wrap_pieces[bend, i]
            squared += out[i] * out[i]
        share = RAISED / math.sqrt(squared) if squared > STRAIGHT * STRAIGHT else 0.0
        for i in range(3):
            out[i] = p.wrap_bends[bend, i] + share * out[i]

    @kernel
    def stand(p, v, bend):
        """Ends of a visit from the bends of the way, which are that visit's from this one on.

        Checked  tests/net_capture/test_visits.py
        """
        raised(p, bend, p.visit_ends[v, 0:3])
        raised(p, bend + p.visit_edges[v] - 1, p.visit_ends[v, 3:6])

    @kernel
    def join(p, v, at):
        """Put the edges of a visit behind those of the visits before it.

        at        how many these have

        Checked  tests/net_capture/test_visits.py
        """
        for j in range(p.visit_edges[v]):
            for i in range(4):
                p.joint_spans[at + j, i] = p.wrap_spans[j, i]
                if i < 3:
                    p.joint_edges[at + j, i] = p.wrap_edges[j, i]
                    p.joint_feet[at + j, i] = p.wrap_feet[j, i]
                if i < 2:
                    face = p.wrap_pairs[j, 2 + i]
                    p.joint_shut[at + j, i] = 1 if face < 0 or p.wrap_covered[face] > 0 else 0

    @kernel
    def settle_all(p, edges):
        """Make the way over the edges of all visits the shortest.

        Checked  tests/net_capture/test_visits.py
        """
        for j in range(edges):
            for i in range(4):
                p.wrap_spans[j, i] = p.joint_spans[j, i]
                if i < 3:
                    p.wrap_edges[j, i] = p.joint_edges[j, i]
                    p.wrap_feet[j, i] = p.joint_feet[j, i]
        for i in range(3):
            p.wrap_bends[0, i] = p.wrap_from[i]
            p.wrap_bends[edges + 1, i] = p.wrap_to[i]
        settle(p, edges)

    @kernel
    def look(p, v):
        """Over which edges of its body a visit goes, between its neighbours as they are now; how many, and whether
        these are others than before.

        Checked  tests/net_capture/test_visits.py
        """
        take(p, p.visit_body[v])
        between(p, v)
        before = p.visit_edges[v]
        for j in range(before + 1):
            p.wrap_chain[j] = p.visit_chain[v, j]
        for i in range(3):
            p.wrap_bent[0, i] = p.visit_ends[v, i]
            p.wrap_bent[1, i] = p.visit_ends[v, 3 + i]
        p.wrap_once = 1
        edges = find(p, before)
        p.wrap_once = 0
        if edges == 0 or p.wrap_slid > 0:
            p.visits_moved += p.wrap_slid
            p.visits_left = 1
            for i in range(3):
                p.visit_left[i] = 0.5 * (p.visit_ends[v, i] + p.visit_ends[v, 3 + i])
        if p.wrap_lost == LOST or (p.wrap_lost == WOUND and before < MOST):
            p.visits_lost = 1
        if edges == 0:
            return 0, True
        changed = edges != before
        for j in range(edges + 1):
            changed = changed or p.visit_chain[v, j] != p.wrap_chain[j]
            p.visit_chain[v, j] = p.wrap_chain[j]
        p.visit_edges[v] = edges
        return edges, changed

    @kernel
    def held_at(p, v, bend):
        """Which bend of a visit, counted from 1, is drawn against the end of an edge over which it may not slide; 0:
        none.

        bend    number of its first

        Checked  tests/net_capture/test_visits.py
        """
        for j in range(p.visit_edges[v]):
            span, shut = p.wrap_spans[bend - 1 + j], p.joint_shut[bend - 1 + j]
            if shut[0] > 0 and span[TAU] <= span[LOW] and span[SLOPE] > PUSH:
                return 1 + j
            if shut[1] > 0 and span[TAU] >= span[HIGH] and span[SLOPE] < -PUSH:
                return 1 + j
        return 0

    @kernel
    def relax(p):
        """Make the way round all visits the shortest; over how many edges it bends.

        Checked  tests/net_capture/test_visits.py
        """
        rounds = 0
        p.visits_moved = 0
        while p.visits > 0:
            again = False
            edges = 0
            whole = True
            unite(p)
            for v in range(p.visits):
                these, changed = look(p, v)
                if edges + these > MOST:
                    p.visits_lost = 1
                if these == 0 or edges + these > MOST:
                    leave(p, v)
                    whole = False
                    break
                join(p, v, edges)
                edges += these
                again = again or changed
            if not whole:
                continue
            if p.visits > 1:
                settle_all(p, edges)
            bend = 1
            for v in range(p.visits):
                stand(p, v, bend)
                p.visit_barred[v] = held_at(p, v, bend)
                bend += p.visit_edges[v]
            rounds += 1
            if p.visits == 1 or rounds == ROUNDS or p.visits_moved > 0 or not again:
                return edges
        return 0

    @kernel
    def length(p, edges):
        """Length of the way [m].

        Checked  tests/net_capture/test_visits.py
        """
        total = 0.0
        for j in range(edges + 1):
            total += p.wrap_pieces[j, 3]
        return total

    @kernel
    def ends(p, piece, edges):
        """Both ends of a piece of the way, raised, into `wrap_a` and `wrap_b`.

        Checked  tests/net_capture/test_visits.py
        """
        for i in range(3):
            p.wrap_a[i] = p.wrap_from[i]
            p.wrap_b[i] = p.wrap_to[i]
        if piece > 0:
            raised(p, piece, p.wrap_a)
        if piece < edges:
            raised(p, piece + 1, p.wrap_b)

    @kernel
    def lean(p, bend):
        """The side to which a way leans at a bend, away from what it bends round, into `wrap_lean`.

        Checked  tests/net_capture/test_visits.py
        """
        for i in range(3):
            p.wrap_lean[i] = p.wrap_pieces[bend - 1, i] - p.wrap_pieces[bend, i]

    @kernel
    def go_round(p, v, body, edges):
        """Enter a visit to a body at place v of the list, with the way that was found round it.

        Checked  tests/net_capture/test_visits.py
        """
        make_room(p, v)
        p.visit_body[v] = body
        p.visit_edges[v] = edges
        p.visit_barred[v] = 0
        for j in range(edges + 1):
            p.visit_chain[v, j] = p.wrap_chain[j]
        stand(p, v, 1)

    @kernel
    def insert(p, piece, edges, body, side):
        """Visit a body that lies across a piece of the way; whether it can.

        edges     over how many the way bends
        side      on which it goes round, see `section`; it leans to where a visit has ended, or else the way bends

        Checked  tests/net_capture/test_visits.py
        """
        if p.visits + p.visits_passed + 2 > VISITS:
            return False
        ends(p, piece, edges)
        near, before = owner(p, piece)
        far, _ = owner(p, piece + 1)
        if side == LEAN and p.visits_left > 0:
            for i in range(3):
                p.wrap_lean[i] = p.visit_left[i] - 0.5 * (p.wrap_a[i] + p.wrap_b[i])
        elif side == LEAN:
            lean(p, piece if piece > 0 else 1)
        take(p, body)
        p.wrap_leans = side
        found = find(p, 0)
        p.wrap_leans = FACES_MET
        if found == 0:
            return False
        v = near + 1 if near >= 0 else max(far, 0)
        if near >= 0 and near == far:
            v = part(p, near, before + 1, 0)
        go_round(p, v, body, found)
        return True

    @kernel
    def like(p, body, own, face, bend, taken):
        """Face of a body at a bend that looks the most as one of another body does, -1: none is there. Where bodies
        meet at a corner it may look another way.

        own, face    the other body and its face
        taken        a face that it is not

        Checked  tests/net_capture/test_visits.py
        """
        rows, planes = bodies_of(p), planes_of(p)
        other = planes[int(rows[own, FIRST]) + face]
        first = int(rows[body, FIRST])
        found = -1
        most = AWAY
        for k in range(int(rows[body, NUMBER])):
            if k == taken:
                continue
            plane = planes[first + k]
            off = dot(plane[0:3], p.wrap_bends[bend]) - plane[3] + p.wrap_inset
            alike = dot(plane[0:3], other[0:3])
            if plane[4] == 0.0 and abs(off) < ON and alike > most:
                found = k
                most = alike
        return found

    @kernel
    def replace(p, bend, edges, body):
        """Visit a body in place of the edge at a bend, over its own edge there; whether it has one.

        Checked  tests/net_capture/test_visits.py
        """
        if p.visits + p.visits_passed + 2 > VISITS:
            return False
        v, before = owner(p, bend)
        own = p.visit_body[v]
        one, other = p.visit_chain[v, before], p.visit_chain[v, before + 1]
        one = like(p, body, own, one, bend, -1)
        other = like(p, body, own, other, bend, one)
        if one < 0 or other < 0:
            return False
        for i in range(3):
            p.wrap_a[i] = p.wrap_from[i]
            p.wrap_b[i] = p.wrap_to[i]
        if bend > 1:
            raised(p, bend - 1, p.wrap_a)
        if bend < edges:
            raised(p, bend + 1, p.wrap_b)
        at = part(p, v, before, 1)
        make_room(p, at)
        p.visit_body[at] = body
        p.visit_edges[at] = 1
        p.visit_barred[at] = 0
        p.visit_chain[at, 0] = one
        p.visit_chain[at, 1] = other
        raised(p, bend, p.visit_ends[at, 0:3])
        raised(p, bend, p.visit_ends[at, 3:6])
        return True

    return Visits(relax, length, ends, take, insert, replace)
