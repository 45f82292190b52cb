"""A step of a pair of which a body turns: into its coordinates, out of them, and from one step to the next.

What the coordinates are stands in `carried`. The equations and what is searched in a step see the state as it is.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.tethered_deorbit.bodies.rigid import Rigid
from fmu_src.tethered_deorbit.bodies.wrapping import Wrapping
from fmu_src.tethered_deorbit.idle import nothing
from fmu_src.tethered_deorbit.layout import ATTITUDE, PAIR
from orbital.kernel import kernel, view
from orbital.rotations import normalise
from orbital.vectors import Array


class Stepping(NamedTuple):
    """Kernels of the same names as in `Bodies`."""

    rest: Callable[..., Any]
    enter: Callable[..., Any]
    go_on: Callable[..., Any]
    seen: Callable[..., Any]
    felt: Callable[..., Any]
    last_seen: Callable[..., Any]
    seen_rate: Callable[..., Any]
    enter_rate: Callable[..., Any]
    stays: Callable[..., Any]


def make_stepping(
    target: Rigid,
    chaser: Rigid,
    span: Callable[..., Any],
    wrapping: Wrapping,
    turning: Callable[..., Any],
    straight: bool,
    bodies: int,
    size: int,
) -> Stepping:
    """The kernels for two bodies.

    span(record, state, whole)   of the line: see `attached`
    wrapping      of the line round the target
    turning       of `bounds`
    straight      whether the line never wraps
    bodies        how many of them turn
    size          of the state

    Checked  tests/tethered_deorbit/test_rigid.py
    """
    keep, rise = wrapping.keep, wrapping.rise

    @kernel
    def leave(record: Any, state: Array, elapsed: float) -> None:
        """The state of a step as it is, in `state.seen`, without the line.

        Checked  tests/tethered_deorbit/test_rigid.py: three tugs
        """
        r = record[0]
        there = r.state_seen
        for i in range(size):
            there[i] = state[i]
        target.carried.leave(record, elapsed, state, there)
        chaser.carried.leave(record, elapsed, state, there)

    @kernel
    def find_line(record: Any, state: Array, whole: bool) -> None:
        """The line's vector and its rate, in `state.line`; after `leave`.

        state         in the coordinates of the step: those of a straight taut line hold it
        whole         as of `Wrapping.follow`

        Checked  tests/tethered_deorbit/test_rigid.py: three tugs
        """
        r = record[0]
        if straight and r.state_carried == 1:
            for i in range(3):
                r.state_line[0][i] = state[6 + i]
                r.state_line[1][i] = state[9 + i]
        else:
            span(record, r.state_seen, whole)

    @view
    def seen(record: Any, state: Array, elapsed: float) -> Array:
        """The state of a step as it is: see `Bodies`.

        Checked  tests/tethered_deorbit/test_rigid.py: three tugs
        """
        leave(record, state, elapsed)
        find_line(record, state, True)
        there: Array = record[0].state_seen
        return there

    @view
    def felt(record: Any, state: Array, elapsed: float) -> Array:
        """The same for the equations: see `Bodies`.

        Checked  tests/tethered_deorbit/test_rigid.py: three tugs
        """
        leave(record, state, elapsed)
        if record[0].state_taut:
            find_line(record, state, False)
        there: Array = record[0].state_seen
        return there

    @view
    def last_seen(record: Any, state: Array) -> Array:
        """What `seen` has left: see `Bodies`.

        Checked  tests/tethered_deorbit/test_rigid.py: three tugs
        """
        there: Array = record[0].state_seen
        return there

    @kernel
    def rest(record: Any) -> None:
        """A step of no length.

        Checked  tests/tethered_deorbit/test_rigid_outputs.py: macro steps change nothing
        """
        record[0].state_carried = 0
        target.carried.rest(record)
        chaser.carried.rest(record)

    @kernel
    def settle(state: Array) -> None:
        """Attitudes back to unit length.

        Checked  tests/tethered_deorbit/test_rigid.py
        """
        for k in range(bodies):
            first = PAIR + ATTITUDE * k
            normalise(state[first : first + 4], state[first : first + 4])

    @kernel
    def enter(record: Any, state: Array) -> None:
        """Into the coordinates of a step: see `carried`.

        Checked  tests/tethered_deorbit/test_rigid.py: three tugs
        """
        settle(state)
        record[0].state_carried = record[0].state_taut
        target.carried.enter(record, state)
        chaser.carried.enter(record, state)

    @kernel
    def leave_rate(record: Any, state: Array, rate: Array) -> None:
        """The rate of that state, in `state.seen_rate`.

        Checked  tests/tethered_deorbit/test_rigid.py: three tugs
        """
        there = record[0].state_seen_rate
        for i in range(size):
            there[i] = rate[i]
        target.carried.leave_rate(record, state, there)
        chaser.carried.leave_rate(record, state, there)

    @view
    def seen_rate(record: Any, state: Array, rate: Array) -> Array:
        """The rate of that state: see `Bodies`.

        Checked  tests/tethered_deorbit/test_rigid.py: three tugs
        """
        leave_rate(record, state, rate)
        there: Array = record[0].state_seen_rate
        return there

    @kernel
    def enter_rate(record: Any, state: Array, there: Array, rate: Array) -> None:
        """The rate in the coordinates of the step: see `Bodies`.

        Checked  tests/tethered_deorbit/test_rigid.py: three tugs
        """
        target.carried.enter_rate(record, there, rate)
        chaser.carried.enter_rate(record, there, rate)
        for i in range(3):
            rate[6 + i] = state[9 + i]

    @kernel
    def hold_at_begin(record: Any, state: Array) -> None:
        """The same at the begin of a step, its attitudes being as they are.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        leave(record, state, 0.0)
        find_line(record, state, True)
        keep(record)
        target.set_pivot(record, r.state_seen, r.state_line[0], r.state_line[1])

    hold_way = nothing if straight else hold_at_begin

    @kernel
    def go_on(record: Any, time: float, state: Array, rate: Array) -> None:
        """From one step to the next: see `Bodies`.

        Checked  tests/tethered_deorbit/test_rigid.py: three tugs
        """
        target.carried.stay(record, time, state)
        chaser.carried.stay(record, time, state)
        settle(state)
        hold_way(record, state)
        target.carried.go_on(record, state, rate)
        chaser.carried.go_on(record, state, rate)

    @kernel
    def stays(record: Any, begin: Array, end: Array, step: float) -> bool:
        """Whether a straight line rises from its face throughout a step: see `Bodies`.

            a_0 + a_1 > 2 W h,   a the angle at which it rises at both ends, W the faster of its turning there

        From both ends it may sink by W t: at most it comes down to (a_0 + a_1 - W h)/2.

        Checked  tests/tethered_deorbit/test_settled_wrapped.py: a step that would go over an edge and back
        """
        seen(record, begin, 0.0)
        first = rise(record)
        seen(record, end, step)
        return bool(first + rise(record) > 2.0 * step * max(turning(begin), turning(end)))

    return Stepping(rest, enter, go_on, seen, felt, last_seen, seen_rate, enter_rate, stays)
