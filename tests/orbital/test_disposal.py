"""Bringing a pair down, against integrations and against figures of the literature."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orbital import disposal

MU, RADIUS = 3.986004418e14, 6378137.0


def test_spiral() -> None:
    """A slow spiral integrated: thrust against the motion, until the orbit is as low."""
    high, low, push = RADIUS + 800e3, RADIUS + 200e3, 2e-3

    def rate(_: float, y: np.ndarray) -> np.ndarray:
        place, velocity = np.asarray(y[:2]), np.asarray(y[2:])
        along = velocity / np.linalg.norm(velocity)
        return np.concatenate([velocity, -MU * place / np.linalg.norm(place) ** 3 - push * along])

    def axis(_: float, state: np.ndarray) -> float:
        y = np.asarray(state)
        return 1.0 / (2.0 / np.linalg.norm(y[:2]) - y[2:] @ y[2:] / MU) - low

    axis.terminal = True  # type: ignore[attr-defined]
    start = [high, 0.0, 0.0, math.sqrt(MU / high)]
    found = solve_ivp(rate, (0.0, 1e6), start, events=axis, rtol=1e-9, atol=1e-3)
    assert disposal.spiral_speed(high, low, MU) == pytest.approx(push * found.t[-1], rel=2e-3)
    assert disposal.spiral_speed(high, low, MU) == pytest.approx(332.0, abs=1.0)


def test_one_burn() -> None:
    """After it the orbit's lowest point is where it was wanted."""
    radius, perigee = RADIUS + 800e3, RADIUS + 120e3
    speed = math.sqrt(MU / radius) - disposal.burn_speed(radius, perigee, MU)
    axis = 1.0 / (2.0 / radius - speed**2 / MU)
    momentum = radius * speed
    eccentricity = math.sqrt(1.0 - momentum**2 / (MU * axis))
    assert axis * (1.0 - eccentricity) == pytest.approx(perigee, rel=1e-9)


def test_propellant_and_time() -> None:
    """A rocket integrated kilogram by kilogram."""
    mass, speed, impulse, force = 3000.0, 300.0, 320.0, 400.0
    flow, step, left, reached, time = force / (impulse * 9.80665), 0.01, mass, 0.0, 0.0
    while reached < speed:
        reached += force / (left - 0.5 * flow * step) * step
        left -= flow * step
        time += step
    assert disposal.propellant(mass, speed, impulse) == pytest.approx(mass - left, rel=1e-4)
    assert disposal.thrust_time(mass, speed, impulse, -force) == pytest.approx(time, rel=1e-4)


def test_power_of_a_jet() -> None:
    """Half the flow times the square of the exhaust's speed, over the efficiency."""
    exhaust = 3000.0 * 9.80665
    flow = 0.25 / exhaust
    assert disposal.jet_power(-0.25, 3000.0, 0.6) == pytest.approx(0.5 * flow * exhaust**2 / 0.6)


def test_beam() -> None:
    """Particles of a beam shot at random, of which 95 % stay within the half-angle."""
    rng = np.random.default_rng(3)
    distance, angle, face = 12.0, math.radians(15.0), 4.0
    at_edge = distance * math.tan(angle)
    points = rng.normal(size=(2, 400_000))
    within = np.hypot(*points)
    points *= at_edge / np.quantile(within, 0.95)
    met = np.mean(np.all(np.abs(points) < 0.5 * face, axis=0))
    assert disposal.beam_share(distance, angle, face) == pytest.approx(float(met), abs=4e-3)
