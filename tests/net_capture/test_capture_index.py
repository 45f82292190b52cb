"""The capture quality index: of a net in flight against scipy's Qhull and the formula written out again."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from fmu_src.implied import formula
from fmu_src.net_capture import capture_index
from fmu_src.net_capture.capture_index import KNOWN, quality_index, told_extent
from fmu_src.net_capture.interface import GROUPS, MODEL
from fmu_src.net_capture.refusal import Scene
from fmu_src.net_capture.shapes import frustum, solids
from tests.net_capture.holding import HOLDING
from tests.net_capture.memory import shown
from tests.net_capture.test_union_wrapping import box, laid
from tests.validation import other_code


def expected(points, offset, volume, surface, length):
    hull = ConvexHull(points)
    return 0.1 * abs(hull.volume / volume - 1.0) + 0.1 * abs(hull.area / surface - 1.0) + 0.8 * offset / length


@pytest.mark.parametrize("flown", [0.5, 7.0])
def test_the_index_is_that_of_qhull_and_the_formula(validated, shoot, flown):
    """Table 1's box, 4 x 8 x 4 m: 128 m3, 160 m2, and 16/3 m as the mean of its edges."""
    net = shoot({"net.mesh": 2.0, "jam.time": 1e9}, HOLDING)
    assert (net["quality.length"], net["quality.at_capture"]) == (pytest.approx(16.0 / 3.0), -1.0)
    net.step(flown)
    points = shown(net)
    hull = ConvexHull(points)
    assert net["quality.hull_volume"] == pytest.approx(hull.volume, rel=1e-4)
    assert net["quality.hull_surface"] == pytest.approx(hull.area, rel=1e-5)
    offset = math.dist(net.array("catch_position"), net.array("target_position"))
    index = expected(points, offset, 128.0, 160.0, 16.0 / 3.0)
    validated(other_code("Qhull"), "capture quality index in flight", net["quality.index"], index, "1", rel=1e-5)


def test_the_index_takes_the_scenes_own_figures(shoot):
    own = {"quality.characteristic_length": 8.0, "quality.target_volume": 100.0, "quality.target_surface": 150.0}
    net = shoot({"net.mesh": 2.0, "jam.time": 1e9} | own, HOLDING)
    net.step(3.0)
    offset = math.dist(net.array("catch_position"), net.array("target_position"))
    assert net["quality.index"] == pytest.approx(expected(shown(net), offset, 100.0, 150.0, 8.0), rel=1e-5)


def test_the_length_of_a_target_is_the_mean_of_its_own_edges():
    """Of the box that holds it, wherever its centre of mass lies in that: a cone's is at a quarter of its length."""
    sizes = {"target_radius_bottom": 1.2, "target_radius_top": 0.0, "target_length": 3.0}
    cone = SimpleNamespace(**sizes, half_size=np.zeros(3), quality_characteristic_length=0.0)
    formula(frustum.measure)(cone)
    assert cone.half_size[2] == pytest.approx(2.25)
    memory = SimpleNamespace(node_plane=None)
    parts = SimpleNamespace(
        memory=memory, per_double=1, scratch_plane=0, terms={"target": "frustum"}, code=lambda name: 1
    )
    formula(capture_index.make(parts).start)(cone)
    assert cone.quality_length == pytest.approx((2.4 + 2.4 + 3.0) / 3.0)
    club = laid(box((0.2, 0.2, 0.2), (0.0, 0.0, -1.5), mass=50.0), box((0.1, 0.1, 3.0), (0.0, 0.0, 0.1), mass=1.0))
    assert club["target.solid"][solids.EDGE] == pytest.approx((0.2 + 0.2 + 3.2) / 3.0)


def test_a_net_that_is_the_target_has_index_zero():
    assert quality_index(128.0, 160.0, 0.0, 128.0, 160.0, 5.0) == 0.0
    assert quality_index(256.0, 120.0, 2.5, 128.0, 160.0, 5.0) == pytest.approx(0.1 + 0.025 + 0.4)


@pytest.mark.parametrize("name", KNOWN)
def test_solids_are_known_by_their_sizes(name):
    """Against the hull of what pictures draw: facets of a round body lie within it, and are short of it by little."""
    part = GROUPS["target"].terms[name]
    record = MODEL.interface(HOLDING | {"target": name}).make_record().view(np.recarray)[0]
    values = {key: start for v in part.variables for key, start in zip(v.element_names(), v.starts(), strict=True)}
    corners, _ = part.checks.surface(values)
    drawn = ConvexHull(np.array(corners))
    found = KNOWN[name].py_func(record)
    for known, short in zip(found, (drawn.volume, drawn.area), strict=True):
        assert short <= known * (1.0 + 1e-12)
        assert short == pytest.approx(known, rel=1e-12 if name == "box" else 0.05)


def test_round_solids_by_heart():
    radius, length = 2.0, 8.0
    record = SimpleNamespace(
        target_radius=radius, target_length=length, target_radius_bottom=3.0, target_radius_top=0.0
    )
    assert KNOWN["cylinder"].py_func(record) == pytest.approx((32.0 * math.pi, 40.0 * math.pi))
    assert KNOWN["sphere"].py_func(record) == pytest.approx((32.0 / 3.0 * math.pi, 16.0 * math.pi))
    assert KNOWN["frustum"].py_func(record) == pytest.approx((24.0 * math.pi, math.pi * (9.0 + 3.0 * math.sqrt(73.0))))
    record.quality_target_volume, record.quality_target_surface = 3.0, 7.0
    assert told_extent.py_func(record) == (3.0, 7.0)


@pytest.mark.parametrize(
    ("target", "given", "blamed"),
    [
        ("box", (0.0, 0.0), []),
        ("box", (5.0, 0.0), ["quality.target_surface"]),
        ("blob", (0.0, 0.0), ["quality.target_volume", "quality.target_surface"]),
        ("blob", (5.0, 9.0), []),
    ],
)
def test_volumes_that_nobody_knows_are_refused(target, given, blamed):
    values = {"quality.target_volume": given[0], "quality.target_surface": given[1]}
    scene = Scene({"target": target}, values, 30.0, {})
    refuses = GROUPS["quality"].terms["plain"].refuses
    assert [refusal.name for refusal in refuses(scene)] == blamed
