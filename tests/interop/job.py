"""What a tool is asked to do with an FMU, and the frame of the programs that do it.

Numbers travel as JSON, which Python writes and reads to the last bit.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path

Value = float | int | bool
Row = dict[str, Value]


@dataclass(frozen=True)
class Job:
    """A run of one FMU from time zero in equal steps.

    fmu, identifier, guid   path, and what its model description says
    step, steps             communication step [s] and their number
    kinds, references       FMI type and value reference of every variable by name
    parameters              by name, in the type of the variable
    commands                (step, input, value): the input is set before that step, counted from 0, and stays
    looks                   after how many steps all outputs are read, ascending; the last is the end
    outputs                 names of all outputs
    """

    fmu: str
    identifier: str
    guid: str
    step: float
    steps: int
    kinds: Mapping[str, str]
    references: Mapping[str, int]
    parameters: Mapping[str, Value]
    commands: Sequence[tuple[int, str, Value]]
    looks: Sequence[int]
    outputs: Sequence[str]

    def of_kind(self, kind: str) -> list[str]:
        """The outputs of one FMI type."""
        return [name for name in self.outputs if self.kinds[name] == kind]

    def due(self, step: int) -> Row:
        """Inputs to be set before a step."""
        return {name: value for at, name, value in self.commands if at == step}


def write(path: Path, jobs: Sequence[Job]) -> None:
    path.write_text(json.dumps([asdict(job) for job in jobs]))


def serve(distribution: str, run: Callable[[Job], list[Row]]) -> None:
    """Do the jobs of the file given first on the command line; `run` gives a row of outputs for each look."""
    jobs, found = (Path(argument) for argument in sys.argv[1:3])
    rows = [run(Job(**job)) for job in json.loads(jobs.read_text())]
    found.write_text(json.dumps({"version": version(distribution), "rows": rows}))
