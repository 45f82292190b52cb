"""Composition of the net capture model: only here do the terms meet.

One substep, from grid time n h to (n + 1) h (leapfrog: velocities live half a substep back, so one evaluation of the
forces serves; second order, dashpots included, see `environment.kick`; stable to `explicit_step_limit` of
`orbital.oscillators`):

    forces at x_n        threads, closing cord, tension at the vertex; dashpots by the velocity predicted for n h
    kick                 v_{n+1/2} = v_{n-1/2} + h F / m, and gravity
    drift                x_{n+1} = x_n + h v_{n+1/2}
    contact              impulses on the nodes that ended below the surface, which they then have not done
    winches              the cord out at (n + 1) h

The grid is counted in integers from the start, whatever the macro step, so a scene gives the same bits in every tool;
and all times count from there, whatever the clock of the tool says.
"""

import math

import numpy as np
from numba import from_dtype, njit, types

from fmu_src.interface import GO_ON, INITIALISE, SIZE, STEP, UNDER_WAY, check_implemented
from fmu_src.net_capture import (
    book,
    closure,
    contact,
    enclosure,
    environment,
    folding,
    grid,
    interface,
    outcome,
    quality,
    target,
    tether,
    threads,
    topology,
)
from fmu_src.net_capture.terms import NodeTerms
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from orbital.kernel import OPTIONS, kernel

ON_GRID = 1e-3
"""Share of a substep by which a communication point may miss the grid and still count as on it: masters add up
times."""

IMPLEMENTED = {
    "net": ("square",),
    "gravity": ("none", "hill"),
    "target": ("box",),
    "contact": ("inelastic",),
    "closing": ("winches",),
    "tether": ("slack",),
    "settling": ("speed",),
    "nodes": NodeTerms(),
}
"""Terms that are composed here."""


def make_entry(terms):
    """Entry of the model built with these terms, `entry(command, record, work, time, step) -> status`."""
    check_implemented(interface.MODEL, IMPLEMENTED, terms)
    model_interface = interface.MODEL.interface(terms)
    has_target = "target" in terms
    has_contact = "contact" in terms
    has_closing = "closing" in terms
    has_tether = "tether" in terms
    has_nodes = "nodes" in terms
    capacity = int(terms["nodes"]) if has_nodes else 0
    is_hill = terms["gravity"] == "hill"
    kick_body = environment.hill_kick_body if is_hill else environment.no_kick_body
    kick_nodes = environment.hill_kick_nodes if is_hill else environment.no_kick_nodes
    choose_substep = grid.make_choose_substep(terms)
    energy_balance = book.make_balance(terms)
    weigh_nodes = environment.hill_weigh_nodes if is_hill else environment.no_weigh_nodes
    share_inside = enclosure.make_share(target.sample, target.SAMPLES)
    judge = outcome.make_judge(terms, tether.towards_chaser, share_inside)
    frame_rate_of = environment.hill_rate if is_hill else environment.no_rate

    @kernel
    def check(p):
        """Fault code of a parameter combination that makes no net, or 0; sets the counts."""
        meshes = round(p.net_side / p.net_mesh)
        if abs(p.net_side / p.net_mesh - meshes) > 1e-6 * meshes or meshes < 2:
            p.fault_value = p.net_side / p.net_mesh
            return interface.NO_WHOLE_MESHES
        if meshes * p.net_segments > interface.LARGEST_MESH:
            p.fault_value = meshes * p.net_segments
            return interface.TOO_FINE
        if p.net_fold_side >= p.net_side:
            p.fault_value = p.net_fold_side
            return interface.FOLD_TOO_LARGE
        if has_closing:
            if p.closing_rings >= meshes:
                p.fault_value = p.closing_rings
                return interface.TOO_MANY_RINGS
        p.knots = int(meshes) + 1
        p.net_nodes = p.knots * p.knots + 2 * (p.net_segments - 1) * p.knots * (p.knots - 1)
        p.net_threads = 2 * p.net_segments * p.knots * (p.knots - 1)
        p.node_slots = topology.node_slots(p.knots, p.net_segments)
        p.thread_slots = topology.thread_slots(p.knots, p.net_segments)
        p.strips = topology.strip_count(p.net_segments)
        if has_nodes:
            if p.net_nodes > capacity:
                p.fault_value = p.net_nodes
                return interface.TOO_MANY_NODES
        p.work_size = topology.work_size(p.knots, p.net_segments)
        return 0

    @kernel
    def add_forces(p, work):
        """All forces at the present positions into the force planes."""
        threads.add_thread_forces(p, work)
        if has_closing:
            closure.pull_mouth(p, work)
        if has_tether:
            tether.pull_vertex(p, work)

    @kernel
    def clear_forces(p, work):
        """Nothing in the force planes."""
        for axis in range(3):
            force = topology.node_plane(p, work, topology.FX + axis)
            for i in range(force.size):
                force[i] = 0.0

    @kernel
    def kick_bodies(p, work, h):
        """Chaser and target by one kick; their own acceleration goes into `p.pull`."""
        if has_tether:
            tether.pull_chaser(p, work, p.pull)
        kick_body(p, p.chaser_place, p.chaser_drift, p.pull, h)
        if has_target:
            kick_body(p, p.target_place, p.target_drift, p.rest, h)

    @kernel
    def substep(p, work):
        """One step of the grid."""
        h = p.solver_substep
        frame_rate = frame_rate_of(p)
        add_forces(p, work)
        p.thread_loss += h * p.thread_power
        if has_closing:
            p.cord_loss += h * p.cord_power
        kick_bodies(p, work, h)
        slots = p.node_slots
        for start in range(0, slots, topology.CHUNK):
            n = min(topology.CHUNK, slots - start)
            kick_nodes(p, work, start, n, h)
            threads.drift_nodes(p, work, start, n, h)
            if has_contact:
                contact.touch_nodes(p, work, start, n, frame_rate, h)
        for axis in range(3):
            p.chaser_place[axis] += h * p.chaser_drift[axis]
        if has_target:
            target.drift_target(p, frame_rate, h)
        if has_closing:
            closure.wind_cord(p, work, h)
        if has_tether:
            tether.reel_in(p, work)
        p.grid += 1

    @kernel
    def begin_leapfrog(p, work):
        """Take the velocities of the start half a substep back; as they are they are those predicted for the start."""
        h = p.solver_substep
        for axis in range(3):
            p.pull[axis] = 0.0
            p.rest[axis] = 0.0
            velocity = topology.node_plane(p, work, topology.U + axis)
            predicted = topology.node_plane(p, work, topology.P + axis)
            for i in range(velocity.size):
                predicted[i] = velocity[i]
        add_forces(p, work)
        kick_bodies(p, work, -0.5 * h)
        kick_nodes(p, work, 0, p.node_slots, -0.5 * h)
        for axis in range(3):
            velocity = topology.node_plane(p, work, topology.U + axis)
            predicted = topology.node_plane(p, work, topology.P + axis)
            force = topology.node_plane(p, work, topology.FX + axis)
            for i in range(velocity.size):
                change = 2.0 * (predicted[i] - velocity[i])
                predicted[i] = velocity[i] - change
                force[i] = 0.0
        p.thread_loss = -0.5 * h * p.thread_power
        if has_closing:
            p.cord_loss = 0.0
        if has_tether:
            p.tether_work = 0.0
            p.tether_reach = tether.towards_chaser(p, work)

    @kernel
    def now(p):
        """Grid time since the shot [s]."""
        return p.grid * p.solver_substep

    @kernel
    def look(p, work):
        """Every measure interval: mouth, trigger, capture and outcome; fault code 1 if the net has blown up."""
        time = now(p)
        quality.watch_mouth(p, work, time, grid.MEASURE_INTERVAL)
        if not math.isfinite(p.mouth_area_max) or not math.isfinite(quality.mouth_area(p, work)):
            return interface.NOT_FINITE
        if has_closing:
            touched = p.contact_first_time if has_contact else -1.0
            beyond = quality.least_depth_beyond(p, work, p.target_place) if has_target else -math.inf
            closure.pull_trigger(p, work, time, touched, beyond)
        judge(p, work, time)
        return 0

    @kernel
    def measure(p, work, ahead):
        """All outputs, `ahead` seconds after the last substep; nothing of the state changes."""
        half = 0.5 * p.solver_substep
        add_forces(p, work)
        weigh_nodes(p, work)
        elastic = threads.elastic_energy(p, work)
        p.thread_dissipated = p.thread_loss + half * p.thread_power
        if has_closing:
            elastic += closure.stored_in_cord(p, work)
            p.cord_dissipated = p.cord_loss + half * p.cord_power
            p.closed = 1 if p.mouth_locked_pairs == 4 else 0
        quality.measure_net(p, work, ahead)
        p.energy_elastic = elastic
        p.energy_total = p.energy_kinetic + elastic
        place_bodies(p, work, ahead)
        quality.add_body_momenta(p, p.chaser_mass, p.chaser_position, p.chaser_velocity)
        if has_target:
            target.measure_target(p)
            target.turn(p.target_attitude, p.target_pose, p.target_rate, p, frame_rate_of(p), ahead)
            quality.add_body_momenta(p, p.target_mass, p.target_position, p.target_velocity)
            for axis in range(3):
                p.angular_momentum[axis] += p.target_spin[axis]
            if has_closing:
                p.mouth_girth = p.girth
        if has_contact:
            contact.measure_contact(p, work)
        if has_tether:
            tether.measure_tether(p)
        if has_nodes:
            write_nodes(p, work, ahead)
        quality.measure_mouth(p, work)
        quality.collect_peaks(p, work)
        if has_closing:
            if p.cord_tension_peak > p.cord_tension_max:
                p.cord_tension_max = p.cord_tension_peak
        p.solver_steps = p.grid
        clear_forces(p, work)
        balance = energy_balance(p, work)
        p.energy_remainder = p.energy_start - balance
        finite = math.isfinite(balance) and math.isfinite(p.momentum[0] + p.momentum[1] + p.momentum[2])
        return 0 if finite else interface.NOT_FINITE

    @kernel
    def place_bodies(p, work, ahead):
        """Places `ahead` seconds on and velocities now of chaser and target: half a kick after those they keep."""
        for axis in range(3):
            p.chaser_position[axis] = p.chaser_place[axis] + ahead * p.chaser_drift[axis]
            p.chaser_velocity[axis] = p.chaser_drift[axis]
            if has_target:
                p.target_position[axis] = p.target_place[axis] + ahead * p.target_drift[axis]
                p.target_velocity[axis] = p.target_drift[axis]
        if has_tether:
            tether.pull_chaser(p, work, p.pull)
        kick_body(p, p.chaser_place, p.chaser_velocity, p.pull, 0.5 * p.solver_substep)
        if has_target:
            kick_body(p, p.target_place, p.target_velocity, p.rest, 0.5 * p.solver_substep)

    @kernel
    def write_nodes(p, work, ahead):
        """Positions of all nodes, unused slots passed over."""
        mass = topology.node_plane(p, work, topology.MASS)
        out = 0
        for node in range(mass.size):
            if mass[node] > 0.0:
                for axis in range(3):
                    p.node_position[out, axis] = quality.position(p, work, axis, node, ahead)
                out += 1

    @kernel
    def initialise(p, work, time):
        """Fold, aim, shoot; a fault code or 0."""
        fault = check(p)
        if fault == 0:
            fault = folding.aim(p)
        if fault != 0:
            return fault
        for i in range(work.size):
            work[i] = 0.0
        p.start_time = time
        p.grid = 0
        p.outcome = outcome.FLYING
        p.captured = 0
        p.settled = 0
        p.closed = 0
        p.t_capture = -1.0
        p.thread_tension_max = 0.0
        p.thread_tension_max_index = 0
        fault = choose_substep(p)
        if fault != 0:
            return fault
        if is_hill:
            a = EARTH_EQUATORIAL_RADIUS + p.orbit_altitude
            p.mean_motion = math.sqrt(EARTH_MU / (a * a * a))
        if has_target:
            fault = target.place_target(p)
            if fault != 0:
                return fault
        topology.lay_out_strips(p, work)
        topology.lay_out_threads(p, work)
        topology.lay_out_masses(p, work)
        folding.fold_flat(p, work)
        folding.jitter(p, work)
        folding.shoot(p, work)
        if has_contact:
            contact.start_contact(p)
            if contact.inside(p, work) > 0:
                return interface.INSIDE_TARGET
        if has_closing:
            closure.start_closing(p)
            outcome.start_enclosure(p)
        quality.start_mouth(p)
        quality.measure_net(p, work, 0.0)
        for axis in range(3):
            p.chaser_place[axis] = p.chaser_start_position[axis]
            recoil = p.catch_mass * (p.catch_velocity[axis] - p.chaser_start_velocity[axis])
            p.chaser_drift[axis] = p.chaser_start_velocity[axis] - recoil / p.chaser_mass
        begin_leapfrog(p, work)
        p.energy_start = 0.0
        fault = measure(p, work, 0.0)
        p.energy_start = -p.energy_remainder
        p.energy_remainder = 0.0
        return fault

    @kernel
    def advance(p, work, end, anew):
        """Substeps up to the last grid point not after `end`, then the outputs at `end`; left after each look."""
        q = (end - p.start_time) / p.solver_substep
        last = math.floor(q + ON_GRID)
        if anew and p.grid < last:
            quality.clear_peaks(p, work)
            if has_closing:
                p.cord_tension_peak = 0.0
        while p.grid < last:
            substep(p, work)
            if p.grid % p.measure_every == 0:
                fault = look(p, work)
                if fault != 0:
                    return fault
                if p.grid < last:
                    p.fault_time = p.start_time + now(p)
                    return UNDER_WAY
        ahead = (q - p.grid) * p.solver_substep
        if ahead < ON_GRID * p.solver_substep:
            ahead = 0.0
        return measure(p, work, ahead)

    slots = model_interface.references
    # slot of the variable that each fault names, by its code
    blamed = tuple(slots.get(interface.BLAMED.get(code, ""), 0) for code in range(max(interface.BLAMED) + 1))

    @kernel
    def explain(p, fault, time):
        """Put the fault in the record, and the value of what it names unless that is there already."""
        p.fault_code = fault
        p.fault_time = time
        p.fault_index = blamed[fault]
        if fault == interface.NO_AXIS:
            p.fault_value = p.shot_axis[0]
        if has_target:
            if fault == interface.NO_QUATERNION:
                p.fault_value = p.target_start_attitude[0]
            if fault == interface.NO_INERTIA:
                p.fault_value = p.target_principal_inertia[0]
            if fault == interface.INSIDE_TARGET:
                p.fault_value = p.chaser_start_position[0]

    record = from_dtype(np.dtype(model_interface.dtype))
    signature = types.int32(types.int64, record[::1], types.float64[::1], types.float64, types.float64)

    @njit(signature, **OPTIONS)
    def entry(command, instance, work, time, step):
        p = instance[0]
        fault = 0
        p.fault_index = 0
        p.fault_time = 0.0
        p.fault_value = 0.0
        if command == SIZE:
            fault = check(p)
        elif command == INITIALISE:
            fault = initialise(p, work, time)
        elif command in (STEP, GO_ON):
            fault = advance(p, work, time + step, command == STEP)
        if fault > 0:
            explain(p, fault, time)
        return fault

    return entry
