"""The net capture model: the loop, and what one substep does.

From grid time n h to (n + 1) h:

    target               kicked by gravity
    nodes                forces of the threads, closing cord, air and a tension at the vertex; the scheme's step;
                         impulses on the nodes that ended below the target's surface, which they then have not done
    chaser               kicked by gravity and the tension
    both                 drift; the target turns, between two halves of the gravity gradient's kick
    reels                the cord out and the work done at (n + 1) h

The grid is counted in integers from the start, whatever the macro step, so a scene gives the same bits in every tool;
and all times count from there, whatever the clock of the tool says.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from fmu_src.interface import GO_ON, INITIALISE, SIZE, STEP, UNDER_WAY
from fmu_src.net_capture import outcome, quality
from fmu_src.net_capture.closing.triggers import make_reached
from fmu_src.net_capture.composition import Composition
from fmu_src.net_capture.counting import make_check
from fmu_src.net_capture.interface import MODEL, NOT_FINITE
from fmu_src.net_capture.planes import complete_strips
from fmu_src.net_capture.shot import NO_AXIS, aim, make_shot
from fmu_src.net_capture.showing import make_measure
from fmu_src.net_capture.stepping import MEASURE_INTERVAL, make_choose_substep, make_limit_way
from fmu_src.net_capture.tensions import make_tensions
from orbital.kernel import entry, kernel

ON_GRID = 1e-3
"""Share of a substep by which a communication point may miss the grid and still count as on it: masters add up
times."""


def make_entry(terms: Mapping[str, str]) -> Any:
    """Entry of the model built with these terms, `entry(command, record, work, time, step) -> status`."""

    model_interface = MODEL.interface(terms)
    terms = model_interface.terms
    parts = Composition(MODEL, terms)
    has_target, has_contact = parts.target is not None, parts.contact is not None
    has_closing, has_tether = parts.closing is not None, parts.tether is not None
    hold, has_volume = parts.volume, parts.volume is not None
    index, has_index = parts.index, parts.index is not None
    pull_off, has_load = parts.pull_off, parts.pull_off is not None
    has_threads, has_air = "threads" in terms, parts.air is not None
    check, tensions = make_check(parts), make_tensions(parts) if has_threads else None
    has_hardest, hardest = parts.hardest is not None, parts.hardest
    has_bending, bending, has_wall, wall = parts.bending is not None, parts.bending, parts.wall is not None, parts.wall
    has_table, table = parts.sliding is not None, parts.sliding
    has_gradient, gradient = parts.gradient is not None, parts.gradient
    has_self, self_contact = parts.self_contact is not None, parts.self_contact
    properties = parts.memory.properties

    graph, folding, gravity, scheme, peaks = parts.graph, parts.folding, parts.gravity, parts.scheme, parts.peaks
    target, contact, closing, tether = parts.target, parts.contact, parts.closing, parts.tether
    has_break, breaking = parts.breaking is not None, parts.breaking
    has_ejection, ejection = parts.ejection is not None, parts.ejection
    shot, measures, limit_way = make_shot(parts), quality.make_quality(parts), make_limit_way(parts)
    choose_substep = make_choose_substep(parts)
    judge = outcome.make_judge(parts, measures)
    reached = make_reached(parts, measures) if has_closing else None
    not_finite, no_axis = (parts.code(fault.name) for fault in (NOT_FINITE, NO_AXIS))
    measure = make_measure(parts, measures, tensions, not_finite)
    lag, frame_rate = scheme.lag, gravity.rate
    clock, pace = parts.clock, parts.pace
    now, reach, due, follows = clock.now, clock.reach, clock.due, pace is not None
    presses, wrap, has_wrap = parts.presses, parts.wrap, parts.wrap is not None
    force_map, has_map = parts.force_map, parts.force_map is not None
    changes, watches, renew, watch = (
        gravity.renew is not None,
        gravity.watch is not None,
        gravity.renew,
        gravity.watch,
    )
    can_stop, stopped_by = scheme.fault is not None, scheme.fault

    @kernel
    def substep(p, work):
        """One step of the grid.

        Checked  tests/net_capture/test_free_flight.py
        """
        h = p.solver_substep
        if has_target:
            gravity.kick_target(p, p.target_place, p.target_drift, p.rest, h)
        if has_gradient:
            gradient.kick(p, 0.5 * h)
        scheme.step(p, work)
        if has_tether:
            tether.kick_chaser(p)
        before = p.scratch[0:3]
        for axis in range(3):
            before[axis] = p.chaser_drift[axis]
        gravity.kick_chaser(p, p.chaser_place, p.chaser_drift, p.pull, h)
        if has_wall:
            wall.rub(p, work, before)
        if has_table:
            table.rub(p, work)
        if has_ejection:
            ejection.hold(p, work, before)
        for axis in range(3):
            # staggered by half a substep, or at one instant with the place: then the mean of before and after counts
            change = p.chaser_drift[axis] - before[axis]
            p.chaser_place[axis] += h * (p.chaser_drift[axis] - (0.5 - lag) * change)
        if has_target:
            target.drift(p, frame_rate(p), h)
        if has_gradient:
            gradient.carry(p, frame_rate(p), h)
            gradient.kick(p, 0.5 * h)
        p.grid += 1
        if changes:
            renew(p)
        if has_ejection:
            ejection.carry(p, work)
            if ejection.count_due(p) > 0:
                scheme.change(p, work, h)
                ejection.fire(p, work)
        if has_closing:
            closing.wind(p, work)
        if has_tether:
            tether.reel_in(p, work)
        if has_load:
            pull_off.go_on(p, work)

    @kernel
    def look(p, work):
        """Every measure interval: mouth, trigger, capture and outcome; a fault code if the net has blown up.

        Checked  tests/net_capture/test_outcome.py
        """
        time = now(p)
        scheme.place(p, work)
        measures.watch_mouth(p, work, time, MEASURE_INTERVAL)
        if not math.isfinite(p.mouth_area_max) or not math.isfinite(measures.mouth_area(p, work)):
            return not_finite
        if has_volume:
            hold.watch(p, work)
        if has_map:
            force_map.look(p)
        if has_closing:
            touched = p.contact_first_time if has_contact else -1.0
            closing.trigger(p, work, time, touched, reached(p, work))
        if watches:
            watch(p, work)
        judge(p, work, time)
        if has_load:
            pull_off.look(p, work, time)
        return 0

    @kernel
    def initialise(p, work, time):
        """Fold, aim, shoot; a fault code or 0.

        Checked  tests/net_capture/test_free_flight.py
        """
        fault = check(p, work)
        if fault != 0:
            return fault
        if not aim(p):
            p.fault_value = p.shot_axis[0]
            return no_axis
        for i in range(work.size):
            work[i] = 0.0
        p.start_time = time
        p.grid = 0
        p.outcome = outcome.FLYING
        p.captured = 0
        p.settled = 0
        p.closed = 0
        p.t_capture = -1.0
        peaks.start(p)
        if has_hardest:
            hardest.start(p)
        p.thread_loss = 0.0
        if presses:
            p.contact_stiffening = 0.0
        if has_bending:
            p.bending_stiffening = 0.0
        fault = choose_substep(p)
        if fault != 0:
            return fault
        gravity.start(p)
        if has_target:
            fault = target.place(p)
            if fault != 0:
                return fault
        if has_gradient:
            gradient.start(p)
        if has_contact:
            limit_way(p)
        graph.lay_out(p, work)
        complete_strips(p, properties(p, work))
        shot.load(p, work)
        if has_bending:
            bending.find(p, work)
        if presses:
            contact.weigh(p, work)
        if presses or has_bending:
            fault = choose_substep(p)
            if fault != 0:
                return fault
            if has_contact:
                limit_way(p)
        if has_threads:
            tensions.list_threads(p, work)
        folding.fold(p, work)
        shot.jitter(p, work)
        shot.shoot(p, work)
        if has_wall:
            wall.start(p, work)
        for axis in range(3):
            p.pull[axis] = 0.0
            p.rest[axis] = 0.0
            p.chaser_place[axis] = p.chaser_start_position[axis]
            p.chaser_drift[axis] = p.chaser_start_velocity[axis]
        if has_closing:
            fault = closing.start(p, work)
            if fault != 0:
                return fault
            outcome.start_enclosure(p)
            p.cord_loss = 0.0
        if has_tether:
            tether.start(p)
        if has_break:
            breaking.start(p)
        measures.start_mouth(p)
        if has_volume:
            hold.start(p)
        if has_index:
            index.start(p)
        if has_load:
            pull_off.start(p)
        if has_wrap:
            wrap.start(p)
        if has_map:
            force_map.start(p)
        if has_self:
            fault = self_contact.start(p, work)
            if fault != 0:
                return fault
        scheme.begin(p, work)
        if has_table:
            table.begin(p, work)
        p.thread_loss = -lag * p.solver_substep * p.thread_power
        if has_air:
            p.air_loss = -lag * p.solver_substep * p.air_power
        if has_bending:
            p.bending_loss = -lag * p.solver_substep * p.bending_power
        start_bodies(p, work)
        if watches:
            watch(p, work)
        if has_contact:
            scheme.place(p, work)
            fault = contact.start(p, work)
            if fault != 0:
                return fault
        if follows:
            scheme.place(p, work)
            pace.start(p, work)
            set_pace(p, work, pace.look(p, work))
        p.energy_start = 0.0
        fault = measure(p, work, 0.0)
        p.energy_start = -p.energy_remainder
        p.energy_remainder = 0.0
        return fault

    @kernel
    def start_bodies(p, work):
        """Give the chaser the recoil of the shot, and take both bodies' velocities back by the scheme's `lag`.

        Checked  tests/net_capture/test_free_flight.py
        """
        late = lag * p.solver_substep
        scheme.show(p, work)
        measures.measure_net(p, work)
        for axis in range(3):
            recoil = p.catch_mass * (p.catch_velocity[axis] - p.chaser_start_velocity[axis])
            p.chaser_drift[axis] -= recoil / p.chaser_mass
        if has_tether:
            tether.pull_chaser(p)
        gravity.kick_chaser(p, p.chaser_place, p.chaser_drift, p.pull, -late)
        if has_ejection:
            ejection.start(p, work)
        if has_target:
            gravity.kick_target(p, p.target_place, p.target_drift, p.rest, -late)

    @kernel
    def set_pace(p, work, step):
        """Go on in substeps no longer than this [s]: velocities and losses that lie back by the scheme's `lag` lie back
        by that of the new substep.

        Checked  tests/net_capture/test_following.py
        """
        substep = pace.settle(p, step)
        if substep != p.solver_substep:
            scheme.change(p, work, substep)
            later = lag * (p.solver_substep - substep)
            p.thread_loss += later * p.thread_power
            if has_closing:
                p.cord_loss += later * p.cord_power
            if has_air:
                p.air_loss += later * p.air_power
            if has_bending:
                p.bending_loss += later * p.bending_power
            if has_tether:
                tether.pull_chaser(p)
            gravity.kick_chaser(p, p.chaser_place, p.chaser_drift, p.pull, later)
            if has_ejection:
                ejection.hold(p, work, p.chaser_drift)
            if has_target:
                gravity.kick_target(p, p.target_place, p.target_drift, p.rest, later)
            p.solver_substep = substep
        p.solver_substep_least = min(p.solver_substep_least, substep)
        p.solver_substep_most = max(p.solver_substep_most, substep)
        p.solver_margin_least = min(p.solver_margin_least, p.pace_seen / substep)

    @kernel
    def advance(p, work, end, anew):
        """Substeps up to the last grid point not after `end`, then the outputs at `end`; left after each look.

        Checked  tests/net_capture/test_free_flight.py
        """
        last = math.floor(reach(p, end) + ON_GRID)
        if anew and p.grid < last:
            peaks.renew(p)
            if has_closing:
                p.cord_tension_peak = 0.0
        while p.grid < last:
            substep(p, work)
            if can_stop:
                fault = stopped_by(p)
                if fault != 0:
                    return fault
            if due(p):
                fault = look(p, work)
                if fault != 0:
                    return fault
                if follows:
                    set_pace(p, work, pace.look(p, work))
                    last = math.floor(reach(p, end) + ON_GRID)
                if p.grid < last:
                    p.fault_time = p.start_time + now(p)
                    return UNDER_WAY
            elif follows and p.pace_late != 0:
                set_pace(p, work, pace.wanted(p))
                last = math.floor(reach(p, end) + ON_GRID)
        ahead = (reach(p, end) - p.grid) * p.solver_substep
        if ahead < ON_GRID * p.solver_substep:
            ahead = 0.0
        return measure(p, work, ahead)

    slots = model_interface.references
    # slot of the variable that each fault names, by its code
    blamed = (0, *(slots.get(fault.blames, 0) for fault in MODEL.faults))

    @entry(model_interface.dtype)
    def model_entry(command, instance, work, time, step):
        """One command of the FMU's shim; a fault code, UNDER_WAY or 0.

        Checked  tests/cosim/test_kernel_fmu_and_fmpy.py
        """
        p = instance[0]
        fault = 0
        p.fault_index = 0
        p.fault_time = 0.0
        p.fault_value = 0.0
        if command == SIZE:
            fault = check(p, work)
        elif command == INITIALISE:
            fault = initialise(p, work, time)
        elif command in (STEP, GO_ON):
            fault = advance(p, work, time + step, command == STEP)
        if fault > 0:
            p.fault_code = fault
            p.fault_time = time
            p.fault_index = blamed[fault]
        return fault

    return model_entry
