"""A table of a part, in the file that a scene names or entry by entry: read once, when the scene is checked."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path as File
from typing import Any

from dcone_cosim import build
from dcone_cosim.files import regular
from dcone_cosim.scene.data import TableFile
from dcone_cosim.scene.expected import Unexpected
from dcone_cosim.scene.mistakes import Mistake
from dcone_cosim.scene.toml_lines import Path, dotted
from dcone_cosim.scenes.fmus import file_of
from dcone_cosim.scenes.keys import Key, key_of, read_table

EXAMPLE = "my-table.csv"
"""A path as a scene could have it."""


def table_of(table: build.Table, given: object, folder: File, path: Path) -> TableFile:
    """The table that a value of a scene in this folder stands for, or `Unexpected` with what is wrong with its file.

    path    of the key
    """
    file = file_of(given, folder, "file", EXAMPLE)
    try:
        digest = hashlib.sha256(regular(file).read_bytes()).hexdigest()
        numbers = table.numbers(table.read(file))
    except OSError as error:
        raise Unexpected(
            f"cannot be read: {error.strerror or error}; expected a file with {table.description}"
        ) from None
    except ValueError as error:
        raise Unexpected(f"{file.name}: {error}; expected {table.description}") from None
    return TableFile(path, file, digest, numbers)


def entry_keys(table: build.Table) -> Mapping[str, Key]:
    """What each entry of a table may say, by key."""
    return {row.name.partition("[")[0]: key_of(row) for row in table.entry}


def entries_of(table: build.Table, given: object, path: Path, mistakes: list[Mistake]) -> Any:
    """The numbers of a table whose entries are tables of the scene; None, and the mistakes, where they are none."""
    text = f"expected one or more tables [[{dotted(path)}]]: {table.description}"
    if not isinstance(given, list) or not given or not all(isinstance(entry, dict) for entry in given):
        mistakes.append(Mistake(path, given, text))
        return None
    before = len(mistakes)
    expected = {key: known.expected for key, known in entry_keys(table).items()}
    read = [read_table(entry, expected, (*path, place), mistakes) for place, entry in enumerate(given)]
    if len(mistakes) > before:
        return None
    assert table.gather is not None
    try:
        return table.numbers(table.gather(read))
    except ValueError as error:
        place = next((n for n, entry in enumerate(read) if not _stands(table, entry)), None)
        at, what = (path, given) if place is None else ((*path, place), given[place])
        mistakes.append(Mistake(at, what, str(error)))
        return None


def _stands(table: build.Table, entry: Any) -> bool:
    """Whether an entry is right by itself."""
    assert table.gather is not None
    try:
        table.gather([entry])
    except ValueError:
        return False
    return True
