"""The markers of a capture, from a run that was just made or from the folder of one."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from dcone_cosim.errors import InputError
from dcone_cosim.files import regular
from dcone_cosim.results import RunResult
from dcone_cosim.tracks.simulated import Flown

CAPTURE = "capture"


def of_result(run: RunResult) -> Flown:
    """Of a run in memory, whose scene has a capture."""
    result = run.phases[CAPTURE]
    columns = {name: result.recorder[name] for name in result.recorder.names}
    return Flown(columns, result.snapshots.times, result.snapshots.nodes, run.parameters[CAPTURE])


def of_folder(folder: Path) -> Flown:
    """Of the folder of a run; `InputError` if it is none, or has no capture."""
    import pyarrow.parquet

    try:
        told = json.loads(regular(folder / "provenance.json").read_text(encoding="utf-8"))
        values = told["phases"][CAPTURE]["parameters"]
        table = pyarrow.parquet.read_table(folder / f"{CAPTURE}.parquet")
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"{folder} is not the folder of a run with a capture: {error}") from None
    columns = {name: np.asarray(table.column(name).to_numpy(), dtype=float) for name in table.column_names}
    shots: list[float] = []
    nodes = []
    if (folder / "nodes.parquet").is_file():
        kept = pyarrow.parquet.read_table(folder / "nodes.parquet")
        times = kept.column("time").to_numpy()
        places = np.column_stack([kept.column(f"position[{axis}]").to_numpy() for axis in (1, 2, 3)])
        shots = [float(time) for time in np.unique(times)]
        nodes = [places[times == time] for time in shots]
    return Flown(columns, shots, nodes, values)
