"""Which of several convex bodies lie across the way of a thread.

Checked  tests/net_capture/test_union_wrapping.py
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from fmu_src.net_capture import visit_list as of
from fmu_src.net_capture.contact.section import make_section
from fmu_src.net_capture.shapes.hulls import FIRST, INSET, MIDDLE, NUMBER, RADIUS
from fmu_src.net_capture.visits import Visits
from orbital.kernel import kernel
from orbital.vectors import dot

MARGIN = 0.01
"""Metres that a way may be longer than it was to be, for bodies that are near."""
GRAZES = 2e-6
"""Metres by which a piece of the way may lie deeper in a body than a way round it."""


class Across(NamedTuple):
    """Kernels that ask the bodies of a union.

    gather(p, way) -> clear                       list those near in `wrap_others`
    crossed(p, body, edges, deeper) -> piece      of the way that goes through one of them
    met(p, edges, left) -> (piece, n)             of the way that goes through any, and the place of that
    """

    gather: Any
    crossed: Any
    met: Any


def make_across(hulls: Any, visits: Visits, listed: of.VisitList) -> Across:
    """Kernels for the bodies of a union, and ways by the list of visits."""
    bodies_of, planes_of, cut = hulls.bodies, hulls.planes, make_section(True).cut
    ends, take, owner = visits.ends, visits.take, listed.owner

    @kernel
    def gather(p, way):
        """List the bodies near a way of that length [m] from `wrap_from` to `wrap_to`; how far all others are, at least
        [m].

        Checked  tests/net_capture/test_union_wrapping.py
        """
        rows = bodies_of(p)
        clear = math.inf
        p.wrap_others_near = 0
        for body in range(rows.shape[0]):
            squared = 0.0
            for i in range(3):
                away = 0.5 * (p.wrap_from[i] + p.wrap_to[i]) - rows[body, MIDDLE + i]
                squared += away * away
            off = math.sqrt(squared) - rows[body, RADIUS] - 0.5 * way
            if off > 0.0:
                clear = min(clear, off)
            elif p.wrap_others_near < of.OTHERS:
                p.wrap_others[p.wrap_others_near] = body
                p.wrap_others_near += 1
            else:
                p.wrap_passed_slack += 1
        return clear

    @kernel
    def apart(p, body, deeper):
        """How far both of `wrap_a` and `wrap_b` are above a face of a body, and so the straight way from one to the
        other, of the first such face; else 0 [m].

        deeper    than a way round it                       [m]

        Checked  tests/net_capture/test_union_wrapping.py
        """
        rows, planes = bodies_of(p), planes_of(p)
        first = int(rows[body, FIRST])
        for k in range(first, first + int(rows[body, NUMBER])):
            height = planes[k, 3] - (INSET + deeper)
            clear = min(dot(planes[k, 0:3], p.wrap_a), dot(planes[k, 0:3], p.wrap_b)) - height
            if clear > 0.0:
                return clear
        return 0.0

    @kernel
    def crosses(p, body, piece, edges, deeper):
        """Whether a piece of the way goes through a body that is visited at neither of its ends; else `wrap_near` gets
        no longer than how far it is from that, at least.

        deeper    than a way round it                       [m]

        Checked  tests/net_capture/test_union_wrapping.py
        """
        for side in range(2):
            v, _ = owner(p, piece + side)
            if v >= 0 and p.visit_body[v] == body:
                p.wrap_near = 0.0
                return False
        ends(p, piece, edges)
        clear = apart(p, body, deeper)
        if clear > 0.0:
            p.wrap_near = min(p.wrap_near, clear)
            return False
        take(p, body)
        p.wrap_grazes = deeper
        first, _, _ = cut(p)
        p.wrap_grazes = 0.0
        if first < 0:
            p.wrap_near = min(p.wrap_near, p.wrap_clear)
        return first >= 0

    @kernel
    def crossed(p, body, edges, deeper):
        """Piece of the way that goes through a body, -1: none does.

        Checked  tests/net_capture/test_union_wrapping.py
        """
        for piece in range(edges + 1):
            if crosses(p, body, piece, edges, deeper):
                return piece
        return -1

    @kernel
    def met(p, edges, left):
        """Piece of the way that goes through a body, and the place of that in `wrap_others`; -1 where there is none.
        Bodies through which the thread has gone are forgotten where it is clear of them. `wrap_near` gets how far it is
        from the others.

        left    how many are asked

        Checked  tests/net_capture/test_union_wrapping.py
        """
        for n in range(left):
            body = p.wrap_others[n]
            through = -1
            for s in range(p.visits_passed):
                if p.visit_passed[s] == body:
                    through = s
            hit = crossed(p, body, edges, GRAZES)
            if through < 0 and hit >= 0:
                return hit, n
            if through >= 0 and hit < 0:
                p.visits_passed -= 1
                p.visit_passed[through] = p.visit_passed[p.visits_passed]
            elif through >= 0:
                p.wrap_near = 0.0
        return -1, -1

    return Across(gather, crossed, met)
