"""Threads near the target, and what is kept of each from one substep to the next.

Which threads are near is looked up now and then, ahead of how fast anything moves. Of each the work memory keeps its
state, the way it lies and the faces over which that goes, in whole numbers; behind them stands the list of those near.

Checked  tests/net_capture/test_wrapping.py
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from fmu_src.net_capture.contact.chain import WOUND
from fmu_src.net_capture.contact.section import MOST
from fmu_src.net_capture.planes import FIRST, LANES, LENGTH, STRIP_NUMBERS, STRIP_WORDS, A, B, P, X
from orbital.kernel import kernel
from orbital.rotations import rotate_inverse
from orbital.vectors import dot

AHEAD = 0.05
"""Metres that a node may move against the target before the threads near it are looked up again."""
LONGEST_LOOK = 200
"""Substeps after which they are in any case."""
FREE, BENT, PASSED = range(3)
"""States of a thread: clear of the target; round an edge; through it."""
STATE, WAY, CLEAR, EDGES, CHAIN, KEPT = 0, 1, 2, 3, 4, 10
"""Whole numbers kept of each thread, one plane of them after another: its state, the length of its way a substep on,
the substep up to which it is clear of the target, over how many edges it bends, and the faces between them, `PACKED` to
a number."""
PACKED, FACE_BITS = 7, 9
CHAIN_WORDS = KEPT - CHAIN
WOUND_BIT = FACE_BITS * ((MOST + 1) % PACKED)
"""Of the last of these: whether it is wound over more edges than are kept, behind the faces of all that are."""
FINE = 1e-12
"""Metres: lengths are kept in picometres."""
JUMP = 2e-4
"""Metres by which a way may differ from what the ends' speeds made of it a substep ago: 0.3 mJ of Table 1's net."""
SHARE = 0.5
"""Of what these speeds make in a substep, by which it may differ beside that."""


class Near(NamedTuple):
    """Kernels of the list, and of what is kept.

    words(p)                     whole numbers of work memory, before those of the pace
    list_at(p, words)            where the list begins
    list_near(p, work)           look up which threads are near
    recall(p, words, at)         over how many edges a thread bends, the faces between them into `wrap_chain`
    keep(p, words, at, edges)    keep these
    wound(p, words, at)          whether it was wound over more edges than are kept
    """

    words: Any
    list_at: Any
    list_near: Any
    recall: Any
    keep: Any
    wound: Any


def make_list_at(composition: Any, kept: int) -> Any:
    """Kernel `list_at` of `Near`."""
    masks = composition.traits.masks

    @kernel
    def list_at(p, words):
        """Where the list begins.

        Checked  tests/net_capture/test_wrapping.py
        """
        return words.size - masks * p.strips - (1 + kept) * p.wrap_numbers

    return list_at


def make_near(composition: Any, kept: int) -> Near:
    """Kernels for the composition's net and target, with so many whole numbers kept of each thread."""
    # after the scheme's own parts are known, see `schemes.asleep`
    from fmu_src.lanes import lowest
    from fmu_src.net_capture.schemes.asleep import make_asleep

    memory = composition.memory
    node_plane, strips, properties, own = memory.node_plane, memory.strips, memory.properties, memory.own
    reals_of, bring = memory.reals, make_asleep(composition).bring
    distance_to, list_at = composition.target.shape.distance, make_list_at(composition, kept)
    cord = composition.cord_bends
    bends, stretches = cord is not None, cord.stretches if cord is not None else None

    @kernel
    def words(p):
        """For each thread, and each stretch of cord that bends, a place in the list of those near, and what is kept of
        it, see `KEPT`.

        Checked  tests/net_capture/test_wrapping.py
        """
        p.wrap_numbers = p.thread_numbers
        if bends:
            p.wrap_numbers += stretches(p)
        return (1 + kept) * p.wrap_numbers

    @kernel
    def list_near(p, work):
        """List the threads that may come to lie across the target before the next time, and say when that is.

        A thread whose middle is further from the surface than half its length can not.

        Checked  tests/net_capture/test_wrapping.py
        """
        words, table, numbers = own(p, work), strips(p, work), properties(p, work)
        at = list_at(p, words)
        for row in range(p.node_slots // p.row_pitch):
            bring(p, reals_of(work), words, row)
        fastest = 0.0
        for node in range(p.node_slots):
            speed = 0.0
            for axis in range(3):
                v = node_plane(p, work, P + axis)[node] - p.target_drift[axis]
                speed += v * v
            fastest = max(fastest, speed)
        reach = p.envelope_radius + AHEAD
        fastest = math.sqrt(fastest) + math.sqrt(dot(p.target_omega, p.target_omega)) * reach
        p.wrap_haste = 2.0 * p.solver_substep * max(fastest, 1e-9)
        p.wrap_substep = p.solver_substep
        p.wrap_next = p.grid + max(int(min(AHEAD / p.wrap_haste, 1.0 * LONGEST_LOOK)), 1)
        p.wrap_listed = 0
        middle, arm = p.wrap_a, p.wrap_b
        for strip in range(p.strips):
            s = STRIP_WORDS * strip
            these = np.uint64(table[s + LANES])
            while these != np.uint64(0):
                lane = np.int64(lowest(these))
                these &= these - np.uint64(1)
                away = 0.0
                for axis in range(3):
                    x = node_plane(p, work, X + axis)
                    arm[axis] = 0.5 * (x[table[s + A] + lane] + x[table[s + B] + lane]) - p.target_place[axis]
                    away += arm[axis] * arm[axis]
                # longer by a third than unstretched no thread is
                half = 0.67 * numbers[STRIP_NUMBERS * strip + LENGTH] + AHEAD
                if away < (p.envelope_radius + half) * (p.envelope_radius + half):
                    rotate_inverse(middle, p.target_pose, arm)
                    if distance_to(p, p.wrap_line, middle) < half:
                        words[at + (1 + CLEAR) * p.wrap_numbers + table[s + FIRST] + lane] = 0
                        words[at + p.wrap_listed] = 64 * strip + lane
                        p.wrap_listed += 1
                        continue
                words[at + p.wrap_numbers + table[s + FIRST] + lane] = FREE

    @kernel
    def recall(p, words, at):
        """Over how many edges a thread bends, 0: none; the faces between them go into `wrap_chain`.

        at        where its state stands

        Checked  tests/net_capture/test_wrapping.py
        """
        if words[at] != BENT:
            return 0
        edges = words[at + EDGES * p.wrap_numbers]
        for j in range(edges + 1):
            word = words[at + (CHAIN + j // PACKED) * p.wrap_numbers]
            p.wrap_chain[j] = (word >> (FACE_BITS * (j % PACKED))) & ((1 << FACE_BITS) - 1)
        return edges

    @kernel
    def keep(p, words, at, edges):
        """Keep over which faces a thread lies.

        Checked  tests/net_capture/test_wrapping.py
        """
        words[at + EDGES * p.wrap_numbers] = edges
        for n in range(CHAIN, KEPT):
            words[at + n * p.wrap_numbers] = 0
        for j in range(edges + 1):
            words[at + (CHAIN + j // PACKED) * p.wrap_numbers] |= p.wrap_chain[j] << (FACE_BITS * (j % PACKED))
        if p.wrap_lost == WOUND:
            words[at + (KEPT - 1) * p.wrap_numbers] |= 1 << WOUND_BIT

    @kernel
    def wound(p, words, at):
        """Whether a thread was wound over more edges than are kept a substep ago.

        Checked  tests/net_capture/test_wrapping.py
        """
        return (words[at + (KEPT - 1) * p.wrap_numbers] >> WOUND_BIT) & 1 == 1

    return Near(words, list_at, list_near, recall, keep, wound)
