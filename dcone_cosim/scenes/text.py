"""Changes to a scene that keep its text: what the command line sets, and where its FMUs are.

The text that is kept with the results runs again to the same results: it has the changed values, a title that tells
them, and the paths of the FMUs' copies beside it.
"""

from __future__ import annotations

import os
import pickle
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from pathlib import Path as File
from types import MappingProxyType
from typing import Any

from dcone_cosim.errors import InputError
from dcone_cosim.scene.mistakes import Override, shown
from dcone_cosim.scene.toml_lines import DEEPEST, Path, deep_key, dotted, given_at

RECORDED = ("replay_every", "nodes", "threads")
"""Keys of a phase that say what is kept of a run, and change nothing in it."""
FORM = 'expected KEY.KEY=VALUE, such as capture.bullets.speed="4 m/s"'


def override(document: dict[str, Any], settings: Sequence[str]) -> list[Override]:
    """Put the settings of the command line into the document; returns where, in the order of the command line."""
    found = []
    for setting in settings:
        names, value = _split(setting)
        table = document
        for depth, name in enumerate(names[:-1], start=1):
            inner = table.setdefault(name, {})
            if not isinstance(inner, dict):
                raise InputError(f"--set {setting}: {dotted(names[:depth])} is not a table: it has no {names[depth]!r}")
            table = inner
        table[names[-1]] = value
        found.append(Override(names, setting))
    return found


def _split(setting: str) -> tuple[tuple[str, ...], Any]:
    """Path and value of a setting; a value that is no TOML is taken as a text, so a quantity needs no quotes."""
    key, sign, text = setting.partition("=")
    if not sign or not key.strip() or not text.strip():
        raise InputError(f"--set {setting}: {FORM}")
    if deep_key(key) is not None:
        raise InputError(f"--set {setting[:60]}...: a key of more than {DEEPEST} parts; {FORM}")
    try:
        nested: Any = tomllib.loads(f"{key}=0")
    except tomllib.TOMLDecodeError:
        raise InputError(f"--set {setting}: {key!r} is not a key; {FORM}") from None
    names: list[str] = []
    while isinstance(nested, dict):
        ((name, nested),) = nested.items()
        names.append(name)
    return tuple(names), value_of(text.strip())


def value_of(text: str) -> Any:
    try:
        parsed = tomllib.loads(f"value={text}")
    except (tomllib.TOMLDecodeError, ValueError, RecursionError):
        return text
    return parsed["value"] if len(parsed) == 1 else text


def _fmu_paths(document: Any) -> Iterator[tuple[Path, str]]:
    """Where FMUs are named: key `fmu` of a phase or a component."""
    if not isinstance(document, dict):
        return
    for phase, tables in document.items():
        if not isinstance(tables, dict):
            continue
        components = tables.get("components")
        parts: list[tuple[Path, Any]] = [((phase,), tables)]
        if isinstance(components, dict):
            parts += [((phase, "components", name), table) for name, table in components.items()]
        for path, table in parts:
            if isinstance(table, dict) and isinstance(table.get("fmu"), str):
                yield (*path, "fmu"), table["fmu"]


def titled(title: str, changes: Sequence[str]) -> str:
    """A title with what was changed, `Table 1 (changed: capture.net.side = 12 m)`: it no longer holds without it."""
    return f"{title} (changed: {', '.join(changes)})".lstrip() if changes else title


def setting(path: Path, value: Any) -> str:
    """A setting as a title shows it, `capture.net.side = 12 m`."""
    return f"{dotted(path)} = {value if isinstance(value, str) else shown(value)}"


def name_changes(text: str, document: dict[str, Any], overrides: Sequence[Override]) -> None:
    """Let the document's title say what the overrides changed of the text."""
    before = _as_told(text)
    told = [
        change.path for change in overrides if change.path != ("title",) and not set(change.path[1:2]) & set(RECORDED)
    ]
    of = {path: given_at(document, path) for path in told}
    changes = [setting(path, value) for path, value in of.items() if given_at(before, path) != value]
    title = document.get("title", "")
    if changes and isinstance(title, str):
        document["title"] = titled(title, changes)


@lru_cache(maxsize=4)
def _as_told(text: str) -> dict[str, Any]:
    """What a text says, to be looked at only."""
    return tomllib.loads(text)


def as_run(
    text: str,
    document: dict[str, Any],
    overrides: Sequence[Override],
    folder: File,
    tables: Mapping[Path, File] = MappingProxyType({}),
) -> str:
    """The text with the overrides and the title in it, and with the full paths of files told relative to the scene.

    tables    files of tables by the key that names each
    """
    changes: dict[Path, Any] = {change.path: given_at(document, change.path) for change in overrides}
    if overrides and "title" in document:
        changes["title",] = document["title"]
    for path, given in _fmu_paths(document):
        full = str((folder / File(given).expanduser()).absolute())
        if full != given and "://" not in given and "\0" not in given:
            changes[path] = full
    for path, file in tables.items():
        if str(file.absolute()) != given_at(document, path):
            changes[path] = str(file.absolute())
    return with_values(text, changes)


def moved(text: str, places: Mapping[File, str], tables: Mapping[Path, str] = MappingProxyType({})) -> str:
    """The text with other paths for its files.

    places    where a copy of each FMU is, by its full path
    tables    where a copy of each table is, by the key that names its file
    """
    found = ((path, places.get(File(given))) for path, given in _fmu_paths(tomllib.loads(text)))
    return with_values(text, {**{path: place for path, place in found if place is not None}, **tables})


def beside(text: str, tables: Mapping[Path, File], folder: File) -> dict[Path, str]:
    """Paths that a scene in this folder has to say of the tables that the text tells by paths that are relative.

    tables    files of tables by the key that names each
    """
    document = tomllib.loads(text)
    relative = {
        path: file for path, file in tables.items() if not File(given_at(document, path)).expanduser().is_absolute()
    }
    return {path: os.path.relpath(file.absolute(), folder.absolute()) for path, file in relative.items()}


def with_values(text: str, changes: Mapping[Path, Any]) -> str:
    """The text with other values at some places, and its comments as far as they can be kept."""
    if not changes:
        return text
    import tomlkit
    from tomlkit.exceptions import TOMLKitError

    wanted = tomllib.loads(text)
    for path, value in changes.items():
        put(wanted, path, value)
    try:
        kept = pickle.loads(_parsed(text))
        for path, value in changes.items():
            put(kept, path, value)
        changed = tomlkit.dumps(kept)
        if tomllib.loads(changed) == wanted:
            return changed
    except (TOMLKitError, tomllib.TOMLDecodeError, TypeError, ValueError, KeyError):
        pass
    return tomlkit.dumps(wanted)  # without the comments, but with every value


@lru_cache(maxsize=4)
def _parsed(text: str) -> bytes:
    """A text with its comments, parsed and pickled: to have that again takes a seventh of the time, and a sweep has
    many scenes of one text."""
    import tomlkit

    return pickle.dumps(tomlkit.parse(text))


def put(document: Any, path: Path, value: Any) -> None:
    """Give a document a value at a place; tables that it lacks on the way are made."""
    for part in path[:-1]:
        if not isinstance(part, int) and part not in document:
            document[part] = {}
        document = document[part]
    document[path[-1]] = value
