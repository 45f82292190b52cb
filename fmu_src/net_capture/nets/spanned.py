"""The faces between threads, as they are seen through the mouth.

Looked at from a point on the shot's axis in front of the mouth, a net without crossings is a plane drawing, and its
faces are what its lines enclose: at every node the threads stand in a circle, and who comes along one and leaves by the
next on one side goes once round a face. Euler's formula, nodes - threads + faces = 2, holds for a drawing without
crossings alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt


class Crossing(Exception):
    """Lines cross, or the rim is not the outermost."""


def faces_of(
    places: npt.NDArray[np.float64], near: Sequence[Sequence[int]], rim: npt.NDArray[np.int64]
) -> list[list[int]]:
    """Nodes of every face, turning as the rim does.

    places   along the mouth's axes and the shot, (n, 3) [m]
    near     to which nodes threads lead from each
    rim      nodes of the mouth, once round, turning from x to y
    """
    front = 2.0 * float(np.abs(places).max())
    seen = places[:, :2] * (front / (front - places[:, 2:]))
    beyond = ~_within(seen, seen[rim])
    beyond[rim] = False
    if beyond.any():
        raise Crossing
    after: dict[tuple[int, int], tuple[int, int]] = {}
    for here, others in enumerate(near):
        way = [math.atan2(*(seen[other] - seen[here])[::-1].tolist()) for other in others]
        circle = [others[k] for k in np.argsort(way, kind="stable")]
        # who comes from one leaves by the one before it in the circle: faces are on the left
        after |= {(one, here): (here, circle[k - 1]) for k, one in enumerate(circle)}
    faces = []
    while after:
        first = edge = next(iter(after))
        face = []
        while edge in after:
            face.append(edge[0])
            edge = after.pop(edge)
        if edge != first:
            raise Crossing
        faces.append(face)
    threads = sum(map(len, near)) // 2
    if len(near) - threads + len(faces) != 2:
        raise Crossing
    inner = [face for face in faces if not _is_round(face, rim, seen)]
    if len(inner) != len(faces) - 1:
        raise Crossing
    return inner


def _within(points: npt.NDArray[np.float64], line: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
    """Which points a closed line surrounds: a ray from such a one crosses it an odd number of times."""
    inside = np.zeros(len(points), dtype=np.bool_)
    x, y = points.T
    for (x0, y0), (x1, y1) in zip(line, np.roll(line, -1, axis=0), strict=True):
        crosses = (y0 > y) != (y1 > y)
        if crosses.any():
            inside ^= crosses & (x < x0 + (y - y0) * (x1 - x0) / (y1 - y0 if y1 != y0 else 1.0))
    return inside


def _is_round(face: list[int], rim: npt.NDArray[np.int64], seen: npt.NDArray[np.float64]) -> bool:
    """Whether a face is what lies outside of the rim."""
    if len(face) != len(rim) or set(face) != set(rim.tolist()):
        return False
    x, y = seen[face].T
    return bool(x @ np.roll(y, -1) - np.roll(x, -1) @ y < 0.0)
