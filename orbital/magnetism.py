"""The Earth's magnetic field, as a tilted dipole or by its harmonics, and what it does to a conductor."""

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

    Valid    to 30 % of the whole field in the mean over low orbits, to 77 % over the South Atlantic at 400 km
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


@kernel
def harmonic_field(out: Array, position: Array, coefficients: Array, room: Array, degree: int) -> None:
    """out = magnetic flux density [T] of a field given by its harmonics, in axes that turn with the Earth.

        B = -grad a sum_nm (g_nm V_nm + h_nm W_nm),   V_nm + i W_nm = (a/r)^(n+1) P_nm(sin lat) exp(i m lon)

    position      r      in the same axes, the first through Greenwich   [m]  (3,)
    coefficients  g, h   of polynomials that are not normalised  [T]        (2, degree + 1, degree + 1)
    room                 for V and W                             [-]        (2 degree + 4, degree + 2)

    Valid    outside the core's sources, |r| > 0
    Source   Cunningham's recursion, as in Montenbruck and Gill, Satellite orbits (2000), eq. 3.29 to 3.33
    Checked  tests/orbital/test_magnetism.py, against the dipole and the gradient of a quadrupole;
             tests/tethered_deorbit/test_field.py, against ppigrf
    """
    a = REFERENCE_RADIUS
    square = dot(position, position)
    x, y, z = position[0] * a / square, position[1] * a / square, position[2] * a / square
    fall = a * a / square
    v, w = room[0 : degree + 2], room[degree + 2 : 2 * degree + 4]
    v[0, 0], w[0, 0] = a / math.sqrt(square), 0.0
    for m in range(degree + 2):
        if m > 0:
            odd = 2.0 * m - 1.0
            v[m, m] = odd * (x * v[m - 1, m - 1] - y * w[m - 1, m - 1])
            w[m, m] = odd * (x * w[m - 1, m - 1] + y * v[m - 1, m - 1])
        for n in range(m + 1, degree + 2):
            up, down = (2.0 * n - 1.0) / (n - m) * z, (n + m - 1.0) / (n - m) * fall
            v[n, m] = up * v[n - 1, m]
            w[n, m] = up * w[n - 1, m]
            if n > m + 1:
                v[n, m] -= down * v[n - 2, m]
                w[n, m] -= down * w[n - 2, m]
    first, second, third = 0.0, 0.0, 0.0
    for n in range(1, degree + 1):
        for m in range(n + 1):
            g, h = coefficients[0, n, m], coefficients[1, n, m]
            third -= (n - m + 1.0) * (g * v[n + 1, m] + h * w[n + 1, m])
            if m == 0:
                first -= g * v[n + 1, 1]
                second -= g * w[n + 1, 1]
            else:
                weight = (n - m + 1.0) * (n - m + 2.0)
                first += 0.5 * weight * (g * v[n + 1, m - 1] + h * w[n + 1, m - 1])
                first -= 0.5 * (g * v[n + 1, m + 1] + h * w[n + 1, m + 1])
                second += 0.5 * weight * (h * v[n + 1, m - 1] - g * w[n + 1, m - 1])
                second += 0.5 * (h * v[n + 1, m + 1] - g * w[n + 1, m + 1])
    out[0], out[1], out[2] = -first, -second, -third
