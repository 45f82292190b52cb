"""The force of one pair of threads that overlap, shared among their four nodes."""

from __future__ import annotations

import math
from typing import Any

from fmu_src.net_capture.planes import FX, INVERSE_MASS
from fmu_src.net_capture.self_contact.reaches import HELD, KICK, NEW, RATE
from fmu_src.net_capture.self_contact.segments import pair_mass, spring
from orbital.kernel import kernel


def make_copy(composition: Any) -> Any:
    """Kernel `copy(p, work, source, target)` for the composition's node planes."""
    node_plane, first_plane = composition.memory.node_plane, composition.self_contact_plane

    @kernel
    def copy(p, work, source, target):
        """Three node planes of the part into others; from -1: zeros.

        Checked  tests/net_capture/test_self_contact.py
        """
        for axis in range(3):
            to = node_plane(p, work, first_plane + target + axis)
            for node in range(p.node_slots):
                to[node] = node_plane(p, work, first_plane + source + axis)[node] if source >= 0 else 0.0

    return copy


def make_push(composition: Any, place: int, rate: int, real: bool) -> Any:
    """Kernel `push(p, work, a, b, c, d, s, t, gap, depth, held) -> power` by the planes of positions and velocities
    from these on; `real`: for a substep."""
    node_plane, first_plane = composition.memory.node_plane, composition.self_contact_plane

    @kernel
    def kick(p, work, node, share, held):
        """Share of a node in the force of this pair, and the change of its velocity so far in this substep by it.

        held    what the dashpot takes from the spring's force    [N]

        Checked  tests/net_capture/test_self_contact.py
        """
        light = share * node_plane(p, work, INVERSE_MASS)[node]
        for axis in range(3):
            force = p.self_contact_force[axis]
            node_plane(p, work, FX + axis)[node] += share * force
            node_plane(p, work, first_plane + NEW + axis)[node] += p.solver_substep * light * force
            if real:
                node_plane(p, work, first_plane + HELD + axis)[node] += share * held * p.self_contact_normal[axis]

    @kernel
    def crowd(p, work, node, stiffness):
        """What touches at a node, as stiffness over mass [1/s2]; the most of any so far.

        Checked  tests/net_capture/test_self_contact.py
        """
        rate = node_plane(p, work, first_plane + RATE)
        rate[node] += stiffness * node_plane(p, work, INVERSE_MASS)[node]
        p.self_contact_rate = max(p.self_contact_rate, rate[node])

    @kernel
    def parting(p, work, node, axis):
        """Velocity of a node half way through its kick, as far as that is known [m/s].

        Checked  tests/net_capture/test_self_contact.py
        """
        last = node_plane(p, work, first_plane + KICK + axis)[node]
        new = node_plane(p, work, first_plane + NEW + axis)[node]
        return node_plane(p, work, rate + axis)[node] - 0.5 * last + new

    @kernel
    def push(p, work, a, b, c, d, s, t, gap, depth, held):
        """Force of a pair that overlaps; the power that it takes [W].

        a, b, c, d    nodes of both threads
        s, t          shares of both at the closest points          [1]
        gap, depth    distance of these; how deep the threads are   [m]
        held          whether they touched a substep ago

        Checked  tests/net_capture/test_self_contact.py
        """
        h, force = p.solver_substep, p.self_contact_force
        inverse = node_plane(p, work, INVERSE_MASS)
        mass = pair_mass(inverse[a], inverse[b], inverse[c], inverse[d])
        stiffness = spring(mass, p.self_contact_duration)
        leaving = 0.0
        for axis in range(3):
            at = node_plane(p, work, place + axis)
            way = (1.0 - s) * at[a] + s * at[b] - (1.0 - t) * at[c] - t * at[d]
            going = (1.0 - s) * parting(p, work, a, axis) + s * parting(p, work, b, axis)
            going -= (1.0 - t) * parting(p, work, c, axis) + t * parting(p, work, d, axis)
            force[axis] = way / gap
            p.self_contact_normal[axis] = force[axis]
            leaving += going * force[axis]
        counts = 2.0 * p.self_contact_damping_ratio * math.sqrt(stiffness * mass)
        if not held:
            since = min(h, depth / max(-leaving, depth / h))
            counts *= 0.5 + since / h
        feel = (1.0 - s) * (1.0 - s) * inverse[a] + s * s * inverse[b]
        feel += (1.0 - t) * (1.0 - t) * inverse[c] + t * t * inverse[d]
        elastic = stiffness * depth
        size = max(0.0, (elastic - counts * leaving) / (1.0 + 0.5 * h * counts * feel))
        for axis in range(3):
            force[axis] *= size
        kick(p, work, a, 1.0 - s, elastic - size)
        kick(p, work, b, s, elastic - size)
        kick(p, work, c, t - 1.0, elastic - size)
        kick(p, work, d, -t, elastic - size)
        if real:
            crowd(p, work, a, (1.0 - s) * stiffness)
            crowd(p, work, b, s * stiffness)
            crowd(p, work, c, (1.0 - t) * stiffness)
            crowd(p, work, d, t * stiffness)
            p.self_contact_force_max = max(p.self_contact_force_max, size)
            p.self_contact_depth = max(p.self_contact_depth, depth)
        p.self_contact_stored += 0.5 * stiffness * depth * depth
        return (elastic - size) * (leaving + 0.5 * h * size * feel)

    return push
