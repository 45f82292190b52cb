"""Cases worth looking at: of each way to fail the first, of each figure the one with the largest value."""

from __future__ import annotations

import math
import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from dcone_cosim.campaign.engine import Made
from dcone_cosim.campaign.outcomes import answered, margin, outcome, succeeded
from dcone_cosim.campaign.spec import Spec
from dcone_cosim.cases.rows import unit_of
from dcone_cosim.findings import reading

OF_EACH = 2
"""Cases of each outcome that is no success."""
MOST_FIGURES = 6
CASES = "cases"
"""Folder of a campaign in which cases are run again."""


@dataclass(frozen=True)
class Worth:
    """A case, and why it is worth looking at.

    command    that runs it again, with its replay;  page   where that is then, from the campaign's folder
    """

    number: int
    why: str
    command: str
    page: str


def worst(spec: Spec, made: Sequence[Made], folder: Path) -> list[Worth]:
    """Such cases, each once.

    Checked  tests/campaign/test_worst.py
    """
    why: dict[int, list[str]] = {}
    seen: dict[str, int] = {}
    for one in made:
        word = outcome(one.row, spec.success.judged)
        if succeeded(one.row, spec.success) is not True and seen.get(word, 0) < OF_EACH:
            seen[word] = seen.get(word, 0) + 1
            why.setdefault(one.number, []).append(word)
    known = [one for one in made if answered(one.row)]
    if spec.success.figure and known:
        least = min(known, key=lambda one: (_or(margin(one.row, spec.success), math.inf), one.number))
        why.setdefault(least.number, []).append(f"nearest to, or farthest beyond, {spec.success.text}")
    names = dict.fromkeys(name for one in known for name, value in one.row.figures.items() if isinstance(value, float))
    wanted = [name for name in spec.record or names if "tension" in name or "peak" in name or name in spec.indices]
    for name in wanted[:MOST_FIGURES]:
        having = [
            (float(value), -one.number) for one in known if isinstance(value := one.row.figures.get(name), int | float)
        ]
        if having:
            value, number = max(having)
            read = reading(*unit_of((one.row for one in known), name), value)
            text = f"largest {name}: {read.from_si(value):.5g} {read.name}".rstrip()
            why.setdefault(-number, []).append(text)
    return [
        Worth(
            number,
            "; ".join(reasons),
            f"dcone campaign rerun {shlex.quote(folder.as_posix())} {number}",
            f"{CASES}/{number}/report.html",
        )
        for number, reasons in sorted(why.items())
    ]


def _or(value: float, other: float) -> float:
    return other if math.isnan(value) else value
