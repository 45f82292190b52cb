"""The way of a line round a body: against a search over a fine graph, closed forms, and Newton's method."""

import heapq
import itertools
import math
from typing import Any

import numpy as np
import pytest

from fmu_src.instance import Instance
from fmu_src.tethered_deorbit.bodies import attached, wrapping
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL
from tests.plain import PlainInstance, plain
from tests.tethered_deorbit.wrapped import BOX, CYLINDER, SIZE, TUMBLING, momentum, pair, uncompiled
from tests.validation import Validated, closed_form

__all__ = ["plain"]


def edges_of_box(size: np.ndarray, count: int) -> list[tuple[np.ndarray, frozenset[int]]]:
    """Points along the edges, each with the two faces it lies on; face 2 a + s is that of axis a, s 0 above."""
    found = []
    for a in range(3):
        b, c = (a + 1) % 3, (a + 2) % 3
        for on_b, on_c in itertools.product((0, 1), repeat=2):
            for t in np.linspace(-0.5, 0.5, count):
                point = np.zeros(3)
                point[a], point[b], point[c] = t * size[a], (0.5 - on_b) * size[b], (0.5 - on_c) * size[c]
                found.append((point, frozenset({2 * b + on_b, 2 * c + on_c})))
    return found


def passes_through(p: np.ndarray, q: np.ndarray, size: np.ndarray) -> bool:
    """Whether a line passes through the inside of the box, by a thousand of its points."""
    t = np.linspace(0.0, 1.0, 1001)[:, None]
    return bool((np.abs(p + t * (q - p)) < 0.5 * size - 1e-9).all(axis=1).any())


def searched(first: np.ndarray, face: int, last: np.ndarray, size: np.ndarray, count: int = 61) -> float:
    """Length of the shortest way from a point of a face to one outside, over points of the edges (Dijkstra)."""
    if not passes_through(first, last, size):
        return float(np.linalg.norm(last - first))
    points = edges_of_box(size, count)
    free = [not passes_through(p, last, size) for p, _ in points]
    best = [math.inf] * len(points)
    heap: list[tuple[float, int]] = []
    for k, (p, sides) in enumerate(points):
        if face in sides:
            best[k] = float(np.linalg.norm(p - first))
            heapq.heappush(heap, (best[k], k))
    shortest = math.inf
    places = np.array([p for p, _ in points])
    while heap:
        length, k = heapq.heappop(heap)
        if length > best[k] or length >= shortest:
            continue
        if free[k]:
            shortest = min(shortest, length + float(np.linalg.norm(last - points[k][0])))
        away = np.linalg.norm(places - points[k][0], axis=1)
        for j in np.flatnonzero(length + away < np.array(best) - 1e-12):
            if points[k][1] & points[j][1]:
                best[j] = length + float(away[j])
                heapq.heappush(heap, (best[j], int(j)))
    return shortest


def test_the_way_at_the_start_is_the_shortest() -> None:
    """Chasers all round, attachments anywhere on the faces: no way of the graph is shorter, and none much longer."""
    rng = np.random.default_rng(12)
    i = pair(BOX)
    bends = set()
    for k in range(40):
        face = int(rng.integers(6))
        first = rng.uniform(-0.5, 0.5, 3) * SIZE
        first[face // 2] = (0.5 - face % 2) * SIZE[face // 2]
        way = rng.normal(size=3)
        last = way / np.linalg.norm(way) * rng.uniform(3.0, 12.0)
        i.array("target_attachment")[:] = first
        i.array("start_relative_position")[:] = -last
        i.initialise()
        wanted = searched(first, face, last, SIZE)
        assert wanted * (1.0 - 2e-3) < i["tether.length"] < wanted * (1.0 + 1e-9), k
        assert i["tether.span"] == pytest.approx(float(np.linalg.norm(last - first)), rel=1e-12)
        bends.add(int(i["tether.bends"]))
    assert bends >= {0, 1, 2}


def wound(radius: float, distance: float, angle: float) -> float:
    """Length of a line round a cylinder that has turned by an angle since its attachment faced the chaser."""
    return math.sqrt(distance**2 - radius**2) + radius * (angle - math.acos(radius / distance))


def test_a_line_is_wound_round_a_cylinder(validated: Validated) -> None:
    """sqrt(D^2 - R^2) + R (phi - acos(R/D)), D the distance of the axis, within 1.4e-3 R; by the turn 2 pi R."""
    radius, distance, rate = 1.3, 9.0, 0.4
    arrays = {
        "target_attachment": (0.0, -radius, 0.4),
        "target_inertia": (900.0, 900.0, 700.0, 0.0, 0.0, 0.0),
        "target_start_rate": (0.0, 0.0, rate),
        "start_relative_position": (0.0, distance, -0.4),
    }
    i = pair(CYLINDER, arrays, target__cylinder_radius=radius, target__cylinder_length=3.0, tether__rest_length=1000.0)
    lengths = []
    for k in range(400):
        i.step(0.1)
        angle = rate * 0.1 * (k + 1)
        lengths.append(i["tether.length"])
        if angle > 1.8:
            assert i["tether.length"] == pytest.approx(wound(radius, distance, angle), abs=1.5e-3 * radius)
    turn = 2.0 * math.pi / rate
    i.step(turn - 0.1)
    before = i["tether.length"]
    i.step(turn)
    formula = closed_form("2 pi R")
    what = "line wound round a cylinder of 1.3 m: length of a turn"
    validated(formula, what, i["tether.length"] - before, 2.0 * math.pi * radius, "m", rel=1e-9)
    assert i["tether.wrapped"] > 4.0 * math.pi * radius
    assert i["tether.bends"] > 60


@pytest.mark.evidence
def test_the_unwinding_line_turns_the_cylinder() -> None:
    """The energy that a reel of constant tension pays is the tension times the length that comes off."""
    radius, pull = 1.3, 5.0
    terms = CYLINDER | {"reel": "commanded"}
    arrays = {
        "target_attachment": (0.0, -radius, 0.0),
        "target_inertia": (900.0, 900.0, 700.0, 0.0, 0.0, 0.0),
        "target_start_rate": (0.0, 0.0, 0.5),
        "start_relative_position": (0.0, 30.0, 0.0),
    }
    i = Instance(
        MODEL,
        terms,
        {
            "start.condition": HANDED_OVER,
            "target.cylinder_radius": radius,
            "target.cylinder_length": 3.0,
            "thrust.level": 0.0,
        },
    )
    for field, value in arrays.items():
        i.array(field)[:] = value
    i["reel.tension"] = pull
    i.initialise()
    before, energy, length = momentum(i), i["energy.relative"], i["tether.length"]
    for _ in range(100):
        i.step(0.5)
        gained = i["energy.relative"] - energy
        assert gained == pytest.approx(-pull * (i["tether.length"] - length), rel=1e-8, abs=1e-8)
        assert momentum(i) == pytest.approx(before, abs=1e-10 * float(np.linalg.norm(before)))
    assert i["target.rate[3]"] < 0.45


def test_a_line_slips_off_a_corner() -> None:
    """Wound aslant it slides to the end of the box and off it. At all times its way passes nowhere through the box, is
    as long as it says, and no shorter than the shortest one of a graph; where it slips it is shorter at once."""
    i = pair(BOX, TUMBLING, tether__rest_length=1000.0)
    before, speed, slips = i["tether.length"], i["tether.length_rate"], 0
    for k in range(400):
        i.step(0.5)
        bends, points = int(i["tether.bends"]), i.array("path_points")
        way = points[: bends + 2]
        found = i["tether.length"]
        assert found == pytest.approx(float(np.linalg.norm(np.diff(way, axis=0), axis=1).sum()), rel=1e-6)
        assert not any(passes_through(p, q, SIZE * (1.0 - 1e-6)) for p, q in itertools.pairwise(way))
        slips += found < before - 0.5 * (abs(speed) + abs(i["tether.length_rate"])) - 0.05
        before, speed = found, i["tether.length_rate"]
        if k % 20 == 0:
            assert found > searched(np.array(TUMBLING["target_attachment"]), 3, way[-1], SIZE) * (1.0 - 2e-3)
    assert slips >= 1


@uncompiled
def test_a_taut_line_slips_off_a_corner() -> None:
    """Shorter at once, it loses what it has stored: what is booked closes the balance of energy."""
    values = {
        "start.condition": HANDED_OVER,
        "start_relative_position": [-0.7, 6.6, -4.5],
        "start_relative_velocity": [0.0, 1.0, 0.0],
        "target_size": SIZE.tolist(),
        "target_attachment": [0.5 * SIZE[0], -0.47, 0.05],
        "target_inertia": [1671.0, 924.0, 1788.0, 30.0, -20.0, 10.0],
        "thrust.level": 0.0,
        "tether.damping_ratio": 0.0,
    }
    slack = PlainInstance(MODEL, BOX, values | {"tether.rest_length": 100.0})
    i = PlainInstance(MODEL, BOX, values | {"tether.rest_length": slack["tether.length"] - 1e-3})
    energy, lost = i["energy.relative"], 0.0
    for _ in range(8):
        i.step(0.04)
        assert i["tether.slip_loss"] >= lost
        lost = i["tether.slip_loss"]
        assert i["energy.relative"] + lost == pytest.approx(energy, abs=1e-9)
    assert lost > 1e-2


@uncompiled
@pytest.mark.parametrize(("terms", "most", "time"), [(BOX, 2, 3.0), (CYLINDER, 4, 12.0)])
def test_the_way_laid_out_flat_is_that_of_newton(
    terms: dict[str, str], most: int, time: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Over one edge and several: length, where the line leaves the body, and the bend of the length, at every stage."""
    paths: list[Any] = []
    edges, off = set(), np.zeros(3)

    def made(polyhedron: Any) -> Any:
        paths.append(make_path(polyhedron))
        return paths[-1]

    def seen(r: Any) -> tuple[float, np.ndarray, float]:
        count = int(r.held_count)
        return r.state_wrapped + r.path_lengths[count], r.state_departure.copy(), r.path_diagonal[max(0, count - 1)]

    def both(record: Any, whole: bool) -> bool:
        flat = follow_unfolded(record, False)
        least = record[0].state_wrapped, *record[0].state_departure
        follow_unfolded(record, True)
        if flat and record[0].held_count > 0:
            edges.add(int(record[0].held_count))
            found = seen(record[0])
            assert least == (record[0].state_wrapped, *record[0].state_departure)
            first = np.array([record[0].path_lengths[0], *record[0].path_ways[0]])
            paths[-1].follow(record)
            wanted = seen(record[0])
            errors = (
                found[0] - wanted[0],
                float(np.abs(found[1] - wanted[1]).max()),
                found[2] / wanted[2] - 1.0,
            )
            np.maximum(off, np.abs(errors), out=off)
            if record[0].held_count == 1:
                np.testing.assert_allclose(first, [record[0].path_lengths[0], *record[0].path_ways[0]], atol=1e-12)
            follow_unfolded(record, whole)
        return bool(flat)

    make_path, follow_unfolded = wrapping.make_path, wrapping.follow_unfolded
    monkeypatch.setattr(wrapping, "make_path", made)
    monkeypatch.setattr(wrapping, "follow_unfolded", both)
    values: dict[str, Any] = {
        "start.condition": HANDED_OVER,
        "start_relative_position": [0.4, 12.0, 0.3],
        "target_attachment": [0.3, 0.5 * SIZE[1], 0.2] if terms is BOX else [0.1, -0.4, 0.05],
        "target_inertia": [1671.0, 924.0, 1788.0, 30.0, -20.0, 10.0],
        "target_start_rate": [0.02, 0.05, 0.3],
        "tether.rest_length": 13.0,
        "thrust.level": -4.0,
    }
    shape = {"target_size": SIZE.tolist()} if terms is BOX else {"target.cylinder_radius": 1.0}
    PlainInstance(MODEL, terms, values | shape).step(time)
    assert max(edges) >= most, edges
    assert off[0] < 1e-13
    assert off[1] < 1e-12
    assert off[2] < 1e-9


@uncompiled
def test_a_straight_line_beyond_its_face_meets_no_other(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whether it holds, at 500 ends all round the body, against the body's thousand points of a line; at both answers
    of the face alone."""
    made: list[Any] = []
    make_wrapping = attached.make_wrapping
    monkeypatch.setattr(attached, "make_wrapping", lambda *given: made.append(make_wrapping(*given)) or made[-1])
    place = [0.3, 0.5 * SIZE[1], 0.2]
    i = PlainInstance(
        MODEL,
        BOX,
        {
            "start.condition": HANDED_OVER,
            "start_relative_position": [0.0, -12.0, 0.0],
            "target_size": SIZE.tolist(),
            "target_attachment": place,
            "tether.rest_length": 13.0,
        },
    )
    assert i.record[0].held_count == 0
    found = set()
    for far in np.random.default_rng(3).uniform(-4.0, 4.0, (500, 3)):
        if (np.abs(far) < 0.5 * SIZE).all():
            continue
        made[-1].follow(i.record, far, True)
        held = bool(made[-1].holds(i.record))
        assert held is not passes_through(np.array(place), far, SIZE), far
        found.add((held, bool(far[1] > place[1])))
    assert {(True, True), (False, False)} <= found
