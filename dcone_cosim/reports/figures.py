"""The figures of a run: capture in space, mouth and energies, orbit, tension. matplotlib is imported only here."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from dcone_cosim import build
from dcone_cosim.master import RunResult
from dcone_cosim.phases import PhaseResult
from dcone_cosim.reports import net_view, side_by_side, style

Figure = tuple[str, Callable[[Path], object]]
"""File name, and what draws it there."""


def draw_all(run: RunResult, folder: Path) -> list[str]:
    """Draw what the run has data for, a PNG each; returns which could not be drawn, and why."""
    style.load()
    figures = list(_figures(run))
    # The capture in space takes as long as the others together.
    return [*_without_data(run), *side_by_side.halves(partial(_draw, folder), figures[:1], figures[1:])]


def _without_data(run: RunResult) -> Iterator[str]:
    """Why there is no picture of the net in space, where a capture was run."""
    capture = run.phases.get("capture")
    if capture is None or capture.snapshots.times:
        return
    why = "the capture's FMU has no outputs for the nodes of a net"
    if next(phase for phase in run.scene.phases if phase.name == "capture").main.fmu is None:
        why = "the scene has no table [capture.nodes], which brings their positions into the FMU"
    yield f"no picture of the net in space: {why}"


def _draw(folder: Path, figures: Iterable[Figure]) -> list[str]:
    import matplotlib as mpl

    failed = []
    with mpl.rc_context(style.SETTINGS):
        for name, draw in figures:
            path = folder / name
            try:
                draw(path)
            except Exception as error:
                path.unlink(missing_ok=True)
                failed.append(f"{name} could not be drawn: {type(error).__name__}: {error}")
    return failed


def _figures(run: RunResult) -> Iterator[Figure]:
    """File name of each figure there is data for, and what draws it."""
    title = run.scene.title
    capture, removal = run.phases.get("capture"), run.phases.get("removal")
    if capture is not None and len(capture.recorder) > 1:
        if capture.snapshots.times:
            asked = any(p.options.get("snapshots") for p in run.scene.phases)
            values = run.parameters.get("capture", {})
            terms = next(phase for phase in run.scene.phases if phase.name == "capture").main.terms
            shapes = build.net_drawing(values, terms), build.target_surface(values, terms)
            yield "capture_in_space.png", partial(net_view.draw, capture, *shapes, asked, title)
        if "mouth.area" in capture.recorder:
            yield "mouth_and_energies.png", partial(_mouth_and_energy, capture, title)
    if removal is not None and len(removal.recorder) > 1:
        if {"chaser.radius", "target.radius"} <= set(removal.recorder.names):
            yield "orbital_radius.png", partial(_orbit, run, removal, title)
        if "tether.tension" in removal.recorder:
            yield "tether_tension.png", partial(_tension, run, removal, title)


EVENTS = (
    ("contact.first_time", "first touch", "--"),
    ("closing.t_start", "winches start", "-."),
    ("t_capture", "captured", "-"),
)


def _mouth_and_energy(result: PhaseResult, title: str, path: Path) -> None:
    recorder = result.recorder
    time, last = recorder["time"], recorder.last()
    figure = style.new_figure(8.5, 6.5)
    above, below = figure.subplots(2, 1, sharex=True)
    style.margins(figure, 0.2 + 2 * style.LEGEND_ROW)
    above.plot(time, recorder["mouth.area"], color=style.NET, label="mouth area")
    if "mouth.area_ratio" in recorder and recorder["mouth.area_ratio"].max() > 0:
        widest = int(np.argmax(recorder["mouth.area_ratio"]))
        flat = recorder["mouth.area"][widest] / recorder["mouth.area_ratio"][widest]
        above.axhline(0.8 * flat, color=style.MUTED, linewidth=0.8, linestyle=":", label="80 % of the flat net")
    above.set_ylabel("mouth area [m²]")
    above.set_ylim(bottom=0)
    series: tuple[tuple[str, str, str, dict[str, Any]], ...] = (
        ("energy.total", "kinetic and elastic", "#9db8d2", {"linewidth": 3.0}),
        ("energy.kinetic", "kinetic", style.CHASER, {"linestyle": (0, (5, 2)), "linewidth": 1.3}),
        ("energy.elastic", "elastic", style.ACCENT, {}),
        ("target.energy", "of the target", style.TARGET, {}),
        ("contact.loss", "lost in contact", style.BULLET, {}),
        ("closing.work", "work of the winches", "#7d3c98", {}),
    )
    for name, label, colour, extra in series:
        if name in recorder:
            below.plot(time, recorder[name], color=colour, label=label, **({"linewidth": 1.1} | extra))
    below.set_ylabel("energy [J]")
    below.set_xlabel("time since the shot [s]")
    for name, label, dash in EVENTS:
        if last.get(name, -1.0) >= 0.0:
            for axes in (above, below):
                axes.axvline(last[name], color="black", linewidth=0.8, linestyle=dash, alpha=0.7)
            above.annotate(
                label, (last[name], 0.5), xycoords=("data", "axes fraction"), rotation=90, fontsize=8,
                ha="center", va="center", bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5},
            )  # fmt: skip
    style.legend(above)
    style.legend(below)
    style.head(figure, title)
    style.save(figure, path)


def _since(run: RunResult) -> str:
    return "time since the hand-over" if run.handoff is not None else "time since the removal began"


def _orbit(run: RunResult, result: PhaseResult, title: str, path: Path) -> None:
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
    below.set_xlabel(f"{_since(run)} [{unit}]")
    style.head(figure, title)
    style.save(figure, path)


LEAST = 1e-6
"""Smallest tension that the logarithmic axis shows [N]."""


def _tension(run: RunResult, result: PhaseResult, title: str, path: Path) -> None:
    """Tension over the whole phase, logarithmic, with its tugs as stems; below, linear, the time of the tugs apart."""
    recorder = result.recorder
    divisor, unit = style.time_axis(result.end)
    since = recorder["time"]
    sets = _tug_sets(run, result)
    figure = style.new_figure(8.5, 6.4)
    if sets:
        above, below = figure.subplots(2, 1, height_ratios=(3, 2))
    else:
        above, below = figure.subplots(), None
    style.margins(figure, 0.6)
    tension = recorder["tether.tension"]
    visible = np.where(tension > LEAST, tension, np.nan)
    above.plot(since / divisor, visible, color=style.CHASER, linewidth=0.9, label="tension at the macro steps")
    _stems(above, sets, divisor)
    values = np.concatenate([tension, *(rows[:, 1] for _, rows, _, _ in sets)])
    values = values[values > LEAST]
    above.set_yscale("log")
    if len(values):
        above.set_ylim(max(LEAST, 0.3 * values.min()), 3.0 * values.max())
    above.set_xlim(0.0, since[-1] / divisor)
    above.set_ylabel("tether tension [N]")
    above.set_xlabel(f"{_since(run)} [{unit}]")
    style.legend(above)
    if below is not None:
        last = max(float(rows[:, 0].max()) for _, rows, _, _ in sets)
        zoom, zoom_unit = style.time_axis(1.05 * last)
        below.plot(since / zoom, tension, color=style.CHASER, linewidth=0.9)
        _stems(below, sets, zoom)
        below.set_xlim(0.0, 1.05 * last / zoom)
        below.set_ylim(bottom=0)
        below.set_ylabel("tether tension [N]")
        below.set_xlabel(f"the tugs apart: {_since(run)} [{zoom_unit}]")
    style.head(figure, title)
    style.save(figure, path)


def _stems(axes: Any, sets: list[tuple[str, style.Array, str, bool]], divisor: float) -> None:
    """Tugs as stems from the least tension to their peak."""
    for label, rows, colour, strong in sets:
        at, peak = rows[:, 0] / divisor, rows[:, 1]
        axes.vlines(at, LEAST, peak, color=colour, linewidth=0.7, alpha=0.7)
        axes.plot(at, peak, "o", color=colour, markersize=3.5 if strong else 2.5, label=label)


def _tug_sets(run: RunResult, result: PhaseResult) -> list[tuple[str, style.Array, str, bool]]:
    """Label, rows of time since the phase began [s] and peak [N], colour, and whether they are the run's own.

    A line taut from the start has not been tugged by that.
    """
    sets = []
    for phase, label, colour, strong in (
        (run.comparison, "tugs, had there been no recoil", style.MUTED, False),
        (result, "tugs", style.BULLET, True),
    ):
        if phase is not None and phase.tugs is not None and phase.tugs.rows:
            rows = np.array(list(phase.tugs.rows.values()))[:, :2]
            rows = rows[rows[:, 0] > 0.0]
            if len(rows):
                sets.append((label, rows, colour, strong))
    return sets
