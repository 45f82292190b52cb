"""What the pair answers between two steps, for the inputs of now: outputs that depend on them directly, derivatives."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from fmu_src.tethered_deorbit.faults import blame, fail
from fmu_src.tethered_deorbit.interface import BAD_PARAMETER
from fmu_src.tethered_deorbit.layout import Places
from orbital.kernel import kernel
from orbital.vectors import Array


def make_answer(
    reel: Any,
    thrust: Any,
    held: Any,
    level: Any,
    trajectory: Any,
    inputs: Any,
    publish: Any,
    differentiate: Any,
    places: Places,
    command_slot: int,
) -> Callable[[Any, Array, bool], int]:
    """The kernel `answer(record, work, differentiating) -> status`.

    command_slot    of the variable that is blamed for a command which is no number
    """
    here_state, slope_state, low_error = places.here, places.slope, places.low

    @kernel
    def answer(record: Any, work: Array, differentiating: bool) -> int:
        """Outputs that depend directly on inputs, or derivatives, for the inputs of now; the state stays.

        differentiating  which of the two

        Returns 0 or a fault.

        Checked  tests/tethered_deorbit/test_derivatives.py: asking changes nothing; test_macro_step.py: a changed
                 length
        """
        r = record[0]
        here = work[here_state:slope_state]
        separation, length, speed = trajectory.state_at(record, work, r.state_published, here)
        thrust.weigh(record, here)
        command, command_rate, taut = r.state_command, r.state_command_rate, r.state_taut
        force, force_rate = r.state_thrust, r.state_thrust_rate
        settled = held.settled(record)
        level.put(record, False)  # the state lies where its stretch gives its tension
        asked, asked_rate = reel.asked(record)
        if asked == command and asked_rate == 0.0:
            asked_rate = command_rate
        if not (asked == command and asked_rate == command_rate):
            if not math.isfinite(asked + asked_rate):
                return fail(record, blame(record, BAD_PARAMETER, command_slot, asked), r.state_published)
            code = reel.prepare(record, asked, asked_rate, 0.0)
            if code != 0:
                return fail(record, code, r.state_published)
            inputs.judge_line(record, here)
        if differentiating:
            asked_force, asked_force_rate = thrust.asked(record)
            thrust.put(record, asked_force, force_rate if asked_force == force else asked_force_rate)
            since = r.state_since
            r.state_since = r.state_begin - r.state_published
            differentiate(record, here, work[slope_state:low_error], separation, length, speed)
            thrust.publish_rate(record, r.state_published)
            r.state_since = since
            thrust.put(record, force, force_rate)
        else:
            publish(record, here, separation, length, speed, 0.0, r.state_published)
        reel.prepare(record, command, command_rate, 0.0)
        r.state_taut = taut
        level.put(record, settled)
        return 0

    return answer
