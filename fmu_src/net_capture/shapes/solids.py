"""What is worked out of a body of any shape before there is an FMU of it: principal axes, girth, sample points.

It goes into the FMU as two tables. `solid` has, SI and in body axes where nothing else is said:

    moments per kg (3); turn from the body to the design axes as a quaternion (4); centre of mass in the design axes
    (3); half the edges of the box around it (3); radius of the sphere around it; girth, and its error; least thickness

Body axes are the principal axes through the centre of mass, which are those nearest to the design axes.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from fmu_src.implied import Implied
from fmu_src.net_capture.shapes.samples import SAMPLES

Array = npt.NDArray[np.float64]

MOMENTS, TURN, CENTER, HALF, RADIUS, GIRTH, GIRTH_ERROR, THICKNESS, EDGE = 0, 3, 7, 10, 13, 14, 15, 16, 17
SOLID = 18
"""Numbers of the table `solid`, and where each begins."""
ALIGNED = 1e-9
"""Products of inertia, as a share of the largest moment, below which the design axes are principal axes."""
WAYS, ANGLES, BEST = 300, 48, 3
"""Directions in which the girth is looked for, angles of each silhouette, and how many of the best are followed."""
FALLING = 0.2
"""Depth per way that leads a sample point inward: less than a box has along its diagonal, more than nothing."""


class Solid(NamedTuple):
    """A body: its mass [kg], principal moments [kg m2] (3,), the matrix from its body to the design axes (3, 3) and its
    centre of mass in the design axes [m] (3,)."""

    mass: float
    moments: Array
    turn: Array
    center: Array

    def to_body(self, points: Array) -> Array:
        """Points of the design axes in body axes [m] (n, 3)."""
        return np.asarray((points - self.center) @ self.turn)


def solid_of(mass: float, center: Array, tensor: Array) -> Solid:
    """The principal axes of a body, of its tensor of inertia about its centre of mass [kg m2] (3, 3), design axes.

    They are named and directed so that they lie nearest to the design axes; these are taken where they are principal.

    Checked  tests/net_capture/test_pieces.py
    """
    products = np.abs(tensor - np.diag(np.diag(tensor))).max()
    if products <= ALIGNED * np.abs(tensor).max():
        return Solid(mass, np.diag(tensor).copy(), np.eye(3), center)
    moments, axes = np.linalg.eigh(tensor)
    order = max(itertools.permutations(range(3)), key=lambda o: sum(abs(axes[i, o[i]]) for i in range(3)))
    moments, axes = moments[list(order)], axes[:, order]
    axes = axes * np.where(np.diag(axes) < 0.0, -1.0, 1.0)
    if np.linalg.det(axes) < 0.0:
        axes[:, int(np.argmin(np.abs(np.diag(axes))))] *= -1.0
    return Solid(mass, moments, axes, center)


def quaternion(matrix: Array) -> Array:
    """Unit quaternion, scalar first, of a rotation matrix (3, 3), from the largest of its components on.

    Source   Shepperd, Journal of Guidance and Control 1 (1978) 223
    Checked  tests/net_capture/test_pieces.py
    """
    m = matrix
    products = np.array([
        [1.0 + m[0, 0] + m[1, 1] + m[2, 2], m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]],
        [m[2, 1] - m[1, 2], 1.0 + m[0, 0] - m[1, 1] - m[2, 2], m[1, 0] + m[0, 1], m[0, 2] + m[2, 0]],
        [m[0, 2] - m[2, 0], m[1, 0] + m[0, 1], 1.0 - m[0, 0] + m[1, 1] - m[2, 2], m[2, 1] + m[1, 2]],
        [m[1, 0] - m[0, 1], m[0, 2] + m[2, 0], m[2, 1] + m[1, 2], 1.0 - m[0, 0] - m[1, 1] + m[2, 2]],
    ])  # fmt: skip
    row = products[int(np.argmax(np.diag(products)))]
    return np.asarray(row / np.linalg.norm(row) * (-1.0 if row[0] < 0.0 else 1.0))


def directions(count: int) -> Array:
    """Unit vectors (count, 3) spread evenly over half a sphere, by the golden angle, and the axes."""
    z = (np.arange(count) + 0.5) / count
    turn = math.pi * (3.0 - math.sqrt(5.0)) * np.arange(count)
    across = np.sqrt(1.0 - z * z)
    return np.vstack([np.eye(3), np.column_stack([across * np.cos(turn), across * np.sin(turn), z])])


def girth(points: Array, along: Array | None = None) -> tuple[float, Array]:
    """Smallest girth [m] of the hull of some points [m] (n, 3), the shortest closed cord that can be passed over it,
    and the direction (3,) along which it passes.

    A cord passes over a convex body along a direction when it goes round what is seen of it along that direction, so it
    is the least perimeter of a silhouette over all directions. First by Cauchy's formula on a sphere of directions,
    then from the best of them, or from `along`, by the method of Nelder and Mead with the hull of each silhouette.

    Valid    a body that is not convex is taken for its hull: a cord does not go into its hollows
    Source   definition; Cauchy's formula for the perimeter, the mean width times pi
    Checked  tests/net_capture/test_pieces.py
    """
    least, way = _girth(np.asarray(points, float).tobytes(), None if along is None else tuple(map(float, along)))
    return least, np.array(way)


@lru_cache(maxsize=256)
def _girth(content: bytes, along: tuple[float, ...] | None) -> tuple[float, tuple[float, ...]]:
    """It; the scenes of a sweep, and those read again, have one body among them."""
    from scipy.optimize import minimize
    from scipy.spatial import ConvexHull

    points = np.frombuffer(content).reshape(-1, 3)
    corners = points[ConvexHull(points).vertices]
    ways = directions(WAYS) if along is None else np.array([along])
    first, second = _across(ways)
    x, y = corners @ first.T, corners @ second.T
    perimeter = np.zeros(len(ways))
    for angle in 2.0 * math.pi * np.arange(ANGLES) / ANGLES:
        perimeter += (math.cos(angle) * x + math.sin(angle) * y).max(axis=0) * 2.0 * math.pi / ANGLES

    def round_it(way: Array) -> float:
        one, two = _across(way[None, :] / np.linalg.norm(way))
        return float(ConvexHull(np.column_stack([corners @ one[0], corners @ two[0]])).area)

    starts = ways[np.argsort(perimeter, kind="stable")[:BEST]]
    options: Any = {"xatol": 1e-5, "fatol": 1e-8, "maxiter": 100}
    found = [minimize(round_it, way, method="Nelder-Mead", options=options) for way in starts]
    best = min(found, key=lambda each: float(each.fun))
    return float(best.fun), tuple(map(float, best.x))


def _across(ways: Array) -> tuple[Array, Array]:
    """Two unit vectors across each of some unit vectors, and across each other (n, 3)."""
    helper = np.eye(3)[np.argmin(np.abs(ways), axis=1)]
    first = np.cross(ways, helper)
    first /= np.linalg.norm(first, axis=1)[:, None]
    return first, np.cross(ways, first)


def table(body: Solid, inner: Array, outer: Array, thickness: float) -> Array:
    """The table `solid` of a body.

    inner, outer   points whose hulls lie in its hull and around it [m] (n, 3), body axes: the same where it has none
                   but flat faces
    thickness      the least of it [m]
    """
    numbers = np.empty(SOLID)
    numbers[MOMENTS:TURN] = body.moments / body.mass
    numbers[TURN:CENTER] = quaternion(body.turn)
    numbers[CENTER:HALF] = body.center
    numbers[HALF:RADIUS] = np.abs(outer).max(axis=0)
    numbers[RADIUS] = np.linalg.norm(outer, axis=1).max()
    least, along = girth(inner)
    most, _ = (least, along) if inner is outer else girth(outer, along)
    numbers[GIRTH], numbers[GIRTH_ERROR] = 0.5 * (least + most), 0.5 * (most - least)
    numbers[THICKNESS] = thickness
    numbers[EDGE] = np.ptp(outer, axis=0).mean()
    return numbers


def rows(values: Mapping[str, Any]) -> Iterator[Implied]:
    """What a scene's values come to: mass, inertia, where body axes lie, and girth."""
    numbers = values["target.solid"]
    yield Implied("target.mass", "mass of the target", values["target.mass"], "kg")
    for i, name in enumerate(("first", "second", "third")):
        moment = values["target.mass"] * numbers[MOMENTS + i]
        yield Implied(f"target.inertia_{i + 1}", f"its moment of inertia about its {name} body axis", moment, "kg.m2")
    for i, name in enumerate(("first", "second", "third")):
        place = numbers[CENTER + i]
        yield Implied(f"target.center_{i + 1}", f"its centre of mass along the {name} design axis", place, "m")
    turned = 2.0 * math.acos(min(1.0, abs(numbers[TURN])))
    yield Implied("target.turned", "turn of its body axes, which are principal, from its design axes", turned, "rad")
    yield Implied("target.girth", "its smallest girth", numbers[GIRTH], "m")
    yield Implied("target.girth_error", "by which that may be off", numbers[GIRTH_ERROR], "m")
    yield Implied("target.thickness", "its least thickness", numbers[THICKNESS], "m")


def _between(start: Array, end: Array) -> Array:
    """Points on the way from one to the other, the start left out."""
    return np.asarray(start + (end - start) * np.linspace(0.0, 1.0, 6)[1:, None])


def samples(
    points: Array, depth: Callable[[Array], Array], surface: Array, leads: Callable[[int], npt.NDArray[np.bool_]]
) -> Array:
    """The table `samples`: where each sample point lies on the surface, and where it is led from there, (27, 6) [m].

    The first is the deepest point there is, the others are spread over the surface, each the farthest from those
    before.

    points    inside the body, (n, 3) [m]
    depth     of points below the surface [m]
    surface   points on it, (m, 3) [m]; each can be reached from one of `points` in a straight line
    leads     which of `points` lie in the same part of the body as one of the surface, (n,)

    Checked  tests/net_capture/test_pieces.py
    """
    deep = depth(points)
    chosen = [int(np.argmax(np.linalg.norm(surface, axis=1)))]
    apart = np.linalg.norm(surface - surface[chosen[0]], axis=1)
    while len(chosen) < SAMPLES - 1:
        chosen.append(int(np.argmax(apart)))
        apart = np.minimum(apart, np.linalg.norm(surface - surface[chosen[-1]], axis=1))
    middle = points[int(np.argmax(deep))]
    rows = [np.concatenate([middle, middle])]
    for number in chosen:
        start, there = surface[number], leads(number)
        worth = deep[there] - FALLING * np.linalg.norm(points[there] - start, axis=1)
        ends = points[there][np.argsort(-worth, kind="stable")]
        rows.append(np.concatenate([start, next(end for end in ends if depth(_between(start, end)).min() > 0.0)]))
    return np.array(rows)
