"""What it takes to bring a pair of bodies down: speed, time, propellant and power, in closed form.

Checked  tests/orbital/test_disposal.py
"""

from __future__ import annotations

import math

from orbital.constants import STANDARD_GRAVITY


def spiral_speed(high: float, low: float, mu: float) -> float:
    """Change of speed [m/s] of a slow spiral between two circles.

        dv = sqrt(mu/a1) - sqrt(mu/a0)

    high, low     a0 a1  radii of the circles                    [m]
    mu                   gravitational parameter                 [m3/s2]

    Valid    a thrust far below gravity, along-track
    Source   Edelbaum, without change of plane
    Checked  tests/orbital/test_disposal.py; 332 m/s from 800 km to 200 km
    """
    return math.sqrt(mu / low) - math.sqrt(mu / high)


def burn_speed(radius: float, perigee: float, mu: float) -> float:
    """Change of speed [m/s] that lowers the perigee of a circular orbit in one short burn.

        dv = sqrt(mu/a) (1 - sqrt(2 rp/(a + rp)))

    radius        a      of the circle                           [m]
    perigee       rp     radius of the perigee                   [m]
    mu                   gravitational parameter                 [m3/s2]

    Valid    a burn much shorter than the orbit; a longer one loses to gravity
    Source   vis-viva at the apogee
    Checked  tests/orbital/test_disposal.py
    """
    return math.sqrt(mu / radius) * (1.0 - math.sqrt(2.0 * perigee / (radius + perigee)))


def propellant(mass: float, speed: float, specific_impulse: float) -> float:
    """Propellant [kg] for a change of speed.

        m_p = M (1 - exp(-dv/(Isp g0)))

    mass          M      of all that is moved, at the begin      [kg]
    speed         dv                                             [m/s]
    specific_impulse Isp                                         [s]

    Valid    any
    Source   Tsiolkovsky
    Checked  tests/orbital/test_disposal.py
    """
    return mass * -math.expm1(-speed / (specific_impulse * STANDARD_GRAVITY))


def thrust_time(mass: float, speed: float, specific_impulse: float, force: float) -> float:
    """Time [s] of thrust for a change of speed: the propellant over its flow, m_p Isp g0/F.

    mass          M      of all that is moved, at the begin      [kg]
    speed         dv                                             [m/s]
    specific_impulse Isp                                         [s]
    force         F                                              [N]

    Valid    thrust all the time
    Source   F = Isp g0 dm/dt
    Checked  tests/orbital/test_disposal.py
    """
    return propellant(mass, speed, specific_impulse) * specific_impulse * STANDARD_GRAVITY / abs(force)


def jet_power(force: float, specific_impulse: float, efficiency: float) -> float:
    """Power drawn [W] by an electric thruster: P = F Isp g0/(2 eta).

    force         F                                              [N]
    specific_impulse Isp                                         [s]
    efficiency    eta    of jet over drawn power                 [1]

    Valid    any
    Source   power of the jet, F c/2
    Checked  tests/orbital/test_disposal.py
    """
    return abs(force) * specific_impulse * STANDARD_GRAVITY / (2.0 * efficiency)


def beam_share(distance: float, half_angle: float, face: float) -> float:
    """Share of a thruster's beam that meets a square face across it, in its middle [1].

        erf(w/(2 sqrt(2) s))^2,   s = d tan(half-angle)/sqrt(-2 ln 0.05)

    distance      d      from the thruster                       [m]
    half_angle           within which 95 % of the beam lie       [rad]
    face          w      side of the square                      [m]

    Valid    a beam that is normal across, its axis through the middle of the face
    Source   integral of a normal density over a square
    Checked  tests/orbital/test_disposal.py; three quarters at 12 m, 15 deg, 4 m
    """
    spread = distance * math.tan(half_angle) / math.sqrt(-2.0 * math.log(0.05))
    return math.erf(face / (2.0 * math.sqrt(2.0) * spread)) ** 2
