"""What a larger substep costs in mouth area, 49 x 49 knots, 8 s: ensembles of jittered starts in free flight.

    python -m tests.net_capture.evidence.mouth_error [FILE] [HOW_MANY]

makes `mouth_error.json` again (or FILE beside it), a quarter of an hour on one core. For each scene: its own default
substep, that of the timings against plain C (tests/benchmarks), and multiples of both, against a third of the default,
whose own error is a ninth. The error is the largest difference of the two mean curves over the flat net's area; it
carries the standard error of that difference where it is largest. The net is chaotic, and the largest of thirty-two
correlated samples is taken, so up to three standard errors are chance.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL
from fmu_src.packaging.builds import fingerprint

RESULT = Path(__file__).with_name("mouth_error.json")
COMMAND = "python -m tests.net_capture.evidence.mouth_error"
FREE = {"net": "square", "gravity": "none"}
MESH = {"net.mesh": 0.5}
SCENES: Mapping[str, Mapping[str, float]] = {
    "table 1": MESH,
    "deployment": MESH | {"net.damping_ratio": 0.05, "net.fold_side": 1.2},
}
FACTORS = (1.0, 1.14)
TIMED = {"deployment": 0.01 / 179}
"""Substep [s] of the timings: h sqrt(k/m) = 0.55, as the speed of the peers was measured, far above the default."""
TIMED_FACTORS = (1.0, 1.14, 1.3)
SEEDS = 16
END, LOOK = 8.0, 0.25
FLAT = 576.0
"""Area of the flat net [m2]."""
SHOT = 9.0
"""Energy of the shot [J]."""

Curve = npt.NDArray[np.float64]


def terms_of(precision: str) -> dict[str, str]:
    """Terms of the free net in this precision; double is what it has without being told."""
    group = next((name for name, group in MODEL.groups.items() if precision in group.terms), None)
    return FREE | ({group: precision} if group else {})


def precisions() -> tuple[str, ...]:
    """Those the model can be built with."""
    offered = any("single" in group.terms for group in MODEL.groups.values())
    return ("double", "single") if offered else ("double",)


def fly(
    scene: Mapping[str, float], terms: Mapping[str, str], seed: int, step_ratio: float
) -> tuple[Curve, float, Instance]:
    """Mouth area every quarter of a second [m2]; largest remainder of the energy book [J]; the net at the end."""
    change = {f"solver.jitter[{i}]": 1e-6 for i in (1, 2, 3)}
    net = Instance(MODEL, terms, {**scene, **change, "solver.seed": seed, "solver.step_ratio": step_ratio}).initialise()
    areas, remainder = [], 0.0
    for _ in range(round(END / LOOK)):
        net.step(LOOK)
        areas.append(net["mouth.area"])
        remainder = max(remainder, abs(net["energy.remainder"]))
    return np.array(areas), remainder, net


def ensemble(
    scene: Mapping[str, float], terms: Mapping[str, str], seeds: int, step_ratio: float
) -> tuple[Curve, float, Instance]:
    """Mouth areas of all starts (seeds, looks); largest remainder of the energy book [J]; one net at the end."""
    runs = [fly(scene, terms, seed, step_ratio) for seed in range(1, seeds + 1)]
    return np.array([areas for areas, _, _ in runs]), max(left for _, left, _ in runs), runs[-1][2]


def compare(curves: Curve, exact: Curve) -> tuple[float, float]:
    """Largest difference of the mean curves, and its standard error, per cent of the flat net's area."""
    difference = np.abs(curves.mean(0) - exact.mean(0))
    error = np.sqrt(curves.var(0, ddof=1) / len(curves) + exact.var(0, ddof=1) / len(exact))
    place = int(difference.argmax())
    return 100.0 * float(difference[place]) / FLAT, 100.0 * float(error[place]) / FLAT


def ratios(scene: str) -> list[tuple[str, float, float]]:
    """Of each row: multiple of what, how many times, and the step ratio; the default substep's own ratio is first."""
    net = Instance(MODEL, FREE, SCENES[scene]).initialise()
    bound = net["solver.stability_bound"]
    steps = {"default": (net["solver.substep"], FACTORS), "timed": (TIMED.get(scene, 0.0), TIMED_FACTORS)}
    return [(name, f, f * step / bound) for name, (step, factors) in steps.items() if step for f in factors]


def main(name: str = RESULT.name, how_many: str = str(SEEDS)) -> dict[str, Any]:
    seeds, rows = int(how_many), []
    for scene, values in SCENES.items():
        chosen = ratios(scene)
        exact, _, _ = ensemble(values, FREE, seeds, chosen[0][2] / 3.0)
        for precision in precisions():
            for of, factor, ratio in chosen:
                curves, remainder, net = ensemble(values, terms_of(precision), seeds, ratio)
                error, standard_error = compare(curves, exact)
                row = {
                    "scene": scene,
                    "precision": precision,
                    "substep_of": of,
                    "times": factor,
                    "substep": float(f"{net['solver.substep']:.6g}"),
                    "share_of_bound": round(net["solver.substep"] / net["solver.stability_bound"], 4),
                    "mouth_curve_percent": round(error, 4),
                    "mouth_curve_standard_error": round(standard_error, 4),
                    "remainder_percent": round(100.0 * remainder / SHOT, 3),
                }
                rows.append(row)
                print(json.dumps(row), flush=True)
    result = {
        "command": COMMAND,
        "version": {name: version(name) for name in ("dcone-cosim", "numba", "numpy")},
        "sources": fingerprint(MODEL.interface(FREE)),
        "seeds": seeds,
        "rows": rows,
    }
    RESULT.with_name(name).write_text(json.dumps(result, indent=1) + "\n")
    return result


if __name__ == "__main__":
    main(*sys.argv[1:])
