"""Questions to a convex polyhedron: its faces n . x <= h and edges o + t d, of `surfaces`, in body axes."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from orbital.kernel import kernel
from orbital.vectors import Array, dot, unit

DEPTH = 1e-10
"""Depth below the faces, as a share of the body's size, from which on a line passes through the body."""
TOGETHER = 1e-5
"""Share of the body's size within which points are at one corner."""
NONE = -1
"""No face, no edge."""


@kernel
def at_edge(record: Any, out: Array, edge: int, along: float) -> None:
    """out = point of an edge [m] at a distance along it.

    Checked  tests/tethered_deorbit/test_wrapping.py
    """
    row = record[0].state_edges[edge]
    for i in range(3):
        out[i] = row[i] + along * row[3 + i]


@kernel
def on_both(record: Any, first: int, second: int) -> bool:
    """Whether two edges have a face in common: between them the line lies on it.

    Checked  tests/tethered_deorbit/test_wrapping.py
    """
    sides = record[0].state_sides
    a, b, c, d = sides[first][0], sides[first][1], sides[second][0], sides[second][1]
    return bool(a in (c, d) or b in (c, d))


@kernel
def face_beyond(record: Any, edge: int, way: Array, sign: float) -> int:
    """The face of an edge over which a line goes on that comes to it along a way, or, sign -1, has come from.

    Checked  tests/tethered_deorbit/test_wrapping.py
    """
    r = record[0]
    a, b = r.state_sides[edge][0], r.state_sides[edge][1]
    return int(a if sign * (dot(way, r.state_faces[a][0:3]) - dot(way, r.state_faces[b][0:3])) > 0.0 else b)


@kernel
def other_side(record: Any, edge: int, face: int) -> int:
    """The face of an edge that is not this one.

    Checked  tests/tethered_deorbit/test_wrapping.py
    """
    sides = record[0].state_sides[edge]
    return int(sides[0] if sides[1] == face else sides[1])


@kernel
def nearest_to(record: Any, edge: int, first: Array, last: Array) -> float:
    """Where along an edge [m] a straight line between two points comes nearest to it.

    Source   common perpendicular of two lines
    Checked  tests/tethered_deorbit/test_wrapping.py
    """
    row = record[0].state_edges[edge]
    aa, ab, ac, bc = 0.0, 0.0, 0.0, 0.0
    for i in range(3):
        way, off = last[i] - first[i], row[i] - first[i]
        aa += way * way
        ab += way * row[3 + i]
        ac += way * off
        bc += row[3 + i] * off
    divisor = aa - ab * ab
    return (ab * ac - aa * bc) / divisor if divisor > 1.0e-12 * aa else 0.5 * row[6]


@kernel
def crossing(record: Any, edge: int, normal: Array, through: Array) -> float:
    """Where along an edge [m] a plane through a point crosses it, or -1.

    Checked  tests/tethered_deorbit/test_wrapping.py
    """
    r = record[0]
    row = r.state_edges[edge]
    low, slope = 0.0, 0.0
    for i in range(3):
        low += normal[i] * (row[i] - through[i])
        slope += normal[i] * row[3 + i]
    high = low + slope * row[6]
    if (low > 0.0) == (high > 0.0):
        return -1.0
    return -low / slope


@kernel
def crosswise(out: Array, way: Array) -> None:
    """out = a direction [-] across another.

    Checked  tests/tethered_deorbit/test_wrapping.py
    """
    thin = 0
    for i in range(3):
        if abs(way[i]) < abs(way[thin]):
            thin = i
    for i in range(3):
        out[i] = (1.0 if i == thin else 0.0) - way[thin] * way[i]
    unit(out, out)


@kernel
def at_corner(record: Any, edge: int, corner: Array) -> float:
    """Where along an edge [m] a corner lies, or -1.

    Checked  tests/tethered_deorbit/test_way.py: a line slips off a corner
    """
    r = record[0]
    row, near = r.state_edges[edge], TOGETHER * r.state_extent
    for end in range(2):
        along, square = end * row[6], 0.0
        for i in range(3):
            off = row[i] + along * row[3 + i] - corner[i]
            square += off * off
        if square <= near * near:
            return float(along)
    return -1.0


class Polyhedron(NamedTuple):
    """Kernels that look at all faces or edges of one.

    outward(record, out, point)            sum of the normals of the faces that meet at a point [-]
    passes(record, first, last) -> (it does, face, face, fraction, fraction)   whether a straight line passes through it
    between(record, first, second) -> edge   that two faces have in common, or -1
    met(record, point) -> bool             whether a point lies below all faces
    """

    outward: Callable[..., Any]
    passes: Callable[..., Any]
    between: Callable[..., Any]
    met: Callable[..., Any]


def make_polyhedron(faces: int, edges: int) -> Polyhedron:
    """The kernels for a body of so many faces and edges."""

    @kernel
    def outward(record: Any, out: Array, point: Array) -> None:
        """out = sum of the normals of the faces that meet at a point [-].

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        for i in range(3):
            out[i] = 0.0
        for f in range(faces):
            face = r.state_faces[f]
            if abs(dot(face[0:3], point) - face[3]) <= TOGETHER * r.state_extent:
                for i in range(3):
                    out[i] += face[i]

    @kernel
    def passes(record: Any, first: Array, last: Array) -> tuple[bool, int, int, float, float]:
        """Whether a straight line passes through the body, the faces by which it enters and leaves, and where.

        Returns (it does, face, face, fraction, fraction); a point within the body enters by the face that is nearest.

        Source   clipping by half-spaces: Cyrus and Beck, Computers and Graphics 3 (1978) 23
        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        begin, end, face_in, face_out = 0.0, 1.0, NONE, NONE
        nearest, height = 0, -math.inf
        depth = DEPTH * r.state_extent
        for f in range(faces):
            face = r.state_faces[f]
            above = dot(face[0:3], first) - face[3]
            slope = dot(face[0:3], last) - face[3] - above
            if above > height:
                nearest, height = f, above
            above += depth
            if slope < 0.0:
                where = -above / slope
                if where > begin:
                    begin, face_in = where, f
            elif slope > 0.0:
                where = -above / slope
                if where < end:
                    end, face_out = where, f
            elif above > 0.0:
                return False, NONE, NONE, 0.0, 0.0
        if face_in == NONE:
            face_in = nearest
        return bool(begin < end and face_out != NONE), face_in, face_out, begin, end

    @kernel
    def between(record: Any, first: int, second: int) -> int:
        """The edge between two faces, or -1.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        sides = record[0].state_sides
        for e in range(edges):
            if (sides[e][0] == first and sides[e][1] == second) or (sides[e][0] == second and sides[e][1] == first):
                return e
        return NONE

    @kernel
    def met(record: Any, point: Array) -> bool:
        """Whether the other body has come into this one, its attachment below all faces.

        Checked  tests/tethered_deorbit/test_wrapping.py: bodies that meet
        """
        r = record[0]
        for f in range(faces):
            face = r.state_faces[f]
            if dot(face[0:3], point) - face[3] >= 0.0:
                return False
        return True

    return Polyhedron(outward, passes, between, met)
