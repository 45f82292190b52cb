"""The threads that an implicit substep reckons with: which they are, what they pull with, what their dashpots took.

They and the nodes at their ends are listed anew in every substep, since 95 % of the threads are slack at any time. A
listed thread that pulls as the substep begins is a spring with a dashpot until it ends, and may push; any other has the
law of `threads` and is only in the matrix, see `conjugate`.

Checked  tests/net_capture/test_stiff.py
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from fmu_src.net_capture.planes import (
    DAMPING,
    FX,
    INVERSE_MASS,
    LANES,
    LENGTH,
    MASS,
    SQUARED,
    STIFFNESS,
    STRIP_NUMBERS,
    STRIP_WORDS,
    A,
    B,
    P,
    U,
    X,
)
from orbital.kernel import kernel, view

END_A, END_B, END_WORDS = range(3)
"""Of a listed thread: its ends, by their places in the list of nodes."""
(
    NX, NY, NZ, ALONG, ACROSS, DASHPOT, SPRING, REST, PULLS, FIRST_TUG, SECOND_TUG, FIRST_SLIP, SECOND_SLIP,
    THREAD_NUMBERS,
) = range(14)  # fmt: skip
"""Of a listed thread: direction n; g (k - T/r) and g T/r [kg/s]; d, k and L; 1 if it pulls as the substep begins; what
its dashpot pulls with at either stage [N]; what its spring would, where the law holds the tension at zero [N]."""
SOLUTION, RESIDUAL, DIRECTION, IMAGE, WEIGHT, INVERSE, VECTORS = range(7)
"""Vectors over the listed nodes, three numbers each: of the conjugate gradients, and the masses and their inverses."""


class Held(NamedTuple):
    """Kernels of the list; `p.matrix_nodes` and `p.matrix_threads` count what is on it.

    words(p)                           whole numbers of work memory it wants
    nodes(p, work)                     slots of the listed nodes
    ends(p, work), numbers(p, work)    of the listed threads, END_WORDS and THREAD_NUMBERS each
    vector(p, work, which)             one of VECTORS
    clear(p, work)                     nothing is listed
    gather(p, work, start, place, g)   list what is taut at a place and not listed yet; how many there were
    hold(p, work)                      forces that the law leaves out at the second stage, at X and P
    dissipate(p, work, start, first, second, share)   what the dashpots took in a substep
    """

    words: Any
    nodes: Any
    ends: Any
    numbers: Any
    vector: Any
    clear: Any
    gather: Any
    hold: Any
    dissipate: Any


def make_held(composition: Any, taut_lanes: Any) -> Held:
    """Kernels of the list of the composition's threads; `taut_lanes` of `threads`."""
    memory = composition.memory
    node_plane, strips, properties, own, reals_of = (
        memory.node_plane,
        memory.strips,
        memory.properties,
        memory.own,
        memory.reals,
    )
    from fmu_src.lanes import lowest

    @kernel
    def words(p):
        """Places, slots, masses and their inverses, vectors; ends and numbers of threads [1].

        Checked  tests/net_capture/test_stiff.py
        """
        return (2 + 3 * VECTORS) * p.node_slots + (END_WORDS + THREAD_NUMBERS) * p.net_threads + p.strips

    @view
    def places(p, work):
        """Of each node's slot, its place in the list if it is listed.

        Checked  tests/net_capture/test_stiff.py
        """
        return own(p, work)[0 : p.node_slots]

    @view
    def nodes(p, work):
        """Slots of the listed nodes.

        Checked  tests/net_capture/test_stiff.py
        """
        return own(p, work)[p.node_slots : 2 * p.node_slots]

    @view
    def ends(p, work):
        """Ends of the listed threads, END_WORDS each.

        Checked  tests/net_capture/test_stiff.py
        """
        return own(p, work)[2 * p.node_slots : 2 * p.node_slots + END_WORDS * p.net_threads]

    @view
    def lanes_in(p, work):
        """Listed lanes of each strip, a bit each.

        Checked  tests/net_capture/test_stiff.py
        """
        first = 2 * p.node_slots + END_WORDS * p.net_threads
        return own(p, work)[first : first + p.strips]

    @view
    def reals_from(p, work, first, count):
        """Numbers of its memory.

        Checked  tests/net_capture/test_stiff.py
        """
        begin = p.work_size - 3 * VECTORS * p.node_slots - THREAD_NUMBERS * p.net_threads + first
        return work[begin : begin + count]

    @view
    def vector(p, work, which):
        """One of VECTORS.

        Checked  tests/net_capture/test_stiff.py
        """
        return reals_from(p, work, 3 * which * p.node_slots, 3 * p.node_slots)

    @view
    def numbers(p, work):
        """Numbers of the listed threads, THREAD_NUMBERS each.

        Checked  tests/net_capture/test_stiff.py
        """
        return reals_from(p, work, 3 * VECTORS * p.node_slots, THREAD_NUMBERS * p.net_threads)

    @kernel
    def listed(p, work, node):
        """Place of a node in the list, at whose end it is put if it is not there yet.

        Checked  tests/net_capture/test_stiff.py
        """
        place = places(p, work)[node]
        if place < p.matrix_nodes and nodes(p, work)[place] == node:
            return place
        place = p.matrix_nodes
        p.matrix_nodes += 1
        places(p, work)[node] = place
        nodes(p, work)[place] = node
        for i in range(3 * place, 3 * place + 3):
            vector(p, work, WEIGHT)[i] = node_plane(p, work, MASS)[node]
            vector(p, work, INVERSE)[i] = node_plane(p, work, INVERSE_MASS)[node]
        return place

    @kernel
    def add_thread(p, work, a, b, start, ahead, g, q):
        """List one thread, with its direction where it is stretched.

        Checked  tests/net_capture/test_stiff.py
        """
        strip = properties(p, work)
        n = p.scratch[0:3]
        w = p.scratch[3:6]
        rest = strip[q + LENGTH]
        stiffness = strip[q + STIFFNESS]
        damping = strip[q + DAMPING]
        across = 0.0
        pulls = 0.0
        tug = 0.0
        slip = 0.0
        for place in (start, ahead):
            length = 0.0
            for axis in range(3):
                plane = node_plane(p, work, place + axis)
                n[axis] = np.float64(plane[b]) - np.float64(plane[a])
                length += n[axis] * n[axis]
            length = math.sqrt(length)
            if length > rest:
                rate = 0.0
                for axis in range(3):
                    plane = node_plane(p, work, U + axis)
                    w[axis] = np.float64(plane[b]) - np.float64(plane[a])
                    n[axis] /= length
                    rate += n[axis] * w[axis]
                if place == start:
                    elastic = stiffness * (length - rest)
                    tug = damping * rate
                    across = max(0.0, elastic + tug) / length
                    if across > 0.0:
                        pulls = 1.0
                    else:
                        tug = 0.0
                        slip = elastic
                break
        i = END_WORDS * p.matrix_threads
        j = THREAD_NUMBERS * p.matrix_threads
        p.matrix_threads += 1
        ends(p, work)[i + END_A] = listed(p, work, a)
        ends(p, work)[i + END_B] = listed(p, work, b)
        thread = numbers(p, work)
        thread[j + NX] = n[0]
        thread[j + NY] = n[1]
        thread[j + NZ] = n[2]
        thread[j + ALONG] = g * max(0.0, stiffness - across)
        thread[j + ACROSS] = g * across
        thread[j + DASHPOT] = damping
        thread[j + SPRING] = stiffness
        thread[j + REST] = rest
        thread[j + PULLS] = pulls
        thread[j + FIRST_TUG] = tug
        thread[j + FIRST_SLIP] = slip

    @kernel
    def clear(p, work):
        """Nothing is listed.

        Checked  tests/net_capture/test_stiff.py
        """
        p.matrix_nodes = 0
        p.matrix_threads = 0
        within = lanes_in(p, work)
        for strip in range(p.strips):
            within[strip] = 0

    @kernel
    def gather(p, work, start, place, g):
        """List what is taut at the positions in the planes from `place` on and not listed yet; how many there were.

        Checked  tests/net_capture/test_stiff.py
        """
        before = p.matrix_threads
        slots = p.node_slots
        table = strips(p, work)
        properties_of = properties(p, work)
        within = lanes_in(p, work)
        reals = reals_of(work)
        for strip in range(p.strips):
            s = STRIP_WORDS * strip
            q = STRIP_NUMBERS * strip
            a, b, lanes, squared = table[s + A], table[s + B], table[s + LANES], properties_of[q + SQUARED]
            left = taut_lanes(reals, slots, place, a, b, lanes, squared) & ~np.uint64(within[strip])
            within[strip] = np.int64(np.uint64(within[strip]) | left)
            while left != np.uint64(0):
                i = np.int64(lowest(left))
                left &= left - np.uint64(1)
                add_thread(p, work, a + i, b + i, start, place, g, q)
        return p.matrix_threads - before

    @kernel
    def hold(p, work):
        """Threads that pulled as the substep began are springs still: add what the law has left out. Notes what all
        dashpots pull with at the second stage.

        Checked  tests/net_capture/test_stiff.py
        """
        slot, end, thread = nodes(p, work), ends(p, work), numbers(p, work)
        d = p.scratch[0:3]
        for t in range(p.matrix_threads):
            j = THREAD_NUMBERS * t
            a, b = slot[end[END_WORDS * t + END_A]], slot[end[END_WORDS * t + END_B]]
            length = 0.0
            rate = 0.0
            for axis in range(3):
                d[axis] = 1.0 * node_plane(p, work, X + axis)[b] - node_plane(p, work, X + axis)[a]
                length += d[axis] * d[axis]
                rate += d[axis] * (node_plane(p, work, P + axis)[b] - node_plane(p, work, P + axis)[a])
            length = math.sqrt(length)
            elastic = thread[j + SPRING] * (length - thread[j + REST])
            tug = thread[j + DASHPOT] * rate / length
            pulls = thread[j + PULLS] > 0.0 or (elastic > 0.0 and elastic + tug > 0.0)
            thread[j + SECOND_TUG] = tug if pulls else 0.0
            thread[j + SECOND_SLIP] = 0.0 if pulls else max(0.0, elastic)
            if thread[j + PULLS] == 0.0:
                continue
            if elastic + tug < 0.0 or elastic <= 0.0:
                for axis in range(3):
                    force = node_plane(p, work, FX + axis)
                    force[a] += (elastic + tug) * d[axis] / length
                    force[b] -= (elastic + tug) * d[axis] / length

    @kernel
    def dissipate(p, work, origin, first_stage, second_stage, share):
        """Add what the dashpots took in this substep [J]: their impulses times the mean rates before and after.

            J = h (D1 + D2)/2 + h g d n.(a1 + a2)/2     D1, D2 pulls of the dashpot at the stages, a of its ends

        It is d times the change of length, for a thread that pulls from the start. Where the law holds a tension at
        zero, the dashpot takes what the spring gives.

        origin                        planes of the positions at the start; those of the end are X, the velocities U, P
        first_stage, second_stage     planes of the accelerations of the stages
        share                         g = gamma h                                                           [s]

        Checked  tests/net_capture/test_stiff.py
        """
        h = p.solver_substep
        slot, end, thread = nodes(p, work), ends(p, work), numbers(p, work)
        n = p.scratch[0:3]
        for t in range(p.matrix_threads):
            a, b = slot[end[END_WORDS * t + END_A]], slot[end[END_WORDS * t + END_B]]
            j = THREAD_NUMBERS * t
            length = 0.0
            change = 0.0
            for axis in range(3):
                start, place = node_plane(p, work, origin + axis), node_plane(p, work, X + axis)
                n[axis] = 0.5 * (start[b] - start[a] + place[b] - place[a])
                length += n[axis] * n[axis]
                change += n[axis] * (place[b] - place[a] - start[b] + start[a])
            length = math.sqrt(length)
            change /= length
            mean = 0.0
            turned = 0.0
            for axis in range(3):
                before, after = node_plane(p, work, U + axis), node_plane(p, work, P + axis)
                first, second = node_plane(p, work, first_stage + axis), node_plane(p, work, second_stage + axis)
                mean += 0.5 * n[axis] / length * (before[b] - before[a] + after[b] - after[a])
                turned += n[axis] / length * (first[b] - first[a] + second[b] - second[a])
            implied = share * thread[j + DASHPOT] * turned
            p.thread_loss += 0.5 * h * (thread[j + FIRST_TUG] + thread[j + SECOND_TUG] + implied) * mean
            p.thread_loss -= 0.5 * (thread[j + FIRST_SLIP] + thread[j + SECOND_SLIP]) * change

    return Held(words, nodes, ends, numbers, vector, clear, gather, hold, dissipate)
