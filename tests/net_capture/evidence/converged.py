"""How far the aggregates of an opening hang on the substep and on the pieces that threads are cut into.

    python -m tests.net_capture.evidence.converged

makes `converged.json` again: Table 1's net with meshes of 2 m, damping ratio 0.106, shot into nothing, eight times each
with its nodes a micrometre beside their places. Of every aggregate the mean, and its standard error.
"""

from __future__ import annotations

import json
from importlib.metadata import version
from pathlib import Path

import numpy as np

from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL

COMMAND = "python -m tests.net_capture.evidence.converged"
RESULT = Path(__file__).with_name("converged.json")
TERMS = {"net": "square", "gravity": "none"}
NET = {"net.mesh": 2.0, "solver.jitter[1]": 1e-6, "solver.jitter[2]": 1e-6, "solver.jitter[3]": 1e-6}
SHOTS, SPAN = 8, 14.0
SHARES = (1.0, 0.5, 0.25)
"""Of the default substep."""
PIECES = (1, 2, 4)
AGGREGATES = {
    "largest mouth area over the flat net's": lambda net: net["mouth.area_max"] / 576.0,
    "when it is largest [s]": lambda net: net["mouth.t_max"],
    "80 % open from [s]": lambda net: net["mouth.t80"],
    "80 % open for [s]": lambda net: net["mouth.time_above_80"],
    "taken by the dashpots [J]": lambda net: net["thread.dissipated"],
}


def shot(seed: int, pieces: int, share: float) -> list[float]:
    """Aggregates of one shot."""
    values = {**NET, "net.segments": pieces, "solver.seed": seed}
    if share != 1.0:
        first = Instance(MODEL, TERMS, values).initialise()
        values["solver.step_ratio"] = share * first["solver.substep"] / first["solver.stability_bound"]
    net = Instance(MODEL, TERMS, values).initialise()
    net.step(SPAN)
    return [of(net) for of in AGGREGATES.values()]


def row(pieces: int, share: float) -> dict[str, object]:
    """Means and standard errors of all shots."""
    found = np.array([shot(seed, pieces, share) for seed in range(SHOTS)])
    error = found.std(axis=0, ddof=1) / np.sqrt(SHOTS)
    return {"pieces": pieces, "share": share, "mean": found.mean(axis=0).tolist(), "error": error.tolist()}


def main() -> dict[str, object]:
    rows = [row(1, share) for share in SHARES] + [row(pieces, 1.0) for pieces in PIECES[1:]]
    result = {"command": COMMAND, "version": version("dcone-cosim"), "shots": SHOTS, "rows": rows}
    RESULT.write_text(json.dumps(result, indent=1) + "\n")
    print("| pieces | substep |", *(f"{name} |" for name in AGGREGATES))
    print("| --- | --- |", "--- |" * len(AGGREGATES))
    for one in rows:
        cells = (f"{mean:.4g} +- {error:.1g} |" for mean, error in zip(one["mean"], one["error"], strict=True))
        print(f"| {one['pieces']} | {one['share']:g} |", *cells)
    return result


if __name__ == "__main__":
    main()
