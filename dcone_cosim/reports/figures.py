"""The figures of a run: capture in space, mouth and energies, orbit, tension. matplotlib is imported only here."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from dcone_cosim.master import RunResult
from dcone_cosim.phases import PhaseResult
from dcone_cosim.reports import net_view, style


def draw_all(run: RunResult, folder: Path) -> list[Path]:
    """Draw what the run has data for; returns the PNG files."""
    import matplotlib as mpl

    drawn = []
    title = run.scene.title
    with mpl.rc_context(style.SETTINGS):
        capture, removal = run.phases.get("capture"), run.phases.get("removal")
        if capture is not None and len(capture.recorder) > 1:
            if capture.snapshots.times:
                asked = any(p.options.get("snapshots") for p in run.scene.phases)
                path = folder / "capture_in_space.png"
                net_view.draw(capture, run.parameters.get("capture", {}), asked, title, path)
                drawn.append(path)
            if "mouth.area" in capture.recorder:
                drawn.append(_mouth_and_energy(capture, title, folder / "mouth_and_energies.png"))
        if removal is not None and len(removal.recorder) > 1:
            if {"chaser.radius", "target.radius"} <= set(removal.recorder.names):
                drawn.append(_orbit(removal, title, folder / "orbital_radius.png"))
            if "tether.tension" in removal.recorder:
                drawn.append(_tension(run, removal, title, folder / "tether_tension.png"))
    return drawn


EVENTS = (
    ("contact.first_time", "first touch", "--"),
    ("closing.t_start", "winches start", "-."),
    ("t_capture", "captured", "-"),
)


def _mouth_and_energy(result: PhaseResult, title: str, path: Path) -> Path:
    recorder = result.recorder
    time, last = recorder["time"], recorder.last()
    figure = style.new_figure(8.5, 6.5)
    above, below = figure.subplots(2, 1, sharex=True)
    above.plot(time, recorder["mouth.area"], color=style.NET, label="mouth area")
    if "mouth.area_ratio" in recorder and recorder["mouth.area_ratio"].max() > 0:
        widest = int(np.argmax(recorder["mouth.area_ratio"]))
        flat = recorder["mouth.area"][widest] / recorder["mouth.area_ratio"][widest]
        above.axhline(0.8 * flat, color=style.MUTED, linewidth=0.8, linestyle=":", label="80 % of the flat net")
    above.set_ylabel("mouth area [m²]")
    above.set_ylim(bottom=0)
    series = (
        ("energy.total", "kinetic and elastic", style.CHASER),
        ("energy.kinetic", "kinetic", style.NET),
        ("energy.elastic", "elastic", style.ACCENT),
        ("target.energy", "of the target", style.TARGET),
        ("contact.loss", "lost in contact", style.BULLET),
        ("closing.work", "work of the winches", "#7d3c98"),
    )
    for name, label, colour in series:
        if name in recorder:
            dash = "--" if name == "energy.kinetic" else "-"
            below.plot(time, recorder[name], dash, color=colour, linewidth=1.2, label=label)
    below.set_ylabel("energy [J]")
    below.set_xlabel("time since the shot [s]")
    for name, label, dash in EVENTS:
        if last.get(name, -1.0) >= 0.0:
            for axes in (above, below):
                axes.axvline(last[name], color="black", linewidth=0.8, linestyle=dash, alpha=0.7)
            above.annotate(
                label, (last[name], 1.0), xycoords=("data", "axes fraction"), rotation=90, fontsize=7,
                xytext=(-2, -4), textcoords="offset points", ha="right", va="top",
            )  # fmt: skip
    above.legend(loc="upper left")
    below.legend(loc="upper left", ncols=2)
    figure.suptitle(title)
    style.save(figure, path)
    return path


def _orbit(result: PhaseResult, title: str, path: Path) -> Path:
    """Orbital radius of both bodies, and of the chaser less the target: on the scale of the orbit they coincide."""
    recorder = result.recorder
    divisor, unit = style.time_axis(result.end - result.start)
    time = (recorder["time"] - result.start) / divisor
    figure = style.new_figure(8.5, 6.0)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    above.plot(time, recorder["target.radius"] / 1e3, color=style.TARGET, label="target", linewidth=2.2, alpha=0.7)
    above.plot(time, recorder["chaser.radius"] / 1e3, color=style.CHASER, label="chaser", linewidth=0.9)
    if "center.semi_major_axis" in recorder:
        axis = recorder["center.semi_major_axis"] / 1e3
        above.plot(time, axis, "--", color=style.MUTED, linewidth=1.0, label="semi-major axis of the pair")
    above.set_ylabel("orbital radius [km]")
    above.ticklabel_format(useOffset=False)
    above.legend()
    below.plot(time, recorder["chaser.radius"] - recorder["target.radius"], color=style.ACCENT, linewidth=1.0)
    below.set_ylabel("chaser over target [m]")
    below.set_xlabel(f"time since the removal began [{unit}]")
    figure.suptitle(title)
    style.save(figure, path)
    return path


LEAST = 1e-6
"""Smallest tension that the logarithmic axis shows [N]."""


def _tension(run: RunResult, result: PhaseResult, title: str, path: Path) -> Path:
    """Tension at the communication points, the tugs between them as stems, and the first hours apart."""
    recorder = result.recorder
    divisor, unit = style.time_axis(result.end - result.start)
    time = (recorder["time"] - result.start) / divisor
    figure = style.new_figure(8.5, 6.0)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    tension = recorder["tether.tension"]
    visible = np.where(tension > LEAST, tension, np.nan)
    above.plot(time, visible, color=style.CHASER, linewidth=0.9, label="tension at the macro steps")
    shown = [tension[tension > LEAST]]
    for tugs, start, colour, label in _tug_sets(run, result):
        at = np.array([(t - start) / divisor for t, _, _ in tugs])
        peak = np.array([p for _, p, _ in tugs])
        above.vlines(at, LEAST, peak, color=colour, linewidth=0.5, alpha=0.5)
        above.plot(at, peak, "o", color=colour, markersize=3, label=label)
        below.plot(at, 1e3 * np.array([v for _, _, v in tugs]), "o", color=colour, markersize=3, label=label)
        shown.append(peak[peak > LEAST])
    values = np.concatenate(shown)
    above.set_yscale("log")
    if len(values):
        above.set_ylim(max(LEAST, 0.3 * values.min()), 3.0 * values.max())
    above.set_ylabel("tether tension [N]")
    if above.get_legend_handles_labels()[1]:
        above.legend(loc="upper right")
    below.set_ylabel("speed as it goes taut [mm/s]")
    below.set_ylim(bottom=0)
    below.set_xlabel(f"time since the removal began [{unit}]")
    figure.suptitle(title)
    style.save(figure, path)
    return path


def _tug_sets(run: RunResult, result: PhaseResult) -> list[tuple[list[tuple[float, float, float]], float, str, str]]:
    sets: list[tuple[list[tuple[float, float, float]], float, str, str]] = []
    if run.comparison is not None and run.comparison.tugs is not None and run.comparison.tugs.rows:
        other = run.comparison.tugs
        sets.append((list(other.rows.values()), run.comparison.start, style.MUTED, "tugs, had there been no recoil"))
    if result.tugs is not None and result.tugs.rows:
        sets.append((list(result.tugs.rows.values()), result.start, style.BULLET, "tugs"))
    return sets
