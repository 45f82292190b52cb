"""Convex hulls: solids whose faces and edges are known, and clouds of points against Qhull."""

import math

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from orbital.hull import hull

GOLD = (1.0 + math.sqrt(5.0)) / 2.0
CUBE = [(x, y, z) for x in (-1.0, 1.0) for y in (-2.0, 2.0) for z in (-0.5, 0.5)]
OCTAHEDRON = [tuple(sign * row) for row in np.eye(3) for sign in (1.0, -1.0)]
ICOSAHEDRON = [
    tuple(np.roll((0.0, a, b * GOLD), shift)) for a in (1.0, -1.0) for b in (1.0, -1.0) for shift in range(3)
]
Solid = tuple[int, np.ndarray, np.ndarray, np.ndarray]


def found(points: object, faces: int = 60, edges: int = 90) -> Solid:
    """Number of edges, faces, edges and the faces of each."""
    f, e, s = np.zeros((faces, 4)), np.zeros((edges, 7)), np.zeros((edges, 2), np.int64)
    counts = hull.py_func(np.array(points, float), f, e, s, np.zeros((4, 3)))  # type: ignore[attr-defined]
    return counts[1], f[: max(counts[0], 0)], e[: max(counts[1], 0)], s[: max(counts[1], 0)]


@pytest.mark.parametrize(
    ("points", "faces", "edges"), [(CUBE, 6, 12), (OCTAHEDRON, 8, 12), (ICOSAHEDRON, 20, 30), (CUBE[:7], 7, 12)]
)
def test_solids(points: list[tuple[float, ...]], faces: int, edges: int) -> None:
    """As many faces and edges as they have, also where points come twice and lie within or in a face."""
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    inner = [(0.0, 0.0, 0.0), tuple(0.5 * (np.array(points[0]) + np.array(points[1])))]
    for cloud in (points, [*points, *points[:3]], [*points, *inner]):
        count, f, e, s = found(np.array(cloud) @ turn.T + 3.0)
        assert (len(f), count) == (faces, edges)
        for edge, (a, b) in zip(e, s, strict=True):
            for end in (edge[:3], edge[:3] + edge[6] * edge[3:6]):
                assert abs(f[a, :3] @ end - f[a, 3]) < 1e-6
                assert abs(f[b, :3] @ end - f[b, 3]) < 1e-6


def test_a_box_of_known_sizes() -> None:
    _, f, e, _ = found(CUBE)
    assert sorted(f[:, 3]) == pytest.approx([0.5, 0.5, 1.0, 1.0, 2.0, 2.0])
    assert sorted(e[:, 6]) == pytest.approx([1.0] * 4 + [2.0] * 4 + [4.0] * 4)


@pytest.mark.parametrize("seed", range(5))
def test_clouds_against_qhull(seed: int) -> None:
    """Points on a sphere are all corners: 2 n - 4 triangles and 3 n - 6 edges; each triangle is one of Qhull's."""
    points = np.random.default_rng(seed).normal(size=(20, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    count, f, e, _ = found(points)
    theirs = ConvexHull(points)
    assert (len(f), count) == (36, 54) == (len(theirs.equations), 3 * 20 - 6)
    ours = sorted(tuple(np.round(row, 9)) for row in f)
    for row, other in zip(ours, sorted(tuple(np.round((*q[:3], -q[3]), 9)) for q in theirs.equations), strict=True):
        assert row == pytest.approx(other, abs=1e-8)
    assert e[:, 6].sum() == pytest.approx(_lengths(theirs))


def _lengths(theirs: ConvexHull) -> float:
    """Of all edges of a hull of triangles, each of two of them."""
    total = 0.0
    for simplex in theirs.simplices:
        corners = theirs.points[simplex]
        total += sum(np.linalg.norm(corners[i] - corners[i - 1]) for i in range(3))
    return total / 2.0


def test_what_is_no_body() -> None:
    assert found([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)])[0] == 0
    assert found([(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0)])[0] == 0
    assert found([(1, 2, 3)] * 5)[0] == 0
    assert found(ICOSAHEDRON, faces=19)[0] == found(ICOSAHEDRON, edges=29)[0] == -1
