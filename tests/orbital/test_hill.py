import math
from fractions import Fraction

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orbital import hill, twobody
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from tests.validation import other_code

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
def test_solution_against_integration(validated, time, thrust):
    found = hill.clohessy_wiltshire(POSITION, VELOCITY, N, time, thrust)
    expected = integrated(N, time, np.zeros(3) if thrust is None else thrust)
    twin = hill.clohessy_wiltshire(POSITION, VELOCITY, 1.01 * N, time, thrust)
    for value, peer, wrong in zip(found, expected, twin, strict=True):
        scale = np.linalg.norm(peer)
        error = np.linalg.norm(value - peer) / scale
        what = "Clohessy and Wiltshire's solution: place and velocity, error relative to their size"
        validated(other_code("Hill's equations by scipy"), what, error, 0.0, abs=1e-11)
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


def exact_coefficients(rate, time):
    """The eight of `hill_coefficients` as fractions, for the very numbers it is given."""
    n, t = Fraction(rate), Fraction(time)
    a = n * t
    count = 12 if abs(a) <= 0.5 else 60  # what is left out is below 1e-30 of the sum
    sine = sum((-1) ** k * a ** (2 * k + 1) / math.factorial(2 * k + 1) for k in range(count))
    versine = -sum((-1) ** k * a ** (2 * k) / math.factorial(2 * k) for k in range(1, count))
    lag = a - sine
    return [versine, sine / n, versine / n, lag, t - 4 * lag / n, n * sine, n * versine, sine]


def times(rng, low, high, count=60):
    """Mean motions [rad/s] and times [s], either way, whose product lies between two powers of ten."""
    for _ in range(count):
        rate = 10.0 ** rng.uniform(-4.0, -2.9)
        yield rate, float(rng.choice([-1.0, 1.0])) * 10.0 ** rng.uniform(low, high) / rate


@pytest.mark.parametrize(("low", "high"), [(-9.0, -6.0), (-6.0, -3.0), (-3.0, -1.0), (-1.0, math.log10(0.5))])
def test_coefficients_of_a_short_flight_keep_their_last_digits(run, rng, low, high):
    for rate, time in times(rng, low, high):
        out = np.empty(8)
        run(hill.hill_coefficients)(out, rate, time)
        for found, exact in zip(out, exact_coefficients(rate, time), strict=True):
            assert abs(Fraction(found) / exact - 1) < 8e-16
    assert 1.0 - math.cos(1e-7) != pytest.approx(5e-15, rel=1e-4, abs=0.0), "the twin: the plain difference"


def test_coefficients_of_a_long_flight(run, rng):
    for rate, time in times(rng, math.log10(0.5), math.log10(20.0)):
        out, angle = np.empty(8), abs(rate * time)
        run(hill.hill_coefficients)(out, rate, time)
        size = [2.0, 1 / rate, 2 / rate, angle, 3 * abs(time) + 4 / rate, rate, 2 * rate, 1.0]
        for found, exact, largest in zip(out, exact_coefficients(rate, time), size, strict=True):
            assert abs(Fraction(found) - exact) < 1e-15 * (1.0 + angle) * largest


def test_coefficients_do_without_the_sine_of_the_platform(run):
    """Every operation in them rounds correctly: in exact arithmetic, rounded after each, they come out the same."""
    F = Fraction
    rate, time = 1.0381289e-3, 20.0
    out = np.empty(8)
    run(hill.hill_coefficients)(out, rate, time)
    a = rate * time
    q = a * a

    def series(*divisors):
        value = 1.0
        for divisor in reversed(divisors):
            value = float(F(1) - F(float(F(float(F(q) / divisor)) * F(value))))
        return value

    versine = float(F(float(F(1, 2) * F(q))) * F(series(12, 30, 56, 90, 132, 182)))
    lag = float(F(float(F(float(F(a) * F(q))) / 6)) * F(series(20, 42, 72, 110, 156, 210)))
    assert (out[0], out[3]) == (versine, lag)
    assert out[1] == float(F(float(F(a) - F(lag))) / F(rate))


def test_coefficients_stay_loud(run):
    out = np.empty(8)
    for time in (math.nan, math.inf, -math.inf):
        run(hill.hill_coefficients)(out, N, time)
        assert not np.isfinite(out).any(), time
    run(hill.hill_coefficients)(out, N, 0.0)
    np.testing.assert_array_equal(out, 0.0)


@pytest.mark.parametrize(("low", "high"), [(-9.0, -6.0), (-6.0, -3.0), (-3.0, -1.0), (-1.0, math.log10(0.5))])
def test_flight_against_exact_arithmetic(run, rng, low, high):
    flight, position, velocity = np.empty(8), np.empty(3), np.empty(3)
    for rate, time in times(rng, low, high, 30):
        start, moving = 30.0 * rng.normal(size=3), 10.0 ** rng.uniform(-3.0, 1.0) * rng.normal(size=3)
        hill.hill_coefficients(flight, rate, time)
        run(hill.hill_flight)(position, velocity, flight, start, moving)
        versine, along, across, lag, drift, ns, nv, sine = exact_coefficients(rate, time)
        x, y, z, u, v, w = (Fraction(value) for value in (*start, *moving))
        added = [
            (3 * versine * x, along * u, 2 * across * v),
            (drift * v, -6 * lag * x, -2 * across * u),
            (along * w, -versine * z),
            (3 * ns * x, -versine * u, 2 * sine * v),
            (-6 * nv * x, -2 * sine * u, -4 * versine * v),
            (-ns * z, -versine * w),
        ]
        for found, begin, parts in zip((*position, *velocity), (x, y, z, u, v, w), added, strict=True):
            error = abs(Fraction(found) - begin - sum(parts))
            assert error < Fraction(math.ulp(found)) / 2 + Fraction(1e-15) * sum(abs(part) for part in parts)
    hill.hill_coefficients(flight, 1.01 * rate, time)
    run(hill.hill_flight)(position, velocity, flight, start, moving)
    assert abs(Fraction(velocity[0]) - u - sum(added[3])) > Fraction(1e-3) * abs(sum(added[3])), "1 % of the rate"


def test_flight_may_be_written_over_its_operands_and_component_by_component(run):
    flight, position, velocity = np.empty(8), POSITION.copy(), VELOCITY.copy()
    hill.hill_coefficients(flight, N, 20.0)
    expected = run(hill.hill_flown)(flight, *POSITION, *VELOCITY)
    run(hill.hill_flight)(position, velocity, flight, position, velocity)
    np.testing.assert_array_equal([*position, *velocity], expected)


def test_no_flight_bends_more_than_its_bound(run, rng):
    flight, position, velocity = np.empty(8), np.empty(3), np.empty(3)
    for _, time in times(rng, -3.0, 1.0, 300):
        start, moving = rng.normal(size=3) * 10.0 ** rng.uniform(-3.0, 2.0), rng.normal(size=3)
        hill.hill_coefficients(flight, N, abs(time))
        hill.hill_flight(position, velocity, flight, start, moving)
        bend = np.linalg.norm(position - (start + abs(time) * moving))
        bound = run(hill.hill_bend)(np.linalg.norm(start), np.linalg.norm(moving), N, abs(time))
        assert bend <= bound * (1.0 + 1e-12) + 1e-14 * np.linalg.norm(position)
    for start, moving in ((np.array([9.0, 0.0, 0.0]), np.zeros(3)), (np.zeros(3), np.array([0.0, 1.0, 0.0]))):
        hill.hill_coefficients(flight, N, 5.0)
        hill.hill_flight(position, velocity, flight, start, moving)
        bend = np.linalg.norm(position - (start + 5.0 * moving))
        bound = run(hill.hill_bend)(np.linalg.norm(start), np.linalg.norm(moving), N, 5.0)
        assert bend > 0.99 * bound, "it is reached, so half of it would be no bound"
