"""A tow of rigid bodies put together once more, in scipy: rotation matrices, absolute velocities, plain gravity."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq

MU = 3.986004418e14
EDGE = 1e-12
"""By how much a line must be past its length, or its tension below zero, for it to change [m]."""
Vector = np.ndarray


def axial(w: Vector) -> Vector:
    return np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])


@dataclass
class Body:
    """A rigid body: mass [kg], inertia (3, 3) [kg m2], attachment (3,) [m], all along body axes."""

    mass: float
    inertia: Vector
    attachment: Vector


@dataclass
class Line:
    """An elastic line: rest length [m], stiffness [N/m], dashpot [N s/m]."""

    length: float
    stiffness: float
    dashpot: float


@dataclass
class Tug:
    time: float
    speed: float
    peak: float = 0.0


@dataclass
class Tow:
    """States in the order: relative position and velocity of the chaser to the origin, the same of the target, rotation
    matrices of both, body rates of both: 36 numbers. The origin moves on a circle, or stands still without field."""

    chaser: Body
    target: Body
    line: Line
    radius: float = 0.0
    thrust: Callable[[Vector, Vector], Vector] | None = None
    tugs: list[Tug] = field(default_factory=list)
    gradient: bool = True

    def origin(self, time: float) -> tuple[Vector, Vector]:
        if self.radius == 0.0:
            return np.zeros(3), np.zeros(3)
        n = np.sqrt(MU / self.radius**3)
        c, s = np.cos(n * time), np.sin(n * time)
        return self.radius * np.array([c, s, 0.0]), self.radius * n * np.array([-s, c, 0.0])

    def gravity(self, time: float, place: Vector) -> Vector:
        """What gravity does beyond what it does to the origin; Battin's difference by a series in the offset."""
        if self.radius == 0.0:
            return np.zeros(3)
        base, _ = self.origin(time)
        r2 = self.radius**2
        q = (2.0 * base @ place + place @ place) / r2
        # (1 + q)^(-3/2) - 1 with expm1 and log1p
        factor = np.expm1(-1.5 * np.log1p(q))
        return -MU / self.radius**3 * (place + factor * (base + place))

    def ends(self, y: Vector) -> tuple[Vector, Vector, list[Vector], list[Vector]]:
        """Vector of the line, its rate, both rotation matrices and both arms."""
        turned = [y[12:21].reshape(3, 3), y[21:30].reshape(3, 3)]
        rates = [y[30:33], y[33:36]]
        arms = [a @ b.attachment for a, b in zip(turned, (self.chaser, self.target), strict=True)]
        moving = [
            a @ np.cross(w, b.attachment) for a, w, b in zip(turned, rates, (self.chaser, self.target), strict=True)
        ]
        return y[6:9] + arms[1] - y[0:3] - arms[0], y[9:12] + moving[1] - y[3:6] - moving[0], turned, arms

    def tension(self, y: Vector) -> float:
        d, v, _, _ = self.ends(y)
        length = float(np.linalg.norm(d))
        return self.line.stiffness * (length - self.line.length) + self.line.dashpot * float(d @ v) / length

    def rate(self, time: float, y: Vector, taut: bool) -> Vector:
        d, _, turned, arms = self.ends(y)
        pull = max(0.0, self.tension(y)) * d / np.linalg.norm(d) if taut else np.zeros(3)
        out = np.zeros(36)
        base, speed = self.origin(time)
        for k, (body, force) in enumerate(((self.chaser, pull), (self.target, -pull))):
            at = 6 * k
            out[at : at + 3] = y[at + 3 : at + 6]
            out[at + 3 : at + 6] = self.gravity(time, y[at : at + 3]) + force / body.mass
            w, a = y[30 + 3 * k : 33 + 3 * k], turned[k]
            out[12 + 9 * k : 21 + 9 * k] = (a @ axial(w)).ravel()
            torque = a.T @ np.cross(arms[k], force)
            if self.radius and self.gradient:
                place = a.T @ (base + y[at : at + 3])
                torque += 3.0 * MU / np.linalg.norm(place) ** 5 * np.cross(place, body.inertia @ place)
            out[30 + 3 * k : 33 + 3 * k] = np.linalg.solve(body.inertia, torque - np.cross(w, body.inertia @ w))
        if self.thrust is not None:
            out[3:6] += self.thrust(base + y[0:3], speed + y[3:6]) / self.chaser.mass
        return out

    def run(self, y: Vector, end: float) -> Vector:
        """State at `end` [s], of a line that is slack at the start; the tugs on the way are kept."""
        time, taut = 0.0, False
        while time < end:
            solver = DOP853(
                partial(self.rate, taut=taut), time, y, end, max_step=0.02 if taut else 10.0, rtol=1e-12, atol=1e-13
            )
            while solver.status == "running":
                solver.step()
                dense = solver.dense_output()
                signal = self.slackness if taut else self.stretch
                if taut:
                    self.note_peak(dense, solver.t_old, solver.t)
                if signal(solver.y) > 0.0:
                    switch = float(brentq(lambda t, d=dense, f=signal: f(d(t)), solver.t_old, solver.t, xtol=1e-12))
                    time, y = switch, dense(switch)
                    break
            else:
                return solver.y
            if not taut:
                d, v, _, _ = self.ends(y)
                self.tugs.append(Tug(time, float(d @ v / np.linalg.norm(d))))
            taut = not taut
        return y

    def stretch(self, y: Vector) -> float:
        """Above zero where a slack line pulls: it is stretched, and its dashpot does not push harder [m]."""
        d, _, _, _ = self.ends(y)
        return min(float(np.linalg.norm(d)) - self.line.length, self.tension(y) / self.line.stiffness) - EDGE

    def slackness(self, y: Vector) -> float:
        return -self.tension(y) - EDGE * self.line.stiffness

    def note_peak(self, dense: Callable[[float], Vector], first: float, last: float) -> None:
        """The peak of the present tug, by a parabola through the largest of nine samples and its neighbours."""
        times = np.linspace(first, last, 9)
        values = np.array([self.tension(dense(t)) for t in times])
        k = int(values.argmax())
        top = values[k]
        if 0 < k < 8:
            a, c = values[k - 1], values[k + 1]
            top -= (c - a) ** 2 / (8.0 * (a - 2.0 * top + c))
        self.tugs[-1].peak = max(self.tugs[-1].peak, float(top))
