"""Position-based dynamics with compliance, one sweep over the threads a substep: order 1, geometry only.

    v = v(n) + h a,   then for one thread after another, with n its direction at x(n), r = |d(n) + h (vb - va)|:
    C = r - L > 0:    lambda = h2 (k C + d n.(vb - va)) / (1 + (1/ma + 1/mb) (h2 k + h d)),   held at lambda >= 0
                      va += lambda n / (h ma),   vb -= lambda n / (h mb)
    x(n + 1) = x(n) + h v(n + 1)

A thread is a distance that may shrink freely, with the compliance 1/k and a dashpot. Each is solved implicitly by
itself from where the threads before it have left its ends, in an order that is fixed, so that bits are the same
everywhere. One thread alone is stable at any step (it is the implicit Euler scheme); of a net no bound is known, and
the cost of a substep does not depend on stiffness. Momentum holds to rounding, and so does angular momentum, since the
impulses lie along the threads as the substep begins.

Its energies are wrong by design, so it is for geometry only. The implicit solution takes what no dashpot took; one
sweep leaves stretches in a stiff net that hold energy which never came in, the more the longer the substep: beyond h
sqrt(k/m) = 1 a pull travels a few threads a substep. `thread.dissipated` tells what the impulses of the dashpots did,
and `energy.remainder` all else. Tensions told are lambda/h2, of the substeps over a macro step; those of a long
substep are too low.

Source   Macklin, Mueller and Chentanez, XPBD: position-based simulation of compliant constrained dynamics, Motion in
         Games (2016), eq. 18 and 26; one sweep in small substeps: Macklin et al., Small steps in physics simulation,
         Symposium on Computer Animation (2019). Directions of the substep's start: Ryckaert, Ciccotti and Berendsen,
         J. Comput. Phys. 23 (1977) 327 (SHAKE)
Checked  tests/net_capture/test_schemes.py, tests/net_capture/test_stiff.py
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from fmu_src.interface import Term
from fmu_src.net_capture.formulas import longest_step
from fmu_src.net_capture.planes import (
    DAMPING,
    FIRST,
    FX,
    INVERSE_MASS,
    LANES,
    LENGTH,
    SHOWN,
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
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.net_capture.schemes import MOST_RATIO, UNBOUNDED, Needs, Scheme, unbounded
from fmu_src.net_capture.schemes.in_step import make_in_step, make_rouse, make_rouse_all
from fmu_src.net_capture.threads import make_threads
from orbital.kernel import kernel

LONGEST = 3.0
"""Default substep times omega, at most."""
KEEPS = 0.01
"""Of the mouth area."""
GEOMETRY_ALONE = {
    **UNBOUNDED,
    "energy_gained": "stretch",
    "energy_lost": "stretch",
    "energy_rises": "stretch",
    "thread_takes": "stretch",
    "order": "",
}
"""Its energies are no measure of a real thread; how far the net is stretched is."""
LEAST_DAMPING = 0.05
"""Damping ratio below which its default step is none: the mouth's curve comes out wrong by 13 % at 0.01, by 25 % at 0
(`python -m tests.stability.matrix table1-capture`); at 0.05 it is within 0.2 %."""


@kernel
def accurate_step(stiffness_rate, damping_rate):
    """Step [s] that keeps the mouth area within 1 %, and no energy.

        h = min(0.3 + 10 zeta, 3) / omega,   zeta omega = damping_rate,   omega^2 = 2 stiffness_rate

    stiffness_rate, damping_rate   as for `formulas.longest_step`

    The scheme damps of itself, by a ratio of about h omega / 2: more than threads of a ratio below 0.1 would.

    Valid    measured with Table 1's net, damping ratio 0.106 over 15 s (0.8 %) and 10 over 8 s
    Source   ours: tests/net_capture/evidence/schemes.py
    Checked  tests/net_capture/test_stiff.py
    """
    omega = math.sqrt(2.0 * stiffness_rate)
    return min(0.3 + 10.0 * damping_rate / omega, LONGEST) / omega


def first_order(values: Mapping[str, float], step: float) -> Mapping[str, tuple[float, float]]:
    """A finer run may differ by the root of 5 %, 22 %, where others may by 5 %; accurate is what is accurate elsewhere.

    With c the share of a swing that a step leaves unresolved, a scheme of order p errs by c^p. Stable is a scheme of
    second order at c^2 = 5 %, and this one at the same c.
    """
    return {"agrees": (0.01, math.sqrt(0.05))}


def refuses(scene: Scene) -> Iterator[Refusal]:
    """Hardly any dashpots at the default step: the scheme damps of itself, and they would not be told from many."""
    ratio = scene.values["net.damping_ratio"]
    if scene.values["solver.step_ratio"] == 0.0 and ratio < LEAST_DAMPING:
        expected = (
            f"must be at least {LEAST_DAMPING:g} with xpbd's default step, which damps of itself: without dashpots the "
            "mouth would come out wrong by 25 %; give a small solver.step_ratio, or take another scheme"
        )
        yield Refusal("net.damping_ratio", f"{ratio:g}", expected)


def make(composition: Any) -> Scheme:
    """Kernels of the scheme with the composition's gravity and pulls."""
    memory, lanes, gravity, pulls = composition.memory, composition.lanes, composition.gravity, composition.pulls
    load, splat, bits, width = lanes.load, lanes.splat, lanes.bits, lanes.width
    node_plane, strips, properties, reals_of = memory.node_plane, memory.strips, memory.properties, memory.reals
    threads = make_threads(composition, P, -1)
    taut_lanes, so_far, note = threads.taut, composition.peaks.so_far, composition.peaks.note
    pull_nodes, pull_nodes_shown, book = pulls.pull, pulls.pull_shown, pulls.book
    accelerate = gravity.accelerate
    _, clear, begin, place = make_in_step(composition)
    is_pushed = gravity.bends or "tether" in composition.terms
    from fmu_src.lanes import highest, lowest, peek, population

    @kernel
    def own_words(p):
        """It wants none [1].

        Checked  tests/net_capture/test_schemes.py
        """
        return 0

    @kernel
    def push(p, work):
        """Gravity and the pulls at single nodes, explicitly.

        Checked  tests/net_capture/test_schemes.py
        """
        h = p.solver_substep
        at = p.scratch[0:3]
        speed = p.scratch[3:6]
        out = p.scratch[6:9]
        pull_nodes(p, work)
        book(p, h)
        inverse = node_plane(p, work, INVERSE_MASS)
        for i in range(p.node_slots):
            if inverse[i] > 0.0:
                for axis in range(3):
                    at[axis] = node_plane(p, work, X + axis)[i]
                    speed[axis] = node_plane(p, work, U + axis)[i]
                accelerate(p, out, at, speed)
                for axis in range(3):
                    force = node_plane(p, work, FX + axis)
                    node_plane(p, work, U + axis)[i] += h * (force[i] * inverse[i] + out[axis])
                    force[i] = 0.0

    @kernel
    def ahead(reals, slots, a, b, lanes, squared, h):
        """Lanes of a strip that would be longer than their rest length after a substep at the velocities of now.

        Checked  tests/net_capture/test_schemes.py
        """
        x = a + X * slots
        y = b + X * slots
        u = a + U * slots
        v = b + U * slots
        limit = splat(squared)
        step = splat(h)
        found = np.uint64(0)
        for j in range(0, np.int64(highest(np.uint64(lanes))) + 1, width):
            dx = load(reals, y + j) - load(reals, x + j)
            dy = load(reals, y + slots + j) - load(reals, x + slots + j)
            dz = load(reals, y + 2 * slots + j) - load(reals, x + 2 * slots + j)
            dx = dx + step * (load(reals, v + j) - load(reals, u + j))
            dy = dy + step * (load(reals, v + slots + j) - load(reals, u + slots + j))
            dz = dz + step * (load(reals, v + 2 * slots + j) - load(reals, u + 2 * slots + j))
            found |= bits(dx * dx + dy * dy + dz * dz > limit) << np.uint64(j)
        return found & np.uint64(lanes)

    @kernel
    def constrain(p, reals, numbers, q, a, b, thread, h):
        """The impulse of one thread on both its nodes; what its dashpot took [J].

        numbers, q    properties of its strip
        a, b, thread  its nodes and its number
        h             substep                                        [s]

        An impulse J changes the kinetic energy by its product with the mean of the rates before and after it, so of
        J = h (T_e + d u') the dashpot takes h d u' (u + u')/2; where the tension is held at zero it takes all that the
        thread gives back, -k C h u.

        Checked  tests/net_capture/test_stiff.py
        """
        slots = p.node_slots
        x = a + X * slots
        y = b + X * slots
        u = a + U * slots
        v = b + U * slots
        nx = np.float64(peek(reals, y)) - np.float64(peek(reals, x))
        ny = np.float64(peek(reals, y + slots)) - np.float64(peek(reals, x + slots))
        nz = np.float64(peek(reals, y + 2 * slots)) - np.float64(peek(reals, x + 2 * slots))
        wx = np.float64(peek(reals, v)) - np.float64(peek(reals, u))
        wy = np.float64(peek(reals, v + slots)) - np.float64(peek(reals, u + slots))
        wz = np.float64(peek(reals, v + 2 * slots)) - np.float64(peek(reals, u + 2 * slots))
        dx = nx + h * wx
        dy = ny + h * wy
        dz = nz + h * wz
        excess = math.sqrt(dx * dx + dy * dy + dz * dz) - numbers[q + LENGTH]
        r = math.sqrt(nx * nx + ny * ny + nz * nz)
        if excess <= 0.0 or r <= 0.0:
            return 0.0
        nx /= r
        ny /= r
        nz /= r
        rate = nx * wx + ny * wy + nz * wz
        k = numbers[q + STIFFNESS]
        d = numbers[q + DAMPING]
        light = np.float64(peek(reals, a + INVERSE_MASS * slots))
        lighter = np.float64(peek(reals, b + INVERSE_MASS * slots))
        both = light + lighter
        tension = (k * excess + d * rate) / (1.0 + both * h * (h * k + d))
        if tension <= 0.0:
            return -k * excess * h * rate
        impulse = h * tension
        after = rate - both * impulse
        if tension > so_far(p, thread):
            note(p, thread, tension)
        first = impulse * light
        second = impulse * lighter
        reals[u] += first * nx
        reals[u + slots] += first * ny
        reals[u + 2 * slots] += first * nz
        reals[v] -= second * nx
        reals[v + slots] -= second * ny
        reals[v + 2 * slots] -= second * nz
        return h * d * after * 0.5 * (rate + after)

    @kernel
    def step(p, work):
        """Pushes, one sweep over all threads, drift.

        Checked  tests/net_capture/test_schemes.py
        """
        h = p.solver_substep
        slots = p.node_slots
        table = strips(p, work)
        numbers = properties(p, work)
        reals = reals_of(work)
        if is_pushed:
            push(p, work)
        for strip in range(p.strips):
            s = STRIP_WORDS * strip
            q = STRIP_NUMBERS * strip
            a, b = table[s + A], table[s + B]
            left = ahead(reals, slots, a, b, table[s + LANES], numbers[q + SQUARED], h)
            while left != np.uint64(0):
                i = np.int64(lowest(left))
                left &= left - np.uint64(1)
                p.thread_loss += constrain(p, reals, numbers, q, a + i, b + i, table[s + FIRST] + i + 1, h)
        for axis in range(3):
            x = node_plane(p, work, X + axis)
            u = node_plane(p, work, U + axis)
            for i in range(slots):
                x[i] += h * u[i]

    @kernel
    def show(p, work):
        """The same, and how many threads are taut; tensions and power are those of the sweeps alone.

        Checked  tests/net_capture/test_schemes.py
        """
        place(p, work)
        table = strips(p, work)
        numbers = properties(p, work)
        reals = reals_of(work)
        count = 0
        for strip in range(p.strips):
            s = STRIP_WORDS * strip
            squared = numbers[STRIP_NUMBERS * strip + SQUARED]
            count += population(
                taut_lanes(reals, p.node_slots, SHOWN, table[s + A], table[s + B], table[s + LANES], squared)
            )
        p.thread_taut = count
        p.thread_power = 0.0
        pull_nodes_shown(p, work)
        clear(p, work)

    return Scheme(0.0, own_words, begin, step, place, threads.stored, show)


PART = Term(
    "position-based dynamics with compliance (XPBD), for the shape of the opening alone: its energies are wrong",
    unbounded(KEEPS),
    make=make,
    excludes=("contact", "closing"),
    checks=Needs(
        make_rouse,
        make_rouse_all,
        0,
        longest_step,
        accurate_step,
        factors=(8.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.1),
        steepest=MOST_RATIO,
        keeps=KEEPS,
        keeps_energy=False,
        follows=False,
        whole=False,
        falls="with solver.step_ratio",
        instead=GEOMETRY_ALONE,
        within=first_order,
    ),
    refuses=refuses,
)
