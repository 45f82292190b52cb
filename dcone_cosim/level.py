"""Which level of the removal's target carries what a capture leaves: a point, or a body that turns.

A point has its attachment on the line of centres, at a fixed distance a, and turns with the line. The attachment of a
body that turns relative to the line at w leaves it by an angle of at most

    theta = theta_0 + (w + (3/4 + 3/2 |c| sqrt(1 - c^2)) n^2 t + n v t/s_0) t

until the first tug at t: the gravity gradient turns the body, the tide the line, whose direction cosine to the vertical
is c, and the Coriolis force a line of s_0 that grows at v. With it come, relative to what a point does,

    time of the tug    a (1 - cos theta)/s                                   s the slack
    peak of the tug    w a sin(theta)/v + m_r (a sin theta)^2/(2 I)          v the speed of the tug, I the least moment
                       + (F/m_c) a (1 - cos theta)/v^2                       F the thrust

Where theta passes a right angle the line would wrap, and the bounds are infinite.

Valid    as bounds to first order of what they bound; gravity between hand-over and tug is left out of t and v
Checked  tests/cosim/test_level.py
"""

from __future__ import annotations

import math
from collections.abc import Container, Mapping
from dataclasses import dataclass, replace

import numpy as np

from dcone_cosim import build
from dcone_cosim.appendage import hinged
from dcone_cosim.errors import HandoffError
from dcone_cosim.handoff import Handoff, HeldTurning, Vector, rotation_matrix
from dcone_cosim.line import Line
from dcone_cosim.scene.data import ComponentScene, PhaseScene

GROUP, POINT, RIGID = "target", "point", "rigid"
EACH = (1, 2, 3)
INERTIA = tuple(f"target.inertia[{i}]" for i in range(1, 7))
ATTITUDE = tuple(f"target.start_attitude[{i}]" for i in range(1, 5))
RATE = tuple(f"target.start_rate[{i}]" for i in EACH)
PLACE = tuple(f"target.attachment[{i}]" for i in EACH)
RATE_FRAME = "target.rate_frame"
TURNING_SETS = (*INERTIA, *ATTITUDE, *RATE, *PLACE, RATE_FRAME)
"""Parameters of a removal whose target turns that the hand-off writes and reads back."""
CENTER = tuple(f"target.center[{i}]" for i in EACH)
SHAPE = {
    **{f"target.size[{i}]": f"target.size[{i}]" for i in EACH},
    "target.radius": "target.cylinder_radius",
    "target.length": "target.cylinder_length",
}
"""Parameters of a capture's target that say what surface it has, and those of a removal's that say the same."""


@dataclass(frozen=True)
class PointBound:
    """By how much a point at most errs, relative to a body that turns.

    rate         w      of the joint body relative to the line                           [rad/s]
    angle        theta  of the attachment from the line, until the first tug             [rad]
    tug_time            estimate of the first tug, since the hand-over                   [s]
    tug_speed           estimate of the speed at which the line then comes taut          [m/s]
    time, peak          the bounds, relative                                             [1]
    tolerance           that either may reach                                            [1]
    """

    rate: float = 0.0
    angle: float = 0.0
    tug_time: float = 0.0
    tug_speed: float = 0.0
    time: float = 0.0
    peak: float = 0.0
    tolerance: float = 0.0

    @property
    def accepted(self) -> bool:
        return max(self.time, self.peak) <= self.tolerance

    @property
    def largest(self) -> float:
        return max(self.time, self.peak)


def body_rate(handed: Handoff) -> Vector:
    """Rate of the joint body relative to inertial space, orbital axes [rad/s]; zero without inertia."""
    joint = handed.joint
    return np.asarray(np.linalg.solve(joint.inertia, joint.spin)) if joint.inertia.any() else np.zeros(3)


def point_bound(handed: Handoff, line: Line, slack: float, thrust: float, tolerance: float) -> PointBound:
    """The bounds of the module for what is handed over.

    slack         s of the line, between its attachments          [m]
    thrust        F of the chaser                                 [N]
    """
    joint, chaser = handed.joint, handed.chaser
    apart = joint.position - chaser.position
    parting = joint.velocity - chaser.velocity + np.cross(handed.turning, apart)
    distance = float(np.linalg.norm(apart))
    of_line = np.cross(apart, parting) / distance**2
    rate = float(np.linalg.norm(body_rate(handed) - of_line))
    along = float(parting @ apart) / distance
    push, room = abs(thrust) / chaser.mass, max(0.0, slack)
    speed = math.sqrt(max(0.0, along) ** 2 + 2.0 * push * room)
    time = math.inf
    if room == 0.0:
        time = 0.0
    elif along > 0.0 or push > 0.0:
        time = 2.0 * room / (max(0.0, along) + speed)
    arm = handed.vertex - joint.position
    reach, least = float(np.linalg.norm(arm)), float(np.linalg.eigvalsh(joint.inertia)[0])
    if reach == 0.0:
        return PointBound(rate, 0.0, time, speed, 0.0, 0.0, tolerance)
    off = math.acos(min(1.0, max(-1.0, float(arm @ -apart) / (reach * distance))))
    turned = 0.0 if time == 0.0 else math.inf
    if 0.0 < time < math.inf:
        n, upright = float(np.linalg.norm(handed.turning)), abs(float(apart[0])) / distance
        tide = 0.75 + 1.5 * upright * math.sqrt(1.0 - upright * upright)
        turned = (rate + tide * n * n * time + n * abs(along) * time / distance) * time
    angle = min(math.pi, off + turned)
    if angle >= 0.5 * math.pi or speed == 0.0:
        return PointBound(rate, angle, time, speed, math.inf, math.inf, tolerance)
    sideways, longer = reach * math.sin(angle), reach * (1.0 - math.cos(angle))
    reduced = chaser.mass * joint.mass / (chaser.mass + joint.mass)
    lighter = 0.5 * reduced * sideways**2 / least if least > 0.0 else 0.0
    peak = rate * sideways / speed + lighter + push * longer / speed**2
    return PointBound(rate, angle, time, speed, longer / room if room > 0.0 else math.inf, peak, tolerance)


def carries_spin(offered: Container[str]) -> bool:
    """Whether a removal with these parameters has a target that turns."""
    return all(name in offered for name in TURNING_SETS)


def needed(phase: PhaseScene, surface: str) -> PhaseScene | None:
    """The phase with a target that turns, with the surface of the capture's where there is one like it; None where the
    scene says what its target is, or its FMU is a file; `HandoffError` where another part of it carries points alone.
    """
    main = phase.main
    if main.fmu is not None or GROUP not in main.unnamed:
        return None
    turning = with_term(main, GROUP, carrying(main, surface))
    why = refused_by(main, turning)
    if why:
        raise HandoffError(
            f"hand-off refused: what is handed over turns, and the {phase.name} cannot carry it\n  {why}"
        )
    return replace(phase, main=turning)


def refused_by(main: ComponentScene, turning: ComponentScene) -> str:
    """What a part of it does not go together with once its target turns; "" where all do."""
    before, after = (
        build.cannot_work(main.model, {**one.defaults, **main.values}, math.inf, one.terms, True)
        for one in (main, turning)
    )
    known = {(one.variable, one.expected) for one in before}
    told = [one for one in after if (one.variable, one.expected) not in known]
    return "; ".join(f"{one.variable} = {one.given}: {one.expected}" for one in told)


def carrier(phase: PhaseScene, surface: str) -> str:
    """What would carry what a point cannot, where the scene or its FMU leaves a point alone."""
    if phase.main.model not in build.CATALOGUE:
        return f"a removal FMU with {INERTIA[0]}, {ATTITUDE[0]}, {RATE[0]} and what else a target that turns has"
    return f'[{phase.name}.target] body = "{carrying(phase.main, surface)}", or none,'


def carrying(main: ComponentScene, surface: str) -> str:
    """The target that turns, with the surface of the capture's where there is one like it."""
    return surface if surface in build.CATALOGUE[main.model].groups[GROUP].terms else RIGID


def with_term(main: ComponentScene, group: str, term: str) -> ComponentScene:
    """A model of ours with another term, and what it then has to be set."""
    terms = {**main.terms, group: term}
    interface = build.CATALOGUE[main.model].interface(terms)
    choices = {row.name: row.choices for row in interface.variables if row.choices and row.causality == "parameter"}
    return replace(main, terms=terms, defaults=build.defaults(interface), choices=choices)


def turning_parameters(
    handed: Handoff, shape: Mapping[str, float], offered: Container[str], inertial: float
) -> dict[str, float]:
    """What to set in a removal whose target turns: inertia, attitude, rate, attachment and surface, in the axes of the
    capture's target.

    shape        parameters of the capture's target, of `SHAPE`, or the corners that a removal's hull has
    offered      parameters that the removal has
    inertial     value of the choice of `RATE_FRAME` by which rates are relative to inertial space
    """
    turned = rotation_matrix(handed.attitude)
    joint = handed.joint
    inertia = turned.T @ joint.inertia @ turned
    places = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    found = {name: float(inertia[place]) for name, place in zip(INERTIA, places, strict=True)}
    vectors = (
        (ATTITUDE, handed.attitude),
        (RATE, turned.T @ body_rate(handed)),
        (PLACE, turned.T @ (handed.vertex - joint.position)),
        (CENTER, turned.T @ (handed.target.position - joint.position)),
    )
    for names, vector in vectors:
        found |= {name: float(x) for name, x in zip(names, vector, strict=True)}
    found |= {RATE_FRAME: inertial} | {SHAPE.get(name, name): value for name, value in shape.items()}
    return {name: value for name, value in found.items() if name in offered}


def held_turning(removal: Mapping[str, float]) -> HeldTurning | None:
    """None for a point. The spin of one with an appendage is that with the appendage held fast."""
    if not carries_spin(removal):
        return None
    turned = rotation_matrix(np.array([removal[name] for name in ATTITUDE]))
    i11, i22, i33, i12, i13, i23 = (removal[name] for name in INERTIA)
    inertia = np.array([[i11, i12, i13], [i12, i22, i23], [i13, i23, i33]])
    spin = inertia @ np.array([removal[name] for name in RATE])
    moving = hinged(removal)
    if moving is not None:
        spin += moving.momentum
    attachment = np.array([removal[name] for name in PLACE])
    return HeldTurning(turned @ spin, turned @ inertia @ turned.T, turned @ attachment)
