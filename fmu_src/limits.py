"""The limits that a table of variables sets to its parameters, as a kernel.

The shim holds every value to them before it calls a kernel; this is for one that is called without it, as by
`instance.Instance`. So a number stands in the table alone, and what a model adds are conditions of several values.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from fmu_src.interface import Interface, Variable
from orbital.kernel import kernel


@kernel
def no_limits(record: Any) -> tuple[int, float]:
    """Nothing is out of bounds."""
    return -1, 0.0


def make_limits(interface: Interface, *names: str) -> Callable[..., Any]:
    """The kernel (record) -> (slot, value) of the first parameter out of its bounds or not finite, or (-1, 0.0).

    names         scalar parameters, in the order they are looked through; those that this interface has

    Checked  tests/packaging/test_rows.py
    """
    rows = {v.name: v for v in interface.variables}
    there = [name for name in names if name in rows]
    slots = np.array([interface.references[name] for name in there] or [-1])
    first: Callable[..., Any] = no_limits
    for name in reversed(there):
        first = _and_then(rows[name], first)

    @kernel
    def limits(record: Any) -> tuple[int, float]:
        """Slot and value of the first one, by its place among them.

        Checked  tests/packaging/test_rows.py
        """
        place, value = first(record)
        return slots[place] if place >= 0 else -1, value

    return limits


def _and_then(v: Variable, others: Callable[..., Any]) -> Callable[..., Any]:
    """The kernel that judges one parameter, and then the others; it is the same wherever the record has them."""
    field, low, high, excluded = v.field, v.minimum, v.maximum, v.open_minimum

    @kernel
    def limits(record: Any) -> tuple[int, float]:
        """Place in the line, 0 for this one, and value of a parameter that is out of its bounds or not finite.

        Checked  tests/packaging/test_rows.py
        """
        value = float(record[0][field])
        if not (math.isfinite(value) and low <= value <= high) or (excluded and value == low):
            return 0, value
        place, value = others(record)
        return place + 1 if place >= 0 else -1, value

    return limits
