"""The volume between net and mouth, and the net's surface, of nets whose shape is known, and of a flying one."""

import math

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL
from fmu_src.net_capture.volume import make
from orbital.kernel import kernel
from tests.net_capture.laid import Layer
from tests.net_capture.memory import graph, nodes, shown
from tests.net_capture.test_breaking import BREAKS
from tests.plain import plainly


def watcher(shape):
    """Function of values: a net as it is meant to open, its volume and surface."""
    layer = Layer(shape, volume="plain")
    watch = make(layer.parts).watch

    @kernel
    def look(record, work):
        watch(record[0], work)

    def as_meant(values):
        laid = layer.lay(values)
        plainly(look)(laid.record, laid.work)
        return laid, float(laid.p["net_volume"]), float(laid.p["net_surface"])

    return as_meant


def test_a_pyramid():
    """A mesh that lies across a ridge is cut along one of its diagonals, which may not be the ridge: that takes as many
    meshes as the ridges are long, of a volume each that falls with the cube of the mesh."""
    as_meant, size = watcher("pyramid"), {"net.side": 6.0, "net.depth": 4.0}
    found = [as_meant(size | {"net.mesh": mesh})[1:] for mesh in (1.0, 0.5)]
    volume, surface = 6.0**2 * 4.0 / 3.0, 4 * 0.5 * 6.0 * 5.0
    errors = [volume - v for v, _ in found]
    assert errors[0] == pytest.approx(0.03 * volume, rel=0.1)
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=1e-9)
    assert [s for _, s in found] == pytest.approx([surface, surface], rel=0.02)


def test_a_cone_with_a_floor():
    """Its rim has no more corners than meridians: against the hull of its knots, without the mouth, which is open.
    Where a meridian ends the net lies a little within the hull."""
    values = {"net.radius": 3.0, "net.depth": 4.0, "net.top_radius": 1.0, "net.mesh": 0.25, "net.meridians": 48}
    laid, volume, surface = watcher("cone")(values)
    hull = ConvexHull(laid.places)
    polygon = 24.0 * 9.0 * math.sin(math.pi / 24.0)
    assert volume == pytest.approx(hull.volume, rel=2e-3)
    assert surface == pytest.approx(hull.area - polygon, rel=2e-3)


def test_a_flying_net():
    """Against sums over its nodes in numpy, and the largest is kept."""
    values = {"net.side": 12.0, "net.mesh": 2.0, "solver.jitter[3]": 1e-3}
    net = Instance(MODEL, BREAKS, values).initialise()
    largest = 0.0
    for _ in range(30):
        net.step(0.2)
        largest = max(largest, net["net.volume"])
    place = np.full((int(net.record[0]["node_slots"]), 3), np.nan)
    place[nodes(net)] = shown(net)
    faces, corners = graph(net).faces, graph(net).rim[graph(net).corners]
    middle = place[corners].mean(axis=0)
    volume = surface = 0.0
    for a, b, c, d in faces:
        for triangle in ((a, b, c), (a, c, d)):
            p, q, r = place[list(triangle)] - middle
            volume += np.dot(p, np.cross(q, r)) / 6.0
            surface += np.linalg.norm(np.cross(q - p, r - p)) / 2.0
    assert net["net.volume"] == pytest.approx(abs(volume), rel=1e-10)
    assert net["net.surface"] == pytest.approx(surface, rel=1e-10)
    assert net["net.volume_max"] >= largest > 0.0
    assert net["net.surface"] <= 144.0 * (1.0 + 1e-3)
