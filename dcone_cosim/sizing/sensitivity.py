"""How the tugs change with each value: d ln peak / d ln x, by runs around the scene, with their scatter.

The slope is that of a straight line through ln peak over ln x. Its standard error tells how far the runs lie off that
line: a tow that bounces is near chaos, and where the error is as large as the slope, nothing but the error is known.

Checked  tests/sizing/test_sensitivity.py
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dcone_cosim.sizing.ground import Ground
from dcone_cosim.sizing.uncertain import Uncertain

REACH = 0.02
"""How far each value is moved, both ways [1]."""


@dataclass(frozen=True)
class Slope:
    """d ln peak / d ln x, and its standard error [1], of the first tug and of the largest."""

    name: str
    first: float
    first_error: float
    largest: float
    largest_error: float


def slope(shares: Sequence[float], peaks: Sequence[float]) -> tuple[float, float]:
    """Slope of ln peak over ln share, and its standard error [1]; NaN where a peak is none."""
    if len(peaks) < 3 or not all(peak > 0.0 for peak in peaks):
        return math.nan, math.nan
    x, y = np.log(shares), np.log(peaks)
    x = x - x.mean()
    found = float(x @ (y - y.mean()) / (x @ x))
    off = y - y.mean() - found * x
    return found, float(np.sqrt(off @ off / (len(x) - 2) / (x @ x)))


def moved(
    ground: Ground, uncertain: Sequence[Uncertain], steps: int
) -> dict[str, list[tuple[float, Mapping[str, float]]]]:
    """Of each number: shares of the scene's value, and the values then."""
    shares = np.linspace(1.0 - REACH, 1.0 + REACH, steps).tolist()
    found: dict[str, list[tuple[float, Mapping[str, float]]]] = {}
    for one in uncertain:
        names = list(one.ends[0])
        if one.smooth and any(ground.values.get(name) for name in names):
            found[one.label] = [(share, {name: share * ground.values[name] for name in names}) for share in shares]
    return found


def slopes(ground: Ground, uncertain: Sequence[Uncertain], steps: int) -> list[Slope]:
    """Slopes of all numbers that are uncertain, the steepest first."""
    plan = moved(ground, uncertain, steps)
    cases = [ground.case(values) for points in plan.values() for _, values in points]
    runs = iter(ground.run(cases, "sensitivities"))
    found = []
    for label, points in plan.items():
        of = [next(runs) for _ in points]
        shares = [share for share, _ in points]
        first = slope(shares, [run.tugs[0][1] if run.tugs else math.nan for run in of])
        largest = slope(shares, [run.peak for run in of])
        found.append(Slope(label, *first, *largest))
    return sorted(found, key=lambda one: -abs(one.largest) if math.isfinite(one.largest) else 0.0)
