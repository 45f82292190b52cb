"""Largest and least on the way: the tension over a macro step and over a tug, the separation since the start, and
since a cut of the line.

What is carried from step to step comes from whole steps of the integrator alone, so that it does not depend on the
communication points; what the part of a step up to a communication point adds is shown there and not carried.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.tethered_deorbit.events import RATE, RATE_SLOPE, SEPARATION, TENSION, TENSION_SLOPE, Events
from fmu_src.tethered_deorbit.layout import Places
from fmu_src.tethered_deorbit.level import Held
from fmu_src.tethered_deorbit.nodes.books import Watch
from fmu_src.tethered_deorbit.outputs import note_pull
from orbital.kernel import kernel
from orbital.vectors import Array

MONOTONE = 2.0
"""Slopes at both ends of a cubic, over its mean slope, up to which it has no turn within; 3 would do: Fritsch and
Carlson, SIAM J. Numer. Anal. 17 (1980) 238."""


class Extremes(NamedTuple):
    """Kernels that keep them.

    start(record)                what is published stands: nothing has been yet but this instant
    begin_macro_step(record)
    note(record, work, until)    take in the current step of the integrator, from the last communication point or its
                                 own begin up to a time, or its end
    begin_anew(record)           go on from what was published at the last communication point
    publish(record)              at a communication point, whose tension and separation are there
    """

    start: Callable[..., Any]
    begin_macro_step: Callable[..., Any]
    note: Callable[..., Any]
    begin_anew: Callable[..., Any]
    publish: Callable[..., Any]


def make_extremes(
    events: Events, held: Held, places: Places, releases: bool = False, watch: Watch | None = None
) -> Extremes:
    """The kernels for one law of the line and one integrator.

    releases     the line may be cut on the way
    watch        of a line with tensions of its own along it

    Checked  tests/tethered_deorbit/test_extremes.py, test_macro_step.py
    """

    by_length, end_state, here_state = events.by_length, places.end, places.here
    along = watch or Watch()

    @kernel
    def begin_anew(record: Any) -> None:
        """Carry on from what is published: the state the steps carry becomes that of the last communication point.

        Checked  tests/tethered_deorbit/test_extremes.py: the closest approach is kept when the inputs change
        """
        r = record[0]
        r.state_approach_distance = r.approach_distance
        r.state_approach_time = r.approach_time
        if releases:
            r.state_returned = r.release_returned
            r.state_return_distance, r.state_return_time = r.release_return_distance, r.release_return_time
        if r.state_taut and not r.state_tug_begun:
            r.state_tug_peak = r.tug_peak[0]

    @kernel
    def start(record: Any) -> None:
        """All extremes are those of the first instant.

        Checked  tests/tethered_deorbit/test_extremes.py, test_macro_step.py: nothing is left of an earlier run
        """
        r = record[0]
        r.tether_tension_peak = r.tether_tension
        r.tether_tension_least = r.tether_tension
        r.approach_distance = r.separation
        r.approach_time = 0.0
        if releases:
            r.release_returned = 0
            r.release_return_distance = 0.0
            r.release_return_time = 0.0
        begin_anew(record)

    @kernel
    def begin_macro_step(record: Any) -> None:
        """The tension's range [N] begins empty.

        Checked  tests/tethered_deorbit/test_extremes.py: the range is that of one macro step
        """
        r = record[0]
        r.state_peak = 0.0
        r.state_least = math.inf
        along.begin(record)

    @kernel
    def publish(record: Any) -> None:
        """Write the extremes at a communication point, its own tension [N] and separation [m] among them.

        Checked  tests/tethered_deorbit/test_extremes.py
        """
        r = record[0]
        r.state_peak = max(r.state_peak, r.tether_tension)
        r.state_least = min(r.state_least, r.tether_tension)
        r.tether_tension_peak = r.state_peak
        r.tether_tension_least = r.state_least
        if r.separation < r.approach_distance:
            r.approach_distance = r.separation
            r.approach_time = r.state_published

    @kernel
    def note_tension(record: Any, work: Array, first: float, last: float, begin: Any, end: Any) -> None:
        """Take in the tension between two fractions of a taut step; the first is past zero after a communication point.

        first, last   fractions of the step                          [-]
        begin, end    signals at its begin and its end

        The dense output is asked only where a turn of the tension may lie within the step: not where it stands still,
        changes steadily, or the step is shorter than a quarter of the vibration.

        Checked  tests/tethered_deorbit/test_extremes.py: the range of long steps is that of short ones;
                 test_tugs.py: peaks
        """
        r = record[0]
        complete = last == 1.0
        least, largest = min(begin[TENSION], end[TENSION]), max(begin[TENSION], end[TENSION])
        change = end[TENSION] - begin[TENSION]
        begin_change, end_change = r.state_step * begin[TENSION_SLOPE], r.state_step * end[TENSION_SLOPE]
        still = max(abs(begin_change), abs(end_change)) <= 4.0 * r.state_stiffness * r.state_taut_tolerance
        steady = max(abs(begin_change - change), abs(end_change - change)) <= 0.25 * abs(change)
        if held.sways and held.settled(record):
            # a load without vibration: the cubic through both ends rises or falls throughout, with room
            steady = min(begin_change * change, end_change * change) >= 0.0 and (
                max(abs(begin_change), abs(end_change)) <= MONOTONE * abs(change)
            )
        short = (begin_change >= 0.0) == (end_change >= 0.0) and r.state_step * r.state_frequency < 1.5
        if held.mapped(record) or not (complete and (still or steady or short)):
            most = min(r.state_peak, r.tug_peak[0])
            least, largest = events.tension_range(record, work, 0.0, last, r.state_least, most)
        if r.state_taut:
            note_pull(record, largest)
        if complete and r.state_taut and not r.state_tug_begun:
            r.state_tug_peak = r.tug_peak[0]
        if first > 0.0:
            least, largest = events.tension_range(record, work, first, last, r.state_least, r.state_peak)
        r.state_peak = max(r.state_peak, largest)
        r.state_least = min(r.state_least, max(0.0, least))

    @kernel
    def note_approach(record: Any, work: Array, last: float, begin: Any, end: Any) -> None:
        """Take in the separation [m], at the end of a step and at a turn in it.

        A turn is searched where it may be nearer than all before by more than the tolerance of the separation.

        last          fraction of the step up to which it counts     [-]
        begin, end    signals at its begin and its end

        Checked  tests/tethered_deorbit/test_extremes.py: two bodies that pass
        """
        r = record[0]
        r.approach_distance, r.approach_time = r.state_approach_distance, r.state_approach_time
        fastest = max(abs(begin[RATE]), abs(end[RATE]))
        fastest += r.state_step * max(abs(begin[RATE_SLOPE]), abs(end[RATE_SLOPE]))
        within_reach = min(begin[SEPARATION], end[SEPARATION]) - 0.5 * r.state_step * fastest
        if within_reach < r.approach_distance - r.solver_tolerance_separation:
            fraction, distance = events.nearest(record, work, last)
            if distance < r.approach_distance:
                r.approach_distance, r.approach_time = distance, r.state_begin + fraction * r.state_step
        if last == 1.0:
            if end[SEPARATION] < r.approach_distance:
                r.approach_distance, r.approach_time = end[SEPARATION], r.state_end
            r.state_approach_distance, r.state_approach_time = r.approach_distance, r.approach_time

    @kernel
    def note_return(record: Any, work: Array, last: float, begin: Any, end: Any) -> None:
        """Take in a pass [m] after the line is cut: every turn of the separation until one is found, then nearer ones.

        Arguments as in `note_approach`.

        Checked  tests/tethered_deorbit/test_release.py, against two Kepler orbits
        """
        r = record[0]
        r.release_returned = r.state_returned
        r.release_return_distance, r.release_return_time = r.state_return_distance, r.state_return_time
        fastest = max(abs(begin[RATE]), abs(end[RATE]))
        fastest += r.state_step * max(abs(begin[RATE_SLOPE]), abs(end[RATE_SLOPE]))
        within_reach = min(begin[SEPARATION], end[SEPARATION]) - 0.5 * r.state_step * fastest
        if r.state_returned and within_reach >= r.state_return_distance - r.solver_tolerance_separation:
            return
        fraction, distance = events.nearest(record, work, last)
        if fraction >= 0.0 and not (r.state_returned and distance >= r.state_return_distance):
            r.release_returned = 1
            r.release_return_distance, r.release_return_time = distance, r.state_begin + fraction * r.state_step
        if last == 1.0:
            r.state_returned = r.release_returned
            r.state_return_distance, r.state_return_time = r.release_return_distance, r.release_return_time

    @kernel
    def note(record: Any, work: Array, until: float) -> None:
        """Take in the current step up to a time [s]: see `Extremes`.

        Checked  tests/tethered_deorbit/test_extremes.py, test_macro_step.py: nothing of the future
        """
        r = record[0]
        if r.state_step == 0.0:
            return
        begin, end = r.state_at_begin, r.state_at_end
        last = 1.0 if until >= r.state_end else max(0.0, (until - r.state_begin) / r.state_step)
        first = min(last, max(0.0, (r.state_published - r.state_begin) / r.state_step))
        if r.state_taut or by_length:
            note_tension(record, work, first, last, begin, end)
        else:
            r.state_least = 0.0
        if last == 1.0:
            along.note(record, work[end_state:here_state])
        note_approach(record, work, last, begin, end)
        if releases:
            if r.state_released and r.state_begin >= r.release_time:
                note_return(record, work, last, begin, end)

    return Extremes(start, begin_macro_step, note, begin_anew, publish)
