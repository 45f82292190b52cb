"""The swing of a dumbbell in its orbit's plane as one action and one angle: period, mean tension, and what slow changes
leave of it.

With phi from the vertical, b = -F/(m_c l) what thrust along the track adds, n' the change of the orbit's rate,

    phi'' = -dU/dphi,   U = (3/2) n^2 sin^2 phi - b sin phi + n' phi
    T/m   = l (phi'^2 + 2 n phi' + 3 n^2 cos^2 phi) + l b sin phi

The action J, the integral of phi' over phi round a swing, stays as n and b change slowly (adiabatic invariant). Between
the turning points phi = c - d cos x, and with phi' = d sin x sqrt(g) all over x is smooth and periodic: sums over even
points are exact to rounding.

Source   Arnold, Mathematical Methods of Classical Mechanics (1989), section 52; Beletsky's equation on a circle
Checked  tests/tethered_deorbit/test_averaged.py
"""

from __future__ import annotations

import math

from orbital.kernel import kernel
from orbital.vectors import Array

POINTS, WAVES = 48, 24
"""Even points over half a swing, and waves of time and impulse over it."""
HALVINGS = 52
SMALLEST = 1e-5
"""Least amplitude that is resolved [rad]."""
NARROW = 1e-12
PERIOD, ACTION, MEAN, LEAST, LARGEST, MIDDLE, WIDTH = range(7)
"""Places in what `swing` fills."""
SIZE = 7
UPRIGHT = 0.5 * math.pi


@kernel
def potential(angle: float, square: float, push: float, slowing: float) -> float:
    """U of the swing [rad^2/s^2].

    angle         phi                                            [rad]
    square, push, slowing   n^2, b, n'                           [1/s^2]

    Checked  tests/tethered_deorbit/test_averaged.py: against the equation of motion
    """
    s = math.sin(angle)
    return (1.5 * square * s - push) * s + slowing * angle


@kernel
def rest_angle(square: float, push: float, slowing: float) -> float:
    """Where the pair would stand still [rad], or 2 where the thrust is too strong for that: the least of U.

    Source   Newton's method
    Checked  tests/tethered_deorbit/test_averaged.py: 7.4045 degrees for Table 2
    """
    share = push / (3.0 * square)
    if not abs(share) < 0.9:
        return 2.0
    angle = math.asin(share)
    for _ in range(8):
        s, c = math.sin(angle), math.cos(angle)
        slope = (3.0 * square * s - push) * c + slowing
        angle -= slope / (3.0 * square * (c * c - s * s) + push * s)
    return angle


@kernel
def turning_point(energy: float, rest: float, side: float, square: float, push: float, slowing: float) -> float:
    """Where a swing of this energy turns, to one side of its rest [rad].

    side          1 or -1

    Checked  tests/tethered_deorbit/test_averaged.py
    """
    low, high = 0.0, abs(side * UPRIGHT - rest)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if potential(rest + side * middle, square, push, slowing) < energy:
            low = middle
        else:
            high = middle
    return rest + side * 0.5 * (low + high)


@kernel
def swing(
    out: Array, waves: Array, energy: float, length: float, rate: float, push: float, slowing: float, detailed: bool
) -> bool:
    """Everything of a swing with this energy; false where it does not turn below the horizontal, or hardly swings.

    out           period [s], action [rad^2/s], mean, least and largest T/m [N/kg], middle and half-width [rad]   (7,)
    waves         of the time and of its even part of the impulse over x: coefficients of x and of sin kx, written where
                  `detailed`                                     (2, WAVES)
    energy        of phi, per moment of inertia                  [rad^2/s^2]
    length, rate, push, slowing   l, n, b, n'

    Checked  tests/tethered_deorbit/test_averaged.py: against the equation of motion
    """
    square = rate * rate
    rest = rest_angle(square, push, slowing)
    if rest > 1.5:
        return False
    top = min(potential(UPRIGHT, square, push, slowing), potential(-UPRIGHT, square, push, slowing))
    bottom = potential(rest, square, push, slowing)
    if not (energy < top and energy - bottom > 1.5 * square * SMALLEST * SMALLEST):
        return False
    right = turning_point(energy, rest, 1.0, square, push, slowing)
    left = turning_point(energy, rest, -1.0, square, push, slowing)
    middle, width = 0.5 * (right + left), 0.5 * (right - left)
    least, largest = math.inf, -math.inf
    period = action = mean = 0.0
    if detailed:
        for k in range(WAVES):
            waves[0, k] = 0.0
            waves[1, k] = 0.0
    for j in range(POINTS):
        x = (j + 0.5) * math.pi / POINTS
        s = width * math.sin(x)
        angle = middle - width * math.cos(x)
        kinetic = max(2.0 * (energy - potential(angle, square, push, slowing)), NARROW * s * s * square)
        turning = math.sqrt(kinetic)
        weight = s / turning
        c, y = math.cos(angle), math.sin(angle)
        even = length * (kinetic + 3.0 * square * c * c + push * y)
        odd = 2.0 * length * rate * turning
        least = min(least, even - odd)
        largest = max(largest, even + odd)
        period += weight
        action += weight * kinetic
        mean += weight * even
        if detailed:
            for k in range(WAVES):
                wave = math.cos(k * x) * (1.0 if k == 0 else 2.0 / k) / POINTS
                waves[0, k] += weight * wave
                waves[1, k] += weight * even * wave
    full = 2.0 * math.pi / POINTS
    out[PERIOD], out[ACTION], out[MEAN] = full * period, full * action, mean / period
    out[LEAST], out[LARGEST], out[MIDDLE], out[WIDTH] = least, largest, middle, width
    return True


@kernel
def along_swing(waves: Array, which: int, x: float) -> float:
    """Time [s] or even impulse [N s/kg] from the left turning point to a place x of the swing [rad].

    which         0 or 1

    Checked  tests/tethered_deorbit/test_averaged.py
    """
    total = waves[which, 0] * x
    for k in range(1, WAVES):
        total += waves[which, k] * math.sin(k * x)
    return float(total)


@kernel
def place_of(waves: Array, time: float, period: float) -> float:
    """The place x of a swing a time [s] after its left turning point [rad].

    Source   Newton's method
    Checked  tests/tethered_deorbit/test_averaged.py
    """
    x = 2.0 * math.pi * time / period
    for _ in range(30):
        slope = waves[0, 0]
        for k in range(1, WAVES):
            slope += k * waves[0, k] * math.cos(k * x)
        change = (along_swing(waves, 0, x) - time) / slope
        x -= change
        if abs(change) < 1e-14:
            break
    return x


@kernel
def energy_of(
    out: Array, waves: Array, action: float, guess: float, length: float, rate: float, push: float, slowing: float
) -> float:
    """Energy of the swing with this action [rad^2/s^2], or infinity where there is none; `out` is filled for it.

        dJ/dE = P

    Source   Newton's method
    Checked  tests/tethered_deorbit/test_averaged.py
    """
    energy = guess
    for _ in range(12):
        if not swing(out, waves, energy, length, rate, push, slowing, False):
            return math.inf
        change = (action - out[ACTION]) / out[PERIOD]
        energy += change
        if abs(action - out[ACTION]) <= 1e-13 * action:
            break
    return energy
