"""What stands in an instance's work memory, as numpy views: node planes, the graph, and the leapfrog's words."""

from typing import NamedTuple

import numpy as np

from fmu_src.net_capture.capture_index import SCRATCH_PLANES
from fmu_src.net_capture.composition import Composition
from fmu_src.net_capture.interface import MODEL
from fmu_src.net_capture.planes import (
    FACE_WORDS,
    MASS,
    NODE_PLANES,
    SHOWN,
    SQUARED,
    STRIP_NUMBERS,
    STRIP_WORDS,
    work_size,
)
from fmu_src.net_capture.schemes.asleep import ROW_WORDS
from fmu_src.net_capture.self_contact.reaches import PLANES as SELF_PLANES
from tests.plain import plainly


def planes(net):
    """The node planes, a view (planes, slots)."""
    return planes_of(net.record[0], net.work, net.interface.terms)


def planes_of(p, work, terms):
    """The same of a record and its work memory."""
    slots = int(p["node_slots"])
    planned = [group for group in ("solver", "substeps", "contact") if group in terms]
    needed = (MODEL.groups[group].terms[terms[group]].checks for group in planned)
    count = NODE_PLANES + sum(part.planes for part in needed)
    reals = work.view(np.float32 if terms["precision"] == "single" else np.float64)
    if "quality" in terms:
        count += SCRATCH_PLANES * 8 // reals.itemsize
    count += 1 if "wall" in terms else 0
    count += SELF_PLANES if "self_contact" in terms else 0
    return reals[: count * slots].reshape(count, slots)


def nodes(net):
    """Slots of the nodes, in the order of the outputs."""
    return np.flatnonzero(planes(net)[MASS] > 0.0)


def shown(net, first=SHOWN):
    """Vectors of all nodes (n, 3), copied: positions of now, or what the three planes from `first` on hold."""
    return planes(net)[first : first + 3, nodes(net)].T.copy()


class Bench:
    """Parts of a model without the model: a record with its start values, and the memory of a net laid out in it, by
    kernels as they were written: see `tests.net_capture.laid`.

    tables    that its parts bring, by name
    """

    def __init__(self, terms, tables=None):
        plainly(self._lay_out)(terms, tables)

    def _lay_out(self, terms, tables):
        interface = self.interface = MODEL.interface(terms).with_tables(tables or {})
        self.parts = Composition(MODEL, interface.terms)
        self.record = interface.make_record().view(np.recarray)
        self.p, self._tables = self.record[0], interface.table_block
        self.p.tables_at = self._tables.ctypes.data
        assert self.parts.graph.count(self.p, np.zeros(0)) == 0
        own = self.parts.scheme.own_words(self.p) + self.parts.traits.masks * self.p.strips
        if self.parts.wrap is not None:
            own += self.parts.wrap.words(self.p)
        self.work = np.zeros(work_size(self.p, self.parts.per_double, own))
        self.p.work_size = self.work.size
        self.parts.graph.lay_out(self.p, self.work)


class Graph(NamedTuple):
    """The graph of a net; nodes by their slots.

    ends         of every thread (n, 2), in the order of their numbers
    length, stiffness, damping, mass   of every thread (n,)
    strips       how many threads each strip has
    rim, corners, bullets, apex        nodes of the rim, its numbers of the corners, the bullets, nodes of the vertex
    faces        (n, 4)
    rest         what follows: words of the scheme
    """

    ends: np.ndarray
    length: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    mass: np.ndarray
    strips: np.ndarray
    rim: np.ndarray
    corners: np.ndarray
    bullets: np.ndarray
    apex: np.ndarray
    faces: np.ndarray
    rest: np.ndarray


def graph(net):
    return graph_of(net.record[0], net.work, net.interface.terms)


def graph_of(p, work, terms):
    """The graph in a record's work memory, strips taken apart into threads."""
    at = planes_of(p, work, terms).nbytes // 8
    parts = []
    counts = ("strips", "strips", "rim_nodes", "net_corners", "net_corners", "apex_nodes", "net_faces")
    widths = (STRIP_WORDS, STRIP_NUMBERS, 1, 1, 1, 1, FACE_WORDS)
    for name, width in zip(counts, widths, strict=True):
        parts.append(work[at : at + width * int(p[name])].reshape(-1, width))
        at += parts[-1].size
    words = [part.view(np.int64) for part in parts]
    ends, numbers, lengths, first = [], [], [], []
    for (a, b, lanes, number), row in zip(words[0].tolist(), parts[1], strict=True):
        here = [lane for lane in range(64) if lanes >> lane & 1]
        ends += [(a + lane, b + lane) for lane in here]
        numbers += [row] * len(here)
        lengths.append(len(here))
        assert number == (first[-1] if first else 0)
        first.append(number + here[-1] + 1)
    pieces = (part.ravel() for part in words[2:6])
    return Graph(
        np.array(ends), *np.array(numbers).T[:SQUARED], np.array(lengths), *pieces, words[6], work[at:].view(np.int64)
    )


def stamps(net):
    """The substep to which the positions of each row belong, with the leapfrog."""
    p = net.record[0]
    rows = int(p["node_slots"]) // int(p["row_pitch"])
    return graph(net).rest[: ROW_WORDS * rows].reshape(rows, ROW_WORDS)[:, 0]
