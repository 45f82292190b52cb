"""The Gauss-Legendre scheme of four stages: implicit, symplectic and symmetric at steps of one size, of order 8.

    k_i = f(x + h sum_j a_ij k_j, c_i h),   x_end = x + h sum_j b_j k_j,   c_i the zeros of P_4(2 c - 1)

It collocates: x is a polynomial of degree 4 whose slope is f at the four nodes. At steps of one size it keeps every
quadratic invariant and takes nothing off a vibration, whatever the step: what is undamped neither dies nor grows. Steps
that follow the error are no longer one map, and the energy drifts with their error; so the size stays as it is until
the error asks for less or allows 1.5 times as much, and while a vibration holds it at `REACH` it never changes. Where
the line goes slack or taut a step is cut to end there: that one has its own size, and its own error in the energy.

Stages     by fixed-point iteration, until a sweep changes them no less than the one before: to rounding. A sweep leaves
           0.166 h |lambda| of the error, so it needs h |lambda| < 6; at `REACH` a quarter is left. What is stiff it
           cannot do, although the scheme itself could (A-stable)
Order      8; error estimate from differences of orders 5 and 3 over the nodes; dense output 7, formed by evaluating f
           anew within the step, twice, since the collocation polynomial itself is of order 4
Stability  A-stable, |R| = 1 on the imaginary axis; 6 is the limit of the iteration
Cost       4 evaluations a sweep, 7 (smooth) to 25 sweeps (at REACH) and 5 more a step; 4 when dense output is asked for
Source     Hairer, Lubich and Wanner, Geometric numerical integration (2006), II.1.3, IV.2.1, VIII.6; when to stop:
           Hairer, McLachlan and Razakarivony, BIT 48 (2008) 231
Checked    tests/tethered_deorbit/test_integrator.py: slope of the error 8 and 7, no damping, symmetry
"""

from __future__ import annotations

import math
from collections.abc import Callable
from decimal import Decimal
from typing import Any

import numpy as np

from fmu_src.integrators import collocation
from fmu_src.integrators.control import next_step_8, shorter_step_8
from fmu_src.integrators.nested import make_nested
from fmu_src.integrators.scheme import AdaptiveScheme
from orbital.kernel import kernel
from orbital.vectors import Array

STAGES = 4
NODES = STAGES + 2
"""Begin of the step, its four stages, its end: the rows of derivatives in stage memory, in this order."""
ROWS = NODES + STAGES + 1
"""Behind them room for the next sweep, or for the derivatives within the step, and for a state."""
DENSE_ROWS = 7
SWEEPS = 60
REACH = 1.5
"""Longest step in radians of an oscillation: a quarter of the iteration's limit."""
ALLOWED_GROWTH = 1.5
CONVERGED = 1.0e-4
"""Square of the change that a last sweep may leave, in tolerances: it has stopped falling, by rounding."""


@collocation.exact
def _nodes() -> list[Decimal]:
    """Zeros of P_4(2 c - 1): 1/2 +- sqrt(3/7 +- 2/7 sqrt(6/5))/2."""
    inner = (Decimal(6) / 5).sqrt() * 2 / 7
    near, far = ((Decimal(3) / 7 - inner).sqrt() / 2, (Decimal(3) / 7 + inner).sqrt() / 2)
    half = Decimal("0.5")
    return [half - far, half - near, half + near, half + far]


_C = _nodes()
_ALL = [Decimal(0), *_C, Decimal(1)]
_WITHIN = [Decimal(i) / 5 for i in (1, 2, 3, 4)]
"""Fractions of the step at which the dense output meets f: the nodes themselves would leave it undetermined."""

# Frozen into the kernels as constants.
_CF = np.array([float(c) for c in _C])
_A = collocation.integrals(_C, _C).reshape(-1)
_B = collocation.integrals(_C, [Decimal(1)])[0]
_HIGH = collocation.difference([Decimal(0), *_WITHIN, Decimal(1)]) / 384.0
_LOW = collocation.difference(_C) / 32.0
_FIRST = collocation.integrals(_ALL, _WITHIN).reshape(-1)
"""From the derivatives at all six nodes to the state within the step, of order 5."""
_TF = np.array([float(t) for t in _WITHIN])
_CUBIC = np.array(collocation.nested_slopes(_WITHIN, range(3)), float).reshape(-1)
_REST = collocation.inverse(collocation.nested_slopes(_WITHIN, range(3, DENSE_ROWS))).reshape(-1)
"""From slopes within the step that the cubic lacks to the rows of dense output behind its three."""


@kernel
def next_step(step: float, error: float, previous_error: float) -> float:
    """Step [s] after a success: the same, unless the error would allow 1.5 times as much.

    error, previous_error  in units of the tolerance             [-]

    Source   ours; a step is only shortened by a rejection
    Checked  tests/tethered_deorbit/test_integrator.py
    """
    better = next_step_8(step, error, previous_error)
    return better if better > ALLOWED_GROWTH * step else step


@kernel
def reach(damping: float) -> float:
    """Longest step in radians of an oscillation [-], whatever its damping: that to which the iteration is quick.

    Checked  tests/tethered_deorbit/test_integrator.py: its stages are found there
    """
    return REACH


def make_gauss(
    derivative: Callable[..., Any], squared_error: Callable[..., Any], size: int, counted: int = 0
) -> AdaptiveScheme:
    """The kernels for one set of equations; arguments as for `dop853.make_dop853`.

    Source   as the module's
    Checked  tests/tethered_deorbit/test_integrator.py
    """
    width = size + counted
    last, room, value = (STAGES + 1) * width, NODES * width, (ROWS - 1) * width
    flag = value + max(width, STAGES)

    @kernel
    def sweep(context: Any, start: Array, step: float, stages: Array) -> float:
        """One fixed-point iteration of the four stages; returns the square of what it changed, in tolerances [-].

            k_i <- f(x + h sum_j a_ij k_j, c_i h)

        Source   as the module's
        Checked  tests/tethered_deorbit/test_integrator.py
        """
        state = stages[value:flag]
        for i in range(STAGES):
            for n in range(size):
                total = 0.0
                for j in range(STAGES):
                    total += _A[i * STAGES + j] * stages[(1 + j) * width + n]
                state[n] = start[n] + step * total
            derivative(context, state, stages[room + i * width : room + (i + 1) * width], _CF[i] * step)
        change = 0.0
        for i in range(STAGES):
            old = stages[(1 + i) * width : (2 + i) * width]
            new = stages[room + i * width : room + (i + 1) * width]
            for n in range(width):
                state[n] = step * (new[n] - old[n])
                old[n] = new[n]
            change += squared_error(context, start, state)
        return float(change)

    @kernel
    def attempt(context: Any, start: Array, step: float, stages: Array, end: Array) -> None:
        """One step: the stages, the state at its end and the derivative there, as `AdaptiveScheme` has it.

        start         x      (size + counted,)
        step          h                                              [s]
        stages               begins with f(x)
        end           x_end  out                                     (size + counted,)

        Source   as the module's
        Checked  tests/tethered_deorbit/test_integrator.py: order 8, and lower with one coefficient off
        """
        for i in range(STAGES):
            for n in range(width):
                stages[(1 + i) * width + n] = stages[n]
        before = math.inf
        stages[flag] = 1.0
        for _ in range(SWEEPS):
            change = sweep(context, start, step, stages)
            if change == 0.0 or (change >= before and change <= CONVERGED):
                stages[flag] = 0.0
                break
            before = change
        for n in range(width):
            total = 0.0
            for j in range(STAGES):
                total += _B[j] * stages[(1 + j) * width + n]
            end[n] = start[n] + step * total
        derivative(context, end, stages[last : last + width], step)
        state = stages[value:flag]
        for i in range(STAGES):
            for n in range(size):
                total = 0.0
                for j in range(NODES):
                    total += _FIRST[i * NODES + j] * stages[j * width + n]
                state[n] = start[n] + step * total
            derivative(context, state, stages[room + i * width : room + (i + 1) * width], _TF[i] * step)

    @kernel
    def error(context: Any, end: Array, step: float, stages: Array, low: Array, high: Array) -> float:
        """Estimated error of the step in units of the tolerance [-]; infinite if the stages were not found.

            e = h |e5|^2 / sqrt(|e5|^2 + 0.01 |e3|^2)

        e5 is the fifth divided difference of f over begin, end and the points within, e3 the third over the stages, on
        the step as unit: they fall with h^5 and h^3, and e with h^8, as that of `dop853`, whose form it has. Over the
        stages themselves the fifth would vanish for every linear equation.

        low, high     room for e3 and e5                             (size + counted,)

        Source   the factors 1/32 and 1/384 are ours: they keep e above the error itself
        Checked  tests/tethered_deorbit/test_estimated_error.py: how it falls, and that it covers the error
        """
        if stages[flag] != 0.0:
            return math.inf
        for n in range(width):
            low[n] = 0.0
            high[n] = _HIGH[0] * stages[n] + _HIGH[NODES - 1] * stages[last + n]
            for j in range(STAGES):
                high[n] += _HIGH[1 + j] * stages[room + j * width + n]
                low[n] += _LOW[j] * stages[(1 + j) * width + n]
        fifth = squared_error(context, end, high)
        if fifth == 0.0:
            return 0.0
        third = squared_error(context, end, low)
        return step * float(fifth) / math.sqrt(fifth + 0.01 * third)

    dense_value, dense_rate = make_nested(width, DENSE_ROWS)

    @kernel
    def fit(start: Array, step: float, stages: Array, dense: Array) -> None:
        """Rows of the dense output behind the first three, from derivatives within the step.

        Its slopes become those derivatives at the fractions 1/5 to 4/5; ends and their slopes are in the first three.

        Source   as the module's
        Checked  tests/tethered_deorbit/test_integrator.py: order 7 within the step
        """
        state = stages[value:flag]
        for n in range(width):
            for i in range(STAGES):
                state[i] = step * stages[room + i * width + n]
                for row in range(3):
                    state[i] -= _CUBIC[i * 3 + row] * dense[row * width + n]
            for row in range(STAGES):
                total = 0.0
                for i in range(STAGES):
                    total += _REST[row * STAGES + i] * state[i]
                dense[(3 + row) * width + n] = total

    @kernel
    def prepare_dense(
        context: Any, start: Array, end: Array, step: float, stages: Array, dense: Array, scratch: Array
    ) -> None:
        """Fill the seven rows of the dense output, by one more evaluation of f at each of four points within the step.

        The step has left those at the states by the polynomial of degree 6 through all six derivatives (order 5). The
        polynomial of degree 7 that they make (order 6) gives the states of the next, and these one of order 7.

        dense         out    rows of size + counted                  (DENSE_ROWS rows)
        scratch       room                                           (size + counted,)

        Source   bootstrapping as in Hairer, Norsett and Wanner (1993), section II.6
        Checked  tests/tethered_deorbit/test_integrator.py: order 7 within the step
        """
        for n in range(width):
            change = end[n] - start[n]
            first, final = step * stages[n], step * stages[last + n]
            dense[n] = change
            dense[width + n] = first - change
            dense[2 * width + n] = 2.0 * change - (first + final)
        fit(start, step, stages, dense)
        for i in range(STAGES):
            dense_value(start, dense, _TF[i], 0, size, scratch)
            derivative(context, scratch, stages[room + i * width : room + (i + 1) * width], _TF[i] * step)
        fit(start, step, stages, dense)

    return AdaptiveScheme(
        flag + 1,
        last,
        DENSE_ROWS * width,
        attempt,
        error,
        prepare_dense,
        dense_value,
        dense_rate,
        next_step,
        shorter_step_8,
        reach,
    )
