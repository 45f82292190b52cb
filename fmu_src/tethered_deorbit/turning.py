"""Axes that turn with a taut line at a constant rate over a step: in them it stands almost still.

The line turns with the orbit. In inertial axes the first, low-order stages of a step cut that corner: over h they miss
the circle by l (w h)^2/2, nanometres to micrometres of stretch, which the line's stiffness turns into forces that have
nothing to do with its motion and cancel only to the order of the scheme. In axes that turn with the line nothing is
left to cut. All laws of the model look the same from any axes, so that only the turning itself is to be added.
"""

from __future__ import annotations

from typing import Any

from fmu_src.tethered_deorbit import layout
from orbital.kernel import kernel
from orbital.vectors import Array, cross, norm

FASTEST_TURN = 0.05
"""Greatest rate of the axes, in radians per radian of the line's own motion; a line that turns faster gets none."""


@kernel
def set_turning(record: Any, state: Array) -> None:
    """Choose the rate of the axes [rad/s] for a step that begins in `state`: zero for a slack line.

        w = rho x rho' / l^2

    state         R, V, rho, rho'  of `layout`                   (12,)

    Valid    any rate: the axes are a matter of cost, not of the result
    Source   angular velocity of the line of two points
    Checked  tests/tethered_deorbit/test_turning.py
    """
    r = record[0]
    turning = r.state_turning
    length = norm(state[6:9])
    turning[0] = 0.0
    turning[1] = 0.0
    turning[2] = 0.0
    if r.state_taut and length > 0.0:
        cross(turning, state[6:9], state[9:12])
        square = length * length
        if norm(turning) <= FASTEST_TURN * r.state_frequency * square:
            turning[0] /= square
            turning[1] /= square
            turning[2] /= square
        else:
            turning[0] = 0.0
            turning[1] = 0.0
            turning[2] = 0.0


@kernel
def add_turning(record: Any, state: Array, rate: Array, sign: float) -> None:
    """Add what the turning of the axes adds to the rate of the state's components.

        d(x)/dt as seen = d(x)/dt - w x x,   for each of R, V, rho, rho'

    state, rate   R, V, rho, rho'  of `layout`                   (12,)
    sign          -1 from inertial to turning axes, 1 back

    V and rho' stay inertial velocities, along turning axes.

    Source   the transport theorem
    Checked  tests/tethered_deorbit/test_turning.py
    """
    add_turning_to(record, state, rate, sign, 0, layout.PAIR)


@kernel
def add_turning_to(record: Any, state: Array, rate: Array, sign: float, first: int, last: int) -> None:
    """The same for the vectors that lie from one component to before another.

    Checked  tests/tethered_deorbit/test_turning.py
    """
    turning = record[0].state_turning
    x, y, z = sign * turning[0], sign * turning[1], sign * turning[2]
    for i in range(first, last, 3):
        rate[i] += y * state[i + 2] - z * state[i + 1]
        rate[i + 1] += z * state[i] - x * state[i + 2]
        rate[i + 2] += x * state[i + 1] - y * state[i]


@kernel
def turn_back(record: Any, time: float, vectors: Array) -> None:
    """Components along inertial axes of vectors given along axes that have turned for a time [s]; in place.

    vectors       R, V, rho, rho'  of `layout`                   (12,); what lies behind them stays

    Checked  tests/tethered_deorbit/test_turning.py
    """
    turn_vectors_back(record, time, vectors, layout.PAIR)


@kernel
def turn_vectors_back(record: Any, time: float, vectors: Array, size: int) -> None:
    """The same for any vectors, one after the other.

        v + a (q x v) + b q x (q x v),   q = w t,   a = sin|q|/|q|,   b = (1 - cos|q|)/|q|^2

    The two factors are their series, which round alike everywhere; the sum is formed so that a length keeps its last
    digit over a hundred thousand steps.

    size          three times as many as there are               [-]

    Valid    |q| < 0.3
    Source   Rodrigues' formula
    Checked  tests/tethered_deorbit/test_turning.py
    """
    turning = record[0].state_turning
    x, y, z = turning[0] * time, turning[1] * time, turning[2] * time
    s = x * x + y * y + z * z
    if s == 0.0:
        return
    a = 1.0 - s / 6.0 * (1.0 - s / 20.0 * (1.0 - s / 42.0 * (1.0 - s / 72.0 * (1.0 - s / 110.0))))
    b = 0.5 * (1.0 - s / 12.0 * (1.0 - s / 30.0 * (1.0 - s / 56.0 * (1.0 - s / 90.0))))
    for i in range(0, size, 3):
        u = y * vectors[i + 2] - z * vectors[i + 1]
        v = z * vectors[i] - x * vectors[i + 2]
        w = x * vectors[i + 1] - y * vectors[i]
        vectors[i] += a * u + b * (y * w - z * v)
        vectors[i + 1] += a * v + b * (z * u - x * w)
        vectors[i + 2] += a * w + b * (x * v - y * u)
