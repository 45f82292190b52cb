"""Figures of a tow: the orbit of both bodies, and the tension of the line with its tugs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from dcone_cosim.plots import style
from dcone_cosim.results import PhaseResult


def orbit(result: PhaseResult, since: str, title: str, path: Path) -> None:
    """Orbital radius of both bodies, and of the chaser less the target: on the scale of the orbit they coincide."""
    recorder = result.recorder
    divisor, unit = style.time_axis(result.end)
    time = recorder["time"] / divisor
    figure = style.new_figure(8.5, 6.0)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    style.margins(figure, 0.2)
    above.plot(time, recorder["target.radius"] / 1e3, color=style.TARGET, label="target", linewidth=2.2, alpha=0.7)
    above.plot(time, recorder["chaser.radius"] / 1e3, color=style.CHASER, label="chaser", linewidth=0.9)
    if "center.semi_major_axis" in recorder:
        axis = recorder["center.semi_major_axis"] / 1e3
        above.plot(time, axis, "--", color=style.MUTED, linewidth=1.0, label="semi-major axis of the pair")
    above.set_ylabel("orbital radius [km]")
    above.ticklabel_format(useOffset=False)
    style.legend(above)
    below.plot(time, recorder["chaser.radius"] - recorder["target.radius"], color=style.ACCENT, linewidth=1.0)
    below.set_ylabel("chaser over target [m]")
    below.set_xlabel(f"{since} [{unit}]")
    style.head(figure, title)
    style.save(figure, path)


LEAST = 1e-6
"""Smallest tension that the logarithmic axis shows [N]."""


def tension(result: PhaseResult, comparison: PhaseResult | None, since: str, title: str, path: Path) -> None:
    """Tension over the whole phase, logarithmic, with its tugs as stems; below, linear, the time of the tugs apart."""
    recorder = result.recorder
    divisor, unit = style.time_axis(result.end)
    time = recorder["time"]
    sets = _tug_sets(result, comparison)
    figure = style.new_figure(8.5, 6.4)
    if sets:
        above, below = figure.subplots(2, 1, height_ratios=(3, 2))
    else:
        above, below = figure.subplots(), None
    style.margins(figure, 0.6)
    pull = recorder["tether.tension"]
    visible = np.where(pull > LEAST, pull, np.nan)
    above.plot(time / divisor, visible, color=style.CHASER, linewidth=0.9, label="tension at the communication steps")
    _stems(above, sets, divisor)
    values = np.concatenate([pull, *(rows[:, 1] for _, rows, _, _ in sets)])
    values = values[values > LEAST]
    style.logarithmic(above)
    if len(values):
        above.set_ylim(max(LEAST, 0.3 * values.min()), 3.0 * values.max())
    above.set_xlim(0.0, time[-1] / divisor)
    above.set_ylabel("tether tension [N]")
    above.set_xlabel(f"{since} [{unit}]")
    style.legend(above)
    if below is not None:
        last = max(float(rows[:, 0].max()) for _, rows, _, _ in sets)
        zoom, zoom_unit = style.time_axis(1.05 * last)
        below.plot(time / zoom, pull, color=style.CHASER, linewidth=0.9)
        _stems(below, sets, zoom)
        below.set_xlim(0.0, 1.05 * last / zoom)
        below.set_ylim(bottom=0)
        below.set_ylabel("tether tension [N]")
        below.set_xlabel(f"the tugs apart: {since} [{zoom_unit}]")
    style.head(figure, title)
    style.save(figure, path)


def _stems(axes: Any, sets: list[tuple[str, style.Array, str, bool]], divisor: float) -> None:
    """Tugs as stems from the least tension to their peak."""
    for label, rows, colour, strong in sets:
        at, peak = rows[:, 0] / divisor, rows[:, 1]
        axes.vlines(at, LEAST, peak, color=colour, linewidth=0.7, alpha=0.7)
        axes.plot(at, peak, "o", color=colour, markersize=3.5 if strong else 2.5, label=label)


def _tug_sets(result: PhaseResult, comparison: PhaseResult | None) -> list[tuple[str, style.Array, str, bool]]:
    """Label, rows of time since the phase began [s] and peak [N], colour, and whether they are the run's own.

    A line taut from the start has not been tugged by that.
    """
    sets = []
    for phase, label, colour, strong in (
        (comparison, "tugs, had the shot no recoil", style.MUTED, False),
        (result, "tugs", style.BULLET, True),
    ):
        if phase is not None and phase.tugs is not None and phase.tugs.rows:
            taut = phase.is_taut_from_start
            rows = [row[:2] for number, row in phase.tugs.rows.items() if not (taut and number == 1)]
            if rows:
                sets.append((label, np.array(rows), colour, strong))
    return sets
