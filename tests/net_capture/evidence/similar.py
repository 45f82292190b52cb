"""The scaling law for every shape of net: lengths x s, times x s, masses x s3, E A x s2 leave the opening as it is.

    python -m tests.net_capture.evidence.similar [SHAPE ...]

makes `similar.json` again, or these shapes of it: mouth area over the flat net's at eight instants of an opening, at
s = 1, 1/16 and 3, at the same speeds and moduli; its largest difference from s = 1, and that of a twin whose bullets'
masses are scaled by s2.

Substeps come in a whole number to every `MEASURE_INTERVAL`, so those of two sizes differ by up to a thousandth, and
folds that part company make of that what they make of a micrometre. At s = 1/16 substeps can be made to scale as well
(`alike`): as 16 is a power of two, all numbers then do, and every mouth area has the same bits.
"""

from __future__ import annotations

import json
import sys
from importlib.metadata import version
from pathlib import Path

import numpy as np

from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL
from fmu_src.net_capture.nets.own_graph import NODES, THREADS
from fmu_src.net_capture.stepping import MEASURE_INTERVAL
from tests.net_capture.own_files import unlike

COMMAND = "python -m tests.net_capture.evidence.similar"
RESULT = Path(__file__).with_name("similar.json")
SIZES = (1.0 / 16.0, 3.0)
LENGTHS = (
    "net.side",
    "net.width",
    "net.height",
    "net.radius",
    "net.depth",
    "net.top_radius",
    "net.mesh",
    "net.fold_side",
)
MASSES = ("net.mass", "vertex.mass", "chaser.mass")
COMMON = {
    "net.mass": 0.33, "bullets.mass": 0.5, "vertex.mass": 0.15, "chaser.mass": 2000.0, "net.fold_side": 1.0,
    "net.damping_ratio": 0.106, "solver.step_ratio": 0.1, "bullets.speed": 3.0,
}  # fmt: skip
SHAPES = {
    "square": ({"net.side": 24.0, "net.mesh": 2.0}, {}),
    "rectangle": ({"net.width": 30.0, "net.height": 24.0, "net.mesh": 2.0}, {}),
    "pyramid": ({"net.side": 24.0, "net.depth": 12.0, "net.mesh": 2.0}, {}),
    "cone": ({"net.radius": 12.0, "net.depth": 12.0, "net.top_radius": 3.0, "net.mesh": 2.0}, {}),
    "radial": ({"net.radius": 12.0, "net.mesh": 2.0}, {}),
    "hexagon": ({"net.radius": 12.0, "net.mesh": 2.0}, {"bullets": "6"}),
    "table": ({}, {}),
}
INSTANTS = np.linspace(1.0, 8.0, 8)


def curve(shape: str, s: float, power: int = 3, alike: bool = False) -> np.ndarray:
    """Mouth area over the flat net's at the instants of an opening.

    power     of s that bullets are scaled by
    alike     whether substeps scale by s to the bit, for 1/s a whole number
    """
    values, terms = SHAPES[shape]
    names = {v.name for v in MODEL.interface({"net": shape, "gravity": "none", **terms}).variables}
    given = {name: value for name, value in {**COMMON, **values}.items() if name in names}
    scaled = {n: v * (s if n in LENGTHS else s**3 if n in MASSES else 1.0) for n, v in given.items()}
    scaled["bullets.mass"] *= s**power
    tables = {}
    if shape == "table":
        nodes, threads, _ = unlike()
        # line and name; place; role, and line and names; length, diameter, stiffness, mass, dashpot
        nodes = nodes * np.array([1.0, 1.0, s, s, s, 1.0])
        threads = threads * np.array([1.0, 1.0, 1.0, s, s, s, s**3, s**2])
        tables = {NODES: nodes, THREADS: threads}
    if alike:
        scaled["chaser.start_position[2]"] = -20.0 * s
        whole = Instance(MODEL, {"net": shape, "gravity": "none", **terms}, given).initialise()
        steps = round(MEASURE_INTERVAL / whole["solver.substep"] / s)
        scaled["solver.step_ratio"] = MEASURE_INTERVAL / (steps - 0.5) / (s * whole["solver.stability_bound"])
    net = Instance(MODEL, {"net": shape, "gravity": "none", **terms}, scaled, tables).initialise()
    found = []
    for before, instant in zip((0.0, *INSTANTS), INSTANTS, strict=False):
        net.step(s * (instant - before))
        found.append(net["mouth.area_ratio"])
    return np.array(found)


def row(shape: str) -> dict[str, object]:
    """Largest differences of a shape, per cent of the flat net's area, by s; of the twin at the first s."""
    whole = curve(shape, 1.0)
    off = {f"{s:.4g}": 100.0 * float(np.abs(curve(shape, s) - whole).max()) for s in SIZES}
    twin = 100.0 * float(np.abs(curve(shape, SIZES[0], 2) - whole).max())
    told: dict[str, object] = {"shape": shape, "largest": 100.0 * float(whole.max()), "off": off, "twin": twin}
    if shape != "table":
        told["same bits"] = bool((curve(shape, SIZES[0], alike=True) == whole).all())
    return told


def main(shapes: list[str]) -> None:
    kept = {one["shape"]: one for one in json.loads(RESULT.read_text())["rows"]} if RESULT.exists() else {}
    for shape in shapes or SHAPES:
        kept[shape] = row(shape)
        print(kept[shape], flush=True)
        result = {"command": COMMAND, "version": version("dcone-cosim"), "rows": list(kept.values())}
        RESULT.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main(sys.argv[1:])
