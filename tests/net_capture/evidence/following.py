"""Substeps that follow the net against fixed ones of the same margin: energy error, mouth, CPU time.

    python -m tests.net_capture.evidence.following [FILE] [HOW_MANY]

makes `following.json` again (or FILE beside it) and prints it as the table of the model's README, some minutes on one
core. The margin is `solver.step_ratio`, the substep over the bound; 0 is the default. Each row is of an ensemble of
jittered starts, fixed and following in turn, so that the ratio of their CPU times is one of neighbours. The energy
error is the largest remainder of the energy book over the energy of the shot; the mouth's is the largest difference of
the mean curves from that of fixed substeps at a quarter of the default, over the flat net's area, with the standard
error of the difference.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Mapping
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
import numpy.typing as npt

from dcone_cosim.scenes.reading import parse
from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL

RESULT = Path(__file__).with_name("following.json")
COMMAND = "python -m tests.net_capture.evidence.following"
SCENES: Mapping[str, tuple[str, tuple[str, ...], float, float]] = {
    "deployment, mesh 1 m": ("deployment", ("capture.net.mesh=1 m",), 8.0, 8.0),
    "mission": ("mission", (), 10.0, 5.0),
}
"""Scene, what is changed in it, how long it is run [s], and until when its mouth is compared [s]: then it is caught."""
MARGINS = (0.9, 0.6, 0.0, 0.1)
SEEDS = 3
LOOK = 0.25

Curve = npt.NDArray[np.float64]


def fly(terms: Mapping[str, str], values: Mapping[str, Any], seed: int, end: float) -> dict[str, Any]:
    """One start: mouth area [m2] at every look, largest remainder and energy of the shot [J], CPU time [s]."""
    jitter = {f"solver.jitter[{i}]": 1e-6 for i in (1, 2, 3)}
    net = Instance(MODEL, terms, {**values, **jitter, "solver.seed": seed}).initialise()
    shot, areas, left, began = net["energy.kinetic"], [], 0.0, time.process_time()
    for _ in range(round(end / LOOK)):
        net.step(LOOK)
        areas.append(net["mouth.area"])
        left = max(left, abs(net["energy.remainder"]))
    cpu = time.process_time() - began
    follows = "solver.margin_least" in net.interface.references
    return {
        "areas": np.array(areas),
        "energy": left / shot,
        "cpu": cpu,
        "steps": net["solver.steps"],
        "share": net["solver.substep"] / net["solver.stability_bound"],
        "margin": net["solver.margin_least"] if follows else net["solver.stability_bound"] / net["solver.substep"],
        "unexpected": net["solver.unexpected"] if follows else 0.0,
        "flat": net["mouth.area"] / net["mouth.area_ratio"],
    }


def mouth(runs: list[dict[str, Any]], exact: list[dict[str, Any]], looks: int) -> tuple[float, float]:
    """Largest difference of the mean curves, and its standard error, over the flat net's area [1]."""
    here, there = (np.array([run["areas"][:looks] for run in of]) for of in (runs, exact))
    difference = np.abs(here.mean(0) - there.mean(0))
    error = np.sqrt(here.var(0, ddof=1) / len(here) + there.var(0, ddof=1) / len(there))
    place = int(difference.argmax())
    return float(difference[place] / runs[0]["flat"]), float(error[place] / runs[0]["flat"])


def rows_of(name: str, seeds: int) -> list[dict[str, Any]]:
    """Every margin, fixed and following."""
    scene, changes, end, until = SCENES[name]
    text = files("dcone_cosim").joinpath("scenes", f"{scene}.toml").read_text(encoding="utf-8")
    main = parse(text, scene, scene, settings=changes).phases[0].main
    terms = {group: term for group, term in main.terms.items() if group != "nodes"}
    paces = {pace: terms | {"substeps": pace} for pace in ("fixed", "following")}
    for of in paces.values():
        Instance(MODEL, of, main.parameters).initialise()  # compiled before anything is timed
    usual = fly(terms, main.parameters, 1, LOOK)["share"]
    exact = [fly(terms, {**main.parameters, "solver.step_ratio": 0.25 * usual}, s, end) for s in range(1, seeds + 1)]
    rows = []
    for margin in MARGINS:
        values, runs = {**main.parameters, "solver.step_ratio": margin}, {pace: [] for pace in paces}
        for seed in range(1, seeds + 1):
            for pace, of in paces.items():
                runs[pace].append(fly(of, values, seed, end))
        fixed, following = runs["fixed"], runs["following"]
        pairs = list(zip(fixed, following, strict=True))
        row: dict[str, Any] = {"scene": name, "margin": margin, "share_of_bound": round(fixed[0]["share"], 3)}
        for pace, of in runs.items():
            error, standard_error = mouth(of, exact, round(until / LOOK))
            row[pace] = {
                "steps": round(median(run["steps"] for run in of)),
                "energy_percent": round(100.0 * max(run["energy"] for run in of), 3),
                "mouth_percent": round(100.0 * error, 3),
                "mouth_standard_error": round(100.0 * standard_error, 3),
                "margin_least": round(min(run["margin"] for run in of), 3),
                "unexpected": round(max(run["unexpected"] for run in of)),
            }
        row["steps_ratio"] = round(median(a["steps"] / b["steps"] for a, b in pairs), 3)
        row["cpu_ratio"] = round(median(a["cpu"] / b["cpu"] for a, b in pairs), 3)
        row["cpu_ratios"] = [round(a["cpu"] / b["cpu"], 3) for a, b in pairs]
        rows.append(row)
        print(json.dumps(row), flush=True)
    return rows


def table(rows: list[dict[str, Any]]) -> str:
    """As the model's README has it."""
    head = "| scene | `step_ratio` | energy error, fixed | following | least margin told | substeps | CPU time |"
    lines = [head, "| --- | --- | --- | --- | --- | --- | --- |"]
    for row in rows:
        margin = f"{row['margin']:g}" if row["margin"] else f"default, {row['share_of_bound']:.2g}"
        fixed, following = row["fixed"], row["following"]
        lines.append(
            f"| {row['scene']} | {margin} | {fixed['energy_percent']:.2g} % | {following['energy_percent']:.2g} % "
            f"| {following['margin_least']:.3g} | {row['steps_ratio']:.2f} | {row['cpu_ratio']:.2f} |"
        )
    return "\n".join(lines)


def main(name: str = RESULT.name, how_many: str = str(SEEDS)) -> dict[str, Any]:
    rows = [row for scene in SCENES for row in rows_of(scene, int(how_many))]
    result = {
        "command": COMMAND,
        "version": {name: version(name) for name in ("dcone-cosim", "numba", "numpy")},
        "seeds": int(how_many),
        "rows": rows,
    }
    RESULT.with_name(name).write_text(json.dumps(result, indent=1) + "\n")
    print(table(rows))
    return result


if __name__ == "__main__":
    main(*sys.argv[1:])
