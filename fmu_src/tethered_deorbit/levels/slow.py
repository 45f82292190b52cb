"""What is asked of a line's slow solution, whatever steps on it: how long it is drawn, what it leaves out."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.integrators.scheme import AdaptiveScheme
from fmu_src.tethered_deorbit.bodies import Bodies
from fmu_src.tethered_deorbit.law import Reel
from fmu_src.tethered_deorbit.layout import Places
from fmu_src.tethered_deorbit.levels.course import course, make_draw
from fmu_src.tethered_deorbit.levels.quintic import LEFT_BY_QUINTIC, make_quintic_draw, quintic_course
from fmu_src.tethered_deorbit.tolerances import ROUNDING
from orbital.kernel import kernel
from orbital.vectors import Array

LEFT_BY_CUBIC = 0.004
"""What a cubic through four even points leaves of a smooth curve, over its own cubic term: 6 (1/81)/24, and a third
more, where the curve does not turn within the step."""
SPAN = 0.01
"""Shortest time over which a course is drawn, in radians of the pace: over a shorter one rounding would bend it."""


class Slow(NamedTuple):
    """Kernels about the course of one step.

    draw(record, work, span) -> m                 see `course.make_draw`
    at(record, elapsed) -> (x, x', x'')           see `course.course`
    span_of(record, step) -> h                    time over which it is drawn [s]
    neglected(record, mass) -> x                  bound of what it leaves out [m]
    left(record) -> x                             what the course, being a polynomial, leaves [m]
    tolerance(record) -> x                        of the stretch [m]
    off_course(record, work) -> (x, x')           of the line at the begin of the step [m], [m/s]
    shift(state, x, y, z, longer, faster)         take so much off the line, in place
    """

    draw: Callable[..., Any]
    at: Callable[..., Any]
    span_of: Callable[..., Any]
    neglected: Callable[..., Any]
    left: Callable[..., Any]
    tolerance: Callable[..., Any]
    off_course: Callable[..., Any]
    shift: Callable[..., Any]


def make_slow(
    derivative: Callable[..., Any],
    scheme: AdaptiveScheme,
    reel: Reel,
    bodies: Bodies,
    places: Places,
    sways: bool = False,
) -> Slow:
    """The kernels for one set of equations, whose rate of the impulse is the tension.

    sways         whether the load sways with a body that turns: see `quintic`

    Checked  tests/tethered_deorbit/test_settled.py
    """
    begin_state, end_state = places.begin, places.end
    line, seen = reel.at_rest, bodies.seen
    at = quintic_course if sways else course

    @kernel
    def span_of(record: Any, step: float) -> float:
        """Time over which a course is drawn for a step [s].

        Checked  tests/tethered_deorbit/test_settled.py
        """
        r = record[0]
        return float(max(step, SPAN / r.state_pace))

    @kernel
    def neglected(record: Any, mass: float) -> float:
        """Bound of what the slow solution leaves out [m], for a moved mass [kg].

            (2 m c/k^2 + (c/k)^3 + (m/k)^2/h) |x'''|,   h the time over which the course is drawn

        Valid    courses whose third derivative changes by no more than itself over h
        Source   terms of third and fourth order of the transfer function
        Checked  tests/tethered_deorbit/test_settled.py: a load that sways
        """
        r = record[0]
        _, _, _, stiffness, damping = line(record, 0.0)
        lag, inertia = damping / stiffness, mass / stiffness
        share = 2.0 * inertia * lag + lag * lag * lag + inertia * inertia / r.state_course_span
        return float(share * 6.0 * abs(r.state_course[3]))

    @kernel
    def left(record: Any) -> float:
        """What a cubic leaves of a smooth curve over the time for which it is drawn [m].

        Checked  tests/tethered_deorbit/test_settled.py: a load that sways
        """
        r = record[0]
        span = r.state_course_span
        return float(LEFT_BY_CUBIC * abs(r.state_course[3]) * span * span * span)

    @kernel
    def step_itself(record: Any, step: float) -> float:
        """Time over which a course of fifth order is drawn for a step [s].

        Checked  tests/tethered_deorbit/test_settled_turning.py
        """
        return step

    @kernel
    def neglected_by_sixth(record: Any, mass: float) -> float:
        """Bound of what a course of fifth order leaves out of the slow solution [m], for a moved mass [kg].

            (m/k + (c/k)^2)^3 |x^(5)|/h,   h the time over which the course is drawn

        Source   the term of sixth order of the transfer function
        Checked  tests/tethered_deorbit/test_settled_turning.py
        """
        r = record[0]
        _, _, _, stiffness, damping = line(record, 0.0)
        lag = damping / stiffness
        square = mass / stiffness + lag * lag
        return float(square * square * square * 120.0 * abs(r.state_course[5]) / r.state_course_span)

    @kernel
    def left_by_quintic(record: Any) -> float:
        """What a polynomial of fifth degree leaves of a smooth curve [m].

        Checked  tests/tethered_deorbit/test_settled_turning.py
        """
        r = record[0]
        square = r.state_course_span * r.state_course_span
        return float(LEFT_BY_QUINTIC * abs(r.state_course[5]) * square * square * r.state_course_span)

    @kernel
    def tolerance(record: Any) -> float:
        """Of the stretch [m].

        Checked  tests/tethered_deorbit/test_settled.py
        """
        r = record[0]
        return float(r.state_taut_tolerance + ROUNDING * r.state_length)

    @kernel
    def off_course(record: Any, work: Array) -> tuple[float, float]:
        """By how much the line at the begin of the step is longer than on its course [m], and lengthens faster [m/s].

        Checked  tests/tethered_deorbit/test_settled.py
        """
        here = seen(record, work[begin_state:end_state], 0.0)
        _, length, speed = bodies.measure(record, here)
        rest, _, _, _, _ = line(record, 0.0)
        stretch, rate, _ = at(record, 0.0)
        return length - rest - stretch, speed - rate

    @kernel
    def shift(state: Array, x: float, y: float, z: float, longer: float, faster: float) -> None:
        """Take from the line what it is too long [m] and lengthens too fast [m/s], along itself.

        state         in the coordinates of the step, or as it is, of `layout`
        x, y, z       direction of the line, of any length

        Checked  tests/tethered_deorbit/test_settled.py
        """
        distance = math.sqrt(x * x + y * y + z * z)
        if distance > 0.0:
            share, rate = longer / distance, faster / distance
            state[6] -= share * x
            state[7] -= share * y
            state[8] -= share * z
            state[9] -= rate * x
            state[10] -= rate * y
            state[11] -= rate * z

    if sways:
        draw = make_quintic_draw(derivative, scheme, reel, bodies, places)
        return Slow(draw, at, step_itself, neglected_by_sixth, left_by_quintic, tolerance, off_course, shift)
    return Slow(make_draw(derivative, reel, bodies, places), at, span_of, neglected, left, tolerance, off_course, shift)
