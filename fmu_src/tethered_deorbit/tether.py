"""The straight line between the two bodies: its length, the rates of it, and the force it passes on."""

from __future__ import annotations

from typing import Any

from orbital.kernel import kernel
from orbital.vectors import Array, dot, norm


@kernel
def length_rate(position: Array, velocity: Array, length: float) -> float:
    """Rate of change of the line's length [m/s].

        dl/dt = rho . rho' / l

    position      rho    target minus chaser                     [m]    (3,)
    velocity      rho'   its rate, inertial                      [m/s]  (3,)
    length        l      |rho|                                   [m]

    Valid    any; where the bodies coincide, the rate at which they part
    Source   derivative of |rho|
    Checked  tests/tethered_deorbit/test_terms.py
    """
    if length == 0.0:
        return norm(velocity)
    return dot(position, velocity) / length


@kernel
def length_acceleration(position: Array, velocity: Array, acceleration: Array, length: float, rate: float) -> float:
    """Second derivative of the line's length [m/s^2].

        l'' = (rho . rho'' + |rho'|^2 - l'^2) / l

    position      rho    target minus chaser                     [m]      (3,)
    velocity      rho'   its rate, inertial                      [m/s]    (3,)
    acceleration  rho''  the rate of that                        [m/s^2]  (3,)
    length        l      |rho|                                   [m]
    rate          l'     of the length                           [m/s]

    Valid    l > 0; zero is returned where the bodies coincide
    Source   second derivative of |rho|
    Checked  tests/tethered_deorbit/test_terms.py
    """
    if length == 0.0:
        return 0.0
    return (dot(position, acceleration) + (dot(velocity, velocity) - rate * rate)) / length


@kernel
def add_tension(record: Any, state: Array, rate: Array, tension: float, length: float) -> None:
    """Add the pull of the line to the rate of the state [m/s^2].

        rho'' -= T/m_r rho/l

    state         R, V, rho, rho'  of `layout`                   (12,)
    tension       T                                              [N]
    length        l      of the line                             [m]

    The two pulls are opposite, so that the centre of mass feels nothing.

    Valid    massless straight line, l > 0
    Source   Newton's third law
    Checked  tests/tethered_deorbit/test_terms.py
    """
    if length > 0.0:
        factor = tension / (record[0].state_reduced_mass * length)
        for i in range(3):
            rate[9 + i] -= factor * state[6 + i]
