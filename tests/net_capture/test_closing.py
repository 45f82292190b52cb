"""The closing cord and its winches: a square of four bullets drawn in, against an integration of its own."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmu_src.net_capture import formulas
from fmu_src.net_capture.closing.reels import cord_tension
from fmu_src.net_capture.planes import MASS, U
from tests.net_capture.memory import nodes, planes, shown
from tests.validation import closed_form, other_code

SCIPY = other_code("bullets and cord by scipy's RK45")
SPEED, STALL, BULLET = 5.0, 10.0, 0.5
TERMS = {"net": "square", "gravity": "none", "closing": "winches"}
DRAWN = {
    "net.side": 10.0,
    "net.mesh": 5.0,
    "net.mass": 1e-6,
    "net.youngs_modulus": 1e11,
    "net.fold_side": 9.9,
    "vertex.mass": 0.0,
    "bullets.speed": 0.0,
    "bullets.mass": BULLET,
    "closing.time": 0.0,
    "closing.speed": SPEED,
    "closing.stall_force": STALL,
    "closing.rings": 0,
}
"""A net that weighs nothing between four bullets at rest, 9.9 m apart; the winches start at the first look."""
FIRST = 0.01
"""Seconds: the first look at the trigger."""


def tension_and_winding(stiffness, ratio, s, rate, length):
    """Winch and cord solved together, as the physics says: T = k (s - L) + d (s' - L'), L' = -v0 (1 - T/T_stall)."""
    k = stiffness / length
    d = 2.0 * ratio * math.sqrt(k * 0.5 * BULLET)
    if s <= length:
        return 0.0, -SPEED
    tension = (k * (s - length) + d * (rate + SPEED)) / (1.0 + d * SPEED / STALL)
    if tension >= STALL:
        return max(k * (s - length) + d * rate, 0.0), 0.0
    return max(tension, 0.0), -SPEED * (1.0 - max(tension, 0.0) / STALL)


def square(stiffness, ratio, until):
    """Side, its rate, cord per side, work of the four winches and what their dashpots took, at `until`.

    Each bullet is drawn to the centre by two cords: m r'' = -sqrt(2) T and s = sqrt(2) r, so s'' = -2 T/m.
    """

    def rates(_, y):
        s, rate, length, _, _ = y
        tension, winding = tension_and_winding(stiffness, ratio, s, rate, length)
        elastic = max(stiffness * (s - length) / length, 0.0)
        work = 4.0 * (tension + elastic**2 / (2.0 * stiffness)) * -winding
        return [rate, -2.0 * tension / BULLET, winding, work, 4.0 * (tension - elastic) * (rate - winding)]

    start = [9.9, 0.0, 9.9, 0.0, 0.0]
    return solve_ivp(rates, (FIRST, until), start, "RK45", rtol=1e-10, atol=1e-12, max_step=1e-3).y[:, -1]


@pytest.mark.parametrize(("stiffness", "ratio"), [(903.0, 0.106), (903.0, 0.0), (90.0, 0.05)])
def test_winches_draw_the_bullets_as_the_independent_integration_says(shoot, validated, stiffness, ratio):
    """0.7 s: the bullets have all but the speed of the winches. A soft cord stores much of their work."""
    own = {"closing.axial_stiffness": stiffness, "closing.damping_ratio": ratio}
    net = shoot(DRAWN | own, TERMS)
    net.step(0.7)
    s, rate, length, work, taken = square(stiffness, ratio, 0.7)
    a, b = net.array("bullet_position")[:2]
    validated(SCIPY, "winches: distance of two bullets", np.linalg.norm(b - a), s, "m", rel=1e-4)
    validated(SCIPY, "winches: length of the cord", net["mouth.cord_length"], 4.0 * length, "m", rel=1e-4)
    validated(SCIPY, "winches: energy of the bullets", net["energy.kinetic"], BULLET * rate**2, "J", rel=1e-3)
    validated(SCIPY, "winches: their work", net["closing.work"], work, "J", rel=1e-3)
    assert net["cord.dissipated"] == pytest.approx(taken, rel=2e-2, abs=1e-9)
    assert abs(net["energy.remainder"]) < 2e-3 * work


def test_the_cords_own_strain_is_part_of_the_work(shoot):
    """The twin: without T_e^2 / (2 EA) a soft cord's work would be two per cent short."""
    net = shoot(DRAWN | {"closing.axial_stiffness": 90.0, "closing.damping_ratio": 0.05}, TERMS)
    net.step(0.7)
    with_strain = square(90.0, 0.05, 0.7)[3]
    assert net["closing.work"] == pytest.approx(with_strain, rel=1e-3)
    assert with_strain > 1.01 * (with_strain - strain_alone())


def strain_alone():
    """The part of the work that is the cord's own strain, by the same integration."""
    stiffness, ratio = 90.0, 0.05

    def rates(_, y):
        s, rate, length, _ = y
        tension, winding = tension_and_winding(stiffness, ratio, s, rate, length)
        elastic = max(stiffness * (s - length) / length, 0.0)
        return [rate, -2.0 * tension / BULLET, winding, 4.0 * elastic**2 / (2.0 * stiffness) * -winding]

    return solve_ivp(rates, (FIRST, 0.7), [9.9, 0.0, 9.9, 0.0], rtol=1e-9, atol=1e-12, max_step=1e-3).y[3, -1]


def test_four_bullets_come_to_the_speed_of_the_winches(shoot, validated):
    """Closed form for a cord that does not stretch: 4 * m/2 * (v0/sqrt(2))^2 = 12.5 J, (1 - exp(-2 T_stall t/(m v0)))^2
    of it after t."""
    net = shoot(DRAWN | {"closing.axial_stiffness": 1e5}, TERMS)
    net.step(1.0 + FIRST)
    grown = (1.0 - math.exp(-2.0 * STALL * 1.0 / (BULLET * SPEED))) ** 2
    formula = closed_form("12.5 J (1 - exp(-2 T_stall t/(m v0)))^2")
    validated(formula, "winches: energy of the bullets after 1 s", net["energy.kinetic"], 12.5 * grown, "J", rel=2e-3)
    assert net["closing.work"] - net["cord.dissipated"] == pytest.approx(12.5 * grown, rel=3e-3)


@pytest.mark.parametrize("rings", [0, 1])
def test_the_books_remainder_falls_with_the_square_of_the_substep(shoot, rings):
    """Between two instants at which every cord is taut and winding."""
    counts, left = (20, 40, 80), []
    for count in counts:
        own = {"net.youngs_modulus": 1e6, "closing.axial_stiffness": 90.0, "closing.damping_ratio": 0.05}
        own |= {"closing.rings": rings, "net.mass": 1.0}
        probe = shoot(DRAWN | own, TERMS)
        ratio = FIRST / count / probe["solver.stability_bound"] * (1.0 + 1e-6)
        net = shoot(DRAWN | own | {"solver.step_ratio": ratio}, TERMS)
        assert net["solver.substep"] == FIRST / count
        net.step(0.1)
        before = net["energy.remainder"]
        net.step(0.3)
        left.append(abs(net["energy.remainder"] - before))
    assert -np.polyfit(np.log(counts), np.log(left), 1)[0] == pytest.approx(2.0, abs=0.1)


RING = 0.03
"""Mass [kg] of the knots in the middle of the sides, through which the cord runs, in the test below."""


def ringed_square(stiffness, ratio, until):
    """Half a side, half the way between opposite rings, cord per side and work, at `until`.

    Bullets at (+-a, +-a), rings at (0, +-b) and (+-b, 0), all in a plane: of the cord s = 2 sqrt(a^2 + (a - b)^2).
    Its tension moves them as -T ds/dx does: m a'' = -T (2a - b) / l, q b'' = 2 T (a - b) / l, l half of s.
    """

    def motion(y):
        a, va, b, vb, length = y[:5]
        half = math.sqrt(a * a + (a - b) ** 2)
        rate = 2.0 * (a * va + (a - b) * (va - vb)) / half
        k, mass = stiffness / length, 1.0 / (2.0 / BULLET + 4.0 / RING)
        d, stretch = 2.0 * ratio * math.sqrt(k * mass), 2.0 * half - length
        tension = 0.0
        if stretch > 0.0:
            tension = (k * stretch + d * (rate + SPEED)) / (1.0 + d * SPEED / STALL)
            tension = max(tension if tension < STALL else k * stretch + d * rate, 0.0)
        return half, stretch, tension, -SPEED * max(1.0 - tension / STALL, 0.0)

    def rates(_, y):
        a, va, b, vb, length, _ = y
        half, stretch, tension, winding = motion(y)
        elastic = max(stiffness * stretch / length, 0.0)
        push = tension / half
        work = 4.0 * (tension + elastic**2 / (2.0 * stiffness)) * -winding
        return [va, -push * (2.0 * a - b) / (BULLET + RING / 1.5), vb, 2.0 * push * (a - b) / RING, winding, work]

    start = [4.95, 0.0, 4.95, 0.0, 9.9, 0.0]
    return solve_ivp(rates, (FIRST, until), start, "RK45", rtol=1e-9, atol=1e-12, max_step=1e-3).y[:, -1]


@pytest.mark.parametrize(("stiffness", "ratio"), [(903.0, 0.106), (903.0, 0.0), (90.0, 0.5)])
def test_a_ring_is_drawn_after_the_bullets(shoot, validated, stiffness, ratio):
    """A cord through one heavy ring on each side, against an integration of its own: threads stay slack."""
    own = {"net.mass": 12.0 * RING / 1.5, "closing.axial_stiffness": stiffness, "closing.damping_ratio": ratio}
    net = shoot(DRAWN | own | {"closing.rings": 1}, TERMS)
    net.step(0.6)
    assert net["thread.tension_max"] == 0.0
    a, _, b, _, length, work = ringed_square(stiffness, ratio, 0.6)
    first, second = net.array("bullet_position")[:2]
    half = 0.5 * np.linalg.norm(second - first)
    validated(SCIPY, "cord through rings: half the distance of bullets", half, a, "m", rel=2e-4)
    rings = shown(net)[[1, 7]]
    validated(SCIPY, "cord through rings: half the distance of rings", 0.5 * math.dist(*rings), b, "m", rel=2e-4)
    validated(SCIPY, "cord through rings: its length", net["mouth.cord_length"], 4.0 * length, "m", rel=2e-4)
    validated(SCIPY, "cord through rings: work of the winches", net["closing.work"], work, "J", rel=2e-3)
    assert abs(net["energy.remainder"]) < 2e-3 * work


@pytest.mark.parametrize(
    ("knots", "rings", "first", "third"),
    [
        (25, 0, [0, 24], [624, 600]),
        (25, 1, [0, 12, 24], [624, 612, 600]),
        (25, 3, [0, 6, 12, 18, 24], [624, 618, 612, 606, 600]),
        (12, 2, [0, 4, 7, 11], [143, 139, 136, 132]),
        (3, 1, [0, 1, 2], [8, 7, 6]),
    ],
)
def test_rings_are_spread_evenly_over_a_side(shoot, knots, rings, first, third):
    """Knots counted by hand, row by row; the second and fourth side run along the columns.

    In a net that lies folded, all threads slack and each knot a little out of line, one side's cord alone is drawn: its
    stops are what it kicks, each towards those before and after it, and nothing else moves.
    """
    second = [knots - 1 + knots * knot for knot in first]
    fourth = [knots * (knots - 1 - knot) for knot in first]
    change = {"net.side": knots - 1.0, "net.mesh": 1.0, "net.mass": 1.0, "closing.rings": rings, "bullets.speed": 0.0}
    change |= {f"solver.jitter[{i}]": 0.01 for i in (1, 2, 3)}
    net = shoot(change | {"closing.time": 0.0, "closing.lock_length": 0.1}, TERMS)
    net.step(0.01)
    assert net["closing.t_start"] == 0.01
    radius = formulas.ring_radius(0.1, rings)
    mass = planes(net)[MASS, nodes(net)][:, None]
    for side, stops in enumerate((first, second, third, fourth)):
        net.array("cord_length")[:] = 1e3
        net.array("cord_length")[side] = 0.11
        net.array("cord_rate")[:] = 0.0
        places, before = shown(net), shown(net, U)
        net.step(net["solver.substep"])
        assert net["thread.tension_peak"] == 0.0
        kick = mass * (shown(net, U) - before)
        expected = np.zeros_like(kick)
        for a, b in pairwise(stops):
            way = places[b] - places[a]
            pull = way / math.sqrt(way @ way + radius * radius)
            expected[a] += pull
            expected[b] -= pull
        push = net["cord.tension_peak"] * net["solver.substep"]
        assert push > 0.0
        assert kick == pytest.approx(push * expected, rel=1e-9, abs=1e-9 * push)
        assert np.flatnonzero(kick.any(axis=1)).tolist() == sorted(stops)


@pytest.mark.parametrize("fold", [0.05, 0.5, 5.0])
@pytest.mark.parametrize("ratio", [0.0, 0.106])
@pytest.mark.parametrize("rings", [0, 1, 3])
def test_closing_at_the_first_instant_makes_no_energy(shoot, fold, ratio, rings):
    """A folded net whose bullets stand closer than the lock length, or not; nothing damps."""
    change = {
        "net.side": 24.0,
        "net.mesh": 2.0,
        "net.damping_ratio": 0.0,
        "net.fold_side": fold,
        "closing.time": 0.0,
        "closing.damping_ratio": ratio,
        "closing.stall_force": STALL,
        "closing.rings": rings,
    }
    net = shoot(change, TERMS)
    start = net["energy.total"]
    for _ in range(40):
        net.step(0.1)
        assert abs(net["energy.remainder"]) < 0.01 * (start + net["closing.work"])
    assert np.diff(net.array("cord_length")[:4]).max() >= 0.0
    assert net.array("cord_length")[:4].min() >= 0.25


def test_what_a_shorter_cord_would_do(shoot):
    """The twin: with cords of a tenth of the lock length behind the bound's back energy appears from nowhere."""
    change = {"net.mesh": 2.0, "net.damping_ratio": 0.0, "closing.time": 0.0, "closing.damping_ratio": 0.0}
    stiff = {"closing.axial_stiffness": 2e6, "closing.lock_length": 2.5}
    net = shoot(change | stiff, TERMS)
    net.step(0.02)
    net.array("cord_length")[:] = 0.1
    start = net["energy.total"]
    with np.errstate(all="ignore"):
        try:
            net.step(1.0)
        except RuntimeError:
            return
    assert net["energy.total"] > 1.5 * start


def test_tension_and_winch_are_solved_together():
    for function in (cord_tension, cord_tension.py_func):
        # k = 100, d = 2, stretched 0.01 m, bullets at rest: T = (1 + 2 * 5) / (1 + 2 * 5 / 10)
        assert function(100.0, 2.0, 0.01, 0.0, 5.0, 10.0, False) == pytest.approx(5.5)
        # beyond the stall force the winch stands still
        assert function(100.0, 2.0, 0.2, 0.0, 5.0, 10.0, False) == pytest.approx(20.0)
        # locked, the cord is a thread
        assert function(100.0, 2.0, 0.01, 0.25, 0.0, 10.0, False) == pytest.approx(1.5)
        assert function(100.0, 2.0, 0.01, -4.0, 0.0, 10.0, False) == 0.0
        # a reel that yields is solved with the same law beyond the force too: T = (20 + 2 * 5) / (1 + 2 * 5 / 10)
        assert function(100.0, 2.0, 0.2, 0.0, 5.0, 10.0, True) == pytest.approx(15.0)
