"""Reports that belong to a run: of its sizing, its accuracy, its stability; their answers, and where they are."""

from __future__ import annotations

import os
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dcone_cosim.errors import InputError
from dcone_cosim.run_reading import json_of

REPORT, REPLAY = "report.html", "replay.html"
"""Names of pages."""
COMMANDS = {"sizing": "size", "accuracy": "accuracy", "stability": "stability"}
"""The command that makes each kind of report."""


BROUGHT, UNSURE = "the scene's line", "the default flux may be off"
"""How the sentences of a sizing begin that tell what the scene's own line is worth, and how far debris is known."""


@dataclass(frozen=True)
class Linked:
    """One such report.

    kind      one of `COMMANDS`
    said      its answer in sentences
    governs   of a sizing, the part of its summary that tells which load governs
    """

    kind: str
    folder: Path
    said: Sequence[str]
    governs: Mapping[str, Any] | None = None

    @classmethod
    def read(cls, kind: str, folder: Path) -> Linked:
        """Of the folder that the command left; `InputError` where it is none."""
        command = COMMANDS[kind]
        if not (folder / REPORT).is_file():
            raise InputError(f"{folder} holds no report: expected a {REPORT} in it, as `dcone {command}` writes")
        content = json_of(folder / "summary.json")
        phases = content.get("phases", {}).values()
        said = content.get("said") or [one for phase in phases for one in phase.get("sentences", ())]
        return cls(kind, folder, [str(one) for one in said], content.get("parts", {}).get("governs"))


def named(folder: Path) -> str:
    """A run folder as a command takes it; a bare name may be that of a scene."""
    return shlex.quote(f"./{folder.absolute().name}")


def shown(kind: str, linked: Sequence[Linked], place: Path, scene: str) -> dict[str, Any]:
    """A report of that kind that is there, or how to make it, for a page at `place`."""
    found = next((one for one in linked if one.kind == kind), None)
    command = f"dcone {COMMANDS[kind]} {scene}"
    if found is None:
        return {"kind": kind, "href": "", "said": [], "command": command}
    href = os.path.relpath((found.folder / REPORT).absolute(), place.absolute().parent)
    return {"kind": kind, "href": Path(href).as_posix(), "said": found.said, "command": command}


def governing(linked: Sequence[Linked]) -> dict[str, Any] | None:
    """Which load governs, of a sizing among them: what each asks of the line, in mm and N, the governing one first."""
    part = next((one.governs for one in linked if one.governs is not None), None)
    if part is None:
        return None
    rows = [
        {
            "load": row["load"],
            "diameter": f"{1e3 * row['diameter']:.3g}",
            "size": "" if row["size"] is None else f"{row['size']:.4g}",
            "how": row["how"],
        }
        for row in sorted(part["rows"], key=lambda row: -row["diameter"])
    ]
    answer = next(one.said for one in linked if one.governs is not None)
    return {
        "purpose": part["purpose"],
        "rows": rows,
        "said": [one for one in answer if one.startswith((BROUGHT, UNSURE))],
    }


def tile(linked: Sequence[Linked]) -> dict[str, str] | None:
    """For the top of a page: of a sizing among them, which load governs, and how thick it asks the line to be."""
    part = governing(linked)
    if part is None or not part["rows"]:
        return None
    first = part["rows"][0]
    return {
        "label": "least diameter of the tether",
        "value": first["diameter"],
        "unit": "mm",
        "since": f"by its sizing; {first['load']} governs: {first['how']}",
    }
