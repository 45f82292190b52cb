"""Convex bodies of which a union is made, for threads that bend round it: every piece is one, and a shell is several.

A body lies within its piece. A box is itself, round pieces are polyhedra as round targets are (`cylinder.faces_around`,
`sphere.faces`). A shell is what lies between chords of its outside and tangents of its inside, and each of its bodies
what of that lies beyond one of these tangents: they overlap, and its outside is one surface without joints. Shells that
stand flush on one another have the same chords.

Ways lie a little below the faces of a body. Where one body stands on another, a gap would be left between the two, into
which a thread could slip: a face that is covered by other bodies is moved out into them by as much as closes it, and
where both have faces in one plane beside it, to where the other ends.

Checked  tests/net_capture/test_union_wrapping.py, test_shell_wrapping.py
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from fmu_src.implied import formula
from fmu_src.net_capture.shapes import cylinder, sphere
from fmu_src.net_capture.shapes import pieces as of

Array = npt.NDArray[np.float64]

BODY = 6
"""Numbers of a body: where its faces begin, how many it has, middle and radius of a sphere around it [m]."""
FIRST, NUMBER, MIDDLE, RADIUS = 0, 1, 2, 5
INSET = 2e-3
"""Metres that a way lies below the surface: so one between two nodes of a face, which lie on it or a little below,
does not touch it, and no bend comes nearer to a node. An edge is as one rounded to 7 mm."""
SAGITTA, FLAT = 0.2, 0.009
"""Of a shell's thickness, and of its radius, by which a chord or a tangent may lie within it at most."""
STAYS = 1.5e-3
"""Metres by which a face moved out may stand out of what covers it, less than what ways lie below the surface."""
ROUNDED, ON = 1e-9, 1e-7
"""By which angles and places may seem to differ [rad], and corners and faces lie apart [m]."""
NEARLY = 0.02
"""Share of the way to its middle, from its corners and from between them, at which a face is looked at."""


class Body(NamedTuple):
    """Faces (n, 4), way out and distance along it, a point inside; faces that may be moved out, and of these which lie
    in a face of the piece; body axes [m]."""

    faces: Array
    inside: Array
    movable: npt.NDArray[np.int64]
    plane: Collection[int]


def chords_of(radius: float, thickness: float, angle: float) -> int:
    """How many chords the outside of a shell has."""
    sagitta = min(SAGITTA * thickness, FLAT * radius)
    return max(2, math.ceil(0.5 * angle / math.acos(1.0 - sagitta / radius)))


def faces_round(radius: float) -> int:
    """How many faces a round piece has round its axis."""
    return int(formula(cylinder.faces_round)(radius))


def _box(half: Array) -> Array:
    faces = np.zeros((6, 4))
    for face in range(6):
        faces[face, face // 2] = 1.0 if face % 2 == 0 else -1.0
        faces[face, 3] = half[face // 2]
    return faces


def _segments(radius: float, length: float, thickness: float, angle: float, count: int) -> list[tuple[Array, Array]]:
    """Faces of every body of a shell, and a point inside it, in the shell's axes: chords of the outside, a tangent of
    the inside, ends of the angle, ends of the axis.

    Each is what of the shell lies beyond one tangent of the inside, so they overlap, and join at the tangents alone.

    count      of the chords
    """
    inner, half = radius - thickness, 0.5 * angle / count
    gap = min(SAGITTA * thickness, FLAT * radius)
    tangents = max(1 if angle <= math.pi else 2, math.ceil(0.5 * angle / math.acos(inner / (inner + gap)) - ROUNDED))
    turns = angle * ((np.arange(count) + 0.5) / count - 0.5)
    chords = np.zeros((count, 4))
    chords[:, 0], chords[:, 1], chords[:, 3] = np.cos(turns), np.sin(turns), radius * math.cos(half)
    ends = np.array([[0.0, 0.0, 1.0, 0.5 * length], [0.0, 0.0, -1.0, 0.5 * length]])
    found = []
    for number in range(tangents):
        middle = angle * ((number + 0.5) / tangents - 0.5)
        out = np.array([math.cos(middle), math.sin(middle), 0.0])
        cuts = [np.array([*-out, -inner])]
        for sign in (-1.0, 1.0):
            edge = 0.5 * sign * angle
            side = np.array([-sign * math.sin(edge), sign * math.cos(edge), 0.0, 0.0])
            reaches = sign * middle + 0.5 * math.pi > 0.5 * angle + ROUNDED
            if angle < 2.0 * math.pi - ROUNDED and reaches and min(np.abs(side - cut).max() for cut in cuts) > ROUNDED:
                cuts.append(side)
        faces = np.vstack([chords, *cuts, ends])
        point = 0.5 * (inner + radius * math.cos(half)) * out
        corners = corners_of(faces, point)
        bounds = [(np.abs(corners @ face[:3] - face[3]) < ON).sum() > 2 for face in faces]
        found.append((faces[bounds], point))
    return found


def chords(rows: Array) -> list[int]:
    """How many chords the outside of each piece has that is a shell. Shells of one radius about one axis that
    begin and end at the same angles have as many, so that their faces lie in one plane.

    rows       pieces, see `union.WORDS`
    """

    def alike(one: Array, other: Array) -> bool:
        along, away = one[8:17].reshape(3, 3)[:, 2], other[5:8] - one[5:8]
        of_one = np.concatenate([one[[0, 1, 4]], one[8:17], away - (away @ along) * along])
        return bool(np.abs(of_one - np.concatenate([other[[0, 1, 4]], other[8:17], np.zeros(3)])).max() < ROUNDED)

    own = [chords_of(*(float(row[i]) for i in (1, 3, 4))) if int(row[0]) == of.SHELL else 0 for row in rows]
    return [max(number for number, other in zip(own, rows, strict=True) if alike(row, other)) for row in rows]


def bodies_of(row: Array, count: int) -> list[Body]:
    """The bodies of a piece, from its row of `union.WORDS`, and how many chords it has, see `chords`."""
    kind, place, turn = int(row[0]), row[5:8], row[8:17].reshape(3, 3)
    room, none = np.zeros((sphere.FACES, 4)), np.zeros(3)
    every: list[int] = list(range(6))
    if kind == of.BOX:
        own = [(_box(row[1:4]), none)]
    elif kind == of.SHELL:
        radius, length, thickness, angle = (float(x) for x in row[1:5])
        own = _segments(radius, length, thickness, angle, count)
    elif kind == of.SPHERE:
        count = formula(sphere.faces)(SimpleNamespace(target_radius=row[1]), room)
        own, every = [(room[:count], none)], []
    else:
        bottom, top, length = (row[1], row[1], row[2]) if kind == of.CYLINDER else row[1:4]
        around = faces_round(max(bottom, top))
        count = formula(cylinder.faces_around)(room, around, bottom, top, -0.5 * length, 0.5 * length)
        own, every = [(room[:count], none)], list(range(around, count))
    found = []
    for faces, inside in own:
        moved = np.empty_like(faces)
        moved[:, :3] = faces[:, :3] @ turn.T
        moved[:, 3] = faces[:, 3] + moved[:, :3] @ place
        plane = every
        if kind == of.SHELL:
            every = [n for n in range(len(faces)) if faces[n, 2] != 0.0 or abs(faces[n, 3]) < ROUNDED]
            plane = every[-2:]
        found.append(Body(moved, place + turn @ inside, np.array(every, dtype=np.int64), plane))
    return found


def corners_of(faces: Array, inside: Array) -> Array:
    """Corners of a body [m] (n, 3)."""
    from scipy.spatial import HalfspaceIntersection

    found = HalfspaceIntersection(np.column_stack([faces[:, :3], -faces[:, 3]]), inside).intersections
    return np.asarray(found[np.isfinite(found).all(axis=1)])


def _on(body: Body, faces: Array, face: int) -> Array:
    """Corners of a body on one of its faces [m] (n, 3), as these planes are."""
    corners = corners_of(faces, body.inside)
    return np.asarray(corners[np.abs(corners @ faces[face, :3] - faces[face, 3]) < ON])


def _within(body: Body, faces: Array, face: int, distance: Callable[[Array], float], stands: float) -> bool:
    """Whether a face of a body lies in the union, or stands out by so much at most [m]."""
    on = _on(body, faces, face)
    between = 0.5 * (on[:, None] + on[None]).reshape(-1, 3)
    return not any(distance(point) > stands for point in between + NEARLY * (on.mean(axis=0) - between))


def _goes_on(body: Body, faces: Array, face: int, others: Array, distance: Callable[[Array], float]) -> Array:
    """Faces of a body, one of which is moved out through the union to where another body ends that has a face in one
    plane with one beside it: so there is no joint.

    others     faces of all bodies
    """

    def of_others(normal: Array) -> Array:
        return np.asarray(others[others[:, :3] @ normal > 1.0 - ROUNDED, 3])

    on = _on(body, faces, face)
    beside = [k for k in range(len(faces)) if k != face and (np.abs(on @ faces[k, :3] - faces[k, 3]) < ON).sum() > 1]
    if not any((np.abs(of_others(faces[k, :3]) - faces[k, 3]) < ON).sum() > 1 for k in beside):
        return faces
    heights = of_others(faces[face, :3])
    for height in np.unique(heights[heights > faces[face, 3] + ON]):
        moved = faces.copy()
        for share in np.linspace(0.0, 1.0, 9)[1:]:
            moved[face, 3] = faces[face, 3] + share * (height - faces[face, 3])
            if not _within(body, moved, face, distance, ON):
                return faces
        faces = moved
    return faces


def _moved_out(body: Body, others: Array, distance: Callable[[Array], float]) -> tuple[Array, Array]:
    """Faces of a body, those that are covered moved out, and which are; `distance(point)` from the union [m].

    others     faces of all bodies
    """
    faces, covered = body.faces.copy(), np.zeros(len(body.faces))
    for face in body.movable:
        for _ in range(2):
            moved = faces.copy()
            moved[face, 3] += 2.0 * INSET if face in body.plane else INSET
            if not _within(body, moved, face, distance, STAYS):
                break
            farther = _goes_on(body, faces, face, others, distance)
            if farther is faces:
                faces, covered[face] = moved, 1.0
                break
            faces = farther
    return faces, covered


def bodies_and_planes(rows: Array, distance: Callable[[Array], float]) -> tuple[Array, Array]:
    """The bodies of a union (n, 6), see `BODY`, and all their faces (m, 5), body axes: way out, distance along it, and
    1 where it is covered.

    rows       its pieces, see `union.WORDS`
    distance   of a point from it [m]
    """
    bodies: list[list[float]] = []
    planes: list[Array] = []
    every = [body for row, count in zip(rows, chords(rows), strict=True) for body in bodies_of(row, count)]
    others = np.vstack([body.faces for body in every])
    for body in every:
        faces, covered = _moved_out(body, others, distance)
        corners = corners_of(faces, body.inside)
        middle = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
        radius = np.linalg.norm(corners - middle, axis=1).max()
        bodies.append([float(sum(len(each) for each in planes)), float(len(faces)), *middle, radius])
        planes.append(np.column_stack([faces, covered]))
    return np.array(bodies), np.vstack(planes)
