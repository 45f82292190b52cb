"""The course on which a settled line is held over a step: drawn from its loads, and the tension that holds it there."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fmu_src.tethered_deorbit.bodies import Bodies
from fmu_src.tethered_deorbit.law import Reel
from fmu_src.tethered_deorbit.layout import Places
from fmu_src.tethered_deorbit.level import Held
from orbital.kernel import kernel
from orbital.vectors import Array


@kernel
def settled(record: Any) -> bool:
    """Whether the line is held on its course.

    Checked  tests/tethered_deorbit/test_settled.py
    """
    return bool(record[0].state_settled == 1)


@kernel
def course(record: Any, elapsed: float) -> tuple[float, float, float]:
    """Stretch of the line on its course [m], its rate [m/s] and the rate of that [m/s^2].

    elapsed       since the begin of the step                    [s]

    Checked  tests/tethered_deorbit/test_settled.py
    """
    c = record[0].state_course
    return (
        ((c[3] * elapsed + c[2]) * elapsed + c[1]) * elapsed + c[0],
        (3.0 * c[3] * elapsed + 2.0 * c[2]) * elapsed + c[1],
        6.0 * c[3] * elapsed + 2.0 * c[2],
    )


@kernel
def slow_solution(
    out: Array, load: float, slope: float, bend: float, turn: float, mass: float, damping: float, stiffness: float
) -> None:
    """Stretch of an oscillator under a load that is a cubic in time, by powers of the time [m], [m/s], ...

        x = P/k - c P'/k^2 - (m/k - c^2/k^2) P''/k,   P = p_0 + p_1 t + p_2 t^2 + p_3 t^3

    out                  of x                                    (4,)
    load, slope, bend, turn   p  of the load                     [N], [N/s], [N/s^2], [N/s^3]
    mass, damping, stiffness  m, c, k                            [kg], [N s/m], [N/m]

    Valid    what P''' adds is left out: (2 m c/k^2 - (c/k)^3) P'''/k, see `neglected`
    Source   powers of d/dt in 1/(k + c d/dt + m d^2/dt^2)
    Checked  tests/tethered_deorbit/test_settled.py: put into the equation of motion
    """
    lag = damping / stiffness
    inertia = mass / stiffness - lag * lag
    out[0] = (load - lag * slope - 2.0 * inertia * bend) / stiffness
    out[1] = (slope - 2.0 * lag * bend - 6.0 * inertia * turn) / stiffness
    out[2] = (bend - 3.0 * lag * turn) / stiffness
    out[3] = turn / stiffness


def make_held(reel: Reel, bodies: Bodies, course: Callable[..., Any], sways: bool) -> Held:
    """The kernels for one elastic law of the line, `reel.at_rest`, two bodies, and a course, of one that turns or not.

    Checked  tests/tethered_deorbit/test_settled.py
    """
    line = reel.at_rest

    @kernel
    def tension(
        record: Any, state: Array, rate: Array, separation: float, length: float, speed: float, elapsed: float
    ) -> float:
        """Tension that keeps the line on its course [N].

            T = m (A - x'')

        state, rate   as it is, and its rate without a pull, of `layout`
        elapsed       since the begin of the step                [s]

        Source   l'' = A - T/m
        Checked  tests/tethered_deorbit/test_settled.py
        """
        free, _, _ = bodies.second(record, state, rate, separation, length, speed, 0.0)
        _, _, bend = course(record, elapsed)
        return float(bodies.mass_now(record, state)) * float(free - bend)

    @kernel
    def along(record: Any, tension: float, elapsed: float) -> tuple[float, float, float]:
        """Length of the line with this tension [N], and its two rates: the law of the line gives the tension back.

            l = l0 + (T - c x')/k

        Checked  tests/tethered_deorbit/test_settled.py
        """
        rest, _, _, stiffness, damping = line(record, 0.0)
        _, speed, bend = course(record, elapsed)
        return rest + (tension - damping * speed) / stiffness, speed, bend

    return Held(settled, tension, along, sways=sways)


def make_draw(derivative: Callable[..., Any], reel: Reel, bodies: Bodies, places: Places) -> Callable[..., Any]:
    """The kernel `draw(record, work, span) -> m` for one set of equations, whose rate of the impulse is the tension.

    Checked  tests/tethered_deorbit/test_settled.py
    """
    begin_state, end_state, here_state, slope_state = places.begin, places.end, places.here, places.slope
    low, high, stages, size, moving = places.low, places.high, places.stages, places.size, places.moving
    impulse = places.impulse
    line, seen = reel.at_rest, bodies.seen

    @kernel
    def draw(record: Any, work: Array, span: float) -> float:
        """The course over a time [s] from the begin of the step, in `state.course`; returns the moved mass [kg].

        The pair is carried over it by one step of Runge and Kutta's, order 4, and seen at its thirds by Hermite's
        cubic; the loads there are the tensions with which the line would keep its length.

        Source   Hairer, Norsett and Wanner (1993), table II.1.2 and section II.6
        Checked  tests/tethered_deorbit/test_settled.py
        """
        r = record[0]
        r.state_settled = 1
        for i in range(4):
            r.state_course[i] = 0.0
        start, end = work[begin_state:end_state], work[end_state:here_state]
        there, first = work[here_state:slope_state], work[slope_state:low]
        total, rate = work[low:high], work[high:stages]
        for i in range(size):
            there[i] = start[i]
            end[i] = start[i]
        derivative(record, start, first, 0.0)
        for i in range(moving):
            total[i] = first[i]
            there[i] = start[i] + 0.5 * span * first[i]
        derivative(record, there, rate, 0.5 * span)
        for i in range(moving):
            total[i] += 2.0 * rate[i]
            there[i] = start[i] + 0.5 * span * rate[i]
        derivative(record, there, rate, 0.5 * span)
        for i in range(moving):
            total[i] += 2.0 * rate[i]
            there[i] = start[i] + span * rate[i]
        derivative(record, there, rate, span)
        for i in range(moving):
            end[i] = start[i] + span / 6.0 * (total[i] + rate[i])
        derivative(record, end, rate, span)
        load, last_load = first[impulse], rate[impulse]
        for i in range(moving):
            change = end[i] - start[i]
            there[i] = start[i] + (7.0 * change + span * (4.0 * first[i] - 2.0 * rate[i])) / 27.0
        derivative(record, there, total, span / 3.0)
        second_load = total[impulse]
        for i in range(moving):
            change = end[i] - start[i]
            there[i] = start[i] + (20.0 * change + span * (2.0 * first[i] - 4.0 * rate[i])) / 27.0
        derivative(record, there, total, span / 1.5)
        third_load = total[impulse]
        bend_load = 4.5 * (2.0 * load - 5.0 * second_load + 4.0 * third_load - last_load) / (span * span)
        turn_load = 4.5 * (last_load - load + 3.0 * (second_load - third_load)) / (span * span * span)
        slope_load = (0.5 * (-11.0 * load + 18.0 * second_load - 9.0 * third_load) + last_load) / span
        here = seen(record, start, 0.0)
        mass = float(bodies.mass_now(record, here))
        _, _, _, stiffness, damping = line(record, 0.0)
        slow_solution(r.state_course, load, slope_load, bend_load, turn_load, mass, damping, stiffness)
        r.state_course_span = span
        return mass

    return draw
