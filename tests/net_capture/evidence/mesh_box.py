"""The same catch of a box by its closed form, and of the box as a mesh on a grid: quality and impulse, in the mean.

    python -m tests.net_capture.evidence.mesh_box [FILE] [HOW_MANY]

makes `mesh_box.json` again (or FILE beside it); what there is is stored every 8 starts. Each row is one start of an
ensemble with a jitter of a micrometre, caught with both: what each has at the end.

    quality index   0.1 |Vn - Vt|/Vt + 0.1 |Sn - St|/St + 0.8 |q|/L: volume and surface of the net's hull and of the
                    target, how far their centres of mass are apart, and the target's longest edge. The lower the better
    impulse, held   what the target has taken in all, m |v|, in the end and in the mean of the last two seconds, as in
                    `laws` [N s]
    sizes           sum of the sizes of all impulses of the contact [N s]; it counts every rattle of the drawn cord

The first and the last of these scatter by a fifth from start to start, the mean of two seconds by much less.
"""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL
from fmu_src.net_capture.shapes import mesh, triangles
from tests import kernels
from tests.conftest import CAPTURE
from tests.net_capture.memory import shown

RESULT = Path(__file__).with_name("mesh_box.json")
COMMAND = "python -m tests.net_capture.evidence.mesh_box"
SIZE = (2.5, 3.9, 2.5)
CELL = 0.05
END, HELD, STEP = 12.0, 2.0, 0.1
"""End of a catch, the last seconds of which the mean is told, time between two looks [s]."""
QUALITY_WITHIN = 0.05
"""By how much the means of the quality index may differ, relative."""
IMPULSE_WITHIN = 0.02
"""By how much the means of the impulse may differ, relative."""
MASS = 1000.0
STARTS, EVERY = 60, 8
"""Starts, and after how many what there is is stored."""
TOLD = ("quality", "impulse", "held", "sizes", "captured")
VALUES: Mapping[str, float] = {
    "net.side": 12.0,
    "net.mesh": 1.0,
    "net.mass": 0.84,
    "net.fold_side": 0.4,
    "bullets.mass": 1.27,
    "vertex.mass": 0.15,
    "chaser.start_position[2]": -12.0,
    "closing.time": 6.4,
    "closing.speed": 5.0,
    "closing.stall_force": 6.0,
    "closing.rings": 1,
    "target.mass": MASS,
    **{f"target.start_rate[{i}]": 0.02 for i in (1, 2, 3)},
    **{f"solver.jitter[{i}]": 1e-6 for i in (1, 2, 3)},
}


def laid() -> dict[str, Any]:
    """Tables of the box as a mesh, from a file."""
    import trimesh

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "box.obj"
        trimesh.creation.box(extents=SIZE).export(path)
        made = mesh.lay({"target.mesh_unit": 1.0, "target.resolution": CELL}, {mesh.MESH: triangles.read(path)})
    return dict(made.tables)


def catch(kind: str, seed: int, tables: Mapping[str, Any]) -> dict[str, float]:
    """One catch to its end."""
    from scipy.spatial import ConvexHull

    given = {**VALUES, "solver.seed": seed}
    if kind == "box":
        given |= {f"target.size[{i + 1}]": edge for i, edge in enumerate(SIZE)}
    net = Instance(MODEL, {**CAPTURE, "target": kind}, given, tables if kind == "mesh" else {}).initialise()
    taken = []
    for _ in range(round(END / STEP)):
        net.step(STEP)
        taken.append(MASS * float(np.linalg.norm(net.array("target_velocity"))))
    hull = ConvexHull(shown(net))
    a, b, c = SIZE
    volume, surface = a * b * c, 2.0 * (a * b + b * c + c * a)
    apart = float(np.linalg.norm(net.array("catch_position") - net.array("target_position")))
    index = 0.1 * abs(hull.volume - volume) / volume + 0.1 * abs(hull.area - surface) / surface
    found = {
        "quality": index + 0.8 * apart / max(SIZE),
        "impulse": taken[-1],
        "held": float(np.mean(taken[-round(HELD / STEP) :])),
        "sizes": net["contact.impulse"],
        "captured": net["t_capture"],
        "momentum": float(np.abs(net.array("momentum")).max()),
    }
    return {name: float(f"{value:.7g}") for name, value in found.items()}


def summarise(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Means and standard deviations of each kind; difference of the means over the box's, and its standard error."""
    found: dict[str, Any] = {"shots": len(rows)}
    for name in TOLD:
        columns = {kind: np.array([row[kind][name] for row in rows]) for kind in ("box", "mesh")}
        found[name] = {kind: float(column.mean()) for kind, column in columns.items()}
        found[name] |= {f"{kind}_spread": float(column.std(ddof=1)) for kind, column in columns.items()}
        error = float(np.hypot(*(column.std(ddof=1) for column in columns.values()))) / np.sqrt(len(rows))
        found[name]["apart"] = found[name]["mesh"] / found[name]["box"] - 1.0
        found[name]["error"] = float(error) / abs(found[name]["box"])
    return found


def main(path: Path, count: int) -> None:
    tables = laid()
    rows: list[dict[str, Any]] = []
    for seed in range(count):
        rows.append({kind: catch(kind, seed, tables) for kind in ("box", "mesh")})
        if len(rows) % EVERY == 0 or len(rows) == count:
            told = {
                "command": COMMAND,
                "versions": {name: version(name) for name in ("dcone-cosim", "numba", "numpy", "trimesh")},
                "summary": summarise(rows),
            }
            head, lines = json.dumps(told, indent=1).removesuffix("\n}"), ",\n".join(json.dumps(row) for row in rows)
            path.write_text(f'{head},\n "rows": [\n{lines}\n ]\n}}\n')
            print(len(rows), told["summary"], flush=True)


if __name__ == "__main__":
    kernels.alone()
    main(
        Path(sys.argv[1]) if len(sys.argv) > 1 else RESULT,
        int(sys.argv[2]) if len(sys.argv) > 2 else STARTS,
    )
