"""Checks across the values of a scene: each is well formed, and yet they do not go together."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any

from dcone_cosim import build
from dcone_cosim.contract import NEVER
from dcone_cosim.phases import kind_of, kinds
from dcone_cosim.scene.data import SHARED, PhaseScene, Scene
from dcone_cosim.scene.mistakes import Mistake, shown, unknown
from dcone_cosim.scene.toml_lines import Path, given_at
from dcone_cosim.scenes.keys import MOST_STEPS

PHYSICAL = {"kg": (1e-15, 1e24), "kg/m3": (1e-20, 1e6), "Pa": (1e-9, 1e20)}
"""From the least to the most that a scene may say of these, by unit: a grain of pollen to the Earth, the air of the
highest orbits to fifty times osmium, what is far below the pressure of light to what is far stiffer than a net a
million times as stiff as Kevlar, which a stability report tries."""


def phases_to_run(document: dict[str, Any], present: list[str], mistakes: list[Mistake]) -> list[str]:
    """The phases in their order: those that `phases` names, or all that have a table."""
    given = document.get("phases")
    if given is None:
        _check_order(present, ("phases",), None, mistakes)
        return present
    path: Path = ("phases",)
    if not isinstance(given, list) or not given or not all(isinstance(name, str) for name in given):
        mistakes.append(Mistake(path, given, 'expected a list such as ["capture", "removal"]'))
        return present
    for name in dict.fromkeys(given):
        if name not in kinds():
            mistakes.append(unknown(path, given, f"unknown phase {name!r}", name, kinds()))
        elif name not in document:
            mistakes.append(Mistake(path, given, f"the phase has no table; expected [{name}]"))
    known = [name for name in given if name in kinds()]
    in_order = [name for name in kinds() if name in given]
    if len(known) > len(in_order):
        mistakes.append(Mistake(path, given, f"names a phase twice; expected {shown(in_order)}"))
    elif known != in_order:
        first, late = next((a, b) for a, b in zip(in_order, known, strict=True) if a != b)
        mistakes.append(Mistake(path, given, f"the {first} comes before the {late}; expected {shown(in_order)}"))
    elif len(known) == len(given):
        _check_order(in_order, path, given, mistakes)
    return [name for name in in_order if name in present]


def _check_order(phases: Sequence[str], path: Path, given: object, mistakes: list[Mistake]) -> None:
    """Each phase after the first takes over from the one before it; some can be no scene's first."""
    for before, name in zip(("", *phases), phases, strict=False):
        kind = kinds()[name]
        if before not in kind.follows and (before or not kind.alone):
            own = path if given is not None else (name,)
            found = f"comes after the {before}" if before else "comes first"
            text = f"the {name} {found}; expected a {' or a '.join(kind.follows) or 'scene of its own'} before it"
            mistakes.append(Mistake(own, given, text))


def about_steps(scene: Scene, document: dict[str, Any]) -> Iterator[Mistake]:
    """Macro steps that are too long or too many, and coupling steps that are longer than they."""
    for phase in scene.phases:
        path: Path = (phase.name, "macro_step")
        given, duration = given_at(document, path), shown(document[phase.name]["duration"])
        steps = phase.duration / phase.macro_step
        if phase.macro_step > phase.duration:
            yield Mistake(path, given, f"must be at most {phase.name}.duration, {duration}")
        elif steps > MOST_STEPS:
            text = f"with {phase.name}.duration = {duration} makes {steps:.4g} steps; at most {MOST_STEPS:,}"
            yield Mistake(path, given, text)
        if phase.coupling.step > phase.macro_step:
            at = (phase.name, "coupling", "step")
            yield Mistake(at, given_at(document, at), f"must be at most {phase.name}.macro_step, {shown(given)}")


def about_sizes(scene: Scene, document: dict[str, Any]) -> Iterator[Mistake]:
    """Values of our models that are above zero and yet no body's or material's: no step would be short enough."""
    for phase in scene.phases:
        for component in phase.components:
            if component.fmu is not None:
                continue
            above: Path = (phase.name,) if component is phase.main else (phase.name, "components", component.name)
            for row in build.settable(build.CATALOGUE[component.model].interface(component.terms)):
                least, most = PHYSICAL.get(row.unit, (0.0, math.inf))
                given = [component.parameters.get(name, 0.0) for name in row.element_names()]
                if any(value and not least <= abs(value) <= most for value in given):
                    path = (*above, row.section, row.key)
                    text = f"is no such quantity of a body or a material: {least:g} to {most:g} {row.unit}"
                    yield Mistake(path, given_at(document, path), text)


def about_values(scene: Scene, document: dict[str, Any]) -> Iterator[Mistake]:
    """Values, each within its bounds, with which a phase of ours cannot work; of a foreign FMU nothing is known."""
    for phase in scene.phases:
        if phase.main.fmu is not None:
            continue
        handed_over = phase is not scene.phases[0]
        must_arrive_in = math.inf if kind_of(phase.name).hand_over(phase.options) == NEVER else phase.duration
        for refusal in build.cannot_work(
            phase.main.model, phase.main.values, must_arrive_in, phase.main.terms, handed_over
        ):
            section, _, key = refusal.variable.partition(".")
            path = (section, key) if section == SHARED else (phase.name, section, key.partition("[")[0])
            yield Mistake(path, given_at(document, path), refusal.expected, refusal.given)


def pairs(scene: Scene) -> Iterator[tuple[PhaseScene | None, PhaseScene]]:
    """Each phase with the one before it, None for the first."""
    return zip((None, *scene.phases), scene.phases, strict=False)


def laid(scene: Scene, document: dict[str, Any]) -> tuple[Scene, list[Mistake]]:
    """The scene with the tables that parts make of what it gives them, and what parameters follow; mistakes where they
    can make none, or it says such a parameter too."""
    found: list[Mistake] = []
    for phase in scene.phases:
        main = phase.main
        if main.fmu is not None or not build.lays(main.model, main.terms, main.sources):
            continue
        answer = build.laid(main.model, {**main.values, **main.asked}, main.sources, main.terms)
        if isinstance(answer, build.Refusal):
            path: Path = (phase.name, *answer.variable.split("."))
            found.append(Mistake(path, given_at(document, path), answer.expected, answer.given))
            continue
        found += _said_too(answer.parameters, phase, document)
        parameters = {**main.parameters, **answer.parameters}
        main = replace(main, parameters=parameters, laid=answer.tables, shown=answer.shown)
        scene = scene.with_phase(replace(phase, main=main))
    return scene, found


def _said_too(names: Iterable[str], phase: PhaseScene, document: dict[str, Any]) -> Iterator[Mistake]:
    """Parameters that follow, and that a scene says all the same."""
    for name in names:
        if name in phase.main.parameters:
            path = (phase.name, *name.partition("[")[0].split("."))
            text = "follows from what this scene asks for; leave one of them out"
            yield Mistake(path, given_at(document, path), text)


def designed(scene: Scene, document: dict[str, Any]) -> tuple[Scene, list[Mistake]]:
    """The scene with the parameters that follow from what it asks; mistakes where none do, or it says them too."""
    found: list[Mistake] = []
    for before, phase in pairs(scene):
        main = phase.main
        if not main.asked:
            continue
        taken = kind_of(phase.name).values_taken(before) if before is not None else {}
        answer = build.designed(main.model, {**main.values, **taken}, main.asked, main.terms)
        if isinstance(answer, build.Refusal):
            path: Path = (phase.name, *answer.variable.split("."))
            found.append(Mistake(path, given_at(document, path), answer.expected, answer.given))
            continue
        found += _said_too(answer, phase, document)
        parameters = {**main.parameters, **answer}
        scene = scene.with_phase(replace(phase, main=replace(main, parameters=parameters, designed=tuple(answer))))
    return scene, found
