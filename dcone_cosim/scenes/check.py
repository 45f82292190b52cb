"""Puts a scene together from its document, and gathers every mistake into one message.

    the parts (components) and their keys -> values -> relations between the values -> `Scene`

Nothing is built for it: what a model of ours takes is known from its rows, what an FMU takes from the file.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path as File
from typing import Any

from dcone_cosim import build
from dcone_cosim.contract import CAPTURE_NEEDS, HAND_OVER, LINE, NEVER, check_contract, near_misses
from dcone_cosim.coupling.options import Connection, Coupling
from dcone_cosim.errors import InputError
from dcone_cosim.line import line_notes
from dcone_cosim.scenes.coupling import about_components, about_one_length, read_connections, read_coupling
from dcone_cosim.scenes.fmus import file_of, offer, opened
from dcone_cosim.scenes.keys import (
    COMPONENT_KEYS,
    FLAG,
    HANDOFF_KEYS,
    PHASE_KEYS,
    REQUIRED,
    SHARED,
    TOP,
    isolation,
    orbit_keys,
    read_snapshots,
    read_table,
    read_title,
    read_value,
    table_in,
)
from dcone_cosim.scenes.mistakes import Enough, Mistake, Mistakes, Places, SceneError, unknown
from dcone_cosim.scenes.parts import RESERVED, Part, follow, of_fmu, of_model, read_files, read_part, reserved_of
from dcone_cosim.scenes.relations import (
    about_hand_over,
    about_line,
    about_steps,
    about_values,
    phases_to_run,
    set_by_handoff,
)
from dcone_cosim.scenes.scene import PHASES, ComponentScene, PhaseScene, Scene
from dcone_cosim.scenes.toml_lines import Path


@dataclass
class _Component:
    """A part with its values."""

    part: Part
    options: dict[str, Any] = field(default_factory=dict)
    parameters: dict[str, float] = field(default_factory=dict)

    def scene(self) -> ComponentScene:
        return ComponentScene(
            self.part.name,
            self.part.model.name if self.part.model is not None and self.part.fmu is None else "",
            dict(self.part.terms) if self.part.fmu is None else {},
            self.part.fmu,
            isolation(self.options),
            self.options.get("timeout", ComponentScene.timeout),
            self.parameters,
            self.part.defaults(),
            self.part.choices(),
            self.options.get("solver_tolerance"),
            self.part.texts,
            self.part.tables,
        )


@dataclass
class _Phase:
    """One phase with its values."""

    main: _Component
    others: list[_Component] = field(default_factory=list)
    options: dict[str, Any] = field(default_factory=dict)
    connections: tuple[Connection, ...] = ()
    coupling: Coupling = field(default_factory=Coupling)


def check(document: dict[str, Any], name: str, places: Places, folder: File) -> Scene:
    """The scene, without its text, or a `SceneError` that lists the mistakes with their lines.

    folder    paths in the scene are relative to it
    """
    mistakes = Mistakes()
    try:
        return _checked(document, name, places, folder, mistakes)
    except Enough:
        raise SceneError(mistakes, places) from None


def _checked(document: dict[str, Any], name: str, places: Places, folder: File, mistakes: list[Mistake]) -> Scene:
    mistakes += [
        Mistake((phase,), document[phase], f"expected a table [{phase}]")
        for phase in PHASES
        if phase in document and not isinstance(document[phase], dict)
    ]
    known = (*TOP, *PHASES)
    mistakes += [unknown((key,), document[key], "unknown key", key, known) for key in document if key not in known]
    title = read_value(document["title"], read_title, ("title",), mistakes) if "title" in document else ""
    handoff = read_table(table_in(document, ("handoff",), mistakes), HANDOFF_KEYS, ("handoff",), mistakes)
    orbit = _orbit(document, mistakes)
    present = [phase for phase in PHASES if isinstance(document.get(phase), dict)]
    phases = {phase: _read_phase(phase, document[phase], orbit, folder, mistakes) for phase in present}
    chosen = phases_to_run(document, present, mistakes)
    mains = {phase: read.main.part for phase, read in phases.items()}
    if len(chosen) == len(PHASES):
        mistakes += set_by_handoff(document, mains["removal"])
    mistakes += about_hand_over(document, mains, chosen)
    mistakes += _about_contract(document, phases, chosen)
    if not mistakes and not chosen:
        raise InputError(f"{places.source} holds no phase; expected [capture], [removal] or both")
    if not mistakes:
        made = [_phase_scene(phase, phases[phase]) for phase in chosen]
        if len(made) == len(PHASES):
            _share_line(made)
        handoff = {key: bool(value) if HANDOFF_KEYS[key] is FLAG else value for key, value in handoff.items()}
        notes = tuple(_close_calls(phases, chosen))
        scene = Scene(name, title, "", tuple(made), handoff, places.source, places, notes)
        mistakes = [*about_steps(scene, document), *about_values(scene, document), *about_line(scene, document)]
        if not mistakes:
            return replace(scene, cautions=tuple(_cautions(scene)))
    raise SceneError(mistakes, places)


def _orbit(document: dict[str, Any], mistakes: list[Mistake]) -> dict[str, Any]:
    """The shared orbit; values of keys that no phase of the scene has are looked at here, the others by their parts."""
    orbit = table_in(document, (SHARED,), mistakes)
    keys = {key: known.expected for key, known in orbit_keys().items()}
    read_table(orbit, keys, (SHARED,), mistakes)
    return {key: value for key, value in orbit.items() if key in keys}


def _read_phase(
    phase: str, tables: dict[str, Any], orbit: dict[str, Any], folder: File, mistakes: list[Mistake]
) -> _Phase:
    model, path = build.MODELS[phase], (phase,)
    main = _read_component(Part(path, phase, model, reserved=reserved_of(phase)), tables, orbit, folder, mistakes)
    read = _Phase(main, options=_options(phase, tables, mistakes))
    components = table_in(tables, (*path, "components"), mistakes)
    for name, table in components.items():
        at: Path = (*path, "components", name)
        if not isinstance(table, dict):
            mistakes.append(Mistake(at, table, f"expected a table [{phase}.components.{name}]"))
        elif name in PHASES or "." in name or not name.strip():
            text = "cannot be the name of a component: expected one without a dot, and not that of a phase"
            mistakes.append(Mistake(at, table, text))
        else:
            read.others.append(_read_component(Part(at, name, reserved=RESERVED), table, orbit, folder, mistakes))
    parts = [main.part, *(component.part for component in read.others)]
    read.coupling = read_coupling(tables, path, parts, mistakes)
    mistakes += about_components(read.coupling, parts, tables)
    mistakes += about_one_length(read.options, read.coupling, parts, tables)
    if "connections" in tables:
        read.connections = read_connections(tables["connections"], (*path, "connections"), parts, mistakes)
    return read


def _options(phase: str, tables: dict[str, Any], mistakes: list[Mistake]) -> dict[str, Any]:
    """What concerns the phase itself, not its components."""
    found = {}
    for key, expected in PHASE_KEYS[phase].items():
        if key in tables:
            found[key] = read_value(tables[key], expected.read, (phase, key), mistakes)
        elif key in REQUIRED:
            mistakes.append(Mistake((phase, key), None, f'expected, such as "{expected.example}"'))
    if phase == "capture" and "snapshots" in tables:
        found["snapshots"] = read_value(tables["snapshots"], read_snapshots, (phase, "snapshots"), mistakes)
    return found


def _read_component(
    part: Part, tables: dict[str, Any], orbit: Mapping[str, Any], folder: File, mistakes: list[Mistake]
) -> _Component:
    """What a component is, and what the scene says of it."""
    read = _Component(part)
    for key, expected in COMPONENT_KEYS.items():
        if key in tables:
            read.options[key] = read_value(tables[key], expected.read, (*part.path, key), mistakes)
    if "timeout" in tables and not read.options.get("isolate", "fmu" in tables):
        text = "only calls to an isolated FMU have a limit; add isolate = true"
        mistakes.append(Mistake((*part.path, "timeout"), tables["timeout"], text))
    if "solver_tolerance" in tables and "fmu" not in tables:
        text = "a model of ours has tolerances of its own, in [solver]; only an FMU is told one"
        mistakes.append(Mistake((*part.path, "solver_tolerance"), tables["solver_tolerance"], text))
    if "fmu" in tables:
        if not _foreign(part, tables, folder, mistakes):
            return read
    elif part.model is not None:
        of_model(part, part.model, tables, mistakes)
    elif not _named_model(part, tables, mistakes):
        return read
    read_files(part, tables, folder, mistakes)
    read.parameters = read_part(part, tables, orbit, mistakes)
    follow(part, read.parameters)
    return read


def _foreign(part: Part, tables: dict[str, Any], folder: File, mistakes: list[Mistake]) -> bool:
    """Take what the FMU file offers; false when there is none to read."""
    path = (*part.path, "fmu")
    if "model" in tables and "model" in part.reserved:
        mistakes.append(Mistake((*part.path, "model"), tables["model"], "there is an fmu too: expected one of them"))
    file = read_value(tables["fmu"], lambda given: file_of(given, folder), path, mistakes)
    archive = read_value(tables["fmu"], lambda _: opened(file), path, mistakes) if file is not None else None
    if archive is None:
        return False
    with archive:
        part.fmu, part.archive = file, archive
        of_fmu(part, offer(archive.variables, part.model))
    return True


def _about_contract(document: dict[str, Any], phases: Mapping[str, _Phase], chosen: list[str]) -> Iterator[Mistake]:
    """What a phase needs of the FMU that takes the place of our model, and does not find there."""
    for name in chosen:
        part = phases[name].main.part
        if part.archive is not None:
            hand_over = _hand_over(phases[name]) if name == "capture" else NEVER
            for text in check_contract(part.archive, name, len(chosen) == len(PHASES), hand_over):
                yield Mistake((name, "fmu"), document[name]["fmu"], text)


def _close_calls(phases: Mapping[str, _Phase], chosen: list[str]) -> Iterator[str]:
    for name in chosen:
        archive = phases[name].main.part.archive
        if archive is not None:
            yield from near_misses(archive, name)
            if name == "removal" and len(chosen) == len(PHASES):
                yield from (f"{archive.path.name}: {note}" for note in line_notes(archive.variables))


def _cautions(scene: Scene) -> dict[str, None]:
    """What the models have to say of the values; each sentence once, be it of both phases."""
    found: list[str] = []
    for phase in scene.phases:
        main = phase.main
        if main.fmu is None:
            found += build.cautions(phase.name, {**main.defaults, **main.parameters}, main.parameters, main.terms)
    if len(scene.phases) == len(PHASES) and scene.phases[0].main.terms.get("gravity") == "none":
        found.append(
            'capture.gravity: law = "none" lets the orbital frame stand still in the capture; it turns in the removal, '
            "which takes the velocities handed over as seen in it (n r: 12 mm/s at 12 m in low orbit). "
            'law = "hill" turns it in both'
        )
    return dict.fromkeys(found)


def _named_model(part: Part, tables: dict[str, Any], mistakes: list[Mistake]) -> bool:
    """Take the model of ours that a further component names; false when there is none."""
    path, given = (*part.path, "model"), tables.get("model")
    if given is None:
        mistakes.append(Mistake(part.path, tables, 'expected a key fmu = "path.fmu" or model = "name" in it'))
        return False
    if not isinstance(given, str) or given not in build.CATALOGUE:
        mistakes.append(unknown(path, given, "expected the name of a model", str(given), build.CATALOGUE))
        return False
    of_model(part, build.CATALOGUE[given], tables, mistakes)
    return True


def _phase_scene(name: str, read: _Phase) -> PhaseScene:
    """The phase from values that have passed every check."""
    options = {key: read.options.get(key) for key in PHASE_KEYS[name] if key not in REQUIRED}
    if name == "capture":
        options["snapshots"] = read.options.get("snapshots") or []
        options["hand_over"] = _hand_over(read)
        options["after_capture"] = math.inf if options["after_capture"] is None else options["after_capture"]
    return PhaseScene(
        name,
        read.main.scene(),
        read.options["macro_step"],
        read.options["duration"],
        options,
        tuple(component.scene() for component in read.others),
        read.connections,
        read.coupling,
    )


def _hand_over(read: _Phase) -> str:
    """When the capture hands over: as told, otherwise at capture, or never where no capture can be reported."""
    told, part = read.options.get("hand_over"), read.main.part
    if told is not None:
        return HAND_OVER[int(told)]
    can_capture = all(group in part.terms for group in CAPTURE_NEEDS) if part.fmu is None else "captured" in part.slots
    return HAND_OVER[0] if can_capture else NEVER


def _share_line(phases: list[PhaseScene]) -> None:
    """Give the phase that does not tell the line's length what the other tells."""
    given = [phase.main.parameters.get(LINE[phase.name]) for phase in phases]
    for i, (phase, length, other) in enumerate(zip(phases, given, reversed(given), strict=True)):
        name = LINE[phase.name]
        if length is None and other is not None and name in phase.main.defaults:
            main = replace(phase.main, parameters={**phase.main.parameters, name: other})
            phases[i] = replace(phase, main=main)
