"""Drag of the air on threads and bullets, for tests on the ground.

A thread is a round cylinder: only the part of its speed that runs across it counts (the cross-flow principle), by
halves at the speeds of its two ends. Of a thread that hangs slack only the share `r/l` of its length lies along
its chord; the rest runs anywhere:

    F = -1/2 rho C d l/2 |v_n| v_n,   v_n = v - r (r . v) / max(r, l)^2

    rho   density of the air                  [kg/m3]    C    drag coefficient across it    [1]
    d, l  its diameter, its unloaded length   [m]        r    from one end to the other     [m]

A bullet is a ball: `F = -1/2 rho C_b pi/4 D^2 |v| v`. The air stands still.

No end of a thread, and no bullet, is slowed by more than half its speed in a substep, so drag upsets no step.

Valid    subsonic; threads that do not stand in each other's lee; no mass of air carried along
Source   Hoerner, Fluid-Dynamic Drag (1965), chapter 3
Checked  tests/net_capture/test_air.py
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from fmu_src.extremes import Extreme, times
from fmu_src.interface import Term
from fmu_src.net_capture.planes import (
    FX,
    LANES,
    LENGTH,
    PER_SQUARED,
    SHOWN,
    SHOWN_RATE,
    SQUARED,
    STRIP_NUMBERS,
    STRIP_WORDS,
    THREAD_MASS,
    A,
    B,
    P,
    X,
)
from fmu_src.rows import at_least_zero, output, positive, state
from orbital.kernel import kernel

MOST_SLOWED = 0.5
"""Share of its speed that drag may take in a substep; the leapfrog's prediction is stable up to 1."""


class Air(NamedTuple):
    """Kernels of the air.

    pull(p, work)          add its forces, for a substep; its power into `air_power`
    pull_shown(p, work)    the same for the positions and velocities shown
    """

    pull: Any
    pull_shown: Any


@kernel
def thread_diameter(mass, length, density):
    """Diameter [m] of a round solid thread of that mass [kg], length [m] and density [kg/m3].

    Checked  tests/net_capture/test_air.py
    """
    return math.sqrt(4.0 * mass / (math.pi * density * length))


def make(composition: Any) -> Air:
    """Kernels for the composition's net and what is rigged to it."""
    memory, rouse_all = composition.memory, composition.rouse_all
    node_plane, strips, properties, bullets = memory.node_plane, memory.strips, memory.properties, memory.bullets
    lanes, reals_of = composition.lanes, memory.reals
    load, store, splat, where, root, slide = lanes.load, lanes.store, lanes.splat, lanes.where, lanes.root, lanes.slide
    flags_of, bits, lane, width, last = lanes.flags, lanes.bits, lanes.lane, lanes.width, np.int64(lanes.width - 1)
    group = np.uint64((1 << width) - 1)
    from fmu_src.lanes import highest, peek, poke

    density_of = composition.density_of

    def make_pull(place: int, rate: int, wake: bool) -> Any:
        """Kernel of the drag by the planes of positions and velocities from these on; `wake`: rows may sleep."""

        @kernel
        def across(reals, slots, node, dx, dy, dz, per_squared, share, limit, on):
            """Drag on one end of some threads side by side, three components [N], and what it takes [W].

            dx, dy, dz     the threads                                             [m]
            per_squared    1 over the square of their chord, or of their length    [1/m2]
            share          1/2 rho C d l/2                                         [kg/m]
            limit          the most of force over speed                            [kg/s]
            on             which lanes are threads

            Checked  tests/net_capture/test_air.py
            """
            at = node + rate * slots
            u, v, w = load(reals, at), load(reals, at + slots), load(reals, at + 2 * slots)
            along = (dx * u + dy * v + dz * w) * per_squared
            x, y, z = u - along * dx, v - along * dy, w - along * dz
            drag = share * root(x * x + y * y + z * z)
            drag = where(on, where(drag < limit, drag, limit), splat(0.0))
            x, y, z = drag * x, drag * y, drag * z
            return x, y, z, x * u + y * v + z * w

        @kernel
        def slow_strip(reals, slots, a, b, held, squared, per_squared, share, limit):
            """Take the drag on a strip of threads from the forces on their ends; its power in lanes [W].

            a, b                    nodes of its lane 0
            held                    lanes that are threads
            squared, per_squared    rest length squared [m2], 1 over that [1/m2]
            share                   1/2 rho C d l/2                               [kg/m]
            limit                   the most of force over speed                  [kg/s]

            Of a strip along a row, whose lanes are a chain, a node gets both its threads' drag at once.

            Checked  tests/net_capture/test_air.py
            """
            rest, slack, most, steady = splat(squared), splat(per_squared), splat(share), splat(limit)
            zero, one = splat(0.0), splat(1.0)
            taken, last_x, last_y, last_z = zero, zero, zero, zero
            chained = b == a + 1
            end = np.int64(highest(np.uint64(held))) + 1
            for j in range(0, end, width):
                m, n = a + j, b + j
                on = flags_of((np.uint64(held) >> np.uint64(j)) & group)
                i, k = m + place * slots, n + place * slots
                dx = load(reals, k) - load(reals, i)
                dy = load(reals, k + slots) - load(reals, i + slots)
                dz = load(reals, k + 2 * slots) - load(reals, i + 2 * slots)
                distance = dx * dx + dy * dy + dz * dz
                taut = distance > rest
                per = slack
                if bits(taut) != np.uint64(0):
                    per = where(taut, one / distance, slack)
                ax, ay, az, here = across(reals, slots, m, dx, dy, dz, per, most, steady, on)
                bx, by, bz, there = across(reals, slots, n, dx, dy, dz, per, most, steady, on)
                taken = taken + (here + there)
                i = m + FX * slots
                if chained:
                    store(reals, i, load(reals, i) - (ax + slide(bx, last_x)))
                    store(reals, i + slots, load(reals, i + slots) - (ay + slide(by, last_y)))
                    store(reals, i + 2 * slots, load(reals, i + 2 * slots) - (az + slide(bz, last_z)))
                    last_x, last_y, last_z = bx, by, bz
                else:
                    k = n + FX * slots
                    store(reals, i, load(reals, i) - ax)
                    store(reals, i + slots, load(reals, i + slots) - ay)
                    store(reals, i + 2 * slots, load(reals, i + 2 * slots) - az)
                    store(reals, k, load(reals, k) - bx)
                    store(reals, k + slots, load(reals, k + slots) - by)
                    store(reals, k + 2 * slots, load(reals, k + 2 * slots) - bz)
            if chained:
                i = a + (end + width - 1) // width * width + FX * slots
                poke(reals, i, peek(reals, i) - lane(last_x, last))
                poke(reals, i + slots, peek(reals, i + slots) - lane(last_y, last))
                poke(reals, i + 2 * slots, peek(reals, i + 2 * slots) - lane(last_z, last))
            return taken

        @kernel
        def slow_bullet(p, work, node, share, limit):
            """Drag on a bullet; its power [W].

            share     1/2 rho C A                   [kg/m]
            limit     the most of force over speed  [kg/s]

            Checked  tests/net_capture/test_air.py
            """
            u = 1.0 * node_plane(p, work, rate)[node]
            v = 1.0 * node_plane(p, work, rate + 1)[node]
            w = 1.0 * node_plane(p, work, rate + 2)[node]
            squared = u * u + v * v + w * w
            drag = min(share * math.sqrt(squared), limit)
            node_plane(p, work, FX)[node] -= drag * u
            node_plane(p, work, FX + 1)[node] -= drag * v
            node_plane(p, work, FX + 2)[node] -= drag * w
            return drag * squared

        @kernel
        def pull(p, work):
            """Add the drag of all threads and bullets [N], and its power [W] into `air_power`.

            Checked  tests/net_capture/test_air.py
            """
            if wake:
                rouse_all(p, work)
            table, numbers = strips(p, work), properties(p, work)
            reals, slots = reals_of(work), p.node_slots
            half = 0.5 * p.air_density
            steady = MOST_SLOWED / p.solver_substep
            power = splat(0.0)
            share, limit, last_own, last_length, last_density = 0.0, 0.0, -1.0, -1.0, -1.0
            for strip in range(p.strips):
                s, q = STRIP_WORDS * strip, STRIP_NUMBERS * strip
                length, own = numbers[q + LENGTH], numbers[q + THREAD_MASS]
                density = density_of(p, strip)
                if own != last_own or length != last_length or density != last_density:
                    share = half * p.air_thread_drag * thread_diameter(own, length, density) * 0.5 * length
                    limit = steady * 0.5 * own
                    last_own, last_length, last_density = own, length, density
                squared, per_squared = numbers[q + SQUARED], numbers[q + PER_SQUARED]
                a, b, held = table[s + A], table[s + B], table[s + LANES]
                if held != 0:  # all of them may have broken
                    power = power + slow_strip(reals, slots, a, b, held, squared, per_squared, share, limit)
            taken = 0.0
            for i in range(width):
                taken += lane(power, np.int64(i))
            share = half * p.air_bullet_drag * 0.25 * math.pi * p.air_bullet_diameter * p.air_bullet_diameter
            limit = steady * p.bullets_mass
            for n in range(p.net_corners):
                taken += slow_bullet(p, work, bullets(p, work)[n], share, limit)
            p.air_power = taken

        return pull

    return Air(make_pull(X, P, True), make_pull(SHOWN, SHOWN_RATE, False))


PART = Term(
    "drag of still air on threads and bullets, quadratic in their speed; no row of nodes sleeps in air",
    (
        positive(
            "air.density", "kg/m3", "of the air: 1.225 at sea level and 15 degC (ICAO standard atmosphere)", 1.225
        ),
        at_least_zero(
            "air.thread_drag",
            "1",
            "drag coefficient of a thread across the stream, on its diameter: of a round cylinder 1.0 at Reynolds "
            "numbers of 1000, 1.4 at 100 (Hoerner 1965)",
            1.1,
        ),
        at_least_zero(
            "air.bullet_drag", "1", "drag coefficient of a bullet, on its section: a ball's (Hoerner 1965)", 0.47
        ),
        at_least_zero("air.bullet_diameter", "m", "of a bullet: 5 cm for 0.5 kg of steel", 0.05),
        output("air.dissipated", "J", "taken by the air so far"),
        state("air_power", "W", "what the air takes now"),
        state("air_loss", "J", "taken by the air up to half a substep back"),
    ),
    make=make,
    extremes=(
        *(
            Extreme(
                f"air {factor:g} times as dense",
                "drag up to where it would stop a thread within a substep",
                "energy_gained",
                {"air.density": times("air.density", factor)},
                chief=factor == 1e3,
            )
            for factor in (1e-6, 1e3)
        ),
        Extreme(
            "bullets of 1 m",
            "drag far greater than what a bullet weighs",
            "energy_gained",
            {"air.bullet_diameter": 1.0},
        ),
    ),
)
