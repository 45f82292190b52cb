"""Where the straight way between two points cuts a convex polyhedron, and over which of its faces a way round it goes.

All is asked in one plane, which holds the straight way and the side on which the thread comes to lie: s along the
straight way, t towards that side. Each face is a line of that plane, and the body lies under all of them,

    alpha s + beta t <= gamma

so the way goes from the face through which the straight one comes in, over what lies above, to that where it goes out.
Two neighbours whose lines meet outside the body have a third between them: the one through which the line from the
middle of the straight way to that point leaves the body. After as many such steps as there are faces none is left out.

Checked  tests/net_capture/test_wrapping.py
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from fmu_src.net_capture.shapes.hulls import INSET
from orbital.kernel import kernel
from orbital.vectors import dot

FACES = 336
"""Faces that a body may have."""
MOST = 40
"""Edges that a way may go over."""
PARALLEL = 1e-9
"""Sine of the angle of two faces that do not meet."""
OVER = 1e-9
"""Metres that a point of the surface may seem to lie above it."""
FAR = 1e3
"""Radii of the body away: where parallel faces meet."""


FACES_MET, LEAN, WALL = range(3)
"""Sides on which a way goes round one of several bodies: that of the faces through which the straight one goes, that of
`wrap_lean`, and that of the wall nearest to its middle."""


class Section(NamedTuple):
    """Kernels for a body whose faces are in `wrap_planes`, and a straight way from `wrap_a` to `wrap_b`.

    cut(p) -> (first, last, middle)   faces where the way comes in and goes out, -1: nowhere; its middle inside [m]
    upright(p, first, last, middle)   direction `wrap_up` across the way to where those faces look; whether there is one
    over(p, first, last, middle)      how many edges the way goes over on that side: the faces before, between and after
                                      them in `wrap_chain`
    """

    cut: Any
    upright: Any
    over: Any


def make_section(leans: bool) -> Section:
    """Kernels of the section.

    leans     whether `wrap_leans` says on which side, see `FACES_MET`, and faces marked in `wrap_covered` lie in other
              bodies, so that no thread comes to lie over them
    """

    @kernel
    def above(p, point):
        """How far a point lies above all faces as the way knows them, 0: on the surface [m].

        Checked  tests/net_capture/test_wrapping.py
        """
        found = -math.inf
        for i in range(p.wrap_faces):
            plane = p.wrap_planes[i]
            found = max(found, plane[0] * point[0] + plane[1] * point[1] + plane[2] * point[2] - plane[3])
        return found + p.wrap_inset

    @kernel
    def cut(p):
        """Faces through which the straight way comes in and goes out, and where its middle inside is along it [m]; -1
        where it passes by, and then how far it is from cutting the body, at least, in `wrap_clear` [m]. Leaves alpha
        and gamma of all faces in `wrap_flat`, its direction in `wrap_line`.

        An end that lies deeper than the inset is on the surface: the body is smaller for its way.

        Checked  tests/net_capture/test_wrapping.py
        """
        a, b, line, planes, flat = p.wrap_a, p.wrap_b, p.wrap_line, p.wrap_planes, p.wrap_flat
        squared = 0.0
        for i in range(3):
            line[i] = b[i] - a[i]
            squared += line[i] * line[i]
        length = math.sqrt(squared)
        p.wrap_clear = 0.0
        if length == 0.0:
            return -1, -1, 0.0
        p.wrap_inset = 0.0
        deepest = max(-above(p, a), -above(p, b))
        if leans:
            p.wrap_inset = max(INSET, deepest + OVER) + p.wrap_grazes
        else:
            p.wrap_inset = max(INSET, deepest)
        for i in range(3):
            line[i] /= length
        first = -1
        last = -1
        enters = -math.inf
        leaves = math.inf
        for i in range(p.wrap_faces):
            alpha = dot(planes[i, 0:3], line)
            gamma = planes[i, 3] - p.wrap_inset - dot(planes[i, 0:3], a)
            flat[i, 0] = alpha
            flat[i, 2] = gamma
            begins = gamma <= 0.0
            ends = alpha * length >= gamma
            if begins and ends:
                p.wrap_clear = min(-gamma, alpha * length - gamma)
                return -1, -1, 0.0
            if begins and gamma < enters * alpha:
                enters = gamma / alpha
                first = i
            elif ends and gamma < leaves * alpha:
                leaves = gamma / alpha
                last = i
        if first < 0 or last < 0 or enters >= leaves:
            return -1, -1, 0.0
        return first, last, 0.5 * (enters + leaves)

    @kernel
    def upright(p, first, last, middle):
        """Direction across the straight way on which the thread lies; whether there is one.

        Checked  tests/net_capture/test_wrapping.py
        """
        line, up, planes = p.wrap_line, p.wrap_up, p.wrap_planes
        wall = nearest_wall(p, first, last, middle)
        bare, met = 1.0, 1.0
        for attempt in range(2):
            if leans:
                bare, met = 1.0 - p.wrap_covered[first], 1.0 - p.wrap_covered[last]
                if attempt == 0 and p.wrap_leans != LEAN and (p.wrap_leans == WALL or bare + met == 0.0):
                    continue
            for i in range(3):
                up[i] = bare * planes[first, i] + met * planes[last, i] if attempt == 0 else planes[wall, i]
                if leans:
                    if p.wrap_leans == LEAN and attempt == 0:
                        up[i] = p.wrap_lean[i]
            along = dot(up, line)
            for i in range(3):
                up[i] -= along * line[i]
            size = math.sqrt(dot(up, up))
            if size > 1e-6:
                for i in range(3):
                    up[i] /= size
                return True
        return False

    @kernel
    def nearest_wall(p, first, last, middle):
        """Face that the middle of the straight way inside lies nearest to, of those that it does not go through and
        that it runs along.

        Checked  tests/net_capture/test_wrapping.py, test_union_wrapping.py
        """
        found = first
        least = math.inf
        for i in range(p.wrap_faces):
            if i == first:
                continue
            if i == last:
                continue
            if leans:
                if p.wrap_covered[i] > 0:
                    continue
            below = p.wrap_flat[i, 2] - p.wrap_flat[i, 0] * middle
            across = math.sqrt(max(1.0 - p.wrap_flat[i, 0] * p.wrap_flat[i, 0], 0.0))
            if across > 0.5 and below < least:
                least = below
                found = i
        return found

    @kernel
    def meet(p, one, other, middle):
        """Where two faces meet in this plane [m]; far away where they do not.

        Checked  tests/net_capture/test_wrapping.py
        """
        f, g = p.wrap_flat[one], p.wrap_flat[other]
        size = f[0] * g[1] - g[0] * f[1]
        if size > -PARALLEL:  # along neither normal, over the body
            first = math.sqrt(f[0] * f[0] + f[1] * f[1])
            last = math.sqrt(g[0] * g[0] + g[1] * g[1])
            s = f[1] / first - g[1] / last
            t = g[0] / last - f[0] / first
            far = FAR * p.envelope_radius / math.sqrt(s * s + t * t)
            return middle + far * s, far * t
        return (f[2] * g[1] - g[2] * f[1]) / size, (f[0] * g[2] - g[0] * f[2]) / size

    @kernel
    def between(p, one, other, s, t, middle):
        """Face that cuts off where two others meet; -1 where none does.

        Checked  tests/net_capture/test_wrapping.py
        """
        found = -1
        least = 1.0
        for k in range(p.wrap_faces):
            if k != one and k != other:
                face = p.wrap_flat[k]
                beyond = face[0] * s + face[1] * t - face[2]
                if beyond > OVER:
                    within = face[0] * middle - face[2]
                    share = within / (within - beyond)
                    if share < least:
                        least = share
                        found = k
        return found

    @kernel
    def over(p, first, last, middle):
        """Edges over which the way goes in this plane.

        Checked  tests/net_capture/test_wrapping.py
        """
        up, chain, planes, flat = p.wrap_up, p.wrap_chain, p.wrap_planes, p.wrap_flat
        for i in range(p.wrap_faces):
            flat[i, 1] = dot(planes[i, 0:3], up)
        chain[0] = first
        chain[1] = last
        edges = 1
        if leans:
            if p.wrap_covered[first] + p.wrap_covered[last] > 0:
                top = -1
                for i in range(p.wrap_faces):
                    if p.wrap_covered[i] == 0 and (top < 0 or flat[i, 1] > flat[top, 1]):
                        top = i
                if top < 0 or top in (first, last):
                    return 1
                chain[1] = top
                chain[2] = last
                return 2
        at = 0
        while at < edges:
            one, other = chain[at], chain[at + 1]
            s, t = meet(p, one, other, middle)
            third = between(p, one, other, s, t, middle)
            if third >= 0 and edges < MOST:
                for i in range(edges, at, -1):
                    chain[i + 1] = chain[i]
                chain[at + 1] = third
                edges += 1
                continue
            at += 1
        return edges

    return Section(cut, upright, over)
