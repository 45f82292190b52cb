"""Reels that wind what is loose of their cord as they start (`closing.slack`): in closed form, and in the book."""

import numpy as np
import pytest

from tests.net_capture.holding import ALONE, HOLDING
from tests.net_capture.test_closing import BULLET, DRAWN, FIRST, SPEED, TERMS, square
from tests.net_capture.test_following import FOLLOWING, watch
from tests.net_capture.test_springs import LAW, SIDE, SPRUNG, Reference, energy, sides
from tests.validation import closed_form

WOUND = {"closing.slack": 1}
LOOSE = 2.1
"""Metres: a mouth of 12 m whose bullets are 9.9 m apart."""
WIDE = DRAWN | WOUND | {"net.side": 9.9 + LOOSE, "net.mesh": 0.5 * (9.9 + LOOSE)}
TAUT = FIRST + LOOSE / SPEED
"""Seconds: when their cord is taut, t0 + s/v0."""


def test_the_cord_pulls_once_its_slack_is_wound(shoot, validated):
    """Within a substep, and no reel ever winds faster than its speed without load."""
    net = shoot(WIDE, TERMS)
    h = net["solver.substep"]
    net.step(FIRST)
    assert net["closing.t_start"] == FIRST
    before, taut = net["mouth.cord_length"], -1.0
    assert before == pytest.approx(4.0 * (9.9 + LOOSE))
    while net.time < 1.0:
        net.step(h)
        assert before - net["mouth.cord_length"] <= 4.0 * SPEED * h * (1.0 + 1e-9)
        before = net["mouth.cord_length"]
        if taut < 0.0 and net["cord.tension_max"] > 0.0:
            taut = net.time
            assert net["energy.kinetic"] < 1e-3
    validated(closed_form("t0 + s/v0"), "slack cord: when it pulls first", taut, TAUT, "s", abs=2.0 * h)


def test_a_cord_that_is_taken_in_pulls_at_once(shoot):
    """The twin, as a scene has it by default: all of it is in at the start."""
    net = shoot(WIDE | {"closing.slack": 0}, TERMS)
    net.step(FIRST + 0.01)
    assert net["mouth.cord_length"] < 4.0 * 9.9
    assert net["cord.tension_max"] > 0.0


def test_then_it_draws_as_one_that_was_taut(shoot):
    """As the independent integration of bullets whose cord was taut from the start says, so much later."""
    net = shoot(WIDE | {"closing.axial_stiffness": 903.0, "closing.damping_ratio": 0.106}, TERMS)
    net.step(0.7 + LOOSE / SPEED)
    s, rate, length, work, _ = square(903.0, 0.106, 0.7)
    a, b = net.array("bullet_position")[:2]
    assert np.linalg.norm(b - a) == pytest.approx(s, rel=1e-4)
    assert net["mouth.cord_length"] == pytest.approx(4.0 * length, rel=1e-4)
    assert net["energy.kinetic"] == pytest.approx(BULLET * rate**2, rel=1e-3)
    assert net["closing.work"] == pytest.approx(work, rel=1e-3)
    assert abs(net["energy.remainder"]) < 2e-3 * work


def test_brakes_take_what_springs_give_to_slack_cord(shoot):
    """All of it until the cord is taut, in closed form; then as the independent integration says."""
    loose = (10.0 - SIDE) / LAW["closing.speed"]
    net = shoot(SPRUNG | LAW | WOUND, HOLDING)
    net.step(FIRST + 0.5 * loose)
    length = 0.5 * (10.0 + SIDE)
    assert net.array("cord_length")[:4] == pytest.approx(length, rel=1e-9)
    assert net["closing.work"] == 0.0
    assert net["cord.tension_max"] == 0.0
    assert net["closing.braked"] == pytest.approx(4.0 * (energy(LAW, 10.0) - energy(LAW, length)), rel=1e-9)
    net.step(FIRST + loose + 0.6 - net.time)
    told = Reference(LAW, 0.6 + FIRST)
    slack = 4.0 * (energy(LAW, 10.0) - energy(LAW, SIDE))
    assert sides(net)[0] == pytest.approx(np.linalg.norm(told.places[1] - told.places[0]), rel=1e-4)
    assert net["closing.work"] == pytest.approx(told.work, rel=2e-3)
    assert net["closing.braked"] - slack == pytest.approx(told.braked, rel=2e-3, abs=2e-3)
    assert abs(net["energy.remainder"]) < 2e-3 * net["energy.kinetic"]
    assert np.abs(net.array("momentum")).max() < 1e-9 * BULLET


@pytest.mark.parametrize("time", [0.0, 1.2])
def test_a_reel_that_jams_keeps_the_slack_that_it_has_not_wound(shoot, time):
    net = shoot(SPRUNG | LAW | WOUND | {"jam.reel": 2, "jam.time": time}, HOLDING)
    net.step(2.0)
    wound = LAW["closing.speed"] * (2.0 - FIRST)
    until = LAW["closing.speed"] * max(time - FIRST, 0.0)
    lengths = net.array("cord_length")[:4]
    assert lengths[[0, 2, 3]] == pytest.approx(10.0 - wound)
    assert lengths[1] == pytest.approx(10.0 - until, abs=1.01 * LAW["closing.speed"] * net["solver.substep"])


@pytest.mark.parametrize("jams", [1e9, 0.0])
def test_a_cord_that_is_stretched_at_the_start_holds_nothing_yet(shoot, jams):
    """Bullets fly apart beyond the side of the mouth before the reels start; what the net stores the cord does not.
    Nor does that of a reel that has jammed."""
    own = {"net.fold_side": 9.9, "net.mass": 0.1, "net.youngs_modulus": 1e7, "bullets.speed": 3.0}
    net = shoot(SPRUNG | ALONE | LAW | WOUND | own | {"closing.time": 0.1, "jam.time": jams}, HOLDING)
    net.step(0.1)
    assert min(sides(net)) > 10.01
    assert net.array("cord_length")[:4] == pytest.approx(sides(net), rel=1e-12)
    start = net["energy.total"]
    net.step(0.1)
    assert abs(net["energy.remainder"]) < 0.005 * start


def test_substeps_that_follow_the_net_reckon_with_the_cord_that_is_out(shoot):
    """Slack to taut, undamped: no instant is faster than the bound then in force."""
    own = {"net.damping_ratio": 0.0, "closing.damping_ratio": 0.0, "net.mesh": 4.0, "closing.time": 8.0}
    net = shoot(own | WOUND | {"closing.axial_stiffness": 1e5}, FOLLOWING)
    net.step(8.0)
    slack = net["mouth.cord_length"] - sum(sides(net))
    assert slack > 1.0
    rows = watch(net, 14.0, 0.0537)
    limit, substep, bound, faster = rows.T
    assert net["cord.tension_max"] > 1.0
    assert (limit >= bound).all()
    assert (limit > substep).all()
    assert (faster > 1.05).any()
    assert net["solver.margin_least"] >= 1.0
