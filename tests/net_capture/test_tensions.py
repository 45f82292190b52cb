"""Outputs of every thread: between which nodes it runs, and what it bears, against the graph taken apart in numpy."""

import numpy as np
import pytest

from fmu_src.net_capture.interface import MODEL, refusals, thread_capacity_of, threads_of
from fmu_src.net_capture.planes import LANES, SHOWN, SHOWN_RATE, STRIP_WORDS
from fmu_src.net_capture.tensions import make_tensions
from orbital.kernel import kernel
from tests.net_capture.laid import Layer
from tests.plain import plainly

SHAPES = {
    "square": {"net.side": 8.0, "net.mesh": 2.0, "net.segments": 2},
    "hexagon": {"net.radius": 6.0, "net.mesh": 2.0},
}
STRUNG = {
    "square": (SHAPES["square"] | {"leads.segments": 3}, {"edge": "plain", "leads": "plain"}),
    "cone": ({"net.radius": 3.0, "net.depth": 4.0, "net.top_radius": 0.8, "net.mesh": 1.0}, {}),
}
"""Values and terms of a square with an edge rope and leads, and of a cone, whose rows have gaps in other places."""
SPARE = 7
"""Outputs that no thread needs."""


@pytest.fixture(scope="module", params=STRUNG)
def strung(request):
    """A net pulled about at random: what it is laid in, and the kernel that writes."""
    values, rigged = STRUNG[request.param]
    count = threads_of(*settled(request.param, values, **rigged))
    layer = Layer(request.param, **rigged, threads=str(count + SPARE))
    laid = layer.lay(values)
    assert int(laid.p["net_threads"]) == count, "as many outputs as threads, or what is written goes astray"
    tensions = make_tensions(layer.parts)
    list_all, write_all = tensions.list_threads, tensions.write

    @kernel
    def shown(record, work):
        list_all(record[0], work)
        write_all(record[0], work)

    @kernel
    def again(record, work):
        write_all(record[0], work)

    random = np.random.default_rng(3)
    laid.planes[SHOWN : SHOWN + 3] += 0.3 * random.standard_normal(laid.planes[SHOWN : SHOWN + 3].shape)
    laid.planes[SHOWN_RATE : SHOWN_RATE + 3] = random.standard_normal(laid.planes[:3].shape)
    plainly(shown)(laid.record, laid.work)
    return laid, plainly(again), count


def settled(shape, values, **rigged):
    """Terms with such a net, and the value of every parameter."""
    terms = MODEL.interface(
        {"net": shape, "gravity": "none", "bullets": "6" if shape == "hexagon" else "4", **rigged}
    ).terms
    return terms, {
        v.name: v.starts()[0] for v in MODEL.interface(terms).variables if v.causality == "parameter"
    } | values


def expected(laid):
    """Tensions by the graph's own lengths, stiffnesses and dashpots."""
    a, b = laid.graph.ends.T
    gap = (laid.planes[SHOWN : SHOWN + 3, b] - laid.planes[SHOWN : SHOWN + 3, a]).T
    rate = (laid.planes[SHOWN_RATE : SHOWN_RATE + 3, b] - laid.planes[SHOWN_RATE : SHOWN_RATE + 3, a]).T
    length = np.linalg.norm(gap, axis=1)
    pull = (
        laid.graph.stiffness * (length - laid.graph.length) + laid.graph.damping * np.sum(gap * rate, axis=1) / length
    )
    return np.where(length > laid.graph.length, np.maximum(pull, 0.0), 0.0)


def test_every_thread_is_listed_between_its_nodes(strung):
    laid, _, count = strung
    assert int(laid.p["net_threads"]) == count == len(laid.graph.ends)
    assert (laid.p["thread_node"][:count] == laid.number[laid.graph.ends] + 1).all()
    assert len(laid.p["thread_node"]) == count + SPARE
    assert not laid.p["thread_node"][count:].any()
    assert not laid.p["thread_tension"][count:].any()


def test_tension_is_that_of_its_own_length_and_dashpot(strung):
    laid, _, count = strung
    told, wanted = laid.p["thread_tension"][:count], expected(laid)
    assert 0.2 < np.mean(wanted > 0.0) < 0.8, "some are taut, some slack"
    assert told == pytest.approx(wanted, rel=1e-9)


def test_a_thread_that_broke_bears_nothing_and_the_others_keep_their_places(strung):
    laid, again, count = strung
    wanted = expected(laid)
    strips = laid.work[laid.planes.nbytes // 8 :][: STRIP_WORDS * int(laid.p["strips"])].view(np.int64)
    held = int(strips[LANES])
    strips[LANES] = held & ~1
    try:
        again(laid.record, laid.work)
        assert laid.p["thread_tension"][0] == 0.0
        assert laid.p["thread_tension"][1:count] == pytest.approx(wanted[1:], rel=1e-9)
    finally:
        strips[LANES] = held


@pytest.mark.parametrize(
    ("shape", "threads"),
    [
        ("square", 2 * 2 * 4 * 5),  # s 2 n (n + 1)
        ("hexagon", 6 * 3 * 4),  # 6 n (n + 1)
    ],
)
def test_as_many_as_the_net_has_are_asked_for_and_fewer_refused(shape, threads):
    terms, values = settled(shape, SHAPES[shape])
    assert threads_of(terms, values) == threads
    assert thread_capacity_of(terms, values) == str(threads)
    for capacity, told in ((threads - 1, ["threads.capacity"]), (threads, [])):
        found = [row[0] for row in refusals({**terms, "threads": str(capacity)}, values)]
        assert [name for name in found if name.startswith("threads")] == told
