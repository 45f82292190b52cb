"""Relative motion near a circular orbit, to first order: Hill's equations, their solution and their integral.

The net's short flight is computed with these as its gravity term; a tow is computed without linearising and judged by
them. Frame of `frames`: x radial outward, y along-track, z along the orbit normal; velocities as seen in that turning
frame.
"""

import math

import numpy as np

from orbital.kernel import kernel
from orbital.vectors import Array


@kernel
def hill_acceleration(out: Array, position: Array, velocity: Array, rate: float) -> None:
    """out = apparent acceleration [m/s^2] of a free body in the orbital frame of a circular orbit.

        x'' = 2 n y' + 3 n^2 x,   y'' = -2 n x',   z'' = -n^2 z

    position      x y z  from the origin of the frame            [m]      (3,)
    velocity             as seen in the turning frame            [m/s]    (3,)
    rate          n      mean motion of the frame's orbit        [rad/s]

    Valid    distances small against the radius: the neglected part is 3 n^2 rho^2 / r, 2e-9 m/s^2 at 60 m in low orbit
    Source   Hill (1878); Clohessy and Wiltshire, J. Aerospace Sciences 27 (1960) 653
    Checked  tests/orbital/test_hill.py
    """
    radial = rate * (2.0 * velocity[1] + 3.0 * rate * position[0])
    along = -2.0 * rate * velocity[0]
    normal = -rate * rate * position[2]
    out[0] = radial
    out[1] = along
    out[2] = normal


@kernel
def hill_jacobi(position: Array, velocity: Array, rate: float) -> float:
    """Jacobi integral of the free relative motion [J/kg], constant along every solution.

        (x'^2 + y'^2 + z'^2)/2 - 3 n^2 x^2/2 + n^2 z^2/2

    position      x y z  from the origin of the frame            [m]      (3,)
    velocity             as seen in the turning frame            [m/s]    (3,)
    rate          n      mean motion of the frame's orbit        [rad/s]

    Times a mass it is an energy, in which the internal energy of a net is added; the Coriolis force does no work.

    Valid    as `hill_acceleration`
    Source   Hill's equations multiplied by the velocity and integrated
    Checked  tests/orbital/test_hill.py
    """
    kinetic = velocity[0] * velocity[0] + velocity[1] * velocity[1] + velocity[2] * velocity[2]
    return float(0.5 * kinetic + 0.5 * rate * rate * (position[2] * position[2] - 3.0 * position[0] * position[0]))


def clohessy_wiltshire(
    position: Array, velocity: Array, rate: float, time: float, acceleration: Array | None = None
) -> tuple[Array, Array]:
    """Position [m] and velocity [m/s] after a time, in the orbital frame of a circular orbit.

        x = (4 - 3 c) x0 + s x0'/n + 2 (1 - c) y0'/n
        y = y0 - 6 (nt - s) x0 - 2 (1 - c) x0'/n + (4 s - 3 nt) y0'/n
        z = c z0 + s z0'/n,     c = cos nt,  s = sin nt
        and for a constant acceleration  (1 - c) ax/n^2 + 2 (nt - s) ay/n^2,
        -2 (nt - s) ax/n^2 + (4 (1 - c) - 3 (nt)^2/2) ay/n^2,   (1 - c) az/n^2

    position      x0 ..  at the start                            [m]      (3,)
    velocity      x0' .. at the start, as seen in the frame      [m/s]    (3,)
    rate          n      mean motion of the frame's orbit        [rad/s]
    time          t      either sign                             [s]
    acceleration  ax ..  by a thrust fixed in the turning frame  [m/s^2]  (3,), none by default

    1 - c and nt - s are formed without cancellation, so that short times are as exact as long ones.

    Valid    as `hill_acceleration`, over the time for which the distance stays small
    Source   Clohessy and Wiltshire (1960); the thrust terms by variation of constants
    Checked  tests/orbital/test_hill.py
    """
    n = rate
    angle = n * time
    s, c = math.sin(angle), math.cos(angle)
    versine = 2.0 * math.sin(0.5 * angle) ** 2
    lag = angle_minus_sine(angle)
    x, y, z = (float(value) for value in position)
    u, v, w = (float(value) for value in velocity)
    new_position = np.array(
        [
            (1.0 + 3.0 * versine) * x + s * u / n + 2.0 * versine * v / n,
            y - 6.0 * lag * x - 2.0 * versine * u / n + (angle - 4.0 * lag) * v / n,
            c * z + s * w / n,
        ]
    )
    new_velocity = np.array(
        [
            3.0 * n * s * x + c * u + 2.0 * s * v,
            -6.0 * n * versine * x - 2.0 * s * u + (1.0 - 4.0 * versine) * v,
            -n * s * z + c * w,
        ]
    )
    if acceleration is not None:
        a, b, d = (float(value) for value in acceleration)
        # 4 (1 - c) and 3 (nt)^2/2 stay a factor 4/3 apart as nt vanishes, so their difference needs no such care.
        new_position += np.array(
            [versine * a + 2.0 * lag * b, -2.0 * lag * a + (4.0 * versine - 1.5 * angle * angle) * b, versine * d]
        ) / (n * n)
        new_velocity += (
            np.array([s * a + 2.0 * versine * b, -2.0 * versine * a + (4.0 * s - 3.0 * angle) * b, s * d]) / n
        )
    return new_position, new_velocity


def angle_minus_sine(angle: float) -> float:
    """An angle minus its sine [rad], without cancellation.

        a - sin a = a^3/6 - a^5/120 + ...

    angle         a      either sign                             [rad]

    Below 1 rad the series is summed, ten terms of it; above, the difference is good as it stands.

    Valid    any finite angle
    Source   Taylor's series of the sine
    Checked  tests/orbital/test_hill.py
    """
    if abs(angle) >= 1.0:
        return angle - math.sin(angle)
    term = angle**3 / 6.0
    total = 0.0
    for k in range(4, 24, 2):
        total += term
        term *= -angle * angle / (k * (k + 1))
    return total
