"""Threads that pull but never push, and the drift of the nodes they join.

Most threads are slack at any time. So a first pass over a strip, free of branches, only asks by how much the squared
length exceeds the squared rest length; the square root, the damping and the force are worked out where a thread is
taut.
"""

import math

import numpy as np

from fmu_src.net_capture.topology import (
    CHUNK,
    FX,
    INVERSE_MASS,
    LENGTH_SQUARED,
    PEAK,
    U,
    X,
    Y,
    Z,
    chunk_scratch,
    gather,
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
def pull(lanes, nodes, slots, a, b, peak, length, stiffness, damping, h):
    """Add the forces [N] of the taut lanes of a chunk to both their nodes; return what their dashpots take [W].

        D = sum of (T - T_e) dL/dt,   T_e = k (L - L0)

    lanes     numbers of the taut lanes within the chunk
    nodes     the node planes, one after another, `slots` long each
    a, b      nodes joined by the chunk's first lane
    peak      largest tension so far of each lane of the chunk   [N]
    h         substep                                            [s]

    The rate of stretch is that of the predicted velocities, which belong to the same instant as the positions. Where
    the tension is held at zero the dashpot takes what the shortening thread gives up. A thread that was slack a substep
    ago gives its nodes a kick that no prediction knows of: there the rate is the mean of those before and after it.

    Indices are unsigned, which spares the test for negative ones: at this place it costs a third.

    Checked  tests/net_capture/test_threads.py, tests/net_capture/test_energy_book.py
    """
    n = np.uint64(slots)
    taken = 0.0
    for i in range(lanes.size):
        lane = np.uint64(lanes[i])
        ia = np.uint64(a) + lane
        ib = np.uint64(b) + lane
        dx = nodes[ib] - nodes[ia]
        ua = ia + n
        ub = ib + n
        dy = nodes[ub] - nodes[ua]
        ua += n
        ub += n
        dz = nodes[ub] - nodes[ua]
        r = math.sqrt(dx * dx + dy * dy + dz * dz)
        inverse = 1.0 / r
        ua += n
        ub += n
        rate = (nodes[ub] - nodes[ua]) * dx
        ua += n
        ub += n
        rate += (nodes[ub] - nodes[ua]) * dy
        ua += n
        ub += n
        rate += (nodes[ub] - nodes[ua]) * dz
        rate *= inverse
        tension = thread_tension(r, rate, length, stiffness, damping)
        ua = ia + np.uint64(U) * n
        ub = ib + np.uint64(U) * n
        before = (nodes[ub] - nodes[ua]) * dx
        before += (nodes[ub + n] - nodes[ua + n]) * dy
        before += (nodes[ub + n + n] - nodes[ua + n + n]) * dz
        before *= inverse
        if r - h * before <= length:
            ua = ia + np.uint64(INVERSE_MASS) * n
            ub = ib + np.uint64(INVERSE_MASS) * n
            rate = before - 0.5 * h * tension * (nodes[ua] + nodes[ub])
        taken += (tension - stiffness * (r - length)) * rate
        peak[lane] = tension if tension > peak[lane] else peak[lane]
        q = tension * inverse
        ua = ia + np.uint64(FX) * n
        ub = ib + np.uint64(FX) * n
        nodes[ua] += q * dx
        nodes[ub] -= q * dx
        ua += n
        ub += n
        nodes[ua] += q * dy
        nodes[ub] -= q * dy
        ua += n
        ub += n
        nodes[ua] += q * dz
        nodes[ub] -= q * dz
    return taken


@kernel
def add_thread_forces(p, work):
    """Add the tension of every thread to its nodes; count those that are stretched, sum what their dashpots take."""
    x = node_plane(p, work, X)
    y = node_plane(p, work, Y)
    z = node_plane(p, work, Z)
    squared = thread_plane(p, work, LENGTH_SQUARED)
    peak = thread_plane(p, work, PEAK)
    table = strip_table(p, work)
    scratch = chunk_scratch(p, work)
    excess = scratch[0:CHUNK]
    lanes = scratch[CHUNK : 2 * CHUNK]
    taut = 0
    taken = 0.0
    for q in range(p.strips):
        count = int(table[4 * q + 2])
        for start in range(0, count, CHUNK):
            a = int(table[4 * q]) + start
            b = int(table[4 * q + 1]) + start
            t = int(table[4 * q + 3]) + start
            n = min(CHUNK, count - start)
            e = excess[0:n]
            found = find_taut(
                e,
                x[a : a + n],
                y[a : a + n],
                z[a : a + n],
                x[b : b + n],
                y[b : b + n],
                z[b : b + n],
                squared[t : t + n],
            )
            if found > 0:
                taut += found
                gather(lanes, e)
                taken += pull(
                    lanes[0:found],
                    work,
                    p.node_slots,
                    a,
                    b,
                    peak[t : t + n],
                    p.thread_length,
                    p.thread_stiffness,
                    p.thread_damping,
                    p.solver_substep,
                )
    p.thread_taut = taut
    p.thread_power = taken


@kernel
def elastic_energy(p, work):
    """Energy stored in the stretched threads [J], sum of k (L - L0)^2 / 2."""
    x = node_plane(p, work, X)
    y = node_plane(p, work, Y)
    z = node_plane(p, work, Z)
    squared = thread_plane(p, work, LENGTH_SQUARED)
    table = strip_table(p, work)
    total = 0.0
    for q in range(p.strips):
        a = int(table[4 * q])
        b = int(table[4 * q + 1])
        t = int(table[4 * q + 3])
        for j in range(int(table[4 * q + 2])):
            dx = x[b + j] - x[a + j]
            dy = y[b + j] - y[a + j]
            dz = z[b + j] - z[a + j]
            distance = dx * dx + dy * dy + dz * dz
            if distance > squared[t + j]:
                stretch = math.sqrt(distance) - p.thread_length
                total += stretch * stretch
    return 0.5 * p.thread_stiffness * total


@kernel
def drift(position, velocity, force, h):
    """Positions from velocities, and the forces cleared for the next substep."""
    for j in range(position.size):
        position[j] += h * velocity[j]
        force[j] = 0.0


@kernel
def drift_nodes(p, work, start, n, h):
    """Drift one chunk of nodes, and clear their forces."""
    stop = start + n
    for axis in range(3):
        drift(
            node_plane(p, work, X + axis)[start:stop],
            node_plane(p, work, U + axis)[start:stop],
            node_plane(p, work, FX + axis)[start:stop],
            h,
        )
