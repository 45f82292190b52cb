"""The closing cord: four winches at the bullets draw the mouth together and never pay out.

Each winch runs at its no-load speed less the share of the tension in its stall force:

    dL/dt = -v0 (1 - T / T_stall)   while 0 <= T < T_stall, otherwise 0

so the cord is ratcheted: its length out is a bound on the mouth's perimeter that only falls. No winch winds its pair
shorter than the lock length, so no cord is ever shorter, and none is stiffer than the stability bound reckons with.

The book of the cord, T_e = EA (s - L)/L the elastic part of its tension T:

    by the winches   [T + T_e^2 / (2 EA)] (-dL)        by the trapezoidal rule over the substep
    to the dashpots  (T - T_e) (ds - dL)
    stored           EA (s - L)^2 / (2 L)
"""

import math

from fmu_src.net_capture.formulas import cord_damping, cord_stiffness, ring_radius
from fmu_src.net_capture.topology import FX, P, X, bullet_node, node_plane
from orbital.kernel import kernel

TRIGGER_TIME, TRIGGER_CONTACT, TRIGGER_DISTANCE = range(3)
NEWTON_STEPS = 4
"""Of the winding law, from a start that is right to second order: the last changes nothing above rounding."""


@kernel
def start_closing(p):
    """Nothing is triggered yet, the cord lies along the mouth."""
    p.trigger_time = -1.0
    p.closing_t_start = -1.0
    p.closing_work = 0.0
    p.cord_dissipated = 0.0
    p.cord_power = 0.0
    p.cord_tension_max = 0.0
    p.cord_tension_peak = 0.0
    p.mouth_locked_pairs = 0
    for i in range(4):
        p.cord_length[i] = max(p.net_side, p.closing_lock_length)
        p.cord_rate[i] = 0.0
    p.mouth_cord_length = 4.0 * p.cord_length[0]


@kernel
def stops(p):
    """Stretches of one pair's cord: from bullet to ring to bullet."""
    return p.closing_rings + 1


@kernel
def cord_stop(p, i, stop):
    """Knot at which a stretch of the i-th pair's cord begins: stop 0 is bullet i, the last is the next bullet."""
    a = bullet_node(p.knots, i)
    b = bullet_node(p.knots, (i + 1) % 4)
    meshes = p.knots - 1
    return a + (b - a) // meshes * ((2 * stop * meshes + stops(p)) // (2 * stops(p)))


@kernel
def along_cord(p, work, i):
    """Way of the i-th pair's cord from bullet through the rings to bullet [m], and its rate by the predicted velocities
    [m/s].

        s = sum over the stretches of sqrt(d^2 + b^2)

    d  between two stops, b  how near to a ring's middle it passes: a stretch pulls with T d / sqrt(d^2 + b^2), so its
    direction does not jump where a ring meets the next.
    """
    radius = ring_radius(p.closing_lock_length, p.closing_rings)
    way = 0.0
    change = 0.0
    for stop in range(stops(p)):
        a = cord_stop(p, i, stop)
        b = cord_stop(p, i, stop + 1)
        squared = radius * radius
        product = 0.0
        for axis in range(3):
            position = node_plane(p, work, X + axis)
            velocity = node_plane(p, work, P + axis)
            d = position[b] - position[a]
            squared += d * d
            product += d * (velocity[b] - velocity[a])
        root = math.sqrt(squared)
        way += root
        change += product / root if root > 0.0 else 0.0
    return way, change


@kernel
def pull_along_cord(p, work, i, tension):
    """The same tension in every stretch: rings have no friction."""
    radius = ring_radius(p.closing_lock_length, p.closing_rings)
    for stop in range(stops(p)):
        a = cord_stop(p, i, stop)
        b = cord_stop(p, i, stop + 1)
        squared = radius * radius
        for axis in range(3):
            position = node_plane(p, work, X + axis)
            d = position[b] - position[a]
            squared += d * d
        share = tension / math.sqrt(squared)
        for axis in range(3):
            position = node_plane(p, work, X + axis)
            force = node_plane(p, work, FX + axis)
            pull = share * (position[b] - position[a])
            force[a] += pull
            force[b] -= pull


@kernel
def pull_trigger(p, work, now, first_contact, beyond):
    """Start the winches when their trigger has fallen and its delay has passed; what is loose of the cord is taken in.

    A pair that stands closer than the lock length has its cord slack, at that length.
    """
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
            distance, rate = along_cord(p, work, i)
            p.cord_length[i] = max(distance, p.closing_lock_length)
            _, p.cord_rate[i] = pull_of_cord(p, distance, rate, p.cord_length[i])


@kernel
def cord_energy(p, distance, length):
    """Energy [J] in a cord of this length between points this far apart: EA (s - L)^2 / (2 L)."""
    stretch = distance - length
    return 0.5 * p.closing_axial_stiffness * stretch * stretch / length if stretch > 0.0 else 0.0


@kernel
def cord_tension(stiffness, damping, stretch, rate, speed, stall):
    """Tension [N] of a stretched cord that a winch may be drawing in.

        T = k (s - L) + d (ds/dt - dL/dt),   dL/dt = -v0 (1 - T / T_stall) while the winch turns

    The dashpot works on the cord's own stretch rate, so the winch's law and the tension are solved together.

    stiffness  k        EA / L                                     [N/m]
    damping    d        dashpot of the cord                        [N s/m]
    stretch    s - L    distance of the bullets less cord out      [m]
    rate       ds/dt    of their distance                          [m/s]
    speed      v0       of the winch without load; 0 once locked   [m/s]
    stall      T_stall  tension at which it stands still           [N]

    Checked  tests/net_capture/test_closing.py
    """
    tension = stiffness * stretch + damping * rate
    if tension < stall:
        tension = (tension + damping * speed) / (1.0 + damping * speed / stall)
    return tension if tension > 0.0 else 0.0


@kernel
def pull_of_cord(p, distance, rate, length):
    """Tension of one pair's cord [N], and the rate of its length [m/s] as the winch turns under it."""
    speed = p.closing_speed if length > p.closing_lock_length else 0.0
    tension = 0.0
    if distance > length:
        stiffness = cord_stiffness(p.closing_axial_stiffness, length)
        damping = cord_damping(p.closing_damping_ratio, stiffness, p.cord_mass)
        tension = cord_tension(stiffness, damping, distance - length, rate, speed, p.closing_stall_force)
    turning = speed * (1.0 - tension / p.closing_stall_force)
    return tension, -turning if turning > 0.0 else 0.0


@kernel
def winch_force(p, distance, rate, length):
    """What a winch works against per length wound [N]: T + T_e^2 / (2 EA)."""
    tension, _ = pull_of_cord(p, distance, rate, length)
    stretch = distance - length
    elastic = p.closing_axial_stiffness * stretch / length if stretch > 0.0 else 0.0
    return tension + 0.5 * elastic * elastic / p.closing_axial_stiffness


@kernel
def pull_mouth(p, work):
    """Pull neighbouring bullets together; sum what the cord's dashpots take [W]."""
    p.cord_power = 0.0
    if p.closing_t_start < 0.0:
        return
    for i in range(4):
        distance, rate = along_cord(p, work, i)
        length = p.cord_length[i]
        tension, winding = pull_of_cord(p, distance, rate, length)
        p.cord_force[i] = winch_force(p, distance, rate, length)
        if tension > p.cord_tension_peak:
            p.cord_tension_peak = tension
        if distance > length:
            elastic = cord_stiffness(p.closing_axial_stiffness, length) * (distance - length)
            p.cord_power += (tension - elastic) * (rate - winding)
            pull_along_cord(p, work, i, tension)


@kernel
def wound(p, distance, rate, length, winding, h):
    """Length of a pair's cord one substep on [m], and how fast it then changes [m/s].

        L' = L + h/2 (dL/dt + dL'/dt),   dL'/dt by the winch's law at L'

    distance, rate   of the bullets at the end of the substep    [m], [m/s]
    length, winding  L, dL/dt at its begin                       [m], [m/s]

    The trapezoidal rule, solved by Newton's method: a short cord makes the law stiff, and this bounds no step.
    """
    known = length + 0.5 * h * winding
    shorter = max(length + h * winding, p.closing_lock_length)
    for _ in range(NEWTON_STEPS):
        _, then = pull_of_cord(p, distance, rate, shorter)
        slope = 1.0
        if distance > shorter and then < 0.0:
            stiffness = cord_stiffness(p.closing_axial_stiffness, shorter)
            damping = cord_damping(p.closing_damping_ratio, stiffness, p.cord_mass)
            yielding = p.closing_speed / (p.closing_stall_force + damping * p.closing_speed)
            slope += 0.5 * h * yielding * stiffness * distance / shorter
        shorter -= (shorter - known - 0.5 * h * then) / slope
        shorter = min(max(shorter, p.closing_lock_length), length)
    _, then = pull_of_cord(p, distance, rate, shorter)
    return shorter, then


@kernel
def wind_cord(p, work, h):
    """Wind the winches by the substep at whose end the bullets now are."""
    if p.closing_t_start < 0.0:
        return
    locked = 0
    total = 0.0
    for i in range(4):
        if p.cord_length[i] > p.closing_lock_length:
            distance, rate = along_cord(p, work, i)
            length = p.cord_length[i]
            shorter, p.cord_rate[i] = wound(p, distance, rate, length, p.cord_rate[i], h)
            against = 0.5 * (p.cord_force[i] + winch_force(p, distance, rate, shorter))
            p.closing_work += against * (length - shorter)
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
        distance, _ = along_cord(p, work, i)
        energy += cord_energy(p, distance, p.cord_length[i])
    return energy
