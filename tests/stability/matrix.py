"""The whole matrix of the shipped scenes: every scheme at every extreme.

    python -m tests.stability.matrix [FILE]

makes `matrix.json` again (or FILE), half an hour on two cores. It is `dcone stability` with time enough for all cases.
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

RESULT = Path(__file__).with_name("matrix.json")
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
            "asked": cell.planned.extreme.criterion,
            "measured": {c.key: float(f"{c.value:.3g}") for c in found.criteria if c.value < 1e300},
        }
    shares = {name: {"refused": refused, "of": tried} for name, refused, tried in one.shares()}
    return {"cells": cells, "refused": shares, "sentences": list(show.sentences(one))}


def main(path: Path = RESULT, folder: Path | None = None) -> None:
    with tempfile.TemporaryDirectory() as made:
        done = commands.stability(None, folder or Path(made) / "matrix", Lines(), budget=TIME)
    result = {
        "command": COMMAND,
        "dcone-cosim": version("dcone-cosim"),
        "limit": {"value": commands.LIMIT, "unit": "s"},
        "phases": {f"{one.plan.scene.name}.{one.plan.phase}": told(one) for one in done.matrices},
    }
    path.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
