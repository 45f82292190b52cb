"""How a net of one's own stands in memory: nodes in rows, threads in strips (see `planes`), in the order of its files.

Threads that follow one another in their file, from and to nodes that go up in step, are a strip, as far as they are
alike. Nodes that a strip reaches over stand in one row, so a net that is written row by row stands as it would if it
were one of ours. Where most threads do not follow one another so (they are written node by node, say, or in no order)
they are sorted first. Where the nodes too are in no order they stand along the lines in which threads run on (the
outputs count them as their file does); in a net without such lines the rows are full, and many strips have one lane.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from fmu_src.net_capture.nets.own_graph import CLOSE, OwnGraph
from fmu_src.net_capture.planes import LONGEST_ROW

Floats = npt.NDArray[np.float64]
EMPTY = 2.0
"""Slots for each node from which on rows are filled up."""
DISORDER = 0.5
"""Strips for each thread from which on the threads are sorted, and then the nodes."""
ORDERLY = 0.2
"""Strips for each thread with which no better order of the nodes is looked for."""
NEAR = 0.25
"""Of a thread's length, by which the nodes of a line lie apart across it."""
WAYS = 4
"""Directions of threads along which nodes may stand in lines."""

HALF_WORD = 32
ROW, COLUMN = 0, 1
A_ROW, A_COLUMN, B_ROW, B_COLUMN, LANES_LOW, LANES_HIGH, SPAN, INNER_ROW, INNER_COLUMN, OF = range(10)
"""Columns of the strips: row and column of both ends of lane 0; the lanes that are threads, in two halves; lanes from
the first to the last; where the inner nodes of cut threads begin, in the first of their rows; a thread of it."""
STRIP_COLUMNS = 10


class Rows(NamedTuple):
    """Where everything stands.

    slots       row and column of every node, (n, 2)
    strips      (q, STRIP_COLUMNS)
    longest     nodes of the longest row
    rows        of nodes
    inner       rows of one inner node each of all threads, where they are cut
    """

    slots: npt.NDArray[np.int64]
    strips: npt.NDArray[np.int64]
    longest: int
    rows: int
    inner: int


@lru_cache(maxsize=16)
def rows_of(graph: OwnGraph) -> Rows:
    """Rows and strips of a graph."""
    alike, count = _alike(graph), len(graph.names)
    found, rank = _rows(graph.ends, alike, count), np.arange(count)
    if len(found.strips) > DISORDER * len(graph.ends):
        for order in orders_of(graph):
            other = np.argsort(order)
            rows = _rows(other[graph.ends], alike, count)
            if len(rows.strips) < len(found.strips):
                found, rank = rows, other
            if len(found.strips) <= ORDERLY * len(graph.ends):
                break
    return found._replace(slots=found.slots[rank])


def orders_of(graph: OwnGraph) -> Iterator[npt.NDArray[np.int64]]:
    """Orders in which the nodes may stand in lines of threads: along the ways that most threads run, seen through the
    mouth, and round the axis and towards it."""
    places = graph.places[:, :2]
    ways = places[graph.ends[:, 1]] - places[graph.ends[:, 0]]
    lengths = np.linalg.norm(ways, axis=1)
    near = NEAR * float(np.median(lengths))
    angles = np.degrees(np.arctan2(ways[:, 1], ways[:, 0])) % 180.0
    number = np.round(angles).astype(np.int64) % 180
    many = np.bincount(number, minlength=180)
    for most in np.argsort(-many, kind="stable")[: min(WAYS, np.count_nonzero(many))].tolist():
        turned = 2.0 * np.radians(angles[number == most])
        angle = 0.5 * math.atan2(float(np.sin(turned).mean()), float(np.cos(turned).mean()))
        along = np.array([math.cos(angle), math.sin(angle)])
        yield _in_lines(places @ along, places @ (along[1], -along[0]), near)
    radius, bearing = np.linalg.norm(places, axis=1), np.arctan2(places[:, 1], places[:, 0])
    yield _in_lines(bearing, radius, near)
    yield _in_lines(radius, bearing, near / float(radius.max()))


def _in_lines(along: Floats, across: Floats, near: float) -> npt.NDArray[np.int64]:
    """Order of nodes line by line; those of a line differ by less than that from one to the next."""
    order = np.argsort(across, kind="stable")
    line = np.empty(len(order), dtype=np.int64)
    line[order] = np.cumsum(np.diff(across[order], prepend=across[order[0]]) > near)
    return np.lexsort((along, line))


def _rows(given: npt.NDArray[np.int64], alike: Sequence[int], count: int) -> Rows:
    """Rows and strips of so many nodes in their order, with threads between these ends."""
    ends = given.tolist()
    order: Sequence[int] = range(len(ends))
    runs = _runs(ends, order, alike, np.zeros((count, 2), dtype=np.int64))
    if len(runs) <= DISORDER * len(ends):
        lengths = _row_lengths(count, ends, runs)
    else:
        upward = np.sort(given, axis=1)
        ends, order = upward.tolist(), np.lexsort((upward[:, 0], upward[:, 1] - upward[:, 0], np.array(alike))).tolist()
        lengths = _threaded(count, upward)
    slots = _slots(lengths)
    longest = int(slots[:, COLUMN].max()) + 1
    if (slots[-1, ROW] + 1) * longest > EMPTY * len(slots):
        slots = _slots([count])
        longest = int(slots[:, COLUMN].max()) + 1
    found, row, column = [], 0, 0
    for run in _runs(ends, order, alike, slots):
        a, b = ends[run[0]]
        lanes = [ends[k][0] - a for k in run]
        word = sum(1 << lane for lane in lanes)
        span = lanes[-1] + 1
        if column + span > longest:
            row, column = row + 1, 0
        halves = word & (1 << HALF_WORD) - 1, word >> HALF_WORD
        found.append([*slots[a], *slots[b], *halves, span, row, column, run[0]])
        column += span
    return Rows(slots, np.array(found, dtype=np.int64), longest, int(slots[-1, ROW]) + 1, row + 1)


def _alike(graph: OwnGraph) -> list[int]:
    """A number for every thread; those alike have the same, but for rounding of their lengths."""
    kinds: dict[tuple[float, ...], list[tuple[float, int]]] = {}
    found, last = [], 0
    for length, told in zip(graph.lengths.tolist(), graph.told.tolist(), strict=True):
        there = kinds.setdefault(tuple(told), [])
        number = next((n for near, n in there if abs(near - length) <= CLOSE * near), None)
        if number is None:
            number, last = last, last + 1
            there.append((length, number))
        found.append(number)
    return found


def _runs(
    ends: Sequence[Sequence[int]], order: Sequence[int], alike: Sequence[int], slots: npt.NDArray[np.int64]
) -> list[list[int]]:
    """Threads that are a strip each: consecutive in that order, alike, going up in step at both ends within a row."""
    rows = slots[:, ROW].tolist()
    found: list[list[int]] = []
    for k in order:
        a, b = ends[k]
        if found:
            run = found[-1]
            first_a, first_b = ends[run[0]]
            step = a - ends[run[-1]][0]
            if (
                0 < step == b - ends[run[-1]][1]
                and a - first_a < LONGEST_ROW
                and alike[k] == alike[run[0]]
                and rows[a] == rows[first_a]
                and rows[b] == rows[first_b]
            ):
                run.append(k)
                continue
        found.append([k])
    return found


def _row_lengths(count: int, ends: Sequence[Sequence[int]], runs: Sequence[Sequence[int]]) -> list[int]:
    """Nodes of each row: none ends between two nodes that one end of a strip reaches over."""
    held = np.zeros(count + 1, dtype=np.int64)
    for run in runs:
        for end in (0, 1):
            held[ends[run[0]][end]] += 1
            held[ends[run[-1]][end]] -= 1
    bounds = [0, *(np.flatnonzero(np.cumsum(held)[: count - 1] == 0) + 1).tolist(), count]
    return [b - a for a, b in itertools.pairwise(bounds)]


def _threaded(count: int, ends: npt.NDArray[np.int64]) -> list[int]:
    """Nodes of each row: in one stand nodes of which each has a thread to the next in the file."""
    begins = np.ones(count + 1, dtype=bool)
    begins[ends[ends[:, 1] - ends[:, 0] == 1, 1]] = False
    return [int(length) for length in np.diff(np.flatnonzero(begins))]


def _slots(lengths: Sequence[int]) -> npt.NDArray[np.int64]:
    """Row and column of every node; a row of more than `LONGEST_ROW` stands in several pieces."""
    found, row = [], 0
    for length in lengths:
        pieces = math.ceil(length / LONGEST_ROW)
        piece = math.ceil(length / pieces)
        found += [(row + k // piece, k % piece) for k in range(length)]
        row += math.ceil(length / piece)
    return np.array(found, dtype=np.int64)
