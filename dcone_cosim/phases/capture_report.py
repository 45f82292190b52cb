"""What a capture found: its lines of the summary, and its figures."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from dcone_cosim import build
from dcone_cosim.events import Event
from dcone_cosim.findings import Finding
from dcone_cosim.phases import closed_report, force_map
from dcone_cosim.phases.end import of_end
from dcone_cosim.phases.phase import Figure
from dcone_cosim.plots import net_view, style
from dcone_cosim.results import PhaseResult, RunResult
from dcone_cosim.scene.data import PhaseScene

_CAPTURE_ROWS = (
    ("contact.first_time", "first touch of the target", "s"),
    ("mouth.t80", "mouth over 80 % of the net's area from", "s"),
    ("mouth.t_max", "mouth widest at", "s"),
    ("mouth.area_max", "largest mouth area", "m2"),
    ("thread.tension_max", "largest tension of a thread", "N"),
    ("cord.tension_max", "largest tension of the closing cord", "N"),
    ("closing.t_start", "reels started at", "s"),
    ("mouth.cord_length", "closing cord still out at the end", "m"),
    ("mouth.girth", "girth of the target that the cord has to pass", "m"),
    ("contact.loss", "energy lost in contact", "J"),
    ("contact.friction_loss", "energy lost in contact, by friction", "J"),
    ("contact.depth", "deepest that a node was pressed below the surface", "m"),
    ("closing.work", "work of the reels", "J"),
    ("thread.dissipated", "energy taken by the threads' dashpots", "J"),
    ("cord.dissipated", "energy taken by the cord's dashpots", "J"),
    ("closing.spring_energy", "energy left in the reels' springs", "J"),
    ("closing.braked", "energy taken by the reels' brakes, and by slack taken in", "J"),
    ("air.dissipated", "energy taken by the air", "J"),
    ("wall.friction_loss", "energy taken by friction in the canister", "J"),
    ("table.friction_loss", "energy taken by friction on the table", "J"),
    ("hinge.loss", "energy taken by the appendage's dashpot and stops", "J"),
    ("wall.emptied", "the last of the net out of its canister at", "s"),
    ("bending.dissipated", "energy taken by the damping of bending", "J"),
    ("self_contact.loss", "energy taken by contact of threads with each other", "J"),
    ("self_contact.touched", "times that two threads came to touch", ""),
    ("self_contact.passed", "times that two threads went through each other", ""),
    ("self_contact.at_start", "pairs of threads that overlapped in the canister, and were left alone", ""),
    ("gravity.work", "energy given by the change of gravity", "J"),
    ("energy.remainder", "energy that the book does not account for", "J"),
    ("tether.paid_out", "tether paid out", "m"),
    ("net.nodes", "nodes of the net", ""),
    ("net.threads", "threads of the net", ""),
)


def findings(run: RunResult, result: PhaseResult) -> Iterator[Finding]:
    last = result.recorder.last() if len(result.recorder) else {}
    yield Finding(result.name, "outcome", "outcome", result.outcome.replace("_", " "))
    yield from of_end("capture", result)
    if result.located is not None:
        yield Finding(result.name, "handed_over_at", "hand-over condition met at", result.located, "s")
        yield Finding(result.name, "located_by", "hand-over condition located by", result.located_by)
    for name, label, unit in _CAPTURE_ROWS:
        if name in last and not (unit == "s" and last[name] < 0.0):  # an instant that has not come is told as -1
            whole = not unit and math.isfinite(last[name])
            value = int(last[name]) if whole else last[name]
            yield Finding(result.name, name, label, value, unit)
    parameters = run.parameters.get(result.name, {})
    if result.outcome == "not_closed" and "closing.timeout" in parameters:
        label = "counts as not closed after, from the start of the reels (closing.timeout)"
        yield Finding(result.name, "closing.timeout", label, parameters["closing.timeout"], "s")
    yield from _at_the_touch(last, result)
    yield from _of_hinge(result)
    yield from _of_hardest(last, result)
    yield from _of_catch(last, result)
    yield from _of_approach(result)
    yield from closed_report.findings(result.name, last, run.left.get(result.name, ()))
    if "chaser.velocity[1]" in last and "chaser.mass" in parameters:
        recoil = result.recorder.vector("chaser.velocity")[0] - _vector(parameters, "chaser.start_velocity")
        size = float(np.linalg.norm(recoil))
        late = any(value > 0.0 for name, value in parameters.items() if name.startswith("ejection.delay["))
        label = "momentum of the bullets that left at once" if late else "momentum of the shot"
        momentum = size * parameters["chaser.mass"]
        least = ROUNDING * parameters.get("bullets.mass", 0.0) * parameters.get("bullets.speed", 0.0)
        yield Finding(result.name, "recoil", label, momentum if momentum > least else 0.0, "N s")


ROUNDING = 1e-12
"""Share of a bullet's momentum that is no recoil: what the cosine of 90 deg leaves [1]."""
_OPEN_ROWS = (
    ("mouth.area", "mouth.area_at_touch", "mouth area at the first touch of the target", "m2"),
    ("net.volume", "net.volume_at_touch", "volume between net and mouth at the first touch of the target", "m3"),
)


def _at_the_touch(last: Mapping[str, float], result: PhaseResult) -> Iterator[Finding]:
    """How far the net was open as it met the target, on a straight line between the rows before and after.

    Checked  tests/cosim/test_at_the_touch.py
    """
    touch, recorder = last.get("contact.first_time", -1.0), result.recorder
    for name, key, label, unit in _OPEN_ROWS:
        if touch >= 0.0 and name in recorder and len(recorder) > 1:
            value = float(np.interp(touch, recorder["time"], recorder[name]))
            yield Finding(result.name, key, label, value, unit)


def _of_hinge(result: PhaseResult) -> Iterator[Finding]:
    """How far a hinged appendage swung to both sides, and where it is at the end.

    Checked  tests/cosim/test_hinged_panel.py
    """
    recorder = result.recorder
    if len(recorder) and "hinge.angle" in recorder:
        angle = recorder["hinge.angle"]
        for key, label, value in (
            ("hinge.angle_max", "largest angle of the appendage, from how it is drawn (of rows)", angle.max()),
            ("hinge.angle_min", "least angle of the appendage (of rows)", angle.min()),
            ("hinge.angle", "angle of the appendage at the end", angle[-1]),
        ):
            yield Finding(result.name, key, label, float(value), "rad", shown_in="deg")


def _of_hardest(last: Mapping[str, float], result: PhaseResult) -> Iterator[Finding]:
    """Where and when the largest tension of a thread was, of an FMU that tells it."""
    nodes = [last.get(f"thread.tension_max_node[{end}]", 0.0) for end in (1, 2)]
    if all(nodes):
        text = f"{nodes[0]:.0f} and {nodes[1]:.0f}"
        yield Finding(result.name, "thread.tension_max_node", "largest tension of a thread, between the nodes", text)
        yield Finding(
            result.name,
            "thread.tension_max_time",
            "largest tension of a thread, at",
            last["thread.tension_max_time"],
            "s",
        )


_CATCH_ROWS = (
    ("t_capture", "captured at", "s"),
    ("enclosure.at_capture", "share of the target inside the net when captured", ""),
    ("mouth.margin_at_capture", "girth of the target less closing cord out, when captured", "m"),
    ("enclosure.least", "least share of the target inside the net from then on", ""),
)


def _of_catch(last: Mapping[str, float], result: PhaseResult) -> Iterator[Finding]:
    """When the target counted as caught, how that looked, and whether it lasted as long as the phase went on."""
    if not last.get("t_capture", -1.0) >= 0.0:
        return
    for name, label, unit in _CATCH_ROWS:
        if name in last:
            shown_in = "%" if name.startswith("enclosure.") else ""
            yield Finding(result.name, name, label, last[name], unit, shown_in=shown_in)
    if "t_lost" not in last:
        return
    seen = result.end - result.start - last["t_capture"]
    yield Finding(result.name, "followed", "followed after the capture for", max(0.0, seen), "s")
    if last["t_lost"] >= 0.0:
        after = last["t_lost"] - last["t_capture"]
        yield Finding(result.name, "lost_after", "target out of the net again, after the capture", after, "s")
        text = f"no: the target was out again {after:.3g} s later"
    elif seen > 1e-6:
        text = f"yes, for the {seen:.3g} s to the end of the phase"
    else:
        text = "not followed: the phase ends at the capture"
    yield Finding(result.name, "lasted", "did the catch last", text)


def _of_approach(result: PhaseResult) -> Iterator[Finding]:
    """How near the target came to the chaser, from centre to centre, at the instants of the table."""
    recorder = result.recorder
    if len(recorder) and {"chaser.position[1]", "target.position[1]"} <= set(recorder.names):
        apart = np.linalg.norm(recorder.vector("target.position") - recorder.vector("chaser.position"), axis=1)
        yield Finding(result.name, "approach", "least distance chaser to target", float(apart.min()), "m")


def _vector(values: dict[str, float], name: str) -> Any:
    return np.array([values.get(f"{name}[{i}]", 0.0) for i in (1, 2, 3)])


def figures(run: RunResult, phase: PhaseScene, result: PhaseResult) -> Iterator[Figure]:
    """The capture in space, where node positions were kept, and the mouth with the energies."""
    title = run.scene.title
    if len(result.recorder) < 2:
        return
    if result.snapshots.times:
        values = {**run.parameters.get(phase.name, {}), **phase.main.made}
        shapes = build.net_drawing(values, phase.main.terms), build.target_surface(values, phase.main.terms)
        asked = bool(phase.options.snapshots)
        swing = build.target_swing(values, phase.main.terms)
        yield "capture_in_space.png", partial(net_view.draw, result, *shapes, asked, title, swing=swing)
    cells = force_map.of_run(run, phase.name)
    if cells is not None:
        yield "force_map.png", partial(force_map.draw, cells, title)
    if "mouth.area" in result.recorder:
        yield "mouth_and_energies.png", partial(mouth_and_energy, result, title)
    yield from closed_report.figures(result, title)


EVENTS = (
    ("contact.first_time", "first touch", "--"),
    ("closing.t_start", "reels start", "-."),
    ("t_capture", "captured", "-"),
)


def own_events(result: PhaseResult) -> Iterator[Event]:
    """What the FMU tells the instant of, and the hand-over."""
    last = result.recorder.last() if len(result.recorder) else {}
    told = (*((name, label) for name, label, _ in EVENTS), ("mouth.t_max", "mouth widest"), ("t_lost", "target lost"))
    for name, label in told:
        if last.get(name, -1.0) >= 0.0:
            yield Event(result.name, label, last[name])
    if result.located is not None:
        yield Event(result.name, "hand-over condition met", result.located)


def mouth_and_energy(result: PhaseResult, title: str, path: Path) -> None:
    """Mouth area above, energies below, with what happened when."""
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
        ("closing.work", "work of the reels", "#7d3c98", {}),
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
