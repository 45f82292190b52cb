"""The closing cord: four winches at the bullets draw the mouth together and never pay out.

Each winch runs at its no-load speed less the share of the tension in its stall force:

    dL/dt = -v0 (1 - T / T_stall)   while 0 <= T < T_stall, otherwise 0

so the cord is ratcheted: its length out is a bound on the mouth's perimeter that only falls.
"""

import math

from fmu_src.net_capture.topology import FX, FY, FZ, U, V, W, X, Y, Z, bullet_node, node_plane
from orbital.kernel import kernel

TRIGGER_TIME, TRIGGER_CONTACT, TRIGGER_DISTANCE = range(3)


@kernel
def start_closing(p):
    """Nothing is triggered yet, the cord lies along the mouth."""
    p.trigger_time = -1.0
    p.closing_t_start = -1.0
    p.closing_work = 0.0
    p.cord_tension_max = 0.0
    p.cord_tension_peak = 0.0
    p.mouth_locked_pairs = 0
    for i in range(4):
        p.cord_length[i] = p.net_side
    p.mouth_cord_length = 4.0 * p.net_side


@kernel
def span(p, work, i):
    """Distance between bullet i and the next [m]."""
    a = bullet_node(p.knots, i)
    b = bullet_node(p.knots, (i + 1) % 4)
    dx = node_plane(p, work, X)[b] - node_plane(p, work, X)[a]
    dy = node_plane(p, work, Y)[b] - node_plane(p, work, Y)[a]
    dz = node_plane(p, work, Z)[b] - node_plane(p, work, Z)[a]
    return math.sqrt(dx * dx + dy * dy + dz * dz)


@kernel
def pull_trigger(p, work, now, first_contact, beyond):
    """Start the winches when their trigger has fallen and its delay has passed; the cord is then drawn straight."""
    if p.trigger_time < 0.0 and (
        p.close_command != 0
        or (p.closing_trigger == TRIGGER_TIME and now >= p.closing_time)
        or (p.closing_trigger == TRIGGER_CONTACT and first_contact >= 0.0)
        or (p.closing_trigger == TRIGGER_DISTANCE and beyond >= p.closing_distance)
    ):
        p.trigger_time = now
    if p.closing_t_start < 0.0 and p.trigger_time >= 0.0 and now >= p.trigger_time + p.closing_delay:
        p.closing_t_start = now
        for i in range(4):
            p.cord_length[i] = span(p, work, i)


@kernel
def cord_energy(p, distance, length):
    """Energy [J] in a cord of this length between points this far apart: EA (s - L)^2 / (2 L)."""
    stretch = distance - length
    return 0.5 * p.closing_axial_stiffness * stretch * stretch / length if stretch > 0.0 else 0.0


@kernel
def cord_tension(p, stiffness, damping, stretch, rate, winding):
    """Tension [N] of a stretched cord that a winch may be drawing in.

        T = k (s - L) + d (ds/dt - dL/dt),   dL/dt = -v0 (1 - T / T_stall) while the winch turns

    The dashpot works on the cord's own stretch rate, so the winch's law and the tension are solved together.

    stiffness  k     EA / L                                     [N/m]
    damping    d     dashpot of the cord                        [N s/m]
    stretch    s - L distance of the bullets less cord out      [m]
    rate       ds/dt of their distance                          [m/s]
    winding    false once the pair is locked
    """
    still = stiffness * stretch + damping * rate
    if not winding or still >= p.closing_stall_force:
        return still if still > 0.0 else 0.0
    drag = damping * p.closing_speed / p.closing_stall_force
    tension = (still + damping * p.closing_speed) / (1.0 + drag)
    return tension if tension > 0.0 else 0.0


@kernel
def draw_cord(p, work, h):
    """Pull neighbouring bullets together and wind the winches by one substep."""
    if p.closing_t_start < 0.0:
        return
    x = node_plane(p, work, X)
    y = node_plane(p, work, Y)
    z = node_plane(p, work, Z)
    u = node_plane(p, work, U)
    v = node_plane(p, work, V)
    w = node_plane(p, work, W)
    fx = node_plane(p, work, FX)
    fy = node_plane(p, work, FY)
    fz = node_plane(p, work, FZ)
    locked = 0
    total = 0.0
    for i in range(4):
        a = bullet_node(p.knots, i)
        b = bullet_node(p.knots, (i + 1) % 4)
        dx = x[b] - x[a]
        dy = y[b] - y[a]
        dz = z[b] - z[a]
        distance = math.sqrt(dx * dx + dy * dy + dz * dz)
        length = p.cord_length[i]
        tension = 0.0
        if distance > length:
            stiffness = p.closing_axial_stiffness / length
            damping = 2.0 * p.closing_damping_ratio * math.sqrt(0.5 * stiffness * p.bullets_mass)
            rate = ((u[b] - u[a]) * dx + (v[b] - v[a]) * dy + (w[b] - w[a]) * dz) / distance
            tension = cord_tension(p, stiffness, damping, distance - length, rate, length > p.closing_lock_length)
            if tension > 0.0:
                q = tension / distance
                fx[a] += q * dx
                fy[a] += q * dy
                fz[a] += q * dz
                fx[b] -= q * dx
                fy[b] -= q * dy
                fz[b] -= q * dz
        if tension > p.cord_tension_peak:
            p.cord_tension_peak = tension
        if length > p.closing_lock_length and tension < p.closing_stall_force:
            shorter = length - h * p.closing_speed * (1.0 - tension / p.closing_stall_force)
            if shorter < p.closing_lock_length:
                shorter = p.closing_lock_length
            p.closing_work += tension * (length - shorter)
            p.cord_length[i] = shorter
        if p.cord_length[i] <= p.closing_lock_length:
            locked += 1
        total += p.cord_length[i]
    p.mouth_locked_pairs = locked
    p.mouth_cord_length = total


@kernel
def stored_in_cord(p, work):
    """Elastic energy of the cord [J]."""
    if p.closing_t_start < 0.0:
        return 0.0
    energy = 0.0
    for i in range(4):
        energy += cord_energy(p, span(p, work, i), p.cord_length[i])
    return energy
