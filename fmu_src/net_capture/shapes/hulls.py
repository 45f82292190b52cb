"""Convex bodies of which a union is made, for threads that bend round it: every piece is one, and a shell is several.

A body lies within its piece. A box is itself, round pieces are polyhedra as round targets are (`cylinder.faces_around`,
`sphere.faces`), and the wall of a shell is cut into slabs along its axis, each of six plane faces: the outer one a
chord of the outside, the inner one a tangent of the inside.

Ways lie a little below the faces of a body. Where one body stands on another, a gap would be left between the two, into
which a thread could slip: a face that is covered by other bodies is moved out into them by as much as closes it.

Checked  tests/net_capture/test_union_wrapping.py
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
"""Of a shell's thickness, and of its radius, by which a slab may lie within it at most."""
STAYS = 1.5e-3
"""Metres by which a face moved out may stand out of what covers it, less than what ways lie below the surface."""
NEARLY = 0.02
"""Share of the way to its middle, from its corners and from between them, at which a face is looked at."""


class Body(NamedTuple):
    """Faces (n, 4), way out and distance along it, a point inside; faces that may be moved out, and of these which lie
    in a face of the piece; body axes [m]."""

    faces: Array
    inside: Array
    movable: npt.NDArray[np.int64]
    plane: Collection[int]


def slabs(radius: float, thickness: float, angle: float) -> int:
    """How many slabs a shell is cut into."""
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


def _slabs(radius: float, length: float, thickness: float, angle: float) -> list[tuple[Array, Array]]:
    """Faces of every slab, and a point inside it, in the shell's axes: outer, inner, sides, ends."""
    count = slabs(radius, thickness, angle)
    half = 0.5 * angle / count
    found = []
    for number in range(count):
        middle = angle * ((number + 0.5) / count - 0.5)
        out = np.array([math.cos(middle), math.sin(middle), 0.0])
        faces = np.zeros((6, 4))
        faces[0] = *out, radius * math.cos(half)
        faces[1] = *-out, thickness - radius
        for side, sign in ((2, -1.0), (3, 1.0)):
            edge = middle + sign * half
            faces[side, :2] = -sign * math.sin(edge), sign * math.cos(edge)
        faces[4] = 0.0, 0.0, 1.0, 0.5 * length
        faces[5] = 0.0, 0.0, -1.0, 0.5 * length
        found.append((faces, (radius - 0.5 * thickness) * out))
    return found


def bodies_of(row: Array) -> list[Body]:
    """The bodies of a piece, from its row of `union.WORDS`."""
    kind, place, turn = int(row[0]), row[5:8], row[8:17].reshape(3, 3)
    room, none = np.zeros((sphere.FACES, 4)), np.zeros(3)
    every: list[int] = list(range(6))
    if kind == of.BOX:
        own = [(_box(row[1:4]), none)]
    elif kind == of.SHELL:
        own = _slabs(*(float(x) for x in row[1:5]))
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
        plane = every[4:] if kind == of.SHELL else every
        found.append(Body(moved, place + turn @ inside, np.array(every, dtype=np.int64), plane))
    return found


def corners_of(faces: Array, inside: Array) -> Array:
    """Corners of a body [m] (n, 3)."""
    from scipy.spatial import HalfspaceIntersection

    found = HalfspaceIntersection(np.column_stack([faces[:, :3], -faces[:, 3]]), inside).intersections
    return np.asarray(found[np.isfinite(found).all(axis=1)])


def _moved_out(body: Body, distance: Callable[[Array], float]) -> tuple[Array, Array]:
    """Faces of a body, those that are covered moved out, and which are; `distance(point)` from the union [m]."""
    faces, covered = body.faces.copy(), np.zeros(len(body.faces))
    for face in body.movable:
        moved = faces.copy()
        moved[face, 3] += 2.0 * INSET if face in body.plane else INSET
        corners = corners_of(moved, body.inside)
        on = corners[np.abs(corners @ moved[face, :3] - moved[face, 3]) < 1e-7]
        between = 0.5 * (on[:, None] + on[None]).reshape(-1, 3)
        within = between + NEARLY * (on.mean(axis=0) - between)
        if not any(distance(point) > STAYS for point in within):
            faces, covered[face] = moved, 1.0
    return faces, covered


def bodies_and_planes(rows: Array, distance: Callable[[Array], float]) -> tuple[Array, Array]:
    """The bodies of a union (n, 6), see `BODY`, and all their faces (m, 5), body axes: way out, distance along it, and
    1 where it is covered.

    rows       its pieces, see `union.WORDS`
    distance   of a point from it [m]
    """
    bodies: list[list[float]] = []
    planes: list[Array] = []
    for body in (body for row in rows for body in bodies_of(row)):
        faces, covered = _moved_out(body, distance)
        corners = corners_of(faces, body.inside)
        middle = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
        radius = np.linalg.norm(corners - middle, axis=1).max()
        bodies.append([float(sum(len(each) for each in planes)), float(len(faces)), *middle, radius])
        planes.append(np.column_stack([faces, covered]))
    return np.array(bodies), np.vstack(planes)
