"""What many cases come to: mean and spread of figures, shares of outcomes, each with what is known of it.

Only cases that came to their end are averaged. Those that failed are counted beside, as is every figure that a case
lacks or that is no finite number.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from dcone_cosim.cases.rows import Row, unit_of
from dcone_cosim.errors import CAPTURE_FAILED
from dcone_cosim.findings import Reading, reading

CONFIDENCE = 0.95
PERCENTILES = (5.0, 50.0, 95.0)
MOST_TEXTS = 12
"""Different texts of one figure that are counted one by one."""


@dataclass(frozen=True)
class Spread:
    """A figure over many cases.

    count        cases whose figure is a finite number
    missing      cases that do not have it, or tell a text instead
    not_finite   cases for which it is NaN or infinite
    deviation    standard deviation of one case, with n - 1 in the denominator; NaN for one case
    interval     in which the mean lies, by Student's t, at `CONFIDENCE`
    percentiles  by percent, linear between the samples
    shown_in     unit in which a person reads the figure, "" for none of its own
    """

    unit: str
    count: int
    missing: int
    not_finite: int
    mean: float
    deviation: float
    interval: tuple[float, float]
    percentiles: Mapping[float, float]
    shown_in: str = ""

    @property
    def read(self) -> Reading:
        """The unit in which a person reads it."""
        return reading(self.unit, self.shown_in, self.mean)


@dataclass(frozen=True)
class Share:
    """How many cases of how many, and in which interval the probability lies, at `CONFIDENCE` (Wilson)."""

    count: int
    of: int
    interval: tuple[float, float]

    @property
    def share(self) -> float:
        return self.count / self.of


@dataclass(frozen=True)
class Summary:
    """An ensemble or a sweep as a whole.

    statuses   of all cases
    figures    over the cases that came to their end; over those whose capture failed, where that became of all
    texts      figures that are texts, over the same: how many cases tell which
    """

    cases: int
    succeeded: Share
    statuses: Mapping[str, Share]
    figures: Mapping[str, Spread] = field(default_factory=dict)
    texts: Mapping[str, Mapping[str, Share]] = field(default_factory=dict)


def share(count: int, of: int, confidence: float = CONFIDENCE) -> Share:
    """A share with Wilson's interval.

        (p + z^2/2n +- z sqrt(p (1 - p)/n + z^2/4n^2)) / (1 + z^2/n)

    Checked  tests/cases/test_statistics.py
    """
    from scipy.special import ndtri

    p, z = count / of, float(ndtri(0.5 + 0.5 * confidence))
    middle, half = p + z**2 / (2 * of), z * math.sqrt(p * (1.0 - p) / of + (z / (2 * of)) ** 2)
    low, high = ((middle + sign * half) / (1.0 + z**2 / of) for sign in (-1.0, 1.0))
    return Share(count, of, (max(low, 0.0) if count else 0.0, min(high, 1.0) if count < of else 1.0))


def spread(values: Sequence[Any], unit: str = "1", confidence: float = CONFIDENCE, *, shown_in: str = "") -> Spread:
    """Mean and spread of a figure; what is no number in `values` counts as missing.

    Checked  tests/cases/test_statistics.py
    """
    from scipy.special import stdtrit

    numbers = [float(value) for value in values if isinstance(value, int | float)]
    sample = np.array([number for number in numbers if math.isfinite(number)])
    count = len(sample)
    mean = deviation = math.nan
    interval = (math.nan, math.nan)
    percentiles = dict.fromkeys(PERCENTILES, math.nan)
    if count:
        mean = float(np.mean(sample))
        percentiles = dict(zip(PERCENTILES, np.percentile(sample, PERCENTILES).tolist(), strict=True))
    if count > 1:
        deviation = float(np.std(sample, ddof=1))
        half = float(stdtrit(count - 1, 0.5 + 0.5 * confidence)) * deviation / math.sqrt(count)
        interval = (mean - half, mean + half)
    missing, not_finite = len(values) - len(numbers), len(numbers) - count
    return Spread(unit, count, missing, not_finite, mean, deviation, interval, percentiles, shown_in)


def summarise(rows: Iterable[Row]) -> Summary:
    """What the rows come to."""
    rows = list(rows)
    good = [row for row in rows if row.complete] or [row for row in rows if row.exit_code == CAPTURE_FAILED]
    succeeded = sum(row.succeeded for row in rows)
    names = list(dict.fromkeys(name for row in good for name in row.figures))
    figures, texts = {}, {}
    for name in names:
        values = [row.figures.get(name) for row in good]
        if any(isinstance(value, int | float) for value in values):
            unit, shown_in = unit_of(good, name)
            figures[name] = spread(values, unit, shown_in=shown_in)
        told = Counter(value for value in values if isinstance(value, str))
        if 0 < len(told) <= MOST_TEXTS:
            texts[name] = {text: share(count, len(good)) for text, count in told.most_common()}
    statuses = Counter(row.status for row in rows)
    return Summary(
        len(rows),
        share(succeeded, len(rows)),
        {status: share(count, len(rows)) for status, count in statuses.most_common()},
        figures,
        texts,
    )
