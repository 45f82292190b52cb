"""The run folder: everything a run leaves, written whole or not at all.

    summary.json  provenance.json  scene.toml  ledger.json  ledger.csv
    capture.parquet  nodes.parquet  removal.parquet  tugs.parquet  removal_without_recoil_tugs.parquet
    *.png

Columns carry their unit in the field metadata of the Parquet file; in a CSV the unit stands in the header. The folder
is filled under another name beside its place, forced to disk and renamed.
"""

from __future__ import annotations

import csv
import importlib.metadata
import json
import os
import platform
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet

from dcone_cosim.errors import InputError
from dcone_cosim.master import RunResult
from dcone_cosim.phases import PhaseResult
from dcone_cosim.recorder import Snapshots, TugLog

PACKAGES = (
    *("dcone-cosim", "numpy", "fmpy", "astropy", "pydantic", "pyarrow", "matplotlib", "typer"),
    *("numba", "llvmlite", "ziglang"),
)


def default_folder(scene: str) -> Path:
    return Path("runs") / f"{scene}-{datetime.now().strftime('%Y%m%dT%H%M%S')}"


def check_free(folder: Path, force: bool) -> None:
    """Refuse a place that is taken, before any work is done."""
    if folder.exists() and not force:
        raise InputError(f"{folder} already exists; choose another place with -o, or replace it with --force")
    if folder.exists() and not (folder / "provenance.json").exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise InputError(f"{folder} is not the folder of a run: --force will not replace it")
    above = next(p for p in folder.absolute().parents if p.exists())
    if not above.is_dir() or not os.access(above, os.W_OK):
        raise InputError(f"{folder} cannot be written: {above} is not a folder that may be written to")


@contextmanager
def atomic_folder(folder: Path) -> Iterator[Path]:
    """A folder to fill, which takes its name only when the block ends well; otherwise nothing is left."""
    folder = folder.absolute()
    made = [p for p in folder.parents if not p.exists()]
    folder.parent.mkdir(parents=True, exist_ok=True)
    draft = Path(tempfile.mkdtemp(prefix=f".{folder.name}.", dir=folder.parent))
    draft.chmod(0o755)
    try:
        yield draft
        for path in [*draft.rglob("*"), draft]:
            _to_disk(path)
        _put_in_place(draft, folder)
        _to_disk(folder.parent)
    except BaseException:
        shutil.rmtree(draft, ignore_errors=True)
        for parent in made:
            if parent.is_dir() and not any(parent.iterdir()):
                parent.rmdir()
        raise


def _put_in_place(draft: Path, folder: Path) -> None:
    if not folder.exists():
        draft.rename(folder)
        return
    old = Path(tempfile.mkdtemp(prefix=f".{folder.name}.old.", dir=folder.parent))
    folder.rename(old / folder.name)
    try:
        draft.rename(folder)
    except OSError:
        (old / folder.name).rename(folder)
        raise
    finally:
        shutil.rmtree(old, ignore_errors=True)


def _to_disk(path: Path) -> None:
    if os.name == "nt" and path.is_dir():
        return
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def write(
    run: RunResult,
    folder: Path,
    fmus: Mapping[str, Mapping[str, Any]],
    summary: Mapping[str, Any],
    started: datetime,
    with_csv: bool = False,
    draw: Callable[[Path], None] | None = None,
) -> None:
    """Write the run folder; `draw` adds the figures to the draft."""
    with atomic_folder(folder) as draft:
        (draft / "scene.toml").write_text(run.scene.text, encoding="utf-8")
        tables = dict(_tables(run))
        for name, table in tables.items():
            pyarrow.parquet.write_table(table, draft / f"{name}.parquet")
            if with_csv:
                headed = table.rename_columns([_headed(f) for f in table.schema])
                pyarrow.csv.write_csv(headed, draft / f"{name}.csv")
        if run.handoff is not None:
            _write_ledger(run, draft)
        _write_json(draft / "summary.json", summary)
        if draw is not None:
            draw(draft)
        _write_json(draft / "provenance.json", provenance(run, fmus, started))


def _headed(field: pa.Field) -> str:
    unit = (field.metadata or {}).get(b"unit", b"1").decode()
    return str(field.name) if unit == "1" else f"{field.name} [{unit}]"


def _write_json(path: Path, content: Any) -> None:
    path.write_text(json.dumps(content, indent=1, default=_plain, allow_nan=False) + "\n", encoding="utf-8")


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray):
        return value.tolist()
    return str(value)


def _table(columns: Sequence[tuple[str, str, Any]]) -> pa.Table:
    """columns: name, unit, values"""
    arrays = [_arrow(np.asarray(values)) for _, _, values in columns]
    fields = [
        pa.field(name, array.type, metadata={"unit": unit})
        for (name, unit, _), array in zip(columns, arrays, strict=True)
    ]
    return pa.Table.from_arrays(arrays, schema=pa.schema(fields))


def _arrow(values: npt.NDArray[Any]) -> Any:
    """An arrow array over the memory of a numpy one; `pyarrow.array` would import pandas first, half a second."""
    if values.dtype == np.bool_:
        return pa.Array.from_buffers(
            pa.bool_(), len(values), [None, pa.py_buffer(np.packbits(values, bitorder="little"))]
        )
    kind = pa.int64() if np.issubdtype(values.dtype, np.integer) else pa.float64()
    contiguous = np.ascontiguousarray(values, dtype=np.int64 if kind == pa.int64() else np.float64)
    return pa.Array.from_buffers(kind, len(values), [None, pa.py_buffer(contiguous)])


def _tables(run: RunResult) -> Iterator[tuple[str, pa.Table]]:
    for name, result in run.phases.items():
        yield name, phase_table(result)
        if result.snapshots.times:
            yield "nodes", nodes_table(result.snapshots)
        if result.tugs is not None:
            yield "tugs", tugs_table(result.tugs)
    if run.comparison is not None and run.comparison.tugs is not None:
        yield "removal_without_recoil_tugs", tugs_table(run.comparison.tugs)


def phase_table(result: PhaseResult) -> pa.Table:
    recorder = result.recorder
    return _table([(name, recorder.units[name], recorder.column(name)) for name in recorder.names])


def nodes_table(snapshots: Snapshots) -> pa.Table:
    """One row per node and snapshot: time, node counted from 1, position."""
    positions = np.concatenate(snapshots.nodes)
    counts = [len(nodes) for nodes in snapshots.nodes]
    columns = [
        ("time", "s", np.repeat(snapshots.times, counts)),
        ("node", "1", np.concatenate([np.arange(1, count + 1) for count in counts])),
    ]
    columns += [(f"position[{i + 1}]", "m", np.ascontiguousarray(positions[:, i])) for i in range(3)]
    return _table(columns)


def tugs_table(tugs: TugLog) -> pa.Table:
    rows = np.array([(number, *tugs.rows[number]) for number in sorted(tugs.rows)]).reshape(-1, 4)
    return _table(
        [
            ("tug", "1", rows[:, 0].astype(np.int64)),
            ("time", "s", rows[:, 1]),
            ("peak", "N", rows[:, 2]),
            ("speed", "m/s", rows[:, 3]),
        ]
    )


def _write_ledger(run: RunResult, draft: Path) -> None:
    record = run.handoff
    assert record is not None
    handed = record.handed
    rows = [row.as_dict() for row in record.rows]
    content = {
        "time": {"value": record.time, "unit": "s"},
        "located_by": record.located_by,
        "rows": rows,
        "cross_checks": [vars(check) for check in record.checks],
        "spin": {
            "dropped": {"value": float(np.linalg.norm(handed.joint.spin)), "unit": "N m s"},
            "attachment_speed": {"value": record.spin.attachment_speed, "unit": "m/s"},
            "tug_speed": {"value": record.spin.tug_speed, "unit": "m/s"},
            "tolerance": record.spin.tolerance,
        },
        "joint_body": {
            "mass": {"value": handed.joint.mass, "unit": "kg"},
            "position": {"value": handed.joint.position, "unit": "m"},
            "velocity": {"value": handed.joint.velocity, "unit": "m/s"},
            "spin": {"value": handed.joint.spin, "unit": "N m s"},
            "inertia": {"value": handed.joint.inertia, "unit": "kg m2"},
        },
        "set_in_removal": handed.parameters,
        "failure": record.failure,
    }
    _write_json(draft / "ledger.json", content)
    if rows:
        with (draft / "ledger.csv").open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, fieldnames=list(rows[0]))
            writer.writeheader()
            writer.writerows(rows)


def provenance(run: RunResult, fmus: Mapping[str, Mapping[str, Any]], started: datetime) -> dict[str, Any]:
    """What made these numbers: versions, machine, FMUs, every parameter, and the time it took."""
    versions = {}
    for package in PACKAGES:
        try:
            versions[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            versions[package] = "not installed"
    phases = {}
    settings = {phase.name: phase for phase in run.scene.phases}
    for name, result in run.phases.items():
        phase = settings[name]
        phases[name] = {
            "fmu": fmus.get(name, {}),
            "terms": dict(phase.terms),
            "macro_step": {"value": phase.macro_step, "unit": "s"},
            "duration": {"value": phase.duration, "unit": "s"},
            "steps": result.steps,
            "cpu": {"value": result.cpu, "unit": "s"},
            "wall": {"value": result.wall, "unit": "s"},
            "parameters": run.parameters.get(name, {}),
        }
    return {
        "scene": run.scene.name,
        "status": run.status,
        "message": run.message,
        "exit_code": run.exit_code,
        "started": started.isoformat(),
        "finished": datetime.now(UTC).isoformat(),
        "python": sys.version.split()[0],
        "platform": platform.platform(),
        "machine": platform.machine(),
        "processors": os.cpu_count(),
        "packages": versions,
        "phases": phases,
    }
