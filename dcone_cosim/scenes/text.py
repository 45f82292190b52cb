"""Changes to a scene that keep its text: what the command line sets, and where its FMUs are.

The text that is kept with the results runs again to the same results: it has the changed values, and its paths say
where the FMUs were.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path as File
from typing import Any

from dcone_cosim.errors import InputError
from dcone_cosim.scenes.mistakes import Override
from dcone_cosim.scenes.toml_lines import Path, dotted

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
                raise InputError(f"--set {setting}: {dotted(names[:depth])} is no table, it has no {names[depth]!r}")
            table = inner
        table[names[-1]] = value
        found.append(Override(names, setting))
    return found


def _split(setting: str) -> tuple[tuple[str, ...], Any]:
    """Path and value of a setting; a value that is no TOML is taken as a text, so a quantity needs no quotes."""
    key, sign, text = setting.partition("=")
    if not sign or not key.strip() or not text.strip():
        raise InputError(f"--set {setting}: {FORM}")
    try:
        nested: Any = tomllib.loads(f"{key}=0")
    except tomllib.TOMLDecodeError:
        raise InputError(f"--set {setting}: {key!r} is no key; {FORM}") from None
    names: list[str] = []
    while isinstance(nested, dict):
        ((name, nested),) = nested.items()
        names.append(name)
    return tuple(names), _value(text.strip())


def _value(text: str) -> Any:
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


def as_run(text: str, document: dict[str, Any], overrides: Sequence[Override], folder: File) -> str:
    """The text with the overrides in it, and with the full paths of FMUs that are told relative to the scene."""
    changes: dict[Path, Any] = {change.path: _at(document, change.path) for change in overrides}
    for path, given in _fmu_paths(document):
        full = str((folder / File(given).expanduser()).absolute())
        if full != given and "://" not in given and "\0" not in given:
            changes[path] = full
    if not changes:
        return text
    import tomlkit
    from tomlkit.exceptions import TOMLKitError

    wanted = tomllib.loads(text)
    for path, value in changes.items():
        _put(wanted, path, value)
    try:
        kept = tomlkit.parse(text)
        for path, value in changes.items():
            _put(kept, path, value)
        changed = tomlkit.dumps(kept)
        if tomllib.loads(changed) == wanted:
            return changed
    except (TOMLKitError, tomllib.TOMLDecodeError, TypeError, ValueError, KeyError):
        pass
    return tomlkit.dumps(wanted)  # without the comments, but with every value


def _at(document: Any, path: Path) -> Any:
    for part in path:
        document = document[part]
    return document


def _put(document: Any, path: Path, value: Any) -> None:
    for part in path[:-1]:
        if part not in document:
            document[part] = {}
        document = document[part]
    document[path[-1]] = value
