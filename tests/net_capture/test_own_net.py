"""Nets from two files: as ours where they are ours, else against an integration of their own equations."""

import math
import re

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from dcone_cosim.errors import InputError
from dcone_cosim.scenes.reading import parse
from fmu_src.instance import Instance
from fmu_src.net_capture.implied import catch_mass, rows
from fmu_src.net_capture.interface import MODEL, refusals
from fmu_src.net_capture.nets.own_graph import NODES, THREADS, NetError, own_graph
from fmu_src.net_capture.nets.own_rows import rows_of
from fmu_src.net_capture.nets.written import DAMPING, FROM, LENGTH, MASS, STIFFNESS, TO, read_nodes, read_threads
from tests.conftest import FREE
from tests.net_capture.laid import Layer
from tests.net_capture.own_files import CORNERS, ENDS, PLACES, VERTEX, save, unlike, write

OWN = FREE | {"net": "table", "nodes": "144"}
RIGS = dict.fromkeys(("knots", "edge", "leads"), "plain")
RIGGED = {"knots.mass": 1e-3, "leads.segments": 3}
CHECKS = MODEL.groups["net"].terms["table"].checks


def every_value(tables, values):
    own = [v for v in MODEL.interface(OWN).variables if v.causality == "parameter"]
    starts = {name: start for v in own for name, start in zip(v.element_names(), v.starts(), strict=True)}
    return starts | values | tables


@pytest.fixture(scope="module")
def layer():
    return Layer("table", **RIGS)


@pytest.fixture(scope="module")
def squares():
    return Layer("square", **RIGS)


@pytest.mark.parametrize(("meshes", "pieces"), [(5, 1), (4, 3), (71, 1)], ids=str)
def test_our_own_net_written_down_is_laid_out_alike(layer, squares, tmp_path, meshes, pieces):
    """The same strips, slots, masses and bound, whatever is rigged to it."""
    values = {"net.side": 0.5 * meshes, "net.mesh": 0.5, **RIGGED}
    whole = squares.lay(values)
    layer.tables = write(whole, tmp_path, 2 * meshes * (meshes + 1))
    ours = squares.lay(values | {"net.segments": pieces})
    own = layer.lay({"net.segments": pieces, **RIGGED})
    if pieces == 1:
        np.testing.assert_array_equal(own.planes, ours.planes)
        np.testing.assert_array_equal(own.mass, ours.mass)
        for name in own.graph._fields[:-2]:
            np.testing.assert_array_equal(getattr(own.graph, name), getattr(ours.graph, name))
        faces = ({frozenset(face) for face in net.graph.faces.tolist()} for net in (own, ours))
        assert next(faces) == next(faces)
    else:
        order, other = (np.lexsort(net.places.T.round(9)) for net in (own, ours))
        np.testing.assert_allclose(own.places[order], ours.places[other], atol=1e-12)
        np.testing.assert_allclose(own.mass[own.slots][order], ours.mass[ours.slots][other], rtol=1e-12)
        for name in ("length", "stiffness", "damping", "mass"):
            np.testing.assert_allclose(
                np.sort(getattr(own.graph, name)), np.sort(getattr(ours.graph, name)), rtol=1e-12
            )
    assert own.bound == pytest.approx(ours.bound, rel=1e-12)
    for name in ("net_nodes", "net_threads", "rim_mesh", "mouth_flat_area"):
        assert own.p[name] == pytest.approx(ours.p[name], rel=1e-12)
    np.testing.assert_allclose(own.p["mouth_side"], ours.p["mouth_side"], rtol=1e-12)


def test_our_own_net_written_down_flies_alike(squares, tmp_path):
    """Bit by bit, through an opening; and not with one thread a thousandth stiffer."""
    values = {"net.side": 24.0, "net.mesh": 24.0 / 11.0}
    tables = write(squares.lay(values | RIGGED | {"knots.mass": 0.0}), tmp_path, 2 * 11 * 12)
    stiffer = {name: table.copy() for name, table in tables.items()}
    stiffer[THREADS][4, STIFFNESS] *= 1.001
    one = Instance(MODEL, FREE, values).initialise()
    two, three = (Instance(MODEL, OWN, {}, given).initialise() for given in (tables, stiffer))
    names = [v.field for v in one.interface.variables if v.causality == "output" and v.name != "solver.stability_bound"]
    for net in (one, two, three):
        for _ in range(80):
            net.step(0.1)
    for name in names:
        np.testing.assert_array_equal(one.array(name), two.array(name))
    assert one["mouth.area_max"] > 400.0
    assert one["thread.tension_max"] != three["thread.tension_max"]


def test_no_two_threads_alike_against_an_independent_integration():
    """Ten knots, fourteen threads, each with its own length, stiffness, mass and dashpot; after half a second, of which
    most is flown with threads taut, positions are those of scipy's Runge-Kutta method of order 8."""
    nodes, threads, place = unlike()
    set_to = {"net.fold_side": 5.8, "solver.step_ratio": 0.02, "bullets.speed": 6.0, "bullets.angle": 1.3}
    net = Instance(MODEL, OWN, set_to, {NODES: nodes, THREADS: threads}).initialise()
    assert (net["net.nodes"], net["net.threads"]) == (10, 14)
    mass = np.zeros(10)
    for (a, b), row in zip(ENDS, threads, strict=True):
        mass[[a, b]] += 0.5 * row[MASS]
    mass[list(CORNERS)] += 0.5
    mass[VERTEX] += 0.15
    start = net.array("node_position")[:10].copy()
    velocity = np.zeros((10, 3))
    axes = np.array(
        [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]
    )  # of a shot along the second axis, radial first
    seen = (start - start.mean(axis=0)) @ axes.T
    scale = 5.8 / 6.0
    np.testing.assert_allclose(
        np.abs(seen[:, :2] - seen[VERTEX, :2]), np.abs(place - place[VERTEX])[:, :2] * scale, atol=1e-9
    )
    for k, corner in enumerate(CORNERS):
        velocity[corner] = [net[f"bullet[{k + 1}].velocity[{i}]"] for i in (1, 2, 3)]
    a, b = np.array(ENDS).T

    def rates(_, state):
        at, v = state.reshape(2, 10, 3)
        d, w = at[b] - at[a], v[b] - v[a]
        r = np.linalg.norm(d, axis=1)
        unit = d / r[:, None]
        pull = threads[:, STIFFNESS] * (r - threads[:, LENGTH]) + threads[:, DAMPING] * np.sum(w * unit, axis=1)
        pull = np.where(r > threads[:, LENGTH], np.maximum(pull, 0.0), 0.0)[:, None] * unit
        force = np.zeros((10, 3))
        np.add.at(force, a, pull)
        np.add.at(force, b, -pull)
        return np.concatenate([v.ravel(), (force / mass[:, None]).ravel()])

    turned = -(mass[:, None] * np.cross(start - net.array("chaser_position"), velocity)).sum(axis=0)
    assert np.abs(turned).max() > 0.05, "corners lie unevenly"
    np.testing.assert_allclose(net.array("chaser_spin"), turned, rtol=0.0, atol=1e-12)
    for _ in range(50):
        net.step(0.01)
    np.testing.assert_allclose(net.array("angular_momentum"), 0.0, rtol=0.0, atol=1e-10)
    found = solve_ivp(
        rates,
        (0.0, 0.5),
        np.concatenate([start.ravel(), velocity.ravel()]),
        "DOP853",
        None,
        rtol=1e-10,
        atol=1e-12,
        max_step=1e-3,
    )
    expected = found.y[:30, -1].reshape(10, 3)
    moved = np.linalg.norm(expected - start - velocity * 0.5, axis=1).max()
    assert moved > 0.3
    off = np.abs(net.array("node_position")[:10] - expected).max()
    assert off < 1e-3 * moved


def test_the_order_of_threads_changes_nothing_but_rounding(layer):
    nodes, threads, _ = unlike()
    for seed in (1, 2):
        _, shuffled, _ = unlike(seed)
        graphs = [own_graph({NODES: nodes, THREADS: given}) for given in (threads, shuffled)]
        np.testing.assert_array_equal(graphs[0].rim, graphs[1].rim)
        assert {frozenset(face) for face in graphs[0].faces} == {frozenset(face) for face in graphs[1].faces}
        layer.tables = {NODES: nodes, THREADS: shuffled}
        laid = layer.lay({})
        stiffness = dict(zip(map(frozenset, ENDS), threads[:, STIFFNESS], strict=True))
        held = laid.graph.ends[: len(ENDS)]
        for pair, k in zip(laid.number[held].tolist(), laid.graph.stiffness, strict=False):
            assert stiffness[frozenset(pair)] == k


ORDERS = {
    "shuffled": lambda threads, chance: chance.permutation(len(threads)),
    "node by node": lambda threads, chance: np.lexsort((threads[:, TO], threads[:, FROM])),
}


@pytest.mark.parametrize("order", ORDERS)
def test_threads_in_another_order_stand_in_strips_all_the_same(layer, squares, tmp_path, order):
    """A net of 441 knots, every third row of another stiffness, half of its threads turned round: each thread is laid
    out once, with what its line says, in as many strips as of the net written row by row."""
    tables = write(squares.lay({"net.side": 10.0, "net.mesh": 0.5, **RIGGED}), tmp_path, 840)
    threads, chance = tables[THREADS].copy(), np.random.default_rng(5)
    threads[threads[:, FROM] // 21 % 3 == 0, STIFFNESS] *= 1.5
    ours = rows_of(own_graph({NODES: tables[NODES], THREADS: threads}))
    given = threads[ORDERS[order](threads, chance)]
    turned = chance.random(len(given)) < 0.5
    given[np.ix_(turned, (FROM, TO))] = given[np.ix_(turned, (TO, FROM))]
    found = rows_of(own_graph({NODES: tables[NODES], THREADS: given}))
    assert len(found.strips) == len(ours.strips) < 0.1 * len(threads)
    layer.tables = {NODES: tables[NODES], THREADS: given}
    laid = layer.lay({})
    told = {frozenset(row[[FROM, TO]].astype(int)): row[[STIFFNESS, LENGTH, MASS]] for row in threads}
    ends = laid.number[laid.graph.ends[: len(threads)]] + 1
    assert {frozenset(pair) for pair in ends.tolist()} == set(told)
    held = np.column_stack([laid.graph.stiffness, laid.graph.length, laid.graph.mass])[: len(threads)]
    np.testing.assert_array_equal(held, [told[frozenset(pair)] for pair in ends.tolist()])


@pytest.mark.parametrize("pieces", [1, 4])
def test_what_it_says_is_what_is_laid_out(layer, pieces):
    """Masses, lengths, bound and drawing, before anything is built."""
    nodes, threads, _ = unlike()
    threads[5:9, STIFFNESS : MASS + 1] = 0.0
    threads[5:, LENGTH + 1] = 1.5e-3  # their diameter
    threads[8:11, DAMPING] = -1.0
    layer.tables = {NODES: nodes, THREADS: threads}
    values = {"net.segments": pieces, "net.youngs_modulus": 2e9, "net.density": 1100.0, "net.damping_ratio": 0.3}
    laid, every = layer.lay(values), every_value(layer.tables, values)
    own = slice(0, 14 * pieces)
    graph = laid.graph
    area = math.pi / 4 * 1.5e-3**2
    whole = sorted(set(np.round(graph.stiffness[own] / pieces, 6)))
    told = [row[STIFFNESS] or 2e9 * area / row[LENGTH] for row in threads]
    np.testing.assert_allclose(whole, sorted(told), rtol=1e-6)
    masses = [row[MASS] or 1100.0 * area * row[LENGTH] for row in threads]
    assert (
        CHECKS.mass(every) == pytest.approx(sum(masses), rel=1e-12) == pytest.approx(graph.mass[own].sum(), rel=1e-12)
    )
    dashpots = [
        d if d >= 0 else 0.6 * math.sqrt(2 * k * m) for d, k, m in zip(threads[:, DAMPING], told, masses, strict=True)
    ]
    np.testing.assert_allclose(np.sort(graph.damping[own][::pieces] / pieces), np.sort(dashpots), rtol=1e-12)
    assert CHECKS.total(every) == pytest.approx(graph.length[own].sum(), rel=1e-12)
    assert CHECKS.nodes(every) == 10 + 14 * (pieces - 1)
    stiff, damped, mass = np.zeros((3, len(laid.mass)))
    for end in graph.ends[own].T:
        np.add.at(stiff, end, graph.stiffness[own])
        np.add.at(damped, end, graph.damping[own])
        np.add.at(mass, end, 0.5 * graph.mass[own])
    there = mass > 0.0
    thread, dashpot, node = laid.thread
    assert 4.0 * thread / node == pytest.approx((stiff[there] / mass[there]).max(), rel=1e-12)
    assert 4.0 * dashpot / node == pytest.approx((damped[there] / mass[there]).max(), rel=1e-12)
    assert CHECKS.piece(every) == pytest.approx(laid.thread, rel=1e-12)
    corners, rim = graph.rim[graph.corners], graph.rim
    edge = [slot for slot in rim if slot not in corners]
    assert node == pytest.approx(min(mass[edge].min() / 0.75, mass[corners].min() / 0.5), rel=1e-12)
    hanging = [pieces * mass[slots].max() for slots in (np.setdiff1d(laid.slots[:10], rim), edge, corners)]
    assert CHECKS.hanging(every)[:3] == pytest.approx(hanging, rel=1e-9)
    found = CHECKS.thread(every)
    assert (found.section, found.stiffness, found.mass) == (None, pytest.approx(max(told)), pytest.approx(min(masses)))
    lines, edge = CHECKS.drawing(every)
    assert [frozenset(line) for line in lines] == [frozenset(pair) for pair in ENDS]
    assert edge == [0, 1, 2, 3, 4, 5, 6, 7, 0]
    assert CHECKS.bullets(every) == 4
    assert CHECKS.sides(every) == pytest.approx([own_graph(every).gaps[k : k + 2].sum() for k in (0, 2, 4, 6)])
    assert catch_mass(every, OWN) == pytest.approx(sum(masses) + 4 * 0.5 + 0.15)
    assert not refusals(OWN, every)
    assert "thread.area" not in {row.key for row in rows(every, OWN)}


def test_faces_span_the_net():
    """Their areas, as seen along the shot, fill the mouth once; Euler's formula counts them."""
    nodes, threads, place = unlike()
    graph = own_graph({NODES: nodes, THREADS: threads})
    assert len(graph.faces) == len(ENDS) - len(PLACES) + 1

    def area(face):
        x, y = place[face, :2].T
        return 0.5 * (x @ np.roll(y, -1) - np.roll(x, -1) @ y)

    areas = [area(face) for face in graph.faces]
    assert min(areas) > 0.0
    assert sum(areas) == pytest.approx(area(graph.rim), rel=1e-12)


GRID_NODES = ["1,-1,-1,0,corner", "2,1,-1,0,corner", "3,1,1,0,corner", "4,-1,1,0,corner", "5,0,0,0,vertex"]
GRID_THREADS = ["1,2,1", "2,3,1", "3,4,1", "4,1,1", "1,5,1", "2,5,1", "3,5,1", "4,5,1"]


@pytest.mark.parametrize(
    ("nodes", "threads", "said"),
    [
        ([*GRID_NODES, "5,0.5,0,0,"], GRID_THREADS, "line 7: node 5 stands twice, on line 6 too"),
        (GRID_NODES, [*GRID_THREADS, "3,3,1"], "line 10: a thread from node 3 to itself"),
        (GRID_NODES, [*GRID_THREADS, "2,1,1"], "line 10: the thread from 2 to 1 stands twice, on line 2 too"),
        ([*GRID_NODES, "6,0.5,0,0,"], GRID_THREADS, "line 7: node 6 hangs on nothing"),
        ([*GRID_NODES, "6,.5,0,0,", "7,.4,0.1,0,"], [*GRID_THREADS, "6,7,1"], "line 7: no threads lead from node 6"),
        (GRID_NODES, [*GRID_THREADS, "3,9,1"], "line 10: node 9 is none of the 5"),
        ([*GRID_NODES[:4], "5,0,0,0,"], GRID_THREADS, "no node has the role vertex"),
        ([n.replace("1,0,corner", "1,0,mouth") for n in GRID_NODES], GRID_THREADS, "0 nodes have the role corner"),
        ([*GRID_NODES, "6,0,0,0,"], [*GRID_THREADS, "5,6,1"], "line 7: nodes 5 (line 6) and 6 are in one place"),
        (
            [*GRID_NODES, "6,0,0,-1,"],
            [*GRID_THREADS, "5,6,1"],
            "line 7: nodes 5 (line 6) and 6 are one behind the other",
        ),
        ([*GRID_NODES[:4], "5,0,0,0,crown"], GRID_THREADS, "line 6: role = 'crown', expected corner, mouth, vertex"),
        ([*GRID_NODES[:4], "5,nan,0,0,vertex"], GRID_THREADS, "line 6: x = 'nan', expected a number"),
        ([*GRID_NODES[:4], "5,0,0,vertex"], GRID_THREADS, "line 6: 4 values, expected 5"),
        ([*GRID_NODES[:4], "v,0,0,0,vertex"], GRID_THREADS, "line 6: node = 'v', expected the number of a node"),
        (GRID_NODES, [*GRID_THREADS[:7], "4,5,0"], "line 9: diameter = 0, expected more than 0"),
        (GRID_NODES, [*GRID_THREADS[:7], "4,5,"], "line 9: expected a diameter, or a stiffness and a mass"),
        (GRID_NODES, GRID_THREADS[1:], "line 2: node 1 of the mouth has threads to 1 others of it (4); expected two"),
        (GRID_NODES, [*GRID_THREADS, "1,3,1"], "line 2: node 1 of the mouth has threads to 3 others of it (2, 4, 3)"),
        ([n.replace(",-1,0,c", ",2,0,c") for n in GRID_NODES], GRID_THREADS, "does not pass through the mouth"),
        ([*GRID_NODES, "6,2,0,0,"], [*GRID_THREADS, "5,6,1"], "its threads cross, or reach beyond the rim"),
        (["1,0,0,0,vertex"], ["# nothing"], "it is empty"),
    ],
)
def test_files_that_make_no_net(tmp_path, nodes, threads, said):
    def read():
        MODEL.interface(OWN).with_tables(save(tmp_path, nodes, threads, "diameter [mm]"))

    with pytest.raises(ValueError, match=re.escape(said)):
        read()


@pytest.mark.parametrize(
    ("head", "said"),
    [
        ("node,x,y [m],role", "line 1: x has no unit, expected such as x [m]"),
        ("node,x [kg],y [m],role", "line 1: x in 'kg', expected one of m, cm, mm"),
        ("node,x [m],y [m]", "line 1: no column role; expected node, x [m]"),
        (
            "node,x [m],y [m],rolle",
            "no column is called 'rolle'; expected node, x [m], y [m], z [m], role; did you mean \"role\"?",
        ),
        ("node,x [m],x [m],y [m],role", "line 1: the column x stands twice"),
        ("node [1],x [m],y [m],role", "line 1: node in '1', expected no unit"),
    ],
)
def test_heads_that_say_too_little(tmp_path, head, said):
    path = tmp_path / "nodes.csv"
    path.write_text(head + "\n1,2,3,corner\n")
    with pytest.raises(ValueError, match=re.escape(said)):
        read_nodes(path)


def test_units_lines_and_columns(tmp_path):
    """Columns in any order, in other units, with comments between."""
    path = tmp_path / "threads.csv"
    path.write_text(
        "# own\n\nto, from, mass [g], stiffness [kN/m], length [cm] # heads\n2, 1, 0.5, 2, 25\n3, 1, 4, 1,\n"
    )
    rows = np.array(read_threads(path))
    assert rows[:, [FROM, TO]].tolist() == [[1, 2], [1, 3]]
    np.testing.assert_allclose(rows[:, [LENGTH, STIFFNESS, MASS, DAMPING]], [[0.25, 2e3, 5e-4, -1], [0, 1e3, 4e-3, -1]])


def test_a_length_below_the_distance_is_told():
    nodes, threads, _ = unlike()
    threads[3, LENGTH] = 1.0
    with pytest.raises(NetError, match=r"line 5: length 1 m, but its nodes 12 and 11 are 3\.15753 m apart"):
        own_graph({NODES: nodes, THREADS: threads})


def test_a_mistake_names_file_and_line(tmp_path):
    """As a user meets it: both files' mistakes with their key."""
    text = """[capture]
duration = "3 s"
macro_step = "0.1 s"
[capture.net]
shape = "table"
node_file = "nodes.csv"
thread_file = "threads.csv"
[capture.gravity]
law = "none"
[capture.nodes]
"""
    save(tmp_path, [*GRID_NODES, "6,0.5,0,0,"], GRID_THREADS, "diameter [mm]")
    with pytest.raises(InputError, match=r"capture.net.node_file = \"nodes.csv\": line 7: node 6 hangs on nothing"):
        parse(text, "mine", "mine.toml", tmp_path)
    with pytest.raises(InputError) as alone:  # how many bullets there are, such files do not say
        parse(text + '[capture.ejection]\ndelay = ["0 s", "1 ms", "0 s"]\n', "mine", "mine.toml", tmp_path)
    assert "node 6 hangs on nothing" in str(alone.value)
    assert "ejection" not in str(alone.value)
    (tmp_path / "threads.csv").write_text("from,to,diameter\n1,2,1\n")
    with pytest.raises(InputError, match=r"threads.csv: line 1: diameter has no unit"):
        parse(text, "mine", "mine.toml", tmp_path)
    save(tmp_path, GRID_NODES, GRID_THREADS, "diameter [mm]")
    scene = parse(text, "mine", "mine.toml", tmp_path)
    assert scene.phases[0].main.terms["nodes"] == "5"
    with pytest.raises(InputError, match=r"capture\.ejection\.delay.*expected a list of 4"):
        parse(text + '[capture.ejection]\ndelay = ["0 s", "1 ms", "0 s"]\n', "mine", "mine.toml", tmp_path)
    with pytest.raises(InputError, match=r"bullets.number.*3.*must be 4"):
        parse(text + "[capture.bullets]\nnumber = 3\n", "mine", "mine.toml", tmp_path)


def test_rows_are_filled_where_no_order_is_kept():
    """A net whose threads are written in no order takes no more than twice the slots of its nodes."""
    nodes, threads, _ = unlike(3)
    found = rows_of(own_graph({NODES: nodes, THREADS: threads}))
    assert (found.slots[-1, 0] + 1) * found.longest <= 2 * len(nodes)
    assert all((a >= 0).all() for a in found.slots)
