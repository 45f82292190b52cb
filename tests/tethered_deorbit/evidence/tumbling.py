"""Energy that an undamped pair loses in a day of tugs without a field, of a point and of a target that tumbles.

    python -m tests.tethered_deorbit.evidence.tumbling

makes `tumbling.json` again: a row for each scheme and choice of tolerances, in some minutes, most of them `radau`'s.
"""

from __future__ import annotations

import json
import math
from importlib.metadata import version
from pathlib import Path
from typing import Any

from tests.tethered_deorbit.evidence.schemes import run, tolerances

RESULT = Path(__file__).with_name("tumbling.json")
COMMAND = "python -m tests.tethered_deorbit.evidence.tumbling"
OWN = 0.155
"""Energy of the relative motion of Table 2's pair, to which the pair's speed here is set [J]."""
SPEED = math.sqrt(2.0 * OWN / (2000.0 * 1000.0 / 3000.0) / 0.98)
START: dict[str, Any] = {
    "start.condition": 3,
    "tether.damping_ratio": 0.0,
    "start_relative_position": (6.0, 7.0, 0.0),
    "start_relative_velocity": (0.5 * SPEED, 0.8 * SPEED, 0.3 * SPEED),
}
TUMBLING: dict[str, Any] = {
    "target_inertia": (6666.7, 2666.7, 6666.7, 0.0, 0.0, 0.0),
    "target_attachment": (0.0, -1.0, 0.0),
    "target_start_rate": tuple(math.radians(rate) for rate in (1.0, 2.0, 4.5)),
}
CASES = (("dop853", 1.0), ("dop853", 0.1), ("dop853", 0.01), ("gauss", 1.0), ("radau", 1.0))


def row(target: str, scheme: str, factor: float) -> dict[str, Any]:
    """What a day of tugs takes off a target of this kind, with all tolerances by a factor [J]."""
    given = START if target == "point" else START | TUMBLING
    terms, values = {"environment": "none", "target": target}, given | tolerances(factor)
    begin = run(scheme, terms, values, 0.0, 60.0)["energy.relative"]
    i = run(scheme, terms, values, 86400.0, 60.0)
    change = i["energy.relative"] - begin
    return {
        "target": target,
        "scheme": scheme,
        "tolerances": factor,
        "change_J": float(f"{change:.2e}"),
        "of_all": float(f"{change / begin:.2e}"),
        "of_relative_motion": float(f"{change / OWN:.2e}"),
        "tugs": int(i["tether.tug_count"]),
        "steps": int(i["solver.steps"]),
    }


def main() -> None:
    """Every row is stored as soon as it is there."""
    stamp = {"command": COMMAND, "version": {name: version(name) for name in ("dcone-cosim", "numba", "numpy")}}
    rows: list[dict[str, Any]] = []
    for target in ("point", "rigid"):
        for scheme, factor in CASES:
            rows.append(row(target, scheme, factor))
            print(rows[-1], flush=True)
            RESULT.write_text(json.dumps(stamp | {"rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
