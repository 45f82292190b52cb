"""Columns of a phase, filled one row per communication point."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from dcone_cosim.fmu.component import VariableInfo

Row = npt.NDArray[np.float64]


FIRST_ROWS, MOST_ROWS = 256, 65536
"""Rows of a recorder's first block, and of the largest."""


TIME = "time"
"""Name of the first column."""


def _beside_time(names: Sequence[str]) -> dict[str, str]:
    """The column of each output: its name, or `output.time` for one that is called as the first column is."""
    shown = f"output.{TIME}"
    while shown in names:
        shown = f"output.{shown}"
    return {shown if name == TIME else name: name for name in names}


class Recorder:
    """Rows of numbers under fixed names, each with its unit and kind; the first column is the time [s].

    names    of the columns: those of the outputs, but for one that bears the name of the first column

    Kept in blocks of columns. Each block is as long as all before it, so that memory follows the rows there are, not
    the rows there might be, and no row is copied while the phase runs.
    """

    def __init__(self, names: Sequence[str], variables: Mapping[str, VariableInfo], expected_rows: int = 1) -> None:
        """expected_rows: rows that are likely, a hint for the first block"""
        columns = _beside_time(names)
        self.names = (TIME, *columns)
        self.units = {TIME: "s"} | {column: variables[name].unit for column, name in columns.items()}
        self.kinds = {TIME: "Real"} | {column: variables[name].kind for column, name in columns.items()}
        self._place = {name: i for i, name in enumerate(self.names)}
        self._blocks: list[Row] = []
        self._rows = self._full = 0
        self._open(min(max(expected_rows, 1), 4 * FIRST_ROWS))

    def _open(self, rows: int) -> None:
        """Begin a block; those before it are full."""
        self._full = self._rows
        self._block: Row = np.empty((len(self.names), rows))
        self._blocks.append(self._block)

    @classmethod
    def of(cls, columns: Mapping[str, tuple[str, str, Row]]) -> Recorder:
        """One that holds rows already: unit, kind and values of each column, the time first."""
        recorder = cls((), {})
        recorder.names = tuple(columns)
        recorder.units = {name: unit for name, (unit, _, _) in columns.items()}
        recorder.kinds = {name: kind for name, (_, kind, _) in columns.items()}
        recorder._place = {name: i for i, name in enumerate(recorder.names)}
        recorder._block = np.array([values for _, _, values in columns.values()], dtype=float)
        recorder._blocks = [recorder._block]
        recorder._rows = recorder._block.shape[1]
        return recorder

    def take_up(self, earlier: Recorder, rows: int) -> None:
        """Begin with the first rows of another one with the same columns."""
        self._block = np.empty((len(self.names), rows + min(max(rows, FIRST_ROWS), MOST_ROWS)))
        self._block[:, :rows] = [earlier[name][:rows] for name in self.names]
        self._blocks, self._rows, self._full = [self._block], rows, 0

    def __len__(self) -> int:
        return self._rows

    def __contains__(self, name: str) -> bool:
        return name in self._place

    def add(self, time: float, values: Row) -> None:
        at = self._rows - self._full
        if at == self._block.shape[1]:
            self._open(min(max(self._rows, FIRST_ROWS), MOST_ROWS))
            at = 0
        self._block[0, at] = time
        self._block[1:, at] = values
        self._rows += 1

    def __getitem__(self, name: str) -> Row:
        """One column."""
        place = self._place[name]
        latest: Row = self._block[place, : self._rows - self._full]
        if not self._full:
            return latest
        return np.concatenate([*(block[place] for block in self._blocks[:-1]), latest])

    def vector(self, name: str, size: int = 3) -> Row:
        """Columns `name[1]` to `name[size]` side by side, shape (rows, size)."""
        return np.column_stack([self[f"{name}[{i}]"] for i in range(1, size + 1)])

    def last(self) -> dict[str, float]:
        """The latest row by name, without the time."""
        return dict(zip(self.names[1:], self._block[1:, self._rows - self._full - 1].tolist(), strict=True))

    def column(self, name: str) -> npt.NDArray[np.float64] | npt.NDArray[np.int64] | npt.NDArray[np.bool_]:
        """One column in the type of its variable."""
        kind = self.kinds[name]
        if kind == "Real":
            return self[name]
        return self[name].astype(np.int64) if kind == "Integer" else self[name].astype(np.bool_)


class Snapshots:
    """Node positions at some of the communication points.

    times        record at the first communication point at or after each; empty: evenly thinned, at most `limit` kept
    """

    def __init__(self, times: Sequence[float] = (), limit: int = 64) -> None:
        self.times: list[float] = []
        self.nodes: list[Row] = []
        self._wanted = sorted(times)
        self._asked = bool(times)
        self._limit = limit
        self._stride = 1
        self._seen = 0

    def due(self, time: float, tolerance: float) -> bool:
        """Whether to record at this communication point; asked once for each."""
        if self._asked:
            due = False
            while self._wanted and self._wanted[0] <= time + tolerance:
                self._wanted.pop(0)
                due = True
            return due
        self._seen += 1
        return (self._seen - 1) % self._stride == 0

    def as_kept(self) -> dict[str, Any]:
        """All of it as plain data and bytes."""
        shapes = [list(nodes.shape) for nodes in self.nodes]
        nodes = np.concatenate([part.ravel() for part in self.nodes]) if self.nodes else np.zeros(0)
        return {
            "times": list(self.times),
            "shapes": shapes,
            "nodes": nodes.tobytes(),
            "wanted": list(self._wanted),
            "stride": self._stride,
            "seen": self._seen,
        }

    def take_up(self, kept: Mapping[str, Any]) -> None:
        """Hold what `as_kept` says, and go on in the same rhythm."""
        self.times, self.nodes, begin = list(kept["times"]), [], 0
        numbers = np.frombuffer(kept["nodes"])
        for rows, columns in kept["shapes"]:
            self.nodes.append(numbers[begin : begin + rows * columns].reshape(rows, columns).copy())
            begin += rows * columns
        self._wanted, self._stride, self._seen = list(kept["wanted"]), kept["stride"], kept["seen"]

    def add(self, time: float, positions: Row) -> None:
        """positions: (nodes, 3) [m]"""
        self.times.append(time)
        self.nodes.append(positions.copy())
        if not self._asked and len(self.times) > self._limit:
            self.times, self.nodes = self.times[::2], self.nodes[::2]
            self._stride *= 2


class TugLog:
    """Every tug once, gathered from the ring of the latest that the FMU keeps, by its running count."""

    def __init__(self, ring: int) -> None:
        self.ring = ring
        self.count = 0
        self.rows: dict[int, tuple[float, float, float]] = {}

    def update(self, count: int, latest: Row) -> None:
        """Take in those that are new, and the one before them, which may have grown.

        latest   time [s], peak [N], speed [m/s] of each tug in the ring, newest first, shape (ring, 3)
        """
        changed = min(count - self.count + 1, count, self.ring)
        self.count = count
        for place, (time, peak, speed) in enumerate(latest[:changed].tolist()):
            self.rows[count - place] = (time, peak, speed)

    def grow(self, newest: Sequence[float]) -> None:
        """The newest tug as it is by now: time [s], peak [N], speed [m/s]."""
        time, peak, speed = newest
        self.rows[self.count] = (time, peak, speed)

    def take_up(self, count: int, rows: Sequence[Sequence[float]]) -> None:
        """Hold these rows: number, time [s], peak [N], speed [m/s] of each."""
        self.count = int(count)
        self.rows = {int(number): (time, peak, speed) for number, time, peak, speed in rows}

    @property
    def newest(self) -> tuple[float, float, float] | None:
        """The tug that may still grow."""
        return self.rows.get(self.count)

    def forget_after(self, count: int, newest: tuple[float, float, float] | None) -> None:
        """Forget all after this count, and how the newest of then has grown since."""
        for number in range(count + 1, self.count + 1):
            self.rows.pop(number, None)
        self.count = count
        if newest is not None:
            self.rows[count] = newest

    @property
    def missed(self) -> int:
        """Tugs that left the ring before it was read: the macro step was too long to see them."""
        return self.count - len(self.rows)
