"""The phases of a scene each by itself, as other tools are given them.

A phase that follows a hand-off begins with what the one before hands over. The scene alone does not know that; the
folder of a run does.
"""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from dcone_cosim import build
from dcone_cosim.errors import InputError
from dcone_cosim.files import regular
from dcone_cosim.level import with_term
from dcone_cosim.phases import kind_of
from dcone_cosim.scene.data import ComponentScene, PhaseScene, Scene


def phases_apart(scene: Scene, from_run: Path | None, notes: list[str]) -> list[PhaseScene]:
    """The phases as they are to be written, each to be run by itself.

    from_run     folder of a run of this scene: what takes over begins as it did there
    notes        gets what is to be told of phases that begin otherwise than in a run of the scene
    """
    if len(scene.phases) == 1 and from_run is not None:
        raise InputError(f"--from-run {from_run}: {scene.source or scene.name} has no hand-off to take from a run")
    phases = [kind_of(phase.name).by_itself(phase) for phase in scene.phases[:-1]] + list(scene.phases[-1:])
    made = phases[:1]
    for before, phase in itertools.pairwise(phases):
        alone = _handed_over(scene, phase, from_run) if from_run is not None else _begun_alone(before, phase, notes)
        made += [alone] if alone is not None else []
    return made


def _begun_alone(before: PhaseScene, phase: PhaseScene, notes: list[str]) -> PhaseScene | None:
    """A phase that would take over, with the scene's own start; None where by that it cannot begin."""
    own, other = kind_of(phase.name).spoken or phase.name, kind_of(before.name).spoken or before.name
    begins = f"the {own} begins with what the {other} hands over, which the scene alone does not tell"
    how = "run the scene, then name its folder with --from-run"
    refusals = build.cannot_work(phase.main.model, phase.main.values, phase.duration, phase.main.terms, False)
    if refusals:
        first = refusals[0]
        reason = f"by itself it cannot begin: {first.variable} = {first.given} {first.expected}"
        notes.append(f"{begins}; {reason}. It is left out: {how}")
        return None
    notes.append(f"{begins}. It is written with the scene's own start, both at rest on one orbit: {how}")
    return phase


def _unlike(scene: Scene, told: Mapping[str, Any]) -> str:
    """How the scene of a run differs from this one, and what to do about it."""
    if told.get("scene") != scene.name:
        return f"that run was of another scene, {told.get('scene')!r}; expected one of {scene.name!r}"
    settings = " ".join(f"--set {setting!r}" for setting in told.get("settings", []))
    if settings:
        return f"that run of {scene.name!r} had other values than asked for here; its own are {settings}"
    return f"that run of {scene.name!r} had other values than the scene has here; run it again"


def _handed_over(scene: Scene, own: PhaseScene, folder: Path) -> PhaseScene:
    """A phase as a run of the scene began it."""
    told = _json(folder, "provenance.json")
    kept = folder / "scene.toml"
    same = kept.is_file() and scene.source and Path(scene.source).is_file() and kept.samefile(scene.source)
    if not same and told.get("scene_sha256") != scene.sha256:
        raise InputError(f"--from-run {folder}: {_unlike(scene, told)}; or export its own, {kept}")
    phase = told.get("phases", {}).get(own.name)
    if phase is None:
        said = told.get("message") or told.get("status")
        raise InputError(f"--from-run {folder}: that run has no {own.name}: {said}")
    start = float(phase["origin"]["value"]) + float(phase["start"]["value"])
    parameters = {name: float(value) for name, value in {**phase["parameters"], **phase.get("given", {})}.items()}
    main = own.main
    for group, term in phase.get("terms", {}).items():
        if main.terms.get(group) != term:  # what was handed over needed another than the scene's own
            main = with_term(main, group, term)
    return replace(own, main=replace(main, parameters=parameters), start=start)


def _json(folder: Path, name: str) -> dict[str, Any]:
    try:
        content: dict[str, Any] = json.loads(regular(folder / name).read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"--from-run {folder}: {name}: {error.strerror}; expected the folder of a run") from error
    except ValueError as error:
        raise InputError(f"--from-run {folder}: {name} is not valid JSON ({error})") from error
    return content


def exchange_step(phase: PhaseScene) -> float:
    """The one step that another tool has for a phase [s]: that at which several components exchange values."""
    return (phase.others and phase.coupling.step) or phase.macro_step


def ours(scene: Scene, phase: PhaseScene) -> dict[str, build.Furnished]:
    """The FMUs of our models in a phase, by component: with the scene's values, and for the phase's times.

    Files are named SCENE-PHASE, that of a further component SCENE-PHASE-COMPONENT.
    """
    experiment = build.Experiment(
        phase.start, phase.start + phase.duration, exchange_step(phase), build.printable(scene.name)
    )
    return {
        c.name: build.Furnished(
            _file_name(scene, phase, c),
            c.model,
            c.terms,
            _numbers(c.parameters),
            experiment,
            c.numbers,
        )
        for c in phase.components
        if c.fmu is None
    }


def _file_name(scene: Scene, phase: PhaseScene, component: ComponentScene) -> str:
    return "-".join([scene.name, phase.name, *([component.name] if component is not phase.main else [])])


def _numbers(values: Mapping[str, float]) -> dict[str, float]:
    """Without what is not known."""
    return {name: value for name, value in values.items() if not math.isnan(value)}
