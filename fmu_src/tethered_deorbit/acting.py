"""What parts do by themselves on the way: at instants they know, or where the state makes them.

A step of the integrator ends exactly there; the part then sets what it sets, and the trajectory begins anew. So what a
part does depends on the motion and the instance's own clock, never on communication points.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import reduce
from typing import Any, NamedTuple

from fmu_src.tethered_deorbit.idle import always, no_end, no_fault
from orbital.kernel import kernel
from orbital.vectors import Array


class Acting(NamedTuple):
    """Kernels of one part; as it stands, those of a part that does nothing by itself.

    begin(record, state) -> fault          at the start, the state being there, in inertial axes
    due(record) -> time                    next instant at which it acts, infinite if it knows none [s]
    limit(record) -> tension               above which a taut line makes it act [N]; also a peak within a step does
    longest(record, state) -> step         over which `holds` can be judged by the step's end alone [s]
    holds(record, state, since) -> bool    whether it need not act yet; axes of the state may have turned, `since` [s]
                                           after the inputs in force began to move. False at one end of a step and not
                                           at the other, it is sought in between
    act(record, state, time, by_state) -> fault   do it; `by_state` where `holds` has just ceased or the tension reached
                                           `limit`. A part that is not concerned is called as well and
                                           does nothing. What it leaves must hold, and be due later than `time`
    """

    begin: Callable[..., Any] = no_fault
    due: Callable[..., Any] = no_end
    limit: Callable[..., Any] = no_end
    longest: Callable[..., Any] = no_end
    holds: Callable[..., Any] = always
    act: Callable[..., Any] = no_fault


IDLE = Acting()


def together(parts: Iterable[Acting]) -> Acting:
    """Several parts as one. They act in their order, and the first fault counts."""
    return reduce(_both, (part for part in parts if part is not IDLE), IDLE)


def _both(first: Acting, second: Acting) -> Acting:
    """Two parts as one."""
    if first is IDLE:
        return second

    @kernel
    def begin(record: Any, state: Array) -> int:
        """The start of both.

        Checked  tests/tethered_deorbit/test_ends.py
        """
        fault: int = first.begin(record, state)
        return fault if fault != 0 else int(second.begin(record, state))

    @kernel
    def due(record: Any) -> float:
        """The earlier instant [s].

        Checked  tests/tethered_deorbit/test_ends.py
        """
        return min(float(first.due(record)), float(second.due(record)))

    @kernel
    def limit(record: Any) -> float:
        """The lower tension [N].

        Checked  tests/tethered_deorbit/test_ends.py
        """
        return min(float(first.limit(record)), float(second.limit(record)))

    @kernel
    def longest(record: Any, state: Array) -> float:
        """The shorter step [s].

        Checked  tests/tethered_deorbit/test_ends.py
        """
        return min(float(first.longest(record, state)), float(second.longest(record, state)))

    @kernel
    def holds(record: Any, state: Array, since: float) -> bool:
        """Whether neither need act.

        Checked  tests/tethered_deorbit/test_ends.py
        """
        return bool(first.holds(record, state, since)) and bool(second.holds(record, state, since))

    @kernel
    def act(record: Any, state: Array, time: float, by_state: bool) -> int:
        """Each in its turn: what is not concerned sets what is set.

        Checked  tests/tethered_deorbit/test_ends.py
        """
        fault = int(first.act(record, state, time, by_state))
        return fault if fault != 0 else int(second.act(record, state, time, by_state))

    return Acting(begin, due, limit, longest, holds, act)
