"""The hexagonal net against one drawn in plain Python, and against the sagging net of a published rod code."""

import math
from collections import Counter
from itertools import pairwise

import numpy as np
import pytest

from fmu_src.instance import Instance, ModelFault
from fmu_src.net_capture.implied import catch_mass
from fmu_src.net_capture.interface import MODEL, refusals
from tests.conftest import FREE
from tests.net_capture.laid import Layer
from tests.net_capture.told import knots_are_as_told
from tests.validation import other_code

TERMS = FREE | {"net": "hexagon", "bullets": "6"}
ROOT = math.sqrt(0.75)


def draw(n, mesh, pieces):
    """Threads as pairs of places, of what the model's page says: six spokes, in each sector threads along both its
    spokes, and a rim."""
    spokes = [mesh * np.array([math.cos(k * math.pi / 3), math.sin(k * math.pi / 3)]) for k in range(7)]
    threads = set()

    def add(a, b):
        ends = [tuple(np.round(p, 9) + 0.0) for p in (a, b)]
        threads.add(frozenset(ends))

    for u, v in pairwise(spokes):
        for i in range(n + 1):
            for j in range(n + 1 - i):
                here = i * u + j * v
                if i + j < n:
                    add(here, here + u)
                    add(here, here + v)
        for i in range(n):
            add((n - i) * u + i * v, (n - i - 1) * u + (i + 1) * v)
    return threads


def all_values(values):
    rows = [v for v in MODEL.interface(TERMS).variables if v.causality == "parameter"]
    starts = {name: start for v in rows for name, start in zip(v.element_names(), v.starts(), strict=True)}
    assert set(values) <= set(starts)
    return starts | values


CASES = [(5, 0.2, 4), (2, 1.5, 1), (3, 1.0, 2), (36, 0.5, 1)]


@pytest.fixture(scope="module")
def layer():
    return Layer("hexagon", bullets="6")


@pytest.fixture(scope="module", params=CASES, ids=str)
def laid(request, layer):
    n, mesh, pieces = request.param
    values = {"net.radius": n * mesh, "net.mesh": mesh, "net.segments": pieces, "net.fold_side": 0.4 * mesh}
    return request.param, values, layer.lay(values)


def test_knots_weigh_what_is_told(laid, layer):
    _, values, net = laid
    knots_are_as_told(layer.terms, values, net)


def test_threads_are_those_drawn(laid):
    (n, mesh, pieces), values, net = laid
    whole = draw(n, mesh, pieces)
    expected = Counter()
    for thread in whole:
        a, b = (np.array(end) for end in thread)
        chain = [a + share * (b - a) for share in np.linspace(0.0, 1.0, pieces + 1)]
        expected.update(frozenset(tuple(np.round(p, 6) + 0.0) for p in pair) for pair in pairwise(chain))
    places = net.planes[14:17].T
    found = Counter(
        frozenset(tuple(np.round(places[node][:2], 6) + 0.0) for node in pair) for pair in net.graph.ends.tolist()
    )
    assert found == expected
    assert len(net.graph.ends) == net.p["net_threads"] == 6 * n * (n + 1) * pieces
    assert len(net.slots) == net.p["net_nodes"] == 3 * n * (n + 1) + 1 + (pieces - 1) * 6 * n * (n + 1)
    np.testing.assert_allclose(net.graph.length, mesh / pieces, rtol=1e-12)
    said = MODEL.groups["net"].terms["hexagon"].checks
    assert said.nodes(all_values(values)) == net.p["net_nodes"]
    assert said.total(all_values(values)) == pytest.approx(net.graph.length.sum(), rel=1e-12)
    row = net.graph.ends // int(net.p["row_pitch"])
    starts = np.repeat(np.cumsum(net.graph.strips) - net.graph.strips, net.graph.strips)
    np.testing.assert_array_equal(row, row[starts])


def test_rim_corners_faces_and_vertex(laid):
    (n, mesh, _), values, net = laid
    rim = net.number[net.graph.rim].tolist()
    at = net.places[rim]
    np.testing.assert_allclose(np.linalg.norm(np.roll(at, -1, axis=0) - at, axis=1), mesh, rtol=1e-9)
    assert len(set(rim)) == 6 * n
    corners = at[net.graph.corners]
    np.testing.assert_allclose(np.linalg.norm(corners, axis=1), n * mesh, rtol=1e-12)
    twice = sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True))
    assert 0.5 * twice == pytest.approx(float(net.p["mouth_flat_area"]), rel=1e-12)
    np.testing.assert_allclose(net.places[net.number[net.graph.apex]], 0.0, atol=1e-12)
    faces = net.number[net.graph.faces][:, :3]
    edges = Counter((int(a), int(b)) for face in faces for a, b in zip(face, np.roll(face, -1), strict=True))
    assert set(edges.values()) == {1}
    assert {e for e in edges if e[::-1] not in edges} == set(zip(rim, rim[1:] + rim[:1], strict=True))
    lines, edge = MODEL.groups["net"].terms["hexagon"].checks.drawing(all_values(values))
    assert edge == [*rim, rim[0]]
    assert len({frozenset(line) for line in lines}) == 6 * n * (n + 1)


def test_what_hangs_on_its_knots(laid):
    (*_, pieces), values, net = laid
    hang = np.zeros(len(net.mass))
    for end in net.graph.ends.T:
        np.add.at(hang, end, 0.5 * net.graph.length * pieces)
    said = MODEL.groups["net"].terms["hexagon"].checks.hanging(all_values(values))
    hang *= 0.33 / net.graph.length.sum()
    assert said.inside == pytest.approx(hang.max(), rel=1e-12)
    assert said.edge == pytest.approx(hang[net.graph.rim].max(), rel=1e-12)
    assert said.corner == pytest.approx(hang[net.graph.bullets].max(), rel=1e-12)
    stiff = np.zeros(len(net.mass))
    for end in net.graph.ends.T:
        np.add.at(stiff, end, net.graph.stiffness)
    thread, _, node = net.thread
    assert 4.0 * thread / node == pytest.approx((stiff[net.slots] / net.mass[net.slots]).max(), rel=1e-12)


def test_a_net_that_sags_as_in_a_published_code(layer, validated):
    """631 nodes and 720 edges of 0.05 m of a hexagon of 1 m, E = 1 MPa, 1000 kg/m3, radius 10 mm, velocities damped by
    0.1 /s, 50 m/s2 downward, corners fixed, springs that push too: all of it in this test but the graph."""
    area = math.pi * 1e-4
    values = {
        "net.radius": 1.0,
        "net.mesh": 0.2,
        "net.segments": 4,
        "net.fold_side": 0.1,
        "net.youngs_modulus": 1e6,
        "net.density": 1000.0,
        "net.mass": 1000.0 * area * 36.0,
    }
    net = layer.lay(values)
    ends, rest, stiffness = net.number[net.graph.ends], net.graph.length, net.graph.stiffness
    assert (len(net.slots), len(ends)) == (631, 720)
    np.testing.assert_allclose(stiffness * rest, 1e6 * area, rtol=1e-12)
    free = np.setdiff1d(np.arange(631), net.number[net.graph.bullets])
    sag = sagging(net.places.copy(), ends, rest, stiffness, net.mass[net.slots], free)
    source = "DDG_Tutorial, rod_network/case_1 (weicheng-huang-mechanics, MATLAB)"
    validated(other_code(source), "hexagonal net: sag at 0.2 s", sag, 0.732, "m", rel=2e-3)


def sagging(place, ends, rest, stiffness, mass, free, steps=4000, end=0.2):
    """Depth of the lowest node [m] then, by the leapfrog: what that code comes to as its step shrinks."""
    step, moving = end / steps, np.zeros_like(place)
    for number in range(steps):
        along = place[ends[:, 1]] - place[ends[:, 0]]
        long = np.linalg.norm(along, axis=1)
        pull = (stiffness * (1.0 - rest / long))[:, None] * along
        force = np.zeros_like(place)
        np.add.at(force, ends[:, 0], pull)
        np.add.at(force, ends[:, 1], -pull)
        force[:, 2] -= 50.0 * mass
        kick = 0.5 * step if number == 0 else step
        moving[free] += kick * (force[free] / mass[free, None] - 0.1 * moving[free])
        place[free] += step * moving[free]
    return -place[:, 2].min()


@pytest.mark.parametrize(
    ("change", "told", "blamed", "shown"),
    [
        ({"net.radius": 12.5}, "net.radius", "net.radius", 12.5),
        ({"net.mesh": 0.05}, "net.mesh", "net.segments", 480),
        ({"net.fold_side": 24.0}, "net.fold_side", "net.fold_side", 24.0),
    ],
    ids=str,
)
def test_what_makes_no_net_is_refused_before_and_by_the_kernel(change, told, blamed, shown):
    assert [refusal.name for refusal in refusals(TERMS, all_values(change))] == [told]
    with pytest.raises(ModelFault) as caught:
        Instance(MODEL, TERMS, change).initialise()
    assert f"({blamed}, value {shown:g}," in str(caught.value)


def test_another_number_of_bullets_is_refused():
    (refusal,) = refusals(FREE | {"net": "hexagon"}, all_values({}))
    assert (refusal.name, refusal.value) == ("bullets.number", "4")
    (code,) = (fault.code for fault in MODEL.faults if fault.name == "wrong_number")
    assert Layer("hexagon").count({}) == code


def test_a_flight_opens_and_keeps_momenta():
    values = {"net.radius": 6.0, "net.mesh": 1.5, "solver.jitter[3]": 1e-3, "shot.roll": 0.2}
    net = Instance(MODEL, TERMS, values).initialise()
    spin, shot = net.array("angular_momentum").copy(), np.linalg.norm(net.array("catch_velocity")) * net["catch.mass"]
    assert net.array("bullet_position").shape == (6, 3)
    widest = 0.0
    for _ in range(10):
        net.step(0.4)
        widest = max(widest, net["mouth.area_ratio"])
        assert np.abs(net.array("momentum")).max() < 1e-12 * shot
        assert np.abs(net.array("angular_momentum") - spin).max() < 1e-12 * shot * 20.0
    assert 0.9 < widest < 1.1
    assert net["catch.mass"] == pytest.approx(0.33 + 6 * 0.5 + 0.15, rel=1e-12)
    assert catch_mass(all_values(values), TERMS) == pytest.approx(net["catch.mass"], rel=1e-12)
    assert abs(net["energy.remainder"]) < 0.01 * 13.5
