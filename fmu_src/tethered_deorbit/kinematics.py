"""The distance of two points, the rates of it, and what the axes of a step add to them."""

from __future__ import annotations

from typing import Any

from orbital.constants import EARTH_MU
from orbital.kernel import kernel
from orbital.vectors import Array, cross, dot, norm


@kernel
def distance_rate(position: Array, velocity: Array, distance: float) -> float:
    """Rate of change of a distance [m/s].

        ds/dt = rho . rho' / s

    position      rho    from the one to the other               [m]    (3,)
    velocity      rho'   its rate, inertial                      [m/s]  (3,)
    distance      s      |rho|                                   [m]

    Valid    any; where the points coincide, the rate at which they part
    Source   derivative of |rho|
    Checked  tests/tethered_deorbit/test_terms.py
    """
    if distance == 0.0:
        return norm(velocity)
    return dot(position, velocity) / distance


@kernel
def distance_acceleration(position: Array, velocity: Array, acceleration: Array, distance: float, rate: float) -> float:
    """Second derivative of a distance [m/s^2].

        s'' = (rho . rho'' + |rho'|^2 - s'^2) / s

    position      rho    from the one to the other               [m]      (3,)
    velocity      rho'   its rate, inertial                      [m/s]    (3,)
    acceleration  rho''  the rate of that                        [m/s^2]  (3,)
    distance      s      |rho|                                   [m]
    rate          s'     of the distance                         [m/s]

    Valid    s > 0; zero is returned where the points coincide
    Source   second derivative of |rho|
    Checked  tests/tethered_deorbit/test_terms.py
    """
    if distance == 0.0:
        return 0.0
    return (dot(position, acceleration) + (dot(velocity, velocity) - rate * rate)) / distance


@kernel
def turning_share(record: Any, position: Array, velocity: Array, length: float) -> float:
    """What the second derivative of the length [m/s^2] lacks when it is formed from the rate of rho' in turning axes.

        rho . (w x rho') / l

    position      rho    target minus chaser                     [m]    (3,)
    velocity      rho'   its inertial rate                       [m/s]  (3,)
    length        l      |rho|                                   [m]

    Valid    any; zero where the bodies coincide
    Source   the transport theorem
    Checked  tests/tethered_deorbit/test_turning.py
    """
    if length == 0.0:
        return 0.0
    w = record[0].state_turning
    x = velocity[1] * position[2] - velocity[2] * position[1]
    y = velocity[2] * position[0] - velocity[0] * position[2]
    z = velocity[0] * position[1] - velocity[1] * position[0]
    return float((w[0] * x + w[1] * y + w[2] * z) / length)


@kernel
def perigee_radius(record: Any, state: Array) -> float:
    """Distance of the osculating perigee of the centre of mass from the Earth's centre [m].

        p/(1 + e),   p = h^2/mu,   e = |v x h/mu - r/|r||

    Source   conic in its focal parameter; e from the eccentricity vector, without the cancellation of 1 - p/a
    Checked  tests/tethered_deorbit/test_ends.py
    """
    r = record[0]
    momentum, eccentric = r.state_vector[0], r.state_vector[1]
    cross(momentum, state[0:3], state[3:6])
    cross(eccentric, state[3:6], momentum)
    radius = norm(state[0:3])
    for i in range(3):
        eccentric[i] = eccentric[i] / EARTH_MU - state[i] / radius
    return dot(momentum, momentum) / EARTH_MU / (1.0 + norm(eccentric))
