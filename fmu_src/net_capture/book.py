"""The energy book of all bodies: what came in, what was taken, and what is there now."""

from __future__ import annotations

from typing import Any

from fmu_src.net_capture.planes import MASS, SHOWN
from orbital.kernel import kernel
from orbital.vectors import dot


def make_balance(composition: Any) -> Any:
    """Kernel `energy_balance(p, work) -> energy [J]` of the model with the composition's parts, of the nodes as shown.

    It is constant but for the scheme's own error, and so the book's remainder is how far it has moved.

    Checked  tests/net_capture/test_energy_book.py
    """
    has_target = composition.target is not None
    has_contact = composition.contact is not None
    presses = composition.presses
    has_closing = composition.closing is not None
    has_tether = composition.tether is not None
    drags = composition.terms.get("tether") == "dragging"
    has_break = composition.breaking is not None
    has_ejection = composition.ejection is not None
    gravity, has_gradient = composition.gravity, composition.gradient is not None
    potential_at, bends, given, changes = gravity.potential, gravity.bends, gravity.given, gravity.given is not None
    chaser_potential, target_potential = gravity.chaser_potential, gravity.target_potential
    swings = has_target and composition.target.hinge is not None
    has_wrap = composition.wrap is not None
    rubs = composition.terms.get("wrap") == "friction"
    has_air, has_load = composition.air is not None, composition.pull_off is not None
    has_bending, has_wall = composition.bending is not None, composition.wall is not None
    has_table, has_self = composition.sliding is not None, composition.self_contact is not None
    node_plane = composition.memory.node_plane

    @kernel
    def potential_of_nodes(p, work):
        """Potential energy [J] of all nodes in the frame.

        Checked  tests/net_capture/test_energy_book.py
        """
        mass = node_plane(p, work, MASS)
        at = p.scratch[3:6]
        total = 0.0
        for i in range(p.node_slots):
            if mass[i] > 0.0:
                for axis in range(3):
                    at[axis] = node_plane(p, work, SHOWN + axis)[i]
                total += mass[i] * potential_at(p, at)
        return total

    @kernel
    def energy_balance(p, work):
        """Energy of all bodies now [J], with what contacts, dashpots, air, bending and breaks took and without what the
        winches gave, or gravity as it changed.

        Checked  tests/net_capture/test_energy_book.py
        """
        energy = p.energy_total + p.thread_dissipated
        energy += 0.5 * p.chaser_mass * dot(p.chaser_velocity, p.chaser_velocity)
        if has_target:
            energy += p.target_energy
        if swings:
            energy += p.hinge_energy + p.hinge_loss
        if has_contact:
            energy += p.contact_loss
        if presses:
            energy += p.contact_stored
        if has_closing:
            energy += p.cord_dissipated - p.closing_work
        if has_tether:
            energy -= p.tether_work
        if drags:
            energy += p.tether_friction_loss
        if has_wrap:
            energy += p.wrap_slip_loss
        if rubs:
            energy += p.wrap_friction_loss
        if has_load:
            energy -= p.pull_off_work
        if has_break:
            energy += p.break_energy
        if has_ejection:
            energy -= p.ejection_work
        if bends:
            potential = potential_of_nodes(p, work)
            potential += chaser_potential(p)
            if has_target:
                potential += target_potential(p)
            if has_gradient:
                potential += p.gravity_gradient_energy
            p.energy_potential = potential
            energy += potential
        if changes:
            energy -= given(p, work)
        if has_air:
            energy += p.air_dissipated
        if has_bending:
            energy += p.bending_dissipated
        if has_wall:
            energy += p.wall_friction_loss
        if has_table:
            energy += p.table_friction_loss
        if has_self:
            energy += p.self_contact_loss
        return energy

    return energy_balance
