"""The settings that a scene's accuracy asks for, put in their places."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from dcone_cosim import build, measured
from dcone_cosim.phases import kind_of
from dcone_cosim.scene.data import Accuracy, Chosen, PhaseScene, Scene
from dcone_cosim.scene.mistakes import Mistake, Places, SceneError, unknown
from dcone_cosim.scene.toml_lines import given_at
from dcone_cosim.scenes.check import check
from dcone_cosim.scenes.keys import SOLVER
from dcone_cosim.scenes.text import override
from dcone_cosim.units import written


def settled(scene: Scene, document: Mapping[str, Any], name: str, places: Places, folder: Path) -> Scene:
    """The scene with the settings that its accuracy asks for; the others are those of `check`."""
    assert scene.accuracy is not None
    mistakes = faults(scene, scene.accuracy, document)
    if mistakes:
        raise SceneError(mistakes, places)
    chosen = {phase.name: chosen_of(phase, scene.accuracy, document) for phase in scene.phases}
    changed = copy.deepcopy(dict(document))
    override(changed, [change for one in chosen.values() if one is not None for change in one.changes])
    again = check(changed, name, places, folder)
    return replace(again, phases=tuple(replace(phase, chosen=chosen[phase.name]) for phase in again.phases))


def faults(scene: Scene, accuracy: Accuracy, document: Mapping[str, Any]) -> list[Mistake]:
    """Quantities that no phase has, and values that the accuracy is to choose."""
    found: list[Mistake] = []
    known = [name for phase in scene.phases for name in kind_of(phase.name).judged_by]
    anything = any(not kind_of(phase.name).judged_by or phase.main.fmu is not None for phase in scene.phases)
    for place, name in enumerate(accuracy.quantities):
        if name not in known and not anything:
            text = "no phase of this scene is judged by it"
            found.append(unknown((SOLVER, "quantities", place), name, text, name, known))
    for phase in scene.phases:
        main = phase.main
        if main.fmu is not None:
            continue
        chosen = {name for rung in build.rungs(main.model, main.values, main.terms) for name in rung.values}
        for name in sorted(chosen & main.parameters.keys()):
            text = f"is chosen by {SOLVER}.accuracy; leave one of them out"
            path = (phase.name, *name.split("."))
            found.append(Mistake(path, given_at(document, path), text))
    return found


def chosen_of(phase: PhaseScene, accuracy: Accuracy, tables: Mapping[str, Any]) -> Chosen | None:
    """What a phase is computed with; None where nothing was measured of it.

    tables    of the scene: a term that it names stays
    """
    main = phase.main
    if main.fmu is not None:
        return None
    groups = build.CATALOGUE[main.model].groups
    paths = {name: (phase.name, groups[name].table or name, groups[name].selector) for name in _numerics(main.model)}
    fixed = [name for name, path in paths.items() if given_at(tables, path) is not None]
    choice = measured.choose(main.model, main.terms, main.values, accuracy.asked, accuracy.quantities, fixed)
    if choice is None:
        return None
    entry, known = choice.entry, build.known_variables(main.model)
    changes = [
        f'{".".join(paths[name])}="{term}"' for name, term in entry.terms.items() if term != main.terms.get(name)
    ]
    for name, value in choice.parameters.items():
        changes.append(f"{phase.name}.{name}={written(value, known[name][0].unit)}")
    label = f"{', '.join(entry.terms.values()) or 'tolerances'} x {entry.size:g}"
    return Chosen(label, tuple(changes), entry.error(accuracy.quantities))


def _numerics(model: str) -> list[str]:
    return [name for name in build.numerics(model) if name in build.CATALOGUE[model].groups]
