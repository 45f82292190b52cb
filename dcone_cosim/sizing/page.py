"""A sizing as one page, pictures and tables in it, which opens without a network."""

from __future__ import annotations

import base64
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dcone_cosim.sizing.section import Section

if TYPE_CHECKING:
    from dcone_cosim.sizing.result import Sizing

QUANTITY = re.compile(r"[-+]?[\d.,]+(e[-+]?\d+)?( \S+)?")
"""A number, perhaps with its unit."""


def write(done: Sizing, about: Mapping[str, Any], folder: Path) -> None:
    """`report.html`, with the pictures that are in the folder."""
    from dcone_cosim.reports import pages

    parts = [_part(section, folder) for section in done.sections]
    text = pages.render("size.html", title=done.title, said=done.said, parts=parts, notes=done.notes, about=about)
    (folder / "report.html").write_text(text, encoding="utf-8")


def _part(section: Section, folder: Path) -> dict[str, Any]:
    picture = folder / section.picture if section.picture else None
    there = picture is not None and picture.is_file()
    cells = section.cells()
    texts = [
        not head.unit and not _is_of_numbers([row[place] for row in cells if row[place]])
        for place, head in enumerate(section.heads)
    ]
    return {
        "key": section.key,
        "title": section.title,
        "purpose": section.purpose,
        "picture": base64.b64encode(picture.read_bytes()).decode() if there and picture is not None else "",
        "heads": [(head.title, is_text) for head, is_text in zip(section.heads, texts, strict=True)],
        "rows": [list(zip(row, texts, strict=True)) for row in cells],
        "said": section.said,
    }


def _is_of_numbers(cells: Sequence[str]) -> bool:
    """Whether most of these texts are numbers with their units, and so stand on the right."""
    return 2 * sum(QUANTITY.fullmatch(one) is not None for one in cells) > len(cells)
