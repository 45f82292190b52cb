"""What meets at the nodes of two sets of threads, those expected to be taut and those that were: sums, and bounds."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fmu_src.net_capture.planes import DAMPING, INVERSE_MASS, NODE_PLANES, STIFFNESS, STRIP_NUMBERS, STRIP_WORDS, A, B
from orbital.kernel import kernel

EXPECTED, SEEN, SETS = range(3)
"""The two sets of threads that are kept, each with a mask for every strip and two node planes, the stiffness [N/m] and
the dashpots [N s/m] that meet at a node."""


class Meeting(NamedTuple):
    """Kernels that keep what meets at the nodes.

    allow(p, stiffness_rate, damping_rate) -> step       that is wanted where this meets [s], see `longest_step`
    meet(p, reals, node, chosen, stiffness, dashpot)     more that meets at a node, for one of the sets
    meet_strip(p, reals, table, numbers, strip, chosen, these)   threads of a strip, a bit each
    meet_both(p, work, node, stiffness, dashpot)         what counts as taut: in both sets
    """

    allow: Any
    meet: Any
    meet_strip: Any
    meet_both: Any


def make_meeting(composition: Any) -> Meeting:
    """Kernels for the composition's memory and the bound of its scheme."""
    needs, reals_of = composition.needs, composition.memory.reals
    longest_step, accurate_step = needs.longest_step, needs.accurate_step
    first_plane, everywhere = NODE_PLANES + needs.planes, composition.everywhere
    from fmu_src.lanes import lowest, peek, poke

    @kernel
    def allow(p, stiffness_rate, damping_rate):
        """Step that is wanted where this meets at a node [s], see `formulas.longest_step`.

        Checked  tests/net_capture/test_following.py
        """
        pressing, resisting = everywhere(p)
        stiffness_rate += pressing
        damping_rate += resisting
        if p.solver_step_ratio > 0.0:
            return p.solver_step_ratio * longest_step(stiffness_rate, damping_rate)
        return accurate_step(stiffness_rate, damping_rate)

    @kernel
    def meet(p, reals, node, chosen, stiffness, damping):
        """Stiffness [N/m] and dashpot [N s/m] that meet at a node, for one of the sets; lowers its bound.

        Checked  tests/net_capture/test_following.py
        """
        at = node + (first_plane + 2 * chosen) * p.node_slots
        stiffness += peek(reals, at)
        damping += peek(reals, at + p.node_slots)
        poke(reals, at, stiffness)
        poke(reals, at + p.node_slots, damping)
        light = np.float64(peek(reals, node + INVERSE_MASS * p.node_slots))
        pressing, resisting = everywhere(p)
        bound = longest_step(stiffness * light + pressing, damping * light + resisting)
        if chosen == EXPECTED:
            p.solver_bound_now = min(p.solver_bound_now, bound)
            p.pace_wanted = min(p.pace_wanted, allow(p, stiffness * light, damping * light))
        else:
            p.pace_seen = min(p.pace_seen, bound)

    @kernel
    def meet_strip(p, reals, table, numbers, strip, chosen, these):
        """These lanes of a strip, a bit each, are in one of the sets now.

        Checked  tests/net_capture/test_following.py
        """
        s = STRIP_WORDS * strip
        q = STRIP_NUMBERS * strip
        while these != np.uint64(0):
            i = np.int64(lowest(these))
            these &= these - np.uint64(1)
            meet(p, reals, peek(table, s + A) + i, chosen, peek(numbers, q + STIFFNESS), peek(numbers, q + DAMPING))
            meet(p, reals, peek(table, s + B) + i, chosen, peek(numbers, q + STIFFNESS), peek(numbers, q + DAMPING))

    @kernel
    def meet_both(p, work, node, stiffness, damping):
        """The same, of a cord, which counts as taut while its winches run: in both sets.

        Checked  tests/net_capture/test_following.py
        """
        for chosen in range(SETS):
            meet(p, reals_of(work), node, chosen, stiffness, damping)

    return Meeting(allow, meet, meet_strip, meet_both)
