"""What is compared of two runs: every figure of their summaries, the keys of their scenes, their tables bit by bit."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from dcone_cosim.cases.rows import CLOCK
from dcone_cosim.findings import Finding, Reading, reading
from dcone_cosim.reports import summary
from dcone_cosim.results import RunResult
from dcone_cosim.resume.differences import differences
from dcone_cosim.run_folder import tables_of
from dcone_cosim.scene.data import Scene

MISSING = "-"


@dataclass(frozen=True)
class Pair:
    """A figure of both runs; None where a run has none.

    unit      SI, "" for a pure number or a text
    shown_in  unit in which a person reads it, "" for none of its own
    scatter   standard deviation of the difference, where the figures are single samples of chaotic ones; 0 otherwise
    """

    name: str
    label: str
    one: float | int | str | None
    other: float | int | str | None
    unit: str = ""
    scatter: float = 0.0
    shown_in: str = ""

    @property
    def read(self) -> Reading:
        """The unit in which a person reads both."""
        sizes = [abs(value) for value in (self.one, self.other) if isinstance(value, float)]
        return reading(self.unit, self.shown_in, max(sizes, default=math.nan))

    @property
    def difference(self) -> float | None:
        """Of the second from the first, None where there are no two numbers."""
        if isinstance(self.one, str | None) or isinstance(self.other, str | None):
            return None
        return float(self.other) - float(self.one)

    @property
    def percent(self) -> float | None:
        """The same relative to the first, None where that is zero."""
        if self.difference is None or isinstance(self.one, str | None) or not self.one:
            return None
        return 100.0 * self.difference / abs(self.one)

    @property
    def same(self) -> bool:
        return self.one == self.other or (self.one != self.one and self.other != self.other)

    def as_dict(self) -> dict[str, Any]:
        return {
            "figure": self.name,
            "label": self.label,
            "first": self.one,
            "second": self.other,
            "difference": self.difference,
            "percent": self.percent,
            "unit": self.unit or ("" if isinstance(self.one, str) or isinstance(self.other, str) else "1"),
            "scatter": self.scatter,
        }


@dataclass(frozen=True)
class KeyPair:
    """A key in which two scenes differ, as each says it."""

    key: str
    one: str
    other: str


def figures(one: RunResult, other: RunResult) -> list[Pair]:
    """All figures of both, in the order of the first; times of this computer are no results.

    Single samples scatter apart from one another only where they have parted: not behind a capture with the same bits.

    Checked  tests/comparing/test_pairs.py
    """
    first, second = _by_name(one), _by_name(other)
    same = same_tables(one, other)
    apart = not any(same.get(name) for name in one.phases)
    return [_pair(name, first.get(name), second.get(name), apart) for name in {**first, **second}]


def _by_name(run: RunResult) -> dict[str, Finding]:
    return {f"{row.phase}.{row.key}": row for row in summary.findings(run) if row.key not in CLOCK}


def _pair(name: str, one: Finding | None, other: Finding | None, apart: bool) -> Pair:
    row = one or other
    assert row is not None
    sizes = [abs(float(r.value)) * r.spread for r in (one, other) if r is not None and not isinstance(r.value, str)]
    scatter = math.hypot(*sizes) if apart else 0.0
    first, second = (None if r is None else r.value for r in (one, other))
    return Pair(name, row.label, first, second, row.unit, scatter, row.shown_in)


def scene_keys(one: Scene, other: Scene) -> list[KeyPair]:
    """Keys in which two scenes differ, as they are written; of packages, as they reach the FMUs, in SI."""
    if all(scene.source.endswith(".toml") for scene in (one, other)):
        first, second = (dict(_flat(tomllib.loads(scene.text))) for scene in (one, other))
        keys = [key for key in {**first, **second} if key != "title" and first.get(key) != second.get(key)]
        return [KeyPair(key, first.get(key, MISSING), second.get(key, MISSING)) for key in keys]
    return [KeyPair(row.key, str(row.was), str(row.now)) for row in differences(one, other)]


def _flat(table: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, str]]:
    for key, value in table.items():
        name = f"{before}{key}"
        if isinstance(value, Mapping):
            yield from _flat(value, f"{name}.")
        else:
            yield name, value if isinstance(value, str) else repr(value)


def same_tables(one: RunResult, other: RunResult) -> dict[str, bool]:
    """Whether the tables that both have hold the same bits."""
    first, second = dict(tables_of(one)), dict(tables_of(other))
    return {name: bool(first[name].equals(second[name])) for name in first if name in second}
