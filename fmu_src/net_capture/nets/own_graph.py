"""What the two files of a net come to as a graph: its nodes by place, the rim of its mouth, its faces."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from fmu_src.net_capture.nets.spanned import Crossing, faces_of
from fmu_src.net_capture.nets.written import CORNER, FROM, LENGTH, LINE, MOUTH, NODE, PLACE, ROLE, TO, VERTEX
from fmu_src.net_capture.planes import MOST_BULLETS

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

NODES, THREADS = "net.node_file", "net.thread_file"
LEAST_BULLETS = 3
CLOSE = 1e-9
"""Share of the net's size below which two places are one, and of a length below which two are the same."""
SHORTER = 1e-6
"""Share by which a thread may be shorter than its nodes are apart."""
MOST_KNOTS = 100_000


class NetError(ValueError):
    """Files that make no net: table at fault, line of its file (0: none alone), and why."""

    def __init__(self, table: str, line: float, text: str) -> None:
        self.table, self.text = table, f"line {int(line)}: {text}" if line else text
        super().__init__(f"{table}, {self.text}")


@dataclass(frozen=True, eq=False)
class OwnGraph:
    """A net of nodes, numbered as the file has them.

    names      of the nodes in the file
    places     along the mouth's axes and the shot, (n, 3) [m]
    ends       of every thread, (m, 2)
    lengths    unloaded, (m,) [m]
    told       diameter [m], stiffness [N/m], mass [kg] and dashpot [N s/m] of every thread as the file has them, (m, 4)
    rim        nodes of the mouth, once round, from a corner on and as x turns to y
    corners    numbers on the rim of its corners, in order
    vertex     nodes that the tether is made fast to
    faces      nodes of each, of any number
    """

    names: Ints
    places: Floats
    ends: Ints
    lengths: Floats
    told: Floats
    rim: Ints
    corners: Ints
    vertex: Ints
    faces: list[list[int]]

    @cached_property
    def gaps(self) -> Floats:
        """From each node of the rim to the next [m], the same for those that are alike but for rounding."""
        at = self.places[self.rim]
        found: list[float] = []
        for gap in np.linalg.norm(np.roll(at, -1, axis=0) - at, axis=1).tolist():
            near = (other for other in dict.fromkeys(found) if abs(other - gap) <= CLOSE * gap)
            found.append(next(near, gap))
        return np.array(found)

    @property
    def sides(self) -> list[float]:
        """Of the rim from each corner to the next [m]."""
        bounds = [*self.corners.tolist(), len(self.rim)]
        return [float(self.gaps[a:b].sum()) for a, b in itertools.pairwise(bounds)]

    @property
    def width(self) -> float:
        """Of the square about the shot's axis that holds the net [m]."""
        return 2.0 * float(np.abs(self.places[:, :2]).max())

    @property
    def mesh(self) -> float:
        """Width of a square mesh that is nowhere narrower than this net's [m]: of its longest thread, or of its widest
        face over sqrt(2)."""
        widest = 0.0
        for face in self.faces:
            at = self.places[face]
            widest = max(widest, float(np.linalg.norm(at[:, None] - at[None], axis=2).max()))
        return max(float(self.lengths.max()), math.sqrt(0.5) * widest)


def own_graph(tables: Mapping[str, Any]) -> OwnGraph:
    """The graph of these tables; `NetError` if they make none."""
    nodes, threads = (np.ascontiguousarray(tables[name], dtype=np.float64) for name in (NODES, THREADS))
    return _kept(nodes.tobytes(), nodes.shape, threads.tobytes(), threads.shape)


@lru_cache(maxsize=16)
def _kept(nodes: bytes, of_nodes: tuple[int, ...], threads: bytes, of_threads: tuple[int, ...]) -> OwnGraph:
    return _graph(np.frombuffer(nodes).reshape(of_nodes), np.frombuffer(threads).reshape(of_threads))


def _graph(nodes: Floats, threads: Floats) -> OwnGraph:
    if len(nodes) > MOST_KNOTS:
        raise NetError(NODES, nodes[MOST_KNOTS, LINE], f"more than {MOST_KNOTS} nodes")
    names, places = nodes[:, NODE].astype(np.int64), nodes[:, PLACE : PLACE + 3]
    ends = _ends(names, threads)
    _apart(nodes, places)
    lengths = _lengths(threads, names, places, ends)
    near: list[list[int]] = [[] for _ in names]
    for a, b in ends.tolist():
        near[a].append(b)
        near[b].append(a)
    alone = [k for k, others in enumerate(near) if not others]
    if alone:
        raise NetError(NODES, nodes[alone[0], LINE], f"node {names[alone[0]]} hangs on nothing: no thread ends there")
    role = nodes[:, ROLE].astype(np.int64)
    vertex = np.flatnonzero(role == VERTEX)
    if not len(vertex):
        raise NetError(NODES, 0, "no node has the role vertex, where the tether is made fast")
    count = int((role == CORNER).sum())
    if not LEAST_BULLETS <= count <= MOST_BULLETS:
        text = f"{count} nodes have the role corner, where a bullet is; expected {LEAST_BULLETS} to {MOST_BULLETS}"
        raise NetError(NODES, 0, text)
    rim = _rim(nodes, names, near, role)
    if not _surrounds(places[rim, :2]):
        raise NetError(NODES, 0, "the shot's axis, x = y = 0, does not pass through the mouth")
    _in_one_piece(nodes, names, near, int(rim[0]))
    try:
        faces = faces_of(places, near, rim)
    except Crossing:
        text = "seen through the mouth its threads cross, or reach beyond the rim: expected a net without crossings"
        raise NetError(THREADS, 0, text) from None
    corners = np.flatnonzero(role[rim] == CORNER)
    return OwnGraph(names, places, ends, lengths, threads[:, LENGTH + 1 :], rim, corners, vertex, faces)


def _ends(names: Ints, threads: Floats) -> Ints:
    """Numbers of the nodes at both ends of every thread."""
    place = {int(name): k for k, name in enumerate(names)}
    found = np.empty((len(threads), 2), dtype=np.int64)
    for k, row in enumerate(threads):
        for end, name in enumerate((int(row[FROM]), int(row[TO]))):
            if name not in place:
                raise NetError(THREADS, row[LINE], f"node {name} is none of the {len(names)} of the file of nodes")
            found[k, end] = place[name]
    return found


def _apart(nodes: Floats, places: Floats) -> None:
    """No two nodes are in one place, nor one behind the other as seen along the shot: folded they would be."""
    close = CLOSE * max(float(np.abs(places).max()), 1e-300)
    seen: dict[tuple[int, int], int] = {}
    for k, (x, y) in enumerate(np.round(places[:, :2] / close).astype(np.int64).tolist()):
        for cell in ((x + i, y + j) for i in (-1, 0, 1) for j in (-1, 0, 1)):
            other = seen.get(cell)
            if other is not None and math.dist(places[k, :2], places[other, :2]) < close:
                same = "in one place" if abs(places[k, 2] - places[other, 2]) < close else "one behind the other"
                name, line = int(nodes[other, NODE]), int(nodes[other, LINE])
                text = f"nodes {name} (line {line}) and {int(nodes[k, NODE])} are {same}, seen along the shot"
                raise NetError(NODES, nodes[k, LINE], text)
        seen[x, y] = k


def _lengths(threads: Floats, names: Ints, places: Floats, ends: Ints) -> Floats:
    """Unloaded, as told or as far as both nodes are apart [m]."""
    apart = np.linalg.norm(places[ends[:, 1]] - places[ends[:, 0]], axis=1)
    told = threads[:, LENGTH]
    short = np.flatnonzero((told > 0.0) & (told < apart * (1.0 - SHORTER)))
    if len(short):
        k = short[0]
        text = (
            f"length {told[k]:g} m, but its nodes {names[ends[k, 0]]} and {names[ends[k, 1]]} are {apart[k]:g} m apart"
        )
        raise NetError(THREADS, threads[k, LINE], text)
    return np.where(told > 0.0, told, apart)


def _rim(nodes: Floats, names: Ints, near: list[list[int]], role: Ints) -> Ints:
    """The mouth's nodes in order; each has threads to two others of them."""
    on = (role == CORNER) | (role == MOUTH)
    beside = {k: [other for other in near[k] if on[other]] for k in np.flatnonzero(on).tolist()}
    for k, others in beside.items():
        if len(others) != 2:
            to = ", ".join(str(names[other]) for other in others) or "none"
            text = (
                f"node {names[k]} of the mouth has threads to {len(others)} others of it ({to}); expected two: the rim "
                "is one closed line of threads, through all nodes with the role corner or mouth"
            )
            raise NetError(NODES, nodes[k, LINE], text)
    first = int(np.flatnonzero(role == CORNER)[0])
    found = [first, beside[first][0]]
    while found[-1] != first:
        before, here = found[-2:]
        found.append(next(other for other in beside[here] if other != before))
    found.pop()
    left = sorted(set(beside) - set(found))
    if left:
        text = f"node {names[left[0]]} is on another closed line than the rest of the mouth; expected one rim"
        raise NetError(NODES, nodes[left[0], LINE], text)
    x, y = nodes[found, PLACE], nodes[found, PLACE + 1]
    turns = float(x @ np.roll(y, -1) - np.roll(x, -1) @ y)
    return np.array(found if turns > 0.0 else [first, *found[:0:-1]])


def _surrounds(rim: Floats) -> bool:
    """Whether a closed line goes once round the middle."""
    angle = np.unwrap(np.arctan2(*np.vstack([rim, rim[:1]]).T[::-1]))
    return bool(abs(abs(angle[-1] - angle[0]) - 2.0 * math.pi) < 1e-6)


def _in_one_piece(nodes: Floats, names: Ints, near: list[list[int]], first: int) -> None:
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    ends = np.array([(a, b) for a, others in enumerate(near) for b in others])
    threads = csr_array((np.ones(len(ends)), (ends[:, 0], ends[:, 1])), shape=(len(names), len(names)))
    _, piece = connected_components(threads, directed=False)
    left = np.flatnonzero(piece != piece[first])
    if len(left):
        raise NetError(NODES, nodes[left[0], LINE], f"no threads lead from node {names[left[0]]} to the mouth")
