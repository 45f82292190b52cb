"""What each term of contact changes in the outcome of Table 1's capture, and how often `captured` and the CQI disagree.

    python -m tests.net_capture.evidence.contact_terms [HOW_MANY [CHOICE ...]]

makes `contact_terms.json` again, some six CPU-seconds a shot; with choices named, these alone and what is not there
yet, and of the others every tenth shot, which must come out as it is stored. `lines` are the rows of the table in the
net's README. Every shot is drawn once, with
the launch errors of `launches` (speed and angle of each bullet off by a standard deviation of 1 %), and is followed for
20 s with each choice of terms, on meshes of 2 m. What is told is the mean over all shots, and the mean difference from
the first choice shot by shot with its standard error. `envelope` takes the sphere round the box for the box, with the
box's mass and inertia.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from fmu_src.instance import Instance
from fmu_src.interface import Value
from fmu_src.net_capture.interface import MODEL, OUTCOMES
from tests import kernels
from tests.net_capture.evidence.launches import ANGLE, ERROR, SEED, SPEED
from tests.net_capture.evidence.launches import TERMS as LAUNCHED

RESULT = Path(__file__).with_name("contact_terms.json")
COMMAND = "python -m tests.net_capture.evidence.contact_terms"
VERSION = {name: version(name) for name in ("dcone-cosim", "numba", "numpy")}
SHOTS, MESH, END, LATE, STEP = 100, 2.0, 20.0, 2.0, 0.5
MASS, SIZE = 1000.0, (4.0, 8.0, 4.0)
TERMS = {**LAUNCHED, "quality": "plain"}
THRESHOLDS = (0.5, 0.6, 0.7, 0.8, 1.0, 1.2, 1.5, 2.0)

Choice = tuple[Mapping[str, str], Mapping[str, Value]]
AROUND = 0.5 * math.hypot(*SIZE)
BALL: Mapping[str, Value] = {
    "target.radius": AROUND,
    **{f"target.principal_inertia[{i + 1}]": MASS / 12.0 * (math.hypot(*SIZE) ** 2 - SIZE[i] ** 2) for i in range(3)},
}
CHOICES: Mapping[str, Choice] = {
    "law A": ({}, {}),
    "law A, envelope": ({"target": "sphere"}, BALL),
    "law A, wrap": ({"wrap": "plain"}, {}),
    "law A, wrap with friction": ({"wrap": "friction"}, {}),
    "law B, no friction": ({"contact": "penalty"}, {"contact.friction": 0.0}),
    "law B": ({"contact": "penalty"}, {}),
}


def draw(number: int) -> dict[str, Value]:
    """Launch errors of a shot, those of `launches`."""
    random = np.random.default_rng([SEED, number])
    speeds, angles = ERROR * SPEED * random.normal(size=4), ERROR * ANGLE * random.normal(size=4)
    values: dict[str, Value] = {"target.start_rate[3]": math.radians(1.0), "net.mesh": MESH}
    for i in range(4):
        values[f"ejection.speed_error[{i + 1}]"] = float(speeds[i])
        values[f"ejection.angle_error[{i + 1}]"] = float(angles[i])
    return values


def follow(number: int, choice: str) -> dict[str, Any]:
    """One shot to its end with one choice of terms."""
    terms, given = CHOICES[choice]
    shot = Instance(MODEL, {**TERMS, **terms}, {**draw(number), **given}).initialise()
    index = []
    while shot.time < END - 1e-9:
        shot.step(STEP)
        index.append(shot["quality.index"])
    wraps = "wrap" in terms
    row = {
        "number": number,
        "choice": choice,
        "captured": bool(shot["captured"]),
        "outcome": OUTCOMES[int(shot["outcome"])],
        "t_capture": shot["t_capture"] if shot["t_capture"] >= 0.0 else math.nan,
        "inside": shot["enclosure.share"],
        "index": float(np.mean(index[-round(LATE / STEP) :])),
        "impulse": MASS * float(np.linalg.norm(shot.array("target_velocity"))),
        "thread": shot["thread.tension_max"],
        "cord": shot["cord.tension_max"],
        "contact_loss": shot["contact.loss"],
        "remainder": shot["energy.remainder"],
        "passed": shot["wrap.passed"] + shot["wrap.passed_slack"] if wraps else 0,
        "friction_loss": shot["wrap.friction_loss"] if terms.get("wrap") == "friction" else 0.0,
    }
    return {name: round(value, 4) if isinstance(value, float) else value for name, value in row.items()}


TOLD = ("t_capture", "inside", "index", "impulse", "thread", "cord", "contact_loss", "remainder", "friction_loss")


def mean(values: Sequence[float]) -> dict[str, float]:
    """Mean of what is known of them and its standard error."""
    known = np.array([value for value in values if not math.isnan(value)])
    if len(known) < 2:
        return {"known": len(known)}
    error = float(known.std(ddof=1)) / math.sqrt(len(known))
    return {"mean": round(float(known.mean()), 4), "error": round(error, 4), "known": len(known)}


def summarise(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Every choice by itself, and against the first."""
    of = {choice: [row for row in rows if row["choice"] == choice] for choice in CHOICES}
    base = next(iter(of.values()))
    found: dict[str, Any] = {}
    for choice, shots in of.items():
        both = list(zip(base, shots, strict=False))
        found[choice] = {
            "captured": sum(row["captured"] for row in shots),
            "captured_otherwise": sum(one["captured"] != other["captured"] for one, other in both),
            "passed": sum(row["passed"] for row in shots),
            "disagree": {
                str(threshold): sum(row["captured"] != (row["index"] < threshold) for row in shots)
                for threshold in THRESHOLDS
            },
            **{name: mean([row[name] for row in shots]) for name in TOLD},
            "difference": {name: mean([other[name] - one[name] for one, other in both]) for name in TOLD},
        }
    return found


TABLE = (("t_capture", "s", 3), ("index", "", 3), ("impulse", "N s", 1), ("thread", "N", 0), ("cord", "N", 0))
TABLE += (("contact_loss", "J", 1),)
"""What the README's table has of them: name, unit, and digits behind the point."""
TABLE_THRESHOLDS = ("0.6", "0.7", "0.8", "1.0")


def lines(summary: Mapping[str, Any], shots: int) -> list[str]:
    """The rows of the README's table: means of the first choice, and of the others how they differ from it."""
    found = []
    for choice, told in summary.items():
        first = not found
        values, sign = (told, "") if first else (told["difference"], "+")
        cells = [
            f"{values[name]['mean']:{sign}.{digits}f} +- {values[name]['error']:.{digits}f} {unit}".strip()
            for name, unit, digits in TABLE
        ]
        disagree = ", ".join(str(told["disagree"][threshold]) for threshold in TABLE_THRESHOLDS)
        name = f"{choice}, as it is" if first else f"{choice}, less that"
        cells = [name, f"{told['captured']} of {shots}", *cells, str(told["passed"]), disagree]
        found.append(f"| {' | '.join(cells)} |")
    return found


def write(rows: Sequence[Mapping[str, Any]], kept: Mapping[str, Any]) -> dict[str, Any]:
    """Store the shots that were followed with every choice, a row on each line."""
    shots = len(rows) // len(CHOICES)
    rows = rows[: shots * len(CHOICES)]
    result = {
        "command": COMMAND,
        "version": VERSION,
        "kept": kept,
        "seed": SEED,
        "shots": shots,
        "summary": summarise(rows),
    }
    head = json.dumps(result, indent=1).removesuffix("\n}")
    lines = ",\n".join(json.dumps(row) for row in rows)
    RESULT.write_text(f'{head},\n "rows": [\n{lines}\n ]\n}}\n')
    return result


def main(how_many: int = SHOTS, *anew: str) -> None:
    """Follow so many shots; what there is is stored after each, so that a run may be cut short.

    anew    choices; those stored of all others are kept, but for every tenth, which must come out as it is stored
    """
    stored = json.loads(RESULT.read_text()) if anew else {"rows": [], "version": {}}
    known = {(row["number"], row["choice"]): row for row in stored["rows"] if row["choice"] not in anew}
    kept = {"version": stored["version"], "rows": 0, "made_again": 0}
    rows: list[dict[str, Any]] = []
    for number in range(how_many):
        for choice in CHOICES:
            row = known.get((number, choice))
            if row is None:
                row = follow(number, choice)
            elif number % 10 == 0:
                assert row == follow(number, choice), f"{choice}, shot {number}: not as it is stored"
                kept["made_again"] += 1
            else:
                kept["rows"] += 1
            rows.append(row)
        print(number, [row["captured"] for row in rows[-len(CHOICES) :]], flush=True)
        write(rows, kept)


if __name__ == "__main__":
    kernels.alone()
    main(*map(int, sys.argv[1:2]), *sys.argv[2:])
