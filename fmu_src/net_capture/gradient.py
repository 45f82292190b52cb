"""The gravity gradient's torque on the target, where a scene names it.

    tau = 3 mu/r^3 u x I u,   V = (3/2) mu/r^3 (u.I u - tr I/3)

about the target's centre of mass, u the way from the Earth to it and I its whole inertia, both in body axes. Those are
principal axes of every rigid target; of one with a hinge I is that at the angle of now, and the hinge is given -dV/dq
(`hinge.matrix.find_lean`). On the circular orbit whose frame is Hill's, mu/r^3 is the square of the frame's rate and u
is its first axis, at rest there. Where the target is off the orbit by some metres, both differ by as much over r,
which Hill's equations leave out too.

The spin is kicked for half a substep before and after the target has turned:

    S <- S + h/2 tau(q),   (q, S) turn freely by h,   S <- S + h/2 tau(q)

and the momentum of a hinge likewise. So momenta and angles are always of one instant, and what contact does between
them stays as it is. The whole is of second order, as the free turning is.

Valid    bodies much smaller than r; circular orbit
Source   Hughes, Spacecraft Attitude Dynamics (1986), section 8.1; the splitting is Stormer's and Verlet's
Checked  tests/net_capture/test_gradient.py, tests/net_capture/test_hinged_gradient.py
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

from fmu_src.extremes import Extreme
from fmu_src.interface import Term
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.rows import output, state, vector
from orbital.kernel import kernel
from orbital.rigid import gradient_torque
from orbital.rotations import rotate, rotate_inverse, turn_back

ORBITS = ("hill",)
"""Gravities of an orbit round the Earth."""


class Gradient(NamedTuple):
    """Kernels of the torque.

    start(p)                    nothing given yet; the target is in place
    kick(p, h)                  give the target what the torque gives in a time [s]
    carry(p, frame_rate, h)     what was given turns back with the frame, as the target's spin does
    measure(p)                  torque and energy now
    """

    start: Any
    kick: Any
    carry: Any
    measure: Any


def make(composition: Any) -> Gradient:
    """Kernels for the composition's gravity."""
    strength = composition.gravity.gradient
    if strength is None:
        raise ValueError(f"net_capture: a gravity gradient needs gravity = {' or '.join(map(repr, ORBITS))}")
    hinge = composition.target.hinge
    swings, lean = hinge is not None, hinge.lean if hinge is not None else None

    @kernel
    def start(p):
        """Nothing given yet; the inertia as a matrix, about the principal axes of a rigid body.

        Checked  tests/net_capture/test_gradient.py
        """
        for i in range(3):
            p.gravity_gradient_angular_impulse[i] = 0.0
            for j in range(3):
                p.gradient_inertia[i, j] = p.target_inertia[i] if i == j else 0.0

    @kernel
    def upward(p, out):
        """out = way from the Earth, the frame's first axis, in body axes [-].

        Checked  tests/net_capture/test_gradient.py
        """
        out[0] = 1.0
        out[1] = 0.0
        out[2] = 0.0
        rotate_inverse(out, p.target_pose, out)

    @kernel
    def find_torque(p, out):
        """out = torque on the target at its attitude, and angle of its hinge, of now, orbital axes [N m].

            tau = R (3 mu/r^3 u x I u)

        Checked  tests/net_capture/test_gradient.py
        """
        upward(p, p.gradient_up)
        if swings:
            for i in range(3):
                for j in range(3):
                    p.gradient_inertia[i, j] = p.hinge_whole[i, j]
        gradient_torque(out, p.gradient_inertia, p.gradient_up, strength(p))
        rotate(out, p.target_pose, out)

    @kernel
    def kick(p, h):
        """Give the target what the torque of now gives in a time [s].

        Checked  tests/net_capture/test_gradient.py
        """
        torque = p.gradient_torque
        find_torque(p, torque)
        for i in range(3):
            p.target_spin[i] += h * torque[i]
            p.gravity_gradient_angular_impulse[i] += h * torque[i]
        if swings:
            lean(p, p.gradient_up, h * strength(p))

    @kernel
    def carry(p, frame_rate, h):
        """What was given stays in inertial space, so it turns back with the frame.

        Checked  tests/net_capture/test_gradient.py
        """
        turn_back(p.gravity_gradient_angular_impulse, frame_rate * h)

    @kernel
    def measure(p):
        """Torque [N m] and energy [J] at the attitude of now.

            V = (3/2) mu/r^3 (u.I u - tr I/3)

        Checked  tests/net_capture/test_gradient.py
        """
        find_torque(p, p.gravity_gradient_torque)
        inertia, up = p.gradient_inertia, p.gradient_up
        total = 0.0
        for i in range(3):
            total -= inertia[i, i] / 3.0
            for j in range(3):
                total += up[i] * inertia[i, j] * up[j]
        p.gravity_gradient_energy = 0.5 * strength(p) * total

    return Gradient(start, kick, carry, measure)


def refuses(scene: Scene) -> Iterator[Refusal]:
    """A gravity without an orbit."""
    found = scene.terms["gravity"]
    if found not in ORBITS:
        wanted = " or ".join(f'"{law}"' for law in ORBITS)
        expected = f"must be {wanted} with [capture.gravity_gradient]: that torque needs an orbit"
        yield Refusal("gravity.law", f'"{found}"', expected)


PART = Term(
    "the gravity gradient turns the target",
    (
        vector("gravity_gradient.torque", "N.m", "of the gravity gradient on the target, orbital axes"),
        output(
            "gravity_gradient.energy",
            "J",
            "of the target's attitude in the gravity gradient, none on the mean over all; part of energy.potential",
        ),
        vector(
            "gravity_gradient.angular_impulse",
            "N.m.s",
            "what the gravity gradient has given the target of angular momentum so far, orbital axes of now",
        ),
        state("gradient_torque[#]", "N.m", "in the substep, orbital axes", shape=(3,)),
        state("gradient_up[#]", "1", "way from the Earth, body axes", shape=(3,)),
        state("gradient_inertia[#][#]", "kg.m2", "about body axes", shape=(3, 3)),
    ),
    needs=("target",),
    make=make,
    refuses=refuses,
    extremes=(
        Extreme(
            "slender target in the lowest orbit",
            "the gravity gradient's torque and what it gives are at their largest",
            "energy_gained",
            {
                "orbit.altitude": 100e3,
                "target.principal_inertia": (1e3, 1e5, 1e5),
                "target.start_attitude": (math.cos(math.pi / 8), 0.0, 0.0, math.sin(math.pi / 8)),
            },
        ),
    ),
)
