"""What starts the reels by a distance: the first look at which it has been reached, worked out from the outputs."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from fmu_src.net_capture.closing.part import refuses
from fmu_src.net_capture.closing.triggers import TRIGGER_DISTANCE, WAYS
from fmu_src.net_capture.refusal import Scene
from tests.net_capture.holding import HOLDING

DISTANCES = {"bullets_beyond_target": -1.0, "vertex_to_target": 14.0, "mouth_to_muzzle": 9.0, "vertex_to_muzzle": 4.0}


def reached(net, way, distance):
    muzzle, vertex = np.array([0.0, -20.0, 0.0]), net.array("vertex_position")
    along = net.array("bullet_position")[:, 1]
    return {
        "bullets_beyond_target": along.min() - net["target.position[2]"] >= distance,
        "vertex_to_target": math.dist(vertex, net.array("target_position")) <= distance,
        "mouth_to_muzzle": along.mean() + 20.0 >= distance,
        "vertex_to_muzzle": math.dist(vertex, muzzle) >= distance,
    }[way]


@pytest.mark.parametrize("way", WAYS)
def test_reels_start_at_the_first_look_at_the_distance(shoot, way):
    distance = DISTANCES[way]
    change = {"closing.trigger": TRIGGER_DISTANCE, "closing.measured": WAYS.index(way), "closing.distance": distance}
    net = shoot({"net.mesh": 4.0, "jam.time": 1e9, "tether.length": 100.0} | change, HOLDING)
    look = 0
    while not reached(net, way, distance):
        look += 1
        assert net["closing.t_start"] == -1.0
        net.step(0.01 * look - net.time)
    assert net["closing.t_start"] == pytest.approx(0.01 * look, abs=1e-9)
    assert 2.0 < net.time < 14.0


NET = SimpleNamespace(checks=SimpleNamespace(knots=lambda values: 20))
"""A net whose sides have room for rings."""


@pytest.mark.parametrize(
    ("way", "distance", "target", "blamed"),
    [
        ("bullets_beyond_target", 0.0, True, []),
        ("bullets_beyond_target", 0.0, False, ["closing.measured"]),
        ("vertex_to_target", 0.0, True, ["closing.distance"]),
        ("vertex_to_muzzle", 3.0, False, []),
        ("mouth_to_muzzle", -1.0, False, ["closing.distance"]),
    ],
)
def test_distances_that_nothing_reaches_are_refused(way, distance, target, blamed):
    values = {
        "closing.rings": 1,
        "closing.reels_at": 0,
        "closing.trigger": TRIGGER_DISTANCE,
        "closing.measured": WAYS.index(way),
        "closing.distance": distance,
    }
    scene = Scene({"target": "box"} if target else {}, values, 30.0, {"net": NET})
    assert [refusal.name for refusal in refuses(scene)] == blamed
