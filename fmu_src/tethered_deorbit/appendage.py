"""A hinged appendage of the target, a panel or a boom, that is held fast for the tow: what that does at its begin.

The target is given with the appendage in it, where it is held. Before, the appendage turned about its hinge, relative
to the rest, which turned at `target.start_rate`. The hinge stops it: forces within the target, which leave its momentum
and angular momentum as they were.

Source   Newton's laws for two bodies joined by a hinge
Checked  tests/tethered_deorbit/test_appendage.py
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.idle import no_fault
from fmu_src.tethered_deorbit.interface import BAD_INERTIA, BAD_PARAMETER
from fmu_src.tethered_deorbit.layout import ATTITUDE, PAIR
from orbital.kernel import kernel
from orbital.rigid import extreme_moments, inertia_matrix
from orbital.vectors import Array, add_scaled, cross, dot, matrix_vector, norm, unit


def make_appendage(terms: Mapping[str, str], interface: Interface) -> Callable[..., Any]:
    """The kernel `freeze(record, state) -> fault`, to be called once the pair stands at its start.

    Checked  tests/tethered_deorbit/test_appendage.py
    """
    if "appendage" not in terms:
        return no_fault
    if terms["target"] == "point":
        raise ValueError("tethered_deorbit: appendage needs a target that turns")
    slots = interface.references
    mass_slot, inertia_slot, axis_slot = (slots[f"appendage.{name}"] for name in ("mass", "inertia[1]", "axis[1]"))
    spin = PAIR + ATTITUDE - 3

    @kernel
    def freeze(record: Any, state: Array) -> int:
        """The target's rate once the hinge has stopped the appendage; returns 0 or a fault.

            h = g (I_p u + m_p c x (u x (c - p))),   w' = w + I^-1 h
            E = g^2/2 (u.I_p u + m_p (1 - m_p/m) |u x (c - p)|^2) - h.I^-1 h/2

        g rate about the hinge, u its direction, p its place, c centre of mass, m_p and I_p mass and inertia of the
        appendage; m and I those of the target with it, w its rate. The centre of mass of all keeps its velocity.

        state         of `layout`, at the start; its body rate is that of the rest of the target

        Source   angular momentum about the centre of mass of all, before and after
        Checked  tests/tethered_deorbit/test_appendage.py, against sums over mass points
        """
        r = record[0]
        axis, arm, push, gained = r.state_appendage[0], r.state_appendage[1], r.state_appendage[2], r.state_appendage[3]
        if not r.appendage_mass < r.target_mass:
            return blame(record, BAD_PARAMETER, mass_slot, r.appendage_mass)
        inertia_matrix(r.state_appendage_inertia, r.appendage_inertia)
        least, greatest = extreme_moments(r.state_appendage_inertia)
        trace = r.appendage_inertia[0] + r.appendage_inertia[1] + r.appendage_inertia[2]
        if not (least >= -1.0e-9 * trace and greatest <= 0.5 * trace * (1.0 + 1.0e-9)):
            return blame(record, BAD_INERTIA, inertia_slot, r.appendage_inertia[0])
        if not unit(axis, r.appendage_axis) > 0.0:
            return blame(record, BAD_PARAMETER, axis_slot, norm(r.appendage_axis))
        for i in range(3):
            axis[i] *= r.appendage_rate
            arm[i] = r.appendage_center[i] - r.appendage_hinge[i]
        momentum = r.appendage_momentum
        matrix_vector(momentum, r.state_appendage_inertia, axis)
        cross(push, axis, arm)
        reduced = r.appendage_mass * (1.0 - r.appendage_mass / r.target_mass)
        energy = 0.5 * (dot(axis, momentum) + reduced * dot(push, push))
        cross(arm, r.appendage_center, push)
        add_scaled(momentum, momentum, r.appendage_mass, arm)
        matrix_vector(gained, r.state_target_inverse, momentum)
        r.appendage_energy = energy - 0.5 * dot(momentum, gained)
        add_scaled(state[spin : spin + 3], state[spin : spin + 3], 1.0, gained)
        return 0

    return freeze
