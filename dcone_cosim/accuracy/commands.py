"""`dcone accuracy` from beginning to end.

study.json rows/                  the result store, with which the same command goes on
table.parquet table.csv           a row for each setting and quantity: error, floor, CPU time
summary.json                      references, orders, fronts, sentences
PHASE_accuracy.png report.html    error against CPU time; all of it as one page
provenance.json scene.toml        what made it
"""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

from dcone_cosim import interrupts
from dcone_cosim.accuracy import page, plot, show
from dcone_cosim.accuracy.judge import Report, judge
from dcone_cosim.accuracy.plan import Effort, plan
from dcone_cosim.accuracy.work import measure
from dcone_cosim.cases.alone import Alone
from dcone_cosim.cases.case import code, content, digest
from dcone_cosim.cases.commands import TOLD, run_all
from dcone_cosim.cases.report import write_report
from dcone_cosim.cases.store import Store
from dcone_cosim.cases.table import Column
from dcone_cosim.cases.workers import Workers, cores
from dcone_cosim.errors import CASES_FAILED, SUCCESS, InputError
from dcone_cosim.progress import Progress
from dcone_cosim.run_folder import default_folder

QUICK = Effort(runs=2, repeats=1, thin=3, refine=False)
KIND = "an accuracy report"
MOST_RUNS = 1000


@dataclass
class Done:
    """What it came to, and where it is."""

    folder: Path
    reports: list[Report]
    content: dict[str, Any]
    notes: list[str] = field(default_factory=list)

    @property
    def exit_code(self) -> int:
        lost = [p for r in self.reports for axis in r.axes for p in axis.points if p.sample.failed]
        return CASES_FAILED if lost or any(report.failure for report in self.reports) else SUCCESS


def accuracy(
    name: str,
    out: Path | None,
    progress: Progress,
    settings: Sequence[str] = (),
    runs: int | None = None,
    quick: bool = False,
    jobs: int | None = None,
    isolate: bool | None = None,
    refine: bool = True,
    peers: bool = False,
) -> Done:
    """Measure every phase of a scene and write the folder. Bad input raises and leaves nothing.

    refine     whether the models themselves are refined too, which is dear
    peers      whether other programs are tried too, where they are installed
    """
    started = datetime.now(UTC)
    if runs is not None and not 2 <= runs <= MOST_RUNS:
        raise InputError(f"--runs {runs}: expected 2 to {MOST_RUNS}")
    usual = QUICK if quick else Effort()
    effort = replace(usual, refine=usual.refine and refine, peers=peers)
    if runs is not None:
        effort = replace(effort, runs=runs, repeats=runs)
    alone = Alone(name, settings, isolate)
    alone.begin(progress)
    progress.say("checking what there is to choose")
    plans = [plan(alone, phase, effort, progress) for phase in alone.phases]
    cases = [case for one in plans for case in one.cases]
    count = max(1, min(jobs or cores(), len(cases)))
    scene = alone.scene
    folder = out if out is not None else default_folder(f"{scene.name}-accuracy")
    study = {
        "kind": KIND,
        "scene": scene.name,
        "varied": [],
        "content": digest(content(scene)),
        "fmus": {},
        "code": code(),
    }
    with interrupts.heeded(TOLD), Store(folder, study) as store:
        interrupts.arm()
        with Workers(count) as workers:
            first = [case for one in plans for case in one.first]
            rows = run_all(first, store, workers, 2 * count, progress, measure)
            for one in plans:
                one.drop_dear(rows)
            cases = [case for one in plans for case in one.cases]
            if len(cases) > len(rows):
                rows = run_all(cases, store, workers, 2 * count, progress, measure)
        store.gather_if_many()
        reports = [judge(one, rows) for one in plans]
        told = {
            "scene": scene.name,
            "title": scene.title,
            "runs": {"chaotic": effort.runs, "others": effort.repeats},
            "phases": {report.plan.phase: show.as_dict(report) for report in reports},
        }
        notes = [*scene.notes, *dict.fromkeys(note for one in plans for note in one.notes)]
        done = Done(folder, reports, told, notes)
        write_report(
            folder,
            [scene],
            _columns(reports),
            told,
            partial(_draw, done),
            started,
            done.exit_code,
            _command(name, settings, runs, quick, peers),
        )
    return done


def _command(name: str, settings: Sequence[str], runs: int | None, quick: bool, peers: bool) -> str:
    """What makes the report again."""
    parts = ["dcone", "accuracy", name, *(part for setting in settings for part in ("--set", setting))]
    parts += [] if runs is None else ["--runs", str(runs)]
    return shlex.join([*parts, *(["--quick"] if quick else []), *(["--peers"] if peers else [])])


def _draw(done: Done, draft: Path, about: Mapping[str, Any]) -> None:
    """Pictures and page."""
    for report in done.reports:
        if report.axes:
            plot.draw(report, draft / f"{report.plan.phase}_accuracy.png")
    page.write(done.reports, done.notes, about, draft)


def _columns(reports: Sequence[Report]) -> Iterator[Column]:
    """A row for each setting and quantity."""
    rows = [
        (report, axis, point, key)
        for report in reports
        for axis in report.axes
        for point in axis.points
        for key in point.errors
    ]
    yield Column("phase", [report.plan.phase for report, *_ in rows])
    yield Column("axis", [axis.name for _, axis, *_ in rows])
    yield Column("family", [point.setting.family for *_, point, _ in rows])
    yield Column("size", [point.setting.size for *_, point, _ in rows])
    yield Column("settings", [" ".join(point.setting.changes) for *_, point, _ in rows])
    yield Column("quantity", [key for *_, key in rows])
    yield Column("error", [float(point.errors[key]) for *_, point, key in rows])
    yield Column("floor", [float(point.floors[key]) for *_, point, key in rows])
    yield Column("relative_to", [report.quantities[key]["relative_to"] for report, _, _, key in rows])
    yield Column("runs", [point.sample.runs for *_, point, _ in rows])
    yield Column("cpu", [point.sample.cpu for *_, point, _ in rows], "s")
