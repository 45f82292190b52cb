"""The limits that a table of variables sets to its parameters, as a kernel.

The shim holds every value to them before it calls a kernel; this is for one that is called without it, as by
`instance.Instance`. So a number stands in the table alone, and what a model adds are conditions of several values.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

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
    found: Callable[..., Any] = no_limits
    for name in reversed(names):
        if name in rows:
            found = _and_then(rows[name], interface.references[name], found)
    return found


def _and_then(v: Variable, slot: int, others: Callable[..., Any]) -> Callable[..., Any]:
    """The kernel that judges one parameter, and then the others."""
    field, low, high, excluded = v.field, v.minimum, v.maximum, v.open_minimum

    @kernel
    def limits(record: Any) -> tuple[int, float]:
        """Slot and value of a parameter that is out of its bounds or not finite, else what the others say.

        Checked  tests/packaging/test_rows.py
        """
        value = float(record[0][field])
        if not (math.isfinite(value) and low <= value <= high) or (excluded and value == low):
            return slot, value
        found: tuple[int, float] = others(record)
        return found

    return limits
