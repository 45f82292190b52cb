"""The choices there are for computing a phase, as the settings that make them.

They lie on axes. Along an axis errors are counted from its finest setting; what a scene errs by is the sum over all.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from dcone_cosim import build
from dcone_cosim.cases.changes import changes_of, following
from dcone_cosim.scene.data import PhaseScene
from dcone_cosim.units import written

NUMERICS, MACRO_STEP, COUPLING = "scheme and step", "macro step", "coupling step"
MACRO_FACTORS = (10.0, 5.0, 2.0, 1.0, 0.5, 0.2)
COUPLING_FACTORS = (4.0, 2.0, 1.0, 0.5, 0.2, 0.1)
FEWEST_STEPS = 8
"""Macro steps that a phase keeps."""


@dataclass(frozen=True)
class Setting:
    """One choice.

    axis       along which it lies
    family     those that differ in one number: a line of the figure
    size       that number over its default, or over the scene's own: what the error falls with [1]
    changes    `KEY=VALUE`, as `--set` takes them; none for the scene as it is
    peer       it is another program's
    partial    not everything that it shows is meant, as with a scheme for the net's shape alone: it is never advised
    detail     its scheme is the scene's own, on another level of detail or at another pace: it judges none
    tolerance  its size is a tolerance, not a step: errors fall with it as they will
    """

    axis: str
    family: str
    size: float
    changes: tuple[str, ...]
    peer: bool = False
    partial: bool = False
    detail: bool = False
    tolerance: bool = False

    @property
    def label(self) -> str:
        return f"{self.family} x {self.size:g}"


def judges(settings: Sequence[Setting]) -> list[Setting]:
    """Of an axis: its reference, the finest setting of the scene's own family, and those one of which judges it.

    They are the finest of every other scheme that means all it shows, in full precision; without one, and along other
    axes, the next finer setting of the family.

    settings    of that axis, those of the scene's own family first
    """
    own = [s for s in settings if s.family == settings[0].family]
    reference = min(own, key=lambda s: s.size)
    others: dict[str, Setting] = {}
    for one in settings:
        if one in own or one.peer or one.detail or one.partial or "single" in one.family:
            continue
        if one.family not in others or one.size < others[one.family].size:
            others[one.family] = one
    if reference.axis == NUMERICS and others:
        return [reference, *others.values()]
    rest = [s for s in own if s is not reference]
    return [reference, *([min(rest, key=lambda s: s.size)] if rest else [])]


def settings_of(phase: PhaseScene, refine: bool, notes: list[str]) -> list[Setting]:
    """All settings of a phase by axes, each family coarse to fine, the first family of an axis that of the scene.

    refine     those too that refine the model itself, which are dear
    notes      gets which choices are not for this scene, and why
    """
    found = [] if phase.main.fmu is not None else list(_of_model(phase, notes))
    if refine and phase.main.fmu is None:
        found += _refinements(phase)
    found += _macro_steps(phase)
    found += _coupling_steps(phase)
    return found


def _of_model(phase: PhaseScene, notes: list[str]) -> Iterator[Setting]:
    main = phase.main
    yield from _rungs(phase, main.terms, main.values, ())
    groups = build.CATALOGUE[main.model].groups
    for name in build.numerics(main.model):
        if name in groups:
            yield from _others(phase, name, groups[name].terms, notes)
    for name in (*build.beside(main.model), *build.details(main.model)):
        others = _others(phase, name, groups[name].terms, notes)
        yield from (replace(setting, detail=True) for setting in others)


def _others(phase: PhaseScene, name: str, choices: Iterable[str], notes: list[str]) -> Iterator[Setting]:
    """Those with another term of a group."""
    main, model = phase.main, build.CATALOGUE[phase.main.model]
    group = model.groups[name]
    key = f"{phase.name}.{group.table or name}.{group.selector}"
    for term in choices:
        if term == main.terms.get(name):
            continue
        terms = {**main.terms, name: term}
        clashing = [other for _, other in model.clashing(terms)]
        if clashing:
            tables = " and ".join(f"[{phase.name}.{other}]" for other in clashing)
            notes.append(f"{phase.name}: {term} is not for this scene: it cannot go together with {tables}")
            continue
        interface = model.interface(terms)
        values = {**build.defaults(interface), **main.given}
        yield from _rungs(phase, interface.terms, values, (f'{key}="{term}"',))


def _refinements(phase: PhaseScene) -> Iterator[Setting]:
    main = phase.main
    for name, rungs in build.refinements(main.model, main.values, main.terms).items():
        yield from (
            Setting(name, name, r.size, (*following(phase, r.values), *changes_of(phase, r.values))) for r in rungs
        )


def _rungs(
    phase: PhaseScene, terms: Mapping[str, str], values: Mapping[str, float], changes: tuple[str, ...]
) -> Iterator[Setting]:
    model = phase.main.model
    groups = build.CATALOGUE[model].groups
    named = [terms[name] for name in build.numerics(model) if name in terms]
    named += [terms[name] for name in build.beside(model) if terms[name] != groups[name].default]
    named += [terms[name] for name in build.details(model) if name in terms]
    family = ", ".join(named) or "tolerances"
    partial, tolerance = not build.whole(model, terms), build.by_tolerance(model)
    for rung in build.rungs(model, values, terms):
        made = (*changes, *changes_of(phase, rung.values))
        yield Setting(NUMERICS, family, rung.size, made, partial=partial, tolerance=tolerance)


def _macro_steps(phase: PhaseScene) -> Iterator[Setting]:
    steps = phase.duration / phase.macro_step
    coupled = bool(phase.connections)
    for factor in MACRO_FACTORS:
        if factor == 1.0:
            yield Setting(MACRO_STEP, MACRO_STEP, factor, ())
        elif steps / factor >= FEWEST_STEPS and not (coupled and phase.coupling.step == 0.0):
            step = written(factor * phase.macro_step, "s")
            yield Setting(MACRO_STEP, MACRO_STEP, factor, (f"{phase.name}.macro_step={step}",))


def _coupling_steps(phase: PhaseScene) -> Iterator[Setting]:
    if not phase.connections:
        return
    by_error = phase.coupling.control == "error"
    size = phase.coupling.tolerance if by_error else phase.coupling.step or phase.macro_step
    name = "tolerance" if by_error else "step"
    for factor in COUPLING_FACTORS:
        if factor == 1.0:
            yield Setting(COUPLING, COUPLING, factor, (), tolerance=by_error)
        elif by_error or factor * size <= phase.macro_step * (1.0 + 1e-9):
            value = written(factor * size, "1" if by_error else "s")
            changes = (f"{phase.name}.coupling.{name}={value}",)
            yield Setting(COUPLING, COUPLING, factor, changes, tolerance=by_error)
