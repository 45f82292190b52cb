"""Friction in the canister: what lies in it holds on to its wall, and leaves in the order in which it is drawn.

A node in the canister, with half of each thread that ends there, of length l in all, is held by

    F = mu p l

p being the force with which each metre of thread is pressed on what lies beside it, in the end on the wall. Less than
that does not move it against the canister; moving, it is braked by as much, against its speed there. So a thread drawn
off at a depth z takes the work mu p z for each metre, and the tension mu p z. In every substep

    J = min(F h, u / (1/m + 1/M)),   the node by -J/m, the chaser by J/M along the relative velocity u

so it comes to rest and never turns round. What that takes is J along the mean of the relative velocities before and
after a substep, with the pulls in it: nothing of a node that is held against a pull. The chaser takes the impulse at
the node's place: what that turns it by is booked. Past the muzzle a node is out, and stays so.

Valid    a chaser whose attitude is held. Walls do not guide: a node is braked on its straight way to whoever draws it
Source   Coulomb friction; ours
Checked  tests/net_capture/test_wall.py
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from fmu_src.extremes import Extreme
from fmu_src.interface import Term
from fmu_src.net_capture.planes import (
    LANES,
    LENGTH,
    LONGEST_ROW,
    MASS,
    SHOWN,
    SHOWN_BACK,
    SHOWN_RATE,
    STRIP_NUMBERS,
    STRIP_WORDS,
    A,
    B,
    P,
    U,
    X,
)
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.net_capture.release import BOOKED
from fmu_src.rows import at_least_zero, count, output, peak, positive, state
from orbital.kernel import kernel
from orbital.vectors import cross, dot

SCHEME, PACE = "leapfrog", "fixed"
"""With which a canister may hold on to a net."""
FLAT = "flat"
"""The folding that has no canister."""


class Wall(NamedTuple):
    """Kernels of the canister's friction.

    start(p, work)    all that lies behind the muzzle is in
    wake(p, work)     rows of what is in stay awake
    rub(p, work, before)    brake it over the substep just taken, from a velocity of the chaser [m/s], and let out what
                      has passed the muzzle
    show(p, work)     brake what is shown, up to the instant that is shown
    """

    start: Any
    wake: Any
    rub: Any
    show: Any


def make(composition: Any) -> Wall:
    """Kernels for the composition's net."""
    terms = composition.terms
    if terms["solver"] != SCHEME or terms["substeps"] != PACE:
        raise ValueError(f"net_capture: friction in the canister needs solver = {SCHEME!r}, substeps = {PACE!r}")
    memory, rouse, now, plane = composition.memory, composition.rouse, composition.clock.now, composition.wall_plane
    node_plane, strips, properties, bullets = memory.node_plane, memory.strips, memory.properties, memory.bullets

    @kernel
    def start(p, work):
        """Lengths of thread that hang on the nodes which are in [m], 0 of all others.

        Checked  tests/net_capture/test_wall.py
        """
        held, table, numbers = node_plane(p, work, plane), strips(p, work), properties(p, work)
        for node in range(p.node_slots):
            held[node] = 0.0
        for strip in range(p.strips):
            s = STRIP_WORDS * strip
            half = 0.5 * numbers[STRIP_NUMBERS * strip + LENGTH]
            for lane in range(LONGEST_ROW):
                if (table[s + LANES] >> lane) & 1:
                    held[table[s + A] + lane] += half
                    held[table[s + B] + lane] += half
        for corner in range(p.net_corners):
            held[bullets(p, work)[corner]] = 0.0
        p.wall_stowed = 0
        for node in range(p.node_slots):
            ahead = 0.0
            for axis in range(3):
                way = np.float64(node_plane(p, work, X + axis)[node]) - p.muzzle[axis]
                ahead += way * p.axes[6 + axis]
            if ahead > 0.0:
                held[node] = 0.0
            p.wall_stowed += 1 if held[node] > 0.0 else 0
        p.wall_emptied = -1.0
        p.wall_loss = 0.0

    @kernel
    def wake(p, work):
        """Rows of what is in stay awake.

        Checked  tests/net_capture/test_wall.py
        """
        if p.wall_stowed > 0:
            held = node_plane(p, work, plane)
            for node in range(p.node_slots):
                if held[node] > 0.0:
                    rouse(p, work, node)

    @kernel
    def brake(p, work, node, rate, velocity, duration, turned, place):
        """Impulse between a node and the chaser over a time, shared between both and booked; what the node gives [J].

        rate        planes of the nodes' velocities
        velocity    of the chaser before                   [m/s]
        duration    [s]
        turned      takes the turn of the chaser           [N m s]
        place       of the node, from the chaser           [m]

        Velocity of the node before the pulls of this time stands in `wall_before` [m/s], what the chaser has got so far
        in `wall_given` [N s], the change of the node's velocity in `wall_change` [m/s].

        Checked  tests/net_capture/test_wall.py
        """
        going, change, moment = p.wall_going, p.wall_change, p.wall_moment
        mass = np.float64(node_plane(p, work, MASS)[node])
        for axis in range(3):
            chaser = velocity[axis] + p.wall_given[axis] / p.chaser_mass
            going[axis] = np.float64(node_plane(p, work, rate + axis)[node]) - chaser
            change[axis] = 0.0
        speed = math.sqrt(dot(going, going))
        if speed == 0.0:
            return 0.0
        light = 1.0 / mass + 1.0 / p.chaser_mass
        hold = p.wall_friction * p.wall_pressing * np.float64(node_plane(p, work, plane)[node])
        impulse = min(hold * duration, speed / light)
        for axis in range(3):
            going[axis] *= impulse / speed
            change[axis] = -going[axis] / mass
            node_plane(p, work, rate + axis)[node] += change[axis]
            p.wall_given[axis] += going[axis]
        cross(moment, place, going)
        given = 0.0
        for axis in range(3):
            turned[axis] += moment[axis]
            after = np.float64(node_plane(p, work, rate + axis)[node])
            given += 0.5 * going[axis] * (p.wall_before[axis] + after)
        return given

    @kernel
    def taken(p, before, velocity):
        """What the chaser gets of all that nodes give [J], by its velocity before, without and with its pulls [m/s].

        Checked  tests/net_capture/test_wall.py
        """
        given = p.wall_given
        return 0.5 * (dot(given, before) + dot(given, velocity) + dot(given, given) / p.chaser_mass)

    @kernel
    def rub(p, work, before):
        """Brake what is in over the substep just taken, whose drift goes with it; and let out what passes the muzzle.

        before    velocity of the chaser before that substep [m/s]

        Checked  tests/net_capture/test_wall.py
        """
        if p.wall_stowed == 0:
            return
        h = p.solver_substep
        held, place = node_plane(p, work, plane), p.wall_place
        for axis in range(3):
            p.wall_given[axis] = 0.0
        for node in range(p.node_slots):
            if held[node] > 0.0:
                for axis in range(3):
                    was = np.float64(node_plane(p, work, X + axis)[node])
                    was -= h * np.float64(node_plane(p, work, U + axis)[node])
                    place[axis] = was - p.chaser_place[axis]
                    # predicted is half the last kick beyond
                    p.wall_before[axis] = 3.0 * np.float64(node_plane(p, work, U + axis)[node])
                    p.wall_before[axis] -= 2.0 * np.float64(node_plane(p, work, P + axis)[node])
                p.wall_loss += brake(p, work, node, U, p.chaser_drift, h, p.chaser_turned, place)
                for axis in range(3):
                    node_plane(p, work, X + axis)[node] += h * p.wall_change[axis]
                    node_plane(p, work, P + axis)[node] += 1.5 * p.wall_change[axis]
        p.wall_loss -= taken(p, before, p.chaser_drift)
        for axis in range(3):
            p.chaser_drift[axis] += p.wall_given[axis] / p.chaser_mass
        for node in range(p.node_slots):
            if held[node] > 0.0:
                ahead = 0.0
                for axis in range(3):
                    muzzle = p.chaser_place[axis] + h * p.chaser_drift[axis]
                    ahead += (np.float64(node_plane(p, work, X + axis)[node]) - muzzle) * p.axes[6 + axis]
                if ahead > 0.0:
                    held[node] = 0.0
                    p.wall_stowed -= 1
        if p.wall_stowed == 0:
            p.wall_emptied = now(p) + h

    @kernel
    def show(p, work):
        """Brake what is shown over the half substep up to the instant that is shown, and tell what was taken [J].

        Checked  tests/net_capture/test_wall.py
        """
        p.wall_friction_loss = p.wall_loss
        if p.wall_stowed == 0 or p.grid == 0:
            return
        held, place = node_plane(p, work, plane), p.wall_place
        for axis in range(3):
            p.wall_given[axis] = 0.0
        for node in range(p.node_slots):
            if held[node] > 0.0:
                for axis in range(3):
                    place[axis] = np.float64(node_plane(p, work, SHOWN + axis)[node]) - p.chaser_place[axis]
                    p.wall_before[axis] = np.float64(node_plane(p, work, SHOWN_BACK + axis)[node])
                half = 0.5 * p.solver_substep
                given = brake(p, work, node, SHOWN_RATE, p.chaser_velocity, half, p.chaser_spin, place)
                p.wall_friction_loss += given
        p.wall_friction_loss -= taken(p, p.chaser_drift, p.chaser_velocity)
        for axis in range(3):
            p.chaser_velocity[axis] += p.wall_given[axis] / p.chaser_mass

    return Wall(start, wake, rub, show)


def refuses(scene: Scene) -> Iterator[Refusal]:
    """What knows no canister."""
    for group, name, allowed in (("solver", "solver.scheme", SCHEME), ("substeps", "solver.substeps", PACE)):
        found = scene.terms.get(group, allowed)
        if found != allowed:
            yield Refusal(name, f'"{found}"', f'must be "{allowed}" with friction in the canister, [capture.wall]')
    if scene.terms.get("folding", FLAT) == FLAT:
        expected = "has no canister whose wall could hold on to a net: [capture.wall]"
        yield Refusal("folding.pattern", f'"{FLAT}"', expected)


PART = Term(
    "friction in the canister: threads hold on to its wall, and leave as they are drawn",
    (
        at_least_zero(
            "wall.friction",
            "1",
            "coefficient of friction of a thread on the wall and its neighbours: 0.1 of Kevlar 49 on aluminium (Brown "
            "and Burgoyne, Wear 236, 1999)",
            0.1,
        ),
        positive(
            "wall.pressing",
            "N/m",
            "force with which each metre of thread is pressed on them in the canister: how hard the net is packed",
            0.1,
        ),
        count("wall.stowed", "nodes that are still in the canister"),
        peak("wall.emptied", "s", "when the last node left it, since the shot; -1 before"),
        output("wall.friction_loss", "J", "taken by friction in the canister so far"),
        *BOOKED,
        state("wall_loss", "J", "the same up to half a substep back"),
        state("wall_going[#]", "m/s", "of a node against the chaser; then the impulse between them", shape=(3,)),
        state("wall_before[#]", "m/s", "velocity of a node before the pulls of a substep", shape=(3,)),
        state("wall_given[#]", "N.s", "what the chaser takes of all nodes in a substep", shape=(3,)),
        state("wall_change[#]", "m/s", "of the velocity of a node, by friction", shape=(3,)),
        state("wall_moment[#]", "N.m.s", "of that impulse about the chaser", shape=(3,)),
        state("wall_place[#]", "m", "of a node, from the chaser", shape=(3,)),
    ),
    excludes=("spin",),
    make=make,
    refuses=refuses,
    extremes=(
        Extreme(
            "a net packed a thousand times as hard",
            "what is held, is held for good",
            "energy_gained",
            {"wall.pressing": 1e3},
            chief=True,
        ),
        Extreme("a net that lies loose", "friction of a millionth", "energy_gained", {"wall.pressing": 1e-6}),
    ),
)
