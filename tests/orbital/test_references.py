"""The pendulum is judged by a rigid pair in Cartesian components, which knows no angle and is not linearised."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orbital import references
from orbital.constants import DAY, EARTH_EQUATORIAL_RADIUS, EARTH_MU, JULIAN_YEAR
from orbital.hill import hill_acceleration
from tests.validation import closed_form, other_code

RIGID = other_code("a rigid pair in Cartesian components by scipy's DOP853")
# Table 2 of the D-CoNe paper.
RADIUS = EARTH_EQUATORIAL_RADIUS + 800e3
N = math.sqrt(EARTH_MU / RADIUS**3)
LENGTH, CHASER, TARGET, THRUST = 12.0, 2000.0, 1000.0, 0.01
REDUCED = CHASER * TARGET / (CHASER + TARGET)
PAIR = (N, LENGTH, CHASER)


def free_acceleration(position, velocity, thrust):
    """Of the chaser relative to the target, without the line; the thrust acts backwards along-track."""
    out = np.empty(3)
    hill_acceleration(out, position, velocity, N)
    return out + np.array([0.0, -thrust / CHASER, 0.0])


def line_tension(position, velocity, thrust):
    """Tension [N] that keeps the distance as it is."""
    square = position @ position
    outward = free_acceleration(position, velocity, thrust) @ position + velocity @ velocity
    return REDUCED * outward / math.sqrt(square)


def swing(phi, thrust, duration, above=False, dense=400):
    """Angle from the vertical towards the thrust, and tension, of a rigid pair released at rest."""
    side = 1.0 if above else -1.0

    def slope(_, y):
        position, velocity = y[:3], y[3:]
        pull = line_tension(position, velocity, thrust) / REDUCED / math.sqrt(position @ position)
        return np.concatenate([velocity, free_acceleration(position, velocity, thrust) - pull * position])

    start = LENGTH * np.array([side * math.cos(phi), -math.sin(phi), 0.0])
    times = np.linspace(0.0, duration, dense)
    run = solve_ivp(
        slope, (0.0, duration), np.concatenate([start, np.zeros(3)]), "DOP853", times, rtol=1e-11, atol=1e-12
    )
    angles = np.arctan2(-run.y[1], side * run.y[0])
    tensions = np.array([line_tension(y[:3], y[3:], thrust) for y in run.y.T])
    return run.t, angles, tensions


def first_crossing(times, values):
    """First time at which the values pass through zero, by linear interpolation."""
    k = int(np.flatnonzero(np.diff(np.sign(values)))[0])
    return times[k] - values[k] * (times[k + 1] - times[k]) / (values[k + 1] - values[k])


def test_orbit_lowering_by_the_power_of_the_thrust():
    per_day = references.spiral_rate(RADIUS, -THRUST, CHASER + TARGET, EARTH_MU) * DAY
    assert per_day == pytest.approx(-554.84, rel=1e-4)
    # d/dt(-mu M/(2 a)) = F v
    power = -THRUST * math.sqrt(EARTH_MU / RADIUS)
    assert per_day / DAY * EARTH_MU * (CHASER + TARGET) / (2 * RADIUS**2) == pytest.approx(power, rel=1e-14)
    assert references.spiral_rate(RADIUS, -1.01 * THRUST, CHASER + TARGET, EARTH_MU) * DAY != pytest.approx(
        -554.84, rel=1e-4
    )


def test_800_to_200_km():
    low = RADIUS - 600e3
    delta_v = references.spiral_delta_v(RADIUS, low, EARTH_MU)
    time = references.spiral_time(RADIUS, low, THRUST, 3000.0, EARTH_MU)
    assert delta_v == pytest.approx(332.0, rel=2e-3)
    assert time / JULIAN_YEAR == pytest.approx(3.16, rel=1e-3)
    assert references.spiral_time(low, RADIUS, THRUST, 3000.0, EARTH_MU) == time
    # The rate integrated numerically.
    down = solve_ivp(
        lambda _, a: [references.spiral_rate(a[0], -THRUST, 3000.0, EARTH_MU)], (0, time), [RADIUS], rtol=1e-10
    )
    assert down.y[0, -1] == pytest.approx(low, abs=1.0)
    assert abs(references.spiral_time(RADIUS, low + 6e3, THRUST, 3000.0, EARTH_MU) / time - 1) > 5e-3


def test_propellant_spent_on_the_way_shortens_it():
    low, exhaust = RADIUS - 600e3, 15e3
    constant = references.spiral_time(RADIUS, low, THRUST, 3000.0, EARTH_MU)
    time = references.spiral_time(RADIUS, low, THRUST, 3000.0, EARTH_MU, exhaust)
    spent = THRUST * time / exhaust
    gained = exhaust * math.log(3000.0 / (3000.0 - spent))
    assert gained == pytest.approx(references.spiral_delta_v(RADIUS, low, EARTH_MU), rel=1e-12)
    assert 0.98 * constant < time < constant
    assert references.spiral_time(RADIUS, low, THRUST, 3000.0, EARTH_MU, 1e12) == pytest.approx(constant, rel=1e-8)


@pytest.mark.parametrize("above", [False, True])
@pytest.mark.parametrize("thrust", [0.0, THRUST, 0.07])
def test_equilibrium_stays_where_it_is_at_the_stated_tension(validated, thrust, above):
    phi = references.equilibrium_angle(thrust, *PAIR)
    _, angles, tensions = swing(phi, thrust, 3000.0, above)
    np.testing.assert_allclose(angles, phi, atol=1e-8)
    formula = references.equilibrium_tension(N, LENGTH, REDUCED)
    validated(RIGID, "3 n^2 l m_r: tension at rest", formula, tensions, "N", rel=1e-8)
    validated(RIGID, "F/(3 n^2 l m_c): sine of the angle at rest", math.sin(phi), np.sin(angles), abs=1e-8)
    _, angles, _ = swing(phi + 0.01, thrust, 3000.0, above)
    assert np.ptp(angles) > 5e-3, "the twin: next to it, it moves"


def test_equilibrium_numbers_of_table_2():
    assert references.equilibrium_tension(N, LENGTH, REDUCED) == pytest.approx(0.0258651, rel=2e-6)
    assert math.degrees(references.equilibrium_angle(THRUST, *PAIR)) == pytest.approx(7.40452, abs=1e-5)
    assert references.equilibrium_angle(-THRUST, *PAIR) == -references.equilibrium_angle(THRUST, *PAIR)
    assert abs(math.degrees(references.equilibrium_angle(1.01 * THRUST, *PAIR)) - 7.40452) > 0.01
    for thrust in (0.08, -0.08, math.nan):
        with pytest.raises(ValueError, match="critical"):
            references.equilibrium_angle(thrust, *PAIR)


def test_towing_along_vbar_is_stable_above_the_critical_thrust_only():
    critical = references.critical_thrust(*PAIR)
    assert critical == pytest.approx(0.077595, rel=1e-5)
    start = math.pi / 2 - 1e-3
    _, angles, _ = swing(start, 1.05 * critical, 30000.0)
    assert np.max(abs(angles - math.pi / 2)) < 1.01e-3
    _, angles, _ = swing(start, 0.95 * critical, 30000.0)
    assert np.max(abs(angles - math.pi / 2)) > 0.05


def test_growth_rate_on_vbar(validated):
    growth = references.vbar_growth_rate(THRUST, *PAIR)
    assert growth == pytest.approx(1.678e-3, rel=2e-4)
    times, angles, _ = swing(math.pi / 2 - 1e-6, THRUST, 4000.0)
    departure = math.pi / 2 - angles
    # The frame's turning does not enter a rigid pair's angle, so from rest the departure is a pure cosh.
    grown = 1e-6 * np.cosh(growth * times)
    what = "sqrt(3 n^2 - F/(m_c l)): departure from V-bar as cosh"
    validated(RIGID, what, grown, departure, "rad", rel=1e-4)
    assert abs(departure[-1] / (1e-6 * np.cosh(1.01 * growth * times[-1])) - 1) > 0.05
    assert references.vbar_growth_rate(references.critical_thrust(*PAIR) * (1 - 1e-12), *PAIR) < 1e-8
    with pytest.raises(ValueError, match="stable"):
        references.vbar_growth_rate(0.08, *PAIR)


@pytest.mark.parametrize("above", [False, True])
@pytest.mark.parametrize(("thrust", "period"), [(THRUST, 3523.75), (0.0, 3494.36)])
def test_small_libration_period(validated, thrust, period, above):
    stated = references.libration_period(thrust, *PAIR)
    assert stated == pytest.approx(period, rel=3e-6)
    phi = references.equilibrium_angle(thrust, *PAIR)
    times, angles, _ = swing(phi + 1e-4, thrust, period, above, dense=4000)
    swung = 4 * float(first_crossing(times, angles - phi))
    validated(RIGID, "2 pi/(sqrt(3) n cos phi): period of small librations", stated, swung, "s", rel=1e-4)
    assert references.libration_period(thrust, 1.01 * N, LENGTH, CHASER) != pytest.approx(stated, rel=1e-3)


def test_slack_begins_at_the_stated_amplitude():
    amplitude = references.slack_amplitude()
    assert math.degrees(amplitude) == pytest.approx(65.905, abs=1e-3)
    # A tenth of a degree either side of it. The swing lasts longer than its period, 1.3 times that of a small one.
    for change, slack in ((-0.1, False), (0.1, True)):
        _, _, tensions = swing(amplitude + math.radians(change), 0.0, 6000.0, dense=4000)
        assert (tensions.min() < 0.0) == slack


def test_tension_of_the_module_docstring_along_a_large_swing():
    for above, sign in ((False, 1.0), (True, -1.0)):
        times, angles, tensions = swing(0.9, THRUST, 4000.0, above, dense=20001)
        rate = np.gradient(angles, times, edge_order=2)
        f = THRUST / CHASER / LENGTH
        for s, agrees in ((sign, True), (-sign, False)):
            formula = (rate + s * N) ** 2 - N**2 + 3 * N**2 * np.cos(angles) ** 2 + f * np.sin(angles)
            close = np.allclose(tensions[5:-5], REDUCED * LENGTH * formula[5:-5], rtol=1e-4, atol=1e-7)
            assert close == agrees


def test_eclipse(validated):
    for beta in (0.0, 0.5, -0.9, 1.0):
        # The orbit counted point by point: in the shadow when behind the Earth and less than its radius off the axis.
        u = np.linspace(0.0, 2 * math.pi, 400001)[:-1]
        x, y, z = RADIUS * np.cos(u) * math.cos(beta), RADIUS * np.sin(u), RADIUS * np.cos(u) * math.sin(beta)
        counted = np.mean((x < 0) & (np.hypot(y, z) < EARTH_EQUATORIAL_RADIUS))
        stated = references.eclipse_fraction(RADIUS, beta, EARTH_EQUATORIAL_RADIUS)
        what = f"part of an orbit at 800 km in shadow, Sun {beta:g} rad above its plane"
        validated(other_code("the orbit counted point by point"), what, stated, counted, abs=1e-5)
        assert references.eclipse_fraction(RADIUS, beta + 0.05, EARTH_EQUATORIAL_RADIUS) != pytest.approx(
            counted, abs=1e-5
        )
    formula = closed_form("acos(sqrt(1 - (R/a)^2)/cos beta)/pi")
    longest = references.eclipse_fraction(RADIUS, 0.0, EARTH_EQUATORIAL_RADIUS)
    validated(formula, "longest part of an orbit at 800 km in shadow", longest, 0.348, rel=5e-3)
    assert references.eclipse_fraction(RADIUS, math.radians(62.70), EARTH_EQUATORIAL_RADIUS) == 0.0
    assert references.eclipse_fraction(RADIUS, math.radians(62.68), EARTH_EQUATORIAL_RADIUS) > 0.0
    assert references.eclipse_fraction(RADIUS, math.pi / 2, EARTH_EQUATORIAL_RADIUS) == 0.0
    low, high = 0.0, math.pi / 2
    while high - low > 1e-6:
        middle = 0.5 * (low + high)
        dark = references.eclipse_fraction(RADIUS, middle, EARTH_EQUATORIAL_RADIUS) > 0.0
        low, high = (middle, high) if dark else (low, middle)
    what = "height of the Sun from which no orbit at 800 km is in shadow"
    validated(closed_form("cos beta = sqrt(1 - (R/a)^2)"), what, math.degrees(low), 62.69, "deg", abs=0.01)
