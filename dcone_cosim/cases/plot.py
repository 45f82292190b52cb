"""A sweep drawn: its chief figures over the key that is varied, a line for each value of a second one."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from dcone_cosim.cases.chief import chief
from dcone_cosim.cases.show import short
from dcone_cosim.cases.table import Column, Entry
from dcone_cosim.plots import style
from dcone_cosim.scene.expected import number_and_unit
from dcone_cosim.units import named, spoken

MOST = 6
"""Figures drawn."""
MOST_LINES = 10
"""Values of the second key that are told apart by colour."""
COLUMNS = 3
"""Of the legend."""
TICKS = 5
"""Of an axis at most: numbers of many digits must not run into each other."""
DECADES = 100.0
"""Ratio of largest to smallest value from which an axis is logarithmic."""


def draw(entries: Sequence[Entry], columns: Sequence[Column], title: str, path: Path) -> str:
    """Draw to a file; returns why there is no picture, "" when there is one."""
    from matplotlib import rc_context

    keys = list(entries[0].varied)
    if len(keys) > 2:
        return f"no figure is drawn of {len(keys)} varied keys; the table has them all"
    shown = chief(columns, MOST)
    if not shown:
        return "no figure is drawn: no figure of the summary is a number that changes"
    by_name = {column.name: column for column in columns}
    across = keys[0] if keys[0] in by_name or keys[-1] not in by_name else keys[1]
    second = next((key for key in keys if key != across), None)
    with rc_context(style.SETTINGS):
        figure = _figure(entries, shown, across, second, by_name)
        style.head(figure, title)
        style.save(figure, path)
    return ""


def _figure(
    entries: Sequence[Entry], shown: Sequence[Column], across: str, second: str | None, by_name: Mapping[str, Column]
) -> Any:
    places, names, unit = _places(entries, across, by_name)
    width = 2 if len(shown) > 1 else 1
    height = math.ceil(len(shown) / width)
    lines = min(len({entry.varied[second].given for entry in entries}), MOST_LINES) if second else 0
    rows = math.ceil((lines + any(not entry.row.succeeded for entry in entries)) / COLUMNS)
    top = 0.6 + style.LEGEND_ROW * rows
    size = (4.6 * width, 2.3 * height + top + 0.55)
    figure = style.new_figure(*size)
    grid = figure.subplots(height, width, squeeze=False, sharex=True)
    figure.subplots_adjust(left=1.05 / size[0], right=1.0 - 0.2 / size[0])
    figure.subplots_adjust(bottom=0.5 / size[1], top=1.0 - top / size[1], wspace=0.36, hspace=0.12)
    for axes, column in zip(grid.flat, shown, strict=False):
        _curves(axes, entries, places, second, column)
        _failures(axes, entries, places)
        axes.set_ylabel(_labelled(column.name, spoken(column.read.name)), fontsize=8, parse_math=False)
        if names:
            axes.set_xticks(range(len(names)), names, parse_math=False)
        else:
            axes.ticklabel_format(useOffset=False)
            axes.locator_params(nbins=TICKS)
            _spread_decades(axes, places)
    for axes in list(grid.flat)[len(shown) :]:
        axes.set_visible(False)
    for axes in list(grid.flat)[max(0, len(shown) - width) : len(shown)]:
        axes.set_xlabel(_labelled(across, unit), fontsize=8, parse_math=False)
        axes.tick_params(labelbottom=True)
    style.legend(grid[0, 0], columns=COLUMNS)
    figure.align_ylabels()
    return figure


def _spread_decades(axes: Any, places: Sequence[float]) -> None:
    """A logarithmic axis for values of one sign over decades, be they negative."""
    sizes = [abs(place) for place in places]
    if len(set(places)) < 3 or min(sizes) == 0.0 or max(sizes) / min(sizes) < DECADES:
        return
    if min(places) > 0.0:
        axes.set_xscale("log")
    elif max(places) < 0.0:
        axes.set_xscale("symlog", linthresh=min(sizes), linscale=0.2)
        axes.set_xlim(right=-0.8 * min(sizes))


def _labelled(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit not in ("", "1") else name


def _places(entries: Sequence[Entry], key: str, by_name: Mapping[str, Column]) -> tuple[list[float], list[str], str]:
    """Where each case stands on the axis; names of the places if the key's values are no numbers; their unit, the one
    in which all of them are given, if there is one."""
    if key not in by_name:
        names = list(dict.fromkeys(entry.varied[key].given for entry in entries))
        return [float(names.index(entry.varied[key].given)) for entry in entries], names, "1"
    numbers = by_name[key].numbers()
    units = {(number_and_unit(entry.varied[key].given) or (0.0, ""))[1] for entry in entries}
    own = named(units.pop()) if len(units) == 1 and "" not in units else None
    if own is None:
        return numbers, [], by_name[key].unit
    return [own.from_si(number) for number in numbers], [], spoken(own.name)


def _curves(axes: Any, entries: Sequence[Entry], places: Sequence[float], second: str | None, column: Column) -> None:
    lines = list(dict.fromkeys(entry.varied[second].given if second else "" for entry in entries))
    values = [column.read.from_si(value) for value in column.numbers()]
    for number, line in enumerate(lines):
        chosen = [i for i, entry in enumerate(entries) if second is None or entry.varied[second].given == line]
        chosen = [i for i in chosen if entries[i].row.complete]
        order = sorted(chosen, key=lambda i: places[i])
        colour = _colour(number, len(lines))
        label = f"{second} = {short(line)}" if second and number < MOST_LINES else None
        axes.plot(
            [places[i] for i in order], [values[i] for i in order], "o-", ms=3.5, lw=1.2, color=colour, label=label
        )


def _colour(number: int, count: int) -> Any:
    if count == 1:
        return style.CHASER
    from matplotlib import colormaps

    return colormaps["viridis"](0.9 * number / (count - 1))


def _failures(axes: Any, entries: Sequence[Entry], places: Sequence[float]) -> None:
    """A cross on the axis for each case that failed."""
    failed = [place for place, entry in zip(places, entries, strict=True) if not entry.row.succeeded]
    if failed:
        axes.plot(
            failed, np.zeros(len(failed)), "x", color=style.BULLET, ms=6, clip_on=False,
            transform=axes.get_xaxis_transform(), label="failed",
        )  # fmt: skip
