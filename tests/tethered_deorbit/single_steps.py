"""Single steps of every scheme, of a Kepler orbit and an oscillator."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from fmu_src.integrators import dop853, gauss, radau
from fmu_src.integrators.scheme import AdaptiveScheme
from orbital.kepler import propagate
from orbital.kernel import kernel
from orbital.twobody import two_body_acceleration

uncompiled = pytest.mark.usefixtures("plain")
SIZE = 6
TIGHT = 1e10
"""What errors are multiplied by where iterations are to end at rounding."""


@kernel
def kepler(context: Any, state: Any, rate: Any, elapsed: float) -> None:
    two_body_acceleration(rate[3:6], state[0:3], 1.0)
    for i in range(3):
        rate[i] = state[3 + i]


@kernel
def oscillator(context: Any, state: Any, rate: Any, elapsed: float) -> None:
    """Frequency 1, damping ratio from the context."""
    rate[0] = state[1]
    rate[1] = -state[0] - 2.0 * context[0] * state[1]


@kernel
def drive(context: Any, state: Any, rate: Any, elapsed: float) -> None:
    """x' = y, y' = cos t, the time of a step's begin in the context: the time of each stage counts."""
    rate[0] = state[1]
    rate[1] = math.cos(context[0] + context[1] * elapsed)


@kernel
def squared(context: Any, state: Any, error: Any) -> float:
    total = 0.0
    for i in range(len(error)):
        total += error[i] * error[i]
    return total


@kernel
def strict(context: Any, state: Any, error: Any) -> float:
    """The same, of an error times TIGHT."""
    return float(squared(context, state, error) * TIGHT * TIGHT)


@dataclass(frozen=True)
class Said:
    """What a scheme says of itself, and steps at which its errors are far from rounding and already asymptotic.

    order, dense   of the result, and of the dense output
    estimate       power of the step with which the estimated error falls
    counts         steps per revolution; near: of a single step
    spoil          coefficients, one of which off by 1 % costs the order: of the result, and of the dense output alone
    """

    make: Callable[..., AdaptiveScheme]
    module: Any
    order: int
    dense: int
    estimate: int
    counts: tuple[int, ...]
    near: tuple[float, ...]
    spoil: tuple[tuple[str, int], ...]
    spoil_dense: tuple[tuple[str, int], ...]


SCHEMES = {
    "dop853": Said(dop853.make_dop853, dop853, 8, 7, 8, (32, 38, 46, 56), (0.5, 0.4, 0.32, 0.25),
                   (("_A", 12 * 16 + 6), ("_A", 7 * 16 + 6)), (("_D", 6),)),
    "gauss": Said(gauss.make_gauss, gauss, 8, 7, 8, (14, 17, 20, 25), (0.5, 0.4, 0.32, 0.25),
                  (("_A", 6), ("_B", 1)), (("_REST", 5), ("_CUBIC", 4))),
    "radau": Said(radau.make_radau, radau, 5, 3, 4, (50, 80, 120, 180), (0.12, 0.09, 0.06, 0.04),
                  (("T", 1), ("T_INVERSE", 4)), (("_FIRST", -1),)),
}  # fmt: skip
each = pytest.mark.parametrize("name", SCHEMES)


def steps_of(
    derivative: Callable[..., Any], scheme: AdaptiveScheme, start: Any, step: float, count: int = 1, context: Any = None
) -> Any:
    """State before and after the last of so many steps, and the stage memory of that one."""
    context = np.zeros(1) if context is None else context
    state, end, stages = start.copy(), start.copy(), np.zeros(scheme.stages)
    for _ in range(count):
        state = end.copy()
        derivative(context, state, stages[: len(start)], 0.0)
        scheme.attempt(context, state, step, stages, end)
    return state, end, stages


START = np.array([0.95, 0.0, 0.0, 0.0, math.sqrt(1.05 / 0.95), 0.0])
"""Perigee of an ellipse with semi-major axis 1 and eccentricity 0.05."""


def exact(time: float) -> Any:
    out = np.zeros(6)
    propagate(out[:3], out[3:], START[:3], START[3:], time, 1.0)
    return out


def slope(steps: Any, errors: Any) -> float:
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])
