"""What each piece of physics in a phase changes and costs: the phase with it and without it, by runs of both.

A variant is left out with all that needs it; what can be switched to "none" is; and what the scene leaves out is added
with its defaults, where the scene can have it so, and named as what could not be tried where not. All run as long as
the phase does as it is.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, Literal

from dcone_cosim import build
from dcone_cosim.accuracy.judge import Sample, error_of, sample_of
from dcone_cosim.accuracy.plan import Planned, Planner
from dcone_cosim.accuracy.settings import Setting
from dcone_cosim.accuracy.show import percent
from dcone_cosim.accuracy.work import CPU, END, Measured, measure
from dcone_cosim.cases.alone import Alone
from dcone_cosim.cases.case import Case
from dcone_cosim.cases.cost import estimate
from dcone_cosim.cases.rows import Row, refused
from dcone_cosim.cases.runner import Memory, Runner
from dcone_cosim.cases.workers import Workers, cores
from dcone_cosim.errors import InputError
from dcone_cosim.fmu.component import Component
from dcone_cosim.progress import Progress
from dcone_cosim.scene.data import PhaseScene, Scene
from dcone_cosim.scene_fmus import opened
from dcone_cosim.units import written

if TYPE_CHECKING:
    from rich.console import Console

RUNS = 4
"""Of each variant: jittered starts of a chaotic phase, or repeats."""
DEARER, AT_LEAST = 30.0, 20.0
"""How many times what the phase takes as it is a variant may take, and how much it may in any case [s]."""
NONE = "none"
AS_IT_IS = Setting("", "", 1.0, ())


@dataclass(frozen=True)
class Variant:
    """The phase with something left out, switched off, or added.

    label      "without contact", "gravity = none", "with tether"
    without    tables that are left out
    """

    label: str
    changes: tuple[str, ...] = ()
    without: tuple[str, ...] = ()


@dataclass
class Effect:
    """What a variant comes to.

    change     of the quantity that changes most, over what its error is relative to, and which that is   [1]
    floor      below which runs cannot tell it from none                                                  [1]
    cpu        median CPU time of the steps [s];  per_step: of one substep [s]
    bytes, variables, memory   of the FMU, and of one instance [byte]
    """

    label: str
    change: float
    quantity: str
    floor: float
    cpu: float
    per_step: float
    bytes: int
    variables: int
    memory: int


@dataclass
class Found:
    """All effects in a phase, the first that of the phase as it is; and what could not be tried."""

    phase: str
    title: str
    effects: list[Effect]
    notes: list[str]


@dataclass(frozen=True)
class Bounded(Measured):
    """A case that is left out if it would take longer than so much CPU time [s]."""

    most: float = math.inf


def measure_within(case: Case) -> Row:
    """Run a case, unless it would take too long."""
    most = case.most if isinstance(case, Bounded) else math.inf
    cost = estimate(case.scene) if math.isfinite(most) else None
    if cost is not None and cost.cpu > most:
        return refused(case.key, f"left out: it would take {cost.told()}")
    return measure(case)


def measured(
    name: str, settings: Sequence[str], progress: Progress, jobs: int | None = None, isolate: bool | None = None
) -> list[Found]:
    """The effects in every phase of a scene whose model is ours."""
    alone = Alone(name, settings, isolate)
    alone.begin(progress)
    found = []
    with Workers(jobs or cores()) as workers:
        runner = Runner(Memory(), workers, 2 * cores(), measure_within)
        for phase in alone.phases:
            if alone.scene_of(phase).phases[0].main.fmu is None:
                found.append(_Phase(alone, phase, runner, progress).effects())
    return found


class _Phase:
    def __init__(self, alone: Alone, phase: str, runner: Runner, progress: Progress) -> None:
        self._alone, self._phase, self._runner, self._progress = alone, phase, runner, progress

    def effects(self) -> Found:
        """As it is first, then every variant, all for as long as it lasts as it is."""
        notes = list[str]()
        (probe,) = Planner(self._alone, self._phase, self._progress).cases(Planned(AS_IT_IS), 1).values()
        row = self._runner.row(probe)
        if not row.samples:
            raise InputError(f"{self._phase}: {row.message or row.status}")
        long = (f"{self._phase}.duration={written(row.timings[END], 's')}",)
        planners = {Variant("as it is"): Planner(self._alone, self._phase, self._progress, long)}
        (base,) = planners.values()
        for variant in variants_of(base.own):
            changes = (*long, *variant.changes)
            try:
                planners[variant] = Planner(self._alone, self._phase, self._progress, changes, variant.without)
            except InputError as error:
                notes.append(f"{self._phase}, {variant.label}: cannot be tried: {str(error).splitlines()[-1].strip()}")
        samples = self._run(planners, max(DEARER * row.timings[CPU], AT_LEAST))
        effects = []
        for (variant, planner), sample in zip(planners.items(), samples, strict=True):
            if sample.failed or not sample.means:
                notes.append(f"{self._phase}, {variant.label}: {sample.failed.splitlines()[-1].strip()}")
                continue
            effects.append(self._effect(variant.label, sample, samples[0], planner.base))
        return Found(self._phase, self._alone.scene.title, effects, notes)

    def _run(self, planners: Mapping[Variant, Planner], most: float) -> list[Sample]:
        """Samples of all variants, each of whose cases takes at most so much [s]."""
        cases: dict[str, Bounded] = {}
        planned = []
        for variant, planner in planners.items():
            planned.append(Planned(Setting("", variant.label, 1.0, ())))
            for key, case in planner.cases(planned[-1], RUNS).items():
                cases[key] = Bounded(**{field.name: getattr(case, field.name) for field in fields(case)}, most=most)
        rows = {}
        for row, _ in self._runner.rows(cases.values()):
            rows[row.key] = row
            self._progress.count("runs", len(rows), len(cases), f"{self._phase}: {len(rows)} of {len(cases)}")
        return [sample_of(one, rows) for one in planned]

    def _effect(self, label: str, sample: Sample, here: Sample, scene: Scene) -> Effect:
        change, quantity, floor = 0.0, "", 0.0
        for key in here.means:
            error, least = error_of(sample, here, key)
            floor = max(floor, least) if here.about[key]["meant"] else floor
            if here.about[key]["meant"] and not math.isnan(error) and error > max(change, least):
                change, quantity = error, str(here.about[key]["label"])
        main = scene.phases[0].main
        (path,) = build.ensure([(main.model, main.terms)], lambda _: None)
        with opened(path, main) as archive:
            size, variables = archive.path.stat().st_size, len(archive.variables)
            with Component(archive, main.name) as instance:
                instance.set(scene.phases[0].main.parameters)
                instance.initialise(scene.phases[0].start)
                memory = instance.state_size() if instance.can_save else 0
        per_step = sample.cpu / sample.steps if sample.steps else math.nan
        return Effect(label, change, quantity, floor, sample.cpu, per_step, size, variables, memory)


def variants_of(phase: PhaseScene) -> Iterator[Variant]:
    """All that can be left out, switched off or added."""
    main, model = phase.main, build.CATALOGUE[phase.main.model]
    numerics = (*build.numerics(main.model), *build.beside(main.model))
    for name, group in model.groups.items():
        if name in numerics:
            continue
        selector = f"{phase.name}.{group.table or name}.{group.selector}"
        if name in main.terms and group.optional:
            with_it = _needing(model, main.terms, name)
            others = f", and so without {' and '.join(with_it[1:])}" if len(with_it) > 1 else ""
            yield Variant(f"without {name}{others}", (), tuple(model.groups[n].table or n for n in with_it))
        elif name in main.terms and NONE in group.terms and main.terms[name] != NONE:
            yield Variant(f"{name} = {NONE}", (f'{selector}="{NONE}"',))
        elif name not in main.terms and group.optional and not group.early and name not in build.FAMILIES:
            usual = group.follows(main.terms, main.values) if group.follows is not None else next(iter(group.terms))
            label = f"with {name}" if group.follows is not None else f"with {name}: {usual}"
            yield Variant(label, (f'{selector}="{usual}"',))


def _needing(model: build.Model, terms: Mapping[str, str], name: str) -> list[str]:
    """The group and those that cannot be without it."""
    found = [name]
    while True:
        left = {group: term for group, term in terms.items() if group not in found}
        more = [group for group, _ in model.missing(left) if group not in found]
        if not more:
            return found
        found += more


def show(found: Sequence[Found], console: Console) -> None:
    """A table for each phase."""
    from rich.table import Table
    from rich.text import Text

    heads: tuple[tuple[str, Literal["left", "right"]], ...] = (
        *(("", "left"), ("changes", "right"), ("most of all", "left"), ("CPU time", "right"), ("a substep", "right")),
        *(("FMU", "right"), ("variables", "right"), ("memory", "right")),
    )
    for one in found:
        title = Text(f"{one.title}: {one.phase}", style="table.title")
        table = Table(title=title, title_justify="left", box=None, pad_edge=False)
        for head, side in heads:
            table.add_column(head, justify=side, overflow="fold")
        here = one.effects[0]
        for effect in one.effects:
            change = (
                "" if effect is here else percent(effect.change) if effect.quantity else f"< {percent(effect.floor)}"
            )
            cells = (effect.label, change, effect.quantity, *_costs(effect, here))
            table.add_row(*map(Text, cells))
        console.print(table)
        console.print()


def _costs(effect: Effect, here: Effect) -> Iterator[str]:
    if effect is here:
        per_step = "" if math.isnan(here.per_step) else f"{1e9 * here.per_step:,.0f} ns"
        yield from (f"{here.cpu:.3g} s", per_step, f"{here.bytes:,} B", f"{here.variables:,}", f"{here.memory:,} B")
        return
    yield f"x {effect.cpu / here.cpu:.3g}"
    yield "" if math.isnan(effect.per_step) else f"{1e9 * effect.per_step:,.0f} ns"
    for own, other in ((effect.bytes, here.bytes), (effect.variables, here.variables), (effect.memory, here.memory)):
        yield f"{own - other:+,}"


def as_dict(found: Sequence[Found]) -> dict[str, Any]:
    """For machines: SI, shares as they are."""
    return {
        one.phase: {"effects": {effect.label: vars(effect) for effect in one.effects}, "notes": one.notes}
        for one in found
    }
