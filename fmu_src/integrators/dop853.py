"""The explicit scheme of Dormand and Prince, order 8(5,3): the default, fastest wherever nothing is stiff.

    x_i = x + h sum_j a_ij k_j,   k_i = f(x_i, c_i h),   x_end = x + h sum_j b_j k_j

Order      8; error estimate from embedded orders 5 and 3; dense output 7, continuous to the first derivative
Stability  h |lambda| up to 6.4 on the negative real axis and 5.97 on the imaginary one; below that an undamped
           oscillation decays, by 2.3e-11 of its size a step at 0.5, 2.4e-8 at 1, 2.7e-5 at 2
Cost       11 evaluations a step (the first is the last step's last), 3 more when dense output is asked for
Source     Hairer, Norsett and Wanner, Solving ordinary differential equations I (1993), section II.5 and II.6; the
           numbers are those of scipy's DOP853
Checked    tests/tethered_deorbit/test_integrator.py: slope of the error 8 and 7, edges of stability
"""

from __future__ import annotations

import importlib.util
import math
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from fmu_src.integrators.control import next_step_8, shorter_step_8
from fmu_src.integrators.nested import make_nested
from fmu_src.integrators.scheme import AdaptiveScheme
from orbital.kernel import kernel
from orbital.vectors import Array

STAGES = 12
ROWS = 16
"""Rows of stage memory: twelve stages, the derivative at the end of the step, three more for the dense output."""

DENSE_ROWS = 7


def _numbers_of_scipy() -> ModuleType:
    """The module of scipy that has them, without those around it, whose import takes half a second."""
    (folder,) = importlib.util.find_spec("scipy").submodule_search_locations  # type: ignore[union-attr, misc]
    path = Path(folder) / "integrate" / "_ivp" / "dop853_coefficients.py"
    found: Any = importlib.util.spec_from_file_location("dop853_coefficients", path)
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


tableau = _numbers_of_scipy()
# Frozen into the kernels as constants. A row of A per stage, the weights of the result as row 12 (A[12] is B).
_A = np.ascontiguousarray(tableau.A).reshape(-1)
_C = np.ascontiguousarray(tableau.C)
_E3 = np.ascontiguousarray(tableau.E3)
_E5 = np.ascontiguousarray(tableau.E5)
_D = np.ascontiguousarray(tableau.D).reshape(-1)

DAMPED_REACH, UNDAMPED_REACH = 3.0, 1.0
"""Longest step in radians of an oscillation: damped, inside stability (5.97); undamped."""
FULL_REACH_DAMPING = 0.05
"""Damping ratio from which the longest step is allowed."""


@kernel
def reach(damping: float) -> float:
    """Longest step in radians of an oscillation [-]: the scheme's own damping stays about a hundredth of the other.

        h omega <= 3 (20 zeta)^(1/8),   held between 1 and 3

    In h omega radians the scheme takes about 2.4e-8 (h omega)^10 off a vibration, a dashpot takes zeta h omega.

    damping       zeta   half the damping rate over omega        [-]

    Valid    omega the frequency of the fastest motion, that of the dashpot when it is faster than the spring
    Source   stability function of `make_dop853`
    Checked  tests/tethered_deorbit/test_turning.py
    """
    allowed = DAMPED_REACH * math.sqrt(math.sqrt(math.sqrt(min(1.0, damping / FULL_REACH_DAMPING))))
    return float(max(UNDAMPED_REACH, allowed))


def make_dop853(
    derivative: Callable[..., Any], squared_error: Callable[..., Any], size: int, counted: int = 0
) -> AdaptiveScheme:
    """The kernels for one set of equations.

    derivative(context, state, rate, elapsed)   writes d(state)/dt, at `elapsed` [s] after the begin of the step
    squared_error(context, state, error)        square of the error's size in units of the tolerance [-]
    size                                        number of components
    counted                                     components behind those that the equations do not depend on: integrals
                                                along the way, for which no stage is formed

    A state, a rate and a row of stages hold size + counted numbers. What `squared_error` makes of the counted ones is
    its own affair; where it leaves them out the others keep their bits.

    Source   as the module's
    Checked  tests/tethered_deorbit/test_integrator.py
    """
    width = size + counted

    @kernel
    def attempt(context: Any, start: Array, step: float, stages: Array, end: Array) -> None:
        """One step: fills the stages, the state at its end and, as row 12, the derivative there.

            x_i = x + h sum_j a_ij k_j,   k_i = f(x_i, c_i h),   x_end = x + h sum_j b_j k_j

        start         x      (size + counted,)
        step          h                                              [s]
        stages        k      rows of size + counted, row 0 given     (ROWS rows)
        end           x_end  out                                     (size + counted,)

        Source   as `make_dop853`
        Checked  tests/tethered_deorbit/test_integrator.py: order 8, and lower with one coefficient off
        """
        for i in range(1, STAGES + 1):
            for n in range(size):
                end[n] = 0.0
            for j in range(i):
                weight = _A[i * ROWS + j]
                if weight != 0.0:
                    row = stages[j * width : (j + 1) * width]
                    for n in range(size):
                        end[n] += weight * row[n]
            for n in range(size):
                end[n] = start[n] + step * end[n]
            derivative(context, end, stages[i * width : (i + 1) * width], _C[i] * step)
        for n in range(size, width):
            integral = 0.0
            for j in range(STAGES):
                integral += _A[STAGES * ROWS + j] * stages[j * width + n]
            end[n] = start[n] + step * integral

    @kernel
    def error(context: Any, end: Array, step: float, stages: Array, low: Array, high: Array) -> float:
        """Estimated error of the step in units of the tolerance [-]; above 1 it is to be taken again, shorter.

            e = h |e5|^2 / sqrt(|e5|^2 + 0.01 |e3|^2),   e5 and e3 the errors by the embedded orders 5 and 3

        low, high     room for e3 and e5                             (size + counted,)

        Source   as `make_dop853`
        Checked  tests/tethered_deorbit/test_estimated_error.py: its size, against scipy's
        """
        for n in range(width):
            low[n] = 0.0
            high[n] = 0.0
        for j in range(STAGES + 1):
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

        dense         out    rows of size + counted                  (DENSE_ROWS rows)
        scratch       room                                           (size + counted,)

        Source   as `make_dop853`
        Checked  tests/tethered_deorbit/test_integrator.py: order 7 within the step
        """
        for i in range(STAGES + 1, ROWS):
            for n in range(size):
                scratch[n] = 0.0
            for j in range(i):
                weight = _A[i * ROWS + j]
                if weight != 0.0:
                    for n in range(size):
                        scratch[n] += weight * stages[j * width + n]
            for n in range(size):
                scratch[n] = start[n] + step * scratch[n]
            derivative(context, scratch, stages[i * width : (i + 1) * width], _C[i] * step)
        for n in range(width):
            change = end[n] - start[n]
            first = step * stages[n]
            last = step * stages[STAGES * width + n]
            dense[n] = change
            dense[width + n] = first - change
            dense[2 * width + n] = 2.0 * change - (first + last)
        for i in range(4):
            for n in range(width):
                scratch[n] = 0.0
            for j in range(ROWS):
                weight = _D[i * ROWS + j]
                if weight != 0.0:
                    for n in range(width):
                        scratch[n] += weight * stages[j * width + n]
            for n in range(width):
                dense[(3 + i) * width + n] = step * scratch[n]

    dense_value, dense_rate = make_nested(width, DENSE_ROWS)
    return AdaptiveScheme(
        ROWS * width,
        STAGES * width,
        DENSE_ROWS * width,
        attempt,
        error,
        prepare_dense,
        dense_value,
        dense_rate,
        next_step_8,
        shorter_step_8,
        reach,
    )
