"""What contact of threads with each other changes in Table 1's capture, and what a substep costs with it.

    python -m tests.net_capture.evidence.self_contact [HOW_MANY]

makes `self_contact.json` again, half a minute on one core and as much for each of the two choices of terms. Starts that
differ by a millimetre of jitter are each followed for 20 s on meshes of 2 m, without it, with threads as thick as they
are, and with threads of 10 mm. What is told is the mean over all starts with its standard error; the impulse is the
target's momentum at the end, the index the CQI of the last 2 s. CPU time is that of the process, a substep's the whole
time over all substeps of all starts, taken in turns.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL
from tests.conftest import CAPTURE
from tests.net_capture.evidence.contact_terms import mean

RESULT = Path(__file__).with_name("self_contact.json")
COMMAND = "python -m tests.net_capture.evidence.self_contact"
STARTS, END, STEP, LATE = 8, 20.0, 0.5, 2.0
MASS = 1000.0
TERMS = {**CAPTURE, "quality": "plain"}
VALUES = {"net.mesh": 2.0, **{f"solver.jitter[{i}]": 1e-3 for i in (1, 2, 3)}}
WITH = {"self_contact": "plain"}
CHOICES: Mapping[str, tuple[Mapping[str, str], Mapping[str, float]]] = {
    "without": ({}, {}),
    "as thick as they are": (WITH, {}),
    "10 mm": (WITH, {"self_contact.thickness": 0.01}),
}
COUNTS = ("touched", "passed", "at_start", "left_out", "depth", "force_max", "loss", "margin_least")


def follow(seed: int, choice: str) -> dict[str, Any]:
    """One start to its end."""
    terms, given = CHOICES[choice]
    net = Instance(MODEL, {**TERMS, **terms}, {**VALUES, **given, "solver.seed": seed}).initialise()
    index = []
    began = time.process_time()
    while net.time < END - 1e-9:
        net.step(STEP)
        index.append(net["quality.index"])
    taken = time.process_time() - began
    row = {
        "seed": seed,
        "choice": choice,
        "captured": bool(net["captured"]),
        "t_capture": net["t_capture"] if net["t_capture"] >= 0.0 else float("nan"),
        "index": float(np.mean(index[-round(LATE / STEP) :])),
        "impulse": MASS * float(np.linalg.norm(net.array("target_velocity"))),
        "thread": net["thread.tension_max"],
        "remainder": net["energy.remainder"],
        "substep": net["solver.substep"],
        "substeps": int(net["solver.steps"]),
        "cpu": taken,
        **{name: net[f"self_contact.{name}"] for name in COUNTS if terms},
    }
    return {name: float(f"{value:.6g}") if isinstance(value, float) else value for name, value in row.items()}


TOLD = ("t_capture", "index", "impulse", "thread", "remainder")


def summarise(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Every choice by itself."""
    found: dict[str, Any] = {}
    for choice in CHOICES:
        shots = [row for row in rows if row["choice"] == choice]
        cpu = sum(row["cpu"] for row in shots) / sum(row["substeps"] for row in shots)
        found[choice] = {
            "captured": sum(row["captured"] for row in shots),
            "microseconds": round(1e6 * cpu, 3),
            "seconds": round(float(np.mean([row["cpu"] for row in shots])), 3),
            **{name: mean([row[name] for row in shots]) for name in TOLD},
            **{name: mean([row[name] for row in shots]) for name in COUNTS if name in shots[0]},
        }
    return found


def main(how_many: int = STARTS) -> None:
    """Follow so many starts; what there is is stored after each."""
    rows: list[dict[str, Any]] = []
    versions = {name: version(name) for name in ("dcone-cosim", "numba", "numpy")}
    for seed in range(how_many):
        rows += [follow(seed, choice) for choice in CHOICES]
        head = {"command": COMMAND, "versions": versions, "starts": seed + 1, "summary": summarise(rows), "rows": rows}
        RESULT.write_text(json.dumps(head, indent=1) + "\n")
        print(seed, [row["captured"] for row in rows[-len(CHOICES) :]], flush=True)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
