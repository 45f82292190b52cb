"""Measured tracks over simulated ones, and how far they are apart."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from dcone_cosim.plots import style
from dcone_cosim.tracks.comparing import Compared

MOST_MARKERS = 8
"""That are drawn: those that err most."""
COLOURS = (style.CHASER, style.BULLET, style.ACCENT, style.TARGET, "#7d3c98", "#d68910", "#117a65", "#5d6d7e")


def draw(found: Sequence[Compared], title: str, path: Path) -> None:
    """Each coordinate over time, dots measured and lines simulated, and the distance of the two below."""
    chosen = sorted((one for one in found if one.known.any()), key=lambda one: -one.rms)[:MOST_MARKERS]
    figure = style.new_figure(8.5, 9.0)
    axes = figure.subplots(4, 1, sharex=True)
    figure.subplots_adjust(left=0.1, right=0.98, bottom=0.06, top=0.9, hspace=0.12)
    for one, colour in zip(chosen, COLOURS, strict=False):
        times, known = one.track.times, one.known
        for axis, panel in enumerate(axes[:3]):
            panel.plot(times, one.track.positions[:, axis], ".", color=colour, markersize=4, label=one.track.marker)
            panel.plot(times[known], one.simulated[known, axis], color=colour, linewidth=1.0)
        axes[3].plot(times[known], one.errors[known], color=colour, linewidth=1.0)
    for panel, name in zip(axes[:3], "xyz", strict=True):
        panel.set_ylabel(f"{name} [m]")
    axes[3].set_ylabel("error [m]")
    axes[3].set_xlabel("time since the shot [s]; dots measured, lines simulated")
    axes[3].set_ylim(bottom=0)
    style.legend(axes[0], MOST_MARKERS // 2)
    style.head(figure, title)
    style.save(figure, path)
