"""The union of pieces: boxes, cylinders, spheres, frusta and shells, each with its mass, place and attitude.

Outside, the distance from it is the least of the distances from its pieces, exactly. Inside, the depth in the piece
that the point is deepest in is a lower bound: where pieces overlap, faces that lie within another piece count for it.
Where faces of two pieces lie on one another contact goes by the faces around that seam (`contact_distance`).
Masses add, also where pieces overlap. It moves about its principal axes, see `solids`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from fmu_src.implied import formula
from fmu_src.interface import Laid, Term, Undesigned
from fmu_src.net_capture.shapes import Checks, Hulls, Point, Shape, Values, hulls, samples, solids
from fmu_src.net_capture.shapes import pieces as of
from fmu_src.net_capture.shapes.box import box_distance
from fmu_src.net_capture.shapes.cylinder import cylinder_distance
from fmu_src.net_capture.shapes.frustum import frustum_distance
from fmu_src.net_capture.shapes.nearest import NOT_ASKED, close_round, make_touched
from fmu_src.net_capture.shapes.shell import shell_distance
from fmu_src.net_capture.shapes.sphere import sphere_distance
from fmu_src.rows import state
from fmu_src.tables import Table
from orbital.kernel import kernel
from orbital.vectors import dot

PARTS, PIECES = "target.parts", "target.pieces"
BODIES, PLANES = "target.bodies", "target.planes"
HINGED = "hinge.stiffness"
"""A value that only scenes have whose target is hinged."""
WORDS = 18
"""Numbers of a piece in the FMU: kind, four sizes (of a box half its edges), place of its middle, matrix from its axes
to the body's by rows, and radius of the sphere about its middle."""
NEAR = 1e-6
"""Distance from the surface, as a share of the body's radius, within which a point lies on it."""
SLIT = 1e-6
"""Metres between two pieces that are no way out of them: their faces lie on one another."""
LOOK, LOOKS, WIDER = 1e-4, 7, 4.0
"""Metres to both sides of a seam at which its other faces are first looked for; how often, and by how much farther each
time: as deep as a node may come in within a substep."""
ALIKE = 1e-6
"""Square of the sine of the angle between faces that have no edge."""


@kernel
def piece_distance(row, normal, local):
    """Signed distance [m] of a point from a piece, and outward normal, in the piece's axes.

    Checked  tests/net_capture/test_pieces.py
    """
    kind = row[0]
    if kind == 0.0:
        return box_distance(normal, local, row[1:4])
    if kind == 1.0:
        return cylinder_distance(normal, local, row[1], 0.5 * row[2])
    if kind == 2.0:
        return sphere_distance(normal, local, row[1])
    if kind == 3.0:
        return frustum_distance(normal, local, row[1], row[2], row[3])
    return shell_distance(normal, local, row[1], row[2], row[3], row[4])


@kernel
def union_distance(rows, normal, own, local, point):
    """Signed distance [m] of a point from a union, negative inside; outward normal into `normal`.

        min over the pieces

    rows         its pieces, see `WORDS`                       (n, 18)
    point        in body axes                             [m]  (3,)
    normal       unit vector, body axes                   [1]  (3,)
    own, local   room for vectors                              (3,)

    Valid    exact outside; inside a lower bound of the depth, exact where the nearest face lies in no other piece
    Checked  tests/net_capture/test_pieces.py
    """
    nearest = math.inf
    for k in range(rows.shape[0]):
        row = rows[k]
        x = point[0] - row[5]
        y = point[1] - row[6]
        z = point[2] - row[7]
        if math.sqrt(x * x + y * y + z * z) - row[17] >= nearest:
            continue
        for i in range(3):
            local[i] = row[8 + i] * x + row[11 + i] * y + row[14 + i] * z
        distance = piece_distance(row, own, local)
        if distance < nearest:
            nearest = distance
            for i in range(3):
                normal[i] = row[8 + 3 * i] * own[0] + row[9 + 3 * i] * own[1] + row[10 + 3 * i] * own[2]
    return nearest


@kernel
def contact_distance(rows, room, normal, point):
    """Signed distance [m] of a point from a union as what touches it asks, negative inside; outward normal into
    `normal`.

    That of `union_distance`, but where the nearest face is covered by another piece it is no way out: a point at a seam
    has no depth in either piece, and would be pushed along it. From its foot on that face it is looked to both sides,
    ever farther, for another face over which it goes out: one that meets this one at an edge in the open. Its depth is
    then that of the foot below the plane of this face, if that is more.

        d' = d(f + s n) - s n . n',   f the foot, n and n' both normals, s what it is looked aside

    rows         its pieces, see `WORDS`                       (n, 18)
    room         for vectors                                   (6, 3)
    normal       unit vector, body axes                   [1]  (3,)
    point        in body axes                             [m]  (3,)

    Valid    faces that lie on one another, to `SLIT`; pieces that touch in a line or a point have no such face
    Checked  tests/net_capture/test_seams.py
    """
    own, local, foot, aside, other, spare = room[0], room[1], room[2], room[3], room[4], room[5]
    found = union_distance(rows, normal, own, local, point)
    if found > SLIT:
        return found
    for i in range(3):
        foot[i] = point[i] - found * normal[i]
        aside[i] = foot[i] + SLIT * normal[i]
    if union_distance(rows, spare, own, local, aside) > 0.5 * SLIT:
        return found
    look = LOOK
    for _ in range(LOOKS):
        for side in range(2):
            away = look if side == 0 else -look
            for i in range(3):
                aside[i] = foot[i] + away * normal[i]
            depth = union_distance(rows, other, own, local, aside)
            alike = dot(normal, other)
            depth -= away * alike
            across = 1.0 - alike * alike
            if depth < 0.0 and across > ALIKE:
                open_to = -1.0
                for way in range(2):
                    for i in range(3):
                        corner = foot[i] - depth / across * (other[i] - alike * normal[i])
                        aside[i] = corner + SLIT * (other[i] + (1 - 2 * way) * normal[i])
                    open_to = max(open_to, union_distance(rows, spare, own, local, aside))
                if open_to > 0.5 * SLIT:
                    if depth < found:
                        found = depth
                        for i in range(3):
                            normal[i] = other[i]
                    return found
        look *= WIDER
    return found


def swinging(rows: np.ndarray) -> np.ndarray:
    """Which pieces a scene calls hinged, (n,)."""
    found: np.ndarray = rows[:, of.ROW] != 0.0 if rows.shape[1] > of.ROW else np.zeros(len(rows), dtype=bool)
    return found


def make(composition: Any) -> Shape:
    """Kernels of a union."""
    pieces_of = composition.table(PIECES)

    @kernel
    def plain_distance(p, normal, point):
        """Signed distance [m] and outward normal, see `union_distance`.

        Checked  tests/net_capture/test_pieces.py
        """
        return union_distance(pieces_of(p), normal, p.piece_room[0], p.piece_room[1], point)

    @kernel
    def distance(p, normal, point):
        """Signed distance [m] and outward normal, see `contact_distance`.

        Checked  tests/net_capture/test_seams.py
        """
        return contact_distance(pieces_of(p), p.piece_room, normal, point)

    @kernel
    def distance_now(p, normal, point):
        """The same of pieces some of which swing, as they are now; what `touched` needs of it is noted, since that is
        asked of few points.

        Checked  tests/net_capture/test_hinge.py
        """
        found = contact_distance(p.hinge_rows[0 : pieces_of(p).shape[0]], p.piece_room, normal, point)
        p.hinge_touched = NOT_ASKED
        p.hinge_gap = found
        for i in range(3):
            p.hinge_found[0, i] = normal[i]
            p.hinge_found[1, i] = point[i]
        return found

    solid = samples.make_solid(composition, plain_distance)._replace(distance=distance)
    if "hinge" in composition.terms:
        return solid._replace(
            distance=distance_now, swings=make_touched(pieces_of, piece_distance), close_round=close_round
        )
    if "wrap" not in composition.terms:
        return solid
    return solid._replace(hulls=Hulls(composition.table(BODIES), composition.table(PLANES)))


def body_of(rows: np.ndarray) -> solids.Solid:
    """Mass, centre of mass and inertia of pieces together, by the theorem of parallel axes.

    Checked  tests/net_capture/test_pieces.py
    """
    found = [(piece.mass, *of.mass_of(piece)) for piece in of.pieces(rows)]
    mass = sum(each for each, _, _ in found)
    center = np.sum([each * place for each, place, _ in found], axis=0) / mass
    tensor = np.zeros((3, 3))
    for each, place, own in found:
        d = place - center
        tensor += own + each * (float(d @ d) * np.eye(3) - np.outer(d, d))
    return solids.solid_of(mass, center, tensor)


def pieces_table(pieces: Sequence[of.Piece], body: solids.Solid) -> np.ndarray:
    """The table `pieces`, in body axes."""
    found = np.empty((len(pieces), WORDS))
    for row, piece in zip(found, pieces, strict=True):
        half = of.half_of(piece)
        row[0], row[1:5] = piece.kind, piece.sizes
        if piece.kind == of.BOX:
            row[1:4] = half
        row[5:8] = body.to_body(piece.place)
        row[8:17] = (body.turn.T @ piece.turn).ravel()
        row[17] = np.linalg.norm(half)
    return found


@lru_cache(maxsize=8)
def _bodies(content: bytes) -> tuple[np.ndarray, np.ndarray]:
    rows, (normal, own, local) = np.frombuffer(content).reshape(-1, WORDS), np.empty((3, 3))
    away = formula(union_distance)
    return hulls.bodies_and_planes(rows, lambda point: float(away(rows, normal, own, local, point)))


def bodies(numbers: Mapping[str, np.ndarray]) -> np.ndarray:
    """The table `bodies`."""
    return _bodies(numbers[PIECES].tobytes())[0]


def planes(numbers: Mapping[str, np.ndarray]) -> np.ndarray:
    """The table `planes`."""
    return _bodies(numbers[PIECES].tobytes())[1]


def lay(values: Mapping[str, float], sources: Mapping[str, np.ndarray]) -> Laid:
    """Tables of the FMU, and the mass, from what a scene says of the pieces; those of a hinge as at angle 0."""
    rows = sources[PARTS]
    if HINGED not in values and swinging(rows).any():
        number = 1 + int(np.argmax(swinging(rows)))
        expected = f"piece {number} says `hinged = true`, which needs the table [capture.hinge]"
        raise Undesigned("target.parts", f"{len(rows)} pieces", expected)
    return _laid(np.ascontiguousarray(rows[:, : of.ROW]).tobytes())


@lru_cache(maxsize=8)
def _laid(content: bytes) -> Laid:
    rows = np.frombuffer(content).reshape(-1, of.ROW)
    body, found = body_of(rows), of.pieces(rows)
    inner, outer = (
        body.to_body(np.vstack([of.spanning(piece, around) for piece in found])) for around in (False, True)
    )
    solid = solids.table(body, inner, outer, min(of.thickness_of(piece) for piece in found))
    table = pieces_table(found, body)
    points = body.to_body(np.vstack([of.filling(piece) for piece in found]))
    normals, room, distance = np.empty_like(points), np.empty((2, 3)), formula(union_distance)

    def depth(at: np.ndarray) -> np.ndarray:
        pairs = zip(normals, at, strict=False)
        return np.array([-distance(table, normal, room[0], room[1], point) for normal, point in pairs])

    depths = depth(points)
    out = points + depths[:, None] * normals
    near = NEAR * solid[solids.RADIUS]
    piece = np.repeat(np.arange(len(found)), len(points) // len(found))
    inside = depths > near
    on = inside & (np.abs(depth(out)) < near)

    def leads(start: int) -> np.ndarray:
        return np.asarray(piece[inside] == piece[on][start])

    tables = {
        PIECES: table,
        "target.solid": solid,
        "target.samples": solids.samples(points[inside], depth, out[on], leads),
    }
    return Laid(tables, {"target.mass": body.mass})


def _distance(values: Values, point: Point) -> float:
    normal, own, local = np.empty((3, 3))
    return float(formula(union_distance)(values[PIECES], normal, own, local, point))


def in_body_axes(rows: np.ndarray) -> Iterator[of.Piece]:
    """Pieces in body axes, from the FMU's table; their masses are not in it."""
    for row in rows:
        kind = int(row[0])
        sizes = 2.0 * row[1:5] if kind == of.BOX else row[1:5]
        yield of.Piece(kind, [float(x) for x in sizes], 0.0, row[5:8], row[8:17].reshape(3, 3))


def _surface(values: Values) -> tuple[list[Point], list[list[int]]]:
    """Of every piece, whole."""
    corners: list[Point] = []
    faces: list[list[int]] = []
    for piece in in_body_axes(values[PIECES]):
        own, sides = of.drawn(piece)
        faces += [[len(corners) + number for number in side] for side in sides]
        corners += own
    return corners, faces


CHECKS = Checks(
    lambda values: list(values["target.solid"][solids.HALF : solids.RADIUS]),
    lambda values: float(values["target.solid"][solids.RADIUS]),
    lambda values: float(values["target.solid"][solids.GIRTH]),
    _distance,
    _surface,
    lambda values: [float(x) for x in values["target.solid"][solids.TURN : solids.CENTER]],
)

PART = Term(
    "union of boxes, cylinders, spheres, frusta and shells",
    (
        state("piece_room[#][#]", "1", "vectors of the distance from pieces", shape=(6, 3)),
        *samples.ROWS,
    ),
    tables=(Table(PIECES, "1", "pieces of the target in its body axes", dimensions=2), *samples.TABLES),
    sources=(
        Table(
            PARTS,
            "1",
            "pieces of the target: shape, sizes, mass or density, position and attitude in its design axes",
            dimensions=2,
            entry=of.ENTRY,
            gather=of.gather,
        ),
    ),
    lay=lay,
    follows=("target.mass",),
    make=make,
    checks=CHECKS,
)

BESIDE = ("target", "union")
FOR_THREADS = (
    Table(
        BODIES,
        "1",
        "convex bodies that it is made of: their faces, and a sphere round each",
        dimensions=2,
        made=bodies,
        beside=BESIDE,
    ),
    Table(
        PLANES,
        "1",
        "faces of these, body axes: way out, distance along it, whether covered",
        dimensions=2,
        made=planes,
        beside=BESIDE,
    ),
)
"""Of threads that bend round it; without these it has none of them."""
