"""What a chaser does between two shots: back to its place by two burns, to another orbit by a slow spiral; what that
takes of propellant; and how the target turns meanwhile, free of torques.

Frame of `frames`: x radial outward, y along-track, z along the orbit normal; velocities as seen in that turning frame.
"""

from __future__ import annotations

import math

import numpy as np

from orbital.constants import EARTH_MU, STANDARD_GRAVITY
from orbital.hill import clohessy_wiltshire
from orbital.vectors import Array

LONGEST_TURN = 0.005
"""Angle [rad] that a body turns in one step of `turned_freely`: its error is some 1e-13 of the angle."""


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


def turned_freely(attitude: Array, rate: Array, inertia: Array, frame_rate: float, time: float) -> tuple[Array, Array]:
    """Attitude and body rate [rad/s] of a rigid body after a time without torques.

        I w' + w x I w = 0,   q' = q (0, w)/2                     by the classical Runge-Kutta scheme
        rate = I^-1 R^T H,    H what the spin was in inertial axes

    attitude             q   unit quaternion, body to orbital axes, scalar first             (4,)
    rate                 w   relative to inertial space, body axes                [rad/s]    (3,)
    inertia              I   principal moments about the body axes                [kg m2]    (3,)
    frame_rate           n   at which the orbital axes turn about their third     [rad/s]
    time                                                                          [s]

    Valid    gravity gradient and drag left out: 3 n^2 t, 1e-5 rad/s per m of low orbit's minute, changes the rate
    Source   Euler's equations
    Checked  tests/orbital/test_manoeuvres.py, against the closed form of a body with an axis of symmetry
    """
    steps = max(1, math.ceil(abs(time) * float(np.linalg.norm(rate)) / LONGEST_TURN))
    size, q, w, moments = time / steps, np.array(attitude, float), np.array(rate, float), np.asarray(inertia, float)
    spin = _matrix(q) @ (moments * w)

    def rates(q: Array, w: Array) -> tuple[Array, Array]:
        return 0.5 * _product(q, np.array([0.0, *w])), np.cross(moments * w, w) / moments

    for _ in range(steps):
        a = rates(q, w)
        b = rates(q + 0.5 * size * a[0], w + 0.5 * size * a[1])
        c = rates(q + 0.5 * size * b[0], w + 0.5 * size * b[1])
        d = rates(q + size * c[0], w + size * c[1])
        q = q + size / 6.0 * (a[0] + 2.0 * b[0] + 2.0 * c[0] + d[0])
        w = w + size / 6.0 * (a[1] + 2.0 * b[1] + 2.0 * c[1] + d[1])
        q /= np.linalg.norm(q)
    half = -0.5 * frame_rate * time
    seen = _product(np.array([math.cos(half), 0.0, 0.0, math.sin(half)]), q)
    return seen, (_matrix(q).T @ spin) / moments


def _product(p: Array, q: Array) -> Array:
    """Quaternion that turns by q first, then by p."""
    vector = p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:])
    return np.array([p[0] * q[0] - p[1:] @ q[1:], *vector])


def _matrix(q: Array) -> Array:
    """Rotation matrix (3, 3) of a unit quaternion."""
    x, y, z = q[1:]
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    matrix: Array = np.eye(3) + 2.0 * q[0] * across + 2.0 * across @ across
    return matrix
