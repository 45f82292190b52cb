"""Threads that pull but never push, and the motion of the nodes they join.

Most threads are slack at any time. So a first pass over a strip, free of branches, only asks by how much the squared
length exceeds the squared rest length; the square root, the damping and the force are worked out where a thread is taut.
"""

import math

from fmu_src.net_capture.topology import (
    CHUNK,
    DAMPING,
    FX,
    FY,
    FZ,
    INVERSE_MASS,
    LENGTH,
    LENGTH_SQUARED,
    PEAK,
    STIFFNESS,
    U,
    V,
    W,
    X,
    Y,
    Z,
    chunk_scratch,
    node_plane,
    strip_table,
    thread_plane,
)
from orbital.kernel import kernel


@kernel
def thread_tension(length, stretch_rate, rest_length, stiffness, damping):
    """Tension [N] of a thread that can pull but never push.

        T = max(0, k (L - L0) + d dL/dt)   when L > L0, otherwise 0

    length        L      distance between its two nodes   [m]
    stretch_rate  dL/dt  positive while lengthening       [m/s]
    rest_length   L0     unloaded length                  [m]
    stiffness     k      EA / L0                          [N/m]
    damping       d      axial dashpot                    [N s/m]

    Valid    strains small enough that EA is constant
    Source   Benvenuto and Lavagna (D-CoNe), eq. 1 and 3; the clamp at zero is ours
    Checked  tests/net_capture/test_threads.py
    """
    tension = stiffness * (length - rest_length) + damping * stretch_rate
    return tension if length > rest_length and tension > 0.0 else 0.0


@kernel
def find_taut(excess, xa, ya, za, xb, yb, zb, squared):
    """Write by how much each squared length exceeds the squared rest length [m2]; return how many do."""
    taut = 0
    for j in range(excess.size):
        dx = xb[j] - xa[j]
        dy = yb[j] - ya[j]
        dz = zb[j] - za[j]
        e = dx * dx + dy * dy + dz * dz - squared[j]
        excess[j] = e
        taut += 1 if e > 0.0 else 0
    return taut


@kernel
def pull(
    excess,
    xa,
    ya,
    za,
    xb,
    yb,
    zb,
    ua,
    va,
    wa,
    ub,
    vb,
    wb,
    fxa,
    fya,
    fza,
    fxb,
    fyb,
    fzb,
    length,
    stiffness,
    damping,
    peak,
):
    """Add the forces [N] of the taut threads among a chunk to both their nodes."""
    for j in range(excess.size):
        if excess[j] > 0.0:
            dx = xb[j] - xa[j]
            dy = yb[j] - ya[j]
            dz = zb[j] - za[j]
            r = math.sqrt(dx * dx + dy * dy + dz * dz)
            rate = ((ub[j] - ua[j]) * dx + (vb[j] - va[j]) * dy + (wb[j] - wa[j]) * dz) / r
            tension = thread_tension(r, rate, length[j], stiffness[j], damping[j])
            if tension > 0.0:
                if tension > peak[j]:
                    peak[j] = tension
                q = tension / r
                fxa[j] += q * dx
                fya[j] += q * dy
                fza[j] += q * dz
                fxb[j] -= q * dx
                fyb[j] -= q * dy
                fzb[j] -= q * dz


@kernel
def add_thread_forces(p, work):
    """Add the tension of every thread to its nodes; return how many are stretched."""
    x = node_plane(p, work, X)
    y = node_plane(p, work, Y)
    z = node_plane(p, work, Z)
    u = node_plane(p, work, U)
    v = node_plane(p, work, V)
    w = node_plane(p, work, W)
    fx = node_plane(p, work, FX)
    fy = node_plane(p, work, FY)
    fz = node_plane(p, work, FZ)
    length = thread_plane(p, work, LENGTH)
    squared = thread_plane(p, work, LENGTH_SQUARED)
    stiffness = thread_plane(p, work, STIFFNESS)
    damping = thread_plane(p, work, DAMPING)
    peak = thread_plane(p, work, PEAK)
    table = strip_table(p, work)
    scratch = chunk_scratch(p, work)
    taut = 0
    for q in range(p.strips):
        count = int(table[4 * q + 2])
        for start in range(0, count, CHUNK):
            a = int(table[4 * q]) + start
            b = int(table[4 * q + 1]) + start
            t = int(table[4 * q + 3]) + start
            n = min(CHUNK, count - start)
            e = scratch[0:n]
            xa = x[a : a + n]
            ya = y[a : a + n]
            za = z[a : a + n]
            xb = x[b : b + n]
            yb = y[b : b + n]
            zb = z[b : b + n]
            found = find_taut(e, xa, ya, za, xb, yb, zb, squared[t : t + n])
            if found > 0:
                taut += found
                pull(
                    e,
                    xa,
                    ya,
                    za,
                    xb,
                    yb,
                    zb,
                    u[a : a + n],
                    v[a : a + n],
                    w[a : a + n],
                    u[b : b + n],
                    v[b : b + n],
                    w[b : b + n],
                    fx[a : a + n],
                    fy[a : a + n],
                    fz[a : a + n],
                    fx[b : b + n],
                    fy[b : b + n],
                    fz[b : b + n],
                    length[t : t + n],
                    stiffness[t : t + n],
                    damping[t : t + n],
                    peak[t : t + n],
                )
    return taut


@kernel
def elastic_energy(p, work):
    """Energy stored in the stretched threads [J], sum of k (L - L0)^2 / 2."""
    x = node_plane(p, work, X)
    y = node_plane(p, work, Y)
    z = node_plane(p, work, Z)
    length = thread_plane(p, work, LENGTH)
    stiffness = thread_plane(p, work, STIFFNESS)
    table = strip_table(p, work)
    energy = 0.0
    for q in range(p.strips):
        a = int(table[4 * q])
        b = int(table[4 * q + 1])
        t = int(table[4 * q + 3])
        for j in range(int(table[4 * q + 2])):
            dx = x[b + j] - x[a + j]
            dy = y[b + j] - y[a + j]
            dz = z[b + j] - z[a + j]
            stretch = math.sqrt(dx * dx + dy * dy + dz * dz) - length[t + j]
            if stretch > 0.0:
                energy += 0.5 * stiffness[t + j] * stretch * stretch
    return energy


@kernel
def kick(velocity, force, inverse_mass, h):
    """Velocities from forces."""
    for j in range(velocity.size):
        velocity[j] += h * (force[j] * inverse_mass[j])


@kernel
def drift(position, velocity, force, h):
    """Positions from velocities, and the forces cleared for the next substep."""
    for j in range(position.size):
        position[j] += h * velocity[j]
        force[j] = 0.0


@kernel
def kick_nodes(p, work, start, n, h):
    """Kick one chunk of nodes."""
    inverse = node_plane(p, work, INVERSE_MASS)[start : start + n]
    kick(node_plane(p, work, U)[start : start + n], node_plane(p, work, FX)[start : start + n], inverse, h)
    kick(node_plane(p, work, V)[start : start + n], node_plane(p, work, FY)[start : start + n], inverse, h)
    kick(node_plane(p, work, W)[start : start + n], node_plane(p, work, FZ)[start : start + n], inverse, h)


@kernel
def drift_nodes(p, work, start, n, h):
    """Drift one chunk of nodes, and clear their forces."""
    stop = start + n
    drift(
        node_plane(p, work, X)[start:stop], node_plane(p, work, U)[start:stop], node_plane(p, work, FX)[start:stop], h
    )
    drift(
        node_plane(p, work, Y)[start:stop], node_plane(p, work, V)[start:stop], node_plane(p, work, FY)[start:stop], h
    )
    drift(
        node_plane(p, work, Z)[start:stop], node_plane(p, work, W)[start:stop], node_plane(p, work, FZ)[start:stop], h
    )
