"""The table of tools in the packaging's README. To measure it anew: python -m tests.interop.readme"""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

from tests.interop import reel_pair
from tests.interop.cases import CASES
from tests.interop.measure import TOOLS, rows

PAGE = Path(__file__).parents[2] / "fmu_src" / "packaging" / "README.md"
TITLES = "| tool | version | FMU | steps that a double holds exactly | steps that it does not |"
HEAD = f"{TITLES}\n| --- | --- | --- | --- | --- |\n"
PAIR = ("container", "pair")
"""Key of the line on two FMUs coupled by a tool."""
TABLE = re.compile(re.escape(HEAD) + r"((?:\|.*\n)*)")


def written(text: str) -> dict[tuple[str, str], list[str]]:
    """Cells of the table's lines, by tool and run."""
    (body,) = TABLE.findall(text)
    titles = {about.title: name for name, about in TOOLS.items()}
    runs = {about.title: name for name, about in CASES.items()} | {reel_pair.TITLE: PAIR[1]}
    lines = [[cell.strip() for cell in line.strip("|").split("|")] for line in body.splitlines()]
    return {(titles[cells[0]], runs[cells[2]]): cells for cells in lines}


def versions(text: str) -> dict[str, str]:
    """The versions that the table tells, by package."""
    return {TOOLS[tool].package: cells[1] for (tool, _), cells in written(text).items()}


def page(text: str, tools: Iterable[str], keep_versions: bool = False) -> str:
    """The page with the lines of these tools, and of the pair, as measured now; the others stay.

    keep_versions    a tool may be newer here than the one that the table tells of, if its numbers are the same
    """
    before = written(text)
    lines = dict(before)
    own = [tool for tool in tools if tool in TOOLS]
    measured = {key: [cell.strip() for cell in line.strip("|").split("|")] for key, line in rows(own).items()}
    if PAIR[1] in tools:
        measured[PAIR] = reel_pair.row()
    for key, cells in measured.items():
        if keep_versions and key in before:
            cells[1] = before[key][1]
        lines[key] = cells
    ordered = [lines[tool, case] for tool in TOOLS for case in (*CASES, PAIR[1]) if (tool, case) in lines]
    body = "".join("| " + " | ".join(cells) + " |\n" for cells in ordered)
    return TABLE.sub(lambda _: HEAD + body, text)


if __name__ == "__main__":
    PAGE.write_text(page(PAGE.read_text(encoding="utf-8"), [*TOOLS, PAIR[1]]), encoding="utf-8")
