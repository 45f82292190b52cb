"""A part of a report: a table whose columns know their units, what it is for, and from what its numbers come.

Terminal, page, files and notebook all show the same parts.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from dcone_cosim.cases.table import Column
from dcone_cosim.units import by_name, spoken

if TYPE_CHECKING:
    import pandas as pd

Cell = float | int | str | bool | None
ROW = "row"
"""In the place of a unit: each row has its own, in the column `unit`."""

REACHES = (
    ("Pa", 1e9, math.inf, "GPa"),
    ("Pa", 1e6, 1e9, "MPa"),
    ("m", 1e4, math.inf, "km"),
    ("m", 1e-9, 0.1, "mm"),
)
"""Units, sizes from and below which a reader sees them in another, and that."""


@dataclass(frozen=True)
class Head:
    """A column.

    key       its name for machines;  label   for a reader
    unit      of its SI values, "1" for a share, "" for texts
    shown_in  unit in which a reader sees them, "" for the same; "%" for shares
    """

    key: str
    label: str
    unit: str = "1"
    shown_in: str = ""

    @property
    def title(self) -> str:
        """Label with the unit shown."""
        unit = self.shown_in or self.unit
        return f"{self.label} [{spoken(unit)}]" if unit not in ("", "1", ROW) else self.label

    def shown(self, value: Cell) -> str:
        """A value as a reader sees it, in four digits."""
        if value is None or (isinstance(value, float) and math.isnan(value)):
            return ""
        if isinstance(value, bool):
            return "yes" if value else "no"
        if isinstance(value, str):
            return value
        if self.shown_in == "%":
            value = 100.0 * value
        elif self.shown_in:
            value = by_name(self.shown_in).from_si(float(value))
        if isinstance(value, int):
            return str(value)
        return f"{value:.4g}" if abs(value) < 1e4 or abs(value) >= 1e7 else f"{value:,.0f}"


def text(key: str, label: str) -> Head:
    """A column of texts."""
    return Head(key, label, "")


@dataclass
class Section:
    """A table of a report.

    key       its name for machines, and of its CSV file
    purpose   what its numbers are for, and how they came to be
    heads     of its columns; rows   each with a value for every column
    picture   name of the file of its picture, "" for none
    said      sentences under it
    """

    key: str
    title: str
    purpose: str
    heads: Sequence[Head]
    rows: Sequence[Sequence[Cell]]
    picture: str = ""
    said: list[str] = field(default_factory=list)

    def frame(self) -> pd.DataFrame:
        """As a table of pandas, SI; `attrs["units"]` has the unit of each column."""
        import pandas as pd

        frame = pd.DataFrame([list(row) for row in self.rows], columns=[head.key for head in self.heads])
        frame.attrs["units"] = {head.key: head.unit for head in self.heads if head.unit}
        return frame

    def columns(self) -> list[Column]:
        """The same as columns of a file."""
        return [
            Column(head.key, [_plain(row[i]) for row in self.rows], "1" if head.unit in ("", ROW) else head.unit)
            for i, head in enumerate(self.heads)
        ]

    def told(self) -> dict[str, Any]:
        """For machines: SI."""
        units = {head.key: head.unit for head in self.heads if head.unit}
        rows = [{head.key: value for head, value in zip(self.heads, row, strict=True)} for row in self.rows]
        return {"title": self.title, "purpose": self.purpose, "units": units, "rows": rows, "said": self.said}

    def cells(self) -> list[list[str]]:
        """As a reader sees it."""
        return [
            [head.shown(value) for head, value in zip(self.heads, row, strict=True)]
            for row in map(self._read, self.rows)
        ]

    def _read(self, row: Sequence[Cell]) -> Sequence[Cell]:
        """A row whose value has a unit of its own, in the unit that a reader sees."""
        places = {head.unit if head.unit == ROW else head.key: place for place, head in enumerate(self.heads)}
        value = row[places[ROW]] if ROW in places else None
        if not isinstance(value, float):
            return row
        found = list(row)
        found[places[ROW]], found[places["unit"]] = in_reach(value, str(row[places["unit"]]))
        return found


def in_reach(value: float, unit: str) -> tuple[float, str]:
    """A value and its unit, of those in `REACHES` where there is one.

    Checked  tests/sizing/test_report.py
    """
    reach = next((row for row in REACHES if row[0] == unit and row[1] <= abs(value) < row[2]), None)
    return (by_name(reach[3]).from_si(value), reach[3]) if reach else (value, "" if unit == "1" else unit)


def _plain(value: Cell) -> Cell:
    return str(value) if isinstance(value, bool) else value


def long_table(sections: Sequence[Section]) -> list[Column]:
    """All parts as one table: a row for each number, with its part, what its row is of, its name and unit."""
    rows: list[tuple[str, str, str, float, str]] = []
    for section in sections:
        for row in section.rows:
            label = ", ".join(str(v) for h, v in zip(section.heads, row, strict=True) if not h.unit and v)
            own = dict(zip((head.key for head in section.heads), row, strict=True)).get("unit")
            for head, value in zip(section.heads, row, strict=True):
                if head.unit and value is not None and not isinstance(value, str):
                    rows.append(
                        (section.key, label, head.key, float(value), str(own) if head.unit == ROW else head.unit)
                    )
    names = ("part", "row", "quantity", "value", "unit")
    return [Column(name, [row[i] for row in rows]) for i, name in enumerate(names)]
