"""What the default substep costs in accuracy, at damping ratios from 0 to 1: ensembles of Table 1's net in free flight.

    python -m tests.net_capture.evidence.steps [HOW_MANY]

makes `steps.json` again: for each ratio the mean of so many jittered starts, against the mean of as many at a third of
the substep, whose own error is a ninth. Both means carry a standard error, since the net is chaotic: the largest
difference over the curve is that of sixty correlated samples, so up to three standard errors are chance.
"""

from __future__ import annotations

import json
import sys
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL

RESULT = Path(__file__).with_name("steps.json")
COMMAND = "python -m tests.net_capture.evidence.steps"
RATIOS = (0.0, 0.0225, 0.05, 0.106, 0.25, 0.5, 1.0)
SEEDS = 12
END, LOOK = 15.0, 0.25
FLAT = 576.0
"""Area of the flat net [m2]."""
SHOT = 9.0
"""Energy of the shot [J]."""
FREE = {"net": "square", "gravity": "none"}

Curve = npt.NDArray[np.float64]


def fly(ratio: float, seed: int, step_ratio: float = 0.0) -> tuple[Curve, float, float]:
    """Mouth area, energy and the remainder every quarter of a second (60, 3); largest area; share of the bound."""
    change = {f"solver.jitter[{i}]": 1e-6 for i in (1, 2, 3)}
    change |= {"net.damping_ratio": ratio, "solver.seed": seed, "solver.step_ratio": step_ratio}
    net = Instance(MODEL, FREE, change).initialise()
    rows = []
    for _ in range(round(END / LOOK)):
        net.step(LOOK)
        rows.append([net[name] for name in ("mouth.area", "energy.total", "energy.remainder")])
    return np.array(rows), net["mouth.area_max"], net["solver.substep"] / net["solver.stability_bound"]


def compare(ratio: float, seeds: int) -> dict[str, Any]:
    """The default substep against a third of it; areas in per cent of the flat net's, energies in per cent of the
    shot's."""
    default = [fly(ratio, seed) for seed in range(1, seeds + 1)]
    share = default[0][2]
    fine = [fly(ratio, seed, share / 3.0) for seed in range(1, seeds + 1)]
    curves, exact = (np.array([curve for curve, _, _ in runs]) for runs in (default, fine))
    widest, widest_exact = (np.array([area for _, area, _ in runs]) for runs in (default, fine))
    difference = np.abs(curves.mean(0) - exact.mean(0))
    error = np.sqrt((curves.var(0, ddof=1) + exact.var(0, ddof=1)) / seeds)
    place, energy = int(difference[:, 0].argmax()), int(difference[:, 1].argmax())
    spread = float(np.sqrt((widest.var(ddof=1) + widest_exact.var(ddof=1)) / seeds))
    return {
        "damping_ratio": ratio,
        "share_of_bound": round(share, 4),
        "largest_mouth_percent": round(100.0 * float(widest.mean() / widest_exact.mean() - 1.0), 3),
        "largest_mouth_standard_error": round(100.0 * spread / float(widest_exact.mean()), 3),
        "mouth_curve_percent": round(100.0 * float(difference[place, 0]) / FLAT, 3),
        "mouth_curve_standard_error": round(100.0 * float(error[place, 0]) / FLAT, 3),
        "energy_percent": round(100.0 * float(difference[energy, 1]) / SHOT, 3),
        "energy_standard_error": round(100.0 * float(error[energy, 1]) / SHOT, 3),
        "remainder_percent": round(100.0 * float(np.abs(curves[:, :, 2]).max()) / SHOT, 3),
    }


def main(seeds: int = SEEDS) -> dict[str, Any]:
    rows = []
    for ratio in RATIOS:
        rows.append(compare(ratio, seeds))
        print(json.dumps(rows[-1]), flush=True)
    result = {
        "command": COMMAND,
        "version": {name: version(name) for name in ("dcone-cosim", "numba", "numpy")},
        "seeds": seeds,
        "rows": rows,
    }
    RESULT.write_text(json.dumps(result, indent=1) + "\n")
    return result


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
