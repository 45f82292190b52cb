"""Quantile functions against scipy, and what makes no distribution."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from dcone_cosim.campaign import distributions
from dcone_cosim.campaign.distributions import KINDS, Unfit, chooser, of_scipy

AT = (1e-6, 0.01, 0.2, 0.5, 0.9, 0.999)
S2 = math.log1p(0.25)


@pytest.mark.parametrize(
    ("word", "given", "reference"),
    [
        ("normal", {"mean": 3.0, "deviation": 0.5}, stats.norm(3.0, 0.5)),
        ("normal", {"mean": 3.0, "deviation": 0.5, "least": 2.0, "most": 3.2}, stats.truncnorm(-2.0, 0.4, 3.0, 0.5)),
        ("lognormal", {"mean": 2.0, "deviation": 1.0}, stats.lognorm(math.sqrt(S2), scale=2.0 * math.exp(-0.5 * S2))),
        ("uniform", {"least": -1.0, "most": 4.0}, stats.uniform(-1.0, 5.0)),
        ("triangular", {"least": 1.0, "likeliest": 2.0, "most": 5.0}, stats.triang(0.25, 1.0, 4.0)),
    ],
)
def test_quantiles(word: str, given: dict[str, float], reference: stats.rv_continuous) -> None:
    quantile = KINDS[word].make(given)
    np.testing.assert_allclose([quantile(u) for u in AT], reference.ppf(AT), rtol=1e-10)


def test_lognormal_has_the_mean_and_deviation_it_is_told() -> None:
    quantile = KINDS["lognormal"].make({"mean": 2.0, "deviation": 1.0})
    values = np.array([quantile(u) for u in (np.arange(20000) + 0.5) / 20000])
    assert (values.mean(), values.std()) == pytest.approx((2.0, 1.0), rel=0.01)


def test_of_scipy() -> None:
    kind = of_scipy("weibull_min")
    assert kind is not None
    assert (kind.needs, kind.pure) == (("c", "loc", "scale"), ("c",))
    quantile = kind.make({"c": 2.0, "loc": 1.0, "scale": 3.0})
    assert quantile(0.3) == pytest.approx(1.0 + 3.0 * math.sqrt(-math.log(0.7)), rel=1e-12)
    assert of_scipy("binom") is None
    assert of_scipy("norml") is None


@pytest.mark.parametrize(
    ("word", "given", "name"),
    [
        ("normal", {"mean": 1.0, "deviation": 0.0}, "deviation"),
        ("normal", {"mean": 0.0, "deviation": 1.0, "least": 2.0, "most": 1.0}, "most"),
        ("normal", {"mean": 0.0, "deviation": 1.0, "least": 50.0, "most": 51.0}, "least"),
        ("lognormal", {"mean": -1.0, "deviation": 1.0}, "mean"),
        ("uniform", {"least": 1.0, "most": 1.0}, "most"),
        ("triangular", {"least": 1.0, "likeliest": 0.5, "most": 2.0}, "likeliest"),
    ],
)
def test_what_makes_none(word: str, given: dict[str, float], name: str) -> None:
    with pytest.raises(Unfit) as error:
        KINDS[word].make(given)
    assert error.value.name == name


def test_choosing() -> None:
    """Each value as often as its weight says; one of no weight never, at the last end either."""
    choose = chooser([1.0, 3.0, 0.0])
    assert [choose(u) for u in (1e-9, 0.2499, 0.2501, 1.0 - 1e-16)] == [0, 0, 1, 1]
    for weights in ([-1.0, 2.0], [0.0, 0.0], [math.nan, 1.0]):
        with pytest.raises(Unfit):
            chooser(weights)


def test_names_are_all_there() -> None:
    assert {"normal", "discrete", "weibull_min"} <= set(distributions.names())
