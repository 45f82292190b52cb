"""Error against CPU time, both in decades: a line for each family of settings, the front of the best, and the floor."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from dcone_cosim.accuracy.judge import Axis, Judged, Report, front, own
from dcone_cosim.plots import style

WIDTH = 2
"""Panels side by side."""
WIDE, LINE = 9.2, 0.18
"""Of the figure, and a line of its title [inch]."""
COLUMNS, BESIDES = 5, 3
"""Of the legend, and what is in it beside the families: floor, front and the scene as it is."""
COLOURS = (
    *("#1f4e79", "#c0392b", "#2e8b57", "#b8860b", "#7d3c98", "#4a9fc5", "#8a6d3b"),
    *("#e07b39", "#c06c9b", "#333333", "#6b8e23", "#20808d"),
)
MARKS = "osD^vP*Xhd<>"
LEAST = 1e-12
"""Errors below are drawn there."""


def draw(report: Report, path: Path) -> None:
    """A panel with the worst error, one for each quantity, and one for each further axis."""
    from matplotlib import rc_context

    with rc_context(style.SETTINGS):
        _draw(report, path)


def _draw(report: Report, path: Path) -> None:
    axis = report.numerics
    panels: list[tuple[str, Axis, str | None]] = [(f"worst of those marked •, by {axis.name}", axis, None)]
    panels += [
        (f"{about['label']}{' •' if about['meant'] else ''} [of {about['relative_to']}]", axis, key)
        for key, about in report.quantities.items()
    ]
    panels += [(f"worst, by {other.name}", other, None) for other in report.axes[1:]]
    panels = panels[:1] + [panel for panel in panels[1:] if _differs(panel[1], panel[2])]
    rows = math.ceil(len(panels) / WIDTH)
    title = f"{report.plan.title}: {report.plan.phase}"
    longer = LINE * (len(style.wrapped(title, WIDE)[0]) - 1)
    head = 0.75 + longer + 0.2 * math.ceil((len(axis.families) + BESIDES) / COLUMNS)
    size = (WIDE, 2.7 * rows + head + 0.05)
    figure = style.new_figure(*size)
    grid = figure.subplots(rows, WIDTH, squeeze=False)
    figure.subplots_adjust(left=0.8 / size[0], right=1.0 - 0.2 / size[0], bottom=0.5 / size[1])
    figure.subplots_adjust(top=1.0 - head / size[1], wspace=0.24, hspace=0.52)
    for axes, (text, of, key) in zip(grid.flat, panels, strict=False):
        _panel(axes, of, key)
        axes.set_title(text, fontsize=8.5, loc="left", parse_math=False)
    for axes in list(grid.flat)[len(panels) :]:
        axes.set_visible(False)
    handles, labels = grid.flat[0].get_legend_handles_labels()
    anchor = (0.6 / size[0], 1.0 - (0.4 + longer) / size[1])
    figure.legend(handles, labels, loc="upper left", bbox_to_anchor=anchor, ncols=COLUMNS, fontsize=8)
    style.head(figure, title)
    style.save(figure, path)


def _differs(axis: Axis, key: str | None) -> bool:
    """Whether there is anything to be seen: settings that differ, by more than rounding, and not from one alone."""
    told = [_value(p, key)[0] for p in axis.points if p.setting != axis.reference]
    return any(LEAST < value < math.inf for value in told)


def _value(point: Judged, key: str | None) -> tuple[float, float]:
    """Error and floor of a point [1]."""
    if key is None:
        return point.worst, point.floor
    return point.errors.get(key, math.nan), point.floors.get(key, 0.0)


def _panel(axes: Any, axis: Axis, key: str | None) -> None:
    for number, family in enumerate(axis.families):
        points = [p for p in axis.points if p.setting.family == family and math.isfinite(_value(p, key)[0])]
        points = [p for p in points if p.setting != axis.reference]
        errors = [max(_value(p, key)[0], LEAST) for p in points]
        costs = [p.sample.cpu for p in points]
        colour, mark = COLOURS[number % len(COLOURS)], MARKS[number % len(MARKS)]
        dash = ":" if points and points[0].setting.peer else "-"
        axes.plot(errors, costs, mark + dash, ms=4, lw=1.1, color=colour, label=family)
    floor = max((_value(p, key)[1] for p in axis.points if math.isfinite(_value(p, key)[0])), default=0.0)
    if floor > LEAST:
        axes.axvspan(LEAST / 100.0, floor, color=style.MUTED, alpha=0.15, lw=0, label="below what can be told")
    if key is None:
        best = [p for p in front(own(axis.points)) if p.setting != axis.reference]
        axes.plot(
            [max(p.worst, LEAST) for p in best], [p.sample.cpu for p in best], "--", lw=2.4, color="black", alpha=0.35,
            label="the best",
        )  # fmt: skip
    here, _ = _value(axis.here, key)
    if math.isfinite(here):
        axes.plot(
            [max(here, LEAST)], [axis.here.sample.cpu], "o", ms=9, mfc="none", mec="black", mew=1.2,
            label="the scene as it is",
        )  # fmt: skip
    lines = [(line.get_xdata(), line.get_ydata()) for line in axes.lines]
    _decades(axes.xaxis, axes.set_xscale, axes.set_xlim, [x for xs, _ in lines for x in xs])
    _decades(axes.yaxis, axes.set_yscale, axes.set_ylim, [y for _, ys in lines for y in ys])
    axes.set_xlabel("error [1]", fontsize=8)
    axes.set_ylabel("CPU time [s]", fontsize=8)


def _decades(axis: Any, scale: Any, limits: Any, values: list[float]) -> None:
    """A logarithmic axis of a decade at least, with whole decades as its labels, or 1, 2, 5 if it has few."""
    from matplotlib.ticker import LogLocator, NullFormatter

    scale("log")
    low, high = min(values, default=1.0), max(values, default=1.0)
    middle, half = math.sqrt(low * high), max(math.sqrt(high / low) * 1.5, math.sqrt(10.0) * 1.1)
    limits(middle / half, middle * half)
    axis.set_major_locator(LogLocator(10.0, (1.0,) if half > 10.0 else (1.0, 2.0, 5.0), numticks=8))
    axis.set_major_formatter(lambda value, _: f"{value:.0e}".replace("e-0", "e-") if value < 0.01 else f"{value:g}")
    axis.set_minor_formatter(NullFormatter())
