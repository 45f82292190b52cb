"""What of a body's edges lies within other bodies, so that no way bends there.

Checked  tests/net_capture/test_visits.py
"""

from __future__ import annotations

import math
from typing import Any

from fmu_src.net_capture.contact.shortest import HIGH, LOW
from fmu_src.net_capture.shapes.hulls import FIRST, NUMBER
from orbital.kernel import kernel
from orbital.vectors import dot

PARALLEL = 1e-9
"""Sine of the angle of an edge to a face that never meets it."""
DEEPER = 2e-7
"""Metres below what ways lie within another body, from where on an edge is in that."""
PAST = 1e-5
"""Metres past the end of an edge at which it is looked whether another body goes on there; no shorter part of one is
left."""
ALIKE = 1e-9
"""By which the cosine of the angle between two faces in one plane may be less than 1."""
APART = 1e-6
"""Metres of an edge from both ends, no less than that, where they are divided by."""


def make_holds(hulls: Any) -> Any:
    """Kernel `holds(p, body, point, within)`: whether a point lies in a body of a union (`shapes.Hulls`), as ways know
    it, or above it by so much at most [m]; body axes [m].

    Checked  tests/net_capture/test_visits.py
    """
    bodies_of, planes_of = hulls.bodies, hulls.planes

    @kernel
    def holds(p, body, point, within):
        """Whether a point lies in a body.

        Checked  tests/net_capture/test_visits.py
        """
        rows, planes = bodies_of(p), planes_of(p)
        first = int(rows[body, FIRST])
        for k in range(first, first + int(rows[body, NUMBER])):
            if dot(planes[k, 0:3], point) - planes[k, 3] + p.wrap_inset > within:
                return False
        return True

    return holds


def make_hide(hulls: Any) -> Any:
    """Kernel `hide(p, j)` of edge number j of a way, among the bodies of a union (`shapes.Hulls`) that are listed in
    `wrap_others`; it does nothing for None, one body alone.

    Checked  tests/net_capture/test_visits.py
    """
    several = hulls is not None
    bodies_of, planes_of, holds = (hulls.bodies, hulls.planes, make_holds(hulls)) if several else (None, None, None)

    @kernel
    def crossing(p, j):
        """Where the way from end to end would cross edge number j if it bent there alone, along it [m].

            tau = (t_a d_b + t_b d_a) / (d_a + d_b),   d the distances of both ends from the edge, t along it

        Checked  tests/net_capture/test_visits.py
        """
        edge, foot = p.wrap_edges[j], p.wrap_feet[j]
        first = 0.0
        last = 0.0
        near = 0.0
        far = 0.0
        for i in range(3):
            first += (p.wrap_a[i] - foot[i]) * edge[i]
            last += (p.wrap_b[i] - foot[i]) * edge[i]
        for i in range(3):
            near += (p.wrap_a[i] - foot[i] - first * edge[i]) * (p.wrap_a[i] - foot[i] - first * edge[i])
            far += (p.wrap_b[i] - foot[i] - last * edge[i]) * (p.wrap_b[i] - foot[i] - last * edge[i])
        near, far = math.sqrt(near), math.sqrt(far)
        return (first * far + last * near) / max(near + far, APART)

    @kernel
    def goes_on(p, edge, foot, tau):
        """Whether a place along an edge lies in another body in `wrap_others`, or on one.

        Checked  tests/net_capture/test_visits.py
        """
        place = p.wrap_moving
        for i in range(3):
            place[i] = foot[i] + tau * edge[i]
        for n in range(p.wrap_others_near):
            if p.wrap_others[n] != p.wrap_body and holds(p, p.wrap_others[n], place, DEEPER):
                return True
        return False

    @kernel
    def hide(p, j):
        """Leave out of an edge what lies within the other bodies in `wrap_others`, or in one of their faces. Of the
        parts before and behind one the way goes over that which is nearer to it. Over an end behind which another body
        goes on the way does not slide.

        Checked  tests/net_capture/test_visits.py
        """
        if several:
            middle = crossing(p, j)
            span, pair, edge, foot = p.wrap_spans[j], p.wrap_pairs[j], p.wrap_edges[j], p.wrap_feet[j]
            rows, planes = bodies_of(p), planes_of(p)
            for n in range(p.wrap_others_near):
                body = p.wrap_others[n]
                if body == p.wrap_body:
                    continue
                enters, leaves = span[LOW], span[HIGH]
                first = int(rows[body, FIRST])
                flush = 0
                for k in range(first, first + int(rows[body, NUMBER])):
                    rises = dot(planes[k, 0:3], edge)
                    below = planes[k, 3] - p.wrap_inset - dot(planes[k, 0:3], foot)
                    if rises > PARALLEL:
                        leaves = min(leaves, (below - DEEPER) / rises)
                    elif rises < -PARALLEL:
                        enters = max(enters, (below - DEEPER) / rises)
                    elif below < -DEEPER:
                        leaves = -math.inf
                    elif below < DEEPER:
                        flush += 1
                    if enters >= leaves:
                        break
                if enters >= leaves or flush > 1:
                    continue
                before, behind = enters - span[LOW], span[HIGH] - leaves
                if behind <= PAST or (before > PAST and middle < 0.5 * (enters + leaves)):
                    span[HIGH] = enters if before > PAST else -math.inf
                    pair[3] = -1
                else:
                    span[LOW] = leaves
                    pair[2] = -1
            for end in range(2):
                tau = span[LOW] - PAST if end == 0 else span[HIGH] + PAST
                if pair[2 + end] >= 0 and abs(tau) < math.inf and goes_on(p, edge, foot, tau):
                    pair[2 + end] = -1

    return hide


def make_elsewhere(hulls: Any) -> Any:
    """Kernel `elsewhere(p, end, point, face)`: whether a point of a face of the body in `wrap_planes` lies in another
    body of those listed in `wrap_others`, or on one, but for one with a face in the same plane there, and one on which
    the end of the way lies from which it comes. Never for None.

    Checked  tests/net_capture/test_shell_wrapping.py
    """
    several = hulls is not None
    bodies_of, planes_of, holds = (hulls.bodies, hulls.planes, make_holds(hulls)) if several else (None, None, None)

    @kernel
    def flush(p, body, point, face):
        """Whether a body has a face in the plane of one of that in `wrap_planes`, at a point that lies on both.

        Checked  tests/net_capture/test_shell_wrapping.py
        """
        rows, planes = bodies_of(p), planes_of(p)
        first = int(rows[body, FIRST])
        for k in range(first, first + int(rows[body, NUMBER])):
            on = dot(planes[k, 0:3], point) - planes[k, 3] + p.wrap_inset > -PAST
            if on and dot(planes[k, 0:3], p.wrap_planes[face, 0:3]) > 1.0 - ALIKE:
                return True
        return False

    @kernel
    def elsewhere(p, end, point, face):
        """Whether a point of a face lies in another body.

        Checked  tests/net_capture/test_shell_wrapping.py
        """
        if several:
            for n in range(p.wrap_others_near):
                body = p.wrap_others[n]
                if body != p.wrap_body and holds(p, body, point, PAST):
                    if not holds(p, body, end, PAST) and not flush(p, body, point, face):
                        return True
        return False

    return elsewhere
