"""Colours and helpers shared by the figures."""

from __future__ import annotations

import math
import textwrap
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

CHASER = "#1f4e79"
TARGET = "#8a6d3b"
NET = "#4a6fa5"
BULLET = "#c0392b"
ACCENT = "#2e8b57"
MUTED = "#888888"
DPI = 130
MOST_LINES = 3
"""Lines of a title; what is longer is cut."""

SETTINGS: Any = {
    "font.size": 9,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 10,
    "legend.frameon": False,
    "figure.facecolor": "white",
}


def load() -> None:
    """Import what drawing needs, half a second; may run in a thread while an FMU computes."""
    import matplotlib.backends.backend_agg
    import matplotlib.figure  # noqa: F401
    import mpl_toolkits.mplot3d.art3d  # noqa: F401


def new_figure(width: float, height: float) -> Any:
    """A figure on the Agg canvas [inch], without pyplot and its global state.

    Its margins are set by hand (`margins`): a layout that is worked out draws everything three times.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height))
    FigureCanvasAgg(figure)
    return figure


LEGEND_ROW = 0.25
"""Height of a row of a legend over its axes [inch]."""


def margins(figure: Any, between: float) -> None:
    """Room for the labels of two axes, one above the other, and for one row of a legend over the upper ones, with
    `between` for what stands between them [inch]."""
    width, height = figure.get_size_inches()
    top = 0.45 + LEGEND_ROW
    figure.subplots_adjust(left=0.85 / width, right=1.0 - 0.15 / width, bottom=0.55 / height, top=1.0 - top / height)
    figure.subplots_adjust(hspace=between / (0.5 * (height - between - top - 0.55)))
    figure.align_ylabels()


def legend(axes: Any, columns: int = 3) -> None:
    """A legend over the axes, where it covers no curve, whatever the curves do."""
    if axes.get_legend_handles_labels()[1]:
        axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns, fontsize=8, borderaxespad=0.1)


def wrapped(title: str, width: float) -> tuple[list[str], float]:
    """The lines of a title over a figure so wide [inch], and the size of its letters."""
    size, lines = 11.0, [title]
    for size in (11.0, 9.0, 7.5):
        letters = int(width * 72.0 / (0.56 * size))
        lines = [line for part in title.splitlines() for line in textwrap.wrap(part, letters)] or [""]
        if len(lines) <= 2:
            break
    if len(lines) > MOST_LINES:
        lines = [*lines[: MOST_LINES - 1], lines[MOST_LINES - 1] + " ..."]
    return lines, size


def head(figure: Any, title: str) -> None:
    """Put the title over the figure as it is written (no mathematics in it), wrapped and made smaller when long."""
    lines, size = wrapped(title, figure.get_figwidth())
    figure.suptitle("\n".join(lines), fontsize=size, parse_math=False, y=1.0 - 0.1 / figure.get_figheight(), va="top")


SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def logarithmic(axes: Any) -> None:
    """Make the y axis logarithmic, with powers of ten as plain text: to set mathematics takes a quarter of a second."""
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter(
        lambda value, _: "10" + f"{math.log10(value):.0f}".translate(SUPERSCRIPTS) if value > 0.0 else ""
    )
    axes.yaxis.set_minor_formatter("")


def plain_ticks(low: float, high: float) -> list[float]:
    """1, 2 and 5 of each decade between two limits: ticks of a logarithmic axis of a decade or two."""
    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    ticks = [round(step * 10.0**decade, 12) for decade in decades for step in (1.0, 2.0, 5.0)]
    return [tick for tick in ticks if low <= tick <= high]


def save(figure: Any, path: Path) -> None:
    figure.savefig(path, dpi=DPI, pil_kwargs={"compress_level": 1})


def time_axis(duration: float) -> tuple[float, str]:
    """Divisor and unit that suit a duration [s]: seconds, minutes, hours or days."""
    for limit, divisor, unit in ((300.0, 1.0, "s"), (7200.0, 60.0, "min"), (3.0 * 86400.0, 3600.0, "h")):
        if duration <= limit:
            return divisor, unit
    return 86400.0, "day"
