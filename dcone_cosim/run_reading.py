"""A run read back from its folder: what was computed, as it was, to be drawn again, compared and gone on from.

Columns come from the tables with every bit, values from the provenance, the scene from its text. What a phase took over
is worked out again from what the one before it left, and its ledger is the one that was written.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from dcone_cosim.drafts import PROVENANCE
from dcone_cosim.errors import HandoffError, InputError
from dcone_cosim.files import regular
from dcone_cosim.fmu.steppable import Steppable
from dcone_cosim.frames import Frames
from dcone_cosim.level import with_term
from dcone_cosim.loading import load
from dcone_cosim.phases import kind_of
from dcone_cosim.phases.passive import Instant, Nearest
from dcone_cosim.phases.phase import Stage
from dcone_cosim.progress import Progress
from dcone_cosim.recorder import Recorder, Row, Snapshots, TugLog
from dcone_cosim.results import Attained, PhaseResult, RunResult
from dcone_cosim.run_folder import NODES, REPLAY_NODES, REPLAY_THREADS, ledger_file
from dcone_cosim.scene.data import Scene

KINDS = {"double": "Real", "float": "Real", "int64": "Integer", "bool": "Boolean"}
"""Kind of a variable by the type of its column."""
EXTREMES = {"tether.taut": "Boolean", "tether.tension_peak": "Real"}


def read_run(folder: Path, scene: Scene | None = None, until: str = "") -> RunResult:
    """The run that left this folder; `InputError` where it is none, or where something of it is missing.

    scene    with which its hand-overs are worked out again; its own if not given
    until    name of the phase from which on nothing is read; "" for all

    Checked  tests/cosim/test_run_reading.py
    """
    told = provenance_of(folder)
    try:
        return _read(folder, told, scene, until)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        version = told.get("packages", {}).get("dcone-cosim", "?")
        raise InputError(
            f"{folder} cannot be read as a run: {type(error).__name__}: {error}; it was written by dcone-cosim "
            f"{version}, and `dcone run` on the folder makes the run again"
        ) from error


def provenance_of(folder: Path) -> dict[str, Any]:
    """What the folder of a run tells of itself."""
    if not (folder / PROVENANCE).is_file():
        raise InputError(f"{folder} is not the folder of a run: it has no {PROVENANCE}")
    told = json_of(folder / PROVENANCE)
    if "phases" not in told:
        raise InputError(f"{folder} is not the folder of a run: its {PROVENANCE} tells of no phases")
    return told


def json_of(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(regular(path).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"{path} cannot be read: {error}") from error
    if not isinstance(content, dict):
        raise InputError(f"{path} cannot be read: expected an object")
    return content


def _read(folder: Path, told: Mapping[str, Any], scene: Scene | None, until: str) -> RunResult:
    run = RunResult(load(str(folder)) if scene is None else scene)
    run.status, run.message, run.exit_code = told["status"], told["message"], int(told["exit_code"])
    run.gone_on = told.get("gone_on", {})
    for name, about in told["phases"].items():
        if name == until:
            break
        run.phases[name] = _phase(folder, name, about)
        for of in ("parameters", "inputs", "given"):
            getattr(run, of)[name] = _numbers(about[of])
        if about["left"]:
            run.left[name] = _numbers(about["left"])
        _take_terms(run, name, about["terms"])
    for place, name in enumerate(told["handed_over_at"]):
        if name == until:
            break
        _recall(run, name, json_of(folder / ledger_file(place, name)))
    for name, about in told["without_recoil"].items():
        if name not in run.phases:
            continue
        columns = {"time": ("s", "Real", np.zeros(1))}
        columns |= {key: ("1", EXTREMES[key], np.array([float(value)])) for key, value in about["row"].items()}
        tugs = _tugs(folder / f"{name}_without_recoil_tugs.parquet", about["tugs"])
        run.comparisons[name] = PhaseResult(name, 0.0, Recorder.of(columns), tugs=tugs)
    run.attained = {
        name: Attained(**{**about, "means": {key: tuple(row) for key, row in about["means"].items()}})
        for name, about in told["attained"].items()
    }
    return run


def _numbers(values: Mapping[str, Any]) -> dict[str, float]:
    """Of JSON, where one that is not finite is a text."""
    return {name: float(value) for name, value in values.items()}


def _take_terms(run: RunResult, name: str, terms: Mapping[str, str]) -> None:
    """A phase may have been run with other terms than its scene names: those that what was handed over needed."""
    phase = next(phase for phase in run.scene.phases if phase.name == name)
    main = phase.main
    for group, term in terms.items():
        if main.fmu is None and main.terms.get(group) != term:
            main = with_term(main, group, term)
    if main is not phase.main:
        run.scene = run.scene.with_phase(replace(phase, main=main))


def _recall(run: RunResult, name: str, ledger: Mapping[str, Any]) -> None:
    """Work out again what a phase took over."""
    phases = run.scene.phases
    place = next(i for i, phase in enumerate(phases) if phase.name == name)
    after = phases[place + 1] if place + 1 < len(phases) else None
    before = next(phase for phase in reversed(phases[:place]) if phase.name in run.phases)
    stage = Stage(run, phases[place], before, after, _nobody, Progress())
    try:
        record = kind_of(name).take_over(stage)
    except HandoffError:
        record = run.handovers[name]
    assert record is not None, "a phase hands over to it"
    record.recall(ledger)
    run.scene = run.scene.with_phase(record.phase)


def _nobody(phase: str, name: str) -> Steppable:
    raise AssertionError(f"{name} of the {phase} is not run")


def _phase(folder: Path, name: str, about: Mapping[str, Any]) -> PhaseResult:
    out = about["came_out"]
    located, tugs = out["located"], out["tugs"]
    safety = folder / f"{name}_passive_safety.parquet"
    return PhaseResult(
        name,
        float(about["start"]["value"]),
        recorder_of(folder / f"{name}.parquet"),
        _snapshots(folder / f"{kind_of(name).prefix}{NODES}.parquet") if kind_of(name).keeps_nodes else Snapshots(),
        None if tugs is None else _tugs(folder / f"{kind_of(name).tugs_file}.parquet", tugs),
        out["outcome"],
        None if located is None else float(located["value"]),
        out["located_by"],
        int(about["steps"]),
        float(about["cpu"]["value"]),
        float(about["wall"]["value"]),
        None,
        _numbers(out["coupling"]),
        out["ended_by"],
        float(out["ended_at"]["value"]),
        float(about["origin"]["value"]),
        _instants(safety) if safety.is_file() else (),
        _frames(folder, kind_of(name).prefix, about["options"]) if kind_of(name).keeps_nodes else None,
    )


def _columns(path: Path) -> dict[str, tuple[str, str, Row]]:
    """Unit, kind and values of every column of a table."""
    import pyarrow as pa
    import pyarrow.parquet

    try:
        table = pyarrow.parquet.ParquetFile(regular(path)).read()
    except (OSError, pa.ArrowException) as error:
        raise InputError(f"{path} cannot be read: {error}") from error
    columns = {}
    for field in table.schema:
        unit = (field.metadata or {}).get(b"unit", b"1").decode()
        # what Arrow offers under the name of NumPy loads pandas, which takes longer than the table
        numbers: Row = np.from_dlpack(table[field.name].cast(pa.float64()).combine_chunks())  # type: ignore[assignment]
        columns[field.name] = unit, KINDS[str(field.type)], numbers
    return columns


def recorder_of(path: Path) -> Recorder:
    """The columns of a phase."""
    return Recorder.of(_columns(path))


def _snapshots(path: Path) -> Snapshots:
    found = Snapshots()
    if path.is_file():
        columns = {name: values for name, (_, _, values) in _columns(path).items()}
        times = columns["time"]
        positions = np.column_stack([columns[f"position[{i}]"] for i in (1, 2, 3)])
        first = np.flatnonzero(columns["node"] == 1)
        found.times = times[first].tolist()
        found.nodes = np.split(positions, first[1:])
    return found


def _frames(folder: Path, prefix: str, options: Mapping[str, Any]) -> Frames | None:
    """Frames of a replay, None where none were kept."""
    path = folder / f"{prefix}{REPLAY_NODES}.parquet"
    if not path.is_file():
        return None
    columns = {name: values for name, (_, _, values) in _columns(path).items()}
    times = np.unique(columns["time"])
    positions = np.column_stack([columns[f"position[{i}]"] for i in (1, 2, 3)]).astype(np.float32)
    found = Frames(float(options["replay_every"]), times.tolist(), list(positions.reshape(len(times), -1, 3)))
    threads = folder / f"{prefix}{REPLAY_THREADS}.parquet"
    if threads.is_file():
        columns = {name: values for name, (_, _, values) in _columns(threads).items()}
        found.tensions = list(columns["tension"].astype(np.float32).reshape(len(times), -1))
        ends = np.column_stack([columns["node[1]"], columns["node[2]"]])
        found.ends = ends[: len(found.tensions[0])].astype(np.int64)
    else:
        found.tensions = [np.zeros(0, dtype=np.float32) for _ in times]
    return found


def _tugs(path: Path, about: Mapping[str, Any]) -> TugLog:
    log = TugLog(int(about["ring"]))
    columns = [values.tolist() for _, _, values in _columns(path).values()]
    log.take_up(about["count"], list(zip(*columns, strict=True)))
    return log


def _instants(path: Path) -> list[Instant]:
    columns = {name: values.tolist() for name, (_, _, values) in _columns(path).items()}

    def nearest(what: str, row: int) -> Nearest | None:
        found = Nearest(columns[f"{what}.least_distance"][row], columns[f"{what}.after"][row])
        return None if found.distance != found.distance else found

    return [
        Instant(time, columns["separation"][row], nearest("stopped", row), nearest("cut", row))
        for row, time in enumerate(columns["time"])
    ]
