"""The course of a settled line that is made fast on a body that turns: of fifth order, the moved mass changing on it.

Such a load sways with the body, within some tens of seconds, and the mass that the line moves with it. So

    m(t) x'' + c x' + k x = P(t)

is solved by powers of the time: P is a polynomial of fifth degree through six points, m of second, and x is the
polynomial that solves it, exactly. The points lie on two steps of Runge and Kutta's, between which the pair is seen by
the polynomial of fifth degree through states and rates at both ends and in the middle.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.polynomial import polynomial

from fmu_src.tethered_deorbit.bodies import Bodies
from fmu_src.tethered_deorbit.law import Reel
from fmu_src.tethered_deorbit.layout import Places
from orbital.kernel import kernel
from orbital.vectors import Array

DEGREE = 5
POINTS = DEGREE + 1
LEFT_BY_QUINTIC = 0.0015
"""What a polynomial of fifth degree through six even points leaves of a smooth curve, over its own highest term:
6 (0.00108)/6, and a third more, where the curve does not turn within the step; see `settled.LEFT_BY_CUBIC`."""


def _through_points() -> np.ndarray:
    """Coefficients by powers of a variable from 0 to 1, of values at six even points."""
    return np.linalg.inv(np.vander(np.arange(POINTS) / DEGREE, POINTS, increasing=True))


def _between() -> np.ndarray:
    """Weights of three states, at 0, 1/2 and 1, and of their rates, for the state at each of the six points."""
    conditions = np.zeros((POINTS, POINTS))
    for row, place in enumerate((0.0, 0.5, 1.0)):
        for power in range(POINTS):
            unit = np.eye(POINTS)[power]
            conditions[row, power] = polynomial.polyval(place, unit)
            conditions[row + 3, power] = polynomial.polyval(place, polynomial.polyder(unit))
    powers = np.vander(np.arange(POINTS) / DEGREE, POINTS, increasing=True)
    return np.ascontiguousarray(powers @ np.linalg.inv(conditions))


_THROUGH = np.ascontiguousarray(_through_points())
_BETWEEN = _between()


@kernel
def quintic_course(record: Any, elapsed: float) -> tuple[float, float, float]:
    """Stretch of the line on its course [m], its rate [m/s] and the rate of that [m/s^2].

    elapsed       since the begin of the step                    [s]

    Checked  tests/tethered_deorbit/test_settled_turning.py
    """
    c = record[0].state_course
    x = rate = bend = 0.0
    for i in range(DEGREE, -1, -1):
        bend = bend * elapsed + 2.0 * rate
        rate = rate * elapsed + x
        x = x * elapsed + c[i]
    return x, rate, bend


@kernel
def swaying_solution(out: Array, load: Array, mass: Array, damping: float, stiffness: float, span: float) -> None:
    """Stretch of an oscillator whose load and mass change, by powers of the time [m], [m/s], ...

        m(t) x'' + c x' + k x = P(t),   m = m_0 + m_1 u + m_2 u^2,   P = p_0 + ... + p_5 u^5,   u = t/h

    out                  of x, by powers of t                    (6,)
    load, mass           p, m                                    [N], [kg]  (6,), (3,)
    damping, stiffness   c, k                                    [N s/m], [N/m]
    span                 h                                       [s]

    Valid    any; of the solutions of this equation the only one that is a polynomial
    Source   equal powers of u, from the highest down
    Checked  tests/tethered_deorbit/test_settled_turning.py: put into the equation of motion
    """
    lag, square = damping / span, span * span
    for i in range(DEGREE + 1):
        n = DEGREE - i
        next_one = out[n + 1] if n < DEGREE else 0.0
        second_next = out[n + 2] if n + 1 < DEGREE else 0.0
        left = load[n] - (lag + n * mass[1] / square) * (n + 1) * next_one
        left -= mass[0] / square * (n + 2) * (n + 1) * second_next
        out[n] = left / (stiffness + n * (n - 1) * mass[2] / square)
    scale = 1.0
    for n in range(DEGREE + 1):
        out[n] /= scale
        scale *= span


def make_quintic_draw(derivative: Callable[..., Any], reel: Reel, bodies: Bodies, places: Places) -> Callable[..., Any]:
    """The kernel `draw(record, work, span) -> m` for one set of equations, whose rate of the impulse is the tension.

    Checked  tests/tethered_deorbit/test_settled_turning.py
    """
    begin_state, end_state, here_state, slope_state = places.begin, places.end, places.here, places.slope
    low, high, stages, size, moving = places.low, places.high, places.stages, places.size, places.moving
    impulse = places.impulse
    line = reel.at_rest
    mass_now = bodies.mass_now

    @kernel
    def runge_kutta(record: Any, begin: Array, first: Array, time: float, step: float, room: Array, end: Array) -> None:
        """A step of order 4.

        begin, end    states; end may not be begin               (size,)
        first         rate at the begin                          (size,)
        time, step    since the begin of the whole, and of this  [s]
        room                                                     (3 size,)

        Source   Hairer, Norsett and Wanner (1993), table II.1.2
        Checked  tests/tethered_deorbit/test_settled_turning.py
        """
        there, rate, total = room[0:size], room[size : 2 * size], room[2 * size : 3 * size]
        for i in range(size):
            there[i] = begin[i]
            end[i] = begin[i]
        for i in range(moving):
            total[i] = first[i]
            there[i] = begin[i] + 0.5 * step * first[i]
        derivative(record, there, rate, time + 0.5 * step)
        for i in range(moving):
            total[i] += 2.0 * rate[i]
            there[i] = begin[i] + 0.5 * step * rate[i]
        derivative(record, there, rate, time + 0.5 * step)
        for i in range(moving):
            total[i] += 2.0 * rate[i]
            there[i] = begin[i] + step * rate[i]
        derivative(record, there, rate, time + step)
        for i in range(moving):
            end[i] = begin[i] + step / 6.0 * (total[i] + rate[i])

    @kernel
    def draw(record: Any, work: Array, span: float) -> float:
        """The course over a time [s] from the begin of the step, in `state.course`; returns the moved mass there [kg].

        The loads are the tensions with which the line would keep to the course whose bend is that of the last one, as
        it ended, and what that bend takes of them.

        Source   Hairer, Norsett and Wanner (1993), sections II.1 and II.6
        Checked  tests/tethered_deorbit/test_settled_turning.py
        """
        r = record[0]
        bend, turn = r.state_course_bend[0], r.state_course_bend[1]
        r.state_settled = 1
        for i in range(POINTS):
            r.state_course[i] = 0.0
        r.state_course[2] = 0.5 * bend
        r.state_course[3] = turn / 6.0
        start, end = work[begin_state:end_state], work[end_state:here_state]
        there, rate = work[here_state:slope_state], work[slope_state:low]
        first, last = work[low:high], work[high:stages]
        room = work[stages + size : stages + 4 * size]
        middle = work[stages + 4 * size : stages + 5 * size]
        between = work[stages + 5 * size : stages + 6 * size]
        loads = work[stages + 6 * size : stages + 6 * size + POINTS]
        powers = work[stages + 6 * size + POINTS : stages + 6 * size + 2 * POINTS]
        mass = work[stages + 6 * size + 2 * POINTS : stages + 6 * size + 2 * POINTS + 3]
        half = 0.5 * span
        derivative(record, start, first, 0.0)
        loads[0], mass[0] = first[impulse], mass_now(record, start)
        runge_kutta(record, start, first, 0.0, half, room, middle)
        derivative(record, middle, between, half)
        middle_mass = mass_now(record, middle)
        runge_kutta(record, middle, between, half, half, room, end)
        derivative(record, end, last, span)
        loads[DEGREE], last_mass = last[impulse], mass_now(record, end)
        for i in range(size):
            there[i] = start[i]
        for j in range(1, DEGREE):
            for i in range(moving):
                change = _BETWEEN[j, 1] * (middle[i] - start[i]) + _BETWEEN[j, 2] * (end[i] - start[i])
                slopes = _BETWEEN[j, 3] * first[i] + _BETWEEN[j, 4] * between[i] + _BETWEEN[j, 5] * last[i]
                there[i] = start[i] + change + span * slopes
            derivative(record, there, rate, j * span / DEGREE)
            loads[j] = rate[impulse]
        curve = 2.0 * (mass[0] - 2.0 * middle_mass + last_mass)
        mass[1], mass[2] = last_mass - mass[0] - curve, curve
        # P = T + m x'': what the bend of the course took of the tensions is given back
        for j in range(POINTS):
            u = j / DEGREE
            loads[j] += (mass[0] + u * (mass[1] + u * mass[2])) * (bend + turn * u * span)
        for n in range(POINTS):
            powers[n] = 0.0
            for j in range(POINTS):
                powers[n] += _THROUGH[n, j] * loads[j]
        _, _, _, stiffness, damping = line(record, 0.0)
        swaying_solution(r.state_course, powers, mass, damping, stiffness, span)
        r.state_course_span = span
        return float(mass[0])

    return draw
