"""A case: a checked scene, with a seed if it has one, and the hash of all that settles its numbers.

The hash is of what reaches the FMUs and the master, by whatever words and files the scene says it: values in SI with
the defaults in their places, terms, steps, options, connections; the FMUs themselves; this package's code; the seed.
Titles, names of files, folders and lines play no part in it, nor does in which process an FMU runs.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from dcone_cosim.scene.data import ComponentScene, Scene

WORDS = frozenset({"name", "title", "text", "source", "places", "notes", "cautions", "sizing"})
"""Fields of a scene that change no number."""
PLACES = frozenset({"isolate", "choices", "defaults", "asked", "designed"})
"""The same of a component; its defaults, and what is designed, are told with its parameters."""


@dataclass(frozen=True)
class Value:
    """What a varied key is in a case: the text as given, and in SI where it is a number, with its unit."""

    given: str
    number: float | None = None
    unit: str = ""


@dataclass(frozen=True)
class Begins:
    """Where the run is kept that a case goes on from, and which of its phases that has: see `beginnings`."""

    folder: Path
    over: tuple[str, ...]


@dataclass(frozen=True)
class Case:
    """One run to be made; plain data, which can be sent to another process or machine.

    key        its hash, under which its row is kept
    settings   `KEY=VALUE`, what the command line would have to set to run this case alone
    varied     what the keys that are varied are here
    begins     phases that need not be run, since others have them in common; it has no part in the hash
    """

    key: str
    scene: Scene
    settings: tuple[str, ...] = ()
    varied: Mapping[str, Value] = field(default_factory=dict)
    seed: int | None = None
    begins: Begins | None = field(default=None, kw_only=True)


def content(scene: Scene) -> Any:
    """All of a scene that reaches its FMUs or the master, as plain data: equal for scenes that come to the same."""
    return {name: _plain(value) for name, value in _fields(scene).items() if name not in WORDS}


def _plain(value: Any) -> Any:
    if isinstance(value, ComponentScene):
        fields = {name: _plain(inner) for name, inner in _fields(value).items() if name not in PLACES}
        read = {name: _of_table(table) for name, table in value.sources.items()}
        return fields | {"parameters": {**value.defaults, **value.parameters}} | ({"sources": read} if read else {})
    if dataclasses.is_dataclass(value):
        return {name: _plain(inner) for name, inner in _fields(value).items()}
    if isinstance(value, Mapping):
        return {str(key): _plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    if isinstance(value, int | str) or value is None:
        return value
    return float(value)


def _of_table(numbers: Any) -> str:
    """A table that the scene gives entry by entry, or that a file has: the SHA-256 of its numbers."""
    return hashlib.sha256(np.ascontiguousarray(numbers, dtype=float).tobytes()).hexdigest()


def _fields(value: Any) -> dict[str, Any]:
    """The fields of a dataclass that are compared, without the paths of files: those count by their content."""
    found = {row.name: getattr(value, row.name) for row in dataclasses.fields(value) if row.compare}
    return {name: inner for name, inner in found.items() if not isinstance(inner, Path)}


def identities(facts: Mapping[str, Any]) -> dict[str, str]:
    """What each FMU is, by phase and component, from the facts of the archives: the GUID of one of ours, which is the
    hash of all that it was built from, and the SHA-256 of the file of any other."""
    found = {}
    for name, phase in facts.items():
        parts = [(name, phase), *((f"{name}, {part}", about) for part, about in phase.get("components", {}).items())]
        for part, about in parts:
            fmu = about["fmu"]
            found[part] = fmu["guid"] if fmu["ours"] else fmu["sha256"]
    return found


@cache
def code() -> dict[str, str]:
    """What the numbers of the master hang on: the version of this package, and the hash of its sources."""
    digest = hashlib.sha256()
    package = Path(__file__).parents[1]
    for path in sorted(package.rglob("*.py")):
        digest.update(path.relative_to(package).as_posix().encode() + b"\0" + path.read_bytes())
    return {"dcone-cosim": version("dcone-cosim"), "sources": digest.hexdigest()}


def digest(*parts: Any) -> str:
    """SHA-256 of plain data, whatever the order of its tables."""
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()


def key_of(scene: Scene, fmus: Mapping[str, str], seed: int | None) -> str:
    """The hash of a case.

    fmus    what each FMU is, see `identities`

    Checked  tests/cases/test_case.py
    """
    return digest(content(scene), dict(fmus), code(), seed)
