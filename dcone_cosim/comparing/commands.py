"""`dcone compare`: two runs read from their folders, set side by side, and written where that is asked for.

compare.csv    every figure of both: values, difference, percent, unit, scatter
compare.json   the same, with the keys in which the scenes differ, and which tables have the same bits
compare.png    tension of the tows and mouth area of the captures
report.html    all of it as one page
"""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dcone_cosim.comparing import plot
from dcone_cosim.comparing.comparison import Comparison
from dcone_cosim.comparing.pairs import figures, same_tables, scene_keys
from dcone_cosim.drafts import atomic_folder, check_free
from dcone_cosim.results import RunResult
from dcone_cosim.run_folder import as_json, versions
from dcone_cosim.run_reading import read_run


def compare(one: Path, other: Path) -> Comparison:
    """Set two runs side by side; `InputError` where one cannot be read."""
    return beside((one, other), _names(one, other), (read_run(one), read_run(other)))


def beside(
    folders: tuple[Path | None, Path | None], names: tuple[str, str], runs: tuple[RunResult, RunResult]
) -> Comparison:
    """The same of two runs at hand; a folder is None where a run is in none."""
    first, second = runs
    return Comparison(
        folders,
        names,
        runs,
        figures(first, second),
        scene_keys(first.scene, second.scene),
        same_tables(first, second),
    )


def _names(one: Path, other: Path) -> tuple[str, str]:
    """The names of the folders, or their paths where these are the same."""
    first, second = one.absolute().name, other.absolute().name
    return (first, second) if first != second else (str(one), str(other))


def write(found: Comparison, folder: Path, content: Mapping[str, Any]) -> Path:
    """Write the folder, whole or not at all; returns where it is."""
    check_free(folder, False)
    with atomic_folder(folder) as draft:
        with (draft.path / "compare.csv").open("w", newline="", encoding="utf-8") as file:
            rows = [row.as_dict() for row in found.figures]
            writer = csv.DictWriter(file, fieldnames=list(rows[0]) if rows else ["figure"])
            writer.writeheader()
            writer.writerows(rows)
        (draft.path / "compare.json").write_text(as_json(content) + "\n", encoding="utf-8")
        reason = plot.draw(list(zip(found.names, found.runs, strict=True)), found.title, draft.path / "compare.png")
        found.notes.extend([reason] if reason else [])
        from dcone_cosim.comparing.page import text_of  # it brings Jinja2

        (draft.path / "report.html").write_text(text_of(found, versions()), encoding="utf-8")
    return draft.folder
