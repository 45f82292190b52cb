"""The matrix as one page, map and tables in it, which opens without a network."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from dcone_cosim.stability import show
from dcone_cosim.stability.judge import FAILED, size
from dcone_cosim.stability.show import LETTERS, MEANINGS, Matrix, by_extreme


def write(matrices: Sequence[Matrix], notes: Sequence[str], about: Mapping[str, Any], folder: Path) -> None:
    """`report.html`, with the maps that are in the folder."""
    from dcone_cosim.reports import pages

    title = "Stability at the ends of the range: " + ", ".join(
        dict.fromkeys(one.plan.scene.title.partition(" (")[0] for one in matrices)
    )
    text = pages.render(
        "stability.html", title=title, phases=[_phase(one, folder) for one in matrices], notes=notes, about=about,
        meanings=[(LETTERS[kind], MEANINGS[kind]) for kind in LETTERS],
    )  # fmt: skip
    (folder / "report.html").write_text(text, encoding="utf-8")


def picture_of(one: Matrix) -> str:
    """Name of the file of its map."""
    return f"{one.plan.scene.name}_{one.plan.phase}_stability.png"


def _phase(one: Matrix, folder: Path) -> dict[str, Any]:
    return {
        "name": one.plan.phase,
        "scene": one.plan.scene.title,
        "sentences": list(show.sentences(one)),
        "picture": base64.b64encode((folder / picture_of(one)).read_bytes()).decode(),
        "rows": [
            {
                "extreme": extreme.name,
                "text": extreme.text,
                "asked": one.about([cell]),
                "scheme": cell.planned.scheme.name,
                "kind": MEANINGS[cell.verdict.kind],
                "bad": cell.verdict.kind == FAILED,
                "why": cell.verdict.text,
                "cpu": f"{cell.cpu:.2g} s" if cell.cpu else "",
                "criteria": "; ".join(f"{c.label} {size(c)}" for c in cell.verdict.criteria if c.value < 1e300),
                "changes": " ".join(f"--set '{change}'" for change in cell.planned.changes),
            }
            for extreme, cells in by_extreme(one)
            for cell in cells
        ],
    }
