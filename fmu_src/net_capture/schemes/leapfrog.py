"""Leapfrog: velocities live half a substep before positions, so one evaluation of the forces serves.

    v(n + 1/2) = v(n - 1/2) + h a(x(n)),   x(n + 1) = x(n) + h v(n + 1/2)

Dashpots see the velocity predicted for the instant of the positions, v(n - 1/2) plus half the last kick: half a substep
back they would make the scheme one of first order.

Order 2 with damping, where no thread changes between slack and taut. Stable up to `explicit_step_limit` of
`orbital.oscillators`.

Rows that nothing pulls are left alone, see `asleep`.

Rows are taken in order. Each strip belongs to the first of its two rows, so when a row's turn has come all its forces
are there: it is kicked and drifted at once, while it is still in the first cache.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fmu_src.interface import Term
from fmu_src.net_capture.planes import (
    FIRST,
    FX,
    INVERSE_MASS,
    LANES,
    LENGTH,
    SHOWN,
    SHOWN_BACK,
    SHOWN_RATE,
    SQUARED,
    STRIP_NUMBERS,
    STRIP_WORDS,
    A,
    B,
    P,
    U,
    X,
)
from fmu_src.net_capture.schemes import Needs, Scheme
from fmu_src.net_capture.schemes.asleep import (
    CLEAR,
    KICKED,
    NEXT,
    OWN_END,
    QUIET,
    QUIET_LOOKS,
    ROW_A,
    ROW_B,
    ROW_WORDS,
    SLEEP_WORDS,
    STAMP,
    STRIPS,
    TAUT,
    TOUCHED,
    WAKE,
    make_asleep,
    make_rouse,
    make_rouse_all,
)
from fmu_src.net_capture.stepping import LONGEST_SLEEP
from fmu_src.net_capture.threads import make_threads
from orbital.kernel import kernel

LAG = 0.5
"""Velocities lie half a substep before positions."""


def make(composition: Any) -> Scheme:
    """Kernels of the scheme with the composition's gravity, contact and pulls."""
    memory, lanes, gravity = composition.memory, composition.lanes, composition.gravity
    contact, pulls = composition.contact, composition.pulls
    threads = make_threads(composition, P, U)
    taut_lanes, pull, pull_shown, total = threads.taut, threads.pull, threads.pull_shown, threads.total
    load, store, splat = lanes.load, lanes.store, lanes.splat
    strips, properties, own, reals_of = memory.strips, memory.properties, memory.own, memory.reals
    node_plane, width = memory.node_plane, lanes.width
    asleep = make_asleep(composition)
    find_neighbours, fly_row, bring, sleep = asleep.find_neighbours, asleep.fly_row, asleep.bring, asleep.sleep
    mark, wake_strips = asleep.mark, asleep.wake_strips
    from fmu_src.lanes import lowest, peek, poke

    group = np.uint64((1 << width) - 1)

    kick_group, coast_group, fly_group = gravity.kick_group, gravity.coast_group, gravity.fly_group
    begin_flight, accelerate = gravity.begin_flight, gravity.accelerate
    bends, rate_of = gravity.bends, gravity.rate
    has_contact = contact is not None
    begin_step, touch_row, clear_steps, hurries = (
        (contact.begin_step, contact.touch_row, contact.clear_steps, contact.hurries) if has_contact else [None] * 4
    )
    pull_nodes, pull_nodes_shown, book = pulls.pull, pulls.pull_shown, pulls.book
    follows, breaking = composition.pace is not None, composition.breaking
    can_tear = breaking is not None
    tear = breaking.tear if can_tear else None
    note = composition.pace.note if follows else None

    @kernel
    def begin(p, work):
        """Velocities half a substep back, from those of the start; all rows awake.

        Checked  tests/net_capture/test_sleep.py
        """
        find_neighbours(p, work)
        half = 0.5 * p.solver_substep
        for axis in range(3):
            for i in range(p.node_slots):
                node_plane(p, work, P + axis)[i] = node_plane(p, work, U + axis)[i]
                node_plane(p, work, SHOWN + axis)[i] = node_plane(p, work, X + axis)[i]
                node_plane(p, work, SHOWN_RATE + axis)[i] = node_plane(p, work, U + axis)[i]
        pull_shown(p, work)
        pull_nodes_shown(p, work)
        add_gravity(p, work, SHOWN_RATE)
        for axis in range(3):
            for i in range(p.node_slots):
                change = half * node_plane(p, work, FX + axis)[i] * node_plane(p, work, INVERSE_MASS)[i]
                node_plane(p, work, U + axis)[i] -= change
                node_plane(p, work, FX + axis)[i] = 0.0

    @kernel
    def add_gravity(p, work, rate):
        """Add gravity's apparent force [N] at the positions shown and the velocities in the planes from `rate` on.

        Checked  tests/net_capture/test_sleep.py
        """
        at = p.scratch[0:3]
        speed = p.scratch[3:6]
        out = p.scratch[6:9]
        inverse = node_plane(p, work, INVERSE_MASS)
        for i in range(p.node_slots):
            if inverse[i] > 0.0:
                for axis in range(3):
                    at[axis] = node_plane(p, work, SHOWN + axis)[i]
                    speed[axis] = node_plane(p, work, rate + axis)[i]
                accelerate(p, out, at, speed)
                for axis in range(3):
                    node_plane(p, work, FX + axis)[i] += out[axis] / inverse[i]

    @kernel
    def look_at_strip(p, reals, table, numbers, words, z, strip):
        """Forces of one strip, and when to look at it again; what its dashpots take [W], in lanes.

        z         where the words of its sleep stand

        Checked  tests/net_capture/test_sleep.py
        """
        s = STRIP_WORDS * strip
        q = STRIP_NUMBERS * strip
        a = peek(table, s + A)
        b = peek(table, s + B)
        in_a = peek(words, z + ROW_A)
        in_b = peek(words, z + ROW_B)
        bring(p, reals, words, in_a)
        bring(p, reals, words, in_b)
        taut = taut_lanes(reals, p.node_slots, X, a, b, peek(table, s + LANES), peek(numbers, q + SQUARED))
        earlier = np.uint64(peek(words, z + TAUT))
        poke(words, z + WAKE, p.grid + 1)
        poke(words, z + TAUT, np.int64(taut))
        if taut != np.uint64(0):
            if follows:
                note(p, reals, table, numbers, words, strip, taut)
            poke(words, z + QUIET, 0)
            mark(p, words, in_a, a, taut)
            mark(p, words, in_b, b, taut)
            power = pull(p, reals, p.node_slots, numbers, q, a, b, peek(table, s + FIRST), taut, earlier)
            if can_tear:
                tear(p, table, strip)
            return power
        if can_tear:
            if peek(table, s + LANES) == 0:
                poke(words, z + WAKE, p.grid + LONGEST_SLEEP)
                return splat(0.0)
        quiet = peek(words, z + QUIET) + 1
        poke(words, z + QUIET, quiet)
        if quiet > QUIET_LOOKS:
            steps = sleep(p, reals, a, b, peek(table, s + LANES), peek(numbers, q + LENGTH))
            poke(words, z + WAKE, p.grid + steps)
        return splat(0.0)

    @kernel
    def drift(p, reals, first, end):
        """Nodes that nothing pulls, a substep on.

        Checked  tests/net_capture/test_sleep.py
        """
        step = splat(p.solver_substep)
        slots = p.node_slots
        for i in range(first, end, width):
            for axis in range(3):
                at = i + axis * slots
                store(reals, at, load(reals, at) + step * load(reals, at + U * slots))

    @kernel
    def kick_row(p, reals, row, lanes, n):
        """Drift the row, and kick the lanes that are pulled, or were a substep ago: their predicted velocities change
        once more. Under gravity that bends all are kicked.

        Checked  tests/net_capture/test_sleep.py
        """
        pitch, slots, substep = p.row_pitch, p.node_slots, p.solver_substep
        first = row * pitch
        if bends:
            for i in range(first, first + pitch, width):
                kick_group(p, reals, i, slots, substep, n)
        else:
            drift(p, reals, first, first + pitch)
            here = lanes & (np.uint64(0xFFFFFFFFFFFFFFFF) >> np.uint64(64 - pitch))
            while here != np.uint64(0):
                j = lowest(here) // np.uint64(width) * np.uint64(width)
                here &= ~(group << j)
                kick_group(p, reals, first + np.int64(j), slots, substep, n)

    @kernel
    def step(p, work):
        """Forces, kick, drift and contact of every row that is awake.

        Checked  tests/net_capture/test_sleep.py
        """
        reals = reals_of(work)
        words = own(p, work)
        table = strips(p, work)
        numbers = properties(p, work)
        rows = p.node_slots // p.row_pitch
        listed = ROW_WORDS * rows + SLEEP_WORDS * p.strips
        n = rate_of(p)
        power = splat(0.0)
        pull_nodes(p, work)
        book(p, p.solver_substep)
        hurried = False
        if has_contact:
            hurried = hurries(p)
            begin_step(p, n)
        for row in range(rows):
            r = ROW_WORDS * row
            if hurried:
                words[r + CLEAR] = 0
            elif words[r + NEXT] > p.grid and (not has_contact or words[r + CLEAR] > p.grid):
                continue
            following = p.grid + LONGEST_SLEEP
            for m in range(words[r + STRIPS], words[r + OWN_END]):
                strip = peek(words, listed + m)
                z = ROW_WORDS * rows + SLEEP_WORDS * strip
                if peek(words, z + WAKE) <= p.grid:
                    power = power + look_at_strip(p, reals, table, numbers, words, z, strip)
                following = min(following, peek(words, z + WAKE))
            touched = words[r + TOUCHED]
            near = False
            if has_contact:
                # of a row that begins to be pulled, or pulled more than any was, nothing is known
                near = words[r + CLEAR] <= p.grid
                near = near or (touched != 0 and (words[r + KICKED] == 0 or p.contact_force > p.contact_reckoned))
            if touched != 0:
                bring(p, reals, words, row)
                kick_row(p, reals, row, np.uint64(touched | words[r + KICKED]), n)
                words[r + KICKED] = touched
                words[r + TOUCHED] = 0
                words[r + STAMP] = p.grid + 1
                wake_strips(p, words, rows, row)
                following = p.grid + 1
            elif words[r + KICKED] != 0:
                bring(p, reals, words, row)
                for j in range(0, p.row_pitch, width):
                    coast_group(p, reals, row * p.row_pitch + j, p.node_slots, p.solver_substep, n)
                words[r + KICKED] = 0
            if has_contact and near:
                if touched == 0:
                    fly_row(p, reals, row, words[r + STAMP], p.grid + 1 - words[r + STAMP])
                    words[r + STAMP] = p.grid + 1
                clear = 0
                if words[r + CLEAR] > p.grid:
                    clear = clear_steps(p, work, row * p.row_pitch, touched != 0)
                if clear == 0:
                    hit = touch_row(p, work, row * p.row_pitch)
                    if hit > 0:
                        words[r + KICKED] = -1
                        wake_strips(p, words, rows, row)
                        following = p.grid + 1
                    elif hit < 0:
                        clear = clear_steps(p, work, row * p.row_pitch, touched != 0)
                words[r + CLEAR] = p.grid + 1 + clear
            words[r + NEXT] = following
        p.thread_loss += p.solver_substep * total(power)

    @kernel
    def place(p, work):
        """Positions and velocities of now into the planes shown, and the velocities of half a substep back.

        Checked  tests/net_capture/test_sleep.py
        """
        reals = reals_of(work)
        words = own(p, work)
        slots = p.node_slots
        for row in range(slots // p.row_pitch):
            stamp = words[ROW_WORDS * row + STAMP]
            first = row * p.row_pitch
            if stamp != p.grid:
                begin_flight(p, p.flight, stamp, p.grid - stamp)
                for i in range(first, first + p.row_pitch, width):
                    fly_group(reals, i, slots, p.flight, SHOWN, SHOWN_RATE, SHOWN_BACK)
            else:
                for i in range(first, first + p.row_pitch, width):
                    for axis in range(3):
                        at = i + axis * slots
                        store(reals, at + SHOWN * slots, load(reals, at))
                        store(reals, at + SHOWN_RATE * slots, load(reals, at + P * slots))
                        store(reals, at + SHOWN_BACK * slots, load(reals, at + U * slots))

    @kernel
    def show(p, work):
        """The same with the velocities of now, and those with which the next substep begins.

        Checked  tests/net_capture/test_sleep.py
        """
        place(p, work)
        pull_shown(p, work)
        pull_nodes_shown(p, work)
        half = 0.5 * p.solver_substep
        inverse = node_plane(p, work, INVERSE_MASS)
        if bends:
            for axis in range(3):
                for i in range(p.node_slots):
                    change = half * node_plane(p, work, FX + axis)[i] * inverse[i]
                    node_plane(p, work, SHOWN_RATE + axis)[i] = node_plane(p, work, SHOWN_BACK + axis)[i] + change
            add_gravity(p, work, SHOWN_RATE)
        for axis in range(3):
            for i in range(p.node_slots):
                change = half * node_plane(p, work, FX + axis)[i] * inverse[i]
                now = node_plane(p, work, SHOWN_BACK + axis)[i] + change
                node_plane(p, work, SHOWN_RATE + axis)[i] = now
                node_plane(p, work, SHOWN_BACK + axis)[i] = now + change
                node_plane(p, work, FX + axis)[i] = 0.0

    @kernel
    def change(p, work, substep):
        """Velocities half of another substep back, as the forces of now have it; all rows awake.

            v(t - h'/2) = v(t) - h'/2 a(t)

        Checked  tests/net_capture/test_following.py
        """
        reals = reals_of(work)
        words = own(p, work)
        rows = p.node_slots // p.row_pitch
        for row in range(rows):
            bring(p, reals, words, row)
            words[ROW_WORDS * row + NEXT] = 0
            words[ROW_WORDS * row + CLEAR] = 0
        for strip in range(p.strips):
            words[ROW_WORDS * rows + SLEEP_WORDS * strip + WAKE] = 0
        show(p, work)
        share = substep / p.solver_substep
        for axis in range(3):
            back = node_plane(p, work, U + axis)
            for i in range(p.node_slots):
                now = node_plane(p, work, SHOWN_RATE + axis)[i]
                back[i] = now - share * (node_plane(p, work, SHOWN_BACK + axis)[i] - now)

    fault = composition.self_contact.fault if composition.self_contact is not None else None
    return Scheme(LAG, asleep.own_words, begin, step, place, threads.stored, show, change, fault)


PART = Term(
    "leapfrog with predicted velocities: order 2, dashpots included; rows that nothing pulls are left alone",
    make=make,
    checks=Needs(make_rouse, make_rouse_all, 0),
)
