"""The run folder: everything a run leaves, written whole or not at all.

    summary.json  provenance.json  scene.toml  ledger.json  ledger.csv
    capture.parquet  nodes.parquet  removal.parquet  tugs.parquet  removal_without_recoil_tugs.parquet
    *.png

Columns carry their unit in the field metadata of the Parquet file; in a CSV the unit stands in the header. The folder
is filled under another name beside its place, forced to disk and renamed. A folder that came to be in its place
meanwhile is never touched: the results then go beside it under the next free name.
"""

from __future__ import annotations

import csv
import importlib.metadata
import itertools
import json
import math
import os
import platform
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from dcone_cosim.errors import InputError
from dcone_cosim.master import RunResult
from dcone_cosim.phases import PhaseResult
from dcone_cosim.recorder import Snapshots, TugLog

if TYPE_CHECKING:
    import pyarrow as pa

PACKAGES = (
    *("dcone-cosim", "numpy", "fmpy", "astropy", "tomlkit", "pyarrow", "matplotlib", "typer"),
    *("numba", "llvmlite", "ziglang"),
)


def default_folder(scene: str) -> Path:
    return Path("runs") / f"{scene}-{datetime.now().strftime('%Y%m%dT%H%M%S')}"


def check_free(folder: Path, force: bool) -> None:
    """Refuse a place that is taken, before any work is done; an empty folder is free."""
    if not _is_free(folder):
        if not force:
            raise InputError(f"{folder} already exists; choose another place with -o, or replace it with --force")
        if not _is_run(folder):
            raise InputError(f"{folder} is not the folder of a run: --force will not replace it")
    above = next(p for p in folder.absolute().parents if p.exists())
    if not above.is_dir() or not os.access(above, os.W_OK):
        raise InputError(f"{folder} cannot be written: {above} is not a folder that may be written to")


def _is_free(folder: Path) -> bool:
    if not os.path.lexists(folder):
        return True
    return folder.is_dir() and not folder.is_symlink() and not any(folder.iterdir())


def _is_run(folder: Path) -> bool:
    return folder.is_dir() and (folder / "provenance.json").exists()


class Draft:
    """The folder to fill, `path`, and, once it has taken its name, where that is: `folder`."""

    def __init__(self, path: Path, folder: Path) -> None:
        self.path, self.folder = path, folder


@contextmanager
def atomic_folder(folder: Path, force: bool = False) -> Iterator[Draft]:
    """A folder to fill, which takes its name only when the block ends well; otherwise nothing is left.

    force        replace a run of that name; otherwise what has the name by then keeps it, and the draft gets `name-2`
    """
    place = folder.absolute()
    made = [p for p in place.parents if not p.exists()]
    empty = place.is_dir() and _is_free(place)
    path = None
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        path = Path(tempfile.mkdtemp(prefix=f".{place.name[:100]}.", dir=place.parent))
        path.chmod(0o755)
        draft = Draft(path, folder)
        yield draft
        for file in [*path.rglob("*"), path]:
            _to_disk(file)
        if not (force and _replace(path, place)):
            draft.folder = folder.with_name(_take_name(path, place, empty).name)
        _to_disk(place.parent)
    except BaseException:
        if path is not None:
            shutil.rmtree(path, ignore_errors=True)
        for parent in made:
            with suppress(OSError):
                parent.rmdir()
        raise


def _replace(draft: Path, place: Path) -> bool:
    """Put the draft in the place of an earlier run, which stays if that fails; False when there is none."""
    if not _is_run(place):
        return False
    aside = Path(tempfile.mkdtemp(prefix=f".{place.name[:100]}.old.", dir=place.parent))
    old = aside / "old"
    try:
        place.rename(old)
        draft.rename(place)
    except BaseException:
        if old.exists() and not os.path.lexists(place):
            old.rename(place)
        raise
    finally:
        shutil.rmtree(aside, ignore_errors=True)
    return True


def _take_name(draft: Path, place: Path, empty: bool) -> Path:
    """Give the draft its name, or the first free one of `name-2`, `name-3`, ...: never one that something else has.

    Making an empty folder claims a name: it fails when there is anything, and a rename replaces nothing but an empty
    folder. `empty`: the place was an empty folder from the beginning, which need not be claimed.
    """
    for number in itertools.count(1):
        name = place if number == 1 else place.with_name(f"{place.name}-{number}")
        claimed = False
        try:
            if not (empty and number == 1 and name.is_dir()):
                name.mkdir()
                claimed = True
            if os.name == "nt":
                name.rmdir()
            draft.rename(name)
        except OSError:
            if claimed:
                with suppress(OSError):
                    name.rmdir()
            if not os.path.lexists(name):
                raise
        except BaseException:
            if claimed and draft.exists():
                with suppress(OSError):
                    name.rmdir()
            raise
        else:
            return name
    raise AssertionError("there is always a next number")


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
    draw: Callable[[Path], Any] | None = None,
    force: bool = False,
) -> Path:
    """Write the run folder, `draw` adding the figures; returns where it is: another name when this one was taken."""
    with atomic_folder(folder, force) as draft:
        fill(draft.path, run, fmus, summary, started, with_csv, draw)
    return draft.folder


def fill(
    folder: Path,
    run: RunResult,
    fmus: Mapping[str, Mapping[str, Any]],
    summary: Mapping[str, Any],
    started: datetime,
    with_csv: bool = False,
    draw: Callable[[Path], Any] | None = None,
) -> None:
    """Put everything into the folder."""
    import pyarrow.csv
    import pyarrow.parquet

    source = "SystemStructure.ssd" if run.scene.source.lower().endswith(".ssp") else "scene.toml"
    (folder / source).write_text(run.scene.text, encoding="utf-8")
    for name, table in _tables(run):
        pyarrow.parquet.write_table(table, folder / f"{name}.parquet")
        if with_csv:
            headed = table.rename_columns([_headed(f) for f in table.schema])
            pyarrow.csv.write_csv(headed, folder / f"{name}.csv")
    if run.handoff is not None:
        _write_ledger(run, folder)
    _write_json(folder / "summary.json", summary)
    if draw is not None:
        draw(folder)
    _write_json(folder / "provenance.json", provenance(run, fmus, started))


def _headed(field: pa.Field) -> str:
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
    return pa.Table.from_arrays(arrays, schema=pa.schema(fields))


def _arrow(values: npt.NDArray[Any]) -> Any:
    """An arrow array over the memory of a numpy one; `pyarrow.array` would import pandas first, half a second."""
    import pyarrow as pa

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
            yield "tugs", tugs_table(result.tugs, _clock(result))
    if run.comparison is not None and run.comparison.tugs is not None:
        yield "removal_without_recoil_tugs", tugs_table(run.comparison.tugs, _clock(run.comparison))


def _clock(result: PhaseResult) -> str:
    """Which clock the times of a phase are of."""
    if result.start == 0.0:
        return "time since the phase began"
    return f"time since the shot, as in removal.parquet; the removal began at {result.start!r} s"


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
            **fmus.get(name, {}),
            "terms": dict(phase.main.terms),
            "macro_step": {"value": phase.macro_step, "unit": "s"},
            "duration": {"value": phase.duration, "unit": "s"},
            "steps": result.steps,
            "cpu": {"value": result.cpu, "unit": "s"},
            "wall": {"value": result.wall, "unit": "s"},
            "parameters": run.parameters.get(name, {}),
        }
    return {
        "scene": run.scene.name,
        "settings": [override.argument for override in run.scene.places.overrides],
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
