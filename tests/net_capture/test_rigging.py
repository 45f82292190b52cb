"""What is rigged to a net: nodes, strips, masses and bounds against some drawn by hand; a flight with all of it."""

import math
from collections import Counter
from itertools import pairwise

import numpy as np
import pytest

from dcone_cosim.build import net_drawing
from fmu_src.instance import Instance
from fmu_src.net_capture.implied import catch_mass, rows, substeps
from fmu_src.net_capture.interface import MODEL
from fmu_src.net_capture.planes import MASS, SHOWN
from tests.conftest import FREE
from tests.net_capture.laid import Layer

RIGS = ("knots", "edge", "leads")
SET = {
    "knots": {"knots.mass": 2e-3, "knots.compliance": 4e-4},
    "edge": {"edge.diameter": 2e-3, "edge.youngs_modulus": 5e9, "edge.density": 1140.0, "edge.damping_ratio": 0.2},
    "leads": {
        "leads.length": 3.0,
        "leads.segments": 6,
        "leads.diameter": 1.5e-3,
        "leads.youngs_modulus": 3e9,
        "leads.density": 970.0,
        "leads.damping_ratio": 0.05,
    },
}
NETS = {
    "square": {"net.side": 8.0, "net.mesh": 1.0},
    "rectangle": {"net.width": 70.0, "net.height": 3.0, "net.mesh": 1.0, "net.segments": 2},
    "cone": {"net.radius": 6.0, "net.depth": 5.0, "net.top_radius": 2.0, "net.mesh": 1.0},
}


def terms_of(shape, *rigs):
    return FREE | {"net": shape} | dict.fromkeys(rigs, "plain")


def all_values(shape, values, *rigs):
    """Every parameter by FMI name, these among them."""
    variables = [v for v in MODEL.interface(terms_of(shape, *rigs)).variables if v.causality == "parameter"]
    starts = {name: start for v in variables for name, start in zip(v.element_names(), v.starts(), strict=True)}
    assert set(values) <= set(starts)
    return starts | values


def values_of(shape, *rigs):
    found = dict(NETS[shape])
    for rig in rigs:
        found |= SET[rig]
    return found


class Rigged:
    """A net with all three rigged to it, laid out; its threads are the net's, the rope's, and those of the leads."""

    def __init__(self, shape):
        self.shape, self.values = shape, values_of(shape, *RIGS)
        self.layer = Layer(shape, **dict.fromkeys(RIGS, "plain"))
        self.laid = self.layer.lay(self.values)
        graph, self.rim = self.laid.graph, self.laid.graph.rim.tolist()
        self.leads = slice(len(graph.ends) - 24, None)
        self.rope = slice(len(graph.ends) - 24 - len(self.rim), len(graph.ends) - 24)
        self.net = slice(0, self.rope.start)
        self.places = self.laid.planes[SHOWN : SHOWN + 3].T


LAID = [pytest.param(net, marks=pytest.mark.evidence if net == "square" else ()) for net in NETS]
"""A square is a rectangle of equal sides: tests/net_capture/test_nets.py."""


@pytest.fixture(scope="module", params=LAID)
def rigged(request):
    return Rigged(request.param)


def test_a_rope_runs_once_round_the_rim(rigged):
    graph, rim, places = rigged.laid.graph, rigged.rim, rigged.places
    ends = graph.ends[rigged.rope]
    around = zip(rim, rim[1:] + rim[:1], strict=True)
    assert Counter(frozenset(pair) for pair in ends.tolist()) == Counter(frozenset(pair) for pair in around)
    lengths = np.linalg.norm(places[ends[:, 0]] - places[ends[:, 1]], axis=1)
    np.testing.assert_allclose(graph.length[rigged.rope], lengths, rtol=1e-12)
    area = math.pi * 1e-6
    np.testing.assert_allclose(graph.stiffness[rigged.rope], 5e9 * area / lengths, rtol=1e-12)
    dashpot = 2.0 * 0.2 * np.sqrt(5e9 * area / lengths * 2.0 * 1140.0 * area * lengths)
    np.testing.assert_allclose(graph.damping[rigged.rope], dashpot, rtol=1e-12)
    np.testing.assert_allclose(graph.mass[rigged.rope], 1140.0 * area * lengths, rtol=1e-12)


COUNTS = "strips", "node_slots", "net_nodes", "net_threads", "thread_numbers"


def counts_of(layer, values):
    """Before the net is laid out, and after."""
    return [[int(record[name][0]) for name in COUNTS] for record in (layer.counted(values), layer.lay(values).record)]


def test_laying_out_leaves_the_counts(rigged):
    """Work memory is shared out by them: up to 0.17.0 the rope's and the leads' numbers of threads were lost."""
    counted, laid = counts_of(rigged.layer, rigged.values)
    assert laid == counted
    assert laid[-1] >= len(rigged.laid.graph.ends)


def test_laying_out_a_hexagon_leaves_the_counts():
    layer = Layer("hexagon", bullets="6", edge="plain")
    counted, laid = counts_of(layer, {"net.radius": 2.0, "net.mesh": 1.0} | SET["edge"])
    assert laid == counted


def test_a_strip_has_each_end_in_one_row(rigged):
    graph = rigged.laid.graph
    row = graph.ends // int(rigged.laid.p["row_pitch"])
    starts = np.repeat(np.cumsum(graph.strips) - graph.strips, graph.strips)
    np.testing.assert_array_equal(row, row[starts])


def test_a_lead_hangs_on_every_corner(rigged):
    graph, places = rigged.laid.graph, rigged.places
    assert rigged.laid.p["net_nodes"] == len(rigged.laid.slots)
    corners = graph.rim[graph.corners]
    threads = [tuple(pair) for pair in graph.ends[rigged.leads].tolist()]
    joined = Counter(node for pair in threads for node in pair)
    for corner, bullet in zip(corners.tolist(), graph.bullets.tolist(), strict=True):
        chain, at = [corner], corner
        while at != bullet:
            (at,) = (b for a, b in threads if a == at)
            chain.append(at)
        assert len(chain) == 7
        assert joined[bullet] == joined[corner] == 1
        away = places[chain] - places[corner]
        outward = places[corner] * (1.0, 1.0, 0.0)
        np.testing.assert_allclose(np.linalg.norm(away, axis=1), 0.5 * np.arange(7), atol=1e-12)
        np.testing.assert_allclose(away[-1] / 3.0, outward / np.linalg.norm(outward), atol=1e-12)
    area = math.pi / 4.0 * 1.5e-3**2
    np.testing.assert_allclose(graph.length[rigged.leads], 0.5, rtol=1e-12)
    np.testing.assert_allclose(graph.stiffness[rigged.leads], 3e9 * area / 0.5, rtol=1e-12)
    np.testing.assert_allclose(graph.mass[rigged.leads], 970.0 * area * 0.5, rtol=1e-12)
    loads = rigged.laid.planes[MASS] - rigged.laid.mass
    assert loads[graph.bullets].tolist() == pytest.approx([0.5] * 4, rel=1e-12)


def test_leads_are_drawn_from_corner_to_bullet(rigged):
    values = all_values(rigged.shape, rigged.values, *RIGS)
    lines, rim = net_drawing(values, terms_of(rigged.shape, *RIGS))
    graph, number = rigged.laid.graph, rigged.laid.number
    drawn, leads = lines[:-4], lines[-4:]
    assert [line[0] for line in leads] == number[graph.rim[graph.corners]].tolist()
    assert [line[-1] for line in leads] == number[graph.bullets].tolist()
    threads = {tuple(pair) for pair in number[graph.ends[rigged.leads]].tolist()}
    assert {pair for line in leads for pair in pairwise(line)} == threads
    assert max(node for line in drawn for node in line) < min(line[1] for line in leads)
    assert rim[0] == rim[-1]


def test_where_bullets_alone_would_have_spread_the_net(rigged):
    """They start and end beyond the corners of the mouth, by a lead that is folded as the net is."""
    values = all_values(rigged.shape, rigged.values, *RIGS)
    (told,) = (row.value for row in rows(values, terms_of(rigged.shape, *RIGS)) if row.key == "shot.opening")
    folded, bullets = rigged.layer.fold(rigged.laid), rigged.laid.graph.bullets
    start, end = (np.linalg.norm(at[bullets, :2], axis=1) for at in (folded, rigged.places))
    assert end.min() > np.linalg.norm(rigged.places[rigged.laid.graph.rim[rigged.laid.graph.corners], :2], axis=1).max()
    assert told == pytest.approx((end - start).mean() / math.tan(values["bullets.angle"]), rel=1e-12)


def test_knots_weigh_and_give_way(rigged):
    """Every node has half of each thread that ends there; a knot its own mass too, a node within a thread or on a lead
    none. A thread and its knots in series have the sum of their compliances."""
    graph, laid, values = rigged.laid.graph, rigged.laid, rigged.values
    expected = np.zeros(len(laid.mass))
    for end in graph.ends.T:
        np.add.at(expected, end, 0.5 * graph.mass)
    pieces = values.get("net.segments", 1)
    inner = (len(laid.slots) - 24) - (pieces - 1) * (rigged.net.stop // pieces)
    expected[laid.slots[:inner]] += 2e-3
    np.testing.assert_allclose(laid.mass, expected, rtol=1e-11, atol=1e-18)
    assert laid.mass.sum() == pytest.approx(0.33 + graph.mass[rigged.net.stop :].sum() + 2e-3 * inner, rel=1e-12)
    whole = pieces * graph.length[rigged.net]
    area = 0.33 / (1440.0 * graph.length[rigged.net].sum())
    alone = 70e9 * area / whole
    soft = graph.stiffness[rigged.net] / pieces
    np.testing.assert_allclose(1.0 / soft, 1.0 / alone + 4e-4, rtol=1e-11)
    dashpot = 2.0 * 0.106 * np.sqrt(soft * 2.0 * 1440.0 * area * whole)
    np.testing.assert_allclose(graph.damping[rigged.net] / pieces, dashpot, rtol=1e-11)
    told = {row.key: row.value for row in rows(all_values(rigged.shape, values, *RIGS), rigged.layer.terms)}
    assert np.abs(soft / told["thread.stiffness"] - 1.0).min() < 1e-9
    assert np.abs(graph.damping[rigged.net] / pieces / told["thread.dashpot"] - 1.0).min() < 1e-9
    inside = np.setdiff1d(laid.slots[:inner], graph.rim)
    assert told["knot.mass"] == pytest.approx(laid.mass[inside].max(), rel=1e-9)


@pytest.mark.parametrize("change", [{}, {"leads.length": 0.3}, {"edge.diameter": 1e-4}, {"leads.segments": 1}], ids=str)
def test_no_node_is_stiffer_than_the_step_allows(rigged, change):
    """The bound is that of a node whose stiffness over mass is at least that of any node of the graph, undamped."""
    values = rigged.values | {"knots.mass": 0.0, "knots.compliance": 0.0} | change
    values |= dict.fromkeys(("net.damping_ratio", "edge.damping_ratio", "leads.damping_ratio"), 0.0)
    laid = rigged.layer.lay(values)
    stiff = np.zeros(len(laid.mass))
    for end in laid.graph.ends.T:
        np.add.at(stiff, end, laid.graph.stiffness)
    most = (stiff[laid.slots] / laid.planes[MASS][laid.slots]).max()
    told, _ = substeps(all_values(rigged.shape, values, *RIGS), terms_of(rigged.shape, *RIGS))
    assert laid.bound == pytest.approx(told, rel=1e-12)
    assert told <= 2.0 / math.sqrt(2.0 * most) * (1.0 + 1e-12)
    assert told > 0.6 * 2.0 / math.sqrt(2.0 * most)


def test_peaks_are_told_line_by_line():
    """Bullets that fly apart on leads stretch these first: until the net is reached nothing else bears a load."""
    values = values_of("square", *RIGS) | {"net.fold_side": 0.01, "leads.length": 0.5, "bullets.angle": 1.2}
    net = Instance(MODEL, terms_of("square", *RIGS), values).initialise()
    while net["leads.tension_max"] == 0.0:
        net.step(0.001)
    peak = net["leads.tension_peak"]
    assert peak == net["leads.tension_max"] > 0.0
    assert net["thread.tension_max"] == 0.0 == net["thread.tension_max_index"]
    assert net["edge.tension_max"] == 0.0
    net.step(1.5)
    net.step(0.001)
    assert net["edge.tension_max"] > 0.0 < net["thread.tension_max"]
    assert net["leads.tension_peak"] <= net["leads.tension_max"] >= peak


def test_a_flight_keeps_what_it_keeps_and_is_what_was_said():
    """With all three: momenta, the energy book within 1 % of the shot, the masses and the momentum that were told."""
    values = values_of("square", *RIGS) | {"solver.jitter[3]": 1e-3, "shot.roll": 0.3}
    net = Instance(MODEL, terms_of("square", *RIGS), values).initialise()
    every, terms = all_values("square", values, *RIGS), terms_of("square", *RIGS)
    told = {row.key: row.value for row in rows(every, terms)}
    assert net["catch.mass"] == pytest.approx(catch_mass(every, terms), rel=1e-12)
    assert net["catch.mass"] == pytest.approx(told["catch.mass"], rel=1e-12)
    moving = np.linalg.norm(net.array("catch_velocity")) * net["catch.mass"]
    assert moving == pytest.approx(told["shot.momentum"], rel=1e-9)
    assert net["energy.kinetic"] == pytest.approx(told["shot.energy"], rel=1e-9)
    spin = net.array("angular_momentum").copy()
    for _ in range(8):
        net.step(0.5)
        assert np.abs(net.array("momentum")).max() < 1e-12 * moving
        assert np.abs(net.array("angular_momentum") - spin).max() < 1e-12 * moving * 20.0
    assert abs(net["energy.remainder"]) < 0.01 * told["shot.energy"]
    # a lead alone pulls its bullet along, and is of another section than the rope
    assert 0.0 < net["thread.tension_max"] < max(net["leads.tension_max"], net["edge.tension_max"])
    assert net["thread.tension_max_index"] <= 144
    apart = net.array("bullet_position")
    assert np.linalg.norm(apart[0] - apart[2]) > 8.0
