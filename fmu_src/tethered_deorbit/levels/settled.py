"""A taut line whose vibration has died: what is left of its stretch follows the load, and steps follow the orbit.

Of a line with the load P = m A (A the rate at which its length would speed up without a pull, m the mass it moves)

    m x'' + c x' + k x = P

every vibration dies by exp(-c t/2m), and what is left is the slow solution

    x = P/k - c P'/k^2 - (m/k - c^2/k^2) P''/k + ...        T = P - m x''

the powers of d/dt in 1/(k + c d/dt + m d^2/dt^2). Over a step P is a cubic through four points of a step of Runge and
Kutta's; x from it is the course on which the length is held, and the tension is what holds it there. So nothing in a
step moves faster than the orbit does, and the tension does not hang on the last digits of the length.

What is given up, and its bound at each step:

- the vibration, as the line settles: its amplitude is below `tolerance_stretch`
- terms of third and higher order of the slow solution: below `tolerance_stretch`
- what the cubic leaves, and the step of Runge and Kutta's that it was drawn from: below `tolerance_separation`

A step that misses one of these is taken again, shorter, and every vibration counts again where that gains nothing.
Whatever makes the trajectory begin anew does the same: a tug, slack, an edge of the thrust, a changed input.

Source   slow solution of a linear oscillator, by its transfer function
Checked  tests/tethered_deorbit/test_settled.py
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from fmu_src.integrators.scheme import AdaptiveScheme
from fmu_src.tethered_deorbit.bodies import Bodies
from fmu_src.tethered_deorbit.law import Reel
from fmu_src.tethered_deorbit.layout import Places
from fmu_src.tethered_deorbit.level import Held, Level
from fmu_src.tethered_deorbit.levels.slow import make_slow
from fmu_src.tethered_deorbit.tolerances import ROUNDING
from orbital.kernel import kernel
from orbital.vectors import Array, norm

GAIN, SWAYING_GAIN = 8.0, 2.0
"""A settled step is at least so many times as long as a resolved one, or it is not worth its preparation: of points,
and of bodies that turn, whose vibration comes back before a longer one has paid."""
SURE = 0.25
"""Share of what may be neglected that a line neglects at most as it settles, so that it does not go to and fro."""
NEXT_LOOK = 30.0
"""Radians of the vibration after which the line is looked at, at the earliest."""
DRAWN_AGAIN = 1e4
"""Tolerances up to which a line that seems to vibrate is looked at along the course just drawn, as its load hangs on
it."""


def make_settled(
    derivative: Callable[..., Any],
    scheme: AdaptiveScheme,
    reel: Reel,
    bodies: Bodies,
    held: Held,
    places: Places,
    sways: bool = False,
) -> Level:
    """The kernels of the level for one set of equations, whose rate of the impulse is the tension.

    sways         whether the load sways with a body that turns

    Checked  tests/tethered_deorbit/test_settled.py
    """
    begin_state, end_state = places.begin, places.end
    stages, size, last, impulse, high = places.stages, places.size, places.last, places.impulse, places.high
    line, seen = reel.at_rest, bodies.seen
    slow = make_slow(derivative, scheme, reel, bodies, places, sways)
    draw, course, span_of, neglected, left_over, tolerance, off_course, shift = slow
    gain = SWAYING_GAIN if sways else GAIN

    @kernel
    def unbend(record: Any) -> None:
        """The next course is drawn from a straight one.

        Checked  tests/tethered_deorbit/test_settled_turning.py
        """
        record[0].state_course_bend[0] = 0.0
        record[0].state_course_bend[1] = 0.0
        record[0].state_course_bend[2] = 0.0

    @kernel
    def bend(record: Any, elapsed: float) -> None:
        """The next course is drawn from one with the bend that the present one has there.

        elapsed       since the begin of the step                [s]

        Checked  tests/tethered_deorbit/test_settled_turning.py
        """
        r = record[0]
        c = r.state_course
        _, _, r.state_course_bend[0] = course(record, elapsed)
        r.state_course_bend[1] = 6.0 * c[3] + (24.0 * c[4] + 60.0 * c[5] * elapsed) * elapsed
        r.state_course_bend[2] = 24.0 * c[4] + 120.0 * c[5] * elapsed

    @kernel
    def put(record: Any, on: bool) -> None:
        """Whether the line is held on its course.

        Checked  tests/tethered_deorbit/test_settled.py: derivatives of outputs
        """
        record[0].state_settled = 1 if on else 0

    @kernel
    def begin(record: Any) -> None:
        """No line has settled yet.

        Checked  tests/tethered_deorbit/test_settled.py
        """
        r = record[0]
        r.state_settled = 0
        r.state_settled_since = 0.0
        r.state_times_settled = 0
        publish(record)

    @kernel
    def restart(record: Any, time: float) -> None:
        """Every vibration counts again from a time on [s].

        Checked  tests/tethered_deorbit/test_settled.py: a changed thrust
        """
        r = record[0]
        r.state_settled = 0
        r.state_next_look = time + NEXT_LOOK / r.state_frequency if r.state_taut else time
        if sways:
            unbend(record)

    @kernel
    def publish(record: Any) -> None:
        """Whether the line has settled, and since when.

        Checked  tests/tethered_deorbit/test_settled.py
        """
        r = record[0]
        r.level_settled = r.state_settled
        r.level_settled_since = r.state_settled_since if r.state_settled else 0.0
        r.level_times_settled = r.state_times_settled

    @kernel
    def look(record: Any, work: Array, step: float, limit: float, cap: float) -> float:
        """Let the line settle where it has: its vibration is below the tolerance, and so is what would be neglected.

            a^2 = x^2 + (m/k) x'^2 of what it is off its course; the next look is when a will have died so far

        step, limit   step that is meant, and the longest one allowed   [s]
        cap           longest step while the line vibrates       [s]

        Returns the step to try [s].

        Valid    0 < damping; without any no vibration dies
        Checked  tests/tethered_deorbit/test_settled.py
        """
        r = record[0]
        if r.state_settled == 1 or r.state_command_rate != 0.0 or not r.state_begin >= r.state_next_look:
            return step
        _, _, _, stiffness, damping = line(record, 0.0)
        soonest = r.state_begin + NEXT_LOOK / r.state_frequency
        r.state_next_look = soonest if damping > 0.0 else math.inf
        if limit < gain * cap or not damping > 0.0:
            return step
        if sways:
            for i in range(size):
                work[high + i] = work[stages + i]
        mass = draw(record, work, span_of(record, gain * cap))
        longer, faster = off_course(record, work)
        amplitude = math.sqrt(longer * longer + mass / stiffness * faster * faster)
        least = tolerance(record)
        if sways and least < amplitude <= DRAWN_AGAIN * least:
            bend(record, 0.0)
            mass = draw(record, work, span_of(record, gain * cap))
            longer, faster = off_course(record, work)
            amplitude = math.sqrt(longer * longer + mass / stiffness * faster * faster)
        if amplitude <= least and neglected(record, mass) <= SURE * least:
            r.state_settled_since = r.state_begin
            r.state_times_settled += 1
            return float(gain * cap)
        r.state_settled = 0
        if sways:
            for i in range(size):
                work[stages + i] = work[high + i]
        if amplitude > least:
            rate = min(0.5 * damping / mass, stiffness / damping)
            r.state_next_look = max(soonest, r.state_begin + math.log(amplitude / least) / rate)
        return step

    @kernel
    def leave(record: Any, work: Array, step: float, cap: float) -> float:
        """Go back to resolved steps where one [s] would be no longer than `GAIN` of them: the line is on its slow
        solution, and the next look is `NEXT_LOOK` away.

        cap           longest step of a line that vibrates       [s]

        Returns the step to take [s].

        Checked  tests/tethered_deorbit/test_settled.py: a load that sways
        """
        r = record[0]
        if r.state_settled == 0 or step >= gain * cap:
            return step
        restart(record, r.state_begin)
        derivative(record, work[begin_state:end_state], work[stages : stages + size], 0.0)
        return cap

    @kernel
    def prepare(record: Any, work: Array, step: float, cap: float) -> float:
        """Draw the course of a settled step [s], put its begin there, axes at rest, and renew the rate of the begin.

        cap           longest step of a line that vibrates       [s]

        Returns the step to take [s]. Where the slow solution neglects too much, the line vibrates from here on.

        Checked  tests/tethered_deorbit/test_settled.py
        """
        r = record[0]
        if r.state_settled == 0:
            return step
        for i in range(3):
            r.state_turning[i] = 0.0
        r.state_moved_mass = draw(record, work, span_of(record, step))
        longer, faster = off_course(record, work)
        start = work[begin_state:end_state]
        x, y, z = bodies.along(record, seen(record, start, 0.0))
        shift(start, x, y, z, longer, faster)
        if neglected(record, r.state_moved_mass) > tolerance(record):
            return float(leave(record, work, 0.0, cap))
        derivative(record, start, work[stages : stages + size], 0.0)
        return step

    @kernel
    def missed(record: Any, work: Array) -> float:
        """By how much the course was wrong, in tolerances of the separation [-]: where the step ended, and between its
        points.

        Checked  tests/tethered_deorbit/test_settled.py: a load that sways
        """
        r = record[0]
        if r.state_settled == 0:
            return 0.0
        rest, _, _, _, _ = line(record, 0.0)
        length, _, _ = held.along(record, work[last + impulse], r.state_step)
        stretch, _, _ = course(record, r.state_step)
        left = abs(length - rest - stretch) + left_over(record)
        apart = r.solver_tolerance_separation + ROUNDING * norm(work[end_state + 6 : end_state + 9])
        return float(left / apart)

    @kernel
    def place(
        record: Any, state: Array, tension: float, elapsed: float, length: float, speed: float
    ) -> tuple[float, float]:
        """Put a state, as it is, where the line of this tension [N] is; returns its length [m] and rate [m/s].

        elapsed       since the begin of the step                [s]
        length, speed of the line in this state, as last seen    [m], [m/s]

        Checked  tests/tethered_deorbit/test_settled.py
        """
        there, rate, _ = held.along(record, tension, elapsed)
        x, y, z = bodies.along(record, state)
        shift(state, x, y, z, length - there, speed - rate)
        return there, rate

    @kernel
    def book(record: Any) -> None:
        """The next course begins with the bend with which this one ends, that of a line that vibrates with none.

        Checked  tests/tethered_deorbit/test_settled_turning.py
        """
        r = record[0]
        if r.state_settled == 1:
            bend(record, r.state_step)
        else:
            unbend(record)

    level = Level(begin, restart, look, prepare, missed, leave, place, put, publish)
    return level._replace(book=book, sways=True) if sways else level
