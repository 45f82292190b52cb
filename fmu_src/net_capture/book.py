"""The energy book of all bodies: what came in, what was taken, and what is there now."""

from fmu_src.net_capture import environment
from orbital.kernel import kernel
from orbital.vectors import dot


def make_balance(terms):
    """Kernel `energy_balance(p, work) -> energy [J]` of the model built with these terms.

    It is constant but for the scheme's own error, and so the book's remainder is how far it has moved.

    Checked  tests/net_capture/test_energy_book.py
    """
    has_target = "target" in terms
    has_contact = "contact" in terms
    has_closing = "closing" in terms
    has_tether = "tether" in terms
    is_hill = terms["gravity"] == "hill"

    @kernel
    def energy_balance(p, work):
        """Energy of all bodies now [J], with what contact and dashpots took and without what the winches gave."""
        energy = p.energy_total + p.thread_dissipated
        energy += 0.5 * p.chaser_mass * dot(p.chaser_velocity, p.chaser_velocity)
        if has_target:
            energy += p.target_energy
        if has_contact:
            energy += p.contact_loss
        if has_closing:
            energy += p.cord_dissipated - p.closing_work
        if has_tether:
            energy -= p.tether_work
        if is_hill:
            potential = environment.potential_of_nodes(p, work)
            potential += p.chaser_mass * environment.hill_potential(p, p.chaser_place)
            if has_target:
                potential += p.target_mass * environment.hill_potential(p, p.target_place)
                potential -= p.mean_motion * p.target_spin[2]
            p.energy_potential = potential
            energy += potential
        return energy

    return energy_balance
