"""Nets of rings and meridians against some drawn in plain Python, and their flights."""

import math
from collections import Counter
from itertools import pairwise

import numpy as np
import pytest

from fmu_src.instance import Instance, ModelFault
from fmu_src.net_capture.interface import MODEL, refusals
from tests.conftest import FREE
from tests.net_capture.laid import Layer
from tests.net_capture.test_hardest import TERMS as SHOWN
from tests.net_capture.told import knots_are_as_told

SPAN = 2.0 / 3.0
"""Of the mesh: knots nearer than this crowd, as the page of the model says."""

CASES = {
    "cone-floor": {"net.radius": 6.0, "net.depth": 5.0, "net.top_radius": 2.0, "net.mesh": 1.0},
    "cone-open": {"net.radius": 6.0, "net.depth": 5.0, "net.top_radius": 2.0, "net.mesh": 1.0, "net.floor": 1},
    "cone-point": {"net.radius": 3.0, "net.depth": 4.0, "net.top_radius": 0.0, "net.mesh": 0.5, "net.segments": 3},
    "cone-even": {"net.radius": 3.0, "net.depth": 4.0, "net.top_radius": 1.0, "net.mesh": 0.5, "net.meridians": 20},
    "cone-wide": {"net.radius": 12.0, "net.depth": 3.0, "net.top_radius": 3.0, "net.mesh": 0.75, "net.segments": 2},
    "radial": {"net.radius": 4.0, "net.mesh": 0.8},
    "radial-coarse": {"net.radius": 1.0, "net.mesh": 1.6},
}


def shape_of(name):
    return name.partition("-")[0]


def flown(shape):
    """Terms of a net in flight, of a cone those that another test compiles."""
    return SHOWN if shape == "cone" else FREE | {"net": shape}


def profile(values):
    """Radius and depth of every ring, and of the tip if there is one, by what the shapes are."""
    radius, top, depth = values["net.radius"], values.get("net.top_radius", 0.0), values.get("net.depth", 0.0)
    mesh = values["net.mesh"]
    wall = max(round(math.hypot(depth, radius - top) / mesh), 1)
    rings = [(radius + k / wall * (top - radius), k / wall * depth) for k in range(wall + 1)]
    if top > 0.0 and values.get("net.floor", 0) == 0:
        floor = max(round(top / mesh), 1)
        rings += [(top * (1.0 - k / floor), depth) for k in range(1, floor + 1)]
    return rings


def draw(values):
    """Places of the nodes in the order of the outputs, threads as pairs of them, knots of every ring by meridian."""
    rings, mesh = profile(values), values["net.mesh"]
    has_tip = rings[-1][0] < 1e-12
    wanted = 2.0 * math.pi * values["net.radius"] / mesh
    few = sorted({2**k for k in range(2, 10)} | {3 * 2**k for k in range(2, 10)}, key=lambda n: abs(n - wanted))
    meridians = values.get("net.meridians", 0) or few[0]
    places, knots, every = [], [], 1
    for r, z in rings[: len(rings) - has_tip]:
        # the rim keeps all its meridians
        while knots and 2 * r * math.sin(math.pi * every / meridians) < SPAN * mesh:
            if meridians % (2 * every) or meridians // (2 * every) < 4:
                break
            every *= 2
        knots.append({})
        for j in range(0, meridians, every):
            angle = math.pi / 4 + 2 * math.pi * j / meridians
            knots[-1][j] = len(places)
            places.append((r * math.cos(angle), r * math.sin(angle), -z))
    if has_tip:
        knots.append(dict.fromkeys(knots[-1], len(places)))
        places.append((0.0, 0.0, -rings[-1][1]))
    round_it = [
        list(zip(ring.values(), [*ring.values()][1:] + [*ring.values()][:1], strict=True))
        for ring in knots[: len(knots) - has_tip]
    ]
    inward = [[(a[j], b[j]) for j in b] for a, b in pairwise(knots)]
    pieces, threads = values.get("net.segments", 1), []
    chains = {pair: [pair[0]] for pairs in round_it + inward for pair in pairs}
    for way in (round_it, inward):
        for piece in range(1, pieces):
            for pairs in way:
                for a, b in pairs:
                    chains[a, b].append(len(places))
                    share = piece / pieces
                    places.append(tuple((1 - share) * np.array(places[a]) + share * np.array(places[b])))
    for (_, b), chain in chains.items():
        threads += pairwise([*chain, b])
    return np.array(places), threads, knots


@pytest.fixture(scope="module")
def layers():
    return {shape: Layer(shape) for shape in ("cone", "radial")}


@pytest.fixture(params=CASES, scope="module")
def pair(request, layers):
    """The name of a case, its values, the net drawn, and the net of the kernels."""
    values = CASES[request.param]
    return request.param, values, draw(values), layers[shape_of(request.param)].lay(values)


def test_knots_weigh_what_is_told(pair, layers):
    case, values, _, laid = pair
    knots_are_as_told(layers[shape_of(case)].terms, values, laid)


def test_nodes_and_threads_are_those_drawn(pair):
    _, _, (places, threads, _), laid = pair
    assert laid.p["net_nodes"] == len(laid.slots) == len(places)
    np.testing.assert_allclose(laid.places, places, rtol=0.0, atol=1e-12)
    ends = laid.number[laid.graph.ends]
    assert ends.min() >= 0
    assert laid.p["net_threads"] == len(ends)
    assert Counter(frozenset(pair) for pair in ends.tolist()) == Counter(frozenset(pair) for pair in threads)
    lengths = np.linalg.norm(places[ends[:, 1]] - places[ends[:, 0]], axis=1)
    np.testing.assert_allclose(laid.graph.length, lengths, rtol=1e-12)
    row = laid.graph.ends // int(laid.p["row_pitch"])
    starts = np.repeat(np.cumsum(laid.graph.strips) - laid.graph.strips, laid.graph.strips)
    np.testing.assert_array_equal(row, row[starts])


def test_what_it_says_before_it_is_laid_out(pair):
    name, values, (places, threads, knots), _ = pair
    said, every = MODEL.groups["net"].terms[shape_of(name)].checks, all_values(shape_of(name), values)
    lengths = [np.linalg.norm(places[a] - places[b]) for a, b in threads]
    assert said.total(every) == pytest.approx(sum(lengths), rel=1e-12)
    assert said.nodes(every) == len(places)
    side, *others = said.sides(every)
    assert others == [side] * 3
    assert said.gap(every) == pytest.approx(side / (said.knots(every) + 1), rel=1e-12)
    rim = [knots[0][j] for j in sorted(knots[0])]
    quarter = places[rim[: len(rim) // 4 + 1]]
    assert side == pytest.approx(np.linalg.norm(np.diff(quarter, axis=0), axis=1).sum(), rel=1e-12)
    assert said.knots(every) == len(rim) // 4 - 1
    lines, edge = said.drawing(every)
    whole = Counter(frozenset(pair) for line in lines for pair in pairwise(line))
    n = values.get("net.segments", 1)
    assert sum(whole.values()) * n == len(threads)
    assert set(whole.values()) == {1}
    assert edge == [*rim, rim[0]]


def test_what_hangs_on_its_knots_and_how_stiff_it_is(pair):
    """The most that hangs on a knot of each kind; and that no node is stiffer for its mass than the step allows for."""
    name, values, (places, threads, knots), laid = pair
    pieces = values.get("net.segments", 1)
    density, modulus = 1440.0, 70e9
    ends = np.array(threads)
    lengths = np.linalg.norm(places[ends[:, 1]] - places[ends[:, 0]], axis=1)
    area = 0.33 / (density * lengths.sum())
    hang, stiff, damped = np.zeros(len(places)), np.zeros(len(places)), np.zeros(len(places))
    for end in ends.T:
        np.add.at(hang, end, 0.5 * lengths)
        np.add.at(stiff, end, modulus * area / lengths)
        np.add.at(damped, end, 2.0 * 0.106 * math.sqrt(2.0 * modulus * density) * area * pieces)
    np.testing.assert_allclose(laid.mass[laid.slots], density * area * hang, rtol=1e-11)
    rim = list(knots[0].values())
    inner = [n for ring in knots[1:] for n in ring.values()]
    checks = MODEL.groups["net"].terms[shape_of(name)].checks
    said = checks.hanging(all_values(shape_of(name), values))
    assert checks.piece(all_values(shape_of(name), values)) == pytest.approx(laid.thread, rel=1e-12)
    assert said.edge == pytest.approx(pieces * density * area * max(hang[rim]), rel=1e-12)
    assert said.corner == pytest.approx(pieces * density * area * hang[rim[0]], rel=1e-12)
    assert said.inside == pytest.approx(pieces * density * area * max(hang[inner]), rel=1e-12)
    thread, dashpot, node = laid.thread
    mass = density * area * hang
    assert 4.0 * thread / node == pytest.approx(max(stiff / mass), rel=1e-12)
    assert 4.0 * dashpot / node >= max(damped / mass) * (1.0 - 1e-12)


def test_faces_rim_and_vertex(pair):
    _, values, (places, _, knots), laid = pair
    rim = laid.number[laid.graph.rim].tolist()
    assert rim == [knots[0][j] for j in sorted(knots[0])]
    corners = places[laid.number[laid.graph.rim[laid.graph.corners]]]
    assert len(corners) == 4
    np.testing.assert_allclose(np.abs(corners[:, :2]), values["net.radius"] / math.sqrt(2.0), rtol=1e-12)
    assert laid.p["mouth_flat_area"] == pytest.approx(2.0 * values["net.radius"] ** 2, rel=1e-14)
    apex = sorted(set(laid.number[laid.graph.apex].tolist()))
    assert apex == sorted(set(knots[-1].values()))
    edges = Counter()
    for face in laid.number[laid.graph.faces].tolist():
        around = [n for k, n in enumerate(face) if n != face[k - 1]]
        edges.update(zip(around, around[1:] + around[:1], strict=True))
    assert set(edges.values()) == {1}
    alone = {edge for edge in edges if edge[::-1] not in edges}
    border = set(zip(rim, rim[1:] + rim[:1], strict=True))
    if len(apex) > 1:
        border |= {(b, a) for a, b in zip(apex, apex[1:] + apex[:1], strict=True)}
    assert alone == border


def all_values(shape, values):
    """Every parameter of a net by FMI name, these among them."""
    rows = [v for v in MODEL.interface(FREE | {"net": shape}).variables if v.causality == "parameter"]
    starts = {name: start for v in rows for name, start in zip(v.element_names(), v.starts(), strict=True)}
    assert set(values) <= set(starts)
    return starts | values


@pytest.mark.parametrize(
    ("shape", "change", "told", "blamed", "shown"),
    [
        ("cone", {"net.meridians": 18}, "net.meridians", "net.meridians", 18),
        pytest.param(
            *("radial", {"net.fold_side": 8.5, "net.radius": 4.0}, "net.fold_side", "net.fold_side", 8.5),
            marks=pytest.mark.evidence,
        ),
        ("cone", {"net.mesh": 0.1, "net.segments": 2}, "net.mesh", "net.segments", 1536),
        ("cone", {"net.radius": 3.0, "net.top_radius": 4.0}, "net.top_radius", "net.top_radius", 4.0),
        ("cone", {"net.radius": 3.0, "net.top_radius": 3.0, "net.floor": 1}, "net.top_radius", "net.top_radius", 3.0),
    ],
)
def test_what_makes_no_net_is_refused_before_and_by_the_kernel(shape, change, told, blamed, shown):
    terms = FREE | {"net": shape}
    assert [refusal.name for refusal in refusals(terms, all_values(shape, change))] == [told]
    with pytest.raises(ModelFault) as caught:
        Instance(MODEL, flown(shape), change).initialise()
    assert f"({blamed}, value {shown:g}," in str(caught.value)


SAME = {"solver.jitter[3]": 1e-3, "shot.roll": 0.3}


@pytest.mark.parametrize("name", ["cone-floor", "cone-open", pytest.param("radial", marks=pytest.mark.evidence)])
def test_a_free_flight_keeps_momenta(name):
    """Of net and chaser together, to a share of 1e-12 of the shot's, and of that at the 20 m to the frame's origin."""
    net = Instance(MODEL, flown(shape_of(name)), CASES[name] | SAME).initialise()
    spin, shot = net.array("angular_momentum").copy(), np.linalg.norm(net.array("catch_velocity")) * net["catch.mass"]
    widest = 0.0
    for _ in range(10):
        net.step(0.4)
        widest = max(widest, net["mouth.area_ratio"])
        assert np.abs(net.array("momentum")).max() < 1e-12 * shot
        assert np.abs(net.array("angular_momentum") - spin).max() < 1e-12 * shot * 20.0
    assert widest > 0.9
    assert abs(net["energy.remainder"]) < 0.01 * 9.0


@pytest.mark.parametrize("name", ["cone-even", pytest.param("radial", marks=pytest.mark.evidence)])
def test_the_remainder_falls_with_the_square_of_the_step(name):
    def remainder(ratio):
        found = []
        for seed in range(3):
            values = CASES[name] | SAME | {"solver.step_ratio": ratio, "solver.seed": seed}
            net = Instance(MODEL, flown(shape_of(name)), values).initialise()
            net.step(3.0)
            found.append(abs(net["energy.remainder"]))
        return np.mean(found)

    assert math.log(remainder(0.2) / remainder(0.05), 4.0) == pytest.approx(2.0, abs=0.2)
