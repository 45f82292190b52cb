"""Values of a scene estimated from measured tracks: least squares over runs of it, with intervals.

A net is chaotic: twins that begin a micrometre apart come apart by themselves, so a single run is one sample, and its
slope by a value is mostly noise. So every set of values is run with several twins; the fit is to their mean, and each
coordinate counts by what it scatters by: with its variance c2 over M twins, and s2 that of the measurements,

    minimise  sum w (r_measured - mean r(p))^2,   w = 1 / (s2 + (1 + 1/M) c2),
    p = p_start exp(q)

over `q`, the logarithm of what each value is of where it began: every value stays of its sign, and all count alike. s2 is
what a first, unweighted fit leaves over beside the twins' scatter, unless it is told. The slope J is by central
differences over `STEP` in q. Scatter makes it too steep, and intervals too narrow, by a share that is known:

    covariance = chi2 g_i g_k (J'wJ)^-1_ik,   g_k^2 = 1 / (1 - N_k / (J'wJ)_kk),   N_k = sum w 2 c2 / (M (2 STEP)^2)

with chi2 = max(1, S / (m - n)) of m coordinates and n values. The scatter of coordinates hangs together over time; so what each twin by itself would
move the values by is added: half an interval is `t sqrt(covariance + moved^2)`, t of Student's distribution at 95 %. Values
further off that fit no worse belong to it too, since the sum is neither round nor smooth.

Valid    errors of the measurements that are independent and alike; what the model itself gets wrong is not in it
Source   Bates and Watts, Nonlinear Regression Analysis (1988), chapter 2; Fuller, Measurement Error Models (1987), for N
Checked  tests/cosim/test_fit.py
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from dcone_cosim.errors import InputError
from dcone_cosim.tracks.reading import Array

STEP = 0.15
"""Share of a value by which it is moved for the slope, to either side."""
WIDEST = math.log(30.0)
"""How far a value may go from where it began, in its logarithm."""
CONFIDENCE = 0.95
ENOUGH = 2e-3
"""Change of every value, as a share, below which the search is over."""
MOST_ROUNDS = 12
BESIDE = (0.3, 0.6, 1.2)
"""How far beside a minimum it is looked for a deeper one, in the logarithm of a value."""
MOST_RESTARTS = 4
LEAST_KNOWN = 0.1
"""Share of a slope's square that must be left when its noise is off: below, it is nothing but noise."""

Simulate = Callable[[Sequence[float]], Array]
"""Simulated coordinates [m] of all measured ones at these values: a row for each twin, (M, m)."""


@dataclass(frozen=True)
class Estimate:
    """One value.

    low, high    of its interval
    """

    name: str
    start: float
    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Fit:
    """What came out.

    before, after   root of the mean squared error of a coordinate, at the start and at the values found [m]
    scatter         the same of a twin about the mean of all [m]
    noise           of the measurements: told, or estimated [m]
    chi2            weighted squares left over per degree of freedom: about 1 where the model is right
    correlation     of the values' errors, (n, n)
    runs            sets of values that were run
    """

    estimates: Sequence[Estimate]
    before: float
    after: float
    scatter: float
    noise: float
    chi2: float
    correlation: Array
    coordinates: int
    runs: int
    converged: bool
    warnings: Sequence[str] = field(default_factory=tuple)


@dataclass
class _Problem:
    """The simulation as a function of q, each set of values run once."""

    first: Array
    measured: Array
    simulate: Simulate
    low: Array
    high: Array
    tell: Callable[[int, float], None]
    kept: dict[bytes, Array] = field(default_factory=dict)

    def twins(self, q: Array) -> Array:
        key = q.tobytes()
        if key not in self.kept:
            self.kept[key] = np.asarray(self.simulate((self.first * np.exp(q)).tolist()))
            self.tell(len(self.kept), _rms(self.kept[key].mean(axis=0) - self.measured))
        return self.kept[key]

    def off(self, q: Array) -> Array:
        """Mean of the twins less what was measured [m]."""
        found: Array = self.twins(q).mean(axis=0) - self.measured
        return found

    def slope(self, q: Array) -> tuple[Array, Array]:
        """Of `off` by each q, and by how much it is too large in the mean, squared: its noise, both (m, n)."""
        columns, noise = [], []
        for k in range(len(q)):
            up, down = q.copy(), q.copy()
            up[k], down[k] = min(q[k] + STEP, self.high[k]), max(q[k] - STEP, self.low[k])
            ends = self.twins(up), self.twins(down)
            way = up[k] - down[k]
            columns.append((ends[0].mean(axis=0) - ends[1].mean(axis=0)) / way)
            noise.append(sum(_variance(end) / len(end) for end in ends) / way**2)
        return np.column_stack(columns), np.column_stack(noise)

    def squares(self, q: Array, weight: Array) -> float:
        """Weighted sum of squares."""
        return float(weight @ self.off(q) ** 2)

    def minimise(self, q: Array, weight: Array) -> Any:
        """The values at which the weighted squares are least."""
        from scipy import optimize

        root = np.sqrt(weight)
        return optimize.least_squares(
            lambda at: root * self.off(at),
            q,
            lambda at: root[:, None] * self.slope(at)[0],
            bounds=(self.low, self.high),
            x_scale=1.0,
            xtol=ENOUGH,
            ftol=1e-6,
            max_nfev=MOST_ROUNDS,
        )


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def _variance(twins: Array) -> Array:
    """Of a twin about the mean, each coordinate; 0 of one alone."""
    found: Array = twins.var(axis=0, ddof=1) if len(twins) > 1 else np.zeros(twins.shape[1])
    return found


def estimate(
    names: Sequence[str],
    start: Sequence[float],
    bounds: Sequence[tuple[float, float]],
    measured: Array,
    simulate: Simulate,
    noise: float | None = None,
    tell: Callable[[int, float], None] = lambda runs, rms: None,
) -> Fit:
    """Estimate values from coordinates.

    bounds      of each value, both included
    noise       standard deviation of a measured coordinate [m]; None: not known
    tell        called after each set of values with how many there were and its root mean square error [m]
    """
    first = np.asarray(start, dtype=float)
    many, free = len(measured), len(first)
    if many <= free:
        raise InputError(f"{many} coordinates cannot tell {free} values; expected more")
    problem = _Problem(first, measured, simulate, *_limits(first, bounds), tell)
    before = _rms(problem.off(np.zeros(free)))
    found = problem.minimise(np.zeros(free), np.ones(many))
    weight, sigma = _weights(problem, found.x, noise)
    found = problem.minimise(found.x, weight)
    for _ in range(MOST_RESTARTS):
        weight, sigma = _weights(problem, found.x, noise)
        least = problem.squares(found.x, weight)
        beside = min(_beside(problem, found.x), key=lambda q: problem.squares(q, weight))
        if not problem.squares(beside, weight) < least - 1.0:
            break
        found = problem.minimise(beside, weight)
    weight, sigma = _weights(problem, found.x, noise)
    covariance, chi2, moved = _spread(problem, found.x, weight, names)
    from scipy import stats

    student = float(stats.t.ppf(0.5 + 0.5 * CONFIDENCE, many - free))
    half = student * np.sqrt(np.diag(covariance) + moved**2)
    least, most = found.x - half, found.x + half
    enough = problem.squares(found.x, weight) + student**2 * max(1.0, chi2)
    for q in _beside(problem, found.x):  # no worse, to what can be told: then it is within the interval
        if problem.squares(q, weight) < enough:
            least, most = np.minimum(least, q), np.maximum(most, q)
    estimates = []
    for k, name in enumerate(names):
        ends = sorted(float(first[k] * math.exp(end)) for end in (least[k], most[k]))
        estimates.append(Estimate(name, float(first[k]), float(first[k] * math.exp(found.x[k])), *ends))
    after, scatter = _rms(problem.off(found.x)), float(np.sqrt(_variance(problem.twins(found.x)).mean()))
    return Fit(
        estimates,
        before,
        after,
        scatter,
        sigma,
        chi2,
        covariance / np.sqrt(np.outer(np.diag(covariance), np.diag(covariance))),
        many,
        len(problem.kept),
        found.status > 0,
        _warnings(found.status, names, found.x, problem, scatter, sigma, chi2),
    )


def _beside(problem: _Problem, q: Array) -> list[Array]:
    """Values beside these, one moved at a time: a search by slopes stops in any dent of a sum that chaos makes rough."""
    found = []
    for k in range(len(q)):
        for way in (*BESIDE, *(-way for way in BESIDE)):
            other = q.copy()
            other[k] = min(max(q[k] + way, problem.low[k]), problem.high[k])
            found.append(other)
    return found


def _weights(problem: _Problem, q: Array, noise: float | None) -> tuple[Array, float]:
    """Of every coordinate, and the noise of the measurements [m]: told, or what is left beside the twins' scatter."""
    twins = problem.twins(q)
    scatter = (1.0 + 1.0 / len(twins)) * _variance(twins)
    squared = float(np.mean(problem.off(q) ** 2))
    sigma2 = noise**2 if noise is not None else max(squared - float(scatter.mean()), 0.05 * squared)
    return 1.0 / (sigma2 + scatter), math.sqrt(sigma2)


def _spread(problem: _Problem, q: Array, weight: Array, names: Sequence[str]) -> tuple[Array, float, Array]:
    """Covariance of q, weighted squares per degree of freedom, and what the twins' scatter moves q by."""
    slope, noise = problem.slope(q)
    steep = slope.T @ (weight[:, None] * slope)
    known = np.diag(steep) - noise.T @ weight
    for name, whole, rest in zip(names, np.diag(steep), known, strict=True):
        if not rest > LEAST_KNOWN * whole:
            raise InputError(
                f"the tracks do not tell {name}: what moves with it is no more than the scatter between twins; leave "
                "it out of --free, or give more markers, or earlier instants"
            )
    size = np.sqrt(np.diag(steep))
    if not np.linalg.eigvalsh(steep / np.outer(size, size))[0] > 1e-6:
        raise InputError(f"the tracks tell only a combination of {', '.join(names)}; leave one of them out of --free")
    inverse = np.linalg.inv(steep)
    wider = size / np.sqrt(known)
    off, twins = problem.off(q), problem.twins(q)
    chi2 = float(off @ (weight * off)) / (len(off) - len(q))
    apart = (twins - twins.mean(axis=0)) @ (weight[:, None] * slope) @ inverse.T
    moved = np.sqrt((1.0 + 1.0 / len(twins)) * _variance(apart))
    return max(1.0, chi2) * np.outer(wider, wider) * inverse, chi2, moved


def _limits(first: Array, bounds: Sequence[tuple[float, float]]) -> tuple[Array, Array]:
    """Of q, so that every value stays within its bounds and no further from its start than `WIDEST`."""
    low, high = np.full(len(first), -WIDEST), np.full(len(first), WIDEST)
    for k, (value, pair) in enumerate(zip(first, bounds, strict=True)):
        reach = sorted(math.log(end / value) if end / value > 0.0 else -math.inf for end in pair)
        low[k], high[k] = max(low[k], reach[0]), min(high[k], reach[1])
    return low, high


def _warnings(
    status: int, names: Sequence[str], q: Array, problem: _Problem, scatter: float, sigma: float, chi2: float
) -> tuple[str, ...]:
    found = []
    if status <= 0:
        found.append(f"the search ended after {MOST_ROUNDS} rounds without settling: the intervals mean little")
    for name, at, least, most in zip(names, q, problem.low, problem.high, strict=True):
        if at - least < 1e-6 or most - at < 1e-6:
            found.append(f"{name} lies at the edge of what was searched: begin elsewhere, or leave it out")
    if scatter > sigma:
        found.append(
            f"twins a micrometre apart differ by {scatter:.2g} m, more than the measurements' {sigma:.2g} m: the net's "
            "own chaos limits what can be found; earlier instants tell more"
        )
    if chi2 > 2.0:
        found.append(
            f"what is left over is {math.sqrt(chi2):.2g} times what measurements and chaos explain: the model is off by "
            "more than these values can mend, and the intervals do not tell that"
        )
    return tuple(found)
