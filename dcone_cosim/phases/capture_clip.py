"""A capture as a page shows it: net, bullets, target and chaser over time; mouth, energies and tensions as charts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from dcone_cosim import build
from dcone_cosim.contract import bullets
from dcone_cosim.findings import spoken
from dcone_cosim.phases import chaos
from dcone_cosim.results import PhaseResult, RunResult
from dcone_cosim.scene.data import PhaseScene
from dcone_cosim.scenery import Array, Chart, Clip, Net, Series, Swing

AGAIN = "dcone run ... --replay"
"""What keeps the net for a replay."""
PER_SECOND = 25.0
"""Frames of the bodies alone."""
BETWEEN = 0.02
"""Share by which a tension has to exceed those of the frames to be told."""
NEAR_ZERO, SAME = 0.01, 0.01
"""Shares of the largest value of a chart below which a curve lies on 0, or on another."""
SEVERAL = 2
"""Frames that make a clip."""


def clip(run: RunResult, phase: PhaseScene, result: PhaseResult, marks: Sequence[tuple[float, str]]) -> Clip | None:
    """The capture as a clip; None where not even the bodies are known.

    Frames are those kept for a replay, else the snapshots of the net, else the bodies at communication points.
    """
    recorder = result.recorder
    if len(recorder) < SEVERAL or "chaser.position[1]" not in recorder:
        return None
    values, terms = {**run.parameters.get(phase.name, {}), **phase.main.made}, phase.main.terms
    net, rows, notes = _net(result, build.net_drawing(values, terms))
    notes += _between(net, result)
    surface = build.target_surface(values, terms) if "target.position[1]" in recorder else None
    hinge = build.target_hinge(values, terms) if "hinge.angle" in recorder else None
    numbers = bullets(recorder.names)
    shots = np.stack([recorder.vector(f"bullet[{b}].position") for b in numbers], axis=1) if numbers else None
    return Clip(
        phase.name,
        "Capture",
        "since the shot",
        recorder["time"][rows],
        recorder.vector("chaser.position")[rows],
        recorder.vector("target.position")[rows] if "target.position[1]" in recorder else None,
        recorder.vector("target.attitude", 4)[rows] if "target.attitude[1]" in recorder else None,
        None if surface is None else (np.array(surface[0], dtype=float), [list(face) for face in surface[1]]),
        recorder.vector("vertex.position")[rows] if "vertex.position[1]" in recorder else None,
        bullets=None if shots is None else shots[rows],
        net=net,
        swing=None if hinge is None or surface is None else Swing(recorder["hinge.angle"][rows], **hinge),
        marks=marks,
        notes=notes,
    )


def _net(result: PhaseResult, drawing: build.Drawing | None) -> tuple[Net | None, Array, list[str]]:
    """The net as far as it was kept, the rows of the table that its frames are of, and what to say of it."""
    time, frames, shots = result.recorder["time"], result.frames, result.snapshots
    if frames is not None and frames.times and len(frames.nodes[0]):
        nodes, times = np.array(frames.nodes), frames.times
        tensions = np.array(frames.tensions) if len(frames.ends) else None
        threads = frames.ends - 1 if len(frames.ends) else drawn_threads(drawing, nodes.shape[1])
        notes = [] if tensions is not None else ["the FMU tells no tensions of its threads: they have no colour"]
    elif len(shots.times) >= SEVERAL:
        nodes, times = np.array(shots.nodes), shots.times
        tensions, threads = None, drawn_threads(drawing, nodes.shape[1])
        notes = [f"{len(times)} snapshots of the net, without tensions: `{AGAIN}` keeps it in full, with them"]
    else:
        every = max(1, round(1.0 / PER_SECOND / max(float(time[1] - time[0]), 1e-12)))
        rows = np.unique([*range(0, len(time), every), len(time) - 1])
        return None, rows, [f"the net was not kept: `{AGAIN}` keeps it"]
    rows = np.array([int(np.argmin(np.abs(time - t))) for t in times])
    rim = drawing[1] if drawing is not None and max(drawing[1]) < nodes.shape[1] else ()
    return Net(nodes, threads, tensions, rim), rows, notes


def _between(net: Net | None, result: PhaseResult) -> Iterator[str]:
    """That a thread bore more between the frames than any frame shows."""
    largest = result.recorder["thread.tension_max"].max() if "thread.tension_max" in result.recorder else 0.0
    if net is None or net.tensions is None or not largest > (1.0 + BETWEEN) * float(net.tensions.max(initial=0.0)):
        return
    spread = chaos.CAPTURE["thread.tension_max"]
    shown = spoken(float(net.tensions.max()), spread)
    yield (
        f"the largest tension of a thread, {spoken(float(largest), spread)} N, lasts shorter than a frame: the colours "
        f"go up to {shown} N, the largest that a frame shows"
    )


def drawn_threads(drawing: build.Drawing | None, count: int) -> Array:
    """Threads from knot to knot where the net is one of ours, (threads, 2)."""
    pairs = [pair for line in drawing[0] for pair in pairwise(line)] if drawing is not None else []
    found = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    return found if not len(found) or found.max() < count else found[:0]


def charts(result: PhaseResult, marks: Sequence[tuple[float, str]]) -> Iterator[Chart]:
    """Mouth, tensions, energies and the angle of a hinge over time."""
    recorder = result.recorder
    if len(recorder) < SEVERAL:
        return
    for key, title, unit, rows in (
        ("mouth", "Mouth area", "m²", (("mouth.area", "mouth area"),)),
        (
            "tensions",
            "Largest tensions in the net",
            "N",
            (("thread.tension_peak", "threads"), ("cord.tension_peak", "closing cord")),
        ),
        (
            "energies",
            "Energies",
            "J",
            (
                ("energy.total", "kinetic and elastic"),
                ("energy.kinetic", "kinetic"),
                ("energy.elastic", "elastic"),
                ("target.energy", "of the target"),
                ("contact.loss", "lost in contact"),
                ("closing.work", "work of the reels"),
            ),
        ),
    ):
        series = list(
            _apart([Series(label, recorder["time"], recorder[name]) for name, label in rows if name in recorder])
        )
        if series:
            yield Chart(key, title, "time since the shot", unit, series, marks=marks)
    if "hinge.angle" in recorder:
        angle = Series("angle", recorder["time"], np.degrees(recorder["hinge.angle"]))
        yield Chart("hinge", "Angle of the hinged appendage", "time since the shot", "deg", [angle], marks=marks)


def _apart(series: Sequence[Series]) -> Iterator[Series]:
    """Curves that lie on 0 or on another in the chart have that in their names, so that none is looked for in vain."""
    most = max((float(np.max(np.abs(one.y), initial=0.0)) for one in series), default=0.0)
    for n, one in enumerate(series):
        if most and len(series) > 1 and float(np.max(np.abs(one.y))) < NEAR_ZERO * most:
            yield replace(one, name=f"{one.name} (near 0 here)")
            continue
        on = next((other for other in series[:n] if float(np.max(np.abs(one.y - other.y))) < SAME * most), None)
        yield one if on is None else replace(one, name=f"{one.name} (lies on: {on.name})")
