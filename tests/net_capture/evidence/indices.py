"""How often `captured` and the capture quality index disagree: shots of mixed aim, followed to 30 s.

    python -m tests.net_capture.evidence.indices [HOW_MANY]

makes `indices.json` again. The shots are those of `shots`, with meshes twice as wide. No threshold of the index that
others call a capture could be had from an open source, so all are tried: below a threshold the index says caught, above
it not.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from fmu_src.instance import Instance
from fmu_src.net_capture.interface import MODEL, OUTCOMES
from tests.net_capture.evidence.shots import SEED, draw

RESULT = Path(__file__).with_name("indices.json")
COMMAND = "python -m tests.net_capture.evidence.indices"
SHOTS = 100
END, LOOK = 30.0, 0.5
"""Seconds from the shot, and between two looks."""
THRESHOLDS = (0.5, 0.6, 0.7, 0.8, 1.0, 1.2, 1.5, 2.0, 2.5, 3.0)


def follow(number: int) -> dict[str, Any]:
    """One shot to its end: what `captured` says of it then, and the index."""
    terms, values, row = draw(number)
    mesh = 1.0 if row["scene"] == "mission" else 2.0
    shot = Instance(MODEL, {**terms, "quality": "plain"}, {**values, "net.mesh": mesh}).initialise()
    index = []
    while shot.time < END - 1e-9:
        shot.step(LOOK)
        index.append(shot["quality.index"])
    late = index[-round(5.0 / LOOK) :]
    return row | {
        "number": number,
        "outcome": OUTCOMES[int(shot["outcome"])],
        "captured": bool(shot["captured"]),
        "inside_at_end": round(shot["enclosure.share"], 3),
        "index_at_capture": round(shot["quality.at_capture"], 3),
        "index": round(float(np.mean(late)), 3),
        "index_least": round(min(index), 3),
        "offset": round(shot["quality.offset"], 3),
    }


def disagreement(rows: Iterable[Mapping[str, Any]], threshold: float) -> dict[str, Any]:
    """How often the two disagree, by which says caught."""
    rows = list(rows)
    return {
        "threshold": threshold,
        "captured_alone": sum(r["captured"] and r["index"] >= threshold for r in rows),
        "index_alone": sum(not r["captured"] and r["index"] < threshold for r in rows),
    }


def write(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Store the result of the shots so far, a row on each line."""
    caught, lost = ([r["index"] for r in rows if r["captured"] == which] for which in (True, False))
    result = {
        "command": COMMAND,
        "version": {name: version(name) for name in ("dcone-cosim", "numba", "numpy")},
        "seed": SEED,
        "shots": len(rows),
        "captured": len(caught),
        "index_captured": [round(float(q), 3) for q in np.quantile(caught, (0.0, 0.5, 1.0))] if caught else [],
        "index_others": [round(float(q), 3) for q in np.quantile(lost, (0.0, 0.5, 1.0))] if lost else [],
        "disagreements": [disagreement(rows, threshold) for threshold in THRESHOLDS],
    }
    head = json.dumps(result, indent=1).removesuffix("\n}")
    lines = ",\n".join(json.dumps(row) for row in rows)
    RESULT.write_text(f'{head},\n "rows": [\n{lines}\n ]\n}}\n')
    return result


def main(how_many: int = SHOTS) -> dict[str, Any]:
    """Follow so many shots; the result is stored after each, so that a run may be cut short."""
    rows: list[dict[str, Any]] = []
    result: dict[str, Any] = {}
    for number in range(how_many):
        rows.append(follow(number))
        print(json.dumps(rows[-1]), flush=True)
        result = write(rows)
    return result


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
