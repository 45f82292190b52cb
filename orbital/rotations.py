"""Attitude as a unit quaternion, scalar first, turning body components into components of the reference frame.

    q = (w, x, y, z) = (cos(angle/2), axis sin(angle/2)),    v_reference = q v_body q*

Quaternions compose like matrices: multiply(p, q) turns first by q, then by p. The body rate is given in body axes, so
the kinematics read dq/dt = q (0, rate) / 2. Results go into `out`, which may be an operand.
"""

import math

from orbital import plain
from orbital.kernel import kernel
from orbital.vectors import Array


@kernel
def identity(out: Array) -> None:
    """out becomes the quaternion of no rotation, (1, 0, 0, 0).

    Checked  tests/orbital/test_rotations.py
    """
    out[0] = 1.0
    out[1] = 0.0
    out[2] = 0.0
    out[3] = 0.0


@kernel
def normalise(out: Array, q: Array) -> float:
    """Length of `q` before it was normalised [-]; out becomes q / |q|.

    A quaternion without length becomes the identity: an input never set is all zeros, and that must mean that no
    rotation is asked.

    Valid    lengths between 1e-150 and 1e150; a NaN stays one
    Checked  tests/orbital/test_rotations.py
    """
    length = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    if length == 0.0:
        identity(out)
    else:
        out[0] = q[0] / length
        out[1] = q[1] / length
        out[2] = q[2] / length
        out[3] = q[3] / length
    return length


@kernel
def conjugate(out: Array, q: Array) -> None:
    """out = q*, the inverse rotation of a unit quaternion.

    Checked  tests/orbital/test_rotations.py
    """
    out[0] = q[0]
    out[1] = -q[1]
    out[2] = -q[2]
    out[3] = -q[3]


@kernel
def multiply(out: Array, p: Array, q: Array) -> None:
    """out = p q, the Hamilton product: the rotation q followed by the rotation p.

    Source   Hamilton's convention, ij = k
    Checked  tests/orbital/test_rotations.py
    """
    w = p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3]
    x = p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2]
    y = p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1]
    z = p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0]
    out[0] = w
    out[1] = x
    out[2] = y
    out[3] = z


@kernel
def multiply_inverse(out: Array, p: Array, q: Array) -> None:
    """out = p* q: the rotation q as seen from the frame that p turns out of.

    With p and q both to the reference frame, the result turns from the body of q to the body of p.

    Valid    p a unit quaternion
    Source   Hamilton's product with p conjugated
    Checked  tests/orbital/test_rotations.py
    """
    w = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3]
    x = p[0] * q[1] - p[1] * q[0] - p[2] * q[3] + p[3] * q[2]
    y = p[0] * q[2] + p[1] * q[3] - p[2] * q[0] - p[3] * q[1]
    z = p[0] * q[3] - p[1] * q[2] + p[2] * q[1] - p[3] * q[0]
    out[0] = w
    out[1] = x
    out[2] = y
    out[3] = z


@kernel
def rotate(out: Array, q: Array, v: Array) -> None:
    """out = q v q*: body components turned into reference components [unit of v].

        t = 2 u x v,   out = v + w t + u x t,   q = (w, u)

    Valid    unit quaternions; an error of norm e changes the length by 2 e
    Source   the product q v q* written out with |q| = 1
    Checked  tests/orbital/test_rotations.py
    """
    _turn(out, q[0], q[1], q[2], q[3], v)


@kernel
def rotate_inverse(out: Array, q: Array, v: Array) -> None:
    """out = q* v q: reference components turned into body components [unit of v].

    Valid    as `rotate`
    Checked  tests/orbital/test_rotations.py
    """
    _turn(out, q[0], -q[1], -q[2], -q[3], v)


@kernel
def from_rotation_vector(out: Array, rotation: Array) -> None:
    """out = the quaternion of a rotation vector, the exact exponential map.

        w = cos(a/2),   u = rotation sin(a/2)/a,   a = |rotation|

    rotation      axis times angle                               [rad]  (3,)

    Below a = 1e-2 the quotient is its series, whose first neglected term is then under 3e-17.

    Valid    any angle; beyond 2 pi the turns are not kept
    Source   Sola, Quaternion kinematics for the error-state Kalman filter (2017), eq. 101
    Checked  tests/orbital/test_rotations.py
    """
    square = rotation[0] * rotation[0] + rotation[1] * rotation[1] + rotation[2] * rotation[2]
    if square < 1.0e-4:
        quotient = 0.5 - square / 48.0 + square * square / 3840.0
        w = 1.0 - square / 8.0 + square * square / 384.0
    else:
        angle = math.sqrt(square)
        quotient = math.sin(0.5 * angle) / angle
        w = math.cos(0.5 * angle)
    x = quotient * rotation[0]
    y = quotient * rotation[1]
    z = quotient * rotation[2]
    out[0] = w
    out[1] = x
    out[2] = y
    out[3] = z


@kernel
def evenly_turned(out: Array, rate: Array, time: float) -> None:
    """out = the quaternion of a turn at a constant rate for a time, by series that round alike everywhere.

        q = (cos h, w t sin(h)/(2 h)),   h = |w t|/2

    rate          w                                              [rad/s]  (3,)
    time          t                                              [s]

    Valid    |w t| <= 1: what is left out is below 1e-16
    Source   Sola (2017), eq. 101
    Checked  tests/orbital/test_rotations.py
    """
    x, y, z = 0.5 * time * rate[0], 0.5 * time * rate[1], 0.5 * time * rate[2]
    s = x * x + y * y + z * z
    # in pairs and fours, which a processor forms side by side: of one chain it would wait for every link
    t = s * s
    u = t * t
    c = (1.0 - s * (1.0 / 2.0)) + t * (1.0 / 24.0 - s * (1.0 / 720.0))
    c += u * ((1.0 / 40320.0 - s * (1.0 / 3628800.0)) + t * (1.0 / 479001600.0 - s * (1.0 / 87178291200.0)))
    d = (1.0 - s * (1.0 / 6.0)) + t * (1.0 / 120.0 - s * (1.0 / 5040.0))
    d += u * ((1.0 / 362880.0 - s * (1.0 / 39916800.0)) + t * (1.0 / 6227020800.0 - s * (1.0 / 1307674368000.0)))
    out[0] = c
    out[1] = d * x
    out[2] = d * y
    out[3] = d * z


@kernel
def turn_back(vector: Array, angle: float) -> None:
    """What stands still, seen in a frame that has turned by an angle about its third axis [rad], in place.

        tan(b/2) = angle/2,   vector turned by -b about (0, 0, 1)

    Valid    |angle| well below 1; b is short of it by angle^3 / 12
    Source   Cayley's map, which needs no trigonometry and so rounds alike everywhere
    Checked  tests/orbital/test_rotations.py
    """
    x = vector[0]
    y = vector[1]
    s = 2.0 / (1.0 + 0.25 * angle * angle)
    vector[0] = x + s * (0.5 * angle * y - 0.25 * angle * angle * x)
    vector[1] = y - s * (0.5 * angle * x + 0.25 * angle * angle * y)


@kernel
def turn_attitude_back(attitude: Array, angle: float) -> None:
    """The attitude of what stands still, seen in a frame that has turned as for `turn_back`, in place and normalised.

    Valid    as `turn_back`, and by the same angle to rounding
    Checked  tests/orbital/test_rotations.py
    """
    half = 0.5 * angle
    w, x, y, z = attitude[0], attitude[1], attitude[2], attitude[3]
    attitude[0] = w + half * z
    attitude[1] = x + half * y
    attitude[2] = y - half * x
    attitude[3] = z - half * w
    normalise(attitude, attitude)


@kernel
def to_rotation_vector(out: Array, q: Array) -> float:
    """Angle of the rotation [rad], 0 to pi; out becomes its rotation vector [rad].

        angle = 2 atan2(|u|, |w|),   out = u angle/|u|   (u reversed when w < 0, the shorter way)

    Valid    unit quaternions; at exactly pi the axis has either sign
    Source   inverse of `from_rotation_vector`
    Checked  tests/orbital/test_rotations.py
    """
    sign = -1.0 if q[0] < 0.0 else 1.0
    sine = math.sqrt(q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    angle = 2.0 * math.atan2(sine, sign * q[0])
    # A sine that underflows in its square still belongs to a rotation: there angle = 2 |u| makes the quotient 2.
    factor = 2.0 * sign if sine == 0.0 else sign * angle / sine
    x = factor * q[1]
    y = factor * q[2]
    z = factor * q[3]
    out[0] = x
    out[1] = y
    out[2] = z
    return angle


@kernel
def quaternion_rate(out: Array, q: Array, body_rate: Array) -> None:
    """out = dq/dt [1/s] of a body turning at `body_rate`.

        dq/dt = q (0, rate) / 2

    q                    body to reference                       [-]      (4,)
    body_rate     rate   of the body, in body axes               [rad/s]  (3,)

    Source   Sola (2017), section 4.4.1, time derivative with a local rate
    Checked  tests/orbital/test_rotations.py
    """
    x = 0.5 * body_rate[0]
    y = 0.5 * body_rate[1]
    z = 0.5 * body_rate[2]
    w_out = -q[1] * x - q[2] * y - q[3] * z
    x_out = q[0] * x + q[2] * z - q[3] * y
    y_out = q[0] * y - q[1] * z + q[3] * x
    z_out = q[0] * z + q[1] * y - q[2] * x
    out[0] = w_out
    out[1] = x_out
    out[2] = y_out
    out[3] = z_out


to_matrix = kernel(plain.to_matrix)


@kernel
def to_matrix_of_any_length(out: Array, q: Array) -> None:
    """out = the rotation matrix [-] (3, 3) of a quaternion that has kept its direction but not its length.

    q                    body to reference, scalar first         [-]      (4,)

    Valid    any length but zero
    Source   the product q v q*, over |q|^2
    Checked  tests/orbital/test_rotations.py
    """
    w, x, y, z = q[0], q[1], q[2], q[3]
    s = 2.0 / (w * w + x * x + y * y + z * z)
    out[0, 0] = 1.0 - s * (y * y + z * z)
    out[1, 1] = 1.0 - s * (x * x + z * z)
    out[2, 2] = 1.0 - s * (x * x + y * y)
    out[0, 1] = s * (x * y - w * z)
    out[1, 0] = s * (x * y + w * z)
    out[0, 2] = s * (x * z + w * y)
    out[2, 0] = s * (x * z - w * y)
    out[1, 2] = s * (y * z - w * x)
    out[2, 1] = s * (y * z + w * x)


@kernel
def from_matrix(out: Array, matrix: Array) -> None:
    """out = the unit quaternion [-] of a rotation matrix, with w >= 0.

    The largest of the four components is taken from the diagonal, so that nothing small is divided by.

    Valid    proper rotations; a matrix slightly off orthogonality gives the nearby normalised quaternion
    Source   Shepperd, Quaternion from rotation matrix, J. Guidance and Control 1 (1978) 223
    Checked  tests/orbital/test_rotations.py
    """
    m00, m11, m22 = matrix[0, 0], matrix[1, 1], matrix[2, 2]
    trace = m00 + m11 + m22
    if trace >= m00 and trace >= m11 and trace >= m22:
        out[0] = 1.0 + trace
        out[1] = matrix[2, 1] - matrix[1, 2]
        out[2] = matrix[0, 2] - matrix[2, 0]
        out[3] = matrix[1, 0] - matrix[0, 1]
    elif m00 >= m11 and m00 >= m22:
        out[0] = matrix[2, 1] - matrix[1, 2]
        out[1] = 1.0 + m00 - m11 - m22
        out[2] = matrix[0, 1] + matrix[1, 0]
        out[3] = matrix[0, 2] + matrix[2, 0]
    elif m11 >= m22:
        out[0] = matrix[0, 2] - matrix[2, 0]
        out[1] = matrix[0, 1] + matrix[1, 0]
        out[2] = 1.0 - m00 + m11 - m22
        out[3] = matrix[1, 2] + matrix[2, 1]
    else:
        out[0] = matrix[1, 0] - matrix[0, 1]
        out[1] = matrix[0, 2] + matrix[2, 0]
        out[2] = matrix[1, 2] + matrix[2, 1]
        out[3] = 1.0 - m00 - m11 + m22
    normalise(out, out)
    if out[0] < 0.0:
        out[0] = -out[0]
        out[1] = -out[1]
        out[2] = -out[2]
        out[3] = -out[3]


@kernel
def _turn(out: Array, w: float, x: float, y: float, z: float, v: Array) -> None:
    """out = v turned by the unit quaternion (w, x, y, z) [unit of v] (3,); see `rotate`.

        v + w t + u x t,   t = 2 u x v,   u = (x, y, z)

    Checked  tests/orbital/test_rotations.py
    """
    v0, v1, v2 = v[0], v[1], v[2]
    t0 = 2.0 * (y * v2 - z * v1)
    t1 = 2.0 * (z * v0 - x * v2)
    t2 = 2.0 * (x * v1 - y * v0)
    out[0] = v0 + w * t0 + (y * t2 - z * t1)
    out[1] = v1 + w * t1 + (z * t0 - x * t2)
    out[2] = v2 + w * t2 + (x * t1 - y * t0)
