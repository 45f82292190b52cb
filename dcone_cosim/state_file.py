"""A kept state as a file: plain data as JSON, and each FMU's state beside it, in one archive.

    state.json   where the loop stands, what the master holds; bytes stand there as {"bytes": NAME}
    N.bin        the bytes: the state of an FMU as that gave it, positions of a net's knots

Nothing in it is run when it is read. The provenance of its run has its SHA-256: a file that is not the one that was
written is refused.
"""

from __future__ import annotations

import hashlib
import json
import zipfile
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from dcone_cosim.errors import InputError
from dcone_cosim.files import regular
from dcone_cosim.states import KeptState

FORMAT = 1
FOLDER, TEXT, BYTES = "states", "state.json", "bytes"
WHEN = (1980, 1, 1, 0, 0, 0)
"""Date of every member: equal states are equal files."""


def name_of(state: KeptState) -> str:
    return f"{FOLDER}/{state.phase}-{state.time:.12g}s.state"


def write(state: KeptState, path: Path) -> str:
    """Write the file; returns its SHA-256."""
    blobs: list[bytes] = []
    content = {"format": FORMAT, **_apart(asdict(state), blobs)}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(zipfile.ZipInfo(TEXT, WHEN), json.dumps(content, indent=1))
        for number, blob in enumerate(blobs):
            archive.writestr(zipfile.ZipInfo(f"{number}.bin", WHEN), blob, zipfile.ZIP_DEFLATED)
    return hashlib.sha256(path.read_bytes()).hexdigest()


def read(path: Path, sha256: str) -> KeptState:
    """The state again; `InputError` for a file that is not the one that was written."""
    try:
        data = regular(path).read_bytes()
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror or error}") from error
    if hashlib.sha256(data).hexdigest() != sha256:
        raise InputError(f"{path} is not the state that its run kept: its SHA-256 is another than the provenance tells")
    try:
        with zipfile.ZipFile(path) as archive:
            content = json.loads(archive.read(TEXT))
            blobs = {name: archive.read(name) for name in archive.namelist() if name != TEXT}
        if content.pop("format") != FORMAT:
            raise InputError(f"{path} is of another format than {FORMAT}, which this version reads")
        return KeptState(**_together(content, blobs))
    except (OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile) as error:
        raise InputError(f"{path} is not a kept state: {type(error).__name__}: {error}") from error


def _apart(value: Any, blobs: list[bytes]) -> Any:
    """Plain data, with the bytes taken out."""
    if isinstance(value, bytes):
        blobs.append(value)
        return {BYTES: f"{len(blobs) - 1}.bin"}
    if isinstance(value, Mapping):
        return {key: _apart(inner, blobs) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_apart(inner, blobs) for inner in value]
    return value


def _together(value: Any, blobs: Mapping[str, bytes]) -> Any:
    if isinstance(value, dict):
        if value.keys() == {BYTES}:
            return blobs[value[BYTES]]
        return {key: _together(inner, blobs) for key, inner in value.items()}
    if isinstance(value, list):
        return [_together(inner, blobs) for inner in value]
    return value
