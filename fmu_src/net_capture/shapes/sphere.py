"""The sphere."""

from __future__ import annotations

import math

import numpy as np

from fmu_src.implied import formula
from fmu_src.interface import Term
from fmu_src.net_capture.shapes import Checks, Point, Shape, Values
from fmu_src.rows import positive
from orbital.kernel import kernel

FACES = 320
"""Faces of a sphere where a thread lies on it."""
WITHIN = 0.98838
"""Their distance over the radius, so that the corners between them lie on the sphere (0.988388, from
`scipy.spatial.HalfspaceIntersection`): a way round them is shorter by 0.8 % on average."""
GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))
SAMPLES = 27
"""Sample points: the centre, and towards the faces, edges and corners of a cube."""
AROUND, UP = 24, 12
"""Corners of the drawing round an equator, and pieces from pole to pole."""


@kernel
def sphere_distance(normal, point, radius):
    """Signed distance [m] of a point from the surface of a sphere, negative inside; outward normal into `normal`.

        sqrt(x2 + y2 + z2) - r

    point        in body axes, from the centre   [m]  (3,)
    normal       unit vector, body axes          [1]  (3,)

    Valid    any point; in the centre the first body axis is taken for the way out
    Checked  tests/net_capture/test_shapes.py
    """
    away = math.sqrt(point[0] * point[0] + point[1] * point[1] + point[2] * point[2])
    for i in range(3):
        normal[i] = point[i] / away if away > 0.0 else (1.0 if i == 0 else 0.0)
    return away - radius


@kernel
def sphere_sample(out, number, radius):
    """out = sample point `number`, 0 to 26 [m]: 13 is the centre, the others lie towards a cube's faces, edges and
    corners.

    Checked  tests/net_capture/test_shapes.py
    """
    squared = 0.0
    for i in range(3):
        out[i] = number % 3 - 1.0
        squared += out[i] * out[i]
        number //= 3
    for i in range(3):
        out[i] *= radius / math.sqrt(squared) if squared > 0.0 else 0.0


@kernel
def measure(p):
    """The box and the sphere around it, and its girth, 2 pi r [m].

    Checked  tests/net_capture/test_shapes.py
    """
    for i in range(3):
        p.half_size[i] = p.target_radius
    p.envelope_radius = p.target_radius
    p.girth = 2.0 * math.pi * p.target_radius


@kernel
def inertia(p, out):
    """out = 2 m r2 / 5 [kg m2].

    Checked  tests/net_capture/test_shapes.py
    """
    for i in range(3):
        out[i] = 0.4 * p.target_mass * p.target_radius * p.target_radius


@kernel
def distance(p, normal, point):
    """Signed distance [m] and outward normal, see `sphere_distance`.

    Checked  tests/net_capture/test_shapes.py
    """
    return sphere_distance(normal, point, p.target_radius)


@kernel
def sample(p, out, number, depth):
    """out = sample point [m] of the sphere that is smaller by a depth, but not below nothing.

    Checked  tests/net_capture/test_shapes.py
    """
    sphere_sample(out, number, max(p.target_radius - depth, 0.0))


@kernel
def faces(p, out):
    """Faces of a polyhedron within it, spread evenly over a spiral from pole to pole, see `Shape.faces`.

    Checked  tests/net_capture/test_wrapping.py
    """
    for face in range(FACES):
        up = 1.0 - (2.0 * face + 1.0) / FACES
        across = math.sqrt(1.0 - up * up)
        out[face, 0] = across * math.cos(GOLDEN_ANGLE * face)
        out[face, 1] = across * math.sin(GOLDEN_ANGLE * face)
        out[face, 2] = up
        out[face, 3] = WITHIN * p.target_radius
    return FACES


def _radius(values: Values) -> float:
    return float(values["target.radius"])


def _distance(values: Values, point: Point) -> float:
    return float(formula(sphere_distance)(np.empty(3), point, _radius(values)))


def drawn(radius: float) -> tuple[list[Point], list[list[int]]]:
    """Corners [m] and faces between meridians and parallels, to draw it by."""
    corners: list[Point] = [[0.0, 0.0, -radius], [0.0, 0.0, radius]]
    for level in range(1, UP):
        tilt = math.pi * (level / UP - 0.5)
        for place in range(AROUND):
            turn = 2.0 * math.pi * place / AROUND
            across = radius * math.cos(tilt)
            corners.append([across * math.cos(turn), across * math.sin(turn), radius * math.sin(tilt)])
    faces = []
    for place in range(AROUND):
        beside = (place + 1) % AROUND
        faces.append([0, 2 + beside, 2 + place])
        for level in range(UP - 2):
            low, high = 2 + level * AROUND, 2 + (level + 1) * AROUND
            faces.append([low + place, low + beside, high + beside, high + place])
        last = 2 + (UP - 2) * AROUND
        faces.append([1, last + place, last + beside])
    return corners, faces


PART = Term(
    "sphere",
    (positive("target.radius", "m", "of the sphere", 2.0),),
    make=lambda composition: Shape(SAMPLES, measure, inertia, distance, sample, faces=faces),
    checks=Checks(
        lambda values: [_radius(values)] * 3,
        _radius,
        lambda values: 2.0 * math.pi * _radius(values),
        _distance,
        lambda values: drawn(_radius(values)),
    ),
)
