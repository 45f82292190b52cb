"""An FMU file that a scene names: what it offers, as keys with units and as slots for connections."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from dcone_cosim import build
from dcone_cosim.errors import FmuError
from dcone_cosim.scene.expected import TEXT, Expected, Unexpected, example_of
from dcone_cosim.scenes.keys import Key, Slot
from dcone_cosim.units import by_name, si_name

if TYPE_CHECKING:
    from dcone_cosim.fmu.archive import Archive
    from dcone_cosim.fmu.steppable import VariableInfo

SETTABLE_KINDS = ("Real", "Integer", "Boolean", TEXT)
ADDRESS = re.compile(r"[a-zA-Z][a-zA-Z0-9+.-]+://")
_ELEMENT = re.compile(r"(.*)\[(\d+)\]")


@dataclass(frozen=True)
class Offer:
    """What a scene may say of an FMU, and what can be connected to it."""

    keys: Mapping[str, Key]
    slots: Mapping[str, Slot]


def file_of(given: object, folder: Path, what: str = "FMU", example: str = "my.fmu") -> Path:
    """Path of the file that a scene in this folder names, or `Unexpected`. Whether it is one, opening it shows."""
    if not isinstance(given, str) or not given.strip():
        raise Unexpected(f'expected the path of {"an" if what == "FMU" else "a"} {what}, such as "{example}"')
    if ADDRESS.match(given):
        raise Unexpected(f"is an address: nothing is fetched; download the {what} and give its path")
    if "\0" in given:
        raise Unexpected("is not a path: it holds a NUL")
    return folder / Path(given).expanduser()


def opened(path: Path) -> Archive:
    """The FMU unpacked and checked, or `Unexpected` with what is wrong with it."""
    from dcone_cosim.fmu.archive import Archive

    try:
        return Archive(path)
    except FmuError as error:
        raise Unexpected(str(error).removeprefix(f"{path}: ")) from None
    except OSError as error:
        raise Unexpected(f"cannot be opened: {error.strerror or error}") from None


def offer(variables: Mapping[str, VariableInfo], model: build.Model | None = None) -> Offer:
    """What the variables of an FMU offer; of a model in whose place it stands it takes the names of choices."""
    choices = {row.name: row.choices for row in build.all_rows(model) if row.choices} if model is not None else {}
    slots = {info.name: Slot(info.kind, info.own, info.causality) for info in variables.values()}
    names: dict[str, list[str]] = {}
    for info in variables.values():
        if info.causality in build.SETTABLE and info.kind in SETTABLE_KINDS:
            match = _ELEMENT.fullmatch(info.name)
            names.setdefault(match[1] if match else info.name, []).append(info.name)
    keys: dict[str, Key] = {}
    for name, elements in names.items():
        alike = len({variables[element].own.relative for element in elements}) == 1
        if alike and sorted(elements) == sorted(f"{name}[{i + 1}]" for i in range(len(elements))):
            keys[name] = _key([f"{name}[{i + 1}]" for i in range(len(elements))], variables, len(elements))
        else:
            keys |= {element: _key([element], variables, 0, choices.get(element, ())) for element in elements}
    return Offer(keys, slots)


def _unit(info: VariableInfo) -> str:
    """SI unit in which a value is read and compared; "1" for a pure number, and when nothing is known of the unit."""
    if info.own.dimension is None:
        return "1"
    known = by_name(info.unit)
    return info.unit if known.is_si and known.dimension == info.own.dimension else si_name(info.own.dimension)


def _key(names: list[str], variables: Mapping[str, VariableInfo], size: int, choices: tuple[str, ...] = ()) -> Key:
    infos = [variables[name] for name in names]
    first, unit = infos[0], _unit(infos[0])
    if first.kind == TEXT:
        return Key(tuple(names), Expected(unit, TEXT, size), (), first.description)
    starts = tuple(info.start or 0.0 for info in infos)
    start = next((s for s in starts if s), 0.0)
    expected = Expected(
        unit,
        first.kind,
        size,
        choices if first.kind == "Integer" else (),
        f"{start:g}" if first.kind == "Integer" else example_of(start, unit),
        max(info.minimum for info in infos),
        min(info.maximum for info in infos),
        relative=first.own.relative,
    )
    return Key(tuple(names), expected, starts, first.description)
