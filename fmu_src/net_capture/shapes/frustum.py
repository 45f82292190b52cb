"""The frustum of a cone, and the cone as its limit: its axis along the third body axis, flat ends.

Body axes begin in the centre of mass, which lies off the middle of the axis towards the wider end.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from types import SimpleNamespace

import numpy as np

from fmu_src.implied import formula
from fmu_src.interface import Term
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.net_capture.shapes import Checks, Point, Shape, Values
from fmu_src.net_capture.shapes.cylinder import faces_around, faces_round
from fmu_src.rows import at_least_zero, positive, state
from orbital.kernel import kernel

AROUND = 8
"""Sample points in each of three planes: one on the axis, and so many around it."""
SAMPLES = 3 * (AROUND + 1)
DRAWN_AROUND = 24
TILTS, TURNS, CUTS = 91, 360, 40
"""Directions that the girth is looked for along, pieces of each silhouette, and cuts of the best interval."""
GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


@kernel
def frustum_distance(normal, point, bottom, top, length):
    """Signed distance [m] of a point from the surface of a frustum, negative inside; outward normal into `normal`.

    With a = sqrt(x2 + y2), z from the middle of the axis, and s how far the point lies beyond the wall, across it:

        max(s, |z| - l/2) inside; outside the distance from the nearest of wall, ends and rims

    point        in body axes, from the middle of the axis     [m]  (3,)
    normal       unit vector, body axes                        [1]  (3,)
    bottom, top  radii at z = -l/2 and z = l/2                 [m]
    length       l                                             [m]

    Valid    any point; on the axis the first body axis is taken for the way out
    Checked  tests/net_capture/test_shapes.py
    """
    across = math.sqrt(point[0] * point[0] + point[1] * point[1])
    x = point[0] / across if across > 0.0 else 1.0
    y = point[1] / across if across > 0.0 else 0.0
    half = 0.5 * length
    slant = math.sqrt(length * length + (bottom - top) * (bottom - top))
    out = length / slant
    up = (bottom - top) / slant
    beyond = (across - bottom) * out + (point[2] + half) * up
    along = (across - bottom) * -up + (point[2] + half) * out
    side = 1.0 if point[2] >= 0.0 else -1.0
    end = abs(point[2]) - half
    radius = top if side > 0.0 else bottom
    if (end > 0.0 and across <= radius) or (end <= 0.0 and beyond <= 0.0 and end > beyond):
        normal[0] = 0.0
        normal[1] = 0.0
        normal[2] = side
        return end
    if (beyond > 0.0 and 0.0 <= along <= slant) or (end <= 0.0 and beyond <= 0.0):
        normal[0] = out * x
        normal[1] = out * y
        normal[2] = up
        return beyond
    rim = bottom if along < 0.0 else top
    over = across - rim
    above = point[2] + half if along < 0.0 else point[2] - half
    distance = math.sqrt(over * over + above * above)
    normal[0] = over / distance * x
    normal[1] = over / distance * y
    normal[2] = above / distance
    return distance


@kernel
def frustum_center(bottom, top, length):
    """Place [m] of the centre of mass on the axis, from the middle.

        l (3 r_t2 + 2 r_t r_b + r_b2) / (4 (r_b2 + r_b r_t + r_t2)) - l/2

    Source   volume and first moment of radii that change evenly
    Checked  tests/net_capture/test_shapes.py
    """
    square = bottom * bottom + bottom * top + top * top
    return length * ((3.0 * top * top + 2.0 * top * bottom + bottom * bottom) / (4.0 * square) - 0.5)


@kernel
def frustum_inertia(out, mass, bottom, top, length):
    """out = principal moments about the centre of mass [kg m2], the axis last.

        I_z = 3/10 m (r_b4 + r_b3 r_t + r_b2 r_t2 + r_b r_t3 + r_t4)/(r_b2 + r_b r_t + r_t2)
        I_x = I_z/2 + m (l2 (6 r_t2 + 3 r_t r_b + r_b2)/(10 (r_b2 + r_b r_t + r_t2)) - (c + l/2)2)

    c            of `frustum_center`

    Source   second moments of radii that change evenly
    Checked  tests/net_capture/test_shapes.py
    """
    b, t = bottom, top
    square = b * b + b * t + t * t
    fourth = b * b * b * b + b * b * b * t + b * b * t * t + b * t * t * t + t * t * t * t
    out[2] = 0.3 * mass * fourth / square
    low = frustum_center(bottom, top, length) + 0.5 * length
    far = length * length * (6.0 * t * t + 3.0 * t * b + b * b) / (10.0 * square)
    out[0] = 0.5 * out[2] + mass * (far - low * low)
    out[1] = out[0]


@kernel
def silhouette(bottom, top, length, tilt):
    """Length [m] of the shortest cord round what is seen of a frustum along a direction at an angle to its axis [rad].

    By Cauchy's formula: the mean over all directions u in that plane of how far it reaches, times 2 pi,

        max(r_b e + (-l/2) sin(tilt) u_y, r_t e + (l/2) sin(tilt) u_y),   e = sqrt(u_x2 + cos(tilt)2 u_y2)

    Checked  tests/net_capture/test_shapes.py
    """
    total = 0.0
    rise, flat = 0.5 * length * math.sin(tilt), math.cos(tilt)
    for i in range(TURNS):
        turn = math.pi * ((i + 0.5) / TURNS - 0.5)
        x, y = math.cos(turn), math.sin(turn)
        wide = math.sqrt(x * x + flat * flat * y * y)
        total += max(bottom * wide - rise * y, top * wide + rise * y)
    return 2.0 * math.pi * total / TURNS


@kernel
def frustum_girth(bottom, top, length):
    """Smallest girth [m] of a frustum: the shortest of its silhouettes, which may lie askew to the axis.

    Valid    within 2e-5 of it
    Checked  tests/net_capture/test_shapes.py
    """
    best, at = math.inf, 0
    for i in range(TILTS):
        found = silhouette(bottom, top, length, 0.5 * math.pi * i / (TILTS - 1))
        if found < best:
            best, at = found, i
    low = 0.5 * math.pi * max(at - 1, 0) / (TILTS - 1)
    high = 0.5 * math.pi * min(at + 1, TILTS - 1) / (TILTS - 1)
    for _ in range(CUTS):
        left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        if silhouette(bottom, top, length, left) < silhouette(bottom, top, length, right):
            high = right
        else:
            low = left
    return min(best, silhouette(bottom, top, length, 0.5 * (low + high)))


@kernel
def frustum_sample(out, number, bottom, top, length, depth):
    """out = sample point `number`, 0 to 26, from the middle of the axis [m]: nine in each of three planes, the first
    of them on the axis, each so deep below ends and wall, as far as there is such a depth.

    Checked  tests/net_capture/test_shapes.py
    """
    slant = math.sqrt(length * length + (bottom - top) * (bottom - top))
    steep = abs(bottom - top) / slant
    below = min(depth, 0.5 * length, max(bottom, top) * length / slant / (1.0 + steep))
    low, high = below - 0.5 * length, 0.5 * length - below
    slope = (top - bottom) / length
    middle = 0.5 * (bottom + top)
    if slope < 0.0:
        high = max(min(high, (below * slant / length - middle) / slope), low)
    elif slope > 0.0:
        low = min(max(low, (below * slant / length - middle) / slope), high)
    out[2] = low + 0.5 * (high - low) * (number // (AROUND + 1))
    radius = max(middle + slope * out[2] - depth * slant / length, 0.0)
    place = number % (AROUND + 1)
    angle = 2.0 * math.pi * (place - 1) / AROUND
    out[0] = radius * math.cos(angle) if place > 0 else 0.0
    out[1] = radius * math.sin(angle) if place > 0 else 0.0


@kernel
def measure(p):
    """The box and the sphere around it, and its smallest girth [m].

    Checked  tests/net_capture/test_shapes.py
    """
    bottom = p.target_radius_bottom
    top = p.target_radius_top
    p.shape_center = frustum_center(bottom, top, p.target_length)
    low = 0.5 * p.target_length + p.shape_center
    high = 0.5 * p.target_length - p.shape_center
    p.half_size[0] = max(bottom, top)
    p.half_size[1] = max(bottom, top)
    p.half_size[2] = max(low, high)
    p.target_edge = (4.0 * max(bottom, top) + p.target_length) / 3.0
    p.envelope_radius = math.sqrt(max(bottom * bottom + low * low, top * top + high * high))
    p.girth = frustum_girth(bottom, top, p.target_length)


@kernel
def inertia(p, out):
    """out = principal moments [kg m2], see `frustum_inertia`.

    Checked  tests/net_capture/test_shapes.py
    """
    frustum_inertia(out, p.target_mass, p.target_radius_bottom, p.target_radius_top, p.target_length)


@kernel
def distance(p, normal, point):
    """Signed distance [m] and outward normal, see `frustum_distance`.

    Checked  tests/net_capture/test_shapes.py
    """
    middle = p.shape_half
    middle[0] = point[0]
    middle[1] = point[1]
    middle[2] = point[2] + p.shape_center
    return frustum_distance(normal, middle, p.target_radius_bottom, p.target_radius_top, p.target_length)


@kernel
def sample(p, out, number, depth):
    """out = sample point [m], see `frustum_sample`.

    Checked  tests/net_capture/test_shapes.py
    """
    frustum_sample(out, number, p.target_radius_bottom, p.target_radius_top, p.target_length, depth)
    out[2] -= p.shape_center


@kernel
def faces(p, out):
    """The faces of a pyramid within it, see `cylinder.faces_around`.

    Checked  tests/net_capture/test_wrapping.py
    """
    low = -0.5 * p.target_length - p.shape_center
    around = faces_round(max(p.target_radius_bottom, p.target_radius_top))
    return faces_around(out, around, p.target_radius_bottom, p.target_radius_top, low, low + p.target_length)


def _sizes(values: Values) -> tuple[float, float, float]:
    return values["target.radius_bottom"], values["target.radius_top"], values["target.length"]


def _measured(values: Values) -> SimpleNamespace:
    """What `measure` finds, but for the girth."""
    bottom, top, length = _sizes(values)
    center = formula(frustum_center)(bottom, top, length)
    low, high = 0.5 * length + center, 0.5 * length - center
    half = [max(bottom, top), max(bottom, top), max(low, high)]
    return SimpleNamespace(center=center, half=half, radius=max(math.hypot(bottom, low), math.hypot(top, high)))


def _distance(values: Values, point: Point) -> float:
    middle = [point[0], point[1], point[2] + _measured(values).center]
    return float(formula(frustum_distance)(np.empty(3), middle, *_sizes(values)))


def drawn(bottom: float, top: float, length: float, middle: float) -> tuple[list[Point], list[list[int]]]:
    """Corners [m] and faces, to draw it by; `middle` of the axis on the third body axis [m]."""
    n = DRAWN_AROUND
    ends = ((bottom, middle - 0.5 * length), (top, middle + 0.5 * length))
    angles = [2.0 * math.pi * i / n for i in range(n)]
    corners: list[Point] = [[r * math.cos(a), r * math.sin(a), z] for r, z in ends for a in angles]
    walls = [[i, (i + 1) % n, n + (i + 1) % n, n + i] for i in range(n)]
    return corners, [list(range(n)), list(range(n, 2 * n)), *walls]


def refuses(scene: Scene) -> Iterator[Refusal]:
    """A frustum of no width."""
    if scene.values["target.radius_bottom"] == scene.values["target.radius_top"] == 0.0:
        yield Refusal("target.radius_top", "0 m", "must be greater than 0 where target.radius_bottom is 0")


PART = Term(
    "frustum of a cone, or a cone where one radius is 0",
    (
        at_least_zero("target.radius_bottom", "m", "of its end at the lower end of the third body axis", 2.0),
        at_least_zero("target.radius_top", "m", "of its end at the upper end of the third body axis", 1.0),
        positive("target.length", "m", "of the frustum along the third body axis", 4.0),
        state("shape_center", "m", "of the centre of mass on the axis, from its middle"),
    ),
    make=lambda composition: Shape(SAMPLES, measure, inertia, distance, sample, faces=faces),
    refuses=refuses,
    checks=Checks(
        lambda values: _measured(values).half,
        lambda values: _measured(values).radius,
        lambda values: float(formula(frustum_girth)(*_sizes(values))),
        _distance,
        lambda values: drawn(*_sizes(values), -_measured(values).center),
    ),
)
