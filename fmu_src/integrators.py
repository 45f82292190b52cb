"""Integrators, each a factory that is given the equations and returns kernels; none knows any model.

A factory's docstring states the scheme's order and the edge of its stability. The kernels allocate nothing: stages and
dense output live in memory the caller owns, so that a run can be saved by copying that memory. Only correctly rounded
operations are used (no `pow`), so that the steps taken are the same on every platform.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate._ivp import dop853_coefficients as tableau

from orbital.kernel import kernel
from orbital.vectors import Array

DOP853_STAGES = 12
DOP853_ROWS = 16
"""Rows of stage memory: twelve stages, the derivative at the end of the step, three more for the dense output."""

DOP853_DENSE_ROWS = 7

# Frozen into the kernels as constants. A row of A per stage, the weights of the result as row 12 (A[12] is B).
_A = np.ascontiguousarray(tableau.A).reshape(-1)
_C = np.ascontiguousarray(tableau.C)
_E3 = np.ascontiguousarray(tableau.E3)
_E5 = np.ascontiguousarray(tableau.E5)
_D = np.ascontiguousarray(tableau.D).reshape(-1)

SAFETY = 0.9
LARGEST_GROWTH = 5.0
LARGEST_CUT = 0.2


class AdaptiveScheme(NamedTuple):
    """The kernels of one embedded scheme; `context` is whatever the equations need, handed through untouched.

    attempt(context, start, step, stages, end)         one step; row 0 of stages holds the derivative at the start on
                                                       entry, row 12 that at the end on return
    error(context, end, step, stages, low, high)       estimate of its error in units of the tolerance
    prepare_dense(context, start, end, step, stages, dense, scratch)
    dense_value(start, dense, fraction, first, count, out)
    dense_rate(dense, fraction, step, first, count, out)
    next_step(step, error, previous_error)             step to try next, after a success
    shorter_step(step, error)                          step to try after a rejection
    """

    attempt: Callable[..., Any]
    error: Callable[..., Any]
    prepare_dense: Callable[..., Any]
    dense_value: Callable[..., Any]
    dense_rate: Callable[..., Any]
    next_step: Callable[..., Any]
    shorter_step: Callable[..., Any]


@kernel
def _next_step(step: float, error: float, previous_error: float) -> float:
    """Step [s] after a success, by a proportional-integral rule.

        h' = h * 0.9 e^(-3/32) e_old^(1/32),   held between h/5 and 5 h

    The powers are taken by repeated square roots, which round alike everywhere.

    error, previous_error  in units of the tolerance             [-]

    Valid    eighth-order error estimates
    Source   Gustafsson (1991): exponents 0.75/k and 0.25/k, k = 8
    Checked  tests/tethered_deorbit/test_integrator.py
    """
    now = math.sqrt(math.sqrt(math.sqrt(math.sqrt(math.sqrt(max(error, 1.0e-12))))))
    before = math.sqrt(math.sqrt(math.sqrt(math.sqrt(math.sqrt(max(previous_error, 1.0e-4))))))
    return step * min(LARGEST_GROWTH, max(LARGEST_CUT, SAFETY * before / (now * now * now)))


@kernel
def _shorter_step(step: float, error: float) -> float:
    """Step [s] after a rejection.

        h' = h * max(0.2, 0.9 e^(-1/8)),   h/5 when the error is not a number

    error        in units of the tolerance, above 1              [-]

    Valid    eighth-order error estimates
    Source   Hairer, Norsett and Wanner, Solving ordinary differential equations I (1993), section II.4
    Checked  tests/tethered_deorbit/test_integrator.py
    """
    if not error < 1.0e6:
        return step * LARGEST_CUT
    return step * max(LARGEST_CUT, SAFETY / math.sqrt(math.sqrt(math.sqrt(error))))


def make_dop853(
    derivative: Callable[..., Any], squared_error: Callable[..., Any], size: int, counted: int = 0
) -> AdaptiveScheme:
    """The explicit Runge-Kutta scheme of Dormand and Prince, order 8(5,3), with its dense output of order 7.

    derivative(context, state, rate, elapsed)   writes d(state)/dt, at `elapsed` [s] after the begin of the step
    squared_error(context, state, error)        square of the error's size in units of the tolerance [-]
    size                                        number of components
    counted                                     components behind those that the equations do not depend on: integrals
                                                along the way, for which no stage is formed

    Order      8; error estimate from embedded orders 5 and 3; dense output 7, continuous to the first derivative
    Stability  h |lambda| up to 6.4 on the negative real axis and 5.97 on the imaginary one; below that an undamped
               oscillation decays, by 2.3e-11 of its size a step at 0.5, 2.4e-8 at 1, 2.7e-5 at 2
    A state, a rate and a row of stages hold size + counted numbers. What `squared_error` makes of the counted ones is
    its own affair; where it leaves them out the others keep their bits.

    Cost       11 evaluations a step (the first is the last step's last), 3 more when dense output is asked for
    Source     Hairer, Norsett and Wanner (1993), section II.5 and II.6; the numbers are those of scipy's DOP853
    Checked    tests/tethered_deorbit/test_integrator.py: slope of the error 8 and 7, edges of stability
    """
    width = size + counted

    @kernel
    def attempt(context: Any, start: Array, step: float, stages: Array, end: Array) -> None:
        """One step: fills the stages, the state at its end and, as row 12, the derivative there.

            x_i = x + h sum_j a_ij k_j,   k_i = f(x_i, c_i h),   x_end = x + h sum_j b_j k_j

        start         x      (size + counted,)
        step          h                                              [s]
        stages        k      rows of size + counted, row 0 given     (DOP853_ROWS rows)
        end           x_end  out                                     (size + counted,)

        Source   as `make_dop853`
        Checked  tests/tethered_deorbit/test_integrator.py: order 8, and lower with one coefficient off
        """
        for i in range(1, DOP853_STAGES + 1):
            for n in range(size):
                end[n] = 0.0
            for j in range(i):
                weight = _A[i * DOP853_ROWS + j]
                if weight != 0.0:
                    row = stages[j * width : (j + 1) * width]
                    for n in range(size):
                        end[n] += weight * row[n]
            for n in range(size):
                end[n] = start[n] + step * end[n]
            derivative(context, end, stages[i * width : (i + 1) * width], _C[i] * step)
        for n in range(size, width):
            integral = 0.0
            for j in range(DOP853_STAGES):
                integral += _A[DOP853_STAGES * DOP853_ROWS + j] * stages[j * width + n]
            end[n] = start[n] + step * integral

    @kernel
    def error(context: Any, end: Array, step: float, stages: Array, low: Array, high: Array) -> float:
        """Estimated error of the step in units of the tolerance [-]; above 1 it is to be taken again, shorter.

            e = h |e5|^2 / sqrt(|e5|^2 + 0.01 |e3|^2),   e5 and e3 the errors by the embedded orders 5 and 3

        low, high     room for e3 and e5                             (size + counted,)

        Source   as `make_dop853`
        Checked  tests/tethered_deorbit/test_integrator.py: its size, against scipy's
        """
        for n in range(width):
            low[n] = 0.0
            high[n] = 0.0
        for j in range(DOP853_STAGES + 1):
            for n in range(width):
                low[n] += _E3[j] * stages[j * width + n]
                high[n] += _E5[j] * stages[j * width + n]
        fifth = squared_error(context, end, high)
        if fifth == 0.0:
            return 0.0
        third = squared_error(context, end, low)
        return step * float(fifth) / math.sqrt(fifth + 0.01 * third)

    @kernel
    def prepare_dense(
        context: Any, start: Array, end: Array, step: float, stages: Array, dense: Array, scratch: Array
    ) -> None:
        """Fill the seven rows of the dense output from the stages of a step, by three more evaluations.

        dense         out    rows of size + counted                  (DOP853_DENSE_ROWS rows)
        scratch       room                                           (size + counted,)

        Source   as `make_dop853`
        Checked  tests/tethered_deorbit/test_integrator.py: order 7 within the step
        """
        for i in range(DOP853_STAGES + 1, DOP853_ROWS):
            for n in range(size):
                scratch[n] = 0.0
            for j in range(i):
                weight = _A[i * DOP853_ROWS + j]
                if weight != 0.0:
                    for n in range(size):
                        scratch[n] += weight * stages[j * width + n]
            for n in range(size):
                scratch[n] = start[n] + step * scratch[n]
            derivative(context, scratch, stages[i * width : (i + 1) * width], _C[i] * step)
        for n in range(width):
            change = end[n] - start[n]
            first = step * stages[n]
            last = step * stages[DOP853_STAGES * width + n]
            dense[n] = change
            dense[width + n] = first - change
            dense[2 * width + n] = 2.0 * change - (first + last)
        for i in range(4):
            for n in range(width):
                scratch[n] = 0.0
            for j in range(DOP853_ROWS):
                weight = _D[i * DOP853_ROWS + j]
                if weight != 0.0:
                    for n in range(width):
                        scratch[n] += weight * stages[j * width + n]
            for n in range(width):
                dense[(3 + i) * width + n] = step * scratch[n]

    @kernel
    def dense_value(start: Array, dense: Array, fraction: float, first: int, count: int, out: Array) -> None:
        """out = components of the state at a fraction of the step; the bits of the start at 0.

            x(s) = x + s (d_0 + (1 - s) (d_1 + s (d_2 + (1 - s) (d_3 + ...))))

        start         x      at the begin of the step                (size + counted,)
        dense         d      from `prepare_dense`
        fraction      s      of the step, 0 to 1                     [-]
        first, count         which components
        out                                                          (count,)

        Source   as `make_dop853`
        Checked  tests/tethered_deorbit/test_integrator.py: order 7 within the step
        """
        rest = 1.0 - fraction
        for n in range(count):
            value = 0.0
            for i in range(DOP853_DENSE_ROWS):
                row = DOP853_DENSE_ROWS - 1 - i
                value = (value + dense[row * width + first + n]) * (fraction if i % 2 == 0 else rest)
            out[n] = start[first + n] + value

    @kernel
    def dense_rate(dense: Array, fraction: float, step: float, first: int, count: int, out: Array) -> None:
        """out = rate of components of the state at a fraction of the step [their unit/s].

        The derivative of `dense_value`.

        step          h                                              [s]
        The others as in `dense_value`.

        Source   as `make_dop853`; the product rule along its nested factors
        Checked  tests/tethered_deorbit/test_integrator.py: order 6 within the step
        """
        rest = 1.0 - fraction
        for n in range(count):
            value = 0.0
            slope = 0.0
            for i in range(DOP853_DENSE_ROWS):
                row = DOP853_DENSE_ROWS - 1 - i
                value += dense[row * width + first + n]
                if i % 2 == 0:
                    slope = slope * fraction + value
                    value *= fraction
                else:
                    slope = slope * rest - value
                    value *= rest
            out[n] = slope / step

    return AdaptiveScheme(attempt, error, prepare_dense, dense_value, dense_rate, _next_step, _shorter_step)
