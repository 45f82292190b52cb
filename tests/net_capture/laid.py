"""A net laid out by its kernels alone, before it is folded.

The kernels run as they were written: to lay out a net once takes Python less time than numba to compile what does it.

Checked  tests/net_capture/test_laid.py: compiled they give the same bits; tests/net_capture/test_own_net.py has a
         slice of it, a net of tables, compiled, beside one of ours
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from fmu_src.net_capture.composition import Composition
from fmu_src.net_capture.interface import MODEL
from fmu_src.net_capture.nets.own_graph import own_graph
from fmu_src.net_capture.nets.own_rows import rows_of
from fmu_src.net_capture.planes import MASS, SHOWN, X
from fmu_src.net_capture.shot import make_shot
from fmu_src.net_capture.stepping import make_choose_substep
from orbital.kernel import kernel
from tests.conftest import FREE
from tests.net_capture.memory import graph_of, planes_of
from tests.plain import plainly, seen


def _of_fields(function: Callable[..., Any]) -> Callable[..., Any]:
    """A kernel of a record that is not compiled."""
    written = plainly(function)
    return lambda record, *more: written(seen(record), *more)


class Layer:
    """What lays nets of one shape out: its kernels, for a record and work memory.

    tables      of a net of one's own, by name
    compiled    as it must be where a net has tables, which Python does not read from memory
    """

    tables: Mapping[str, np.ndarray] = {}

    def __init__(self, shape: str, *, compiled: bool = False, **rigged: str) -> None:
        self.compiled = compiled or shape == "table"
        self.terms = MODEL.interface(FREE | {"net": shape} | rigged).terms
        parts = self.parts = Composition(MODEL, self.terms)
        graph, shot = parts.graph, make_shot(parts)
        count_of, lay, load_on, thread_of = graph.count, graph.lay_out, shot.load, parts.net.thread

        @kernel
        def count(record, work):
            return count_of(record[0], work)

        @kernel
        def lay_out(record, work):
            lay(record[0], work)

        @kernel
        def load(record, work):
            load_on(record[0], work)

        @kernel
        def thread(record):
            return thread_of(record[0])

        choose, folding = make_choose_substep(parts), parts.folding
        check_of, fold_of = folding.check, folding.fold

        @kernel
        def check(record):
            return check_of(record[0])

        @kernel
        def fold(record, work):
            fold_of(record[0], work)

        @kernel
        def bound(record):
            fault = choose(record[0])
            return record[0].solver_stability_bound if fault == 0 else -1.0

        kernels = (count, lay_out, load, thread, bound, check, fold)
        self._count, self.lay_out, self.load, self.thread, self.bound, self.check, self._fold = (
            kernels if self.compiled else map(_of_fields, kernels)
        )

    def record(self, values: Mapping[str, float]):
        interface = MODEL.interface(self.terms).with_tables(self.tables)
        record = interface.make_record()
        if not self.compiled:  # for kernels of a test's own
            record = record.view(np.recarray)
        self._block = interface.table_block
        record["tables_at"] = self._block.ctypes.data
        for name, value in values.items():
            record[name.replace(".", "_")] = value
        return record

    def count(self, values: Mapping[str, float]) -> int:
        return self._count(self.record(values), np.zeros(0))

    def counted(self, values: Mapping[str, float]):
        """A record with the counts of its net."""
        record = self.record(values)
        assert self._count(record, np.zeros(0)) == 0
        return record

    def lay(self, values: Mapping[str, float]) -> "Laid":
        return Laid(self, self.counted(values))

    def fold(self, laid: "Laid") -> np.ndarray:
        """Places of all slots in the canister, along the mouth's axes and the shot, from the muzzle."""
        laid.record["axes"] = np.eye(3).ravel()
        self._fold(laid.record, laid.work)
        return laid.planes[X : X + 3].T.copy()


class Laid:
    """One such net.

    mass      of the net alone, by slot; `planes` have bullets and vertex too
    slots     those that hold a node, as the outputs count them; number    of the node in a slot, -1: none
    places    of all nodes, as the net is meant
    bound     guaranteed stability bound of the explicit step [s]
    """

    def __init__(self, layer, record):
        self.record, p = record, record[0]
        self.p = p
        own = 12 * int(p["strips"] + p["node_slots"])
        self.work = np.zeros(40 * int(p["node_slots"]) + 12 * int(p["strips"]) + 8 * int(p["net_nodes"]) + own)
        layer.lay_out(record, self.work)
        self.thread, self.bound = layer.thread(record), layer.bound(record)
        self.planes = planes_of(p, self.work, layer.terms)
        self.mass = self.planes[MASS].copy()
        layer.load(record, self.work)
        self.graph = graph_of(p, self.work, layer.terms)
        self.slots = np.flatnonzero(self.mass > 0.0)
        if layer.tables:
            knots = rows_of(own_graph(layer.tables)).slots @ (int(p["row_pitch"]), 1)
            self.slots = np.concatenate([knots, self.slots[self.slots >= p["knot_slots"]]])
        self.number = np.full(int(p["node_slots"]), -1)
        self.number[self.slots] = np.arange(len(self.slots))
        self.places = self.planes[SHOWN : SHOWN + 3].T[self.slots]
