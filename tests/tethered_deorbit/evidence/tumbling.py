"""Energy that an undamped pair loses in a day of tugs without a field, of a point and of a target that tumbles.

    python -m tests.tethered_deorbit.evidence.tumbling

prints a row for each scheme and choice of tolerances, in some minutes, most of them `radau`'s.
"""

from __future__ import annotations

import math
from typing import Any

from tests.tethered_deorbit.evidence.schemes import run, tolerances

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


def main() -> None:
    for target, given in (("point", START), ("rigid", START | TUMBLING)):
        for scheme, factor in CASES:
            terms, values = {"environment": "none", "target": target}, given | tolerances(factor)
            begin = run(scheme, terms, values, 0.0, 60.0)["energy.relative"]
            i = run(scheme, terms, values, 86400.0, 60.0)
            change = i["energy.relative"] - begin
            print(
                f"{target} {scheme} x {factor:g}: {change:.1e} J of {begin:.4g} J, {change / OWN:.1e} of {OWN} J; "
                f"{i['tether.tug_count']} tugs, {i['solver.steps']} steps",
                flush=True,
            )


if __name__ == "__main__":
    main()
