"""Tracks of markers, as a camera system leaves them: a CSV with the columns time, marker, x, y, z.

Times count from the shot [s]. Positions are in the shot's frame [m]: from the muzzle, `x` and `y` along the two
transverse axes, `z` along the shot, as the README of the net capture says. Rows may stand in any order. A marker is

    bullet 1     a bullet, by its number         vertex     where the tether is made fast
    node 25      a node of the net, by its number among the outputs
"""

from __future__ import annotations

import csv
import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from dcone_cosim.errors import InputError
from dcone_cosim.files import regular

Array = npt.NDArray[np.float64]
COLUMNS = ("time", "marker", "x", "y", "z")
MARKER = re.compile(r"(bullet|node) ([1-9]\d*)|vertex")
EXPECTED = "bullet 1, node 25 or vertex"


@dataclass(frozen=True)
class Track:
    """Where a marker was seen.

    times        since the shot, rising [s]
    positions    in the shot's frame, (n, 3) [m]
    """

    marker: str
    times: Array
    positions: Array

    @property
    def kind(self) -> str:
        """bullet, node or vertex."""
        return self.marker.partition(" ")[0]

    @property
    def number(self) -> int:
        """Of a bullet or node, counted from 1; 0 of the vertex."""
        return int(self.marker.partition(" ")[2] or 0)


def read_tracks(path: Path) -> list[Track]:
    """Tracks of a file, in the order in which its markers first appear; `InputError` that names the line and what was
    expected."""
    try:
        text = regular(path).read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise InputError(f"{path} does not exist; expected a CSV with the columns {', '.join(COLUMNS)}") from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path} cannot be read: {getattr(error, 'strerror', None) or error}") from None
    seen: dict[str, list[tuple[float, ...]]] = {}
    for count, row in enumerate(csv.reader(text.splitlines()), 1):
        cells = [cell.strip() for cell in row]
        if count == 1:
            if tuple(cells) != COLUMNS:
                raise InputError(f"{path}, line 1: {','.join(cells)[:60]!r}; expected the head {','.join(COLUMNS)}")
        elif cells and not cells[0].startswith("#"):
            marker, numbers = _row(path, count, cells)
            seen.setdefault(marker, []).append(numbers)
    if not seen:
        raise InputError(f"{path} has no rows; expected {', '.join(COLUMNS)} of at least one marker")
    return [_track(path, marker, rows) for marker, rows in seen.items()]


def _row(path: Path, count: int, cells: list[str]) -> tuple[str, tuple[float, ...]]:
    if len(cells) != len(COLUMNS):
        raise InputError(f"{path}, line {count}: {len(cells)} values; expected {len(COLUMNS)}: {', '.join(COLUMNS)}")
    if MARKER.fullmatch(cells[1]) is None:
        raise InputError(f"{path}, line {count}: marker = {cells[1]!r}; expected {EXPECTED}")
    numbers = []
    for name, cell in ((COLUMNS[0], cells[0]), *zip(COLUMNS[2:], cells[2:], strict=True)):
        try:
            number = float(cell)
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            raise InputError(f"{path}, line {count}: {name} = {cell!r}; expected a number")
        numbers.append(number)
    if numbers[0] < 0.0:
        raise InputError(f"{path}, line {count}: time = {numbers[0]:g} s; expected one since the shot, 0 or later")
    return cells[1], tuple(numbers)


def _track(path: Path, marker: str, rows: list[tuple[float, ...]]) -> Track:
    numbers = np.array(sorted(rows))
    twice = np.flatnonzero(np.diff(numbers[:, 0]) == 0.0)
    if len(twice):
        raise InputError(f"{path}: {marker} stands twice at {numbers[twice[0], 0]:g} s; expected one place at a time")
    return Track(marker, numbers[:, 0], numbers[:, 1:])
