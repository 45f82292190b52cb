"""The cylinder: its axis along the third body axis, flat ends."""

from __future__ import annotations

import math

from fmu_src.interface import Term
from fmu_src.net_capture.shapes import Checks, Point, Shape, Values
from fmu_src.rows import positive
from orbital.kernel import kernel

SAMPLES = 27
"""Sample points: at either end and half way, one on the axis and eight around it."""
AROUND = 8
DRAWN_AROUND = 24
FACES_AROUND = 48
"""Faces of a round side where a thread lies on it: within 0.22 % of the radius, and a way round them within 0.08 %."""
COARSE, FEWEST, THIN = 1e-3, 8, 4e-3
"""Metres by which fewer faces may lie within it, half of what ways do; and by which these few may, of what is thin: a
thread may be wound round it for four turns then, as far as edges are kept."""


@kernel
def of_prism(normal, flat, x, y, height, half_length):
    """Signed distance [m] from the surface of what has one section all along its third axis and flat ends; outward
    normal into `normal`.

    flat         signed distance from the section's edge [m], and the way out of it there, x and y [1]
    height       along the axis, from its middle         [m]
    normal       unit vector                             [1]  (3,)

    Valid    a section whose distances are exact
    Checked  tests/net_capture/test_shapes.py, test_pieces.py
    """
    up = 1.0 if height >= 0.0 else -1.0
    end = abs(height) - half_length
    if flat > 0.0 and end > 0.0:
        distance = math.sqrt(flat * flat + end * end)
        normal[0] = flat / distance * x
        normal[1] = flat / distance * y
        normal[2] = end / distance * up
        return distance
    if flat > end:
        normal[0] = x
        normal[1] = y
        normal[2] = 0.0
        return flat
    normal[0] = 0.0
    normal[1] = 0.0
    normal[2] = up
    return end


@kernel
def cylinder_distance(normal, point, radius, half_length):
    """Signed distance [m] of a point from the surface of a cylinder, negative inside; outward normal into `normal`.

        a = sqrt(x2 + y2) - r,   b = |z| - l/2
        sqrt(max(a, 0)^2 + max(b, 0)^2) outside, max(a, b) inside

    point        in body axes, from the centre   [m]  (3,)
    normal       unit vector, body axes          [1]  (3,)

    Valid    any point; on the axis, seen from inside, the first body axis is taken for the way out
    Checked  tests/net_capture/test_shapes.py
    """
    across = math.sqrt(point[0] * point[0] + point[1] * point[1])
    x = point[0] / across if across > 0.0 else 1.0
    y = point[1] / across if across > 0.0 else 0.0
    return of_prism(normal, across - radius, x, y, point[2], half_length)


@kernel
def faces_round(radius):
    """How many faces a round side has for threads: as few as lie so deep, `COARSE`, within it, up to `FACES_AROUND`.

    radius       the largest, of a frustum     [m]

    Checked  tests/net_capture/test_wrapping.py
    """
    if radius * (1.0 - math.cos(math.pi / FEWEST)) <= THIN:
        return FEWEST
    around = FEWEST
    while around < FACES_AROUND and radius * (1.0 - math.cos(math.pi / around)) > COARSE:
        around += 4
    return around


@kernel
def faces_around(out, around, bottom, top, low, high):
    """Faces of a prism or pyramid within a cylinder or frustum, edge to edge on its surface, into the rows of `out`,
    see `Shape.faces`; how many.

    around       so many of them round the axis
    bottom, top  radii at its ends, of which one may be 0        [m]
    low, high    the ends on the third axis                      [m]

    Checked  tests/net_capture/test_wrapping.py
    """
    shrunk = math.cos(math.pi / around)
    slope = (bottom - top) * shrunk / (high - low)
    size = math.sqrt(1.0 + slope * slope)
    for face in range(around):
        angle = 2.0 * math.pi * face / around
        out[face, 0] = math.cos(angle) / size
        out[face, 1] = math.sin(angle) / size
        out[face, 2] = slope / size
        out[face, 3] = (bottom * shrunk + slope * low) / size
    count = around
    for end in range(2):
        if (bottom if end == 0 else top) > 0.0:
            out[count, 0] = 0.0
            out[count, 1] = 0.0
            out[count, 2] = -1.0 if end == 0 else 1.0
            out[count, 3] = -low if end == 0 else high
            count += 1
    return count


@kernel
def cylinder_girth(radius, length):
    """Smallest girth [m] of a cylinder: round it, 2 pi r, or over both ends, 2 (l + 2 r).

    Checked  tests/net_capture/test_shapes.py
    """
    return min(2.0 * math.pi * radius, 2.0 * (length + 2.0 * radius))


@kernel
def cylinder_sample(out, number, radius, half_length):
    """out = sample point `number`, 0 to 26 [m]: nine in each of three planes, the first of them on the axis.

    Checked  tests/net_capture/test_shapes.py
    """
    level = number // (AROUND + 1) - 1
    place = number % (AROUND + 1)
    angle = 2.0 * math.pi * (place - 1) / AROUND
    out[0] = radius * math.cos(angle) if place > 0 else 0.0
    out[1] = radius * math.sin(angle) if place > 0 else 0.0
    out[2] = level * half_length


@kernel
def measure(p):
    """The box and the sphere around it, and its smallest girth [m].

    Checked  tests/net_capture/test_shapes.py
    """
    p.half_size[0] = p.target_radius
    p.half_size[1] = p.target_radius
    p.half_size[2] = 0.5 * p.target_length
    p.envelope_radius = math.sqrt(p.target_radius * p.target_radius + p.half_size[2] * p.half_size[2])
    p.girth = cylinder_girth(p.target_radius, p.target_length)


@kernel
def inertia(p, out):
    """out = m (3 r2 + l2) / 12 across the axis, m r2 / 2 about it [kg m2].

    Checked  tests/net_capture/test_shapes.py
    """
    across = p.target_mass * (3.0 * p.target_radius * p.target_radius + p.target_length * p.target_length) / 12.0
    out[0] = across
    out[1] = across
    out[2] = 0.5 * p.target_mass * p.target_radius * p.target_radius


@kernel
def distance(p, normal, point):
    """Signed distance [m] and outward normal, see `cylinder_distance`.

    Checked  tests/net_capture/test_shapes.py
    """
    return cylinder_distance(normal, point, p.target_radius, 0.5 * p.target_length)


@kernel
def sample(p, out, number, depth):
    """out = sample point [m] of the cylinder that is smaller by a depth all round, but not below nothing.

    Checked  tests/net_capture/test_shapes.py
    """
    cylinder_sample(out, number, max(p.target_radius - depth, 0.0), max(0.5 * p.target_length - depth, 0.0))


@kernel
def faces(p, out):
    """The faces of a prism within it, see `faces_around`.

    Checked  tests/net_capture/test_wrapping.py
    """
    around = faces_round(p.target_radius)
    return faces_around(out, around, p.target_radius, p.target_radius, -p.half_size[2], p.half_size[2])


def _half(values: Values) -> list[float]:
    return [values["target.radius"], values["target.radius"], 0.5 * values["target.length"]]


def _distance(values: Values, point: Point) -> float:
    a = math.hypot(point[0], point[1]) - values["target.radius"]
    b = abs(point[2]) - 0.5 * values["target.length"]
    return float(math.hypot(a, b) if a > 0.0 and b > 0.0 else max(a, b))


def _girth(values: Values) -> float:
    radius, length = values["target.radius"], values["target.length"]
    return float(min(2.0 * math.pi * radius, 2.0 * (length + 2.0 * radius)))


def _surface(values: Values) -> tuple[list[Point], list[list[int]]]:
    radius, half, n = values["target.radius"], 0.5 * values["target.length"], DRAWN_AROUND
    angles = [2.0 * math.pi * i / n for i in range(n)]
    corners: list[Point] = [[radius * math.cos(a), radius * math.sin(a), z] for z in (-half, half) for a in angles]
    walls = [[i, (i + 1) % n, n + (i + 1) % n, n + i] for i in range(n)]
    return corners, [list(range(n)), list(range(n, 2 * n)), *walls]


PART = Term(
    "cylinder",
    (
        positive("target.radius", "m", "of the cylinder about the third body axis", 2.0),
        positive("target.length", "m", "of the cylinder along the third body axis", 8.0),
    ),
    make=lambda composition: Shape(SAMPLES, measure, inertia, distance, sample, faces=faces),
    checks=Checks(
        _half,
        lambda values: math.hypot(values["target.radius"], 0.5 * values["target.length"]),
        _girth,
        _distance,
        _surface,
    ),
)
