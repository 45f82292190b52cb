"""How thick a line has to be: the section at which a load, times a factor of safety, is just what it bears.

A line twice as thick is twice as stiff and snaps harder, so a section follows from its own tug: it is a fixed point.
Plain Python; nothing is compiled for it.
"""

from __future__ import annotations

import math

from orbital.oscillators import damped_snap_peak

DASHPOT_GOVERNS = 0.5
"""Damping ratio from which on the dashpot's jump as the line goes taut is the largest tension [1]; see
`oscillators.damped_snap_peak`."""


def impact_share(zeta: float) -> float:
    """Peak of a damped snap over that of an undamped one, without preload [1].

    zeta                 damping ratio                           [1]

    Valid    zeta >= 0
    Source   `oscillators.damped_snap_peak` at v sqrt(k m) = 1
    Checked  tests/orbital/test_tethers.py
    """
    return damped_snap_peak(1.0, 1.0, 1.0, zeta)


def preloaded_snap_peak(speed: float, stiffness: float, mass: float, zeta: float, preload: float) -> float:
    """Largest tension [N] when a damped line goes taut at a given speed while a steady force keeps its ends apart.

        T = P + u,   u(t) = exp(-zeta w t) (u0 cos w_d t + (u0' + zeta w u0)/w_d sin w_d t),
        u0 = c v - P,   u0' = (k - c^2/m) v + c P/m,   at the first turn of u, or at the start where it falls from there

    speed         v      of separation as the line goes taut     [m/s]
    stiffness     k                                              [N/m]
    mass          m      reduced mass                            [kg]
    zeta                 c / (2 sqrt(k m)), below 1              [1]
    preload       P      steady tension                          [N]

    Valid    0 <= zeta < 1, v > 0; P + sqrt(P^2 + k m v^2) without damping
    Source   m x'' + c x' + k x = P with x = 0, x' = v at the start; T = k x + c x' obeys the same equation
    Checked  tests/orbital/test_tethers.py
    """
    if not 0.0 <= zeta < 1.0:
        raise ValueError(f"the damping ratio must lie in [0, 1), but is {zeta}")
    w = math.sqrt(stiffness / mass)
    root = math.sqrt((1.0 - zeta) * (1.0 + zeta))
    damping = 2.0 * zeta * math.sqrt(stiffness * mass)
    start = damping * speed - preload
    slope = (stiffness - damping**2 / mass) * speed + damping * preload / mass
    if slope <= 0.0:
        return preload + start
    across = (slope + zeta * w * start) / (root * w)
    turn = math.atan2(slope, w * (zeta * across + root * start))  # where u' = 0, in w_d t
    fall = math.exp(-zeta * turn / root)
    return preload + fall * (start * math.cos(turn) + across * math.sin(turn))


def snap_section(
    speed: float,
    mass: float,
    length: float,
    young_modulus: float,
    strength: float,
    safety: float,
    preload: float = 0.0,
    share: float = 1.0,
) -> float:
    """Section that bears its own snap [m2], with a factor of safety on the peak.

        A = F^2 g^2 v^2 E m / (l sigma^2) + 2 F P / sigma

    speed         v      at which the line goes taut             [m/s]
    mass          m      reduced mass                            [kg]
    length        l      unloaded                                [m]
    young_modulus E                                              [Pa]
    strength      sigma  breaking stress                         [Pa]
    safety        F      factor of safety on the peak            [1]
    preload       P      steady tension                          [N]
    share         g      of the undamped impact, `impact_share`  [1]

    Valid    undamped with any preload (g = 1), or damped without one (P = 0); with both it counts too much
    Source   F T = sigma A with T = P + sqrt(P^2 + k m v^2), k = E A / l: (sigma A/F - P)^2 = P^2 + E A m v^2 / l
    Checked  tests/orbital/test_tethers.py, tests/sizing/test_fixed_point.py
    """
    return (safety * share * speed / strength) ** 2 * young_modulus * mass / length + 2.0 * safety * preload / strength


def load_section(load: float, strength: float, safety: float) -> float:
    """Section that bears a load which the line's own stiffness does not change [m2]: A = F T / sigma.

    load          T                                              [N]
    strength      sigma  breaking stress                         [Pa]
    safety        F      factor of safety                        [1]

    Valid    any
    Source   definition of stress
    Checked  tests/orbital/test_tethers.py
    """
    return safety * load / strength


def diameter_of(section: float) -> float:
    """Diameter of a solid round section [m]: d = sqrt(4 A / pi).

    section       A                                              [m2]

    Valid    any
    Source   geometry
    Checked  tests/orbital/test_tethers.py
    """
    return math.sqrt(4.0 * section / math.pi)


def cut_rate(diameter: float, length: float, flux: float) -> float:
    """Rate at which particles cut a line [1/s]: N' = pi D L f.

    diameter      D      of the line                             [m]
    length        L      that is out                             [m]
    flux          f      of particles larger than D/3, through a surface that turns at random, per its area and time
                                                                 [1/(m2 s)]

    Valid    particles much smaller than the line is long; one of a third of its diameter or more cuts it
    Source   a third of the diameter: Anselmo and Pardini, Space Debris 1 (2000), 87; Khan and Sanmartin,
             J. Spacecraft and Rockets 50 (2013), 603
    Checked  tests/orbital/test_tethers.py
    """
    return math.pi * diameter * length * flux


def diameter_for_cuts(
    probability: float, time: float, length: float, coefficient: float, reference: float, exponent: float
) -> float:
    """Diameter at which a line is cut within a time with this probability [m], for a flux that falls as a power.

        1 - exp(-N' t) = p,   N' = pi D L f0 (D/(3 d0))^-q:   D = (pi L f0 (3 d0)^q t / -ln(1 - p))^(1/(q - 1))

    probability   p                                              [1]
    time          t                                              [s]
    length        L      that is out                             [m]
    coefficient   f0     flux of particles larger than d0        [1/(m2 s)]
    reference     d0                                             [m]
    exponent      q                                              [1]

    Valid    q > 1 and 0 < p < 1; ValueError otherwise: a thicker line would be cut as often
    Source   cuts at random, in a Poisson process
    Checked  tests/orbital/test_tethers.py
    """
    if not exponent > 1.0 or not 0.0 < probability < 1.0:
        raise ValueError(f"expected an exponent above 1 and a probability between 0 and 1: {exponent}, {probability}")
    cuts = -math.log1p(-probability)
    base = math.pi * length * coefficient * (3.0 * reference) ** exponent * time / cuts
    return float(base ** (1.0 / (exponent - 1.0)))
