"""The first second of contact of the catch of `mesh_box`, before it is chaotic: the box by its closed form, and as a
mesh on a grid of 5 and of 7 cm.

    python -m tests.net_capture.evidence.mesh_first

makes `mesh_first.json` again, a minute on one core. Each row is one start: the sum of the sizes of all impulses [N s]
so long after the first touch, with each; what the target has taken up then; and the instants of the first touch, which
are the same, since up to there all are one flight.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL
from tests.conftest import CAPTURE
from tests.net_capture.evidence.mesh_box import KINDS, SIZE, VALUES, laid

RESULT = Path(__file__).with_name("mesh_first.json")
COMMAND = "python -m tests.net_capture.evidence.mesh_first"
SHOTS = 8
LOOKS = (0.2, 0.5, 1.0)
"""Seconds after the first touch."""


def first(kind: str, seed: int, tables: Mapping[str, Any]) -> dict[str, Any]:
    """Instant of the first touch, impulses after each of `LOOKS`, and the target's velocity then."""
    given = {**VALUES, "solver.seed": seed}
    if kind == "box":
        given |= {f"target.size[{i + 1}]": edge for i, edge in enumerate(SIZE)}
    terms = {**CAPTURE, "target": "box" if kind == "box" else "mesh"}
    net = Instance(MODEL, terms, given, tables).initialise()
    while net["contact.first_time"] < 0.0:
        net.step(0.01)
    impulses = []
    for look in LOOKS:
        while net.time < net["contact.first_time"] + look:
            net.step(0.01)
        impulses.append(net["contact.impulse"])
    return {"touch": net["contact.first_time"], "impulse": impulses, "speed": net["target.velocity[2]"]}


def main() -> None:
    tables = {kind: laid(kind) for kind in KINDS}
    rows = [{kind: first(kind, seed, tables[kind]) for kind in KINDS} for seed in range(SHOTS)]
    versions = {name: version(name) for name in ("dcone-cosim", "numba", "numpy", "trimesh")}
    RESULT.write_text(json.dumps({"command": COMMAND, "versions": versions, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
