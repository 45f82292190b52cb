"""The graph of every net against one laid out in plain Python; flights of the new nets; what makes no net."""

import math
from collections import Counter
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pytest

from fmu_src.instance import Instance, ModelFault
from fmu_src.net_capture import formulas
from fmu_src.net_capture.interface import MODEL, refusals
from fmu_src.net_capture.nets.pyramid import pyramid_length
from fmu_src.net_capture.planes import MASS
from tests.conftest import FREE
from tests.net_capture.laid import Layer
from tests.net_capture.told import knots_are_as_told
from tests.validation import closed_form

MESH = 2.0
SLOPE = 0.7
"""Depth of the pyramids over half their side."""

LARGE = 5000
"""Pieces along and across a net that take Python seconds; they have no more strips side by side than a long one."""
CASES = [
    pytest.param(
        (shape, columns, rows, segments), marks=pytest.mark.evidence if columns * rows * segments > LARGE else ()
    )
    for shape, columns, rows in (
        ("square", 4, 4),
        ("square", 7, 7),
        ("square", 130, 130),
        ("rectangle", 5, 8),
        ("rectangle", 130, 3),
        ("pyramid", 6, 6),
        ("pyramid", 5, 5),
        ("pyramid", 67, 67),
    )
    for segments in (1, 3)
]


class Drawn(NamedTuple):
    """A net drawn by hand: places of the nodes in the order of the outputs, threads as pairs of them, their lengths."""

    nodes: np.ndarray
    threads: list[tuple[int, int]]
    lengths: np.ndarray
    knot: np.ndarray


def behind(shape, columns, rows, x, y):
    """Depth of the net as meant at a place, by what the pyramid is: walls that rise from the mouth's sides."""
    if shape != "pyramid":
        return 0.0
    to_side = min(0.5 * columns * MESH - abs(x), 0.5 * rows * MESH - abs(y))
    return SLOPE * to_side


def draw(shape, columns, rows, segments):
    knot = np.arange((rows + 1) * (columns + 1)).reshape(rows + 1, columns + 1)
    places = []
    for i in range(rows + 1):
        for j in range(columns + 1):
            x, y = MESH * (j - columns / 2), MESH * (i - rows / 2)
            places.append((x, y, -behind(shape, columns, rows, x, y)))
    whole = [(knot[i, j], knot[i, j + 1]) for i in range(rows + 1) for j in range(columns)]
    across = [(knot[i, j], knot[i + 1, j]) for i in range(rows) for j in range(columns + 1)]
    chains = {pair: [pair[0]] for pair in whole + across}
    for pairs in (whole, across):
        for piece in range(1, segments):
            for a, b in pairs:
                chains[a, b].append(len(places))
                share = piece / segments
                places.append(tuple((1 - share) * np.array(places[a]) + share * np.array(places[b])))
    threads = []
    for (_, b), chain in chains.items():
        chain.append(b)
        threads += list(pairwise(chain))
    nodes = np.array(places)
    ends = np.array(threads)
    return Drawn(nodes, threads, np.linalg.norm(nodes[ends[:, 1]] - nodes[ends[:, 0]], axis=1), knot)


def parameters(shape, columns, rows, segments):
    sides = {"net.side": MESH * columns}
    if shape == "rectangle":
        sides = {"net.width": MESH * columns, "net.height": MESH * rows}
    if shape == "pyramid":
        sides["net.depth"] = SLOPE * 0.5 * MESH * columns
    return sides | {"net.mesh": MESH, "net.segments": segments}


@pytest.fixture(scope="module")
def kernels():
    """By shape: what lays a net out."""
    return {shape: Layer(shape) for shape in ("square", "rectangle", "pyramid")}


@pytest.fixture(params=CASES, ids=lambda case: "-".join(map(str, case)), scope="module")
def pair(request, kernels):
    """A case, the net drawn by hand, and the net of the kernels."""
    return request.param, draw(*request.param), kernels[request.param[0]].lay(parameters(*request.param))


def test_knots_weigh_what_is_told(pair, kernels):
    (shape, *size), _, laid = pair
    knots_are_as_told(kernels[shape].terms, parameters(shape, *size), laid)


def test_nodes_stand_in_the_order_of_the_outputs(pair):
    _, drawn, laid = pair
    assert laid.p["net_nodes"] == len(laid.slots) == len(drawn.nodes)
    np.testing.assert_allclose(laid.places, drawn.nodes, rtol=0.0, atol=1e-9)


def test_threads_are_those_drawn(pair):
    (_, columns, rows, segments), drawn, laid = pair
    ends = laid.number[laid.graph.ends]
    assert ends.min() >= 0
    assert laid.p["net_threads"] == len(ends) == segments * (columns * (rows + 1) + rows * (columns + 1))
    length = {frozenset(pair): each for pair, each in zip(drawn.threads, drawn.lengths, strict=True)}
    found = [frozenset(pair) for pair in ends.tolist()]
    assert Counter(found) == Counter(list(length))
    np.testing.assert_allclose(laid.graph.length, [length[pair] for pair in found], rtol=1e-12)


def test_a_strip_has_each_end_in_one_row(pair):
    _, _, laid = pair
    row = laid.graph.ends // int(laid.p["row_pitch"])
    starts = np.repeat(np.cumsum(laid.graph.strips) - laid.graph.strips, laid.graph.strips)
    np.testing.assert_array_equal(row, row[starts])
    assert int(laid.p["row_pitch"]) % 4 == 0
    assert laid.graph.strips.max() > 1


def test_total_length_is_the_closed_form(pair, validated):
    (shape, columns, rows, _), drawn, laid = pair
    closed = formulas.grid_length(MESH * columns, MESH * rows, MESH)
    if shape == "pyramid":
        closed = pyramid_length(MESH * columns, math.sqrt(1.0 + SLOPE * SLOPE), MESH)
    assert drawn.lengths.sum() == pytest.approx(closed, rel=1e-12)
    formula = closed_form("a (b/l + 1) + b (a/l + 1), a pyramid's by its slope")
    validated(formula, f"{shape}: total length of thread", laid.graph.length.sum(), closed, "m", rel=1e-12)
    values = parameters(*pair[0])
    told = MODEL.groups["net"].terms[shape].checks.total(values)
    assert told == pytest.approx(closed, rel=1e-14)


def test_masses_are_half_of_each_thread_and_the_loads(pair):
    _, drawn, laid = pair
    density = 0.33 / drawn.lengths.sum()
    ends = np.array(drawn.threads)
    expected = np.zeros(len(drawn.nodes))
    for end in ends.T:
        np.add.at(expected, end, 0.5 * density * drawn.lengths)
    np.testing.assert_allclose(laid.mass[laid.slots], expected, rtol=1e-11)
    assert laid.mass.sum() == pytest.approx(0.33, rel=1e-12)
    loads = laid.planes[MASS] - laid.mass
    knot = drawn.knot
    rows, columns = (n - 1 for n in knot.shape)
    for corner in (knot[0, 0], knot[0, -1], knot[-1, 0], knot[-1, -1]):
        expected[corner] += 0.5
    middle = {knot[i, j] for i in (rows // 2, (rows + 1) // 2) for j in (columns // 2, (columns + 1) // 2)}
    for node in middle:
        expected[node] += 0.15 / len(middle)
    np.testing.assert_allclose(laid.planes[MASS][laid.slots], expected, rtol=1e-11)
    assert loads.sum() == pytest.approx(4 * 0.5 + 0.15, rel=1e-12)


def test_stiffness_and_dashpots_follow_the_lengths(pair):
    """k = E A / l of the piece; d = 2 xi sqrt(k m) of the whole thread and a knot of two of them, cut into pieces."""
    (*_, segments), drawn, laid = pair
    area = 0.33 / (1440.0 * drawn.lengths.sum())
    piece = laid.graph.length
    np.testing.assert_allclose(laid.graph.stiffness, 70e9 * area / piece, rtol=1e-11)
    np.testing.assert_allclose(laid.graph.mass, 1440.0 * area * piece, rtol=1e-11)
    whole = piece * segments
    dashpot = 2.0 * 0.106 * np.sqrt(70e9 * area / whole * 2.0 * 1440.0 * area * whole)
    np.testing.assert_allclose(laid.graph.damping, dashpot * segments, rtol=1e-11)


def test_the_rim_goes_once_round_the_mouth(pair):
    (_, columns, rows, _), drawn, laid = pair
    rim = laid.number[laid.graph.rim]
    knot = drawn.knot
    by_hand = [*knot[0, :-1], *knot[:-1, -1], *knot[-1, :0:-1], *knot[:0:-1, 0]]
    assert rim.tolist() == by_hand
    at = drawn.nodes[rim]
    np.testing.assert_allclose(np.linalg.norm(np.roll(at, -1, axis=0) - at, axis=1), MESH, rtol=1e-12)
    corners = at[laid.graph.corners]
    half = 0.5 * MESH * np.array([columns, rows, 0.0])
    np.testing.assert_allclose(np.abs(corners), np.tile(half, (4, 1)), atol=1e-12)
    assert len({tuple(np.sign(corner)) for corner in corners}) == 4
    assert np.all(np.diff(laid.graph.corners) > 0)
    sides = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1)
    np.testing.assert_allclose(laid.p["mouth_side"][:4], sides, rtol=1e-12)
    assert laid.p["mouth_flat_area"] == pytest.approx(MESH * MESH * columns * rows, rel=1e-14)


def test_the_vertex_is_at_the_middle_and_the_top(pair):
    (shape, columns, rows, _), _, laid = pair
    apex = laid.places[laid.number[laid.graph.apex]]
    assert len(apex) == 4
    np.testing.assert_allclose(apex.mean(axis=0)[:2], 0.0, atol=1e-12)
    assert np.abs(apex[:, 0]).max() == pytest.approx(0.5 * MESH * (columns % 2), abs=1e-12)
    assert np.abs(apex[:, 1]).max() == pytest.approx(0.5 * MESH * (rows % 2), abs=1e-12)
    np.testing.assert_allclose(apex[:, 2], laid.places[:, 2].min(), atol=1e-12)
    if shape == "pyramid" and columns % 2 == 0:
        assert apex[0, 2] == pytest.approx(-laid.p["net_depth"], rel=1e-12)


def test_faces_cover_the_net_once_and_turn_one_way(pair):
    (_, columns, rows, segments), _, laid = pair
    faces = laid.number[laid.graph.faces]
    assert laid.p["net_faces"] == len(faces) == columns * rows
    edges = Counter((int(a), int(b)) for face in faces for a, b in zip(face, np.roll(face, -1), strict=True))
    assert set(edges.values()) == {1}
    rim = laid.number[laid.graph.rim].tolist()
    alone = {edge for edge in edges if edge[::-1] not in edges}
    assert alone == set(zip(rim, rim[1:] + rim[:1], strict=True))
    if segments == 1:
        threads = {frozenset(pair) for pair in laid.number[laid.graph.ends].tolist()}
        assert {frozenset(edge) for edge in edges} == threads
    # seen along the shot, whatever the shape
    x, y = laid.places[faces][:, :, 0], laid.places[faces][:, :, 1]
    areas = 0.5 * np.sum(x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1), axis=1)
    np.testing.assert_allclose(areas, MESH * MESH, rtol=1e-11)
    assert areas.sum() == pytest.approx(float(laid.p["mouth_flat_area"]), rel=1e-12)


def terms_of(shape):
    return FREE | {"net": shape}


def flown(shape, values, seconds=7.0):
    net = Instance(MODEL, terms_of(shape), {"net.mesh": MESH} | values).initialise()
    net.step(seconds)
    return net


SAME = {"solver.jitter[3]": 1e-3, "solver.seed": 4, "shot.roll": 0.3}


@pytest.mark.parametrize(
    ("shape", "sides"),
    [
        ("rectangle", {"net.width": 24.0, "net.height": 24.0}),
        ("pyramid", {"net.side": 24.0, "net.depth": 0.0}),
    ],
)
def test_a_rectangle_of_equal_sides_and_a_flat_pyramid_are_the_square(shape, sides):
    square, other = flown("square", SAME), flown(shape, SAME | sides)
    names = [v.field for v in square.interface.variables if v.causality == "output"]
    for name in names:
        np.testing.assert_array_equal(other.array(name), square.array(name), err_msg=name)
    assert square["mouth.area"] > 300.0


SHAPES = [
    ("rectangle", {"net.width": 20.0, "net.height": 28.0}),
    ("pyramid", {"net.side": 24.0, "net.depth": 12.0}),
]


@pytest.mark.parametrize(("shape", "sides"), SHAPES)
def test_a_free_flight_keeps_momenta(shape, sides):
    """Of net and chaser together they are zero, to a share of 1e-12 of the 4.6 N s of the shot, and of these at the
    20 m from the muzzle to the frame's origin; what the net has stays."""
    net = Instance(MODEL, terms_of(shape), {"net.mesh": MESH} | SAME | sides).initialise()
    spin, moving = net.array("angular_momentum").copy(), net.array("catch_velocity") * net["catch.mass"]
    shot = np.linalg.norm(moving)
    # with each bullet go the halves of the two threads of its corner
    length = MODEL.groups["net"].terms[shape].checks.total({"net.mesh": MESH} | sides)
    leaving = 4.0 * (0.5 + 0.33 * MESH / length)
    assert shot == pytest.approx(leaving * 3.0 * math.cos(math.radians(40.0)), rel=1e-12)
    for _ in range(14):
        net.step(0.5)
        assert np.abs(net.array("momentum")).max() < 1e-12 * shot
        assert np.abs(net.array("angular_momentum") - spin).max() < 1e-12 * shot * 20.0
    np.testing.assert_allclose(net.array("catch_velocity") * net["catch.mass"], moving, rtol=0.0, atol=1e-12 * shot)
    assert net["mouth.area"] > 200.0


@pytest.mark.parametrize(("shape", "sides"), SHAPES)
def test_the_remainder_falls_with_the_square_of_the_step(shape, sides):
    ratios = (0.2, 0.1, 0.05)
    remainders = [
        np.mean(
            [
                abs(
                    flown(shape, SAME | sides | {"solver.step_ratio": ratio, "solver.seed": seed}, 6.0)[
                        "energy.remainder"
                    ]
                )
                for seed in range(3)
            ]
        )
        for ratio in ratios
    ]
    slope = np.polyfit(np.log(ratios), np.log(remainders), 1)[0]
    assert slope == pytest.approx(2.0, abs=0.15)
    assert remainders[0] < 1e-3 * 9.0


@pytest.mark.parametrize(("shape", "sides"), SHAPES)
def test_bullets_leave_for_their_corners(shape, sides):
    net = Instance(MODEL, terms_of(shape), {"net.mesh": MESH} | sides).initialise()
    width, height = net["net.width"] if shape == "rectangle" else 24.0, net.array("mouth_side")[1]
    assert height == (28.0 if shape == "rectangle" else 24.0)
    speeds = net.array("bullet_velocity")
    first, second, axis = net.array("axes").reshape(3, 3)
    np.testing.assert_allclose(np.abs(speeds @ first / (speeds @ second)), width / height, rtol=1e-12)
    np.testing.assert_allclose(speeds @ axis, 3.0 * math.cos(math.radians(40.0)), rtol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(speeds, axis=1), 3.0, rtol=1e-12)
    places = net.array("bullet_position") - net.array("muzzle")
    np.testing.assert_array_equal(np.sign(places @ first), np.sign(speeds @ first))
    np.testing.assert_array_equal(np.sign(places @ second), np.sign(speeds @ second))


REFUSED = [
    ("square", {"net.side": 25.0}, "net.side", "net.side", 12.5),
    ("rectangle", {"net.width": 31.0}, "net.width", "net.width", 15.5),
    ("rectangle", {"net.height": 27.0}, "net.height", "net.height", 13.5),
    ("rectangle", {"net.width": 31.0, "net.height": 27.0}, "net.width", "net.width", 15.5),
    ("rectangle", {"net.height": 2.0, "net.fold_side": 0.5}, "net.height", "net.height", 1.0),
    ("rectangle", {"net.fold_side": 26.0}, "net.fold_side", "net.fold_side", 26.0),
    ("rectangle", {"net.segments": 27}, "net.mesh", "net.segments", 405.0),
    ("rectangle", {"net.height": 26.0, "net.width": 802.0}, "net.mesh", "net.segments", 401.0),
    ("pyramid", {"net.side": 25.0}, "net.side", "net.side", 12.5),
    ("pyramid", {"net.segments": 34}, "net.mesh", "net.segments", 408.0),
    ("pyramid", {"net.fold_side": 24.5}, "net.fold_side", "net.fold_side", 24.5),
]


@pytest.mark.parametrize(("shape", "change", "told", "blamed", "shown"), REFUSED)
def test_what_makes_no_net_is_refused_before_and_by_the_kernel(shape, change, told, blamed, shown):
    values = {"net.mesh": MESH} | change
    assert [refusal.name for refusal in refusals(terms_of(shape), all_values(shape, values))] == [told]
    with pytest.raises(ModelFault) as caught:
        Instance(MODEL, terms_of(shape), values).initialise()
    assert f"({blamed}, value {shown:g}," in str(caught.value)


@pytest.mark.parametrize(
    ("shape", "values"),
    [
        ("rectangle", {"net.fold_side": 25.9}),
        ("rectangle", {"net.height": 4.0}),
        ("rectangle", {"net.width": 800.0}),
        ("pyramid", {"net.segments": 33}),
    ],
)
def test_what_just_makes_one_is_not(shape, values, kernels):
    assert refusals(terms_of(shape), all_values(shape, {"net.mesh": MESH} | values)) == []
    assert kernels[shape].count({"net.mesh": MESH} | values) == 0


def all_values(shape, values):
    """Every parameter of a net by FMI name, these among them."""
    rows = [v for v in MODEL.interface(terms_of(shape)).variables if v.causality == "parameter"]
    starts = {name: start for v in rows for name, start in zip(v.element_names(), v.starts(), strict=True)}
    assert set(values) <= set(starts)
    return starts | values
