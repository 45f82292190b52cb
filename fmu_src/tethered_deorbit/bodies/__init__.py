"""What the line is made fast to: two points, or bodies that turn; and the straight line between the two attachments."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.idle import always, never, no_fault, nothing, zero
from fmu_src.tethered_deorbit.surfaces import SURFACES


class Bodies(NamedTuple):
    """Kernels of the two bodies at the ends of the line. `state` and `rate` are those of `layout`, as they are but
    where it says otherwise; axes may turn.

    begin(record) -> fault                      least effective mass of the line, and what does not change
    place(record, state, longest) -> fault      attitudes and rates at the start, the centres being in the state; a line
                                                longer than `longest` [m] is refused
    line(record, state) -> (separation, length, its rate)   of the centres of mass [m]; of the line [m], [m/s]
    along(record, state) -> (x, y, z)           direction of the line at the chaser, towards the target, of any length
    stand(record, state)                        where attachments and line are; `line` and `seen` do it too. The rest is
                                                asked of the state in which they stand
    measure(record, state)                      what `line` returns
    move(record, state, rate)                   rate of attitudes and body rates without the line; writes all of them
    second(record, state, rate, separation, length, length_rate, turned) -> (length'', separation', separation'')
                                                [m/s^2], [m/s], [m/s^2]; `turned` is 1 where the axes of the rate turn
                                                with the step, 0 where they are at rest
    pull(record, state, rate, tension, separation)   add the pull of the line [N] to the rate
    add_turning(record, state, rate, sign)      what the turning of the axes adds to the rate of attitudes
    turn_back(record, time, state)              attitudes that axes turning for a time [s] have; in place
    rest(record)                                a step of no length: the state is as it is
    enter(record, state)                        from the state as it is to the coordinates of the step that begins there
    go_on(record, time, state, rate)            from the end of a step of a time [s] to the begin of the next; attitudes
                                                have no rate there but for what turning axes add
    seen(record, state, elapsed) -> state       as it is, from the coordinates of a step, `elapsed` [s] after its begin
    felt(record, state, elapsed) -> state       the same for the equations alone: nothing of a slack line is sought
    last_seen(record, state) -> state           what `seen` made of it, if that was the last that was asked
    seen_rate(record, state, rate) -> rate      and its rate, after `seen`
    enter_rate(record, state, seen, rate)       the rate in the coordinates of the step, from that as it is
    squared_error(record, state, error) -> e^2  of the attitudes, in units of the tolerances
    pace(record, state) -> n                    by which the tolerance of velocities across a taut line follows [rad/s]
    square_across(record, state, error, along) -> e^2   square of the error of the velocity across it that counts
                                                [m2/s2]; `along` is the part along the line [m/s]
    moved_mass(record, state) -> m              that the line has to move where it is [kg]; after `seen`
    mass_now(record, state) -> m                the same, with what the tank has lost [kg]
    longest(record, state) -> h                 longest step [s] that these coordinates bear, and over which the way of
                                                the line can be followed
    publish(record, state)                      outputs of their own
    energy(record, state, turning) -> E         of the attitudes [J], constant in a frame that turns evenly [rad/s] but
                                                for what the line does
    differentiate(record, state, rate, turning, change) -> E'   rates of their outputs; power [W]
    further       by how much farther than of points a step of a damped line may reach over its vibration

    Of a line with nodes are asked, after `stand` of the same state, in place of `pull`:

    ends(record, state, out)                    where it is made fast at the chaser and its rate, in rows 0 and 1, and
                                                at the target, in rows 2 and 3, from the target's centre of mass (4, 3)
    chaser_end(record, state, rate, out)        second derivative of the chaser's arm, taken off `out`, after `ends`
    twist_chaser(record, state, rate, x, y, z)  what the pull at the chaser's end [N] does to the rate of its attitude
    twist_target(record, state, rate, x, y, z)  the same at the target, of the opposite of the pull there [N]
    beyond                                      field of the record with the distance that the line ends short of the
                                                target [m]

    Of a line that goes straight to its attachments nothing of what follows is asked:

    hold(record, state)                         from the way of the line to this state others are followed
    trouble(record) -> fault                    of a line that could not be followed
    holds(record, state)                        whether the line's way over edges of the body is still the one that was
    renew(record, state)                        take the one that is
    stays(record, begin, end, step) -> bool     whether a way that holds at both ends of a step [s], states in its
                                                coordinates, surely holds all along; leaves what `seen` does of the end
    rise(record) -> s                           sine of the angle at which a straight line rises from the face on which
                                                it is made fast, else 0; after `seen`
    retry(record, state)                        where none could be found that holds: whether now one could be
    book(record, energy)                        what the line has lost by a change of its way [J]
    """

    begin: Callable[..., Any]
    place: Callable[..., Any]
    move: Callable[..., Any]
    stand: Callable[..., Any]
    measure: Callable[..., Any]
    line: Callable[..., Any]
    along: Callable[..., Any]
    second: Callable[..., Any]
    pull: Callable[..., Any]
    add_turning: Callable[..., Any]
    turn_back: Callable[..., Any]
    rest: Callable[..., Any]
    enter: Callable[..., Any]
    go_on: Callable[..., Any]
    seen: Callable[..., Any]
    felt: Callable[..., Any]
    last_seen: Callable[..., Any]
    seen_rate: Callable[..., Any]
    enter_rate: Callable[..., Any]
    longest: Callable[..., Any]
    squared_error: Callable[..., Any]
    pace: Callable[..., Any]
    square_across: Callable[..., Any]
    moved_mass: Callable[..., Any]
    mass_now: Callable[..., Any]
    publish: Callable[..., Any]
    energy: Callable[..., Any]
    differentiate: Callable[..., Any]
    ends: Callable[..., Any]
    chaser_end: Callable[..., Any] = nothing
    twist_chaser: Callable[..., Any] = nothing
    twist_target: Callable[..., Any] = nothing
    beyond: str = "target_attachment_distance"
    further: float = 1.0
    hold: Callable[..., Any] = nothing
    trouble: Callable[..., Any] = no_fault
    holds: Callable[..., Any] = always
    renew: Callable[..., Any] = nothing
    stays: Callable[..., Any] = always
    rise: Callable[..., Any] = zero
    retry: Callable[..., Any] = never
    book: Callable[..., Any] = nothing


KINDS = {"target": ("point", "rigid", *SURFACES), "chaser": ("point", "rigid")}


def make_bodies(
    terms: Mapping[str, str],
    frame_at: Callable[..., Any],
    strength_at: Callable[..., Any],
    size: int,
    interface: Interface,
) -> Bodies:
    """The kernels for a record of this interface.

    terms         of `interface`: those of "target" and "chaser" are among `KINDS`
    frame_at, strength_at   kernels `place` and `gradient` of the environment
    size          of the state
    """
    from fmu_src.tethered_deorbit.bodies import attached, points

    turning = tuple(role for role in ("target", "chaser") if terms[role] != "point")
    if not turning:
        return points.make_points(interface)
    return attached.make_attached(turning, terms, size, frame_at, strength_at, interface)
