"""A tow as a page shows it: both bodies and the line over time; tension with its tugs, distance and orbit as charts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from dcone_cosim.findings import spoken
from dcone_cosim.plots.style import time_axis
from dcone_cosim.recorder import Recorder
from dcone_cosim.results import PhaseResult
from dcone_cosim.scenery import Array, Chart, Clip, Series

MOST_FRAMES = 3000
SEVERAL = 2
"""Frames that make a clip."""
FAR = 70.0
"""Distance of the bodies from which on the chaser is drawn larger than it is [m]."""
FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
"""Of a box whose corners are counted in binary."""
Surface = tuple[Array, list[list[int]]]


def orbital_axes(position: Array, velocity: Array) -> Array:
    """Axes radial, along-track and cross-track as rows, (n, 3, 3), of positions and velocities (n, 3).

    Checked  tests/report/test_clips.py
    """
    radial = position / np.linalg.norm(position, axis=1)[:, None]
    cross = np.cross(position, velocity)
    cross = cross / np.linalg.norm(cross, axis=1)[:, None]
    return np.stack([radial, np.cross(cross, radial), cross], axis=1)


def clip(
    name: str, result: PhaseResult, clock: str, values: Mapping[str, float], surface: Surface | None
) -> Clip | None:
    """The tow as a clip, seen from the target in the orbital frame; None where the bodies' places are not told.

    values     parameters of the phase, SI
    surface    of the target by a capture before; that of the tow's own box counts before it
    """
    recorder = result.recorder
    if len(recorder) < SEVERAL or "relative.position[1]" not in recorder:
        return None
    rows = np.unique(np.linspace(0, len(recorder) - 1, MOST_FRAMES).astype(int))
    chaser = -recorder.vector("relative.position")[rows]
    attitude = None
    if "target.attitude[1]" in recorder:
        attitude = _seen_from(_axes(recorder, rows), recorder.vector("target.attitude", 4)[rows])
    peak = next((one for one in ("tether.tension_peak", "tether.tension") if one in recorder), "")
    taut = recorder["tether.taut"][rows] > 0 if "tether.taut" in recorder else None
    notes = [
        "seen from the target, which stays in the middle; the tether is coloured by the largest tension of its step"
    ]
    if attitude is None:
        notes.append("the target is a point in this phase, drawn as a ball: its shape and its turning are not computed")
        reach = values.get("target.attachment_distance", 0.0)
        if reach:
            notes.append(
                f"the tether is made fast {spoken(reach)} m from the centre of mass; that piece, of net and target, "
                "is drawn in the colour of the target"
            )
    if "lumped.deflection" in recorder:
        aside = float(np.max(recorder["lumped.deflection"]))
        notes.append(f"the tether is drawn straight: its nodes are at most {spoken(aside)} m beside that line")
    if float(np.max(np.linalg.norm(chaser, axis=1))) > FAR:
        notes.append("the chaser is drawn larger than it is, so that it is seen")
    if len(rows) < len(recorder):
        notes.append(f"{len(rows):,} of {len(recorder):,} steps are shown")
    return Clip(
        name,
        name.replace("_", " ").capitalize(),
        clock,
        recorder["time"][rows],
        chaser,
        np.zeros((len(rows), 3)),
        attitude,
        (_box(values) or surface) if attitude is not None else None,
        _line_end(values, chaser, attitude),
        recorder[peak][rows] if peak else None,
        taut,
        held=attitude is None,
        marks=_marks(result),
        notes=notes,
    )


def _marks(result: PhaseResult) -> list[tuple[float, str]]:
    """The first tug and the largest."""
    rows = [] if result.tugs is None else sorted(result.tugs.rows.values())
    if not rows:
        return []
    largest = max(rows, key=lambda row: row[1])
    first = (rows[0][0], "first tug")
    return [first] if largest is rows[0] else [first, (largest[0], "largest tug")]


def _axes(recorder: Recorder, rows: Array) -> Array:
    """Of the orbital frame at some rows, (n, 3, 3); those of the field-free frame where there is no orbit."""
    if not {"altitude", "center.position[1]", "center.velocity[1]"} <= set(recorder.names):
        return np.broadcast_to(np.eye(3), (len(rows), 3, 3))
    return orbital_axes(recorder.vector("center.position")[rows], recorder.vector("center.velocity")[rows])


def _seen_from(axes: Array, attitude: Array) -> Array:
    """Quaternions from body to orbital axes (n, 4), scalar first, of such from body to inertial axes."""
    from scipy.spatial.transform import Rotation

    turned = Rotation.from_matrix(axes) * Rotation.from_quat(attitude, scalar_first=True)
    return np.asarray(turned.as_quat(scalar_first=True))


def _box(values: Mapping[str, float]) -> Surface | None:
    """Of a target that is a box about its centre; None for any other."""
    if any(f"target.size[{i}]" not in values for i in (1, 2, 3)):
        return None
    size, center = (np.array([values.get(f"target.{n}[{i}]", 0.0) for i in (1, 2, 3)]) for n in ("size", "center"))
    signs = np.array([[(corner >> bit) & 1 for bit in (2, 1, 0)] for corner in range(8)]) - 0.5
    return center + signs * size, FACES


def _line_end(values: Mapping[str, float], chaser: Array, attitude: Array | None) -> Array:
    """Where the line is made fast, from the target's centre (frames, 3) [m]."""
    if attitude is not None and "target.attachment[1]" in values:
        from scipy.spatial.transform import Rotation

        held = [values[f"target.attachment[{i}]"] for i in (1, 2, 3)]
        return np.asarray(Rotation.from_quat(attitude, scalar_first=True).apply(held))
    reach = values.get("target.attachment_distance", 0.0)
    distance = np.linalg.norm(chaser, axis=1)[:, None]
    shares: Array = np.minimum(reach / np.maximum(distance, 1e-12), 1.0)
    return np.asarray(chaser * shares)


def charts(result: PhaseResult, beside: PhaseResult | None, since: str) -> Iterator[Chart]:
    """Tension with the tugs, distance, and the orbit.

    beside    the same tow without the shot's recoil
    """
    recorder = result.recorder
    if len(recorder) < SEVERAL:
        return
    divisor, unit = time_axis(result.end)
    time = recorder["time"] / divisor
    if "tether.tension" in recorder:
        series = [
            Series("tension at the communication steps", time, recorder["tether.tension"]),
            *_tugs(result, divisor, "tugs"),
        ]
        if beside is not None:
            series += _tugs(beside, divisor, "tugs, had the shot no recoil", True)
        yield Chart("tension", "Tension of the tether, with its tugs", since, "N", series, unit, log=True)
    if "separation" in recorder:
        yield Chart(
            "distance", "Distance of the bodies", since, "m", [Series("distance", time, recorder["separation"])], unit
        )
    if "center.semi_major_axis" in recorder:
        axis = recorder["center.semi_major_axis"]
        change = Series("semi-major axis of the pair, change", time, axis - axis[0])
        yield Chart("orbit", "Change of the orbit", since, "m", [change], unit)


def _tugs(result: PhaseResult, divisor: float, name: str, faint: bool = False) -> Sequence[Series]:
    rows = [] if result.tugs is None else [result.tugs.rows[number] for number in sorted(result.tugs.rows)]
    if not rows:
        return []
    times, peaks, _ = np.array(rows).T
    return [Series(name, times / divisor, peaks, "stems", faint)]
