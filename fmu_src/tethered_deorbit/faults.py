"""How a kernel says what is at fault: a code, which variable or component, and its value."""

from __future__ import annotations

import math
from typing import Any

from fmu_src.interface import HEAD, Interface, Variable
from fmu_src.tethered_deorbit.interface import MODEL
from orbital.kernel import kernel


def base_slot(name: str) -> int:
    """Value reference of a variable that every choice of terms has in the same place."""
    return Interface(MODEL, {}, HEAD + MODEL.base).references[name]


def own_slot(name: str, *groups: tuple[Variable, ...]) -> int:
    """Value reference of a variable of the first group that has it; the groups follow the base in this order."""
    variables = HEAD + MODEL.base + tuple(v for group in groups for v in group)
    return Interface(MODEL, {}, variables).references[name]


@kernel
def blame(record: Any, code: int, index: int, value: float) -> int:
    """The fault, with what is at fault put in the record; a value that is no number is shown as zero.

    index         value reference of a variable, or component of the state counted from 1, or 0
    value         SI

    Checked  tests/tethered_deorbit/test_robust.py
    """
    r = record[0]
    r.fault_index = index
    r.fault_value = value if math.isfinite(value) else 0.0
    return code
