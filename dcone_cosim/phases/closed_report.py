"""How well the net is closed: lines of the summary and figures of the capture quality index and the pull-off test."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping
from functools import partial
from pathlib import Path

from dcone_cosim import pulled
from dcone_cosim.findings import Finding
from dcone_cosim.phases.phase import Figure
from dcone_cosim.plots import style
from dcone_cosim.results import PhaseResult

PULL_OFF = ("waiting", "pulled", "held", "slipped_off")
"""Meaning of the Integer output `pull_off.stands`."""
_TOLD = (
    "the net was not pulled: it was never captured, or settled, for long enough",
    "not seen: the phase ends while the net is pulled",
    "the net holds",
    "the net slips off",
)
_QUALITY_ROWS = (
    ("quality.at_capture", "quality index (CQI) when captured, lower is better", ""),
    ("quality.index", "quality index at the end", ""),
    ("quality.length", "characteristic length of the target in it", "m"),
    ("quality.hull_volume", "volume of the net's hull", "m3"),
    ("quality.hull_surface", "surface of the net's hull", "m2"),
    ("quality.offset", "from the target's centre of mass to the net's", "m"),
)
_PULL_ROWS = (
    ("pull_off.t_start", "pulled from", "s"),
    ("pull_off.drawn_max", "its vertex gives way by, along the pull", "m"),
    ("pull_off.tension_max", "largest tension of a thread in it", "N"),
    ("pull_off.work", "work of the pull", "J"),
)


def findings(phase: str, last: Mapping[str, float], left: Container[str] = ()) -> Iterator[Finding]:
    """What the last row of a phase tells of either; of a pull that came after it, the hand-off tells.

    left          names of what it has left to the next
    """
    for name, label, unit in _QUALITY_ROWS:
        if name in last and last[name] >= 0.0:
            yield Finding(phase, name, label, last[name], unit)
    if "pull_off.stands" in last and pulled.LEFT[0] not in left:
        yield from _of_pull(phase, last)


def _of_pull(phase: str, last: Mapping[str, float]) -> Iterator[Finding]:
    stands = int(last["pull_off.stands"])
    yield Finding(phase, "pull_off", "pull-off test", _TOLD[stands])
    if PULL_OFF[stands] == "waiting":
        return
    for name, label, unit in _PULL_ROWS:
        yield Finding(phase, name, label, last[name], unit)
    slip = [last[f"pull_off.slip[{i}]"] for i in (1, 2, 3)]
    text = ", ".join(f"{way:+.3g}" for way in slip)
    yield Finding(phase, "pull_off.slip", "the net has moved about the target, its axes", f"{text} m")
    threads = [
        (int(last[f"pull_off.hardest[{i}].thread"]), last[f"pull_off.hardest[{i}].tension"]) for i in range(1, 6)
    ]
    told = ", ".join(f"{tension:.3g} N (thread {number})" for number, tension in threads if number > 0)
    if told:
        yield Finding(phase, "pull_off.threads", "most borne under the whole load", told)


def figures(result: PhaseResult, title: str) -> Iterator[Figure]:
    """Of either, as far as it is there."""
    if "quality.index" in result.recorder:
        yield "capture_quality.png", partial(_quality, result, title)
    if "pull_off.stands" in result.recorder and result.recorder.last()["pull_off.t_start"] >= 0.0:
        yield "pull_off.png", partial(_pull, result, title)


def _quality(result: PhaseResult, title: str, path: Path) -> None:
    """The index above; volume and surface of the hull, and how far off the net is, below."""
    recorder = result.recorder
    time, last = recorder["time"], recorder.last()
    figure = style.new_figure(8.5, 6.5)
    above, below = figure.subplots(2, 1, sharex=True)
    style.margins(figure, 0.2 + style.LEGEND_ROW)
    above.plot(time, recorder["quality.index"], color=style.NET, label="capture quality index (CQI)")
    if last.get("t_capture", -1.0) >= 0.0:
        for axes in (above, below):
            axes.axvline(last["t_capture"], color="black", linewidth=0.8, alpha=0.7)
        above.annotate(
            "captured", (last["t_capture"], 0.7), xycoords=("data", "axes fraction"), rotation=90, fontsize=8,
            ha="center", va="center", bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5},
        )  # fmt: skip
    above.set_ylabel("index [1]")
    above.set_ylim(bottom=0)
    below.plot(time, recorder["quality.offset"], color=style.ACCENT, label="offset of the centres of mass [m]")
    below.plot(time, recorder["quality.hull_volume"], color=style.NET, label="volume of the net's hull [m³]")
    below.set_yscale("log")
    below.set_xlabel("time since the shot [s]")
    style.legend(above)
    style.legend(below)
    style.head(figure, title)
    style.save(figure, path)


def _pull(result: PhaseResult, title: str, path: Path) -> None:
    """Load and largest thread tension above; how far vertex and net give way about the target, in its axes, below."""
    recorder = result.recorder
    begin = recorder.last()["pull_off.t_start"]
    kept = recorder["time"] >= begin - 1.0
    time = recorder["time"][kept]
    figure = style.new_figure(8.5, 6.5)
    above, below = figure.subplots(2, 1, sharex=True)
    style.margins(figure, 0.2 + style.LEGEND_ROW)
    if "thread.tension_peak" in recorder:
        peak = recorder["thread.tension_peak"][kept]
        above.plot(time, peak, color=style.ACCENT, linewidth=0.9, label="largest tension of a thread")
    above.plot(time, recorder["pull_off.load"][kept], color=style.NET, linewidth=2.0, label="pull at the vertex")
    above.set_ylabel("force [N]")
    below.plot(time, recorder["pull_off.drawn"][kept], color=style.NET, label="vertex, along the pull")
    for i, axis in enumerate("123", 1):
        label = f"middle of the net, axis {axis}"
        below.plot(time, recorder[f"pull_off.slip[{i}]"][kept], linewidth=0.9, label=label)
    below.set_ylabel("way about the target [m]")
    below.set_xlabel("time since the shot [s]")
    style.legend(above)
    style.legend(below)
    style.head(figure, title)
    style.save(figure, path)
