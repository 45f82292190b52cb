"""An elastic line whose rest length is part of the state: its sizes as it is wound or slips, and its book of energy."""

from __future__ import annotations

import math
from typing import Any

from orbital.kernel import kernel
from orbital.oscillators import dashpot, line_stiffness, natural_frequency, reduced_mass


@kernel
def elastic_share(record: Any, length: float) -> float:
    """Tension of the line without its dashpot [N], of a taut one.

        T_e = E A (l - L)/L

    length        l      of the line                             [m]

    Source   Hooke's law
    Checked  tests/tethered_deorbit/test_winch.py: the book of energy
    """
    r = record[0]
    force: float = line_stiffness(r.tether_youngs_modulus, r.tether_diameter, r.state_rest) * (length - r.state_rest)
    return force


@kernel
def drawn(record: Any, length: float, tension: float) -> float:
    """Force [N] against which a rest length is wound in: its work is all that the pair and its line gain.

        T + T_e^2/(2 EA)

    length        l      of the line                             [m]
    tension       T      of it                                   [N]

    Valid    tension > 0, else zero
    Source   dE/dt of the stretched line at L' = v: -T v - T_e^2/(2 EA) v - c (l' - v)^2
    Checked  tests/tethered_deorbit/test_winch.py: the book of energy
    """
    if not tension > 0.0:
        return 0.0
    r = record[0]
    elastic = elastic_share(record, length)
    extensional = line_stiffness(r.tether_youngs_modulus, r.tether_diameter, 1.0)
    return tension + 0.5 * elastic * elastic / extensional


@kernel
def heat_of(record: Any, speed: float) -> float:
    """Power that the dashpot of a taut line takes [W].

        c (l' - L')^2

    speed         l'     of the line                             [m/s]

    Checked  tests/tethered_deorbit/test_winch.py: the book of energy
    """
    r = record[0]
    stiffness = line_stiffness(r.tether_youngs_modulus, r.tether_diameter, r.state_rest)
    stretching = speed - r.state_winding
    power: float = (
        dashpot(r.tether_damping_ratio, stiffness, reduced_mass(r.chaser_mass, r.target_mass)) * stretching * stretching
    )
    return power


@kernel
def kept(record: Any, length: float) -> float:
    """What a line has in its stretch as it goes slack, and its dashpot takes; negative as it goes taut [J].

        k (l - L)^2 / 2 where l > L, else nothing

    length        l      of the line                             [m]

    A damped line pulls no more while it is still stretched; what relaxes then is no longer counted as its energy. One
    that has slipped off a corner is shorter at once, and has nothing left.

    Checked  tests/tethered_deorbit/test_winch.py: the book of energy; test_slipping.py: a line that slips
    """
    r = record[0]
    if not length > r.state_rest:
        return 0.0
    stored: float = 0.5 * elastic_share(record, length) * (length - r.state_rest)
    return -stored if r.state_taut else stored


@kernel
def tune(record: Any, shortest: float) -> int:
    """Put the line's sizes in force for the steps to come [N/m], [N s/m], [rad/s]; returns 0, or 1 where it has none.

    shortest      rest length that it may come to                [m]

    Source   as of a locked reel
    Checked  tests/tethered_deorbit/test_winch.py
    """
    r = record[0]
    stiffness = line_stiffness(r.tether_youngs_modulus, r.tether_diameter, shortest)
    if not 0.0 < stiffness < math.inf:
        return 1
    r.state_stiffness = stiffness
    r.state_damping = dashpot(r.tether_damping_ratio, stiffness, reduced_mass(r.chaser_mass, r.target_mass))
    fastest = max(1.0, 2.0 * r.tether_damping_ratio)
    r.state_frequency = natural_frequency(stiffness, r.state_effective_mass) * fastest
    r.state_taut_tolerance = r.solver_tolerance_stretch
    return 0


@kernel
def line(record: Any, since: float) -> tuple[float, float, float, float, float]:
    """What `make_elastic` asks of a line, as the law has seen it last.

    Source   `line_stiffness` and `dashpot` of `orbital.oscillators`
    Checked  tests/tethered_deorbit/test_winch.py
    """
    r = record[0]
    stiffness = line_stiffness(r.tether_youngs_modulus, r.tether_diameter, r.state_rest)
    damping = dashpot(r.tether_damping_ratio, stiffness, reduced_mass(r.chaser_mass, r.target_mass))
    return r.state_rest, r.state_winding, r.state_winding_rate, stiffness, damping
