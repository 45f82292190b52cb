"""Whether a closed surface goes round a point, and the mouth measures."""

import itertools

import numpy as np
import pytest

from fmu_src.net_capture.quality import crossing
from fmu_src.net_capture.topology import MASS, NODE_PLANES

CORNERS = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))


def cube_triangles():
    """The faces of a cube, outward, as triangles of corners."""
    for axis, side in itertools.product(range(3), (-1.0, 1.0)):
        face = [c for c in CORNERS if c[axis] == side]
        a, b, c, d = face[0], face[1], face[3], face[2]
        if np.dot(np.cross(b - a, c - b), side * np.eye(3)[axis]) < 0.0:
            b, d = d, b
        yield a, b, c
        yield a, c, d


def winding(function, point):
    return sum(function(None, None, point, *a, *b, *c) for a, b, c in cube_triangles())


@pytest.mark.parametrize("function", [crossing, crossing.py_func])
def test_winding_number_tells_inside_from_outside(function):
    generator = np.random.default_rng(3)
    for point in generator.uniform(-2.0, 2.0, size=(200, 3)):
        inside = bool(np.abs(point).max() < 1.0)
        assert (winding(function, point) != 0) == inside


def test_an_open_cube_does_not_close_by_itself():
    """The twin: with a face missing some point inside is seen as outside, so the cap over the mouth is needed."""
    open_cube = list(cube_triangles())[2:]
    open_cube = [t for t in open_cube if not all(p[2] == 1.0 for p in t)]
    point = np.array([0.05, 0.02, 0.9])
    assert sum(crossing(None, None, point, *a, *b, *c) for a, b, c in open_cube) == 0


def test_mouth_area_of_the_folded_net_is_its_square(shoot):
    net = shoot({"net.fold_side": 0.5})
    assert net["mouth.area"] == pytest.approx(0.25, rel=1e-12)
    assert net["mouth.depth"] == pytest.approx(0.0, abs=1e-12)
    turned = shoot({"shot.axis[1]": 1.0, "shot.axis[3]": 2.0, "shot.roll": 0.7})
    assert turned["mouth.area"] == pytest.approx(0.25, rel=1e-12)


def test_mass_properties_are_those_of_the_nodes(shoot):
    net = shoot({"net.mesh": 2.0})
    net.step(5.0)
    slots = int(net.record["node_slots"][0])
    planes = net.work[: NODE_PLANES * slots].reshape(NODE_PLANES, slots)
    mass = planes[MASS]
    centre = (planes[:3] * mass).sum(axis=1) / mass.sum()
    assert net.array("catch_position") == pytest.approx(centre, rel=1e-12)
    arms = (planes[:3] - centre[:, None]).T
    tensor = sum(m * (np.dot(r, r) * np.eye(3) - np.outer(r, r)) for m, r in zip(mass, arms, strict=True))
    told = net.array("catch_inertia")
    assert told == pytest.approx([tensor[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))], abs=1e-9)
