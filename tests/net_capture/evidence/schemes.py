"""The four schemes of the net side by side: order at slack and taut, accuracy of the default steps, and what it costs.

    python -m tests.net_capture.evidence.schemes [PART ...]

makes `schemes.json` again, or these parts of it, five minutes on one core.

switching   two masses whose thread snaps taut once and lets go: error of their distance afterwards against the closed
            form (`orbital.oscillators`), root mean square over sixteen gaps, which put the onset anywhere in a substep,
            and the slope of that over the substep
opening     Table 1's net over 15 s, with its dashpots at the default steps and without any at the same: largest
            difference of the mean mouth curve from that of the leapfrog at a third of its default step, per cent of the
            flat net's area, with its standard error; energy likewise, per cent of the shot's; what the energy book
            leaves over; CPU time of one run
overdamped  one opening over 8 s with threads of damping ratio 10: mouth area every two seconds, CPU time
"""

from __future__ import annotations

import json
import math
import sys
import time
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL
from orbital.oscillators import damping_ratio, snap_duration, snap_restitution
from tests.net_capture.evidence.steps import END, FLAT, FREE, LOOK, SHOT
from tests.net_capture.taut_pair import PER_MASS, STIFFNESS, dashpot, pair, state

RESULT = Path(__file__).with_name("schemes.json")
COMMAND = "python -m tests.net_capture.evidence.schemes"
SCHEMES = ("leapfrog", "rk4", "ros2", "xpbd")
COUNTS = (40, 80, 160, 320, 640)
"""Substeps in a hundredth of a second; the thread stays taut for 17 ms."""
GAPS = 16
RATE, AFTER = 0.1, 0.05
"""Speed at which the thread lengthens [m/s]; when the distance is judged [s]."""
SEEDS = 3
OVERDAMPED = 10.0
LONGER = (("leapfrog", 0.0), ("ros2", 100.0), ("ros2", 300.0), ("ros2", 1000.0), ("xpbd", 100.0), ("xpbd", 300.0))
"""Step ratios tried with overdamped threads; zero: the default."""
SHORTER = 8.0
"""Seconds for which these are followed."""


def bounced(ratio: float, gap: float) -> float:
    """Stretch [m] of the thread at the end, by closed form: slack, taut, and slack again at the speed that is left."""
    mass = 1.0 / PER_MASS
    zeta = damping_ratio(dashpot(ratio), STIFFNESS, mass)
    frequency = math.sqrt(STIFFNESS / mass)
    taut = snap_duration(STIFFNESS, mass, zeta)
    damped = frequency * math.sqrt(1.0 - zeta * zeta)
    let_go = RATE / damped * math.exp(-zeta * frequency * taut) * math.sin(damped * taut)
    return let_go - snap_restitution(zeta) * RATE * (AFTER - gap / RATE - taut)


def bounce_errors(scheme: str, ratio: float, counts: tuple[int, ...] = COUNTS, gaps: int = GAPS) -> list[float]:
    """Root mean square of the error of that stretch [m], for each substep."""
    errors = []
    for count in counts:
        h = 0.01 / count
        probe = pair(scheme, 0.0, 0.0, {"net.damping_ratio": ratio})
        share = h / probe["solver.stability_bound"] * (1.0 + 1e-6)
        squares = []
        for i in range(gaps):
            gap = RATE * h * (20.0 + (i + 0.5) / gaps)
            net = pair(scheme, -gap, RATE, {"net.damping_ratio": ratio, "solver.step_ratio": share})
            net.step(AFTER)
            squares.append((state(net)[0] - bounced(ratio, gap)) ** 2)
        errors.append(math.sqrt(float(np.mean(squares))))
    return errors


def slope(counts: tuple[int, ...], errors: list[float]) -> float:
    return float(-np.polyfit(np.log(counts), np.log(errors), 1)[0])


def fly(
    scheme: str, ratio: float, seed: int, step_ratio: float, end: float = END
) -> tuple[npt.NDArray[np.float64], Instance, float]:
    """Mouth area, energy and the remainder every quarter of a second (n, 3); the net at the end; CPU time [s]."""
    change = {f"solver.jitter[{i}]": 1e-6 for i in (1, 2, 3)}
    change |= {"net.damping_ratio": ratio, "solver.seed": seed, "solver.step_ratio": step_ratio}
    net = Instance(MODEL, FREE | {"solver": scheme}, change).initialise()
    rows, began = [], time.process_time()
    for _ in range(round(end / LOOK)):
        net.step(LOOK)
        rows.append([net[name] for name in ("mouth.area", "energy.total", "energy.remainder")])
    return np.array(rows), net, time.process_time() - began


def ensemble(
    scheme: str, ratio: float, step_ratio: float, seeds: int
) -> tuple[npt.NDArray[np.float64], Instance, float]:
    """All curves (seeds, 60, 3), one net at the end, CPU time of the median run [s]."""
    runs = [fly(scheme, ratio, seed, step_ratio) for seed in range(1, seeds + 1)]
    return np.array([run[0] for run in runs]), runs[0][1], float(np.median([run[2] for run in runs]))


def opening(scheme: str, ratio: float, step_ratio: float, exact: npt.NDArray[np.float64], seeds: int) -> dict[str, Any]:
    """One row against the reference's curves."""
    curves, net, taken = ensemble(scheme, ratio, step_ratio, seeds)
    difference = np.abs(curves.mean(0) - exact.mean(0))
    error = np.sqrt((curves.var(0, ddof=1) + exact.var(0, ddof=1)) / seeds)
    place = int(difference[:, 0].argmax())
    row = {
        "scheme": scheme,
        "damping_ratio": ratio,
        "substep": float(f"{net['solver.substep']:.6g}"),
        "share_of_leapfrog_bound": round(net["solver.substep"] / net["solver.stability_bound"], 3),
        "mouth_curve_percent": round(100.0 * float(difference[place, 0]) / FLAT, 3),
        "mouth_curve_standard_error": round(100.0 * float(error[place, 0]) / FLAT, 3),
        "energy_percent": round(100.0 * float(difference[:, 1].max()) / SHOT, 3),
        "remainder_percent": round(100.0 * float(np.abs(curves[:, :, 2]).max()) / SHOT, 3),
        "cpu_seconds": round(taken, 2),
    }
    print(json.dumps(row), flush=True)
    return row


def switching() -> list[dict[str, Any]]:
    rows = []
    for ratio in (0.0, 0.106):
        for scheme in SCHEMES:
            errors = bounce_errors(scheme, ratio)
            row = {"scheme": scheme, "damping_ratio": ratio, "order": round(slope(COUNTS, errors), 2)}
            rows.append(row | {"errors": [float(f"{e:.3g}") for e in errors]})
            print(json.dumps(rows[-1]), flush=True)
    return rows


def openings() -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = []
    steps: dict[str, float] = {}
    for ratio in (0.106, 0.0):
        _, net, _ = fly("leapfrog", ratio, 1, 0.0)
        share = net["solver.substep"] / net["solver.stability_bound"]
        exact, _, _ = ensemble("leapfrog", ratio, share / 3.0, SEEDS)
        for scheme in ("leapfrog", "ros2", "xpbd"):
            row = opening(scheme, ratio, steps.get(scheme, 0.0) / net["solver.stability_bound"], exact, SEEDS)
            if scheme != "leapfrog":
                steps[scheme] = row["substep"] * (1.0 + 1e-5)
            rows.append(row)
    return rows


def overdamped() -> list[dict[str, Any]]:
    rows = []
    for scheme, step_ratio in LONGER:
        curve, net, taken = fly(scheme, OVERDAMPED, 1, step_ratio, SHORTER)
        row = {
            "scheme": scheme,
            "substep": float(f"{net['solver.substep']:.6g}"),
            "share_of_leapfrog_bound": round(net["solver.substep"] / net["solver.stability_bound"], 3),
            "mouth_areas": [round(area, 2) for area in curve[7::8, 0].tolist()],
            "energy": round(float(curve[-1, 1]), 3),
            "cpu_seconds": round(taken, 2),
        }
        rows.append(row)
        print(json.dumps(row), flush=True)
    return rows


PARTS = {"switching": switching, "opening": openings, "overdamped": overdamped}


def main(*names: str) -> None:
    """Each part is stored when it is done; all of them, if none are named."""
    for name in names or PARTS:
        rows = PARTS[name]()
        stored = json.loads(RESULT.read_text()) if RESULT.exists() else {}
        stored |= {
            "command": COMMAND,
            "version": {name: version(name) for name in ("dcone-cosim", "numba", "numpy")},
            "counts": COUNTS,
            name: rows,
        }
        RESULT.write_text(json.dumps(stored, indent=1) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
