"""What a value may be drawn from: a table of distributions, each by its quantile function.

A case takes its values from a point of the unit cube, u in (0, 1) for each, as x = F^-1(u). So every sampler works with
every distribution, and a value hangs on nothing but its own u.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from dcone_cosim.names import LONGEST

ALIKE = 0.75
"""How much like a name of scipy's a word must be spelt to be taken for it [1]."""
Quantile = Callable[[float], float]
Numbers = Mapping[str, float]


class Unfit(ValueError):
    """Parameters that make no distribution: names the parameter, and says what was expected of it."""

    def __init__(self, name: str, expected: str) -> None:
        super().__init__(expected)
        self.name = name


@dataclass(frozen=True)
class Kind:
    """A kind of distribution.

    needs    parameters that it must be given, in the unit of the value
    may      others that it may be given
    pure     those of both that are pure numbers
    make     `make(parameters)` gives its quantile function, SI; raises `Unfit`
    text     what it is, in a few words
    """

    needs: tuple[str, ...]
    may: tuple[str, ...]
    make: Callable[[Numbers], Quantile]
    text: str
    pure: tuple[str, ...] = ()


def _positive(given: Numbers, name: str) -> float:
    value = given[name]
    if not value > 0.0:
        raise Unfit(name, "must be greater than 0")
    return value


def _ordered(given: Numbers, *names: str) -> list[float]:
    values = [given[name] for name in names]
    for (one, low), (two, high) in zip(
        zip(names, values, strict=True), list(zip(names, values, strict=True))[1:], strict=False
    ):
        if not low <= high:
            raise Unfit(two, f"must not be less than {one}")
    if not values[0] < values[-1]:
        raise Unfit(names[-1], f"must be greater than {names[0]}")
    return values


def _bounds(given: Numbers) -> tuple[float, float]:
    low, high = given.get("least", -math.inf), given.get("most", math.inf)
    if not low < high:
        raise Unfit("most", "must be greater than least")
    return low, high


def normal(given: Numbers) -> Quantile:
    """Quantile of a normal distribution, cut off at `least` and `most` where these are given.

        x = m + s Phi^-1(Phi(a) + u (Phi(b) - Phi(a))),   a = (least - m)/s, b = (most - m)/s

    Checked  tests/campaign/test_distributions.py
    """
    from scipy.special import ndtr, ndtri

    mean, deviation = given["mean"], _positive(given, "deviation")
    low, high = _bounds(given)
    begin, end = float(ndtr((low - mean) / deviation)), float(ndtr((high - mean) / deviation))
    if not end > begin:
        raise Unfit("least", "nothing of the distribution is between least and most")
    return lambda u: min(max(mean + deviation * float(ndtri(begin + u * (end - begin))), low), high)


def lognormal(given: Numbers) -> Quantile:
    """Quantile of a lognormal distribution by its own mean and standard deviation.

        s^2 = ln(1 + (deviation/mean)^2),   mu = ln(mean) - s^2/2,   x = exp(mu + s Phi^-1(u))

    Checked  tests/campaign/test_distributions.py
    """
    from scipy.special import ndtri

    mean, deviation = _positive(given, "mean"), _positive(given, "deviation")
    squared = math.log1p((deviation / mean) ** 2)
    middle = math.log(mean) - 0.5 * squared
    return lambda u: math.exp(middle + math.sqrt(squared) * float(ndtri(u)))


def uniform(given: Numbers) -> Quantile:
    """Quantile of a uniform distribution.

    Checked  tests/campaign/test_distributions.py
    """
    low, high = _ordered(given, "least", "most")
    return lambda u: low + u * (high - low)


def triangular(given: Numbers) -> Quantile:
    """Quantile of a triangular distribution with its mode at `likeliest`.

    Checked  tests/campaign/test_distributions.py
    """
    low, mode, high = _ordered(given, "least", "likeliest", "most")
    share = (mode - low) / (high - low)

    def quantile(u: float) -> float:
        if u < share:
            return low + math.sqrt(u * (high - low) * (mode - low))
        return high - math.sqrt((1.0 - u) * (high - low) * (high - mode))

    return quantile


KINDS: dict[str, Kind] = {
    "normal": Kind(("mean", "deviation"), ("least", "most"), normal, "normal, cut off at least and most if given"),
    "lognormal": Kind(("mean", "deviation"), (), lognormal, "lognormal by its own mean and standard deviation"),
    "uniform": Kind(("least", "most"), (), uniform, "uniform between two ends"),
    "triangular": Kind(("least", "likeliest", "most"), (), triangular, "triangular with its mode at likeliest"),
}
"""By the word of a campaign file; `discrete` has values of its own, and any other is looked for in `scipy.stats`."""
DISCRETE = "discrete"


def of_scipy(name: str) -> Kind | None:
    """A continuous distribution of `scipy.stats`, its shapes pure numbers, `loc` and `scale` in the value's unit; None
    where there is none of that name.

    Checked  tests/campaign/test_distributions.py
    """
    from scipy import stats

    found = getattr(stats, name, None)
    if not isinstance(found, stats.rv_continuous):
        return None
    shapes = tuple(part.strip() for part in (found.shapes or "").split(",") if part.strip())

    def make(given: Numbers) -> Quantile:
        _positive(given, "scale")
        frozen: Any = found(*(given[shape] for shape in shapes), loc=given["loc"], scale=given["scale"])
        if math.isnan(float(frozen.ppf(0.5))):
            raise Unfit(shapes[0] if shapes else "scale", f"makes no {name} of scipy.stats")
        return lambda u: float(frozen.ppf(u))

    return Kind((*shapes, "loc", "scale"), (), make, f"{name} of scipy.stats", shapes)


def names() -> list[str]:
    """Every word there is."""
    from scipy import stats

    own = [*KINDS, DISCRETE]
    return own + [name for name in dir(stats) if isinstance(getattr(stats, name), stats.rv_continuous)]


def like(word: str) -> list[str]:
    """Words that one that is not known may have been meant for: our own, and of the hundred of scipy those alone that
    are nearly spelt so, since among so many some resemble any word by chance.

    Checked  tests/campaign/test_reading.py
    """
    own = [*KINDS, DISCRETE]
    return own + difflib.get_close_matches(word[:LONGEST], [one for one in names() if one not in own], 3, ALIKE)


def chooser(weights: Sequence[float]) -> Callable[[float], int]:
    """Which of several values a point takes: `chooser(weights)(u)` is its place.

    weights    of the values, of any sum [1]

    Checked  tests/campaign/test_distributions.py
    """
    if any(not weight >= 0.0 or not math.isfinite(weight) for weight in weights) or not sum(weights) > 0.0:
        raise Unfit("weights", "must be finite, none below 0, and not all 0")
    ends: npt.NDArray[np.float64] = np.cumsum(np.asarray(weights, dtype=float)) / math.fsum(weights)
    last = max(place for place, weight in enumerate(weights) if weight > 0.0)
    return lambda u: min(int(np.searchsorted(ends, u, side="right")), last)
