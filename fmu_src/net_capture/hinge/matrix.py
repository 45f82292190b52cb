"""The masses of two bodies on a hinge, as one matrix, and what their momenta make of them: see `motion`."""

from __future__ import annotations

from fmu_src.net_capture.hinge.numbers import ARM, AXIS, HINGE, INERTIA, REST, REST_INERTIA, SHARE
from orbital.kernel import kernel
from orbital.rotations import rotate_inverse
from orbital.vectors import cross, dot

NUMBER = 9
"""Of what is integrated: attitude (4), cosine and sine, angle, its momentum, what the dashpot took."""


@kernel
def turned(out, axis, c, s, v):
    """out = a vector turned about a unit axis by the angle with this cosine and sine: c v + s e x v + (1 - c) e.v e.

    Source   Rodrigues' formula
    Checked  tests/net_capture/test_hinge.py
    """
    along = (1.0 - c) * (axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2])
    x = c * v[0] + s * (axis[1] * v[2] - axis[2] * v[1]) + along * axis[0]
    y = c * v[1] + s * (axis[2] * v[0] - axis[0] * v[2]) + along * axis[1]
    z = c * v[2] + s * (axis[0] * v[1] - axis[1] * v[0]) + along * axis[2]
    out[0] = x
    out[1] = y
    out[2] = z


@kernel
def times(out, matrix, v):
    """out = matrix times vector (3,), symmetric; not in place.

    Checked  tests/net_capture/test_hinge.py
    """
    for i in range(3):
        out[i] = matrix[i, 0] * v[0] + matrix[i, 1] * v[1] + matrix[i, 2] * v[2]


@kernel
def assemble(p, body, c, s):
    """Matrix of the masses and its inverse at the angle with this cosine and sine; r, s and the turned inertia beside.

    Checked  tests/net_capture/test_hinge.py
    """
    axis, arm, slope, room = body[AXIS : AXIS + 3], p.hinge_room[0], p.hinge_room[1], p.hinge_room[2]
    own, whole, small, inverse = p.hinge_own, p.hinge_whole, p.hinge_small, p.hinge_inverse
    turned(room, axis, c, s, body[ARM : ARM + 3])
    cross(slope, axis, room)
    for i in range(3):
        arm[i] = body[HINGE + i] + room[i] - body[REST + i]
    # R I R': turn the columns, then the rows
    for j in range(3):
        for i in range(3):
            room[i] = p.target_mass * body[INERTIA + 3 * i + j]
        turned(room, axis, c, s, room)
        for i in range(3):
            own[i, j] = room[i]
    for i in range(3):
        turned(own[i], axis, c, s, own[i])
    reduced = p.target_mass * body[SHARE] * (1.0 - body[SHARE])
    square = dot(arm, arm)
    for i in range(3):
        for j in range(3):
            whole[i, j] = p.target_mass * body[REST_INERTIA + 3 * i + j] + own[i, j] - reduced * arm[i] * arm[j]
        whole[i, i] += reduced * square
    coupling, eased = p.hinge_coupling, p.hinge_eased
    times(coupling, own, axis)
    own_moment = dot(axis, coupling) + reduced * dot(slope, slope)
    cross(room, arm, slope)
    for i in range(3):
        coupling[i] += reduced * room[i]
    for i in range(3):
        a, b = (i + 1) % 3, (i + 2) % 3
        for j in range(3):
            k, m = (j + 1) % 3, (j + 2) % 3
            small[j, i] = whole[a, k] * whole[b, m] - whole[a, m] * whole[b, k]
    volume = whole[0, 0] * small[0, 0] + whole[0, 1] * small[1, 0] + whole[0, 2] * small[2, 0]
    for i in range(3):
        for j in range(3):
            small[i, j] /= volume
    times(eased, small, coupling)
    light = 1.0 / (own_moment - dot(coupling, eased))
    for i in range(3):
        for j in range(3):
            inverse[i, j] = small[i, j] + light * eased[i] * eased[j]
        inverse[i, 3] = -light * eased[i]
        inverse[3, i] = inverse[i, 3]
    inverse[3, 3] = light


@kernel
def take_rates(p, attitude, momentum):
    """Rate of the rest in its axes, and of the hinge, into `hinge_rates` [rad/s], from the momenta.

    momentum      of the hinge                                  [N m s]

    Checked  tests/net_capture/test_hinge.py
    """
    rates, spin, inverse = p.hinge_rates, p.hinge_room[3], p.hinge_inverse
    rotate_inverse(spin, attitude, p.target_spin)
    for i in range(4):
        rates[i] = inverse[i, 3] * momentum
        for j in range(3):
            rates[i] += inverse[i, j] * spin[j]


@kernel
def find_lean(p, body, up):
    """Moment of a central field on the hinge over 3 mu/r^3 [kg m2], at the angle that `assemble` was last told.

        V = (3/2) mu/r^3 (u.I u - tr I/3),   I = I1 + R I2 R' + m (r.r 1 - r r')
        -dV/dq = -3 mu/r^3 (u.(e x I2 u) + m (r.s/3 - (u.r)(u.s)))

    up            u      from the middle of the field to the centre of mass, body axes   [-]   (3,)
    m             the reduced mass of both bodies; r, s, e, I2 as in `motion`

    Valid    bodies much smaller than r
    Source   derivative of the potential of Hughes, Spacecraft Attitude Dynamics (1986), section 8.1
    Checked  tests/net_capture/test_hinged_gradient.py
    """
    arm, slope, moving, turning = p.hinge_room[0], p.hinge_room[1], p.hinge_room[2], p.hinge_room[3]
    times(moving, p.hinge_own, up)
    cross(turning, body[AXIS : AXIS + 3], moving)
    reduced = p.target_mass * body[SHARE] * (1.0 - body[SHARE])
    return -dot(up, turning) - reduced * (dot(arm, slope) / 3.0 - dot(up, arm) * dot(up, slope))


@kernel
def derive(p, body, y, out):
    """out = rates of what is integrated, (9,), see `NUMBER`; those of now are left in `hinge_rates`.

    Checked  tests/net_capture/test_hinge.py
    """
    assemble(p, body, y[4], y[5])
    take_rates(p, y[0:4], y[7])
    w, speed, axis = p.hinge_rates[0:3], p.hinge_rates[3], body[AXIS : AXIS + 3]
    arm, slope, own = p.hinge_room[0], p.hinge_room[1], p.hinge_own
    turning, moving, other = p.hinge_room[2], p.hinge_room[3], p.hinge_room[4]
    out[0] = -0.5 * (y[1] * w[0] + y[2] * w[1] + y[3] * w[2])
    out[1] = 0.5 * (y[0] * w[0] + y[2] * w[2] - y[3] * w[1])
    out[2] = 0.5 * (y[0] * w[1] + y[3] * w[0] - y[1] * w[2])
    out[3] = 0.5 * (y[0] * w[2] + y[1] * w[1] - y[2] * w[0])
    out[4] = -y[5] * speed
    out[5] = y[4] * speed
    out[6] = speed
    for i in range(3):
        turning[i] = w[i] + speed * axis[i]
    times(moving, own, turning)
    cross(other, axis, moving)
    pull = dot(turning, other)
    cross(moving, w, arm)
    cross(turning, w, slope)
    cross(other, axis, slope)
    reduced = p.target_mass * body[SHARE] * (1.0 - body[SHARE])
    for i in range(3):
        pull += reduced * (moving[i] + speed * slope[i]) * (turning[i] + speed * other[i])
    out[7] = pull - p.hinge_stiffness * y[6] - p.hinge_damping * speed
    out[8] = p.hinge_damping * speed * speed
