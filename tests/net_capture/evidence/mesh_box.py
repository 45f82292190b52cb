"""The same catch of a box by its closed form, and of the box as a mesh on a grid: quality and impulse, in the mean.

    python -m tests.net_capture.evidence.mesh_box [FILE] [HOW_MANY]

makes `mesh_box.json` again (or FILE beside it), some minutes on one core. Each row is one start of an ensemble with a
jitter of a micrometre, caught with both: what each has at the end.

    quality index   0.1 |Vn - Vt|/Vt + 0.1 |Sn - St|/St + 0.8 |q|/L: volume and surface of the net's hull and of the
                    target, how far their centres of mass are apart, and the target's longest edge. The lower the better
    impulse         sum of the sizes of all impulses of the contact [N s]

The impulse of one catch scatters by a fifth, since it counts every rattle of the drawn cord: so many starts tell its
mean to a twentieth, and a difference of 2 % would take some 800. What is judged is the difference over its error.
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
from tests.conftest import CAPTURE
from tests.net_capture.memory import shown

RESULT = Path(__file__).with_name("mesh_box.json")
COMMAND = "python -m tests.net_capture.evidence.mesh_box"
SIZE = (2.5, 3.9, 2.5)
CELL = 0.05
END = 12.0
QUALITY_WITHIN = 0.05
"""By how much the means of the quality index may differ, relative."""
IMPULSE_WITHIN = 2.0
"""By how many of its standard errors the difference of the mean impulses may differ from none."""
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
    "target.mass": 1000.0,
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
    while net.time < END - 1e-9:
        net.step(0.5)
    hull = ConvexHull(shown(net))
    a, b, c = SIZE
    volume, surface = a * b * c, 2.0 * (a * b + b * c + c * a)
    apart = float(np.linalg.norm(net.array("catch_position") - net.array("target_position")))
    index = 0.1 * abs(hull.volume - volume) / volume + 0.1 * abs(hull.area - surface) / surface
    return {
        "quality": index + 0.8 * apart / max(SIZE),
        "impulse": net["contact.impulse"],
        "captured": net["t_capture"],
        "momentum": float(np.abs(net.array("momentum")).max()),
    }


def summarise(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Means, and standard deviations, of each kind."""
    found: dict[str, Any] = {"shots": len(rows)}
    for name in ("quality", "impulse", "captured"):
        columns = {kind: np.array([row[kind][name] for row in rows]) for kind in ("box", "mesh")}
        found[name] = {kind: float(column.mean()) for kind, column in columns.items()}
        found[name] |= {f"{kind}_spread": float(column.std(ddof=1)) for kind, column in columns.items()}
        error = float(np.hypot(*(column.std(ddof=1) for column in columns.values()))) / np.sqrt(len(rows))
        found[name]["difference_over_error"] = float((columns["mesh"].mean() - columns["box"].mean()) / error)
    return found


def main(path: Path, count: int) -> None:
    tables = laid()
    rows = [{kind: catch(kind, seed, tables) for kind in ("box", "mesh")} for seed in range(count)]
    told = {
        "command": COMMAND,
        "versions": {name: version(name) for name in ("dcone-cosim", "numba", "numpy", "trimesh")},
        "summary": summarise(rows),
        "rows": rows,
    }
    path.write_text(json.dumps(told, indent=1) + "\n")
    print(json.dumps(told["summary"], indent=1))


if __name__ == "__main__":
    main(
        Path(sys.argv[1]) if len(sys.argv) > 1 else RESULT,
        int(sys.argv[2]) if len(sys.argv) > 2 else 32,
    )
