"""What a line that is longer for a while does to the motion of the pair that it joins."""

from __future__ import annotations

import math
from typing import Any

from orbital.kernel import kernel
from orbital.vectors import Array, dot


@kernel
def shift(state: Array, longer: float, faster: float) -> None:
    """Take from the line what it is too long [m] and lengthens too fast [m/s]; its angular momentum stays.

    Checked  tests/tethered_deorbit/test_event_map.py: angular momentum
    """
    rho, rate = state[6:9], state[9:12]
    apart = math.sqrt(dot(rho, rho))
    if not apart > longer:
        return
    along = dot(rho, rate) / apart
    nearer = (apart - longer) / apart
    for i in range(3):
        across = rate[i] - along * rho[i] / apart
        rate[i] = across / nearer + (along - faster) * rho[i] / apart
    for i in range(3):
        rho[i] *= nearer


@kernel
def fall_behind(record: Any, state: Array, longer: float) -> None:
    """What the vibration has done to the pair across its line: it has turned by less, and what pulls across has had
    more of an arm.

    longer        integral of the vibration over the time    [m s]

    Checked  tests/tethered_deorbit/test_event_map.py: energy, times of tugs
    """
    r = record[0]
    rho, rate = state[6:9], state[9:12]
    angle = 2.0 * longer / r.state_length
    square = dot(rho, rho)
    if not square > 0.0:
        return
    along = dot(rho, rate) / square
    across = max(0.0, dot(rate, rate) / square - along * along)
    for i in range(3):
        a = rate[i] - along * rho[i]
        rate[i] -= angle * (along * a - across * rho[i])
        rho[i] -= angle * a
        rate[i] += longer * r.state_leverage[i]


@kernel
def turns(record: Any, state: Array) -> float:
    """Square of how fast pair and orbit turn [rad^2/s^2].

        w^2 + n^2,   w = |rho x rho'|/s^2

    Checked  tests/tethered_deorbit/test_event_map.py: a pair that whirls
    """
    r = record[0]
    rho, rate = state[6:9], state[9:12]
    square = dot(rho, rho)
    radial = dot(rho, rate)
    turn = max(0.0, dot(rate, rate) - radial * radial / square) / square
    return float(turn + r.state_pace * r.state_pace)
