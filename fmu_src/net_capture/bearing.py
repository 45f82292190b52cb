"""Which threads bear most while the closed net is pulled: tension, number and place of each."""

from __future__ import annotations

import math
from typing import Any

from fmu_src.net_capture.planes import (
    DAMPING,
    FIRST,
    LANES,
    LENGTH,
    LONGEST_ROW,
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
from orbital.rotations import rotate_inverse
from orbital.vectors import dot

MOST = 5
"""Threads that are told."""


def make_bearing(composition: Any) -> Any:
    """Kernel `tell_threads(p, work)` for the composition's net, by the nodes as shown."""
    memory = composition.memory
    node_plane, strips, properties = memory.node_plane, memory.strips, memory.properties

    @kernel
    def rank(p, tension, number, x, y, z):
        """Enter a thread among those that bear most, at a place from the target's centre of mass in the frame [m].

        Checked  tests/net_capture/test_pull_off.py
        """
        at = MOST
        while at > 0 and tension > p.pull_off_hardest_tension[at - 1]:
            at -= 1
        for i in range(MOST - 1, at, -1):
            p.pull_off_hardest_tension[i] = p.pull_off_hardest_tension[i - 1]
            p.pull_off_hardest_thread[i] = p.pull_off_hardest_thread[i - 1]
            for axis in range(3):
                p.pull_off_hardest_position[i, axis] = p.pull_off_hardest_position[i - 1, axis]
        if at < MOST:
            p.pull_off_hardest_tension[at] = tension
            p.pull_off_hardest_thread[at] = number
            place = p.scratch[0:3]
            place[0], place[1], place[2] = x, y, z
            rotate_inverse(place, p.target_pose, place)
            for axis in range(3):
                p.pull_off_hardest_position[at, axis] = place[axis]

    @kernel
    def tell_threads(p, work):
        """The threads that bear most now: tension, number, and their middles in the target's axes.

        Checked  tests/net_capture/test_pull_off.py
        """
        for i in range(MOST):
            p.pull_off_hardest_tension[i] = 0.0
            p.pull_off_hardest_thread[i] = 0
        table, numbers = strips(p, work), properties(p, work)
        middle, way = p.scratch[3:6], p.scratch[6:9]
        for strip in range(p.strips):
            s, q = STRIP_WORDS * strip, STRIP_NUMBERS * strip
            for lane in range(LONGEST_ROW):
                if (table[s + LANES] >> lane) & 1:
                    a, b = table[s + A] + lane, table[s + B] + lane
                    product = 0.0
                    for axis in range(3):
                        at, rate = node_plane(p, work, SHOWN + axis), node_plane(p, work, SHOWN_RATE + axis)
                        way[axis] = 1.0 * at[b] - at[a]
                        middle[axis] = 0.5 * (at[a] + at[b]) - p.target_place[axis]
                        product += way[axis] * (1.0 * rate[b] - rate[a])
                    length = math.sqrt(dot(way, way))
                    if length > numbers[q + LENGTH]:
                        tension = thread_tension(
                            length, product / length, numbers[q + LENGTH], numbers[q + STIFFNESS], numbers[q + DAMPING]
                        )
                        rank(p, tension, table[s + FIRST] + lane + 1, middle[0], middle[1], middle[2])

    return tell_threads
