"""`dcone stability` from beginning to end.

study.json rows/                  the result store, with which the same command goes on
table.parquet table.csv           a row for each case and criterion: what was measured, and up to where it counts
summary.json                      what became of every case, and the share refused by scheme
SCENE_PHASE_stability.png         the map
report.html provenance.json       all of it as one page, and what made it
"""

from __future__ import annotations

import shlex
import time as clock
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

from dcone_cosim import interrupts
from dcone_cosim.cases.alone import Alone, Fmus
from dcone_cosim.cases.case import code, content, digest
from dcone_cosim.cases.commands import TOLD, run_all
from dcone_cosim.cases.pace import spoken
from dcone_cosim.cases.report import write_report
from dcone_cosim.cases.store import Store
from dcone_cosim.cases.table import Column
from dcone_cosim.cases.workers import Workers, cores
from dcone_cosim.errors import CASES_FAILED, SUCCESS, InputError
from dcone_cosim.progress import Progress
from dcone_cosim.run_folder import default_folder
from dcone_cosim.stability import page, plot, show
from dcone_cosim.stability.plan import PhasePlan, plan
from dcone_cosim.stability.work import measure

KIND = "a stability matrix"
SHIPPED: Mapping[str, tuple[str, ...]] = {
    "table1-capture": ("capture.net.mesh=4 m", "capture.duration=16 s", "capture.macro_step=0.02 s"),
    "table2-deorbit": (),
}
"""Scenes that are tried where none is named, and what is set in them: a coarse net does as well, for a tenth of the
time."""
LIMIT, BUDGET = 20.0, 1200.0
"""CPU time of a case, and time for all cases on the clock [s]."""
QUICK_LIMIT, QUICK_BUDGET = 2.0, 30.0
"""The same of a quick look."""


@dataclass
class Done:
    """What it came to, and where it is."""

    folder: Path
    matrices: list[show.Matrix]
    content: dict[str, Any]
    notes: list[str] = field(default_factory=list)

    @property
    def exit_code(self) -> int:
        red = any(cell.verdict.red for one in self.matrices for cell in one.cells)
        return CASES_FAILED if red else SUCCESS


def stability(
    name: str | None,
    out: Path | None,
    progress: Progress,
    settings: Sequence[str] = (),
    limit: float | None = None,
    budget: float | None = None,
    quick: bool = False,
    jobs: int | None = None,
    isolate: bool | None = None,
) -> Done:
    """Try every phase of a scene, or of the shipped ones, and write the folder. Bad input raises and leaves nothing.

    limit     CPU time that a case may be reckoned to take [s]; None: LIMIT, or QUICK_LIMIT
    budget    time on the clock after which no further case is begun [s]; None: BUDGET, or QUICK_BUDGET
    """
    started = datetime.now(UTC)
    command = _command(name, settings, limit, budget, quick)
    if limit is None:
        limit = QUICK_LIMIT if quick else LIMIT
    if budget is None:
        budget = QUICK_BUDGET if quick else BUDGET
    for option, value in (("--limit", limit), ("--budget", budget)):
        if not 0.0 < value < 1e9:
            raise InputError(f"{option} {value:g}: expected a time greater than 0 s, and less than 1e9 s")
    if name is None and settings:
        raise InputError("--set needs a SCENE: without one the shipped scenes are tried as they are")
    chosen = {name: tuple(settings)} if name is not None else SHIPPED
    alones = [Alone(scene, given, isolate) for scene, given in chosen.items()]
    fmus = Fmus(progress)
    plans: list[PhasePlan] = []
    for alone in alones:
        alone.begin(progress)
        progress.say(f"checking what there is to try of {alone.scene.name}")
        plans += [plan(alone, phase, fmus, limit, quick) for phase in alone.phases]
    scenes = [alone.scene for alone in alones]
    label = scenes[0].name if len(scenes) == 1 else "shipped"
    folder = out if out is not None else default_folder(f"{label}-stability")
    study = {
        "kind": KIND,
        "scene": label,
        "varied": [],
        "content": digest([content(scene) for scene in scenes]),
        "fmus": {},
        "code": code(),
    }
    # what counts most first: should the time run out, the rest is left
    order = sorted(
        ((not cell.extreme.chief, one.schemes.index(cell.scheme), cell.case) for one in plans for cell in one.cells),
        key=lambda row: row[:2],
    )
    cases = [case for *_, case in order if case is not None]
    count = max(1, min(jobs or cores(), len(cases)))
    began = clock.perf_counter()
    with interrupts.heeded(TOLD), Store(folder, study) as store:
        interrupts.arm()
        with Workers(count) as workers:
            rows = run_all(
                cases, store, workers, count + 1, progress, measure, lambda: clock.perf_counter() - began > budget
            )
        store.gather_if_many()
        matrices = [show.matrix(one, rows) for one in plans]
        notes = list(dict.fromkeys(note for scene in scenes for note in scene.notes))
        left = sum(case.key not in rows for case in cases)
        if left:
            notes.append(f"{left} cases were left out after {spoken(budget)}; the same command goes on with them")
        told = {
            "scenes": [scene.name for scene in scenes],
            "limit": {"value": limit, "unit": "s"},
            "phases": {f"{one.plan.scene.name}.{one.plan.phase}": show.as_dict(one) for one in matrices},
        }
        done = Done(folder, matrices, told, notes)
        draw = partial(_draw, done)
        write_report(folder, scenes, _columns(matrices), told, draw, started, done.exit_code, command)
    return done


def _command(name: str | None, settings: Sequence[str], limit: float | None, budget: float | None, quick: bool) -> str:
    """What makes the report again."""
    parts = ["dcone", "stability", *([name] if name else [])]
    parts += [part for setting in settings for part in ("--set", setting)]
    parts += [] if limit is None else ["--limit", f"{limit:g}"]
    parts += [] if budget is None else ["--budget", f"{budget:g}"]
    return shlex.join([*parts, *(["--quick"] if quick else [])])


def _draw(done: Done, draft: Path, about: Mapping[str, Any]) -> None:
    """Maps and page."""
    for one in done.matrices:
        plot.draw(one, draft / page.picture_of(one))
    page.write(done.matrices, done.notes, about, draft)


def _columns(matrices: Sequence[show.Matrix]) -> Iterator[Column]:
    """A row for each case and criterion; one without for a case that has none."""
    rows = [
        (one, cell, criterion)
        for one in matrices
        for cell in one.cells
        for criterion in (cell.verdict.criteria or (None,))
    ]
    nan = float("nan")
    yield Column("scene", [one.plan.scene.name for one, *_ in rows])
    yield Column("phase", [one.plan.phase for one, *_ in rows])
    yield Column("extreme", [cell.planned.extreme.name for _, cell, _ in rows])
    yield Column("scheme", [cell.planned.scheme.name for _, cell, _ in rows])
    yield Column("verdict", [cell.verdict.kind for _, cell, _ in rows])
    yield Column("why", [cell.verdict.text for _, cell, _ in rows])
    yield Column("settings", [" ".join(cell.planned.changes) for _, cell, _ in rows])
    yield Column("criterion", [c.key if c else "" for *_, c in rows])
    yield Column("value", [c.value if c else nan for *_, c in rows])
    yield Column("accurate_up_to", [c.accurate if c else nan for *_, c in rows])
    yield Column("stable_up_to", [c.stable if c else nan for *_, c in rows])
    yield Column("unit", [c.unit if c else "" for *_, c in rows])
    yield Column("cpu", [cell.cpu for _, cell, _ in rows], "s")
