"""A tow from event to event: free flight, tugs and vibration in closed form, a rigid dumbbell once that has died.

A taut line is on its slow course at once, see `settled`, and vibrates about it in closed form, see `vibration`: the
state of a step is that of the pair on the course, whose steps follow the orbit, and the vibration is put onto what is
seen of it. So a tug is one step, to the instant at which its tension falls to zero, and lasts as long as it does: the
load of tide, thrust and turning acts on it all the while. Longer by v, the pair keeps its angular momentum and turns
the slower,

    s -> s + v,   s' -> s' + v',   u x rho' -> u x rho' s/(s + v),   and falls behind by 2 w/s times the integral of v

The vibration changes its own load. Of a pair that turns at w on an orbit of the rate n

    dA/dl <= w^2 + 3 n^2 - 4 w^2        so that   e = 4 (w^2 + n^2)/(k/m)

is how much the square of its frequency would be wrong by. It is not: dA/dl is put into it, see `probe`. What is left is
of second order, and e, with w^2 + n^2 + a/s for what pushes the pair to turn, bounds by how much peak and time of a tug
may be wrong. Where e exceeds
`level.peak_error`, where the line hardly vibrates at all (damping above 0.9 of the critical), or where the slow
solution neglects too much, every vibration is followed as ever, and `settled` is what there is.

Source   slow solution of a linear oscillator and its free vibration; ours
Checked  tests/tethered_deorbit/test_event_map.py
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
from fmu_src.tethered_deorbit.levels.counted import counted
from fmu_src.tethered_deorbit.levels.lengthened import fall_behind, shift, turns
from fmu_src.tethered_deorbit.levels.settled import NEXT_LOOK, SURE, make_settled
from fmu_src.tethered_deorbit.levels.slow import SPAN, make_slow
from fmu_src.tethered_deorbit.levels.vibration import lets_go, swept, tension_span, vibration_at
from orbital.kernel import kernel
from orbital.vectors import Array, dot, norm

MOST_DAMPED = 0.9
"""Damping ratio up to which a vibration is mapped: near the critical one its closed form loses its digits."""
FIRST = 0.02
"""First step of a line that is mapped, in radians of how its load changes; a tug within it ends it."""
WORTH = 0.1
"""Share of a resolved step that a mapped one has to have."""
FIRST_FOLLOWED = 0.3
"""First step of a line that is followed again, in radians of its motion."""
PROBE = 1.0e-3
"""Share of the line by which it is lengthened to see what its load gains."""
MOST_DRAWN = 4
"""Courses drawn of a line that has gone taut, each from where the one before has it."""
SHORTEST = 1.0e-6
"""Least time of a tug, in radians of the line's motion."""


@kernel
def mapped(record: Any) -> bool:
    """Whether the line is on its course, and vibrates about it in closed form or not at all.

    Checked  tests/tethered_deorbit/test_event_map.py
    """
    return bool(record[0].state_settled == 1)


@kernel
def bounces(record: Any) -> bool:
    """Whether the step ends where the line goes slack.

    Checked  tests/tethered_deorbit/test_event_map.py
    """
    r = record[0]
    return bool(r.state_settled == 1 and r.state_bounces == 1)


@kernel
def beyond(record: Any, elapsed: float) -> float:
    """Impulse of the vibration [N s] since the begin of the step, a time ago [s].

        integral of T_v = k (integral of v) + c (v(t) - v(0))

    Checked  tests/tethered_deorbit/test_event_map.py: impulse
    """
    r = record[0]
    place, speed = r.state_vibration[0], r.state_vibration[1]
    m, c, q = r.state_moved_mass, r.state_damping, r.state_firmness
    there, rate = vibration_at(place, speed, m, c, q, elapsed)
    return float(r.state_stiffness * swept(place, speed, there, rate, m, c, q) + c * (there - place))


def mapping(held: Held) -> Held:
    """What is held, with its vibration."""
    return held._replace(mapped=mapped, bounces=bounces, beyond=beyond, span=tension_span)


def make_event_map(
    derivative: Callable[..., Any], scheme: AdaptiveScheme, reel: Reel, bodies: Bodies, held: Held, places: Places
) -> Level:
    """The kernels of the level for one set of equations, whose rate of the impulse is the tension.

    Valid    points; see `refusals`
    Checked  tests/tethered_deorbit/test_event_map.py
    """
    begin_state, end_state, stages, size = places.begin, places.end, places.stages, places.size
    here_state, slope_state, low = places.here, places.slope, places.low
    impulse = places.impulse
    settled = make_settled(derivative, scheme, reel, bodies, held, places)
    draw, _, _, neglected, _, tolerance, off_course, _ = make_slow(derivative, scheme, reel, bodies, places)

    @kernel
    def pushes(record: Any, work: Array) -> float:
        """Square of how fast what acts on the pair would turn it [rad^2/s^2]; after `derivative` of the line at rest.

            (|a| + |P|/m)/s,   a the acceleration of a line that keeps its length

        Checked  tests/tethered_deorbit/test_event_map.py: a hard push across the line
        """
        rate = work[slope_state:low]
        apart = norm(work[begin_state + 6 : begin_state + 9])
        load = abs(rate[impulse]) / bodies.mass_now(record, work[begin_state:end_state])
        return float((norm(rate[9:12]) + load) / apart)

    @kernel
    def neglects(record: Any, mass: float) -> float:
        """What the slow solution leaves out, over what it may [-]: `level.peak_error` of the line's stretch, or the
        tolerance of that.

        mass          that the line moves                        [kg]

        Checked  tests/tethered_deorbit/test_event_map.py: long lines
        """
        r = record[0]
        place, speed = r.state_vibration[0], r.state_vibration[1]
        stretched = abs(r.state_course[0]) + math.sqrt(place * place + mass / r.state_stiffness * speed * speed)
        left = float(neglected(record, mass))
        if left > tolerance(record):
            r.state_level_error = max(r.state_level_error, min(r.level_peak_error, left / stretched))
        return float(left / max(tolerance(record), r.level_peak_error * stretched))

    @kernel
    def probe(record: Any, work: Array) -> None:
        """What load and angular momentum gain as the line lengthens, the pair then turning the slower.

            q = k - dP/dl,   leverage = (d(l a)/dl)/l,   a the acceleration across the line

        Valid    what is linear in the length: centrifugal force, tide, thrust
        Source   ours
        Checked  tests/tethered_deorbit/test_event_map.py: energy
        """
        r = record[0]
        start, there, rate = work[begin_state:end_state], work[here_state:slope_state], work[slope_state:low]
        derivative(record, start, rate, 0.0)
        load = rate[impulse]
        unit, gained = r.state_vector[0], r.state_leverage
        apart = norm(start[6:9])
        for i in range(3):
            unit[i] = start[6 + i] / apart
        along = dot(unit, rate[9:12])
        for i in range(3):
            gained[i] = -apart * (rate[9 + i] - along * unit[i])
        for i in range(size):
            there[i] = start[i]
        more = PROBE * r.state_length
        shift(there, -more, 0.0)
        derivative(record, there, rate, 0.0)
        r.state_firmness = r.state_stiffness - (rate[impulse] - load) / more
        along = dot(unit, rate[9:12])
        for i in range(3):
            gained[i] += (apart + more) * (rate[9 + i] - along * unit[i])
            gained[i] /= more * apart

    @kernel
    def begin(record: Any) -> None:
        """Nothing is held.

        Checked  tests/tethered_deorbit/test_event_map.py
        """
        r = record[0]
        r.state_vibration[0] = 0.0
        r.state_vibration[1] = 0.0
        r.state_bounces = 0
        r.state_level_error = 0.0
        settled.begin(record)

    @kernel
    def restart(record: Any, time: float) -> None:
        """From a time on [s] every vibration is sought anew.

        Checked  tests/tethered_deorbit/test_event_map.py: a changed thrust
        """
        settled.restart(record, time)
        r = record[0]
        r.state_next_look = time
        r.state_vibration[0] = 0.0
        r.state_vibration[1] = 0.0
        r.state_bounces = 0

    @kernel
    def carry(record: Any, work: Array) -> None:
        """The vibration from one step to the next, its impulse booked; below the tolerance it has died.

        Checked  tests/tethered_deorbit/test_event_map.py: impulse
        """
        r = record[0]
        vibration = r.state_vibration
        if vibration[0] == 0.0 and vibration[1] == 0.0:
            return
        m, c, q = r.state_moved_mass, r.state_damping, r.state_firmness
        place, speed = vibration_at(vibration[0], vibration[1], m, c, q, r.state_step)
        if math.sqrt(place * place + m / q * speed * speed) <= tolerance(record):
            place = 0.0
            speed = 0.0
            r.state_times_settled += 1
            r.state_settled_since = r.state_begin
        longer = swept(vibration[0], vibration[1], place, speed, m, c, q)
        work[begin_state + impulse] += r.state_stiffness * longer + c * (place - vibration[0])
        fall_behind(record, work[begin_state:end_state], longer)
        vibration[0] = place
        vibration[1] = speed

    @kernel
    def look(record: Any, work: Array, step: float, limit: float, cap: float) -> float:
        """Put a line that has gone taut on its course, and what it is off it into its vibration.

        step, limit   step that is meant, and the longest one allowed   [s]
        cap           longest step while the line is followed    [s]

        Returns the step to try [s].

        Checked  tests/tethered_deorbit/test_event_map.py
        """
        r = record[0]
        if r.state_settled == 1:
            carry(record, work)
            return step
        if r.state_command_rate != 0.0 or not r.state_begin >= r.state_next_look:
            return step
        start = work[begin_state:end_state]
        m, c, k = bodies.mass_now(record, start), r.state_damping, r.state_stiffness
        error = 4.0 * turns(record, start) * m / k
        if error <= r.level_peak_error and c <= 2.0 * MOST_DAMPED * math.sqrt(k * m):
            # The load is that of the line at rest, where its course has it: it is drawn once its vibration is out.
            for i in range(4):
                r.state_course[i] = 0.0
            stretch, speed = off_course(record, work)
            shift(start, stretch, speed)
            r.state_settled = 1
            derivative(record, start, work[slope_state:low], 0.0)
            turning = turns(record, start) + pushes(record, work)
            error = 4.0 * turning * m / k
            first = FIRST / math.sqrt(turning)
            mass, longer = m, math.inf
            for _ in range(MOST_DRAWN if error <= r.level_peak_error else 0):
                mass = draw(record, work, first)
                longer, faster = off_course(record, work)
                shift(start, longer, faster)
                stretch += longer
                speed += faster
                if error * abs(longer) <= tolerance(record):
                    break
            r.state_vibration[0] = stretch
            r.state_vibration[1] = speed
            close = error <= r.level_peak_error and error * abs(longer) <= tolerance(record)
            if close and neglects(record, mass) <= SURE:
                r.state_moved_mass = mass
                r.state_level_error = max(r.state_level_error, error)
                return float(min(first, limit))
            r.state_vibration[0] = 0.0
            r.state_vibration[1] = 0.0
            shift(start, -stretch, -speed)
            r.state_settled = 0
        return float(settled.look(record, work, step, limit, cap))

    @kernel
    def leave(record: Any, work: Array, step: float, cap: float) -> float:
        """Follow every vibration where a step of a line on its course gains nothing.

        Checked  tests/tethered_deorbit/test_event_map.py: a pair that whirls
        """
        r = record[0]
        if r.state_settled == 0 or step >= WORTH * cap:
            return step
        longer, faster = r.state_vibration[0], r.state_vibration[1]
        start = work[begin_state:end_state]
        shift(start, -longer, -faster)
        r.state_settled = 0
        r.state_vibration[0] = 0.0
        r.state_vibration[1] = 0.0
        r.state_bounces = 0
        r.state_next_look = r.state_begin + NEXT_LOOK / r.state_frequency
        derivative(record, start, work[stages : stages + size], 0.0)
        return float(min(cap, FIRST_FOLLOWED / r.state_frequency))

    @kernel
    def prepare(record: Any, work: Array, step: float, cap: float) -> float:
        """Draw the course of a step [s], put its begin there, and end it where the line goes slack.

        cap           longest step of a line that is followed    [s]

        Returns the step to take [s].

        Checked  tests/tethered_deorbit/test_event_map.py
        """
        r = record[0]
        if r.state_settled == 0:
            return step
        for i in range(3):
            r.state_turning[i] = 0.0
        r.state_moved_mass = draw(record, work, max(step, SPAN / math.sqrt(turns(record, work[begin_state:end_state]))))
        longer, faster = off_course(record, work)
        start = work[begin_state:end_state]
        shift(start, longer, faster)
        if neglects(record, r.state_moved_mass) > 1.0:
            return float(leave(record, work, 0.0, cap))
        r.state_bounces = 0
        probe(record, work)
        slack = lets_go(record, step)
        if slack < math.inf:
            r.state_bounces = 1
            step = min(step, max(slack, SHORTEST / r.state_frequency))
        derivative(record, start, work[stages : stages + size], 0.0)
        return step

    @kernel
    def place(
        record: Any, state: Array, tension: float, elapsed: float, length: float, speed: float
    ) -> tuple[float, float]:
        """Put a state, as it is, where the line is as it vibrates; returns its length [m] and rate [m/s].

        tension       of the line on its course                  [N]
        elapsed       since the begin of the step                [s]
        length, speed of the line in this state, as last seen    [m], [m/s]

        Checked  tests/tethered_deorbit/test_event_map.py
        """
        r = record[0]
        there, rate, _ = held.along(record, tension, elapsed)
        a, b, m, c, q = (
            r.state_vibration[0],
            r.state_vibration[1],
            r.state_moved_mass,
            r.state_damping,
            r.state_firmness,
        )
        v, faster = vibration_at(a, b, m, c, q, elapsed)
        fall_behind(record, state, swept(a, b, v, faster, m, c, q))
        shift(state, length - there - v, speed - rate - faster)
        return there + v, rate + faster

    return counted(Level(begin, restart, look, prepare, settled.missed, leave, place, settled.put))
