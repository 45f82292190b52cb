"""What is told of net and bodies at an instant: all outputs, from the state and without a change of it."""

from __future__ import annotations

import math
from typing import Any

from fmu_src.net_capture import quality
from fmu_src.net_capture.book import make_balance
from orbital.kernel import kernel


def make_measure(parts: Any, measures: Any, tensions: Any, not_finite: int) -> Any:
    """Kernel `measure(p, work, ahead) -> fault code` of the composition's parts.

    measures      see `quality.Quality`
    tensions      those of all threads; None: they are not told
    not_finite    fault code of what is no finite number

    Checked  tests/net_capture/test_quality.py
    """
    has_target, has_contact = parts.target is not None, parts.contact is not None
    has_closing, has_tether = parts.closing is not None, parts.tether is not None
    hold, has_volume = parts.volume, parts.volume is not None
    index, has_index = parts.index, parts.index is not None
    pull_off, has_load = parts.pull_off, parts.pull_off is not None
    hardest, has_hardest = parts.hardest, parts.hardest is not None
    has_nodes, has_threads, has_air = "nodes" in parts.terms, tensions is not None, parts.air is not None
    has_bending, has_wall, wall = parts.bending is not None, parts.wall is not None, parts.wall
    has_table, table = parts.sliding is not None, parts.sliding
    has_self = parts.self_contact is not None
    books_turn = parts.books_turn
    has_wrap, follows = parts.wrap is not None, parts.pace is not None
    has_ejection, ejection = parts.ejection is not None, parts.ejection
    gravity, scheme, peaks = parts.gravity, parts.scheme, parts.peaks
    gradient, has_gradient = parts.gradient, parts.gradient is not None
    target, contact, closing, tether = parts.target, parts.contact, parts.closing, parts.tether
    swings = has_target and target.hinge is not None
    show_hinge = target.hinge.show if swings else None
    lag, frame_rate, now, write_nodes = scheme.lag, gravity.rate, parts.clock.now, parts.numbering.write
    energy_balance = make_balance(parts)

    @kernel
    def measure(p, work, ahead):
        """All outputs, `ahead` seconds after the last substep; nothing of the state changes.

        Checked  tests/net_capture/test_quality.py
        """
        late = lag * p.solver_substep
        scheme.show(p, work)
        elastic = scheme.stored(p, work)
        p.thread_dissipated = p.thread_loss + late * p.thread_power
        if has_wrap:
            elastic += p.wrap_stored
        if has_closing:
            elastic += closing.stored(p, work)
            p.cord_dissipated = p.cord_loss + late * p.cord_power
            p.closed = 1 if p.mouth_locked_pairs == p.net_corners else 0
        place_bodies(p, ahead)
        if books_turn:
            for axis in range(3):
                p.chaser_spin[axis] = p.chaser_turned[axis]
        if has_wall:
            wall.show(p, work)
        if has_table:
            table.show(p, work)
        if has_ejection:
            ejection.show(p, work)
        if has_air:
            p.air_dissipated = p.air_loss + late * p.air_power
        if has_bending:
            elastic += p.bending_energy
            p.bending_dissipated = p.bending_loss + late * p.bending_power
        if has_self:
            elastic += p.self_contact_stored
            p.self_contact_loss = p.self_contact_booked + late * p.self_contact_power
        measures.measure_net(p, work)
        p.energy_elastic = elastic
        p.energy_total = p.energy_kinetic + elastic
        quality.add_body_momenta(p, p.chaser_mass, p.chaser_position, p.chaser_velocity)
        if books_turn:
            for axis in range(3):
                p.angular_momentum[axis] += p.chaser_spin[axis]
        if has_target:
            target.measure(p)
            if swings:
                show_hinge(p, ahead)
            target.show(p, frame_rate(p), ahead)
            quality.add_body_momenta(p, p.target_mass, p.target_position, p.target_velocity)
            for axis in range(3):
                p.angular_momentum[axis] += p.target_spin[axis]
            if has_gradient:
                gradient.measure(p)
            if has_closing:
                p.mouth_girth = p.girth
        if has_contact:
            contact.measure(p, work)
        if has_load:
            pull_off.show(p, work, late)
        balance = energy_balance(p, work)
        p.energy_remainder = p.energy_start - balance
        measures.measure_mouth(p, work)
        if ahead > 0.0:
            measures.carry(p, work, ahead)
        if has_volume:
            hold.watch(p, work)
        measures.show_points(p, work)
        carry_mass(p, ahead)
        if has_tether:
            tether.measure(p)
        if has_nodes:
            write_nodes(p, work)
        if has_index:
            fault = index.measure(p, work)
            if fault != 0:
                return fault
        if has_threads:
            tensions.write(p, work)
        peaks.collect(p)
        if has_hardest:
            hardest.tell(p, work)
        if has_closing:
            if p.cord_tension_peak > p.cord_tension_max:
                p.cord_tension_max = p.cord_tension_peak
        p.solver_steps = p.grid
        if follows:
            p.solver_substep_mean = now(p) / p.grid if p.grid > 0 else p.solver_substep
        finite = math.isfinite(balance) and math.isfinite(p.momentum[0] + p.momentum[1] + p.momentum[2])
        return 0 if finite else not_finite

    @kernel
    def carry_mass(p, ahead):
        """The centre of mass of the catch a time on [s].

        Checked  tests/net_capture/test_free_flight.py
        """
        for axis in range(3):
            p.catch_position[axis] += ahead * p.catch_velocity[axis]

    @kernel
    def place_bodies(p, ahead):
        """Places `ahead` seconds on and velocities now of chaser and target: those they keep lie back by the scheme's
        `lag`.

        Checked  tests/net_capture/test_free_flight.py
        """
        late = lag * p.solver_substep
        for axis in range(3):
            p.chaser_position[axis] = p.chaser_place[axis] + ahead * p.chaser_drift[axis]
            p.chaser_velocity[axis] = p.chaser_drift[axis]
            if has_target:
                p.target_position[axis] = p.target_place[axis] + ahead * p.target_drift[axis]
                p.target_velocity[axis] = p.target_drift[axis]
        if has_tether:
            tether.pull_chaser(p)
        gravity.kick_chaser(p, p.chaser_place, p.chaser_velocity, p.pull, late)
        if has_target:
            gravity.kick_target(p, p.target_place, p.target_velocity, p.rest, late)

    return measure
