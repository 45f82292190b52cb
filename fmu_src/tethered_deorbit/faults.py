"""How a kernel says what is at fault: a code, which variable or component, and its value."""

from __future__ import annotations

import math
from typing import Any

from orbital.kernel import kernel


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


@kernel
def fail(record: Any, code: int, time: float) -> int:
    """The code, with when [s] put in the record.

    `time` counts from the start of the instance, as everywhere below the entry; the importer is told its own.

    Checked  tests/tethered_deorbit/test_macro_step.py: at a late start; test_robust.py
    """
    r = record[0]
    r.fault_code = code
    r.fault_time = r.state_start + time
    return code
