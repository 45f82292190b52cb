"""How long a tow is computed in which way: counted step by step, told at communication points."""

from __future__ import annotations

from typing import Any

from fmu_src.tethered_deorbit.level import Level
from orbital.kernel import kernel

FREE, FOLLOWED, MAPPED, DUMBBELL, AVERAGED = range(5)
"""What a step was, by `level.now`."""
MODES = 5


def counted(level: Level) -> Level:
    """A level that counts so.

    Checked  tests/tethered_deorbit/test_event_map.py: times of the modes
    """

    @kernel
    def begin(record: Any) -> None:
        """No time has passed in any mode.

        Checked  tests/tethered_deorbit/test_event_map.py
        """
        r = record[0]
        for i in range(MODES):
            r.state_level_times[i] = 0.0
        r.state_level_now = FREE
        level.begin(record)
        publish(record)

    @kernel
    def restart(record: Any, time: float) -> None:
        """What the steps had run ahead of a time [s] did not happen.

        Checked  tests/tethered_deorbit/test_event_map.py: a changed thrust
        """
        r = record[0]
        r.state_level_times[r.state_level_now] -= max(0.0, r.state_end - time)
        level.restart(record, time)

    @kernel
    def book(record: Any) -> None:
        """A step has been taken: its time counts for its mode.

        Checked  tests/tethered_deorbit/test_event_map.py: times of the modes
        """
        r = record[0]
        now = FREE
        if r.state_taut:
            now = FOLLOWED
            if r.state_settled == 1:
                now = DUMBBELL if r.state_vibration[0] == 0.0 and r.state_vibration[1] == 0.0 else MAPPED
        r.state_level_now = now
        r.state_level_times[now] += r.state_step

    @kernel
    def publish(record: Any) -> None:
        """Which mode it is, and how long each has been, up to the communication point.

        Checked  tests/tethered_deorbit/test_event_map.py: times of the modes
        """
        r = record[0]
        now, times = r.state_level_now, r.state_level_times
        r.level_settled = 1 if now == DUMBBELL else 0
        r.level_settled_since = r.state_settled_since if now == DUMBBELL else 0.0
        r.level_times_settled = r.state_times_settled
        r.level_now = now
        ahead = r.state_end - r.state_published
        r.level_free = times[FREE] - (ahead if now == FREE else 0.0)
        r.level_followed = times[FOLLOWED] - (ahead if now == FOLLOWED else 0.0)
        r.level_mapped = times[MAPPED] - (ahead if now == MAPPED else 0.0)
        r.level_dumbbell = times[DUMBBELL] - (ahead if now == DUMBBELL else 0.0)
        r.level_error = r.state_level_error

    return level._replace(begin=begin, restart=restart, publish=publish, book=book)
