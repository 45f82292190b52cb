"""Star-folded nets: bullets outermost, arms that unwind from their tips, and which nets cannot be folded so."""

import math

import numpy as np
import pytest
from scipy.spatial import cKDTree

from fmu_src.implied import formula
from fmu_src.instance import Instance
from fmu_src.net_capture.folding.star import widest, wrapped
from fmu_src.net_capture.interface import MODEL, refusals
from fmu_src.net_capture.nets.own_graph import NODES, THREADS
from fmu_src.net_capture.nets.written import ROLES
from fmu_src.net_capture.planes import SHOWN
from tests.conftest import FREE
from tests.net_capture.laid import Layer
from tests.net_capture.memory import graph, nodes, planes
from tests.net_capture.own_files import write

CANISTER = {"canister.radius": 0.12, "canister.depth": 0.3}
CASES = {
    "square": ("square", {"net.side": 4.0, "net.mesh": 0.5, "net.segments": 2}, {}),
    "no knot in the middle": ("square", {"net.side": 4.5, "net.mesh": 0.5}, {}),
    "four times as wide as high": ("rectangle", {"net.width": 8.0, "net.height": 2.0, "net.mesh": 0.25}, {}),
    "pyramid": ("pyramid", {"net.side": 4.0, "net.mesh": 0.5, "net.depth": 3.0}, {}),
    "cone": ("cone", {"net.radius": 2.0, "net.depth": 2.0, "net.top_radius": 0.5, "net.mesh": 0.25}, {}),
    "radial": ("radial", {"net.radius": 3.0, "net.mesh": 0.5}, {}),
    "hexagon": ("hexagon", {"net.radius": 3.0, "net.mesh": 0.5, "net.segments": 2}, {"bullets": "6"}),
    "led": ("square", {"net.side": 4.0, "net.mesh": 0.5, "leads.length": 1.5, "leads.segments": 7}, {"leads": "plain"}),
}


@pytest.fixture(scope="module", params=CASES, ids=str)
def folded(request):
    """The net laid out, and where its nodes lie."""
    shape, values, rigged = CASES[request.param]
    layer = Layer(shape, folding="star", **rigged)
    laid = layer.lay(values | CANISTER)
    assert layer.check(laid.record) == 0
    return laid, layer.fold(laid)


def test_it_is_in_the_canister_with_no_thread_stretched_and_no_two_nodes_in_one_place(folded):
    laid, place = folded
    ends = laid.graph.ends
    length = np.linalg.norm(place[ends[:, 0]] - place[ends[:, 1]], axis=1)
    assert np.all(length <= laid.graph.length * (1.0 - 1e-9))
    there = place[laid.slots]
    apart, _ = cKDTree(there).query(there, k=2)
    assert apart[:, 1].min() > 1e-5
    distance = np.linalg.norm(there[:, :2], axis=1)
    assert distance.max() <= 0.12 + 1e-12
    assert -0.3 - 1e-12 <= there[:, 2].min() < there[:, 2].max() <= 1e-12
    assert np.ptp(there[:, 2]) > 0.44 * 0.3, "see `fold_width`"


def test_bullets_lie_outermost_each_on_its_own_side(folded):
    laid, place = folded
    bullets = laid.graph.bullets
    distance = np.linalg.norm(place[:, :2], axis=1)
    assert distance[bullets].min() > 0.95 * distance[laid.slots].max()
    lies, flies = (np.unwrap(np.arctan2(at[:, 1], at[:, 0])) for at in (place[bullets], laid.planes[SHOWN:].T[bullets]))
    sector = 2.0 * math.pi / len(bullets)
    np.testing.assert_allclose(np.diff(lies), sector, atol=0.05)
    assert abs(np.mean(lies - flies)) < 1e-9
    assert np.abs(lies - flies).max() < 0.5 * sector


def test_arms_lie_side_by_side(folded):
    """Nodes of one arm are from its spiral no farther than half of the way to the next arm, whatever they are of."""
    laid, place = folded
    p, meant = laid.record[0], laid.planes[SHOWN : SHOWN + 2].T[laid.slots]
    arms = int(p["net_corners"])
    first = 0.0 if arms == 6 else math.pi / 4
    angle, radius = np.arctan2(meant[:, 1], meant[:, 0]) - first, np.linalg.norm(meant, axis=1)
    arm = np.round(angle * arms / (2.0 * math.pi))
    along = radius * np.sin(math.pi / arms - np.abs(angle - arm * 2.0 * math.pi / arms))
    pitch = math.pi * 0.12**2 / along.max()
    outermost = 0.12 - 0.45 * pitch / arms
    along *= 1.0 - 0.45 * pitch / arms / radius.max()
    c = 0.5 * outermost**2 / along.max()
    phi = np.linspace(0.0, 1.01 * outermost / c, 200001)
    length = c * (0.5 * phi * np.sqrt(1.0 + phi**2) + 0.5 * np.arcsinh(phi))
    way = np.interp(along, length, phi)
    turned = first + arm * 2.0 * math.pi / arms + way - np.interp(along.max(), length, phi)
    spiral = c * way[:, None] * np.column_stack([np.cos(turned), np.sin(turned)])
    beside = np.linalg.norm(place[laid.slots][:, :2] - spiral, axis=1)
    assert beside.max() < 0.47 * pitch / arms
    assert beside.max() > 0.3 * pitch / arms


@pytest.mark.parametrize("angle", [0.0, 3.0, -3.0, 3.2, -3.2, 40.0])
def test_angles_are_wrapped(angle):
    found = wrapped(angle)
    assert -math.pi <= found <= math.pi
    assert math.cos(found - angle) == pytest.approx(1.0, abs=1e-12)


SHOT = {
    "net.side": 4.0,
    "net.mesh": 0.5,
    "canister.radius": 0.15,
    "canister.depth": 0.2,
    "wall.friction": 0.1,
    "wall.pressing": 3.0,
    "vertex.mass": 1e-3,
    "chaser.mass": 40.0,
    "solver.jitter[1]": 1e-5,
    "shot.roll": 0.3,
}


def test_arms_leave_from_their_tips_inwards():
    """Shot with friction in the canister: along each diagonal knots set out in their order, the middle of the net last
    of all; momentum holds to rounding, and the book to a hundredth of the shot."""
    net = Instance(MODEL, FREE | {"folding": "star", "wall": "plain"}, SHOT).initialise()
    memory, slots = planes(net), nodes(net)
    assert net["energy.elastic"] == 0.0
    energy = net["energy.kinetic"]
    net.step(0.02)  # the chaser recoils, and takes along all that lies in the canister
    lying = memory[SHOWN : SHOWN + 3].T - net.array("chaser_position")
    out = np.full(len(slots), np.inf)
    while net["wall.stowed"] > 0:
        net.step(0.01)
        assert net.time < 5.0
        moved = np.abs(memory[SHOWN : SHOWN + 3].T - net.array("chaser_position") - lying)[slots].max(axis=1) > 1e-5
        out[moved & np.isinf(out)] = net.time
        assert np.abs(net.array("momentum")).max() < 1e-12 * 6.0
        assert abs(net["energy.remainder"]) < 0.01 * energy
    knots = out.reshape(9, 9)
    for arm in (knots, knots[::-1], knots[:, ::-1], knots[::-1, ::-1]):
        diagonal = np.diagonal(arm)[:5]
        assert np.all(np.diff(diagonal) >= 0.0), diagonal
        assert diagonal[1] < diagonal[2] < diagonal[3] < diagonal[4]
    assert knots[4, 4] == out.max()
    assert graph(net).bullets.tolist() == [slots[k] for k in (0, 8, 80, 72)]
    net.step(0.6)
    assert net["mouth.area_max"] > 0.8 * 16.0


def test_a_canister_so_wide_that_arms_do_not_go_round():
    """At the limit an arm of half the side covers the canister in turns as far apart as its radius."""
    radius = formula(widest)(4.0, 4)
    arm = 2.0 * math.sin(math.pi / 4)
    assert math.pi * radius**2 / arm == pytest.approx(radius, rel=1e-12)


OWN = FREE | {"net": "table", "folding": "star"}


def starts():
    rows = [v for v in MODEL.interface(OWN).variables if v.causality == "parameter"]
    return {name: start for v in rows for name, start in zip(v.element_names(), v.starts(), strict=True)}


def crossed(*corners):
    """Tables of a net of one's own: its corners at these angles [deg], 3 m from a vertex to which each has a thread."""
    at = [(3.0 * math.cos(math.radians(angle)), 3.0 * math.sin(math.radians(angle))) for angle in corners]
    vertex, corner = ROLES.index("vertex"), ROLES.index("corner")
    nodes_told = [[2, 1, 0.0, 0.0, 0.0, vertex], *([k + 3, k + 2, x, y, 0.0, corner] for k, (x, y) in enumerate(at))]
    numbers = range(2, len(at) + 2)
    ends = [*((1, k) for k in numbers), *zip(numbers, [*numbers[1:], 2], strict=True)]
    return {
        NODES: np.array(nodes_told),
        THREADS: np.array([[k, a, b, 6, 0, 900, 0.1, 0.1] for k, (a, b) in enumerate(ends, 2)]),
    }


@pytest.mark.parametrize("angles", [(5, 80, 190, 280), (0, 60, 120, 180, 240, 300), (10, 100, 230)])
def test_a_net_with_a_bullet_in_each_sector_may_be_folded(angles):
    assert refusals(OWN | {"bullets": str(len(angles))}, starts() | CANISTER | crossed(*angles)) == []


def test_corners_that_crowd_on_one_side_are_refused():
    found = refusals(OWN, starts() | CANISTER | crossed(0, 20, 40, 200))
    assert [(r.name, r.value) for r in found] == [("folding.pattern", '"star"')]
    assert "each of 4 equal sectors" in found[0].expected
    assert "up to 70 deg" in found[0].expected


@pytest.mark.evidence
def test_a_net_of_ones_own_is_folded_as_ours(tmp_path):
    """Written down and read again, to the bit."""
    shape, values, _ = CASES["square"]
    ours = Layer(shape, folding="star")
    laid = ours.lay(values | CANISTER | {"net.segments": 1})

    class Own(Layer):
        tables = write(laid, tmp_path)

    layer = Own("table", folding="star")
    again = layer.lay(CANISTER)
    np.testing.assert_allclose(layer.fold(again)[again.slots], ours.fold(laid)[laid.slots], atol=1e-15)
