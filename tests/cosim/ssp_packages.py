"""Packages for the tests of SSP: a scene exported once, and copies of it with something changed."""

from __future__ import annotations

import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path

STRUCTURE = "SystemStructure.ssd"


def contents(path: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def packed(path: Path, files: Mapping[str, bytes]) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return path


def changed(source: Path, target: Path, *changes: tuple[str, str], file: str = STRUCTURE) -> Path:
    """A copy of a package in which a text of one file is another; each must be there."""
    files = contents(source)
    text = files[file].decode()
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new, 1)
    files[file] = text.encode()
    return packed(target, files)


Change = Callable[[dict[str, bytes]], None]
