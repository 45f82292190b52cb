"""A line round a body: its way against a search over a fine graph, closed forms, an integration in scipy, and laws."""

import heapq
import itertools
import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmu_src.instance import Instance, ModelFault
from fmu_src.tethered_deorbit.bodies import attached, wrapping
from fmu_src.tethered_deorbit.interface import HANDED_OVER, MODEL
from tests.plain import PlainInstance, plain
from tests.validation import Validated, closed_form, other_code

__all__ = ["plain"]

uncompiled = pytest.mark.usefixtures("plain")

BOX = {"reel": "locked", "environment": "none", "target": "box", "thrust": "along_track"}
CYLINDER = {"reel": "locked", "environment": "none", "target": "cylinder", "thrust": "along_track"}
SIZE = np.array([2.5, 3.9, 2.2])
M_C, M_T = 2000.0, 1000.0
REDUCED = M_C * M_T / (M_C + M_T)
STIFFNESS = 60e9 * math.pi * 1e-6 / 4.0


def pair(terms: dict[str, str], arrays: dict[str, Any] | None = None, **parameters: float) -> Instance:
    """A field-free pair handed over, parameters by name with __ for a dot, arrays by field."""
    given = {
        "start.condition": HANDED_OVER,
        "tether.damping_ratio": 0.0,
        "tether.rest_length": 14.0,
        "thrust.level": 0.0,
    }
    i = Instance(MODEL, terms, given | {name.replace("__", "."): value for name, value in parameters.items()})
    i.array("start_relative_position")[:] = 0.0, 12.0, 0.0
    if terms["target"] == "box":
        i.array("target_size")[:] = SIZE
        i.array("target_attachment")[:] = 0.0, -0.5 * SIZE[1], 0.0
    i.array("target_inertia")[:] = 1671.0, 924.0, 1788.0, 30.0, -20.0, 10.0
    for field, value in (arrays or {}).items():
        i.array(field)[:] = value
    return i.initialise()


def momentum(i: Instance) -> np.ndarray:
    place = i.array("target_position") - i.array("chaser_position")
    speed = i.array("target_velocity") - i.array("chaser_velocity")
    return np.asarray(REDUCED * np.cross(place, speed) + i.array("target_spin"))


# ------------------------------------------------------------------------------------------------- the way at the start


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


# ----------------------------------------------------------------------------------------------------------- winding up


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


def test_what_wraps_too_often_is_told() -> None:
    flat = {"target_start_rate": (0.0, 0.0, 0.5), "target_inertia": (1671.0, 924.0, 1788.0, 0.0, 0.0, 0.0)}
    i = pair(BOX, flat, tether__rest_length=1e5)
    with pytest.raises(ModelFault, match="the line has wrapped"):
        i.step(1000.0)
    assert i["tether.bends"] == 0


# ------------------------------------------------------------------------------------------------------- in a plane


def in_plane(size: np.ndarray, attached: np.ndarray, end: np.ndarray) -> tuple[float, np.ndarray]:
    """Length of the shorter way round a rectangle in its plane, and the corner or attachment where it leaves it."""
    half = 0.5 * size[:2]
    corners = [np.array(c) * half for c in ((1, 1), (-1, 1), (-1, -1), (1, -1))]

    def inside(p: np.ndarray, q: np.ndarray) -> bool:
        low, high = 0.0, 1.0
        for axis in range(2):
            for sign in (1.0, -1.0):
                above, slope = sign * p[axis] - half[axis] + 1e-11, sign * (q[axis] - p[axis])
                if slope < 0.0:
                    low = max(low, -above / slope)
                elif slope > 0.0:
                    high = min(high, -above / slope)
                elif above > 0.0:
                    return False
        return low < high

    ways = []
    angle = math.atan2(attached[1], attached[0])
    for sign in (1.0, -1.0):
        order = sorted(corners, key=lambda c: (sign * (math.atan2(c[1], c[0]) - angle)) % (2.0 * math.pi))
        here, length, left = attached, 0.0, list(order)
        while inside(here, end) and left:
            corner = left.pop(0)
            length, here = length + float(np.linalg.norm(corner - here)), corner
        ways.append((length + float(np.linalg.norm(end - here)), here))
    return min(ways, key=lambda w: w[0])


def test_tugs_of_a_wrapped_line_in_a_plane(validated: Validated) -> None:
    """A box that turns at 2 deg/s across the line of a chaser that pulls away: tugs as of scipy's DOP853."""
    rate, drift = math.radians(2.0), 0.005
    inertia = 1788.0
    arrays = {
        "target_inertia": (1671.0, 924.0, inertia, 0.0, 0.0, 0.0),
        "target_start_rate": (0.0, 0.0, rate),
        "start_relative_velocity": (0.0, drift, 0.0),
    }
    pull_away = -4.0
    i = pair(BOX, arrays, tether__rest_length=13.0, thrust__level=pull_away)
    attached = np.array([0.0, -0.5 * SIZE[1]])
    stiffness = STIFFNESS / 13.0

    def seen(y: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        """Length, where the line leaves, and its direction to the chaser, body axes."""
        turned = np.array([[math.cos(y[4]), math.sin(y[4])], [-math.sin(y[4]), math.cos(y[4])]])
        end = turned @ -y[0:2]
        length, leaves = in_plane(SIZE, attached, end)
        return length, leaves, (end - leaves) / np.linalg.norm(end - leaves)

    def motion(_: float, y: np.ndarray, taut: bool) -> np.ndarray:
        pull = np.zeros(2)
        torque = 0.0
        if taut:
            length, leaves, way = seen(y)
            force = stiffness * (length - 13.0) * way
            torque = leaves[0] * force[1] - leaves[1] * force[0]
            back = np.array([[math.cos(y[4]), -math.sin(y[4])], [math.sin(y[4]), math.cos(y[4])]])
            pull = back @ force
        away = np.array([0.0, -pull_away / M_C])
        return np.array([y[2], y[3], *(pull / REDUCED + away), y[5], torque / inertia])

    y, time, taut, tugs = np.array([0.0, 12.0, 0.0, drift, 0.0, rate]), 0.0, False, []
    while len(tugs) < 3 or taut:

        def change(_: float, y: np.ndarray, taut: bool) -> float:
            return seen(y)[0] - 13.0

        change.terminal, change.direction = True, -1 if taut else 1  # type: ignore[attr-defined]
        leg = solve_ivp(
            motion,
            (time, time + 500.0),
            y,
            "DOP853",
            args=(taut,),
            events=change,
            max_step=0.05 if taut else 1.0,
            rtol=1e-10,
            atol=1e-12,
            dense_output=taut,
        )
        assert leg.status == 1
        if taut:
            times = np.linspace(time, leg.t[-1], 2001)
            tugs[-1].append(max(stiffness * (seen(leg.sol(t))[0] - 13.0) for t in times))
        else:
            tugs.append([float(leg.t[-1])])
        time, y, taut = float(leg.t[-1]), leg.y[:, -1], not taut
    i.step(time + 1.0)
    count = int(i["tether.tug_count"])
    assert count == len(tugs)
    for k, (when, peak) in enumerate(tugs):
        assert i[f"tug[{count - k}].time"] == pytest.approx(when, abs=1e-6)
        assert i[f"tug[{count - k}].peak"] == pytest.approx(peak, rel=1e-5)
    source = other_code("scipy DOP853, a rectangle in its plane")
    what = "line wrapped round a box that turns: peak of the first tug"
    validated(source, what, i[f"tug[{count}].peak"], tugs[0][1], "N", rel=1e-5)


# ------------------------------------------------------------------------------------------------------- laws


TUMBLING = {
    "target_start_rate": (0.05, -0.02, 0.06),
    "start_relative_velocity": (0.01, 0.02, 0.015),
    "target_attachment": (0.4, -0.5 * SIZE[1], -0.3),
}


@pytest.mark.parametrize("terms", [BOX, CYLINDER])
def test_momentum_and_energy_through_wrapped_tugs(terms: dict[str, str]) -> None:
    """Tumbling about no axis: spins included, to 1e-11; the line slides without loss."""
    arrays: dict[str, Any] = dict(TUMBLING)
    values = {"target__cylinder_radius": 1.2, "target__cylinder_length": 3.0} if terms is CYLINDER else {}
    if terms is CYLINDER:
        arrays["target_attachment"] = (0.0, -1.2, -0.3)
    i = pair(terms, arrays, **values)
    before, energy = momentum(i), i["energy.relative"]
    wrapped_tugs = 0
    bends = 0
    for _ in range(600):
        count = i["tether.tug_count"]
        i.step(0.5)
        bends = max(bends, int(i["tether.bends"]))
        wrapped_tugs += bool(i["tether.tug_count"] > count and i["tether.bends"] > 0)
        assert momentum(i) == pytest.approx(before, abs=1e-11 * float(np.linalg.norm(before)))
        assert i["energy.relative"] == pytest.approx(energy, rel=1e-8)
    assert wrapped_tugs >= 1
    assert bends >= 2


def test_rates_of_a_wrapped_line() -> None:
    """Against differences of fourth order: the line's own, and those of what it shows."""
    i = pair(BOX, TUMBLING, tether__rest_length=1000.0)
    seen_bends, slides = set(), 0.0
    for _ in range(30):
        i.step(3.0)
        before = int(i["tether.bends"])
        names = ("tether.length", "tether.length_rate", "tether.span", "tether.wrapped")
        seen, step = [], 0.005
        rates: dict[str, float] = {}
        for k in range(5):
            i.step(step)
            seen.append([i[name] for name in names])
            if k == 2:
                i.differentiate()
                rates = {name: i.rate(name) for name in names}
        if int(i["tether.bends"]) != before:
            continue
        v = np.array(seen)
        differences = (v[0] - 8.0 * v[1] + 8.0 * v[3] - v[4]) / (12.0 * step)
        assert [rates[name] for name in names] == pytest.approx(differences, rel=1e-6, abs=1e-9)
        seen_bends.add(before)
        slides = max(slides, abs(rates["tether.wrapped"]))
    assert seen_bends >= {0, 1, 2}
    assert slides > 1e-3


def wrapped_and_taut(zeta: float) -> PlainInstance:
    """A box that the line comes round from its far face, over two edges, stretched by half a millimetre."""
    values = {
        "start.condition": HANDED_OVER,
        "start_relative_position": [0.0, 12.0, 0.0],
        "target_size": SIZE.tolist(),
        "target_attachment": [0.3, 0.5 * SIZE[1], 0.2],
        "target_inertia": [1671.0, 924.0, 1788.0, 30.0, -20.0, 10.0],
        "thrust.level": 0.0,
        "tether.damping_ratio": zeta,
    }
    slack = PlainInstance(MODEL, BOX, values | {"tether.rest_length": 100.0})
    assert slack["tether.bends"] == 2
    return PlainInstance(MODEL, BOX, values | {"tether.rest_length": slack["tether.length"] - 5e-4})


@uncompiled
def test_a_wrapped_line_is_hauled_in() -> None:
    """Its tension is that of its whole length, k (l - l0) + c (l' - l0'), k and c as l0 makes them on the way."""
    zeta, pace = 0.3, -2e-3
    i = wrapped_and_taut(zeta)
    first, area = i["tether.rest_length"], 0.25 * math.pi * i["tether.diameter"] ** 2
    for k in range(10):
        i.set_rates({"reel.length_offset": pace})
        i.step(0.05)
        rest = first + pace * 0.05 * (k + 1)
        stiffness = 60e9 * area / rest
        dashpot = 2.0 * zeta * math.sqrt(stiffness * REDUCED)
        expected = stiffness * (i["tether.length"] - rest) + dashpot * (i["tether.length_rate"] - pace)
        assert i["tether.tension"] == pytest.approx(expected, rel=1e-9)
        assert i["tether.taut"]
        assert i["tether.bends"] == 2
        assert abs(i["tether.length_rate"]) > 1e-5


@uncompiled
def test_hauling_in_a_wrapped_line_pays_its_energy() -> None:
    """The work of the reel, (T + T^2/(2 EA)) (-l0'), by Simpson's rule."""
    pace, step = -2e-3, 0.01
    i = wrapped_and_taut(0.0)
    strength = 60e9 * 0.25 * math.pi * i["tether.diameter"] ** 2
    energy, power = [i["energy.relative"]], []
    for k in range(21):
        pull = i["tether.tension"]
        power.append(-pace * (pull + pull * pull / (2.0 * strength)))
        if k < 20:
            i.set_rates({"reel.length_offset": pace})
            i.step(step)
            energy.append(i["energy.relative"])
    assert i["tether.bends"] == 2
    work = step / 3.0 * (power[0] + power[-1] + 4.0 * sum(power[1:-1:2]) + 2.0 * sum(power[2:-1:2]))
    assert work > 1e-4
    assert energy[-1] - energy[0] == pytest.approx(work, rel=1e-6)


def test_macro_steps_and_a_stop_in_between_change_nothing() -> None:
    """The same tugs, bit for bit, for steps of 0.7 and 70 s: the way is followed from the steps of the integrator."""
    ends = []
    for step, count in ((0.7, 300), (70.0, 3)):
        i = pair(BOX, TUMBLING)
        for _ in range(count):
            i.step(step)
        ends.append([i[f"tug[{k}].{what}"] for k in range(1, 4) for what in ("time", "peak")])
        ends[-1] += [i["tether.length"], i["tether.wrapped"]]
    assert ends[0][:6] == ends[1][:6]
    assert ends[0] == pytest.approx(ends[1], rel=1e-11)


def test_an_attachment_out_of_sight_wraps_first() -> None:
    """On the far side of the box the line is shorter by the way round, and the tug comes sooner and harder."""
    arrays = {"start_relative_velocity": (0.0, 0.05, 0.0), "target_start_rate": (0.0, 0.0, 0.01)}
    near = pair(BOX, arrays, tether__rest_length=15.0)
    far = pair(BOX, arrays | {"target_attachment": (0.0, 0.5 * SIZE[1], 0.0)}, tether__rest_length=15.0)
    assert far["tether.length"] > near["tether.length"] + SIZE[1]
    assert far["tether.bends"] == 2
    firsts = []
    for i in (near, far):
        while i["tether.tug_count"] == 0:
            i.step(1.0)
        firsts.append(i["tug[1].time"])
    assert firsts[1] < 0.5 * firsts[0]


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
    monkeypatch.setattr(attached, "make_wrapping", lambda surface: made.append(make_wrapping(surface)) or made[-1])
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


@pytest.mark.parametrize("count", [4, pytest.param(100, marks=pytest.mark.evidence)])
def test_tows_of_any_tumbling_body_run_to_an_end(count: int) -> None:
    """Sizes, attachments, spins and thrusts at random: a tow ends after its time or where the bodies meet."""
    rng = np.random.default_rng(7)
    for k in range(count):
        size, pull = rng.uniform(0.5, 5.0, 3), -(10.0 ** rng.uniform(-1.0, 1.0))
        way, axis = rng.normal(size=3), int(rng.integers(3))
        first = rng.uniform(-0.5, 0.5, 3) * size
        first[axis] = math.copysign(0.5 * size[axis], first[axis])
        arrays = {
            "target_inertia": (*(1000.0 / 12.0 * (size @ size - size**2)), 0.0, 0.0, 0.0),
            "target_attachment": first,
            "target_start_rate": rng.normal(size=3) * 10.0 ** rng.uniform(-3.0, -0.8),
            "start_relative_position": way / np.linalg.norm(way) * rng.uniform(6.0, 9.0),
            "start_relative_velocity": rng.normal(size=3) * 0.02,
        }
        values = {"thrust__level": pull, "tether__damping_ratio": float(rng.choice([0.0, 0.05, 0.5]))}
        if k % 2 == 0:
            i = pair(BOX, arrays | {"target_size": size}, **values)
        else:
            values |= {"target__cylinder_radius": 0.5 * size[0], "target__cylinder_length": size[2]}
            i = pair(CYLINDER, arrays, **values)
        try:
            i.step(1000.0)
        except ModelFault as end:
            if "the bodies have met" not in str(end):
                raise


def test_bodies_that_meet_end_the_tow() -> None:
    """A chaser that flies at 50 mm/s from 12 m at a face 1.95 m from the centre is there after 201 s."""
    i = pair(BOX, {"start_relative_velocity": (0.0, -0.05, 0.0), "target_attachment": (0.5, -0.5 * SIZE[1], 0.3)})
    i.step(200.9)
    with pytest.raises(ModelFault, match="the bodies have met") as told:
        i.step(1.0)
    assert float(str(told.value).rpartition(" at ")[2].removesuffix(" s)")) == pytest.approx(201.0, abs=1e-6)
    with pytest.raises(ModelFault, match="the bodies have met"):
        pair(BOX, {"start_relative_position": (0.0, 1.0, 0.0)})
