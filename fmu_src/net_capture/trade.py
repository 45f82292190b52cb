"""How the net trades accuracy for time: its substep, and pieces of thread."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fmu_src.net_capture.implied import substeps
from fmu_src.net_capture.interface import GROUPS
from fmu_src.trade import Rung

NUMERICS = ("solver", "precision")
BESIDE = ("substeps",)
PIECES = (2,)
"""Into how many times more pieces threads are cut."""


def rungs(values: Mapping[str, float], terms: Mapping[str, str]) -> list[Rung]:
    """Substeps by the scheme's own factors of its default one, as far as they are stable."""
    needs = _needs(terms)
    if terms.get("substeps") == "following" and not needs.follows:
        return []
    bound, enough = substeps(values, terms)
    sizes = [size for size in needs.factors if size * enough <= needs.steepest * bound]
    return [Rung(size, {"solver.step_ratio": size * enough / bound}) for size in sizes]


def whole(terms: Mapping[str, str]) -> bool:
    """Whether all that the scheme shows is meant, or the net's shape alone."""
    return bool(_needs(terms).whole)


def instead(terms: Mapping[str, str]) -> Mapping[str, str]:
    """Criteria that mean nothing with the scheme, and those that are asked in their place, see `schemes.Needs`."""
    found: Mapping[str, str] = _needs(terms).instead
    return found


def within(terms: Mapping[str, str]) -> Mapping[str, tuple[float, float]]:
    """Criteria that hold less closely with the scheme, see `schemes.Needs`, or in so few bits."""
    kept = GROUPS["precision"].terms[terms.get("precision", "double")].checks
    return {**kept.within, **_needs(terms).within}


def refinements(values: Mapping[str, float], terms: Mapping[str, str]) -> dict[str, list[Rung]]:
    """Threads cut into more pieces: the same net, nearer to a continuous one."""
    pieces = values["net.segments"]
    return {"pieces of a thread": [Rung(1.0 / n, {"net.segments": n * pieces}) for n in (1, *PIECES)]}


def _needs(terms: Mapping[str, str]) -> Any:
    """What the scheme says of itself."""
    return GROUPS["solver"].terms[terms.get("solver", "leapfrog")].checks
