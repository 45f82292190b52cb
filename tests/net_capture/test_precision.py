"""Nodes in single precision: how far the flight moves, what memory it takes, and how a scene chooses it."""

import numpy as np
import pytest

from dcone_cosim.loading import load
from dcone_cosim.scene.mistakes import SceneError
from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL
from fmu_src.net_capture.planes import NODE_PLANES, STRIP_NUMBERS, STRIP_WORDS, X
from tests.conftest import FREE
from tests.net_capture.memory import graph, nodes, planes

SINGLE = FREE | {"precision": "single"}
SHOT = 4 * 0.5 * 3.0
"""Momentum that the bullets take, size by size [N s]."""


@pytest.fixture(scope="module")
def flights():
    """Table 1's net in both precisions: the instance after 8 s, its mouth areas until 6 s, and the largest momentum."""
    found = {}
    for name, terms in (("double", FREE), ("single", SINGLE)):
        net = Instance(MODEL, terms).initialise()
        areas, momentum, spin = [], 0.0, 0.0
        for k in range(80):
            net.step(0.1)
            momentum = max(momentum, np.abs(net.array("momentum")).max())
            spin = max(spin, np.abs(net.array("angular_momentum")).max())
            if k < 60:
                areas.append(net["mouth.area"])
        found[name] = (net, np.array(areas), momentum, spin)
    return found


def test_momentum_of_a_flight(flights):
    _, _, kept, _ = flights["double"]
    _, _, moved, spin = flights["single"]
    assert kept < 1e-12 * SHOT
    assert 1e-12 * SHOT < moved < 1e-5 * SHOT
    # about the target's centre, 20 m from the muzzle, where a position is known to 1e-6 m
    assert spin < 1e-4 * SHOT * 20.0


def test_mouth_area_is_within_a_thousandth_until_6_s(flights):
    areas = {name: flight[1] for name, flight in flights.items()}
    assert areas["double"][-1] > 200.0
    assert np.abs(areas["single"] / areas["double"] - 1.0).max() < 1e-3
    assert np.any(areas["single"] != areas["double"])


def test_the_book_closes_in_single_precision(flights):
    net = flights["single"][0]
    assert abs(net["energy.remainder"]) < 0.01 * 9.0


def test_planes_take_half_the_memory(flights):
    """The tables are the same; a row is filled up to a whole vector."""
    sizes = {}
    for name, (net, *_) in flights.items():
        p = net.record[0]
        assert planes(net).shape == (NODE_PLANES, int(p["node_slots"]))
        tables = graph(net)
        own = tables.rest.size
        listed = len(tables.rim) + 2 * len(tables.corners) + len(tables.apex) + tables.faces.size
        around = (STRIP_WORDS + STRIP_NUMBERS) * int(p["strips"]) + listed
        assert int(p["work_size"]) == net.work.size == planes(net).nbytes // 8 + around + own
        sizes[name] = planes(net).nbytes / int(p["node_slots"])
        assert int(p["row_pitch"]) % (4 if name == "double" else 8) == 0
        assert len(nodes(net)) == 625
    assert sizes["single"] == 0.5 * sizes["double"] == NODE_PLANES * 4


def test_positions_are_kept_in_the_precision_asked_for(flights):
    kept = {name: planes(flight[0])[X : X + 3, nodes(flight[0])] for name, flight in flights.items()}
    assert kept["single"].dtype == np.float32
    assert kept["double"].dtype == np.float64
    assert np.any(kept["double"] != kept["double"].astype(np.float32))
    np.testing.assert_allclose(kept["single"].mean(axis=1), kept["double"].mean(axis=1), atol=0.05)


def test_double_is_the_default():
    assert MODEL.interface(FREE).terms["precision"] == "double"
    assert load("table1-capture").phases[0].main.terms["precision"] == "double"


def test_a_scene_chooses_it():
    part = load("table1-capture", ['capture.solver.precision="single"']).phases[0].main
    assert part.terms["precision"] == "single"
    assert part.terms["solver"] == "leapfrog"
    with pytest.raises(SceneError, match=r"capture\.solver\.precision") as caught:
        load("table1-capture", ['capture.solver.precision="half"'])
    assert "double, single" in str(caught.value)


@pytest.mark.parametrize(
    "setting",
    [
        'capture.net.youngs_modulus="700 TPa"',
        'capture.net.mass="0.01 g"',  # rings that the cord moves faster than any thread does
        'capture.closing.axial_stiffness="100 MN"',
    ],
)
def test_substeps_in_which_bullets_hardly_move_are_refused(setting):
    """Whatever makes them short: with 24 bits the target would be 3 to 7 cm deep in the net, or energy come in."""
    coarse = ['capture.net.mesh="4 m"', setting]
    load("table1-capture", coarse)
    with pytest.raises(SceneError, match="at least 24 of that"):
        load("table1-capture", [*coarse, 'capture.solver.precision="single"'])
    load("table1-capture", ['capture.net.mesh="4 m"', 'capture.solver.precision="single"'])
