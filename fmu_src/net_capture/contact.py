"""Contact of nodes with the target: an envelope first, then the surface, then an inelastic impulse (law A).

A node may not come closer than the surface by the end of the substep: an impulse along the outward normal raises its
normal velocity relative to the surface point to what still lands on the surface, or to the restitution's share. The
target takes the opposite impulse at the same point, so linear and angular momentum are kept to rounding, and the loss
of kinetic energy is booked exactly.
"""

from fmu_src.net_capture.shapes import box_distance, box_radius
from fmu_src.net_capture.topology import (
    CHUNK,
    FX,
    FY,
    FZ,
    INVERSE_MASS,
    MASS,
    U,
    V,
    W,
    X,
    Y,
    Z,
    chunk_scratch,
    gather,
    node_plane,
)
from orbital.kernel import kernel
from orbital.rotations import rotate_inverse, to_matrix
from orbital.vectors import cross, dot

FASTEST = 200.0
"""Speed [m/s] between node and surface up to which the second level of the search misses no contact."""
RECOVERY_SPEED = 0.01
"""Speed [m/s] at which a node found below the surface is brought back: small against any impact, so it adds no
energy."""


@kernel
def find_near(x, y, z, cx, cy, cz, squared):
    """How many nodes of a chunk lie within the envelope."""
    near = 0
    for j in range(x.size):
        dx = x[j] - cx
        dy = y[j] - cy
        dz = z[j] - cz
        near += 1 if dx * dx + dy * dy + dz * dz < squared else 0
    return near


@kernel
def find_close(closeness, x, y, z, cx, cy, cz, turn, half, margin):
    """Write for each node of a chunk by how much it lies within the box widened by a margin [m]; return how many do."""
    hx = half[0] + margin
    hy = half[1] + margin
    hz = half[2] + margin
    a = turn[0, 0]
    b = turn[0, 1]
    c = turn[0, 2]
    d = turn[1, 0]
    e = turn[1, 1]
    f = turn[1, 2]
    g = turn[2, 0]
    h = turn[2, 1]
    k = turn[2, 2]
    close = 0
    for j in range(closeness.size):
        dx = x[j] - cx
        dy = y[j] - cy
        dz = z[j] - cz
        u = hx - abs(a * dx + d * dy + g * dz)
        v = hy - abs(b * dx + e * dy + h * dz)
        w = hz - abs(c * dx + f * dy + k * dz)
        least = u if u < v else v
        least = least if least < w else w
        closeness[j] = least
        close += 1 if least > 0.0 else 0
    return close


@kernel
def take_rate(p, frame_rate):
    """Angular velocity of the target relative to the frame, frame axes, from its angular momentum."""
    turn = p.target_turn
    for i in range(3):
        p.target_omega[i] = 0.0
    for k in range(3):
        spin = turn[0, k] * p.target_spin[0] + turn[1, k] * p.target_spin[1] + turn[2, k] * p.target_spin[2]
        rate = spin / p.target_inertia[k]
        for i in range(3):
            p.target_omega[i] += turn[i, k] * rate
    p.target_omega[2] -= frame_rate


@kernel
def touch_nodes(p, work, start, n, frame_rate, h):
    """Give one chunk of nodes the impulses of contact, after the kick and before the drift."""
    stop = start + n
    x = node_plane(p, work, X)[start:stop]
    y = node_plane(p, work, Y)[start:stop]
    z = node_plane(p, work, Z)[start:stop]
    c = p.target_place
    if find_near(x, y, z, c[0], c[1], c[2], p.envelope_radius * p.envelope_radius) > 0:
        scratch = chunk_scratch(p, work)
        closeness = scratch[0:n]
        lanes = scratch[CHUNK : 2 * CHUNK]
        to_matrix(p.target_turn, p.target_pose)
        found = find_close(closeness, x, y, z, c[0], c[1], c[2], p.target_turn, p.half_size, FASTEST * h)
        if found > 0:
            take_rate(p, frame_rate)
            gather(lanes, closeness)
            for i in range(found):
                touch(p, work, start + int(lanes[i]), frame_rate, h)


@kernel
def touch(p, work, node, frame_rate, h):
    """Impulse between one node and the box, if it would otherwise end the substep below the surface."""
    inverse = node_plane(p, work, INVERSE_MASS)[node]
    if inverse == 0.0:
        return
    u = node_plane(p, work, U)
    v = node_plane(p, work, V)
    w = node_plane(p, work, W)
    arm = p.scratch[13:16]
    body = p.scratch[16:19]
    local = p.scratch[19:22]
    normal = p.scratch[22:25]
    lever = p.scratch[25:28]
    turn = p.target_turn
    omega = p.target_omega
    arm[0] = node_plane(p, work, X)[node] - p.target_place[0]
    arm[1] = node_plane(p, work, Y)[node] - p.target_place[1]
    arm[2] = node_plane(p, work, Z)[node] - p.target_place[2]
    for i in range(3):
        body[i] = turn[0, i] * arm[0] + turn[1, i] * arm[1] + turn[2, i] * arm[2]
    gap = box_distance(local, body, p.half_size)
    for i in range(3):
        normal[i] = turn[i, 0] * local[0] + turn[i, 1] * local[1] + turn[i, 2] * local[2]
    approach = (
        normal[0] * (u[node] - p.target_velocity[0] - (omega[1] * arm[2] - omega[2] * arm[1]))
        + normal[1] * (v[node] - p.target_velocity[1] - (omega[2] * arm[0] - omega[0] * arm[2]))
        + normal[2] * (w[node] - p.target_velocity[2] - (omega[0] * arm[1] - omega[1] * arm[0]))
    )
    if gap + h * approach >= 0.0:
        return
    wanted = -gap / h
    if wanted > RECOVERY_SPEED:
        wanted = RECOVERY_SPEED
    if approach < 0.0 and -p.contact_restitution * approach > wanted:
        wanted = -p.contact_restitution * approach
    if wanted <= approach:
        return
    # inverse of the mass the impulse feels: node, target, and the target's turning
    cross(lever, body, local)
    feel = inverse + 1.0 / p.target_mass
    for i in range(3):
        feel += lever[i] * lever[i] / p.target_inertia[i]
    impulse = (wanted - approach) / feel
    p.contact_impulse += impulse
    # work of the impulse over the mean of the relative normal velocities before the kick of this substep and after
    kicked = (
        node_plane(p, work, FX)[node] * normal[0]
        + node_plane(p, work, FY)[node] * normal[1]
        + node_plane(p, work, FZ)[node] * normal[2]
    )
    p.contact_loss -= impulse * 0.5 * (wanted + approach - h * inverse * kicked)
    u[node] += impulse * inverse * normal[0]
    v[node] += impulse * inverse * normal[1]
    w[node] += impulse * inverse * normal[2]
    cross(lever, arm, normal)
    for i in range(3):
        p.target_velocity[i] -= impulse / p.target_mass * normal[i]
        p.target_spin[i] -= impulse * lever[i]
    take_rate(p, frame_rate)
    if p.contact_first_time < 0.0:
        p.contact_first_time = p.start_time + p.grid * p.solver_substep


@kernel
def start_contact(p):
    """Clear the contact ledger; take the envelope from the target's size."""
    for i in range(3):
        p.half_size[i] = 0.5 * p.target_size[i]
    p.envelope_radius = box_radius(p.half_size) + 0.05
    p.contact_first_time = -1.0
    p.contact_impulse = 0.0
    p.contact_loss = 0.0


@kernel
def measure_contact(p, work):
    """Count the nodes on the surface (within a millimetre)."""
    x = node_plane(p, work, X)
    y = node_plane(p, work, Y)
    z = node_plane(p, work, Z)
    mass = node_plane(p, work, MASS)
    arm = p.scratch[13:16]
    normal = p.scratch[19:22]
    count = 0
    for i in range(x.size):
        arm[0] = x[i] - p.target_place[0]
        arm[1] = y[i] - p.target_place[1]
        arm[2] = z[i] - p.target_place[2]
        if mass[i] > 0.0 and dot(arm, arm) < p.envelope_radius * p.envelope_radius:
            rotate_inverse(arm, p.target_pose, arm)
            if box_distance(normal, arm, p.half_size) < 1e-3:
                count += 1
    p.contact_nodes = count


@kernel
def inside(p, work):
    """How many nodes lie inside the target [count], for the check of the start."""
    x = node_plane(p, work, X)
    y = node_plane(p, work, Y)
    z = node_plane(p, work, Z)
    arm = p.scratch[13:16]
    normal = p.scratch[19:22]
    count = 0
    for i in range(x.size):
        arm[0] = x[i] - p.target_place[0]
        arm[1] = y[i] - p.target_place[1]
        arm[2] = z[i] - p.target_place[2]
        rotate_inverse(arm, p.target_pose, arm)
        if box_distance(normal, arm, p.half_size) <= 0.0:
            count += 1
    return count
