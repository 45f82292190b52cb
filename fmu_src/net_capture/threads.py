"""Threads that pull but never push.

Most threads are slack at any time. So a first pass over a strip, free of branches, only asks which of its squared
lengths exceed the squared rest length; tension, damping and force are worked out for the groups of lanes in which one
does, several lanes at once.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from fmu_src.net_capture.planes import (
    DAMPING_PER_SQUARED,
    FIRST,
    FX,
    INVERSE_MASS,
    LANES,
    LENGTH,
    LONGEST_ROW,
    PER_SQUARED,
    SHOWN,
    SHOWN_RATE,
    SQUARED,
    STIFFNESS,
    STRIP_NUMBERS,
    STRIP_WORDS,
    A,
    B,
    X,
)
from orbital.kernel import kernel

SERIES_ENDS = 4e-3
"""Excess r2/L2 - 1 up to which the shortening is summed: the series' own error is then below 4e-13 of it, or 4e-8 in
single precision, which keeps 6e-8."""


@kernel
def thread_tension(length, stretch_rate, rest_length, stiffness, damping):
    """Tension [N] of a thread that can pull but never push.

        T = max(0, k (L - L0) + d dL/dt)   when L > L0, otherwise 0

    length        L      distance between its two nodes   [m]
    stretch_rate  dL/dt  positive while lengthening       [m/s]
    rest_length   L0     unloaded length                  [m]
    stiffness     k      EA / L0                          [N/m]
    damping       d      axial dashpot                    [N s/m]

    Valid    strains small enough that EA is constant
    Source   Benvenuto and Lavagna (D-CoNe), eq. 1 and 3; the clamp at zero is ours
    Checked  tests/net_capture/test_threads.py
    """
    tension = stiffness * (length - rest_length) + damping * stretch_rate
    return tension if length > rest_length and tension > 0.0 else 0.0


class Threads(NamedTuple):
    """Kernels of the threads.

    taut(reals, slots, place, a, b, lanes, squared)      lanes that are stretched, a bit each
    pull(p, reals, slots, numbers, q, a, b, first, taut, earlier)
                                                         add their forces at the velocities predicted; what their
                                                         dashpots take [W], in lanes
    total(x)                                             sum over the lanes
    pull_now(p, work)                                    forces of all threads; counts those that are taut, sums what
                                                         their dashpots take
    pull_shown(p, work)                                  the same, at the positions and velocities shown
    stored(p, work)                                      energy in the stretched threads as shown [J]
    """

    taut: Any
    pull: Any
    total: Any
    pull_now: Any
    pull_shown: Any
    stored: Any


def make_pull(composition: Any, place: int, rate: int, before: int) -> Any:
    """Kernel `pull` for positions and velocities in the planes from `place` and `rate` on.

    before    planes of the velocities of half a substep back; negative: none are kept
    """
    lanes = composition.lanes
    load, store, splat, where, root, bits, lane = (
        lanes.load,
        lanes.store,
        lanes.splat,
        lanes.where,
        lanes.root,
        lanes.bits,
        lanes.lane,
    )
    from fmu_src.lanes import lowest, peek, poke

    width, flags_of, slide = lanes.width, lanes.flags, lanes.slide
    group = np.uint64((1 << width) - 1)
    has_before = before >= 0
    watches = has_before and "contact" in composition.terms
    is_double = composition.terms["precision"] == "double"
    tears = has_before and composition.breaking is not None

    @kernel
    def note_peak(p, tensions, first, above):
        """Keep the largest tension of the macro step, and of which thread; `above` has a bit for each larger one.

        Checked  tests/net_capture/test_threads.py
        """
        while above != np.uint64(0):
            i = np.int64(lowest(above))
            above &= above - np.uint64(1)
            tension = lane(tensions, i)
            if tension > p.thread_tension_peak:
                p.thread_tension_peak = tension
                p.thread_peak_index = first + i + 1

    @kernel
    def end_chain(reals, slots, node, fx, fy, fz):
        """The last thread of a vector of them pulls the node after it.

        Checked  tests/net_capture/test_threads.py
        """
        last = np.int64(width - 1)
        at = node + FX * slots
        poke(reals, at, peek(reals, at) - lane(fx, last))
        poke(reals, at + slots, peek(reals, at + slots) - lane(fy, last))
        poke(reals, at + 2 * slots, peek(reals, at + 2 * slots) - lane(fz, last))

    @kernel
    def pull(p, reals, slots, numbers, q, a, b, first, taut, earlier):
        """Add the forces [N] of the taut lanes of a strip to both their nodes; return what their dashpots take [W], in
        lanes.

            T / r = k s + d (w . r) (1 - s)^2 / L^2,   s = 1 - L / r,   r2 / L2 = 1 + e
            s = e (1/2 - 3/8 e + 5/16 e2 - 35/128 e3 + 63/256 e4 - 231/1024 e5)     while e <= SERIES_ENDS;
        in single precision three terms of it
            D = sum of (T - T_e) dL/dt,   T_e = k (r - L)

        numbers, q    properties of the strips, and which strip this is
        a, b          nodes of its lane 0
        first         number of its first thread
        taut          a bit for each lane that is stretched
        earlier       the same a substep ago

        The rate of stretch is that of the predicted velocities, which belong to the same instant as the positions.
        Where the tension is held at zero the dashpot takes what the shortening thread gives up. A thread that was slack
        a substep ago gives its nodes a kick that no prediction knows of: there the rate is the mean of those before and
        after it. A thread that breaks pulls for half a substep. Of a strip along a row, whose lanes are a chain, a node
        gets the forces of both its threads at once.

        Checked  tests/net_capture/test_threads.py, tests/net_capture/test_energy_book.py
        """
        squared = splat(peek(numbers, q + SQUARED))
        per_squared = splat(peek(numbers, q + PER_SQUARED))
        rest = splat(peek(numbers, q + LENGTH))
        stiffness = splat(peek(numbers, q + STIFFNESS))
        damping = splat(peek(numbers, q + DAMPING_PER_SQUARED))
        zero = splat(0.0)
        half = splat(0.5)
        one = splat(1.0)
        ends = splat(SERIES_ENDS)
        half_step = splat(0.5 * p.solver_substep)
        peak = splat(p.thread_tension_peak)
        taken = zero
        chained = b == a + 1
        following = np.int64(0)
        fx = zero
        fy = zero
        fz = zero
        while taut != np.uint64(0):
            j = lowest(taut) // np.uint64(width) * np.uint64(width)
            here = (taut >> j) & group
            taut -= here << j
            on = flags_of(here)
            m = a + np.int64(j)
            n = b + np.int64(j)
            x = m + place * slots
            y = n + place * slots
            dx = load(reals, y) - load(reals, x)
            dy = load(reals, y + slots) - load(reals, x + slots)
            dz = load(reals, y + 2 * slots) - load(reals, x + 2 * slots)
            x = m + rate * slots
            y = n + rate * slots
            along = (load(reals, y) - load(reals, x)) * dx + (load(reals, y + slots) - load(reals, x + slots)) * dy
            along = along + (load(reals, y + 2 * slots) - load(reals, x + 2 * slots)) * dz
            distance = dx * dx + dy * dy + dz * dz
            over = distance - squared
            e = over * per_squared
            e2 = e * e
            s = half - splat(0.375) * e
            if is_double:
                s = s + e2 * (
                    (splat(0.3125) - splat(0.2734375) * e) + e2 * (splat(0.24609375) - splat(0.2255859375) * e)
                )
            else:
                s = s + e2 * splat(0.3125)
            s = e * s
            if bits(e > ends) != np.uint64(0):
                s = where(e > ends, one - one / root(one + e), s)
            g = one - s
            elastic = stiffness * s
            pulling = elastic + damping * along * (g * g)
            pulling = where(on, where(pulling > zero, pulling, zero), zero)
            tension = pulling * (rest * (one + e) * g)
            above = bits(tension > peak)
            if above != np.uint64(0):
                note_peak(p, tension, first + np.int64(j), above)
                peak = splat(p.thread_tension_peak)
            if tears:
                torn = bits(tension > splat(p.break_strength)) & here
                if torn != np.uint64(0):
                    p.torn_lanes |= np.int64(torn << j)
                    stretch = where(flags_of(torn), rest * s / g, zero)
                    released = half * stiffness * stretch * stretch
                    for i in range(width):
                        p.break_energy += lane(released, np.int64(i))
                    # half of the kick leads to this instant, and it goes no further
                    share = where(flags_of(torn), half, one)
                    pulling = pulling * share
                    elastic = elastic * share
            if watches and bits(tension > splat(p.contact_force)) != np.uint64(0):
                for i in range(width):
                    p.contact_force = max(p.contact_force, 2.0 * lane(tension, np.int64(i)))
            stretching = along
            if has_before and here & ~(earlier >> j) != np.uint64(0):
                x = m + before * slots
                y = n + before * slots
                back = (load(reals, y) - load(reals, x)) * dx + (load(reals, y + slots) - load(reals, x + slots)) * dy
                back = back + (load(reals, y + 2 * slots) - load(reals, x + 2 * slots)) * dz
                light = load(reals, m + INVERSE_MASS * slots) + load(reals, n + INVERSE_MASS * slots)
                onset = flags_of(here & ~(earlier >> j))
                stretching = where(onset, back - half_step * pulling * distance * light, along)
            taken = taken + where(on, (pulling - elastic) * stretching, zero)
            if chained and np.int64(j) != following:
                end_chain(reals, slots, a + following, fx, fy, fz)
                fx = zero
                fy = zero
                fz = zero
            following = np.int64(j) + width
            before_x = fx
            before_y = fy
            before_z = fz
            fx = pulling * dx
            fy = pulling * dy
            fz = pulling * dz
            x = m + FX * slots
            if chained:
                store(reals, x, load(reals, x) + (fx - slide(fx, before_x)))
                store(reals, x + slots, load(reals, x + slots) + (fy - slide(fy, before_y)))
                store(reals, x + 2 * slots, load(reals, x + 2 * slots) + (fz - slide(fz, before_z)))
            else:
                y = n + FX * slots
                store(reals, x, load(reals, x) + fx)
                store(reals, x + slots, load(reals, x + slots) + fy)
                store(reals, x + 2 * slots, load(reals, x + 2 * slots) + fz)
                store(reals, y, load(reals, y) - fx)
                store(reals, y + slots, load(reals, y + slots) - fy)
                store(reals, y + 2 * slots, load(reals, y + 2 * slots) - fz)
        if chained:
            end_chain(reals, slots, a + following, fx, fy, fz)
        return taken

    return pull


def make_threads(composition: Any, rate: int, before: int) -> Threads:
    """Kernels of the threads for a scheme.

    rate      planes of the velocities at the instant of the positions, which the dashpots see
    before    planes of the velocities of half a substep back; negative: none are kept
    """
    memory, lanes = composition.memory, composition.lanes
    load, splat, bits, width = lanes.load, lanes.splat, lanes.bits, lanes.width
    strips, properties, reals_of = memory.strips, memory.properties, memory.reals
    from fmu_src.lanes import highest, population

    lane = lanes.lane
    pull = make_pull(composition, X, rate, before)
    own, follows = memory.own, composition.pace is not None
    can_tear = composition.breaking is not None
    note = composition.pace.note if follows else None

    @kernel
    def total(x):
        """Sum over the lanes.

        Checked  tests/net_capture/test_energy_book.py
        """
        found = 0.0
        for i in range(width):
            found += lane(x, np.int64(i))
        return found

    @kernel
    def taut_lanes(reals, slots, place, a, b, lanes, squared):
        """Lanes of a strip that are longer than their rest length, a bit each.

        place         planes of the positions, from which a and b count
        lanes         those that are threads
        squared       rest length squared [m2]

        Checked  tests/net_capture/test_threads.py
        """
        x = a + place * slots
        y = b + place * slots
        limit = splat(squared)
        found = np.uint64(0)
        if can_tear:
            if lanes == 0:
                return found
        for j in range(0, np.int64(highest(np.uint64(lanes))) + 1, width):
            dx = load(reals, y + j) - load(reals, x + j)
            dy = load(reals, y + slots + j) - load(reals, x + slots + j)
            dz = load(reals, y + 2 * slots + j) - load(reals, x + 2 * slots + j)
            found |= bits(dx * dx + dy * dy + dz * dz > limit) << np.uint64(j)
        return found & np.uint64(lanes)

    def make_pull_all(place: int, rate: int) -> Any:
        """Kernel that adds the forces of all threads at the positions and velocities in these planes."""
        pull_there = make_pull(composition, place, rate, -1)
        notes = follows and place == X

        @kernel
        def pull_all(p, work):
            """Add the forces of all threads; count those that are taut, sum what their dashpots take [W].

            Checked  tests/net_capture/test_threads.py
            """
            slots = p.node_slots
            table = strips(p, work)
            numbers = properties(p, work)
            reals = reals_of(work)
            power = splat(0.0)
            count = 0
            for strip in range(p.strips):
                s = STRIP_WORDS * strip
                q = STRIP_NUMBERS * strip
                squared = numbers[q + SQUARED]
                found = taut_lanes(reals, slots, place, table[s + A], table[s + B], table[s + LANES], squared)
                if found != np.uint64(0):
                    count += population(found)
                    if notes:
                        note(p, reals, table, numbers, own(p, work), strip, found)
                    power = power + pull_there(
                        p, reals, slots, numbers, q, table[s + A], table[s + B], table[s + FIRST], found, found
                    )
            p.thread_taut = count
            p.thread_power = total(power)

        return pull_all

    @kernel
    def stored(p, work):
        """Energy in the stretched threads [J], sum of k (r - L)^2 / 2.

        Checked  tests/net_capture/test_energy_book.py
        """
        slots = p.node_slots
        table = strips(p, work)
        numbers = properties(p, work)
        reals = reals_of(work)
        whole = 0.0
        for strip in range(p.strips):
            s = STRIP_WORDS * strip
            q = STRIP_NUMBERS * strip
            length = numbers[q + LENGTH]
            energy = 0.0
            found = taut_lanes(reals, slots, SHOWN, table[s + A], table[s + B], table[s + LANES], length * length)
            for i in range(LONGEST_ROW):
                if (found >> np.uint64(i)) & np.uint64(1):
                    squared = 0.0
                    for axis in range(3):
                        plane = (SHOWN + axis) * slots + i
                        d = np.float64(reals[plane + table[s + B]]) - np.float64(reals[plane + table[s + A]])
                        squared += d * d
                    stretch = math.sqrt(squared) - length
                    energy += stretch * stretch
            whole += 0.5 * numbers[q + STIFFNESS] * energy
        return whole

    return Threads(taut_lanes, pull, total, make_pull_all(X, rate), make_pull_all(SHOWN, SHOWN_RATE), stored)
