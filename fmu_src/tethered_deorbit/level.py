"""How closely a tow is followed: whether every vibration of its taut line is, or none that has died."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.tethered_deorbit.idle import never, nothing, zero
from orbital.kernel import kernel


@kernel
def no_line(*arguments: Any) -> tuple[float, float, float]:
    """Nothing is held: never asked."""
    return 0.0, 0.0, 0.0


@kernel
def no_place(*arguments: Any) -> tuple[float, float]:
    """Nor placed."""
    return 0.0, 0.0


@kernel
def as_meant(record: Any, work: Any, step: float, limit: float, cap: float) -> float:
    """The step that is meant [s]: nothing ever settles.

    Checked  tests/tethered_deorbit/test_settled.py: where nothing can settle
    """
    return step


@kernel
def as_said(record: Any, work: Any, step: float, cap: float) -> float:
    """The step that is meant [s].

    Checked  tests/tethered_deorbit/test_settled.py: where nothing can settle
    """
    return step


class Held(NamedTuple):
    """Kernels of a line whose length is prescribed over a step, its tension being what holds it so. As it stands, those
    of a tow all of whose steps are resolved.

    settled(record) -> bool                      whether it is so now
    tension(record, state, rate, separation, length, speed, elapsed) -> T   of the free rate of a state; the rest as of
                                                 `Bodies.second`, `elapsed` [s] after the begin of the step
    along(record, tension, elapsed) -> (l, l', l'')   the line there [m], [m/s], [m/s2]
    mapped(record) -> bool                       whether it vibrates about that length, in closed form
    bounces(record) -> bool                      whether such a line goes slack at the end of the step
    beyond(record, elapsed) -> J                 impulse of that vibration since the begin of the step [N s]
    span(record, first, last) -> (least, largest)   tension between two instants of the step [N]
    sways                                        whether it is made fast on a body that turns
    """

    settled: Callable[..., Any] = never
    tension: Callable[..., Any] = zero
    along: Callable[..., Any] = no_line
    mapped: Callable[..., Any] = never
    bounces: Callable[..., Any] = never
    beyond: Callable[..., Any] = zero
    span: Callable[..., Any] = no_place
    sways: bool = False


class Level(NamedTuple):
    """Kernels of one level; as it stands, of one that resolves every vibration.

    begin(record)                      at the start of an instance
    restart(record, time)              the trajectory begins anew: every vibration counts
    look(record, work, step, limit, cap) -> step   at the begin of a taut step: whether its vibration has died, and the
                                       step to try [s]; of those given one is meant, one allowed, and one as long as it
                                       may be while the line vibrates
    prepare(record, work, step, cap) -> step   before a settled step is taken: the one to take [s]
    missed(record, work) -> e          after it: by how much the line was held wrongly, in tolerances
    leave(record, work, step, cap) -> step   go back to resolved steps where a shorter one gains nothing [s]
    place(record, state, tension, elapsed, length, speed) -> (l, l')   put a state within a settled step where the line
                                       is [m], [m/s]; in place
    put(record, settled)               whether the line is held
    publish(record)                    outputs of its own
    book(record)                       a step has been taken
    sways                              whether what is missed falls with the sixth power of a step, else with the fourth
    """

    begin: Callable[..., Any] = nothing
    restart: Callable[..., Any] = nothing
    look: Callable[..., Any] = as_meant
    prepare: Callable[..., Any] = as_said
    missed: Callable[..., Any] = zero
    leave: Callable[..., Any] = as_said
    place: Callable[..., Any] = no_place
    put: Callable[..., Any] = nothing
    publish: Callable[..., Any] = nothing
    book: Callable[..., Any] = nothing
    sways: bool = False


RESOLVED, UNHELD = Level(), Held()
