"""How the net lies in its canister, by the name a scene gives it.

Whatever the pattern, no thread is longer than its rest length and no two nodes are in one place: a pattern maps the net
as it is meant to open, seen along the shot, to places no farther apart. The canister opens at the muzzle, and reaches
back from it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

Values = Mapping[str, float]


class Folding(NamedTuple):
    """Kernels of one folding.

    check(p) -> fault   whether the net, whose size is in the record, can be folded so; a fault code or 0
    fold(p, work)       positions of all nodes at the start, from their places in the net as meant, which stand in the
                        planes shown
    """

    check: Any
    fold: Any


class Checks(NamedTuple):
    """What a folding says before any build or run, of values by FMI name; `net` are the checks of the net.

    radius(values, net)    of the bullets from the shot's axis in the folded net    [m]
    volume(values)         of the canister; 0 for one that has no depth             [m3]
    """

    radius: Callable[[Values, Any], float]
    volume: Callable[[Values], float]


def foldings() -> dict[str, Any]:
    """Every folding's term, by name."""
    from fmu_src.net_capture.folding import accordion, flat, rolled, star

    return {"flat": flat.PART, "accordion": accordion.PART, "rolled": rolled.PART, "star": star.PART}
