"""Pieces of a union whose seam nodes can slip into: those that touch in a line or a point, and narrow slits.

Where faces of two pieces lie on one another contact knows that they are no way out (`union.contact_distance`). Where a
round piece lies on another one there is a wedge between them that comes to nothing, and nodes have no size: they go
beneath the line in which the two touch. A slit that is narrower than a node may go deep lets them in as well.
"""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import combinations

import numpy as np
import numpy.typing as npt

from fmu_src.implied import formula
from fmu_src.net_capture.shapes import Values, solids
from fmu_src.net_capture.shapes import pieces as of
from fmu_src.net_capture.shapes.union import PIECES, SLIT, WORDS, in_body_axes, piece_distance

Array = npt.NDArray[np.float64]

SEAM = 1e-3
"""Distance, as a share of the body's radius, within which pieces touch: as deep as a node may go."""
AROUND = 16
"""Places round a point in which two pieces touch that tell whether faces do: two neighbours that lie between both."""

ROUNDED = 1e-9
"""Metres by which faces may seem apart."""


def _outward(piece: of.Piece) -> Array:
    """Directions, along the axis and across it, in which what spans a piece lies at its surface, body axes."""
    own = (of.spanning(piece, False) - piece.place) @ piece.turn
    out = np.sign(own)
    if piece.kind != of.BOX:
        across = np.linalg.norm(own[:, :2], axis=1, keepdims=True)
        out[:, :2] = np.divide(own[:, :2], across, out=np.zeros_like(own[:, :2]), where=across > 0.0)
    return np.asarray(out @ piece.turn.T)


def open_seams(values: Values) -> tuple[tuple[int, int], ...]:
    """Pairs of pieces, from 1, that are nearer to one another than `SEAM` of the body's radius or reach in by less, and
    of which no faces lie on one another.

    Checked  tests/net_capture/test_seams.py
    """
    rows = np.ascontiguousarray(values[PIECES])
    return _open_seams(rows.tobytes(), SEAM * float(values["target.solid"][solids.RADIUS]))


@lru_cache(maxsize=8)
def _open_seams(content: bytes, near: float) -> tuple[tuple[int, int], ...]:
    rows = np.frombuffer(content).reshape(-1, WORDS)
    found = list(in_body_axes(rows))
    away, normal = formula(piece_distance), np.empty(3)

    def distance(number: int, point: Array) -> float:
        """Of a point from a piece, whose outward normal there is in `normal`, body axes."""
        piece = found[number]
        far = float(away(rows[number], normal, (point - piece.place) @ piece.turn))
        normal[:] = piece.turn @ normal
        return far

    def points(inner: int, below: float) -> Array:
        """What spans a piece, moved beneath its surface."""
        return np.asarray(of.spanning(found[inner], False) - below * _outward(found[inner]))

    def nearest(inner: int, outer: int, below: float) -> float:
        """Least distance from a piece of what spans another."""
        return min(distance(outer, point) for point in points(inner, below))

    def face_to_face(inner: int, outer: int) -> bool:
        """Whether a face of a piece lies on one of another, beneath a point of what spans it."""
        for point in points(inner, near):
            far = distance(outer, point)
            out = normal.copy()
            foot = point - far * out
            gap = distance(inner, foot)
            if gap > SLIT:
                continue
            over = 2.0 * max(gap, ROUNDED)
            one = np.cross(out, np.eye(3)[int(np.argmin(np.abs(out)))])
            one /= np.linalg.norm(one)
            other, between = np.cross(out, one), []
            for turn in 2.0 * math.pi * np.arange(AROUND) / AROUND:
                beside = foot + 0.5 * near * (math.cos(turn) * one + math.sin(turn) * other)
                within = distance(outer, beside - over * out) < 0.0
                between.append(within and distance(inner, beside + over * out) < 0.0)
            if any(between[k - 1] and between[k] for k in range(AROUND)):
                return True
        return False

    def slips(one: int, two: int) -> bool:
        ways = (one, two), (two, one)
        if np.linalg.norm(found[one].place - found[two].place) > rows[one][17] + rows[two][17] + near:
            return False
        if min(nearest(*way, 0.0) for way in ways) > near or min(nearest(*way, near) for way in ways) <= 0.0:
            return False
        return not any(face_to_face(*way) for way in ways)

    return tuple((one + 1, two + 1) for one, two in combinations(range(len(found)), 2) if slips(one, two))
