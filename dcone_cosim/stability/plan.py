"""The cells of a phase: every scheme at every extreme, each as a case to be run, or with the reason why it is none."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product

from dcone_cosim import build
from dcone_cosim.cases import ensemble
from dcone_cosim.cases.alone import Alone, Fmus
from dcone_cosim.cases.case import digest, key_of
from dcone_cosim.cases.changes import changes_of, following
from dcone_cosim.errors import InputError
from dcone_cosim.phases import kind_of
from dcone_cosim.quantities import spread_instants
from dcone_cosim.scene.data import PhaseScene, Scene
from dcone_cosim.stability.judge import EXCLUDED, LEFT, ORDER, Verdict, refusal
from dcone_cosim.stability.work import Cell
from dcone_cosim.units import written

INSTANTS = 120
"""At which curves are compared, at most."""
AS_IT_IS = build.Extreme("as it is", "the scene itself", "finite", chief=True)
STEPS = (100.0, 10.0, 0.1, 0.01)
"""Macro and coupling steps over a scene's own, of an FMU from elsewhere."""

FINER_STEP = 0.25
"""Of a run that is compared, over a step that an extreme sets."""
DIGITS = 17
"""Of a value: no bit of an edge may be lost."""


@dataclass(frozen=True)
class Scheme:
    """One way to compute a phase.

    name       as it stands in the table
    changes    settings that choose it
    without    tables of the phase that it cannot go together with
    lacks      extremes that there are not with it, by name, and why
    """

    name: str
    changes: tuple[str, ...] = ()
    without: tuple[str, ...] = ()
    lacks: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Planned:
    """A pair of extreme and scheme.

    case       None where there is none, then `found` says why
    changes    settings that make it
    """

    extreme: build.Extreme
    scheme: Scheme
    changes: tuple[str, ...]
    case: Cell | None = None
    found: Verdict | None = None

    @property
    def asked(self) -> str:
        """Key of the criterion that it is about."""
        return self.extreme.criterion if self.case is None else self.case.asked


@dataclass
class PhasePlan:
    """A phase and its cells, by extremes."""

    scene: Scene
    phase: str
    schemes: list[Scheme]
    extremes: list[build.Extreme]
    cells: list[Planned]

    @property
    def cases(self) -> list[Cell]:
        return [cell.case for cell in self.cells if cell.case is not None]


def plan(alone: Alone, phase: str, fmus: Fmus, limit: float, quick: bool) -> PhasePlan:
    """All cells of a phase, or the chief ones alone if there is little time.

    limit    CPU time that a case may take [s]
    """
    settings = tuple(f"{phase}.{setting}" for setting in kind_of(phase).to_its_end)
    base = alone.scene_of(phase, settings, to_its_end=True)
    own = base.phases[0]
    ours = own.main.fmu is None
    schemes = list(_schemes(own)) if ours else [Scheme("its own")]
    extremes = [AS_IT_IS, *(build.extremes(own.main.model, own.main.terms) if ours else ()), *_steps(own, ours)]
    if quick:
        extremes = [one for one in extremes if one.chief]
    maker = _Maker(alone, phase, settings, fmus, limit, quick)
    drafts = [
        Planned(extreme, scheme, (), found=Verdict(LEFT, "not in a quick look"))
        if quick and scheme is not schemes[0] and extreme is not AS_IT_IS
        else maker.draft(extreme, scheme)
        for extreme, scheme in product(extremes, schemes)
    ]
    fmus.make_ready(draft.made for draft in drafts if isinstance(draft, _Draft))
    cells = [maker.planned(draft) if isinstance(draft, _Draft) else draft for draft in drafts]
    return PhasePlan(base, phase, schemes, extremes, cells)


def _schemes(phase: PhaseScene) -> Iterator[Scheme]:
    """That of the scene first."""
    main = phase.main
    model = build.CATALOGUE[main.model]
    groups = [name for name in build.numerics(model.name) if name in model.groups]
    own = [main.terms[name] for name in groups]
    choices = sorted(product(*(model.groups[name].terms for name in groups)), key=lambda terms: list(terms) != own)
    for chosen in choices:
        terms = {**main.terms, **dict(zip(groups, chosen, strict=True))}
        beside = {name: model.groups[name].default for name in build.beside(model.name)}
        if not build.rungs(model.name, main.values, terms):
            terms |= beside
        named = [*chosen, *(terms[name] for name, usual in beside.items() if terms[name] != usual)]
        without = _left_out(model, terms, groups)
        changes = tuple(
            f'{phase.name}.{model.groups[name].table or name}.{model.groups[name].selector}="{terms[name]}"'
            for name in (*groups, *beside)
            if terms[name] != main.terms[name]
        )
        tables = tuple(model.groups[name].table or name for name in without)
        left = {name: term for name, term in terms.items() if name not in without}
        lacks = dict(_lacking(model.name, main.terms, left))
        yield Scheme(", ".join(named) or "its own", changes, tables, lacks)


def _lacking(model: str, all_terms: Mapping[str, str], terms: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Extremes of the parts of a phase that are gone, or that have nothing to act on, and why."""
    there = {one.name: one for one in build.extremes(model, terms)}
    gone = " and ".join(name for name in all_terms if name not in terms)
    for one in build.extremes(model, all_terms):
        missing = [group for group in one.needs if group not in terms]
        if one.name not in there or missing:
            yield one.name, f"goes without {' and '.join(missing) or gone}"


def _left_out(model: build.Model, terms: Mapping[str, str], numerics: Sequence[str]) -> list[str]:
    """Groups that a choice of numerics cannot go together with, and those that have nothing to act on then."""
    return _and_what_needs_them(model, terms, [other for group, other in model.clashing(terms) if group in numerics])


def _and_what_needs_them(model: build.Model, terms: Mapping[str, str], gone: Sequence[str]) -> list[str]:
    """Groups that are left out, and those that have nothing to act on then."""
    left, found = dict(terms), list(gone)
    while any(name in left for name in found):
        for name in found:
            left.pop(name, None)
        found += [group for group, needed in model.missing(left) if needed not in left]
    return list(dict.fromkeys(found))


def _steps(phase: PhaseScene, ours: bool) -> Iterator[build.Extreme]:
    """Macro steps of an FMU from elsewhere; coupling steps are those of `_Maker`."""
    if ours:
        return
    for factor in STEPS:
        step = factor * phase.macro_step
        if step <= phase.duration:
            about = "what an FMU from elsewhere lets be chosen"
            yield build.Extreme(f"macro step x {factor:g}", about, "finite", macro_step=step, chief=True)


@dataclass(frozen=True)
class _Draft:
    """A pair that can be run, before its FMU is there.

    made       its scene
    changes    settings that make it
    without    tables of the phase that it goes without
    asked      key of the criterion that it is about
    """

    extreme: build.Extreme
    scheme: Scheme
    made: Scene
    changes: tuple[str, ...]
    without: tuple[str, ...]
    asked: str


def _told(error: InputError) -> str:
    """What a scene's check said, without the file that it is about."""
    return str(error).splitlines()[-1].strip()


class _Maker:
    """Makes cells of one phase: drafts first, then, of those that can be run, the cases."""

    def __init__(
        self, alone: Alone, phase: str, settings: tuple[str, ...], fmus: Fmus, limit: float, quick: bool
    ) -> None:
        self._alone, self._phase, self._settings = alone, phase, settings
        self._fmus, self._limit, self._quick = fmus, limit, quick
        self._bases: dict[str, Scene] = {}

    def draft(self, extreme: build.Extreme, scheme: Scheme) -> _Draft | Planned:
        if extreme.name in scheme.lacks:
            return Planned(extreme, scheme, (), found=Verdict(EXCLUDED, scheme.lacks[extreme.name]))
        follows = self._phase != self._alone.phases[0]
        handed = [name for name in extreme.values if follows and kind_of(self._phase).takes_over(name)]
        if handed:
            why = f"goes without a {handed[0]} of its own: the phase before hands it over"
            return Planned(extreme, scheme, (), found=Verdict(EXCLUDED, why))
        why = self._idle(extreme) or self._unsuited(scheme)
        if why:
            return Planned(extreme, scheme, (), found=Verdict(EXCLUDED, why))
        try:
            made, changes, without = self._made(extreme, scheme)
        except InputError as error:
            return Planned(extreme, scheme, (), found=refusal(_told(error)))
        if made is None:
            return Planned(extreme, scheme, changes, found=Verdict(EXCLUDED, "goes without what it is about"))
        main = made.phases[0].main
        asked = build.instead(main.model, main.terms).get(extreme.criterion, extreme.criterion)
        if not asked:
            why = f"goes without {extreme.criterion}, which means nothing with it"
            return Planned(extreme, scheme, changes, found=Verdict(EXCLUDED, why))
        if asked == ORDER and kind_of(self._phase).rounding(made.phases[0]) is None:
            why = "goes without an order that could be seen: rounding is as large as its error"
            return Planned(extreme, scheme, changes, found=Verdict(EXCLUDED, why))
        return _Draft(extreme, scheme, made, changes, without, asked)

    def planned(self, draft: _Draft) -> Planned:
        try:
            case = self._cell(draft)
        except InputError as error:
            found = refusal(_told(error))
            return Planned(draft.extreme, draft.scheme, draft.changes, found=found)
        return Planned(draft.extreme, draft.scheme, draft.changes, case)

    def _idle(self, extreme: build.Extreme) -> str:
        """Why nothing would happen in it; "" where something would."""
        terms = self._alone.scene_of(self._phase).phases[0].main.terms
        found = [f'{group} = "{term}"' for group, term in extreme.idle.items() if terms.get(group) == term]
        return f"goes without anything that moves: {' and '.join(found)}" if found else ""

    def _unsuited(self, scheme: Scheme) -> str:
        """Why a part of the scene, as it is, does not go together with what the scheme changes; "" where all do."""
        try:
            self._base(scheme)
        except InputError as error:
            told = _told(error)
            if any(f"{change.partition('=')[0]} = " in told for change in scheme.changes):
                return f"does not go together with the scene: {told}"
        return ""

    def _base(self, scheme: Scheme) -> PhaseScene:
        if scheme.name not in self._bases:
            self._bases[scheme.name] = self._scene((*self._settings, *scheme.changes), scheme.without)
        return self._bases[scheme.name].phases[0]

    def _scene(self, changes: Sequence[str], without: Sequence[str]) -> Scene:
        return self._alone.scene_of(self._phase, changes, without, to_its_end=True)

    def _made(self, extreme: build.Extreme, scheme: Scheme) -> tuple[Scene | None, tuple[str, ...], tuple[str, ...]]:
        """The scene of a cell, None where it has no such variable; its settings, and the tables it goes without."""
        own = self._base(scheme)
        changes, without = [*self._settings, *scheme.changes], list(scheme.without)
        main = own.main
        if main.fmu is None:
            values = {**main.values, **main.asked}
            given = extreme.given(values)
            model = build.CATALOGUE[main.model]
            worked_out = model.interface(main.terms).follows  # no scene says these
            if any((name not in values and f"{name}[1]" not in values) or name in worked_out for name in given):
                return None, (), ()
            tables = {name: group.table or name for name, group in model.groups.items()}
            gone = [name for name, term in extreme.terms.items() if term is None]
            without += [tables[name] for name in _and_what_needs_them(model, main.terms, gone)]
            changes += [
                f'{self._phase}.{tables[name]}.{model.groups[name].selector}="{term}"'
                for name, term in extreme.terms.items()
                if term is not None
            ]
            changes += changes_of(own, given, DIGITS)
            numbers = {name: value for name, value in given.items() if not isinstance(value, Sequence)}
            followed = following(own, numbers)
            changes += [one for one in followed if one.split(".")[1] not in without]
        if extreme.duration:
            changes.append(f"{self._phase}.duration={written(extreme.duration, 's', DIGITS)}")
        step = extreme.macro_step or min(own.macro_step, extreme.duration or own.macro_step)
        if step != own.macro_step:
            changes.append(f"{self._phase}.macro_step={written(step, 's', DIGITS)}")
        return self._scene(changes, without), tuple(changes), tuple(without)

    def _cell(self, draft: _Draft) -> Cell:
        made, changes, without = draft.made, draft.changes, draft.without
        own = made.phases[0]
        main = own.main
        kind = kind_of(self._phase)
        first = 0.0 if kind.own_clock else own.start
        same = draft.asked == "same"
        finer, scatters = None, draft.extreme.scatters
        if same:
            step = written(min(self._alone.scene_of(self._phase).phases[0].macro_step, own.duration), "s", DIGITS)
            finer = self._scene((*changes, f"{self._phase}.macro_step={step}"), without)
            instants: tuple[float, ...] = (first + own.duration,)
        else:
            instants = spread_instants(first, own.duration, own.macro_step, INSTANTS)
            finest = self._finest(own, draft.extreme)
            try:
                finer = self._scene((*changes, *finest), without) if finest else None
            except InputError as error:
                scatters = f"that is refused: {_told(error)}"
        jittered = None
        if not same and main.fmu is None:
            try:
                jittered = self._scene((*changes, *ensemble.jitter(made, 1)), without)
            except InputError:
                if kind.chaotic:
                    raise
        how = (draft.asked, self._limit, instants)
        key = digest(key_of(made, self._fmus.of(made), 1), *how, same, scatters, self._quick)
        return Cell(key, made, changes, {}, 1, *how, finer, jittered, same, scatters, self._quick)

    def _finest(self, own: PhaseScene, extreme: build.Extreme) -> tuple[str, ...]:
        """Settings that compute it as finely as its model says is enough for a reference, or in a quarter of the step
        where the extreme sets one."""
        main = own.main
        if main.fmu is not None:
            return (f"{self._phase}.macro_step={written(min(STEPS) * own.macro_step, 's', DIGITS)}",)
        values = main.values
        rungs = build.rungs(main.model, values, main.terms)
        finest = rungs[-1].values if rungs else {}
        quartered = {name: FINER_STEP * values[name] for name in finest if name in extreme.values}
        groups = build.CATALOGUE[main.model].groups
        others = tuple(
            f'{self._phase}.{groups[name].table or name}.{groups[name].selector}="{term}"'
            for name, term in build.reference(main.model, main.terms).items()
        )
        return (*others, *changes_of(own, {**finest, **quartered}, DIGITS))
