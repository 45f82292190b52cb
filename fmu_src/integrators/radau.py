"""The scheme Radau IIA of three stages: implicit, for stiff, damped lines; of order 5.

    z_i = h sum_j a_ij f(x + z_j, c_j h),   x_end = x + z_3,   c = (4 - sqrt 6)/10, (4 + sqrt 6)/10, 1

It collocates at c, the end among them, so that of what decays within a step 3/(h |lambda|) is left at its end (stiffly
accurate). A vibration that nothing else damps it damps itself: by 1.4e-10 of its size a step at h |lambda| = 0.1, by
2.1e-6 at 0.5, by 1.3e-4 at 1.

Stages     by simplified Newton iteration on the system that T turns into one real and one complex part; Jacobian by
           differences at the begin of every step. It ends when what is left is below a hundredth of the tolerance
Order      5; error estimate of order 3, filtered, so that it does not see what is stiff; dense output 3, the
           collocation polynomial. The estimate falls with the fourth power of the step, the error with the sixth: where
           nothing is stiff the steps are far shorter than the tolerance needs
Stability  L-stable: all of the left half of the plane, and R(-inf) = 0
Cost       one evaluation per component for the Jacobian, 3 an iteration, 2 to 5 iterations, one real and one complex
           elimination a step
Source     Hairer and Wanner, Solving ordinary differential equations II (1996), table IV.5.6 and section IV.8
Checked    tests/tethered_deorbit/test_integrator.py: slope of the error 5 and 3, stability, what a stiff decay leaves
"""

from __future__ import annotations

import math
from collections.abc import Callable
from decimal import Decimal
from typing import Any

import numpy as np

from fmu_src.integrators import collocation
from fmu_src.integrators.control import next_step_4, shorter_step_4
from fmu_src.integrators.elimination import factor, factor_complex, solve, solve_complex
from fmu_src.integrators.nested import make_nested
from fmu_src.integrators.scheme import AdaptiveScheme
from orbital.kernel import kernel
from orbital.vectors import Array

STAGES = 3
DENSE_ROWS = 3
ITERATIONS = 10
CONVERGED = 0.01
"""What the iteration may leave, in tolerances."""
STALLED = 0.1
"""Below this an iteration that no longer gains has met rounding."""
SMALL = 1.0e-5
EPSILON = 2.220446049250313e-16


@collocation.exact
def _nodes() -> list[Decimal]:
    """(4 -+ sqrt 6)/10 and 1."""
    root = Decimal(6).sqrt()
    return [(4 - root) / 10, (4 + root) / 10, Decimal(1)]


@collocation.exact
def _powers() -> tuple[Decimal, Decimal]:
    """Cube roots of 3 and of 9."""
    third = Decimal(1) / 3
    return Decimal(3) ** third, Decimal(9) ** third


@collocation.exact
def _eigenvalues() -> tuple[float, float, float]:
    """Of the inverse of a: one real, and real and imaginary part of the pair.

    3 + 9^(1/3) - 3^(1/3),   3 + (3^(1/3) - 9^(1/3))/2,   (3^(5/6) + 3^(7/6))/2
    """
    three, nine = _powers()
    root = Decimal(3).sqrt()
    return float(3 + nine - three), float(3 + (three - nine) / 2), float(root * (three + nine) / 2)


_C = _nodes()

# Frozen into the kernels as constants.
_CF = np.array([float(c) for c in _C])
_A = collocation.integrals(_C, _C).reshape(-1)
REAL, PAIR, TURN = _eigenvalues()
_T = (
    (Decimal("0.091232394870892942792"), Decimal("-0.14125529502095420843"), Decimal("-0.030029194105147424492")),
    (Decimal("0.24171793270710701896"), Decimal("0.20412935229379993199"), Decimal("0.38294211275726193779")),
    (Decimal("0.96604818261509293619"), Decimal(1), Decimal(0)),
)
"""Turns the inverse of a into REAL and the pair; that they do is tested, and the result does not depend on them."""
T = np.array(_T, float).reshape(-1)
T_INVERSE = collocation.inverse(_T).reshape(-1)
_ROOT = math.sqrt(6.0)
_E = np.array([-13.0 - 7.0 * _ROOT, -13.0 + 7.0 * _ROOT, -1.0]) / 3.0
_FIRST, _SECOND = float(_C[0]), float(_C[1])


@kernel
def reach(damping: float) -> float:
    """Longest step in radians of an oscillation [-]: there is none.

    Checked  tests/tethered_deorbit/test_field_free.py: what is stiff costs nothing
    """
    return math.inf


def make_radau(
    derivative: Callable[..., Any], squared_error: Callable[..., Any], size: int, counted: int = 0
) -> AdaptiveScheme:
    """The kernels for one set of equations; arguments as for `dop853.make_dop853`.

    Source   as the module's
    Checked  tests/tethered_deorbit/test_integrator.py
    """
    width, square = size + counted, size * size
    last = width
    # rows of the stages z, of w = T^-1 z, of derivatives or right-hand sides, and room for a state and a rate
    at_z, at_w, at_f, at_state, at_rate = (row * width for row in (2, 5, 8, 11, 12))
    jacobian = 13 * width
    real, pair, beside = (jacobian + i * square for i in (1, 2, 3))
    pivots = jacobian + 4 * square
    flag = pivots + 2 * size

    @kernel
    def prepare(context: Any, start: Array, step: float, stages: Array) -> None:
        """The Jacobian at the begin of the step, and both matrices of the iteration in triangular factors.

            J_ij = (f_i(x + d e_j) - f_i(x))/d,   d = sqrt(eps max(1e-5, |x_j|))
            (REAL/h) 1 - J,   ((PAIR + i TURN)/h) 1 - J

        Source   Hairer and Wanner (1996), section IV.8, eq. 8.7 and the choice of d in RADAU5
        Checked  tests/tethered_deorbit/test_integrator.py
        """
        state, rate = stages[at_state : at_state + width], stages[at_rate : at_rate + width]
        for n in range(width):
            state[n] = start[n]
        for j in range(size):
            state[j] = start[j] + math.sqrt(EPSILON * max(SMALL, abs(start[j])))
            apart = state[j] - start[j]
            derivative(context, state, rate, 0.0)
            state[j] = start[j]
            for i in range(size):
                stages[jacobian + i * size + j] = (rate[i] - stages[i]) / apart
        for i in range(square):
            stages[real + i] = -stages[jacobian + i]
            stages[pair + i] = -stages[jacobian + i]
            stages[beside + i] = 0.0
        for i in range(size):
            stages[real + i * (size + 1)] += REAL / step
            stages[pair + i * (size + 1)] += PAIR / step
            stages[beside + i * (size + 1)] += TURN / step
        factor(stages[real : real + square], stages[pivots : pivots + size], size)
        factor_complex(
            stages[pair : pair + square],
            stages[beside : beside + square],
            stages[pivots + size : pivots + 2 * size],
            size,
        )

    @kernel
    def iterate(context: Any, start: Array, step: float, stages: Array) -> float:
        """One iteration of simplified Newton; returns the size of the largest change of a stage, in tolerances [-].

            (REAL/h - J) dw_1 = (T^-1 f)_1 - REAL/h w_1,   the same of the pair w_2 + i w_3;   z = T w

        Source   Hairer and Wanner (1996), section IV.8, eq. 8.4
        Checked  tests/tethered_deorbit/test_integrator.py
        """
        state = stages[at_state : at_state + width]
        for i in range(STAGES):
            for n in range(size):
                state[n] = start[n] + stages[at_z + i * width + n]
            derivative(context, state, stages[at_f + i * width : at_f + (i + 1) * width], _CF[i] * step)
        first, second, third = at_f, at_f + width, at_f + 2 * width
        for n in range(size):
            f, g, k = stages[first + n], stages[second + n], stages[third + n]
            u, v, w = stages[at_w + n], stages[at_w + width + n], stages[at_w + 2 * width + n]
            stages[first + n] = T_INVERSE[0] * f + T_INVERSE[1] * g + T_INVERSE[2] * k - REAL / step * u
            stages[second + n] = T_INVERSE[3] * f + T_INVERSE[4] * g + T_INVERSE[5] * k - (PAIR * v - TURN * w) / step
            stages[third + n] = T_INVERSE[6] * f + T_INVERSE[7] * g + T_INVERSE[8] * k - (TURN * v + PAIR * w) / step
        solve(stages[real : real + square], stages[pivots : pivots + size], size, stages[first : first + size])
        solve_complex(
            stages[pair : pair + square],
            stages[beside : beside + square],
            stages[pivots + size : pivots + 2 * size],
            size,
            stages[second : second + size],
            stages[third : third + size],
        )
        largest = 0.0
        for i in range(STAGES):
            for n in range(size, width):
                state[n] = 0.0
            for n in range(size):
                state[n] = T[3 * i] * stages[first + n] + T[3 * i + 1] * stages[second + n]
                state[n] += T[3 * i + 2] * stages[third + n]
                stages[at_z + i * width + n] += state[n]
                stages[at_w + i * width + n] += stages[at_f + i * width + n]
            change = squared_error(context, start, state)
            if not change <= largest:
                largest = change
        return math.sqrt(largest)

    @kernel
    def count_up(context: Any, start: Array, step: float, stages: Array, end: Array) -> None:
        """Counted components at stages and end, from derivatives at the stages that were found.

            z_i = h sum_j a_ij f_j

        Source   as the module's
        Checked  tests/tethered_deorbit/test_integrator.py: as if they had been integrated with the others
        """
        state = stages[at_state : at_state + width]
        for i in range(STAGES - 1):
            for n in range(size):
                state[n] = start[n] + stages[at_z + i * width + n]
            derivative(context, state, stages[at_f + i * width : at_f + (i + 1) * width], _CF[i] * step)
        for n in range(size, width):
            for i in range(STAGES):
                total = _A[STAGES * i + 2] * stages[last + n]
                for j in range(STAGES - 1):
                    total += _A[STAGES * i + j] * stages[at_f + j * width + n]
                stages[at_z + i * width + n] = step * total
            end[n] = start[n] + stages[at_z + 2 * width + n]

    @kernel
    def attempt(context: Any, start: Array, step: float, stages: Array, end: Array) -> None:
        """One step: the stages, the state at its end and the derivative there, as `AdaptiveScheme` has it.

        start         x      (size + counted,)
        step          h                                              [s]
        stages               begins with f(x)
        end           x_end  out                                     (size + counted,)

        The iteration ends when by its rate of convergence less than `CONVERGED` is left.

        Source   as the module's
        Checked  tests/tethered_deorbit/test_integrator.py: order 5, and lower with one coefficient off
        """
        prepare(context, start, step, stages)
        for n in range(at_z, at_f):
            stages[n] = 0.0
        stages[flag] = 1.0
        before = math.inf
        for k in range(ITERATIONS):
            change = iterate(context, start, step, stages)
            share = change / before
            left = change if k == 0 else change * share / (1.0 - share)
            if change == 0.0 or (k > 0 and share < 1.0 and left <= CONVERGED) or (share >= 1.0 and change <= STALLED):
                stages[flag] = 0.0
                break
            if not change < math.inf or (k > 1 and share >= 2.0):
                break
            before = change
        for n in range(size):
            end[n] = start[n] + stages[at_z + 2 * width + n]
        derivative(context, end, stages[last : last + width], step)
        if counted:
            count_up(context, start, step, stages, end)

    @kernel
    def error(context: Any, end: Array, step: float, stages: Array, low: Array, high: Array) -> float:
        """Estimated error of the step in units of the tolerance [-]; infinite if the iteration has failed.

            e = (REAL/h - J)^-1 (f(x) + (e_1 z_1 + e_2 z_2 + e_3 z_3)/h)

        Where that is above 1, f(x) gives way to f(x + e), which takes out of it what is stiff.

        low, high     room                                           (size + counted,)

        Source   Hairer and Wanner (1996), section IV.8, eq. 8.19 and 8.20
        Checked  tests/tethered_deorbit/test_estimated_error.py: how it falls; that it is scipy's
        """
        if stages[flag] != 0.0:
            return math.inf
        for n in range(size, width):
            high[n] = 0.0
        size_of_it = 0.0
        for again in range(2):
            rate = stages[at_rate : at_rate + width] if again == 1 else stages[0:width]
            for n in range(size):
                high[n] = (
                    rate[n]
                    + (
                        _E[0] * stages[at_z + n]
                        + _E[1] * stages[at_z + width + n]
                        + _E[2] * stages[at_z + 2 * width + n]
                    )
                    / step
                )
            solve(stages[real : real + square], stages[pivots : pivots + size], size, high[0:size])
            size_of_it = math.sqrt(squared_error(context, end, high))
            if again == 1 or size_of_it <= 1.0:
                break
            for n in range(width):
                low[n] = end[n] - stages[at_z + 2 * width + n]
            for n in range(size):
                low[n] += high[n]
            derivative(context, low, stages[at_rate : at_rate + width], 0.0)
        return size_of_it

    @kernel
    def prepare_dense(
        context: Any, start: Array, end: Array, step: float, stages: Array, dense: Array, scratch: Array
    ) -> None:
        """Fill the three rows of the dense output: the collocation polynomial, through begin and stages.

        dense         out    rows of size + counted                  (DENSE_ROWS rows)
        scratch       unused

        Source   as the module's
        Checked  tests/tethered_deorbit/test_integrator.py: order 3 within the step
        """
        for n in range(width):
            change = stages[at_z + 2 * width + n]
            here = (stages[at_z + n] / _FIRST - change) / (1.0 - _FIRST)
            there = (stages[at_z + width + n] / _SECOND - change) / (1.0 - _SECOND)
            bend = (there - here) / (_SECOND - _FIRST)
            dense[n] = change
            dense[width + n] = here - _FIRST * bend
            dense[2 * width + n] = bend

    dense_value, dense_rate = make_nested(width, DENSE_ROWS)
    return AdaptiveScheme(
        flag + 1,
        last,
        DENSE_ROWS * width,
        attempt,
        error,
        prepare_dense,
        dense_value,
        dense_rate,
        next_step_4,
        shorter_step_4,
        reach,
    )
