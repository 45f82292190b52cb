"""The box: edges along the body axes."""

from __future__ import annotations

import math

from fmu_src.interface import Term, Variable
from fmu_src.net_capture.shapes import Checks, Point, Shape, Values
from orbital.kernel import kernel


@kernel
def box_distance(normal, point, half):
    """Signed distance [m] of a point from the surface of a box, negative inside; its outward normal goes into `normal`.

    Outside, the nearest point of the box is found by clamping each coordinate; inside, the nearest face.

    point        in body axes, from the centre   [m]  (3,)
    half         half the edges                  [m]  (3,)
    normal       unit vector, body axes          [1]  (3,)

    Valid    any point; on an edge seen from inside the first of the nearest faces is taken
    Checked  tests/net_capture/test_contact.py
    """
    outside = 0.0
    deepest = -math.inf
    face = 0
    for i in range(3):
        beyond = abs(point[i]) - half[i]
        if beyond > deepest:
            deepest = beyond
            face = i
        reach = beyond if beyond > 0.0 else 0.0
        normal[i] = reach if point[i] >= 0.0 else -reach
        outside += reach * reach
    if outside > 0.0:
        distance = math.sqrt(outside)
        for i in range(3):
            normal[i] /= distance
        return distance
    for i in range(3):
        normal[i] = 0.0
    normal[face] = 1.0 if point[face] >= 0.0 else -1.0
    return deepest


@kernel
def box_girth(size):
    """Smallest girth [m] of a box: the shortest closed cord that can be passed over it.

        2 (a + b)  with a, b the two shorter edges

    Checked  tests/net_capture/test_contact.py (16 m for 4 x 8 x 4 m)
    """
    longest = max(size[0], max(size[1], size[2]))
    return 2.0 * (size[0] + size[1] + size[2] - longest)


BOX_SAMPLES = 27
"""Sample points of a box: its centre, the middles of its faces and edges, and its corners."""


@kernel
def box_sample(point, half, number):
    """point = sample point `number` of a box, of the grid of three by three by three points, the first axis fastest.

    point        in body axes, from the centre   [m]  (3,)
    half         half the edges                  [m]  (3,)
    number       0 to 26; 13 is the centre       [1]

    Checked  tests/net_capture/test_enclosure.py
    """
    for i in range(3):
        point[i] = (number % 3 - 1) * half[i]
        number //= 3


@kernel
def measure(p):
    """Half the edges, half the diagonal, and the smallest girth [m].

    Checked  tests/net_capture/test_shapes.py
    """
    squared = 0.0
    for i in range(3):
        p.half_size[i] = 0.5 * p.target_size[i]
        squared += p.half_size[i] * p.half_size[i]
    p.envelope_radius = math.sqrt(squared)
    p.girth = box_girth(p.target_size)


@kernel
def inertia(p, out):
    """out = m (a2 + b2) / 12 of the two other edges [kg m2].

    Checked  tests/net_capture/test_shapes.py
    """
    for i in range(3):
        a = p.target_size[(i + 1) % 3]
        b = p.target_size[(i + 2) % 3]
        out[i] = p.target_mass * (a * a + b * b) / 12.0


@kernel
def distance(p, normal, point):
    """Signed distance [m] and outward normal, see `box_distance`.

    Checked  tests/net_capture/test_shapes.py
    """
    return box_distance(normal, point, p.half_size)


@kernel
def sample(p, out, number, depth):
    """out = sample point [m] of the box that is smaller by a depth on every side, but not below nothing.

    Checked  tests/net_capture/test_shapes.py
    """
    half = p.shape_half
    for i in range(3):
        half[i] = max(p.half_size[i] - depth, 0.0)
    box_sample(out, half, number)


@kernel
def faces(p, out):
    """The six faces into the rows of `out`, see `Shape.faces`.

    Checked  tests/net_capture/test_wrapping.py
    """
    for face in range(6):
        for i in range(3):
            out[face, i] = 0.0
        axis = face // 2
        out[face, axis] = 1.0 if face % 2 == 0 else -1.0
        out[face, 3] = p.half_size[axis]
    return 6


def _size(values: Values) -> list[float]:
    return [values[f"target.size[{i}]"] for i in (1, 2, 3)]


def _half(values: Values) -> list[float]:
    return [0.5 * edge for edge in _size(values)]


def _distance(values: Values, point: Point) -> float:
    beyond = [abs(x) - h for x, h in zip(point, _half(values), strict=True)]
    outside = math.hypot(*(max(b, 0.0) for b in beyond))
    return outside if outside > 0.0 else max(beyond)


def _surface(values: Values) -> tuple[list[Point], list[list[int]]]:
    a, b, c = _half(values)
    corners: list[Point] = [[x, y, z] for x in (-a, a) for y in (-b, b) for z in (-c, c)]
    return corners, [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]]


PART = Term(
    "box",
    (
        Variable(
            "target.size[#]",
            "m",
            "parameter",
            "edges along the body axes",
            (4.0, 8.0, 4.0),
            shape=(3,),
            minimum=0.0,
            open_minimum=True,
        ),
    ),
    make=lambda composition: Shape(BOX_SAMPLES, measure, inertia, distance, sample, faces=faces),
    checks=Checks(
        _half,
        lambda values: math.hypot(*_half(values)),
        lambda values: 2.0 * (sum(_size(values)) - max(_size(values))),
        _distance,
        _surface,
    ),
)
