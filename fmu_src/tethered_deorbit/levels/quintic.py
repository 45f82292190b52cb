"""The course of a settled line that is made fast on a body that turns: of fifth order, the moved mass changing on it.

Such a load sways with the body, within some tens of seconds, and the mass that the line moves with it. So

    m(t) x'' + c x' + k x = P(t)

is solved by powers of the time: P is a polynomial of fifth degree through six points, m of second, and x is the
polynomial that solves it, exactly. The points lie on a step of the integrator, of which the dense output's rate of the
impulse is the tension.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fmu_src.integrators.scheme import AdaptiveScheme
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


_THROUGH = np.ascontiguousarray(_through_points())


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


def make_quintic_draw(
    derivative: Callable[..., Any], scheme: AdaptiveScheme, reel: Reel, bodies: Bodies, places: Places
) -> Callable[..., Any]:
    """The kernel `draw(record, work, span) -> m` for one set of equations, whose rate of the impulse is the tension.

    scheme        the integrator that steps with them

    Checked  tests/tethered_deorbit/test_settled_turning.py
    """
    begin_state, end_state, here_state, slope_state = places.begin, places.end, places.here, places.slope
    low, high, first, last = places.low, places.high, places.stages, places.last
    dense_begin, work_end, size, impulse = places.dense, places.total, places.size, places.impulse
    line = reel.at_rest
    mass_now, seen = bodies.mass_now, bodies.seen

    @kernel
    def draw(record: Any, work: Array, span: float) -> float:
        """The course over a time [s] from the begin of the step, in `state.course`; returns the moved mass there [kg].

        The loads are the tensions with which the line would keep to the course whose bend is that of the last one, as
        it ended, and what that bend takes of them. Uses the memory of stages and of dense output.

        Source   P = T + m x'', along a step of the integrator
        Checked  tests/tethered_deorbit/test_settled_turning.py
        """
        r = record[0]
        bend, turn, bow = r.state_course_bend[0], r.state_course_bend[1], r.state_course_bend[2]
        r.state_settled = 1
        for i in range(POINTS):
            r.state_course[i] = 0.0
        r.state_course[2] = 0.5 * bend
        r.state_course[3] = turn / 6.0
        r.state_course[4] = bow / 24.0
        start, end, there = work[begin_state:end_state], work[end_state:here_state], work[here_state:slope_state]
        stages, dense = work[first:dense_begin], work[dense_begin:work_end]
        loads, powers = work[slope_state : slope_state + POINTS], work[slope_state + POINTS : slope_state + 2 * POINTS]
        mass = work[slope_state + 2 * POINTS : slope_state + 2 * POINTS + 3]
        derivative(record, start, work[first : first + size], 0.0)
        loads[0], mass[0] = work[first + impulse], mass_now(record, start)
        scheme.attempt(record, start, span, stages, end)
        loads[DEGREE], last_mass = work[last + impulse], mass_now(record, end)
        scheme.prepare_dense(record, start, end, span, stages, dense, work[low:high])
        for j in range(1, DEGREE):
            scheme.dense_rate(dense, j / DEGREE, span, impulse, 1, loads[j : j + 1])
        scheme.dense_value(start, dense, 0.5, 0, size, there)
        middle_mass = mass_now(record, seen(record, there, 0.5 * span))
        curve = 2.0 * (mass[0] - 2.0 * middle_mass + last_mass)
        mass[1], mass[2] = last_mass - mass[0] - curve, curve
        # P = T + m x'': what the bend of the course took of the tensions is given back
        for j in range(POINTS):
            u = j / DEGREE
            loads[j] += (mass[0] + u * (mass[1] + u * mass[2])) * (bend + (turn + 0.5 * bow * u * span) * u * span)
        for n in range(POINTS):
            powers[n] = 0.0
            for j in range(POINTS):
                powers[n] += _THROUGH[n, j] * loads[j]
        _, _, _, stiffness, damping = line(record, 0.0)
        swaying_solution(r.state_course, powers, mass, damping, stiffness, span)
        r.state_course_span = span
        return float(mass[0])

    return draw
