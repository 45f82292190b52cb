"""The scheme itself, on a Kepler orbit and an oscillator: order, dense output, edges of stability, step control."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import DOP853

from fmu_src import integrators
from fmu_src.instance import Instance
from fmu_src.integrators import DOP853_DENSE_ROWS, DOP853_ROWS, DOP853_STAGES, AdaptiveScheme, make_dop853
from fmu_src.tethered_deorbit.interface import MODEL
from orbital.kepler import propagate
from orbital.kernel import kernel
from orbital.twobody import two_body_acceleration

SIZE = 6


@kernel
def kepler(context: Any, state: Any, rate: Any, elapsed: float) -> None:
    two_body_acceleration(rate[3:6], state[0:3], 1.0)
    for i in range(3):
        rate[i] = state[3 + i]


@kernel
def oscillator(context: Any, state: Any, rate: Any, elapsed: float) -> None:
    """Frequency 1, damping ratio from the context."""
    rate[0] = state[1]
    rate[1] = -state[0] - 2.0 * context[0] * state[1]


@kernel
def squared(context: Any, state: Any, error: Any) -> float:
    total = 0.0
    for i in range(len(error)):
        total += error[i] * error[i]
    return total


def fixed_steps(derivative: Callable[..., Any], scheme: AdaptiveScheme, start: Any, step: float, count: int) -> Any:
    """State after `count` steps, and the memory of the last one."""
    state, end = start.copy(), start.copy()
    stages = np.zeros(DOP853_ROWS * len(start))
    for _ in range(count):
        state = end.copy()
        derivative(np.zeros(1), state, stages[: len(start)], 0.0)
        scheme.attempt(np.zeros(1), state, step, stages, end)
    return state, end, stages


START = np.array([0.95, 0.0, 0.0, 0.0, math.sqrt(1.05 / 0.95), 0.0])
"""Perigee of an ellipse with semi-major axis 1 and eccentricity 0.05."""


def exact(time: float) -> Any:
    out = np.zeros(6)
    propagate(out[:3], out[3:], START[:3], START[3:], time, 1.0)
    return out


@pytest.fixture(scope="module")
def scheme() -> AdaptiveScheme:
    return make_dop853(kepler, squared, SIZE)


def slope(steps: list[float], errors: list[float]) -> float:
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])


def test_order_eight(scheme: AdaptiveScheme) -> None:
    counts = [32, 38, 46, 56]
    ends = [fixed_steps(kepler, scheme, START, math.tau / n, n)[1] for n in counts]
    errors = [float(np.linalg.norm(end - exact(math.tau))) for end in ends]
    assert slope([math.tau / n for n in counts], errors) == pytest.approx(8.0, abs=0.1)


@pytest.mark.parametrize(("name", "row"), [("_A", 12), ("_A", 7), ("_D", 0)])
def test_order_notices_one_wrong_coefficient(monkeypatch: pytest.MonkeyPatch, name: str, row: int) -> None:
    """Twin of the two tests of order: a weight off by 1 % in the result, in a stage, in the dense output."""
    wrong = getattr(integrators, name).copy()
    wrong[row * DOP853_ROWS + 6] *= 1.01
    monkeypatch.setattr(integrators, name, wrong)
    spoilt = make_dop853(kepler, squared, SIZE)
    steps = [0.5, 0.4, 0.32, 0.25]
    whole, within = [], []
    for step in steps:
        state, end, stages = fixed_steps(kepler, spoilt, START, step, 1)
        whole.append(float(np.linalg.norm(end - exact(step))))
        dense, out = np.zeros(DOP853_DENSE_ROWS * SIZE), np.zeros(SIZE)
        spoilt.prepare_dense(np.zeros(1), state, end, step, stages, dense, np.zeros(SIZE))
        spoilt.dense_value(state, dense, 0.4, 0, SIZE, out)
        within.append(float(np.linalg.norm(out - exact(0.4 * step))))
    assert slope(steps, within) < 7.0
    assert (slope(steps, whole) < 7.0) == (name == "_A")


def test_dense_output_order(scheme: AdaptiveScheme) -> None:
    """Order 7: the largest error within one step falls with its eighth power, that of the rate with the seventh."""
    steps, errors, rates = [0.5, 0.4, 0.32, 0.25], [], []
    for step in steps:
        state, end, stages = fixed_steps(kepler, scheme, START, step, 1)
        dense, out, rate = np.zeros(DOP853_DENSE_ROWS * SIZE), np.zeros(SIZE), np.zeros(SIZE)
        scheme.prepare_dense(np.zeros(1), state, end, step, stages, dense, np.zeros(SIZE))
        worst, worst_rate = 0.0, 0.0
        for fraction in np.linspace(0.0, 1.0, 41):
            scheme.dense_value(state, dense, fraction, 0, SIZE, out)
            worst = max(worst, float(np.linalg.norm(out - exact(fraction * step))))
            scheme.dense_rate(dense, fraction, step, 0, SIZE, rate)
            worst_rate = max(worst_rate, float(np.linalg.norm(rate[:3] - exact(fraction * step)[3:])))
        assert out == pytest.approx(end, abs=1e-15)
        errors.append(worst)
        rates.append(worst_rate)
    assert slope(steps, errors) == pytest.approx(8.0, abs=0.1)
    assert slope(steps, rates) == pytest.approx(7.0, abs=0.1)


@kernel
def drive(context: Any, state: Any, rate: Any, elapsed: float) -> None:
    """x' = y, y' = cos t, the time of a step's begin in the context: the time of each stage counts."""
    rate[0] = state[1]
    rate[1] = math.cos(context[0] + context[1] * elapsed)


def test_order_with_time_in_the_equations() -> None:
    """Result and dense output keep a high order, about 8; with stage times 1 % off it falls to 2."""
    moving = make_dop853(drive, squared, 2)
    for factor, order in ((1.0, True), (1.01, False)):
        steps, errors, within = [2.0, 1.6, 1.3, 1.0], [], []
        for step in steps:
            context, start, end = np.array([0.3, factor]), np.array([-math.cos(0.3), math.sin(0.3)]), np.zeros(2)
            stages, dense, out = np.zeros(DOP853_ROWS * 2), np.zeros(DOP853_DENSE_ROWS * 2), np.zeros(2)
            drive(context, start, stages[:2], 0.0)
            moving.attempt(context, start, step, stages, end)
            errors.append(abs(end[1] - math.sin(0.3 + step)))
            moving.prepare_dense(context, start, end, step, stages, dense, np.zeros(2))
            moving.dense_value(start, dense, 0.4, 0, 2, out)
            within.append(abs(out[1] - math.sin(0.3 + 0.4 * step)))
        assert (slope(steps, errors) > 7.0) == order
        assert (slope(steps, within) > 7.0) == order


def test_edges_of_stability() -> None:
    """h |lambda| = 5.97 on the imaginary axis, 6.4 on the real one; the decay below it is the one stated."""
    small = make_dop853(oscillator, squared, 2)

    def growth(step: float, zeta: float) -> float:
        columns = []
        for start in np.eye(2):
            end, stages = np.zeros(2), np.zeros(DOP853_ROWS * 2)
            oscillator(np.array([zeta]), start, stages[:2], 0.0)
            small.attempt(np.array([zeta]), start, step, stages, end)
            columns.append(end.copy())
        return float(abs(np.linalg.eigvals(np.array(columns).T)).max())

    assert growth(5.96, 0.0) < 1.0 < growth(5.98, 0.0)
    assert 1.0 - growth(2.0, 0.0) == pytest.approx(2.7e-5, rel=0.02)
    assert 1.0 - growth(2.02, 0.0) != pytest.approx(2.7e-5, rel=0.02)
    assert 1.0 - growth(1.0, 0.0) == pytest.approx(2.4e-8, rel=0.02)
    assert growth(6.38, 1.0) < 1.0 < growth(6.42, 1.0)


def test_step_control(scheme: AdaptiveScheme) -> None:
    assert scheme.next_step(1.0, 0.9**8, 0.9**8) == pytest.approx(0.9 * 0.9 ** (-0.5))
    assert scheme.next_step(1.0, 0.0, 1.0) == 5.0
    assert scheme.next_step(1.0, 0.9**8, 0.9**8) != pytest.approx(0.9 * 0.9 ** (-4 / 7))  # a scheme of order 7
    assert scheme.shorter_step(1.0, 2.0**8) == pytest.approx(0.45)
    assert scheme.shorter_step(1.0, 2.0**7) != pytest.approx(0.45)
    assert scheme.shorter_step(1.0, math.nan) == 0.2
    stages = np.zeros(DOP853_ROWS * SIZE)
    kepler(np.zeros(1), START, stages[:SIZE], 0.0)
    end, low, high = np.zeros(SIZE), np.zeros(SIZE), np.zeros(SIZE)
    steps, errors = [0.4, 0.3, 0.2], []
    for step in steps:
        scheme.attempt(np.zeros(1), START, step, stages, end)
        errors.append(scheme.error(np.zeros(1), end, step, stages, low, high))
    assert slope(steps, errors) == pytest.approx(8.0, abs=0.3)
    assert DOP853_STAGES == 12


def test_size_of_the_estimated_error(scheme: AdaptiveScheme) -> None:
    """That of another implementation of the scheme, which takes the mean over the components where `squared` sums."""
    peer = DOP853(lambda _, state: state, 0.0, START, 1.0)
    stages, end = np.zeros(DOP853_ROWS * SIZE), np.zeros(SIZE)
    kepler(np.zeros(1), START, stages[:SIZE], 0.0)
    for step in (0.4, 0.2):
        scheme.attempt(np.zeros(1), START, step, stages, end)
        error = scheme.error(np.zeros(1), end, step, stages, np.zeros(SIZE), np.zeros(SIZE))
        rows = stages[: (DOP853_STAGES + 1) * SIZE].reshape(-1, SIZE)
        assert error == pytest.approx(
            math.sqrt(SIZE) * peer._estimate_error_norm(rows, step, np.ones(SIZE)), rel=1e-9, abs=0.0
        )


def test_tolerances_rule_the_error() -> None:
    """A hundred times the tolerance costs accuracy, and saves steps; each of the three has its own say."""

    def tug(**tolerances: float) -> tuple[float, float, int]:
        terms = {"reel": "locked", "thrust": "along_track"}
        i = Instance(MODEL, terms, {f"solver.tolerance_{k}": v for k, v in tolerances.items()}).initialise()
        i.step(3217.0)
        return i["tug[1].time"], i["tug[1].peak"], int(i["solver.steps"])

    reference = (3215.6134167570826, 7.4542333983073155)  # table2_reference.json, case B
    good = tug()
    coarse = tug(orbit=1.0, separation=1e-5, stretch=1e-6)
    assert abs(good[0] - reference[0]) < 1e-6 < abs(coarse[0] - reference[0])
    assert abs(good[1] / reference[1] - 1.0) < 1e-8 < abs(coarse[1] / reference[1] - 1.0)
    assert coarse[2] < tug(separation=1e-5, orbit=1.0)[2] <= good[2] < tug(stretch=1e-13)[2]
