"""A settled line round a box: over edges, along which it slides, and over one that it touches for a moment only."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fmu_src.instance import Instance
from tests.tethered_deorbit.wrapped import BOX, M_C, REDUCED, SIZE, STIFFNESS, momentum, pair
from tests.validation import Validated, closed_form

SETTLED = BOX | {"level": "settled"}
LENGTH = 12.0
SEEN = ("tether.tension", "separation", "tether.impulse", "tether.wrapped", "target.attitude[2]", "target.rate[3]")
WITHIN = (3e-8, 3e-9, 6e-8, 3e-9, 6e-10, 1e-10)
"""What these may be off [N], [m], [N s], [m], [-], [rad/s]: some three times what they are at most."""


def rows(i: Instance, until: float) -> np.ndarray:
    """SEEN, then largest and least tension of the macro step, bends, steps so far, and whether it is settled."""
    found = []
    while i.time < until:
        i.step(4.0)
        others = ("tether.tension_peak", "tether.tension_least", "tether.bends", "solver.steps")
        settled = i["level.settled"] if "level" in i.interface.terms else 0.0
        found.append([i[name] for name in (*SEEN, *others)] + [settled])
    return np.array(found)


def sliding(terms: dict[str, str]) -> Instance:
    """1 N draws the line tight over an edge, along which it slides by some decimetres until it comes off."""
    turned = Rotation.from_euler("zyx", (0.8, -0.4, 0.45))
    x, y, z, w = turned.as_quat()
    start = {
        "target_attachment": (0.5 * SIZE[0], 1.2, 0.0),
        "target_start_attitude": (w, x, y, z),
        "target_start_rate": (-0.0075, -0.0057, 0.0044),
        "start_relative_velocity": (-0.012, 0.002, -0.023),
    }
    straight = pair(BOX, start, tether__rest_length=100.0)["tether.length"]
    rest = straight - LENGTH / 3.0 / STIFFNESS
    return pair(terms, start, tether__rest_length=rest, thrust__level=-1.0, tether__damping_ratio=0.2)


def touching(terms: dict[str, str], faster: float, width: float = SIZE[0]) -> Instance:
    """0.3 N tow a box by the middle of its face, along which the line comes to lie about a minute after the start.

    faster        by how much it turns faster than would have it come near
    width         of its face                                    [m]
    """
    arm, inertia = 0.5 * SIZE[1], 1788.0
    load = 0.3 / M_C / (1.0 / REDUCED + arm * arm / inertia)
    slowed = load * arm / inertia
    turned = Rotation.from_euler("z", 0.5 * math.pi - 0.5 * slowed * (60.0**2 - 5.0**2))
    x, y, z, w = turned.as_quat()
    at = turned.as_matrix() @ [0.0, -arm, 0.0]
    rate = np.array([0.0, 0.0, 60.0 * slowed * faster])
    start = {
        "target_size": (width, *SIZE[1:]),
        "target_inertia": (1671.0, 924.0, inertia, 0.0, 0.0, 0.0),
        "target_start_attitude": (w, x, y, z),
        "target_start_rate": rate,
        "start_relative_position": np.array([0.0, LENGTH, 0.0]) - at,
        "start_relative_velocity": -np.cross(rate, at),
    }
    rest = LENGTH - load / STIFFNESS * LENGTH
    return pair(terms, start, tether__rest_length=rest, thrust__level=-0.3, tether__damping_ratio=0.2)


def test_a_line_that_settles_and_slides_is_that_whose_vibration_is_followed() -> None:
    """In 85 steps in place of 220 before it comes off the edge, tension to 1e-8 N of 0.4 N."""
    followed, stepped_over, at_once = sliding(BOX), sliding(SETTLED), sliding(SETTLED)
    beside, there = rows(followed, 92.0), rows(stepped_over, 92.0)
    over = (there[:, 8] == 1.0) & (there[:, 10] == 1.0)
    assert over.sum() > 10
    assert np.ptp(there[over, 3]) > 0.5
    assert (np.abs(there - beside)[:, :6].max(axis=0) < WITHIN).all()
    # the largest and the least tension of each macro step; where it comes off the largest is that of this instant, of
    # which both runs know the tension's course, 0.024 N/s, but the time no better than to half a millisecond
    off = np.flatnonzero(np.diff(there[:, 8]) < 0.0) + 1
    assert len(off) == 1
    extremes = np.abs(there - beside)[:, 6:8]
    assert extremes[off].max() < 0.024 * 5e-4
    extremes[off] = 0.0
    assert extremes.max() < WITHIN[0]
    last = np.flatnonzero(over)[-1]
    assert 2 * there[last, 9] < beside[last, 9]
    at_once.step(92.0)
    assert [at_once[name] for name in SEEN] == list(there[-1, :6])


@pytest.mark.parametrize("faster", [1.008, 1.01])
def test_a_step_that_would_go_over_an_edge_and_back_ends_there(faster: float) -> None:
    """A touch of 1 s and one of 8 s, in a step of 25 s. Passed over, the latter cost 1.2e-5 N and 5e-7 of attitude."""
    followed, stepped_over = touching(BOX, faster), touching(SETTLED, faster)
    beside, there = rows(followed, 120.0), rows(stepped_over, 120.0)
    assert stepped_over["level.times_settled"] > 1
    assert 1.5 * there[-1, 9] < beside[-1, 9]
    assert (np.abs(there - beside)[:, :6].max(axis=0) < WITHIN).all()


def test_a_settled_line_over_edges_keeps_angular_momentum(validated: Validated) -> None:
    """Without thrust, while it slides: what the pull turns the box by it takes from the pair, to 6e-8 of 207 N m s in a
    minute."""
    i = sliding(SETTLED)
    i.step(40.0)
    assert i["level.settled"]
    assert i["tether.bends"] == 1
    i["thrust.offset"] = 1.0
    before = momentum(i)
    i.step(60.0)
    kept, what = closed_form("angular momentum is kept"), "settled line that slides over an edge: momentum in a minute"
    validated(kept, what, momentum(i), before, "N.m.s", abs=2e-7)


def test_what_shakes_a_line_as_it_meets_an_edge(validated: Validated) -> None:
    """Its load leaps by J = m w^2 (1/l' - 1/l) as its free length l becomes l', w the speed of its end across it: that
    swings on a shorter radius. So a settled line is followed again there: it shakes by J/k, and its tension has

        J (1 - e^(-z p t) (cos q t - z/(1 - z^2)^(1/2) sin q t)),   p^2 = k/m, z = c/(2 m p), q^2 = (1 - z^2) p^2

    more than beside a face of a fiftieth of the width, whose edge the line meets at the same instant; from then on the
    arm turns too, which takes 0.05 J in a second.
    """
    i, narrow = touching(BOX, 4.0), touching(BOX, 4.0, SIZE[0] / 50.0)
    while i["tether.bends"] == 0:
        i.step(0.01)
        narrow.step(0.01)
    turned = Rotation.from_quat(np.roll(i.array("target_attitude"), -1))
    at, spin = turned.apply(i.array("target_attachment")), turned.apply(i.array("target_rate"))
    line = i.array("chaser_position") - i.array("target_position") - at
    n = line / np.linalg.norm(line)
    speed = i.array("chaser_velocity") - i.array("target_velocity") - np.cross(spin, line + at)
    across = speed - n * (n @ speed)
    lever = turned.inv().apply(np.cross(at, n))
    mass = 1.0 / (1.0 / REDUCED + lever @ (lever / [1671.0, 924.0, 1788.0]))
    wrapped = i["tether.wrapped"]
    shorter = 1.0 / (LENGTH - wrapped) - 1.0 / (LENGTH - wrapped / 50.0)
    leap = mass * (across @ across) * shorter
    stiffness = STIFFNESS / LENGTH
    frequency = math.sqrt(stiffness / mass)
    share = 0.2 * math.sqrt(stiffness * REDUCED) / (mass * frequency)
    quick = math.sqrt(1.0 - share * share)
    begin, first = i.time, i["tether.tension"] - narrow["tether.tension"]
    for _ in range(7):
        i.step(0.05)
        narrow.step(0.05)
        angle = frequency * (i.time - begin)
        swing = math.cos(quick * angle) - share / quick * math.sin(quick * angle)
        wanted = 1.0 - math.exp(-share * angle) * swing
        more = i["tether.tension"] - narrow["tether.tension"] - first
        formula, what = (
            closed_form("m w^2 (1/l' - 1/l), damped"),
            "line that meets an edge: leap of its load, over its size",
        )
        validated(formula, what, more / leap, wanted, "1", abs=0.01)
    assert wanted > 0.9
