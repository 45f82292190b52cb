"""A line round the convex hull of some corners: beside a box, against a search over a graph, and refusals."""

import heapq
import math
from typing import Any

import numpy as np
import pytest
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from fmu_src.instance import ModelFault
from fmu_src.tethered_deorbit.interface import ENDS_AT_START, HANDED_OVER, MODEL
from tests.plain import PlainInstance, plain

__all__ = ["plain"]
pytestmark = pytest.mark.usefixtures("plain")

SIZE = np.array([2.5, 3.9, 2.2])
BOX = 0.5 * SIZE * np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
OCTAHEDRON = 2.0 * np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], float)
IRREGULAR = np.array([(1.5, 0, 0), (-1, 0.3, 0.2), (0, 1.8, -0.1), (0.2, -1.2, 0.4), (0.1, 0.2, 1.4), (0, -0.3, -1.1)])


def listed(corners: np.ndarray) -> dict[str, tuple[float, ...]]:
    """Parameters of a hull, its last corner repeated."""
    filled = np.vstack([corners, np.tile(corners[-1], (32 - len(corners), 1))])
    return {f"target_corner_{axis}": tuple(filled[:, i]) for i, axis in enumerate("xyz")}


def pair(target: str, **more: Any) -> PlainInstance:
    terms = {"reel": "locked", "environment": "none", "target": target} | more.pop("terms", {})
    values = {
        "start.condition": HANDED_OVER,
        "start_relative_position": (0.0, 12.0, 0.0),
        "tether.rest_length": 40.0,
        "tether.damping_ratio": 0.0,
        "target_inertia": (1671.0, 924.0, 1788.0, 30.0, -20.0, 10.0),
        "target_attachment": (0.0, -0.5 * SIZE[1], 0.0),
        **more,
    }
    return PlainInstance(MODEL, terms, values)


@pytest.mark.parametrize("seed", range(4))
def test_the_hull_of_a_box_is_the_box(seed: int) -> None:
    """Corners in any order, one twice: the same way at the start and through a tumbling tow, to rounding."""
    rng = np.random.default_rng(seed)
    corners = rng.permutation(BOX)
    turn = Rotation.random(random_state=seed).as_quat()
    common = {
        "target_start_attitude": (turn[3], *turn[:3]),
        "target_start_rate": tuple(rng.normal(size=3) * 0.2),
        "tether.rest_length": 13.0,
    }
    box = pair("box", target_size=tuple(SIZE), **common)
    hull = pair("hull", **listed(np.vstack([corners, corners[:1]])), **common)
    for time in (0.0, 3.0, 6.0, 9.0):
        if time:
            box.step(3.0)
            hull.step(3.0)
        assert hull["tether.length"] == pytest.approx(box["tether.length"], rel=1e-9)
        assert hull["tether.wrapped"] == pytest.approx(box["tether.wrapped"], abs=1e-8)
        assert hull["tether.bends"] == box["tether.bends"]
    assert hull["tether.tension_peak"] == pytest.approx(box["tether.tension_peak"], rel=1e-6, abs=1e-6)


def shortest(corners: np.ndarray, first: np.ndarray, face: int, last: np.ndarray, count: int = 41) -> float:
    """Length of the way from a point of a face to one outside, over points of the edges (Dijkstra)."""
    solid = ConvexHull(corners)
    planes = solid.equations

    def passes(p: np.ndarray, q: np.ndarray) -> bool:
        t = np.linspace(0.0, 1.0, 401)[1:-1, None]
        return bool(((p + t * (q - p)) @ planes[:, :3].T + planes[:, 3] < -1e-9).all(axis=1).any())

    if not passes(first, last):
        return float(np.linalg.norm(last - first))
    points, on = [], []
    for f, simplex in enumerate(solid.simplices):
        for g in solid.neighbors[f]:
            if g < f:
                continue
            a, b = corners[list(set(simplex) & set(solid.simplices[g]))]
            for t in np.linspace(0.0, 1.0, count):
                points.append(a + t * (b - a))
                on.append({f, int(g)})
    ends = {i: float(np.linalg.norm(last - p)) for i, p in enumerate(points) if not passes(p, last)}
    far = {i: float(np.linalg.norm(p - first)) for i, p in enumerate(points) if face in on[i]}
    queue = [(length, i) for i, length in far.items()]
    heapq.heapify(queue)
    best = math.inf
    while queue:
        length, i = heapq.heappop(queue)
        if length > far.get(i, math.inf):
            continue
        if length >= best:
            break
        best = min(best, length + ends.get(i, math.inf))
        for j, p in enumerate(points):
            if on[i] & on[j]:
                reached = length + float(np.linalg.norm(p - points[i]))
                if reached < far.get(j, math.inf):
                    far[j] = reached
                    heapq.heappush(queue, (reached, j))
    return best


@pytest.mark.parametrize("corners", [OCTAHEDRON, IRREGULAR], ids=["octahedron", "irregular"])
@pytest.mark.parametrize("seed", range(5))
def test_ways_against_a_search_over_a_graph(corners: np.ndarray, seed: int) -> None:
    """Made fast anywhere on a face, the chaser anywhere: no way of the graph is shorter, and none much longer."""
    rng = np.random.default_rng(seed)
    solid = ConvexHull(corners)
    face = int(rng.integers(len(solid.simplices)))
    weights = rng.dirichlet((2.0, 2.0, 2.0))
    attachment = weights @ corners[solid.simplices[face]]
    # mostly from behind, where it has to go round
    chaser = -8.0 * attachment / np.linalg.norm(attachment) + rng.normal(size=3)
    i = pair(
        "hull",
        target_attachment=tuple(attachment),
        start_relative_position=tuple(-chaser),
        **listed(corners),
    )
    expected = shortest(corners, attachment, face, chaser)
    assert i["tether.length"] <= expected * (1.0 + 1e-9)
    assert i["tether.length"] == pytest.approx(expected, rel=2e-3)
    assert i["tether.bends"] >= 1


def test_distance_to_a_hull() -> None:
    """Beside a face, an edge and a corner of an octahedron |x| + |y| + |z| <= 2."""
    root = math.sqrt(3.0)
    for place, gap in (((2.0, 2.0, 2.0), 4.0 / root), ((3.0, 3.0, 0.0), 2.0 * math.sqrt(2.0)), ((5.0, 0.0, 0.0), 3.0)):
        for clearance, ends in ((gap * (1.0 - 1e-9), False), (gap * (1.0 + 1e-9), True)):
            values = {
                "terms": {"ends": "watched"},
                "target_attachment": (-2.0, 0.0, 0.0),
                "start_relative_position": tuple(-np.array(place)),
                "ends.clearance": clearance,
            }
            if ends:
                text = next(f.text for f in MODEL.faults if f.code == ENDS_AT_START)
                with pytest.raises(ModelFault, match=text[:30]):
                    pair("hull", **values, **listed(OCTAHEDRON))
            else:
                pair("hull", **values, **listed(OCTAHEDRON))


def test_corners_in_a_plane_are_no_body() -> None:
    with pytest.raises(ModelFault, match="span no body"):
        pair("hull", **listed(np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (1.0, 1.0, 0.0)])))
