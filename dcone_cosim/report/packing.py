"""Arrays as a page holds them: positions in 16 bits, tensions in 8 on a logarithmic scale, all else in single.

Each array is `{"type", "shape", "data"}` with the bytes in base64, little-endian, and what makes numbers of them:

    u2    value = low + step * code, along the last axis                 err <= step / 2, a 131,000th of the span
    tension (u1)    0 slack;  T = most * FLOOR^((255 - code) / 254)      err <= 1.4 %

Checked  tests/report/test_packing.py
"""

from __future__ import annotations

import base64
from itertools import pairwise
from typing import Any

import numpy as np

from dcone_cosim.scenery import Array, Chart, Clip, Net, Swing

FLOOR = 1e-3
"""Tension told from slack, over the largest: what bears less is shown as slack."""
CODES = 255
MOST_BYTES = 12_000_000
"""Of a net's clip before base64; of a longer one every n-th frame is shown, and said so."""
MOST_POINTS = 20_000
"""Points of a curve; of a longer one, the least and the largest of each stretch are kept."""


def text_of(values: Array) -> str:
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode()


def singles(values: Array) -> dict[str, Any]:
    """In single precision."""
    return {"type": "f4", "shape": list(np.shape(values)), "data": text_of(np.asarray(values, dtype="<f4"))}


def doubles(values: Array) -> dict[str, Any]:
    return {"type": "f8", "shape": list(np.shape(values)), "data": text_of(np.asarray(values, dtype="<f8"))}


def wholes(values: Array) -> dict[str, Any]:
    return {"type": "u4", "shape": list(np.shape(values)), "data": text_of(np.asarray(values, dtype="<u4"))}


def places(values: Array) -> dict[str, Any]:
    """Positions (..., 3) in 16 bits between the least and the largest along each axis."""
    flat = np.asarray(values, dtype=float).reshape(-1, 3)
    low = flat.min(axis=0)
    step = np.maximum(flat.max(axis=0) - low, 1e-9) / 65535.0
    codes = np.rint((flat - low) / step).astype("<u2")
    told = {"low": low.tolist(), "step": step.tolist()}
    return {"type": "u2", "shape": list(np.shape(values)), **told, "data": text_of(codes)}


def tensions(values: Array, most: float) -> dict[str, Any]:
    """Tensions [N] as codes of a logarithmic scale that ends at `most`."""
    pull = np.asarray(values, dtype=float)
    with np.errstate(divide="ignore"):
        exponent = np.log(pull / most) / np.log(FLOOR) if most > 0.0 else np.full(pull.shape, np.inf)
    codes = np.where(exponent <= 1.0, np.rint(CODES - (CODES - 1) * np.clip(exponent, 0.0, 1.0)), 0)
    return {"type": "u1", "shape": list(pull.shape), "most": most, "floor": FLOOR, "data": text_of(codes.astype("u1"))}


def clip(one: Clip) -> dict[str, Any]:
    """A clip for `replay.js`."""
    every = _stride(one.net)
    keep = np.unique([*range(0, len(one.times), every), len(one.times) - 1])
    notes = list(one.notes)
    if every > 1:
        notes.append(f"every {every}. frame of {len(one.times):,} is shown: all would be too much for a page")
    told: dict[str, Any] = {
        "key": one.key,
        "title": one.title,
        "clock": one.clock,
        "times": doubles(one.times[keep]),
        "chaser": singles(one.chaser[keep]),
        "marks": [{"time": time, "what": what} for time, what in one.marks],
        "notes": notes,
        "held": one.held,
    }
    for name, values in (
        ("target", one.target),
        ("attitude", one.attitude),
        ("line", one.line_end),
        ("bullets", one.bullets),
    ):
        if values is not None:
            told[name] = singles(values[keep])
    if one.surface is not None:
        told["surface"] = {"corners": np.asarray(one.surface[0]).tolist(), "faces": one.surface[1]}
    if one.swing is not None:
        told |= {"swing": _swing(one.swing), "angle": singles(one.swing.angle[keep])}
    if one.tension is not None:
        told["tension"] = tensions(one.tension[keep], float(np.max(one.tension, initial=0.0)))
    if one.taut is not None:
        told["taut"] = np.asarray(one.taut[keep], dtype=int).tolist()
    if one.net is not None:
        told["net"] = _net(one.net, keep)
    return told


def _stride(net: Net | None) -> int:
    """Of the frames that are shown, so that the page stays light."""
    if net is None:
        return 1
    size = 2 * net.nodes.size + (0 if net.tensions is None else net.tensions.size)
    return max(1, -(-size // MOST_BYTES))


def _swing(swing: Swing) -> dict[str, Any]:
    """What of the body swings, and about what; its angle is told beside."""
    places = {name: np.asarray(getattr(swing, name), dtype=float).tolist() for name in ("hinge", "axis", "lag")}
    return {"corners": np.asarray(swing.corners, dtype=bool).tolist(), **places}


def _net(net: Net, keep: Array) -> dict[str, Any]:
    told = {"nodes": places(net.nodes[keep]), "threads": wholes(net.threads), "rim": list(map(int, net.rim))}
    if net.tensions is not None and net.tensions.size:
        told["tensions"] = tensions(net.tensions[keep], float(net.tensions.max()))
    return told


def chart(one: Chart) -> dict[str, Any]:
    """A chart for `chart.js`."""
    series, fewer = [], False
    for row in one.series:
        x, y = (row.x, row.y) if row.kind == "stems" else thinned(row.x, row.y)
        fewer |= len(x) < len(row.x)
        series.append(
            {"name": row.name, "kind": row.kind, "faint": row.faint, "hue": row.hue, "x": doubles(x), "y": singles(y)}
        )
    return {
        "key": one.key,
        "title": one.title,
        "clock": one.clock,
        "unit": one.unit,
        "xUnit": one.x_unit,
        "log": one.log,
        "thinned": fewer,
        "marks": [{"time": time, "what": what} for time, what in one.marks],
        "series": series,
    }


def thinned(x: Array, y: Array) -> tuple[Array, Array]:
    """A curve of at most `MOST_POINTS`: of each stretch its least and its largest value stay, where they are."""
    if len(x) <= MOST_POINTS:
        return x, y
    edges = np.linspace(0, len(x), MOST_POINTS // 2 - 1).astype(int)
    kept = {0, len(x) - 1}
    for begin, end in pairwise(edges):
        if end > begin:
            kept |= {begin + int(np.argmin(y[begin:end])), begin + int(np.argmax(y[begin:end]))}
    rows = np.array(sorted(kept))
    return x[rows], y[rows]
