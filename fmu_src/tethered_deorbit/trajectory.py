"""The trajectory in the integrator's own steps, which know nothing of communication points.

A step reaches from `state.begin` to `state.end` and is kept with its dense output until a communication point lies past
it. So the same inputs give the same steps, bit for bit, whatever the macro step. A step ends early, exactly there, when
the line changes between slack and taut.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.integrators.scheme import AdaptiveScheme
from fmu_src.tethered_deorbit.acting import IDLE, Acting
from fmu_src.tethered_deorbit.bodies import Bodies
from fmu_src.tethered_deorbit.events import CROSSING, CROSSING_SLOPE, TENSION, TENSION_SLOPE, Events, Signals
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.idle import always
from fmu_src.tethered_deorbit.interface import NOT_FINITE, STEP_NOT_MET
from fmu_src.tethered_deorbit.layout import Places
from fmu_src.tethered_deorbit.turning import add_turning, set_turning, turn_back
from orbital.kernel import kernel
from orbital.vectors import Array, dot, norm

FIRST_TAUT_STEP = 0.3
FIRST_FREE_STEP = 0.05
"""First step after a change: in radians of the line's, or of the orbit's motion."""
WIDEST_TURN = 0.25
"""Greatest angle by which the axes of a step may turn [rad]: inside the series of `turn_back`."""
SHORTEST_CONTACT = 1.0e-6
"""Least time between two changes, in radians of the line's motion: a line that grazes goes on."""
LANDING_ITERATIONS = 5
LINE, EDGES, ACTS = 1, 2, 3
"""What ends a step, by `state.event`: a change between slack and taut, of the line's way over edges, or a part acts."""
SHORTEST_BETWEEN_EDGES, LEAST_BETWEEN_EDGES = 1.0e-3, 1.0e-3
"""Least time between two changes of the edges, in radians of the line's motion, and [s]: what the line passes through
the body in between is of second order in its length."""
EDGE = 1.0e-10
"""Fraction of a step to which the instant is found at which the line meets an edge or leaves one."""
LAST = 1.0 - 1.0e-12
"""Fraction of a step from which on it is over, to the accuracy with which a change is located."""
ROUNDING = 4.0 * 2.220446049250313e-16
SHORTEST = 32.0 * ROUNDING
"""Shortest step asked for, as a share of the time; half of it can no longer be told from rounding."""


def make_squared_error(bodies: Bodies) -> Callable[..., Any]:
    """Size of an error of the state in units of the tolerances."""

    @kernel
    def squared_error(record: Any, state: Array, error: Array) -> float:
        """Square of the error's size [-].

            sum of (e_R/tol_o)^2, (e_V/(tol_o n))^2, (e_rho/tol_s)^2, (e_rho'/(tol_s n))^2,
            and while taut, of the parts along the line, (e.u/tol_t)^2, (e'.u/(tol_t omega))^2,
            and what the bodies add for their attitudes

        Each tolerance is at least a few units in the last place of what it bounds.

        state, error     of `layout`

        Valid    n the pace of the environment, on an orbit its mean motion, omega the taut line's frequency
        Source   ours
        Checked  tests/tethered_deorbit/test_integrator.py
        """
        r = record[0]
        n = r.state_pace
        orbit = r.solver_tolerance_orbit + ROUNDING * norm(state[0:3])
        orbit_rate = r.solver_tolerance_orbit * n + ROUNDING * norm(state[3:6])
        length = norm(state[6:9])
        apart = r.solver_tolerance_separation + ROUNDING * length
        apart_rate = r.solver_tolerance_separation * n + ROUNDING * norm(state[9:12])
        square = dot(error[0:3], error[0:3]) / (orbit * orbit)
        square += dot(error[3:6], error[3:6]) / (orbit_rate * orbit_rate)
        square += dot(error[6:9], error[6:9]) / (apart * apart)
        if r.state_taut and length > 0.0:
            taut = r.state_taut_tolerance + ROUNDING * length
            taut_rate = taut * r.state_frequency
            along, along_rate = dot(error[6:9], state[6:9]) / length, dot(error[9:12], state[6:9]) / length
            across = dot(error[9:12], error[9:12]) - along_rate * along_rate
            square += along * along / (taut * taut) + along_rate * along_rate / (taut_rate * taut_rate)
            square += max(0.0, across) / (apart_rate * apart_rate)
        else:
            square += dot(error[9:12], error[9:12]) / (apart_rate * apart_rate)
        return float(square + bodies.squared_error(record, state, error))

    return squared_error


def make_longest_taut_step(reach: Callable[..., Any]) -> Callable[..., Any]:
    """The kernel that says how long a step of a taut line may be, of a scheme with this `AdaptiveScheme.reach`."""

    @kernel
    def longest_taut_step(record: Any) -> float:
        """Longest step [s] of a taut line: as far as the scheme reaches over its vibration.

            h omega <= reach(zeta),   zeta = c / (2 m omega),   m the line's effective mass

        Valid    omega the frequency of the fastest motion, that of the dashpot when it is faster than the spring
        Source   `AdaptiveScheme.reach`, which for a scheme that damps what is stiff has no end
        Checked  tests/tethered_deorbit/test_turning.py
        """
        r = record[0]
        damping = abs(r.state_damping) / (2.0 * r.state_effective_mass * r.state_frequency)
        longest: float = reach(damping) / r.state_frequency
        return longest

    return longest_taut_step


class Trajectory(NamedTuple):
    """Kernels that move along the trajectory.

    restart(record, work, time)               begin anew at the state stored as END
    advance(record, work, longest) -> fault   take the next step, up to a change of the line, but no longer [s]
    state_at(record, work, time, out) -> (separation [m], length of the line [m], its rate [m/s])   state within the
                                              current step, inertial axes; the three from before the axes are turned
                                              back: the bits of the tension do not depend on who asks
    """

    restart: Callable[..., Any]
    advance: Callable[..., Any]
    state_at: Callable[..., Any]


def make_trajectory(
    derivative: Callable[..., Any],
    bodies: Bodies,
    scheme: AdaptiveScheme,
    events: Events,
    acting: Acting,
    places: Places,
) -> Trajectory:
    """The kernels for one set of equations, two bodies, an integrator, events, and parts that act by themselves.

    Valid    tolerances that rounding can meet
    Checked  tests/tethered_deorbit/test_macro_step.py
    """
    begin_state, end_state, here_state, size = places.begin, places.end, places.here, places.size
    slope_state = places.slope
    low, high, stages, last = places.low, places.high, places.stages, places.last
    dense_begin, work_end = places.dense, places.total

    longest_taut_step = make_longest_taut_step(scheme.reach)
    acts = acting is not IDLE
    watches = acts or bodies.holds is not always
    moving, seen = places.moving, bodies.seen

    @kernel
    def restart(record: Any, work: Array, time: float) -> None:
        """Begin anew at the state stored as END, at a time [s]: axes at rest, a short first step.

        Checked  tests/tethered_deorbit/test_macro_step.py, test_ramps.py: a ramp does not see what ran ahead
        """
        r = record[0]
        for i in range(size):
            work[begin_state + i] = work[end_state + i]
        bodies.rest(record)
        for i in range(3):
            r.state_turning[i] = 0.0
        r.state_begin = time
        r.state_end = time
        r.state_since += r.state_step
        r.state_step = 0.0
        r.state_event = 0
        r.state_fresh = 1
        r.state_dense_ready = 0
        r.state_error = 1.0e-4
        free = FIRST_FREE_STEP / r.state_pace
        r.state_next_step = min(free, FIRST_TAUT_STEP / r.state_frequency) if r.state_taut else free

    @kernel
    def attempt(record: Any, work: Array, step: float) -> None:
        """One step of the integrator of a given size [s], from BEGIN to END.

        Checked  tests/tethered_deorbit/test_macro_step.py, tests/consistency/test_table2.py
        """
        scheme.attempt(
            record,
            work[begin_state:end_state],
            step,
            work[stages:dense_begin],
            work[end_state:here_state],
        )
        r = record[0]
        r.state_step = step
        r.state_end = r.state_begin + step
        r.state_dense_ready = 0

    @kernel
    def end_signals(record: Any, work: Array) -> Signals:
        """The signals at the end of the step: see `Events`.

        Checked  tests/tethered_deorbit/test_tugs.py
        """
        signals: Signals = events.signals(
            record, work[end_state:here_state], work[last : last + size], record[0].state_step
        )
        return signals

    @kernel
    def quiet(record: Any, work: Array) -> bool:
        """Whether a taut line's tension cannot reach zero within the step, judged by its slope at both ends.

            2 h max|T'| < min T

        Valid    a slope that is nowhere in the step twice that of its steeper end
        Checked  tests/tethered_deorbit/test_tugs.py, against an independent integration: no change is lost
        """
        r = record[0]
        begin = events.signals(record, work[begin_state:end_state], work[stages : stages + size], 0.0)
        end = end_signals(record, work)
        steepest = max(abs(begin[TENSION_SLOPE]), abs(end[TENSION_SLOPE]))
        return bool(2.0 * r.state_step * steepest < min(begin[TENSION], end[TENSION]))

    @kernel
    def land(record: Any, work: Array, fraction: float) -> None:
        """Redo the step so that it ends on the change, to rounding: Newton on its size, from the dense output.

        fraction      of the step at which the change lies           [-]

        Source   Newton's method, held within the step
        Checked  tests/tethered_deorbit/test_tugs.py: the length at which a tug begins
        """
        r = record[0]
        whole = r.state_step
        least = min(whole, SHORTEST_CONTACT / r.state_frequency)
        step = max(least, fraction * whole)
        attempt(record, work, step)
        for _ in range(LANDING_ITERATIONS):
            there = end_signals(record, work)
            value, slope = there[CROSSING], there[CROSSING_SLOPE]
            if not abs(value) < 0.1 * abs(slope) * step:
                break
            better = min(whole, max(least, step - value / slope))
            if abs(better - step) <= ROUNDING * step:
                break
            step = better
            attempt(record, work, step)
        there = end_signals(record, work)
        # What has risen and fallen again within the least time between two changes was none.
        r.state_event = LINE if max(there[CROSSING], there[CROSSING_SLOPE]) > 0.0 else 0

    @kernel
    def ceased(record: Any, state: Array, elapsed: float) -> int:
        """What has ceased to hold `elapsed` [s] after the begin of the step, as a number of `state.event`, or 0.

        state         in the coordinates of the step, of `layout`

        Checked  tests/tethered_deorbit/test_wrapping.py, test_ends.py
        """
        there = seen(record, state, elapsed)
        if not bodies.holds(record, there):
            return EDGES
        if acts and not acting.holds(record, there, record[0].state_since + elapsed):
            return ACTS
        return 0

    @kernel
    def retry(record: Any, work: Array) -> bool:
        """Whether a way of the line that holds has been found where there was none.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        there = seen(record, work[end_state:here_state], record[0].state_step)
        return bool(bodies.retry(record, there))

    @kernel
    def stop_where_ceased(record: Any, work: Array) -> None:
        """Redo the step so that it ends where the line's way over edges, or what a part goes by, has just ceased to
        hold, by halving.

        Checked  tests/tethered_deorbit/test_wrapping.py, test_ends.py
        """
        r = record[0]
        low, high = 0.0, 1.0
        event = ceased(record, work[end_state:here_state], r.state_step)
        here = work[here_state:slope_state]
        events.ensure_dense(record, work)
        while high - low > EDGE:
            middle = 0.5 * (low + high)
            scheme.dense_value(work[begin_state:end_state], work[dense_begin:work_end], middle, 0, size, here)
            there = ceased(record, here, middle * r.state_step)
            if there == 0:
                low = middle
            else:
                high, event = middle, there
        least = 0.0
        if event == EDGES:
            least = min(LEAST_BETWEEN_EDGES, SHORTEST_BETWEEN_EDGES / r.state_frequency)
        attempt(record, work, max(high * r.state_step, min(r.state_step, least)))
        r.state_event = event

    @kernel
    def stop_at_limit(record: Any, work: Array) -> None:
        """Redo the step so that it ends where the tension exceeds what a part lets pass, unless it ends before.

        Checked  tests/tethered_deorbit/test_ends.py
        """
        r = record[0]
        limit = acting.limit(record)
        if r.state_taut and limit < math.inf:
            fraction = events.first_above(record, work, limit)
            if fraction >= 0.0:
                least = min(r.state_step, SHORTEST_CONTACT / r.state_frequency)
                attempt(record, work, max(least, fraction * r.state_step))
                r.state_event = ACTS

    @kernel
    def advance(record: Any, work: Array, longest: float) -> int:
        """Take the next step; returns 0 or a fault. It ends early where the line changes.

        longest       longest step allowed                           [s]

        Checked  tests/tethered_deorbit/test_macro_step.py, test_integrator.py: tolerances rule the error;
                 test_robust.py
        """
        r = record[0]
        r.state_since += r.state_step
        begin = work[begin_state:end_state]
        rate = work[stages : stages + size]
        for i in range(size):
            begin[i] = work[end_state + i]
        if r.state_fresh:
            bodies.hold(record, begin)
            bodies.enter(record, begin)
            set_turning(record, begin)
            derivative(record, begin, rate, 0.0)
            r.state_fresh = 0
        else:
            for i in range(size):
                rate[i] = work[last + i]
            if r.state_taut:
                add_turning(record, begin, rate, 1.0)
                turn_back(record, r.state_step, begin)
                turn_back(record, r.state_step, rate)
                bodies.turn_back(record, r.state_step, begin)
            bodies.go_on(record, r.state_step, begin, rate)
            if r.state_taut:
                set_turning(record, begin)
                add_turning(record, begin, rate, -1.0)
                bodies.add_turning(record, begin, rate, -1.0)
        r.state_begin = r.state_end
        r.state_event = 0
        r.solver_steps += 1
        step = min(r.state_next_step, max(longest, SHORTEST * abs(r.state_begin)))
        step = min(step, bodies.longest(record, begin))
        if acts:
            step = min(step, acting.longest(record, seen(record, begin, 0.0)))
        if r.state_taut:
            step = min(step, longest_taut_step(record))
            turn = norm(r.state_turning)
            if turn > 0.0:
                step = min(step, WIDEST_TURN / turn)
        while True:
            if not step > 0.5 * SHORTEST * abs(r.state_begin):
                code = NOT_FINITE if not math.isfinite(r.state_error) else STEP_NOT_MET
                return blame(record, code, 0, r.state_error)
            attempt(record, work, step)
            error = scheme.error(
                record,
                work[end_state:here_state],
                step,
                work[stages:dense_begin],
                work[low:high],
                work[high:stages],
            )
            code = bodies.trouble(record)
            if code != 0:
                return blame(record, code, 0, 0.0)
            if error <= 1.0:
                break
            r.state_error = error
            r.solver_rejected += 1
            step = scheme.shorter_step(step, error)
        r.state_next_step = scheme.next_step(step, error, r.state_error if math.isfinite(r.state_error) else 1.0)
        r.state_error = error
        if not (r.state_taut and quiet(record, work)):
            fraction = events.find_change(record, work)
            # Where moving inputs end a step, a change in its last digit is for the next to judge: they may turn round.
            if fraction >= 0.0 and not (fraction >= LAST and longest < math.inf):
                land(record, work, fraction)
        if acts:
            stop_at_limit(record, work)
        if watches and ceased(record, work[end_state:here_state], r.state_step) != 0:
            stop_where_ceased(record, work)
        elif watches and r.state_event == 0 and retry(record, work):
            r.state_event = EDGES
        return 0

    @kernel
    def state_at(record: Any, work: Array, time: float, out: Array) -> tuple[float, float, float]:
        """Separation [m], length of the line [m] and its rate [m/s] at a time; out becomes the state, inertial axes.

        time          within the current step, or its end            [s]
        out           of `layout`

        Checked  tests/tethered_deorbit/test_macro_step.py: the same bits whatever the macro step
        """
        r = record[0]
        since = r.state_step
        if time >= r.state_end or r.state_step == 0.0:
            for i in range(size):
                out[i] = work[end_state + i]
        else:
            events.ensure_dense(record, work)
            fraction = max(0.0, (time - r.state_begin) / r.state_step)
            since = fraction * r.state_step
            scheme.dense_value(work[begin_state:end_state], work[dense_begin:work_end], fraction, 0, size, out)
        there = seen(record, out, since)
        separation, length, speed = bodies.measure(record, there)
        for i in range(moving):
            out[i] = there[i]
        turn_back(record, since, out)
        bodies.turn_back(record, since, out)
        return separation, length, speed

    return Trajectory(restart, advance, state_at)
