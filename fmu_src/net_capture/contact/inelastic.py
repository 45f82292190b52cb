"""Law A: an inelastic impulse at the surface.

A node may not come closer than the surface by the end of the substep: an impulse along the outward normal raises its
normal velocity relative to the surface point to what still lands on the surface, or to the restitution's share. The
target takes the opposite impulse at the same point, so linear and angular momentum are kept to rounding, and the loss
of kinetic energy is booked exactly.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fmu_src.extremes import Extreme
from fmu_src.interface import Term
from fmu_src.net_capture.contact import Checks, Contact
from fmu_src.net_capture.contact.touching import INSIDE_TARGET, ROWS, make_contact, refuses
from fmu_src.net_capture.planes import INVERSE_MASS, P, U, X
from fmu_src.rows import parameter
from orbital.kernel import kernel
from orbital.vectors import cross, dot

RECOVERY_SPEED = 0.01
"""Speed [m/s] at which a node found below the surface is brought back: small against any impact, so it adds no
energy."""
WALLS = 3
"""Walls of a hollow that a node may come to in a substep beside that before which it began."""
WITHIN = 1e-9
"""Metres below the surface where a node counts as on it."""


def make(composition: Any) -> Contact:
    """Kernels of the law with the composition's target."""
    node_plane, distance_to = composition.memory.node_plane, composition.target.shape.distance
    now, has_hollows = composition.clock.now, composition.target.shape.faces is None
    has_map = composition.force_map is not None
    add_to_map = composition.force_map.add if has_map else None
    hinge = composition.target.hinge
    swings = hinge is not None
    swing, along, feel_both, push_both, reach = (
        (hinge.swing, hinge.along, hinge.feel, hinge.push, hinge.reach) if hinge is not None else [None] * 5
    )

    @kernel
    def meet(p, work, node, h, ended):
        """Impulse between one node and the target, if it would otherwise end the substep below the surface; 1 if so.

        Gap and normal are those of its place before the drift, for which the target stands still. With the lever
        l = r x n of the impulse J about the target's centre of mass:

            v_n = n . (v - v_c) - w . l,   1/m = 1/m_node + 1/m_target + l . I^-1 l
            J = m (wanted - v_n),   m_target dv_c = -J n,   dw = -J I^-1 l

        A node that bounces does so half way through the substep, at t = h/2, or earlier where it would else end below
        the surface: the lever is that of its place then, and it ends the substep set back by t J/m_node from where its
        new velocity alone would take it. Its kick K was given for the whole substep, of which the surface takes back
        (1 - 2t/h) K, all of it from a node that rests (t = 0).

        Half way, because velocities lie there: the speed that is thrown back is that of the bounce, and threads do the
        same work before and after it. Bounced at the instant it reaches the surface, at a speed that its threads have
        not had the time to give it or have given it too early, a node gains m v K (1 - 2t/h), and where threads hold it
        down its hops fall into step with the grid and gain on each. So a bounce may be off by v h/2, and no energy is.

        ended     gap and normal are those of where the node is to end the substep, and it does not bounce half way

        Checked  tests/net_capture/test_contact.py, tests/net_capture/test_hollows.py
        """
        inverse = np.float64(node_plane(p, work, INVERSE_MASS)[node])
        if inverse == 0.0:
            return 0
        u = node_plane(p, work, U)
        v = node_plane(p, work, U + 1)
        w = node_plane(p, work, U + 2)
        arm = p.contact_arm
        body = p.contact_point
        local = p.contact_local
        normal = p.contact_normal
        lever = p.contact_lever
        turn = p.target_turn
        arm[0] = node_plane(p, work, X)[node] - h * u[node] - p.target_place[0]
        arm[1] = node_plane(p, work, X + 1)[node] - h * v[node] - p.target_place[1]
        arm[2] = node_plane(p, work, X + 2)[node] - h * w[node] - p.target_place[2]
        if ended:
            if swings:
                swing(p, arm)
            for axis in range(3):
                j, k = (axis + 1) % 3, (axis + 2) % 3
                carried = p.target_omega[j] * arm[k] - p.target_omega[k] * arm[j]
                p.contact_lever[axis] = node_plane(p, work, U + axis)[node] - p.target_drift[axis] - carried
                if swings:
                    p.contact_lever[axis] -= p.hinge_moved[axis]
            for axis in range(3):
                arm[axis] += h * p.contact_lever[axis]
        for i in range(3):
            body[i] = turn[0, i] * arm[0] + turn[1, i] * arm[1] + turn[2, i] * arm[2]
        gap = distance_to(p, local, body)
        if ended and gap >= -WITHIN:
            return 0
        if ended:  # it acts, as every kick, where the substep began: so angular momentum is kept
            for axis in range(3):
                at = node_plane(p, work, X + axis)[node] - h * node_plane(p, work, U + axis)[node]
                arm[axis] = at - p.target_place[axis]
            for i in range(3):
                body[i] = turn[0, i] * arm[0] + turn[1, i] * arm[1] + turn[2, i] * arm[2]
        for i in range(3):
            normal[i] = turn[i, 0] * local[0] + turn[i, 1] * local[1] + turn[i, 2] * local[2]
        cross(lever, arm, normal)
        own = normal[0] * u[node] + normal[1] * v[node] + normal[2] * w[node]
        approach = own - dot(normal, p.target_drift) - dot(lever, p.target_omega)
        if swings:
            if not ended and gap >= h * (abs(approach) + (reach(p) + gap) * abs(p.hinge_speed)):
                return 0  # whichever body it is near
            approach -= along(p, body, local) * p.hinge_speed
        if ended:
            gap -= h * approach
        if gap + h * approach >= 0.0:
            return 0
        wanted = -gap / h
        if wanted > RECOVERY_SPEED:
            wanted = RECOVERY_SPEED
        time = 0.0
        if approach < 0.0 and -p.contact_restitution * approach > wanted:
            if p.contact_restitution > 0.0 and not ended:
                thrown = -p.contact_restitution * approach
                time = max(0.0, min(0.5 * h, (gap + h * thrown) / (thrown - approach)))
                arm[0] += time * u[node]
                arm[1] += time * v[node]
                arm[2] += time * w[node]
                for i in range(3):
                    body[i] = turn[0, i] * arm[0] + turn[1, i] * arm[1] + turn[2, i] * arm[2]
                cross(lever, arm, normal)
                approach = own - dot(normal, p.target_drift) - dot(lever, p.target_omega)
                if swings:
                    approach -= along(p, body, local) * p.hinge_speed
            wanted = -p.contact_restitution * approach
        if wanted <= approach:
            return 0
        turned = p.contact_turned
        cross(local, body, local)
        feel = inverse + 1.0 / p.target_mass
        if swings:
            feel += feel_both(p, local)
        else:
            for i in range(3):
                turned[i] = local[i] / p.target_inertia[i]
                feel += local[i] * turned[i]
        impulse = (wanted - approach) / feel
        p.contact_impulse += impulse
        if has_map:
            add_to_map(p, body, impulse)
        # work of the impulse over the mean of the relative normal velocities before the kick of this substep, as far as
        # the surface takes it, and after it; the predicted velocity is half a kick ahead of that after it
        taken = 0.0
        for axis in range(3):
            velocity = node_plane(p, work, U + axis)
            taken += 2.0 * (node_plane(p, work, P + axis)[node] - velocity[node]) * normal[axis]
        if time > 0.0:
            taken *= 1.0 - 2.0 * time / h
        p.contact_loss -= impulse * 0.5 * (wanted + approach - taken)
        back = time * impulse * inverse
        for axis in range(3):
            change = impulse * inverse * normal[axis]
            node_plane(p, work, X + axis)[node] += h * change - back * normal[axis]
            node_plane(p, work, U + axis)[node] += change
            node_plane(p, work, P + axis)[node] += change - 0.5 * taken * normal[axis]
            p.target_drift[axis] -= impulse / p.target_mass * normal[axis]
            p.target_spin[axis] -= impulse * lever[axis]
            if not swings:
                gain = turn[axis, 0] * turned[0] + turn[axis, 1] * turned[1] + turn[axis, 2] * turned[2]
                p.target_omega[axis] -= impulse * gain
        if swings:
            push_both(p, impulse)
        if p.contact_first_time < 0.0:
            p.contact_first_time = now(p)
        return 1

    @kernel
    def touch(p, work, node, h):
        """Impulse between one node and the target; where that has hollows, also of the walls that the node comes to
        within the substep, one after another; 1 if there is any.

        Checked  tests/net_capture/test_hollows.py
        """
        touched = meet(p, work, node, h, False)
        if has_hollows:
            for _ in range(WALLS):
                if meet(p, work, node, h, True) == 0:
                    break
                touched = 1
        return touched

    return make_contact(composition, touch)


PART = Term(
    "impact that takes the normal velocity relative to the surface",
    (
        parameter("contact.restitution", "1", "share of the normal speed that comes back", 0.0, 0.0, 1.0),
        *ROWS,
    ),
    needs=("target",),
    faults=(INSIDE_TARGET,),
    make=make,
    checks=Checks(),
    refuses=refuses,
    extremes=tuple(
        Extreme(
            f"restitution {share:g}",
            "impacts that take all of the normal speed, or none",
            "energy_gained",
            {"contact.restitution": share},
            chief=share == 1.0,
        )
        for share in (0.0, 1.0)
    ),
)
