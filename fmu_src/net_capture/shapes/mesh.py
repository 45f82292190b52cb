"""Any closed mesh: its signed distance on a grid, in the FMU's tables, between whose points it is interpolated.

The grid stands in the body axes, which are principal; see `solids`. The body's box is a whole number of cells along
each of them. Its error is that of the interpolation: none on a plane, of the order of the cell's square times the
curvature where the body is round, and of a fraction of a cell at its edges and corners, which it rounds, unless its
planes lie in the faces beside them, as in those of a box. It is measured from points of the body's surface.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from fmu_src.implied import Implied, formula
from fmu_src.interface import Laid, Term, Undesigned
from fmu_src.net_capture.shapes import Checks, Point, Shape, Values, samples, solids, triangles
from fmu_src.rows import positive
from fmu_src.tables import Table
from orbital.kernel import kernel

Array = npt.NDArray[np.float64]

MESH, GRID, LATTICE, FACES = "target.mesh", "target.grid", "target.lattice", "target.faces"
ERROR = 6
"""Where the table of the lattice has the grid's error."""
MARGIN = 2
"""Cells of the grid beyond the body."""
WHOLE = 1e-6
"""Share of a cell by which the body may be longer than a whole number of them."""
MOST = 4_000_000
"""Points of the largest grid: 32 MB."""
SMALLEST, LARGEST = 0.01, 500.0
"""Size of a target [m] outside which the file's unit is taken for wrong."""
THIN = 0.05
"""Share of the surface that may lie on thinner walls than the least thickness that is told."""
CELLS = 2.0
"""Cells that have to lie across it."""
LOOKED_AT = 3000
"""Points inside from which sample points are led to, and points of the surface from which that of the grid may be
farthest."""
BESIDE, LED = 1e-3, 12
"""Share of a cell to both sides over which a gradient is taken, and steps along it to the grid's surface."""
ROUND_BALL = 2.5
"""Way to such a point from the surface, over its depth, up to which it lies in the same part of the body."""


@kernel
def grid_distance(grid, lattice, normal, point):
    """Signed distance [m] of a point by a grid, negative inside; outward normal into `normal`.

    Trilinear between the eight points of its cell; the normal is the gradient of that, made a unit vector. Beyond the
    grid, the distance from the nearest point of the surface as the grid's edge sees it.

    grid         signed distances                          [m]  (k, l, m)
    lattice      lowest corner, and edges of a cell        [m]  (6,) or more
    point        in body axes                              [m]  (3,)
    normal       unit vector, body axes                    [1]  (3,)

    Valid    within the error that `lay` measures; where the gradient vanishes, the first body axis
    Checked  tests/net_capture/test_mesh.py
    """
    x = (point[0] - lattice[0]) / lattice[3]
    y = (point[1] - lattice[1]) / lattice[4]
    z = (point[2] - lattice[2]) / lattice[5]
    u = min(max(x, 0.0), grid.shape[0] - 1.0)
    v = min(max(y, 0.0), grid.shape[1] - 1.0)
    w = min(max(z, 0.0), grid.shape[2] - 1.0)
    i = min(int(u), grid.shape[0] - 2)
    j = min(int(v), grid.shape[1] - 2)
    k = min(int(w), grid.shape[2] - 2)
    u -= i
    v -= j
    w -= k
    a, b = grid[i, j, k], grid[i + 1, j, k]
    c, d = grid[i, j + 1, k], grid[i + 1, j + 1, k]
    e, f = grid[i, j, k + 1], grid[i + 1, j, k + 1]
    g, h = grid[i, j + 1, k + 1], grid[i + 1, j + 1, k + 1]
    low = (1.0 - v) * ((1.0 - u) * a + u * b) + v * ((1.0 - u) * c + u * d)
    high = (1.0 - v) * ((1.0 - u) * e + u * f) + v * ((1.0 - u) * g + u * h)
    distance = (1.0 - w) * low + w * high
    normal[0] = (1.0 - w) * ((1.0 - v) * (b - a) + v * (d - c)) + w * ((1.0 - v) * (f - e) + v * (h - g))
    normal[1] = (1.0 - w) * ((1.0 - u) * (c - a) + u * (d - b)) + w * ((1.0 - u) * (g - e) + u * (h - f))
    normal[1] *= lattice[3] / lattice[4]
    normal[2] = (high - low) * (lattice[3] / lattice[5])
    length = math.sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2])
    for axis in range(3):
        normal[axis] = normal[axis] / length if length > 0.0 else (1.0 if axis == 0 else 0.0)
    x = lattice[3] * (x - i - u)
    y = lattice[4] * (y - j - v)
    z = lattice[5] * (z - k - w)
    if x == 0.0 and y == 0.0 and z == 0.0:
        return distance
    x += distance * normal[0]
    y += distance * normal[1]
    z += distance * normal[2]
    distance = math.sqrt(x * x + y * y + z * z)
    normal[0] = x / distance
    normal[1] = y / distance
    normal[2] = z / distance
    return distance


def make(composition: Any) -> Shape:
    """Kernels of a mesh."""
    grid_of, lattice_of = composition.table(GRID), composition.table(LATTICE)

    @kernel
    def distance(p, normal, point):
        """Signed distance [m] and outward normal, see `grid_distance`.

        Checked  tests/net_capture/test_mesh.py
        """
        return grid_distance(grid_of(p), lattice_of(p), normal, point)

    return samples.make_solid(composition, distance)


def lay(values: Mapping[str, float], sources: Mapping[str, Array]) -> Laid:
    """Tables of the FMU from the triangles of a file."""
    corners = sources[MESH]
    return _laid(_Content(corners), values["target.mesh_unit"], values["target.resolution"])


class _Content:
    """Numbers that are the same where their bits are."""

    def __init__(self, numbers: Array) -> None:
        self.numbers, self._key = numbers, hashlib.sha256(numbers.tobytes()).digest()

    def __hash__(self) -> int:
        return hash(self._key)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Content) and other._key == self._key


@lru_cache(maxsize=8)
def _laid(content: _Content, unit: float, cell: float) -> Laid:
    corners = unit * content.numbers.reshape(-1, 3, 3)
    size = float(np.ptp(corners.reshape(-1, 3), axis=0).max())
    if not SMALLEST <= size <= LARGEST:
        expected = f"makes the target {size:.3g} m long; expected the length that one unit of the file stands for"
        raise Undesigned("target.mesh_unit", f"{unit:g} m", expected)
    volume, center, tensor = triangles.moments(corners)
    body = solids.solid_of(volume, center, tensor)
    points = body.to_body(corners.reshape(-1, 3))
    corners = points.reshape(-1, 3, 3)
    along = np.maximum(np.ceil(np.ptp(points, axis=0) / cell - WHOLE), 1.0)
    edges = np.where(np.abs(along * cell - np.ptp(points, axis=0)) < WHOLE * cell, cell, np.ptp(points, axis=0) / along)
    low = points.min(axis=0) - MARGIN * edges
    counts = tuple(int(n) for n in along + 2 * MARGIN + 1)
    if math.prod(counts) > MOST:
        needed = 1.01 * cell * (math.prod(counts) / MOST) ** (1.0 / 3.0)
        expected = f"makes {math.prod(counts):,} points; expected {needed:.2g} m or more, at most {MOST:,} points"
        raise Undesigned("target.resolution", f"{cell:g} m", expected)
    nearest = triangles.Nearest(corners, 0.5 * float(edges.min()))
    axes = [low[i] + edges[i] * np.arange(counts[i]) for i in range(3)]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    within, overlap = triangles.inside(corners, low, edges, (counts[0], counts[1], counts[2]))
    if overlap is not None:
        raise _runs_through(overlap @ body.turn.T + center, unit)
    grid = nearest.distances(nodes.reshape(-1, 3)).reshape(counts) * np.where(within, -1.0, 1.0)
    lattice = np.array([*low, *edges, 0.0])
    lattice[ERROR] = _error(grid, lattice, nearest.places)
    thickness = _thickness(corners, grid, lattice)
    if thickness < CELLS * cell:
        raise _too_coarse(corners, cell, min(thickness, triangles.thickness(corners, THIN)))
    tables = {
        GRID: grid,
        LATTICE: lattice,
        "target.solid": solids.table(body, points, points, thickness),
        "target.samples": _samples(grid, lattice, nodes),
    }
    return Laid(tables, {}, {FACES: corners.reshape(-1, 9)})


def _runs_through(place: Array, unit: float) -> Undesigned:
    """Bodies that overlap at a place of the file [m]: their masses would count twice, and be hollow in the grid."""
    at = ", ".join(f"{x / unit:.3g}" for x in place)
    return Undesigned(
        "target.mesh", "", f"bodies in it run into one another, at ({at}): expected one surface round all"
    )


def _too_coarse(corners: Array, cell: float, thickness: float) -> Undesigned:
    """Walls [m] that need a finer grid: which at once, or that none has so many points."""
    needed = thickness / CELLS
    points = float(np.prod(np.ptp(corners.reshape(-1, 3), axis=0) / needed + 2 * MARGIN + 1))
    expected = f"is too coarse for walls of {thickness:.3g} m; expected {needed:.2g} m or less"
    if points > MOST:
        expected += f", which makes {points:.2g} points, and at most {MOST:,} go: close the hollow, or take a union"
    return Undesigned("target.resolution", f"{cell:g} m", expected)


def between(grid: Array, lattice: Array, points: Array) -> Array:
    """What `grid_distance` has within the grid, for many points (n, 3) [m]."""
    place = (points - lattice[:3]) / lattice[3:6]
    cells = np.clip(place.astype(int), 0, np.array(grid.shape) - 2)
    share = place - cells
    found = np.zeros(len(points))
    for corner in np.ndindex(2, 2, 2):
        weight = np.prod(np.where(corner, share, 1.0 - share), axis=1)
        found += weight * grid[tuple((cells + corner).T)]
    return found


def _error(grid: Array, lattice: Array, points: Array) -> float:
    """How far the grid's surface may be from points of the body's (n, 3) [m], along the gradient: it rounds edges and
    corners.

    Checked  tests/net_capture/test_mesh.py
    """
    start = points[np.argsort(np.abs(between(grid, lattice, points)))[-LOOKED_AT:]]
    at, beside = start.copy(), BESIDE * np.diag(lattice[3:6])
    for _ in range(LED):
        slope = np.stack([between(grid, lattice, at + e) - between(grid, lattice, at - e) for e in beside], axis=-1)
        slope /= lattice[3:6]
        steep = np.linalg.norm(slope, axis=1, keepdims=True)
        way = between(grid, lattice, at)[:, None] * slope
        at -= np.divide(way, steep, out=np.zeros_like(way), where=steep > 0.0)
    return float(np.linalg.norm(at - start, axis=1).max())


def _thickness(corners: Array, grid: Array, lattice: Array) -> float:
    """Thickness [m] that `THIN` of the surface falls below, across it from the middles of the triangles inward, as
    large as the body where nothing is met."""
    cell = lattice[3:6].min()
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(across, axis=1)
    inward = -across / area[:, None]
    middles = corners.mean(axis=1)
    through = np.full(len(corners), math.inf)
    high = lattice[:3] + lattice[3:6] * (np.array(grid.shape) - 1)
    for step in range(2, 2 * max(grid.shape)):
        way = 0.5 * step * cell
        at = np.clip(middles + way * inward, lattice[:3], high)
        out = (between(grid, lattice, at) > 0.0) & np.isinf(through)
        through[out] = way
    order = np.argsort(through)
    share = np.cumsum(area[order]) / area.sum()
    return float(through[order][int(np.searchsorted(share, THIN))])


def _samples(grid: Array, lattice: Array, nodes: Array) -> Array:
    """The table `samples`, from points of the grid."""
    inner = np.argwhere(grid < -0.25 * lattice[3:6].max())
    inner = inner[:: max(len(inner) // LOOKED_AT, 1)]
    points = nodes[tuple(inner.T)]
    normals, distance = np.empty_like(points), formula(grid_distance)
    depths = np.array([-distance(grid, lattice, n, p) for n, p in zip(normals, points, strict=True)])
    out = points + depths[:, None] * normals
    on = np.abs(between(grid, lattice, out)) < 0.25 * lattice[3:6].max()
    surface = out[on]

    def leads(start: int) -> npt.NDArray[np.bool_]:
        way = np.linalg.norm(points - surface[start], axis=1)
        there = way <= ROUND_BALL * depths
        there[np.flatnonzero(on)[start]] = True
        return np.asarray(there)

    return solids.samples(points, lambda at: -between(grid, lattice, at), surface, leads)


def rows(values: Values) -> Iterator[Implied]:
    """The grid and its error."""
    counts, lattice = values[GRID].shape, values[LATTICE]
    yield Implied("target.grid_points", "points of the grid of its distances", float(math.prod(counts)), "1")
    yield Implied("target.grid_cell", "their distance, the largest", float(lattice[3:6].max()), "m")
    yield Implied("target.grid_error", "by which the surface may be off, at its edges", float(lattice[ERROR]), "m")


def _distance(values: Values, point: Point) -> float:
    return float(formula(grid_distance)(values[GRID], values[LATTICE], np.empty(3), point))


def _surface(values: Values) -> tuple[list[Point], list[list[int]]]:
    corners = values[FACES].reshape(-1, 3)
    return list(corners), [[3 * k, 3 * k + 1, 3 * k + 2] for k in range(len(corners) // 3)]


PART = Term(
    "closed mesh from a file",
    samples.ROWS,
    tables=(
        Table(GRID, "m", "signed distances from the target's surface", dimensions=3),
        Table(LATTICE, "m", "lowest corner of that grid in body axes, edges of its cells, and its error"),
        *samples.TABLES,
    ),
    sources=(
        Table(
            MESH,
            "1",
            "a closed mesh of triangles, .stl or .obj",
            dimensions=2,
            read=triangles.read,
            counted_in="target.mesh_unit",
        ),
    ),
    asked=(
        positive("target.mesh_unit", "m", "length that one unit of the mesh's file stands for", 1.0),
        positive("target.resolution", "m", "distance of the points of the grid of its distances", 0.1),
    ),
    lay=lay,
    make=make,
    checks=Checks(
        lambda values: list(values["target.solid"][solids.HALF : solids.RADIUS]),
        lambda values: float(values["target.solid"][solids.RADIUS]),
        lambda values: float(values["target.solid"][solids.GIRTH]),
        _distance,
        _surface,
        lambda values: [float(x) for x in values["target.solid"][solids.TURN : solids.CENTER]],
    ),
)
