"""A net that is let go without a shot falls as Clohessy and Wiltshire say: places and velocities of one instant."""

import numpy as np
import pytest

from orbital.hill import clohessy_wiltshire
from tests.conftest import CAPTURE_HILL
from tests.validation import closed_form

RATE = np.sqrt(3.986004418e14 / 7178137.0**3)
LET_GO = {
    "net.mesh": 12.0,
    "bullets.speed": 0.0,
    "chaser.start_position[1]": 9.0,
    "chaser.start_position[2]": -20.0,
    "chaser.start_position[3]": 5.0,
    "chaser.start_velocity[1]": 0.02,
    "chaser.start_velocity[3]": -0.01,
    "closing.time": 1e3,
}
"""Net and chaser begin in one place with one velocity; gravity alone moves them."""


@pytest.mark.parametrize("time", [0.01, 20.0])
def test_places_and_velocities_are_those_of_the_instant(shoot, validated, time):
    """Half a substep of gravity left out of a velocity, at the start or at the end, would be 1e-7 m/s and more."""
    net = shoot(LET_GO, CAPTURE_HILL)
    assert net["solver.substep"] > 5e-5
    net.step(time)
    place, velocity = clohessy_wiltshire(np.array([9.0, -20.0, 5.0]), np.array([0.02, 0.0, -0.01]), RATE, time)
    formula = closed_form("Clohessy and Wiltshire")
    for body, name in (("catch", "net"), ("chaser", "chaser")):
        found = net.array(f"{body}_position"), net.array(f"{body}_velocity")
        validated(formula, f"{name} let go without a shot: place", found[0], place, "m", abs=1e-9)
        validated(formula, f"{name} let go without a shot: velocity", found[1], velocity, "m/s", abs=1e-10)
