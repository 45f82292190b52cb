"""A line that breaks where its tension exceeds its strength, and is slack from then on."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from fmu_src.tethered_deorbit.acting import Acting, together
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.interface import BROKE
from fmu_src.tethered_deorbit.law import Reel
from fmu_src.tethered_deorbit.nodes.parting import Parting
from fmu_src.tethered_deorbit.parted import make_parted
from orbital.kernel import kernel
from orbital.vectors import Array

ONE_PIECE = Parting()
REACHED = 1.0 - 1.0e-6
"""Share of the strength from which on it is exceeded, to the accuracy with which that instant is located."""


def breakable(reel: Reel, terms: Mapping[str, str], line: Callable[..., Any], parting: Parting = ONE_PIECE) -> Reel:
    """The law of a line that breaks, if the scene says so; else the law as it is.

    line          kernel of `Bodies`
    parting       of a line of nodes: it breaks where the piece that pulls hardest exceeds the strength, taut or not,
                  and a peak within a step that the ends of the step do not show is missed

    The instant is found within the step, also where only a peak exceeds the strength. A broken line has no onset and is
    never taut, whatever the inputs.

    Valid    a line as strong everywhere as its weakest place, however long the load lasts
    Checked  tests/tethered_deorbit/test_ends.py
    """
    if "break" not in terms:
        return reel
    bears, pieces = parting.bears, parting.pieces

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
    def bears_still(record: Any, state: Array, since: float) -> bool:
        """Whether a line of nodes has broken, or bears its load.

        Checked  tests/tethered_deorbit/test_nodes_parted.py
        """
        return bool(record[0].state_broken) or bool(bears(record, state, since))

    @kernel
    def limit(record: Any) -> float:
        """The strength [N], until it is exceeded.

        Checked  tests/tethered_deorbit/test_ends.py
        """
        strength: float = record[0].break_strength
        return math.inf if record[0].state_broken else strength

    @kernel
    def act(record: Any, state: Array, time: float, by_state: bool) -> int:
        """Break; BROKE if the run ends with it, with outputs of a line that still pulls.

        Checked  tests/tethered_deorbit/test_ends.py
        """
        r = record[0]
        # it may be another part that is concerned
        if pieces:
            if bears_still(record, state, 0.0):
                return 0
        else:
            if r.state_broken or not (by_state and r.state_taut):
                return 0
            reel.see(record, state)
            _, length, speed = line(record, state)
            if not reel.tension(record, length, speed, 0.0) >= REACHED * r.break_strength:
                return 0
        r.break_broken = 1
        r.break_time = time
        if not r.break_flies_on:
            return blame(record, BROKE, 0, r.break_strength)
        r.state_broken = 1
        parting.tear(record, state)
        return 0

    @kernel
    def parted(record: Any) -> bool:
        """Whether it is broken.

        Checked  tests/tethered_deorbit/test_ends.py
        """
        return bool(record[0].state_broken != 0)

    breaking = Acting(begin=begin, holds=bears_still, act=act) if pieces else Acting(begin=begin, limit=limit, act=act)
    return make_parted(reel, parted)._replace(acting=together((breaking, reel.acting)))
