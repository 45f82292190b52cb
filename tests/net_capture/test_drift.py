"""A net shot along the track drifts off the line of sight by n D^2 / v: why bullets should be fast."""

import math

import numpy as np
import pytest

from orbital.hill import clohessy_wiltshire
from tests.conftest import CAPTURE_HILL

RATE = math.sqrt(3.986004418e14 / 7178137.0**3)
AWAY = {"net.mesh": 2.0, "shot.axis[2]": -1.0, "closing.time": 1e3, "tether.length": 1e3}
"""Back along the track, where nothing is in the way."""


@pytest.mark.parametrize("speed", [3.0, 6.0])
def test_the_net_drifts_off_the_line_of_sight(shoot, speed):
    """The field is linear, so threads do not matter: the centre of mass flies as one point. 20 m on, the Coriolis
    acceleration 2 n v has carried it by n v t^2, and tides by less than a hundredth of that."""
    net = shoot(AWAY | {"bullets.speed": speed}, CAPTURE_HILL)
    start, velocity = net.array("catch_position").copy(), net.array("catch_velocity").copy()
    mean = -velocity[1]
    assert 0.5 * speed < mean < speed
    time = round(20.0 / mean, 2)
    net.step(time)
    place, _ = clohessy_wiltshire(start, velocity, RATE, time)
    drift = net.array("catch_position") - start
    np.testing.assert_allclose(drift, place - start, rtol=0.0, atol=1e-6)
    reckoned = RATE * drift[1] ** 2 / mean
    assert drift[0] == pytest.approx(-reckoned, rel=0.02)
    # the other way round, or twice as fast, would be seen
    assert abs(drift[0] - reckoned) > reckoned
    assert abs(drift[0] + 0.5 * reckoned) > 0.4 * reckoned
    assert np.abs(drift[2]) < 1e-9
