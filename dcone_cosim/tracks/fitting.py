"""Values of a scene estimated from measured tracks: least squares over runs of it, with intervals.

    minimise  sum |r_measured - r(p)|^2,   p = p_start exp(q)

over `q`, the logarithm of what each value is of where it began: every value stays of its sign, and all count alike. The
slope is taken by central differences of `STEP` in q, wide enough to stand over what rounding makes of a net. With the
residuals' variance s2 = S / (m - n), m coordinates and n values,

    covariance = s2 (J'J)^-1,   q +- t sqrt(covariance),   t of Student's distribution at 95 %

A net is chaotic: twins that begin a micrometre apart come apart by themselves, and no fit can be closer than that. So
the scene is also run with such twins; how far their markers lie apart is the floor, and how far each would move the
values, by the same slope, is added to the interval (as the root of the sum of squares).

Valid    errors of the measurements that are independent and alike; what the model itself gets wrong is in none of this
Source   Bates and Watts, Nonlinear Regression Analysis (1988), chapter 2
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

STEP = 0.02
"""Share of a value by which it is moved for the slope."""
WIDEST = math.log(30.0)
"""How far a value may go from where it began, in its logarithm."""
CONFIDENCE = 0.95
ENOUGH = 1e-4
"""Change of every value, as a share, below which the search is over."""
MOST_ROUNDS = 20

Simulate = Callable[[Sequence[float]], Array]
"""Simulated coordinates [m] of all measured ones, in one order, at these values."""


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
    floor           the same between twins that begin a micrometre apart [m]
    correlation     of the values' errors, (n, n)
    runs            that it took
    ended           why the search ended
    """

    estimates: Sequence[Estimate]
    before: float
    after: float
    floor: float
    correlation: Array
    coordinates: int
    runs: int
    ended: str
    converged: bool
    warnings: Sequence[str] = field(default_factory=tuple)


def estimate(
    names: Sequence[str],
    start: Sequence[float],
    bounds: Sequence[tuple[float, float]],
    measured: Array,
    simulate: Simulate,
    twins: Sequence[Simulate],
    tell: Callable[[int, float], None] = lambda runs, rms: None,
) -> Fit:
    """Estimate values from coordinates.

    bounds      of each value, both included
    twins       the same simulation, begun elsewhere by a micrometre
    tell        called after each run with how many there were and its root mean square error [m]
    """
    from scipy import optimize, stats

    first = np.asarray(start, dtype=float)
    free, many = len(first), len(measured)
    if many <= free:
        raise InputError(f"{many} coordinates cannot tell {free} values; expected more")
    runs = 0

    def residuals(q: Array, run: Simulate = simulate) -> Array:
        nonlocal runs
        off = np.asarray(run((first * np.exp(q)).tolist()) - measured)
        runs += 1
        tell(runs, float(np.sqrt(np.mean(off**2))))
        return off

    low, high = _limits(first, bounds)

    def slope(q: Array) -> Array:
        columns = []
        for k in range(free):
            up, down = q.copy(), q.copy()
            up[k], down[k] = min(q[k] + STEP, high[k]), max(q[k] - STEP, low[k])
            columns.append((residuals(up) - residuals(down)) / (up[k] - down[k]))
        return np.column_stack(columns)

    begin = residuals(np.zeros(free))
    found: Any = optimize.least_squares(
        residuals, np.zeros(free), slope, bounds=(low, high), x_scale=1.0, xtol=ENOUGH, ftol=1e-8, max_nfev=MOST_ROUNDS
    )
    jacobian, off = found.jac, found.fun
    singular = np.linalg.svd(jacobian, compute_uv=False)
    if not singular[-1] > 1e-8 * singular[0] or not singular[0] > 0.0:
        blind = [name for name, column in zip(names, jacobian.T, strict=True) if not np.any(column)]
        which = " and ".join(blind) if blind else "a combination of " + ", ".join(names)
        raise InputError(f"the tracks do not tell {which}: nothing moves with it; leave it out of --free")
    inverse = np.linalg.inv(jacobian.T @ jacobian)
    covariance = float(off @ off) / (many - free) * inverse
    student = float(stats.t.ppf(0.5 + 0.5 * CONFIDENCE, many - free))
    apart = [residuals(found.x, twin) - off for twin in twins]
    moved = np.array([inverse @ jacobian.T @ shift for shift in apart]).reshape(-1, free)
    floor = float(np.sqrt(np.mean(np.square(apart)))) if apart else 0.0
    chaos = np.sqrt(np.mean(moved**2, axis=0)) if apart else np.zeros(free)
    half = student * np.hypot(np.sqrt(np.diag(covariance)), chaos)
    values = first * np.exp(found.x)
    estimates = [
        Estimate(name, float(s), float(v), *sorted((float(v * math.exp(-h)), float(v * math.exp(h)))))
        for name, s, v, h in zip(names, first, values, half, strict=True)
    ]
    return Fit(
        estimates,
        float(np.sqrt(np.mean(begin**2))),
        float(np.sqrt(np.mean(off**2))),
        floor,
        covariance / np.sqrt(np.outer(np.diag(covariance), np.diag(covariance))),
        many,
        runs,
        str(found.message),
        found.status > 0,
        _warnings(found.status, names, found.x, low, high, floor, float(np.sqrt(np.mean(off**2)))),
    )


def _limits(first: Array, bounds: Sequence[tuple[float, float]]) -> tuple[Array, Array]:
    """Of q, so that every value stays within its bounds and no further from its start than `WIDEST`."""
    low, high = np.full(len(first), -WIDEST), np.full(len(first), WIDEST)
    for k, (value, pair) in enumerate(zip(first, bounds, strict=True)):
        reach = sorted(math.log(end / value) if end / value > 0.0 else -math.inf for end in pair)
        low[k], high[k] = max(low[k], reach[0]), min(high[k], reach[1])
    return low, high


def _warnings(
    status: int, names: Sequence[str], q: Array, low: Array, high: Array, floor: float, rms: float
) -> tuple[str, ...]:
    found = []
    if status <= 0:
        found.append(f"the search ended after {MOST_ROUNDS} rounds without settling: the intervals mean little")
    for name, at, least, most in zip(names, q, low, high, strict=True):
        if at - least < 1e-6 or most - at < 1e-6:
            found.append(f"{name} lies at the edge of what was searched: begin elsewhere, or leave it out")
    if floor > 0.5 * rms:
        found.append(
            f"twins a micrometre apart differ by {floor:.3g} m, the fit by {rms:.3g} m: the net's own chaos is the limit, "
            "and earlier instants tell more"
        )
    return tuple(found)
