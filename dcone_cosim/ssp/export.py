"""Packages of a scene: one .ssp per phase, for any tool that reads SSP 1.0.

Each FMU of ours starts with the scene's values by itself; the package tells them once more, where they can be changed.
"""

from __future__ import annotations

import math
import re
import zipfile
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path

from dcone_cosim import build, placed
from dcone_cosim.apart import exchange_step, ours, phases_apart
from dcone_cosim.coupling.options import Connection
from dcone_cosim.drafts import check_folder
from dcone_cosim.errors import InputError
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.fmu.steppable import NUMBERS, VariableInfo
from dcone_cosim.names import did_you_mean
from dcone_cosim.progress import Progress
from dcone_cosim.scene.data import ComponentScene, PhaseScene, Scene
from dcone_cosim.scratch import Scratch
from dcone_cosim.ssp.markup import RESOURCES, STRUCTURE
from dcone_cosim.ssp.writing import ComponentElement, Port, Structure, Value, Wire, parameter_set, structure
from dcone_cosim.units import read_units

EPOCH = (1980, 1, 1, 0, 0, 0)
"""The earliest time a zip archive can tell: what is written depends on the content alone."""
FORMS = ("inline", "ssv")
"""Where the structure has its values: in itself, or in the .ssv files, which are there in any case."""


@dataclass
class Exported:
    """The packages written, and what to tell of them."""

    paths: list[Path] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def export_scene(
    scene: Scene,
    out: Path,
    progress: Progress,
    from_run: Path | None = None,
    form: str = "inline",
    open_inputs: bool = True,
) -> Exported:
    """Write `SCENE-PHASE.ssp` for every phase of a scene.

    from_run       folder of a run of this scene: what takes over begins as it did there
    form           which of `FORMS` the structure binds its values in
    open_inputs    list inputs that nothing is connected to; fmpy's `simulate_ssp` cannot have them

    Checked  tests/cosim/test_ssp_export.py, tests/interop/test_ssp_tools.py
    """
    if form not in FORMS:
        raise InputError(f"--parameters {form}: expected {' or '.join(FORMS)}{did_you_mean(form, FORMS)}")
    check_folder(out)
    done = Exported()
    phases = phases_apart(scene, from_run, done.notes)
    wanted = {(p.name, name): fmu for p in phases for name, fmu in ours(scene, p).items()}
    with Scratch.temporary() as folder:
        written = build.write_fmus(list(wanted.values()), (), folder, progress.say)
        fmus = dict(zip(wanted, written, strict=True))
        fmus |= {(p.name, c.name): c.fmu for p in phases for c in p.components if c.fmu is not None}
        contents = [(phase.name, _package(scene, phase, fmus, form, open_inputs)) for phase in phases]
    made = [p for p in (out.absolute(), *out.absolute().parents) if not p.exists()]
    try:
        out.mkdir(parents=True, exist_ok=True)
        with Scratch(out) as draft:
            drafts = [_zip(draft / f"{scene.name}-{phase}.ssp", content) for phase, content in contents]
            for path in drafts:
                done.paths.append(placed.put(path, out / path.name))
    except BaseException:
        for folder in made:
            with suppress(OSError):
                folder.rmdir()
        raise
    return done


def _package(
    scene: Scene, phase: PhaseScene, fmus: Mapping[tuple[str, str], Path], form: str, open_inputs: bool
) -> dict[str, bytes]:
    """Files of a package by their path in it."""
    files: dict[str, bytes] = {}
    parts = []
    variables: dict[str, Mapping[str, VariableInfo]] = {}
    connected = {(c.target, c.input) for c in phase.connections}
    for component in phase.components:
        path = fmus[phase.name, component.name]
        source = f"{RESOURCES}/{component.name}.fmu"
        with Archive(path) as archive:
            part = _part(component, archive, source, None if open_inputs else connected)
            variables[component.name] = archive.variables
        files[source] = path.read_bytes()
        if part.values:
            values_at = f"{RESOURCES}/{component.name}.ssv"
            files[values_at] = parameter_set(part.values, part.units)
            part = replace(part, values_at=values_at if form == "ssv" else "")
        parts.append(part)
    content = Structure(
        identifier(f"{scene.name}_{phase.name}"),
        scene.title or scene.name,
        parts,
        [_wire(c, variables[c.source][c.output], variables[c.target][c.input]) for c in phase.connections],
        phase.start,
        phase.start + phase.duration,
        exchange_step(phase),
        _ours(phase),
    )
    return {STRUCTURE: structure(content), **files}


def identifier(name: str) -> str:
    """A name that OMSimulator takes: letters, digits and underscores, no digit in front."""
    made = re.sub(r"\W", "_", name, flags=re.ASCII)
    return made if made[:1].isalpha() else f"_{made}"


def _part(
    component: ComponentScene, archive: Archive, source: str, connected: set[tuple[str, str]] | None
) -> ComponentElement:
    """connected: inputs to list, by instance and name; None for all"""
    known = read_units(archive.description.unitDefinitions, str(archive.path))
    units = {name: unit for name, unit in known.items() if unit.dimension is not None}
    kinds = {row.name: row.type for row in archive.description.modelVariables if row.type in NUMBERS}
    rows = {name: archive.variables[name] for name in kinds}

    def unit(name: str) -> str:
        declared = rows[name].own.name
        return declared if kinds[name] == "Real" and declared in units else ""

    ports = [
        Port(row.name, row.causality, row.kind, unit(row.name))
        for row in rows.values()
        if row.causality == "output"
        or (row.causality == "input" and (connected is None or (component.name, row.name) in connected))
    ]
    values = [
        Value(name, rows[name].kind, rows[name].own.from_si(value), unit(name))
        for name, value in component.parameters.items()
        if name in rows and not math.isnan(value)
    ]
    return ComponentElement(component.name, source, ports, values, units)


def _wire(connection: Connection, out: VariableInfo, to: VariableInfo) -> Wire:
    """The connection between the values as the two FMUs count them; it is between SI values inside."""
    factor, offset = connection.factor, connection.offset
    if not (out.own.is_si and to.own.is_si):
        offset = to.own.from_si(factor * out.own.offset + offset)
        factor = factor * (out.own.factor / to.own.factor)
    return Wire((connection.source, out.name), (connection.target, to.name), factor, offset)


def _ours(phase: PhaseScene) -> dict[str, dict[str, str]]:
    """What a phase is beyond SSP, for our own master."""
    plan = {"name": phase.name, "main": phase.main.name}
    plan |= {"macro_step": repr(phase.macro_step), "duration": repr(phase.duration)}
    for key, value in vars(phase.options).items():
        if isinstance(value, str | float):
            plan[key] = value if isinstance(value, str) else repr(value)
        elif isinstance(value, list | tuple) and value:
            plan[key] = " ".join(map(repr, value))
    ours = {"Plan": plan}
    if phase.others:
        told = {key: value for key, value in vars(phase.coupling).items() if value}
        ours["Coupling"] = {k: " ".join(v) if isinstance(v, tuple) else str(v) for k, v in told.items()}
    return ours


def _zip(path: Path, content: Mapping[str, bytes]) -> Path:
    """An archive whose bytes depend on its content alone; stored, since the FMUs in it are compressed already."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as archive:
        for name in (STRUCTURE, *sorted(content.keys() - {STRUCTURE})):
            info = zipfile.ZipInfo(name, EPOCH)
            info.create_system = 3
            info.external_attr = 0o644 << 16
            archive.writestr(info, content[name])
    return path
