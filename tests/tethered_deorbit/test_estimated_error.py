"""The error that a scheme estimates of a step, against the true one and other implementations; the next step."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import DOP853, Radau

from fmu_src.integrators import radau
from orbital.kernel import kernel
from tests.plain import plain
from tests.tethered_deorbit.single_steps import (
    SCHEMES,
    SIZE,
    START,
    TIGHT,
    each,
    exact,
    kepler,
    oscillator,
    slope,
    squared,
    steps_of,
    strict,
    uncompiled,
)
from tests.validation import Validated, other_code

__all__ = ["plain"]


@uncompiled
def test_step_control() -> None:
    """Steps after a success and after a rejection, for estimates of eighth and of fourth order."""
    eighth, fourth = SCHEMES["dop853"].make(kepler, squared, SIZE), SCHEMES["radau"].make(kepler, squared, SIZE)
    for scheme, k in ((eighth, 8), (fourth, 4)):
        assert scheme.next_step(1.0, 0.9**k, 0.9**k) == pytest.approx(0.9 * 0.9 ** (-0.5))
        assert scheme.next_step(1.0, 0.0, 1.0) == 5.0
        assert scheme.next_step(1.0, 0.9**k, 0.9**k) != pytest.approx(0.9 * 0.9 ** (-0.5 * k / (k - 1)))
        assert scheme.shorter_step(1.0, 2.0**k) == pytest.approx(0.45)
        assert scheme.shorter_step(1.0, 2.0 ** (k - 1)) != pytest.approx(0.45)
        assert scheme.shorter_step(1.0, math.nan) == scheme.shorter_step(1.0, math.inf) == 0.2
    steady = SCHEMES["gauss"].make(kepler, squared, SIZE)
    assert steady.next_step(1.0, 0.9**8, 0.9**8) == steady.next_step(1.0, 1.0, 1.0) == 1.0
    assert steady.next_step(1.0, 1e-4, 1e-4) == eighth.next_step(1.0, 1e-4, 1e-4) > 1.5


@each
@uncompiled
def test_estimated_error(name: str) -> None:
    """It falls with its power of the step, and covers the error on the orbit and the oscillator, within bounds."""
    said = SCHEMES[name]
    scheme = said.make(kepler, strict, SIZE)
    steps, errors = (0.4, 0.3, 0.2), []
    for step in steps:
        _, end, stages = steps_of(kepler, scheme, START, step)
        errors.append(scheme.error(np.zeros(1), end, step, stages, np.zeros(SIZE), np.zeros(SIZE)) / TIGHT)
        assert np.linalg.norm(end - exact(step)) < errors[-1]
    assert slope(steps, errors) == pytest.approx(said.estimate, abs=0.3)
    small = said.make(oscillator, strict, 2)
    for step in (0.3, 0.6, 1.0):
        _, end, stages = steps_of(oscillator, small, np.array([0.0, 1.0]), step)
        error = small.error(np.zeros(1), end, step, stages, np.zeros(2), np.zeros(2)) / TIGHT
        assert math.dist(end, (math.sin(step), math.cos(step))) < error < step**said.estimate


@uncompiled
def test_size_of_the_estimated_error(validated: Validated) -> None:
    """That of another implementation of the scheme, which takes the mean over the components where `squared` sums."""
    scheme, low, high = SCHEMES["dop853"].make(kepler, squared, SIZE), np.zeros(SIZE), np.zeros(SIZE)
    peer = DOP853(lambda _, state: state, 0.0, START, 1.0)
    for step in (0.4, 0.2):
        _, end, stages = steps_of(kepler, scheme, START, step)
        error = scheme.error(np.zeros(1), end, step, stages, low, high)
        rows = stages[: 13 * SIZE].reshape(-1, SIZE)
        expected = math.sqrt(SIZE) * peer._estimate_error_norm(rows, step, np.ones(SIZE))
        validated(other_code("scipy's DOP853"), "dop853: estimated error of one step", error, expected, rel=1e-9)


def divided(nodes: Any, values: Any) -> Any:
    """Divided difference over all nodes, by recursion."""
    if len(nodes) == 1:
        return values[0]
    return (divided(nodes[1:], values[1:]) - divided(nodes[:-1], values[:-1])) / (nodes[-1] - nodes[0])


@uncompiled
def test_size_of_the_estimated_error_of_gauss() -> None:
    """h |e5|^2/sqrt(|e5|^2 + 0.01 |e3|^2), the differences formed anew."""
    scheme, step = SCHEMES["gauss"].make(kepler, squared, SIZE), 0.4
    _, end, stages = steps_of(kepler, scheme, START, step)
    rates, nodes = stages[: 10 * SIZE].reshape(-1, SIZE), 0.5 + 0.5 * np.polynomial.legendre.leggauss(4)[0]
    fifth = np.linalg.norm(divided(np.linspace(0.0, 1.0, 6), rates[[0, 6, 7, 8, 9, 5]]) / 384.0)
    third = np.linalg.norm(divided(nodes, rates[1:5]) / 32.0)
    error = scheme.error(np.zeros(1), end, step, stages, np.zeros(SIZE), np.zeros(SIZE))
    assert error == pytest.approx(step * fifth**2 / math.hypot(fifth, 0.1 * third), rel=1e-8)


@uncompiled
def test_radau_is_that_of_another_implementation(validated: Validated) -> None:
    """State after one step and its estimated error, of scipy's Radau with the same step, on the orbit."""

    def rates(_: float, state: Any) -> Any:
        return np.concatenate([state[3:], -state[:3] / np.linalg.norm(state[:3]) ** 3])

    for step in (0.01, 0.05):
        peer = Radau(rates, 0.0, START, 1.0, rtol=1e3, atol=1e3, first_step=step)
        peer.newton_tol = 1e-16
        peer.step()
        scheme = SCHEMES["radau"].make(kepler, strict, SIZE)
        _, end, stages = steps_of(kepler, scheme, START, peer.t)
        assert peer.t == step
        validated(other_code("scipy's Radau"), "radau: state after one step on an orbit", end, peer.y, abs=1e-13)
        stages[-1] = 0.0
        squared_scheme = SCHEMES["radau"].make(kepler, squared, SIZE)
        error = squared_scheme.error(np.zeros(1), end, step, stages, np.zeros(SIZE), np.zeros(SIZE))
        z = stages[2 * SIZE : 5 * SIZE].reshape(3, SIZE)
        jacobian = np.array([(rates(0.0, START + d) - rates(0.0, START - d)) / 2e-6 for d in 1e-6 * np.eye(6)]).T
        right = rates(0.0, START) + radau._E @ z / step
        expected = np.linalg.norm(np.linalg.solve(radau.REAL / step * np.eye(6) - jacobian, right))
        assert error == pytest.approx(expected, rel=1e-3)


@uncompiled
def test_what_is_stiff_is_filtered_out_of_the_estimate() -> None:
    """Above 1 the estimate is formed once more, with f where the first says that the state was to begin."""
    zeta, step, start = 50.0, 0.5, np.array([0.0, 1.0])
    system, unit = np.array([[0.0, 1.0], [-1.0, -2.0 * zeta]]), np.eye(2)

    def estimate(factor: float) -> float:
        @kernel
        def scaled(context: Any, state: Any, error: Any) -> float:
            return float(squared(context, state, error) * factor * factor)

        scheme = SCHEMES["radau"].make(oscillator, scaled, 2)
        _, end, stages = steps_of(oscillator, scheme, start, step, context=np.array([zeta]))
        return float(scheme.error(np.array([zeta]), end, step, stages, np.zeros(2), np.zeros(2)) / factor)

    found = np.linalg.solve(np.kron(np.eye(3), unit) - step * np.kron(radau._A.reshape(3, 3), system),
                            step * np.kron(radau._CF, system @ start))  # fmt: skip
    drawn = radau._E @ found.reshape(3, 2) / step
    once = np.linalg.solve(radau.REAL / step * unit - system, system @ start + drawn)
    twice = np.linalg.solve(radau.REAL / step * unit - system, system @ (start + once) + drawn)
    assert np.linalg.norm(twice) < 0.3 * np.linalg.norm(once)
    assert estimate(0.9 / np.linalg.norm(once)) == pytest.approx(np.linalg.norm(once), rel=1e-3)
    assert estimate(1.1 / np.linalg.norm(once)) == pytest.approx(np.linalg.norm(twice), rel=1e-3)
