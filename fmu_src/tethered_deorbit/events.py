"""What happens inside one step of the integrator: where the line goes slack or taut, and its largest tension.

Everything is read off the dense output of the step. Signals and their exact time derivatives are sampled at a few
points; between two of them an extremum shows by its slope, so that a line that goes taut and slack again within one
step is found.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.integrators.scheme import AdaptiveScheme
from fmu_src.tethered_deorbit.bodies import Bodies
from fmu_src.tethered_deorbit.law import Reel
from fmu_src.tethered_deorbit.layout import Places
from fmu_src.tethered_deorbit.level import Held
from orbital.kernel import kernel
from orbital.vectors import Array

INTERVALS = 8
SAMPLES, BETWEEN = 16, 0.1
"""Where the rate of the impulse is looked at, and what it may do in between, over what it spans: over a step of 4
radians a cosine goes on by 0.008 of itself."""
ROOT_ITERATIONS = 80
CROSSING, CROSSING_SLOPE, TENSION, TENSION_SLOPE, SEPARATION, RATE, RATE_SLOPE = range(7)
"""Signals: the crossing signal rises through zero when the line changes between slack and taut."""
SIGNALS = 7
Signals = tuple[float, float, float, float, float, float, float]


class Events(NamedTuple):
    """Kernels that search the current step.

    signals(record, state, rate, elapsed) -> (crossing, its rate, tension, its rate, separation, its rate, that one's)
                                                          of any state of the step, in its axes, `elapsed` [s] after its
                                                          begin; the line as it is now
    ensure_dense(record, work)                            compute the dense output of the step unless it is there
    find_change(record, work) -> fraction                 of the step at which slack and taut change, or -1
    tension_range(record, work, first, last, known_least, known_largest) -> (least, largest)   tension [N] between two
                                                          fractions of the step, where it goes beyond what is known
    first_above(record, work, limit) -> fraction          of the step at which the tension first exceeds one [N], or -1
    nearest(record, work, last) -> (fraction, distance)   where the separation turns from less to more and is least
                                                          [m], up to a fraction of the step; infinite if nowhere
    by_length                                             as of `law.Reel`
    """

    signals: Callable[..., Any]
    ensure_dense: Callable[..., Any]
    find_change: Callable[..., Any]
    tension_range: Callable[..., Any]
    first_above: Callable[..., Any]
    nearest: Callable[..., Any]
    by_length: bool


def make_events(reel: Reel, bodies: Bodies, held: Held, scheme: AdaptiveScheme, places: Places) -> Events:
    """The kernels for one law of the line, two bodies and one integrator.

    Valid    steps in which the signals turn at most once in an eighth of the step
    Checked  tests/tethered_deorbit/test_robust.py
    """
    begin_state, end_state, here_state, slope_state = places.begin, places.end, places.here, places.slope
    low_error, high_error, stages, dense_begin = places.low, places.high, places.stages, places.dense
    first, seen = reel.first, places.moving - reel.first
    work_end, impulse = places.total, places.impulse
    state_seen, rate_seen = bodies.seen, bodies.seen_rate
    by_length = reel.by_length

    @kernel
    def signals(record: Any, state: Array, rate: Array, elapsed: float) -> Signals:
        """The seven signals of a state: see `Events`, and CROSSING to RATE_SLOPE for their places.

        state, rate   of `layout`, in the coordinates and axes of the step
        elapsed       since the begin of the step                    [s]

        Checked  tests/tethered_deorbit/test_turning.py: bits that no axes change; test_terms.py: the kinematics
        """
        there = state_seen(record, state, elapsed)
        separation, length, speed = bodies.measure(record, there)
        slopes = rate_seen(record, there, rate)
        change, apart, slope = bodies.second(record, there, slopes, separation, length, speed, 1.0)
        if held.settled(record):
            length, speed, change = held.along(record, rate[impulse], elapsed)
        since = record[0].state_since + elapsed
        reel.see(record, there)
        reel.see_change(record, there, slopes, 1.0)
        tension = reel.tension(record, length, speed, since)
        tension_rate = reel.tension_rate(record, length, speed, change, since)
        if record[0].state_taut and not by_length:
            return -tension, -tension_rate, tension, tension_rate, separation, apart, slope
        onset = reel.onset(record, length, speed, since)
        onset_rate = reel.onset_rate(record, length, speed, change, since)
        if record[0].state_taut:
            onset, onset_rate = -onset, -onset_rate
        return onset, onset_rate, tension, tension_rate, separation, apart, slope

    @kernel
    def ensure_dense(record: Any, work: Array) -> None:
        """Work out the dense output of the current step, unless it is in the work memory.

        Checked  tests/tethered_deorbit/test_macro_step.py: the same bits whoever asks, and how often
        """
        r = record[0]
        if r.state_dense_ready == 0:
            scheme.prepare_dense(
                record,
                work[begin_state:end_state],
                work[end_state:here_state],
                r.state_step,
                work[stages:dense_begin],
                work[dense_begin:work_end],
                work[low_error:high_error],
            )
            r.state_dense_ready = 1

    @kernel
    def at(record: Any, work: Array, fraction: float) -> Signals:
        """Signals at a fraction of the step [-]; the dense output must be there.

        Checked  tests/tethered_deorbit/test_robust.py: a line that is touched for a moment within a step
        """
        dense = work[dense_begin:work_end]
        here = work[here_state:slope_state]
        slope = work[slope_state:low_error]
        scheme.dense_value(work[begin_state:end_state], dense, fraction, first, seen, here[first : first + seen])
        step = record[0].state_step
        scheme.dense_rate(dense, fraction, step, first, seen, slope[first : first + seen])
        if held.settled(record):
            scheme.dense_rate(dense, fraction, step, impulse, 1, slope[impulse : impulse + 1])
        return signals(record, here, slope, fraction * step)

    @kernel
    def root(record: Any, work: Array, low: float, high: float, which: int, level: float) -> float:
        """Fraction of the step [-] at which a signal passes a level between two fractions.

        Regula falsi in the Illinois form, halved when it stalls; the step is redone afterwards to land exactly.

        low, high     fractions with the signal on different sides   [-]
        which         place of the signal
        level         in its unit

        Source   Dowell and Jarratt, BIT 11 (1971) 168
        Checked  tests/tethered_deorbit/test_commanded.py: a ramp through zero; test_robust.py
        """
        at_low = at(record, work, low)[which] - level
        at_high = at(record, work, high)[which] - level
        kept = 0
        for i in range(ROOT_ITERATIONS):
            if high - low <= 1.0e-13:
                break
            middle = 0.5 * (low + high)
            if i % 3 != 2:
                guess = (low * at_high - high * at_low) / (at_high - at_low)
                if low < guess < high:
                    middle = guess
            value = at(record, work, middle)[which] - level
            if value == 0.0:
                return middle
            if (value > 0.0) == (at_high > 0.0):
                if abs(middle - high) <= 1.0e-14:
                    return middle
                high, at_high = middle, value
                if kept == 1:
                    at_low *= 0.5
                kept = 1
            else:
                if abs(middle - low) <= 1.0e-14:
                    return middle
                low, at_low = middle, value
                if kept == -1:
                    at_high *= 0.5
                kept = -1
        return high

    @kernel
    def find_change(record: Any, work: Array) -> float:
        """Fraction of the step [-] at which slack and taut change, or -1. Searched only where the signal rises.

        At the begin of a step that follows a change the signal is zero to rounding, of either sign, and falls: taken by
        its sign alone, the change just made would be found once more.

        Valid    signals that turn at most once in an eighth of the step
        Checked  tests/tethered_deorbit/test_robust.py: a grazing line; test_tugs.py
        """
        ensure_dense(record, work)
        low = 0.0
        value_low, slope_low, _, _, _, _, _ = at(record, work, low)
        for i in range(INTERVALS):
            high = (i + 1.0) / INTERVALS
            value_high, slope_high, _, _, _, _, _ = at(record, work, high)
            first, value_first, last, value_last = low, value_low, high, value_high
            if slope_low <= 0.0 < slope_high:
                first = root(record, work, low, high, CROSSING_SLOPE, 0.0)
                value_first = at(record, work, first)[CROSSING]
            elif slope_high <= 0.0 < slope_low:
                last = root(record, work, low, high, CROSSING_SLOPE, 0.0)
                value_last = at(record, work, last)[CROSSING]
            if max(slope_low, slope_high) > 0.0 and value_last > 0.0:
                # above zero from where it begins to rise, by rounding: the change is due at once
                return root(record, work, first, last, CROSSING, 0.0) if value_first <= 0.0 else first
            low, value_low, slope_low = high, value_high, slope_high
        return -1.0

    @kernel
    def strays(record: Any, work: Array, first: float, last: float, least: float, largest: float) -> bool:
        """Whether the tension may leave a range [N] between two fractions of the step, by the rate of its impulse.

        Valid    as `tension_range`; what lies between the samples is a share of what they span
        Checked  tests/tethered_deorbit/test_settled_wrapped.py: the range of a macro step
        """
        r = record[0]
        found = work[slope_state + impulse : slope_state + impulse + 1]
        low, high = math.inf, -math.inf
        for i in range(1, SAMPLES):
            fraction = first + (last - first) * (i / SAMPLES)
            scheme.dense_rate(work[dense_begin:work_end], fraction, r.state_step, impulse, 1, found)
            low, high = min(low, found[0]), max(high, found[0])
        room = BETWEEN * (high - low) + r.state_stiffness * r.state_taut_tolerance
        return bool(high + room > largest or low - room < least)

    @kernel
    def tension_range(
        record: Any, work: Array, first: float, last: float, known_least: float, known_largest: float
    ) -> tuple[float, float]:
        """Least and largest tension [N] between two fractions of the step, also at its turns in between.

        known_least, known_largest   what lies between these need not be told [N]

        Checked  tests/tethered_deorbit/test_extremes.py: the range of a vibration
        """
        if held.mapped(record):
            step = record[0].state_step
            low, high = held.span(record, first * step, last * step)
            return float(low), float(high)
        ensure_dense(record, work)
        if held.sways:
            begin, end = at(record, work, first)[TENSION], at(record, work, last)[TENSION]
            low, high = min(begin, end), max(begin, end)
            if not strays(record, work, first, last, min(low, known_least), max(high, known_largest)):
                return low, high
        low, here = first, at(record, work, first)
        least = largest = here[TENSION]
        slope_low = here[TENSION_SLOPE]
        for i in range(INTERVALS):
            high = first + (last - first) * ((i + 1.0) / INTERVALS)
            there = at(record, work, high)
            slope_high = there[TENSION_SLOPE]
            least, largest = min(least, there[TENSION]), max(largest, there[TENSION])
            if (slope_low > 0.0) != (slope_high > 0.0):
                turn = at(record, work, root(record, work, low, high, TENSION_SLOPE, 0.0))
                least, largest = min(least, turn[TENSION]), max(largest, turn[TENSION])
            low, slope_low = high, slope_high
        return least, largest

    @kernel
    def first_above(record: Any, work: Array, limit: float) -> float:
        """Fraction of the step [-] at which the tension first exceeds a limit [N], or -1.

        Checked  tests/tethered_deorbit/test_ends.py: a line that breaks just below its peak
        """
        ensure_dense(record, work)
        low, here = 0.0, at(record, work, 0.0)
        if here[TENSION] > limit:
            return 0.0
        slope_low = here[TENSION_SLOPE]
        for i in range(INTERVALS):
            high = (i + 1.0) / INTERVALS
            there = at(record, work, high)
            last, tension = high, there[TENSION]
            if tension <= limit and slope_low > 0.0 >= there[TENSION_SLOPE]:
                last = root(record, work, low, high, TENSION_SLOPE, 0.0)
                tension = at(record, work, last)[TENSION]
            if tension > limit:
                return root(record, work, low, last, TENSION, limit)
            low, slope_low = high, there[TENSION_SLOPE]
        return -1.0

    @kernel
    def nearest(record: Any, work: Array, last: float) -> tuple[float, float]:
        """Where the separation turns from less to more and is least: fraction of the step [-] and distance [m].

        last          fraction up to which it counts                 [-]

        Checked  tests/tethered_deorbit/test_extremes.py: two bodies that pass
        """
        ensure_dense(record, work)
        found, distance = -1.0, math.inf
        low, rate_low = 0.0, at(record, work, 0.0)[RATE]
        for i in range(INTERVALS):
            high = (i + 1.0) / INTERVALS
            rate_high = at(record, work, high)[RATE]
            if rate_low <= 0.0 < rate_high:
                fraction = root(record, work, low, high, RATE, 0.0)
                separation = at(record, work, fraction)[SEPARATION]
                if fraction <= last and separation < distance:
                    found, distance = fraction, separation
            low, rate_low = high, rate_high
        return found, distance

    return Events(signals, ensure_dense, find_change, tension_range, first_above, nearest, by_length)
