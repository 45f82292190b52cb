"""Friction of a thread that lies over edges: how its length is shared among the pieces between them.

A piece of the way, of length l, holds u of the thread's unstretched length, so it pulls with

    T = k L (l / u - 1),   k and L of the whole thread

Over an edge the thread turns by an angle phi, and does not slide while neither side pulls more than exp(mu phi) times
the other. Beyond that, length goes over from the slack to the tight side until it is just that:

    T_a = g T_b   gives   u_a = 2 l_a S / (b + sqrt(b2 - 4 (1 - g) l_a S)),   b = l_a + S + g (l_b - S),   S = u_a + u_b

and of each du that goes over friction takes (T_a - T_b) (1 + (T_a + T_b) / 2 k L) du, which the pieces store less. phi
is the angle of the helix that the thread would be round the edge if that were a little rounded: by how far it turns
about the edge, times the sine of its angle to it.

Where the way comes to go over another edge at one of its ends, a piece is cut in two that pull alike; where it leaves
one, two become one. Where it has slid over a corner nothing of this is known any more: it is shared as it would lie
without friction, and what it stored beyond that is lost as well.

The dashpot of a thread is one, of the whole way, and does not count in what slides. Along an edge a way slides without
friction, to where it is the shortest.

Valid    small strains; quasi-static: a thread has no mass of its own on its way
Source   L. Euler, Remarques sur l'effet du frottement dans l'equilibre, Mem. Acad. Berlin 18 (1762) 265
Checked  tests/net_capture/test_capstan.py
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from fmu_src.interface import Variable
from fmu_src.net_capture.contact.friction import FRICTION
from fmu_src.net_capture.contact.section import MOST
from fmu_src.net_capture.contact.shortest import TAU, along
from fmu_src.net_capture.near import FINE, KEPT
from fmu_src.rows import at_least_zero, count, peak, state
from orbital.kernel import kernel

HELD, EXCESS, PARTS = KEPT, KEPT + 1, KEPT + 2
PLACES, DRAGS, WITH_FRICTION = PARTS + MOST, PARTS + 2 * MOST, PARTS + 3 * MOST
"""Whole numbers kept of a thread behind those that any has: of how many pieces the next are, what it stores beyond what
it would without friction [pJ], the unstretched length in each piece but the last and where the way crosses each edge
[pm], and by how much one side of it pulls more than the other [pN]; `FINE` of a unit to one."""
SWEEPS = 60
"""Over all edges at most, in each of which length goes over every edge that it slides over."""
STRAIN = 1e-12
"""By which one side of an edge may be strained more than friction bears."""


class Capstan(NamedTuple):
    """Kernels of friction, of a thread whose way over so many edges is in `wrap_pieces` and `wrap_edges`.

    start(p)                                  nothing lost yet
    remember(p)                               keep the names of its edges, before a way is found anew
    hold(p, words, at, edges, way, length, stiffness, known)  let it slide, and book that; elastic pulls into
                                              `wrap_pulls` [N]
    let_go(p, words, at)                      it is slack or straight
    stretch(p, words, at, edges, way, length, stiffness) -> energy   pulls as it is held now, without sliding [J]
    """

    start: Any
    remember: Any
    hold: Any
    let_go: Any
    stretch: Any


def rows() -> Iterator[Variable]:
    """Rows of a thread that bends with friction."""
    yield at_least_zero(
        "wrap.friction", "1", "coefficient of friction between a thread and the target's edges", FRICTION
    )
    yield peak("wrap.friction_loss", "J", "lost by threads that slid over edges along themselves")
    yield peak("wrap.slide", "m", "sum of all lengths of thread that slid over an edge")
    yield count("wrap_names[#]", "edges over which a way goes, by their bodies and faces", "state", shape=(MOST,))
    yield count("wrap_before[#]", "edges over which it went a substep ago", "state", shape=(MOST,))
    for name, unit, text, rows in (
        ("parts", "m", "unstretched length in every piece of a way", MOST + 1),
        ("was", "m", "the same before it slides", MOST + 1),
        ("pulls", "N", "elastic pull of every piece", MOST + 1),
        ("drags", "N", "by how much one side of an edge pulled more than the other a substep ago", MOST),
        ("grips", "1", "how many times one side of an edge may pull what the other does", MOST),
        ("rates", "m/s", "at which either end of a way lengthens it", 2),
    ):
        yield state(f"wrap_{name}[#]", unit, text, shape=(rows,))


def make_capstan() -> Capstan:
    """Kernels of friction."""

    @kernel
    def start(p):
        """Nothing lost yet.

        Checked  tests/net_capture/test_capstan.py
        """
        p.wrap_friction_loss = 0.0
        p.wrap_slide = 0.0

    @kernel
    def remember(p):
        """Keep the edges over which the way went.

        Checked  tests/net_capture/test_capstan.py
        """
        for j in range(MOST):
            p.wrap_before[j] = p.wrap_names[j]

    @kernel
    def share(p, edges, way, length):
        """Share the thread among the pieces as it lies without friction: all pull alike.

        Checked  tests/net_capture/test_capstan.py
        """
        for j in range(edges + 1):
            p.wrap_parts[j] = length * p.wrap_pieces[j, 3] / way

    @kernel
    def shift_of(p, edges, before):
        """By how many places the edges of the way stood farther on a substep ago; MOST + 1 where it is another way.

        Checked  tests/net_capture/test_capstan.py
        """
        for shift in range(1 - edges, before):
            alike = 0
            for j in range(max(0, -shift), min(edges, before - shift)):
                if p.wrap_names[j] != p.wrap_before[j + shift]:
                    alike = 0
                    break
                alike += 1
            if alike > 0:
                return shift
        return MOST + 1

    @kernel
    def carry(p, edges, before, shift):
        """Give every piece what it had, from `wrap_was`: pieces at the ends that were one share it by their lengths,
        and those that became one hold it together.

        Checked  tests/net_capture/test_capstan.py
        """
        for j in range(edges + 1):
            held = 0.0
            for i in range(before + 1):
                if min(max(i - shift, 0), edges) == j:
                    held += p.wrap_was[i]
            own = min(max(j + shift, 0), before)
            if j + shift != own:
                held = p.wrap_was[own]
            together = 0.0
            for k in range(edges + 1):
                if min(max(k + shift, 0), before) == own:
                    together += p.wrap_pieces[k, 3]
            p.wrap_parts[j] = held * p.wrap_pieces[j, 3] / together

    @kernel
    def go_along(p, words, at, edges, before, shift):
        """As its bends move along their edges, the thread that is held there stays where it is along itself: by so much
        of it goes over from the piece behind a bend to that before it.

            du = (tau - tau') cos(a),   a the angle of the way to the edge

        Checked  tests/net_capture/test_capstan.py
        """
        for j in range(max(0, -shift), min(edges, before - shift)):
            moved = p.wrap_spans[j, TAU] - FINE * words[at + (PLACES + j + shift) * p.wrap_numbers]
            over = 0.5 * (along(p, j, j) + along(p, j + 1, j)) * moved
            over = min(max(over, -0.5 * p.wrap_parts[j]), 0.5 * p.wrap_parts[j + 1])
            p.wrap_parts[j] += over
            p.wrap_parts[j + 1] -= over
            p.wrap_drags[j] = FINE * words[at + (DRAGS + j + shift) * p.wrap_numbers]

    @kernel
    def take_up(p, words, at, edges, way, length, known):
        """Share the thread among the pieces as it was held; whether that is known.

        Checked  tests/net_capture/test_capstan.py
        """
        before = words[at + HELD * p.wrap_numbers] - 1
        shift = shift_of(p, edges, before) if known and before > 0 else MOST + 1
        if shift > MOST:
            share(p, edges, way, length)
            return False
        left = length
        for i in range(before):
            p.wrap_was[i] = FINE * words[at + (PARTS + i) * p.wrap_numbers]
            left -= p.wrap_was[i]
        p.wrap_was[before] = left
        carry(p, edges, before, shift)
        go_along(p, words, at, edges, before, shift)
        return True

    @kernel
    def stored(p, edges, axial):
        """Energy in all pieces [J], E A (l - u)2 / (2 u) in each; their pulls into `wrap_pulls` [N].

        axial     E A of the thread                              [N]

        Checked  tests/net_capture/test_capstan.py
        """
        energy = 0.0
        for j in range(edges + 1):
            stretch = max(0.0, p.wrap_pieces[j, 3] - p.wrap_parts[j])
            p.wrap_pulls[j] = axial * stretch / p.wrap_parts[j]
            energy += 0.5 * p.wrap_pulls[j] * stretch
        return energy

    @kernel
    def arc(p, j):
        """Angle by which the thread turns over edge number j, on a helix round it [rad]: 2 asin(|d - d'| / 2 s) s, d
        and d' the directions before and after, s the sine of their angle to the edge.

        Checked  tests/net_capture/test_capstan.py
        """
        across = 1.0 - along(p, j, j) * along(p, j, j)
        squared = 0.0
        for i in range(3):
            change = p.wrap_pieces[j + 1, i] - p.wrap_pieces[j, i]
            squared += change * change
        if squared >= 4.0 * across:
            return math.pi * math.sqrt(max(across, 0.0))
        return 2.0 * math.asin(math.sqrt(squared / (4.0 * across))) * math.sqrt(across)

    @kernel
    def pass_over(p, j, share_of_far):
        """Let length go over edge number j until the piece before it pulls so many times what that after does.

        Checked  tests/net_capture/test_capstan.py
        """
        near, far = p.wrap_pieces[j, 3], p.wrap_pieces[j + 1, 3]
        whole = p.wrap_parts[j] + p.wrap_parts[j + 1]
        middle = near + whole + share_of_far * (far - whole)
        held = 2.0 * near * whole / (middle + math.sqrt(middle * middle - 4.0 * (1.0 - share_of_far) * near * whole))
        p.wrap_parts[j] = held
        p.wrap_parts[j + 1] = whole - held

    @kernel
    def slide(p, edges):
        """Let the thread slide over every edge whose friction it overcomes.

        Checked  tests/net_capture/test_capstan.py
        """
        for j in range(edges):
            p.wrap_grips[j] = math.exp(p.wrap_friction * arc(p, j))
        for _ in range(SWEEPS):
            slid = False
            for j in range(edges):
                near = p.wrap_pieces[j, 3] / p.wrap_parts[j] - 1.0
                far = p.wrap_pieces[j + 1, 3] / p.wrap_parts[j + 1] - 1.0
                grip = p.wrap_grips[j]
                if near > grip * far + STRAIN:
                    pass_over(p, j, grip)
                    slid = True
                elif far > grip * near + STRAIN:
                    pass_over(p, j, 1.0 / grip)
                    slid = True
            if not slid:
                return

    @kernel
    def let_go(p, words, at):
        """Nothing is held any more: what was stored beyond a thread without friction is lost.

        Checked  tests/net_capture/test_capstan.py
        """
        p.wrap_friction_loss += FINE * words[at + EXCESS * p.wrap_numbers]
        words[at + EXCESS * p.wrap_numbers] = 0
        words[at + HELD * p.wrap_numbers] = 0

    @kernel
    def hold(p, words, at, edges, way, length, stiffness, known):
        """Let a taut thread slide over its edges, book what friction takes, and keep how it is shared; its pulls go
        into `wrap_pulls`.

        at                  where its state stands
        way, length         of the way, and unstretched                  [m]
        stiffness           of the whole thread                          [N/m]
        known               whether it was round these edges a substep ago, and has not slid over a corner since

        Checked  tests/net_capture/test_capstan.py
        """
        axial = stiffness * length
        for j in range(edges):
            p.wrap_drags[j] = 0.0
        if not take_up(p, words, at, edges, way, length, known):
            let_go(p, words, at)
        for j in range(edges + 1):
            p.wrap_was[j] = p.wrap_parts[j]
        slide(p, edges)
        now = stored(p, edges, axial)
        over = 0.0
        for j in range(edges):
            over += p.wrap_parts[j] - p.wrap_was[j]
            near, far = p.wrap_pulls[j], p.wrap_pulls[j + 1]
            p.wrap_slide += abs(over)
            p.wrap_friction_loss += 0.5 * (near - far + p.wrap_drags[j]) * (1.0 + 0.5 * (near + far) / axial) * over
        excess = now - 0.5 * stiffness * (way - length) * (way - length)
        words[at + EXCESS * p.wrap_numbers] = np.int64(excess / FINE)
        words[at + HELD * p.wrap_numbers] = edges + 1
        for j in range(edges):
            words[at + (PARTS + j) * p.wrap_numbers] = np.int64(p.wrap_parts[j] / FINE + 0.5)
            words[at + (PLACES + j) * p.wrap_numbers] = np.int64(p.wrap_spans[j, TAU] / FINE)
            words[at + (DRAGS + j) * p.wrap_numbers] = np.int64((p.wrap_pulls[j] - p.wrap_pulls[j + 1]) / FINE)

    @kernel
    def stretch(p, words, at, edges, way, length, stiffness):
        """Energy that a thread stores as it is held now [J]; its pulls go into `wrap_pulls`.

        Checked  tests/net_capture/test_capstan.py
        """
        take_up(p, words, at, edges, way, length, True)
        return stored(p, edges, stiffness * length)

    return Capstan(start, remember, hold, let_go, stretch)
