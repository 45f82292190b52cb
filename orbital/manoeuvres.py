"""What a chaser does between two shots: back to its place by two burns, to another orbit by a slow spiral; and what
that takes of propellant.

Frame of `frames`: x radial outward, y along-track, z along the orbit normal; velocities as seen in that turning frame.
"""

from __future__ import annotations

import math

import numpy as np

from orbital.constants import EARTH_MU, STANDARD_GRAVITY
from orbital.hill import clohessy_wiltshire
from orbital.vectors import Array


def flown(position: Array, velocity: Array, rate: float, time: float) -> tuple[Array, Array]:
    """Position [m] and velocity [m/s] of a free body after a time; straight on in a frame that stands still.

    position, velocity   at the start                            [m], [m/s]   (3,)
    rate          n      of the frame; 0: it stands still        [rad/s]
    time          t                                              [s]

    Source   `hill.clohessy_wiltshire`
    Checked  tests/orbital/test_manoeuvres.py
    """
    if rate == 0.0:
        return np.asarray(position, float) + time * np.asarray(velocity, float), np.array(velocity, float)
    return clohessy_wiltshire(position, velocity, rate, time)


def two_impulses(
    position: Array, velocity: Array, goal: Array, goal_velocity: Array, rate: float, time: float
) -> tuple[Array, Array]:
    """The two changes of velocity [m/s] that bring a body to a place and a velocity in a given time.

        dv1 = Phi_rv^-1 (r1 - Phi_rr r0) - v0,   dv2 = v1 - (Phi_vr r0 + Phi_vv (v0 + dv1))

    position, velocity     r0, v0 now, relative to a free body   [m], [m/s]   (3,)
    goal, goal_velocity    r1, v1 then                           [m], [m/s]   (3,)
    rate          n        of the frame; 0: it stands still      [rad/s]
    time          t        from the first burn to the second     [s]

    Valid    0 < nt < pi, short burns, distances small against the radius
    Source   Clohessy and Wiltshire (1960), the rendezvous of their title
    Checked  tests/orbital/test_manoeuvres.py
    """
    coasting, _ = flown(position, np.zeros(3), rate, time)
    reached = np.column_stack([flown(np.zeros(3), axis, rate, time)[0] for axis in np.eye(3)])
    needed = np.asarray(np.linalg.solve(reached, np.asarray(goal, float) - coasting), float)
    _, arriving = flown(position, needed, rate, time)
    return needed - velocity, goal_velocity - arriving


def spiral_speed(from_axis: float, to_axis: float) -> float:
    """Change of velocity [m/s] of a slow spiral between two circular orbits of one plane.

        |sqrt(mu/a1) - sqrt(mu/a2)|

    from_axis, to_axis   a1, a2   semi-major axes                [m]

    Valid    a thrust that is small against gravity
    Source   T. N. Edelbaum, ARS Journal 31 (1961) 1079, without a change of plane
    Checked  tests/orbital/test_manoeuvres.py
    """
    return abs(math.sqrt(EARTH_MU / from_axis) - math.sqrt(EARTH_MU / to_axis))


def propellant(mass: float, speed: float, specific_impulse: float) -> float:
    """Propellant [kg] that a change of velocity takes: m (1 - exp(-dv/(Isp g0))).

    mass               m     before it                           [kg]
    speed              dv    sum of the sizes of all burns       [m/s]
    specific_impulse   Isp                                       [s]

    Source   Tsiolkovsky
    Checked  tests/orbital/test_manoeuvres.py
    """
    return -mass * math.expm1(-speed / (specific_impulse * STANDARD_GRAVITY))
