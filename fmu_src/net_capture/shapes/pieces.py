"""Pieces of which a union is made: what a scene says of each, its mass, its points, and how it is drawn.

A piece is given in axes of its own, from the middle of its box: round ones about the third axis, a shell from the first
axis to both sides. A row of numbers says one, `ROW` of them:

    kind, four sizes [m], [rad]; mass [kg]; position [m] and attitude of its own axes in the design axes, scalar first

Where any of them swings about a hinge one more says whether each does, 1 or 0.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from fmu_src.implied import formula
from fmu_src.interface import Variable
from fmu_src.net_capture.shapes import Point, cylinder, frustum, sphere
from fmu_src.net_capture.shapes.shell import shell_center, shell_squares
from fmu_src.rows import choice, parameter, positive, vector

Array = npt.NDArray[np.float64]

BOX, CYLINDER, SPHERE, FRUSTUM, SHELL = range(5)
ROW = 13
KINDS = ("box", "cylinder", "sphere", "frustum", "shell")
SIZES: tuple[tuple[str, ...], ...] = (
    ("size[1]", "size[2]", "size[3]"),
    ("radius", "length"),
    ("radius",),
    ("radius_bottom", "radius_top", "length"),
    ("radius", "length", "thickness", "angle"),
)
"""What says the sizes of each kind, in the order of its row."""
ENTRY: tuple[Variable, ...] = (
    choice("shape", "shape of the piece; a shell is a piece of a tube, as of a fairing", KINDS),
    vector("size", "m", "edges of a box, each above 0", "parameter", (1.0, 1.0, 1.0)),
    positive("radius", "m", "of a cylinder, a sphere, or a shell's outside", 1.0),
    parameter("radius_bottom", "m", "of a frustum at the lower end of its third axis", 1.0, 0.0),
    parameter("radius_top", "m", "of a frustum at the upper end of its third axis", 0.5, 0.0),
    positive("length", "m", "of a round piece along its third axis", 1.0),
    positive("thickness", "m", "of a shell's wall", 0.05),
    positive("angle", "rad", "of a shell about its third axis, from its first axis to both sides", math.pi,
             2.0 * math.pi, display_unit="deg"),
    positive("mass", "kg", "of the piece, evenly spread", 100.0),
    positive("density", "kg/m3", "of the piece, in the place of its mass", 100.0),
    vector("position", "m", "of its middle in the design axes", "parameter"),
    parameter("attitude[#]", "1", "quaternion from its axes to the design axes, scalar first; zero: aligned", 0.0,
              shape=(4,)),
    Variable("hinged", "1", "parameter", "whether it is part of the appendage that swings: [capture.hinge]", False,
             kind="Boolean"),
)  # fmt: skip
"""What a scene may say of a piece."""
ROUND, TALL = 96, 24
"""Points on a circle of what spans a piece, and circles of a sphere."""
STEPS = (-0.98, -0.8, -0.4, 0.0, 0.4, 0.8, 0.98)
"""Points along each half edge of the box round a piece, of which those inside it count."""


class Piece(NamedTuple):
    """A piece, with the matrix from its axes to the design axes."""

    kind: int
    sizes: Sequence[float]
    mass: float
    place: Array
    turn: Array


def gather(entries: Sequence[Mapping[str, Any]]) -> list[list[float]]:
    """Rows of pieces from what a scene says of them, SI; ValueError with the number of the piece at fault."""
    rows = [_row(f"piece {place}", entry) for place, entry in enumerate(entries, 1)]
    if any(entry.get("hinged", False) for entry in entries):
        for row, entry in zip(rows, entries, strict=True):
            row.append(float(entry.get("hinged", False)))
    return rows


def _row(name: str, entry: Mapping[str, Any]) -> list[float]:
    if "shape" not in entry:
        raise ValueError(f"{name} has no shape: expected one of {', '.join(KINDS)}")
    kind = int(entry["shape"])
    wanted = list(dict.fromkeys(key.partition("[")[0] for key in SIZES[kind]))
    called = f"{name}, a {KINDS[kind]},"
    for key in entry:
        if key not in (*wanted, "shape", "mass", "density", "position", "attitude", "hinged"):
            raise ValueError(f"{called} has no {key}; expected {', '.join(wanted)}")
    optional = ("angle",)
    for key in wanted:
        if key not in entry and key not in optional:
            raise ValueError(f"{called} lacks its {key}; expected {', '.join(wanted)}")
    if ("mass" in entry) == ("density" in entry):
        said = "both mass and density" if "mass" in entry else "no mass or density"
        raise ValueError(f"{called} has {said}: expected one of them")
    sizes = [float(x) for x in np.ravel([entry.get(key, math.pi) for key in wanted])]
    _check(called, kind, sizes)
    attitude = np.array(entry.get("attitude", [0.0] * 4), dtype=float)
    squared = float(attitude @ attitude)
    if squared == 0.0:
        attitude[0] = squared = 1.0
    if not abs(squared - 1.0) <= 1e-6:
        raise ValueError(f"{called} has an attitude of length {math.sqrt(squared):.6g}: expected a unit quaternion")
    mass = entry["mass"] if "mass" in entry else entry["density"] * volume(kind, sizes)
    sizes += [0.0] * (4 - len(sizes))
    place = entry.get("position", [0.0] * 3)
    return [float(kind), *sizes, float(mass), *map(float, place), *(attitude / math.sqrt(squared))]


def _check(called: str, kind: int, sizes: Sequence[float]) -> None:
    if min(sizes) <= 0.0 and kind == BOX:
        raise ValueError(f"{called} has size {sizes} m: each must be greater than 0")
    if kind == FRUSTUM and sizes[0] == sizes[1] == 0.0:
        raise ValueError(f"{called} has two radii of 0 m: one must be greater")
    if kind == SHELL and sizes[2] >= sizes[0]:
        raise ValueError(f"{called} has a thickness of {sizes[2]:g} m: must be less than its radius, {sizes[0]:g} m")


def pieces(rows: Array) -> list[Piece]:
    """The pieces that rows say."""
    found = []
    for row in rows:
        w, x, y, z = row[9:13]
        turn = np.array([
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ])  # fmt: skip
        found.append(Piece(int(row[0]), [float(x) for x in row[1:5]], float(row[5]), row[6:9], turn))
    return found


def volume(kind: int, sizes: Sequence[float]) -> float:
    """Volume of a piece [m3]."""
    if kind == BOX:
        return math.prod(sizes[:3])
    if kind == SPHERE:
        return 4.0 / 3.0 * math.pi * sizes[0] ** 3
    if kind == CYLINDER:
        return math.pi * sizes[0] ** 2 * sizes[1]
    if kind == FRUSTUM:
        bottom, top, length = sizes[:3]
        return math.pi / 3.0 * length * (bottom * bottom + bottom * top + top * top)
    radius, length, thickness, angle = sizes
    return 0.5 * angle * length * thickness * (2.0 * radius - thickness)


def mass_of(piece: Piece) -> tuple[Array, Array]:
    """Centre of mass of a piece [m], and its inertia about it [kg m2], along the design axes."""
    center, moments, s = np.zeros(3), np.zeros(3), piece.sizes
    if piece.kind == BOX:
        moments[:] = [(s[(i + 1) % 3] ** 2 + s[(i + 2) % 3] ** 2) / 12.0 for i in range(3)]
    elif piece.kind == SPHERE:
        moments[:] = 0.4 * s[0] * s[0]
    elif piece.kind == SHELL:
        center[0] = shell_center(*s)
        x, y, z = shell_squares(*s)
        moments[:] = y + z, x + z, x + y
    else:
        bottom, top, length = (s[0], s[0], s[1]) if piece.kind == CYLINDER else s[:3]
        center[2] = formula(frustum.frustum_center)(bottom, top, length)
        formula(frustum.frustum_inertia)(moments, 1.0, bottom, top, length)
    return piece.place + piece.turn @ center, piece.mass * piece.turn @ np.diag(moments) @ piece.turn.T


def half_of(piece: Piece) -> Array:
    """Half the edges of the box round a piece, along its own axes [m]."""
    s = piece.sizes
    if piece.kind == BOX:
        return 0.5 * np.array(s[:3])
    if piece.kind == SPHERE:
        return np.full(3, s[0])
    radius = max(s[0], s[1]) if piece.kind == FRUSTUM else s[0]
    return np.array([radius, radius, 0.5 * (s[2] if piece.kind == FRUSTUM else s[1])])


def thickness_of(piece: Piece) -> float:
    """Least thickness of a piece [m]: the wall of a shell, else the least edge of its box."""
    return piece.sizes[2] if piece.kind == SHELL else 2.0 * float(half_of(piece).min())


def filling(piece: Piece) -> Array:
    """Points of a piece's own box in even rows, (n, 3) [m], design axes; for a shell they follow its wall."""
    grid = np.array(list(itertools.product(STEPS, repeat=3)))
    if piece.kind == SHELL:
        radius, length, thickness, angle = piece.sizes
        away, turn = radius - 0.5 * thickness * (1.0 - grid[:, 0]), 0.5 * angle * grid[:, 1]
        own = np.column_stack([away * np.cos(turn), away * np.sin(turn), 0.5 * length * grid[:, 2]])
    else:
        own = grid * half_of(piece)
    moved: Array = piece.place + own @ piece.turn.T
    return moved


def spanning(piece: Piece, around: bool) -> Array:
    """Points whose hull is that of a piece, or, where it is round, lies in it or around it, (n, 3) [m], design axes."""
    s, turns = piece.sizes, 2.0 * math.pi * np.arange(ROUND) / ROUND
    wider = 1.0 / math.cos(math.pi / ROUND) if around else 1.0
    if piece.kind == BOX:
        own = 0.5 * np.array(list(itertools.product(*([-edge, edge] for edge in s[:3]))))
    elif piece.kind == SPHERE:
        tilts = math.pi * (np.arange(TALL + 1) / TALL - 0.5)
        wider = wider / math.cos(0.5 * math.pi / TALL) if around else 1.0
        own = np.array([
            [math.cos(b) * math.cos(a), math.cos(b) * math.sin(a), math.sin(b)] for b in tilts for a in turns[::2]
        ]) * s[0] * wider  # fmt: skip
    else:
        bottom, top, length = s[:3] if piece.kind == FRUSTUM else (s[0], s[0], s[1])
        if piece.kind == SHELL:
            turns = s[3] * (np.arange(ROUND + 1) / ROUND - 0.5)
        circle = wider * np.column_stack([np.cos(turns), np.sin(turns)])
        flat = [(bottom * circle, -0.5 * length), (top * circle, 0.5 * length)]
        if piece.kind == SHELL:
            inner = (1.0 - s[2] / s[0]) * bottom * circle[[0, -1]] / wider
            flat += [(inner, -0.5 * length), (inner, 0.5 * length)]
        own = np.vstack([np.column_stack([xy, np.full(len(xy), z)]) for xy, z in flat])
    moved: Array = piece.place + own @ piece.turn.T
    return moved


def drawn(piece: Piece) -> tuple[list[Point], list[list[int]]]:
    """Corners of a piece [m], design axes, and faces, to draw it by."""
    s = piece.sizes
    if piece.kind == BOX:
        corners: Any = 0.5 * np.array(list(itertools.product(*([-edge, edge] for edge in s[:3]))))
        faces = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]]
    elif piece.kind == SPHERE:
        corners, faces = sphere.drawn(s[0])
    elif piece.kind == SHELL:
        corners, faces = _shell(*s)
    else:
        bottom, top, length = (s[0], s[0], s[1]) if piece.kind == CYLINDER else s[:3]
        corners, faces = frustum.drawn(bottom, top, length, 0.0)
    return list(piece.place + np.array(corners) @ piece.turn.T), faces


def _shell(radius: float, length: float, thickness: float, angle: float) -> tuple[list[Point], list[list[int]]]:
    """A shell's wall from both sides, its ends and its edges."""
    n = cylinder.DRAWN_AROUND
    turns = [angle * (i / n - 0.5) for i in range(n + 1)]
    rings = [(r, z) for r in (radius, radius - thickness) for z in (-0.5 * length, 0.5 * length)]
    corners: list[Point] = [[r * math.cos(a), r * math.sin(a), z] for r, z in rings for a in turns]
    low, high, low_in, high_in = (k * (n + 1) for k in range(4))
    faces = []
    for i in range(n):
        for one, two in ((low, high), (low_in, high_in), (low, low_in), (high, high_in)):
            faces.append([one + i, one + i + 1, two + i + 1, two + i])
    faces += [[low + i, high + i, high_in + i, low_in + i] for i in (0, n)]
    return corners, faces
