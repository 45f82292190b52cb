"""A net as it is written: a file of nodes and a file of threads, CSV with heads that name column and unit.

    node, x [m], y [m], z [m], role      from, to, length [m], diameter [mm], stiffness [N/m], mass [g], damping [N s/m]
    1, -3, -3, 0, corner                 1, 2, 0.5, 0.8, , ,
    2, -2.5, -3, 0, mouth                2, 3, , , 5200, 0.4, 0.05

Nodes have whole numbers as names. x and y run along the mouth's two axes, z along the shot: what lies behind the mouth
has z below 0. Without the column z the net is flat. A role is corner (on the mouth's rim, with a bullet), mouth (on the
rim, without), vertex (where the tether is made fast) or nothing.

A thread has a diameter, from which and from the scene's material all else follows, or a stiffness and a mass of its
own; with both the diameter is its section alone. Without a length it is as long as its nodes are apart, without a
damping the scene's ratio holds. Columns may stand in any order; those that no thread uses may be left out. From # on a
line is a comment.
"""

from __future__ import annotations

import csv
import difflib
import math
import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}
MASSES = {"kg": 1.0, "g": 1e-3, "mg": 1e-6}
STIFFNESSES = {"N/m": 1.0, "kN/m": 1e3, "MN/m": 1e6, "N/mm": 1e3}
DASHPOTS = {"N s/m": 1.0, "N.s/m": 1.0}
Units = Mapping[str, float]

NODE_COLUMNS: dict[str, Units] = {"node": {}, "x": LENGTHS, "y": LENGTHS, "z": LENGTHS, "role": {}}
THREAD_COLUMNS: dict[str, Units] = {
    "from": {},
    "to": {},
    "length": LENGTHS,
    "diameter": LENGTHS,
    "stiffness": STIFFNESSES,
    "mass": MASSES,
    "damping": DASHPOTS,
}
ROLES = ("", "corner", "mouth", "vertex")
PLAIN, CORNER, MOUTH, VERTEX = range(len(ROLES))

LINE, NODE, PLACE, ROLE = 0, 1, 2, 5
"""Columns of the numbers of nodes: line of the file, name, place [m] in three, role."""
FROM, TO, LENGTH, DIAMETER, STIFFNESS, MASS, DAMPING = range(1, 8)
"""Columns of those of threads, after the line: names of both nodes, unloaded length [m], diameter [m], stiffness [N/m],
mass [kg]; 0 for what is not told. Dashpot [N s/m]; -1 where the ratio of the scene holds."""

_HEAD = re.compile(r"(?P<name>[^\[\]]*?)\s*(?:\[(?P<unit>[^\[\]]*)\])?")

Row = dict[str, str]


def read_nodes(path: Path) -> list[list[float]]:
    """Numbers of a file of nodes; ValueError, with the line, for what makes none."""
    rows: list[list[float]] = []
    seen: dict[int, int] = {}
    for line, cells, factors in _rows(path, NODE_COLUMNS, ("node", "x", "y", "role")):
        name = _name(line, "node", cells["node"])
        if name in seen:
            raise ValueError(f"line {line}: node {name} stands twice, on line {seen[name]} too")
        seen[name] = line
        role = cells["role"].lower()
        if role not in ROLES:
            raise ValueError(f"line {line}: role = {cells['role']!r}, expected corner, mouth, vertex or nothing")
        place = [_number(line, axis, cells.get(axis, "0"), factors.get(axis, 1.0)) for axis in "xyz"]
        rows.append([line, name, *place, ROLES.index(role)])
    return rows


def read_threads(path: Path) -> list[list[float]]:
    """Numbers of a file of threads; ValueError, with the line, for what makes none."""
    rows: list[list[float]] = []
    seen: dict[tuple[int, int], int] = {}
    for line, cells, factors in _rows(path, THREAD_COLUMNS, ("from", "to")):
        a, b = (_name(line, end, cells[end]) for end in ("from", "to"))
        if a == b:
            raise ValueError(f"line {line}: a thread from node {a} to itself")
        pair = (min(a, b), max(a, b))
        if pair in seen:
            raise ValueError(f"line {line}: the thread from {a} to {b} stands twice, on line {seen[pair]} too")
        seen[pair] = line
        told = {}
        for column in ("length", "diameter", "stiffness", "mass"):
            told[column] = _number(line, column, cells.get(column) or "0", factors.get(column, 1.0))
            if told[column] <= 0.0 and cells.get(column):
                raise ValueError(f"line {line}: {column} = {cells[column]}, expected more than 0")
        if (told["stiffness"] > 0.0) != (told["mass"] > 0.0):
            raise ValueError(f"line {line}: a stiffness without a mass, or a mass without a stiffness; expected both")
        if told["stiffness"] == 0.0 and told["diameter"] == 0.0:
            raise ValueError(f"line {line}: expected a diameter, or a stiffness and a mass")
        damping = -1.0
        if cells.get("damping"):
            damping = _number(line, "damping", cells["damping"], factors["damping"])
            if damping < 0.0:
                raise ValueError(f"line {line}: damping = {cells['damping']}, expected 0 or more")
        rows.append([line, a, b, *told.values(), damping])
    return rows


def rewritten_nodes(path: Path, factor: Callable[[str], float]) -> str:
    """Text of a file of nodes with every number in SI, times the factor of its unit."""
    return _rewritten(path, NODE_COLUMNS, factor)


def rewritten_threads(path: Path, factor: Callable[[str], float]) -> str:
    """Text of a file of threads, as `rewritten_nodes`."""
    return _rewritten(path, THREAD_COLUMNS, factor)


def _rewritten(path: Path, columns: Mapping[str, Units], factor: Callable[[str], float]) -> str:
    si = {name: [unit for unit, of in units.items() if of == 1.0][-1] for name, units in columns.items() if units}
    lines: list[str] = []
    for _, cells, factors in _rows(path, columns, ()):
        if not lines:
            lines.append(", ".join(f"{name} [{si[name]}]" if name in si else name for name in cells))
        told = {name: f"{float(cells[name]) * factors[name] * factor(si[name]):.12g}" for name in si if cells.get(name)}
        lines.append(", ".join({**cells, **told}.values()))
    return "\n".join(lines) + "\n"


def _rows(path: Path, columns: Mapping[str, Units], needed: tuple[str, ...]) -> Iterator[tuple[int, Row, Units]]:
    """Line, cells by column, and factor to SI of each column, row by row."""
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise ValueError("is no text in UTF-8") from None
    factors: dict[str, float] = {}
    for line, row in enumerate(csv.reader(text.partition("#")[0] for text in lines), 1):
        cells = [cell.strip() for cell in row]
        if not any(cells):
            continue
        if not factors:
            factors = dict(_heads(line, cells, columns))
            missing = [name for name in needed if name not in factors]
            if missing:
                raise ValueError(f"line {line}: no column {missing[0]}; expected {_told(columns)}")
            continue
        if len(cells) != len(factors):
            raise ValueError(f"line {line}: {len(cells)} values, expected {len(factors)} as the head has")
        yield line, dict(zip(factors, cells, strict=True)), factors


def _heads(line: int, cells: list[str], columns: Mapping[str, Units]) -> Iterator[tuple[str, float]]:
    """Name and factor to SI of every column."""
    seen = set()
    for cell in cells:
        found = _HEAD.fullmatch(cell)
        name = found["name"].lower() if found is not None else cell
        if found is None or name not in columns:
            near = difflib.get_close_matches(name, columns, 1)
            likely = f'; did you mean "{near[0]}"?' if near else ""
            raise ValueError(f"line {line}: no column is called {cell!r}; expected {_told(columns)}{likely}")
        if name in seen:
            raise ValueError(f"line {line}: the column {name} stands twice")
        seen.add(name)
        units, unit = columns[name], found["unit"]
        if units and unit is None:
            raise ValueError(f"line {line}: {name} has no unit, expected such as {name} [{next(iter(units))}]")
        if units and unit.strip() not in units:
            raise ValueError(f"line {line}: {name} in {unit.strip()!r}, expected one of {', '.join(units)}")
        if not units and unit is not None:
            raise ValueError(f"line {line}: {name} in {unit!r}, expected no unit")
        yield name, units[unit.strip()] if units else 1.0


def _told(columns: Mapping[str, Units]) -> str:
    return ", ".join(f"{name} [{next(iter(units))}]" if units else name for name, units in columns.items())


def _name(line: int, column: str, cell: str) -> int:
    if not (cell.isascii() and cell.isdecimal() and len(cell) <= 9):
        raise ValueError(f"line {line}: {column} = {cell!r}, expected the number of a node, such as 17")
    return int(cell)


def _number(line: int, column: str, cell: str, factor: float) -> float:
    number = _float(cell)
    if not math.isfinite(number):
        raise ValueError(f"line {line}: {column} = {cell!r}, expected a number")
    return number * factor


def _float(cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        return math.nan
