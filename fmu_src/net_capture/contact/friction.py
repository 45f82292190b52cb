"""Coulomb friction with a true stick: a spring along the surface that gives way where it is asked for too much."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from fmu_src.net_capture.contact.pushing import make_push
from orbital.kernel import kernel
from orbital.vectors import dot

FRICTION = 0.1
"""Of Kevlar 49 on aluminium: a shear stress of 0.099 p^0.91 at a pressure p. Source: Brown and Burgoyne, Wear 236,
1999."""
CARRIED, SINCE, PLANES = 0, 3, 4
"""Node planes behind those of scheme and pace: how far a node has been carried along the surface from where it holds
on, axes of the body touched [m], and the substep after the one in which it last touched."""
ALONG = 0.82
"""Stiffness along the surface over that across it, 2 (1 - nu) / (2 - nu) at nu = 0.3. Source: Mindlin, J. Appl. Mech.
16, 1949."""


class Friction(NamedTuple):
    """Kernels of friction.

    rub(p, work, node, inverse, since, held, stiffness, dashpot, most) -> impulse   for a substep
    stored(p, work, node, stiffness)     energy in the spring along the surface [J]
    """

    rub: Any
    stored: Any


def make_friction(composition: Any) -> Friction:
    """Kernels for the composition's memory."""
    node_plane, first_plane = composition.memory.node_plane, composition.contact_planes
    relative, aim, push = make_push(composition)
    hinge = composition.target.hinge
    swings = hinge is not None
    along_own, along_body = (hinge.along_own, hinge.along_body) if hinge is not None else [None] * 2

    @kernel
    def stored(p, work, node, stiffness):
        """Energy in the spring along the surface [J]: c_t x^2 / 2.

        Checked  tests/net_capture/test_penalty.py
        """
        squared = 0.0
        for i in range(3):
            carried = node_plane(p, work, first_plane + CARRIED + i)[node]
            squared += carried * carried
        return 0.5 * ALONG * stiffness * squared

    @kernel
    def rub(p, work, node, inverse, since, held, stiffness, dashpot, most):
        """Friction of a node for a substep; its impulse [N s].

            x' = x + t w,   F = -(c_t x' + b_t w),   and mu F_n along it where that is less; then the spring gives way

            c_t x' + b_t (x' - x)/t = -F,   x' = (b_t x - t F)/(c_t t + b_t)

        no faster than its dashpot lets it: at once it would hold energy that nobody has put in.

        since         t      on the surface in this substep                    [s]
        held          whether it was there a substep ago, and holds on
        stiffness     c      across the surface, c_t = ALONG c                 [N/m]
        dashpot       b      across the surface, b_t = ALONG b                 [N s/m]
        most          mu F_n                                                   [N]

        The dashpot sees the velocity w half way through the kick, with the kick's own share. What is not in the spring
        afterwards has been taken, by the dashpot or by sliding.

        Checked  tests/net_capture/test_penalty.py
        """
        normal, slip, along, carried = p.contact_normal, p.contact_slip, p.contact_along, p.contact_carried
        rested = p.contact_rested
        turn, h = p.target_turn, p.solver_substep
        spring = ALONG * stiffness
        rate = ALONG * dashpot
        before = stored(p, work, node, stiffness) if held else 0.0
        # where it holds on, frame axes; the surface may have turned under it
        for k in range(3):
            rested[k] = node_plane(p, work, first_plane + CARRIED + k)[node]
        if swings:
            along_body(p, rested)
        for i in range(3):
            carried[i] = 0.0
            if held:
                for k in range(3):
                    carried[i] += turn[i, k] * rested[k]
        relative(p, work, node, 2.0, slip)
        lifted, out = dot(carried, normal), dot(carried, normal) + since * dot(slip, normal)
        for i in range(3):
            rested[i] = carried[i] - lifted * normal[i]
            carried[i] += since * slip[i] - out * normal[i]
        relative(p, work, node, 1.0, slip)
        out = dot(slip, normal)
        for i in range(3):
            slip[i] -= out * normal[i]
            along[i] = -spring * carried[i] - rate * slip[i]
        trial = math.sqrt(dot(along, along))
        size = 0.0
        if trial > 0.0:
            for i in range(3):
                along[i] /= trial
            feel = aim(p, inverse, along)
            size = trial / (1.0 + 0.5 * h * rate * feel)
            slides = size > most
            size = min(size, most)
            middle = dot(slip, along) + 0.5 * h * size * feel
            if slides:
                for i in range(3):
                    carried[i] = (rate * rested[i] - since * size * along[i]) / (spring * since + rate)
                taken = before - 0.5 * spring * dot(carried, carried)
            else:
                taken = -h * spring * (dot(carried, slip) + 0.5 * h * size * feel * dot(carried, along))
            taken -= h * size * middle
            push(p, work, node, h, inverse, along, h * size)
            p.contact_loss += taken
            p.contact_friction_loss += taken
        for i in range(3):
            rested[i] = turn[0, i] * carried[0] + turn[1, i] * carried[1] + turn[2, i] * carried[2]
        if swings:
            along_own(p, rested)
        for i in range(3):
            node_plane(p, work, first_plane + CARRIED + i)[node] = rested[i]
        return h * size

    return Friction(rub, stored)
