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


@kernel
def hill_coefficients(out: Array, rate: float, time: float) -> None:
    """out = what `hill_flight` needs of a time: 1 - c, s/n, (1 - c)/n, nt - s, (4 s - 3 nt)/n, n s, n (1 - c), s.

        nt - s = a^3/6 - a^5/120 + ...,   1 - c = a^2/2 - a^4/24 + ...,   s = a - (a - s),   a = nt

    out                  c = cos nt, s = sin nt                  [-, s, s, -, s, 1/s, 1/s, -]   (8,)
    rate          n      mean motion of the frame's orbit        [rad/s]
    time          t      either sign                             [s]

    Series summed to the last digit while |a| <= 1/2; a longer time is halved until it is that short and the result
    doubled as often. So only correctly rounded operations are used, and the bits are the same on every platform.

    Valid    rate > 0; each is right to 8e-16 of itself while |a| <= 1/2, and beyond that to 1e-15 (1 + |a|) of the
             largest size it has in a revolution
    Source   Taylor's series; sin 2a = 2 s c, 1 - cos 2a = 2 s^2, 2a - sin 2a = 2 ((a - s) + s (1 - c))
    Checked  tests/orbital/test_hill.py, against exact arithmetic
    """
    angle = rate * time
    doublings = 0
    while 0.5 < abs(angle) < math.inf:
        angle *= 0.5
        doublings += 1
    q = angle * angle
    lag = 1.0 - q / 72.0 * (1.0 - q / 110.0 * (1.0 - q / 156.0 * (1.0 - q / 210.0)))
    lag = angle * q / 6.0 * (1.0 - q / 20.0 * (1.0 - q / 42.0 * lag))
    versine = 1.0 - q / 56.0 * (1.0 - q / 90.0 * (1.0 - q / 132.0 * (1.0 - q / 182.0)))
    versine = 0.5 * q * (1.0 - q / 12.0 * (1.0 - q / 30.0 * versine))
    sine = angle - lag
    for _ in range(doublings):
        lag = 2.0 * (lag + sine * versine)
        versine, sine = 2.0 * sine * sine, 2.0 * sine * (1.0 - versine)
    out[0] = versine
    out[1] = sine / rate
    out[2] = versine / rate
    out[3] = lag
    out[4] = time - 4.0 * lag / rate
    out[5] = rate * sine
    out[6] = rate * versine
    out[7] = sine


@kernel
def hill_flown(
    flight: Array, x: float, y: float, z: float, u: float, v: float, w: float
) -> tuple[float, float, float, float, float, float]:
    """Place [m] and velocity [m/s] of a free body after the time of `flight`, component by component.

    The formula of `hill_flight`, for bodies whose components stand in planes of memory.

    flight               from `hill_coefficients`                (8,)
    x, y, z              place now                               [m]
    u, v, w              velocity now, as seen in the frame      [m/s]

    Valid    as `hill_flight`
    Checked  tests/orbital/test_hill.py
    """
    return (
        x + (3.0 * flight[0] * x + flight[1] * u + 2.0 * flight[2] * v),
        y + (flight[4] * v - 6.0 * flight[3] * x - 2.0 * flight[2] * u),
        z + (flight[1] * w - flight[0] * z),
        u + (3.0 * flight[5] * x - flight[0] * u + 2.0 * flight[7] * v),
        v - (6.0 * flight[6] * x + 2.0 * flight[7] * u + 4.0 * flight[0] * v),
        w - (flight[5] * z + flight[0] * w),
    )


@kernel
def hill_flight(position_out: Array, velocity_out: Array, flight: Array, position: Array, velocity: Array) -> None:
    """Position [m] and velocity [m/s] of a free body after a time, in the orbital frame of a circular orbit.

        x = (4 - 3 c) x0 + s x0'/n + 2 (1 - c) y0'/n
        y = y0 - 6 (nt - s) x0 - 2 (1 - c) x0'/n + (4 s - 3 nt) y0'/n
        z = c z0 + s z0'/n,     c = cos nt,  s = sin nt,   and their derivatives

    flight               n and t, from `hill_coefficients`       (8,)
    position      x0 ..  now                                     [m]      (3,)
    velocity      x0' .. now, as seen in the turning frame       [m/s]    (3,)

    Each component is what it was and a sum of what the flight adds, so that a short flight costs one rounding. The
    error is below half a unit in the last place of the result and 1e-15 of the sum of the sizes of what is added, while
    |nt| <= 1/2. The outputs may be the operands.

    Valid    as `hill_acceleration`, over the time for which the distance stays small
    Source   Clohessy and Wiltshire (1960)
    Checked  tests/orbital/test_hill.py, against exact arithmetic
    """
    x, y, z, u, v, w = hill_flown(flight, position[0], position[1], position[2], velocity[0], velocity[1], velocity[2])
    position_out[0] = x
    position_out[1] = y
    position_out[2] = z
    velocity_out[0] = u
    velocity_out[1] = v
    velocity_out[2] = w


@kernel
def hill_bend(distance: float, speed: float, rate: float, time: float) -> float:
    """Bound of how far a free flight ends from the straight line r + v t [m].

        (n t^2 |v| + 3/2 (nt)^2 |r|) (1 + 2/3 nt)

    distance      |r|    from the origin; of two bodies, between them            [m]
    speed         |v|    as seen in the turning frame; of two bodies, relative   [m/s]
    rate          n      mean motion of the frame's orbit                        [rad/s]
    time          t      not negative                                            [s]

    Valid    any time; reached to first order in nt, by a flight along x or y and by a body at rest on the x axis
    Source   1 - cos a <= a^2/2 and a - sin a <= a^3/6 in the solution
    Checked  tests/orbital/test_hill.py
    """
    angle = rate * time
    return (angle * time * speed + 1.5 * angle * angle * distance) * (1.0 + angle / 1.5)


def clohessy_wiltshire(
    position: Array, velocity: Array, rate: float, time: float, acceleration: Array | None = None
) -> tuple[Array, Array]:
    """Position [m] and velocity [m/s] after a time, as `hill_flight`, and under a constant acceleration.

        x += (1 - c) ax/n^2 + 2 (nt - s) ay/n^2
        y += -2 (nt - s) ax/n^2 + (4 (1 - c) - 3 (nt)^2/2) ay/n^2
        z += (1 - c) az/n^2,     c = cos nt,  s = sin nt

    position             at the start                            [m]      (3,)
    velocity             at the start, as seen in the frame      [m/s]    (3,)
    rate          n      mean motion of the frame's orbit        [rad/s]
    time          t      either sign                             [s]
    acceleration  ax ..  by a thrust fixed in the turning frame  [m/s^2]  (3,), none by default

    Valid    as `hill_acceleration`, over the time for which the distance stays small
    Source   Clohessy and Wiltshire (1960); the thrust terms by variation of constants
    Checked  tests/orbital/test_hill.py
    """
    flight, new_position, new_velocity = np.empty(8), np.empty(3), np.empty(3)
    hill_coefficients(flight, float(rate), float(time))
    hill_flight(new_position, new_velocity, flight, np.asarray(position, float), np.asarray(velocity, float))
    if acceleration is not None:
        n, angle = rate, rate * time
        versine, lag, sine = (float(flight[i]) for i in (0, 3, 7))
        a, b, d = (float(value) for value in acceleration)
        # 4 (1 - c) and 3 (nt)^2/2 stay a factor 4/3 apart as nt vanishes, so their difference needs no such care.
        new_position += np.array(
            [versine * a + 2.0 * lag * b, -2.0 * lag * a + (4.0 * versine - 1.5 * angle * angle) * b, versine * d]
        ) / (n * n)
        new_velocity += (
            np.array([sine * a + 2.0 * versine * b, -2.0 * versine * a + (4.0 * sine - 3.0 * angle) * b, sine * d]) / n
        )
    return new_position, new_velocity
