"""What the folder of a run keeps so that the run can be made again from it alone, wherever it is moved to.

    scene.toml, fmus/*.fmu, tables/*          a scene as run, with copies of the FMUs and tables that it names
    system.ssp, SystemStructure.ssd           a package as it was, and its structure to be read by people

`dcone run FOLDER` makes the run again. Values given on the command line stand in the scene's text; a package is left as
it is, and they are taken from the provenance.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dcone_cosim.errors import InputError
from dcone_cosim.files import regular
from dcone_cosim.scenes.text import moved

if TYPE_CHECKING:
    from dcone_cosim.scene.data import Scene

PROVENANCE, SCENE, PACKAGE, STRUCTURE, FMUS, TABLES = (
    *("provenance.json", "scene.toml", "system.ssp", "SystemStructure.ssd", "fmus", "tables"),
)


@dataclass(frozen=True)
class Kept:
    """A run to be made again: its scene or package, its name, and the settings that are not in it yet."""

    path: Path
    name: str
    settings: tuple[str, ...]


def keep(scene: Scene, folder: Path) -> None:
    """Put into the folder all that the run was made from."""
    if scene.source.lower().endswith(".ssp"):
        shutil.copyfile(scene.source, folder / PACKAGE)
        (folder / STRUCTURE).write_text(scene.text, encoding="utf-8")
        return
    fmus = _copied(
        [c.fmu.absolute() for phase in scene.phases for c in phase.components if c.fmu is not None], folder, FMUS
    )
    tables = _copied([table.file.absolute() for table in scene.tables], folder, TABLES)
    named = {table.path: tables[table.file.absolute()] for table in scene.tables}
    (folder / SCENE).write_text(moved(scene.text, fmus, named), encoding="utf-8")


def _copied(files: list[Path], folder: Path, place: str) -> dict[Path, str]:
    """Copies of files in a folder, each under its own name unless another has that; where they are, in the folder."""
    names: dict[Path, str] = {}
    for file in files:
        if file not in names:
            same = sum(other.name == file.name for other in names)
            names[file] = f"{place}/{file.stem}-{same + 1}{file.suffix}" if same else f"{place}/{file.name}"
            (folder / place).mkdir(exist_ok=True)
            shutil.copyfile(file, folder / names[file])
    return names


def kept_in(folder: Path) -> Kept | None:
    """What to make again of the folder of a run; None when it is no such folder."""
    provenance = folder / PROVENANCE
    with suppress(OSError, ValueError):  # what can be no path is no folder either
        if provenance.is_file():
            return _kept(folder, _read(provenance))
    return None


def _kept(folder: Path, told: Mapping[str, Any]) -> Kept:
    name, settings = str(told.get("scene", folder.name)), told.get("settings", [])
    if (folder / SCENE).is_file():
        return Kept(folder / SCENE, name, ())
    if (folder / PACKAGE).is_file():
        return Kept(folder / PACKAGE, name, tuple(map(str, settings)))
    raise InputError(f"{folder} is the folder of a run, but holds neither {SCENE} nor {PACKAGE}")


def unlike(folder: Path, facts: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """In which FMUs a run made again from a folder differs from the run that left the folder.

    facts    of the FMUs of each phase as they are now, as the provenance has them
    """
    told = _read(folder / PROVENANCE)
    then, now = _identities(told.get("phases", {})), _identities(facts)
    return [
        *_changed_on_the_way(folder, told.get("gone_on") or {}),
        *_other_fmus(then, now),
    ]


def _changed_on_the_way(folder: Path, gone_on: Mapping[str, Any]) -> list[str]:
    """Of a run that went on from another with other values: made again, it has them from its beginning."""
    found = []
    while gone_on:
        if gone_on.get("changed"):
            found.append(
                f"made again from its beginning: {folder} went on from the run {gone_on['run']} in its "
                f"{gone_on['phase']}, where {', '.join(gone_on['changed'])} changed; here that holds throughout"
            )
        gone_on = gone_on.get("earlier") or {}
    return found


def _other_fmus(then: Mapping[str, str], now: Mapping[str, str]) -> list[str]:
    return [
        f"made again with another FMU of the {name}: its SHA-256 is {now[name][:12]}..., it was {sha[:12]}..."
        for name, sha in then.items()
        if now.get(name, sha) != sha
    ]


def _identities(phases: Mapping[str, Any]) -> dict[str, str]:
    """SHA-256 of the FMU of each phase and further component."""
    found = {}
    for name, phase in phases.items():
        for part, about in ((name, phase), *((f"{name}, {n}", c) for n, c in phase.get("components", {}).items())):
            found[part] = str(about.get("fmu", {}).get("sha256", ""))
    return found


def _read(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(regular(path).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"{path} cannot be read: {error}") from error
    if not isinstance(content, dict):
        raise InputError(f"{path} is not the provenance of a run: expected an object")
    return content
