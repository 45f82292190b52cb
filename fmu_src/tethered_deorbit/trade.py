"""How the tow trades accuracy for time: all three tolerances together."""

from __future__ import annotations

from collections.abc import Mapping

from fmu_src.tethered_deorbit.interface import SOLVER
from fmu_src.trade import Rung

LOOSEST = 0.1
"""Bound of a level's error that is never exceeded [1]."""
NUMERICS = ("solver",)
BESIDE: tuple[str, ...] = ()
DETAILS = ("level",)
BY_TOLERANCE = True
DISTURBED = frozenset({"oblateness", "air", "third_bodies", "sunlight", "electrodynamic"})
"""Groups that disturb an orbit."""
UNEVEN = frozenset({"burn", "engine", "plume", "release", "break", "aocs"})
"""Groups with which the work of the thrust is not that of one force on a pair that holds together."""
INTEGRALS = ("orbit", "jacobi", "jacobi_falls")
ALWAYS = "pushes"
"""A criterion that holds of every line."""
FACTORS = (1e6, 1e5, 1e4, 1e3, 1e2, 10.0, 1.0, 0.1, 0.01)
"""Of the tolerances over their defaults. The finest is for references: below it rounding is all that changes."""


BOUNDS = {"event_map": ("level.peak_error",), "averaged": ("level.peak_error", "level.average_tolerance")}
"""Of levels of detail: what they may err by, and go by the same factor. For references nothing is left to them."""


def rungs(values: Mapping[str, float], terms: Mapping[str, str]) -> list[Rung]:
    """All tolerances by one factor, each within its bounds, and those of a level of detail."""
    found = []
    for factor in FACTORS:
        chosen = {row.name: factor * float(row.starts()[0]) for row in SOLVER}
        settings = {row.name: min(max(chosen[row.name], row.minimum), row.maximum) for row in SOLVER}
        for name in BOUNDS.get(terms.get("level", ""), ()):
            settings[name] = min(factor * values[name], LOOSEST) if factor > FACTORS[-1] else 0.0
        found.append(Rung(factor, settings))
    return found


def whole(terms: Mapping[str, str]) -> bool:
    """All schemes show all."""
    return True


def instead(terms: Mapping[str, str]) -> Mapping[str, str]:
    """All criteria mean something with all schemes; an orbit that is disturbed keeps neither its axis nor the integral
    of the relative motion, without a field there is neither, and a line that is cut holds nothing.

    Checked  tests/stability/test_seeded_parts.py
    """
    found: dict[str, str] = {}
    free = terms.get("environment") == "none"
    even = terms.get("reel") == "locked" and terms.get("thrust", "along_track") == "along_track"
    kept = "work" if free and even and not UNEVEN & terms.keys() else ALWAYS
    if free or DISTURBED & terms.keys():
        found |= dict.fromkeys(INTEGRALS, kept)
    if "lumped" in terms:
        found |= dict.fromkeys(("longer", "snap"), kept if free else "jacobi")
    if "release" in terms:
        found |= dict.fromkeys(("longer", *INTEGRALS), ALWAYS)
    return found


def reference(terms: Mapping[str, str]) -> Mapping[str, str]:
    """All compute in 53 bits."""
    return {}


def within(values: Mapping[str, float], terms: Mapping[str, str]) -> Mapping[str, tuple[float, float]]:
    """All criteria hold alike with all schemes."""
    return {}


def refinements(values: Mapping[str, float], terms: Mapping[str, str]) -> dict[str, list[Rung]]:
    """None: the line is one piece."""
    return {}
