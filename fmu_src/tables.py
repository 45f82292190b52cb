"""Tables that a part brings along: numbers of a file that are too many for parameters, as a grid or a measured curve.

They are data, not code: a table of another content or length costs no build. Their kernels see them in one block of
eight-byte words, which nobody writes to and instances may share:

    4 for each table   place of its first number, counted in words from the block's beginning; then its extents along
                       the first, second and third index, 1 for those it has not
    then               its numbers in C order, each table at a multiple of eight words

The same block is a file of the FMU (`packaging/table_file.py`) and the memory of an instance in this process.

Checked  tests/packaging/test_tables.py
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from orbital.kernel import view

ROW = 4
"""Words of the directory for each table."""
LINE = 8
"""Words of a cache line, at whose multiples tables begin."""
MOST_DIMENSIONS = 3


def read_rows(path: Path, units: Sequence[str] = ()) -> list[list[float]]:
    """Numbers of a text file, a row a line, apart by commas or blanks; from # on a line is a comment.

    units    of the columns, where a head may stand before the rows, `time [s], x [m/s2]`: it has to name these

    ValueError, with the number of the line, for what is no number, and for a row that is not as long as the first.
    """
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise ValueError("is no text in UTF-8") from None
    rows: list[list[float]] = []
    headed = False
    for count, line in enumerate(lines, 1):
        bare = line.partition("#")[0]
        if units and not rows and not headed and "[" in bare:
            headed = _check_head(count, bare, units)
            continue
        words = bare.replace(",", " ").split()
        try:
            row = [float(word) for word in words]
        except ValueError:
            raise ValueError(f"line {count}: expected numbers, found {line.strip()[:40]!r}") from None
        if rows and row and len(row) != len(rows[0]):
            raise ValueError(f"line {count}: {len(row)} numbers, expected {len(rows[0])} as in the rows before")
        rows += [row] if row else []
    return rows


def _check_head(count: int, line: str, units: Sequence[str]) -> bool:
    """True for a head that names these units; ValueError for one that names others."""
    found = [unit.strip().replace("^", "") for unit in re.findall(r"\[([^\[\]]*)\]", line)]
    if found != list(units):
        raise ValueError(f"line {count}: a head with the units {', '.join(found)}, expected {', '.join(units)}")
    return True


@dataclass(frozen=True)
class Table:
    """One table of a part: numbers in a grid of one to three dimensions, whose extents come with them.

    name    also what a scene says: key `knots` in `[capture.net]` is the table `net.knots`, its value a path of a file
    unit    FMI unit name of the SI values, "1" for pure numbers, or for columns of several units
    read    `read(path)`: the numbers of such a file; ValueError, with the line where there is one, for what is none
    entry   rows that a scene may say of each of its entries, where it is no file but an array of tables
    gather  `gather(entries)`: the numbers of such entries, each with what it says by key [SI]; ValueError as `read`
    counted_in  row of the scene's that says the unit of its numbers, "" where the file does
    rewritten   `rewritten(path, factor)`: text of such a file with every number times the factor of its FMI unit
    made    `made(numbers)`: the numbers of one that no scene gives, from those of the tables before it, by name
    beside  group and term of it, beside which alone the part has this table; None: beside all
    """

    name: str
    unit: str
    description: str
    dimensions: int = 1
    read: Callable[[Path], npt.ArrayLike] = read_rows
    entry: tuple[Any, ...] = ()
    gather: Callable[[Sequence[Mapping[str, Any]]], npt.ArrayLike] | None = None
    made: Callable[[Mapping[str, npt.NDArray[np.float64]]], npt.ArrayLike] | None = None
    counted_in: str = ""
    rewritten: Callable[[Path, Callable[[str], float]], str] | None = None
    beside: tuple[str, str] | None = None

    def __post_init__(self) -> None:
        if not 1 <= self.dimensions <= MOST_DIMENSIONS:
            raise ValueError(f"table {self.name}: {self.dimensions} dimensions, expected 1 to {MOST_DIMENSIONS}")
        if self.beside is not None and self.made is None:
            raise ValueError(f"table {self.name}: a scene gives it, it cannot hang on the choice of {self.beside[0]}")

    def numbers(self, given: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """A copy of what is given, as it is kept; ValueError if it can not be this table."""
        values = np.array(given, dtype="<f8", order="C")
        if values.size == 0:
            raise ValueError("it is empty")
        if values.ndim != self.dimensions:
            raise ValueError(f"{values.ndim} dimensions given, expected {self.dimensions}")
        bad = np.argwhere(~np.isfinite(values))
        if len(bad):
            where = ", ".join(str(index + 1) for index in bad[0])
            raise ValueError(f"number {where} is {values[tuple(bad[0])]:g}, expected a finite one")
        values.flags.writeable = False
        return values


def from_files(tables: Iterable[Table]) -> list[Table]:
    """Those that a scene gives."""
    return [table for table in tables if table.made is None]


def demand(tables: Sequence[Table], given: Container[str], model: str) -> None:
    """ValueError for the first table of a model that was not given."""
    for table in from_files(tables):
        if table.name not in given:
            raise ValueError(f"this {model} needs the table {table.name} ({table.description}), and was given none")


def numbers(
    tables: Sequence[Table], given: Mapping[str, npt.ArrayLike], model: str
) -> dict[str, npt.NDArray[np.float64]]:
    """What each table of a model is given or made of; ValueError if one is missing, unknown, or can not be what it is
    for."""
    known = {table.name for table in from_files(tables)}
    for name in given:
        if name not in known:
            raise ValueError(f"table {name}: this {model} has no table of that name")
    demand(tables, given, model)
    found: dict[str, npt.NDArray[np.float64]] = {}
    for table in tables:
        try:
            found[table.name] = table.numbers(given[table.name] if table.made is None else table.made(found))
        except ValueError as error:
            raise ValueError(f"table {table.name}: {error}") from None
    return found


def block(tables: Sequence[Table], given: Mapping[str, npt.NDArray[np.float64]]) -> npt.NDArray[np.int64]:
    """The block of these tables, as words, at a multiple of 64 bytes; empty where there is none."""
    first = _whole_lines(ROW * len(tables))
    directory = np.ones((len(tables), ROW), dtype="<i8")
    for row, table in zip(directory, tables, strict=True):
        row[0] = first
        row[1 : 1 + table.dimensions] = given[table.name].shape
        first += _whole_lines(given[table.name].size)
    memory = np.zeros(first + LINE, dtype="<i8")
    words = memory[-memory.ctypes.data // 8 % LINE :][:first]
    words[: directory.size] = directory.ravel()
    for row, table in zip(directory, tables, strict=True):
        words[row[0] : row[0] + given[table.name].size] = given[table.name].ravel().view("<i8")
    words.flags.writeable = False
    return words


def _whole_lines(words: int) -> int:
    return words + -words % LINE


def identity(words: npt.NDArray[np.int64]) -> int:
    """A whole number that tells one block from another: 63 bits of its SHA-256, and never 0."""
    return int.from_bytes(hashlib.sha256(words.tobytes()).digest()[:8], "little") >> 1 or 1


def make_reader(tables: Sequence[Table], name: str) -> Any:
    """Kernel `reader(p) -> array`: one of a model's tables, as it was given; it can not be written to.

    tables    of the interface, in its order
    p         the record, whose `tables_at` is the block's address while the model's entry runs

    The array is to be used where it was asked for, and nowhere kept. ValueError for a name that is none.
    """
    places = {table.name: place for place, table in enumerate(tables)}
    if name not in places:
        raise ValueError(f"no part of this model brings a table {name!r}")
    place, dimensions = places[name], tables[places[name]].dimensions
    from llvmlite import ir
    from numba import types
    from numba.extending import intrinsic

    word, kind = ir.IntType(64), types.Array(types.float64, dimensions, "C", readonly=True)

    @intrinsic
    def table_at(context: Any, address: Any) -> Any:
        def emit(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            words = builder.inttoptr(args[0], word.as_pointer())
            entries = [builder.gep(words, [word(ROW * place + k)]) for k in range(1 + dimensions)]
            first, *extents = (builder.load(entry) for entry in entries)
            strides = [word(8)]
            for extent in reversed(extents[1:]):
                strides.insert(0, builder.mul(extent, strides[0]))
            array = context.make_array(kind)(context, builder)
            data = builder.bitcast(builder.gep(words, [first]), array.data.type)
            context.populate_array(
                array, data=data, shape=extents, strides=strides, itemsize=word(8), meminfo=None, parent=None
            )
            return array._getvalue()

        return kind(types.int64), emit

    @view
    def reader(p):  # type: ignore[no-untyped-def]
        return table_at(p.tables_at)  # type: ignore[call-arg]

    return reader
