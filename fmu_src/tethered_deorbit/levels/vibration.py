"""The vibration of a damped line about its course, in closed form: how far it is at an instant, when the line lets go,
and between what its tension lies.

Of a line on its course x_s with the tension T_s, what is left of its stretch is free of any load,

    m v'' + c v' + q v = 0,   q = k - m dA/dl        T = T_s + k v + c v'

where A, the load over m, changes with the length, the turning of the pair slowing down as it grows. So v is known at
every instant from v and v' at one. Of a line that has just gone taut at a speed w it is v = -x_s, v' = w - x_s': half a
turn of it is a tug.

Source   free damped oscillator
Checked  tests/tethered_deorbit/test_event_map.py
"""

from __future__ import annotations

import math
from typing import Any

from fmu_src.tethered_deorbit.levels.course import course
from orbital.kernel import kernel

ROOT_ITERATIONS = 60
PIECES = 8
"""Parts of a step in which the tension of a line that does not vibrate is looked at."""


@kernel
def vibration_at(
    place: float, speed: float, mass: float, damping: float, stiffness: float, elapsed: float
) -> tuple[float, float]:
    """Free vibration v [m] and its rate [m/s] after a time.

        v  = exp(-g t) (a cos w t + (b + g a)/w sin w t)
        v' = exp(-g t) (b cos w t - (g b + (q/m) a)/w sin w t),   g = c/2m,   w^2 = q/m - g^2

    place, speed  a, b   at t = 0                                [m], [m/s]
    mass, damping, stiffness  m, c, q                            [kg], [N s/m], [N/m]
    elapsed       t                                              [s]

    Valid    c < 2 sqrt(q m)
    Source   free damped oscillator
    Checked  tests/tethered_deorbit/test_event_map.py: against its equation
    """
    if place == 0.0 and speed == 0.0:
        return 0.0, 0.0
    decay = 0.5 * damping / mass
    square = stiffness / mass
    turn = math.sqrt(square - decay * decay)
    left = math.exp(-decay * elapsed)
    c, s = math.cos(turn * elapsed), math.sin(turn * elapsed) / turn
    there = left * (place * c + (speed + decay * place) * s)
    rate = left * (speed * c - (decay * speed + square * place) * s)
    return there, rate


@kernel
def swept(
    place: float, speed: float, there: float, rate: float, mass: float, damping: float, stiffness: float
) -> float:
    """Integral of a free vibration over time [m s], from what it is at both ends.

        integral of v = -(m (v' - b) + c (v - a))/q

    place, speed  a, b   at the begin                            [m], [m/s]
    there, rate   v, v'  at the end                              [m], [m/s]

    Source   the integral of its equation
    Checked  tests/tethered_deorbit/test_event_map.py: against its equation
    """
    return -(mass * (rate - speed) + damping * (there - place)) / stiffness


@kernel
def pull_at(record: Any, elapsed: float) -> float:
    """Tension of a mapped line, not clamped [N], a time after the begin of the step [s].

        T = k (x_s + v) + c (x_s' + v')

    Checked  tests/tethered_deorbit/test_event_map.py
    """
    r = record[0]
    k, c = r.state_stiffness, r.state_damping
    x, rate, _ = course(record, elapsed)
    v, faster = vibration_at(
        r.state_vibration[0], r.state_vibration[1], r.state_moved_mass, c, r.state_firmness, elapsed
    )
    return float(k * (x + v) + c * (rate + faster))


@kernel
def first_turn(record: Any) -> tuple[float, float]:
    """When the tension of the vibration is first least after the begin of the step [s], and half its period [s].

        T_v = R exp(-g t) cos(w t - p),   least at w t - p = pi - atan(g/w)

    Valid    a vibration there is
    Source   T_v is a free vibration itself, with T_v(0) = k a + c b, T_v'(0) = k b - c (q a + c b)/m
    Checked  tests/tethered_deorbit/test_event_map.py: the first tug's end
    """
    r = record[0]
    k, c, m, q = r.state_stiffness, r.state_damping, r.state_moved_mass, r.state_firmness
    place, speed = r.state_vibration[0], r.state_vibration[1]
    decay = 0.5 * c / m
    turn = math.sqrt(q / m - decay * decay)
    pull = k * place + c * speed
    rate = k * speed - c * (q * place + c * speed) / m
    phase = math.atan2((rate + decay * pull) / turn, pull)
    half = math.pi / turn
    least = (math.pi - math.atan(decay / turn) + phase) / turn
    while least <= 0.0:
        least += 2.0 * half
    while least > 2.0 * half:
        least -= 2.0 * half
    return least, half


@kernel
def vanishes(record: Any, first: float, last: float) -> float:
    """When the tension falls to zero, between an instant at which it pulls and one at which it would push [s].

    Source   regula falsi in the Illinois form, Dowell and Jarratt, BIT 11 (1971) 168
    Checked  tests/tethered_deorbit/test_event_map.py: the first tug's end
    """
    low, high = first, last
    at_low, at_high = pull_at(record, low), pull_at(record, high)
    kept = 0
    for _ in range(ROOT_ITERATIONS):
        if high - low <= 1e-14 * high:
            break
        middle = (low * at_high - high * at_low) / (at_high - at_low)
        if not low < middle < high:
            middle = 0.5 * (low + high)
            if not low < middle < high:
                break
        value = pull_at(record, middle)
        if value == 0.0:
            return middle
        if value < 0.0:
            high, at_high = middle, value
            if kept == 1:
                at_low *= 0.5
            kept = 1
        else:
            low, at_low = middle, value
            if kept == -1:
                at_high *= 0.5
            kept = -1
    return high


@kernel
def lets_go(record: Any, step: float) -> float:
    """When a mapped line goes slack within a step, from its begin [s], or infinity.

    Looked at where the vibration is least, which is once a period, and at the end; without one at even parts.

    Valid    a tension of the course that turns at most once in a period, or in an eighth of the step
    Checked  tests/tethered_deorbit/test_event_map.py
    """
    r = record[0]
    if r.state_vibration[0] == 0.0 and r.state_vibration[1] == 0.0:
        before = 0.0
        for i in range(PIECES):
            there = step * (i + 1.0) / PIECES
            if pull_at(record, there) <= 0.0:
                return float(vanishes(record, before, there)) if pull_at(record, before) > 0.0 else before
            before = there
        return math.inf
    least, half = first_turn(record)
    before = 0.0
    while True:
        last = least >= step
        there = step if last else least
        if pull_at(record, there) <= 0.0:
            pulls = max(before, there - half)
            if pull_at(record, pulls) > 0.0:
                return float(vanishes(record, pulls, there))
            # it falls from its dashpot's first pull on, or has never pulled
            return float(vanishes(record, before, there)) if pull_at(record, before) > 0.0 else before
        if last:
            return math.inf
        before = least
        least += 2.0 * half


@kernel
def tension_span(record: Any, first: float, last: float) -> tuple[float, float]:
    """Least and largest tension of a mapped line between two instants of the step [N], also where it turns in between.

    first, last   since the begin of the step                    [s]

    Checked  tests/tethered_deorbit/test_event_map.py: peaks
    """
    r = record[0]
    begin, end = pull_at(record, first), pull_at(record, last)
    least, largest = min(begin, end), max(begin, end)
    if r.state_vibration[0] == 0.0 and r.state_vibration[1] == 0.0:
        for i in range(1, PIECES):
            there = pull_at(record, first + (last - first) * i / PIECES)
            least, largest = min(least, there), max(largest, there)
        return least, largest
    turn, half = first_turn(record)
    if turn - half > first:
        turn -= half
    elif turn < first:
        turn += half * math.ceil((first - turn) / half)
    while turn < last:
        there = pull_at(record, turn)
        least, largest = min(least, there), max(largest, there)
        turn += half
    return least, largest
