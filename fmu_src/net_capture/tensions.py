"""What every thread bears, as outputs; in an FMU that is asked for it alone.

Threads are counted from 1 in the order of the strips, without the gaps that their numbers have, and keep their places
when some break.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from fmu_src.net_capture.planes import (
    DAMPING,
    LANES,
    LENGTH,
    LONGEST_ROW,
    MASS,
    SHOWN,
    SHOWN_RATE,
    STIFFNESS,
    STRIP_NUMBERS,
    STRIP_WORDS,
    A,
    B,
)
from fmu_src.net_capture.threads import thread_tension
from orbital.kernel import kernel


class Tensions(NamedTuple):
    """Kernels of the outputs of all threads.

    list_threads(p, work)    between which nodes each runs, once the net is laid out and its nodes have their masses
    write(p, work)           what each bears, as the net is shown
    """

    list_threads: Any
    write: Any


def make_tensions(composition: Any) -> Tensions:
    """Kernels for the composition's memory."""
    memory = composition.memory
    node_plane, strips, properties = memory.node_plane, memory.strips, memory.properties
    number_of, has_order = composition.numbering.of, composition.net.knot_slot is not None

    @kernel
    def list_threads(p, work):
        """Strip, lane and both nodes of every thread; of outputs beyond them, no node.

        Checked  tests/net_capture/test_tensions.py
        """
        table = strips(p, work)
        mass = node_plane(p, work, MASS)
        found = 0
        for strip in range(p.strips):
            at = STRIP_WORDS * strip
            a = table[at + A]
            b = table[at + B]
            first = 0
            second = 0
            if not has_order:
                first = number_of(p, work, a) - (1 if mass[a] > 0.0 else 0)
                second = number_of(p, work, b) - (1 if mass[b] > 0.0 else 0)
            for lane in range(min(LONGEST_ROW, p.node_slots - max(a, b))):
                first += 1 if mass[a + lane] > 0.0 else 0
                second += 1 if mass[b + lane] > 0.0 else 0
                if (table[at + LANES] >> lane) & 1:
                    p.thread_strip[found] = strip
                    p.thread_lane[found] = lane
                    p.thread_node[found, 0] = number_of(p, work, a + lane) if has_order else first
                    p.thread_node[found, 1] = number_of(p, work, b + lane) if has_order else second
                    found += 1
        for k in range(found, p.thread_tension.size):
            p.thread_tension[k] = 0.0
            p.thread_node[k, 0] = 0
            p.thread_node[k, 1] = 0

    @kernel
    def write(p, work):
        """Tension of every thread [N] at the positions and velocities shown; see `threads.thread_tension`.

            dL/dt = (v_b - v_a) . (x_b - x_a) / L

        Checked  tests/net_capture/test_tensions.py
        """
        table = strips(p, work)
        numbers = properties(p, work)
        for k in range(p.net_threads):
            at = STRIP_WORDS * p.thread_strip[k]
            lane = p.thread_lane[k]
            p.thread_tension[k] = 0.0
            if (table[at + LANES] >> lane) & 1:
                a = table[at + A] + lane
                b = table[at + B] + lane
                squared = 0.0
                along = 0.0
                for axis in range(3):
                    place = node_plane(p, work, SHOWN + axis)
                    rate = node_plane(p, work, SHOWN_RATE + axis)
                    gap = place[b] - place[a]
                    squared += gap * gap
                    along += gap * (rate[b] - rate[a])
                length = math.sqrt(squared)
                q = STRIP_NUMBERS * p.thread_strip[k]
                if length > numbers[q + LENGTH]:
                    p.thread_tension[k] = thread_tension(
                        length, along / length, numbers[q + LENGTH], numbers[q + STIFFNESS], numbers[q + DAMPING]
                    )

    return Tensions(list_threads, write)
