"""Puts a scene together from its document, and gathers every mistake into one message.

    the parts (components) and their keys -> values -> relations between the values -> `Scene`

Nothing is built for it: what a model of ours takes is known from its rows, what an FMU takes from the file.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path as File
from typing import Any

from dcone_cosim import build
from dcone_cosim.contract import check_contract, near_misses
from dcone_cosim.coupling.options import Connection, Coupling
from dcone_cosim.errors import InputError
from dcone_cosim.phases import kind_of, kinds
from dcone_cosim.phases.phase import Document
from dcone_cosim.scene.data import SHARED, Accuracy, ComponentScene, HandoffOptions, LineScene, PhaseScene, Scene
from dcone_cosim.scene.mistakes import Enough, Mistake, Mistakes, Places, SceneError, unknown
from dcone_cosim.scene.toml_lines import Path
from dcone_cosim.scenes.alike import filled
from dcone_cosim.scenes.components import (
    RESERVED,
    follow,
    of_fmu,
    of_model,
    read_files,
    read_lines,
    read_part,
    reserved_of,
)
from dcone_cosim.scenes.coupling import about_components, about_one_length, read_connections, read_coupling
from dcone_cosim.scenes.fmus import file_of, offer, opened
from dcone_cosim.scenes.keys import (
    COMPONENT_KEYS,
    RANGES,
    REQUIRED,
    SIZING,
    SIZING_KEYS,
    SOLVER,
    SOLVER_KEYS,
    TOP,
    handoff_gone,
    handoff_keys,
    isolation,
    orbit_keys,
    phase_keys,
    read_table,
    read_title,
    read_value,
    table_in,
)
from dcone_cosim.scenes.lines import known_by_name, read_own, set_apart
from dcone_cosim.scenes.read_component import ReadComponent
from dcone_cosim.scenes.relations import about_sizes, about_steps, about_values, designed, laid, pairs, phases_to_run
from orbital.materials import Material


@dataclass
class _Component:
    """A part with its values."""

    part: ReadComponent
    options: dict[str, Any] = field(default_factory=dict)
    parameters: dict[str, float] = field(default_factory=dict)
    lines: dict[str, LineScene] = field(default_factory=dict)

    def scene(self) -> ComponentScene:
        defaults = self.part.defaults()
        ours = self.part.model if self.part.fmu is None else None
        only_here = build.asked_names(ours.name, self.part.terms) if ours is not None else set()
        asked = {name: self.parameters.get(name, defaults[name]) for name in defaults if name in only_here}
        return ComponentScene(
            self.part.name,
            ours.name if ours is not None else "",
            dict(self.part.terms) if self.part.fmu is None else {},
            self.part.fmu,
            isolation(self.options),
            self.options.get("timeout", ComponentScene.timeout),
            {name: value for name, value in self.parameters.items() if name not in only_here},
            {name: value for name, value in defaults.items() if name not in only_here},
            {name: names for name, names in self.part.choices().items() if name not in only_here},
            self.options.get("solver_tolerance"),
            self.part.texts,
            self.part.tables,
            tuple(sorted(self.part.unnamed)),
            asked,
            lines=self.lines,
            sources=self.part.sources,
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
    document = filled(document, mistakes)
    mistakes += [
        Mistake((phase,), document[phase], f"expected a table [{phase}]")
        for phase in kinds()
        if phase in document and not isinstance(document[phase], dict)
    ]
    known = (*TOP, *kinds())
    mistakes += [unknown((key,), document[key], "unknown key", key, known) for key in document if key not in known]
    title = read_value(document["title"], read_title, ("title",), mistakes) if "title" in document else ""
    given = table_in(document, ("handoff",), mistakes)
    gone = handoff_gone()
    mistakes += [Mistake(("handoff", key), given[key], gone[key]) for key in given if key in gone]
    given = {key: value for key, value in given.items() if key not in gone}
    handoff = read_table(given, handoff_keys(), ("handoff",), mistakes)
    orbit = _orbit(document, mistakes)
    accuracy, materials = _accuracy(document, mistakes), read_own(document, mistakes)
    sizing = _sizing(document, mistakes)
    present = [phase for phase in kinds() if isinstance(document.get(phase), dict)]
    phases = {phase: _read_phase(phase, document[phase], orbit, folder, materials, mistakes) for phase in present}
    mistakes[:] = [mistake for mistake in mistakes if not known_by_name(document, materials, mistake)]
    chosen = phases_to_run(document, present, mistakes)
    whole = Document(document, {phase: read.main.part for phase, read in phases.items()}, chosen)
    for phase in present:
        mistakes += kind_of(phase).faults(whole)
    mistakes += _about_contract(whole, phases)
    if not mistakes and not chosen:
        raise InputError(f"{places.source} holds no phase; expected {' or '.join(f'[{name}]' for name in kinds())}")
    if not mistakes:
        made = [_phase_scene(phase, phases[phase]) for phase in chosen]
        for after in range(1, len(made)):
            made[after - 1 : after + 1] = kind_of(made[after].name).joined(made[after - 1], made[after])
        flags = {key for key, expected in handoff_keys().items() if expected.kind == "Boolean"}
        named = {key: expected.choices for key, expected in handoff_keys().items() if expected.choices}
        handoff = {key: bool(value) if key in flags else value for key, value in handoff.items()}
        handoff |= {key: choices[int(handoff[key])] for key, choices in named.items() if key in handoff}
        parts = [one for read in phases.values() for one in (read.main, *read.others)]
        apart = (note for one in parts for note in set_apart(one.part.path, one.lines, places))
        notes = (*_close_calls(whole, phases), *apart)
        scene = Scene(
            name, title, "", tuple(made), HandoffOptions(**handoff), places.source, places, notes, (), accuracy, sizing
        )
        mistakes = list(about_steps(scene, document))
        scene, unlaid = laid(scene, document)
        if unlaid:
            raise SceneError([*mistakes, *unlaid], places)
        scene, undesigned = designed(scene, document)
        mistakes += undesigned or list(about_sizes(scene, document)) or about_values(scene, document)
        for before, own in pairs(scene):
            mistakes += kind_of(own.name).value_faults(before, own, document)
        if not mistakes:
            return replace(scene, cautions=tuple(_cautions(scene)))
    raise SceneError(mistakes, places)


def _accuracy(document: dict[str, Any], mistakes: list[Mistake]) -> Accuracy | None:
    """How exact the run is to be, None where the scene does not say."""
    table = table_in(document, (SOLVER,), mistakes)
    found = read_table(table, SOLVER_KEYS, (SOLVER,), mistakes)
    if table and "accuracy" not in table:
        mistakes.append(Mistake((SOLVER, "accuracy"), None, 'expected, such as "1 %"'))
    if "accuracy" not in found:
        return None
    return Accuracy(found["accuracy"], tuple(found.get("quantities", ())), int(found.get("runs", 1)))


def _sizing(document: dict[str, Any], mistakes: list[Mistake]) -> dict[str, Any]:
    """What the hardware is sized for, as far as the scene says."""
    table = table_in(document, (SIZING,), mistakes)
    found: dict[str, Any] = read_table(table, SIZING_KEYS, (SIZING,), mistakes, (RANGES,))
    sizes, values = (found.get(key, []) for key in ("flux_sizes", "flux_values"))
    given = "flux_sizes" in found or "flux_values" in found
    if given and (len(sizes) != len(values) or len(sizes) < 2 or sorted(set(sizes)) != sizes):
        text = "expected two or more sizes, the least first, and as many flux_values"
        mistakes.append(Mistake((SIZING, "flux_sizes"), table.get("flux_sizes"), text))
    for key, ends in table_in(table, (SIZING, RANGES), mistakes).items():
        if not isinstance(ends, list) or len(ends) != 2:
            text = 'expected the least and the largest value, such as ["-0.02 N", "-0.005 N"]'
            mistakes.append(Mistake((SIZING, RANGES, key), ends, text))
        else:
            found.setdefault(RANGES, {})[key] = [json.dumps(end) if not isinstance(end, str) else end for end in ends]
    return found


def _orbit(document: dict[str, Any], mistakes: list[Mistake]) -> dict[str, Any]:
    """The shared orbit; values of keys that no phase of the scene has are looked at here, the others by their parts."""
    orbit = table_in(document, (SHARED,), mistakes)
    keys = {key: known.expected for key, known in orbit_keys().items()}
    read_table(orbit, keys, (SHARED,), mistakes)
    return {key: value for key, value in orbit.items() if key in keys}


def _read_phase(
    phase: str,
    tables: dict[str, Any],
    orbit: dict[str, Any],
    folder: File,
    own: Mapping[str, Material],
    mistakes: list[Mistake],
) -> _Phase:
    model, path = build.CATALOGUE[kind_of(phase).model], (phase,)
    main = _read_component(
        ReadComponent(path, phase, model, reserved=reserved_of(phase)), tables, orbit, folder, own, mistakes
    )
    read = _Phase(main, options=_options(phase, tables, mistakes))
    components = table_in(tables, (*path, "components"), mistakes)
    for name, table in components.items():
        at: Path = (*path, "components", name)
        if not isinstance(table, dict):
            mistakes.append(Mistake(at, table, f"expected a table [{phase}.components.{name}]"))
        elif name in kinds() or "." in name or not name.strip():
            text = "cannot be the name of a component: expected one without a dot, and not that of a phase"
            mistakes.append(Mistake(at, table, text))
        else:
            read.others.append(
                _read_component(ReadComponent(at, name, reserved=RESERVED), table, orbit, folder, own, mistakes)
            )
    parts = [main.part, *(component.part for component in read.others)]
    read.coupling = read_coupling(tables, path, parts, mistakes)
    mistakes += about_components(read.coupling, parts, tables)
    mistakes += about_one_length(read.options, read.coupling, parts, tables)
    if "connections" in tables:
        read.connections = read_connections(tables["connections"], (*path, "connections"), parts, mistakes)
    return read


def _options(phase: str, tables: dict[str, Any], mistakes: list[Mistake]) -> dict[str, Any]:
    """What concerns the phase itself, not its components, as far as it is told."""
    found = {}
    for key, expected in phase_keys(phase).items():
        if key in tables:
            found[key] = read_value(tables[key], expected.read, (phase, key), mistakes)
        elif key in REQUIRED:
            mistakes.append(Mistake((phase, key), None, f'expected, such as "{expected.example}"'))
    return found


def _read_component(
    part: ReadComponent,
    tables: dict[str, Any],
    orbit: Mapping[str, Any],
    folder: File,
    own: Mapping[str, Material],
    mistakes: list[Mistake],
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
        of_model(part, part.model, tables, folder, mistakes)
    elif not _named_model(part, tables, folder, mistakes):
        return read
    read_files(part, tables, folder, mistakes)
    read.parameters = read_part(part, tables, orbit, mistakes)
    read.lines, follows = read_lines(part, tables, read.parameters, own, mistakes)
    read.parameters |= follows
    follow(part, read.parameters)
    return read


def _foreign(part: ReadComponent, tables: dict[str, Any], folder: File, mistakes: list[Mistake]) -> bool:
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


def _about_contract(document: Document, phases: Mapping[str, _Phase]) -> Iterator[Mistake]:
    """What a phase needs of the FMU that takes the place of our model, and does not find there."""
    for name in document.chosen:
        read, kind = phases[name], kind_of(name)
        archive = read.main.part.archive
        if archive is not None:
            after = document.after(name)
            hands_over = kind_of(after).takes if after else ()
            hand_over = kind.hand_over(kind.options(_own(kind.keys, read), read.main.part))
            for text in check_contract(archive, kind, bool(document.before(name)), hands_over, hand_over):
                yield Mistake((name, "fmu"), document.tables[name]["fmu"], text)


def _close_calls(document: Document, phases: Mapping[str, _Phase]) -> Iterator[str]:
    for name in document.chosen:
        archive = phases[name].main.part.archive
        if archive is not None:
            yield from near_misses(archive, kind_of(name))
            if document.before(name):
                yield from (f"{archive.path.name}: {note}" for note in kind_of(name).notes(archive.variables))


def _cautions(scene: Scene) -> dict[str, None]:
    """What the models have to say of the values; each sentence once, be it of several phases."""
    found: list[str] = []
    for phase in scene.phases:
        main = phase.main
        if main.fmu is None:
            found += build.cautions(phase.name, main.model, main.values, main.parameters, main.terms)
    for before, own in pairs(scene):
        found += kind_of(own.name).cautions(before, own)
    return dict.fromkeys(found)


def _named_model(part: ReadComponent, tables: dict[str, Any], folder: File, mistakes: list[Mistake]) -> bool:
    """Take the model of ours that a further component names; false when there is none."""
    path, given = (*part.path, "model"), tables.get("model")
    if given is None:
        mistakes.append(Mistake(part.path, tables, 'expected a key fmu = "path.fmu" or model = "name" in it'))
        return False
    if not isinstance(given, str) or given not in build.CATALOGUE:
        mistakes.append(unknown(path, given, "expected the name of a model", str(given), build.CATALOGUE))
        return False
    of_model(part, build.CATALOGUE[given], tables, folder, mistakes)
    return True


def _phase_scene(name: str, read: _Phase) -> PhaseScene:
    """The phase from values that have passed every check."""
    kind = kind_of(name)
    return PhaseScene(
        name,
        read.main.scene(),
        read.options["macro_step"],
        read.options["duration"],
        kind.options(_own(kind.keys, read), read.main.part),
        tuple(component.scene() for component in read.others),
        read.connections,
        read.coupling,
    )


def _own(keys: Mapping[str, Any], read: _Phase) -> dict[str, Any]:
    """The options of a phase that only its kind knows."""
    return {key: value for key, value in read.options.items() if key in keys and value is not None}
