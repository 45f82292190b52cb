"""What laws of contact share: which nodes are looked at, the target as they meet it, what is told of it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from fmu_src.implied import formula
from fmu_src.interface import fault
from fmu_src.net_capture.contact import Contact
from fmu_src.net_capture.contact.search import make_largest_way, make_search
from fmu_src.net_capture.planes import MASS, SHOWN
from fmu_src.net_capture.refusal import Refusal, Scene, text
from fmu_src.net_capture.stepping import LONGEST_SLEEP
from fmu_src.rows import count, peak, state
from orbital.kernel import kernel
from orbital.rotations import rotate_inverse, to_matrix
from orbital.vectors import dot

ON_SURFACE = 1e-3
"""Distance [m] up to which a node counts as on the surface."""

INSIDE_TARGET = fault(
    "inside_target", "chaser.start_position[1]", "chaser.start_position: the folded net would begin inside the target"
)


ROWS = (
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


def make_contact(composition: Any, touch: Any) -> Contact:
    """Kernels of a law with the composition's target.

    touch(p, work, node, h)    what passes between one node and the target in a substep [s]; 1 if they touched
    """
    memory, distance_to = composition.memory, composition.target.shape.distance
    node_plane, reals_of = memory.node_plane, memory.reals
    search = make_search(composition, LONGEST_SLEEP)
    near, close, largest_pull = search.near, search.close, search.largest_pull
    hinge = composition.target.hinge
    swings = hinge is not None
    take_both = hinge.take if hinge is not None else None
    largest_way = make_largest_way(hinge)
    inside_target = composition.code(INSIDE_TARGET.name)
    from fmu_src.lanes import lowest

    @kernel
    def begin_step(p, rate):
        """Attitude and rate of the target, which stands still while the nodes are looked at, and how far a point within
        the envelope moves with it in the substep [m].

        Checked  tests/net_capture/test_fast_nodes.py
        """
        to_matrix(p.target_turn, p.target_pose)
        if swings:
            take_both(p, rate)
        else:
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
    directed = any(chaser) or any(scene.vector("shot.axis"))  # else `refuses_place` speaks
    if directed and shape.distance(scene.values, inside) < 0.0:
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
