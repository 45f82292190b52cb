"""What the spread of a figure comes from: Sobol indices, and surrogates with their own error.

Sobol indices follow from cases made for them (`sampler = "saltelli"`): the share of the variance that goes with one
value alone, and with all that it takes part in. Where the solver's jitter is an input, its index is that of chaos.

From cases at random a surrogate is fitted, a sparse polynomial chaos and a Gaussian process, each judged by cases that
it has not seen. What neither explains is jitter, or finer than they can be.

    Q2 = 1 - sum (y - y_hat)^2 / sum (y - mean)^2        over folds that were left out
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from dcone_cosim.errors import InputError

Numbers = npt.NDArray[np.float64]
FOLDS = 5
"""Parts of the cases, each of which is left out once."""
DEGREES = tuple(range(1, 9))
"""Of the polynomials that are tried."""
MOST_TERMS = 2000
"""Terms of a polynomial from which on it is not tried."""
MOST_OF_PROCESS = 400
"""Cases that a Gaussian process is fitted to: its cost goes with their third power."""
LEAST = 20
"""Cases below which nothing is fitted."""
RESAMPLES = 200
"""Bootstrap samples of an index's interval."""


@dataclass(frozen=True)
class Index:
    """Sobol indices of one input, with half the width of each one's interval [1]."""

    name: str
    first: float
    first_error: float
    total: float
    total_error: float


@dataclass(frozen=True)
class Indices:
    """Of a figure: over how many base samples; those with a case that lacks the figure are left out."""

    figure: str
    samples: int
    left_out: int
    inputs: tuple[Index, ...]


def sobol_indices(
    figure: str, names: Sequence[str], values: Sequence[float], confidence: float, seed: int
) -> Indices | None:
    """Sobol indices from the values of cases in the order of `sampling.saltelli`, by SALib; None where fewer than two
    base samples are complete, or the figure does not change.

    Source   A. Saltelli et al. (2010), Jansen's estimator of the total index; intervals by bootstrap
    Checked  tests/campaign/test_sensitivity.py: the Ishigami function
    """
    from SALib.analyze import sobol

    size = len(names)
    table = np.asarray(values, dtype=float).reshape(-1, size + 2)
    good = np.isfinite(table).all(axis=1)
    kept = table[good]
    if len(kept) < 2 or not np.ptp(kept) > 0.0:
        return None
    problem = {"num_vars": size, "names": list(names), "bounds": [[0.0, 1.0]] * size}
    found = sobol.analyze(
        problem, kept.ravel(), calc_second_order=False, num_resamples=RESAMPLES, conf_level=confidence, seed=seed
    )
    rows = (
        Index(
            name, float(found["S1"][i]), float(found["S1_conf"][i]), float(found["ST"][i]), float(found["ST_conf"][i])
        )
        for i, name in enumerate(names)
    )
    return Indices(figure, len(kept), int((~good).sum()), tuple(rows))


@dataclass(frozen=True)
class Surrogate:
    """A fitted stand-in for a figure.

    kind       polynomial chaos or Gaussian process
    error      1 - Q2, the share of the variance that it does not explain of cases it has not seen [1]
    indices    first and total Sobol index of each input, of a polynomial chaos; they sum to what it explains
    """

    kind: str
    degree: int
    cases: int
    error: float
    indices: Mapping[str, tuple[float, float]]


def surrogates(names: Sequence[str], normal: Sequence[bool], points: Numbers, values: Numbers) -> list[Surrogate]:
    """Surrogates of a figure, each with its own error.

    names     of the inputs that it may hang on smoothly
    normal    whether each is best told by its normal score, otherwise by its share of the cube
    points    (n, d) of the unit cube;  values (n,)

    Checked  tests/campaign/test_sensitivity.py
    """
    from scipy.special import ndtri

    good = np.isfinite(values)
    points, values = points[good], values[good]
    if len(values) < LEAST or not np.ptp(values) > 0.0:
        return []
    told = np.where(np.asarray(normal)[None, :], ndtri(points), points)
    scale = float(np.std(values))
    scaled = (values - float(np.mean(values))) / scale
    found = []
    best: tuple[float, int] | None = None
    for degree in DEGREES:
        terms = math.comb(degree + len(names), degree)
        if terms > MOST_TERMS or (degree > 1 and terms > 0.8 * len(values)):
            break
        error = _left_out(lambda x, y, degree=degree: _chaos(normal, x, y, degree)[0], told, scaled)  # type: ignore[misc]
        if best is None or error < best[0]:
            best = error, degree
        elif degree > best[1] + 1:
            break
    if best is not None:
        _, result = _chaos(normal, told, scaled, best[1])
        found.append(Surrogate("polynomial chaos", best[1], len(values), best[0], _indices_of(result, names)))
    some = slice(0, MOST_OF_PROCESS)
    error = _left_out(_process, told[some], scaled[some])
    found.append(Surrogate("Gaussian process", 0, len(scaled[some]), error, {}))
    return found


Fit = Callable[[Numbers], Numbers]


def _left_out(fit: Callable[[Numbers, Numbers], Fit], points: Numbers, values: Numbers) -> float:
    """1 - Q2 over folds that were left out."""
    fold = np.arange(len(values)) % FOLDS
    left = np.empty(len(values))
    for number in range(FOLDS):
        out = fold == number
        left[out] = values[out] - fit(points[~out], values[~out])(points[out])
    return float(np.sum(left**2) / np.sum((values - np.mean(values)) ** 2))


def openturns() -> Any:
    """The library, silent; `InputError` where it is not installed."""
    try:
        import openturns as ot
    except ImportError:
        raise InputError("surrogates and rare failures need OpenTURNS; pip install 'dcone-cosim[campaign]'") from None
    ot.Log.Show(ot.Log.NONE)
    return ot


def _chaos(normal: Sequence[bool], points: Numbers, values: Numbers, degree: int) -> tuple[Fit, Any]:
    """A sparse polynomial chaos, its terms chosen by least angles and leaving one out."""
    ot = openturns()
    marginals = [ot.Normal() if is_normal else ot.Uniform(0.0, 1.0) for is_normal in normal]
    enumerate_function = ot.LinearEnumerateFunction(len(marginals))
    families = [ot.StandardDistributionPolynomialFactory(one) for one in marginals]
    basis = ot.OrthogonalProductPolynomialFactory(families, enumerate_function)
    size = enumerate_function.getStrataCumulatedCardinal(degree)
    chosen = ot.LeastSquaresMetaModelSelectionFactory(ot.LARS(), ot.CorrectedLeaveOneOut())
    algorithm = ot.FunctionalChaosAlgorithm(
        ot.Sample(points), ot.Sample(values[:, None]), ot.JointDistribution(marginals),
        ot.FixedStrategy(basis, size), ot.LeastSquaresStrategy(chosen),
    )  # fmt: skip
    algorithm.run()
    result = algorithm.getResult()
    model = result.getMetaModel()
    return lambda x: np.asarray(model(ot.Sample(x)))[:, 0], result


def _indices_of(result: Any, names: Sequence[str]) -> dict[str, tuple[float, float]]:
    ot = openturns()
    sobol = ot.FunctionalChaosSobolIndices(result)
    return {name: (sobol.getSobolIndex(i), sobol.getSobolTotalIndex(i)) for i, name in enumerate(names)}


def _process(points: Numbers, values: Numbers) -> Fit:
    """A Gaussian process with a Matern covariance (5/2), a length for each input, and a nugget that is fitted."""
    ot = openturns()
    size = points.shape[1]
    covariance = ot.MaternModel([1.0] * size, [1.0], 2.5)
    covariance.setNuggetFactor(1e-2)
    fitter = ot.GaussianProcessFitter(
        ot.Sample(points), ot.Sample(values[:, None]), covariance, ot.ConstantBasisFactory(size).build()
    )
    fitter.run()
    regression = ot.GaussianProcessRegression(fitter.getResult())
    regression.run()
    model = regression.getResult().getMetaModel()
    return lambda x: np.asarray(model(ot.Sample(x)))[:, 0]
