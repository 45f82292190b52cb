"""Round which of several convex bodies a thread bends, and in which order.

A union is made of convex bodies (`shapes/hulls.py`). The way of a thread is the shortest that goes through none of
them, on the side on which it came to lie: it visits one body after another (`visits.py`). A body that comes to lie
across a piece of it is visited from then on, between the bends at both ends of that piece, and one from which it has
lifted off no more; both happen where it does not bend there, so neither the way nor its slope jumps.

An edge that runs into another body ends there. A way that is drawn to such an end is held by the concave corner, unless
the edge goes on as that of the other body: then it goes over to that.

A body that could not have come to lie across a taut thread in a substep is one that the thread has gone through, and
this alone is left out until the thread is clear of it.

Checked  tests/net_capture/test_union_wrapping.py
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from fmu_src.net_capture import visit_list as of
from fmu_src.net_capture.across import GRAZES, MARGIN, make_across
from fmu_src.net_capture.contact.section import FACES_MET, LEAN, WALL
from fmu_src.net_capture.lying import Lie
from fmu_src.net_capture.near import BENT, FINE, JUMP, SHARE, WAY
from fmu_src.net_capture.planes import P, X
from fmu_src.net_capture.visits import make_visits
from orbital.kernel import kernel
from orbital.vectors import distance

KEPT = of.KEPT
"""Whole numbers kept of each thread behind those that any has."""
STEP = 1e-3
"""Metres by which a way may become longer at once where it goes over from body to body: their faces, and what ways lie
below them, do not fit together better."""
MEETINGS = 2 * of.VISITS
"""Bodies that a thread may meet in one substep."""
SIDES = (FACES_MET, WALL, LEAN)
"""Of a body on which a way may go round it, see `section`, in the order in which they are tried."""
LEAN_FIRST = SIDES.index(LEAN)
"""Where that order begins once a visit has ended: the way leans to where that was."""
CORNERS = 24
"""Corners over which a way may slide in one substep."""
THROUGH = 1e-4
"""Metres by which it lies deeper where it has gone through: one that grazes is asked again a substep on."""
LONGER = 1e-6
"""Metres by which a way that goes over to another body may be longer, and one that goes round one more shorter."""
NEAR_CORNER = 0.02
"""Metres between bends on edges of two bodies, from where on both are to be of one: much farther than bends move in a
substep."""


class Rounds(NamedTuple):
    """Kernels of a thread among several bodies; what they find stands as `Lie` says.

    seek(p, work, words, at, a, b, length)             how it lies now, and keep that
    again(p, work, words, at, a, b, place, rate)       how it lies by these planes, round the same bodies
    """

    seek: Any
    again: Any


def make_bodies(composition: Any, kept: int, lie: Lie, remember: Any) -> Rounds:
    """Kernels for the composition's target, behind so many whole numbers kept of each thread."""
    hulls, rubs = composition.target.shape.hulls, remember is not None
    stand, reckon = lie.stand, lie.reckon
    listed = of.make_visit_list()
    recall, keep, name, pass_through = listed.recall, listed.keep, listed.name, listed.remember
    visits = make_visits(hulls, lie, listed)
    relax, length_of, insert, replace = visits.relax, visits.length, visits.insert, visits.replace
    gather, crossed, met = make_across(hulls, visits, listed)

    @kernel
    def take_up(p, work, words, place, a, b, at, reach):
        """The way of a thread between these nodes as it is kept, to where they are now; over how many edges it bends.

        at         planes of places
        reach      length that it may have [m]

        Checked  tests/net_capture/test_union_wrapping.py
        """
        stand(p, work, a, b, at)
        for i in range(3):
            p.wrap_from[i] = p.wrap_a[i]
            p.wrap_to[i] = p.wrap_b[i]
        p.wrap_far = gather(p, max(reach, distance(p.wrap_from, p.wrap_to)) + MARGIN)
        recall(p, words, place)
        if rubs:
            name(p)
            remember(p)
        p.visits_lost = 0
        p.visits_left = 0
        return relax(p)

    @kernel
    def rate(p, work, a, b, edges):
        """How fast the way gets longer [m/s].

        Checked  tests/net_capture/test_union_wrapping.py
        """
        _, _, going, _, _ = reckon(p, work, a, b, X, P, edges)
        return going

    @kernel
    def go_round(p, work, words, place, a, b, piece, edges, body, length, expected, share):
        """Let the way go round a body that has come to lie across a piece of it, on the first side on which it is no
        longer than it may be; else it stays as it was. Over how many edges it bends then, 0: it can not.

        One body more in the way makes it no shorter, unless it slides over a corner: else another visit was lost.

        Of faces, wall and lean: leans first where a visit has ended.

        Checked  tests/net_capture/test_union_wrapping.py
        """
        least = length_of(p, edges) if edges > 0 else distance(p.wrap_from, p.wrap_to)
        before = max(expected, least)
        keep(p, words, place)
        left = p.visits_left
        for attempt in range(len(SIDES) + 1):
            side = SIDES[((LEAN_FIRST if left > 0 else 0) + attempt) % len(SIDES)]
            if side == LEAN and left == 0 and edges == 0:
                continue
            if attempt > 0:
                recall(p, words, place)
                edges = relax(p)
            p.visits_left = left
            found = relax(p) if insert(p, piece, edges, body, side) else 0
            if found > 0:
                way = length_of(p, found)
                within = JUMP + share * p.solver_substep * abs(rate(p, work, a, b, found))
                whole = way >= least - LONGER or p.visits_moved > 0
                if whole and (way <= before + max(within, STEP) or (attempt == len(SIDES) and way <= length)):
                    return found
        recall(p, words, place)
        return 0

    @kernel
    def meet(p, work, words, place, a, b, edges, length, expected, share):
        """Let the way go round bodies that have come to lie across it; over how many edges it bends then.

        Where it can not go round one by itself, another may be in the way first. Only those round which it can not go
        in the end it has gone through.

        edges      over how many it bends before
        expected   length of the way as it was to be now             [m]
        share      of what its ends make in a substep, by which it may be longer

        Checked  tests/net_capture/test_union_wrapping.py
        """
        left = p.wrap_others_near
        for _ in range(MEETINGS):
            p.wrap_near = math.inf
            piece, n = met(p, edges, left)
            if n < 0:
                break
            body = p.wrap_others[n]
            found = go_round(p, work, words, place, a, b, piece, edges, body, length, expected, share)
            if found > 0:
                edges = found
                left = p.wrap_others_near
            else:
                edges = relax(p)
                left -= 1
                p.wrap_others[n] = p.wrap_others[left]
                p.wrap_others[left] = body
        for n in range(left, p.wrap_others_near):
            body = p.wrap_others[n]
            if crossed(p, body, edges, GRAZES) >= 0:
                if crossed(p, body, edges, THROUGH) >= 0:
                    pass_through(p, body)
                    p.wrap_passed += 1
                p.wrap_near = 0.0
        return edges

    @kernel
    def goes_on(p, words, place, bend, edges, body, most):
        """Whether the way goes over another body in place of its own at a bend, no longer than now and through none;
        else it stays as it was. Over how many edges it bends then.

        most    visits that it may be then

        Checked  tests/net_capture/test_union_wrapping.py
        """
        way = length_of(p, edges)
        keep(p, words, place)
        if not replace(p, bend, edges, body):
            return False, edges
        found = relax(p)
        whole = found > 0 and p.visits <= most and length_of(p, found) <= way + LONGER
        if whole:
            piece, _ = met(p, found, p.wrap_others_near)
            whole = piece < 0
        if not whole:
            recall(p, words, place)
            found = relax(p)
        return whole, found

    @kernel
    def past_end(p, words, place, v, bend, edges):
        """Let the way go over to another body where it is held at the end of an edge that goes on as that of the other.
        Whether it does, and over how many edges it bends then.

        bend    number of the first of this visit

        Checked  tests/net_capture/test_union_wrapping.py
        """
        held, own = p.visit_barred[v], p.visit_body[v]
        if held > 0:
            for n in range(p.wrap_others_near):
                if p.wrap_others[n] != own:
                    over, edges = goes_on(p, words, place, bend + held - 1, edges, p.wrap_others[n], of.VISITS)
                    if over or v >= p.visits or p.visit_barred[v] == 0:
                        return over, edges
        return False, edges

    @kernel
    def round_corner(p, words, place, v, bend, edges):
        """Where the bends of a visit and the next come near one another, let both be to one body, so that the way may
        slide over the corner at which their edges meet. Whether they are, and over how many edges it bends then.

        Checked  tests/net_capture/test_visits.py, test_shell_wrapping.py
        """
        last = bend + p.visit_edges[v] - 1
        if v + 1 < p.visits and p.wrap_pieces[last, 3] < NEAR_CORNER:
            for side in range(2):
                one, other = v + side, v + 1 - side
                most = p.visits - (1 if p.visit_edges[other] == 1 else 0)
                body = p.visit_body[one]
                if body != p.visit_body[other]:
                    over, edges = goes_on(p, words, place, last + 1 - side, edges, body, most)
                    if over or v + 1 >= p.visits:
                        return over, edges
        return False, edges

    @kernel
    def go_over(p, words, place, edges):
        """Let the way go over to other bodies where it is held, or will come to a corner. Over how many edges it bends
        then.

        Checked  tests/net_capture/test_union_wrapping.py
        """
        v = 0
        bend = 1
        left = of.VISITS
        while v < p.visits and left > 0:
            over, edges = past_end(p, words, place, v, bend, edges)
            if not over and v < p.visits:
                over, edges = round_corner(p, words, place, v, bend, edges)
            if over:
                left -= 1
                v = 0
                bend = 1
            else:
                bend += p.visit_edges[v]
                v += 1
        return edges

    @kernel
    def seek(p, work, words, at, a, b, length):
        """How a thread lies now among all bodies.

        at         where its state stands
        length     of the thread, unstretched                    [m]

        Checked  tests/net_capture/test_union_wrapping.py
        """
        bent = words[at] == BENT
        share = SHARE if bent else SHARE + 2.0
        before = FINE * words[at + WAY * p.wrap_numbers] if bent else 0.0
        place = at + kept * p.wrap_numbers
        edges = take_up(p, work, words, place, a, b, X, before)
        lost = p.visits_lost
        straight = distance(p.wrap_from, p.wrap_to)
        expected = before if bent else straight
        for _ in range(CORNERS):
            moved = p.visits_moved
            edges = meet(p, work, words, place, a, b, edges, length, expected, share)
            if moved == 0 and p.visits_moved == 0:
                break
            edges = relax(p)
        edges = go_over(p, words, place, edges)
        keep(p, words, place)
        if rubs:
            name(p)
        p.wrap_clear = min(p.wrap_far, p.wrap_near) if edges == 0 else 0.0
        found = (0, straight, 0.0, 0.0, 0.0)
        within = JUMP
        if edges > 0:
            found = reckon(p, work, a, b, X, P, edges)
            within += share * p.solver_substep * abs(found[2])
        if lost > 0 and found[1] < expected - within:
            if expected > length:
                p.wrap_passed += 1
            else:
                p.wrap_passed_slack += 1
        return found

    @kernel
    def again(p, work, words, at, a, b, place, rate):
        """How a thread lies by these planes, round the bodies round which it bends.

        Checked  tests/net_capture/test_union_wrapping.py
        """
        before = FINE * words[at + WAY * p.wrap_numbers]
        edges = take_up(p, work, words, at + kept * p.wrap_numbers, a, b, place, before)
        if rubs:
            name(p)
        if edges == 0:
            return 0, distance(p.wrap_from, p.wrap_to), 0.0, 0.0, 0.0
        return reckon(p, work, a, b, place, rate, edges)

    return Rounds(seek, again)
