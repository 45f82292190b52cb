"""The Earth's magnetic field as a tilted dipole, and what it does to a conductor that is moved through it."""

from __future__ import annotations

import math

from orbital.kernel import kernel
from orbital.vectors import Array, dot

# IGRF-13, epoch 2020.0: Gauss coefficients g10, g11, h11 [T] about a sphere of 6371.2 km (Alken et al., Earth, Planets
# and Space 73 (2021) 49). Those of 2025 differ by 0.2 % in strength and 0.1 deg in direction.
G10, G11, H11 = -29404.8e-9, -1450.9e-9, 4652.5e-9
REFERENCE_RADIUS = 6371.2e3
STRENGTH = math.sqrt(G10 * G10 + G11 * G11 + H11 * H11)
"""On the magnetic equator at that radius [T]: 29.8 uT."""
NORTH = (-G11 / STRENGTH, -H11 / STRENGTH, -G10 / STRENGTH)
"""Direction of the magnetic pole in the north, in axes that turn with the Earth, the first through Greenwich [-]."""

ELECTRON_CHARGE = 1.602176634e-19
"""[C], exact: SI 2019."""
ELECTRON_MASS = 9.1093837015e-31
"""[kg], CODATA 2018."""
BOLTZMANN = 1.380649e-23
"""[J/K], exact: SI 2019."""


@kernel
def dipole_north(out: Array, greenwich: float) -> None:
    """out = direction of the magnetic pole in the north, in axes at rest (3,) [-].

    greenwich     angle of its meridian from the first axis      [rad]

    Checked  tests/orbital/test_magnetism.py
    """
    c, s = math.cos(greenwich), math.sin(greenwich)
    out[0] = c * NORTH[0] - s * NORTH[1]
    out[1] = s * NORTH[0] + c * NORTH[1]
    out[2] = NORTH[2]


@kernel
def dipole_field(out: Array, position: Array, north: Array) -> None:
    """out = magnetic flux density [T].

        B = B0 (a/r)^3 (m - 3 (m . e) e),   e = r/|r|

    position      r      from the Earth's centre                 [m]        (3,)
    north         m      unit vector to the pole in the north    [-]        (3,)

    Valid    within a quarter of the whole field in low orbit, where the other terms are largest
    Source   potential of the three coefficients of degree 1
    Checked  tests/orbital/test_magnetism.py, against the gradient of that
    """
    square = dot(position, position)
    radius = math.sqrt(square)
    factor = STRENGTH * REFERENCE_RADIUS**3 / (square * radius)
    along = 3.0 * dot(north, position) / square
    for i in range(3):
        out[i] = factor * (north[i] - along * position[i])


@kernel
def tether_current(
    emf: float, resistance: float, drop: float, limit: float, density: float, temperature: float, radius: float
) -> float:
    """Current along a conductor between two plasma contactors [A], with the sign of the voltage that drives it.

        |I| = min((|E| - U)/R, I_most, 4 pi r^2 e n sqrt(k T/(2 pi m_e))),   0 below the drop U

    emf           E      induced                                 [V]
    resistance    R      of conductor and contactors             [ohm]
    drop          U      that both contactors take               [V]
    limit         I_most                                         [A]
    density       n      of electrons                            [1/m^3]
    temperature   T      of electrons                            [K]
    radius        r      of the sphere from which a contactor draws them [m]

    Valid    a conductor that is insulated between its contactors, so that the current is the same all along
    Source   Ohm; random thermal flux of electrons through a surface, Sanmartin et al., Journal of Propulsion and Power
             9 (1993) 353
    Checked  tests/orbital/test_magnetism.py
    """
    flux = ELECTRON_CHARGE * density * math.sqrt(BOLTZMANN * temperature / (2.0 * math.pi * ELECTRON_MASS))
    size = min(max(0.0, abs(emf) - drop) / resistance, min(limit, 4.0 * math.pi * radius * radius * flux))
    return size if emf >= 0.0 else -size
