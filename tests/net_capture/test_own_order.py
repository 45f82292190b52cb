"""Nets of one's own whose nodes and threads are written in no order: as many strips as of those that are, and outputs
that count the nodes as the file does."""

import math

import numpy as np
import pytest

from fmu_src.net_capture.nets.own_graph import NODES, THREADS, own_graph
from fmu_src.net_capture.nets.own_rows import rows_of
from fmu_src.net_capture.nets.written import FROM, LENGTH, MASS, PLACE, STIFFNESS, TO
from fmu_src.net_capture.planes import SHOWN
from fmu_src.net_capture.tensions import make_tensions
from orbital.kernel import kernel
from tests.net_capture.laid import Layer
from tests.net_capture.own_files import write

SHAPES = {
    "square": ({"net.side": 6.0, "net.mesh": 0.5}, {}),
    "pyramid": ({"net.side": 4.0, "net.mesh": 0.5, "net.depth": 2.0}, {}),
    "hexagon": ({"net.radius": 3.0, "net.mesh": 0.5}, {"bullets": "6"}),
    "cone": ({"net.radius": 3.0, "net.mesh": 0.5, "net.depth": 2.0, "net.top_radius": 1.0}, {}),
}


def in_no_order(tables, turn):
    """The same net, turned about the shot's axis, its lines shuffled, half of its threads turned round."""
    chance = np.random.default_rng(3)
    nodes, threads = (chance.permutation(tables[name]) for name in (NODES, THREADS))
    c, s = math.cos(turn), math.sin(turn)
    nodes[:, PLACE : PLACE + 2] = nodes[:, PLACE : PLACE + 2] @ np.array([[c, s], [-s, c]])
    turned = chance.random(len(threads)) < 0.5
    threads[np.ix_(turned, (FROM, TO))] = threads[np.ix_(turned, (TO, FROM))]
    return {NODES: nodes, THREADS: threads}


@pytest.mark.parametrize("shape", SHAPES)
def test_there_are_as_many_strips_as_in_order(shape, tmp_path):
    values, rigged = SHAPES[shape]
    tables = write(Layer(shape, **rigged).lay(values), tmp_path)
    written = rows_of(own_graph(tables))
    found = [rows_of(own_graph(in_no_order(tables, turn))) for turn in (0.0, 0.4)]
    assert max(len(rows.strips) for rows in found) <= len(written.strips) < 0.35 * len(tables[THREADS])
    for rows in found:
        assert (rows.slots[:, 0].max() + 1) * rows.longest <= 2 * len(tables[NODES])
        assert len({tuple(slot) for slot in rows.slots.tolist()}) == len(tables[NODES])


def test_a_net_in_no_order_is_laid_out_and_counted_as_its_file_has_it(tmp_path):
    """Places of nodes, and properties and both numbers of every thread, cut in two pieces; for a thread of two
    pieces, the node between them has one of the numbers beyond the file's."""
    tables = write(Layer("square").lay({"net.side": 4.0, "net.mesh": 0.5}), tmp_path)
    tables[THREADS][::3, STIFFNESS] *= 1.5
    given = in_no_order(tables, 0.4)
    layer = Layer("table", nodes="300", threads="300")
    layer.tables = given
    laid = layer.lay({"net.segments": 2})
    write_nodes, list_threads = layer.parts.numbering.write, make_tensions(layer.parts).list_threads

    @kernel
    def tell(record, work):
        write_nodes(record[0], work)
        list_threads(record[0], work)

    tell(laid.record, laid.work)
    count = len(given[NODES])
    told = laid.p["node_position"]
    np.testing.assert_allclose(told[:count], given[NODES][:, PLACE : PLACE + 3], atol=1e-12)
    np.testing.assert_array_equal(told[: len(laid.slots)], laid.planes[SHOWN : SHOWN + 3].T[laid.slots])
    line = {int(name): k for k, name in enumerate(given[NODES][:, 1])}
    ends = laid.p["thread_node"][: 2 * len(given[THREADS])] - 1
    pieces, middles = {}, np.arange(count, len(laid.slots)).tolist()
    for number, (a, b) in enumerate(ends.tolist()):
        pieces.setdefault(max(a, b), []).append((min(a, b), number))
    assert sorted(pieces) == middles
    joined = {frozenset(knot for knot, _ in both): [number for _, number in both] for both in pieces.values()}
    assert len(joined) == len(given[THREADS])
    for row in given[THREADS]:
        for number in joined[frozenset((line[int(row[FROM])], line[int(row[TO])]))]:
            assert laid.graph.stiffness[number] == pytest.approx(2.0 * row[STIFFNESS], rel=1e-12)
            assert laid.graph.length[number] == pytest.approx(0.5 * row[LENGTH], rel=1e-12)
            assert laid.graph.mass[number] == pytest.approx(0.5 * row[MASS], rel=1e-12)
    between = told[middles] - 0.5 * sum(told[[both[i][0] for _, both in sorted(pieces.items())]] for i in (0, 1))
    assert np.abs(between).max() < 1e-12
