"""The orbital frame: axis 1 radial outward, 2 along-track, 3 cross-track, and its way to and from the inertial frame.

The rows of the basis C are the three axes in inertial components, so v_orbital = C v_inertial. The frame turns about
its third axis at h/r^2, and velocities given in it are those seen by an observer who turns with it. Relative vectors
(chaser minus target, metres) are transformed as such and never by way of two geocentric positions: one ulp of the
radius, 0.9 nm at 800 km, times the stiffness of the Table 2 tether is already 3.7e-6 N of a towing tension of 0.026 N.
"""

import math

from orbital.kernel import kernel
from orbital.rotations import conjugate, from_matrix, multiply, multiply_inverse
from orbital.vectors import Array, add, cross, dot, matrix_vector, norm, subtract, transposed_matrix_vector, unit


@kernel
def orbital_basis(out: Array, position: Array, velocity: Array) -> float:
    """Angular rate of the orbital frame [rad/s]; out becomes its basis [-] (3, 3), one axis per row.

        e1 = r/|r|,   e3 = (r x v)/|r x v|,   e2 = e3 x e1

    On a circular orbit e2 is the direction of the velocity. On a vertical line there is no orbital plane: the rows are
    then zero where undefined, and the rate returned is zero.

    position      r      of the frame's origin, inertial         [m]    (3,)
    velocity      v      of the frame's origin, inertial         [m/s]  (3,)

    Valid    r and v not parallel
    Source   the frame of Clohessy and Wiltshire, J. Aerospace Sciences 27 (1960) 653
    Checked  tests/orbital/test_frames.py
    """
    radial, along, normal = out[0], out[1], out[2]
    cross(normal, position, velocity)
    # The same rounding as in orbital_rate, so that the two can never disagree.
    rate = norm(normal) / dot(position, position)
    unit(normal, normal)
    unit(radial, position)
    cross(along, normal, radial)
    unit(along, along)
    return rate


@kernel
def orbital_rate(position: Array, velocity: Array) -> float:
    """Angular rate of the orbital frame about its third axis [rad/s].

        h / r^2 = |r x v| / r^2

    position      r      of the frame's origin, inertial         [m]    (3,)
    velocity      v      of the frame's origin, inertial         [m/s]  (3,)

    Valid    central forces; a force f_n out of the plane adds a rate r f_n / h about axis 1, left out here
    Source   conservation of areas; on a circular orbit it is the mean motion
    Checked  tests/orbital/test_frames.py
    """
    x = position[1] * velocity[2] - position[2] * velocity[1]
    y = position[2] * velocity[0] - position[0] * velocity[2]
    z = position[0] * velocity[1] - position[1] * velocity[0]
    return math.sqrt(x * x + y * y + z * z) / dot(position, position)


@kernel
def relative_to_inertial(
    position_out: Array, velocity_out: Array, basis: Array, rate: float, position: Array, velocity: Array
) -> None:
    """A relative state from the turning orbital frame to inertial axes [m, m/s].

        position_out = C^T rho,   velocity_out = C^T (v + w x rho),   w = (0, 0, rate)

    basis         C      of the frame, from `orbital_basis`      [-]      (3, 3)
    rate                 of the frame about axis 3               [rad/s]
    position      rho    relative position, orbital frame        [m]      (3,)
    velocity      v      as seen in the turning frame            [m/s]    (3,)

    Valid    any size; the way there and back closes to 1e-15
    Source   derivative of a vector in a rotating frame
    Checked  tests/orbital/test_frames.py
    """
    velocity_out[0] = velocity[0] - rate * position[1]
    velocity_out[1] = velocity[1] + rate * position[0]
    velocity_out[2] = velocity[2]
    transposed_matrix_vector(velocity_out, basis, velocity_out)
    transposed_matrix_vector(position_out, basis, position)


@kernel
def relative_to_orbital(
    position_out: Array, velocity_out: Array, basis: Array, rate: float, position: Array, velocity: Array
) -> None:
    """A relative state from inertial axes to the turning orbital frame [m, m/s].

        position_out = C rho,   velocity_out = C v - w x (C rho),   w = (0, 0, rate)

    basis         C      of the frame, from `orbital_basis`      [-]      (3, 3)
    rate                 of the frame about axis 3               [rad/s]
    position      rho    relative position, inertial axes        [m]      (3,)
    velocity      v      relative velocity, inertial             [m/s]    (3,)

    Valid    any size; the way there and back closes to 1e-15
    Source   inverse of `relative_to_inertial`
    Checked  tests/orbital/test_frames.py
    """
    matrix_vector(velocity_out, basis, velocity)
    matrix_vector(position_out, basis, position)
    velocity_out[0] = velocity_out[0] + rate * position_out[1]
    velocity_out[1] = velocity_out[1] - rate * position_out[0]


@kernel
def state_to_inertial(
    position_out: Array,
    velocity_out: Array,
    origin_position: Array,
    origin_velocity: Array,
    basis: Array,
    rate: float,
    position: Array,
    velocity: Array,
) -> None:
    """A state in the orbital frame to inertial position and velocity about the Earth's centre [m, m/s].

        r = R + C^T rho,   v = V + C^T (v_rot + w x rho)

    origin_position  R   of the frame's origin, inertial         [m]    (3,)
    origin_velocity  V   of the frame's origin, inertial         [m/s]  (3,)
    The others as in `relative_to_inertial`.

    Valid    absolute states only: adding R costs the last nanometre, so relative motion is never read off two of these
    Source   as `relative_to_inertial`
    Checked  tests/orbital/test_frames.py
    """
    relative_to_inertial(position_out, velocity_out, basis, rate, position, velocity)
    add(position_out, origin_position, position_out)
    add(velocity_out, origin_velocity, velocity_out)


@kernel
def state_to_orbital(
    position_out: Array,
    velocity_out: Array,
    origin_position: Array,
    origin_velocity: Array,
    basis: Array,
    rate: float,
    position: Array,
    velocity: Array,
) -> None:
    """An inertial state about the Earth's centre to the orbital frame [m, m/s].

        rho = C (r - R),   v_rot = C (v - V) - w x rho

    origin_position  R   of the frame's origin, inertial         [m]    (3,)
    origin_velocity  V   of the frame's origin, inertial         [m/s]  (3,)
    position         r   of the body, inertial                   [m]    (3,)
    velocity         v   of the body, inertial                   [m/s]  (3,)
    The others as in `relative_to_orbital`.

    Valid    the difference carries the rounding of r and R, about a nanometre in low orbit
    Source   inverse of `state_to_inertial`
    Checked  tests/orbital/test_frames.py
    """
    subtract(position_out, position, origin_position)
    subtract(velocity_out, velocity, origin_velocity)
    relative_to_orbital(position_out, velocity_out, basis, rate, position_out, velocity_out)


@kernel
def orbital_quaternion(out: Array, basis: Array) -> None:
    """out = the unit quaternion [-] (4,) that turns orbital components into inertial ones.

    basis         C      of the frame, from `orbital_basis`      [-]    (3, 3)

    Valid    right-handed orthonormal rows
    Source   `rotations.from_matrix` of C, conjugated, since C turns the other way
    Checked  tests/orbital/test_frames.py
    """
    from_matrix(out, basis)
    conjugate(out, out)


@kernel
def attitude_to_inertial(out: Array, orbital_quaternion: Array, attitude: Array) -> None:
    """out = attitude, body to inertial frame [-] (4,), of a body given in the orbital frame.

        q_inertial = q_frame q

    orbital_quaternion  q_frame  orbital to inertial frame       [-]    (4,)
    attitude            q        body to orbital frame           [-]    (4,)

    The body rate needs no transformation: it is relative to inertial space, in body axes, on both sides.

    Valid    unit quaternions
    Source   composition of rotations
    Checked  tests/orbital/test_frames.py
    """
    multiply(out, orbital_quaternion, attitude)


@kernel
def attitude_to_orbital(out: Array, orbital_quaternion: Array, attitude: Array) -> None:
    """out = attitude, body to orbital frame [-] (4,), of a body given in the inertial frame.

        q = q_frame* q_inertial

    orbital_quaternion  q_frame     orbital to inertial frame    [-]    (4,)
    attitude            q_inertial  body to inertial frame       [-]    (4,)

    Valid    unit quaternions
    Source   inverse of `attitude_to_inertial`
    Checked  tests/orbital/test_frames.py
    """
    multiply_inverse(out, orbital_quaternion, attitude)
