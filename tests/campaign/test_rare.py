"""Rare failures: subset sampling against a closed form, and its coefficient of variation against what it does."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.special import ndtr, ndtri

from dcone_cosim.campaign.rare import sentences, subset
from tests.campaign.conftest import spec_of

pytest.importorskip("openturns")
SIZE = 4
DRAWN = '[[dispersion]]\nkey = "removal.thrust.level"\ndistribution = "normal"\ndeviation = "5 %"\n'
BOUND = float(ndtri(1e-4))


def margins(points: np.ndarray) -> list[float]:
    """A linear margin: fails with a probability of 1e-4."""
    return list(ndtri(points).sum(axis=1) / math.sqrt(SIZE) - BOUND)


def test_one_in_ten_thousand() -> None:
    """Over 100 repetitions: no bias, and a coefficient of variation that is told is that which there is."""
    told = [subset(margins, SIZE, 400, seed) for seed in range(100)]
    found = np.array([one["failure"] for one in told])
    assert found.mean() == pytest.approx(1e-4, rel=3.0 * found.std() / 1e-4 / math.sqrt(100))
    variation = found.std(ddof=1) / found.mean()
    assert np.median([one["coefficient_of_variation"] for one in told]) == pytest.approx(variation, rel=0.35)
    logs = np.log(found / 1e-4)
    width = np.array([1.96 * one["coefficient_of_variation"] for one in told])
    assert 85 <= int(np.sum(np.abs(logs) <= width)) <= 100
    assert {one["levels"] for one in told} <= {3, 4, 5}


@pytest.mark.parametrize(("steps", "fails"), [(0.1, 0.0), (0.5, 0.0), (0.02, 0.001)])
def test_margins_of_few_values_have_no_probability(steps: float, fails: float) -> None:
    """Where one in a thousand fails, or none, and the rest are of two margins, 0.02 to 0.1 was told: the share of the
    nearer margin."""

    def margins_of(points: np.ndarray) -> list[float]:
        return [-0.1 if u < fails else 0.389 if u < steps else 0.5 for u in points[:, 0]]

    told = subset(margins_of, 3, 300, 2031)
    assert (told["failure"], told["coefficient_of_variation"]) == (None, None)
    assert told["thresholds"][-1] > 0.0
    (said,) = sentences(spec_of('success = { figure = "removal.largest_tug_peak", below = "50 N" }\n' + DRAWN), told)
    assert said.startswith("no probability of failing (removal.largest_tug_peak below 50 N is success): after ")


def test_the_same_again_and_what_has_no_figure() -> None:
    one, two = (subset(margins, SIZE, 200, 3) for _ in range(2))
    assert one == two

    def halves(points: np.ndarray) -> list[float]:
        """Half of the cubes have no figure at all: they count as failed."""
        return [math.nan if point[0] < 0.5 else 1.0 for point in points]

    assert subset(halves, 2, 400, 1)["failure"] == pytest.approx(0.5, abs=0.1)
    assert ndtr(BOUND) == pytest.approx(1e-4)
