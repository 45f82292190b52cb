"""Folded nets: no thread stretched, no two nodes in one place, all within the canister; and a shot from each."""

import math
from functools import cache

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.spatial import cKDTree

from fmu_src.implied import formula
from fmu_src.instance import Instance
from fmu_src.net_capture.folding.rolled import CORE, pitch
from fmu_src.net_capture.folding.spiral import turned
from fmu_src.net_capture.folding.zigzag import fold_width, zigzag
from fmu_src.net_capture.implied import rows
from fmu_src.net_capture.interface import MODEL, refusals
from tests.conftest import FREE
from tests.net_capture.laid import Layer

SET = {
    "flat": {"net.fold_side": 0.4},
    "accordion": {"canister.width": 0.25, "canister.depth": 0.3},
    "rolled": {"canister.radius": 0.12, "canister.depth": 0.3},
    "star": {"canister.radius": 0.12, "canister.depth": 0.3},
}
NETS = {
    "square": {"net.side": 12.0, "net.mesh": 0.5, "net.segments": 2},
    "cone": {"net.radius": 3.0, "net.depth": 4.0, "net.top_radius": 0.8, "net.mesh": 0.25},
    "hexagon": {"net.radius": 4.0, "net.mesh": 0.5},
    "led": {"net.side": 12.0, "net.mesh": 0.5, "leads.length": 3.0, "leads.segments": 7},
}
CASES = [
    ("square", "accordion"),
    ("hexagon", "accordion"),
    ("square", "rolled"),
    ("cone", "rolled"),
    ("led", "accordion"),
    ("hexagon", "star"),
]


@cache
def layer_of(shape, pattern):
    rigged = {"hexagon": {"bullets": "6"}, "led": {"leads": "plain"}}.get(shape, {})
    return Layer("square" if shape == "led" else shape, folding=pattern, **rigged)


LAID = [pytest.param(c, marks=pytest.mark.evidence if c == ("square", "accordion") else ()) for c in CASES]
"""A square from an accordion is shot below."""


@pytest.fixture(scope="module", params=LAID, ids="-".join)
def folded(request):
    """The pattern, the net laid out, and where its nodes lie."""
    shape, pattern = request.param
    layer = layer_of(shape, pattern)
    laid = layer.lay(NETS[shape] | SET[pattern])
    assert layer.check(laid.record) == 0
    return pattern, laid, layer.fold(laid)


def test_no_thread_is_stretched(folded):
    _, laid, place = folded
    ends = laid.graph.ends
    length = np.linalg.norm(place[ends[:, 0]] - place[ends[:, 1]], axis=1)
    assert np.all(length <= laid.graph.length * (1.0 - 1e-9))


def test_no_two_nodes_are_in_one_place(folded):
    _, laid, place = folded
    apart, _ = cKDTree(place[laid.slots]).query(place[laid.slots], k=2)
    assert apart[:, 1].min() > 1e-6


def test_all_is_in_the_canister_and_fills_it(folded):
    pattern, laid, place = folded
    across, along = place[laid.slots][:, :2], place[laid.slots][:, 2]
    assert along.max() <= 1e-12
    assert along.min() >= -0.3 - 1e-12
    assert np.ptp(along) > 0.15
    if pattern == "accordion":
        assert np.abs(across).max() <= 0.125 + 1e-12
        assert np.ptp(across, axis=0).min() > 0.1
    else:
        distance = np.linalg.norm(across, axis=1)
        assert distance.max() <= 0.12 + 1e-12
        assert distance.max() > 0.09
        assert distance.min() < 0.05


def test_layers_of_a_roll_lie_one_on_another():
    """Along one radius, what lies on a turn of the spiral stays within that turn."""
    layer = layer_of("square", "rolled")
    laid = layer.lay(NETS["square"] | SET["rolled"])
    place, meant = layer.fold(laid)[laid.slots], laid.places
    step = formula(pitch)(0.12, 12.0)
    rows = {round(y, 6) for y in meant[:, 1]}
    for y in rows:
        radius = np.linalg.norm(place[np.abs(meant[:, 1] - y) < 1e-6][:, :2], axis=1)
        assert np.ptp(radius) < step


@pytest.mark.parametrize("length", [12.0, 40.0])
def test_a_band_wound_at_that_pitch_fills_the_roll(length):
    """Its spiral, from the core to the canister's wall, is as long as the band."""
    c = formula(pitch)(0.12, length) / math.tau
    found, _ = quad(lambda a: c * math.sqrt(1.0 + a * a), CORE * 0.12 / c, 0.12 / c)
    assert found == pytest.approx(length, rel=1e-4)


@pytest.mark.parametrize("pattern", ["rolled"])
def test_the_outermost_turn_of_a_roll_is_where_its_length_ends(pattern):
    """As far out as a band of the length between its first node and its last is wound, within the turn's thickness."""
    layer = layer_of("square", pattern)
    laid = layer.lay(NETS["square"] | SET[pattern])
    distance = np.linalg.norm(layer.fold(laid)[laid.slots][:, :2], axis=1)
    step = formula(pitch)(0.12, 12.0)
    assert 0.12 - 2.0 * step < distance.max() <= 0.12
    assert CORE * 0.12 - 2.0 * step < distance.min() < CORE * 0.12 + step


@pytest.mark.parametrize("length", [1e-3, 0.3, 7.0, 4e3])
def test_a_spiral_turns_as_far_as_its_length_says(length):
    angle = turned(length)
    found, _ = quad(lambda a: math.sqrt(1.0 + a * a), 0.0, angle)
    assert found == pytest.approx(length, rel=1e-9)


@pytest.mark.parametrize(("width", "mesh"), [(0.25, 0.5), (0.4, 0.5), (0.1, 1.0), (0.5, 0.5), (1.0, 0.5)])
def test_folds_fit_and_spread_the_knots(width, mesh):
    found = fold_width(width, mesh)
    assert found <= width
    assert found > 0.44 * width
    places = np.array([zigzag(mesh * k, found) for k in range(40)])
    assert np.ptp(places) > 0.9 * found
    if mesh > width:
        assert np.diff(np.sort(places)).max() < 0.2 * found


def test_a_zigzag():
    ways = [0.0, 0.1, 0.25, 0.3, 0.5, 0.6, -0.1]
    assert [zigzag(way, 0.25) for way in ways] == pytest.approx([-0.125, -0.025, 0.125, 0.075, -0.125, -0.025, -0.025])


@pytest.mark.parametrize("pattern", ["accordion", pytest.param("rolled", marks=pytest.mark.evidence)])
def test_a_shot_from_it_opens(pattern):
    values = NETS["square"] | SET[pattern] | {"net.segments": 1, "net.mesh": 1.0, "shot.roll": 0.3}
    net = Instance(MODEL, FREE | {"folding": pattern}, values).initialise()
    assert net["energy.elastic"] == 0.0
    shot = np.linalg.norm(net.array("catch_velocity")) * net["catch.mass"]
    reach = np.linalg.norm(net.array("chaser_position")) + 0.5
    assert np.abs(net.array("chaser_spin")).max() > 1e-3 * shot * 0.25, "bullets lie unevenly in the canister"
    for _ in range(10):
        net.step(0.6)
        assert np.abs(net.array("momentum")).max() < 1e-12 * shot
        assert np.abs(net.array("angular_momentum")).max() < 1e-12 * shot * reach, "as before the shot"
    assert net["mouth.area_max"] > 0.9 * 144.0
    assert abs(net["energy.remainder"]) < 0.01 * 9.0


def starts_of(pattern):
    """Every parameter of a net folded so, by FMI name."""
    variables = [v for v in MODEL.interface(FREE | {"folding": pattern}).variables if v.causality == "parameter"]
    return {name: start for v in variables for name, start in zip(v.element_names(), v.starts(), strict=True)}


@pytest.mark.parametrize(
    ("pattern", "change", "told"),
    [
        ("accordion", {"canister.width": 12.0}, "canister.width"),
        ("accordion", {"canister.depth": 6.0}, "canister.depth"),
        ("rolled", {"canister.depth": 6.0}, "canister.depth"),
        ("rolled", {"canister.radius": 1.2}, "canister.radius"),
        ("star", {"canister.depth": 6.0}, "canister.depth"),
        ("star", {"canister.radius": 1.4}, "canister.radius"),
    ],
)
def test_a_canister_that_is_none_is_refused_before_and_by_the_kernel(pattern, change, told):
    terms = FREE | {"folding": pattern}
    values = starts_of(pattern) | NETS["square"] | SET[pattern]
    assert refusals(terms, values) == []
    assert [refusal.name for refusal in refusals(terms, values | change)] == [told]
    layer = layer_of("square", pattern)
    record = layer.counted(NETS["square"] | SET[pattern] | change)
    assert layer.check(record) != 0
    assert record[0]["fault_value"] == next(iter(change.values()))


@pytest.mark.parametrize(
    ("pattern", "expected"),
    [("accordion", 0.25 * 0.25 * 0.3), *((each, math.pi * 0.12 * 0.12 * 0.3) for each in ("rolled", "star"))],
)
def test_what_is_told_of_the_canister(pattern, expected):
    terms = MODEL.interface(FREE | {"folding": pattern}).terms
    told = {row.key: row for row in rows(starts_of(pattern) | NETS["square"] | SET[pattern], terms)}
    assert told["canister.volume"].value == pytest.approx(expected, rel=1e-12)
    assert told["canister.filled"].value == pytest.approx(0.33 / 1440.0 / expected, rel=1e-12)
    assert told["canister.filled"].unit == "", "a share is no count"
