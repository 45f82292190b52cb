import math
from fractions import Fraction

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orbital import hill, twobody
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU

RADIUS = EARTH_EQUATORIAL_RADIUS + 800e3
N = math.sqrt(EARTH_MU / RADIUS**3)
POSITION = np.array([3.0, -10.0, 2.0])
VELOCITY = np.array([0.01, 0.02, -0.004])
THRUST = np.array([2e-6, -5e-6, 1e-6])


def integrated(rate, time, acceleration):
    def slope(_, y):
        out = np.empty(3)
        hill.hill_acceleration(out, y[:3], y[3:], rate)
        return np.concatenate([y[3:], out + acceleration])

    start = np.concatenate([POSITION, VELOCITY])
    end = solve_ivp(slope, (0.0, time), start, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    return end[:3], end[3:]


def exact_acceleration(position, velocity):
    """Gravity at both ends and the forces of the turning frame, nothing linearised."""
    out, rate = np.empty(3), np.array([0.0, 0.0, N])
    twobody.differential_gravity(out, np.array([RADIUS, 0.0, 0.0]), position, EARTH_MU)
    return out - 2 * np.cross(rate, velocity) - np.cross(rate, np.cross(rate, position))


@pytest.mark.parametrize("distance", [1.0, 60.0, 1000.0])
def test_acceleration_is_the_exact_one_up_to_the_square_of_the_distance(run, rng, distance):
    out = np.empty(3)
    for position, velocity in rng.normal(size=(30, 2, 3)):
        position *= distance / np.linalg.norm(position)
        run(hill.hill_acceleration)(out, position, velocity, N)
        neglected = 3.0 * N**2 * distance**2 / RADIUS
        error = np.linalg.norm(out - exact_acceleration(position, velocity))
        assert error < 1.1 * neglected + 1e-15 * N
        run(hill.hill_acceleration)(out, position, -velocity, N)
        assert np.linalg.norm(out - exact_acceleration(position, velocity)) > 1.1 * neglected


def test_acceleration_may_be_written_over_its_operand_and_keeps_nan_visible(run):
    out, expected = POSITION.copy(), np.empty(3)
    run(hill.hill_acceleration)(expected, POSITION, VELOCITY, N)
    run(hill.hill_acceleration)(out, out, VELOCITY, N)
    np.testing.assert_array_equal(out, expected)
    run(hill.hill_acceleration)(out, np.zeros(3), np.zeros(3), N)
    np.testing.assert_array_equal(out, 0.0)
    run(hill.hill_acceleration)(out, np.array([0.0, math.nan, math.nan]), VELOCITY, N)
    assert np.isfinite(out[:2]).all(), "the along-track place does not matter, so its NaN does not either"
    assert np.isnan(out[2])


@pytest.mark.parametrize("time", [-500.0, 1.0, 900.0, 12000.0])
@pytest.mark.parametrize("thrust", [None, THRUST])
def test_solution_against_integration(time, thrust):
    found = hill.clohessy_wiltshire(POSITION, VELOCITY, N, time, thrust)
    expected = integrated(N, time, np.zeros(3) if thrust is None else thrust)
    twin = hill.clohessy_wiltshire(POSITION, VELOCITY, 1.01 * N, time, thrust)
    for value, peer, wrong in zip(found, expected, twin, strict=True):
        scale = np.linalg.norm(peer)
        assert np.linalg.norm(value - peer) < 1e-11 * scale
        assert np.linalg.norm(wrong - peer) > 1e-9 * scale


def test_solution_starts_at_the_start_and_short_times_lose_nothing():
    position, velocity = hill.clohessy_wiltshire(POSITION, VELOCITY, N, 0.0, THRUST)
    np.testing.assert_array_equal(position, POSITION)
    np.testing.assert_array_equal(velocity, VELOCITY)
    # From rest under radial thrust y = -2 (nt - sin nt) a/n^2, about -n a t^3/3. The tolerances are relative alone:
    # pytest would otherwise allow 1e-12, and the value is smaller.
    time = 1e-3
    position, _ = hill.clohessy_wiltshire(np.zeros(3), np.zeros(3), N, time, np.array([1.0, 0.0, 0.0]))
    assert position[1] == pytest.approx(-N * time**3 / 3, rel=1e-12, abs=0.0)
    plain = -2 * (N * time - math.sin(N * time)) / N**2
    assert plain != pytest.approx(-N * time**3 / 3, rel=1e-6, abs=0.0), "the twin: the plain difference"


def test_jacobi_integral_is_kept_along_the_solution(run):
    start = run(hill.hill_jacobi)(POSITION, VELOCITY, N)
    scale = 0.5 * VELOCITY @ VELOCITY + 1.5 * N**2 * POSITION @ POSITION
    for time in np.linspace(0.0, 7000.0, 15)[1:]:
        state = hill.clohessy_wiltshire(POSITION, VELOCITY, N, time)
        # Positions grow to hundreds of metres, so the terms that cancel do too.
        grown = scale + 1.5 * N**2 * state[0] @ state[0]
        assert abs(run(hill.hill_jacobi)(*state, N) - start) < 1e-14 * grown
        assert abs(run(hill.hill_jacobi)(*state, 1.01 * N) - start) > 1e-9 * grown


def test_angle_minus_sine_against_exact_arithmetic():
    for angle in (1e-8, 1e-3, 0.5, 0.9999, -0.7, 1.0001, 3.0):
        a = Fraction(angle)
        exact = sum((-1) ** k * a ** (2 * k + 3) / math.factorial(2 * k + 3) for k in range(16))
        assert abs(Fraction(hill.angle_minus_sine(angle)) / exact - 1) < 2e-15
    assert hill.angle_minus_sine(0.0) == 0.0
    assert math.isnan(hill.angle_minus_sine(math.nan))
