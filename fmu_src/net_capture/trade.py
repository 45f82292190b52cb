"""How the net trades accuracy for time: its substep, and pieces of thread."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fmu_src.net_capture.implied import substeps
from fmu_src.net_capture.interface import GROUPS
from fmu_src.trade import Rung

NUMERICS = ("solver", "precision")
BESIDE = ("substeps",)
DETAILS: tuple[str, ...] = ()
BY_TOLERANCE = False
ROUNDED = {"energy_gained": "agrees", "energy_lost": "agrees", "energy_rises": "agrees"}
"""Work that is done along rounded ways is booked to nothing, the more the smaller the substep; no bound that is worth
telling follows from the bits alone, and whether it matters a run of 53 bits tells."""
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
    """Criteria that mean nothing with the scheme, or in so few bits, and those that are asked in their place, see
    `schemes.Needs`."""
    found: Mapping[str, str] = {**ROUNDED, **_needs(terms).instead} if _is_single(terms) else _needs(terms).instead
    return found


def reference(terms: Mapping[str, str]) -> Mapping[str, str]:
    """With 24 bits a run is compared with one of 53: more substeps are only more rounding."""
    return {"precision": "double"} if _is_single(terms) else {}


def _is_single(terms: Mapping[str, str]) -> bool:
    return terms.get("precision") == "single"


def within(values: Mapping[str, float], terms: Mapping[str, str]) -> Mapping[str, tuple[float, float]]:
    """Criteria that hold less closely with the scheme, see `schemes.Needs`."""
    bound, enough = substeps(values, terms)
    ratio = values["solver.step_ratio"]
    found: Mapping[str, tuple[float, float]] = _needs(terms).within(values, ratio * bound if ratio > 0.0 else enough)
    return found


def refinements(values: Mapping[str, float], terms: Mapping[str, str]) -> dict[str, list[Rung]]:
    """Threads cut into more pieces: the same net, nearer to a continuous one."""
    pieces = values["net.segments"]
    return {"pieces of a thread": [Rung(1.0 / n, {"net.segments": n * pieces}) for n in (1, *PIECES)]}


def _needs(terms: Mapping[str, str]) -> Any:
    """What the scheme says of itself."""
    return GROUPS["solver"].terms[terms.get("solver", "leapfrog")].checks
