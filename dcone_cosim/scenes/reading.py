"""Reads a scene from TOML, and has it checked as a whole before anything is built or written.

    title = "..."               phases = ["capture", "removal"]
    [orbit]                     shared by all phases
    [capture]  [capture.net] shape = "square" ...       a table per part; a table that names a term brings the term in
    [removal]  [removal.reel] law = "locked" ...
    [handoff]

Which tables and keys there are follows from the models' own tables of variables, through `build`; where an FMU file
takes a model's place (`fmu = "path.fmu"`), from its model description.
"""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from dcone_cosim.errors import InputError
from dcone_cosim.files import regular
from dcone_cosim.scene.data import Scene
from dcone_cosim.scene.mistakes import Places
from dcone_cosim.scene.toml_lines import DEEPEST, deep_key

UTF_16 = (b"\xff\xfe", b"\xfe\xff")
"""Byte order marks of UTF-16."""


def read_text(path: Path) -> str:
    """Text of a scene file, in UTF-8 with or without a byte order mark."""
    try:
        content = regular(path).read_bytes()
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror or error}") from error
    try:
        return content.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        what = "it is in UTF-16" if content.startswith(UTF_16) else f"byte {content[error.start]:#x} in line {line}"
        raise InputError(f"{path} cannot be read as text: {what}; save it as UTF-8") from error


def parse(
    text: str, name: str, source: str, folder: Path = Path(), settings: Sequence[str] = (), choose: bool = True
) -> Scene:
    """A scene from its text.

    source       names it in messages
    folder       paths of FMUs are relative to it
    choose       whether the settings that its accuracy asks for are chosen
    """
    if not text.strip():
        raise InputError(f"{source} is empty; expected a scene with at least [capture] or [removal]")
    line = deep_key(text)
    if line is not None:
        raise InputError(f"{source} line {line}: a key of more than {DEEPEST} parts; no scene has one")
    try:
        document = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        last = len(text.splitlines())
        said = str(error).replace("(at end of document)", f"(line {last}, at the end of the file)")
        raise InputError(f"{source} is not valid TOML, or cut short: {said}") from error
    except RecursionError as error:
        raise InputError(f"{source} cannot be read as a scene: its lists or tables are nested too deeply") from error
    except ValueError as error:
        raise InputError(f"{source} cannot be read as a scene: a number in it has thousands of digits") from error
    from dcone_cosim.scenes.check import check  # astropy is loaded only for a text that parses
    from dcone_cosim.scenes.text import as_run, name_changes, override

    overrides = override(document, settings)
    name_changes(text, document, overrides)
    places = Places(source, text, tuple(overrides))
    scene = check(document, name, places, folder)
    if scene.accuracy is not None and choose:
        from dcone_cosim.scenes.choosing import settled

        scene = settled(scene, document, name, places, folder)
    tables = {table.path: table.file for table in scene.tables}
    return replace(scene, text=as_run(text, document, overrides, folder, tables))
