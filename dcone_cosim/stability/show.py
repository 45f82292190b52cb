"""The matrix on the terminal, in sentences, and as plain data for machines."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from dcone_cosim.cases.rows import FAULT, LOST, Row
from dcone_cosim.criteria import Criterion
from dcone_cosim.stability.judge import ACCURATE, EXCLUDED, FAILED, IN_THE, LEFT, REFUSED, STABLE, Verdict
from dcone_cosim.stability.plan import PhasePlan, Planned

if TYPE_CHECKING:
    from rich.console import Console

LETTERS = {ACCURATE: "A", STABLE: "S", REFUSED: "R", EXCLUDED: "-", FAILED: "F", LEFT: "."}
MEANINGS = {
    ACCURATE: "stable and accurate",
    STABLE: "stable",
    REFUSED: "refused, with the bound or the cost",
    EXCLUDED: "no such case",
    FAILED: "failed",
    LEFT: "left out",
}
STYLES = {ACCURATE: "green", STABLE: "cyan", REFUSED: "yellow", EXCLUDED: "dim", FAILED: "bold red", LEFT: "dim"}


@dataclass(frozen=True)
class Cell:
    """A pair of extreme and scheme with what became of it.

    cpu    time that its runs took [s], 0 where there was none
    """

    planned: Planned
    verdict: Verdict
    cpu: float = 0.0


@dataclass
class Matrix:
    """A phase, judged."""

    plan: PhasePlan
    cells: list[Cell]

    def of(self, kind: str) -> list[Cell]:
        """Those of which that became."""
        return [cell for cell in self.cells if cell.verdict.kind == kind]

    def words(self, key: str) -> str:
        """A criterion as runs of this phase tell of it; its key where none did."""
        told = (one.label for cell in self.cells for one in cell.verdict.criteria if one.key == key)
        return next(told, key).partition(IN_THE)[0]

    def about(self, cells: Sequence[Cell]) -> str:
        """What the cases of an extreme must show above all, in words, "" where there is none: schemes may be asked for
        different things."""
        return "; ".join(map(self.words, asked(cells)))

    def shares(self) -> Iterator[tuple[str, int, int]]:
        """Each scheme, how many of its cases were refused, and of how many."""
        for scheme in self.plan.schemes:
            own = [cell for cell in self.cells if cell.planned.scheme is scheme]
            tried = [cell for cell in own if cell.verdict.kind not in (EXCLUDED, LEFT)]
            yield scheme.name, sum(cell.verdict.kind == REFUSED for cell in tried), len(tried)


def asked(cells: Sequence[Cell]) -> list[str]:
    """Keys of what the cases among these must show above all."""
    return list(dict.fromkeys(cell.planned.asked for cell in cells if cell.verdict.kind != EXCLUDED))


def matrix(plan: PhasePlan, rows: Mapping[str, Row]) -> Matrix:
    """What became of every cell of a phase."""
    return Matrix(plan, [_cell(planned, rows) for planned in plan.cells])


def _cell(planned: Planned, rows: Mapping[str, Row]) -> Cell:
    if planned.case is None:
        assert planned.found is not None
        return Cell(planned, planned.found)
    row = rows.get(planned.case.key)
    if row is None:
        return Cell(planned, Verdict(LEFT, "the time allowed was over"))
    if row.status in (LOST, FAULT):
        return Cell(planned, Verdict(FAILED, row.message))
    criteria = [Criterion(**one) for one in row.samples["criteria"]]
    return Cell(planned, Verdict(row.status, row.message, criteria), row.timings["cpu"])


def sentences(one: Matrix) -> Iterator[str]:
    """How many became what, and the share refused by scheme."""
    counts = ", ".join(f"{len(one.of(kind))} {MEANINGS[kind]}" for kind in LETTERS if one.of(kind))
    yield f"{one.plan.phase}: {len(one.cells)} cases: {counts}"
    for name, refused, tried in one.shares():
        if tried:
            yield f"{one.plan.phase}: {name}: {refused} of {tried} refused ({100.0 * refused / tried:.0f} %)"


def reasons(one: Matrix) -> Iterator[tuple[str, str, str, str]]:
    """Extreme, scheme, letter and words of every cell that needs some."""
    for cell in one.cells:
        if cell.verdict.kind in (STABLE, REFUSED, FAILED):
            names = cell.planned.extreme.name, cell.planned.scheme.name
            yield *names, LETTERS[cell.verdict.kind], cell.verdict.text


def show(one: Matrix, console: Console) -> None:
    """The map and its reasons."""
    from rich.table import Table
    from rich.text import Text

    title = f"{one.plan.scene.title}: {one.plan.phase}"
    table = Table(title=Text(title, style="table.title"), title_justify="left", box=None, pad_edge=False)
    table.add_column("extreme", overflow="fold")
    table.add_column("asked above all", overflow="fold")
    for scheme in one.plan.schemes:
        table.add_column(scheme.name, justify="center", overflow="fold")
    for extreme, cells in by_extreme(one):
        marks = [Text(LETTERS[cell.verdict.kind], style=STYLES[cell.verdict.kind]) for cell in cells]
        table.add_row(Text(extreme.name), Text(", ".join(asked(cells))), *marks)
    console.print(table)
    for key in asked(one.cells):
        if one.words(key) != key:
            console.print(Text(f"  {key}: {one.words(key)}"), highlight=False, soft_wrap=True)
    kinds = {cell.verdict.kind for cell in one.cells}
    console.print(Text(", ".join(f"{LETTERS[k]} {MEANINGS[k]}" for k in LETTERS if k in kinds)), soft_wrap=True)
    for name, how, letter, text in reasons(one):
        console.print(Text(f"  {letter} {name}, {how}: {text}"), highlight=False, soft_wrap=True)
    for sentence in sentences(one):
        console.print(Text(sentence), highlight=False, soft_wrap=True)
    console.print()


def by_extreme(one: Matrix) -> Iterator[tuple[Any, Sequence[Cell]]]:
    """Each extreme with its cells, in the order of the schemes."""
    width = len(one.plan.schemes)
    for number, extreme in enumerate(one.plan.extremes):
        yield extreme, one.cells[number * width : (number + 1) * width]


def as_dict(one: Matrix) -> dict[str, Any]:
    """For machines."""
    return {
        "counts": {kind: len(one.of(kind)) for kind in LETTERS},
        "refused": {name: {"refused": refused, "tried": tried} for name, refused, tried in one.shares()},
        "cells": [
            {
                "extreme": cell.planned.extreme.name,
                "scheme": cell.planned.scheme.name,
                "asked": cell.planned.asked,
                **cell.verdict.told(),
            }
            for cell in one.cells
        ],
        "sentences": list(sentences(one)),
    }
