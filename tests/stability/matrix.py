"""The whole matrix of a scene: every scheme at every extreme.

    python -m tests.stability.matrix table2-deorbit

makes `table2-deorbit.json` again, some minutes on two cores. It is `dcone stability` with time enough for all cases.
"""

from __future__ import annotations

import json
import sys
import tempfile
from importlib.metadata import version
from pathlib import Path
from typing import Any

from dcone_cosim.progress import Lines
from dcone_cosim.stability import commands, show
from dcone_cosim.stability.show import Matrix

RESULTS = Path(__file__).with_name("results")
COMMAND = "python -m tests.stability.matrix"
TIME = 3.0 * 3600.0


def told(one: Matrix) -> dict[str, Any]:
    """A phase of the matrix as it is stored: by extreme and scheme what became of it, why, and what was measured."""
    cells: dict[str, dict[str, Any]] = {}
    for cell in one.cells:
        found = cell.verdict
        cells.setdefault(cell.planned.extreme.name, {})[cell.planned.scheme.name] = {
            "kind": found.kind,
            "why": found.text,
            "asked": cell.planned.asked,
            "measured": {c.key: float(f"{c.value:.3g}") for c in found.criteria if c.value < 1e300},
        }
    shares = {name: {"refused": refused, "of": tried} for name, refused, tried in one.shares()}
    return {"cells": cells, "refused": shares, "sentences": list(show.sentences(one))}


def main(scene: str, folder: str = "") -> None:
    with tempfile.TemporaryDirectory() as made:
        out = Path(folder) if folder else Path(made) / "matrix"
        done = commands.stability(scene, out, Lines(), commands.SHIPPED.get(scene, ()), budget=TIME)
    result = {
        "command": f"{COMMAND} {scene}",
        "dcone-cosim": version("dcone-cosim"),
        "limit": {"value": commands.LIMIT, "unit": "s"},
        "phases": {f"{one.plan.scene.name}.{one.plan.phase}": told(one) for one in done.matrices},
    }
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / f"{scene}.json").write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
