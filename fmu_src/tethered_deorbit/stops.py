"""Where a step ends early: the line changes between slack and taut, comes over other edges, or a part acts.

The signals at both ends of a step are worked out once and kept with it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from fmu_src.integrators.scheme import AdaptiveScheme
from fmu_src.tethered_deorbit.acting import IDLE, Acting
from fmu_src.tethered_deorbit.bodies import Bodies
from fmu_src.tethered_deorbit.events import (
    CROSSING,
    CROSSING_SLOPE,
    INTERVALS,
    SIGNALS,
    TENSION,
    TENSION_SLOPE,
    Events,
    Signals,
)
from fmu_src.tethered_deorbit.idle import always
from fmu_src.tethered_deorbit.layout import Places
from fmu_src.tethered_deorbit.level import Held
from fmu_src.tethered_deorbit.tolerances import ROUNDING
from orbital.kernel import kernel
from orbital.vectors import Array

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


def make_stop(
    attempt: Callable[..., Any],
    bodies: Bodies,
    scheme: AdaptiveScheme,
    events: Events,
    acting: Acting,
    held: Held,
    places: Places,
) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """The kernels `begin(record, work)`, to be called at the begin of a step, and `stop(record, work, longest)`, which
    ends the step just taken where it has to end.

    attempt(record, work, step)   takes it anew, of another size [s]

    Checked  tests/tethered_deorbit/test_tugs.py, test_macro_step.py
    """
    begin_state, end_state, here_state, size = places.begin, places.end, places.here, places.size
    slope_state, stages, last = places.slope, places.stages, places.last
    dense_begin, work_end = places.dense, places.total
    acts = acting is not IDLE
    by_length = events.by_length
    watches = acts or bodies.holds is not always
    seen, last_seen = bodies.seen, bodies.last_seen

    @kernel
    def keep_end(record: Any, work: Array) -> None:
        """Signals at the end of the step, in `state.at_end`.

        Checked  tests/tethered_deorbit/test_tugs.py
        """
        r = record[0]
        found: Signals = events.signals(record, work[end_state:here_state], work[last : last + size], r.state_step)
        for i in range(SIGNALS):
            r.state_at_end[i] = found[i]

    @kernel
    def keep_begin(record: Any, work: Array) -> None:
        """Those at its begin, in `state.at_begin`.

        Checked  tests/tethered_deorbit/test_tugs.py
        """
        r = record[0]
        found: Signals = events.signals(record, work[begin_state:end_state], work[stages : stages + size], 0.0)
        for i in range(SIGNALS):
            r.state_at_begin[i] = found[i]

    @kernel
    def most(record: Any, signal: int, slope: int) -> float:
        """Bound of a signal within the step, by its two ends: see `quiet`.

        Checked  tests/tethered_deorbit/test_tugs.py, test_ends.py
        """
        begin, end, step = record[0].state_at_begin, record[0].state_at_end, record[0].state_step
        second = begin[signal] + step * begin[slope] / 3.0
        third = end[signal] - step * end[slope] / 3.0
        highest = max(max(begin[signal], end[signal]), max(second, third))
        lowest = min(min(begin[signal], end[signal]), min(second, third))
        return float(2.0 * highest - lowest)

    @kernel
    def quiet(record: Any) -> bool:
        """Whether the line cannot change between slack and taut within the step, judged by its two ends.

            taut      2 h max|T'| < min T
            slack     max b + (max b - min b) < 0,   b = (s_0, s_0 + h s_0'/3, s_1 - h s_1'/3, s_1)

        b are the points between which the cubic of the onset s through both ends lies. A line that is taut by its
        length has one then too.

        Valid    a slope of the tension that is nowhere in the step twice that of its steeper end; an onset that leaves
                 its cubic by less than the cubic's own range
        Source   Bezier: a polynomial lies in the hull of its control points
        Checked  tests/tethered_deorbit/test_tugs.py, against an independent integration: no change is lost;
                 test_rigid.py: nor where a body tumbles
        """
        r = record[0]
        begin, end, step = r.state_at_begin, r.state_at_end, r.state_step
        if r.state_taut and not by_length:
            steepest = max(abs(begin[TENSION_SLOPE]), abs(end[TENSION_SLOPE]))
            return bool(2.0 * step * steepest < min(begin[TENSION], end[TENSION]))
        return bool(most(record, CROSSING, CROSSING_SLOPE) < 0.0)

    @kernel
    def land(record: Any, work: Array, fraction: float) -> None:
        """Redo the step so that it ends on the change, to rounding: Newton on its size, from the dense output.

        fraction      of the step at which the change lies           [-]

        Source   Newton's method, held within the step
        Checked  tests/tethered_deorbit/test_tugs.py: the length at which a tug begins
        """
        r = record[0]
        there = r.state_at_end
        whole = r.state_step
        least = min(whole, SHORTEST_CONTACT / r.state_frequency)
        step = max(least, fraction * whole)
        attempt(record, work, step)
        keep_end(record, work)
        for _ in range(LANDING_ITERATIONS):
            value, slope = there[CROSSING], there[CROSSING_SLOPE]
            if not abs(value) < 0.1 * abs(slope) * step:
                break
            better = min(whole, max(least, step - value / slope))
            if abs(better - step) <= ROUNDING * step:
                break
            step = better
            attempt(record, work, step)
            keep_end(record, work)
        # What has risen and fallen again within the least time between two changes was none.
        r.state_event = LINE if max(there[CROSSING], there[CROSSING_SLOPE]) > 0.0 else 0

    @kernel
    def ceased(record: Any, there: Array, elapsed: float) -> int:
        """What has ceased to hold `elapsed` [s] after the begin of the step, as a number of `state.event`, or 0.

        there         as it is, of `layout`; after `Bodies.seen`

        Checked  tests/tethered_deorbit/test_wrapping.py, test_ends.py
        """
        if not bodies.holds(record, there):
            return EDGES
        if acts and not acting.holds(record, there, record[0].state_since + elapsed):
            return ACTS
        return 0

    @kernel
    def stop_where_ceased(record: Any, work: Array, event: int, by: float) -> None:
        """Redo the step so that it ends where the line's way over edges, or what a part goes by, has just ceased to
        hold, by halving.

        event         what has ceased, as a number of `state.event`
        by            fraction of the step at which it has           [-]

        Checked  tests/tethered_deorbit/test_wrapping.py, test_ends.py
        """
        r = record[0]
        low, high = 0.0, by
        here = work[here_state:slope_state]
        events.ensure_dense(record, work)
        while high - low > EDGE:
            middle = 0.5 * (low + high)
            scheme.dense_value(work[begin_state:end_state], work[dense_begin:work_end], middle, 0, size, here)
            elapsed = middle * r.state_step
            there = ceased(record, seen(record, here, elapsed), elapsed)
            if there == 0:
                low = middle
            else:
                high, event = middle, there
        least = 0.0
        if event == EDGES:
            least = min(LEAST_BETWEEN_EDGES, SHORTEST_BETWEEN_EDGES / r.state_frequency)
        attempt(record, work, max(high * r.state_step, min(r.state_step, least)))
        keep_end(record, work)
        r.state_event = event

    @kernel
    def lost_at(record: Any, work: Array, fraction: float) -> bool:
        """Whether the line's way over edges does not hold at a fraction of the step [-], of which the dense output is.

        Checked  tests/tethered_deorbit/test_settled_wrapped.py: a step that would go over an edge and back
        """
        here = work[here_state:slope_state]
        scheme.dense_value(work[begin_state:end_state], work[dense_begin:work_end], fraction, 0, size, here)
        return not bodies.holds(record, seen(record, here, fraction * record[0].state_step))

    @kernel
    def look_between(record: Any, work: Array) -> None:
        """End a settled step where the line comes over an edge that it has left again by the end of the step.

        Such a step is so long that what the line passes through the body in between counts. It is looked at at eighths,
        and a straight line where the parabola through its lowest three rises is least.

        Valid    a straight line whose rise is smooth; one over edges that does not hold for an eighth of the step
        Checked  tests/tethered_deorbit/test_settled_wrapped.py: a step that would go over an edge and back
        """
        r = record[0]
        if bodies.stays(record, work[begin_state:end_state], work[end_state:here_state], r.state_step):
            return
        events.ensure_dense(record, work)
        before, lowest = math.inf, math.inf
        for k in range(INTERVALS + 1):
            fraction = k / INTERVALS
            if lost_at(record, work, fraction) and 0 < k < INTERVALS:
                stop_where_ceased(record, work, EDGES, fraction)
                return
            rise = bodies.rise(record)
            if k > 1 and lowest < min(before, rise):
                vertex = (k - 1.0 + 0.5 * (before - rise) / (before - 2.0 * lowest + rise)) / INTERVALS
                if lost_at(record, work, vertex):
                    stop_where_ceased(record, work, EDGES, vertex)
                    return
            before, lowest = lowest, rise

    @kernel
    def stop_at_limit(record: Any, work: Array) -> None:
        """Redo the step so that it ends where the tension exceeds what a part lets pass, unless it ends before.

        Checked  tests/tethered_deorbit/test_ends.py
        """
        r = record[0]
        limit = acting.limit(record)
        if r.state_taut and (most(record, TENSION, TENSION_SLOPE) >= limit or held.mapped(record)) and limit < math.inf:
            fraction = events.first_above(record, work, limit)
            if fraction >= 0.0:
                least = min(r.state_step, SHORTEST_CONTACT / r.state_frequency)
                attempt(record, work, max(least, fraction * r.state_step))
                keep_end(record, work)
                r.state_event = ACTS

    @kernel
    def stop(record: Any, work: Array, longest: float) -> None:
        """End the step where it has to end; after `begin`.

        longest       longest step allowed                           [s]

        Checked  tests/tethered_deorbit/test_tugs.py, test_macro_step.py, test_ends.py
        """
        r = record[0]
        keep_end(record, work)
        looked = not (held.mapped(record) or quiet(record))
        if held.bounces(record):
            r.state_event = LINE
        if looked:
            fraction = events.find_change(record, work)
            # Where moving inputs end a step, a change in its last digit is for the next to judge: they may turn round.
            if fraction >= 0.0 and not (fraction >= LAST and longest < math.inf):
                land(record, work, fraction)
        if acts:
            stop_at_limit(record, work)
        if watches:
            end = work[end_state:here_state]
            if looked or acts:
                seen(record, end, r.state_step)
            there = last_seen(record, end)
            event = ceased(record, there, r.state_step)
            if event != 0:
                stop_where_ceased(record, work, event, 1.0)
            elif r.state_event == 0 and bodies.retry(record, there):
                r.state_event = EDGES
            elif r.state_event == 0 and held.settled(record):
                look_between(record, work)

    return keep_begin, stop
