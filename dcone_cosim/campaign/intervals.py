"""Which interval a campaign may tell of a share: it hangs on how its cases were drawn.

Wilson's interval, and those of percentiles, are of independent cases. Those of a Latin hypercube are not: the variance
of a share is at most n/(n - 1) times that of independent ones, whatever is asked of them, and mostly less. So the same
intervals are told, with that. A scrambled Sobol sequence has no such bound that is of use: at worst its variance is
2^(t + d - 1) times that of independent cases, for d values and the quality t of the sequence, and that only where the
number of cases is a power of two. One sequence does not show its own error, so no interval is told; campaigns with
other seeds show it.

Source   A. B. Owen, Monte Carlo theory, methods and examples, proposition 10.4 (Latin hypercube); Z. Pan and
         A. B. Owen, arXiv 2106.10534 (2021), the bound of gain coefficients (Sobol)
Checked  tests/campaign/test_intervals.py
"""

from __future__ import annotations

import math
from dataclasses import replace

from dcone_cosim.campaign.spec import HYPERCUBE, MONTE_CARLO, Spec
from dcone_cosim.cases.statistics import Share, share

NONE = (math.nan, math.nan)
HAVE = (MONTE_CARLO, HYPERCUBE)
"""Samplers whose cases bound the error of a share."""


def of_share(spec: Spec, count: int, of: int) -> Share:
    """A share of the cases with its interval, NaN where the sampler bounds none."""
    found = share(count, of, spec.confidence)
    return found if spec.sampler in HAVE else replace(found, interval=NONE)


def told(spec: Spec) -> str:
    """What the interval of the probability is, in words."""
    if spec.sampler not in HAVE:
        return (
            "no interval: cases of a Sobol sequence are not independent, and one sequence does not show its error; "
            "campaigns with other seeds do"
        )
    what = f"{100.0 * spec.confidence:g} % interval of Wilson"
    if spec.sampler == HYPERCUBE:
        return (
            f"{what} as of independent cases: those of a Latin hypercube have a variance of n/(n - 1) times theirs at "
            "most, and mostly less"
        )
    return what


def bounds(found: Share) -> str:
    """ " (0.923 to 0.966)", or nothing where there is no interval."""
    return "" if math.isnan(found.interval[0]) else f" ({found.interval[0]:.4g} to {found.interval[1]:.4g})"
