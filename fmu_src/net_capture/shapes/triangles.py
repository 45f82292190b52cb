"""A closed mesh of triangles from a file, what is wrong with one that is none, and distances from it."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Numbers = npt.NDArray[np.int64]

KINDS = (".stl", ".obj")
MOST = 200_000
"""Triangles of the largest mesh that is read."""
HEAD, EACH = 80, 50
"""Bytes of a binary STL: before the number of its triangles, and for each of them."""
LOOKED_ACROSS = 400
"""Triangles from which a thickness is looked for."""
FLAT = 1e-12
"""Area of a triangle, as a share of the square of the mesh's size, below which it is none."""
NEIGHBOURS = 6
"""Triangles near a point that are looked at for the nearest."""
ASIDE = (1.2345e-5, 2.3456e-5)
"""By how much of a cell the lines along which crossings are counted pass beside the grid's points: through no edge."""
CHUNK = 200_000

APART = 1e-4
"""Share of a cell by which two crossings differ, where bodies may touch face to face."""


def read(path: Path) -> Array:
    """Corners of the triangles of a closed mesh, (n, 9), in the file's unit, all facing outward.

    ValueError with what is wrong: no such mesh, holes, triangles without area, or faces that look inward.

    Checked  tests/net_capture/test_mesh.py
    """
    if path.suffix.lower() not in KINDS:
        raise ValueError(f"is no {' or '.join(KINDS)} file")
    try:
        import trimesh
    except ImportError:
        raise ValueError("meshes need trimesh: pip install 'dcone-cosim[mesh]'") from None
    _whole(path.read_bytes() if path.suffix.lower() == ".stl" else b"")  # an OSError of its own
    try:
        as_written = trimesh.load_mesh(path, process=False)
        mesh = trimesh.load_mesh(path, process=True, maintain_order=True)
    except ImportError:  # of what would guess the encoding of a text
        raise ValueError("cannot be read as a mesh: it is neither a binary STL nor a text") from None
    except Exception as error:  # whatever the reader stumbles over
        raise ValueError(f"cannot be read as a mesh: {error}") from None
    if isinstance(as_written, trimesh.Trimesh):
        _finite(np.asarray(as_written.triangles, dtype=float))
    if not isinstance(mesh, trimesh.Trimesh) or len(mesh.faces) == 0:
        raise ValueError("holds no triangles")
    if len(mesh.faces) > MOST:
        raise ValueError(f"holds {len(mesh.faces):,} triangles, expected at most {MOST:,}")
    corners = np.asarray(mesh.triangles, dtype=float)
    size = float(np.ptp(corners.reshape(-1, 3), axis=0).max())
    thin = np.flatnonzero(areas(corners) <= FLAT * size * size)
    if len(thin):
        raise ValueError(f"triangle {int(thin[0]) + 1} of {len(corners):,} has no area ({len(thin)} such in all)")
    _once(np.asarray(mesh.faces))
    edges = np.sort(mesh.edges, axis=1)
    _, counts = np.unique(edges, axis=0, return_counts=True)
    if (counts != 2).any():
        open_ones, shared = int((counts == 1).sum()), int((counts > 2).sum())
        text = f"{open_ones} edges belong to one triangle alone, {shared} to more than two"
        raise ValueError(f"is not closed: {text}")
    if not mesh.is_winding_consistent:
        raise ValueError("has neighbouring triangles that face opposite ways: expected all to face outward")
    if volume(corners) <= 0.0:
        raise ValueError("has triangles that face inward: expected all to face outward")
    return corners.reshape(-1, 9)


def _whole(content: bytes) -> None:
    """ValueError for a binary STL of fewer triangles than it says: a head of 80 bytes, their number, 50 bytes each."""
    head = content[: HEAD + 4]
    if len(head) < HEAD + 4 or b"\0" not in head:  # too short for one, or a text
        return
    said, there = int.from_bytes(head[HEAD:], "little"), (len(content) - len(head)) / EACH
    if there < said:
        raise ValueError(f"is cut short: it says {said:,} triangles and holds {int(there):,}")


def _finite(corners: Array) -> None:
    bad = np.argwhere(~np.isfinite(corners))
    if len(bad):
        raise ValueError(f"triangle {int(bad[0][0]) + 1} has a corner that is no number")


def _once(faces: Numbers) -> None:
    """ValueError for triangles that stand twice, whichever way they face."""
    _, first, counts = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    if (counts > 1).any():
        twice = int((counts > 1).sum())
        raise ValueError(
            f"has triangle {int(first[counts > 1].min()) + 1} twice, with the same corners ({twice} such in all)"
        )


def areas(corners: Array) -> Array:
    """Areas of triangles (n, 3, 3) [m2]."""
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.asarray(0.5 * np.linalg.norm(across, axis=1))


def volume(corners: Array) -> float:
    """Volume within triangles (n, 3, 3) that face outward [m3], by the theorem of Gauss."""
    return float(np.einsum("ni,ni->n", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum()) / 6.0


def thickness(corners: Array, share: float) -> float:
    """Thickness [m] that this share of the surface falls below: the way inward, across it, from evenly chosen triangles
    to the next one.

    corners    of a closed mesh that faces outward (n, 3, 3) [m]

    Source   T. Moller and B. Trumbore, J. Graphics Tools 2 (1997) 21: where a ray meets a triangle
    Checked  tests/net_capture/test_mesh_messages.py
    """
    area = areas(corners)
    places = (np.arange(LOOKED_ACROSS) + 0.5) / LOOKED_ACROSS * area.sum()
    chosen = corners[np.minimum(np.searchsorted(np.cumsum(area), places), len(corners) - 1)]
    across = np.cross(chosen[:, 1] - chosen[:, 0], chosen[:, 2] - chosen[:, 0])
    inward = -across / np.linalg.norm(across, axis=1)[:, None]
    nearest = 1e-9 * float(np.ptp(corners.reshape(-1, 3), axis=0).max())
    a, ab, ac = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    found = np.empty(len(chosen))
    with np.errstate(divide="ignore", invalid="ignore"):
        for k, (way, start) in enumerate(zip(inward, chosen.mean(axis=1), strict=True)):
            p, s = np.cross(way, ac), start - a
            q = np.cross(s, ab)
            whole = np.einsum("ni,ni->n", ab, p)
            u, v, t = (np.einsum("ni,ni->n", *pair) / whole for pair in ((s, p), (q, way[None, :] + 0.0 * q), (ac, q)))
            hit = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (t > nearest)
            found[k] = t[hit].min(initial=math.inf)
    return float(np.sort(found)[int(share * len(found))])


def moments(corners: Array) -> tuple[float, Array, Array]:
    """Volume [m3], its centre [m], and its tensor of inertia about that for a density of one [m5], of triangles that
    face outward, from the tetrahedra that they make with the origin.

    Source   D. Eberly, Polyhedral mass properties (2002), the integrals over a tetrahedron
    Checked  tests/net_capture/test_mesh.py
    """
    middle = corners.reshape(-1, 3).mean(axis=0)
    a, b, c = (corners[:, k] - middle for k in range(3))
    six = np.einsum("ni,ni->n", a, np.cross(b, c))
    whole = float(six.sum()) / 6.0
    total = a + b + c
    center = (six[:, None] * total).sum(axis=0) / 24.0 / whole
    squares = sum(np.einsum("n,ni,nj->ij", six, x, x) for x in (a, b, c, total)) / 120.0
    squares = squares - whole * np.outer(center, center)
    return whole, center + middle, np.trace(squares) * np.eye(3) - squares


def closest(points: Array, a: Array, b: Array, c: Array) -> Array:
    """The closest points of triangles, one for each point, (n, 3) [m].

    Source   C. Ericson, Real-Time Collision Detection (2005), section 5.1.5: the regions of corners, edges and face
    Checked  tests/net_capture/test_mesh.py
    """
    ab, ac = b - a, c - a
    found = np.empty_like(points)
    left = np.ones(len(points), dtype=bool)

    def settle(where: npt.NDArray[np.bool_], place: Array) -> None:
        now = left & where
        found[now] = place[now]
        left[now] = False

    def dot(x: Array, y: Array) -> Array:
        return np.asarray(np.einsum("ni,ni->n", x, y))

    d1, d2 = dot(ab, points - a), dot(ac, points - a)
    d3, d4 = dot(ab, points - b), dot(ac, points - b)
    d5, d6 = dot(ab, points - c), dot(ac, points - c)
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    with np.errstate(divide="ignore", invalid="ignore"):
        settle((d1 <= 0.0) & (d2 <= 0.0), a)
        settle((d3 >= 0.0) & (d4 <= d3), b)
        settle((vc <= 0.0) & (d1 >= 0.0) & (d3 <= 0.0), a + (d1 / (d1 - d3))[:, None] * ab)
        settle((d6 >= 0.0) & (d5 <= d6), c)
        settle((vb <= 0.0) & (d2 >= 0.0) & (d6 <= 0.0), a + (d2 / (d2 - d6))[:, None] * ac)
        w = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        settle((va <= 0.0) & (d4 - d3 >= 0.0) & (d5 - d6 >= 0.0), b + w[:, None] * (c - b))
        total = va + vb + vc
        settle(left.copy(), a + (vb / total)[:, None] * ab + (vc / total)[:, None] * ac)
    return found


class Nearest:
    """How far points are from triangles, without a sign.

    Which triangles may be nearest is told by points spread over them, no farther apart than `spread`.
    """

    def __init__(self, corners: Array, spread: float) -> None:
        from scipy.spatial import cKDTree

        self._corners = corners
        places, owners = [], []
        longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
        pieces = np.maximum(np.ceil(longest / spread).astype(int), 1)
        for count in np.unique(pieces):
            i, j = (x.ravel() for x in np.meshgrid(np.arange(count + 1), np.arange(count + 1)))
            keep = i + j <= count
            u, v = i[keep] / count, j[keep] / count
            these = np.flatnonzero(pieces == count)
            a, b, c = (corners[these, None, k] for k in range(3))
            spots = a + u[None, :, None] * (b - a) + v[None, :, None] * (c - a)
            places.append(spots.reshape(-1, 3))
            owners.append(np.repeat(these, len(u)))
        self.places, self._owners = np.vstack(places), np.concatenate(owners)
        self._tree = cKDTree(self.places)

    def distances(self, points: Array) -> Array:
        """Of points (n, 3) from the nearest triangle [m]."""
        found = np.empty(len(points))
        for first in range(0, len(points), CHUNK):
            some = points[first : first + CHUNK]
            _, near = self._tree.query(some, k=min(NEIGHBOURS, len(self.places)))
            best = np.full(len(some), math.inf)
            for column in np.atleast_2d(near.T):
                triangle = self._corners[self._owners[column]]
                at = closest(some, triangle[:, 0], triangle[:, 1], triangle[:, 2])
                best = np.minimum(best, np.linalg.norm(some - at, axis=1))
            found[first : first + CHUNK] = best
        return found


def inside(
    corners: Array, low: Array, cell: Array, counts: tuple[int, int, int]
) -> tuple[npt.NDArray[np.bool_], Array | None]:
    """Which points of a grid lie within a closed mesh: those with an odd number of crossings on the way along the first
    axis, for a line that passes just beside them. And where such a line comes in twice before it goes out, or goes out
    first, if anywhere: bodies there run into one another, or triangles face inward [m] (3,).

    low       the grid's lowest corner [m] (3,)
    cell      distances of its points [m] (3,)
    counts    how many they are along each axis

    Checked  tests/net_capture/test_mesh.py, test_mesh_messages.py
    """
    crossings = np.zeros((counts[0] + 1, counts[1], counts[2]), dtype=np.int32)
    local = (corners - low) / cell
    local[:, :, 1:] -= ASIDE
    met: list[Array] = []
    for a, b, c in local:
        (y0, z0), (y1, z1) = (
            np.maximum(np.ceil(np.minimum(np.minimum(a, b), c)[1:]).astype(int), 0),
            np.minimum(np.floor(np.maximum(np.maximum(a, b), c)[1:]).astype(int), np.array(counts[1:]) - 1),
        )
        if y1 < y0 or z1 < z0:
            continue
        area = (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1])
        if area == 0.0:
            continue
        y, z = np.meshgrid(np.arange(y0, y1 + 1), np.arange(z0, z1 + 1), indexing="ij")
        u = ((y - a[1]) * (c[2] - a[2]) - (z - a[2]) * (c[1] - a[1])) / area
        v = ((b[1] - a[1]) * (z - a[2]) - (b[2] - a[2]) * (y - a[1])) / area
        hit = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0)
        x = a[0] + u[hit] * (b[0] - a[0]) + v[hit] * (c[0] - a[0])
        place = np.clip(np.ceil(x).astype(int), 0, counts[0])
        np.add.at(crossings, (place, y[hit], z[hit]), 1)
        met.append(np.column_stack([y[hit], z[hit], x, np.full(len(x), -math.copysign(1.0, area))]))
    after = crossings[::-1].cumsum(axis=0)[::-1]
    return np.asarray(after[1:] % 2 == 1), _twice_in(np.vstack(met), low, cell)


def _twice_in(met: Array, low: Array, cell: Array) -> Array | None:
    """A place [m] where a line is within more than one body, or fewer than none.

    met    crossings (n, 4): which line, where on it [cells], and 1 inward, -1 outward
    """
    y, z, x, inward = met[np.lexsort([met[:, 2], met[:, 1], met[:, 0]])].T
    depth = np.cumsum(inward)[:-1]
    same = (np.diff(y) == 0.0) & (np.diff(z) == 0.0)
    wrong = np.flatnonzero(same & ((depth < 0.0) | (depth > 1.0)) & (np.diff(x) > APART))
    if len(wrong) == 0:
        return None
    at = wrong[np.argmax(np.diff(x)[wrong])]
    return np.asarray(low + cell * np.array([0.5 * (x[at] + x[at + 1]), y[at] + ASIDE[0], z[at] + ASIDE[1]]))
