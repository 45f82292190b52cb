"""The input of a law of the line: how it is read and written, and what is asked of one that moves a length."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.interface import NO_LENGTH
from orbital.kernel import kernel


def make_command(field: str) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """The kernels `asked` and `leave` of `law.Reel` for the input with this field in the record.

    Checked  tests/tethered_deorbit/test_ramps.py
    """
    rate_field = f"rate_{field}"

    @kernel
    def asked(record: Any) -> tuple[float, float]:
        """What the input says: its value and its rate [its unit, its unit/s].

        Checked  tests/tethered_deorbit/test_ramps.py
        """
        r = record[0]
        return r[field], r[rate_field]

    @kernel
    def leave(record: Any, value: float) -> None:
        """Write the value the input has reached back to it.

        Checked  tests/tethered_deorbit/test_ramps.py: a ramp leaves its last value
        """
        record[0][field] = value

    return asked, leave


def make_shortest(slot: int) -> Callable[..., Any]:
    """The kernel `(record, length, rate, duration) -> (shortest, fault)`: the least a moving length [m] comes to.

    slot          value reference that is blamed when that is no length

    Checked  tests/tethered_deorbit/test_ramps.py
    """

    @kernel
    def shortest_on_the_way(record: Any, length: float, rate: float, duration: float) -> tuple[float, int]:
        """Least length [m] on the way, and 0 or the fault of one that is no length.

        length        as the step begins                             [m]
        rate          of the length                                  [m/s]
        duration      of the step                                    [s]

        Checked  tests/tethered_deorbit/test_ramps.py: lines that would vanish on the way
        """
        shortest = min(length, length + rate * duration)
        if not 0.0 < shortest < math.inf:
            return shortest, blame(record, NO_LENGTH, slot, shortest)
        return shortest, 0

    return shortest_on_the_way
