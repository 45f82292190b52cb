"""`dcone campaign` from beginning to end: the file, the cases, the answers, the folder (see `folder`)."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from dcone_cosim import interrupts
from dcone_cosim.campaign import cluster, explained, page, plot, show
from dcone_cosim.campaign import inputs as inputs_module
from dcone_cosim.campaign.answers import answers, required_diameters
from dcone_cosim.campaign.applied import base_of, inputs_of
from dcone_cosim.campaign.engine import Engine, Made, Work, key_of
from dcone_cosim.campaign.figures import OPTIONAL, check_figures, check_names
from dcone_cosim.campaign.folder import KIND, SCENE, Kept, kept, settings_of, study_of, summary_of, table
from dcone_cosim.campaign.inputs import Inputs
from dcone_cosim.campaign.intervals import HAVE
from dcone_cosim.campaign.outcomes import settled
from dcone_cosim.campaign.reading import read
from dcone_cosim.campaign.sampling import check_grid, count_of, points
from dcone_cosim.campaign.shots import ground_of, run_shot
from dcone_cosim.campaign.spec import ADAPTIVE, SALTELLI, SUBSET, Spec
from dcone_cosim.campaign.worst import CASES, worst
from dcone_cosim.cases.alone import Fmus
from dcone_cosim.cases.case import code, content, digest
from dcone_cosim.cases.commands import TOLD
from dcone_cosim.cases.report import write_report
from dcone_cosim.cases.rows import Row
from dcone_cosim.cases.store import Store
from dcone_cosim.cases.table import Entry, as_arrow, timings
from dcone_cosim.cases.work import make_ready
from dcone_cosim.cases.workers import cores
from dcone_cosim.commands import Written, run_and_write
from dcone_cosim.errors import CASES_FAILED, SUCCESS, DconeError
from dcone_cosim.progress import Progress
from dcone_cosim.report.commands import write_page
from dcone_cosim.run_folder import default_folder
from dcone_cosim.scene.data import Scene
from dcone_cosim.scene.mistakes import Mistake, SceneError
from dcone_cosim.scenes.kept import keep
from dcone_cosim.scenes.reading import parse
from dcone_cosim.scratch import Scratch

TIMINGS = "timings.parquet"
CHECKED = (0.025, 0.5, 0.975)
"""Where on their distributions values are shown by `--check`."""
MOST_ABSENT = 10_000
"""Cases without a row after which no more are looked for."""


@dataclass
class Done:
    """What a campaign came to.

    content    of summary.json
    said       the answers in sentences
    """

    title: str
    folder: Path
    made: list[Made]
    content: dict[str, Any]
    said: list[str]
    notes: list[str] = field(default_factory=list)

    @property
    def exit_code(self) -> int:
        return CASES_FAILED if self.content["no_answer"] else SUCCESS


@dataclass(frozen=True)
class Plan:
    """A campaign that has been checked, with its FMUs there.

    identity    of all that settles a case's numbers beside its settings
    facts       of the FMUs, for the provenance
    cases       how many were asked for in place of what the file says
    """

    spec: Spec
    base: Scene
    inputs: Inputs
    fmus: Mapping[str, str]
    facts: Sequence[Mapping[str, Any]]
    text: str
    cases: int | None

    @property
    def identity(self) -> list[Any]:
        return [content(self.base), dict(self.fmus), code(), list(self.spec.record)]

    def study(self) -> dict[str, Any]:
        """What the folder is of."""
        return {
            "kind": KIND,
            "scene": self.base.name,
            "varied": self.inputs.names,
            "content": digest(content(self.base), self.spec.design()),
            "fmus": dict(self.fmus),
            "code": code(),
            "name": self.spec.name,
            "file": self.spec.source,
            "campaign": self.text,
            **({} if self.cases is None else {"cases": self.cases}),
        }


def checked(path: Path, cases: int | None = None) -> tuple[Spec, Scene, Inputs]:
    """A campaign held against its scene; nothing is built or run."""
    spec = read(path, cases)
    base = base_of(spec)
    spec = settled(spec, base)
    check_names(spec, base)
    inputs = inputs_of(spec, base)
    check_grid(spec, inputs.names, [one.points for one in inputs.inputs])
    if spec.sampler == SALTELLI and spec.correlations:
        raise SceneError(
            [Mistake(("correlation",), None, "Sobol indices are those of independent values; leave it out")],
            spec.places,
        )
    return spec, base, inputs


def planned(path: Path, progress: Progress, isolate: bool | None = None, cases: int | None = None) -> Plan:
    """The same with the FMUs of every term that a case may have."""
    spec, base, inputs = checked(path, cases)
    base = base.isolating(isolate)
    fmus = Fmus(progress)
    others = list(_alternatives(inputs, base))
    fmus.make_ready([base, *others])
    found = fmus.of(base)
    for place, scene in enumerate(others):
        found |= {f"{name}, alternative {place + 1}": one for name, one in fmus.of(scene).items() if one != found[name]}
    return Plan(spec, base, inputs, found, list(fmus.facts.values()), spec.places.text, cases)


def _alternatives(inputs: Inputs, base: Scene) -> Iterator[Scene]:
    """The scene with each text of each discrete input: it may have other FMUs."""
    for group in inputs.groups:
        first = inputs.inputs[group.places[0]]
        for place in range(len(first.texts)):
            settings = group.write([float(place)])
            yield parse(base.text, base.name, base.source, Path(base.source).parent, settings)


def campaign(
    path: Path,
    out: Path | None,
    progress: Progress,
    scheduler: str | None = None,
    jobs: int | None = None,
    isolate: bool | None = None,
    with_figures: bool = True,
    work: Work = run_shot,
    replays: bool = False,
    cases: int | None = None,
) -> Done:
    """Run a campaign and write its folder. Bad input raises and leaves nothing; the same command goes on there.

    scheduler, jobs    see `cluster.opened`
    work               what makes the row of a case, a function of a module
    replays            run the cases worth looking at again, with a page of each
    cases              how many, in place of what the file says
    """
    started = datetime.now(UTC)
    cluster.check(scheduler)
    plan = planned(path, progress, isolate, cases)
    spec, folder = plan.spec, out if out is not None else default_folder(f"{plan.spec.name}-campaign")
    coordinates = [one.points for one in plan.inputs.inputs]
    count = count_of(spec, coordinates)
    processes = min(jobs or cores(), count or spec.most)
    with ExitStack() as stack:
        stack.enter_context(interrupts.heeded(TOLD))
        store = stack.enter_context(Store(folder, plan.study()))
        _keep_scene(plan.base, folder)
        interrupts.arm()
        workers = stack.enter_context(cluster.opened(scheduler, processes))
        for _ in range(workers.count if work is run_shot else 0):
            workers.executor.submit(make_ready, plan.base)
        progress.say(f"running on {workers.what}")
        ground = ground_of(plan.base, isolate, tuple(name.removesuffix(OPTIONAL) for name in spec.record))
        engine = Engine(spec, plan.inputs, ground, plan.identity, store, workers, progress, work)
        nominal = engine.nominal()
        check_figures(spec, nominal)
        found = _run(engine, coordinates, count)
        store.gather_if_many()
        command = f"dcone campaign {shlex.quote(path.name)}{'' if cases is None else f' --cases {cases}'}"
        return _written(
            plan, engine, nominal, found, folder, started, command, with_figures, progress if replays else None
        )


def _run(engine: Engine, coordinates: Sequence[Sequence[float]], count: int | None) -> Mapping[str, Any]:
    """All cases; returns what the sampler itself finds."""
    spec = engine.spec
    if spec.sampler == ADAPTIVE:
        from dcone_cosim.campaign.maps import run_map

        return run_map(engine)
    if spec.sampler == SUBSET:
        from dcone_cosim.campaign.rare import run_subset

        return run_subset(engine)
    engine.run(points(spec, coordinates), count)
    return {}


def _keep_scene(base: Scene, folder: Path) -> None:
    """Put the scene there at once, so that a case can be made again whenever the campaign ends."""
    if not (folder / SCENE).is_file():
        with Scratch(folder) as draft:
            keep(base, draft)
            for path in sorted(p for p in draft.rglob("*") if p.is_file() and p.name != SCENE):
                place = folder / path.relative_to(draft)
                place.parent.mkdir(parents=True, exist_ok=True)
                path.replace(place)
            (draft / SCENE).replace(folder / SCENE)


def _written(
    plan: Plan,
    engine: Engine,
    nominal: Row,
    found: Mapping[str, Any],
    folder: Path,
    started: datetime,
    command: str,
    with_figures: bool,
    replays: Progress | None,
) -> Done:
    """Write all of it; `replays` is told of the cases that are run again for their pages, None for none."""
    spec, made = plan.spec, engine.made
    derived = required_diameters(spec, plan.base, plan.inputs.names, made)
    told, spread = answers(spec, made, derived, plan.inputs.names), explained.explained(spec, plan.inputs, made)
    said = [*show.sentences(spec, told), *_of_sampler(spec, found), *explained.sentences(spread), *_of_cost(made)]
    content_of = {
        "campaign": spec.name,
        "title": spec.title,
        "scene": plan.base.name,
        "sampler": spec.sampler,
        "seed": spec.seed,
        **show.as_dict(spec, told),
        **found,
        **explained.as_dict(spread),
        "said": said,
        "nominal": {"status": nominal.status, "figures": dict(nominal.figures)},
        "cost": _cost(made),
    }
    notes = [*plan.base.notes, *spread.notes]
    done = Done(spec.title, folder, made, content_of, said, notes)
    worth, bounded = worst(spec, made, folder), spec.sampler in HAVE

    columns = table(plan.inputs, made, derived, spec.success.judged)

    def draw(draft: Path, about: Mapping[str, Any]) -> None:
        import pyarrow.parquet

        pyarrow.parquet.write_table(as_arrow(timings([Entry(one.row) for one in made])), draft / TIMINGS)
        pictures = plot.draw(spec, plan.inputs, made, told, spread, draft) if with_figures else []
        there = {one.number for one in worth if (folder / one.page).is_file()}
        page.write(
            spec.title, said, plan.inputs, told, spread, worth, there, pictures, plan.text, bounded, notes, about, draft
        )

    def publish() -> None:
        write_report(folder, [plan.base], columns, content_of, draw, started, done.exit_code, command)

    publish()
    if replays is not None:
        for one in worth:
            if (folder / one.page).is_file():
                continue
            replays.say(f"case {one.number} again, for its replay")
            try:
                rerun(folder, one.number, None, replays)
            except DconeError as error:
                notes.append(f"case {one.number} has no page: {error}")
        publish()
    return done


def _of_sampler(spec: Spec, found: Mapping[str, Any]) -> list[str]:
    """What a map or a subset sampling found, in words."""
    if "map" in found:
        from dcone_cosim.campaign import maps

        return maps.sentences(found["map"])
    if "rare" in found:
        from dcone_cosim.campaign import rare

        return rare.sentences(spec, found["rare"])
    return []


def _of_cost(made: Sequence[Made]) -> list[str]:
    hours = _cost(made)["value"] / 3600.0
    return [f"{len(made)} cases took {hours:.3g} CPU-h"] if hours > 0.0 else []


def _cost(made: Sequence[Made]) -> dict[str, Any]:
    """Processor time of all cases [s]."""
    return {"value": sum(one.row.timings.get("cpu", 0.0) for one in made), "unit": "s"}


def shown(folder: Path) -> tuple[str, list[str], Mapping[str, Any], dict[str, Any]]:
    """Title, sentences, figures and content of the campaign of a folder, as far as it has come."""
    study, told = study_of(folder), summary_of(folder)
    if told is not None:
        return told["title"], told["said"], told["figures"], told
    found = kept(folder)
    spec = found.spec
    made: list[Made] = []
    with Store(folder, study) as store:
        identity = [content(found.base), study["fmus"], study["code"], list(spec.record)]
        if spec.sampler not in (ADAPTIVE, SUBSET):
            made = list(_there(found, identity, store))
    so_far = answers(spec, made, {}, found.inputs.names)
    said = ["it has not come to its end: its command goes on with the rest", *show.sentences(spec, so_far)]
    content_of = {"title": spec.title, **show.as_dict(spec, so_far), "said": said}
    return spec.title, said, content_of["figures"], content_of


def _there(found: Kept, identity: Any, store: Store) -> Iterator[Made]:
    """Cases of a campaign whose rows are there, in their order, up to the last."""
    spec, inputs = found.spec, found.inputs
    coordinates = [one.points for one in inputs.inputs]
    count, absent = count_of(spec, coordinates), 0
    for number, point in enumerate(points(spec, coordinates), 1):
        if absent > MOST_ABSENT or number > (spec.most if count is None else count):
            return
        values = tuple(inputs.values(point))
        row = store.get(key_of(identity, inputs.settings(values)))
        absent = absent + 1 if row is None else 0
        if row is not None:
            yield Made(number, values, row)


def told_of_check(path: Path, cases: int | None = None) -> tuple[dict[str, Any], list[str]]:
    """What a campaign would be, for machines and in sentences; nothing is built or run."""
    spec, base, inputs = checked(path, cases)
    count = count_of(spec, [one.points for one in inputs.inputs])
    first = []
    for one in inputs.inputs:
        values = [one.value(u) for u in CHECKED]
        texts = [inputs_module.shown(one, value) for value in values]
        first.append({"input": one.name, "values": texts})
    how_many = (
        f"{count:,} cases"
        if count is not None
        else f"cases until {spec.until.text if spec.until else ''}, {spec.most:,} at most"
    )
    said = [
        f"{base.name}: {how_many} by {spec.sampler}, {len(inputs.inputs)} values drawn for each",
        *(
            f"{row['input']}: {', '.join(row['values'])} at {', '.join(f'{100 * u:g} %' for u in CHECKED)}"
            for row in first
        ),
    ]
    return {"title": spec.title, "scene": base.name, "cases": count, "sampler": spec.sampler, "inputs": first}, said


def rerun(folder: Path, number: int, out: Path | None, progress: Progress, with_figures: bool = True) -> Written:
    """Run a case of a campaign again, and write the full folder of a run."""
    found = kept(folder)
    settings = settings_of(found, number)
    place = out if out is not None else folder / CASES / str(number)
    replay = any(phase.name == "capture" and phase.main.fmu is None for phase in found.base.phases)
    written = run_and_write(
        str(folder / SCENE), place, progress, with_figures=with_figures, settings=settings, replay=replay
    )
    write_page(written.folder, None, progress)
    return written
