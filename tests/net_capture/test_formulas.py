"""Sections, stiffness, dashpots and the stability bound of net and cord, against hand calculation and the matrix."""

import math
from itertools import pairwise

import numpy as np
import pytest

from fmu_src.net_capture import formulas
from tests.validation import closed_form

LIMITS = formulas.make_substep_limits(formulas.longest_step, formulas.accurate_step)


def test_table_1_thread(validated):
    """0.33 kg of 1440 kg/m3 in 1200 m of thread, 70 GPa: 0.191 mm2, 0.493 mm, EA = 13.37 kN."""
    length = formulas.grid_length(24.0, 24.0, 1.0)
    area = formulas.thread_area(0.33, 1440.0, length)
    assert length == 1200.0
    section = closed_form("m/(rho total length)")
    validated(section, "Table 1's thread: area", area, 0.191e-6, "m2", rel=1e-3)
    diameter = formulas.round_diameter(area)
    validated(closed_form("sqrt(4 A/pi)"), "Table 1's thread: diameter", diameter, 0.493e-3, "m", rel=1e-3)
    stiffness = formulas.axial_stiffness(70e9, area, 1.0)
    validated(closed_form("E A"), "Table 1's thread: EA", stiffness, 13368.0, "N", rel=1e-4)
    # xi = 0.106, an inner knot of two threads of 0.275 g
    assert formulas.thread_dashpot(0.106, 13368.0, 5.5e-4) == pytest.approx(0.5748, rel=1e-3)


def test_cord_of_half_a_millimetre_of_nylon():
    """4.6 GPa on 0.196 mm2: EA = 903 N; two bullets of 0.5 kg on 24 m swing at 1.95 Hz."""
    stiffness = formulas.cord_stiffness(903.0, 24.0)
    assert stiffness == pytest.approx(37.6, rel=1e-3)
    assert math.sqrt(stiffness / 0.25) / (2.0 * math.pi) == pytest.approx(1.953, rel=1e-3)
    mass = formulas.cord_mass(0.5, 1e-3, 0)
    assert formulas.cord_damping(0.1, stiffness, mass) == pytest.approx(0.2 * math.sqrt(37.625 * 0.25), rel=1e-9)
    # one ring on a knot of a gram, bent sharply: it moves twice as far as the cord lengthens
    assert formulas.cord_mass(0.5, 1e-3, 1) == pytest.approx(1.0 / (4.0 + 4000.0))
    # reels on knots of the rim, and the ring at the bullet between them
    assert formulas.cord_mass(0.5, 1e-3, 1, 1) == pytest.approx(1.0 / (8.0 + 2000.0))
    # rings take a fifth of 25 cm, shared by the stretches; without rings there is nothing to pass
    assert [formulas.ring_radius(0.25, rings) for rings in (0, 1, 3)] == pytest.approx([0.0, 0.025, 0.0125])


def matrices(knots, stiffness, damping, knot_mass, bullet, cord, dashpot, rings=0):
    """Mass, stiffness and dashpot matrices of a square net along one line, with a cord around its corners.

    Through rings the cord runs back and forth, bent as sharply as it can be: its way is s = sum |x_i - x_j|, and both
    ends of a stretch pull towards each other. One of a ring's stretches is as short as its radius, and turns.
    """
    n = knots * knots
    k, c, mass = np.zeros((n, n)), np.zeros((n, n)), np.zeros(n)
    corners = [0, knots - 1, n - 1, n - knots]
    pairs = [(i * knots + j, i * knots + j + 1) for i in range(knots) for j in range(knots - 1)]
    pairs += [(i * knots + j, (i + 1) * knots + j) for i in range(knots - 1) for j in range(knots)]
    for a, b in pairs:
        mass[[a, b]] += 0.25 * knot_mass
    mass[corners] += bullet
    ring = list(zip(corners, corners[1:] + corners[:1], strict=True))
    slopes = [(np.eye(n)[a] - np.eye(n)[b], stiffness, damping) for a, b in pairs]
    for a, b in ring:
        stops = [a + (b - a) * i // (rings + 1) for i in range(rings + 2)]
        way = sum((-1) ** i * (np.eye(n)[p] - np.eye(n)[q]) for i, (p, q) in enumerate(pairwise(stops)))
        slopes.append((way, cord, dashpot))
        # a stretch of 20 % strain turns about a radius of a tenth of the lock length, a tenth over the stretches of two
        turns = 0.2 * (rings + 1) / 0.2 * cord
        slopes += [(np.eye(n)[p] - np.eye(n)[q], turns, 0.0) for p, q in list(pairwise(stops))[: rings - rings // 2]]
    for slope, stiff, damp in slopes:
        k += stiff * np.outer(slope, slope)
        c += damp * np.outer(slope, slope)
    return mass, k, c


def largest(mass, k, c, h):
    """Largest size of an eigenvalue of the scheme: x' = x + h v', v' = v + h a(x, v + (v - u)/2), u' = v."""
    n = mass.size
    one, none = np.eye(n), np.zeros((n, n))
    a, b = -h * k / mass[:, None], -h * c / mass[:, None]
    v = np.hstack([a, one + 1.5 * b, -0.5 * b])
    step = np.vstack([np.hstack([one, none, none]) + h * v, v, np.hstack([none, one, none])])
    # a net that drifts as a whole has a double eigenvalue 1, which rounding spreads: look beyond it
    return np.abs(np.linalg.eigvals(step)).max()


@pytest.mark.parametrize("bullet", [0.5, 1e-5])
@pytest.mark.parametrize("rings", [0, 1, 3])
@pytest.mark.parametrize(("ratio", "cord"), [(0.0, 3612.0), (0.106, 3612.0), (1.0, 3612.0), (0.106, 3e6), (0.0, 3e6)])
def test_the_bound_holds_for_net_and_cord_together(ratio, cord, bullet, rings):
    """Where cord and threads differ in damping the modes do not decouple: the bound is tried on the whole matrix."""
    stiffness, knot = 13368.0, 5.5e-4
    damping = formulas.thread_dashpot(ratio, stiffness, knot)
    dashpot = formulas.cord_damping(0.106, cord, formulas.cord_mass(bullet, 0.75 * knot, rings))
    mass, k, c = matrices(5, stiffness, damping, knot, bullet, cord, dashpot, rings)
    bound, accurate = LIMITS(stiffness, damping, knot, cord, dashpot, bullet, rings, 0.0)
    assert accurate <= 0.9 * bound * (1.0 + 1e-12)
    assert largest(mass, k, c, bound) < 1.0 + 1e-5
    # and it is not far from the edge: half as much again diverges
    assert largest(mass, k, c, 1.5 * bound) > 1.01 or (rings and largest(mass, k, c, 2.0 * bound) > 1.01)


def test_the_step_follows_the_damping():
    """Of Table 1's net: omega h from 0.3 without damping to nine tenths of the bound from a ratio of 0.15 on."""
    stiffness_rate = 4.0 * 13368.0 / 5.5e-4
    omega = math.sqrt(2.0 * stiffness_rate)
    for ratio, expected in ((0.0, 0.3), (0.0225, 0.4126), (0.05, 0.550), (0.106, 0.831)):
        damping_rate = 4.0 * formulas.thread_dashpot(ratio, 13368.0, 5.5e-4) / 5.5e-4
        assert omega * formulas.accurate_step(stiffness_rate, damping_rate) == pytest.approx(expected, rel=2e-3)
    for ratio in (0.2, 1.0):
        damping_rate = 4.0 * formulas.thread_dashpot(ratio, 13368.0, 5.5e-4) / 5.5e-4
        limit = formulas.longest_step(stiffness_rate, damping_rate)
        assert formulas.accurate_step(stiffness_rate, damping_rate) == pytest.approx(0.9 * limit, rel=1e-12)
