"""Where a capture's markers were in a simulation, at the instants of measured tracks.

Bullets and vertex are known with their velocities at every communication point; between two the cubic that has both is
taken. Nodes are known at the snapshots alone, and are compared there, within half a macro step.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dcone_cosim import build
from dcone_cosim.errors import InputError
from dcone_cosim.tracks.reading import Array, Track


@dataclass(frozen=True)
class Flown:
    """What a capture leaves of its markers, in the orbital frame.

    columns     of the outputs by name, with the `time` since the shot [s]
    shots       instants of the snapshots [s]; `nodes` the positions of all nodes then, (n, 3) each [m]
    values      of the capture's parameters, by FMI name, SI
    """

    columns: Mapping[str, Array]
    shots: Sequence[float]
    nodes: Sequence[Array]
    values: Mapping[str, float]


def at_instants(flown: Flown, track: Track) -> Array:
    """Where the track's marker was at its instants, in the shot's frame, (n, 3) [m]; NaN where that is not known.

    Checked  tests/cosim/test_tracks.py
    """
    muzzle, axes = build.shot_frame(flown.values)
    if track.kind == "node":
        found = _of_nodes(flown, track)
    else:
        name = "vertex" if track.kind == "vertex" else f"bullet[{track.number}]"
        if f"{name}.position[1]" not in flown.columns:
            raise InputError(f"{track.marker} is in the tracks, and no {name}.position in the results of the capture")
        found = _cubic(flown.columns, name, track.times)
    placed: Array = (found - muzzle) @ axes.T
    return placed


def _cubic(columns: Mapping[str, Array], name: str, times: Array) -> Array:
    """By Hermite's cubic between two communication points: its error is the fourth derivative times dt^4 / 384."""
    from scipy.interpolate import CubicHermiteSpline

    def vector(what: str) -> Array:
        return np.column_stack([columns[f"{name}.{what}[{axis}]"] for axis in (1, 2, 3)])

    grid, kept = np.unique(columns["time"], return_index=True)
    curve = CubicHermiteSpline(grid, vector("position")[kept], vector("velocity")[kept])
    found: Array = np.array(curve(times), dtype=float)
    found[(times < grid[0] - 1e-9) | (times > grid[-1] + 1e-9)] = np.nan
    return found


def _of_nodes(flown: Flown, track: Track) -> Array:
    found = np.full((len(track.times), 3), np.nan)
    if not len(flown.shots):
        raise InputError(
            f"{track.marker} is in the tracks, and the run kept no nodes; expected [capture.nodes] in the scene and "
            "the instants of the tracks among capture.snapshots"
        )
    if track.number > len(flown.nodes[0]):
        raise InputError(f"{track.marker} is in the tracks, and the net has {len(flown.nodes[0])} nodes")
    shots, near = np.asarray(flown.shots), 0.5 * float(np.median(np.diff(flown.columns["time"])))
    for place, time in enumerate(track.times):
        shot = int(np.argmin(np.abs(shots - time)))
        if abs(shots[shot] - time) <= near * (1.0 + 1e-9):
            found[place] = flown.nodes[shot][track.number - 1]
    return found
