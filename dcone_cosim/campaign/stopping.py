"""When a campaign has enough cases: once the interval of its probability is as narrow as was asked.

It is looked at a few numbers of cases only, in the order of their numbers, so that neither the speed of a worker nor a
lucky moment ends it. A first look after `FIRST` cases, and the interval of Wilson, whose width does not vanish where no
case or every case succeeded, keep what it says honest (`tests/campaign/test_stopping.py`: over many repetitions the
interval at the end holds the truth as often as it says).
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from dcone_cosim.campaign.spec import Until
from dcone_cosim.cases.statistics import Share, share

FIRST = 100
"""Cases before the first look."""
GROWTH = 1.05
"""From one look to the next [1]."""


def looks(first: int = FIRST) -> Iterator[int]:
    """Numbers of cases at which the interval is looked at."""
    number = first
    while True:
        yield number
        number = math.ceil(number * GROWTH)


def half_width(found: Share) -> float:
    return 0.5 * (found.interval[1] - found.interval[0])


def enough(successes: int, answered: int, until: Until) -> bool:
    """Whether the interval is as narrow as that.

    Checked  tests/campaign/test_stopping.py
    """
    return answered > 0 and half_width(share(successes, answered, until.confidence)) <= until.within


def needed(successes: int, answered: int, until: Until, most: int) -> int:
    """How many cases it will take, as far as is known by now: (z/w)^2 p (1 - p), with p away from 0 and 1."""
    from scipy.special import ndtri

    z = float(ndtri(0.5 + 0.5 * until.confidence))
    p = (successes + 0.5 * z**2) / (answered + z**2)
    count = math.ceil((z / until.within) ** 2 * p * (1.0 - p))
    return min(max(count, FIRST), most)
