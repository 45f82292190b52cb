import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orbital import oscillators
from tests.validation import closed_form, other_code

SCIPY = other_code("mass and spring by scipy's DOP853")
# The tether of Table 2, and 1 m threads of Table 1: aramid of 0.275 g/m, EA = 13.74 kN, two threads' mass to a node.
STIFFNESS, MASS, SPEED = 3926.9908169872415, 2000.0 / 3.0, 1.969680e-3
THREAD_STIFFNESS, NODE_MASS = 13740.0, 2 * 0.275e-3


def snap(zeta, preload=0.0):
    """Peak tension, duration and speed of return of a mass on the line, integrated until the tension is gone."""
    damping = 2 * zeta * math.sqrt(STIFFNESS * MASS)

    def tension(_, y):
        return STIFFNESS * y[0] + damping * y[1]

    def gone(t, y):
        return tension(t, y) if t > 1e-3 else 1.0

    gone.terminal, gone.direction = True, -1
    end = 10 * math.pi * math.sqrt(MASS / STIFFNESS)
    run = solve_ivp(
        lambda t, y: [y[1], (preload - tension(t, y)) / MASS],
        (0.0, end),
        [0.0, SPEED],
        "DOP853",
        events=gone,
        rtol=1e-11,
        atol=1e-14,
        max_step=2e-3,
    )
    return max(tension(0, y) for y in run.y.T), run.t[-1], run.y[1, -1]


def test_numbers_of_table_2(validated):
    stiffness = oscillators.line_stiffness(60e9, 1e-3, 12.0)
    validated(closed_form("E pi d^2/(4 l)"), "Table 2: stiffness of the line", stiffness, 3926.99, "N/m", rel=1e-6)
    assert oscillators.dashpot(0.05, 3926.99, 666.667) == pytest.approx(161.803, rel=1e-5)  # 0.1 sqrt(2,618,000)
    reduced = oscillators.reduced_mass(2000.0, 1000.0)
    validated(closed_form("m_c m_t/(m_c + m_t)"), "Table 2: reduced mass", reduced, 666.667, "kg", rel=1e-6)
    period = 2 * math.pi / oscillators.natural_frequency(STIFFNESS, MASS)
    validated(closed_form("2 pi sqrt(m_r/k)"), "Table 2: period of the taut line", period, 2.589, "s", abs=5e-4)
    assert 2 * math.pi / oscillators.natural_frequency(1.01 * STIFFNESS, MASS) != pytest.approx(2.589, abs=5e-4)


@pytest.mark.parametrize("preload", [0.0, 0.5, 20.0])
def test_undamped_peak(validated, preload):
    peak, _, _ = snap(0.0, preload)
    stated = oscillators.snap_peak(SPEED, STIFFNESS, MASS, preload)
    validated(SCIPY, "P + sqrt(P^2 + k m_r v^2): peak of an undamped snap", stated, peak, "N", rel=1e-5)
    assert oscillators.snap_peak(1.01 * SPEED, STIFFNESS, MASS, 1.01 * preload) != pytest.approx(peak, rel=5e-3)


@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.2, 0.49, 0.5, 0.8])
def test_damped_snap(validated, zeta):
    peak, duration, speed = snap(zeta)
    stated = oscillators.damped_snap_peak(SPEED, STIFFNESS, MASS, zeta)
    validated(SCIPY, "formula of a damped snap: peak", stated, peak, "N", rel=1e-5)
    assert oscillators.damped_snap_peak(SPEED, STIFFNESS, 1.02 * MASS, zeta) != pytest.approx(peak, rel=5e-3)
    lasting = oscillators.snap_duration(STIFFNESS, MASS, zeta)
    validated(SCIPY, "formula of a damped snap: duration", lasting, duration, "s", rel=1e-8)
    restitution = oscillators.snap_restitution(zeta)
    validated(SCIPY, "formula of a damped snap: restitution", restitution, -speed / SPEED, rel=1e-7)
    assert oscillators.snap_restitution(zeta + 0.01) != pytest.approx(-speed / SPEED, rel=5e-3)


def test_peak_joins_its_two_branches_and_the_undamped_one():
    below, above = (oscillators.damped_snap_peak(SPEED, STIFFNESS, MASS, 0.5 + step) for step in (-1e-9, 1e-9))
    assert below == pytest.approx(above, rel=1e-8)
    assert oscillators.damped_snap_peak(SPEED, STIFFNESS, MASS, 0.0) == oscillators.snap_peak(SPEED, STIFFNESS, MASS)
    assert oscillators.damped_snap_peak(SPEED, STIFFNESS, MASS, 2.0) == pytest.approx(
        2 * 2.0 * math.sqrt(STIFFNESS * MASS) * SPEED
    )


def test_frequency_and_decrement_of_a_damped_oscillation(validated):
    damping = 0.2 * 2 * math.sqrt(STIFFNESS * MASS)
    zeta = oscillators.damping_ratio(damping, STIFFNESS, MASS)
    assert zeta == pytest.approx(0.2, rel=1e-15)
    # The eigenvalue of the oscillation holds both.
    value = np.linalg.eigvals([[0.0, 1.0], [-STIFFNESS / MASS, -damping / MASS]])[0]
    omega = oscillators.damped_frequency(STIFFNESS, MASS, damping)
    eigenvalue = other_code("eigenvalue of the oscillation's matrix by numpy")
    validated(eigenvalue, "frequency of a damped oscillation", omega, abs(value.imag), "rad/s", rel=1e-14)
    assert omega != pytest.approx(oscillators.natural_frequency(STIFFNESS, MASS), rel=5e-3)
    decrement = -value.real * 2 * math.pi / abs(value.imag)
    found = oscillators.logarithmic_decrement(zeta)
    validated(eigenvalue, "logarithmic decrement of a damped oscillation", found, decrement, rel=1e-14)
    assert oscillators.logarithmic_decrement(1.01 * zeta) != pytest.approx(decrement, rel=5e-3)


@pytest.mark.parametrize("zeta", [-0.1, 1.0, math.nan, math.inf])
def test_what_does_not_oscillate_is_refused(zeta):
    for formula in (
        lambda: oscillators.logarithmic_decrement(zeta),
        lambda: oscillators.snap_restitution(zeta),
        lambda: oscillators.snap_duration(STIFFNESS, MASS, zeta),
        lambda: oscillators.damped_frequency(STIFFNESS, MASS, zeta * 2 * math.sqrt(STIFFNESS * MASS)),
    ):
        with pytest.raises(ValueError, match="damping ratio"):
            formula()
    if not zeta >= 0.0:
        with pytest.raises(ValueError, match="damping ratio"):
            oscillators.damped_snap_peak(SPEED, STIFFNESS, MASS, zeta)


def grown(step, damping):
    """Whether a square net whose threads all lie along one line, the stiffest it can be, diverges within 4000 steps."""
    rng = np.random.default_rng(1)
    x = rng.normal(size=(6, 6)) * 1e-6
    v = before = np.zeros_like(x)

    def stretch(a):
        return sum(np.roll(a, shift, axis) - a for shift in (1, -1) for axis in (0, 1))

    for _ in range(4000):
        predicted = v + 0.5 * (v - before)
        before = v
        v = v + step / NODE_MASS * (THREAD_STIFFNESS * stretch(x) + damping * stretch(predicted))
        x = x + step * v
        if np.max(abs(x)) > 1.0:
            return True
    return False


def net_limit(damping):
    """The limit for that net: its eigenvalues reach 8 k/m and 8 d/m."""
    return oscillators.explicit_step_limit(8.0 * THREAD_STIFFNESS / NODE_MASS, 8.0 * damping / NODE_MASS)


@pytest.mark.parametrize(("ratio", "limit"), [(0.0, 1.414e-4), (0.106, 8.01e-5), (1.0, 1.241e-5)])
def test_step_limit_of_table_1_is_the_edge_of_stability(ratio, limit):
    damping = 2 * ratio * math.sqrt(THREAD_STIFFNESS * NODE_MASS)
    stated = net_limit(damping)
    assert stated == pytest.approx(limit, rel=2e-3)
    assert not grown(0.99 * stated, damping)
    assert grown(1.01 * stated, damping)


def test_step_limit_in_units_of_the_thread(validated):
    unit = math.sqrt(NODE_MASS / THREAD_STIFFNESS)
    # h w (h w + 8 z) = 4 with w = sqrt(8), z = zeta sqrt(8)
    for zeta, limit in ((0.0, 0.7071), (0.05, 0.5345)):
        damping = 2 * zeta * math.sqrt(THREAD_STIFFNESS * NODE_MASS)
        what = f"longest stable substep of a net over sqrt(m/k), damping ratio {zeta:g}"
        validated(closed_form("h w (h w + 8 z) = 4"), what, net_limit(damping) / unit, limit, abs=5e-4)
    # Heavy damping: the limit falls as 1/z, where sqrt(1 + z^2) - z would have lost every digit.
    heavy = 1e10 * math.sqrt(THREAD_STIFFNESS * NODE_MASS)
    assert net_limit(heavy) == pytest.approx(NODE_MASS / (8.0 * heavy), rel=1e-12, abs=0.0)
