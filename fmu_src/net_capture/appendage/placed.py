"""Whether a hinge lies where its scene may have meant it: its axis near both bodies, the appendage out of the rest.

Both bodies do not touch each other in a capture, so one may swing through the other. How deep it is in goes by points
within each of its pieces, as far below the surface as half that piece is thick: a thin wing's middle, a rod's axis.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from fmu_src.cautions import Caution
from fmu_src.implied import formula
from fmu_src.net_capture.appendage.laying import pieces_at
from fmu_src.net_capture.hinge import numbers as at
from fmu_src.net_capture.shapes import pieces as of
from fmu_src.net_capture.shapes import solids
from fmu_src.net_capture.shapes.union import PIECES, WORDS, in_body_axes, piece_distance

Array = npt.NDArray[np.float64]
Values = Mapping[str, Any]

FAR = 0.1
"""Share of the target's radius: an axis farther from both bodies is off them; a piece so far in the other body, or half
its own thickness if that is less, may lie against it."""
ROUNDED = 0.01
"""Share of the target's radius, or half of half the other piece's thickness if that is less, that is not told."""
ALONG, GRID = 401, 9
"""Points of the axis, and along each edge of the points within a piece."""
DEGREES = 5.0
"""Between the angles that are looked at."""
FEET = 50
"""Points on either piece by which it is found how far two lie apart."""
AT_ONCE = 2.0
"""Substeps within which a stop is met at once."""


class Off(NamedTuple):
    """How far the axis passes the rest and the appendage, and how far these lie apart as drawn [m]."""

    rest: float
    appendage: float
    apart: float


def _within(piece: of.Piece) -> tuple[Array, float]:
    """Points of a piece as deep as half its thickness, (n, 3) in its own axes, and that depth [m]."""
    grid = np.linspace(-1.0, 1.0, GRID)
    if piece.kind == of.SHELL:
        radius, length, thickness, angle = piece.sizes
        deep, middle = 0.5 * thickness, radius - 0.5 * thickness
        found = [
            (middle * math.cos(a), middle * math.sin(a), z)
            for a in 0.5 * angle * grid
            for z in (0.5 * length - deep) * grid
        ]
        return np.array(found), deep
    half = of.half_of(piece)
    if piece.kind == of.FRUSTUM:
        half[:2] = 0.5 * (piece.sizes[0] + piece.sizes[1])
    deep = float(half.min())
    spread = [grid * (edge - deep) if edge > deep else np.zeros(1) for edge in half]
    own = np.array(list(itertools.product(*spread)))
    if piece.kind in (of.CYLINDER, of.FRUSTUM):
        own = own[np.hypot(own[:, 0], own[:, 1]) <= half[0] - deep + 1e-12]
    return own, deep


def _distance(row: Array, piece: of.Piece, points: Array) -> float:
    """Least signed distance of points from a piece [m]; a row of the table and the piece it says, both body axes."""
    away, normal = formula(piece_distance), np.empty(3)
    return min(float(away(row, normal, point)) for point in (points - piece.place) @ piece.turn)


def _apart(*pair: tuple[Array, of.Piece]) -> float:
    """How far two pieces lie apart [m]: the foot of a point on the one, of that on the other, and so forth; 0 where
    they overlap.

    Valid    convex pieces; between shells no less than it is
    """
    away, normal = formula(piece_distance), np.empty(3)
    point, before = pair[1][1].place, pair[1][1].place
    for number in range(2 * FEET):
        row, piece = pair[number % 2]
        before, far = point, float(away(row, normal, (point - piece.place) @ piece.turn))
        point = point - max(far, 0.0) * (piece.turn @ normal)
    return float(np.linalg.norm(point - before))


class _Bodies:
    """Pieces of rest and appendage at an angle, body axes."""

    def __init__(self, values: Values, angle: float) -> None:
        rows = pieces_at(values, angle)
        swings = values[at.BODY][at.PIECES : at.PIECES + len(rows)] != 0.0
        found = list(zip(rows, in_body_axes(rows), strict=True))
        self.rest, self.appendage = (
            [pair for pair, swung in zip(found, swings, strict=True) if swung == side] for side in (False, True)
        )

    def sunk(self) -> dict[tuple[int, int], tuple[float, float, float]]:
        """By numbers of a piece of the appendage and one of the rest: how deep the one is in the other, half the
        thickness of each [m]; of those that are near."""
        found = {}
        for i, (_, piece) in enumerate(self.appendage):
            own, deep = _within(piece)
            points = piece.place + own @ piece.turn.T
            for k, (row, other) in enumerate(self.rest):
                if np.linalg.norm(points - row[5:8], axis=1).min() < row[17] + deep:
                    half = 0.5 * of.thickness_of(other)
                    found[i, k] = (deep - _distance(row, other, points), deep, half)
        return found


def off_axis(values: Values) -> Off | None:
    """How far the axis of the hinge lies off both bodies as they are drawn; None where it passes one of them as near
    as `FAR` of the target's radius, or no farther than they lie apart.

    Valid    a line, on which the position that the scene gives is any point
    Checked  tests/net_capture/test_hinge_placed.py
    """
    table, radius = values[at.BODY], float(values["target.solid"][solids.RADIUS])
    hinge, axis = table[at.HINGE : at.AXIS], table[at.AXIS : at.ARM]
    foot, bodies = hinge - (hinge @ axis) * axis, _Bodies(values, 0.0)
    line = foot + np.linspace(-2.0, 2.0, ALONG)[:, None] * radius * axis
    far = [min(_distance(row, piece, line) for row, piece in side) for side in (bodies.rest, bodies.appendage)]
    if min(far) <= FAR * radius:
        return None
    apart = min(_apart(one, two) for one in bodies.rest for two in bodies.appendage)
    return Off(far[0], far[1], apart) if min(far) > FAR * radius + apart else None


class Sunk:
    """How deep the appendage is in the rest at an angle of its hinge.

    Checked  tests/net_capture/test_hinge_placed.py
    """

    def __init__(self, values: Values) -> None:
        self.values, self.radius = values, float(values["target.solid"][solids.RADIUS])
        self.drawn = _Bodies(values, 0.0).sunk()

    def at(self, angle: float) -> float:
        """Depth [m]; 0 where it is no deeper than as drawn, or than a wing that lies against the rest."""
        deepest = 0.0
        for pair, (depth, deep, half) in _Bodies(self.values, angle).sunk().items():
            drawn = self.drawn[pair][0] if pair in self.drawn else 0.0
            allowed = max(drawn, min(deep, FAR * self.radius))
            if depth > allowed + min(ROUNDED * self.radius, 0.5 * half):
                deepest = max(deepest, depth)
        return deepest


class Swing(NamedTuple):
    """What the limit of a hinge lets the appendage do: the largest angle that keeps it out of the rest [rad], at which
    it is deepest in it, and how deep it is there [m]."""

    free: float
    worst: float
    deepest: float


def swing_of(values: Values) -> Swing:
    """Of both sides, every `DEGREES` or less.

    Checked  tests/net_capture/test_hinge_placed.py
    """
    return _swing(values[at.BODY].tobytes(), values[PIECES].tobytes(), values["target.solid"].tobytes())


@lru_cache(maxsize=8)
def _swing(body: bytes, pieces: bytes, solid: bytes) -> Swing:
    values = {at.BODY: np.frombuffer(body), PIECES: np.frombuffer(pieces).reshape(-1, WORDS)}
    sunk, limit = Sunk(values | {"target.solid": np.frombuffer(solid)}), float(values[at.BODY][at.LIMIT])
    steps = max(1, math.ceil(math.degrees(limit) / DEGREES))
    free, worst, deepest = limit, 0.0, 0.0
    for number in range(1, steps + 1):
        for angle in (limit * number / steps, -limit * number / steps):
            depth = sunk.at(angle)
            if depth > 0.0:
                free = min(free, limit * (number - 1) / steps)
            if depth > deepest:
                worst, deepest = angle, depth
    return Swing(free, worst, deepest)


def cautions(values: Values, substep: float) -> Iterator[Caution]:
    """What a user may not expect of where a hinge lies, and of how fast it turns as it starts.

    substep       of the capture                                        [s]

    Checked  tests/net_capture/test_hinge_placed.py
    """
    off = off_axis(values)
    if off is not None:
        yield Caution(
            "hinge.position",
            f"the axis passes the rest of the target at {off.rest:.3g} m and the appendage at {off.appendage:.3g} m, "
            f"which lie {off.apart:.3g} m apart: both turn about it as if on arms without mass; expected on one of "
            "them or between them",
        )
    start = float(values["hinge.start_angle"])
    depth = Sunk(values).at(start)
    if depth > 0.0:
        yield Caution(
            "hinge.start_angle",
            f"at {math.degrees(start):.4g} deg the appendage is {depth:.2g} m deep in the rest of the target, through "
            "which it swings as if it were not there; expected an angle at which it is out of it",
        )
    limit, swing = float(values[at.BODY][at.LIMIT]), swing_of(values)
    if swing.deepest > 0.0:
        keeps = (
            f"a limit of {math.degrees(swing.free):.3g} deg keeps it out" if swing.free > 0.0 else "none keeps it out"
        )
        yield Caution(
            "hinge.limit",
            f"{math.degrees(limit):.4g} deg let the appendage swing into the rest of the target, "
            f"{swing.deepest:.2g} m deep at {math.degrees(swing.worst):.3g} deg, as if that were not there, where its "
            f"spring does not hold it back; {keeps}",
        )
    yield from _fast(values, substep)


def _fast(values: Values, substep: float) -> Iterator[Caution]:
    """A start at which the stop is met at once, or the net goes through what turns so fast."""
    table, rate, start = values[at.BODY], float(values["hinge.start_rate"]), float(values["hinge.start_angle"])
    if rate == 0.0:
        return
    left, told = float(table[at.LIMIT]) - math.copysign(start, rate * start), f"{math.degrees(rate):.4g} deg/s"
    if left < AT_ONCE * substep * abs(rate):
        yield Caution(
            "hinge.start_rate",
            f"at {told} the stop at {math.degrees(table[at.LIMIT]):.4g} deg, {math.degrees(left):.3g} deg on, is met "
            f"within {AT_ONCE:g} substeps of {substep:.2g} s and takes that motion at once; expected slower",
        )
    rows = pieces_at(values, 0.0)
    swings = table[at.PIECES : at.PIECES + len(rows)] != 0.0
    pieces = [piece for piece, swung in zip(in_body_axes(rows), swings, strict=True) if swung]
    half = 0.5 * min(of.thickness_of(piece) for piece in pieces)
    way = abs(rate) * float(table[at.REACH]) * substep
    if way > half:
        yield Caution(
            "hinge.start_rate",
            f"at {told} the appendage moves up to {way:.2g} m in a substep of {substep:.2g} s, and half its thickness "
            f"is {half:.2g} m: it goes through nodes of the net without touching them; expected at most "
            f"{math.degrees(half / (float(table[at.REACH]) * substep)):.3g} deg/s",
        )
