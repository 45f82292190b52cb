"""The classical Runge-Kutta scheme: order 4 while no thread changes between slack and taut, 1 when some do.

    k1 = f(y),  k2 = f(y + h k1 / 2),  k3 = f(y + h k2 / 2),  k4 = f(y + h k3),  y' = y + h (k1 + 2 k2 + 2 k3 + k4) / 6

Stable up to h |lambda| = 2 sqrt(2) on the imaginary axis, 2.785 on the real one, and 2.615 in any direction of the left
half of the plane; four evaluations of all forces a substep, and no row sleeps. What it is for: a second opinion
of the opening. An impulse within a step would spoil its order, so it goes without contact and closing. A target beside
it, which nothing touches, turns to second order as with every scheme.

Source   Kutta (1901); Hairer, Norsett and Wanner, Solving ordinary differential equations I (1993), table II.1.2
Checked  tests/net_capture/test_order.py
"""

from __future__ import annotations

import math
from typing import Any

from fmu_src.interface import Term
from fmu_src.net_capture.formulas import onset_step
from fmu_src.net_capture.planes import (
    FX,
    INVERSE_MASS,
    NODE_PLANES,
    P,
    U,
    X,
)
from fmu_src.net_capture.schemes import Needs, Scheme
from fmu_src.net_capture.schemes.in_step import make_in_step, make_rouse, make_rouse_all
from fmu_src.net_capture.threads import make_threads
from orbital.kernel import kernel

START, START_RATE, SUM, SUM_RATE = (NODE_PLANES + 3 * i for i in range(4))
"""Node planes: state at the start of the substep, weighted sums of the rates of the stages."""
OWN_PLANES = 12
LEAST_RADIUS = 2.615
"""Of the region of stability, measured from 0, in the left half of the plane; least at 122.5 degrees."""


@kernel
def longest_step(stiffness_rate, damping_rate):
    """Longest step [s] at which the scheme is stable at a node, whose swings have the eigenvalues lambda.

        h |lambda| <= 2.615,   |lambda| = omega max(1, zeta + sqrt(zeta^2 - 1))

    stiffness_rate, damping_rate   as for `formulas.longest_step`

    Checked  tests/net_capture/test_schemes.py
    """
    omega = math.sqrt(2.0 * stiffness_rate)
    zeta = damping_rate / omega
    return LEAST_RADIUS / (omega * (zeta + math.sqrt(zeta * zeta - 1.0) if zeta > 1.0 else 1.0))


@kernel
def accurate_step(stiffness_rate, damping_rate):
    """The onset of each pull sets it, as for the leapfrog, as far as the scheme is stable [s].

    Checked  tests/net_capture/test_schemes.py
    """
    return min(onset_step(stiffness_rate, damping_rate), 0.9 * longest_step(stiffness_rate, damping_rate))


def make(composition: Any) -> Scheme:
    """Kernels of the scheme with the composition's gravity, contact and pulls."""
    memory, gravity, pulls = composition.memory, composition.gravity, composition.pulls
    node_plane = memory.node_plane
    threads = make_threads(composition, P, -1)
    pull_now, pull_shown = threads.pull_now, threads.pull_shown
    pull_nodes, pull_nodes_shown, book = pulls.pull, pulls.pull_shown, pulls.book
    accelerate = gravity.accelerate
    copy, clear, begin, place = make_in_step(composition)

    @kernel
    def own_words(p):
        """It wants none [1]."""
        return 0

    @kernel
    def add_stage(p, work, weight, onward):
        """Add a stage's rates to the sums, and go on from the start by `onward` [s] at these rates.

        Checked  tests/net_capture/test_schemes.py
        """
        at = p.scratch[0:3]
        speed = p.scratch[3:6]
        pull = p.scratch[6:9]
        inverse = node_plane(p, work, INVERSE_MASS)
        for i in range(p.node_slots):
            if inverse[i] > 0.0:
                for axis in range(3):
                    at[axis] = node_plane(p, work, X + axis)[i]
                    speed[axis] = node_plane(p, work, P + axis)[i]
                accelerate(p, pull, at, speed)
                for axis in range(3):
                    force = node_plane(p, work, FX + axis)
                    rate = force[i] * inverse[i] + pull[axis]
                    force[i] = 0.0
                    node_plane(p, work, SUM + axis)[i] += weight * speed[axis]
                    node_plane(p, work, SUM_RATE + axis)[i] += weight * rate
                    node_plane(p, work, X + axis)[i] = node_plane(p, work, START + axis)[i] + onward * speed[axis]
                    node_plane(p, work, P + axis)[i] = node_plane(p, work, START_RATE + axis)[i] + onward * rate

    @kernel
    def step(p, work):
        """Four stages, and their weighted sum.

        Checked  tests/net_capture/test_schemes.py
        """
        h = p.solver_substep
        copy(p, work, X, START)
        copy(p, work, U, START_RATE)
        copy(p, work, U, P)
        for axis in range(3):
            for i in range(p.node_slots):
                node_plane(p, work, SUM + axis)[i] = 0.0
                node_plane(p, work, SUM_RATE + axis)[i] = 0.0
        for stage in range(4):
            weight = h / 6.0 if stage == 0 or stage == 3 else h / 3.0
            pull_now(p, work)
            pull_nodes(p, work)
            p.thread_loss += weight * p.thread_power
            book(p, weight)
            add_stage(p, work, weight, h if stage == 2 else 0.5 * h)
        for axis in range(3):
            for i in range(p.node_slots):
                speed = node_plane(p, work, START_RATE + axis)[i] + node_plane(p, work, SUM_RATE + axis)[i]
                node_plane(p, work, X + axis)[i] = (
                    node_plane(p, work, START + axis)[i] + node_plane(p, work, SUM + axis)[i]
                )
                node_plane(p, work, U + axis)[i] = speed
                node_plane(p, work, P + axis)[i] = speed

    @kernel
    def show(p, work):
        """The same, and the power of the dashpots [W].

        Checked  tests/net_capture/test_schemes.py
        """
        place(p, work)
        pull_shown(p, work)
        pull_nodes_shown(p, work)
        clear(p, work)

    @kernel
    def change(p, work, substep):
        """A substep knows nothing of the one before."""

    return Scheme(0.0, own_words, begin, step, place, threads.stored, show, change)


PART = Term(
    "classical Runge-Kutta of order 4, for the opening: a second opinion, at four evaluations of all forces a substep",
    make=make,
    excludes=("contact", "closing"),
    checks=Needs(make_rouse, make_rouse_all, OWN_PLANES, longest_step, accurate_step),
)
