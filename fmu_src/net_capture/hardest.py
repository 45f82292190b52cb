"""Which of the net's own threads bears most, told by the nodes at its ends, which count as the outputs of nodes do."""

from __future__ import annotations

from typing import Any, NamedTuple

from fmu_src.interface import Term, Variable
from fmu_src.net_capture.planes import FIRST, LONGEST_ROW, STRIP_WORDS, A, B
from fmu_src.rows import count, peak
from orbital.kernel import kernel


class Hardest(NamedTuple):
    """Kernels of the place of the largest tension.

    start(p)           nothing has borne anything yet
    tell(p, work)      after the largest of the macro step is known
    """

    start: Any
    tell: Any


def make(composition: Any) -> Hardest:
    """Kernels of the place of the largest tension."""
    memory, now = composition.memory, composition.clock.now
    strips, number_of = memory.strips, composition.numbering.of

    @kernel
    def start(p):
        """Nothing has borne anything yet.

        Checked  tests/net_capture/test_hardest.py
        """
        p.thread_tension_peak_index = 0
        p.thread_tension_max_time = -1.0
        for end in range(2):
            p.thread_tension_peak_node[end] = 0
            p.thread_tension_max_node[end] = 0

    @kernel
    def tell(p, work):
        """Nodes of the thread that bore most in this macro step, and of the one that has borne most since the start.

        Checked  tests/net_capture/test_hardest.py
        """
        index = p.thread_peak_index if p.thread_tension_peak > 0.0 else 0
        if index != p.thread_tension_peak_index:
            p.thread_tension_peak_index = index
            p.thread_tension_peak_node[0] = 0
            p.thread_tension_peak_node[1] = 0
            table = strips(p, work)
            for strip in range(p.strips if index > 0 else 0):
                s = STRIP_WORDS * strip
                lane = index - 1 - table[s + FIRST]
                if lane >= 0 and lane < LONGEST_ROW:
                    # the last strip that begins at or before it is the one it is of
                    p.thread_tension_peak_node[0] = table[s + A] + lane
                    p.thread_tension_peak_node[1] = table[s + B] + lane
            for end in range(2 if index > 0 else 0):
                p.thread_tension_peak_node[end] = number_of(p, work, p.thread_tension_peak_node[end])
        if index > 0 and p.thread_tension_max_index == index and p.thread_tension_max == p.thread_tension_peak:
            for end in range(2):
                p.thread_tension_max_node[end] = p.thread_tension_peak_node[end]
            p.thread_tension_max_time = now(p)

    return Hardest(start, tell)


PART = Term(
    "between which nodes the largest tension is, in every macro step and since the start",
    (
        count("thread.tension_peak_index", "which thread bore most in the last macro step, counted from 1; 0: none"),
        Variable(
            "thread.tension_peak_node[#]",
            "1",
            "output",
            "nodes at the ends of that thread, counted as the outputs of nodes are",
            0,
            kind="Integer",
            shape=(2,),
        ),
        Variable(
            "thread.tension_max_node[#]",
            "1",
            "output",
            "nodes at the ends of the thread that has borne most since the start",
            0,
            kind="Integer",
            shape=(2,),
        ),
        peak("thread.tension_max_time", "s", "end of the macro step in which it did, since the shot; -1 before"),
    ),
    make=make,
)
