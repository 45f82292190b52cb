"""The target: a free rigid body. Its state is position, velocity, attitude and angular momentum in the frame's axes.

Between impulses the angular momentum about the centre of mass is constant (it only turns with the frame), and so it is
the state, not the rate; the attitude follows by a midpoint step with a Cayley map, which needs no trigonometry and so
gives the same bits on every platform.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, NamedTuple

from fmu_src.extremes import Extreme
from fmu_src.interface import Term, Variable, fault
from fmu_src.net_capture.hinge.motion import Hinge, make_hinge
from fmu_src.net_capture.refusal import Refusal, Scene, text
from fmu_src.rows import at_least_zero, moving, output, parameter, positive, state, vector
from orbital.kernel import kernel
from orbital.rotations import multiply, normalise, rotate, rotate_inverse, turn_attitude_back, turn_back
from orbital.vectors import dot

BEYOND_REACH = 0.55
"""Depth of the sample points below the faces, in meshes: with all knots outside, a mesh reaches 0.535 at a corner."""

NO_QUATERNION = fault(
    "no_quaternion", "target.start_attitude[1]", "target.start_attitude is not a quaternion of unit length (nor zero)"
)
NO_INERTIA = fault(
    "no_inertia",
    "target.principal_inertia[1]",
    "the principal inertias of the target break the triangle inequality",
)

ROWS = (
    positive("target.mass", "kg", "mass of the target", 1000.0),
    at_least_zero(
        "target.principal_inertia[#]",
        "kg.m2",
        "about the body axes; zero: of a uniform body of this shape",
        0.0,
        shape=(3,),
    ),
    parameter(
        "target.start_attitude[#]",
        "1",
        "quaternion from body to orbital frame, scalar first; zero: aligned. Of a union, from its design axes",
        0.0,
        shape=(4,),
    ),
    parameter(
        "target.start_rate[#]",
        "rad/s",
        "body rate in body axes, relative to inertial space; of a union, in its design axes",
        0.0,
        shape=(3,),
        display_unit="deg/s",
    ),
    *moving("target", "centre of mass, orbital frame", "of the centre of mass, orbital frame"),
    Variable("target.attitude[#]", "1", "output", "quaternion from body to orbital frame, scalar first", shape=(4,)),
    Variable(
        "target.rate[#]",
        "rad/s",
        "output",
        "body rate in body axes, relative to inertial space",
        shape=(3,),
        display_unit="deg/s",
    ),
    Variable("target.inertia[#]", "kg.m2", "output", "about the body axes", shape=(3,)),
    output("target.reach", "m", "farthest point of the target from its centre of mass", discrete=True),
    vector("target.spin", "N.m.s", "angular momentum about the target's centre of mass, orbital axes"),
    state("target_place[#]", "m", "centre of mass at the last substep", shape=(3,)),
    state("target_drift[#]", "m/s", "velocity of the centre of mass half a substep back", shape=(3,)),
    state("target_pose[#]", "1", "attitude at the last substep", shape=(4,)),
    state("target_middle[#]", "1", "attitude half way through a substep", shape=(4,)),
    state("target_turning[#]", "rad/s", "a body rate, for the step", shape=(3,)),
    state("half_size[#]", "m", "half the edges of the box around the target", shape=(3,)),
    state("shape_half[#]", "m", "of the box that holds the sample points", shape=(3,)),
    state("envelope_radius", "m", "of the sphere around the target"),
    state("target_edge", "m", "mean of the edges of the box that holds it, wherever its centre of mass lies in that"),
    state("girth", "m", "smallest girth"),
    state("target_thickness", "m", "least thickness: that of a part, or of the box around the target"),
    output("target.energy", "J", "kinetic energy of translation and spin of the target"),
)


EXTREMES = (
    *(
        Extreme(
            f"target of {mass:g} kg",
            "what it is hit by weighs more, or next to nothing",
            "energy_gained",
            {"target.mass": mass},
            needs=("contact",),
            chief=mass == 1.0,
        )
        for mass in (1.0, 1e5)
    ),
    Extreme(
        "spin of 60 deg/s",
        "corners of the target come at the net faster than the net flies",
        "depth",
        {"target.start_rate": (0.0, 0.0, math.radians(60.0))},
        needs=("contact",),
    ),
)


class Target(NamedTuple):
    """Kernels of a free target.

    shape                          those of its shape
    place(p) -> fault              put it into its start attitude and rate at the origin
    drift(p, frame_rate, h)        move and turn it by one substep with its momenta held
    measure(p)                     rate and energy from its momenta
    show(p, frame_rate, ahead)     attitude a time on [s]
    sample(p, out, number)         out = a sample point in the frame [m], below where any part of the net comes
    hinge                          kernels of the appendage that swings, see `hinge.motion`; None: it is one rigid body
    """

    shape: Any
    place: Any
    drift: Any
    measure: Any
    show: Any
    sample: Any
    hinge: Hinge | None = None


def refuses(scene: Scene) -> Iterator[Refusal]:
    """Inertia and attitude that no rigid body has."""
    inertia = scene.vector("target.principal_inertia")
    if any(inertia):
        largest, others = max(inertia), sum(inertia) - max(inertia)
        if min(inertia) <= 0.0 or largest > others * (1.0 + 1e-12):
            expected = (
                "none may be zero or exceed the sum of the other two "
                f"(leave it out for a uniform {scene.terms['target']})"
            )
            yield Refusal("target.principal_inertia", text(inertia, " kg m2"), expected)
    attitude = scene.vector("target.start_attitude", 4)
    squared = sum(part * part for part in attitude)
    if any(attitude) and not abs(squared - 1.0) <= 1e-6:
        expected = f"must be a quaternion of unit length, scalar first; its length is {math.sqrt(squared):.6g}"
        yield Refusal("target.start_attitude", text(attitude), expected)


def free_body(name: str, shape: Term) -> Term:
    """The term of a free target of a shape."""
    return replace(
        shape,
        summary=f"free {name} that takes the reaction of every contact",
        variables=(*shape.variables, *ROWS),
        faults=(NO_QUATERNION, NO_INERTIA, *shape.faults),
        make=lambda composition: make_target(composition, shape),
        refuses=lambda scene: [*refuses(scene), *(shape.refuses(scene) if shape.refuses else ())],
        extremes=(*shape.extremes, *EXTREMES),
    )


@kernel
def rate_from_spin(p, out, attitude):
    """out = body rate relative to inertial space, body axes [rad/s], from the angular momentum.

    Checked  tests/net_capture/test_contact.py
    """
    rotate_inverse(out, attitude, p.target_spin)
    for i in range(3):
        out[i] /= p.target_inertia[i]


@kernel
def turn(out, attitude, rate, h):
    """out = attitude after a time [s] at a body rate, in axes at rest.

        q' = q (1, h w / 2) / sqrt(1 + |h w|^2 / 4),   w = rate

    Valid    |h w| well below 1; the angle is short of h w by its (h w)^2 / 12
    Checked  tests/net_capture/test_contact.py
    """
    x = 0.5 * h * rate[0]
    y = 0.5 * h * rate[1]
    z = 0.5 * h * rate[2]
    a = attitude[0]
    b = attitude[1]
    c = attitude[2]
    d = attitude[3]
    out[0] = a - b * x - c * y - d * z
    out[1] = b + a * x + c * z - d * y
    out[2] = c + a * y + d * x - b * z
    out[3] = d + a * z + b * y - c * x
    normalise(out, out)


def make_turning(frame_turns: bool) -> tuple[Any, Any]:
    """Kernels that turn the target by a substep with its momenta held, and that tell its attitude a time on.

    frame_turns   whether the frame turns about its third axis

    The body turns in axes at rest, and these turn back as the frame turns: of second order in every frame.
    """

    @kernel
    def drift(p, frame_rate, h):
        """Move and turn the target by one substep with its momenta held.

        Checked  tests/net_capture/test_contact.py, tests/net_capture/test_gradient.py
        """
        for i in range(3):
            p.target_place[i] += h * p.target_drift[i]
        half = p.target_middle
        rate = p.target_turning
        rate_from_spin(p, rate, p.target_pose)
        turn(half, p.target_pose, rate, 0.5 * h)
        rate_from_spin(p, rate, half)
        turn(p.target_pose, p.target_pose, rate, h)
        if frame_turns:
            turn_attitude_back(p.target_pose, frame_rate * h)
            turn_back(p.target_spin, frame_rate * h)

    @kernel
    def show(p, frame_rate, ahead):
        """Attitude a time on [s].

        Checked  tests/net_capture/test_contact.py
        """
        turn(p.target_attitude, p.target_pose, p.target_rate, ahead)
        if frame_turns:
            turn_attitude_back(p.target_attitude, frame_rate * ahead)

    return drift, show


@kernel
def measure_target(p):
    """Rate and energy of the target from its momenta.

    Checked  tests/net_capture/test_contact.py
    """
    rate_from_spin(p, p.target_rate, p.target_pose)
    energy = 0.5 * p.target_mass * dot(p.target_velocity, p.target_velocity)
    for i in range(3):
        energy += 0.5 * p.target_inertia[i] * p.target_rate[i] * p.target_rate[i]
    p.target_energy = energy


def make_target(composition: Any, part: Term) -> Target:
    """Kernels of a free target of the shape that a part makes."""
    assert part.make is not None
    shape = part.make(composition)
    uniform_inertia, measure_shape, shape_sample = shape.inertia, shape.measure, shape.sample
    given_otherwise, axes = shape.axes is not None, shape.axes
    swings = "hinge" in composition.terms
    hinge = make_hinge(composition, shape.swings, shape.close_round) if swings else None
    place_hinge, drift_hinge, measure_hinge, extent, follow = (
        (hinge.place, hinge.drift, hinge.measure, hinge.extent, hinge.follow) if hinge is not None else [None] * 5
    )
    no_inertia, no_quaternion = composition.code(NO_INERTIA.name), composition.code(NO_QUATERNION.name)

    @kernel
    def place(p):
        """Put the target into its start attitude and rate at the origin; a fault code or 0.

        Checked  tests/net_capture/test_contact.py
        """
        principal = p.target_inertia
        total = 0.0
        for i in range(3):
            total += abs(p.target_principal_inertia[i])
        uniform_inertia(p, principal)
        if total > 0.0:
            for i in range(3):
                principal[i] = p.target_principal_inertia[i]
        for i in range(3):
            if principal[i] <= 0.0 or principal[i] > (principal[(i + 1) % 3] + principal[(i + 2) % 3]) * (1.0 + 1e-12):
                p.fault_value = p.target_principal_inertia[0]
                return no_inertia
        squared = 0.0
        for i in range(4):
            p.target_pose[i] = p.target_start_attitude[i]
            squared += p.target_start_attitude[i] * p.target_start_attitude[i]
        if squared == 0.0:
            p.target_pose[0] = 1.0
        elif abs(squared - 1.0) > 1e-6:
            p.fault_value = p.target_start_attitude[0]
            return no_quaternion
        normalise(p.target_pose, p.target_pose)
        if given_otherwise:
            axes(p, p.target_middle)
            multiply(p.target_pose, p.target_pose, p.target_middle)
        spin = p.target_turning
        for i in range(3):
            p.target_place[i] = 0.0
            p.target_drift[i] = 0.0
            p.target_rate[i] = p.target_start_rate[i]
        if given_otherwise:
            rotate_inverse(p.target_rate, p.target_middle, p.target_rate)
        for i in range(3):
            spin[i] = principal[i] * p.target_rate[i]
        rotate(p.target_spin, p.target_pose, spin)
        if swings:
            fault = place_hinge(p)
            if fault != 0:
                return fault
        p.target_thickness = math.inf
        p.target_edge = 0.0
        measure_shape(p)
        if swings:
            extent(p)
        for i in range(3):
            p.target_thickness = min(p.target_thickness, 2.0 * p.half_size[i])
        if p.target_edge == 0.0:
            p.target_edge = 2.0 * (p.half_size[0] + p.half_size[1] + p.half_size[2]) / 3.0
        p.target_reach = p.envelope_radius
        return 0

    @kernel
    def sample(p, out, number):
        """out = sample point of the target in the frame [m], so far below its surface that no part of the net comes
        there.

        Valid    a target thicker than 1.1 meshes; of a thinner one the points come together in its middle
        Checked  tests/net_capture/test_enclosure.py
        """
        shape_sample(p, out, number, BEYOND_REACH * p.net_mesh)
        if swings:
            follow(p, out, number)
        rotate(out, p.target_pose, out)
        for i in range(3):
            out[i] += p.target_place[i]

    @kernel
    def drift_both(p, frame_rate, h):
        """Move the target by one substep, turn it and let its appendage swing.

        Checked  tests/net_capture/test_hinge.py
        """
        for i in range(3):
            p.target_place[i] += h * p.target_drift[i]
        drift_hinge(p, frame_rate, h)

    drift, show = make_turning(composition.gravity.turns)
    if hinge is not None:
        return Target(shape, place, drift_both, measure_hinge, show, sample, hinge)
    return Target(shape, place, drift, measure_target, show, sample)
