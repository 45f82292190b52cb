"""The run folder: everything a run leaves, written whole or not at all.

    summary.json  provenance.json  scene.toml  fmus/*.fmu  ledger.json  ledger.csv
    PHASE.parquet  nodes.parquet  force_map.parquet  tugs.parquet  removal_without_recoil_tugs.parquet
    replay_nodes.parquet  replay_threads.parquet
    states/*.state  *.png

Columns carry their unit in the field metadata of the Parquet file, and in `df.attrs["units"]` where pandas reads it; in
a CSV the unit stands in the header. An output called `time` is in the column `output.time`, beside that of our own.
"""

from __future__ import annotations

import csv
import importlib.metadata
import json
import math
import os
import platform
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from dcone_cosim import state_file
from dcone_cosim.drafts import PROVENANCE, contents
from dcone_cosim.frames import Frames
from dcone_cosim.phases import force_map, kind_of
from dcone_cosim.recorder import Snapshots, TugLog
from dcone_cosim.results import Handover, PhaseResult, RunResult
from dcone_cosim.scenes.kept import keep
from dcone_cosim.states import KeptState

if TYPE_CHECKING:
    import pyarrow as pa

PACKAGES = (
    *("dcone-cosim", "numpy", "fmpy", "astropy", "tomlkit", "pyarrow", "matplotlib", "typer"),
    *("numba", "llvmlite", "ziglang"),
)


FORCE_MAP = "force_map"
NODES = "nodes"
"""Name of the table of the net's knots."""
REPLAY_NODES, REPLAY_THREADS = "replay_nodes", "replay_threads"
"""Names of the tables of a replay."""
OF_KNOTS = (NODES, REPLAY_THREADS)
"""How the names of tables end that have a row for each knot or thread and instant."""


def default_folder(scene: str) -> Path:
    return Path("runs") / f"{scene}-{datetime.now().strftime('%Y%m%dT%H%M%S')}"


def fill(
    folder: Path,
    run: RunResult,
    fmus: Mapping[str, Mapping[str, Any]],
    summary: Mapping[str, Any],
    started: datetime,
    with_csv: bool = False,
    draw: Callable[[Path], Any] | None = None,
) -> None:
    """Put everything into the folder, and what the run was made from, so that it can be made again."""
    import pyarrow.parquet

    keep(run.scene, folder)
    for name, table in tables_of(run):
        pyarrow.parquet.write_table(table, folder / f"{name}.parquet")
        if with_csv:
            _write_csv(table, folder / f"{name}.csv")
    for place, (name, handover) in enumerate(run.handovers.items()):
        _write_ledger(handover, folder / ledger_file(place, name))
    states = [_write_state(state, folder) for state in run.states]
    _write_json(folder / "summary.json", summary)
    if draw is not None:
        draw(folder)
    files = sorted({*contents(folder), PROVENANCE})
    _write_json(folder / PROVENANCE, provenance(run, fmus, started) | {"states": states, "files": files})


def _write_state(state: KeptState, folder: Path) -> dict[str, Any]:
    """Write a kept state; returns what the provenance tells of it."""
    name = state_file.name_of(state)
    (folder / name).parent.mkdir(exist_ok=True)
    about = {"phase": state.phase, "asked": state.asked, "time": state.time, "rows": state.rows}
    return {"file": name, "sha256": state_file.write(state, folder / name), **about}


def histories_of(run: Path) -> dict[str, int]:
    """The tables of a run's folder but for those with a row for each knot or thread, and how many values each has."""
    import pyarrow.parquet

    names = sorted(path.stem for path in run.glob("*.parquet") if not path.stem.endswith(OF_KNOTS))
    told = ((name, pyarrow.parquet.read_metadata(run / f"{name}.parquet")) for name in names)
    return {name: meta.num_rows * meta.num_columns for name, meta in told}


def as_csv(run: Path, name: str, place: Path) -> str:
    """A table of a run's folder as CSV in another; its name there.

    Checked  tests/report/test_page.py
    """
    import pyarrow.parquet

    _write_csv(pyarrow.parquet.read_table(run / f"{name}.parquet"), place / f"{name}.csv")
    return f"{name}.csv"


def _write_csv(table: pa.Table, path: Path) -> None:
    import pyarrow.csv

    pyarrow.csv.write_csv(table.rename_columns([csv_head(f) for f in table.schema]), path)


def csv_head(field: pa.Field) -> str:
    """Head of a column in a CSV: its name, with its unit if it has one."""
    unit = (field.metadata or {}).get(b"unit", b"1").decode()
    return str(field.name) if unit == "1" else f"{field.name} [{unit}]"


def _write_json(path: Path, content: Any) -> None:
    path.write_text(as_json(content) + "\n", encoding="utf-8")


def as_json(content: Any) -> str:
    """JSON that every reader takes: a number that is not finite becomes the text "nan", "inf" or "-inf"."""
    return json.dumps(_plain(content), indent=1, allow_nan=False)


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic | np.ndarray):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {str(key): _plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else str(value)
    return value if value is None or isinstance(value, str | int) else str(value)


def _table(columns: Sequence[tuple[str, str, Any]], **about: Mapping[str, str]) -> pa.Table:
    """columns: name, unit, values; about: further metadata of a column, by its name"""
    import pyarrow as pa

    arrays = [_arrow(np.asarray(values)) for _, _, values in columns]
    fields = [
        pa.field(name, array.type, metadata={"unit": unit, **about.get(name, {})})
        for (name, unit, _), array in zip(columns, arrays, strict=True)
    ]
    attributes = {"units": {name: unit for name, unit, _ in columns}} | {
        name: dict(more) for name, more in about.items()
    }
    # pandas takes `DataFrame.attrs` from here
    return pa.Table.from_arrays(arrays, schema=pa.schema(fields, {"PANDAS_ATTRS": json.dumps(attributes)}))


def _arrow(values: npt.NDArray[Any]) -> Any:
    """An arrow array over the memory of a numpy one; `pyarrow.array` would import pandas first, half a second."""
    import pyarrow as pa

    if values.dtype == np.bool_:
        return pa.Array.from_buffers(
            pa.bool_(), len(values), [None, pa.py_buffer(np.packbits(values, bitorder="little"))]
        )
    if values.dtype == np.float32:
        return pa.Array.from_buffers(pa.float32(), len(values), [None, pa.py_buffer(np.ascontiguousarray(values))])
    kind = pa.int64() if np.issubdtype(values.dtype, np.integer) else pa.float64()
    contiguous = np.ascontiguousarray(values, dtype=np.int64 if kind == pa.int64() else np.float64)
    return pa.Array.from_buffers(kind, len(values), [None, pa.py_buffer(contiguous)])


def tables_of(run: RunResult) -> Iterator[tuple[str, pa.Table]]:
    """Every table of a run by its name."""
    for name, result in run.phases.items():
        kind, clock = kind_of(name), kind_of(name).clock(run)
        yield name, phase_table(result, clock)
        if result.snapshots.times:
            yield f"{kind.prefix}{NODES}", nodes_table(result.snapshots, clock)
        if result.frames is not None and result.frames.times:
            yield f"{kind.prefix}{REPLAY_NODES}", replay_nodes_table(result.frames, clock)
            if len(result.frames.ends):
                yield f"{kind.prefix}{REPLAY_THREADS}", replay_threads_table(result.frames, clock)
        if result.tugs is not None:
            yield kind.tugs_file, tugs_table(result.tugs, clock)
        cells = force_map.of_run(run, name)
        if cells is not None:
            yield f"{kind.prefix}{FORCE_MAP}", force_table(cells)
        if result.passive:
            yield f"{name}_passive_safety", passive_table(result, clock)
    for name, result in run.comparisons.items():
        if result.tugs is not None:
            yield f"{name}_without_recoil_tugs", tugs_table(result.tugs, kind_of(name).clock(run))


def phase_table(result: PhaseResult, clock: str) -> pa.Table:
    """One row per communication point; `clock` says what its time is counted from."""
    recorder = result.recorder
    return _table(
        [(name, recorder.units[name], recorder.column(name)) for name in recorder.names], time={"clock": clock}
    )


def nodes_table(snapshots: Snapshots, clock: str) -> pa.Table:
    """One row per node and snapshot: time, node counted from 1, position."""
    positions = np.concatenate(snapshots.nodes)
    counts = [len(nodes) for nodes in snapshots.nodes]
    columns = [
        ("time", "s", np.repeat(snapshots.times, counts)),
        ("node", "1", np.concatenate([np.arange(1, count + 1) for count in counts])),
    ]
    columns += [(f"position[{i + 1}]", "m", np.ascontiguousarray(positions[:, i])) for i in range(3)]
    return _table(columns, time={"clock": clock})


def replay_nodes_table(frames: Frames, clock: str) -> pa.Table:
    """One row per node and frame: time, node counted from 1, position in single precision."""
    positions = np.array(frames.nodes)
    count = positions.shape[1]
    columns = [
        ("time", "s", np.repeat(frames.times, count)),
        ("node", "1", np.tile(np.arange(1, count + 1), len(frames.times))),
    ]
    columns += [(f"position[{i + 1}]", "m", positions[:, :, i].ravel()) for i in range(3)]
    return _table(columns, time={"clock": clock})


def replay_threads_table(frames: Frames, clock: str) -> pa.Table:
    """One row per thread and frame: time, thread counted from 1, its two nodes, tension in single precision."""
    count, times = len(frames.ends), len(frames.times)
    return _table(
        [
            ("time", "s", np.repeat(frames.times, count)),
            ("thread", "1", np.tile(np.arange(1, count + 1), times)),
            ("node[1]", "1", np.tile(frames.ends[:, 0], times)),
            ("node[2]", "1", np.tile(frames.ends[:, 1], times)),
            ("tension", "N", np.array(frames.tensions).ravel()),
        ],
        time={"clock": clock},
    )


def force_table(cells: force_map.Cells) -> pa.Table:
    """One row per cell of the target: face, middle in body axes, impulse and largest force."""
    columns = [("cell", "1", np.arange(1, len(cells.impulse) + 1)), ("face", "1", cells.face)]
    columns += [(f"position[{i + 1}]", "m", np.ascontiguousarray(cells.middle[:, i])) for i in range(3)]
    return _table([*columns, ("impulse", "N.s", cells.impulse), ("peak", "N", cells.peak)])


def tugs_table(tugs: TugLog, clock: str) -> pa.Table:
    """One row per tug; `clock` says what its time is counted from."""
    rows = np.array([(number, *tugs.rows[number]) for number in sorted(tugs.rows)]).reshape(-1, 4)
    return _table(
        [
            ("tug", "1", rows[:, 0].astype(np.int64)),
            ("time", "s", rows[:, 1]),
            ("peak", "N", rows[:, 2]),
            ("speed", "m/s", rows[:, 3]),
        ],
        time={"clock": clock},
    )


def passive_table(result: PhaseResult, clock: str) -> pa.Table:
    """One row per instant at which the thrust was stopped and the line cut; NaN where that could not be shown."""

    def column(what: str, field: str) -> npt.NDArray[np.float64]:
        found = [getattr(instant, what) for instant in result.passive]
        return np.array([math.nan if near is None else getattr(near, field) for near in found])

    return _table(
        [
            ("time", "s", np.array([instant.time for instant in result.passive])),
            ("separation", "m", np.array([instant.separation for instant in result.passive])),
            ("stopped.least_distance", "m", column("stopped", "distance")),
            ("stopped.after", "s", column("stopped", "after")),
            ("cut.least_distance", "m", column("cut", "distance")),
            ("cut.after", "s", column("cut", "after")),
        ],
        time={"clock": clock},
    )


def ledger_file(place: int, phase: str) -> str:
    """Name of the file of a hand-over: the first of a run, or a later one."""
    return f"ledger_{phase}.json" if place else "ledger.json"


def _write_ledger(handover: Handover, path: Path) -> None:
    """What was handed over, as JSON, and its ledger once more as CSV."""
    _write_json(path, handover.told())
    rows = [row.as_dict() for row in handover.rows]
    if rows:
        with path.with_suffix(".csv").open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, fieldnames=list(rows[0]))
            writer.writeheader()
            writer.writerows(rows)


def versions() -> dict[str, str]:
    """Of the packages that matter."""
    found = {}
    for package in PACKAGES:
        try:
            found[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            found[package] = "not installed"
    return found


def provenance(run: RunResult, fmus: Mapping[str, Mapping[str, Any]], started: datetime) -> dict[str, Any]:
    """What made these numbers: versions, machine, FMUs, every value that a model was given, and the time it took.

    `dcone run` on the folder makes the run again from the scene that is kept in it; this says what that scene came to.
    Values are SI; `given` are those that the master set, `handed_over` those of them that the scene does not say.
    """
    phases = {}
    settings = {phase.name: phase for phase in run.scene.phases}
    for name, result in run.phases.items():
        phase, given = settings[name], run.given.get(name, {})
        phases[name] = {
            **fmus.get(name, {}),
            "terms": dict(phase.main.terms),
            "start": {"value": result.start, "unit": "s"},
            "origin": {"value": result.origin, "unit": "s"},
            "macro_step": {"value": phase.macro_step, "unit": "s"},
            "duration": {"value": phase.duration, "unit": "s"},
            "options": {} if phase.options is None else vars(phase.options),
            "steps": result.steps,
            "cpu": {"value": result.cpu, "unit": "s"},
            "wall": {"value": result.wall, "unit": "s"},
            "parameters": run.parameters.get(name, {}),
            "inputs": run.inputs.get(name, {}),
            "given": given,
            "handed_over": {n: value for n, value in given.items() if phase.main.parameters.get(n) != value},
            "left": run.left.get(name, {}),
            "came_out": _came_out(result),
        }
    return {
        "scene": run.scene.name,
        "scene_sha256": run.scene.sha256,
        "settings": [override.argument for override in run.scene.places.overrides],
        "handoff": vars(run.scene.handoff),
        "handed_over_at": {name: it.told()["time"] for name, it in run.handovers.items()},
        "status": run.status,
        "message": run.message,
        "exit_code": run.exit_code,
        "started": started.isoformat(),
        "finished": datetime.now(UTC).isoformat(),
        "python": sys.version.split()[0],
        "platform": platform.platform(),
        "machine": platform.machine(),
        "processors": os.cpu_count(),
        "packages": versions(),
        "phases": phases,
        "without_recoil": {name: _compared(result) for name, result in run.comparisons.items()},
        "attained": {name: vars(attained) for name, attained in run.attained.items()},
        "gone_on": dict(run.gone_on),
    }


def _came_out(result: PhaseResult) -> dict[str, Any]:
    """How a phase came out, beside its tables."""
    located = None if result.located is None else {"value": result.located, "unit": "s"}
    return {
        "outcome": result.outcome,
        "located": located,
        "located_by": result.located_by,
        "ended_by": result.ended_by,
        "ended_at": {"value": result.ended_at, "unit": "s"},
        "tugs": None if result.tugs is None else {"count": result.tugs.count, "ring": result.tugs.ring},
        "coupling": dict(result.coupling),
    }


def _compared(result: PhaseResult) -> dict[str, Any]:
    """What is told of a phase run for comparison, beside its tugs: whether its line began taut, and its extremes."""
    recorder = result.recorder
    row = {}
    if len(recorder) and "tether.taut" in recorder:
        row["tether.taut"] = float(recorder["tether.taut"][0])
    if len(recorder) and "tether.tension_peak" in recorder:
        row["tether.tension_peak"] = float(np.max(recorder["tether.tension_peak"]))
    return {"tugs": _came_out(result)["tugs"], "row": row}
