"""Values of a campaign's file as TOML text."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

import tomlkit


def flat(table: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, str]]:
    """Every value of nested tables by its dotted key, as TOML; an empty table is a value."""
    for key, value in table.items():
        bare = key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else f'"{key}"'
        if isinstance(value, Mapping) and value:
            yield from flat(value, f"{above}{bare}.")
        else:
            yield f"{above}{bare}", as_toml(value)


def as_toml(value: Any) -> str:
    """A value of a TOML document as it is written there, tables within a line."""
    return str(tomlkit.item(_within_a_line(value)).as_string())


def _within_a_line(value: Any) -> Any:
    if isinstance(value, Mapping):
        table = tomlkit.inline_table()
        for key, inner in value.items():
            table[key] = _within_a_line(inner)
        return table
    if isinstance(value, list):
        array = tomlkit.array()
        for inner in value:
            array.append(_within_a_line(inner))
        return array
    return value
