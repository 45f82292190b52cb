"""Closed forms the removal model is judged by: the slow spiral down, the pendulum of a towed pair, the Earth's shadow.

The pair is two point masses on a taut line of length l near a circular orbit, small against its radius; a thrust F on
the chaser alone acts backwards along the local along-track. With phi the angle of the line from the vertical, positive
where the chaser is displaced along the thrust, and f = F/m_c the acceleration it gives the chaser:

    phi'' = cos phi (f/l - 3 n^2 sin phi)
    T/(m_r l) = (phi' + n)^2 - n^2 + 3 n^2 cos^2 phi + (f/l) sin phi     with phi' - n when the chaser is the upper body

The first gives the equilibria, their periods and growth rates, the second the tension. Only the ratio f/(3 n^2 l)
counts: it is the sine of the equilibrium angle.
"""

import math

from orbital.kernel import kernel


def spiral_rate(semi_major_axis: float, thrust: float, mass: float, mu: float) -> float:
    """Rate of change of the semi-major axis [m/s], averaged over a near-circular orbit.

        da/dt = 2 a^(3/2) F / (sqrt(mu) M)

    semi_major_axis  a   of the near-circular orbit              [m]
    thrust           F   along-track; negative lowers the orbit  [N]
    mass             M   of all that is moved                    [kg]
    mu               mu  gravitational parameter                 [m^3/s^2]

    Valid    thrust acceleration small against mu/a^2
    Source   Battin (1999), variation of parameters; power F v equals the rate of -mu M/(2 a)
    Checked  tests/orbital/test_references.py; 554.84 m/day for Table 2
    """
    return 2.0 * semi_major_axis * math.sqrt(semi_major_axis) * thrust / (math.sqrt(mu) * mass)


def spiral_delta_v(start_radius: float, end_radius: float, mu: float) -> float:
    """Velocity increment [m/s] of a slow spiral between two circular orbits, up or down.

        dv = |sqrt(mu/r1) - sqrt(mu/r2)|

    start_radius  r1     of the first circle                     [m]
    end_radius    r2     of the last circle                      [m]
    mu            mu     gravitational parameter                 [m^3/s^2]

    Valid    thrust acceleration small against mu/r^2, no plane change
    Source   Edelbaum, ARS Journal 31 (1961) 1079, without inclination change; `spiral_rate` integrated
    Checked  tests/orbital/test_references.py; 332 m/s from 800 to 200 km
    """
    return abs(math.sqrt(mu / start_radius) - math.sqrt(mu / end_radius))


def spiral_time(
    start_radius: float, end_radius: float, thrust: float, mass: float, mu: float, exhaust_speed: float = math.inf
) -> float:
    """Time [s] of a slow spiral between two circular orbits.

        t = M dv/F                              constant mass
        t = (M v_e/F)(1 - exp(-dv/v_e))         propellant leaving at v_e

    start_radius  r1     of the first circle                     [m]
    end_radius    r2     of the last circle                      [m]
    thrust        F      magnitude                               [N]
    mass          M      at the start                            [kg]
    mu            mu     gravitational parameter                 [m^3/s^2]
    exhaust_speed v_e    infinite: the mass stays constant       [m/s]

    Valid    as `spiral_delta_v`; no drag
    Source   `spiral_delta_v` and the rocket equation
    Checked  tests/orbital/test_references.py; 3.16 years for Table 2 from 800 to 200 km
    """
    delta_v = spiral_delta_v(start_radius, end_radius, mu)
    if math.isinf(exhaust_speed):
        return mass * delta_v / abs(thrust)
    return -math.expm1(-delta_v / exhaust_speed) * mass * exhaust_speed / abs(thrust)


@kernel
def equilibrium_tension(rate: float, length: float, mass: float) -> float:
    """Tension [N] of a pair at rest in the orbital frame about the vertical, whatever the thrust.

        T = 3 n^2 l m_r

    rate          n      mean motion of the orbit                [rad/s]
    length        l      of the line                             [m]
    mass          m_r    reduced mass of the pair                [kg]

    Gravity gradient and centrifugal force give 3 n^2 l m_r cos^2 phi, the thrust's share along the line gives the rest.

    Valid    thrust below `critical_thrust`
    Source   T of the module docstring at rest, with sin phi = f/(3 n^2 l)
    Checked  tests/orbital/test_references.py; 0.0258651 N for Table 2
    """
    return 3.0 * rate**2 * length * mass


def critical_thrust(rate: float, length: float, chaser_mass: float) -> float:
    """Thrust [N] above which towing along V-bar is stable; below it the pair librates about the near-vertical.

        F = 3 n^2 l m_c

    rate          n      mean motion of the orbit                [rad/s]
    length        l      of the line                             [m]
    chaser_mass   m_c    of the body that thrusts                [kg]

    Valid    chaser on the side it thrusts towards, pulling away
    Source   stability of phi = pi/2 in the module docstring
    Checked  tests/orbital/test_references.py; 0.077595 N for Table 2
    """
    return 3.0 * rate**2 * length * chaser_mass


def equilibrium_angle(thrust: float, rate: float, length: float, chaser_mass: float) -> float:
    """Angle [rad] of the line from the vertical at which a thrusting pair is at rest, towards the thrust.

        sin phi = F / (3 n^2 l m_c)

    thrust        F      backwards along-track, on the chaser    [N]
    rate          n      mean motion of the orbit                [rad/s]
    length        l      of the line                             [m]
    chaser_mass   m_c    of the body that thrusts                [kg]

    Torque of the gravity gradient, 3 n^2 m_r l^2 sin phi cos phi, against that of the thrust, m_r l (F/m_c) cos phi.
    The chaser may hang below the target or above it, by the same angle.

    Valid    |F| up to `critical_thrust`, where the line reaches V-bar; ValueError beyond
    Source   phi'' = 0 in the module docstring
    Checked  tests/orbital/test_references.py; 7.40452 deg for Table 2
    """
    sine = thrust / critical_thrust(rate, length, chaser_mass)
    if not -1.0 <= sine <= 1.0:
        raise ValueError(f"thrust {thrust} N exceeds the critical {thrust / sine} N: the pair is towed along V-bar")
    return math.asin(sine)


def vbar_growth_rate(thrust: float, rate: float, length: float, chaser_mass: float) -> float:
    """Rate [1/s] at which a pair towed along V-bar leaves it.

        sigma = sqrt(3 n^2 - F/(m_c l))

    thrust        F      pulling away along V-bar, on the chaser [N]
    rate          n      mean motion of the orbit                [rad/s]
    length        l      of the line                             [m]
    chaser_mass   m_c    of the body that thrusts                [kg]

    Valid    |F| below `critical_thrust`, beyond which V-bar is stable and ValueError is raised; line taut
    Source   linearisation about phi = pi/2: d'' = (3 n^2 - f/l) d
    Checked  tests/orbital/test_references.py; 1.678e-3 1/s for Table 2
    """
    square = 3.0 * rate**2 - thrust / (chaser_mass * length)
    if not square >= 0.0:
        raise ValueError(f"V-bar is stable at {thrust} N: nothing grows")
    return math.sqrt(square)


def libration_period(thrust: float, rate: float, length: float, chaser_mass: float) -> float:
    """Period [s] of small in-plane librations about the equilibrium angle.

        2 pi / (sqrt(3) n cos phi)

    thrust        F      backwards along-track, on the chaser    [N]
    rate          n      mean motion of the orbit                [rad/s]
    length        l      of the line                             [m]
    chaser_mass   m_c    of the body that thrusts                [kg]

    Valid    |F| below `critical_thrust`; small amplitudes, taut line
    Source   linearisation about the equilibrium: d'' = -3 n^2 cos^2 phi d
    Checked  tests/orbital/test_references.py; 3523.75 s for Table 2, 3494.36 s without thrust
    """
    phi = equilibrium_angle(thrust, rate, length, chaser_mass)
    return 2.0 * math.pi / (math.sqrt(3.0) * rate * math.cos(phi))


def slack_amplitude() -> float:
    """Amplitude [rad] of in-plane libration at which the line first goes slack, without thrust.

        cos^2 A = 1/6

    With u = phi'/n, energy gives u^2 = 3 (sin^2 A - sin^2 phi), so that T/(m_r l n^2) = 2 u^2 + 2 u + 3 cos^2 A. It is
    least at u = -1/2, on the swing against the orbital motion, and there it vanishes when cos^2 A = 1/6: the same for
    every orbit, length and mass.

    Valid    rigid line in the plane of a circular orbit, no thrust
    Source   T of the module docstring
    Checked  tests/orbital/test_references.py; 65.905 deg
    """
    return math.acos(math.sqrt(1.0 / 6.0))


def eclipse_fraction(orbit_radius: float, beta: float, body_radius: float) -> float:
    """Part of a circular orbit spent in the shadow of the central body [-].

        acos(sqrt(1 - (R/a)^2)/cos beta)/pi     or 0 when the quotient exceeds 1

    orbit_radius  a      of the circular orbit                   [m]
    beta          beta   angle of the Sun above the orbital plane  [rad]
    body_radius   R      of the body that casts the shadow       [m]

    Valid    cylindrical shadow, no penumbra, spherical body, a >= R
    Source   the arc of a circle inside the cylinder behind the body
    Checked  tests/orbital/test_references.py; 34.8 % at beta = 0 and 800 km, none above 62.69 deg
    """
    quotient = math.sqrt(1.0 - (body_radius / orbit_radius) ** 2)
    cosine = math.cos(beta)
    return math.acos(quotient / cosine) / math.pi if quotient < cosine else 0.0
