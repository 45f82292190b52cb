"""An impulse between a node and the target at the same point: what it changes, and at what speed."""

from __future__ import annotations

from typing import Any, NamedTuple

from fmu_src.net_capture.planes import P, U, X
from orbital.kernel import kernel
from orbital.vectors import cross, dot


class Push(NamedTuple):
    """Kernels for a node whose arm from the target's centre of mass is in `contact_arm`, the target's attitude in
    `target_turn`.

    relative(p, work, node, back, out)    out = its velocity relative to the surface [m/s], frame axes, `back` halves of
                                          the substep's kick before that after it
    aim(p, inverse, direction)            make ready to push along a direction, frame axes; what 1 N s changes [1/kg]
    push(p, work, node, h, inverse, direction, impulse)   give it an impulse [N s] and the target the opposite one
    """

    relative: Any
    aim: Any
    push: Any


def make_push(composition: Any) -> Push:
    """Kernels for the composition's memory."""
    node_plane, hinge = composition.memory.node_plane, composition.target.hinge
    swings = hinge is not None
    swing, along, feel_both, push_both = (hinge.swing, hinge.along, hinge.feel, hinge.push) if swings else [None] * 4

    @kernel
    def relative(p, work, node, back, out):
        """out = velocity of a node relative to the surface point under it [m/s].

            u - k (P - U) - v_c - w x arm,   P - U half of what this substep has given it

        Checked  tests/net_capture/test_penalty.py
        """
        cross(out, p.contact_arm, p.target_omega)
        for axis in range(3):
            u = node_plane(p, work, U + axis)[node]
            out[axis] += u - back * (node_plane(p, work, P + axis)[node] - u) - p.target_drift[axis]
        if swings:
            swing(p, p.contact_arm)
            for axis in range(3):
                out[axis] -= p.hinge_moved[axis]

    @kernel
    def aim(p, inverse, direction):
        """What 1 N s along a direction changes of the speed along it [1/kg]: 1/m + 1/M + l . I^-1 l, l = arm x n.

        Checked  tests/net_capture/test_penalty.py
        """
        lever, turned, turn = p.contact_lever, p.contact_turned, p.target_turn
        cross(lever, p.contact_arm, direction)
        feel = inverse + 1.0 / p.target_mass
        if swings:
            point, local = p.hinge_point, p.hinge_local
            for i in range(3):
                arm = p.contact_arm
                point[i] = turn[0, i] * arm[0] + turn[1, i] * arm[1] + turn[2, i] * arm[2]
                local[i] = turn[0, i] * direction[0] + turn[1, i] * direction[1] + turn[2, i] * direction[2]
            along(p, point, local)
            cross(local, point, local)
            return feel + feel_both(p, local)
        for i in range(3):
            own = turn[0, i] * lever[0] + turn[1, i] * lever[1] + turn[2, i] * lever[2]
            turned[i] = own / p.target_inertia[i]
            feel += own * turned[i]
        return feel

    @kernel
    def push(p, work, node, h, inverse, direction, impulse):
        """Give a node an impulse along the direction aimed at [N s], as one kick of a substep [s], and the target the
        opposite one at the same point.

        Checked  tests/net_capture/test_penalty.py
        """
        lever, turned, turn = p.contact_lever, p.contact_turned, p.target_turn
        for axis in range(3):
            change = impulse * inverse * direction[axis]
            node_plane(p, work, X + axis)[node] += h * change
            node_plane(p, work, U + axis)[node] += change
            # predicted for the end of the substep, as of any other kick
            node_plane(p, work, P + axis)[node] += 1.5 * change
            p.target_drift[axis] -= impulse / p.target_mass * direction[axis]
            p.target_spin[axis] -= impulse * lever[axis]
            if not swings:
                p.target_omega[axis] -= impulse * dot(turn[axis], turned)
        if swings:
            push_both(p, impulse)

    return Push(relative, aim, push)
