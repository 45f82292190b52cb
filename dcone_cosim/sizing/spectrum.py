"""The load spectrum: tugs by size, and cycles by range and mean, counted by rainflow.

Turning points are not those of the recorded rows, between which tugs fall. From slack each tug rises to its peak,
exactly, however short it is; while the line stays taut over whole macro steps, the least and the largest tension that
the FMU tells of each follow; and then it is slack again. What swings more than once within a macro step is counted
once.

Source   rainflow counting, ASTM E1049-85, by the package `rainflow`
Checked  tests/sizing/test_spectrum.py
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

SAME = 1e-9
"""Share to which the peak of a tug and that of a macro step are the same [1]."""
CLASSES = 10
"""Into which the tugs are sorted, up to the largest."""


def turning_points(loads: Mapping[str, Any]) -> list[float]:
    """Tension [N] at each turn, in their order."""
    tugs, taut = loads["tugs"], loads.get("taut", [])
    begins = [time for time, _, _ in tugs]
    series = [0.0]
    for number, (begin, peak, _) in enumerate(tugs):
        until = begins[number + 1] if number + 1 < len(begins) else np.inf
        rows = [(least, most) for time, least, most in taut if begin < time <= until]
        if not any(most >= (1.0 - SAME) * peak for _, most in rows):
            series.append(peak)
        for pair in rows:
            series += pair if abs(pair[0] - series[-1]) <= abs(pair[1] - series[-1]) else pair[::-1]
        if np.isfinite(until) or not rows:
            series.append(0.0)
    return [value for i, value in enumerate(series) if i == 0 or value != series[i - 1]]


def cycles(points: Sequence[float]) -> list[tuple[float, float, float]]:
    """Range [N], mean [N] and count of each cycle; half a cycle counts 0.5."""
    import rainflow

    return [(size, mean, count) for size, mean, count, _, _ in rainflow.extract_cycles(points)]


def by_size(peaks: Sequence[float], most: float) -> list[tuple[float, float, int, int]]:
    """Classes of tugs: from [N], to [N], how many, and how many above its begin."""
    edges = np.linspace(0.0, most, CLASSES + 1)
    counts, _ = np.histogram(peaks, edges)
    above = np.cumsum(counts[::-1])[::-1]
    return [(float(a), float(b), int(n), int(m)) for a, b, n, m in zip(edges, edges[1:], counts, above, strict=False)]


def cycle_classes(found: Sequence[tuple[float, float, float]], most: float) -> list[tuple[float, float, float, float]]:
    """Classes of cycles: range from [N], to [N], cycles, and their mean tension [N]."""
    edges = np.linspace(0.0, most, CLASSES + 1)
    rows = []
    for a, b in pairwise(edges.tolist()):
        inside = [(mean, count) for size, mean, count in found if a < size <= b]
        number = sum(count for _, count in inside)
        mean = sum(mean * count for mean, count in inside) / number if number else float("nan")
        rows.append((float(a), float(b), number, mean))
    return rows
