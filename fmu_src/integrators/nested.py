"""Dense output as a nested polynomial: the state within a step from the rows that a scheme has prepared."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from orbital.kernel import kernel
from orbital.vectors import Array


def make_nested(width: int, rows: int) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """The kernels `dense_value` and `dense_rate` of `AdaptiveScheme`.

        x(s) = x + s (d_0 + (1 - s) (d_1 + s (d_2 + (1 - s) (d_3 + ...))))

    With d_0 = x_end - x, d_1 = h f - d_0 and d_2 = 2 d_0 - h f - h f_end the polynomial has value and slope of both
    ends, whatever the rows behind these are.

    width         components of a state and of a row
    rows          of d

    Source   Hairer, Norsett and Wanner (1993), section II.6
    Checked  tests/tethered_deorbit/test_integrator.py: order within the step
    """

    @kernel
    def dense_value(start: Array, dense: Array, fraction: float, first: int, count: int, out: Array) -> None:
        """out = components of the state at a fraction of the step; the bits of the start at 0.

        start         x      at the begin of the step                (width,)
        dense         d      from `prepare_dense`
        fraction      s      of the step, 0 to 1                     [-]
        first, count         which components
        out                                                          (count,)

        Source   as `make_nested`
        Checked  tests/tethered_deorbit/test_integrator.py: order within the step
        """
        rest = 1.0 - fraction
        for n in range(count):
            value = 0.0
            for i in range(rows):
                row = rows - 1 - i
                value = (value + dense[row * width + first + n]) * (fraction if row % 2 == 0 else rest)
            out[n] = start[first + n] + value

    @kernel
    def dense_rate(dense: Array, fraction: float, step: float, first: int, count: int, out: Array) -> None:
        """out = rate of components of the state at a fraction of the step [their unit/s].

        The derivative of `dense_value`.

        step          h                                              [s]
        The others as in `dense_value`.

        Source   as `make_nested`; the product rule along its nested factors
        Checked  tests/tethered_deorbit/test_integrator.py: order within the step
        """
        rest = 1.0 - fraction
        for n in range(count):
            value = 0.0
            slope = 0.0
            for i in range(rows):
                row = rows - 1 - i
                value += dense[row * width + first + n]
                if row % 2 == 0:
                    slope = slope * fraction + value
                    value *= fraction
                else:
                    slope = slope * rest - value
                    value *= rest
            out[n] = slope / step

    return dense_value, dense_rate
