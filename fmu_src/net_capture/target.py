"""The target: a free rigid box. Its state is position, velocity, attitude and angular momentum in the frame's axes.

Between impulses the angular momentum about the centre of mass is constant (it only turns with the frame), and so it is
the state, not the rate; the attitude follows by a midpoint step with a Cayley map, which needs no trigonometry and so
gives the same bits on every platform.
"""

from fmu_src.net_capture.interface import NO_INERTIA, NO_QUATERNION
from fmu_src.net_capture.shapes import box_girth
from orbital.kernel import kernel
from orbital.rotations import normalise, rotate, rotate_inverse
from orbital.vectors import dot


@kernel
def place_target(p):
    """Put the target into its start attitude and rate at the origin; return a fault code or 0."""
    size = p.target_size
    principal = p.target_inertia
    total = 0.0
    for i in range(3):
        total += abs(p.target_principal_inertia[i])
    for i in range(3):
        a = size[(i + 1) % 3]
        b = size[(i + 2) % 3]
        principal[i] = p.target_mass * (a * a + b * b) / 12.0 if total == 0.0 else p.target_principal_inertia[i]
    for i in range(3):
        if principal[i] <= 0.0 or principal[i] > (principal[(i + 1) % 3] + principal[(i + 2) % 3]) * (1.0 + 1e-12):
            return NO_INERTIA
    squared = 0.0
    for i in range(4):
        p.target_pose[i] = p.target_start_attitude[i]
        squared += p.target_start_attitude[i] * p.target_start_attitude[i]
    if squared == 0.0:
        p.target_pose[0] = 1.0
    elif abs(squared - 1.0) > 1e-6:
        return NO_QUATERNION
    normalise(p.target_pose, p.target_pose)
    for i in range(3):
        p.target_place[i] = 0.0
        p.target_drift[i] = 0.0
        p.target_rate[i] = p.target_start_rate[i]
        p.scratch[i] = principal[i] * p.target_start_rate[i]
    rotate(p.target_spin, p.target_pose, p.scratch[0:3])
    p.girth = box_girth(size)
    return 0


@kernel
def rate_from_spin(p, out, attitude):
    """out = body rate relative to inertial space, body axes [rad/s], from the angular momentum."""
    rotate_inverse(out, attitude, p.target_spin)
    for i in range(3):
        out[i] /= p.target_inertia[i]


@kernel
def turn(out, attitude, rate, p, frame_rate, h):
    """out = attitude after h [s] at a body rate, seen in a frame that turns about its third axis.

        q' = q (1, h w / 2) / sqrt(1 + |h w|^2 / 4),   w = rate - R^T (0, 0, frame_rate)

    Valid    |h w| well below 1; the angle is short of h w by its (h w)^2 / 12
    """
    frame = p.scratch[6:9]
    frame[0] = 0.0
    frame[1] = 0.0
    frame[2] = frame_rate
    rotate_inverse(frame, attitude, frame)
    x = 0.5 * h * (rate[0] - frame[0])
    y = 0.5 * h * (rate[1] - frame[1])
    z = 0.5 * h * (rate[2] - frame[2])
    a = attitude[0]
    b = attitude[1]
    c = attitude[2]
    d = attitude[3]
    out[0] = a - b * x - c * y - d * z
    out[1] = b + a * x + c * z - d * y
    out[2] = c + a * y + d * x - b * z
    out[3] = d + a * z + b * y - c * x
    normalise(out, out)


@kernel
def drift_target(p, frame_rate, h):
    """Move and turn the target by one substep with its momenta held."""
    for i in range(3):
        p.target_place[i] += h * p.target_drift[i]
    half = p.scratch[9:13]
    rate = p.scratch[0:3]
    rate_from_spin(p, rate, p.target_pose)
    turn(half, p.target_pose, rate, p, frame_rate, 0.5 * h)
    rate_from_spin(p, rate, half)
    turn(p.target_pose, p.target_pose, rate, p, frame_rate, h)
    # the angular momentum is constant in inertial space, so it turns backwards in the frame
    angle = frame_rate * h
    x = p.target_spin[0]
    y = p.target_spin[1]
    s = 2.0 / (1.0 + 0.25 * angle * angle)
    p.target_spin[0] = x + s * (0.5 * angle * y - 0.25 * angle * angle * x)
    p.target_spin[1] = y - s * (0.5 * angle * x + 0.25 * angle * angle * y)


@kernel
def measure_target(p):
    """Rate and energy of the target from its momenta."""
    rate_from_spin(p, p.target_rate, p.target_pose)
    energy = 0.5 * p.target_mass * dot(p.target_velocity, p.target_velocity)
    for i in range(3):
        energy += 0.5 * p.target_inertia[i] * p.target_rate[i] * p.target_rate[i]
    p.target_energy = energy
