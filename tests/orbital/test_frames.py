import math

import numpy as np
import pytest

from orbital import frames, kepler, rotations, twobody
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU

RADIUS = EARTH_EQUATORIAL_RADIUS + 800e3
ROUND_TRIP = 1.0e-15


def orbit(anomaly=1.0, eccentricity=0.0, axis=RADIUS):
    position, velocity = np.empty(3), np.empty(3)
    kepler.elements_to_state(position, velocity, axis, eccentricity, math.radians(98.0), 0.7, 0.3, anomaly, EARTH_MU)
    return position, velocity


def frame_at(anomaly=1.0, eccentricity=0.0):
    basis = np.empty((3, 3))
    rate = frames.orbital_basis(basis, *orbit(anomaly, eccentricity))
    return basis, rate


def test_axes_of_a_circular_orbit(run):
    basis = np.empty((3, 3))
    position, velocity = orbit()
    rate = run(frames.orbital_basis)(basis, position, velocity)
    np.testing.assert_allclose(basis @ basis.T, np.eye(3), atol=5e-16)
    assert np.linalg.det(basis) == pytest.approx(1.0, abs=1e-15)
    np.testing.assert_allclose(basis @ position, [RADIUS, 0, 0], atol=1e-8)
    np.testing.assert_allclose(basis @ velocity, [0, twobody.circular_speed(RADIUS, EARTH_MU), 0], atol=1e-11)
    assert rate == pytest.approx(twobody.mean_motion(RADIUS, EARTH_MU), rel=1e-15, abs=0.0)
    assert rate == run(frames.orbital_rate)(position, velocity)


def test_rate_of_an_eccentric_orbit_is_that_of_its_anomaly(run):
    position, velocity = orbit(1.0, 0.4)
    rate = run(frames.orbital_rate)(position, velocity)
    before, after, spare = np.empty(3), np.empty(3), np.empty(3)
    h = 1.0
    kepler.propagate(before, spare, position, velocity, -h, EARTH_MU)
    kepler.propagate(after, spare, position, velocity, h, EARTH_MU)
    swept = math.atan2(np.linalg.norm(np.cross(before, after)), float(np.dot(before, after)))
    assert swept / (2 * h) == pytest.approx(rate, rel=1e-6)
    n = twobody.mean_motion(RADIUS, EARTH_MU)
    assert swept / (2 * h) != pytest.approx(n, rel=1e-2), "the twin: the mean motion is not the rate"


def test_a_vertical_line_has_no_frame_and_gives_no_nan(run):
    basis = np.full((3, 3), 9.0)
    assert run(frames.orbital_basis)(basis, np.array([RADIUS, 0, 0]), np.array([100.0, 0, 0])) == 0.0
    np.testing.assert_array_equal(basis, [[1, 0, 0], [0, 0, 0], [0, 0, 0]])


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e4])
def test_relative_states_go_there_and_back(run, rng, scale):
    basis, rate = frame_at(2.0, 0.2)
    p, v, p_back, v_back = np.empty((4, 3))
    for rho, rho_dot in scale * rng.normal(size=(100, 2, 3)):
        run(frames.relative_to_inertial)(p, v, basis, rate, rho, rho_dot)
        run(frames.relative_to_orbital)(p_back, v_back, basis, rate, p, v)
        size = np.linalg.norm(rho)
        assert np.linalg.norm(p_back - rho) <= ROUND_TRIP * size
        assert np.linalg.norm(v_back - rho_dot) <= ROUND_TRIP * (np.linalg.norm(rho_dot) + rate * size)
        run(frames.relative_to_orbital)(p_back, v_back, basis, -rate, p, v)
        assert np.linalg.norm(v_back - rho_dot) > rate * math.hypot(rho[0], rho[1]), "the twin: the frame turned back"


def test_relative_states_may_be_transformed_in_place(run, rng):
    basis, rate = frame_at()
    rho, rho_dot = rng.normal(size=(2, 3))
    for transform in (frames.relative_to_inertial, frames.relative_to_orbital):
        p, v = np.empty(3), np.empty(3)
        run(transform)(p, v, basis, rate, rho, rho_dot)
        p_same, v_same = rho.copy(), rho_dot.copy()
        run(transform)(p_same, v_same, basis, rate, p_same, v_same)
        np.testing.assert_array_equal(p, p_same)
        np.testing.assert_array_equal(v, v_same)


def test_absolute_positions_could_not_carry_a_tether(rng):
    """The twin of the round trip: by way of geocentric states it misses the tolerance a millionfold."""
    basis, rate = frame_at()
    origin = orbit()
    rho, rho_dot = np.array([1.0, -10.0, 2.0]), np.array([0.01, 0.0, 0.0])
    p, v = np.empty(3), np.empty(3)
    frames.state_to_inertial(p, v, *origin, basis, rate, rho, rho_dot)
    frames.state_to_orbital(p, v, *origin, basis, rate, p, v)
    error = np.linalg.norm(p - rho)
    assert 1e3 * ROUND_TRIP * np.linalg.norm(rho) < error < 5e-9


def test_a_point_at_rest_in_the_frame_moves_with_it(run):
    """Velocity against the numerical derivative of the position, along a circular orbit; the flipped rate must fail."""
    rho = np.array([3.0, -10.0, 2.0])
    rate = twobody.mean_motion(RADIUS, EARTH_MU)
    h = 1.0
    places = []
    for anomaly in (1.0 - rate * h, 1.0 + rate * h):
        p, v = np.empty(3), np.empty(3)
        run(frames.relative_to_inertial)(p, v, frame_at(anomaly)[0], rate, rho, np.zeros(3))
        places.append(p)
    slope = (places[1] - places[0]) / (2 * h)
    run(frames.relative_to_inertial)(p, v, frame_at(1.0)[0], rate, rho, np.zeros(3))
    np.testing.assert_allclose(v, slope, atol=1e-8)
    run(frames.relative_to_inertial)(p, v, frame_at(1.0)[0], -rate, rho, np.zeros(3))
    assert not np.allclose(v, slope, atol=1e-8)


def test_two_bodies_on_one_circular_orbit_are_at_rest_to_each_other(run):
    angle = 1e-3
    basis, rate = frame_at(1.0)
    p, v = np.empty(3), np.empty(3)
    run(frames.state_to_orbital)(p, v, *orbit(1.0), basis, rate, *orbit(1.0 + angle))
    np.testing.assert_allclose(p, [-2 * RADIUS * math.sin(angle / 2) ** 2, RADIUS * math.sin(angle), 0], atol=1e-8)
    np.testing.assert_allclose(v, 0.0, atol=1e-11)
    run(frames.state_to_inertial)(p, v, *orbit(1.0), basis, rate, p, v)
    np.testing.assert_allclose(p, orbit(1.0 + angle)[0], rtol=1e-14)
    np.testing.assert_allclose(v, orbit(1.0 + angle)[1], rtol=1e-12)


def test_attitude_between_the_frames(run, rng):
    basis, _ = frame_at()
    frame, attitude, out, turned = np.empty(4), rng.normal(size=4), np.empty(4), np.empty(3)
    rotations.normalise(attitude, attitude)
    run(frames.orbital_quaternion)(frame, basis)
    run(frames.attitude_to_inertial)(out, frame, attitude)
    body_vector = rng.normal(size=3)
    rotations.rotate(turned, attitude, body_vector)
    by_matrix = basis.T @ turned
    rotations.rotate(turned, out, body_vector)
    np.testing.assert_allclose(turned, by_matrix, atol=2e-15)
    assert not np.allclose(turned, basis @ by_matrix, atol=1e-3), "the twin: the frame turned the wrong way"
    run(frames.attitude_to_orbital)(out, frame, out)
    np.testing.assert_allclose(out, attitude, atol=ROUND_TRIP)
