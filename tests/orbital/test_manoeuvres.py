"""What a chaser does between two shots, against closed forms and integrations by scipy."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orbital.constants import EARTH_MU
from orbital.manoeuvres import flown, propellant, spiral_speed, two_impulses

RATE = 1.0381e-3


def hill(_: float, state: np.ndarray) -> np.ndarray:
    x, _, z, u, v, w = state
    n = RATE
    return np.array([u, v, w, 2.0 * n * v + 3.0 * n * n * x, -2.0 * n * u, -n * n * z])


def integrated(position: np.ndarray, velocity: np.ndarray, time: float) -> tuple[np.ndarray, np.ndarray]:
    found = solve_ivp(hill, (0.0, time), [*position, *velocity], method="DOP853", rtol=1e-12, atol=1e-12)
    return found.y[:3, -1], found.y[3:, -1]


@pytest.mark.parametrize("time", [1.0, 60.0, 1500.0])
def test_two_burns_bring_it_there(time: float) -> None:
    """By an integration of Hill's equations: the first burn reaches the place, the second leaves the velocity."""
    begin, speed = np.array([1.0, -13.0, 0.4]), np.array([0.003, -0.01, 0.002])
    goal, goal_speed = np.array([0.0, -12.0, 0.0]), np.array([0.001, 0.0, -0.002])
    first, second = two_impulses(begin, speed, goal, goal_speed, RATE, time)
    place, arriving = integrated(begin, speed + first, time)
    assert place == pytest.approx(goal, abs=1e-9)
    assert arriving + second == pytest.approx(goal_speed, abs=1e-11)


def test_in_a_frame_that_stands_still_it_flies_straight() -> None:
    begin, goal = np.array([1.0, 2.0, 3.0]), np.array([4.0, 0.0, -3.0])
    first, second = two_impulses(begin, np.ones(3), goal, np.zeros(3), 0.0, 10.0)
    assert first == pytest.approx((goal - begin) / 10.0 - 1.0)
    assert second == pytest.approx(-(goal - begin) / 10.0)
    assert flown(begin, np.ones(3), 0.0, 5.0)[0] == pytest.approx(begin + 5.0)
    slowly = two_impulses(begin, np.ones(3), goal, np.zeros(3), 1e-9, 10.0)
    assert np.array(slowly) == pytest.approx(np.array([first, second]), abs=1e-7)


def test_propellant_and_spiral() -> None:
    """Tsiolkovsky by an integration of m' = -F/(Isp g0); the spiral by that of a small tangential thrust."""
    burnt = propellant(2000.0, 250.0, 220.0)
    masses = np.linspace(2000.0, 2000.0 - burnt, 20001)
    assert np.trapezoid(220.0 * 9.80665 / masses[::-1], masses[::-1]) == pytest.approx(250.0, rel=1e-8)
    low, high, push = 6.6e6, 7.2e6, 1e-3

    def spiralling(_: float, state: np.ndarray) -> np.ndarray:
        place, speed = state[:2], state[2:]
        pull = -EARTH_MU * place / np.linalg.norm(place) ** 3
        return np.array([*speed, *(pull + push * speed / np.linalg.norm(speed))])

    def axis(state: np.ndarray) -> float:
        return 1.0 / (2.0 / float(np.linalg.norm(state[:2])) - float(state[2:] @ state[2:]) / EARTH_MU)

    def reached(_: float, state: np.ndarray) -> float:
        return axis(np.asarray(state)) - high

    reached.terminal = True  # type: ignore[attr-defined]
    begin = np.array([low, 0.0, 0.0, math.sqrt(EARTH_MU / low)])
    ended = solve_ivp(spiralling, (0.0, 1e7), begin, method="DOP853", rtol=1e-9, atol=1e-3, events=reached)
    assert push * ended.t[-1] == pytest.approx(spiral_speed(low, high), rel=1e-3)
    assert spiral_speed(high, low) == spiral_speed(low, high)
