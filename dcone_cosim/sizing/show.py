"""A sizing on the terminal: the answer, then for each part what its numbers are for, and its table."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Literal

from dcone_cosim.sizing.section import Section

if TYPE_CHECKING:
    from rich.console import Console

    from dcone_cosim.sizing.result import Sizing

MOST_ROWS = 14
"""Rows of a part that are shown; its file has all."""


ASIDE, WIDE = ("how", "why", "note", "youngs_modulus", "strength", "beam"), 140
"""Columns that a terminal with fewer letters leaves out; page and files have them."""
LETTERS = 9
"""In a line of the head of a column of numbers, or as many as its longest word has: none is cut in two."""


def show(done: Sizing, console: Console) -> None:
    """The answer, and all parts."""
    from rich.text import Text

    console.print(Text(done.title, style="bold"))
    for sentence in done.said:
        console.print(Text(f"- {sentence}"), highlight=False, soft_wrap=True)
    console.print()
    for section in done.sections:
        _show(section, console)


def _show(section: Section, console: Console) -> None:
    from rich.table import Table
    from rich.text import Text

    console.print(Text(section.title, style="bold"))
    console.print(Text(section.purpose, style="italic"), highlight=False)
    table = Table(box=None, pad_edge=False)
    shown = [i for i, head in enumerate(section.heads) if console.width >= WIDE or head.key not in ASIDE]
    for head in (section.heads[i] for i in shown):
        side: Literal["left", "right"] = "left" if not head.unit else "right"
        title = "\n".join(textwrap.wrap(head.title, LETTERS, break_long_words=False)) if head.unit else head.title
        table.add_column(Text(title), justify=side, overflow="fold", no_wrap=bool(head.unit))
    cells = section.cells()
    for row in cells[:MOST_ROWS]:
        table.add_row(*(Text(row[i]) for i in shown))
    console.print(table)
    if len(cells) > MOST_ROWS:
        console.print(Text(f"and {len(cells) - MOST_ROWS} more rows in {section.key}.csv"), highlight=False)
    for sentence in section.said:
        console.print(Text(sentence), highlight=False, soft_wrap=True)
    console.print()
