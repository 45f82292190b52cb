"""Mean, spread and shares against numpy and scipy, and what is left out of them is counted."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from dcone_cosim.cases.rows import Row
from dcone_cosim.cases.statistics import share, spread, summarise
from dcone_cosim.errors import CAPTURE_FAILED


def test_spread_is_that_of_numpy_and_scipy() -> None:
    sample = np.random.default_rng(1).normal(3.0, 0.5, 40)
    found = spread(sample.tolist(), "N")
    interval = stats.t.interval(0.95, 39, loc=sample.mean(), scale=stats.sem(sample))
    assert (found.unit, found.count, found.missing, found.not_finite) == ("N", 40, 0, 0)
    assert found.mean == pytest.approx(sample.mean(), rel=1e-14)
    assert found.deviation == pytest.approx(sample.std(ddof=1), rel=1e-14)
    assert found.interval == pytest.approx(interval, rel=1e-12)
    assert found.percentiles == pytest.approx(dict(zip((5.0, 50.0, 95.0), np.percentile(sample, (5, 50, 95)))))  # noqa: B905


def test_the_interval_of_the_mean_holds_it_as_often_as_it_says() -> None:
    """Of 1000 samples of five, 950 within three standard deviations of that count, 21."""
    generator = np.random.default_rng(7)
    samples = generator.normal(2.0, 1.0, (1000, 5))
    held = sum(low <= 2.0 <= high for low, high in (spread(sample.tolist()).interval for sample in samples))
    assert 929 <= held <= 971


def test_by_hand() -> None:
    found = spread([1.0, 2.0, 3.0, 4.0])
    assert (found.mean, found.percentiles[50.0], found.percentiles[5.0]) == (2.5, 2.5, pytest.approx(1.15))
    assert found.deviation == pytest.approx(math.sqrt(5.0 / 3.0))


def test_what_is_no_number_is_counted_and_left_out() -> None:
    found = spread([1.0, math.nan, None, 3.0, math.inf, "not told", 2])
    assert (found.count, found.missing, found.not_finite, found.mean) == (3, 2, 2, 2.0)


@pytest.mark.parametrize("values", [[], [None], [math.nan]])
def test_nothing_to_average(values: list[float | None]) -> None:
    found = spread(values)
    assert found.count == 0
    assert all(math.isnan(x) for x in (found.mean, found.deviation, *found.interval, *found.percentiles.values()))


def test_one_value_has_no_spread() -> None:
    found = spread([3.0])
    assert (found.mean, found.percentiles[95.0]) == (3.0, 3.0)
    assert math.isnan(found.deviation)
    assert math.isnan(found.interval[0])


@pytest.mark.parametrize(
    ("count", "of"), [(0, 1), (1, 1), (0, 16), (16, 16), (1, 16), (7, 20), (190, 200), (1733, 1825)]
)
@pytest.mark.parametrize("confidence", [0.95, 0.99])
def test_shares_are_those_of_scipy(count: int, of: int, confidence: float) -> None:
    found = share(count, of, confidence)
    expected = stats.binomtest(count, of).proportion_ci(confidence, "wilson")
    assert found.interval == pytest.approx((expected.low, expected.high), abs=1e-12)
    assert found.share == count / of


def rows() -> list[Row]:
    outcomes, units = ("ended", "towed", "towed", "towed"), {"removal.x": "m"}
    good = [
        Row(str(n), "completed", 0, "", {"removal.x": float(n), "removal.outcome": outcome}, units)
        for n, outcome in enumerate(outcomes)
    ]
    lacking = Row("4", "completed", 0, "", {"removal.y": 1.0, "removal.x": "not told"})
    failed = Row("5", "FMU failed", 5, "it broke", {"removal.x": 1e9}, {"removal.x": "m"})
    return [*good, lacking, failed]


def test_failures_are_told_beside_and_averaged_with_nothing() -> None:
    found = summarise(rows())
    x, y = found.figures["removal.x"], found.figures["removal.y"]
    assert (x.mean, x.count, x.missing, x.unit) == (1.5, 4, 1, "m")
    assert (y.mean, y.count, y.missing) == (1.0, 1, 4)
    assert {status: one.count for status, one in found.statuses.items()} == {"completed": 5, "FMU failed": 1}
    assert (found.succeeded.count, found.succeeded.of) == (5, 6)
    outcomes = found.texts["removal.outcome"]
    assert {text: (one.count, one.of) for text, one in outcomes.items()} == {"towed": (3, 5), "ended": (1, 5)}


def test_all_failed() -> None:
    found = summarise(rows()[-1:])
    assert (found.figures, found.texts, found.succeeded.count) == ({}, {}, 0)


def test_where_every_capture_failed_their_figures_are_told() -> None:
    """A capture that failed is an answer; beside others that came to their end it is no part of their mean."""
    missed = [Row(f"m{x}", "capture failed", CAPTURE_FAILED, figures={"capture.area": x}) for x in (2.0, 4.0)]
    whole = Row("w", "completed", 0, figures={"capture.area": 9.0})
    assert summarise(missed).figures["capture.area"].mean == 3.0
    assert summarise([*missed, whole]).figures["capture.area"].mean == 9.0
    assert summarise([*missed, whole]).succeeded.count == 1
