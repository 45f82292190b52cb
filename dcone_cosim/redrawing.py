"""The figures of a run drawn again, from the tables in its folder alone."""

from __future__ import annotations

import json
from pathlib import Path

from dcone_cosim import placed
from dcone_cosim.drafts import PROVENANCE, check_folder
from dcone_cosim.progress import Progress
from dcone_cosim.reports.figures import draw_all
from dcone_cosim.run_folder import as_json
from dcone_cosim.run_reading import provenance_of, read_run
from dcone_cosim.scratch import Scratch


def draw_again(folder: Path, out: Path | None, progress: Progress) -> tuple[list[Path], list[str]]:
    """Draw the figures of the run of a folder, there or elsewhere; where they are, and what could not be drawn.

    Each comes to its place whole; an earlier one gives way. In its own folder they count as files of the run.
    """
    run, place = read_run(folder), out if out is not None else folder
    check_folder(place)
    place.mkdir(parents=True, exist_ok=True)
    with Scratch(place) as draft:
        with progress.working("drawing"):
            progress.say("drawing")
            notes = draw_all(run, draft)
        files = sorted(path.name for path in draft.glob("*.png"))
        if place.samefile(folder):
            list_files(folder, files, draft / PROVENANCE)
        return [placed.put(draft / name, place / name) for name in files], notes


def list_files(folder: Path, files: list[str], draft: Path) -> None:
    """Have the provenance list files before they are there: what it lists may be missing, no others may be there."""
    told = provenance_of(folder)
    listed = sorted({*told.get("files", ()), *files})
    if listed != told.get("files"):
        draft.write_text(as_json(json.loads(as_json(told)) | {"files": listed}) + "\n", encoding="utf-8")
        placed.put(draft, folder / PROVENANCE)
