"""Values of a scene estimated from measured tracks: least squares by regression over runs of it, with intervals.

A net is chaotic: twins that begin a micrometre apart come apart by themselves, and which thread snaps taut first jumps
with any value. So one run is a sample, its slope by a value is noise, and a search by slopes stops in the next dent. In
place of that a round runs the scene at values scattered about the present ones, each with a seed of its own, and fits a
plane to what comes out,

    off_i = b + J (q_i - q) + scatter,   off = r(p) - r_measured,   p = p_start exp(q)

over `q`, the logarithm of what each value is of where it began: every value stays of its sign, and all count alike.
With c2 the variance of a coordinate's scatter about the plane of K runs, s2 that of the measurements,

    q <- q - (J'wJ)^-1 J'w b,   w = 1 / (s2 + (1 + 1/K) c2)

and the next round looks closer, until that tells no more. Half an interval is the root of the sum of squares of

- t sqrt(V_kk), t of Student's distribution at 95 %, with chi2 = max(1, S / (m - n)) of m coordinates and n values and
  V = chi2 g_i g_k (J'wJ)^-1_ik,   g_k^2 = 1 / (1 - N_k / (J'wJ)_kk),   N_k = sum w c2 (A'A)^-1_kk
  N what scatter alone adds to the square of a slope, A the plan of the round;
- t times the standard deviation of what each run's scatter by itself would move q by: scatter hangs together over time,
  and the shot that was measured has its own;
- twice what the last three rounds, which look wider and closer, disagree by.

Valid    errors of the measurements that are independent and alike; what the model itself gets wrong is not in it.
         Coverage is shown for a straight line alone: of a net's chaos three trials are known, of which one missed
Source   Bates and Watts, Nonlinear Regression Analysis (1988), chapter 2; N: Fuller, Measurement Error Models (1987)
Checked  tests/cosim/test_fit.py
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from dcone_cosim.errors import InputError
from dcone_cosim.tracks.reading import Array

POINTS = 8
"""Runs of a round for each free value, and half as many more."""
FIRST, CLOSEST = 1.0, 0.01
"""How far about the present values the first round looks, and the closest, in the logarithm."""
NARROWER = 0.6
LEAST_ROUNDS, MOST_ROUNDS = 5, 12
WIDEST = math.log(30.0)
"""How far a value may go from where it began, in its logarithm."""
CONFIDENCE = 0.95
LEAST_KNOWN = 0.1
"""Share of a slope's square that must be left when its noise is off: below, it is nothing but noise."""

Simulate = Callable[[Sequence[float], int], Array]
"""Simulated coordinates [m] of all measured ones at these values, begun with a seed."""


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

    before, after   root of the mean squared error of a coordinate, at the start and, by the plane, as found [m]
    scatter         the same of a run about the plane of the last round [m]
    noise           of the measurements: told, or estimated [m]
    chi2            weighted squares left over per degree of freedom: about 1 where the model is right
    correlation     of the values' errors, (n, n)
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


@dataclass(frozen=True)
class _Round:
    """What a round tells: where it would go on, and how well that is known.

    half      of the interval of every q
    spread    covariance of q
    blind     number of a value that it does not tell; -1 for none
    """

    q: Array
    step: Array
    half: Array
    spread: Array
    after: float
    scatter: float
    noise: float
    chi2: float
    blind: int


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
    tell        called after each run with how many there were and its root mean square error [m]
    """
    first = np.asarray(start, dtype=float)
    many, free = len(measured), len(first)
    if many <= free:
        raise InputError(f"{many} coordinates cannot tell {free} values; expected more")
    low, high = _limits(first, bounds)
    runs = 0

    def off(q: Array) -> Array:
        nonlocal runs
        runs += 1
        found: Array = np.asarray(simulate((first * np.exp(q)).tolist(), runs)) - measured
        tell(runs, _rms(found))
        return found

    before = _rms(off(np.zeros(free)))
    q, radius = np.zeros(free), FIRST
    rounds: list[_Round] = []
    while len(rounds) < MOST_ROUNDS:
        plan = _plan(q, radius, low, high, len(rounds))
        rounds.append(_look(q, plan, np.array([off(at) for at in plan]), noise, names))
        q = np.clip(q + np.clip(rounds[-1].step, -1.5 * radius, 1.5 * radius), low, high)
        if radius <= CLOSEST or (len(rounds) >= LEAST_ROUNDS and float(rounds[-1].half.max()) > radius):
            break
        radius = max(CLOSEST, NARROWER * radius)
    near = rounds[-3:]
    last = min(near, key=lambda one: (one.blind >= 0, float(np.sum(np.log(one.half)))))
    q = np.clip(last.q + last.step, low, high)
    ends = np.array([np.clip(one.q + one.step, low, high) for one in near if one.blind < 0 or one is last])
    half = np.hypot(last.half, 2.0 * np.sqrt(np.mean((ends - q) ** 2, axis=0)))
    settled = bool(np.all(np.abs(last.step) <= np.maximum(last.half, NARROWER ** (LEAST_ROUNDS - 1))))
    if last.blind >= 0:
        raise InputError(
            f"the tracks do not tell {names[last.blind]}: what moves with it is no more than the scatter between runs; "
            "leave it out of --free, or give more markers, or earlier instants"
        )
    estimates = []
    for k, name in enumerate(names):
        interval = sorted(float(first[k] * math.exp(q[k] + side * half[k])) for side in (-1.0, 1.0))
        estimates.append(Estimate(name, float(first[k]), float(first[k] * math.exp(q[k])), *interval))
    size = np.sqrt(np.diag(last.spread))
    return Fit(
        estimates,
        before,
        last.after,
        last.scatter,
        last.noise,
        last.chi2,
        last.spread / np.outer(size, size),
        many,
        runs,
        settled,
        _warnings(settled, names, q, low, high, last),
    )


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def _plan(q: Array, radius: float, low: Array, high: Array, count: int) -> Array:
    """Values of a round: pairs opposite one another, evenly drawn within the radius."""
    free = len(q)
    pairs = (POINTS * free + POINTS) // 4 + 1
    drawn = radius * np.random.default_rng(count).uniform(-1.0, 1.0, (pairs, free))
    found: Array = np.clip(np.concatenate([q + drawn, q - drawn]), low, high)
    return found


def _look(q: Array, plan: Array, off: Array, noise: float | None, names: Sequence[str]) -> _Round:
    """A plane through the runs of a round, the step to its least squares, and the intervals there."""
    from scipy import stats

    runs, many, free = len(plan), off.shape[1], len(q)
    design = np.column_stack([np.ones(runs), plan - q])
    planned = np.linalg.inv(design.T @ design)
    plane = planned @ design.T @ off
    base, slope, rest = plane[0], plane[1:].T, off - design @ plane
    scatter = np.sum(rest**2, axis=0) / (runs - free - 1)
    told = (1.0 + 1.0 / runs) * scatter

    def weights(left: Array) -> tuple[Array, float]:
        squared = float(np.mean(left**2))
        sigma2 = noise**2 if noise is not None else max(squared - float(told.mean()), 0.05 * squared, 1e-24)
        return 1.0 / (sigma2 + told), math.sqrt(sigma2)

    left, sigma = base, 0.0
    step: Array = np.zeros(free)
    inverse: Array = np.eye(free)
    weight: Array = np.ones(many)
    for _ in range(3):  # the noise is what is left over, and what is left over hangs on the weights
        weight, sigma = weights(left)
        steep = slope.T @ (weight[:, None] * slope)
        size = np.sqrt(np.maximum(np.diag(steep), 1e-300))
        if not np.linalg.eigvalsh(steep / np.outer(size, size))[0] > 1e-6:
            raise InputError(
                f"the tracks do not tell {' and '.join(names)} apart: nothing moves with one of them, or all alike; "
                "leave one out of --free"
            )
        inverse = np.asarray(np.linalg.inv(steep), dtype=float)
        step = -inverse @ (slope.T @ (weight * base))
        left = base + slope @ step
    known = 1.0 - (planned.diagonal()[1:] * float(weight @ scatter)) / np.diag(steep)
    blind_one = int(np.argmin(known)) if known.min() < LEAST_KNOWN else -1
    wider = 1.0 / np.sqrt(np.maximum(known, LEAST_KNOWN))
    chi2 = float(left @ (weight * left)) / (many - free)
    spread = max(1.0, chi2) * np.outer(wider, wider) * inverse
    moved = rest @ (weight[:, None] * slope) @ inverse.T * wider
    spread = spread + np.diag(np.sum(moved**2, axis=0) / (runs - free - 1) * (1.0 + 1.0 / runs))
    half = float(stats.t.ppf(0.5 + 0.5 * CONFIDENCE, many - free)) * np.sqrt(np.diag(spread))
    return _Round(q, step, half, spread, _rms(left), float(np.sqrt(scatter.mean())), sigma, chi2, blind_one)


def _limits(first: Array, bounds: Sequence[tuple[float, float]]) -> tuple[Array, Array]:
    """Of q, so that every value stays within its bounds and no further from its start than `WIDEST`."""
    low, high = np.full(len(first), -WIDEST), np.full(len(first), WIDEST)
    for k, (value, pair) in enumerate(zip(first, bounds, strict=True)):
        reach = sorted(math.log(end / value) if end / value > 0.0 else -math.inf for end in pair)
        low[k], high[k] = max(low[k], reach[0]), min(high[k], reach[1])
    return low, high


def _warnings(settled: bool, names: Sequence[str], q: Array, low: Array, high: Array, last: _Round) -> tuple[str, ...]:
    found = []
    if not settled:
        found.append("the search ended without settling: the intervals mean little")
    for name, at, least, most in zip(names, q, low, high, strict=True):
        if at - least < 1e-6 or most - at < 1e-6:
            found.append(f"{name} lies at the edge of what was searched: begin elsewhere, or leave it out")
    if last.scatter > last.noise:
        found.append(
            f"runs scatter by {last.scatter:.2g} m, more than the measurements' {last.noise:.2g} m: the net's own "
            "chaos limits what can be found; earlier instants tell more"
        )
    if last.chi2 > 2.0:
        found.append(
            f"what is left over is {math.sqrt(last.chi2):.2g} times what measurements and chaos explain: the model is "
            "off by more than these values can mend, and the intervals do not tell that"
        )
    return tuple(found)
