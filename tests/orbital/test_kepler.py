import math
from fractions import Fraction

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from orbital import kepler, twobody
from orbital.constants import EARTH_MU
from tests.validation import other_code

# Semi-major axis and eccentricity: low circle, ellipse, GEO, a transfer, hyperbola.
CONICS = [(7.178e6, 0.0), (8e6, 0.1), (4.2164e7, 1e-4), (2.4e7, 0.72), (-2e7, 1.4)]


def state(*elements):
    position, velocity = np.empty(3), np.empty(3)
    kepler.elements_to_state(position, velocity, *elements, EARTH_MU)
    return position, velocity


def propagated(run, position, velocity, duration):
    r, v = np.empty(3), np.empty(3)
    assert run(kepler.propagate)(r, v, position, velocity, duration, EARTH_MU) == 0
    return r, v


def integrated(position, velocity, duration, mu=EARTH_MU):
    def rate(_, y):
        out = np.empty(3)
        twobody.two_body_acceleration(out, y[:3], mu)
        return np.concatenate([y[3:], out])

    start = np.concatenate([position, velocity])
    end = solve_ivp(rate, (0.0, duration), start, method="DOP853", rtol=1e-12, atol=1e-5).y[:, -1]
    return end[:3], end[3:]


@pytest.mark.parametrize(("axis", "eccentricity"), CONICS)
def test_elements_there_and_back(run, rng, axis, eccentricity):
    for i, node, argument, anomaly in rng.uniform(0.05, 1.9, size=(20, 4)):
        given = (axis, eccentricity, i, node, argument, anomaly)
        position, velocity = np.empty(3), np.empty(3)
        run(kepler.elements_to_state)(position, velocity, *given, EARTH_MU)
        found = kepler.state_to_elements(position, velocity, EARTH_MU)
        if eccentricity == 0.0:
            given = (axis, eccentricity, i, node, 0.0, argument + anomaly)
        # Anomaly and argument are as uncertain as rounding over eccentricity.
        np.testing.assert_allclose(found, given, rtol=1e-13, atol=1e-15 / max(eccentricity, 1e-4))
        assert abs(found.inclination / (1.01 * i) - 1) > 1e-13


def test_circular_and_equatorial_orbits_have_their_angles_by_definition():
    found = kepler.state_to_elements(*state(7e6, 0.0, 0.0, 0.4, 0.5, 0.6), EARTH_MU)
    assert (found.ascending_node, found.periapsis_argument) == (0.0, 0.0)
    assert found.true_anomaly == pytest.approx(1.5, rel=1e-14)
    found = kepler.state_to_elements(*state(7e6, 0.2, 0.0, 0.4, 0.5, 0.6), EARTH_MU)
    assert found.ascending_node == 0.0
    assert found.periapsis_argument == pytest.approx(0.9, rel=1e-13)
    found = kepler.state_to_elements(*state(7e6, 0.2, math.pi, 0.0, 0.5, 0.6), EARTH_MU)
    assert found.inclination == pytest.approx(math.pi, rel=1e-15)
    assert found.periapsis_argument == pytest.approx(0.5, rel=1e-13)


def test_state_of_elements_points_where_they_say(run):
    position, velocity = np.empty(3), np.empty(3)
    run(kepler.elements_to_state)(position, velocity, 1e7, 0.3, 0.0, 0.0, 0.0, 0.0, EARTH_MU)
    np.testing.assert_allclose(position, [0.7e7, 0, 0], rtol=1e-15)
    np.testing.assert_allclose(velocity, [0, math.sqrt(EARTH_MU / 1e7 * 1.3 / 0.7), 0], rtol=1e-15)
    run(kepler.elements_to_state)(position, velocity, 1e7, 0.0, math.pi / 2, math.pi / 2, 0.0, math.pi / 2, EARTH_MU)
    np.testing.assert_allclose(position, [0, 0, 1e7], atol=1e-8)
    np.testing.assert_allclose(velocity, [0, -math.sqrt(EARTH_MU / 1e7), 0], atol=1e-11)


def test_what_is_no_orbit_is_refused(run):
    r, v = np.array([7e6, 0.0, 0.0]), np.array([0.0, 7e3, 0.0])
    for position, velocity in [(r, np.zeros(3)), (r, r), (np.zeros(3), v), (np.full(3, np.nan), v)]:
        with pytest.raises(ValueError, match="no orbital plane"):
            kepler.state_to_elements(position, velocity, EARTH_MU)
    kept = np.full(3, 9.0)
    assert run(kepler.propagate)(kept, kept, r, np.array([0.0, math.nan, 0.0]), 10.0, EARTH_MU) == 1
    np.testing.assert_array_equal(kept, 9.0)


def test_at_the_centre_there_is_no_orbit(compiled):
    kept, v = np.full(3, 9.0), np.array([0.0, 7e3, 0.0])
    assert kepler.propagate(kept, kept, np.zeros(3), v, 10.0, EARTH_MU) == 1


@pytest.mark.parametrize(("axis", "eccentricity"), CONICS)
@pytest.mark.parametrize("duration", [0.0, 3.0, -900.0, 5000.0, 30000.0])
def test_propagation_against_integration(run, validated, axis, eccentricity, duration):
    start = state(axis, eccentricity, 1.7, 0.2, 1.1, 0.4)
    r, v = propagated(run, *start, duration)
    r_peer, v_peer = integrated(*start, duration)
    scipy = other_code("scipy's DOP853")
    errors = [np.linalg.norm(a - b) / np.linalg.norm(a) for a, b in ((r, r_peer), (v, v_peer))]
    what = "Kepler orbits, circle to hyperbola: place and velocity, error relative to their size"
    validated(scipy, what, errors, 0.0, abs=1e-9)


def test_propagation_with_another_attraction_would_be_noticed(run):
    start = state(8e6, 0.1, 1.7, 0.2, 1.1, 0.4)
    r, _ = propagated(run, *start, 900.0)
    assert np.linalg.norm(r - integrated(*start, 900.0, 1.0001 * EARTH_MU)[0]) > 1e-6 * np.linalg.norm(r)


def test_a_parabola_too(run):
    position = np.array([7e6, 0.0, 1e6])
    velocity = np.array([1.0, 2.0, 0.5])
    velocity *= math.sqrt(2 * EARTH_MU / np.linalg.norm(position)) / np.linalg.norm(velocity)
    r, v = propagated(run, position, velocity, 7000.0)
    r_peer, v_peer = integrated(position, velocity, 7000.0)
    np.testing.assert_allclose(r, r_peer, rtol=1e-9)
    np.testing.assert_allclose(v, v_peer, rtol=1e-9)


def test_propagation_against_keplers_equation(run):
    axis, e, anomaly, time = 2.4e7, 0.72, 0.9, 4000.0
    n = twobody.mean_motion(axis, EARTH_MU)
    eccentric = 2 * math.atan(math.sqrt((1 - e) / (1 + e)) * math.tan(anomaly / 2))
    mean = eccentric - e * math.sin(eccentric) + n * time
    eccentric = brentq(lambda x: x - e * math.sin(x) - mean, mean - 1, mean + 1, xtol=1e-15, rtol=1e-15)
    later = 2 * math.atan(math.sqrt((1 + e) / (1 - e)) * math.tan(eccentric / 2))
    r, v = propagated(run, *state(axis, e, 0.5, 0.6, 0.7, anomaly), time)
    for value, expected in zip((r, v), state(axis, e, 0.5, 0.6, 0.7, later), strict=True):
        np.testing.assert_allclose(value, expected, rtol=1e-13)


def test_whole_periods_end_where_they_began_and_nothing_is_lost(run):
    start = state(8e6, 0.1, 1.7, 0.2, 1.1, 0.4)
    period = twobody.orbital_period(8e6, EARTH_MU)
    r, v = propagated(run, *start, 20 * period)
    np.testing.assert_allclose(r, start[0], rtol=1e-12)
    r, v = propagated(run, *start, 20.3 * period)
    assert twobody.specific_energy(r, v, EARTH_MU) == pytest.approx(
        twobody.specific_energy(*start, EARTH_MU), rel=2e-15
    )
    np.testing.assert_allclose(np.cross(r, v), np.cross(*start), rtol=5e-15)


def test_stumpff_functions_either_side_of_the_switch(run):
    for z in (-2.0, -1.0001, -0.9999, -0.3, -1e-12, 0.0, 1e-300, 1e-5, 0.9999, 1.0001, 2.0):
        c2, c3 = run(kepler.stumpff)(z)
        exact_2 = sum(Fraction(-z) ** k / math.factorial(2 * k + 2) for k in range(16))
        exact_3 = sum(Fraction(-z) ** k / math.factorial(2 * k + 3) for k in range(16))
        assert abs(Fraction(c2) / exact_2 - 1) < 1e-15
        assert abs(Fraction(c3) / exact_3 - 1) < 2e-15
    for z in (39.0, 30.0, -30.0, -400.0):
        c2, c3 = run(kepler.stumpff)(z)
        root = np.sqrt(np.longdouble(abs(z)))
        even, odd = (np.cos(root), np.sin(root)) if z > 0 else (np.cosh(root), np.sinh(root))
        assert c2 == pytest.approx(float((1 - even) / np.longdouble(z)), rel=1e-14, abs=1e-17)
        assert c3 == pytest.approx(float((root - odd) / (np.longdouble(z) * root)), rel=1e-14)
