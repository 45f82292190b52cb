"""A sizing as one page, pictures and tables in it, which opens without a network."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dcone_cosim.sizing.section import Section

if TYPE_CHECKING:
    from dcone_cosim.sizing.result import Sizing


def write(done: Sizing, about: Mapping[str, Any], folder: Path) -> None:
    """`report.html`, with the pictures that are in the folder."""
    from dcone_cosim.reports import pages

    parts = [_part(section, folder) for section in done.sections]
    text = pages.render("size.html", title=done.title, said=done.said, parts=parts, notes=done.notes, about=about)
    (folder / "report.html").write_text(text, encoding="utf-8")


def _part(section: Section, folder: Path) -> dict[str, Any]:
    picture = folder / section.picture if section.picture else None
    there = picture is not None and picture.is_file()
    return {
        "key": section.key,
        "title": section.title,
        "purpose": section.purpose,
        "picture": base64.b64encode(picture.read_bytes()).decode() if there and picture is not None else "",
        "heads": [(head.title, not head.unit) for head in section.heads],
        "rows": [list(zip(cells, (not head.unit for head in section.heads), strict=True)) for cells in section.cells()],
        "said": section.said,
    }
