"""The net at evenly spaced instants of a capture, for a replay: where every node is, and what every thread bears.

    replay_nodes.parquet     time, node, position
    replay_threads.parquet   time, thread, its two nodes, tension

Positions and tensions are kept in single precision: 4 um at 60 m. An FMU without outputs for its threads leaves
positions alone.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

Single = npt.NDArray[np.float32]
Whole = npt.NDArray[np.int64]

FRAMES_PER_SECOND = 25.0
"""Of a replay at the speed of the capture."""
FEWEST = 300
"""Frames of the whole phase, however short it is, as far as there are macro steps for them."""
AT = 1e-9
"""How far before its instant a frame may be taken [s]."""


def suits(duration: float, macro_step: float) -> float:
    """Time from frame to frame that suits a phase [s]: 25 a second, more of one that is over soon."""
    return max(macro_step, min(1.0 / FRAMES_PER_SECOND, duration / FEWEST))


@dataclass
class Frames:
    """Frames of a net, at the first communication point at or after every multiple of `every` [s].

    times       of each [s]
    nodes       positions (nodes, 3) [m] of each
    tensions    (threads,) [N] of each; empty where they are not told
    ends        numbers of the two nodes of each thread, counted from 1, (threads, 2)
    """

    every: float
    times: list[float] = field(default_factory=list)
    nodes: list[Single] = field(default_factory=list)
    tensions: list[Single] = field(default_factory=list)
    ends: Whole = field(default_factory=lambda: np.zeros((0, 2), dtype=np.int64))
    _next: int = 0

    def due(self, time: float) -> bool:
        """Whether to take one at this communication point; asked once for each."""
        if time < self._next * self.every - AT:
            return False
        self._next = math.floor((time + AT) / self.every) + 1
        return True

    def add(self, time: float, positions: npt.NDArray[np.float64], tensions: npt.NDArray[np.float64]) -> None:
        """positions (nodes, 3) [m], tensions (threads,) [N]"""
        self.times.append(time)
        self.nodes.append(positions.astype(np.float32))
        self.tensions.append(tensions[: len(self.ends)].astype(np.float32))

    def as_kept(self) -> dict[str, Any]:
        """All of it as plain data and bytes."""
        return {
            "times": list(self.times),
            "nodes": np.array(self.nodes, dtype=np.float32).tobytes(),
            "tensions": np.array(self.tensions, dtype=np.float32).tobytes(),
            "ends": self.ends.tolist(),
            "next": self._next,
        }

    def take_up(self, kept: Mapping[str, Any]) -> None:
        """Hold what `as_kept` says, and go on in the same rhythm."""
        self.times, self._next = list(kept["times"]), int(kept["next"])
        self.ends = np.array(kept["ends"], dtype=np.int64).reshape(-1, 2)
        count = max(len(self.times), 1)
        self.nodes = list(np.frombuffer(kept["nodes"], dtype=np.float32).reshape(count, -1, 3).copy())[
            : len(self.times)
        ]
        tensions = np.frombuffer(kept["tensions"], dtype=np.float32).reshape(count, len(self.ends)).copy()
        self.tensions = list(tensions)[: len(self.times)]
