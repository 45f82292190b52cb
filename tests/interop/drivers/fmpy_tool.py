"""fmpy: `simulate_fmu` and nothing else."""

from __future__ import annotations

from typing import Any

import fmpy
import numpy as np

from tests.interop.job import Job, Row, serve

NUMPY = {"Real": np.float64, "Integer": np.int32, "Boolean": np.bool_}


def signals(job: Job) -> Any:
    """The commands as fmpy takes inputs: a table over time, with two lines where an input jumps."""
    if not job.commands:
        return None
    names = sorted({name for _, name, _ in job.commands})
    present: Row = dict.fromkeys(names, 0)
    lines: list[tuple[Any, ...]] = [(0.0, *present.values())]
    for at in sorted({at for at, _, _ in job.commands}):
        lines.append((at * job.step, *present.values()))
        present |= job.due(at)
        lines.append((at * job.step, *present.values()))
    lines.append((job.steps * job.step, *present.values()))
    columns = [("time", np.float64), *((name, NUMPY[job.kinds[name]]) for name in names)]
    return np.array(lines, dtype=columns)


def run(job: Job) -> list[Row]:
    found = fmpy.simulate_fmu(
        job.fmu,
        stop_time=job.steps * job.step,
        output_interval=job.step,
        start_values=dict(job.parameters),
        input=signals(job),
        output=list(job.outputs),
    )
    if len(found) != job.steps + 1:
        raise RuntimeError(f"{len(found)} rows, expected {job.steps + 1}")
    return [{name: found[name][look].item() for name in job.outputs} for look in job.looks]


if __name__ == "__main__":
    serve("fmpy", run)
