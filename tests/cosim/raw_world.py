"""A chaser, a target and a net as nothing but mass points, and what a capture FMU would say of them.

The points are held in inertial axes, which lie across the orbital frame at any angle; the target's six move as a rigid
body. `outputs` forms what the capture tells, in its turning frame and from the definitions; every judgement of the
hand-off is a sum over the points in the inertial axes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

Array = npt.NDArray[np.float64]
Sums = tuple[float, Array, Array, Array, Array, float]

RATE = 1.0381289e-3
"""At which the orbital frame turns: 800 km [rad/s]."""


@dataclass(frozen=True)
class Points:
    """Masses [kg] (n,), positions [m] and velocities [m/s] (n, 3), inertial."""

    mass: Array
    position: Array
    velocity: Array

    def __add__(self, other: Points) -> Points:
        return Points(*(np.concatenate(pair) for pair in zip(self.parts(), other.parts(), strict=True)))

    def parts(self) -> tuple[Array, Array, Array]:
        return self.mass, self.position, self.velocity

    def center(self) -> tuple[Array, Array]:
        """Position and velocity of the centre of mass."""
        return self.mass @ self.position / self.mass.sum(), self.mass @ self.velocity / self.mass.sum()

    def momentum(self) -> Array:
        return np.array(self.mass @ self.velocity)

    def spin(self, about: tuple[Array, Array] | None = None) -> Array:
        """Angular momentum about a moving point, the centre of mass unless one is given [N m s]."""
        place, rate = about or self.center()
        return np.array((self.mass[:, None] * np.cross(self.position - place, self.velocity - rate)).sum(axis=0))

    def inertia(self) -> Array:
        """About the centre of mass [kg m2]."""
        arms = self.position - self.center()[0]
        return np.array(sum(m * (a @ a * np.eye(3) - np.outer(a, a)) for m, a in zip(self.mass, arms, strict=True)))

    def energy(self) -> float:
        """Kinetic [J]."""
        return float(0.5 * self.mass @ (self.velocity**2).sum(axis=1))

    def energy_if_rigid(self) -> float:
        """Kinetic energy of the rotation alone, if the points turned as one body with the spin they have [J]."""
        turning = np.linalg.solve(self.inertia(), self.spin())
        return float(0.5 * self.mass @ (np.cross(turning, self.position - self.center()[0]) ** 2).sum(axis=1))


@dataclass(frozen=True)
class World:
    """The three groups of points, the vertex (3,) and the frame's axes: columns are the frame's in inertial axes."""

    chaser: Points
    target: Points
    net: Points
    vertex: Array
    axes: Array
    attitude: Rotation
    body_rate: Array
    principal: Array
    reach: float

    @property
    def joint(self) -> Points:
        return self.target + self.net

    @property
    def all(self) -> Points:
        return self.chaser + self.joint

    def in_frame(self, points: Points) -> Points:
        """The same points in the turning frame's axes, velocities as seen in it."""
        seen = points.velocity - np.cross(RATE * self.axes[:, 2], points.position)
        return Points(points.mass, points.position @ self.axes, seen @ self.axes)

    def outputs(self) -> dict[str, float]:
        """Of a capture FMU, by name."""
        chaser, target, net = (self.in_frame(points) for points in (self.chaser, self.target, self.net))
        quaternion = self.attitude.as_quat(scalar_first=True)
        inertia, (place, rate) = net.inertia(), net.center()
        vectors = {
            "chaser.position": chaser.position[0],
            "chaser.velocity": chaser.velocity[0],
            "target.position": target.center()[0],
            "target.velocity": target.center()[1],
            "target.rate": self.body_rate,
            "target.inertia": self.principal,
            "target.spin": self.target.spin() @ self.axes,
            "target.attitude": quaternion,
            "vertex.position": self.vertex @ self.axes,
            "catch.position": place,
            "catch.velocity": rate,
            "catch.spin": net.spin(),
            "catch.inertia": [inertia[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))],
        }
        values = {f"{name}[{i}]": float(x) for name, vector in vectors.items() for i, x in enumerate(vector, start=1)}
        masses = {name: float(points.mass.sum()) for name, points in (("chaser", chaser), ("target", target))}
        return values | {
            "chaser.mass": masses["chaser"],
            "target.mass": masses["target"],
            "catch.mass": float(net.mass.sum()),
            "energy.kinetic": net.energy(),
            "target.reach": self.reach,
        }


def world(seed: int, spin: float = 2e-3) -> World:
    """A capture as mission's: a chaser of 2 t, a target of 1 t that turns, a net of 6 kg about it.

    spin         size of the target's rates [rad/s]
    """
    generator = np.random.default_rng(seed)
    axes = Rotation.random(random_state=seed).as_matrix()
    attitude = Rotation.random(random_state=seed + 1000)
    turning = RATE * axes[:, 2]

    def moving(place: Array, seen: Array) -> Array:
        """Inertial velocity of a place of the frame, with a velocity seen in it, both inertial axes."""
        return np.asarray(seen @ axes.T + np.cross(turning, place))

    chaser_place = np.array([[0.1, -12.0, 0.05]]) + 0.1 * generator.normal(size=(1, 3))
    chaser_place = chaser_place @ axes.T
    chaser = Points(np.array([2000.0]), chaser_place, moving(chaser_place, 5e-3 * generator.normal(size=(1, 3))))
    # six points on the body's axes: a rigid body whose inertia is diagonal there
    arms, masses = np.array([0.9, 1.4, 1.1]), np.array([120.0, 230.0, 150.0])
    body = np.concatenate([np.diag(arms), -np.diag(arms)])
    squares = 2.0 * masses * arms**2
    body_rate = spin * generator.normal(size=3)
    to_inertial = axes @ attitude.as_matrix()
    center = 0.02 * generator.normal(size=3) @ axes.T
    swing = np.cross(body_rate, body) @ to_inertial.T
    target = Points(
        np.concatenate([masses, masses]),
        center + body @ to_inertial.T,
        moving(center, 2e-3 * generator.normal(size=3)) + swing,
    )
    places = (generator.normal(0.0, 1.5, (40, 3)) + np.array([0.0, 0.8, 0.0])) @ axes.T
    net = Points(generator.uniform(0.05, 0.25, 40), places, moving(places, generator.normal(0.0, 0.5, (40, 3))))
    vertex = (np.array([0.1, -1.95, -0.05]) + 0.05 * generator.normal(size=3)) @ axes.T
    return World(chaser, target, net, vertex, axes, attitude, body_rate, squares.sum() - squares, float(arms.max()))
