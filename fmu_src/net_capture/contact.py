"""Contact of nodes with the target: an envelope first, then the surface, then an inelastic impulse (law A).

A node may not come closer than the surface by the end of the substep: an impulse along the outward normal raises its
normal velocity relative to the surface point to what still lands on the surface, or to the restitution's share. The
target takes the opposite impulse at the same point, so linear and angular momentum are kept to rounding, and the loss
of kinetic energy is booked exactly.

The nodes have drifted already when they are looked at, so both levels of the search follow their way through the whole
substep, however fast they are: no node passes unseen.
"""

import math

from fmu_src.net_capture.shapes import box_distance, box_radius
from fmu_src.net_capture.topology import (
    CHUNK,
    INVERSE_MASS,
    MASS,
    P,
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

RECOVERY_SPEED = 0.01
"""Speed [m/s] at which a node found below the surface is brought back: small against any impact, so it adds no
energy."""

ON_SURFACE = 1e-3
"""Distance [m] up to which a node counts as on the surface."""


@kernel
def find_near(x, y, z, u, v, w, cx, cy, cz, radius, h):
    """How many nodes of a chunk may have been within a sphere during the substep that ends at these positions.

    The way's middle is within radius + |h u|/2 if any of it is within the radius; (a + b)^2 <= 2 a^2 + 2 b^2 spares the
    root.
    """
    half = 0.5 * h
    within = 2.0 * radius * radius
    near = 0
    for j in range(x.size):
        a = half * u[j]
        b = half * v[j]
        c = half * w[j]
        dx = x[j] - a - cx
        dy = y[j] - b - cy
        dz = z[j] - c - cz
        near += 1 if dx * dx + dy * dy + dz * dz - 2.0 * (a * a + b * b + c * c) < within else 0
    return near


@kernel
def find_close(closeness, x, y, z, u, v, w, cx, cy, cz, turn, half_size, margin, h):
    """Write for each node of a chunk by how much its way through the substep lies within the box widened by a margin
    [m]; return how many do.

    The way's extent along each axis of the box counts, so a way past a corner may be taken for one through it.
    """
    hx = half_size[0] + margin
    hy = half_size[1] + margin
    hz = half_size[2] + margin
    half = 0.5 * h
    a = turn[0, 0]
    b = turn[0, 1]
    c = turn[0, 2]
    d = turn[1, 0]
    e = turn[1, 1]
    f = turn[1, 2]
    g = turn[2, 0]
    i = turn[2, 1]
    k = turn[2, 2]
    close = 0
    for j in range(closeness.size):
        sx = half * u[j]
        sy = half * v[j]
        sz = half * w[j]
        dx = x[j] - sx - cx
        dy = y[j] - sy - cy
        dz = z[j] - sz - cz
        p = hx + abs(a * sx + d * sy + g * sz) - abs(a * dx + d * dy + g * dz)
        q = hy + abs(b * sx + e * sy + i * sz) - abs(b * dx + e * dy + i * dz)
        r = hz + abs(c * sx + f * sy + k * sz) - abs(c * dx + f * dy + k * dz)
        least = p if p < q else q
        least = least if least < r else r
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
    """Give one chunk of nodes, which have drifted, the impulses of contact, before the target moves."""
    stop = start + n
    x = node_plane(p, work, X)[start:stop]
    y = node_plane(p, work, Y)[start:stop]
    z = node_plane(p, work, Z)[start:stop]
    u = node_plane(p, work, U)[start:stop]
    v = node_plane(p, work, V)[start:stop]
    w = node_plane(p, work, W)[start:stop]
    c = p.target_place
    moving = h * math.sqrt(dot(p.target_drift, p.target_drift))
    if find_near(x, y, z, u, v, w, c[0], c[1], c[2], p.envelope_radius + moving, h) > 0:
        scratch = chunk_scratch(p, work)
        closeness = scratch[0:n]
        lanes = scratch[CHUNK : 2 * CHUNK]
        to_matrix(p.target_turn, p.target_pose)
        take_rate(p, frame_rate)
        moving += h * math.sqrt(dot(p.target_omega, p.target_omega)) * p.envelope_radius
        found = find_close(closeness, x, y, z, u, v, w, c[0], c[1], c[2], p.target_turn, p.half_size, moving, h)
        if found > 0:
            gather(lanes, closeness)
            for i in range(found):
                touch(p, work, start + int(lanes[i]), frame_rate, h)


@kernel
def touch(p, work, node, frame_rate, h):
    """Impulse between one node and the box, if it would otherwise end the substep below the surface.

    Gap and normal are those of its place before the drift, for which the target stands still.
    """
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
    arm[0] = node_plane(p, work, X)[node] - h * u[node] - p.target_place[0]
    arm[1] = node_plane(p, work, Y)[node] - h * v[node] - p.target_place[1]
    arm[2] = node_plane(p, work, Z)[node] - h * w[node] - p.target_place[2]
    for i in range(3):
        body[i] = turn[0, i] * arm[0] + turn[1, i] * arm[1] + turn[2, i] * arm[2]
    gap = box_distance(local, body, p.half_size)
    for i in range(3):
        normal[i] = turn[i, 0] * local[0] + turn[i, 1] * local[1] + turn[i, 2] * local[2]
    approach = (
        normal[0] * (u[node] - p.target_drift[0] - (omega[1] * arm[2] - omega[2] * arm[1]))
        + normal[1] * (v[node] - p.target_drift[1] - (omega[2] * arm[0] - omega[0] * arm[2]))
        + normal[2] * (w[node] - p.target_drift[2] - (omega[0] * arm[1] - omega[1] * arm[0]))
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
    # work of the impulse over the mean of the relative normal velocities before the kick of this substep and after it;
    # the predicted velocity is half a kick ahead of that after it
    kicked = 0.0
    for axis in range(3):
        velocity = node_plane(p, work, U + axis)
        kicked += 2.0 * (node_plane(p, work, P + axis)[node] - velocity[node]) * normal[axis]
    p.contact_loss -= impulse * 0.5 * (wanted + approach - kicked)
    for axis in range(3):
        change = impulse * inverse * normal[axis]
        node_plane(p, work, X + axis)[node] += h * change
        node_plane(p, work, U + axis)[node] += change
        node_plane(p, work, P + axis)[node] += change - 0.5 * kicked * normal[axis]
    cross(lever, arm, normal)
    for i in range(3):
        p.target_drift[i] -= impulse / p.target_mass * normal[i]
        p.target_spin[i] -= impulse * lever[i]
    take_rate(p, frame_rate)
    if p.contact_first_time < 0.0:
        p.contact_first_time = p.grid * p.solver_substep


@kernel
def start_contact(p):
    """Clear the contact ledger; take the envelope from the target's size."""
    for i in range(3):
        p.half_size[i] = 0.5 * p.target_size[i]
    p.envelope_radius = box_radius(p.half_size)
    p.contact_first_time = -1.0
    p.contact_impulse = 0.0
    p.contact_loss = 0.0


@kernel
def measure_contact(p, work):
    """Count the nodes on the surface."""
    x = node_plane(p, work, X)
    y = node_plane(p, work, Y)
    z = node_plane(p, work, Z)
    mass = node_plane(p, work, MASS)
    arm = p.scratch[13:16]
    normal = p.scratch[19:22]
    reach = p.envelope_radius + ON_SURFACE
    count = 0
    for i in range(x.size):
        arm[0] = x[i] - p.target_place[0]
        arm[1] = y[i] - p.target_place[1]
        arm[2] = z[i] - p.target_place[2]
        if mass[i] > 0.0 and dot(arm, arm) < reach * reach:
            rotate_inverse(arm, p.target_pose, arm)
            if box_distance(normal, arm, p.half_size) < ON_SURFACE:
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
