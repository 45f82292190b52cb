"""Springs that draw the mouth in, and a reel that jams: four bullets, against an integration of their own."""

import math
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmu_src.net_capture import formulas
from fmu_src.net_capture.closing.part import refuses
from fmu_src.net_capture.planes import MASS, U
from fmu_src.net_capture.refusal import Scene
from tests.net_capture.holding import ALONE, HOLDING
from tests.net_capture.memory import nodes, planes, shown
from tests.validation import other_code

SCIPY = other_code("scipy's DOP853, bullets, cords and springs as point masses")

BULLET, SIDE, LOCK, FIRST = 0.5, 4.0, 0.25, 0.01
SPRUNG = ALONE | {
    "net.side": 10.0,
    "net.mesh": 5.0,
    "net.mass": 1e-6,
    "net.youngs_modulus": 1e11,
    "net.fold_side": SIDE,
    "bullets.speed": 0.0,
    "bullets.angle": 0.5 * math.pi,
    "bullets.mass": BULLET,
    "closing.time": 0.0,
    "closing.rings": 0,
}
"""A net that weighs nothing between four bullets at rest; the springs start at the first look."""


class Reference:
    """Positions (4, 2), velocities (4, 2), cords (4,), work of the springs and what their brakes took.

    Written from the laws alone: T = k (s - L) + d (s' - L'), L' = -v0 (1 - T/F), F = min(most, F0 + c (L - L_lock)).
    """

    def __init__(self, values, until, jams=(math.inf,) * 4):
        self.values, self.jams = values, jams
        corners = 0.5 * SIDE * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
        speed = values.get("bullets.speed", 0.0)
        outward = corners / np.linalg.norm(corners[0])
        moved = corners + FIRST * speed * outward
        self.begin = np.linalg.norm(moved[1] - moved[0])
        lengths = [10.0 if jam < FIRST else self.begin for jam in jams]
        start = np.concatenate([moved.ravel(), speed * outward.ravel(), lengths, [0.0, 0.0]])
        found = solve_ivp(self.rates, (FIRST, until), start, rtol=1e-10, atol=1e-12, max_step=5e-4).y[:, -1]
        self.places, self.speeds = found[:8].reshape(4, 2), found[8:16].reshape(4, 2)
        self.cords, self.work, self.braked = found[16:20], found[20], found[21]

    def force(self, length):
        v = self.values
        return min(v["closing.force_limit"], v["closing.force"] + v["closing.force_rate"] * (length - LOCK))

    def rates(self, time, y):
        v, stiffness = self.values, 903.0
        places, speeds, lengths = y[:8].reshape(4, 2), y[8:16].reshape(4, 2), y[16:20]
        pushed, turning, work, braked = np.zeros((4, 2)), np.zeros(4), 0.0, 0.0
        for i in range(4):
            j = (i + 1) % 4
            way = places[j] - places[i]
            s = np.linalg.norm(way)
            rate = way @ (speeds[j] - speeds[i]) / s
            k, full = stiffness / lengths[i], self.force(lengths[i])
            d = 2.0 * 0.106 * math.sqrt(k * 0.5 * BULLET)
            top = 0.0 if time >= self.jams[i] else v["closing.speed"]
            tension, holds = 0.0, False
            if s > lengths[i]:
                tension = (k * (s - lengths[i]) + d * (rate + top)) / (1.0 + d * top / full)
                holds = tension > full and not v.get("closing.pulled", 0)
                if holds:
                    tension = k * (s - lengths[i]) + d * rate
                tension = max(tension, 0.0)
            turning[i] = 0.0 if holds else -top * (1.0 - tension / full)
            elastic = max(k * (s - lengths[i]), 0.0)
            each = (tension + elastic**2 / (2.0 * stiffness)) * -turning[i]
            work, braked = work + each, braked + full * -turning[i] - each
            pushed[i] += tension * way / s
            pushed[j] -= tension * way / s
        return np.concatenate([speeds.ravel(), pushed.ravel() / BULLET, turning, [work, braked]])


def sides(net):
    places = net.array("bullet_position")
    return [math.dist(places[i], places[(i + 1) % 4]) for i in range(4)]


@pytest.fixture
def sprung(shoot):
    """A net of four bullets on springs that has gone on for so long."""

    def run(values, until):
        net = shoot(SPRUNG | values, HOLDING)
        net.step(until)
        assert np.abs(net.array("momentum")).max() < 1e-9 * BULLET
        assert np.abs(net.array("angular_momentum")).max() < 1e-9 * BULLET * 300.0
        return net

    return run


def energy(values, length):
    """Of a spring with so much cord out, until its pair is locked [J], in closed form."""
    least, rate, most = (values[f"closing.force{part}"] for part in ("", "_rate", "_limit"))
    rising = min(length - LOCK, (most - least) / rate) if rate else length - LOCK
    return rising * (least + 0.5 * rate * rising) + most * (length - LOCK - rising)


@pytest.mark.parametrize(("rate", "limit"), [(0.0, 20.0), (2.0, 20.0), (2.0, 8.0)])
def test_what_springs_give_the_bullets_get(sprung, rate, limit):
    """All but what a brake takes that holds 100 m/s at the whole force: no more than the share of the reel's speed."""
    values = {"closing.force": 5.0, "closing.force_rate": rate, "closing.force_limit": limit, "closing.speed": 100.0}
    net = sprung(values, 0.4)
    length = net["mouth.cord_length"] / 4.0
    given = 4.0 * (energy(values, SIDE) - energy(values, length))
    reel = 2.0 * math.sqrt(net["energy.kinetic"] / (4.0 * BULLET))
    got = net["energy.total"] + net["cord.dissipated"]
    assert (1.0 - reel / 100.0) * given < got < (1.0 + 1e-3) * given
    assert net["closing.spring_energy"] == pytest.approx(4.0 * energy(values, length), rel=1e-9)
    assert LOCK < length < 3.5


LAW = {"closing.force": 3.0, "closing.force_rate": 4.0, "closing.force_limit": 12.0, "closing.speed": 2.0}
CASES = {
    "braked": (LAW, 0.6),
    "holding": (LAW | {"bullets.speed": 3.0, "closing.speed": 5.0, "solver.step_ratio": 0.1}, 0.5),
    "paying out": (
        LAW | {"bullets.speed": 3.0, "closing.speed": 5.0, "closing.pulled": 1, "solver.step_ratio": 0.1},
        0.5,
    ),
    "hardly braked": (LAW | {"closing.speed": 8.0}, 0.4),
}


@pytest.mark.parametrize("name", CASES)
def test_springs_draw_the_bullets_as_the_independent_integration_says(validated, sprung, name):
    values, until = CASES[name]
    net = sprung(values, until)
    told = Reference(values, until)
    between = np.linalg.norm(told.places[1] - told.places[0])
    validated(SCIPY, f"springs, {name}: distance of two bullets", sides(net)[0], between, "m", rel=1e-4)
    validated(SCIPY, f"springs, {name}: length of the cord", net["mouth.cord_length"], sum(told.cords), "m", rel=1e-4)
    validated(SCIPY, f"springs, {name}: their work", net["closing.work"], told.work, "J", abs=2e-3 * told.work + 1e-9)
    slack = 4.0 * (energy(LAW, 10.0) - energy(LAW, told.begin))
    assert net["closing.braked"] - slack == pytest.approx(told.braked, rel=2e-3, abs=2e-3)
    assert abs(net["energy.remainder"]) < 2e-3 * net["energy.kinetic"]


def test_what_a_weaker_spring_would_do(sprung):
    """The twin: one per cent less force shows."""
    values, until = CASES["hardly braked"]
    net = sprung(values | {"closing.force_limit": 0.99 * values["closing.force_limit"]}, until)
    told = Reference(values, until)
    assert abs(sides(net)[0] / math.dist(told.places[1], told.places[0]) - 1.0) > 1e-3


@pytest.mark.parametrize("time", [0.0, 0.2])
def test_a_reel_that_jams_leaves_the_others_drawing(validated, sprung, time):
    """Before the start its cord stays as long as the side of the net, later as long as it is then."""
    jam = {"jam.reel": 2, "jam.time": time}
    net = sprung(LAW | jam, 0.6)
    told = Reference(LAW, 0.6, (math.inf, time, math.inf, math.inf))
    apart = [math.dist(told.places[(i + 1) % 4], told.places[i]) for i in range(4)]
    validated(
        SCIPY, "one spring jams: its cord and the others", net.array("cord_length")[:4], told.cords, "m", rel=2e-4
    )
    validated(SCIPY, "one spring jams: sides of the mouth", sides(net), apart, "m", rel=5e-4)
    assert net["closed"] == 0


@pytest.mark.parametrize(
    ("rings", "at", "stops"),
    [
        (1, 0, ([0, 2, 4], [4, 14, 24], [24, 22, 20], [20, 10, 0])),
        (1, 1, ([2, 4, 14], [14, 24, 22], [22, 20, 10], [10, 0, 2])),
        (3, 2, ([2, 3, 4, 9, 14], [14, 19, 24, 23, 22], [22, 21, 20, 15, 10], [10, 5, 0, 1, 2])),
    ],
)
def test_reels_stand_at_chosen_knots(shoot, rings, at, stops):
    """Of a net of 5 x 5 that lies folded, all threads slack; knots counted by hand, row by row.

    One cord alone is drawn: each of its stops is kicked towards those before and after it, and nothing else moves.
    """
    change = {"net.side": 4.0, "net.mesh": 1.0, "net.mass": 1.0, "closing.rings": rings, "closing.reels_at": at}
    change |= {f"solver.jitter[{i}]": 0.01 for i in (1, 2, 3)} | {"bullets.speed": 0.0, "closing.time": 0.0}
    net = shoot(ALONE | change | {"closing.lock_length": 0.1}, HOLDING)
    assert net.array("cord_length")[:4] == pytest.approx(4.0)
    net.step(0.01)
    radius, mass = formulas.ring_radius(0.1, rings), planes(net)[MASS, nodes(net)][:, None]
    for cord, along in enumerate(stops):
        net.array("cord_length")[:] = 1e3
        net.array("cord_length")[cord] = 0.11
        net.array("cord_rate")[:] = 0.0
        places, before = shown(net), shown(net, U)
        net.step(net["solver.substep"])
        kick = mass * (shown(net, U) - before)
        expected = np.zeros_like(kick)
        for a, b in pairwise(along):
            way = places[b] - places[a]
            pull = way / math.sqrt(way @ way + radius * radius)
            expected[a] += pull
            expected[b] -= pull
        push = net["cord.tension_peak"] * net["solver.substep"]
        assert push > 0.0
        assert kick == pytest.approx(push * expected, rel=1e-9, abs=1e-9 * push)


def test_a_reel_beyond_the_last_ring_is_refused():
    values = {"closing.rings": 1, "closing.reels_at": 2, "closing.trigger": 0}
    net = SimpleNamespace(checks=SimpleNamespace(knots=lambda values: 20))
    (refusal,) = refuses(Scene({"target": "box"}, values, 30.0, {"net": net}))
    assert (refusal.name, refusal.value) == ("closing.reels_at", "2")
