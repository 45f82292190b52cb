"""From a package to a scene, which the master runs like any other.

The scene has one phase. It is of a kind that is known when our own annotation says so or its main component offers
what such a kind is recognised by; any other system is a phase by its own name, stepped from its start to its stop.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from dcone_cosim.errors import FmuError
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.phases import kind_of
from dcone_cosim.scene.data import ComponentScene, PhaseScene, Scene
from dcone_cosim.scene.mistakes import Places
from dcone_cosim.scene.toml_lines import given_at
from dcone_cosim.scenes.keys import isolation
from dcone_cosim.scenes.text import override, setting, titled
from dcone_cosim.scratch import Scratch
from dcone_cosim.ssp import matching, planning
from dcone_cosim.ssp.export import identifier
from dcone_cosim.ssp.markup import STRUCTURE
from dcone_cosim.ssp.matching import PackageComponent
from dcone_cosim.ssp.package import Mistakes, Package, entry_of
from dcone_cosim.ssp.parsing import Document, document, read
from dcone_cosim.ssp.values import given_values


def load(path: Path, settings: Sequence[str] = (), shown_name: str = "") -> Scene:
    """The scene that a package holds, checked; an `InputError` lists every mistake found.

    settings    `PHASE.macro_step=0.1 s`, `COMPONENT.isolate=true`, `COMPONENT.VARIABLE=VALUE`, each in the place of
                what the package says
    shown_name  of the scene; that of the file if not given

    Checked  tests/cosim/test_ssp_bad.py, tests/cosim/test_ssp_export.py
    """
    mistakes = Mistakes(str(path))
    folder = Scratch.temporary()
    with Package(path) as package:
        text = package.read(STRUCTURE)
        root = read(text, STRUCTURE, "ssd:SystemStructureDescription", mistakes)
        mistakes.check()
        assert root is not None, "without a mistake there is a structure"
        content = document(root, STRUCTURE, mistakes)
        parts = _parts(content, package, folder.path, mistakes)
        mistakes.check()
        for part in parts.values():
            matching.check_ports(part, content.units, mistakes)
        values = list(given_values(content.bindings, package, mistakes))
    parameters = matching.parameters(values, parts, mistakes)
    connections = matching.connections(content.connections, parts, mistakes)
    name, main = planning.name_and_main(content, parts)
    changes: dict[str, Any] = {}
    overrides = override(changes, settings)
    told, run, more = planning.settings_of(changes, overrides, name, parts)
    start, duration = planning.times(content, parts, told, mistakes)
    if kind_of(name).begins_at_zero and start != 0.0:
        mistakes.add(STRUCTURE, None, f"startTime = {start!r}: a {name} begins at 0")
    given = {part: parameters[part] | more.get(part, {}) for part in parts}
    components = {
        part: ComponentScene(
            part,
            fmu=row.fmu,
            isolate=isolation(run.get(part, {})),
            timeout=run.get(part, {}).get("timeout", ComponentScene.timeout),
            parameters={name: value for name, value in given[part].items() if not isinstance(value, str)},
            texts={name: value for name, value in given[part].items() if isinstance(value, str)},
            defaults=row.defaults(),
            tolerance=told.get("solver_tolerance"),
        )
        for part, row in parts.items()
    }
    options = planning.options(name, content.ours.get("Plan", {}), told, mistakes)
    phase = PhaseScene(
        name,
        components[main],
        planning.macro_step(content, parts, duration, told, mistakes),
        duration,
        options,
        tuple(row for part, row in components.items() if part != main),
        connections,
        planning.coupling(content.ours.get("Coupling", {}), parts, mistakes),
        start,
        folder,  # with the unpacked FMUs
    )
    mistakes.check()
    shown = text.decode("utf-8", "replace")
    rows = {change.path: setting(change.path, given_at(changes, change.path)) for change in overrides}
    title = titled(content.description, list(rows.values()))
    places = Places(str(path), "", tuple(overrides))
    return Scene(
        shown_name or path.stem, title, shown, (phase,), source=str(path), places=places, notes=tuple(mistakes.ignored)
    )


def _parts(content: Document, package: Package, folder: Path, mistakes: Mistakes) -> dict[str, PackageComponent]:
    """Every component with its FMU, unpacked and opened once to see what it offers."""
    parts = {}
    for number, (name, row) in enumerate(content.components.items()):
        entry, reason = entry_of(row.get("source"), package.names, mistakes)
        if reason:
            mistakes.add(STRUCTURE, row.sourceline, f"<ssd:Component> {name!r}: {reason}")
            continue
        fmu = package.unpack(entry, folder, f"{number}-{identifier(Path(entry).stem)}")
        try:
            with Archive(fmu) as archive:
                parts[name] = PackageComponent(name, row, fmu, archive.variables, archive.description.defaultExperiment)
        except FmuError as error:
            said = str(error).replace(str(fmu), entry)
            mistakes.add(STRUCTURE, row.sourceline, f"<ssd:Component> {name!r}: {said}")
    return parts
