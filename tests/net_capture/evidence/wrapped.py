"""Threads that bend round what is thin and hollow: shots with 1 mm of jitter, and how many threads go through.

    python -m tests.net_capture.evidence.wrapped [CASE ...]

makes `wrapped.json` again (with cases named: their rows). Each shot runs to the end of its capture; `passed` and
`slack` are `wrap.passed` and `wrap.passed_slack` then, `open` the largest remainder of the energy book over what came
in, added up from what is recorded (`books`), and `seed` that of the jitter, 0 for none.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import Any

from tests import kernels
from tests.net_capture.evidence.books import captures, judged, write

RESULT = Path(__file__).with_name("wrapped.json")
COMMAND = "python -m tests.net_capture.evidence.wrapped"
BACK = {
    "capture.target.start_attitude": [0.5**0.5, 0.0, 0.0, -(0.5**0.5)],
    "capture.closing.time": "6.6 s",
    "capture.duration": "14 s",
}
CASES: dict[str, tuple[str, dict[str, Any], int]] = {
    "fairing": ("fairing", {}, 2),
    "fairing, its back to the net": ("fairing", BACK, 4),
    "fairing-holds": ("fairing-holds", {}, 2),
    "big-panel": ("big-panel", {}, 2),
    "big-panel-wrapped": ("big-panel-wrapped", {}, 3),
}
"""Scene, what is changed of it, and how many shots."""


def shot(scene: str, settings: dict[str, Any], seed: int) -> dict[str, Any]:
    """One row."""
    jitter = {"capture.solver.jitter": ["1 mm"] * 3, "capture.solver.seed": seed} if seed > 0 else {}
    ((_, of, status),) = captures(scene, {**settings, **jitter})
    told = {
        name: int(of.columns[f"wrap.{word}"][-1]) for name, word in (("passed", "passed"), ("slack", "passed_slack"))
    }
    book = judged(of)
    return {"status": status, **told, "bent": int(of.columns["wrap.threads"].max()), "open": book["open"]}


def main(*only: str) -> None:
    """Every case, or those named anew, and what is stored of the others as it is."""
    stored = json.loads(RESULT.read_text())["rows"] if only and RESULT.exists() else []
    for case in only or CASES:
        scene, settings, shots = CASES[case]
        stored = [row for row in stored if row["case"] != case]
        for seed in range(shots):
            began = time.process_time()
            stored.append({"case": case, "seed": seed, **shot(scene, settings, seed)})
            print(json.dumps(stored[-1]), f"{time.process_time() - began:.1f} CPU-s", flush=True)
            write(RESULT, COMMAND, stored, "case", "seed")


if __name__ == "__main__":
    kernels.alone()
    main(*sys.argv[1:])
