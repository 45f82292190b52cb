"""The hand-off: what the capture leaves behind becomes what the removal begins with, and a ledger proves it.

Net, bullets and vertex join the target inelastically: their masses, momenta, spins and inertias add. A removal whose
target turns takes all of it over; one of two point masses drops the spin of the joined body, which is booked as dropped
with its size: it is the level where `level` bounds by how little that changes the first tug. A removal that can only be
of points is refused where that bound is passed.

Frames. Positions and velocities are given in the orbital frame of the target's initial centre of mass, velocities as
seen in that turning frame; spins are relative to inertial space, along the orbital axes.
"""

from __future__ import annotations

import math
from collections.abc import Container, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from dcone_cosim.appendage import ANGLE, PRODUCTS, Hinged, asked, hinged
from dcone_cosim.errors import HandoffError
from dcone_cosim.scene.data import PhaseScene
from orbital import plain
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU

Vector = npt.NDArray[np.float64]
Values = Mapping[str, float]

CAPTURE_OUTPUTS = (
    *(f"chaser.{what}[{i}]" for what in ("position", "velocity") for i in (1, 2, 3)),
    *(f"target.{what}[{i}]" for what in ("position", "velocity", "rate", "inertia", "spin") for i in (1, 2, 3)),
    *(f"target.attitude[{i}]" for i in (1, 2, 3, 4)),
    *(f"vertex.position[{i}]" for i in (1, 2, 3)),
    "target.reach",
    "catch.mass",
    *(f"catch.{what}[{i}]" for what in ("position", "velocity", "spin") for i in (1, 2, 3)),
    *(f"catch.inertia[{i}]" for i in range(1, 7)),
    "energy.kinetic",
)
"""Outputs of the capture FMU that the hand-off reads."""

CAPTURE_PARAMETERS = (
    "chaser.mass",
    "target.mass",
    *(f"chaser.start_velocity[{i}]" for i in (1, 2, 3)),
)

_CARRIED = ("center_position", "center_velocity", "relative_position", "relative_velocity")
REMOVAL_SETS = ("chaser.mass", "target.mass", *(f"start.{what}[{i}]" for what in _CARRIED for i in (1, 2, 3)))
"""Real parameters of the removal FMU that the hand-off writes and reads back, beside `start.condition` and anomaly."""


@dataclass(frozen=True)
class Body:
    """A body in the orbital frame.

    mass [kg], position (3,) [m], velocity (3,) as seen in the turning frame [m/s], spin (3,) about its own centre of
    mass relative to inertial space [N m s], inertia (3, 3) about its centre of mass [kg m2], along the orbital axes
    """

    mass: float
    position: Vector
    velocity: Vector
    spin: Vector = field(default_factory=lambda: np.zeros(3))
    inertia: Vector = field(default_factory=lambda: np.zeros((3, 3)))

    def inertial_velocity(self, turning: Vector) -> Vector:
        """u = v + w x r [m/s], along the orbital axes."""
        return self.velocity + np.cross(turning, self.position)


@dataclass(frozen=True)
class Handoff:
    """What is handed over: the bodies before, the joined body, where the line is made fast on it [m] (3,), how far the
    target reaches from its centre of mass [m], the removal's parameters, the target's attitude, a unit quaternion
    from body to orbital axes (4,), and the mass of a line that the chaser has no more in it [kg].

    appendage    that swings in the capture: parameters of a removal's, from the target's own centre of mass; else
                 empty. The joined body's spin is then without the appendage's motion, which is to be held fast
    swing        that motion, about the target's centre of mass, orbital axes
    """

    chaser: Body
    target: Body
    catch: Body
    catch_energy: float
    joint: Body
    vertex: Vector
    reach: float
    turning: Vector
    parameters: dict[str, float]
    attitude: Vector
    drawn: float = 0.0
    appendage: Mapping[str, float] = field(default_factory=dict)
    swing: Hinged | None = None

    @property
    def turning_energy(self) -> float:
        """Kinetic energy of the target about its centre of mass before, that of its appendage in it [J]."""
        if self.swing is None:
            return spin_energy(self.target)
        rigid = replace(self.target, spin=self.target.spin - self.swing.momentum)
        return spin_energy(rigid) + self.swing.energy(rigid.spin, rigid.inertia)


@dataclass(frozen=True)
class HeldTurning:
    """A target that turns as the removal's parameters say when read back, along orbital axes.

    spin [N m s] (3,), inertia [kg m2] (3, 3), attachment from the centre of mass [m] (3,)
    """

    spin: Vector
    inertia: Vector
    attachment: Vector


def mean_motion(altitude: float) -> float:
    """Rate at which the orbital frame turns on a circular orbit [rad/s].

    altitude      over the equatorial radius                     [m]
    """
    return plain.mean_motion(EARTH_EQUATORIAL_RADIUS + altitude, EARTH_MU)


def frame_rate(phase: PhaseScene) -> float:
    """Rate at which the orbital axes of a capture turn [rad/s]: not at all where its gravity lets them stand still."""
    altitude = phase.setting("orbit.altitude")
    if altitude is None or phase.main.terms.get("gravity", "hill") != "hill":
        return 0.0
    return mean_motion(altitude)


def _vector(values: Values, name: str) -> Vector:
    return np.array([values[f"{name}[{i}]"] for i in (1, 2, 3)])


def rotation_matrix(attitude: Vector) -> Vector:
    """(3, 3) from body to orbital axes, of a unit quaternion, scalar first."""
    matrix = np.empty((3, 3))
    plain.to_matrix(matrix, attitude)
    return matrix


def join(first: Body, second: Body, turning: Vector) -> Body:
    """The two as one rigid body after a perfectly inelastic joining.

        m = m1 + m2,  r = (m1 r1 + m2 r2)/m,  H = H1 + H2 + mu d x d',  I = I1 + I2 + mu (d.d 1 - d d^T)

    with mu = m1 m2/m and d = r2 - r1, d' its inertial rate.
    """
    mass = first.mass + second.mass
    reduced = first.mass * second.mass / mass
    d = second.position - first.position
    rate = second.velocity - first.velocity + np.cross(turning, d)
    return Body(
        mass,
        (first.mass * first.position + second.mass * second.position) / mass,
        (first.mass * first.velocity + second.mass * second.velocity) / mass,
        first.spin + second.spin + reduced * np.cross(d, rate),
        first.inertia + second.inertia + reduced * (np.dot(d, d) * np.eye(3) - np.outer(d, d)),
    )


def pair_parameters(chaser: Body, target: Body) -> dict[str, float]:
    """Masses, centre of mass and relative state of two points, under the removal's names."""
    mass = chaser.mass + target.mass
    vectors = {
        "center_position": (chaser.mass * chaser.position + target.mass * target.position) / mass,
        "center_velocity": (chaser.mass * chaser.velocity + target.mass * target.velocity) / mass,
        "relative_position": target.position - chaser.position,
        "relative_velocity": target.velocity - chaser.velocity,
    }
    parameters = {"chaser.mass": chaser.mass, "target.mass": target.mass}
    for name, vector in vectors.items():
        parameters |= {f"start.{name}[{i + 1}]": float(vector[i]) for i in range(3)}
    return parameters


def require_rigid(names: Container[str], why: str = "what is handed over is one rigid target") -> None:
    """`HandoffError` where a capture, perhaps an FMU in a file, tells by its outputs that its target swings."""
    if ANGLE in names:
        raise HandoffError(f"hand-off refused: the capture's target has an appendage that swings ({ANGLE}); {why}")


def prepare(capture: Values, frame_rate: float, appendage: Mapping[str, float] = MappingProxyType({})) -> Handoff:
    """Map the capture's outputs and parameters to the removal's parameters.

    capture       `CAPTURE_OUTPUTS` and `CAPTURE_PARAMETERS` by name, SI
    frame_rate    n, at which the orbital frame turns [rad/s]
    appendage     that swings there, as it is now: a removal's parameters, from the target's centre of mass
    """
    turning = np.array([0.0, 0.0, frame_rate])
    chaser = Body(capture["chaser.mass"], _vector(capture, "chaser.position"), _vector(capture, "chaser.velocity"))
    attitude = np.array([capture[f"target.attitude[{i}]"] for i in range(1, 5)])
    turn = rotation_matrix(attitude)
    whole = np.diag(_vector(capture, "target.inertia"))
    for (i, j), name in zip(((0, 1), (0, 2), (1, 2)), PRODUCTS if appendage else (), strict=False):
        whole[i, j] = whole[j, i] = capture[name]
    target = Body(
        capture["target.mass"],
        _vector(capture, "target.position"),
        _vector(capture, "target.velocity"),
        _vector(capture, "target.spin"),
        turn @ whole @ turn.T,
    )
    i11, i22, i33, i12, i13, i23 = (capture[f"catch.inertia[{i}]"] for i in range(1, 7))
    inertia = np.array([[i11, i12, i13], [i12, i22, i23], [i13, i23, i33]])
    seen_spin = _vector(capture, "catch.spin")
    catch = Body(
        capture["catch.mass"],
        _vector(capture, "catch.position"),
        _vector(capture, "catch.velocity"),
        seen_spin + inertia @ turning,
        inertia,
    )
    # Kinetic energy of the catch about its own centre of mass, from that in the turning frame.
    inner = capture["energy.kinetic"] - 0.5 * catch.mass * float(catch.velocity @ catch.velocity)
    inner += float(turning @ seen_spin) + 0.5 * float(turning @ inertia @ turning)
    joint = join(target, catch, turning)
    swing = hinged({**appendage, "target.mass": target.mass})
    if swing is not None:
        placed = asked(appendage.get, turn.T @ (target.position - joint.position))
        moving = hinged({**placed, "target.mass": joint.mass})
        assert moving is not None
        swing, joint = swing.along(turn), replace(joint, spin=joint.spin - moving.along(turn).momentum)
    vertex = _vector(capture, "vertex.position")
    parameters = pair_parameters(chaser, joint)
    bodies, reach = (chaser, target, catch, inner, joint, vertex), capture["target.reach"]
    return Handoff(*bodies, reach, turning, parameters, attitude, appendage=appendage, swing=swing)


def line_drawn(handed: Handoff, mass: float) -> Handoff:
    """The same with this mass [kg] taken from the chaser: of the nodes of its line, which no capture has apart.

    Places and velocities stay; the removal lays the line out between its attachments.
    """
    chaser = replace(handed.chaser, mass=handed.chaser.mass - mass)
    return replace(handed, chaser=chaser, parameters=pair_parameters(chaser, handed.joint), drawn=mass)


def held_bodies(removal: Values) -> tuple[Body, Body]:
    """Chaser and target as the removal's parameters say when read back."""
    chaser_mass, target_mass = removal["chaser.mass"], removal["target.mass"]
    mass = chaser_mass + target_mass
    center, center_rate = _vector(removal, "start.center_position"), _vector(removal, "start.center_velocity")
    relative, relative_rate = _vector(removal, "start.relative_position"), _vector(removal, "start.relative_velocity")
    return (
        Body(chaser_mass, center - target_mass / mass * relative, center_rate - target_mass / mass * relative_rate),
        Body(target_mass, center + chaser_mass / mass * relative, center_rate + chaser_mass / mass * relative_rate),
    )


def spin_energy(body: Body) -> float:
    """H . I^-1 H / 2 [J]; zero for a body without inertia."""
    if not body.inertia.any():
        return 0.0
    return 0.5 * float(body.spin @ np.linalg.solve(body.inertia, body.spin))


@dataclass(frozen=True)
class SpinSpeeds:
    """What is told of a spin that a point drops.

    attachment_speed   |H| / I_min times how far the target reaches: how fast it may carry the tether's end [m/s]
    tug_speed          estimate of the speed at which the line first comes taut [m/s]
    """

    attachment_speed: float = 0.0
    tug_speed: float = 0.0


def spin_speeds(handed: Handoff, slack: float, thrust: float) -> SpinSpeeds:
    """The speed that the spin may give the attachment, and the relative speed of the first tug.

        v_tug^2 = v_rel^2 + 2 (|F|/m_chaser) s

    slack         s of the tether                                [m]
    thrust        F of the chaser                                [N]

    Valid    as an estimate: gravity between hand-over and first tug is left out
    """
    joint, chaser = handed.joint, handed.chaser
    smallest = float(np.linalg.eigvalsh(joint.inertia)[0])
    speed = float(np.linalg.norm(joint.spin)) / smallest * handed.reach if smallest > 0.0 else 0.0
    relative = joint.velocity - chaser.velocity
    tug = math.sqrt(float(relative @ relative) + 2.0 * abs(thrust) / chaser.mass * max(0.0, slack))
    return SpinSpeeds(speed, tug)


def without_recoil(handed: Handoff, start_velocity: Vector) -> dict[str, float]:
    """The removal's parameters had the shot given no momentum: the same places, everything at rest but for the chaser's
    own velocity before the shot [m/s], (3,)."""
    chaser = Body(handed.chaser.mass, handed.chaser.position, start_velocity)
    target = Body(handed.joint.mass, handed.joint.position, np.zeros(3))
    return pair_parameters(chaser, target)
