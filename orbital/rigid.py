"""The turning of a rigid body: its inertia, Euler's equations, and the torque of a central field. All in body axes."""

import math

from orbital.kernel import kernel
from orbital.vectors import Array


@kernel
def inertia_matrix(out: Array, moments: Array) -> None:
    """out = the symmetric matrix of inertia [kg m2].

    moments       I11, I22, I33, I12, I13, I23                   [kg m2]  (6,)
    out                                                          [kg m2]  (3, 3)

    The off-diagonal elements are those of the matrix, -integral of x y dm, not the products of inertia.

    Checked  tests/orbital/test_rigid.py
    """
    for i in range(3):
        out[i, i] = moments[i]
    out[0, 1] = moments[3]
    out[1, 0] = moments[3]
    out[0, 2] = moments[4]
    out[2, 0] = moments[4]
    out[1, 2] = moments[5]
    out[2, 1] = moments[5]


@kernel
def invert_symmetric(out: Array, matrix: Array) -> float:
    """Determinant of a symmetric matrix [unit^3]; out becomes its inverse [1/unit] (3, 3), unless that is zero.

    Valid    any; by cofactors
    Source   Cramer's rule
    Checked  tests/orbital/test_rigid.py
    """
    a, b, c = matrix[0, 0], matrix[1, 1], matrix[2, 2]
    d, e, f = matrix[0, 1], matrix[0, 2], matrix[1, 2]
    first, second, third = b * c - f * f, e * f - d * c, d * f - e * b
    determinant = a * first + d * second + e * third
    if determinant != 0.0:
        out[0, 0] = first / determinant
        out[1, 1] = (a * c - e * e) / determinant
        out[2, 2] = (a * b - d * d) / determinant
        out[0, 1] = second / determinant
        out[1, 0] = out[0, 1]
        out[0, 2] = third / determinant
        out[2, 0] = out[0, 2]
        out[1, 2] = (d * e - a * f) / determinant
        out[2, 1] = out[1, 2]
    return float(determinant)


@kernel
def extreme_moments(matrix: Array) -> tuple[float, float]:
    """Least and greatest principal moment of a symmetric matrix [unit].

        m + 2 p cos((phi + 2 pi k)/3),   m = tr/3,   p^2 = |A - m 1|^2/6,   cos phi = det(A - m 1)/(2 p^3)

    Valid    any symmetric matrix
    Source   Smith, Eigenvalues of a symmetric 3 x 3 matrix, Comm. ACM 4 (1961) 168
    Checked  tests/orbital/test_rigid.py
    """
    mean = (matrix[0, 0] + matrix[1, 1] + matrix[2, 2]) / 3.0
    a, b, c = matrix[0, 0] - mean, matrix[1, 1] - mean, matrix[2, 2] - mean
    d, e, f = matrix[0, 1], matrix[0, 2], matrix[1, 2]
    spread = math.sqrt((a * a + b * b + c * c + 2.0 * (d * d + e * e + f * f)) / 6.0)
    if spread == 0.0:
        return mean, mean
    determinant = a * (b * c - f * f) - d * (d * c - e * f) + e * (d * f - b * e)
    cosine = min(1.0, max(-1.0, determinant / (2.0 * spread * spread * spread)))
    angle = math.acos(cosine) / 3.0
    return mean + 2.0 * spread * math.cos(angle + 2.0 * math.pi / 3.0), mean + 2.0 * spread * math.cos(angle)


@kernel
def euler(out: Array, inertia: Array, inverse: Array, rate: Array, torque: Array) -> None:
    """out = rate of change of the body rate [rad/s^2].

        w' = I^-1 (tau - w x I w)

    inertia, inverse   I, I^-1  about the centre of mass         (3, 3)
    rate               w        relative to inertial space       [rad/s]  (3,)
    torque             tau                                       [N m]    (3,)

    Valid    out may be torque
    Source   Euler's equations
    Checked  tests/orbital/test_rigid.py, against Jacobi's elliptic functions
    """
    x, y, z = rate[0], rate[1], rate[2]
    u = inertia[0, 0] * x + inertia[0, 1] * y + inertia[0, 2] * z
    v = inertia[1, 0] * x + inertia[1, 1] * y + inertia[1, 2] * z
    w = inertia[2, 0] * x + inertia[2, 1] * y + inertia[2, 2] * z
    a = torque[0] - (y * w - z * v)
    b = torque[1] - (z * u - x * w)
    c = torque[2] - (x * v - y * u)
    for i in range(3):
        out[i] = inverse[i, 0] * a + inverse[i, 1] * b + inverse[i, 2] * c


@kernel
def gradient_torque(out: Array, inertia: Array, position: Array, strength: float) -> None:
    """out = torque of a central field on a small body [N m].

        tau = 3 mu/r^5 r x I r

    inertia       I      about the centre of mass                [kg m2]  (3, 3)
    position      r      of the centre of mass from that of the field, body axes   [m]  (3,)
    strength      3 mu/r^5                                       [1/(m2 s2)]

    Valid    bodies much smaller than r
    Source   Hughes, Spacecraft Attitude Dynamics (1986), section 8.1
    Checked  tests/orbital/test_rigid.py, against mass points in the field
    """
    x, y, z = position[0], position[1], position[2]
    u = inertia[0, 0] * x + inertia[0, 1] * y + inertia[0, 2] * z
    v = inertia[1, 0] * x + inertia[1, 1] * y + inertia[1, 2] * z
    w = inertia[2, 0] * x + inertia[2, 1] * y + inertia[2, 2] * z
    out[0] = strength * (y * w - z * v)
    out[1] = strength * (z * u - x * w)
    out[2] = strength * (x * v - y * u)


@kernel
def point_velocity(out: Array, turned: Array, rate: Array, point: Array) -> None:
    """out = velocity of a point of a body about its centre of mass, reference axes [m/s].

        b' = A (w x a)

    turned        A      body to reference                       [-]      (3, 3)
    rate          w      body axes                               [rad/s]  (3,)
    point         a      from the centre of mass, body axes      [m]      (3,)

    Source   a rigid body
    Checked  tests/orbital/test_rigid.py
    """
    x = rate[1] * point[2] - rate[2] * point[1]
    y = rate[2] * point[0] - rate[0] * point[2]
    z = rate[0] * point[1] - rate[1] * point[0]
    for i in range(3):
        out[i] = turned[i, 0] * x + turned[i, 1] * y + turned[i, 2] * z


@kernel
def point_acceleration(out: Array, turned: Array, rate: Array, change: Array, point: Array) -> None:
    """out = acceleration of a point of a body about its centre of mass, reference axes [m/s^2].

        b'' = A (w' x a + w x (w x a))

    change        w'     rate of w, body axes                    [rad/s2] (3,)
    The others as of `point_velocity`.

    Source   a rigid body
    Checked  tests/orbital/test_rigid.py
    """
    a, b, c = point[0], point[1], point[2]
    p, q, r = rate[0], rate[1], rate[2]
    u, v, w = q * c - r * b, r * a - p * c, p * b - q * a
    x = change[1] * c - change[2] * b + (q * w - r * v)
    y = change[2] * a - change[0] * c + (r * u - p * w)
    z = change[0] * b - change[1] * a + (p * v - q * u)
    for i in range(3):
        out[i] = turned[i, 0] * x + turned[i, 1] * y + turned[i, 2] * z
