"""Probabilities and percentiles: intervals that hold what they say."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import binom, norm

from dcone_cosim.campaign.answers import answers, distribution, percentile, required_diameters
from dcone_cosim.campaign.engine import Made
from dcone_cosim.cases.rows import Row, refused
from dcone_cosim.cases.statistics import share
from dcone_cosim.loading import load
from tests.campaign.conftest import spec_of

JUST = '[[dispersion]]\nkey = "removal.thrust.level"\ndistribution = "normal"\ndeviation = "5 %"\n'
BOUND = 'success = { figure = "removal.peak", below = "2 N" }\n' + JUST


def made(peaks: list[float]) -> list[Made]:
    return [
        Made(number, (0.0,), Row(str(number), "completed", 0, "", {"removal.peak": peak}, {"removal.peak": "N"}))
        for number, peak in enumerate(peaks, 1)
    ]


def test_shares() -> None:
    cases = [*made([1.0] * 30 + [3.0] * 10), Made(41, (0.0,), refused("41", "no"))]
    found = answers(spec_of(BOUND), cases, {})
    assert found.success == share(30, 40)
    assert found.bounds == (30 / 41, 31 / 41)
    assert (found.unanswered, found.cases) == ({"refused": 1}, 41)
    assert found.figures["removal.peak"].mean == 1.5


def test_a_grid_is_no_sample() -> None:
    spec = spec_of('sampler = "grid"\n' + BOUND)
    found = answers(spec, made([1.0, 3.0]), {})
    assert (found.success, dict(found.figures), found.good) == (None, {}, 1)


@pytest.mark.parametrize("percent", [5.0, 50.0, 95.0])
def test_intervals_of_percentiles_hold(percent: float) -> None:
    """Over 4000 samples of 100: at least as often as they say, whatever the distribution; and not always."""
    random, truth = np.random.default_rng(1), float(norm.ppf(percent / 100.0))
    low = high = 0
    for _ in range(4000):
        one = percentile(np.sort(random.normal(size=100)), percent, 0.95).interval
        low, high = low + (one[0] > truth), high + (one[1] < truth)
    exact = binom.cdf(
        [binom.ppf(0.025, 100, percent / 100.0) - 1, binom.ppf(0.975, 100, percent / 100.0)], 100, percent / 100
    )
    assert low / 4000 == pytest.approx(exact[0], abs=0.008)
    assert high / 4000 == pytest.approx(1.0 - exact[1], abs=0.008)
    assert low <= 4000 * 0.033
    assert high <= 4000 * 0.033


def test_too_few_cases_bound_nothing() -> None:
    found = distribution(list(range(20)), "N", 0, 0.95).percentiles[3]
    assert (found.percent, math.isnan(found.interval[1])) == (99.0, True)
    assert found.interval[0] == 18.0


@pytest.mark.parametrize(
    ("unit", "mean", "shown_in", "told"),
    [("rad/s", 0.1, "deg/s", 5.729578), ("m", 2e-3, "mm", 2.0), ("m", 2.0, "m", 2.0), ("N", 3.0, "N", 3.0)],
)
def test_a_page_has_figures_in_units_that_are_read(unit: str, mean: float, shown_in: str, told: float) -> None:
    found = distribution([0.9 * mean, 1.1 * mean], unit, 0, 0.95)
    assert found.shown_in.name == shown_in
    assert found.shown_in.from_si(found.mean) == pytest.approx(told, rel=1e-6)


def test_required_diameter() -> None:
    """Twice the diameter bears twice the tension: at the diameter required the margin is the factor of safety's."""
    base, spec = load("table2-deorbit"), spec_of(JUST)
    own = base.phases[0].setting("tether.diameter")
    assert own
    rows = [
        Row(str(n), "completed", 0, "", {"removal.line.margin_of_safety": margin})
        for n, margin in enumerate((1.0, 9.0))
    ]
    cases = [Made(number, (0.0,), row) for number, row in enumerate([*rows, refused("3", "no")], 1)]
    found = required_diameters(spec, base, ["removal.thrust.level"], cases)["removal.line.diameter_required"]
    assert found[:2] == pytest.approx([own, 0.2 * own], rel=1e-12)
    assert math.isnan(found[2])
    found = required_diameters(spec, base, ["removal.tether.diameter"], [Made(1, (2.0 * own,), rows[0])])[
        "removal.line.diameter_required"
    ]
    assert found == pytest.approx([2.0 * own], rel=1e-12)


def test_a_figure_that_is_the_same_but_for_rounding_does_not_vary() -> None:
    """It has no histogram: a bin of it would be narrower than a number is exact."""
    assert not distribution([3.0, 3.0 + 4e-16, 3.0], "s", 0, 0.95).varies
    assert not distribution([0.0, 0.0], "s", 0, 0.95).varies
    assert distribution([3.0, 3.0001], "s", 0, 0.95).varies
    assert not distribution([3.0], "s", 0, 0.95).varies
