"""Sweeps and ensembles as tables on the terminal, and as plain data for machines."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from dcone_cosim.cases.chief import chief
from dcone_cosim.cases.statistics import CONFIDENCE, Share, Spread, Summary
from dcone_cosim.cases.table import Column, Entry

if TYPE_CHECKING:
    from rich.console import Console

MOST_ROWS = 40
"""Cases of a sweep that are printed."""
MOST_FIGURES = 4
"""Figures of each that are."""
OUTCOMES = (".outcome", ".lasted")
"""Figures that say how a phase came out."""
MOST_FAILURES = 5
"""Cases that failed that are told of one by one."""


def show_sweep(entries: Sequence[Entry], columns: Sequence[Column], title: str, console: Console) -> None:
    from rich.table import Table
    from rich.text import Text

    keys = list(entries[0].varied)
    shown = chief(columns, max(1, MOST_FIGURES + 1 - len(keys)))
    table = Table(title=Text(title, style="table.title"), title_justify="left", box=None, pad_edge=False)
    for key in keys:
        table.add_column(Text(_broken(key)), justify="right", overflow="fold")
    table.add_column("status", no_wrap=True)
    for column in shown:
        table.add_column(Text(_broken(column.name, column.read.name)), justify="right", overflow="fold")
    for place, entry in enumerate(entries[:MOST_ROWS]):
        given = [Text(short(entry.varied[key].given)) for key in keys]
        figures = [_number(column.read_at(place)) for column in shown]
        table.add_row(*given, Text(entry.row.status), *figures)
    console.print(table)
    if len(entries) > MOST_ROWS:
        console.print(f"and {len(entries) - MOST_ROWS} more cases in the table", highlight=False)


def _broken(name: str, unit: str = "") -> str:
    """The head of a column on several lines, so that it is narrow."""
    return name.replace(".", ".\n") + (f"\n[{unit}]" if unit else "")


def short(given: str) -> str:
    """A value as given, its number with six digits at most: of a range it may have twelve."""
    return re.sub(r"\d+\.\d{5,}", lambda match: f"{float(match[0]):.6g}", given)


def _number(value: Any) -> str:
    if value is None:
        return ""
    return str(value) if isinstance(value, int) else f"{value:.6g}"


def show_ensemble(summary: Summary, title: str, console: Console) -> None:
    from rich.table import Table
    from rich.text import Text

    table = Table(title=Text(title, style="table.title"), title_justify="left", box=None, pad_edge=False)
    table.add_column("", overflow="fold", min_width=24)
    for head in ("mean", "spread", "5 %", "median", "95 %"):
        table.add_column(head, justify="right", no_wrap=True)
    table.add_column("", no_wrap=True)
    previous = ""
    for name, spread in summary.figures.items():
        phase, _, figure = name.partition(".")
        if phase != previous:
            table.add_row(Text(phase, style="bold"))
            previous = phase
        read = spread.read
        numbers = [f"{read.from_si(spread.mean):.5g}"]
        if spread.deviation > 0.0:
            numbers.append(f"{read.from_si(spread.deviation):.2g}")
            numbers += [f"{read.from_si(value):.5g}" for value in spread.percentiles.values()]
        numbers += [""] * (5 - len(numbers))
        table.add_row(Text(f"  {figure}{_lacking(spread)}"), *numbers, read.name)
    console.print(table)
    for line in shares(summary):
        console.print(Text(line), highlight=False)


def _lacking(spread: Spread) -> str:
    parts = []
    if spread.missing:
        parts.append(f"{spread.missing} without it")
    if spread.not_finite:
        parts.append(f"{spread.not_finite} not finite")
    return f" (of {spread.count} runs, {', '.join(parts)})" if parts else ""


def shares(summary: Summary) -> list[str]:
    """How many cases came out how, with the interval of the probability."""
    lines = [f"{summary.cases} runs: {_counted(summary.statuses)} (95 % interval of the probability)"]
    for name, told in summary.texts.items():
        if name.endswith(OUTCOMES):
            lines.append(f"{name}: {_counted(told)}")
    return lines


def _counted(told: Mapping[str, Share]) -> str:
    return ", ".join(
        f"{one.count} {text} ({one.interval[0]:.3g} to {one.interval[1]:.3g})" for text, one in told.items()
    )


def failures(entries: Sequence[Entry]) -> list[str]:
    """Which cases failed and why, the first of them in full sentences."""
    failed = [entry for entry in entries if not entry.row.succeeded]
    lines = [f"{_case(entry)}: {entry.row.message or entry.row.status}" for entry in failed[:MOST_FAILURES]]
    if len(failed) > MOST_FAILURES:
        lines.append(f"and {len(failed) - MOST_FAILURES} more failed; the table has the reason of each")
    return lines


def _case(entry: Entry) -> str:
    parts = [f"{key} = {short(value.given)}" for key, value in entry.varied.items()]
    parts += [f"seed {entry.seed}"] if entry.seed is not None else []
    return ", ".join(parts)


def counts(summary: Summary) -> dict[str, Any]:
    """How many cases came out how, for machines. A grid is no sample: there is no probability to be told of."""
    return {
        "cases": summary.cases,
        "succeeded": summary.succeeded.count,
        "statuses": {status: one.count for status, one in summary.statuses.items()},
    }


def as_dict(summary: Summary) -> dict[str, Any]:
    """Of an ensemble, for machines, numbers with all their digits."""
    return {
        "cases": summary.cases,
        "confidence": CONFIDENCE,
        "succeeded": _share(summary.succeeded),
        "statuses": {status: _share(one) for status, one in summary.statuses.items()},
        "figures": {name: _spread(one) for name, one in summary.figures.items()},
        "texts": {name: {text: _share(one) for text, one in told.items()} for name, told in summary.texts.items()},
    }


def _share(one: Share) -> dict[str, Any]:
    return {"count": one.count, "of": one.of, "share": one.share, "interval": list(one.interval)}


def _spread(one: Spread) -> dict[str, Any]:
    return {
        "unit": one.unit,
        **({"shown_in": one.shown_in} if one.shown_in else {}),
        "count": one.count,
        "missing": one.missing,
        "not_finite": one.not_finite,
        "mean": one.mean,
        "standard_deviation": one.deviation,
        "interval_of_mean": None if math.isnan(one.interval[0]) else list(one.interval),
        "percentiles": {f"{percent:g}": value for percent, value in one.percentiles.items()},
    }
