"""How far the aggregates of an opening hang on the substep and on the pieces that threads are cut into.

    python -m tests.net_capture.evidence.converged [substeps] [pieces]

makes `converged.json` again, or one part of it: Table 1's net, damping ratio 0.106, shot into nothing several times
each with its nodes a micrometre beside their places. Of every aggregate the mean, and its standard error: with meshes
of 2 m over substeps, and with meshes of 4 m over the pieces that every thread is cut into.
"""

from __future__ import annotations

import json
import sys
from importlib.metadata import version
from pathlib import Path

import numpy as np

from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL

COMMAND = "python -m tests.net_capture.evidence.converged"
RESULT = Path(__file__).with_name("converged.json")
TERMS = {"net": "square", "gravity": "none"}
JITTER = {f"solver.jitter[{axis}]": 1e-6 for axis in (1, 2, 3)}
SPAN = 14.0
CLOSED = 20.0
"""By when every mouth has fallen below 80 % for good [s]: how long it was open is asked then."""
SHARES = (1.0, 0.5, 0.25)
"""Of the default substep."""
PIECES = (1, 2, 4, 8)
PARTS = {
    "substeps": (2.0, 8, [(1, share) for share in SHARES]),
    "pieces": (4.0, 4, [(pieces, 1.0) for pieces in PIECES]),
}
"""Mesh [m], shots, and pieces and substeps of each row."""
OPEN_FOR = "80 % open for [s]"
AGGREGATES = {
    "largest mouth area over the flat net's": lambda net: net["mouth.area_max"] / 576.0,
    "when it is largest [s]": lambda net: net["mouth.t_max"],
    "80 % open from [s]": lambda net: net["mouth.t80"],
    OPEN_FOR: lambda net: net["mouth.time_above_80"],
    "taken by the dashpots [J]": lambda net: net["thread.dissipated"],
}


def shot(mesh: float, seed: int, pieces: int, share: float) -> list[float]:
    """Aggregates of one shot."""
    values = {**JITTER, "net.mesh": mesh, "net.segments": pieces, "solver.seed": seed}
    if share != 1.0:
        first = Instance(MODEL, TERMS, values).initialise()
        values["solver.step_ratio"] = share * first["solver.substep"] / first["solver.stability_bound"]
    net = Instance(MODEL, TERMS, values).initialise()
    net.step(SPAN)
    found = {name: of(net) for name, of in AGGREGATES.items()}
    net.step(CLOSED - SPAN)
    if net["mouth.area_ratio"] > 0.8:
        raise ValueError(f"{pieces} pieces, {share:g} of the substep: the mouth is still open at {CLOSED:g} s")
    return list((found | {OPEN_FOR: AGGREGATES[OPEN_FOR](net)}).values())


def row(mesh: float, shots: int, pieces: int, share: float) -> dict[str, object]:
    """Means and standard errors of all shots."""
    found = np.array([shot(mesh, seed, pieces, share) for seed in range(shots)])
    error = found.std(axis=0, ddof=1) / np.sqrt(shots)
    return {"pieces": pieces, "share": share, "mean": found.mean(axis=0).tolist(), "error": error.tolist()}


def limit(values: np.ndarray) -> tuple[float, float]:
    """Where values at n, 2 n and 4 n pieces lead to, and the order of their errors in the length of a piece.

    Source   Richardson's extrapolation: e_n = c n^-p, so p = log2 of the ratio of both differences
    """
    first, second = values[1] - values[0], values[2] - values[1]
    ratio = second / first
    return float(values[2] + second * ratio / (1.0 - ratio)), float(-np.log2(ratio))


def main(parts: list[str]) -> None:
    kept = json.loads(RESULT.read_text()) if RESULT.exists() else {}
    for name in parts or PARTS:
        mesh, shots, rows = PARTS[name]
        found = [row(mesh, shots, pieces, share) for pieces, share in rows]
        kept[name] = {"mesh": mesh, "shots": shots, "version": version("dcone-cosim"), "rows": found}
        print("| pieces | substep |", *(f"{name} |" for name in AGGREGATES))
        print("| --- | --- |", "--- |" * len(AGGREGATES))
        for one in found:
            cells = (f"{mean:.4g} +- {error:.1g} |" for mean, error in zip(one["mean"], one["error"], strict=True))
            print(f"| {one['pieces']} | {one['share']:g} |", *cells, flush=True)
        RESULT.write_text(json.dumps({"command": COMMAND} | kept, indent=1) + "\n")


if __name__ == "__main__":
    main(sys.argv[1:])
