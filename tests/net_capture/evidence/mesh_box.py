"""The same catch of a box by its closed form, and of the box as a mesh on a grid: quality and impulse, in the mean.

    python -m tests.net_capture.evidence.mesh_box [HOW_MANY [KIND ...]]

makes `mesh_box.json` again, some three CPU-seconds a start; what there is is stored every 8 starts. With kinds named,
these alone and what is not there yet, and of the others every tenth start, which must come out as it is stored. Each
row is one start of an ensemble with a jitter of a micrometre, caught with all kinds:

    box             by its closed form
    mesh, coarse    on grids of 5 and of at most 7 cm, in whose planes the faces lie

`mesh_box_before.json` has the same starts on a grid of 7 cm in whose planes half of the faces lay, as up to 0.16.0
(`rounded`): of the box's twelve edges nine were rounded, 27 to 29 mm within, of its eight corners seven by 50 mm; its
`first` are rows of `mesh_first`. `lines` are the rows of the table in the net's README.

What each has at the end:

    quality index   0.1 |Vn - Vt|/Vt + 0.1 |Sn - St|/St + 0.8 |q|/L: volume and surface of the net's hull and of the
                    target, how far their centres of mass are apart, and the target's longest edge. The lower the better
    impulse, held   what the target has taken in all, m |v|, in the end and in the mean of the last two seconds, as in
                    `laws` [N s]
    sizes           sum of the sizes of all impulses of the contact [N s]; it counts every rattle of the drawn cord

The sizes scatter by a fifth from start to start and the impulse in the end by a tenth, the mean of two seconds by much
less.
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
BEFORE = Path(__file__).with_name("mesh_box_before.json")
COMMAND = "python -m tests.net_capture.evidence.mesh_box"
SIZE = (2.5, 3.9, 2.5)
CELLS = {"mesh": 0.05, "coarse": 0.07}
"""Grids of the kinds that are meshes [m]."""
KINDS = ("box", *CELLS)
END, HELD, STEP = 12.0, 2.0, 0.1
"""End of a catch, the last seconds of which the mean is told, time between two looks [s]."""
NAMES = {
    "box": "closed form: mean, spread",
    "mesh": "grid of 5 cm, less that",
    "coarse": "grid of 7 cm, less that",
    "rounded": "the same with rounded edges, as up to 0.16.0, less that",
}
"""What the README's table calls them."""
QUALITY_WITHIN = 0.05
"""By how much the means of the quality index may differ, relative."""
IMPULSE_WITHIN = 0.02
"""By how much the means of the impulse may differ, relative."""
MASS = 1000.0
STARTS, EVERY, AGAIN = 240, 8, 10
"""Starts, after how many what there is is stored, and of how many that are stored one is made again."""
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


def laid(kind: str = "mesh") -> dict[str, Any]:
    """Tables of the box as a mesh, from a file; none of the box."""
    import trimesh

    if kind not in CELLS:
        return {}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "box.obj"
        trimesh.creation.box(extents=SIZE).export(path)
        made = mesh.lay({"target.mesh_unit": 1.0, "target.resolution": CELLS[kind]}, {mesh.MESH: triangles.read(path)})
    return dict(made.tables)


def catch(kind: str, seed: int, tables: Mapping[str, Any]) -> dict[str, float]:
    """One catch to its end."""
    from scipy.spatial import ConvexHull

    given = {**VALUES, "solver.seed": seed}
    if kind == "box":
        given |= {f"target.size[{i + 1}]": edge for i, edge in enumerate(SIZE)}
    terms = {**CAPTURE, "target": "box" if kind == "box" else "mesh"}
    net = Instance(MODEL, terms, given, tables).initialise()
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
    """Means and standard deviations of each kind; differences of the means from the box's, over the box's, and their
    standard errors."""
    found: dict[str, Any] = {"shots": len(rows)}
    for name in TOLD:
        columns = {kind: np.array([row[kind][name] for row in rows]) for kind in rows[0]}
        means, spreads = ({k: float(f(c)) for k, c in columns.items()} for f in (np.mean, lambda c: c.std(ddof=1)))
        found[name] = {
            kind: {
                "mean": means[kind],
                "spread": spreads[kind],
                "apart": means[kind] / means["box"] - 1.0,
                "error": float(np.hypot(spreads[kind], spreads["box"]) / np.sqrt(len(rows)) / means["box"]),
            }
            for kind in columns
        }
        del found[name]["box"]["apart"], found[name]["box"]["error"]
    return found


def lines(rows: Sequence[Mapping[str, Any]], before: Sequence[Mapping[str, Any]]) -> list[str]:
    """The rows of the README's table: means and spreads of the box, and of the others how their means differ from it.

    before    rows of what there was before, of the same starts
    """
    both = [{**row, **old} for row, old in zip(rows, before, strict=True)]
    told, found = summarise(both), []
    for kind, name in NAMES.items():
        cells = [name]
        for what, unit, digits in (
            ("quality", "", 3),
            ("impulse", " N s", 2),
            ("held", " N s", 2),
            ("sizes", " N s", 0),
        ):
            value = told[what][kind]
            if kind == "box":
                cells.append(f"{value['mean']:.{digits}f}{unit}, {100.0 * value['spread'] / value['mean']:.0f} %")
            else:
                cells.append(f"{100.0 * value['apart']:+.1f} +- {100.0 * value['error']:.1f} %")
        found.append(f"| {' | '.join(cells)} |")
    return found


def main(count: int = STARTS, *anew: str) -> None:
    """Catch so many starts.

    anew    kinds; those stored of all others are kept, but for every tenth start, which must come out as it is stored
    """
    stored = json.loads(RESULT.read_text()) if anew else {"rows": []}
    tables = {kind: laid(kind) for kind in KINDS}
    versions = {name: version(name) for name in ("dcone-cosim", "numba", "numpy", "trimesh")}
    if anew:
        assert versions == stored["versions"], "what is stored is of other versions"
    rows: list[dict[str, Any]] = []
    for seed in range(count):
        known = stored["rows"][seed] if seed < len(stored["rows"]) else {}
        row = {kind: known[kind] for kind in KINDS if kind in known and kind not in anew}
        for kind in KINDS:
            if kind not in row:
                row[kind] = catch(kind, seed, tables[kind])
            elif seed % AGAIN == 0:
                assert row[kind] == catch(kind, seed, tables[kind]), f"{kind}, start {seed}: not as it is stored"
        rows.append({kind: row[kind] for kind in KINDS})
        if len(rows) % EVERY == 0 or len(rows) == count:
            told = {"command": COMMAND, "versions": versions, "summary": summarise(rows)}
            head, lines = json.dumps(told, indent=1).removesuffix("\n}"), ",\n".join(json.dumps(row) for row in rows)
            RESULT.write_text(f'{head},\n "rows": [\n{lines}\n ]\n}}\n')
            print(len(rows), told["summary"], flush=True)


if __name__ == "__main__":
    kernels.alone()
    main(*map(int, sys.argv[1:2]), *sys.argv[2:])
