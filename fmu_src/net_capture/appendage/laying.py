"""The table of a hinged appendage, from the pieces of a scene: masses, where the hinge is, and what holds at any angle.

Box, sphere, girth and what an impulse gives at most are those of the worst of `ANGLES` angles within the limit; between
them box and sphere are widened by as far as a point can move. The girth is the least of `GIRTHS` angles: a cord that
passes over the target in none of them holds it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from fmu_src.implied import Implied, formula
from fmu_src.interface import Laid, Undesigned
from fmu_src.net_capture.hinge import numbers as at
from fmu_src.net_capture.shapes import pieces as of
from fmu_src.net_capture.shapes import solids
from fmu_src.net_capture.shapes.samples import SAMPLES
from fmu_src.net_capture.shapes.union import (
    PARTS,
    PIECES,
    body_of,
    in_body_axes,
    piece_distance,
    pieces_table,
    swinging,
)
from fmu_src.net_capture.shapes.union import lay as lay_union

Array = npt.NDArray[np.float64]

ANGLES, GIRTHS = 181, 7
"""Angles from the limit on one side to that on the other."""
BEYOND = 0.01
"""Radians that it may be carried beyond its limit within a substep."""


def turn_about(axis: Array, angle: float) -> Array:
    """Matrix (3, 3) that turns about a unit axis by an angle [rad]."""
    x, y, z = axis
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    found: Array = np.eye(3) + math.sin(angle) * across + (1.0 - math.cos(angle)) * across @ across
    return found


def lay(values: Mapping[str, float], sources: Mapping[str, Array]) -> Laid:
    """The table of the hinge, from what a scene says of it and of the pieces."""
    if PARTS not in sources:
        return Laid({}, {})  # another shape, which is refused
    rows, swings = sources[PARTS], swinging(sources[PARTS])
    if not swings.any():
        expected = "one or more of them must say `hinged = true`: what [capture.hinge] holds"
        raise Undesigned("target.parts", f"{len(rows)} pieces", expected)
    if swings.all():
        expected = "one or more of them must not be hinged: [capture.hinge] joins two bodies"
        raise Undesigned("target.parts", f"{len(rows)} pieces, all of them hinged", expected)
    if len(rows) > at.MOST_PIECES:
        raise Undesigned(
            "target.parts", f"{len(rows)} pieces", f"must be at most {at.MOST_PIECES} with [capture.hinge]"
        )
    place, axis = (np.array([values[f"hinge.{name}[{i}]"] for i in (1, 2, 3)]) for name in ("position", "axis"))
    if not axis.any():
        raise Undesigned("hinge.axis", "[0, 0, 0]", "must be a direction, of any length, in the target's design axes")
    if values["hinge.limit"] == 0.0:
        expected = "must be greater than 0: a hinge that cannot turn is none (leave [capture.hinge] and `hinged` out)"
        raise Undesigned("hinge.limit", "0 deg", expected)
    made = lay_union(values, sources).tables
    key = (rows.tobytes(), rows.shape, place.tobytes(), axis.tobytes(), float(values["hinge.limit"]))
    return Laid({at.BODY: _table(*key, made["target.samples"].tobytes())}, {})


@lru_cache(maxsize=8)
def _table(content: bytes, shape: tuple[int, int], place: bytes, axis: bytes, limit: float, samples: bytes) -> Array:
    rows = np.frombuffer(content).reshape(shape)
    swings = swinging(rows)
    plain = rows[:, : of.ROW]
    whole, rest, appendage = (body_of(part) for part in (plain, plain[~swings], plain[swings]))
    along = whole.turn.T @ (np.frombuffer(axis) / np.linalg.norm(np.frombuffer(axis)))
    table = np.zeros(at.SAMPLES + SAMPLES)
    table[at.SHARE] = appendage.mass / whole.mass
    hinge, centre, back = whole.to_body(np.array([np.frombuffer(place), appendage.center, rest.center]))
    table[at.HINGE : at.AXIS], table[at.AXIS : at.ARM] = hinge, along
    table[at.ARM : at.REST], table[at.REST : at.REST_INERTIA] = centre - hinge, back
    for begin, body in ((at.REST_INERTIA, rest), (at.INERTIA, appendage)):
        turn = whole.turn.T @ body.turn
        table[begin : begin + 9] = (turn @ np.diag(body.moments) @ turn.T / whole.mass).ravel()
    table[at.LIMIT] = limit
    found = of.pieces(plain)
    _reach(table, whole, found, swings, limit)
    table[at.PIECES : at.PIECES + len(rows)] = swings
    table[at.SAMPLES :] = _belongs(np.frombuffer(samples).reshape(-1, 6), whole, found, swings)
    return table


def swung(values: Mapping[str, Any]) -> npt.NDArray[np.bool_]:
    """Which corners of the pieces swing, in the order in which they are drawn (n,).

    Checked  tests/net_capture/test_hinged_contact.py, tests/report/test_browser.py
    """
    table, found = values[at.BODY], list(in_body_axes(values[PIECES]))
    numbers = [len(of.drawn(piece)[0]) for piece in found]
    return np.repeat(table[at.PIECES : at.PIECES + len(found)] != 0.0, numbers)


def pieces_at(values: Mapping[str, Any], angle: float) -> Array:
    """The table of the pieces at an angle, body axes, from the centre of mass as it is then (n, WORDS).

    Checked  tests/net_capture/test_hinged_contact.py
    """
    table, rows = values[at.BODY], np.array(values[PIECES])
    hinge, turn = table[at.HINGE : at.AXIS], turn_about(table[at.AXIS : at.ARM], angle)
    for row, swings in zip(rows, table[at.PIECES : at.PIECES + len(rows)], strict=True):
        if swings:
            row[5:8] = hinge + turn @ (row[5:8] - hinge)
            row[8:17] = (turn @ row[8:17].reshape(3, 3)).ravel()
    rows[:, 5:8] -= table[at.SHARE] * (turn - np.eye(3)) @ table[at.ARM : at.REST]
    return rows


def corners_at(values: Mapping[str, Any], angle: float) -> Array:
    """Corners of the pieces (n, 3) [m], in the order in which they are drawn, at an angle; body axes, from the centre
    of mass as it is then.

    Checked  tests/net_capture/test_hinged_contact.py
    """
    table = values[at.BODY]
    hinge, turn = table[at.HINGE : at.AXIS], turn_about(table[at.AXIS : at.ARM], angle)
    shift = table[at.SHARE] * (turn - np.eye(3)) @ table[at.ARM : at.REST]
    corners = np.vstack([of.drawn(piece)[0] for piece in in_body_axes(values[PIECES])])
    moved = np.where(swung(values)[:, None], hinge + (corners - hinge) @ turn.T, corners)
    return np.asarray(moved - shift)


def held_at(values: Mapping[str, Any], angle: float) -> dict[str, Array]:
    """The appendage at an angle of its hinge, body axes, places from the centre of mass of the whole as it is then:
    `mass` [kg] (1,), `inertia` about its own centre of mass [kg m2] (3, 3), `center` of its mass, `hinge`, a point of
    the axis [m] (3,), and `axis` (3,).

    Checked  tests/cosim/test_hinge_handed_over.py
    """
    table, mass = values[at.BODY], float(values["target.mass"])
    turn, arm = turn_about(table[at.AXIS : at.ARM], angle), table[at.ARM : at.REST]
    hinge = table[at.HINGE : at.AXIS] - table[at.SHARE] * (turn @ arm - arm)
    inertia = mass * turn @ table[at.INERTIA : at.LIMIT].reshape(3, 3) @ turn.T
    return {
        "mass": mass * table[at.SHARE : at.SHARE + 1],
        "inertia": inertia,
        "center": hinge + turn @ arm,
        "hinge": hinge,
        "axis": table[at.AXIS : at.ARM],
    }


def rows(values: Mapping[str, Any]) -> Iterator[Implied]:
    """What a scene's hinge comes to: the moment that its spring feels, its frequency and damping, the least girth."""
    table, mass = values[at.BODY], values["target.mass"]
    moment = mass / float(np.linalg.inv(matrix(table, 0.0)[0])[3, 3])
    stiffness, damping = values["hinge.stiffness"], values["hinge.damping"]
    yield Implied("hinge.mass", "mass of the hinged appendage", mass * table[at.SHARE], "kg")
    yield Implied("hinge.moment", "moment of inertia that the hinge feels, the target free", moment, "kg.m2")
    if stiffness > 0.0:
        rate = math.sqrt(stiffness / moment)
        yield Implied("hinge.frequency", "at which it swings on its spring", rate / (2.0 * math.pi), "Hz")
        if damping > 0.0:
            yield Implied("hinge.dies_out", "time in which that falls to 1/e", 2.0 * moment / damping, "s")
    yield Implied("hinge.girth", "smallest girth of the target at any angle", table[at.GIRTH], "m")


def matrix(table: Array, angle: float) -> tuple[Array, Array]:
    """Matrix of the masses over the mass of the whole [m2] (4, 4), and how the appendage's centre of mass moves per
    radian [m] (3,), at an angle.

    Checked  tests/net_capture/test_hinge.py
    """
    share, axis = table[at.SHARE], table[at.AXIS : at.ARM]
    turn = turn_about(axis, angle)
    arm = turn @ table[at.ARM : at.REST]
    r, s = table[at.HINGE : at.AXIS] + arm - table[at.REST : at.REST_INERTIA], np.cross(axis, arm)
    own = turn @ table[at.INERTIA : at.LIMIT].reshape(3, 3) @ turn.T
    reduced, found = share * (1.0 - share), np.empty((4, 4))
    found[:3, :3] = table[at.REST_INERTIA : at.INERTIA].reshape(3, 3) + own
    found[:3, :3] += reduced * (r @ r * np.eye(3) - np.outer(r, r))
    found[:3, 3] = found[3, :3] = own @ axis + reduced * np.cross(r, s)
    found[3, 3] = axis @ own @ axis + reduced * s @ s
    return found, s


def lightest(table: Array) -> float:
    """Least moment that the hinge feels within its limit, the target free, over the mass of the whole [m2].

    Checked  tests/net_capture/test_hinge_extremes.py
    """
    return min(1.0 / float(np.linalg.inv(matrix(table, angle)[0])[3, 3]) for angle in _angles(table[at.LIMIT]))


def _angles(limit: float) -> Array:
    """From beyond the limit on one side to beyond that on the other [rad]."""
    return np.linspace(-limit - BEYOND, limit + BEYOND, ANGLES)


def _reach(
    table: Array, whole: solids.Solid, found: list[of.Piece], swings: npt.NDArray[np.bool_], limit: float
) -> None:
    """Numbers of the table that hold at any angle."""
    hinge, axis, share = table[at.HINGE : at.AXIS], table[at.AXIS : at.ARM], table[at.SHARE]
    inner, outer = (
        [whole.to_body(np.vstack([of.spanning(p, around) for p, s in zip(found, swings, strict=True) if s == side]))
         for side in (False, True)]
        for around in (False, True)
    )  # fmt: skip
    half, radius, reach, yields = np.zeros(3), 0.0, 0.0, 0.0
    girths = []
    for number, angle in enumerate(_angles(limit)):
        turn = turn_about(axis, angle)
        masses, slope = matrix(table, angle)
        light = np.linalg.inv(masses)
        shift = share * (turn - np.eye(3)) @ table[at.ARM : at.REST]
        moved = [outer[0] - shift, hinge + (outer[1] - hinge) @ turn.T - shift]
        ways = [np.zeros_like(moved[0]) - share * slope, np.cross(axis, moved[1] + shift - hinge) - share * slope]
        half = np.maximum(half, np.abs(np.vstack(moved)).max(axis=0))
        radius = max(radius, float(np.linalg.norm(np.vstack(moved), axis=1).max()))
        reach = max(reach, float(np.linalg.norm(np.vstack(ways), axis=1).max()))
        for points, way in zip(moved, ways, strict=True):
            jacobian = np.zeros((len(points), 3, 4))
            for i in range(3):
                jacobian[:, :, i] = np.cross(np.eye(3)[i], points)
            jacobian[:, :, 3] = way
            given = jacobian @ light @ jacobian.transpose(0, 2, 1)
            yields = max(yields, 1.0 + float(np.linalg.eigvalsh(given)[:, 2].max()))
        if number % ((ANGLES - 1) // (GIRTHS - 1)) == 0:
            least, way = solids.girth(np.vstack([inner[0], hinge + (inner[1] - hinge) @ turn.T]))
            most, _ = solids.girth(np.vstack([outer[0], hinge + (outer[1] - hinge) @ turn.T]), way)
            girths.append((0.5 * (least + most), 0.5 * (most - least)))
    between = reach * (limit + BEYOND) / (ANGLES - 1)
    table[at.YIELDS], table[at.REACH] = yields, reach
    table[at.HALF : at.RADIUS], table[at.RADIUS] = half + between, radius + between
    table[at.GIRTH], table[at.GIRTH_ERROR] = min(girths)


def _belongs(
    samples: Array, whole: solids.Solid, found: list[of.Piece], swings: npt.NDArray[np.bool_]
) -> npt.NDArray[np.bool_]:
    """Which sample points belong to the appendage: those that are led to a point within its pieces."""
    rows, normal, away = pieces_table(found, whole), np.empty(3), formula(piece_distance)
    belongs = np.empty(len(samples), dtype=bool)
    for number, end in enumerate(samples[:, 3:]):
        local = ((end - row[5:8]) @ row[8:17].reshape(3, 3) for row in rows)
        belongs[number] = swings[
            int(np.argmin([away(row, normal, place) for row, place in zip(rows, local, strict=True)]))
        ]
    return belongs
