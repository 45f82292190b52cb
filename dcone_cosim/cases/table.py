"""All cases as one table: a row per case, what was varied in front, what came of it behind.

    KEY               the varied key in SI, where its values are numbers
    given.KEY         the same as it was given
    seed              of an ensemble
    status exit_code message
    PHASE.FIGURE      every figure of the summary; empty where a case does not have it
    PHASE.FIGURE.told what is told instead of a number, of a figure that is a number in other cases
    key               hash of the case

What the cases cost is in a table of its own, so that this one has the same bits however often the work was stopped and
on however many processors it ran.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dcone_cosim.cases.case import Value
from dcone_cosim.cases.rows import Row, unit_of
from dcone_cosim.findings import Reading, reading
from dcone_cosim.run_folder import csv_head

if TYPE_CHECKING:
    import pyarrow as pa


@dataclass(frozen=True)
class Entry:
    """A case with its row."""

    row: Row
    varied: Mapping[str, Value] = field(default_factory=dict)
    seed: int | None = None


@dataclass(frozen=True)
class Column:
    """A column; `values` are of one type, None where there is none; `shown_in` as a row has it."""

    name: str
    values: Sequence[Any]
    unit: str = "1"
    shown_in: str = ""

    @property
    def read(self) -> Reading:
        """The unit in which a person reads it: one for all its values."""
        sizes = [abs(one) for one in self.values if isinstance(one, float) and math.isfinite(one)]
        return reading(self.unit, self.shown_in, max(sizes, default=math.nan))

    def read_at(self, place: int) -> Any:
        """A value of it in that unit."""
        value = self.values[place]
        return self.read.from_si(value) if isinstance(value, float) else value

    def numbers(self) -> list[float]:
        """Its values, NaN where there is none."""
        return [float("nan") if value is None else float(value) for value in self.values]


def columns(entries: Sequence[Entry]) -> list[Column]:
    """The columns of the table, in their order."""
    found = [*_varied(entries), *_told(entries)]
    names = {column.name for column in found} | {"key"}
    for column in _figures([entry.row for entry in entries]):
        found.append(replace(column, name=f"result.{column.name}") if column.name in names else column)
    return [*found, Column("key", [entry.row.key for entry in entries])]


def _varied(entries: Sequence[Entry]) -> Iterable[Column]:
    for key in dict.fromkeys(key for entry in entries for key in entry.varied):
        values = [entry.varied[key] for entry in entries]
        units = {value.unit for value in values}
        if len(units) == 1 and all(value.number is not None for value in values):
            yield Column(key, [value.number for value in values], units.pop())
        yield Column(f"given.{key}", [value.given for value in values])


def _told(entries: Sequence[Entry]) -> Iterable[Column]:
    if any(entry.seed is not None for entry in entries):
        yield Column("seed", [entry.seed for entry in entries])
    for name in ("status", "exit_code", "message"):
        yield Column(name, [getattr(entry.row, name) for entry in entries])


def _figures(rows: Sequence[Row]) -> Iterable[Column]:
    for name in _in_order(row.figures for row in rows):
        values = [row.figures.get(name) for row in rows]
        numbers = [None if isinstance(value, str) else value for value in values]
        texts = [value if isinstance(value, str) else None for value in values]
        is_number = any(value is not None for value in numbers)
        if is_number:
            whole = all(isinstance(value, int) for value in numbers if value is not None)
            floats = numbers if whole else [None if v is None else float(v) for v in numbers]
            yield Column(name, floats, *unit_of(rows, name))
        if any(text is not None for text in texts):
            yield Column(f"{name}.told" if is_number else name, texts)


def _in_order(tables: Iterable[Mapping[str, Any]]) -> list[str]:
    """Every name there is: phases as they come, and within each the names of the fullest table first."""
    of: dict[str, dict[str, None]] = {}
    for table in sorted(tables, key=len, reverse=True):
        for name in table:
            of.setdefault(name.partition(".")[0], {})[name] = None
    return [name for names in of.values() for name in names]


def timings(entries: Sequence[Entry]) -> list[Column]:
    """What each case cost [s], where that is known."""
    rows = [entry.row for entry in entries]
    times = [
        Column(name, [row.timings.get(name) for row in rows], "s") for name in _all_of(row.timings for row in rows)
    ]
    return [Column("key", [row.key for row in rows]), *times]


def _all_of(tables: Iterable[Mapping[str, Any]]) -> list[str]:
    return list(dict.fromkeys(name for table in tables for name in table))


def as_arrow(found: Sequence[Column]) -> pa.Table:
    """The same as the tables of a run have it: units in the metadata of the fields, and for pandas in `df.attrs`."""
    import pyarrow as pa

    arrays = [pa.array(column.values, _kind(column), from_pandas=False) for column in found]
    fields = [
        pa.field(column.name, array.type, metadata={"unit": column.unit})
        for column, array in zip(found, arrays, strict=True)
    ]
    attributes = {"units": {column.name: column.unit for column in found}}
    return pa.Table.from_arrays(arrays, schema=pa.schema(fields, {"PANDAS_ATTRS": json.dumps(attributes)}))


def _kind(column: Column) -> Any:
    import pyarrow as pa

    value = next((value for value in column.values if value is not None), None)
    return pa.string() if isinstance(value, str) else pa.int64() if isinstance(value, int) else pa.float64()


def write(entries: Sequence[Entry], folder: Path) -> list[Column]:
    """`table.parquet`, `table.csv` and `timings.parquet`; returns the columns of the first."""
    import pyarrow.csv
    import pyarrow.parquet

    found = columns(entries)
    table = as_arrow(found)
    pyarrow.parquet.write_table(table, folder / "table.parquet")
    pyarrow.csv.write_csv(table.rename_columns([csv_head(f) for f in table.schema]), folder / "table.csv")
    pyarrow.parquet.write_table(as_arrow(timings(entries)), folder / "timings.parquet")
    return found
