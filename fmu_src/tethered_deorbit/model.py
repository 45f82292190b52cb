"""The tethered removal, composed of its terms: the one entry that an FMU calls."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numba
from numba import njit

from fmu_src.integrators import make_dop853
from fmu_src.interface import INITIALISE, REFRESH, SIZE, STEP
from fmu_src.tethered_deorbit import layout
from fmu_src.tethered_deorbit.environment import add_gravity
from fmu_src.tethered_deorbit.events import make_events
from fmu_src.tethered_deorbit.interface import BAD_PARAMETER, GROUND, MODEL, NOT_FINITE, TIME_GAP, TOO_MANY_EVENTS
from fmu_src.tethered_deorbit.outputs import begin_tug, clear_tugs, make_publish
from fmu_src.tethered_deorbit.reel import make_reel
from fmu_src.tethered_deorbit.start import start_state
from fmu_src.tethered_deorbit.tether import add_tension, elastic_stiffness, length_rate
from fmu_src.tethered_deorbit.thrust import make_no_thrust, make_thrust
from fmu_src.tethered_deorbit.trajectory import make_measure, make_trajectory
from fmu_src.tethered_deorbit.turning import add_turning
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from orbital.kernel import OPTIONS, kernel
from orbital.twobody import mean_motion
from orbital.vectors import Array, norm

EVENT_LIMIT = 1_000_000
TIME_DRIFT = 1.0e-9
"""By how much, relative, a communication point may miss the end of the last macro step: masters accumulate t += h."""


def make_entry(terms: Mapping[str, str]) -> Any:
    """The compiled entry `(command, record, work, time, step) -> status` of the model with the given terms.

    terms         {"reel": ..., "thrust": ...}; without "thrust" there is no thruster in it

    Checked  tests/tethered_deorbit/test_macro_step.py
    """
    reel = make_reel(terms["reel"], elastic_stiffness)
    thrust = make_thrust(terms["thrust"]) if "thrust" in terms else make_no_thrust()

    @kernel
    def derivative(record: Any, state: Array, rate: Array) -> None:
        add_gravity(record, state, rate)
        thrust.add(record, state, rate)
        if record[0].state_taut:
            length = norm(state[6:9])
            speed = length_rate(state[6:9], state[9:12], length)
            add_tension(record, state, rate, reel.tension(record, length, speed), length)
            add_turning(record, state, rate, -1.0)

    scheme = make_dop853(derivative, make_measure(), layout.SIZE)
    events = make_events(reel, scheme)
    trajectory = make_trajectory(derivative, scheme, events)
    publish = make_publish(reel)

    @kernel
    def fail(record: Any, code: int, time: float, value: float) -> int:
        r = record[0]
        r.fault_code = code
        r.fault_index = 0
        r.fault_time = time
        r.fault_value = value if math.isfinite(value) else 0.0
        return code

    @kernel
    def judge_line(record: Any, state: Array) -> float:
        """Decide afresh whether the line is taut, from the law alone; returns its rate of lengthening [m/s]."""
        r = record[0]
        length = norm(state[6:9])
        speed: float = length_rate(state[6:9], state[9:12], length)
        taut = reel.onset(record, length, speed) > 0.0 and reel.tension(record, length, speed) > 0.0
        r.state_taut = 1 if taut else 0
        return speed

    @kernel
    def finite(state: Array) -> bool:
        total = 0.0
        for i in range(layout.SIZE):
            total += state[i]
        return math.isfinite(total)

    @kernel
    def initialise(record: Any, work: Array, time: float) -> int:
        r = record[0]
        if not (r.chaser_mass > 0.0 and r.target_mass > 0.0):
            return fail(record, BAD_PARAMETER, time, min(r.chaser_mass, r.target_mass))
        if not min(r.solver_tolerance_orbit, r.solver_tolerance_separation, r.solver_tolerance_stretch) > 0.0:
            return fail(record, BAD_PARAMETER, time, r.solver_tolerance_stretch)
        r.state_total_mass = r.chaser_mass + r.target_mass
        r.state_chaser_share = r.chaser_mass / r.state_total_mass
        r.state_target_share = r.target_mass / r.state_total_mass
        r.state_reduced_mass = r.chaser_mass * r.state_target_share
        r.state_mean_motion = mean_motion(EARTH_EQUATORIAL_RADIUS + r.orbit_altitude, EARTH_MU)
        code = reel.prepare(record, r.reel_length_offset)
        if code != 0:
            return fail(record, code, time, r.reel_length_offset)
        thrust.reset(record, time)
        code = thrust.prepare(record, time)
        if code != 0:
            return fail(record, code, time, 0.0)
        end = work[layout.END : layout.HERE]
        code = start_state(record, end, reel.start_limit(record))
        if code != 0:
            return fail(record, code, time, r.start_separation)
        if not finite(end):
            return fail(record, NOT_FINITE, time, 0.0)
        r.state_published = time
        r.solver_steps = 0
        r.solver_rejected = 0
        clear_tugs(record)
        speed = judge_line(record, end)
        trajectory.restart(record, work, time)
        publish(record, end, norm(end[6:9]), speed)
        r.tether_tension_peak = r.tether_tension
        if r.state_taut:
            begin_tug(record, time, speed)
            r.state_tug_peak = r.tether_tension
            r.tug_peak[0] = r.tether_tension
        thrust.publish(record, time)
        return 0

    @kernel
    def take_inputs(record: Any, work: Array, time: float) -> int:
        """Put changed inputs in force at the last communication point, and begin the trajectory anew there."""
        r = record[0]
        if not math.isfinite(r.reel_length_offset):
            return fail(record, BAD_PARAMETER, time, 0.0)
        if not thrust.changed(record) and r.reel_length_offset == r.state_length_offset:
            return 0
        here = work[layout.HERE : layout.SLOPE]
        trajectory.state_at(record, work, r.state_published, here)
        for i in range(layout.SIZE):
            work[layout.END + i] = here[i]
        # What the tug has reached so far is what was published; the rest of the step did not happen.
        was_taut = r.state_taut
        if was_taut:
            r.state_tug_peak = r.tug_peak[0]
        code = reel.prepare(record, r.reel_length_offset)
        if code != 0:
            return fail(record, code, time, r.reel_length_offset)
        code = thrust.prepare(record, r.state_published)
        if code != 0:
            return fail(record, code, time, 0.0)
        speed = judge_line(record, here)
        if r.state_taut and not was_taut:
            begin_tug(record, r.state_published, speed)
        trajectory.restart(record, work, r.state_published)
        return 0

    @kernel
    def note_tension(record: Any, work: Array, until: float) -> None:
        """Carry the peaks from the last communication point, or the begin of the step, up to `until`."""
        r = record[0]
        if r.state_taut == 0 or r.state_step == 0.0:
            return
        stages = work[layout.STAGES : layout.DENSE]
        _, _, begin, begin_rate = events.signals(record, work[layout.BEGIN : layout.END], stages[0 : layout.SIZE])
        _, _, end, end_rate = events.signals(
            record, work[layout.END : layout.HERE], stages[12 * layout.SIZE : 13 * layout.SIZE]
        )
        whole = max(begin, end)
        change, begin_change, end_change = end - begin, r.state_step * begin_rate, r.state_step * end_rate
        still = max(abs(begin_change), abs(end_change)) <= 4.0 * r.state_stiffness * r.state_taut_tolerance
        steady = max(abs(begin_change - change), abs(end_change - change)) <= 0.25 * abs(change)
        short = (begin_rate >= 0.0) == (end_rate >= 0.0) and r.state_step * r.state_frequency < 1.5
        if not (still or steady or short):
            whole = events.largest_tension(record, work, 0.0, 1.0)
        complete = until >= r.state_end
        final = 1.0 if complete else max(0.0, (until - r.state_begin) / r.state_step)
        so_far = whole if complete else events.largest_tension(record, work, 0.0, final)
        recent = so_far
        if r.state_published > r.state_begin:
            first = min(final, (r.state_published - r.state_begin) / r.state_step)
            recent = events.largest_tension(record, work, first, final)
        r.tether_tension_peak = max(r.tether_tension_peak, recent)
        # What is carried on comes from whole steps alone, so that it does not depend on the communication points.
        r.tug_peak[0] = max(r.state_tug_peak, so_far)
        if complete:
            r.state_tug_peak = r.tug_peak[0]

    @kernel
    def change_line(record: Any, work: Array) -> None:
        """The step ended where the line changes between slack and taut: let it."""
        r = record[0]
        end = work[layout.END : layout.HERE]
        trajectory.state_at(record, work, r.state_end, end)
        if r.state_taut:
            r.state_taut = 0
        else:
            r.state_taut = 1
            begin_tug(record, r.state_end, length_rate(end[6:9], end[9:12], norm(end[6:9])))
        trajectory.restart(record, work, r.state_end)

    @kernel
    def step_to(record: Any, work: Array, time: float, step: float) -> int:
        r = record[0]
        if not (math.isfinite(time) and math.isfinite(step) and step >= 0.0):
            return fail(record, TIME_GAP, r.state_published, step)
        if abs(time - r.state_published) > TIME_DRIFT * max(1.0, abs(time)):
            return fail(record, TIME_GAP, r.state_published, time)
        target = time + step
        if not target > r.state_published or step == 0.0:
            return 0
        code = take_inputs(record, work, time)
        if code != 0:
            return code
        r.tether_tension_peak = 0.0
        changes = 0
        while r.state_end <= target:
            if norm(work[layout.END : layout.END + 3]) < EARTH_EQUATORIAL_RADIUS:
                return fail(record, GROUND, r.state_end, norm(work[layout.END : layout.END + 3]))
            note_tension(record, work, r.state_end)
            if r.state_event:
                changes += 1
                if changes > EVENT_LIMIT:
                    return fail(record, TOO_MANY_EVENTS, r.state_end, float(changes))
                change_line(record, work)
            code = trajectory.advance(record, work)
            if code != 0:
                return fail(record, code, r.state_begin, r.state_error)
        note_tension(record, work, target)
        here = work[layout.HERE : layout.SLOPE]
        length, speed = trajectory.state_at(record, work, target, here)
        if not finite(here):
            return fail(record, NOT_FINITE, target, 0.0)
        if norm(here[0:3]) < EARTH_EQUATORIAL_RADIUS:
            return fail(record, GROUND, target, norm(here[0:3]))
        publish(record, here, length, speed)
        thrust.publish(record, target)
        r.tether_tension_peak = max(r.tether_tension_peak, r.tether_tension)
        r.state_published = target
        return 0

    @kernel
    def refresh(record: Any, work: Array, time: float) -> int:
        """The outputs that depend directly on inputs, as they would be with the inputs of now; the state stays."""
        r = record[0]
        here = work[layout.HERE : layout.SLOPE]
        length, speed = trajectory.state_at(record, work, r.state_published, here)
        in_force, taut = r.state_length_offset, r.state_taut
        if r.reel_length_offset != in_force:
            code = reel.prepare(record, r.reel_length_offset)
            if code != 0:
                return fail(record, code, time, r.reel_length_offset)
            judge_line(record, here)
        publish(record, here, length, speed)
        if r.reel_length_offset != in_force:
            reel.prepare(record, in_force)
            r.state_taut = taut
        return 0

    record_type = numba.from_dtype(MODEL.interface(terms).dtype)[::1]
    signature = numba.int32(numba.int64, record_type, numba.float64[::1], numba.float64, numba.float64)

    @njit(signature, **OPTIONS)
    def entry(command: int, record: Any, work: Array, time: float, step: float) -> int:
        record[0].fault_code = 0
        if command == SIZE:
            record[0].work_size = layout.WORK
            return 0
        if command == INITIALISE:
            return initialise(record, work, time)
        if command == STEP:
            return step_to(record, work, time, step)
        if command == REFRESH:
            return refresh(record, work, time)
        return fail(record, BAD_PARAMETER, time, float(command))

    return entry
