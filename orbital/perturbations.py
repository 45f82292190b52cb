"""What disturbs a Kepler orbit: the Earth's flattening and the air, as accelerations and differences of them."""

from __future__ import annotations

import math

from orbital.kernel import kernel
from orbital.vectors import Array, dot, norm


@kernel
def flattening_acceleration(out: Array, position: Array, pole: Array, mu: float, strength: float) -> None:
    """out = acceleration by the second zonal harmonic [m/s^2].

        a = -(3/2) mu J2 R^2/r^5 ((1 - 5 s^2) r + 2 z p),   z = r . p,  s = z/r

    position      r      from the centre                         [m]        (3,)
    pole          p      unit vector of the axis                 [-]        (3,)
    mu            mu     gravitational parameter                 [m^3/s^2]
    strength      J2 R^2 harmonic times the radius squared       [m^2]

    Valid    |r| > 0
    Source   Vallado, Fundamentals of astrodynamics and applications (2013), section 8.7.1; the gradient of
             `flattening_energy`
    Checked  tests/orbital/test_perturbations.py, against the gradient of the potential
    """
    square = dot(position, position)
    z = dot(position, pole)
    factor = -1.5 * mu * strength / (square * square * math.sqrt(square))
    radial = factor * (1.0 - 5.0 * z * z / square)
    axial = 2.0 * factor * z
    x, y, w = position[0], position[1], position[2]
    out[0] = radial * x + axial * pole[0]
    out[1] = radial * y + axial * pole[1]
    out[2] = radial * w + axial * pole[2]


@kernel
def differential_flattening(
    out: Array, position: Array, offset: Array, pole: Array, mu: float, strength: float
) -> None:
    """out = that acceleration at the end of `offset` minus that at its start [m/s^2], without cancellation.

        a = k (A r + B z p),   A = (5 z^2/r^2 - 1)/r^5,   B = -2/r^5,   k = (3/2) mu J2 R^2
        da = k (A' d + dA r + (B' dz + dB z) p)

    dA and dB are formed from q = d.(d + 2 r)/r^2 and w = r'/r = sqrt(1 + q), by w - 1 = q/(1 + w) and
    w^-n - 1 = (1 - w)(1 + w + ... + w^(n-1))/w^n.

    position      r      where the offset starts                 [m]        (3,)
    offset        d      from there to the other body            [m]        (3,)
    The others as in `flattening_acceleration`.

    Valid    any offset that does not end at the centre; error 2e-15 of the result's own length
    Source   as `twobody.differential_gravity`
    Checked  tests/orbital/test_perturbations.py, against 50 digits
    """
    square = dot(position, position)
    q = (
        offset[0] * (offset[0] + 2.0 * position[0])
        + offset[1] * (offset[1] + 2.0 * position[1])
        + offset[2] * (offset[2] + 2.0 * position[2])
    ) / square
    w = math.sqrt(1.0 + q)
    less = -q / (1.0 + w)
    fifth = w * w * w * w * w
    seventh = fifth * w * w
    sum_of_five = 1.0 + w * (1.0 + w * (1.0 + w * (1.0 + w)))
    fall_of_five = less * sum_of_five / fifth
    fall_of_seven = less * (sum_of_five + fifth * (1.0 + w)) / seventh
    z, dz = dot(position, pole), dot(offset, pole)
    there = z + dz
    slant, slant_change = z * z / square, dz * (2.0 * z + dz) / square
    k = 1.5 * mu * strength / (square * square * math.sqrt(square))
    along = k * (5.0 * there * there / (square * seventh) - 1.0 / fifth)
    change = k * (5.0 * (slant * fall_of_seven + slant_change / seventh) - fall_of_five)
    axial = -2.0 * k * (dz / fifth + z * fall_of_five)
    for i in range(3):
        out[i] = along * offset[i] + change * position[i] + axial * pole[i]


@kernel
def flattening_energy(position: Array, pole: Array, mu: float, strength: float) -> float:
    """Potential of the second zonal harmonic [J/kg].

        mu J2 R^2/(2 r^3) (3 s^2 - 1)

    The arguments as in `flattening_acceleration`.

    Valid    |r| > 0
    Source   Vallado (2013), eq. 8-19
    Checked  tests/orbital/test_perturbations.py; tests/tethered_deorbit/test_perturbed.py: energy is kept
    """
    square = dot(position, position)
    z = dot(position, pole)
    return 0.5 * mu * strength / (square * math.sqrt(square)) * (3.0 * z * z / square - 1.0)


@kernel
def air_density(altitude: float, base: float, base_altitude: float, scale_height: float) -> float:
    """Density of the air [kg/m^3], falling with altitude by one scale height.

        rho = rho_0 exp(-(h - h_0)/H)

    altitude      h      above the equatorial radius             [m]
    base          rho_0  density at h_0                          [kg/m^3]
    base_altitude h_0                                            [m]
    scale_height  H                                              [m]

    Valid    some scale heights about h_0
    Source   Vallado (2013), eq. 8-33
    Checked  tests/tethered_deorbit/test_perturbed.py: an orbit decays
    """
    return base * math.exp((base_altitude - altitude) / scale_height)


@kernel
def drag_acceleration(
    out: Array, position: Array, velocity: Array, pole: Array, rotation: float, ballistic: float
) -> float:
    """out = acceleration by the drag of air that turns with the Earth [m/s^2]; returns the speed in the air [m/s].

        a = -b |u| u,   u = v - w p x r,   b = rho c_d A/(2 m)

    position      r      from the centre                         [m]        (3,)
    velocity      v      inertial                                [m/s]      (3,)
    pole          p      unit vector of the axis                 [-]        (3,)
    rotation      w      of the air                              [rad/s]
    ballistic     b                                              [1/m]

    Valid    a body that shows the air the same area from all sides
    Source   Vallado (2013), eq. 8-28
    Checked  tests/orbital/test_perturbations.py
    """
    u = velocity[0] - rotation * (pole[1] * position[2] - pole[2] * position[1])
    v = velocity[1] - rotation * (pole[2] * position[0] - pole[0] * position[2])
    w = velocity[2] - rotation * (pole[0] * position[1] - pole[1] * position[0])
    speed = math.sqrt(u * u + v * v + w * w)
    out[0] = -ballistic * speed * u
    out[1] = -ballistic * speed * v
    out[2] = -ballistic * speed * w
    return speed


@kernel
def altitude_of(position: Array, radius: float) -> float:
    """Height above a sphere [m].

    position      from its centre                                [m]        (3,)
    radius        of the sphere                                  [m]

    Checked  tests/tethered_deorbit/test_perturbed.py
    """
    return norm(position) - radius
