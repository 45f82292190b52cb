"""Rows of a model's table, one maker for each kind that several models have.

Where a row is an array, its name says so by `[#]`, as in `Variable`; `vector`, `moving` and `rate` add it themselves.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from fmu_src.interface import INDEX, Causality, Value, Variable


def parameter(
    name: str,
    unit: str,
    description: str,
    start: Value | Sequence[Value],
    low: float = -math.inf,
    high: float = math.inf,
    **more: Any,
) -> Variable:
    """A parameter from `low` to `high`, both included."""
    return Variable(name, unit, "parameter", description, start, minimum=low, maximum=high, **more)


def at_least_zero(
    name: str, unit: str, description: str, start: float, high: float = math.inf, **more: Any
) -> Variable:
    """A parameter that may be zero but not less."""
    return parameter(name, unit, description, start, 0.0, high, **more)


def positive(name: str, unit: str, description: str, start: float, high: float = math.inf, **more: Any) -> Variable:
    """A parameter greater than zero."""
    return parameter(name, unit, description, start, 0.0, high, open_minimum=True, **more)


def angle(name: str, description: str, start: float, low: float = -math.inf, high: float = math.inf) -> Variable:
    """An angle as a parameter, shown in degrees."""
    return parameter(name, "rad", description, start, low, high, display_unit="deg")


def choice(name: str, description: str, choices: tuple[str, ...]) -> Variable:
    """An Integer parameter that means one of these; the first is the default."""
    return parameter(name, "1", description, 0, 0, len(choices) - 1, kind="Integer", choices=choices)


def moving_input(
    name: str, unit: str, description: str, low: float, high: float, nominal: float
) -> tuple[Variable, Variable]:
    """A Real input, and where the rate is kept at which it moves during a step."""
    held = rate(name.replace(".", "_"), per_second(unit))
    return Variable(name, unit, "input", description, minimum=low, maximum=high, nominal=nominal, rate=held.name), held


def output(name: str, unit: str, description: str, nominal: float = 0.0, rate: str = "", **more: Any) -> Variable:
    """A Real output."""
    return Variable(name, unit, "output", description, nominal=nominal, rate=rate, **more)


def peak(name: str, unit: str, description: str, nominal: float = 0.0, **more: Any) -> Variable:
    """A Real output that remembers: it stands still but for jumps."""
    return output(name, unit, description, nominal, discrete=True, **more)


def flag(name: str, description: str, **more: Any) -> Variable:
    """A Boolean output."""
    return Variable(name, "1", "output", description, False, kind="Boolean", **more)


def count(name: str, description: str, causality: Causality = "output", **more: Any) -> Variable:
    """An Integer that counts."""
    return Variable(name, "1", causality, description, 0, kind="Integer", minimum=0, **more)


def vector(
    name: str,
    unit: str,
    description: str,
    causality: Causality = "output",
    start: Value | Sequence[Value] = 0.0,
    **more: Any,
) -> Variable:
    """Three components of one quantity."""
    return Variable(f"{name}{INDEX}", unit, causality, description, start, shape=(3,), **more)


def moving(
    name: str, description: str, velocity: str, nominal: float = 10.0, speed: float = 1.0, rate: str = ""
) -> tuple[Variable, Variable]:
    """A position and its velocity, three components each.

    velocity    what the velocity is
    speed       its typical size [m/s]
    rate        the row that holds the rate of the velocity, where there is one
    """
    return (
        vector(f"{name}.position", "m", description, nominal=nominal, rate=f"{name}.velocity{INDEX}"),
        vector(f"{name}.velocity", "m/s", velocity, nominal=speed, rate=rate),
    )


def state(name: str, unit: str, description: str, **more: Any) -> Variable:
    """A number that only the kernels see."""
    return Variable(name, unit, "state", description, **more)


def rate(name: str, unit: str, shape: tuple[int, ...] = ()) -> Variable:
    """Where the time derivative of an input or output is kept: `rate.<name>`."""
    return state(f"rate.{name}{INDEX * len(shape)}", unit, "time derivative", shape=shape)


def partial(name: str, unit: str) -> Variable:
    """Where the derivative of an output by an input is kept: `partial.<name>`."""
    return state(f"partial.{name}", unit, "direct derivative")


def per_second(unit: str) -> str:
    """FMI unit of the rate of a quantity: m gives m/s, m/s gives m/s2."""
    over, _, power = unit.rpartition("/s")
    return f"{unit}/s" if not over or power else f"{over}/s2"
