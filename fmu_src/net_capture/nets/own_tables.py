"""The tables that a net of one's own brings: its two files, and what its kernels read, which is made from them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from fmu_src.net_capture.nets.own_graph import NODES, THREADS, OwnGraph, own_graph
from fmu_src.net_capture.nets.own_rows import OF, STRIP_COLUMNS, rows_of
from fmu_src.net_capture.nets.written import read_nodes, read_threads, rewritten_nodes, rewritten_threads
from fmu_src.net_capture.planes import FACE_WORDS
from fmu_src.tables import Table

Floats = npt.NDArray[np.float64]

UNLOADED, DIAMETER, STIFFNESS, MASS, DASHPOT = range(STRIP_COLUMNS, STRIP_COLUMNS + 5)
"""Columns of the strips after those of `own_rows`, of a thread: unloaded length [m]; diameter [m], stiffness [N/m] and
mass [kg], 0 where they are not told; dashpot [N s/m], below 0 where the ratio tells it."""
PLACE = 2
"""Column of the knots from which on their places stand [m], after row and column."""
GAP = 2
"""Column of the rim: from a node to the next [m], after row and column."""

INSIDE, EDGE, CORNER, WITHIN = range(4)
"""Kinds of node: of the net inside, of its rim, of the rim with a bullet; within a thread that is cut."""
KIND, OWN_STIFFNESS, BY_AREA, OWN_MASS, MASS_BY_AREA, OWN_DASHPOT, VIA_OWN, VIA_AREA, KIND_COLUMNS = range(9)
"""Columns of the kinds of nodes, sums over the threads that meet there: k [N/m], A/l [m]; m/2 [kg], A l/2 [m3];
d [N s/m], sqrt(k m) [N s/m] and A [m2] of those whose dashpot the ratio tells."""

LONGEST, ROWS, INNER_ROWS, WHOLE_THREADS, FLAT_AREA, WIDTH, MESH = range(7)
"""Numbers of a net: nodes of its longest row, rows of knots, rows of one inner node of all threads, threads; area of
the mouth between its corners [m2], `width` and `mesh` of the graph [m]."""


def _sizes(graph: OwnGraph) -> list[float]:
    rows = rows_of(graph)
    x, y, _ = graph.places[graph.rim[graph.corners]].T
    area = 0.5 * float(x @ np.roll(y, -1) - np.roll(x, -1) @ y)
    return [rows.longest, rows.rows, rows.inner, len(graph.ends), area, graph.width, graph.mesh]


def _knots(graph: OwnGraph) -> Floats:
    return np.column_stack([rows_of(graph).slots, graph.places])


def _strips(graph: OwnGraph) -> Floats:
    strips = rows_of(graph).strips
    of = strips[:, OF]
    return np.column_stack([strips, graph.lengths[of], graph.told[of]])


def _rim(graph: OwnGraph) -> Floats:
    return np.column_stack([rows_of(graph).slots[graph.rim], graph.gaps])


def _corners(graph: OwnGraph) -> Floats:
    return np.column_stack([graph.corners, graph.sides])


def _faces(graph: OwnGraph) -> Floats:
    """Row and column of four nodes each, the last twice for a triangle; one with more sides is cut into such."""
    found = []
    for face in graph.faces:
        for k in range(1, len(face) - 1, FACE_WORDS - 2):
            four = [face[0], *face[k : k + FACE_WORDS - 1]]
            found.append([*four, *[four[-1]] * (FACE_WORDS - len(four))])
    return np.asarray(rows_of(graph).slots[np.array(found)].reshape(len(found), -1), dtype=np.float64)


@lru_cache(maxsize=16)
def kinds_of(graph: OwnGraph) -> Floats:
    """The kinds of nodes there are, each once."""
    diameter, stiffness, mass, dashpot = graph.told.T
    own = stiffness > 0.0
    area = np.where(own, 0.0, 0.25 * np.pi * diameter**2)
    by_ratio = dashpot < 0.0
    of_thread = np.column_stack(
        [
            stiffness,
            area / graph.lengths,
            0.5 * mass,
            0.5 * area * graph.lengths,
            np.where(by_ratio, 0.0, dashpot),
            np.where(by_ratio, np.sqrt(stiffness * mass), 0.0),
            np.where(by_ratio, area, 0.0),
        ]
    )
    sums = np.zeros((len(graph.names), of_thread.shape[1]))
    for end in graph.ends.T:
        np.add.at(sums, end, of_thread)
    kind = np.full(len(graph.names), INSIDE)
    kind[graph.rim] = EDGE
    kind[graph.rim[graph.corners]] = CORNER
    whole = np.vstack(
        [np.column_stack([kind, sums]), np.column_stack([np.full(len(of_thread), WITHIN), 2 * of_thread])]
    )
    unlike = {tuple(f"{number:.9g}" for number in row): row for row in whole.tolist()}
    return np.array(list(unlike.values()))


def _made(of: Callable[[OwnGraph], Any]) -> Callable[[Mapping[str, Any]], Any]:
    return lambda numbers: of(own_graph(numbers))


TABLES = (
    Table(
        NODES,
        "1",
        "node, x [m], y [m], z [m], role: the nodes of a net, a row each",
        2,
        read=read_nodes,
        rewritten=rewritten_nodes,
    ),
    Table(
        THREADS,
        "1",
        "from, to, length [m], diameter [mm], stiffness [N/m], mass [g], damping [N s/m]: its threads, a row each",
        2,
        read=read_threads,
        rewritten=rewritten_threads,
    ),
    Table("net.sizes", "1", "how large it is", made=_made(_sizes)),
    Table("net.knots", "1", "where its nodes stand and are", 2, made=_made(_knots)),
    Table("net.strips", "1", "its threads in strips", 2, made=_made(_strips)),
    Table("net.rim", "1", "nodes of its rim", 2, made=_made(_rim)),
    Table("net.corners", "1", "corners of its rim, and how far apart", 2, made=_made(_corners)),
    Table("net.apex", "1", "nodes of its vertex", 2, made=_made(lambda graph: rows_of(graph).slots[graph.vertex])),
    Table("net.spans", "1", "faces between its threads", 2, made=_made(_faces)),
    Table("net.kinds", "1", "what meets at its nodes", 2, made=_made(kinds_of)),
)
