"""What a law of the line's tension is to the rest of the model: a set of kernels.

Each law has one input, its command, that may move at a constant rate. The command in force is kept as the value it had
at one instant and its rate; `since` is the time since that instant [s]. `tension` is unclamped, so that it runs
smoothly through zero: the switch between slack and taut is the integrator's business. `onset` is negative while a slack
line stays slack.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.tethered_deorbit.acting import IDLE, Acting
from fmu_src.tethered_deorbit.idle import nothing, zero


class Reel(NamedTuple):
    """Kernels of one law; lengths in m, rates in m/s, tension in N. `length` is that of the line between its
    attachments (see `tether.line_length`), not the distance of the bodies.

    asked(record) -> (value, rate)                          what the input says
    leave(record, value)                                    write the value reached back to the input
    prepare(record, value, rate, duration) -> fault         put a command in force, to move for a time
    taut(record, length, rate) -> bool                      whether a line met in this state pulls, at since = 0
    tension(record, length, rate, since)                    unclamped
    tension_rate(record, length, rate, acceleration, since) its time derivative
    onset(record, length, rate, since)                      rises through zero when a slack line goes taut
    onset_rate(record, length, rate, acceleration, since)   its time derivative
    energy(record, length, since)                           stored in a taut line [J]
    energy_rate(record, length, rate, since)                its time derivative [W]
    partials(record, length, rate) -> (by tension, by energy)   derivatives by the command of a taut line, at since = 0
    start_limit(record)                                     longest line with which a pair may start
    acting                                                  what the reel does by itself
    see(record, state)                                      before any of these that depend on the line: take from the
                                                            state what they need beside it; its axes may turn
    first                                                   of the components of the state that it sees
    see_change(record, state, rate, turned)                 and from its rate, before those of a time derivative;
                                                            `turned` is 1 where its axes turn with the step, else 0
    drive(record, state, rate, length, speed, tension, since)   rates of its own components, `reel.components`; without
                                                            a pull the tension is zero
    turn(record, state, length) -> energy                   the line has just gone taut or slack: book what it then has
                                                            or no longer has, in the state, and return it [J];
                                                            `state.taut` is anew
    publish(record, state, length, speed)                   outputs of its own
    differentiate(record, length, speed, acceleration)      and their rates, at since = 0
    at_rest(record, since) -> (l0, l0', l0'', k, c)         of an elastic line with fixed ends, which may settle while
                                                            its input stands still: see `levels.settled`
    by_length                                               the line is taut while it is longer than it is unloaded, and
                                                            may pull also while it is not
    """

    asked: Callable[..., Any]
    leave: Callable[..., Any]
    prepare: Callable[..., Any]
    taut: Callable[..., Any]
    tension: Callable[..., Any]
    tension_rate: Callable[..., Any]
    onset: Callable[..., Any]
    onset_rate: Callable[..., Any]
    energy: Callable[..., Any]
    energy_rate: Callable[..., Any]
    partials: Callable[..., Any]
    start_limit: Callable[..., Any]
    acting: Acting = IDLE
    see: Callable[..., Any] = nothing
    first: int = 6
    see_change: Callable[..., Any] = nothing
    drive: Callable[..., Any] = nothing
    turn: Callable[..., Any] = zero
    publish: Callable[..., Any] = nothing
    differentiate: Callable[..., Any] = nothing
    at_rest: Callable[..., Any] = nothing
    by_length: bool = False
