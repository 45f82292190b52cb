"""Zonal harmonics of the Earth's field beyond the second, as accelerations and differences of them.

U_n = mu J_n R^n/r^(n+1) P_n(s),   s = z/r,   z = r . p
a = mu J_n R^n/r^(n+2) (P'_(n+1)(s) r/|r| - P'_n(s) p)
"""

from __future__ import annotations

import math

from orbital.kernel import kernel
from orbital.vectors import Array, dot


@kernel
def third_slopes(s: float, ds: float) -> tuple[float, float, float, float]:
    """P'_4 and P'_3 at s + ds, and how much more that is than at s [-]; the differences without cancellation.

        P'_4 = (35 s^3 - 15 s)/2,   P'_3 = (15 s^2 - 3)/2

    s, ds         sine of the latitude, and its change           [-]

    Source   Legendre polynomials
    Checked  tests/orbital/test_zonals.py
    """
    t = s + ds
    along, axial = 0.5 * t * (35.0 * t * t - 15.0), 0.5 * (15.0 * t * t - 3.0)
    return along, axial, 0.5 * ds * (35.0 * (t * t + t * s + s * s) - 15.0), 7.5 * ds * (t + s)


@kernel
def fourth_slopes(s: float, ds: float) -> tuple[float, float, float, float]:
    """P'_5 and P'_4 at s + ds, and how much more that is than at s [-]; the differences without cancellation.

        P'_5 = (315 s^4 - 210 s^2 + 15)/8,   P'_4 = (35 s^3 - 15 s)/2

    s, ds         sine of the latitude, and its change           [-]

    Source   Legendre polynomials
    Checked  tests/orbital/test_zonals.py
    """
    t = s + ds
    square, sum_of_squares = t * t, t * t + s * s
    along, axial = (square * (315.0 * square - 210.0) + 15.0) / 8.0, 0.5 * t * (35.0 * square - 15.0)
    more = ds * (t + s) * (315.0 * sum_of_squares - 210.0) / 8.0
    return along, axial, more, 0.5 * ds * (35.0 * (t * t + t * s + s * s) - 15.0)


@kernel
def zonal_acceleration(out: Array, position: Array, pole: Array, mu: float, third: float, fourth: float) -> None:
    """out = acceleration by the third and the fourth zonal harmonic [m/s^2].

        a = sum mu J_n R^n/r^(n+2) (P'_(n+1)(s) r/|r| - P'_n(s) p)

    position      r      from the centre                         [m]        (3,)
    pole          p      unit vector of the axis                 [-]        (3,)
    mu            mu     gravitational parameter                 [m^3/s^2]
    third         J3 R^3                                         [m^3]
    fourth        J4 R^4                                         [m^4]

    Valid    |r| > 0
    Source   Vallado, Fundamentals of astrodynamics and applications (2013), section 8.6; the gradient of `zonal_energy`
    Checked  tests/orbital/test_zonals.py, against the gradient of the potential
    """
    square = dot(position, position)
    radius = math.sqrt(square)
    s = dot(position, pole) / radius
    along, axial, _, _ = third_slopes(s, 0.0)
    strength = mu * third / (square * square * radius)
    radial, polar = strength * along, strength * axial
    along, axial, _, _ = fourth_slopes(s, 0.0)
    strength = mu * fourth / (square * square * square)
    radial += strength * along
    polar += strength * axial
    for i in range(3):
        out[i] = radial * (position[i] / radius) - polar * pole[i]


@kernel
def differential_zonal(
    out: Array, position: Array, offset: Array, pole: Array, mu: float, third: float, fourth: float
) -> None:
    """out = that acceleration at the end of `offset` minus that at its start [m/s^2], without cancellation.

        a = k u^m (A e - B p),   u = r/r',   m = n + 2,   e = r/|r|
        da = k ((u^m - 1) (A' e' - B' p) + dA e' + A de - dB p)
        de = d/r' + (u - 1) e,   ds = dz/r' + (u - 1) s,   u - 1 = -q/(w (1 + w)),   w = sqrt(1 + q) = 1/u

    q = d.(d + 2 r)/r^2; u^m - 1 = (u - 1)(1 + u + ... + u^(m-1)).

    position      r      where the offset starts                 [m]        (3,)
    offset        d      from there to the other body            [m]        (3,)
    The others as in `zonal_acceleration`.

    Valid    any offset that does not end at the centre; error 1e-14 of the result's own length
    Source   as `perturbations.differential_flattening`
    Checked  tests/orbital/test_zonals.py, against 50 digits
    """
    square = dot(position, position)
    radius = math.sqrt(square)
    q = (
        offset[0] * (offset[0] + 2.0 * position[0])
        + offset[1] * (offset[1] + 2.0 * position[1])
        + offset[2] * (offset[2] + 2.0 * position[2])
    ) / square
    w = math.sqrt(1.0 + q)
    u, less = 1.0 / w, -q / (w * (1.0 + w))
    other = radius * w
    s = dot(position, pole) / radius
    ds = dot(offset, pole) / other + less * s
    by_five = less * (1.0 + u * (1.0 + u * (1.0 + u * (1.0 + u))))
    by_six = by_five + less * u * u * u * u * u
    along, axial, along_more, axial_more = third_slopes(s, ds)
    strength = mu * third / (square * square * radius)
    there = strength * (by_five * along + along_more)
    change = strength * (along - along_more)
    polar = strength * (by_five * axial + axial_more)
    along, axial, along_more, axial_more = fourth_slopes(s, ds)
    strength = mu * fourth / (square * square * square)
    there += strength * (by_six * along + along_more)
    change += strength * (along - along_more)
    polar += strength * (by_six * axial + axial_more)
    for i in range(3):
        out[i] = (
            there * ((position[i] + offset[i]) / other)
            + change * (offset[i] / other + less * (position[i] / radius))
            - polar * pole[i]
        )


@kernel
def zonal_energy(position: Array, pole: Array, mu: float, third: float, fourth: float) -> float:
    """Potential of the third and the fourth zonal harmonic [J/kg].

        sum mu J_n R^n/r^(n+1) P_n(s),   P_3 = (5 s^3 - 3 s)/2,   P_4 = (35 s^4 - 30 s^2 + 3)/8

    The arguments as in `zonal_acceleration`.

    Valid    |r| > 0
    Source   Vallado (2013), eq. 8-19
    Checked  tests/orbital/test_zonals.py; tests/tethered_deorbit/test_sky.py: energy is kept
    """
    square = dot(position, position)
    radius = math.sqrt(square)
    s = dot(position, pole) / radius
    t = s * s
    third_order = third / (square * square) * 0.5 * s * (5.0 * t - 3.0)
    return mu * (third_order + fourth / (square * square * radius) * (t * (35.0 * t - 30.0) + 3.0) / 8.0)
