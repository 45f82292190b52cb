"""Law A: an inelastic impulse at the surface.

A node may not come closer than the surface by the end of the substep: an impulse along the outward normal raises its
normal velocity relative to the surface point to what still lands on the surface, or to the restitution's share. The
target takes the opposite impulse at the same point, so linear and angular momentum are kept to rounding, and the loss
of kinetic energy is booked exactly.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from fmu_src.extremes import Extreme
from fmu_src.implied import formula
from fmu_src.interface import Term, fault
from fmu_src.net_capture.contact import Contact
from fmu_src.net_capture.contact.search import largest_way, make_search
from fmu_src.net_capture.planes import INVERSE_MASS, MASS, SHOWN, P, U, X
from fmu_src.net_capture.refusal import Refusal, Scene, text
from fmu_src.net_capture.stepping import LONGEST_SLEEP
from fmu_src.rows import count, parameter, peak, state
from orbital.kernel import kernel
from orbital.rotations import rotate_inverse, to_matrix
from orbital.vectors import cross, dot

RECOVERY_SPEED = 0.01
"""Speed [m/s] at which a node found below the surface is brought back: small against any impact, so it adds no
energy."""

ON_SURFACE = 1e-3
"""Distance [m] up to which a node counts as on the surface."""

INSIDE_TARGET = fault(
    "inside_target", "chaser.start_position[1]", "chaser.start_position: the folded net would begin inside the target"
)


@kernel
def take_rate(p, frame_rate):
    """Angular velocity of the target relative to the frame, frame axes, from its angular momentum.

    Checked  tests/net_capture/test_contact.py
    """
    turn = p.target_turn
    for i in range(3):
        p.target_omega[i] = 0.0
    for k in range(3):
        spin = turn[0, k] * p.target_spin[0] + turn[1, k] * p.target_spin[1] + turn[2, k] * p.target_spin[2]
        rate = spin / p.target_inertia[k]
        for i in range(3):
            p.target_omega[i] += turn[i, k] * rate
    p.target_omega[2] -= frame_rate


def make(composition: Any) -> Contact:
    """Kernels of the law with the composition's target."""
    memory, distance_to = composition.memory, composition.target.shape.distance
    node_plane, reals_of = memory.node_plane, memory.reals
    search = make_search(composition, LONGEST_SLEEP)
    near, close, largest_pull = search.near, search.close, search.largest_pull
    inside_target, now = composition.code(INSIDE_TARGET.name), composition.clock.now
    from fmu_src.lanes import lowest

    @kernel
    def begin_step(p, rate):
        """Attitude and rate of the target, which stands still while the nodes are looked at, and how far a point within
        the envelope moves with it in the substep [m].

        Checked  tests/net_capture/test_fast_nodes.py
        """
        to_matrix(p.target_turn, p.target_pose)
        take_rate(p, rate)
        p.contact_margin = largest_way(p, p.solver_substep)

    @kernel
    def touch_row(p, work, first):
        """Contact of a row of nodes that have just drifted; how many were touched [1], -1 if none was near.

        Checked  tests/net_capture/test_contact.py
        """
        reals = reals_of(work)
        found = close(p, reals, first, p.target_turn, p.contact_margin)
        if found == np.uint64(0):
            return 0 if near(p, reals, first, p.contact_margin) else -1
        touched = 0
        while found != np.uint64(0):
            touched += touch(p, work, first + np.int64(lowest(found)), p.solver_substep)
            found &= found - np.uint64(1)
        if touched > 0:
            p.contact_margin = max(p.contact_margin, largest_way(p, p.solver_substep))
        return touched

    @kernel
    def touch(p, work, node, h):
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

        Checked  tests/net_capture/test_contact.py
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
        for i in range(3):
            body[i] = turn[0, i] * arm[0] + turn[1, i] * arm[1] + turn[2, i] * arm[2]
        gap = distance_to(p, local, body)
        for i in range(3):
            normal[i] = turn[i, 0] * local[0] + turn[i, 1] * local[1] + turn[i, 2] * local[2]
        cross(lever, arm, normal)
        own = normal[0] * u[node] + normal[1] * v[node] + normal[2] * w[node]
        approach = own - dot(normal, p.target_drift) - dot(lever, p.target_omega)
        if gap + h * approach >= 0.0:
            return 0
        wanted = -gap / h
        if wanted > RECOVERY_SPEED:
            wanted = RECOVERY_SPEED
        time = 0.0
        if approach < 0.0 and -p.contact_restitution * approach > wanted:
            if p.contact_restitution > 0.0:
                thrown = -p.contact_restitution * approach
                time = max(0.0, min(0.5 * h, (gap + h * thrown) / (thrown - approach)))
                arm[0] += time * u[node]
                arm[1] += time * v[node]
                arm[2] += time * w[node]
                for i in range(3):
                    body[i] = turn[0, i] * arm[0] + turn[1, i] * arm[1] + turn[2, i] * arm[2]
                cross(lever, arm, normal)
                approach = own - dot(normal, p.target_drift) - dot(lever, p.target_omega)
            wanted = -p.contact_restitution * approach
        if wanted <= approach:
            return 0
        turned = p.contact_turned
        cross(local, body, local)
        feel = inverse + 1.0 / p.target_mass
        for i in range(3):
            turned[i] = local[i] / p.target_inertia[i]
            feel += local[i] * turned[i]
        impulse = (wanted - approach) / feel
        p.contact_impulse += impulse
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
            gain = turn[axis, 0] * turned[0] + turn[axis, 1] * turned[1] + turn[axis, 2] * turned[2]
            p.target_omega[axis] -= impulse * gain
        if p.contact_first_time < 0.0:
            p.contact_first_time = now(p)
        return 1

    @kernel
    def gap_of(p, work, node):
        """Distance of a node as shown from the surface [m]; where it is far, its distance from the envelope.

        Checked  tests/net_capture/test_contact.py
        """
        arm = p.contact_arm
        for axis in range(3):
            arm[axis] = node_plane(p, work, SHOWN + axis)[node] - p.target_place[axis]
        beyond = dot(arm, arm) - (p.envelope_radius + ON_SURFACE) * (p.envelope_radius + ON_SURFACE)
        if beyond > 0.0:
            return beyond
        rotate_inverse(arm, p.target_pose, arm)
        return distance_to(p, p.contact_normal, arm)

    @kernel
    def start(p, work):
        """Nothing touched yet; a fault where the folded net stands inside the target.

        Checked  tests/net_capture/test_contact.py
        """
        p.contact_first_time = -1.0
        p.contact_impulse = 0.0
        p.contact_loss = 0.0
        p.contact_haste = 0.0
        p.contact_force = 0.0
        p.contact_reckoned = 0.0
        p.contact_besides = 0
        p.contact_pull = largest_pull(p, work)
        mass = node_plane(p, work, MASS)
        for node in range(p.node_slots):
            if mass[node] > 0.0 and gap_of(p, work, node) <= 0.0:
                p.fault_value = p.chaser_start_position[0]
                return inside_target
        return 0

    @kernel
    def measure(p, work):
        """Count the nodes on the surface [1].

        Checked  tests/net_capture/test_contact.py
        """
        mass = node_plane(p, work, MASS)
        found = 0
        for node in range(p.node_slots):
            if mass[node] > 0.0 and gap_of(p, work, node) < ON_SURFACE:
                found += 1
        p.contact_nodes = found

    return Contact(start, begin_step, touch_row, search.clear_steps, search.hurries, measure)


def refuses(scene: Scene) -> Iterator[Refusal]:
    """A muzzle inside the target."""
    chaser = scene.vector("chaser.start_position")
    shape = scene.parts["target"].checks
    inside = in_body_axes(scene.vector("target.start_attitude", 4), chaser)
    if shape.turn is not None:
        inside = in_body_axes(shape.turn(scene.values), inside)
    if any(chaser) and shape.distance(scene.values, inside) < 0.0:
        expected = "must be outside the target: the folded net would begin inside it"
        yield Refusal("chaser.start_position", text(chaser, " m"), expected)


def in_body_axes(attitude: list[float], vector: list[float]) -> list[float]:
    """A vector of the frame in the axes of a body with this attitude; zero: aligned."""
    length = math.hypot(*attitude)
    if length == 0.0:
        return vector
    matrix = np.empty((3, 3))
    formula(to_matrix)(matrix, np.array(attitude) / length)
    return [float(part) for part in vector @ matrix]


PART = Term(
    "impact that takes the normal velocity relative to the surface",
    (
        parameter("contact.restitution", "1", "share of the normal speed that comes back", 0.0, 0.0, 1.0),
        count("contact.nodes", "nodes now on the surface"),
        peak("contact.first_time", "s", "first touch, since the shot; -1 before"),
        peak("contact.impulse", "N.s", "sum of the sizes of all impulses so far"),
        peak("contact.loss", "J", "kinetic energy lost in contact so far"),
        state("target_turn[#][#]", "1", "rotation matrix from body to frame", shape=(3, 3)),
        state("target_omega[#]", "rad/s", "rate of the target relative to the frame, frame axes", shape=(3,)),
        state("contact_margin", "m", "how far a point of the target moves in the substep"),
        state("contact_haste", "m/s", "speed of the target that rows were reckoned with"),
        state("contact_force", "N", "tension that no thread has exceeded"),
        state("contact_reckoned", "N", "the same, that rows were reckoned with"),
        count("contact_besides", "whether anything but threads pulled nodes", "state"),
        state("contact_pull", "1/kg", "acceleration that threads of 1 N may give the lightest node"),
        *(
            state(f"contact_{name}[#]", unit, text, shape=(3,))
            for name, unit, text in (
                ("arm", "m", "of a node from the target's centre of mass, frame axes"),
                ("point", "m", "the same, body axes"),
                ("local", "1", "outward normal, body axes; then arm times normal"),
                ("normal", "1", "outward normal, frame axes"),
                ("lever", "m", "arm times normal, frame axes"),
                ("turned", "1/(kg.m)", "rate that an impulse gives, body axes"),
            )
        ),
    ),
    needs=("target",),
    faults=(INSIDE_TARGET,),
    make=make,
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
