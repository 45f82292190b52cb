"""A line that breaks where its tension exceeds its strength, and is slack from then on."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from fmu_src.tethered_deorbit.acting import Acting, together
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.interface import BROKE
from fmu_src.tethered_deorbit.law import Reel
from orbital.kernel import kernel
from orbital.vectors import Array

REACHED = 1.0 - 1.0e-6
"""Share of the strength from which on it is exceeded, to the accuracy with which that instant is located."""


def breakable(reel: Reel, terms: Mapping[str, str], line: Callable[..., Any]) -> Reel:
    """The law of a line that breaks, if the scene says so; else the law as it is.

    line          kernel of `Bodies`

    The instant is found within the step, also where only a peak exceeds the strength. A broken line has no onset and is
    never taut, whatever the inputs.

    Valid    a line as strong everywhere as its weakest place, however long the load lasts
    Checked  tests/tethered_deorbit/test_ends.py
    """
    if "break" not in terms:
        return reel

    @kernel
    def begin(record: Any, state: Array) -> int:
        """A new line.

        Checked  tests/tethered_deorbit/test_ends.py: nothing is left of an earlier run
        """
        r = record[0]
        r.state_broken = 0
        r.break_broken = 0
        r.break_time = 0.0
        return 0

    @kernel
    def limit(record: Any) -> float:
        """The strength [N], until it is exceeded.

        Checked  tests/tethered_deorbit/test_ends.py
        """
        strength: float = record[0].break_strength
        return math.inf if record[0].state_broken else strength

    @kernel
    def act(record: Any, state: Array, time: float, by_state: bool) -> int:
        """Break; BROKE if the run ends with it.

        Checked  tests/tethered_deorbit/test_ends.py
        """
        r = record[0]
        if r.state_broken or not (by_state and r.state_taut):
            return 0
        # it may be another part that is concerned
        reel.see(record, state)
        _, length, speed = line(record, state)
        if not reel.tension(record, length, speed, 0.0) >= REACHED * r.break_strength:
            return 0
        if not r.break_flies_on:
            return blame(record, BROKE, 0, r.break_strength)
        r.state_broken = 1
        r.break_broken = 1
        r.break_time = time
        return 0

    @kernel
    def taut(record: Any, length: float, rate: float) -> bool:
        """Whether a whole line pulls.

        Checked  tests/tethered_deorbit/test_ends.py
        """
        return record[0].state_broken == 0 and bool(reel.taut(record, length, rate))

    @kernel
    def onset(record: Any, length: float, rate: float, since: float) -> float:
        """That of a whole line; of a broken one, never.

        Checked  tests/tethered_deorbit/test_ends.py
        """
        return -1.0 if record[0].state_broken else float(reel.onset(record, length, rate, since))

    @kernel
    def onset_rate(record: Any, length: float, rate: float, acceleration: float, since: float) -> float:
        """Its time derivative.

        Checked  tests/tethered_deorbit/test_ends.py
        """
        return 0.0 if record[0].state_broken else float(reel.onset_rate(record, length, rate, acceleration, since))

    breaking = Acting(begin=begin, limit=limit, act=act)
    return reel._replace(taut=taut, onset=onset, onset_rate=onset_rate, acting=together((breaking, reel.acting)))
