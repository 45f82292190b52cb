"""The tethered removal, composed of its terms: the one entry that an FMU calls."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from fmu_src.interface import DIFFERENTIATE, GO_ON, INITIALISE, REFRESH, SIZE, STEP, UNDER_WAY, check_implemented
from fmu_src.limits import make_limits
from fmu_src.tethered_deorbit.acting import IDLE, together
from fmu_src.tethered_deorbit.answers import make_answer
from fmu_src.tethered_deorbit.aocs import make_aocs
from fmu_src.tethered_deorbit.appendage import make_appendage
from fmu_src.tethered_deorbit.bodies import KINDS, make_bodies
from fmu_src.tethered_deorbit.breaking import ONE_PIECE, breakable
from fmu_src.tethered_deorbit.derivatives import make_differentiate
from fmu_src.tethered_deorbit.ends import ENDS, make_ends
from fmu_src.tethered_deorbit.environment import FIELDS, make_environment
from fmu_src.tethered_deorbit.environment.friction import telling
from fmu_src.tethered_deorbit.environment.perturbed import make_perturbing
from fmu_src.tethered_deorbit.equations import make_equations
from fmu_src.tethered_deorbit.events import make_events
from fmu_src.tethered_deorbit.extremes import make_extremes
from fmu_src.tethered_deorbit.faults import blame, fail
from fmu_src.tethered_deorbit.idle import never, zero
from fmu_src.tethered_deorbit.inputs import make_inputs
from fmu_src.tethered_deorbit.interface import BAD_PARAMETER, GROUND, MODEL, NOT_FINITE, TIME_GAP, TOO_MANY_EVENTS
from fmu_src.tethered_deorbit.layout import ATTITUDE, PAIR, layout_of, places_of
from fmu_src.tethered_deorbit.levels.averaged import leapt
from fmu_src.tethered_deorbit.levels.choosing import check_level, make_held_of, make_level
from fmu_src.tethered_deorbit.minded import LIMITED
from fmu_src.tethered_deorbit.nodes.books import Watch
from fmu_src.tethered_deorbit.nodes.chain import make_nodes
from fmu_src.tethered_deorbit.outputs import begin_tug, clear_tugs, make_publish, note_pull
from fmu_src.tethered_deorbit.parted import make_loose
from fmu_src.tethered_deorbit.reel import LAWS, WINCHES, components, make_reel
from fmu_src.tethered_deorbit.reel_rows import INPUTS
from fmu_src.tethered_deorbit.release import releasable
from fmu_src.tethered_deorbit.schemes import SCHEMES
from fmu_src.tethered_deorbit.sights import Sights
from fmu_src.tethered_deorbit.start import make_start
from fmu_src.tethered_deorbit.stops import ACTS, EDGES, LINE
from fmu_src.tethered_deorbit.thrust import DIRECTIONS, make_thrust
from fmu_src.tethered_deorbit.tolerances import make_squared_error
from fmu_src.tethered_deorbit.trajectory import make_trajectory
from orbital.kernel import entry, kernel
from orbital.oscillators import reduced_mass
from orbital.vectors import Array

EVENT_LIMIT = 1_000_000
SLICE = 4096
"""Steps of the integrator after which a macro step is left, so that it can be told where it is: some 20 ms."""
GAP, GAP_SHARE = 16.0 * 2.220446049250313e-16, 1e-6
"""By how much a communication point may miss the end of the last macro step, of the times and of the step: the rounding
of times that a master adds up."""

IMPLEMENTED = {
    "reel": (*LAWS, *WINCHES),
    "lumped": ("nodes",),
    "net": ("series",),
    "thrust": DIRECTIONS,
    "environment": FIELDS,
    "solver": tuple(SCHEMES),
    "burn": ("timed", "arcs"),
    "engine": ("electric", "chemical"),
    "plume": ("beam",),
    "aocs": ("wheels",),
    "appendage": ("frozen",),
    "ends": ("watched",),
    "break": ("breaks",),
    "release": ("time", "altitude", "perigee"),
    "level": ("settled", "event_map", "averaged"),
    "friction": ("coulomb",),
    "oblateness": ("J2", "J4"),
    "air": ("exponential", "nrlmsis"),
    "third_bodies": ("sun_and_moon", "sun", "moon"),
    "shadow": ("cylinder", "cone"),
    "sunlight": ("pressure",),
    "power": ("solar",),
    "electrodynamic": ("dipole", "igrf"),
    **KINDS,
}
"""Terms that are composed here."""


def make_entry(terms: Mapping[str, str]) -> Any:
    """The compiled entry `(command, record, work, time, step) -> status` of the model with the given terms.

    terms         of `MODEL.groups`; without "thrust" there is no thruster in it, and all but "reel" have defaults

    Checked  tests/tethered_deorbit/test_macro_step.py
    """
    interface = MODEL.interface(terms)
    terms = interface.terms
    check_implemented(MODEL, IMPLEMENTED, terms)
    environment = make_environment(terms["environment"], interface)
    command_slot = next(interface.references[name] for name in INPUTS if name in interface.references)
    limits = make_limits(interface, *LIMITED)
    layout = layout_of(terms, *components(terms["reel"]))
    perturbing = make_perturbing(interface, layout)
    bodies = make_bodies(terms, environment.place, environment.gradient, layout.size, interface)
    spin = PAIR + ATTITUDE - 3 if terms["target"] != "point" else -1
    sights = Sights(layout.reel, spin, bodies.line, environment.frame, make_loose(terms))
    if "net" in terms and terms["reel"] != "locked":
        raise ValueError(f"{MODEL.name}: a net in series goes with reel = locked, not {terms['reel']!r}")
    reel, watch, parting = make_reel(terms["reel"], interface, sights), Watch(), ONE_PIECE
    if "lumped" in terms:
        for group, _, carried in MODEL.unfit(terms):
            raise ValueError(f"{MODEL.name}: nodes go with {group} = {' or '.join(carried)}, not {terms[group]!r}")
        reel, bodies, watch, parting = make_nodes(reel, bodies, environment, perturbing.beside, layout, interface)
    reel = releasable(
        breakable(telling(reel, terms, layout), terms, bodies.line, parting), terms, interface, parting.cut
    )
    thrust = make_thrust(terms, environment.place, environment.along_track, bodies.along, layout, interface)

    aocs = make_aocs(terms, environment.frame, bodies.along, layout, interface)
    check_level(MODEL.name, terms)
    held = make_held_of(terms, reel, bodies)
    inertial, derivative = make_equations(environment, perturbing, reel, thrust, bodies, aocs, held, layout)
    scheme = SCHEMES[terms["solver"]](
        derivative, make_squared_error(bodies, held), layout.moving, layout.size - layout.moving
    )
    places = places_of(layout, scheme)
    level, leap = make_level(terms, derivative, scheme, reel, bodies, held, layout, places)
    leaps = leap is not never
    events = make_events(reel, bodies, held, scheme, places)
    extremes = make_extremes(events, held, places, "release" in terms, watch)
    acting = together((reel.acting, thrust.acting, perturbing.acting, make_ends(terms, bodies.line, interface)))
    acts, turns = acting is not IDLE, reel.turn is not zero
    trajectory = make_trajectory(derivative, bodies, scheme, events, acting, held, level, places)
    inputs = make_inputs(reel, thrust, bodies, trajectory, extremes, acting, places, command_slot)
    start_state, freeze = make_start(environment, bodies, interface), make_appendage(terms, interface)
    publish = make_publish(reel, environment, perturbing, bodies, layout)
    differentiate = make_differentiate(inertial, reel, thrust, environment, perturbing, bodies)
    answer = make_answer(reel, thrust, held, level, trajectory, inputs, publish, differentiate, places, command_slot)
    size, spent, work_size = layout.size, layout.spent, places.total
    end_state, here_state, slope_state, low_error = places.end, places.here, places.slope, places.low

    @kernel
    def finite(state: Array) -> bool:
        """Whether no component of a state is infinite or not a number.

        Checked  tests/tethered_deorbit/test_robust.py
        """
        total = 0.0
        for i in range(size):
            total += state[i]
        return math.isfinite(total)

    @kernel
    def initialise(record: Any, work: Array) -> int:
        """Fill state, work memory and outputs from the parameters; returns 0 or a fault.

        Checked  tests/tethered_deorbit/test_start.py, test_macro_step.py: nothing is left of an earlier run
        """
        r = record[0]
        slot, value = limits(record)
        if slot >= 0:
            return fail(record, blame(record, BAD_PARAMETER, slot, value), 0.0)
        r.state_total_mass = r.chaser_mass + r.target_mass
        r.state_chaser_share = r.chaser_mass / r.state_total_mass
        r.state_target_share = r.target_mass / r.state_total_mass
        r.state_reduced_mass = reduced_mass(r.chaser_mass, r.target_mass)
        environment.begin(record)
        perturbing.begin(record)
        code = bodies.begin(record)
        if code != 0:
            return fail(record, code, 0.0)
        command, _ = reel.asked(record)
        code = reel.prepare(record, command, 0.0, 0.0)
        if code != 0:
            return fail(record, code, 0.0)
        thrust.reset(record)
        code = thrust.check(record)
        if code == 0:
            code = thrust.start(record)
        if code != 0:
            return fail(record, code, 0.0)
        force, _ = thrust.asked(record)
        thrust.put(record, force, 0.0)
        end = work[end_state:here_state]
        code = start_state(record, end, reel.start_limit(record))
        if code != 0:
            return fail(record, code, 0.0)
        code = freeze(record, end)
        if code == 0:
            code = aocs.begin(record, end)
        if code != 0:
            return fail(record, code, 0.0)
        for i in range(spent, size):
            end[i] = 0.0
        thrust.weigh(record, end)
        if not finite(end):
            return fail(record, blame(record, NOT_FINITE, 0, 0.0), 0.0)
        if acts:
            code = acting.begin(record, end)
            if code != 0:
                return fail(record, code, 0.0)
        r.state_published = 0.0
        r.state_changes = 0
        r.solver_steps = 0
        r.solver_rejected = 0
        clear_tugs(record)
        speed = inputs.judge_line(record, end)
        r.state_step = 0.0
        level.begin(record)
        trajectory.restart(record, work, 0.0)
        r.state_since = 0.0
        separation, length, _ = bodies.line(record, end)
        publish(record, end, separation, length, speed, 0.0, 0.0)
        if r.state_taut:
            begin_tug(record, 0.0, speed)
            note_pull(record, r.tether_tension)
        extremes.start(record)
        thrust.publish(record, end, 0.0)
        aocs.publish(record, end)
        return 0

    @kernel
    def line_energy(record: Any, length: float) -> float:
        """Energy stored in the line [J] at the end of the step.

        Checked  tests/tethered_deorbit/test_wrapping.py: a taut line slips
        """
        r = record[0]
        return float(reel.energy(record, length, r.state_since + r.state_step)) if r.state_taut else 0.0

    @kernel
    def change_line(record: Any, work: Array) -> None:
        """The step ended where the line changes between slack and taut, or comes over other edges: let it.

        Checked  tests/consistency/test_table2.py: the first five tugs
        """
        r = record[0]
        end = work[end_state:here_state]
        _, length, speed = trajectory.state_at(record, work, r.state_end, end)
        was_taut, lost = r.state_taut, 0.0
        if r.state_event == EDGES:
            reel.see(record, end)
            stored = line_energy(record, length)
            bodies.renew(record, end)
            inputs.judge_line(record, end)
            _, length, _ = bodies.line(record, end)
            lost = stored - line_energy(record, length)
        elif r.state_taut:
            r.state_taut = 0
        else:
            r.state_taut = 1
            begin_tug(record, r.state_end, speed)
        if turns and r.state_taut != was_taut:
            lost -= inputs.turn(record, work, length)
        if r.state_event == EDGES:
            bodies.book(record, lost)
        trajectory.restart(record, work, r.state_end)

    @kernel
    def show(record: Any, work: Array, time: float) -> int:
        """Publish what the pair is at a time within the current step, or at its end; returns 0 or a fault.

        Checked  tests/tethered_deorbit/test_macro_step.py; test_ends.py: the outputs of an end are those of its instant
        """
        r = record[0]
        extremes.note(record, work, time)
        here = work[here_state:slope_state]
        separation, length, speed = trajectory.state_at(record, work, time, here)
        if not finite(here):
            return fail(record, blame(record, NOT_FINITE, 0, 0.0), time)
        radius = environment.fallen(here[0:3])
        if radius >= 0.0:
            return fail(record, blame(record, GROUND, 0, radius), time)
        thrust.weigh(record, here)
        publish(record, here, separation, length, speed, r.state_since + (time - r.state_begin), time)
        thrust.publish(record, here, time)
        aocs.publish(record, here)
        r.state_published = time
        level.publish(record)
        r.state_changes = 0
        extremes.publish(record)
        return 0

    @kernel
    def carry_over(record: Any, work: Array, target: float) -> bool:
        """Carry the pair over many revolutions up to a communication point [s]; false where it is to be stepped.

        Checked  tests/tethered_deorbit/test_averaged.py
        """
        r = record[0]
        now = r.state_end
        here = work[here_state:slope_state]
        trajectory.state_at(record, work, now, here)
        later = leap(record, here, work[slope_state:low_error], now, target)
        if not later > now:
            return False
        if acts and (acting.due(record) <= later or not acting.holds(record, here, 0.0)):
            r.state_next_leap = target
            return False
        for i in range(size):
            work[end_state + i] = here[i]
        leapt(record, now, later)
        trajectory.restart(record, work, later)
        return True

    @kernel
    def step_to(record: Any, work: Array, time: float, step: float, anew: bool) -> int:
        """Take a macro step, or go on with it; it is left after a slice of steps, and nothing is then half done.

        time, step    communication point by the importer's clock, and size   [s]
        anew          it begins; else it goes on

        Returns 0, UNDER_WAY or a fault.

        Checked  tests/tethered_deorbit/test_macro_step.py; tests/packaging/test_long_steps.py: left and gone on with
        """
        r = record[0]
        if not (math.isfinite(time) and math.isfinite(step) and step >= 0.0):
            return fail(record, blame(record, TIME_GAP, 0, step), r.state_published)
        target = time + step - r.state_start
        gap = GAP * max(abs(time), abs(r.state_start)) + GAP_SHARE * step
        if abs(time - r.state_start - r.state_published) > gap:
            return fail(record, blame(record, TIME_GAP, 0, time), r.state_published)
        if not target > r.state_published or step == 0.0:
            return 0
        duration = target - r.state_published
        if anew:
            code: int = inputs.take(record, work, duration)
            if code != 0:
                return code
            extremes.begin_macro_step(record)
        moving = r.state_command_rate != 0.0 or r.state_thrust_rate != 0.0
        left = SLICE
        while r.state_end <= target:
            if left == 0:
                r.fault_time = r.state_start + r.state_end
                return UNDER_WAY
            left -= 1
            radius = environment.fallen(work[end_state : end_state + 3])
            if radius >= 0.0:
                return fail(record, blame(record, GROUND, 0, radius), r.state_end)
            extremes.note(record, work, r.state_end)
            event = r.state_event
            if event:
                r.state_changes += 1
                if r.state_changes > EVENT_LIMIT:
                    return fail(record, blame(record, TOO_MANY_EVENTS, 0, float(r.state_changes)), r.state_end)
                if event in (LINE, EDGES):
                    change_line(record, work)
            if acts and (event == ACTS or acting.due(record) <= r.state_end):
                code = inputs.act(record, work, target, event == ACTS)
                if code in ENDS:
                    show(record, work, r.state_end)
                if code != 0:
                    return code
            # A moving input is known up to the communication point only: there the last step ends.
            if moving and r.state_end == target:
                break
            if leaps and not moving and event == 0 and carry_over(record, work, target):
                continue
            longest = target - r.state_end if moving else math.inf
            if acts:
                longest = min(longest, acting.due(record) - r.state_end)
            code = trajectory.advance(record, work, longest)
            if code != 0:
                return fail(record, code, r.state_begin)
        code = show(record, work, target)
        if code != 0:
            return code
        if moving:
            return int(inputs.leave(record, work, duration))
        return 0

    @entry(interface.dtype)
    def model_entry(command: int, record: Any, work: Array, time: float, step: float) -> int:
        """The entry of `fmu_src.interface`, by command; returns a status.

        Checked  tests/tethered_deorbit/test_macro_step.py, test_robust.py: no such command
        """
        r = record[0]
        r.fault_code = 0
        r.fault_index = 0
        r.fault_time = 0.0
        r.fault_value = 0.0
        if command == SIZE:
            r.work_size = work_size
            return 0
        if command == INITIALISE:
            r.state_start = time
            return initialise(record, work)
        if command in (STEP, GO_ON):
            return step_to(record, work, time, step, command == STEP)
        if command == REFRESH:
            return answer(record, work, False)
        if command == DIFFERENTIATE:
            return answer(record, work, True)
        return fail(record, blame(record, BAD_PARAMETER, 0, float(command)), r.state_published)

    return model_entry
