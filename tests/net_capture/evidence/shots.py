"""Shots of mixed aim, followed for over a minute: does what is called captured stay in the net?

    python -m tests.net_capture.evidence.shots [HOW_MANY]

makes `captures.json` again. Four of five shots are at Table 1's scene, the fifth at the mission's; aim, roll, distance,
spin of the target and jitter are drawn anew for each. The share of 8/9 was chosen with 200 shots of another seed, and
once raised after the first shots of this one, with a cord that ran through no rings: 21 of its 157 captures were lost
within a minute. The quarter of a second was asked for after these very shots, through rings, had lost 1 of 191: that
none is lost with it is no independent proof, that one in a hundred is not, is.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterable, Mapping
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import binomtest

from fmu_src.instance import Instance
from fmu_src.interface import Value
from fmu_src.net_capture.composition import Composition
from fmu_src.net_capture.enclosure import make_encloses, make_share
from fmu_src.net_capture.interface import MODEL, OUTCOMES
from fmu_src.net_capture.quality import make_quality

RESULT = Path(__file__).with_name("captures.json")
COMMAND = "python -m tests.net_capture.evidence.shots"
SEED = 2026
SHOTS = 200
LOOK = 0.1
"""Seconds between two looks at a shot."""
MINUTE = 60.0
END = 95.0
"""Seconds from the shot for which every shot is followed at most: the latest captures are seen for a minute."""

TABLE_1 = {
    "net": "square",
    "gravity": "none",
    "target": "box",
    "contact": "inelastic",
    "closing": "winches",
    "nodes": "625",
}
"""Terms of the scene, and so kernels that a test run compiles for it anyway; here no node is looked at."""
MISSION = {**TABLE_1, "gravity": "hill", "tether": "slack"}
MISSION_VALUES: Mapping[str, Value] = {
    "net.side": 12.0,
    "net.mesh": 0.5,
    "net.mass": 0.84,
    "net.fold_side": 0.4,
    "bullets.mass": 1.27,
    "closing.stall_force": 6.0,
    "tether.length": 100.0,  # long enough never to come taut
    "target.size[1]": 2.5,
    "target.size[2]": 3.9,
    "target.size[3]": 2.5,
}

NOTHING: Mapping[str, Value] = {}


@cache
def make_looks(gravity: str) -> tuple[Any, Any, Any]:
    """Kernels that say how much of the target is inside, whether a point is, and how far the bullets are beyond one."""
    parts = Composition(MODEL, MODEL.interface(MISSION if gravity == "hill" else TABLE_1).terms)
    return make_share(parts), make_encloses(parts.memory), make_quality(parts).beyond


def draw(number: int, seed: int = SEED) -> tuple[dict[str, str], dict[str, Value], dict[str, Any]]:
    """Terms and parameters of a shot, and what was drawn for it, in degrees and metres."""
    generator = np.random.default_rng([seed, number])
    mission = number % 5 == 4
    reach, closing_at, lead = (12.0, 6.4, -0.006) if mission else (20.0, 11.2, 0.0)
    distance = reach * generator.uniform(0.86, 1.14)
    tilt, way, roll = generator.uniform(0.0, 14.0), generator.uniform(0.0, 360.0), generator.uniform(0.0, 90.0)
    spin = generator.normal(size=3)
    spin *= generator.uniform(0.0, 3.0) / np.linalg.norm(spin)
    across = math.tan(math.radians(tilt))
    axis = (lead + across * math.cos(math.radians(way)), 1.0, across * math.sin(math.radians(way)))
    values: dict[str, Value] = {
        **(MISSION_VALUES if mission else {}),
        "closing.time": closing_at * distance / reach,
        "chaser.start_position[2]": -distance,
        "shot.roll": math.radians(roll),
        "solver.seed": int(generator.integers(1, 10**6)),
    }
    for i in range(3):
        values[f"shot.axis[{i + 1}]"] = axis[i]
        values[f"target.start_rate[{i + 1}]"] = math.radians(float(spin[i]))
        values[f"solver.jitter[{i + 1}]"] = 1e-6
    drawn = {"scene": "mission" if mission else "table1", "tilt": tilt, "distance": distance, "roll": roll}
    drawn["spin"] = float(np.linalg.norm(spin))
    return (MISSION if mission else TABLE_1), values, {k: v if k == "scene" else round(v, 2) for k, v in drawn.items()}


def follow(number: int, seed: int = SEED, end: float = END, changes: Mapping[str, Value] = NOTHING) -> dict[str, Any]:
    """One shot until a minute after its capture, or until all of the target has been out for five seconds.

    `centre_only` is the rule of version 0.2.0: captured at the first look at which the cord is shorter than the girth,
    the bullets are beyond the target's centre and that centre is inside; taken back once it is not.
    """
    terms, values, row = draw(number, seed)
    shot = Instance(MODEL, terms, {**values, **changes}).initialise()
    row |= {"number": number, "cord_short": None, "held_at_end": None}
    old: dict[str, Any] = {"captured": None, "lost": None}
    share_inside, encloses, beyond = make_looks(terms["gravity"])
    failed, empty, share, looks = False, 0, math.nan, 0
    while shot.time < end - 1e-9:
        looks += 1
        shot.step(looks * LOOK - shot.time)
        if not (shot["closing.t_start"] >= 0.0 and shot["mouth.cord_length"] < shot["mouth.girth"]):
            continue
        record, centre = shot.record.view(np.recarray)[0], shot.array("target_place")
        inside = encloses(record, shot.work, centre)
        if row["cord_short"] is None:
            row["cord_short"] = round(shot.time, 2)
            failed = not (inside and beyond(record, shot.work, centre) > 0.0)
            old["captured"] = None if failed else round(shot.time, 2)
        elif not inside and not failed:
            failed, old["lost"] = True, round(shot.time, 2)
        share = share_inside(record, shot.work)
        empty = empty + 1 if share == 0.0 else 0
        if empty * LOOK >= 5.0 or 0.0 <= shot["t_capture"] < shot.time - (MINUTE + 1.0):
            break
    captured, lost = shot["t_capture"], shot["t_lost"]
    row |= {
        "outcome": OUTCOMES[int(shot["outcome"])],
        "captured": None if captured < 0.0 else round(captured, 2),
        "inside_at_capture": round(shot["enclosure.at_capture"], 3) if captured >= 0.0 else None,
        "least_inside_since": round(shot["enclosure.least"], 3) if captured >= 0.0 else None,
        "lost": None if lost < 0.0 else round(lost, 2),
        "inside_at_end": None if math.isnan(share) else round(share, 3),
        "end": round(shot.time, 2),
        "held_at_end": bool(share >= 0.5),
        "centre_only": old,
    }
    return row


def proportion(part: int, whole: int) -> dict[str, Any]:
    """A count with its 95 % interval (Clopper and Pearson)."""
    interval = binomtest(part, whole).proportion_ci(0.95, "exact")
    return {"count": part, "of": whole, "interval": [round(interval.low, 4), round(interval.high, 4)]}


def within(row: Mapping[str, Any], seconds: float) -> bool:
    """Whether a capture was taken back within so many seconds."""
    return row["lost"] is not None and row["lost"] - row["captured"] <= seconds


def summarise(rows: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    rows = list(rows)
    taken = [r for r in rows if r["captured"] is not None]
    good = [r for r in rows if r["held_at_end"]]
    old = [r["centre_only"] for r in rows if r["centre_only"]["captured"] is not None]
    late = [max(0.0, r["captured"] - r["cord_short"]) for r in taken if r["held_at_end"]]
    return {
        "shots": len(rows),
        "captured": len(taken),
        "taken_back_within_30_s": proportion(sum(within(r, 30.0) for r in taken), len(taken)),
        "taken_back_within_60_s": proportion(sum(within(r, MINUTE) for r in taken), len(taken)),
        "hold_to_the_end": len(good),
        "hold_but_refused": sum(r["captured"] is None for r in good),
        "later_than_cord_short_s": {
            name: round(float(np.quantile(late, part)), 2) if late else None
            for name, part in (("half", 0.5), ("nine_of_ten", 0.9), ("all", 1.0))
        },
        "centre_only_rule": {
            "captured": len(old),
            "taken_back_within_30_s": proportion(
                sum(o["lost"] is not None and o["lost"] - o["captured"] <= 30.0 for o in old), len(old)
            ),
            "taken_back_within_60_s": proportion(
                sum(o["lost"] is not None and o["lost"] - o["captured"] <= MINUTE for o in old), len(old)
            ),
        },
    }


def write(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Store the result of the shots so far, a row on each line."""
    result = {
        "command": COMMAND,
        "version": {name: version(name) for name in ("dcone-cosim", "numba", "numpy")},
        "seed": SEED,
        "summary": summarise(rows),
    }
    head = json.dumps(result, indent=1).removesuffix("\n}")
    lines = ",\n".join(json.dumps(row) for row in rows)
    RESULT.write_text(f'{head},\n "rows": [\n{lines}\n ]\n}}\n')
    return result


def main(how_many: int = SHOTS) -> dict[str, Any]:
    """Follow so many shots; the result is stored after each, so that a run may be cut short."""
    rows: list[dict[str, Any]] = []
    result: dict[str, Any] = {}
    with ProcessPoolExecutor() as pool:
        for row in pool.map(follow, range(how_many)):
            rows.append(row)
            print(json.dumps(row), flush=True)
            result = write(rows)
    print(json.dumps(result["summary"], indent=1))
    return result


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
