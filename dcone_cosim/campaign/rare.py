"""The probability of a rare failure, by subset sampling, with its coefficient of variation.

Each level keeps the tenth of its cases that is nearest to failure and walks on from them, so that a probability of 1e-4
takes four levels, and not some millions of cases.

    P = p_0^(m - 1) P_m,   failure: the margin of `success` is below 0

A figure that takes few values, such as a share of points, has many cases of one margin: none is nearer to failure than
the tenth that a level would start from, and the walk comes to a halt. Then there is no probability.

Source   S.-K. Au and J. L. Beck, Probabilistic Engineering Mechanics 16 (2001) 263; OpenTURNS computes it
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from dcone_cosim.campaign.engine import Engine
from dcone_cosim.campaign.outcomes import margin
from dcone_cosim.campaign.sampling import inside
from dcone_cosim.campaign.sensitivity import openturns
from dcone_cosim.campaign.spec import MONTE_CARLO, Spec

FAR = -1e9
"""Margin of a case that has none: it did not come to have the figure, and counts as failed."""
BLOCK = 20
"""Cases that are run side by side."""
RANGE = 2.0
"""Width of a step of the walk, in normal scores [1]."""
SHARE = 0.1
"""Share of a level's cases that the next one starts from [1]."""
Margins = Callable[[npt.NDArray[np.float64]], Sequence[float]]


def subset(margins: Margins, size: int, count: int, seed: int) -> dict[str, Any]:
    """Probability that a margin is below 0, with its coefficient of variation; None for both if no level came so far.

    margins    of points (k, size) of the unit cube
    count      cases of each level

    Checked  tests/campaign/test_rare.py: against a closed form, its coefficient of variation over repetitions; margins
             of few values
    """
    from scipy.special import ndtr

    ot = openturns()
    ot.RandomGenerator.SetSeed(seed)

    def asked(scores: Any) -> list[list[float]]:
        points = inside(ndtr(np.asarray(scores, dtype=float).reshape(-1, size)))
        return [[value if math.isfinite(value) else FAR] for value in margins(points)]

    function = ot.PythonFunction(size, 1, func_sample=asked)
    vector = ot.CompositeRandomVector(function, ot.RandomVector(ot.Normal(size)))
    algorithm = ot.SubsetSampling(ot.ThresholdEvent(vector, ot.Less(), 0.0), RANGE, SHARE)
    block = min(BLOCK, count)
    algorithm.setBlockSize(block)
    algorithm.setMaximumOuterSampling(max(1, count // block))
    algorithm.run()
    found = algorithm.getResult()
    probability, variation = float(found.getProbabilityEstimate()), float(found.getCoefficientOfVariation())
    thresholds = [float(one) for one in algorithm.getThresholdPerStep()]
    came = thresholds[-1] == 0.0 and probability > 0.0  # else it is the share of a level before
    return {
        "failure": probability if came else None,
        "coefficient_of_variation": variation if came else None,
        "levels": int(algorithm.getStepsNumber()),
        "thresholds": thresholds,
    }


def run_subset(engine: Engine) -> Mapping[str, Any]:
    """Cases level after level; what it found, for the summary."""
    spec: Spec = engine.spec
    assert spec.n is not None

    def margins(points: npt.NDArray[np.float64]) -> list[float]:
        return [margin(one.row, spec.success) for one in engine.batch(list(points))]

    return {"rare": subset(margins, len(engine.inputs.inputs), spec.n, spec.seed)}


def sentences(spec: Spec, told: Mapping[str, Any]) -> list[str]:
    """What it found, in words."""
    if told["failure"] is None:
        least = told["thresholds"][-1]
        return [
            f"no probability of failing ({spec.success.text} is success): after {told['levels']} levels the walk came "
            f"to a halt {least:.3g} short of failure, where too many cases are alike; take a figure that differs from "
            f"case to case, or more cases by {MONTE_CARLO}"
        ]
    return [
        f"probability of failing ({spec.success.text} is success): {told['failure']:.3g}, coefficient of variation "
        f"{told['coefficient_of_variation']:.2g}, by subset sampling over {told['levels']} levels"
    ]
