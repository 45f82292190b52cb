"""What the importer sets, put in force: the command of the line and the thrust, held or moving."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.tethered_deorbit.acting import Acting
from fmu_src.tethered_deorbit.bodies import Bodies
from fmu_src.tethered_deorbit.extremes import Extremes
from fmu_src.tethered_deorbit.faults import blame, fail
from fmu_src.tethered_deorbit.idle import zero
from fmu_src.tethered_deorbit.interface import BAD_PARAMETER
from fmu_src.tethered_deorbit.law import Reel
from fmu_src.tethered_deorbit.layout import Places
from fmu_src.tethered_deorbit.outputs import begin_tug
from fmu_src.tethered_deorbit.thrust import Thrust
from fmu_src.tethered_deorbit.tolerances import ROUNDING
from fmu_src.tethered_deorbit.trajectory import Trajectory
from orbital.kernel import kernel
from orbital.vectors import Array


class Inputs(NamedTuple):
    """Kernels that take them.

    judge_line(record, state) -> rate              decide afresh whether the line is taut
    take(record, work, duration) -> fault          as a macro step begins [s]
    leave(record, work, duration) -> fault         as one ends in which inputs have moved
    turn(record, work, length) -> energy           the line, so long [m], has gone taut or slack at the end of the
                                                   step: what the law has booked of it [J]
    act(record, work, target, by_state) -> fault   at the end of the step, where a part acts, until the macro step's end
    """

    judge_line: Callable[..., Any]
    take: Callable[..., Any]
    leave: Callable[..., Any]
    turn: Callable[..., Any]
    act: Callable[..., Any]


def make_inputs(
    reel: Reel,
    thrust: Thrust,
    bodies: Bodies,
    trajectory: Trajectory,
    extremes: Extremes,
    acting: Acting,
    places: Places,
    command_slot: int,
) -> Inputs:
    """The kernels for one law of the line, one thruster and two bodies.

    acting         what they do by themselves
    command_slot   value reference of the law's input, which is blamed when it is no number

    Checked  tests/tethered_deorbit/test_macro_step.py, test_ramps.py
    """

    end_state, here_state, slope_state, size = places.end, places.here, places.slope, places.size

    turns = reel.turn is not zero

    @kernel
    def turn(record: Any, work: Array, length: float) -> float:
        """Have the law book that the line, in the state stored as END, has just gone taut or slack.

        Checked  tests/tethered_deorbit/test_winch.py: the book of energy
        """
        end = work[end_state:here_state]
        reel.see(record, end)
        return float(reel.turn(record, end, length))

    @kernel
    def judge_line(record: Any, state: Array) -> float:
        """Decide afresh whether the line is taut, from the law alone; returns its rate of lengthening [m/s].

        Checked  tests/tethered_deorbit/test_start.py, test_macro_step.py: a changed length
        """
        r = record[0]
        _, length, speed = bodies.line(record, state)
        reel.see(record, state)
        r.state_taut = 1 if reel.taut(record, length, speed) else 0
        return float(speed)

    @kernel
    def begin_anew(record: Any, work: Array, duration: float) -> int:
        """Put what the inputs say in force, and begin the trajectory anew, at the last communication point.

        What was published stands; the rest of the step did not happen. Returns 0 or a fault.

        duration      for which the inputs move                      [s]

        Checked  tests/tethered_deorbit/test_macro_step.py, test_ramps.py: a ramp does not see what ran ahead
        """
        r = record[0]
        here = work[here_state:slope_state]
        trajectory.state_at(record, work, r.state_published, here)
        for i in range(size):
            work[end_state + i] = here[i]
        extremes.begin_anew(record)
        command, command_rate = reel.asked(record)
        code = reel.prepare(record, command, command_rate, duration)
        if code == 0:
            code = thrust.check(record)
        if code != 0:
            return fail(record, code, r.state_published)
        force, force_rate = thrust.asked(record)
        thrust.account(record, r.state_published)
        thrust.put(record, force, force_rate)
        trajectory.restart(record, work, r.state_published)
        r.state_since = 0.0
        return 0

    @kernel
    def take(record: Any, work: Array, duration: float) -> int:
        """Begin anew when an input has changed, or moves, or has moved; then decide afresh whether the line is taut.

        duration      of the macro step                              [s]

        Returns 0 or a fault.

        Checked  tests/tethered_deorbit/test_macro_step.py, test_ramps.py; test_commanded.py: a changed command is
                 one tug
        """
        r = record[0]
        command, command_rate = reel.asked(record)
        force, force_rate = thrust.asked(record)
        changed = not (command == r.state_command and force == r.state_thrust)
        moving = not (command_rate == 0.0 and force_rate == 0.0)
        moved = not (r.state_command_rate == 0.0 and r.state_thrust_rate == 0.0)
        if not (changed or moving or moved):
            return 0
        if not math.isfinite(command + command_rate):
            return fail(record, blame(record, BAD_PARAMETER, command_slot, command), r.state_published)
        was_taut = r.state_taut
        code = begin_anew(record, work, duration)
        if code != 0:
            return code
        end = work[end_state:here_state]
        speed = judge_line(record, end)
        if turns and r.state_taut != was_taut:
            _, length, _ = bodies.line(record, end)
            turn(record, work, length)
        # The first step after a change of the line is a short one.
        trajectory.restart(record, work, r.state_published)
        if r.state_taut and not was_taut:
            begin_tug(record, r.state_published, speed)
        return 0

    @kernel
    def leave(record: Any, work: Array, duration: float) -> int:
        """After a step in which inputs moved: they stay where they have come to, as if they were to go on moving.

        The line is judged only when it is known how the next step begins. Returns 0 or a fault.

        duration      of the macro step                              [s]

        Checked  tests/tethered_deorbit/test_ramps.py: two ramps make one; test_tugs.py: ramps that end at zero
        """
        r = record[0]
        command, command_rate = reel.asked(record)
        if command_rate != 0.0:
            reached = command + command_rate * duration
            # A ramp that ends at zero to rounding, of the times too, ends at zero: 1e-19 N would be a taut line.
            times = abs(r.state_start) + r.state_published
            exact = abs(reached) > ROUNDING * (abs(command) + abs(command_rate) * times)
            reel.leave(record, reached if exact else 0.0)
        thrust.leave(record, duration)
        return int(begin_anew(record, work, 0.0))

    @kernel
    def act(record: Any, work: Array, target: float, by_state: bool) -> int:
        """Let the parts act at the end of the step, with what moves carried on to there, and begin anew.

        target        end of the macro step, until which inputs move [s]
        by_state      a part's condition has ceased

        Returns 0 or a fault.

        Checked  tests/tethered_deorbit/test_ends.py
        """
        r = record[0]
        now = r.state_end
        end = work[end_state:here_state]
        trajectory.state_at(record, work, now, end)
        since = r.state_since + r.state_step
        command, command_rate = r.state_command + r.state_command_rate * since, r.state_command_rate
        force, force_rate = r.state_thrust + r.state_thrust_rate * since, r.state_thrust_rate
        trajectory.restart(record, work, now)
        r.state_since = 0.0
        code: int = reel.prepare(record, command, command_rate, target - now)
        if code != 0:
            return fail(record, code, now)
        thrust.account(record, now)
        thrust.put(record, force, force_rate)
        was_taut, length = r.state_taut, 0.0
        if turns:
            _, length, _ = bodies.line(record, end)  # of one that parts, as it still was
        code = acting.act(record, end, now, by_state)
        if code != 0:
            return fail(record, code, now)
        speed = judge_line(record, end)
        if turns and r.state_taut != was_taut:
            turn(record, work, length)
        trajectory.restart(record, work, now)
        r.state_since = 0.0
        if r.state_taut and not was_taut:
            begin_tug(record, now, speed)
        return 0

    return Inputs(judge_line, take, leave, turn, act)
