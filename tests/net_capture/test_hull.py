"""The convex hull of a net against scipy's Qhull, and bodies known by heart."""

import itertools

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from fmu_src.net_capture.hull import make_hull
from tests.validation import closed_form, other_code


@pytest.fixture(scope="module")
def hull():
    kernel = make_hull()

    def measured(points, room=40):
        scratch = np.zeros(room * (len(points) + 8))
        scratch[: 3 * len(points)] = np.ravel(points)
        return kernel(scratch, len(points))

    return measured


def sheet(seed, wave):
    """Knots of a net of 25 x 25 that is bent, shaken and turned."""
    random = np.random.default_rng(seed)
    x, y = np.meshgrid(np.linspace(-12.0, 12.0, 25), np.linspace(-12.0, 12.0, 25))
    points = np.stack([x, y, wave * np.cos(0.3 * x) * np.cos(0.2 * y)], -1).reshape(-1, 3)
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    return (points + wave * 1e-2 * random.normal(size=points.shape)) @ turn + random.normal(size=3)


def wrapped(seed):
    """Nodes of a net that lies on a box which is turned: on its faces, its edges and its corners, but for rounding."""
    random = np.random.default_rng(seed)
    points = random.uniform(-1.0, 1.0, (600, 3))
    points[np.arange(600), random.integers(0, 3, 600)] = random.choice((-1.0, 1.0), 600)
    points[:200, 0] = random.choice((-1.0, 1.0), 200)
    points[:200, 1] = random.choice((-1.0, 1.0), 200)
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    return points * np.array([2.0, 4.0, 2.0]) @ turn + random.normal(size=3)


WITHIN = 1e-2
"""What a nearly flat net's volume may be off by [m3]: a millionth of 12 m over 576 m2."""
CLOUDS = {
    "ball": lambda seed: np.random.default_rng(seed).normal(size=(400, 3)),
    "sphere": lambda seed: (lambda p: p / np.linalg.norm(p, axis=1)[:, None])(
        np.random.default_rng(seed).normal(size=(200, 3))
    ),
    "lattice": lambda seed: np.array(list(itertools.product(range(5), range(4), range(3))), float) * (1.0 + seed),
    "bent net": lambda seed: sheet(seed, 3.0),
    "nearly flat net": lambda seed: sheet(seed, 1e-4),
    "wrapped round a box": wrapped,
    "four": lambda seed: np.random.default_rng(seed).normal(size=(4, 3)),
    "twice the same": lambda seed: np.repeat(np.random.default_rng(seed).normal(size=(60, 3)), 2, axis=0),
}


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("name", CLOUDS)
def test_volume_and_area_are_qhulls(validated, hull, name, seed):
    points = CLOUDS[name](seed)
    expected = ConvexHull(points)
    known = np.array((expected.volume, expected.area))
    within = np.maximum(1e-5 * known, WITHIN if name == "nearly flat net" else 0.0)
    validated(other_code("Qhull"), f"hull, {name}: volume and area", hull(points), known, "m3, m2", abs=within)


def test_bodies_known_by_heart(validated, hull):
    """A box with all its lattice, and the net as it is shot: flat, both sides of it."""
    box = np.array(list(itertools.product((-2.0, 0.0, 2.0), (-4.0, 4.0), (1.0, 5.0))))
    formula = closed_form("a b c, 2 (a b + b c + c a)")
    validated(formula, "hull of a box: volume and area", hull(box), (128.0, 160.0), "m3, m2", rel=1e-5)
    flat = np.array(list(itertools.product(np.linspace(0.0, 6.0, 7), np.linspace(0.0, 3.0, 4), (0.7,))))
    assert hull(flat) == pytest.approx((0.0, 36.0), rel=1e-5)
    line = np.linspace(0.0, 1.0, 9)[:, None] * np.array([1.0, 2.0, -1.0])
    assert hull(line) == (0.0, 0.0)
    assert hull(np.ones((5, 3))) == (0.0, 0.0)


def test_a_hull_without_room_says_so(hull):
    """Faces for six of two hundred points: no number that could be taken for a volume."""
    assert hull(CLOUDS["sphere"](0), room=4)[0] == -1.0
