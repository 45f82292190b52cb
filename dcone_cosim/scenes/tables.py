"""A table of a part, in the file that a scene names: read once, when the scene is checked."""

from __future__ import annotations

import hashlib
from pathlib import Path as File

from dcone_cosim import build
from dcone_cosim.files import regular
from dcone_cosim.scene.data import TableFile
from dcone_cosim.scene.expected import Unexpected
from dcone_cosim.scene.toml_lines import Path
from dcone_cosim.scenes.fmus import file_of

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
