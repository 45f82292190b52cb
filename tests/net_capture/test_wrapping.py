"""Threads that bend round the target: the way over an edge, two nodes that swing round one, momenta."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from fmu_src.net_capture.contact.edges import make_bend
from fmu_src.net_capture.interface import MODEL, refusals
from fmu_src.net_capture.planes import U, X
from fmu_src.net_capture.refusal import Scene
from orbital.kernel import kernel
from tests.net_capture.on_target import Kernels

BOX = {"net": "square", "gravity": "none", "target": "box", "contact": "inelastic", "wrap": "plain"}
SIDES = {"target_size": (4.0, 8.0, 4.0), "target_mass": 1e9}
NODE, LENGTH = 5e-4, 1.0


@pytest.fixture(scope="module")
def kernels():
    return Kernels(BOX)


@pytest.fixture(scope="module")
def bend(kernels):
    find = make_bend(kernels.parts)

    @kernel
    def found(record):
        return find(record[0])

    def over(a, b, **values):
        scene = kernels.place(**SIDES | values)
        scene.p["wrap_a"], scene.p["wrap_b"] = a, b
        return scene.p["wrap_bend"].copy() if found(scene.record) else None

    return over


@pytest.mark.parametrize("seed", range(6))
def test_a_way_over_an_edge_is_the_shortest(bend, seed):
    """Of all points of that edge, by minimising."""
    draw = np.random.default_rng(seed)
    a = np.array([draw.uniform(1.4, 1.95), draw.uniform(-1.0, 1.0), 2.0 + draw.uniform(0.0, 0.3)])
    b = np.array([2.0 + draw.uniform(0.0, 0.3), draw.uniform(-1.0, 1.0), draw.uniform(1.2, 1.7)])
    if np.linalg.norm(np.cross(b - a, (2.0 - a[0], 0.0, 2.0 - a[2]))) == 0.0:
        pytest.skip("it grazes the edge")
    way = lambda t: np.linalg.norm(a - (2.0, t, 2.0)) + np.linalg.norm(b - (2.0, t, 2.0))  # noqa: E731
    shortest = minimize_scalar(way, bounds=(-2.0, 2.0), method="bounded", options={"xatol": 1e-10})
    middle = 0.5 * (a + b)
    cuts = (a[2] - 2.0) * (2.0 - b[2]) < (2.0 - a[0]) * (b[0] - 2.0) or max(middle[0], middle[2]) < 2.0
    found = bend(a, b)
    if found is None:
        inside = [np.all(np.abs(a + s * (b - a)) < (2.0, 4.0, 2.0)) for s in np.linspace(0.0, 1.0, 2001)]
        assert not any(inside), "it cuts the box"
    else:
        assert cuts
        assert found[[0, 2]] == pytest.approx((2.0, 2.0), abs=1e-12)
        assert found[1] == pytest.approx(shortest.x, abs=1e-5)


def test_what_does_not_cut_an_edge_stays_straight(bend):
    assert bend((0.0, 0.0, 2.0), (1.0, 0.0, 2.0)) is None, "both on one face"
    assert bend((0.0, 0.0, 2.5), (1.0, 0.0, 2.1)) is None, "above it"
    assert bend((2.5, 0.0, 2.5), (3.5, 0.0, 1.0)) is None, "beside it"
    assert bend((1.9, 0.0, 2.0), (2.0, 0.0, 1.9)) is not None, "round a corner from face to face"
    assert bend((0.0, 0.0, 2.1), (0.0, 0.0, -2.1)) is None, "round two edges, which it does not know of"


def swung(kernels, **values):
    """Two nodes that fall at 1 m/s with a taut thread across an edge: energy [J] of both and in the thread after 0.3 s,
    over that at the start."""
    scene = kernels.place(**SIDES | values)
    edge = np.array([2.0, 0.0, 2.0])
    across, down = np.array([-1.0, 0.0, 1.0]) / math.sqrt(2.0), np.array([-1.0, 0.0, -1.0]) / math.sqrt(2.0)
    places = [edge + 0.5 * LENGTH * side * across - 0.01 * down for side in (1.0, -1.0)]
    stiffness = 13368.0
    scene.put([NODE] * 2, places, [down] * 2).join(2, LENGTH, stiffness, 0.0)
    before = momenta(scene)
    scene.go(2e-5, 15000)
    speeds = scene.planes[U : U + 3, :2].T
    return scene, 0.5 * NODE * (speeds**2).sum() / NODE, before


def momenta(scene):
    places, speeds = (scene.planes[first : first + 3, :2].T for first in (X, U))
    held = scene.p["target_mass"] * scene.p["target_drift"]
    turning = np.cross(places, NODE * speeds).sum(axis=0) + np.cross(scene.p["target_place"], held)
    return NODE * speeds.sum(axis=0) + held, turning + scene.p["target_spin"]


def test_nodes_swing_round_an_edge_and_keep_what_they_have(kernels):
    """A contact point in the middle of a straight thread would have left them nothing."""
    scene, share, _ = swung(kernels)
    assert share == pytest.approx(1.0, abs=1e-6)
    assert scene.p["wrap_impulse"] > 0.2 * NODE
    # they go round: what fell now comes from both sides
    assert np.linalg.norm(scene.planes[X : X + 3, 0] - scene.planes[X : X + 3, 1]) < 0.9 * LENGTH


def test_a_light_target_takes_the_opposite_of_all(kernels):
    scene, _, before = swung(kernels, target_mass=0.05, target_start_rate=(0.2, 0.1, 0.4))
    for now, then in zip(momenta(scene), before, strict=True):
        assert now == pytest.approx(then, abs=1e-12 * np.abs(then).max() + 1e-15)
    assert np.linalg.norm(scene.p["target_drift"]) > 1e-3


def test_the_pull_along_the_way_takes_the_place_of_the_straight_one(kernels):
    """Both are taut: each node is pulled towards the edge alone, by k (l - L)."""
    edge, places = np.array([2.0, 0.0, 2.0]), np.array([(1.5, 0.0, 2.02), (2.02, 0.0, 1.995)])
    scene = kernels.place(**SIDES).put([NODE] * 2, places, np.zeros((2, 3))).join(2, 0.5, 13368.0, 0.0)
    scene.go(1e-6, 1)
    far = np.linalg.norm(places - edge, axis=1)
    towards = (edge - places) / far[:, None]
    pull = 13368.0 * (far.sum() - 0.5)
    np.testing.assert_allclose(scene.planes[U : U + 3, :2].T, 1e-6 * pull / NODE * towards, rtol=1e-6, atol=1e-9)


def test_a_taut_thread_that_is_through_already_stays_straight(kernels):
    """The pull of a way that is there at once would come from nowhere."""
    scene = kernels.place(**SIDES)
    places = [(1.4, 0.0, 2.001), (2.001, 0.0, 1.4)]
    scene.put([NODE] * 2, places, np.zeros((2, 3))).join(2, 1.1, 13368.0, 0.0)
    scene.go(2e-5, 10)
    assert scene.p["wrap_passed"] == 1
    assert scene.p["wrap_impulse"] == 0.0
    # were it slack, it would have its way at once, and pull once that is longer than it is
    scene = kernels.place(**SIDES).put([NODE] * 2, places, [(-1.0, 0.0, 0.0), (0.0, 0.0, -1.0)])
    scene.join(2, 1.21, 13368.0, 0.0).go(2e-5, 1000)
    assert scene.p["wrap_passed"] == 0
    assert scene.p["wrap_impulse"] > 0.2 * NODE


def test_what_no_thread_bends_with_is_refused():
    terms = dict(BOX)
    interface = MODEL.interface(terms | {"precision": "single"})
    start = {n: s for v in interface.variables for n, s in zip(v.element_names(), v.starts(), strict=True)}
    assert [r.name for r in refusals(terms | {"precision": "single"}, start)] == ["solver.precision"]
    hollow = MODEL.interface(terms | {"target": "mesh"}).terms
    found = MODEL.groups["wrap"].terms["plain"].refuses(Scene(hollow, {}, 1.0, {}))
    assert [r.name for r in found] == ["target.shape"]
    with pytest.raises(ValueError, match="break"):
        MODEL.interface(terms | {"break": "breaks"})
