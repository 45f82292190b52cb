"""The coordinates of a step in which what turns evenly stands still: a body's attitude, and while taut the line's end.

An attachment goes round with its body. Sought from the centres of mass, a taut line would have to be kept at its length
by a relative vector that goes round the other way, and the first, low-order stages of a step miss that circle by
a (w h)^2/2, micrometres that the line's stiffness turns into forces that have nothing to do with its motion. So over a
step the state holds, in place of attitude q and relative vector rho,

    q = p e(w_0 t),   y = rho + s A(q) b,   y' = rho' + s A(q) (w x b),   e(v) the turn by a vector v, s the body's sign

w_0 the body's rate at the begin of the step, b the point of the body about which the line turns there, and none while
the line is slack. b is where the line leaves the body, or behind that where it slides over an edge (`path`). p stands
still but for the change of w, and y is the vector of the line itself.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.tethered_deorbit.idle import nothing
from fmu_src.tethered_deorbit.layout import ATTITUDE
from orbital.kernel import kernel
from orbital.rigid import point_acceleration, point_velocity
from orbital.rotations import evenly_turned, multiply, to_matrix_of_any_length
from orbital.vectors import Array, add_scaled, cross, matrix_vector


class Carried(NamedTuple):
    """Kernels of one body; as it stands, of one that does not turn. `seen` is a state as it is, `state` one in the
    coordinates of a step; axes are those of the step.

    rest(record)                         a step of no length: both are the same
    enter(record, state)                 from the state as it is to that at the begin of a step
    stay(record, time, state)            attitude as it is, after a step of a time [s]; in place
    go_on(record, state, rate)           the next step begins where this one ended: its own rate and point of the body
    leave(record, elapsed, state, seen)  attitude as it is, and take from the relative vector what `enter` has added
    enter_rate(record, seen, rate)       from the rate of the state as it is to that in the coordinates of the step
    leave_rate(record, seen, rate)       back, of the relative velocity alone; both after `leave`
    """

    rest: Callable[..., Any] = nothing
    enter: Callable[..., Any] = nothing
    stay: Callable[..., Any] = nothing
    go_on: Callable[..., Any] = nothing
    leave: Callable[..., Any] = nothing
    enter_rate: Callable[..., Any] = nothing
    leave_rate: Callable[..., Any] = nothing


def make_carried(role: str, first: int, sign: float, leaving: str) -> Carried:
    """The kernels of one body, "target" or "chaser".

    first       place of its attitude in the state
    sign        as of `rigid.make_rigid`
    leaving     row of the point about which the line's far end turns: where the line leaves it, if it does not slide

    Checked  tests/tethered_deorbit/test_rigid.py
    """
    turned, room, turn, spin, point = (f"state_{role}_{name}" for name in ("turned", "room", "turn", "spin", "point"))
    middle, last = first + 4, first + ATTITUDE

    @kernel
    def rest(record: Any) -> None:
        """A step of no length.

        Checked  tests/tethered_deorbit/test_rigid_outputs.py: macro steps change nothing
        """
        r = record[0]
        for i in range(3):
            r[spin][i] = 0.0
            r[point][i] = 0.0

    @kernel
    def enter(record: Any, state: Array) -> None:
        """The step begins: its rate is the body's; while taut, its point is that about which the line turns.

        Checked  tests/tethered_deorbit/test_rigid.py: three tugs
        """
        r = record[0]
        for i in range(3):
            r[spin][i] = state[middle + i]
            r[point][i] = r[leaving][i] if r.state_taut else 0.0
        to_matrix_of_any_length(r[turned], state[first:middle])
        matrix_vector(r[room][0], r[turned], r[point])
        point_velocity(r[room][1], r[turned], state[middle:last], r[point])
        add_scaled(state[6:9], state[6:9], sign, r[room][0])
        add_scaled(state[9:12], state[9:12], sign, r[room][1])

    @kernel
    def stay(record: Any, time: float, state: Array) -> None:
        """The attitude as it is: see `Carried`.

        Checked  tests/tethered_deorbit/test_rigid.py: three tugs
        """
        r = record[0]
        evenly_turned(r[turn], r[spin], time)
        multiply(state[first:middle], state[first:middle], r[turn])

    @kernel
    def go_on(record: Any, state: Array, rate: Array) -> None:
        """The next step begins, the attitude being as it is: see `Carried`. What the line has slid by is added.

        Checked  tests/tethered_deorbit/test_rigid.py: three tugs; test_wrapping.py
        """
        r = record[0]
        slid, add = r[room][0], r[room][1]
        moved = False
        for i in range(3):
            r[spin][i] = state[middle + i]
            slid[i] = r[leaving][i] - r[point][i] if r.state_taut else 0.0
            moved = moved or slid[i] != 0.0
        for i in range(first, middle):
            rate[i] = 0.0
        if moved:
            to_matrix_of_any_length(r[turned], state[first:middle])
            matrix_vector(add, r[turned], slid)
            add_scaled(state[6:9], state[6:9], sign, add)
            point_velocity(add, r[turned], state[middle:last], slid)
            add_scaled(state[9:12], state[9:12], sign, add)
            add_scaled(rate[6:9], rate[6:9], sign, add)
            point_acceleration(add, r[turned], state[middle:last], rate[middle:last], slid)
            add_scaled(rate[9:12], rate[9:12], sign, add)
            for i in range(3):
                r[point][i] += slid[i]

    @kernel
    def leave(record: Any, elapsed: float, state: Array, seen: Array) -> None:
        """The state as it is: see `Carried`. Fills the matrix `turned`.

        Checked  tests/tethered_deorbit/test_rigid.py: three tugs
        """
        r = record[0]
        evenly_turned(r[turn], r[spin], elapsed)
        multiply(seen[first:middle], state[first:middle], r[turn])
        for i in range(middle, last):
            seen[i] = state[i]
        to_matrix_of_any_length(r[turned], seen[first:middle])
        if r.state_carried == 1:
            matrix_vector(r[room][0], r[turned], r[point])
            point_velocity(r[room][1], r[turned], seen[middle:last], r[point])
            add_scaled(seen[6:9], seen[6:9], -sign, r[room][0])
            add_scaled(seen[9:12], seen[9:12], -sign, r[room][1])

    @kernel
    def enter_rate(record: Any, seen: Array, rate: Array) -> None:
        """The rate in the coordinates of the step: see `Carried`.

            p' = q (0, w - w_0) e*/2,   y'' = rho'' + s A (w' x b + w x (w x b))

        Checked  tests/tethered_deorbit/test_rigid.py: three tugs
        """
        r = record[0]
        if r.state_carried == 1:
            spare = r[room][0]
            point_acceleration(spare, r[turned], seen[middle:last], rate[middle:last], r[point])
            add_scaled(rate[6:9], rate[6:9], sign, r[room][1])
            add_scaled(rate[9:12], rate[9:12], sign, spare)
        a, b, c, d = seen[first], seen[first + 1], seen[first + 2], seen[first + 3]
        x = 0.5 * (seen[middle] - r[spin][0])
        y = 0.5 * (seen[middle + 1] - r[spin][1])
        z = 0.5 * (seen[middle + 2] - r[spin][2])
        e, f, g, h = -b * x - c * y - d * z, a * x + c * z - d * y, a * y - b * z + d * x, a * z + b * y - c * x
        t, u, v, w = r[turn][0], -r[turn][1], -r[turn][2], -r[turn][3]
        rate[first] = e * t - f * u - g * v - h * w
        rate[first + 1] = e * u + f * t + g * w - h * v
        rate[first + 2] = e * v - f * w + g * t + h * u
        rate[first + 3] = e * w + f * v - g * u + h * t

    @kernel
    def leave_rate(record: Any, seen: Array, rate: Array) -> None:
        """The rate of the relative velocity as it is, as it is seen from axes that turn: see `Carried`.

            rho'' - W x rho' = (y'' - W x y') - s (A (w' x b + w x (w x b)) - W x A (w x b)),   W the rate of the axes

        Checked  tests/tethered_deorbit/test_rigid.py: three tugs
        """
        r = record[0]
        if r.state_carried == 1:
            spare = r[room][0]
            point_acceleration(spare, r[turned], seen[middle:last], rate[middle:last], r[point])
            add_scaled(rate[9:12], rate[9:12], -sign, spare)
            cross(spare, r.state_turning, r[room][1])
            add_scaled(rate[9:12], rate[9:12], sign, spare)

    return Carried(rest, enter, stay, go_on, leave, enter_rate, leave_rate)
