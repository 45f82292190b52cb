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
from fmu_src.tethered_deorbit.events import Events
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.interface import NOT_FINITE, STEP_NOT_MET
from fmu_src.tethered_deorbit.layout import Places
from fmu_src.tethered_deorbit.level import Held, Level
from fmu_src.tethered_deorbit.stops import make_stop
from fmu_src.tethered_deorbit.tolerances import ROUNDING, make_longest_taut_step
from fmu_src.tethered_deorbit.turning import add_turning, set_turning, turn_back
from orbital.kernel import kernel
from orbital.vectors import Array, norm

FIRST_TAUT_STEP = 0.3
FIRST_FREE_STEP = 0.05
"""First step after a change: in radians of the line's, or of the orbit's motion."""
WIDEST_TURN = 0.25
"""Greatest angle by which the axes of a step may turn [rad]: inside the series of `turn_back`."""
CAREFUL = 0.9
"""Share of the growth that what a settled step has missed allows: it falls with its fourth power, of bodies that turn
with its sixth (taken as the eighth)."""
SHORTEST = 32.0 * ROUNDING
"""Shortest step asked for, as a share of the time; half of it can no longer be told from rounding."""


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
    held: Held,
    level: Level,
    places: Places,
) -> Trajectory:
    """The kernels for one set of equations, two bodies, an integrator, events, and parts that act by themselves.

    Valid    tolerances that rounding can meet
    Checked  tests/tethered_deorbit/test_macro_step.py
    """
    begin_state, end_state, here_state, size = places.begin, places.end, places.here, places.size
    slope_state = places.slope
    low, high, stages, last = places.low, places.high, places.stages, places.last
    dense_begin, work_end, impulse = places.dense, places.total, places.impulse

    longest_taut_step = make_longest_taut_step(scheme.reach, bodies.further)
    acts = acting is not IDLE
    sways = level.sways
    moving, seen, last_seen = places.moving, bodies.seen, bodies.last_seen

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
        level.restart(record, time)
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

    begin_step, stop = make_stop(attempt, bodies, scheme, events, acting, held, places)

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
        limit = min(max(longest, SHORTEST * abs(r.state_begin)), bodies.longest(record, begin))
        begin_step(record, work)
        if acts:
            limit = min(limit, acting.longest(record, last_seen(record, begin)))
        step = min(r.state_next_step, limit)
        cap = math.inf
        if r.state_taut:
            cap = longest_taut_step(record, bodies.moved_mass(record, last_seen(record, begin)))
            step = level.look(record, work, step, limit, cap)
            if not held.settled(record):
                step = min(step, cap)
                turn = norm(r.state_turning)
                if turn > 0.0:
                    step = min(step, WIDEST_TURN / turn)
        while True:
            if not step > 0.5 * SHORTEST * abs(r.state_begin):
                code = NOT_FINITE if not math.isfinite(r.state_error) else STEP_NOT_MET
                return blame(record, code, 0, r.state_error)
            step = level.prepare(record, work, step, cap)
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
            missed = level.missed(record, work)
            if error <= 1.0 and missed <= 1.0:
                break
            if missed > error:
                error = missed
            r.state_error = error
            r.solver_rejected += 1
            step = level.leave(record, work, scheme.shorter_step(step, error), cap)
        r.state_next_step = scheme.next_step(step, error, r.state_error if math.isfinite(r.state_error) else 1.0)
        if missed > 0.0:
            root = math.sqrt(math.sqrt(missed))
            grown = max(1.0, CAREFUL / (math.sqrt(root) if sways else root))
            r.state_next_step = min(r.state_next_step, grown * step)
        r.state_error = error
        stop(record, work, longest)
        level.book(record)
        return 0

    @kernel
    def tension_at(record: Any, work: Array, time: float) -> float:
        """Tension [N] of a settled line at a time [s] within the current step: the rate of its impulse.

        Checked  tests/tethered_deorbit/test_settled.py
        """
        r = record[0]
        rate = work[slope_state:low]
        if time >= r.state_end or r.state_step == 0.0:
            return float(work[last + impulse])
        fraction = max(0.0, (time - r.state_begin) / r.state_step)
        scheme.dense_rate(work[dense_begin:work_end], fraction, r.state_step, impulse, 1, rate[impulse : impulse + 1])
        return float(rate[impulse])

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
        if held.settled(record):
            length, speed = level.place(record, there, tension_at(record, work, time), since, length, speed)
        for i in range(moving):
            out[i] = there[i]
        if held.mapped(record):
            out[impulse] += held.beyond(record, since)
        turn_back(record, since, out)
        bodies.turn_back(record, since, out)
        return separation, length, speed

    return Trajectory(restart, advance, state_at)
