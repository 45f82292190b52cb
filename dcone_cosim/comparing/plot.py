"""Two runs in one picture: the tension of each tow with its tugs, and the mouth of each capture."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from dcone_cosim.phases import kind_of
from dcone_cosim.plots import style
from dcone_cosim.results import PhaseResult, RunResult

COLOURS = (style.CHASER, style.BULLET)
TENSION, MOUTH = "tether.tension", "mouth.area"
LEAST = 1e-6
"""Smallest tension that is shown [N]."""
FAR = 20.0
"""Ratio of tensions from which on their axis is logarithmic."""
Panel = tuple[str, str, Callable[[Any, Sequence[tuple[str, PhaseResult]]], None]]


def draw(named: Sequence[tuple[str, RunResult]], title: str, path: Path) -> str:
    """Draw; returns why there is no picture, "" where there is one."""
    import matplotlib as mpl

    panels = list(_panels([run for _, run in named]))
    if not panels:
        return "no picture: the runs have neither a tension nor a mouth area in common"
    style.load()
    with mpl.rc_context(style.SETTINGS):
        high = 2.9 * len(panels) + 0.9
        figure = style.new_figure(8.5, high)
        figure.subplots_adjust(left=0.1, right=0.98, bottom=0.55 / high, top=1.0 - 0.85 / high, hspace=0.55)
        for place, (phase, label, fill) in enumerate(panels, start=1):
            axes = figure.add_subplot(len(panels), 1, place)
            fill(axes, [(name, run.phases[phase]) for name, run in named])
            _, unit = style.time_axis(max(run.phases[phase].end for _, run in named))
            axes.set_ylabel(label)
            axes.set_xlabel(f"time of the {kind_of(phase).spoken or phase} [{unit}]")
            style.legend(axes, 2)
        style.head(figure, title)
        style.save(figure, path)
    return ""


def _panels(runs: Sequence[RunResult]) -> list[Panel]:
    found: list[Panel] = []
    for phase in runs[0].phases:
        if not all(phase in run.phases and len(run.phases[phase].recorder) > 1 for run in runs):
            continue
        recorders = [run.phases[phase].recorder for run in runs]
        if all(MOUTH in recorder for recorder in recorders):
            found.append((phase, "mouth area [m²]", _mouths))
        if all(TENSION in recorder for recorder in recorders):
            found.append((phase, "tether tension [N]", _tensions))
    return found


def _mouths(axes: Any, named: Sequence[tuple[str, PhaseResult]]) -> None:
    divisor, _ = style.time_axis(max(result.end for _, result in named))
    for (name, result), colour, dash in zip(named, COLOURS, ("-", "--"), strict=True):
        axes.plot(result.recorder["time"] / divisor, result.recorder[MOUTH], dash, color=colour, label=name)
    axes.set_ylim(bottom=0)


def _tensions(axes: Any, named: Sequence[tuple[str, PhaseResult]]) -> None:
    """Tension at the macro steps, and each tug as a stem to its peak; logarithmic where these are far apart."""
    last = max(result.end for _, result in named)
    divisor, _ = style.time_axis(last)
    shown: list[float] = []
    for (name, result), colour, dash in zip(named, COLOURS, ("-", "--"), strict=True):
        pull = result.recorder[TENSION]
        axes.plot(
            result.recorder["time"] / divisor, np.where(pull > LEAST, pull, np.nan), dash, color=colour, label=name
        )
        rows = [] if result.tugs is None else [row[:2] for row in result.tugs.rows.values()]
        times, peaks = np.array(rows).reshape(-1, 2).T
        axes.vlines(times / divisor, LEAST, peaks, color=colour, linewidth=0.7, alpha=0.5)
        fill = "none" if dash == "--" else "full"
        axes.plot(times / divisor, peaks, "o", color=colour, markersize=3.5, fillstyle=fill)
        shown += [value for value in (*pull.tolist(), *peaks.tolist()) if value > LEAST]
    axes.set_xlim(0.0, last / divisor)
    if shown and max(shown) > FAR * min(shown):
        axes.set_yscale("log")
        axes.set_ylim(0.5 * min(shown), 2.0 * max(shown))
    else:
        axes.set_ylim(bottom=0)
