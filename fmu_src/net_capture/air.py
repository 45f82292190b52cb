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

from fmu_src.extremes import Extreme, times
from fmu_src.interface import Term
from fmu_src.net_capture.planes import (
    FX,
    LANES,
    LENGTH,
    LONGEST_ROW,
    MASS,
    SHOWN,
    SHOWN_RATE,
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
    memory, rouse = composition.memory, composition.rouse
    node_plane, strips, properties, bullets = memory.node_plane, memory.strips, memory.properties, memory.bullets
    has_edge, has_leads = "edge" in composition.terms, "leads" in composition.terms

    @kernel
    def density_of(p, strip):
        """Of the material of a strip [kg/m3].

        Checked  tests/net_capture/test_air.py
        """
        if has_leads:
            if strip >= p.leads_strip:
                return p.leads_density
        if has_edge:
            if strip >= p.edge_strip:
                return p.edge_density
        return p.net_density

    def make_pull(place: int, rate: int, wake: bool) -> Any:
        """Kernel of the drag by the planes of positions and velocities from these on; `wake`: rows may sleep."""

        @kernel
        def slow(p, work, node, x, y, z, share, limit):
            """Drag on one end of a thread; its power [W].

            x, y, z   the thread over the larger of its chord and its length   [1]
            share     1/2 rho C d l/2                                          [kg/m]
            limit     the most of force over speed                             [kg/s]

            Checked  tests/net_capture/test_air.py
            """
            u = node_plane(p, work, rate)[node]
            v = node_plane(p, work, rate + 1)[node]
            w = node_plane(p, work, rate + 2)[node]
            along = x * u + y * v + z * w
            across_x = u - along * x
            across_y = v - along * y
            across_z = w - along * z
            speed = math.sqrt(across_x * across_x + across_y * across_y + across_z * across_z)
            drag = min(share * speed, limit)
            node_plane(p, work, FX)[node] -= drag * across_x
            node_plane(p, work, FX + 1)[node] -= drag * across_y
            node_plane(p, work, FX + 2)[node] -= drag * across_z
            return drag * (across_x * u + across_y * v + across_z * w)

        @kernel
        def pull(p, work):
            """Add the drag of all threads and bullets [N], and its power [W] into `air_power`.

            Checked  tests/net_capture/test_air.py
            """
            if wake:
                mass = node_plane(p, work, MASS)
                for node in range(p.node_slots):
                    if mass[node] > 0.0:
                        rouse(p, work, node)
            table = strips(p, work)
            numbers = properties(p, work)
            half = 0.5 * p.air_density
            steady = MOST_SLOWED / p.solver_substep
            power = 0.0
            for strip in range(p.strips):
                s = STRIP_WORDS * strip
                length = numbers[STRIP_NUMBERS * strip + LENGTH]
                own = numbers[STRIP_NUMBERS * strip + THREAD_MASS]
                share = half * p.air_thread_drag * thread_diameter(own, length, density_of(p, strip)) * 0.5 * length
                limit = steady * 0.5 * own
                for lane in range(LONGEST_ROW):
                    if (table[s + LANES] >> lane) & 1:
                        a = table[s + A] + lane
                        b = table[s + B] + lane
                        x = node_plane(p, work, place)[b] - node_plane(p, work, place)[a]
                        y = node_plane(p, work, place + 1)[b] - node_plane(p, work, place + 1)[a]
                        z = node_plane(p, work, place + 2)[b] - node_plane(p, work, place + 2)[a]
                        longer = max(math.sqrt(x * x + y * y + z * z), length)
                        x /= longer
                        y /= longer
                        z /= longer
                        power += slow(p, work, a, x, y, z, share, limit)
                        power += slow(p, work, b, x, y, z, share, limit)
            share = half * p.air_bullet_drag * 0.25 * math.pi * p.air_bullet_diameter * p.air_bullet_diameter
            limit = steady * p.bullets_mass
            for n in range(p.net_corners):
                power += slow(p, work, bullets(p, work)[n], 0.0, 0.0, 0.0, share, limit)
            p.air_power = power

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
