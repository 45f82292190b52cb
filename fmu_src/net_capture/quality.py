"""Measures of a shot: mouth, energies and momenta, and whether the target is caught.

Velocities are kept half a substep back; a measure uses those at the instant itself, v + h a / 2, and between two
substeps positions on the straight line the next substep follows. All that accelerates a node must stand in the force
planes.
"""

import math

from fmu_src.net_capture.topology import (
    FX,
    INVERSE_MASS,
    MASS,
    PEAK,
    U,
    X,
    bullet_node,
    node_plane,
    thread_plane,
    vertex_node,
)
from orbital.kernel import kernel

OPEN_ENOUGH = 0.8
"""Share of the flat net's area above which a mouth counts as open (t80, T80)."""


@kernel
def position(p, work, axis, node, ahead):
    """A node's coordinate [m] `ahead` seconds after the last substep; forces must be in the force planes."""
    index = axis
    velocity = node_plane(p, work, U + index)[node]
    force = node_plane(p, work, FX + index)[node]
    inverse = node_plane(p, work, INVERSE_MASS)[node]
    return node_plane(p, work, X + index)[node] + ahead * (velocity + p.solver_substep * force * inverse)


@kernel
def speed(p, work, axis, node):
    """A node's velocity component [m/s] at the last substep's end; forces must be in the force planes."""
    force = node_plane(p, work, FX + axis)[node]
    inverse = node_plane(p, work, INVERSE_MASS)[node]
    return node_plane(p, work, U + axis)[node] + 0.5 * p.solver_substep * force * inverse


@kernel
def mouth_area(p, work):
    """Area [m2] of the quadrilateral of the bullets, projected on the plane normal to the shot (shoelace formula)."""
    twice = 0.0
    for i in range(4):
        a = bullet_node(p.knots, i)
        b = bullet_node(p.knots, (i + 1) % 4)
        xa = 0.0
        ya = 0.0
        xb = 0.0
        yb = 0.0
        for axis in range(3):
            at_a = node_plane(p, work, X + axis)[a]
            at_b = node_plane(p, work, X + axis)[b]
            xa += at_a * p.axes[axis]
            ya += at_a * p.axes[3 + axis]
            xb += at_b * p.axes[axis]
            yb += at_b * p.axes[3 + axis]
        twice += xa * yb - xb * ya
    return 0.5 * abs(twice)


@kernel
def bullet_depth(p, work, corner):
    """How far a bullet is from the muzzle along the shot [m]."""
    node = bullet_node(p.knots, corner)
    depth = 0.0
    for axis in range(3):
        depth += (node_plane(p, work, X + axis)[node] - p.muzzle[axis]) * p.axes[6 + axis]
    return depth


@kernel
def least_depth_beyond(p, work, place):
    """How far the rearmost bullet is beyond a point, along the shot [m]."""
    at = 0.0
    for axis in range(3):
        at += (place[axis] - p.muzzle[axis]) * p.axes[6 + axis]
    least = math.inf
    for corner in range(4):
        depth = bullet_depth(p, work, corner)
        if depth < least:
            least = depth
    return least - at


@kernel
def start_mouth(p):
    """Nothing measured yet."""
    p.mouth_t80 = -1.0
    p.mouth_t_max = 0.0
    p.mouth_area_max = 0.0
    p.mouth_time_above_80 = 0.0


@kernel
def watch_mouth(p, work, now, interval):
    """Follow the opening: largest area and when, first time above 80 %, time spent above."""
    area = mouth_area(p, work)
    if area > p.mouth_area_max:
        p.mouth_area_max = area
        p.mouth_t_max = now
    if area > OPEN_ENOUGH * p.net_side * p.net_side:
        if p.mouth_t80 < 0.0:
            p.mouth_t80 = now
        p.mouth_time_above_80 += interval


@kernel
def crossing(p, work, place, ax, ay, az, bx, by, bz, cx, cy, cz):
    """Signed crossing of a triangle by the ray from a point along a fixed oblique direction: 1, -1 or 0.

    Source   Moeller and Trumbore, Journal of Graphics Tools 2 (1997) 21, with the sign of the determinant kept
    """
    dx = 0.3128
    dy = 0.5417
    dz = 0.7801
    ax -= place[0]
    ay -= place[1]
    az -= place[2]
    e1x = bx - place[0] - ax
    e1y = by - place[1] - ay
    e1z = bz - place[2] - az
    e2x = cx - place[0] - ax
    e2y = cy - place[1] - ay
    e2z = cz - place[2] - az
    hx = dy * e2z - dz * e2y
    hy = dz * e2x - dx * e2z
    hz = dx * e2y - dy * e2x
    det = e1x * hx + e1y * hy + e1z * hz
    if det == 0.0:
        return 0
    u = -(ax * hx + ay * hy + az * hz) / det
    if u < 0.0 or u >= 1.0:
        return 0
    qx = -(ay * e1z - az * e1y)
    qy = -(az * e1x - ax * e1z)
    qz = -(ax * e1y - ay * e1x)
    v = (dx * qx + dy * qy + dz * qz) / det
    if v < 0.0 or u + v >= 1.0:
        return 0
    t = (e2x * qx + e2y * qy + e2z * qz) / det
    if t <= 0.0:
        return 0
    return 1 if det > 0.0 else -1


@kernel
def knot_crossing(p, work, place, i, j, k):
    """Signed crossing of the triangle of three knots."""
    x = node_plane(p, work, X)
    y = node_plane(p, work, X + 1)
    z = node_plane(p, work, X + 2)
    return crossing(p, work, place, x[i], y[i], z[i], x[j], y[j], z[j], x[k], y[k], z[k])


@kernel
def cap_crossing(p, work, place, i, j, cx, cy, cz):
    """Signed crossing of the triangle of two knots of the rim and the middle of the mouth."""
    x = node_plane(p, work, X)
    y = node_plane(p, work, X + 1)
    z = node_plane(p, work, X + 2)
    return crossing(p, work, place, x[i], y[i], z[i], x[j], y[j], z[j], cx, cy, cz)


@kernel
def encloses(p, work, place):
    """Whether the net, closed by a cap over its mouth, goes round a point: winding number by signed crossings.

    The cap joins every piece of the rim to the middle of the bullets, so the surface is closed whatever its shape.

    Checked  tests/net_capture/test_quality.py
    """
    k = p.knots
    winding = 0
    for i in range(k - 1):
        for j in range(k - 1):
            n = i * k + j
            winding += knot_crossing(p, work, place, n, n + 1, n + k + 1)
            winding += knot_crossing(p, work, place, n, n + k + 1, n + k)
    cx = 0.0
    cy = 0.0
    cz = 0.0
    for corner in range(4):
        node = bullet_node(k, corner)
        cx += 0.25 * node_plane(p, work, X)[node]
        cy += 0.25 * node_plane(p, work, X + 1)[node]
        cz += 0.25 * node_plane(p, work, X + 2)[node]
    last = k * (k - 1)
    for j in range(k - 1):
        winding += cap_crossing(p, work, place, j + 1, j, cx, cy, cz)
        winding += cap_crossing(p, work, place, last + j, last + j + 1, cx, cy, cz)
        winding += cap_crossing(p, work, place, j * k, (j + 1) * k, cx, cy, cz)
        winding += cap_crossing(p, work, place, (j + 1) * k + k - 1, j * k + k - 1, cx, cy, cz)
    return winding != 0


@kernel
def measure_net(p, work, ahead):
    """Bullets, vertex, mass properties, kinetic energy and momenta of net, bullets and vertex.

    ahead        seconds since the last substep, less than one substep

    Fills `momentum` and `angular_momentum` with the net's share; forces must be in the force planes.
    """
    mass = node_plane(p, work, MASS)
    total = 0.0
    kinetic = 0.0
    for i in range(3):
        p.catch_position[i] = 0.0
        p.catch_velocity[i] = 0.0
        p.catch_spin[i] = 0.0
    for i in range(6):
        p.catch_inertia[i] = 0.0
    for n in range(mass.size):
        m = mass[n]
        if m > 0.0:
            x = position(p, work, 0, n, ahead)
            y = position(p, work, 1, n, ahead)
            z = position(p, work, 2, n, ahead)
            u = speed(p, work, 0, n)
            v = speed(p, work, 1, n)
            w = speed(p, work, 2, n)
            total += m
            kinetic += 0.5 * m * (u * u + v * v + w * w)
            p.catch_position[0] += m * x
            p.catch_position[1] += m * y
            p.catch_position[2] += m * z
            p.catch_velocity[0] += m * u
            p.catch_velocity[1] += m * v
            p.catch_velocity[2] += m * w
            p.catch_spin[0] += m * (y * w - z * v)
            p.catch_spin[1] += m * (z * u - x * w)
            p.catch_spin[2] += m * (x * v - y * u)
            p.catch_inertia[0] += m * (y * y + z * z)
            p.catch_inertia[1] += m * (z * z + x * x)
            p.catch_inertia[2] += m * (x * x + y * y)
            p.catch_inertia[3] -= m * x * y
            p.catch_inertia[4] -= m * x * z
            p.catch_inertia[5] -= m * y * z
    p.catch_mass = total
    p.energy_kinetic = kinetic
    for i in range(3):
        p.momentum[i] = p.catch_velocity[i]
        p.angular_momentum[i] = p.catch_spin[i]
        p.catch_position[i] /= total
        p.catch_velocity[i] /= total
    x = p.catch_position[0]
    y = p.catch_position[1]
    z = p.catch_position[2]
    p.catch_spin[0] -= y * p.momentum[2] - z * p.momentum[1]
    p.catch_spin[1] -= z * p.momentum[0] - x * p.momentum[2]
    p.catch_spin[2] -= x * p.momentum[1] - y * p.momentum[0]
    p.catch_inertia[0] -= total * (y * y + z * z)
    p.catch_inertia[1] -= total * (z * z + x * x)
    p.catch_inertia[2] -= total * (x * x + y * y)
    p.catch_inertia[3] += total * x * y
    p.catch_inertia[4] += total * x * z
    p.catch_inertia[5] += total * y * z
    for corner in range(4):
        node = bullet_node(p.knots, corner)
        for axis in range(3):
            p.bullet_position[corner, axis] = position(p, work, axis, node, ahead)
            p.bullet_velocity[corner, axis] = speed(p, work, axis, node)
    for axis in range(3):
        p.vertex_position[axis] = 0.0
        p.vertex_velocity[axis] = 0.0
        for i in range(4):
            p.vertex_position[axis] += 0.25 * position(p, work, axis, vertex_node(p.knots, i), ahead)
            p.vertex_velocity[axis] += 0.25 * speed(p, work, axis, vertex_node(p.knots, i))


@kernel
def add_body_momenta(p, mass, place, velocity):
    """Add a body's linear and orbital angular momentum to the scene's."""
    p.momentum[0] += mass * velocity[0]
    p.momentum[1] += mass * velocity[1]
    p.momentum[2] += mass * velocity[2]
    p.angular_momentum[0] += mass * (place[1] * velocity[2] - place[2] * velocity[1])
    p.angular_momentum[1] += mass * (place[2] * velocity[0] - place[0] * velocity[2])
    p.angular_momentum[2] += mass * (place[0] * velocity[1] - place[1] * velocity[0])


@kernel
def measure_mouth(p, work):
    """Present mouth area and depth."""
    p.mouth_area = mouth_area(p, work)
    p.mouth_area_ratio = p.mouth_area / (p.net_side * p.net_side)
    depth = 0.0
    for corner in range(4):
        depth += 0.25 * bullet_depth(p, work, corner)
    p.mouth_depth = depth


@kernel
def collect_peaks(p, work):
    """Largest thread tension of the macro step and since the start, and where."""
    peak = thread_plane(p, work, PEAK)
    largest = 0.0
    where = 0
    for i in range(peak.size):
        if peak[i] > largest:
            largest = peak[i]
            where = i
    p.thread_tension_peak = largest
    if largest > p.thread_tension_max:
        p.thread_tension_max = largest
        p.thread_tension_max_index = where + 1


@kernel
def clear_peaks(p, work):
    """Begin a new macro step."""
    peak = thread_plane(p, work, PEAK)
    for i in range(peak.size):
        peak[i] = 0.0
