"""`dcone sweep` and `dcone run --ensemble` from beginning to end: cases, rows, the folder of results.

study.json rows/           the result store, with which the same command goes on
table.parquet table.csv    one row per case, the same bits however the work was cut up (see `table`)
timings.parquet            what each case cost
summary.json               how many came out how; of an ensemble also mean, spread and percentiles
sweep.png                  chief figures over the varied keys
provenance.json scene.toml what made it; the scene before anything was varied
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import ExitStack
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from dcone_cosim import interrupts, placed
from dcone_cosim.cases import ensemble as ensembles
from dcone_cosim.cases import show, vary
from dcone_cosim.cases.alone import Fmus
from dcone_cosim.cases.beginnings import kept_of
from dcone_cosim.cases.case import Case, Value, code, content, digest, identities, key_of
from dcone_cosim.cases.early import Early, begun_together
from dcone_cosim.cases.pace import Pace
from dcone_cosim.cases.plot import draw
from dcone_cosim.cases.rows import Row, refused
from dcone_cosim.cases.runner import Runner
from dcone_cosim.cases.statistics import Summary, summarise
from dcone_cosim.cases.store import ROWS, Store
from dcone_cosim.cases.table import Column, Entry, write
from dcone_cosim.cases.work import make_ready, run_case
from dcone_cosim.cases.workers import Workers, cores
from dcone_cosim.drafts import PROVENANCE, to_disk
from dcone_cosim.errors import CASES_FAILED, SUCCESS, InputError, Interrupted
from dcone_cosim.loading import named
from dcone_cosim.progress import Progress
from dcone_cosim.results import RunResult
from dcone_cosim.run_folder import as_json, default_folder, provenance
from dcone_cosim.run_reading import json_of
from dcone_cosim.scene.data import Scene
from dcone_cosim.scene_fmus import remarks
from dcone_cosim.scenes.kept import keep
from dcone_cosim.scratch import Scratch

SWEEP, ENSEMBLE = "a sweep", "an ensemble"
TOLD = b"dcone: interrupted; the cases that are done are kept\n"
MOST_JOBS = 1024


@dataclass
class Done:
    """What a sweep or an ensemble came to, and where it is.

    notes    what to tell of the work
    """

    title: str
    folder: Path
    entries: list[Entry]
    columns: list[Column]
    summary: Summary
    content: dict[str, Any]
    notes: list[str] = field(default_factory=list)

    @property
    def exit_code(self) -> int:
        return SUCCESS if all(entry.row.succeeded for entry in self.entries) else CASES_FAILED


@dataclass
class Plan:
    """What is to be run.

    base       the scene before anything was varied
    varied     texts of the values of each varied key
    entries    in the order of the table: the case, or the row of one that cannot be; its values; its seed
    facts      of the FMUs, for the provenance; `fmus` identifies those of the base
    about      what else the summary and the provenance tell
    identified what the FMUs of a case are, by its key, of those that may have beginnings in common
    """

    kind: str
    base: Scene
    title: str
    varied: Mapping[str, Sequence[str]]
    entries: list[tuple[Case | Row, Mapping[str, Value], int | None]]
    facts: list[Mapping[str, Any]]
    fmus: Mapping[str, str]
    about: Mapping[str, Any]
    identified: Mapping[str, Mapping[str, str]] = field(default_factory=dict)

    @property
    def cases(self) -> list[Case]:
        return [case for case, _, _ in self.entries if isinstance(case, Case)]

    def study(self) -> dict[str, Any]:
        """What the folder is of."""
        return {
            "kind": self.kind,
            "scene": self.base.name,
            "varied": list(self.varied),
            "content": digest(content(self.base)),
            "fmus": dict(self.fmus),
            "code": code(),
        }


def sweep(
    name: str,
    arguments: Sequence[str],
    out: Path | None,
    progress: Progress,
    settings: Sequence[str] = (),
    jobs: int | None = None,
    with_figures: bool = True,
    isolate: bool | None = None,
) -> Done:
    """Run a grid of cases and write its folder. Bad input raises and leaves nothing."""
    return sweep_over(name, vary.read(arguments, settings), out, progress, settings, jobs, with_figures, isolate)


def sweep_over(
    name: str,
    keys: Sequence[vary.Varied],
    out: Path | None,
    progress: Progress,
    settings: Sequence[str] = (),
    jobs: int | None = None,
    with_figures: bool = True,
    isolate: bool | None = None,
) -> Done:
    """The same with the keys and their values as they are."""
    base = named(name, settings).isolating(isolate)
    folder = _folder(base, SWEEP, out)
    count = _processes(jobs, math.prod(len(key.values) for key in keys))
    with ExitStack() as last, Workers(count) as workers:
        for _ in range(count):
            workers.submit(make_ready, None)
        fmus = Fmus(progress)
        of_base = fmus.of(base)
        firsts = [] if len(base.phases) == 1 else vary.first_two(name, keys, settings)
        firsts = [scene.isolating(isolate) for scene in firsts]
        early = Early([(scene, fmus.of(scene)) for scene in firsts], folder, workers, _kept(name, progress))
        last.callback(early.close)  # once no worker writes there any more
        for _ in range(count):
            workers.submit(make_ready, base)
        plan = _planned(name, base, keys, settings, isolate, progress, fmus, of_base)
        return _carry_out(plan, folder, progress, workers, 2 * count, with_figures, early)


def _kept(name: str, progress: Progress) -> Mapping[str, Path]:
    """The beginnings there are, where the scene is the folder of a run."""
    folder = Path(name)
    if not (folder / PROVENANCE).is_file() or "phases" not in json_of(folder / PROVENANCE):
        return {}
    found = kept_of(folder)
    if found:
        progress.say(f"cases that begin as {folder} did go on from what it has left")
    return found


def _planned(
    name: str,
    base: Scene,
    keys: Sequence[vary.Varied],
    settings: Sequence[str],
    isolate: bool | None,
    progress: Progress,
    fmus: Fmus,
    of_base: Mapping[str, str],
) -> Plan:
    """Every case, checked."""
    identified: dict[str, Mapping[str, str]] = {}
    entries: list[tuple[Case | Row, Mapping[str, Value], int | None]] = []
    for combination in vary.grid(name, keys, settings, progress.say):
        if combination.scene is None:
            key = digest("refused", content(base), sorted(combination.settings))
            entries.append((refused(key, combination.refusal), combination.values, None))
            continue
        scene = combination.scene.isolating(isolate)
        of_scene = fmus.of(scene)
        key = key_of(scene, of_scene, None)
        identified[key] = of_scene
        entries.append(
            (Case(key, scene, (*settings, *combination.settings), combination.values), combination.values, None)
        )
    return Plan(
        SWEEP,
        base,
        f"{base.title} (varied: {', '.join(key.key for key in keys)})".lstrip(),
        {key.key: key.values for key in keys},
        entries,
        list(fmus.facts.values()),
        of_base,
        {"varied": {key.key: list(key.values) for key in keys}},
        identified,
    )


def ensemble(
    name: str,
    count: int,
    seed: int,
    out: Path | None,
    progress: Progress,
    settings: Sequence[str] = (),
    jobs: int | None = None,
    isolate: bool | None = None,
) -> Done:
    """Run a scene with so many starts, the first with this seed, and write its folder."""
    ensembles.check(count, seed)
    base = named(name, settings).isolating(isolate)
    seeds = range(seed, seed + count)
    members = ensembles.members(name, base, seeds, settings)
    fmus = Fmus(progress)
    entries: list[tuple[Case | Row, Mapping[str, Value], int | None]] = []
    for number, member in members:
        scene = member.isolating(isolate)
        key = key_of(scene, fmus.of(scene), number)
        entries.append((Case(key, scene, (*settings, *ensembles.jitter(base, number)), {}, number), {}, number))
    facts = list(fmus.facts.values())
    about = {"ensemble": {"runs": count, "first_seed": seed, "jitter": list(ensembles.jitter(base, seed))}}
    title = f"{base.title}: {count} runs with jittered starts"
    plan = Plan(ENSEMBLE, base, title, {}, entries, facts, identities(facts[0]), about)
    processes = _processes(jobs, count)
    with Workers(processes) as workers:
        return _carry_out(plan, _folder(base, ENSEMBLE, out), progress, workers, 2 * processes, False)


def _processes(jobs: int | None, cases: int) -> int:
    if jobs is not None and not 1 <= jobs <= MOST_JOBS:
        raise InputError(f"--jobs {jobs}: expected 1 to {MOST_JOBS} processes")
    return max(1, min(jobs or cores(), cases))


def _folder(base: Scene, kind: str, out: Path | None) -> Path:
    return out if out is not None else default_folder(f"{base.name}-{kind.split()[1]}")


def _carry_out(
    plan: Plan,
    folder: Path,
    progress: Progress,
    workers: Executor,
    ahead: int,
    with_figures: bool,
    early: Early | None = None,
) -> Done:
    started = datetime.now(UTC)
    with interrupts.heeded(TOLD), Store(folder, plan.study()) as store:
        interrupts.arm()
        cases = begun_together(plan.cases, plan.identified, store, workers, progress, early)
        rows = run_all(cases, store, workers, ahead, progress)
        store.gather_if_many()
        done = _result(plan, rows, folder)
        _write(plan, done, folder, started, with_figures)
    return done


def run_all(
    cases: Sequence[Case],
    store: Store,
    executor: Executor,
    ahead: int,
    progress: Progress,
    work: Callable[[Case], Row] = run_case,
    over: Callable[[], bool] = lambda: False,
) -> dict[str, Row]:
    """Rows of all cases by key, with a word on how far it is; see `Runner` for the arguments.

    over    says when no further case is to be begun
    """
    pace = Pace(len(cases))

    def tell() -> None:
        progress.count("cases", pace.done, pace.total, pace.told())

    found: dict[str, Row] = {}
    try:
        for row, before in Runner(store, executor, ahead, work, tell).rows(case for case in cases if not over()):
            found[row.key] = row
            pace.count(row.succeeded, before)
            tell()
            if not before and pace.done - pace.found == 1:
                placed.note(store.folder / ROWS)
    except Interrupted as stop:
        raise Interrupted(
            f"{stop} with {pace.done} of {pace.total} cases done; they are kept in {store.folder}, "
            "and the same command goes on with the rest"
        ) from None
    return found


def _result(plan: Plan, rows: Mapping[str, Row], folder: Path) -> Done:
    entries = [
        Entry(case if isinstance(case, Row) else rows[case.key], varied, seed) for case, varied, seed in plan.entries
    ]
    summary = summarise(entry.row for entry in entries)
    what = show.as_dict(summary) if plan.kind == ENSEMBLE else show.counts(summary)
    told = {"scene": plan.base.name, "title": plan.title, **plan.about, **what}
    told["failures"] = [
        {
            **{key: value.given for key, value in entry.varied.items()},
            **({"seed": entry.seed} if entry.seed is not None else {}),
            "status": entry.row.status,
            "message": entry.row.message,
        }
        for entry in entries
        if not entry.row.succeeded
    ]
    notes = [*plan.base.notes, *dict.fromkeys(note for facts in plan.facts for note in remarks(facts))]
    return Done(plan.title, folder, entries, [], summary, told, notes)


def _write(plan: Plan, done: Done, folder: Path, started: datetime, with_figures: bool) -> None:
    """Every file under another name first; the provenance, which says that all is there, last."""
    with ExitStack() as stack:
        draft = stack.enter_context(Scratch(folder))
        done.columns = write(done.entries, draft)
        (draft / "summary.json").write_text(as_json(done.content) + "\n", encoding="utf-8")
        keep(plan.base, draft)
        if with_figures:
            reason = _drawn(done, draft / "sweep.png")
            done.notes += [reason] if reason else []
        files = sorted(path.relative_to(draft) for path in draft.rglob("*") if path.is_file())
        about = {
            **provenance(RunResult(plan.base), {}, started),
            **plan.about,
            "status": f"{done.summary.succeeded.count} of {done.summary.cases} cases succeeded",
            "exit_code": done.exit_code,
            "code": code(),
            "fmus": plan.facts,
            "files": [str(path) for path in files],
        }
        (draft / PROVENANCE).write_text(as_json(about) + "\n", encoding="utf-8")
        publish(draft, [*files, Path(PROVENANCE)], folder)


def _drawn(done: Done, path: Path) -> str:
    """Draw; returns what could not be drawn. The numbers are there already and are worth more."""
    try:
        return draw(done.entries, done.columns, done.title, path)
    except Exception as error:
        return f"no figure could be drawn: {type(error).__name__}: {error}"


def publish(draft: Path, files: Iterable[Path], folder: Path) -> None:
    for file in files:
        (folder / file).parent.mkdir(parents=True, exist_ok=True)
        to_disk(draft / file)
        placed.put(draft / file, folder / file)
    to_disk(folder)
