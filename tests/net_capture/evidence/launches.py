"""Table 1's capture with errors at the launch: how far the sequence of the paper's Fig. 3 scatters.

    python -m tests.net_capture.evidence.launches [HOW_MANY]

makes `launches.json` again. Speed and angle of each bullet are off by a standard deviation of 1 % of 3 m/s and of 40
deg, drawn anew for each shot. The last of the paper's pictures is at 15 s.
"""

from __future__ import annotations

import json
import math
import sys
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from fmu_src.instance import Instance
from fmu_src.interface import Value
from fmu_src.net_capture.interface import MODEL, OUTCOMES
from tests import kernels
from tests.net_capture.evidence.shots import TABLE_1

RESULT = Path(__file__).with_name("launches.json")
COMMAND = "python -m tests.net_capture.evidence.launches"
SEED, SHOTS, ERROR = 2027, 32, 0.01
END, LAST_PICTURE, STEP = 25.0, 15.0, 0.1
"""Seconds from the shot: of a run, of the paper's last picture, between two looks."""
TERMS = {name: term for name, term in TABLE_1.items() if name != "nodes"} | {"ejection": "4"}
SPEED, ANGLE = 3.0, math.radians(40.0)
TOLD = {
    "open": "mouth.t80",
    "touched": "contact.first_time",
    "widest": "mouth.t_max",
    "captured": "t_capture",
}


def follow(number: int) -> dict[str, Any]:
    """One shot, to its end or a second after its capture."""
    random = np.random.default_rng([SEED, number])
    speeds, angles = ERROR * SPEED * random.normal(size=4), ERROR * ANGLE * random.normal(size=4)
    values: dict[str, Value] = {"target.start_rate[3]": math.radians(1.0)}
    for i in range(4):
        values[f"ejection.speed_error[{i + 1}]"] = float(speeds[i])
        values[f"ejection.angle_error[{i + 1}]"] = float(angles[i])
    shot = Instance(MODEL, TERMS, values).initialise()
    row: dict[str, Any] = {"number": number, "short": None, "cord_at_15_s": math.nan, "inside_at_15_s": math.nan}
    while shot.time < END - 1e-9 and not 0.0 <= shot["t_capture"] < shot.time - 1.0:
        shot.step(STEP)
        if row["short"] is None and shot["mouth.cord_length"] < shot["mouth.girth"]:
            row["short"] = round(shot.time, 2)
        if abs(shot.time - LAST_PICTURE) < 0.5 * STEP:
            row["cord_at_15_s"] = round(shot["mouth.cord_length"], 3)
            row["inside_at_15_s"] = round(shot["enclosure.share"], 3)
    row |= {name: round(shot[output], 3) for name, output in TOLD.items()}
    return row | {"outcome": OUTCOMES[int(shot["outcome"])]}


def scatter(values: list[float]) -> dict[str, float]:
    """Mean, standard deviation, least and largest."""
    known = np.array(values)
    figures = {"mean": known.mean(), "deviation": known.std(ddof=1), "least": known.min(), "largest": known.max()}
    return {name: round(float(value), 3) for name, value in figures.items()}


def main(how_many: int = SHOTS) -> dict[str, Any]:
    """Follow so many shots, and store what they came to."""
    rows = []
    for number in range(how_many):
        rows.append(follow(number))
        print(json.dumps(rows[-1]), flush=True)
    taken = [row for row in rows if row["captured"] >= 0.0]
    result = {
        "command": COMMAND,
        "version": {name: version(name) for name in ("dcone-cosim", "numba", "numpy")},
        "seed": SEED,
        "error": ERROR,
        "shots": len(rows),
        "captured": len(taken),
        "cord_shorter_than_girth_by_15_s": sum(
            row["short"] is not None and row["short"] <= LAST_PICTURE for row in rows
        ),
        "captured_by_15_s": sum(row["captured"] <= LAST_PICTURE for row in taken),
        "times": {
            name: scatter([row[name] for row in taken]) for name in ("open", "touched", "widest", "short", "captured")
        },
        "cord_at_15_s": scatter([row["cord_at_15_s"] for row in rows]),
    }
    head = json.dumps(result, indent=1).removesuffix("\n}")
    lines = ",\n".join(json.dumps(row) for row in rows)
    RESULT.write_text(f'{head},\n "rows": [\n{lines}\n ]\n}}\n')
    return result


if __name__ == "__main__":
    kernels.alone()
    main(*map(int, sys.argv[1:]))
