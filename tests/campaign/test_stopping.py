"""The rule that ends a campaign: its interval holds the truth as often as it says, the stopping included."""

from __future__ import annotations

from itertools import pairwise, takewhile

import numpy as np
import pytest

from dcone_cosim.campaign.spec import Until
from dcone_cosim.campaign.stopping import FIRST, enough, half_width, looks, needed
from dcone_cosim.cases.statistics import share

HUNDREDTH = Until(0.95, 0.01, "95 % within 1 %")


def ended(random: np.random.Generator, p: float, until: Until) -> tuple[int, int]:
    """Successes and cases at which the rule ends one campaign."""
    good, before = 0, 0
    for number in looks():
        good, before = good + int(random.binomial(number - before, p)), number
        if enough(good, number, until):
            return good, number
    raise AssertionError


@pytest.mark.parametrize("p", [0.1, 0.95, 0.5])
def test_coverage_over_a_hundred_repetitions(p: float) -> None:
    """A 95 % interval holds 89 to 99 times."""
    random, held, cases = np.random.default_rng(18), 0, []
    for _ in range(100):
        good, number = ended(random, p, HUNDREDTH)
        found = share(good, number)
        assert half_width(found) <= 0.01
        held += found.interval[0] <= p <= found.interval[1]
        cases.append(number)
    assert 89 <= held <= 99
    assert np.mean(cases) == pytest.approx(1.96**2 * p * (1.0 - p) / 1e-4, rel=0.06)


@pytest.mark.parametrize("p", [0.001, 0.01, 0.1])
def test_coverage_of_many(p: float) -> None:
    """Over 3000: near 95 %, also where it ends early because nearly every case came out the same."""
    random, held = np.random.default_rng(19), 0
    for _ in range(3000):
        good, number = ended(random, p, HUNDREDTH)
        low, high = share(good, number).interval
        held += low <= p <= high
    assert 0.93 <= held / 3000 <= 0.99


def test_a_hasty_rule_does_not_hold() -> None:
    """The twin: looking after every case from the second on, with an interval that vanishes where all are alike."""
    random, held = np.random.default_rng(20), 0
    for _ in range(100):
        outcomes = random.random(20000) < 0.1
        sums = np.cumsum(outcomes)
        n = np.arange(1, 20001)
        share_of = sums / n
        half = 1.96 * np.sqrt(share_of * (1.0 - share_of) / n)
        at = int(np.argmax((half <= 0.01) & (n >= 2)))
        held += abs(share_of[at] - 0.1) <= max(half[at], 1e-12)
    assert held < 89


def test_looks_and_what_is_needed() -> None:
    found = list(takewhile(lambda number: number < 1000, looks()))
    assert found[:3] == [FIRST, 105, 111] == [100, 105, 111]
    assert all(later > earlier for earlier, later in pairwise(found))
    assert not enough(0, 0, HUNDREDTH)
    assert needed(900, 1000, HUNDREDTH, 10**6) == pytest.approx(3457, rel=0.02)
    assert needed(900, 1000, HUNDREDTH, 500) == 500
