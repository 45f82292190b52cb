"""What must hold of a phase however stiff or extreme it is: conservation laws and closed forms, from both sides.

Each kind of phase has its own (`phases.phase.Phase.criteria`). They ask what came out alone, never how it was
computed, so that a run in this process and an FMU from elsewhere can be asked as well.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dcone_cosim.quantities import Array
from dcone_cosim.results import RunResult
from dcone_cosim.scene.data import PhaseScene

Tug = tuple[float, float, float]


@dataclass(frozen=True)
class Evidence:
    """What a phase left.

    columns    of the outputs by name, a value at each communication point, and the `time` [s]
    values     of parameters and inputs by FMI name, SI
    terms      that a model of ours has, by group; none of an FMU from elsewhere
    duration   that it was to last [s]
    tugs       time [s], peak [N] and speed [m/s] of each, the oldest first
    nodes      positions of all nodes [m] (n, 3) at some of the communication points, by the place of that in `columns`
    """

    columns: Mapping[str, Array]
    values: Mapping[str, float]
    terms: Mapping[str, str]
    duration: float
    tugs: Sequence[Tug] = ()
    nodes: Mapping[int, Array] = field(default_factory=dict)

    def vector(self, name: str, size: int = 3) -> Array:
        """Columns `name[1]` to `name[size]` side by side, shape (rows, size)."""
        return np.column_stack([self.columns[f"{name}[{i}]"] for i in range(1, size + 1)])

    def has(self, *names: str) -> bool:
        """Whether there are outputs of all these names, or vectors."""
        return all(name in self.columns or f"{name}[1]" in self.columns for name in names)


class Criterion(NamedTuple):
    """One of them, as a run meets it.

    key        its name for machines, by which an extreme asks for it
    label      what is measured, in words
    value      by how much it is missed
    unit       "1" for a share
    accurate   value up to which the run counts as accurate, and `stable` up to which as stable
    """

    key: str
    label: str
    value: float
    unit: str
    accurate: float
    stable: float


FINITE = "finite"


def finite(evidence: Evidence) -> Criterion:
    """Every output at every communication point is a number."""
    wrong = sum(int(np.count_nonzero(~np.isfinite(column))) for column in evidence.columns.values())
    wrong += sum(int(np.count_nonzero(~np.isfinite(nodes))) for nodes in evidence.nodes.values())
    return Criterion(FINITE, "outputs that are not finite", float(wrong), "1", 0.0, 0.0)


def rise(column: npt.NDArray[np.float64]) -> float:
    """How far a column comes above the least it was before."""
    return float(np.max(column - np.minimum.accumulate(column), initial=0.0))


def evidence_of(run: RunResult, phase: PhaseScene) -> Evidence:
    """What a phase of a run left."""
    result = run.phases[phase.name]
    recorder = result.recorder
    time = recorder["time"]
    nodes = {
        int(np.argmin(np.abs(time - at))): positions
        for at, positions in zip(result.snapshots.times, result.snapshots.nodes, strict=True)
    }
    tugs = [] if result.tugs is None else [result.tugs.rows[number] for number in sorted(result.tugs.rows)]
    values = {**run.parameters.get(phase.name, {}), **run.inputs.get(phase.name, {}), **phase.main.made}
    columns = {name: recorder[name] for name in recorder.names}
    return Evidence(columns, values, phase.main.terms, phase.duration, tugs, nodes)
