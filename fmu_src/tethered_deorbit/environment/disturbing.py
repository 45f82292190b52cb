"""What one thing that disturbs an orbit brings."""

from __future__ import annotations

from collections.abc import Callable
from functools import reduce
from typing import Any, NamedTuple

from fmu_src.tethered_deorbit.idle import nothing
from orbital.kernel import kernel
from orbital.vectors import Array


class Disturbing(NamedTuple):
    """Kernels; as it stands, of nothing.

    add(record, state, rate)                  to the rate under gravity; the Earth's axis, Sun and Moon are pointed to
    publish(record, time)                     outputs, from those of bodies and centre; the same
    differentiate(record, center, velocity)   its potential's part in the rate of `energy.orbital`
    beside(record, state, offset, parting, rate)   to the acceleration of a node of the line from the target [m/s^2]
                                              what acts on it less what acts on the target, after `add` of the same
                                              state; its place and velocity from the target [m], [m/s], (3,) each
    """

    add: Callable[..., Any] = nothing
    publish: Callable[..., Any] = nothing
    differentiate: Callable[..., Any] = nothing
    beside: Callable[..., Any] = nothing


def together(parts: list[Disturbing]) -> Disturbing:
    """Several as one, in their order."""
    return reduce(_both, parts, Disturbing())


def _both(first: Disturbing, second: Disturbing) -> Disturbing:
    """Two as one."""
    return Disturbing(
        _in_turn(first.add, second.add),
        _published(first.publish, second.publish),
        _in_turn(first.differentiate, second.differentiate),
        _beside(first.beside, second.beside),
    )


def _in_turn(first: Callable[..., Any], second: Callable[..., Any]) -> Callable[..., Any]:
    """Two kernels of a record and two vectors, one after the other."""
    if first is nothing or second is nothing:
        return second if first is nothing else first

    @kernel
    def in_turn(record: Any, a: Array, b: Array) -> None:
        """Both.

        Checked  tests/tethered_deorbit/test_perturbed.py
        """
        first(record, a, b)
        second(record, a, b)

    return in_turn


def _beside(first: Callable[..., Any], second: Callable[..., Any]) -> Callable[..., Any]:
    """Two kernels of a record and four vectors, one after the other."""
    if first is nothing or second is nothing:
        return second if first is nothing else first

    @kernel
    def both_beside(record: Any, state: Array, offset: Array, parting: Array, rate: Array) -> None:
        """Both.

        Checked  tests/tethered_deorbit/test_nodes_in_orbit.py
        """
        first(record, state, offset, parting, rate)
        second(record, state, offset, parting, rate)

    return both_beside


def _published(first: Callable[..., Any], second: Callable[..., Any]) -> Callable[..., Any]:
    """Two kernels of a record and a time, one after the other."""
    if first is nothing or second is nothing:
        return second if first is nothing else first

    @kernel
    def published(record: Any, time: float) -> None:
        """Both.

        Checked  tests/tethered_deorbit/test_perturbed.py
        """
        first(record, time)
        second(record, time)

    return published
