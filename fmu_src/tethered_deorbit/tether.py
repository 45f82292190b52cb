"""The straight line between the two bodies: its length, the rates of it, and the force it passes on.

It is made fast at the chaser's centre of mass and at a fixed distance from the target's. A target that is a point turns
with the line, so that its attachment always lies on the line of centres.
"""

from __future__ import annotations

from typing import Any

from orbital.kernel import kernel
from orbital.vectors import Array, dot, norm


@kernel
def line_length(record: Any, separation: float) -> float:
    """Length of the line between its attachments [m]; negative where the chaser is nearer than the target's.

        l = s - a

    separation    s      of the centres of mass                  [m]

    with a the parameter target.attachment_distance; l has the rates of s.

    Valid    attachment on the line of centres
    Source   fmu_src/tethered_deorbit/README.md, What is computed
    Checked  tests/tethered_deorbit/test_attachment.py
    """
    length: float = separation - record[0].target_attachment_distance
    return length


@kernel
def length_rate(position: Array, velocity: Array, separation: float) -> float:
    """Rate of change of the line's length, which is that of the separation [m/s].

        dl/dt = ds/dt = rho . rho' / s

    position      rho    target minus chaser                     [m]    (3,)
    velocity      rho'   its rate, inertial                      [m/s]  (3,)
    separation    s      |rho|                                   [m]

    Valid    any; where the bodies coincide, the rate at which they part
    Source   derivative of |rho|
    Checked  tests/tethered_deorbit/test_terms.py
    """
    if separation == 0.0:
        return norm(velocity)
    return dot(position, velocity) / separation


@kernel
def length_acceleration(position: Array, velocity: Array, acceleration: Array, separation: float, rate: float) -> float:
    """Second derivative of the line's length, which is that of the separation [m/s^2].

        l'' = (rho . rho'' + |rho'|^2 - l'^2) / s

    position      rho    target minus chaser                     [m]      (3,)
    velocity      rho'   its rate, inertial                      [m/s]    (3,)
    acceleration  rho''  the rate of that                        [m/s^2]  (3,)
    separation    s      |rho|                                   [m]
    rate          l'     of the length                           [m/s]

    Valid    s > 0; zero is returned where the bodies coincide
    Source   second derivative of |rho|
    Checked  tests/tethered_deorbit/test_terms.py
    """
    if separation == 0.0:
        return 0.0
    return (dot(position, acceleration) + (dot(velocity, velocity) - rate * rate)) / separation


@kernel
def add_tension(record: Any, state: Array, rate: Array, tension: float, separation: float) -> None:
    """Add the pull of the line to the rate of the state [m/s^2].

        rho'' -= T/m_r rho/s

    state         R, V, rho, rho'  of `layout`                   (12,)
    tension       T                                              [N]
    separation    s      |rho|                                   [m]

    The two pulls are opposite, so that the centre of mass feels nothing.

    Valid    massless straight line, s > 0
    Source   Newton's third law
    Checked  tests/tethered_deorbit/test_terms.py
    """
    if separation > 0.0:
        factor = tension / (record[0].state_reduced_mass * separation)
        for i in range(3):
            rate[9 + i] -= factor * state[6 + i]
