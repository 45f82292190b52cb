"""How the net trades accuracy for time: its substep, and pieces of thread."""

from __future__ import annotations

from collections.abc import Mapping

from fmu_src.net_capture.implied import substeps
from fmu_src.net_capture.interface import GROUPS
from fmu_src.trade import Rung

NUMERICS = ("solver", "precision")
BESIDE = ("substeps",)
PIECES = (2,)
"""Into how many times more pieces threads are cut."""


def rungs(values: Mapping[str, float], terms: Mapping[str, str]) -> list[Rung]:
    """Substeps by the scheme's own factors of its default one, as far as they are stable."""
    needs = GROUPS["solver"].terms[terms.get("solver", "leapfrog")].checks
    if terms.get("substeps") == "following" and not needs.follows:
        return []
    bound, enough = substeps(values, terms)
    sizes = [size for size in needs.factors if size * enough <= needs.steepest * bound]
    return [Rung(size, {"solver.step_ratio": size * enough / bound}) for size in sizes]


def whole(terms: Mapping[str, str]) -> bool:
    """Whether all that the scheme shows is meant, or the net's shape alone."""
    return bool(GROUPS["solver"].terms[terms.get("solver", "leapfrog")].checks.whole)


def refinements(values: Mapping[str, float], terms: Mapping[str, str]) -> dict[str, list[Rung]]:
    """Threads cut into more pieces: the same net, nearer to a continuous one."""
    pieces = values["net.segments"]
    return {"pieces of a thread": [Rung(1.0 / n, {"net.segments": n * pieces}) for n in (1, *PIECES)]}
