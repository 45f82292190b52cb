"""The convex hull of a few points, as faces and edges."""

from __future__ import annotations

import math

from orbital.kernel import kernel
from orbital.vectors import Array, cross, dot, norm, unit

FLAT = 1.0e-6
"""Share of the size of the hull within which a point counts as lying in a face."""
PARALLEL = 1.0e-9
"""Sine of the angle of two faces below which they count as parallel."""


@kernel
def hull(points: Array, faces: Array, edges: Array, sides: Array, room: Array) -> tuple[int, int]:
    """How many faces and edges the convex hull of some points has; (0, 0) where it has no volume, (-1, -1) where they
    are more than there is room for.

    points        x      one per row; the same may come twice        [m]    (n, 3)
    faces         n, h   outward normal and height: n . x <= h       [-], [m]      (m, 4)
    edges         o, d, l  begin, direction and length: o + t d, 0 <= t <= l       (k, 7)
    sides         the two faces of each edge                         [-]    (k, 2)
    room          room for vectors                                   [-]    (4, 3)

    Every three points that are not in line span a plane; one with no point beyond it is a face. Two faces that have two
    corners in common meet in an edge.

    Valid    some tens of points: the time goes with n^4
    Source   definition of the hull by its supporting planes
    Checked  tests/orbital/test_hull.py, against Qhull
    """
    n = points.shape[0]
    first, second, normal, begin = room[0], room[1], room[2], room[3]
    size = 0.0
    for i in range(n):
        square = 0.0
        for a in range(3):
            off = points[i, a] - points[0, a]
            square += off * off
        size = max(size, math.sqrt(square))
    near = FLAT * size
    count = 0
    for i in range(n):
        for j in range(i + 1, n):
            for k in range(j + 1, n):
                for a in range(3):
                    first[a] = points[j, a] - points[i, a]
                    second[a] = points[k, a] - points[i, a]
                cross(normal, first, second)
                if norm(normal) <= near * size:
                    continue
                unit(normal, normal)
                height = dot(normal, points[i])
                above, below = False, False
                for p in range(n):
                    beyond = dot(normal, points[p]) - height
                    above = above or beyond > near
                    below = below or beyond < -near
                if above and below:
                    continue
                if not (above or below):
                    return 0, 0
                sign = -1.0 if above else 1.0
                known = False
                for f in range(count):
                    # the same plane: these three points lie in it
                    known = known or (
                        abs(dot(faces[f, 0:3], points[i]) - faces[f, 3]) <= near
                        and abs(dot(faces[f, 0:3], points[j]) - faces[f, 3]) <= near
                        and abs(dot(faces[f, 0:3], points[k]) - faces[f, 3]) <= near
                    )
                if known:
                    continue
                if count == faces.shape[0]:
                    return -1, -1
                for a in range(3):
                    faces[count, a] = sign * normal[a]
                faces[count, 3] = sign * height
                count += 1
    found = 0
    for f in range(count):
        for g in range(f + 1, count):
            cross(normal, faces[f, 0:3], faces[g, 0:3])
            if norm(normal) <= PARALLEL:
                continue
            unit(normal, normal)
            low, high = math.inf, -math.inf
            for p in range(n):
                if (
                    abs(dot(faces[f, 0:3], points[p]) - faces[f, 3]) <= near
                    and abs(dot(faces[g, 0:3], points[p]) - faces[g, 3]) <= near
                ):
                    along = dot(normal, points[p])
                    high = max(high, along)
                    if along < low:
                        low = along
                        for a in range(3):
                            begin[a] = points[p, a]
            if not high - low > near:
                continue
            if found == edges.shape[0]:
                return -1, -1
            for a in range(3):
                edges[found, a] = begin[a]
                edges[found, 3 + a] = normal[a]
            edges[found, 6] = high - low
            sides[found, 0] = f
            sides[found, 1] = g
            found += 1
    return count, found
