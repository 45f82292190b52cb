"""No node passes unseen into the target, however fast it is: the search follows the way through the substep."""

import numpy as np
import pytest

from tests.conftest import CAPTURE
from tests.net_capture.memory import shown

WALL = {f"target.size[{i}]": size for i, size in ((1, 8.0), (2, 2.0), (3, 8.0))}
LIGHT = {
    "net.side": 4.0,
    "net.mesh": 1.0,
    "net.mass": 1e-5,
    "net.youngs_modulus": 1e6,
    "net.damping_ratio": 0.0,
    "net.fold_side": 0.4,
    "vertex.mass": 1e-6,
    "bullets.mass": 1e-3,
    "bullets.angle": 0.3,
    "chaser.start_position[2]": -5.0,
    "closing.rings": 0,
}
"""A net of milligrams whose soft threads leave the substep at a millisecond and more; a stiff cord through its light
knots would not."""


def deepest(net):
    """How far any node is inside the target, by its place and attitude as told [m]."""
    w, x, y, z = net.array("target_attitude")
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    inside = (shown(net) - net.array("target_position")) @ turn
    half = 0.5 * net.array("target_size")
    return float(np.max(np.min(half - np.abs(inside), axis=1)))


def fly(net, speed):
    """Deepest place of a node in the target at any substep until everything has met it."""
    worst = -np.inf
    while net.time < 12.0 / speed:
        net.step(net["solver.substep"])
        worst = max(worst, deepest(net))
    return worst


@pytest.mark.parametrize("speed", [3.0, 300.0, 3000.0])
@pytest.mark.parametrize("mass", [1e3, 1e-2])
def test_no_node_enters_the_target(shoot, speed, mass):
    net = shoot(WALL | LIGHT | {"bullets.speed": speed, "target.mass": mass}, CAPTURE)
    reach = speed * net["solver.substep"]
    worst = fly(net, speed)
    assert net["contact.first_time"] > 0.0
    assert net["contact.impulse"] > 0.0
    assert worst < 1e-3 * max(1.0, reach)


@pytest.mark.parametrize("axis", [1, 3])
def test_none_enters_along_another_axis(shoot, axis):
    """The way counts along each axis of the box: from 5.15 m, its middle is outside when its end is inside."""
    wall = WALL | {"target.size[2]": 8.0, f"target.size[{axis}]": 2.0}
    there = {"chaser.start_position[2]": 0.0, f"chaser.start_position[{axis}]": -5.15, "bullets.speed": 3000.0}
    net = shoot(LIGHT | wall | there, CAPTURE)
    reach = 3000.0 * net["solver.substep"]
    assert fly(net, 3000.0) < 1e-3 * max(1.0, reach)
    assert net["contact.impulse"] > 0.0


def test_a_turning_target_sweeps_up_nodes(shoot):
    """The surface comes to the net: 20 rad/s at 4 m."""
    turning = {"target.start_rate[3]": 20.0, "bullets.speed": 1.0, "target.mass": 1e3}
    net = shoot(WALL | LIGHT | turning, CAPTURE)
    assert fly(net, 1.0) < 2e-3
    assert net["contact.impulse"] > 0.0
