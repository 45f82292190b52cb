"""Two bodies, one of them a point mass that does not move: accelerations and integrals of motion.

The differential gravity is here because its formulation decides whether a tow can be computed at all: the equilibrium
stretch of the tether is 6.6 micrometres, and the difference of two accelerations at 7000 km would drown it in rounding.
Orbital elements and propagation along a Kepler orbit stand in `kepler`.
"""

import math

from orbital import plain
from orbital.kernel import kernel
from orbital.vectors import Array, dot, norm


@kernel
def two_body_acceleration(out: Array, position: Array, mu: float) -> None:
    """out = acceleration [m/s^2] by a central mass.

        g(r) = -mu r / |r|^3

    position      r      from the centre of attraction           [m]        (3,)
    mu            mu     gravitational parameter                 [m^3/s^2]

    Valid    |r| > 0; at the centre the result is not a number
    Source   Newton; Battin, An introduction to the mathematics and methods of astrodynamics (1999), chapter 3
    Checked  tests/orbital/test_twobody.py
    """
    square = dot(position, position)
    factor = -mu / (square * math.sqrt(square))
    x, y, z = position[0], position[1], position[2]
    out[0] = factor * x
    out[1] = factor * y
    out[2] = factor * z


@kernel
def differential_gravity(out: Array, position: Array, offset: Array, mu: float) -> None:
    """out = gravity at the end of `offset` minus gravity at its start [m/s^2], without cancellation.

        g(r + d) - g(r) = -mu / |r + d|^3 (d - f(q) r)
        q = d . (d + 2 r) / r^2,   |r + d|^2 = r^2 (1 + q)
        f(q) = (1 + q)^(3/2) - 1 = q (3 + 3 q + q^2) / (1 + (1 + q)^(3/2))

    The sign is that of the relative motion: with d = r_chaser - r_target and r = r_target it is what gravity adds to
    d'', to first order +2 mu/r^3 of a radial and -mu/r^3 of a transverse offset.

    position      r      where the offset starts                 [m]        (3,)
    offset        d      from there to the other body            [m]        (3,)
    mu            mu     gravitational parameter                 [m^3/s^2]

    Valid    any offset, of any size, that does not end at the centre; error 1e-15 of the result's own length
    Source   Battin (1999), chapter 8, Encke's method; f(q) is his, the rest is divided by the other radius
    Checked  tests/orbital/test_twobody.py, against 50 digits
    """
    r0, r1, r2 = position[0], position[1], position[2]
    d0, d1, d2 = offset[0], offset[1], offset[2]
    square = r0 * r0 + r1 * r1 + r2 * r2
    q = (d0 * (d0 + 2.0 * r0) + d1 * (d1 + 2.0 * r1) + d2 * (d2 + 2.0 * r2)) / square
    ratio = (1.0 + q) * math.sqrt(1.0 + q)
    f = q * (3.0 + q * (3.0 + q)) / (1.0 + ratio)
    factor = -mu / (square * math.sqrt(square) * ratio)
    out[0] = factor * (d0 - f * r0)
    out[1] = factor * (d1 - f * r1)
    out[2] = factor * (d2 - f * r2)


@kernel
def specific_energy(position: Array, velocity: Array, mu: float) -> float:
    """Orbital energy per unit mass [J/kg], negative on a closed orbit.

        v^2/2 - mu/r = -mu/(2 a)

    position      r      from the centre of attraction           [m]        (3,)
    velocity      v      inertial                                [m/s]      (3,)
    mu            mu     gravitational parameter                 [m^3/s^2]

    Valid    |r| > 0
    Source   the vis viva integral
    Checked  tests/orbital/test_twobody.py
    """
    return 0.5 * dot(velocity, velocity) - mu / norm(position)


@kernel
def semi_major_axis(position: Array, velocity: Array, mu: float) -> float:
    """Semi-major axis [m], negative on a hyperbola.

        a = 1 / (2/r - v^2/mu)

    position      r      from the centre of attraction           [m]        (3,)
    velocity      v      inertial                                [m/s]      (3,)
    mu            mu     gravitational parameter                 [m^3/s^2]

    Valid    not on a parabola, where it is infinite
    Source   vis viva, as `specific_energy`
    Checked  tests/orbital/test_twobody.py
    """
    return 1.0 / (2.0 / norm(position) - dot(velocity, velocity) / mu)


mean_motion = kernel(plain.mean_motion)


@kernel
def circular_speed(radius: float, mu: float) -> float:
    """Speed on a circular orbit [m/s].

        v = sqrt(mu / r)

    radius        r      from the centre of attraction           [m]
    mu            mu     gravitational parameter                 [m^3/s^2]

    Valid    r > 0
    Source   centripetal balance
    Checked  tests/orbital/test_twobody.py
    """
    return math.sqrt(mu / radius)


@kernel
def orbital_period(semi_major_axis: float, mu: float) -> float:
    """Period of a closed orbit [s].

        2 pi / n

    semi_major_axis  a   of the ellipse, the radius of a circle  [m]
    mu               mu  gravitational parameter                 [m^3/s^2]

    Valid    a > 0
    Source   Kepler's third law
    Checked  tests/orbital/test_twobody.py
    """
    return 2.0 * math.pi / mean_motion(semi_major_axis, mu)
