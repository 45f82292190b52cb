"""A body that turns on without torques, against an integration by scipy, its constants and its special cases."""

from __future__ import annotations

from time import perf_counter

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from orbital.tumbling import turned_freely

RATE = 1.0381e-3
BEGUN = Rotation.from_quat([0.3, -0.2, 0.5, 0.7])
BEGUN_AS = BEGUN.as_quat(scalar_first=True)


def integrated(rate: np.ndarray, inertia: np.ndarray, time: float) -> tuple[Rotation, np.ndarray]:
    """Attitude and rate by Euler's equations and q' = q (0, w)/2."""

    def changes(_: float, state: np.ndarray) -> np.ndarray:
        s, v, w = state[0], state[1:4], state[4:]
        return np.array([-0.5 * v @ w, *(0.5 * (s * w + np.cross(v, w))), *(np.cross(inertia * w, w) / inertia)])

    start = [*BEGUN_AS, *rate]
    end = solve_ivp(changes, (0.0, time), start, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    return Rotation.from_quat(end[:4], scalar_first=True), end[4:]


BODIES = [(700.0, 1000.0, 1300.0), (1300.0, 700.0, 1000.0), (1000.0, 1300.0, 700.0), (1300.0, 1000.0, 700.0)]
RATES = [(0.02, 0.03, -0.3), (-0.3, 0.02, 0.01), (0.03, -0.3, 0.02), (0.1, -0.12, 0.14), (-0.2, -0.1, -0.05)]


@pytest.mark.parametrize("inertia", BODIES)
@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("time", [7.0, 260.0, -90.0])
def test_it_turns_as_it_is_integrated(inertia: tuple[float, ...], rate: tuple[float, ...], time: float) -> None:
    """About each of its axes, either way round, whatever the order of its moments."""
    moments, begun = np.array(inertia), np.array(rate)
    found, turned = turned_freely(BEGUN_AS, begun, moments, 0.0, time)
    attitude, expected = integrated(begun, moments, time)
    assert turned == pytest.approx(expected, abs=1e-9)
    assert (Rotation.from_quat(found, scalar_first=True).inv() * attitude).magnitude() < 1e-8


@pytest.mark.parametrize("time", [1e5, 1e7, 3e7])
def test_a_long_time_costs_no_more(time: float) -> None:
    """Half the time twice comes to the same, momentum and energy stay; an integration of 1e7 s took minutes."""
    inertia, rate = np.array([700.0, 1000.0, 1300.0]), np.array([0.02, 0.03, -0.1])
    since = perf_counter()
    found, turned = turned_freely(BEGUN_AS, rate, inertia, RATE, time)
    assert perf_counter() - since < 1.0
    half = turned_freely(BEGUN_AS, rate, inertia, RATE, 0.5 * time)
    twice, again = turned_freely(*half, inertia, RATE, 0.5 * time)
    attitude = Rotation.from_quat(found, scalar_first=True)
    assert turned == pytest.approx(again, abs=1e-15 * time)
    assert (attitude.inv() * Rotation.from_quat(twice, scalar_first=True)).magnitude() < 1e-15 * time
    assert inertia @ turned**2 == pytest.approx(inertia @ rate**2, rel=1e-13)
    kept = Rotation.from_rotvec([0.0, 0.0, -RATE * time]).apply(BEGUN.apply(inertia * rate))
    assert attitude.apply(inertia * turned) == pytest.approx(kept, rel=1e-11)


@pytest.mark.parametrize(
    ("inertia", "rate"),
    [
        ((700.0, 1000.0, 1300.0), (0.0, 0.3, 0.0)),
        ((700.0, 1000.0, 1300.0), (0.0, 0.0, -0.3)),
        ((700.0, 1000.0, 1300.0), (0.0, 0.0, 0.0)),
        ((900.0, 900.0, 900.0), (0.1, -0.2, 0.3)),
        ((900.0, 900.0, 400.0), (0.1, -0.2, 0.0)),
        ((400.0, 900.0, 900.0), (0.0, -0.2, 0.1)),
    ],
)
def test_about_a_principal_axis_it_turns_evenly(inertia: tuple[float, ...], rate: tuple[float, ...]) -> None:
    found, turned = turned_freely(BEGUN_AS, np.array(rate), np.array(inertia), 0.0, 300.0)
    assert turned.tolist() == list(rate)
    expected = BEGUN * Rotation.from_rotvec(300.0 * np.array(rate))
    assert (Rotation.from_quat(found, scalar_first=True).inv() * expected).magnitude() < 1e-12


@pytest.mark.parametrize("lone", [150.0, 600.0])
def test_a_body_with_an_axis_of_symmetry_turns_in_closed_form(lone: float) -> None:
    """Its axis goes round the angular momentum at H/I1, and it turns about it at (1 - I3/I1) w3 besides."""
    inertia, rate, time = np.array([400.0, 400.0, lone]), np.array([0.05, 0.0, 0.2]), 9e4
    found, turned = turned_freely(BEGUN_AS, rate, inertia, RATE, time)
    around = Rotation.from_rotvec(BEGUN.apply(inertia * rate) / 400.0 * time)
    about = Rotation.from_rotvec([0.0, 0.0, (1.0 - lone / 400.0) * rate[2] * time])
    expected = Rotation.from_rotvec([0.0, 0.0, -RATE * time]) * around * BEGUN * about
    assert (Rotation.from_quat(found, scalar_first=True).inv() * expected).magnitude() < 1e-10
    assert turned == pytest.approx(about.inv().apply(rate), abs=1e-11)


def test_a_tumble_about_the_middle_axis_turns_over() -> None:
    inertia, rate = np.array([700.0, 1000.0, 1300.0]), np.array([1e-3, 0.3, 1e-3])
    found, turned = turned_freely(BEGUN_AS, rate, inertia, 0.0, 120.0)
    attitude, expected = integrated(rate, inertia, 120.0)
    assert turned == pytest.approx(expected, abs=1e-8)
    assert (Rotation.from_quat(found, scalar_first=True).inv() * attitude).magnitude() < 1e-7
    assert turned[1] < 0.29
