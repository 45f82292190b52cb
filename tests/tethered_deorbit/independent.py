"""The tow integrated by other means: absolute gravity formed otherwise, scipy's solver, its own location of events.

No line of the model is used. What a run begins with is read from the outputs of an instance at its start.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

from fmu_src.instance import Instance

MU = 3.986004418e14
BLIND = 1e-3
"""For so long after a change no other is looked for [s]: the signal is zero to rounding there, of either sign."""
ABSOLUTE = np.array([1e-7] * 3 + [1e-10] * 3 + [1e-14] * 3 + [1e-15] * 3 + [1e-11])

Vector = np.ndarray[Any, np.dtype[np.float64]]


@dataclass
class Line:
    """A locked line and its thruster.

    length, stiffness, damping   l0 [m], k [N/m], c [N s/m]
    thrust                       along the chaser's along-track [N]
    """

    chaser: float
    target: float
    length: float
    stiffness: float
    damping: float
    thrust: float


@dataclass
class Towed:
    """What came out: tugs as (time, speed, peak), impulse at the end, least separation and when; all SI."""

    tugs: list[tuple[float, float, float]] = field(default_factory=list)
    slack_from: list[float] = field(default_factory=list)
    impulse: float = 0.0
    nearest: float = np.inf
    nearest_at: float = 0.0


def line_of(i: Instance) -> Line:
    length = i["tether.rest_length"]
    stiffness = i["tether.youngs_modulus"] * np.pi * i["tether.diameter"] ** 2 / (4.0 * length)
    chaser, target = i["chaser.mass"], i["target.mass"]
    damping = 2.0 * i["tether.damping_ratio"] * np.sqrt(stiffness * chaser * target / (chaser + target))
    return Line(chaser, target, length, stiffness, damping, i["thrust.level"])


def start_of(i: Instance) -> Vector:
    """Centre, its velocity, relative position and velocity in inertial axes, and an impulse of zero."""
    r, v = i.array("center_position").copy(), i.array("center_velocity").copy()
    normal = np.cross(r, v)
    basis = np.array([r / np.linalg.norm(r), np.zeros(3), normal / np.linalg.norm(normal)])
    basis[1] = np.cross(basis[2], basis[0])
    turning = np.array([0.0, 0.0, np.linalg.norm(normal) / (r @ r)])
    relative = i.array("relative_position").copy()
    rate = i.array("relative_velocity") + np.cross(turning, relative)
    return np.concatenate([r, v, basis.T @ relative, basis.T @ rate, [0.0]])


def cross(a: Vector, b: Vector) -> Vector:
    """numpy's, in a tenth of the time."""
    (a1, a2, a3), (b1, b2, b3) = a.tolist(), b.tolist()
    return np.array([a2 * b3 - a3 * b2, a3 * b1 - a1 * b3, a1 * b2 - a2 * b1])


def size(a: Vector) -> float:
    return math.sqrt(a @ a)


def gravity_difference(r: Vector, d: Vector) -> Vector:
    """g(r + d) - g(r) [m/s^2] = -mu/|r+d|^3 (d + r (1 - (|r+d|/|r|)^3)), the bracket by expm1 and log1p."""
    square = r @ r
    grown = math.expm1(1.5 * math.log1p((2.0 * (r @ d) + d @ d) / square))
    return -MU / (square**1.5 * (1.0 + grown)) * (d - grown * r)


def integrate(line: Line, start: Vector, end: float) -> Towed:
    total = line.chaser + line.target
    reduced = line.chaser * line.target / total

    def of_line(y: Vector) -> tuple[float, float, float]:
        length = size(y[6:9])
        rate = float(y[6:9] @ y[9:12]) / length
        return length, rate, line.stiffness * (length - line.length) + line.damping * rate

    def motion(taut: bool) -> Any:
        def rates(_: float, y: Vector) -> Vector:
            r, rho = y[0:3], y[6:9]
            to_chaser, to_target = -line.target / total * rho, line.chaser / total * rho
            own = -MU / (r @ r) ** 1.5 * r
            at_chaser, at_target = gravity_difference(r, to_chaser), gravity_difference(r, to_target)
            place, velocity = r + to_chaser, y[3:6] - line.target / total * y[9:12]
            across = cross(cross(place, velocity), place)
            thrust = line.thrust * across / size(across)
            tension = of_line(y)[2] if taut else 0.0
            center = own + (line.chaser * at_chaser + line.target * at_target + thrust) / total
            apart = at_target - at_chaser - thrust / line.chaser
            apart -= tension / reduced * rho / size(rho)
            rate = np.empty(13)
            rate[0:3], rate[3:6], rate[6:9], rate[9:12], rate[12] = y[3:6], center, y[9:12], apart, tension
            return rate

        return rates

    def switch(taut: bool) -> Any:
        def signal(_: float, y: Vector) -> float:
            length, _, tension = of_line(y)
            return -tension if taut else min(length - line.length, tension / line.stiffness)

        signal.terminal, signal.direction = True, 1.0  # type: ignore[attr-defined]
        return signal

    def turn(_: float, y: Vector) -> float:
        return float(y[6:9] @ y[9:12])

    turn.direction = 1.0  # type: ignore[attr-defined]
    out = Towed(nearest=float(np.linalg.norm(start[6:9])))
    time, state, taut = 0.0, start, False
    while time < end:
        begun, most = time, 0.0
        if taut:
            out.tugs.append((time, of_line(state)[1], 0.0))
        while True:
            blind = time == begun
            until = min(end, time + BLIND) if blind else end
            found = solve_ivp(
                motion(taut), (time, until), state, "DOP853", rtol=1e-13, atol=ABSOLUTE, dense_output=True,
                events=[turn] if blind else [turn, switch(taut)],
            )  # fmt: skip
            for at, y in zip(found.t_events[0], found.y_events[0], strict=True):
                if np.linalg.norm(y[6:9]) < out.nearest:
                    out.nearest, out.nearest_at = float(np.linalg.norm(y[6:9])), float(at)
            if taut:
                most = max(most, _largest(found, lambda y: of_line(y)[2]))
            time, state = float(found.t[-1]), found.y[:, -1]
            if not blind or time >= end:
                break
        if taut:
            out.tugs[-1] = (*out.tugs[-1][:2], most)
            out.slack_from.append(time)
        taut = not taut
    if np.linalg.norm(state[6:9]) < out.nearest:
        out.nearest, out.nearest_at = float(np.linalg.norm(state[6:9])), end
    out.impulse = float(state[12])
    return out


def _largest(found: Any, value: Any) -> float:
    """Largest of a value over the dense output, from its samples refined."""
    times = np.unique(np.concatenate([np.linspace(a, b, 9) for a, b in zip(found.t[:-1], found.t[1:], strict=True)]))
    values = [value(found.sol(t)) for t in times]
    top = int(np.argmax(values))
    low, high = times[max(0, top - 1)], times[min(len(times) - 1, top + 1)]
    better = minimize_scalar(
        lambda t: -value(found.sol(t)), bounds=(low, high), method="bounded", options={"xatol": 1e-9}
    )
    return float(max(values[top], -better.fun))
