import math
from decimal import Decimal, localcontext

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orbital import twobody
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from tests.validation import closed_form, other_code

RADIUS = EARTH_EQUATORIAL_RADIUS + 800e3
# Relative to the result's own length: a few roundings of 1.1e-16 each, as the docstring promises.
TOLERANCE = 1.0e-15


def decimal_difference(position, offset, mu):
    """g(r + d) - g(r) by its definition, with 60 digits."""

    def gravity(r):
        square = sum(x * x for x in r)
        return [-Decimal(mu) * x / (square * square.sqrt()) for x in r]

    r = [Decimal(x) for x in position.tolist()]
    d = [Decimal(x) for x in offset.tolist()]
    there = gravity([x + y for x, y in zip(r, d, strict=True)])
    return [a - b for a, b in zip(there, gravity(r), strict=True)]


def relative_error(value, exact):
    top = sum((Decimal(x) - y) ** 2 for x, y in zip(value.tolist(), exact, strict=True)).sqrt()
    return float(top / sum(y * y for y in exact).sqrt())


def offsets(rng):
    directions = rng.normal(size=(12, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    return [RADIUS * size * d for size in (1e-12, 1e-9, 1e-7, 1e-6, 1e-3, 0.5, 20.0) for d in directions]


def test_differential_gravity_to_the_last_digits_of_its_own_size(run, rng, validated):
    out, errors = np.empty(3), []
    with localcontext() as context:
        context.prec = 60
        for offset in offsets(rng):
            position = rng.normal(size=3)
            position *= RADIUS / np.linalg.norm(position)
            run(twobody.differential_gravity)(out, position, offset, EARTH_MU)
            exact = decimal_difference(position, offset, EARTH_MU)
            errors.append(relative_error(out, exact))
            assert relative_error(-out, exact) > 1.0, "the twin: a flipped sign"
    exactly = other_code("sixty digits by Python's decimal")
    what = "difference of gravity over 7 um to 140,000 km, error relative to its size"
    validated(exactly, what, errors, 0.0, abs=TOLERANCE)


def test_the_plain_difference_of_two_accelerations_would_not_do(rng):
    position, offset = np.array([RADIUS, 1e3, -2e3]), np.array([0.3, -0.5, 0.4])
    here, there = np.empty(3), np.empty(3)
    twobody.two_body_acceleration(here, position, EARTH_MU)
    twobody.two_body_acceleration(there, position + offset, EARTH_MU)
    with localcontext() as context:
        context.prec = 60
        assert relative_error(there - here, decimal_difference(position, offset, EARTH_MU)) > 1e-10


def test_differential_gravity_to_first_order_is_the_gravity_gradient(run):
    out = np.empty(3)
    n_squared = EARTH_MU / RADIUS**3
    for offset, factor in (([1.0, 0, 0], 2.0), ([0, 1.0, 0], -1.0), ([0, 0, 1.0], -1.0)):
        run(twobody.differential_gravity)(out, np.array([RADIUS, 0.0, 0.0]), np.array(offset), EARTH_MU)
        np.testing.assert_allclose(out, factor * n_squared * np.array(offset), atol=1e-6 * n_squared)


def test_no_offset_no_difference_and_nan_stays_visible(run):
    out = np.empty(3)
    position = np.array([RADIUS, 0.0, 0.0])
    run(twobody.differential_gravity)(out, position, np.zeros(3), EARTH_MU)
    np.testing.assert_array_equal(out, 0.0)
    run(twobody.differential_gravity)(out, position, np.array([0.0, math.nan, 0.0]), EARTH_MU)
    assert np.isnan(out).all()


def test_acceleration(run):
    out = np.empty(3)
    run(twobody.two_body_acceleration)(out, np.array([3.0, 0.0, -4.0]), 125.0)
    np.testing.assert_allclose(out, [-3.0, 0.0, 4.0], rtol=1e-15)


def test_there_is_no_acceleration_at_the_centre(compiled):
    out = np.empty(3)
    twobody.two_body_acceleration(out, np.zeros(3), 1.0)
    assert np.isnan(out).all()


def test_acceleration_is_minus_the_gradient_of_the_energy(run, rng):
    r, out = RADIUS * np.array([0.6, -0.5, 0.7]), np.empty(3)
    run(twobody.two_body_acceleration)(out, r, EARTH_MU)
    h = 10.0
    for axis in range(3):
        step = h * np.eye(3)[axis]
        slope = (
            twobody.specific_energy(r + step, np.zeros(3), EARTH_MU)
            - twobody.specific_energy(r - step, np.zeros(3), EARTH_MU)
        ) / (2 * h)
        assert out[axis] == pytest.approx(-slope, rel=1e-8)
        assert out[axis] != pytest.approx(-1.01 * slope, rel=1e-8)


def test_energy_axis_and_period_belong_to_the_same_orbit(run):
    position, velocity = np.array([RADIUS, 0.0, 0.0]), np.array([500.0, 7600.0, 900.0])
    a = run(twobody.semi_major_axis)(position, velocity, EARTH_MU)
    assert run(twobody.specific_energy)(position, velocity, EARTH_MU) == pytest.approx(-EARTH_MU / (2 * a), rel=1e-14)
    period = run(twobody.orbital_period)(a, EARTH_MU)

    def rate(_, y):
        out = np.empty(3)
        twobody.two_body_acceleration(out, y[:3], EARTH_MU)
        return np.concatenate([y[3:], out])

    start = np.concatenate([position, velocity])
    for factor, closed in ((1.0, True), (1.01, False)):
        end = solve_ivp(rate, (0.0, factor * period), start, method="DOP853", rtol=1e-12, atol=1e-6).y[:, -1]
        assert (np.linalg.norm(end[:3] - position) < 0.01) == closed


def test_numbers_of_the_table_2_orbit(run, validated):
    rate = run(twobody.mean_motion)(RADIUS, EARTH_MU)
    validated(closed_form("sqrt(mu/a^3)"), "Table 2: mean motion", rate, 1.0381289e-3, "rad/s", rel=5e-8)
    assert run(twobody.mean_motion)(RADIUS * 1.01, EARTH_MU) != pytest.approx(1.0381289e-3, rel=5e-8)
    v = run(twobody.circular_speed)(RADIUS, EARTH_MU)
    assert v == pytest.approx(RADIUS * run(twobody.mean_motion)(RADIUS, EARTH_MU), rel=1e-15)
    assert run(twobody.semi_major_axis)(np.array([0, RADIUS, 0]), np.array([0, 0, v]), EARTH_MU) == pytest.approx(
        RADIUS
    )
