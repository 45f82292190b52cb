"""Every scheme by itself, on a Kepler orbit and an oscillator: order, dense output, stability, coefficients."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm

from fmu_src.instance import Instance
from fmu_src.integrators import collocation, elimination, gauss, radau
from fmu_src.tethered_deorbit.interface import MODEL
from orbital.kernel import kernel
from tests.plain import plain
from tests.tethered_deorbit.single_steps import (
    SCHEMES,
    SIZE,
    START,
    Said,
    drive,
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
from tests.validation import Validated, closed_form

__all__ = ["plain"]


def after_a_revolution(said: Said) -> float:
    """Slope of the error after one revolution."""
    scheme = said.make(kepler, strict, SIZE)
    steps = [math.tau / n for n in said.counts]
    ends = [steps_of(kepler, scheme, START, step, n)[1] for step, n in zip(steps, said.counts, strict=True)]
    return slope(steps, [float(np.linalg.norm(end - exact(math.tau))) for end in ends])


def within_a_step(said: Said) -> tuple[float, float, float]:
    """Slopes of the largest error in one step, of that of the rate in it, and of the error at its end."""
    scheme = said.make(kepler, strict, SIZE)
    errors, rates, ends = [], [], []
    for step in said.near:
        state, end, stages = steps_of(kepler, scheme, START, step)
        dense, out, rate = np.zeros(scheme.dense), np.zeros(SIZE), np.zeros(SIZE)
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
        ends.append(float(np.linalg.norm(end - exact(step))))
    return slope(said.near, errors), slope(said.near, rates), slope(said.near, ends)


@each
@uncompiled
def test_order(validated: Validated, name: str) -> None:
    said, orbit = SCHEMES[name], closed_form("Kepler's ellipse after a revolution")
    validated(orbit, f"{name}: order of the error", after_a_revolution(said), said.order, abs=0.1)


@each
@uncompiled
def test_dense_output_order(name: str) -> None:
    """The largest error within one step falls with a power one above the order, that of the rate with the order."""
    said = SCHEMES[name]
    value, rate, _ = within_a_step(said)
    # that of gauss is so good that the error of the step itself, one order higher, is the largest in it
    assert value == pytest.approx(said.dense + (2 if name == "gauss" else 1), abs=0.1)
    assert rate >= said.dense - 0.1


def spoilt(monkeypatch: pytest.MonkeyPatch, said: Said, place: tuple[str, int]) -> None:
    """One coefficient of a scheme off by 1 %."""
    name, index = place
    wrong = getattr(said.module, name)
    if index < 0:
        wrong *= 1.01
    else:
        wrong = wrong.copy()
        wrong[index] *= 1.01
    monkeypatch.setattr(said.module, name, wrong)


@pytest.mark.parametrize(
    ("name", "place"), [(name, place) for name, said in SCHEMES.items() for place in said.spoil], ids=str
)
@uncompiled
def test_order_notices_one_wrong_coefficient(
    monkeypatch: pytest.MonkeyPatch, name: str, place: tuple[str, int]
) -> None:
    """Twin of the two tests of order: a weight off by 1 % in the result, in a stage."""
    said = SCHEMES[name]
    spoilt(monkeypatch, said, place)
    value, _, end = within_a_step(said)
    assert end < said.order
    assert value < said.dense


@pytest.mark.parametrize(
    ("name", "place"), [(name, place) for name, said in SCHEMES.items() for place in said.spoil_dense], ids=str
)
@uncompiled
def test_dense_output_notices_one_wrong_coefficient(
    monkeypatch: pytest.MonkeyPatch, name: str, place: tuple[str, int]
) -> None:
    """Twin: the dense output loses its order, and the result keeps its own."""
    said = SCHEMES[name]
    spoilt(monkeypatch, said, place)
    value, _, end = within_a_step(said)
    assert value < said.dense
    assert end > said.order + 0.5


@each
@uncompiled
def test_order_with_time_in_the_equations(name: str) -> None:
    """Result and dense output keep their order; with stage times 1 % off it falls to 2."""
    said = SCHEMES[name]
    moving = said.make(drive, strict, 2)
    steps = (2.0, 1.6, 1.3, 1.0) if said.order > 5 else (0.8, 0.6, 0.4, 0.3)
    for factor, order in ((1.0, True), (1.01, False)):
        errors, within = [], []
        for step in steps:
            context, start = np.array([0.3, factor]), np.array([-math.cos(0.3), math.sin(0.3)])
            _, end, stages = steps_of(drive, moving, start, step, context=context)
            dense, out = np.zeros(moving.dense), np.zeros(2)
            errors.append(abs(end[1] - math.sin(0.3 + step)))
            moving.prepare_dense(context, start, end, step, stages, dense, np.zeros(2))
            moving.dense_value(start, dense, 0.4, 0, 2, out)
            within.append(abs(out[1] - math.sin(0.3 + 0.4 * step)))
        assert (slope(steps, errors) > said.order - 1.0) == order
        assert (slope(steps, within) > said.dense - 0.2) == order


@each
@uncompiled
def test_counted_components_are_integrals(name: str) -> None:
    """The equations do not depend on them; they come out as if they had been integrated with the others."""
    said = SCHEMES[name]

    @kernel
    def with_area(context: Any, state: Any, rate: Any, elapsed: float) -> None:
        """And the area swept out, dA/dt = (x y' - y x')/2."""
        kepler(context, state, rate, elapsed)
        rate[6] = 0.5 * (state[0] * state[4] - state[1] * state[3]) * context[0]

    @kernel
    def of_six(context: Any, state: Any, error: Any) -> float:
        return float(strict(context, state, error[0:6]))

    ends = []
    for size, counted in ((6, 1), (7, 0)):
        scheme = said.make(with_area, of_six, size, counted)
        start, context = np.append(START, 0.3), np.ones(1)
        state, end, stages = steps_of(with_area, scheme, start, 0.05, context=context)
        dense, out = np.zeros(scheme.dense), np.zeros(7)
        scheme.prepare_dense(context, state, end, 0.05, stages, dense, np.zeros(7))
        scheme.dense_value(state, dense, 0.6, 0, 7, out)
        ends.append(np.append(end, out))
    # equal areas in equal times: A = h t/2
    assert ends[0] == pytest.approx(ends[1], abs=1e-11)
    assert ends[0][6] == pytest.approx(0.3 + 0.025 * math.sqrt(0.95 * 1.05), abs=1e-9)
    assert ends[0][6] != pytest.approx(0.3 + 0.025 * math.sqrt(0.96 * 1.05), abs=1e-9)


@uncompiled
def test_what_radau_counts_is_counted_at_the_stages_it_found() -> None:
    """Also where the iteration ended early: the derivatives of an iteration before would be those of other states."""

    @kernel
    def with_square(context: Any, state: Any, rate: Any, elapsed: float) -> None:
        kepler(context, state, rate, elapsed)
        rate[6] = state[0] * state[0]

    @kernel
    def loose(context: Any, state: Any, error: Any) -> float:
        return 1e-4 * float(squared(context, state, error[0:6]))

    start = np.append(START, 0.3)
    _, end, stages = steps_of(with_square, SCHEMES["radau"].make(with_square, loose, 6, 1), start, 0.8)
    places = 0.95 + stages[2 * 7 : 5 * 7].reshape(3, 7)[:, 0]
    weights = np.array([(16 - math.sqrt(6)) / 36, (16 + math.sqrt(6)) / 36, 1 / 9])
    assert end[6] == pytest.approx(0.3 + 0.8 * weights @ places**2, abs=1e-15)
    tight = steps_of(with_square, SCHEMES["radau"].make(with_square, strict, 6, 1), start, 0.8)[1]
    assert abs(end[6] - tight[6]) > 1e-9, "the iteration has ended early"


def growth(name: str, step: float, zeta: float) -> float:
    """Largest factor by which a step multiplies a state of the oscillator."""
    small = SCHEMES[name].make(oscillator, strict, 2)
    columns = [steps_of(oscillator, small, start, step, context=np.array([zeta]))[1] for start in np.eye(2)]
    return float(abs(np.linalg.eigvals(np.array(columns).T)).max())


@uncompiled
def test_edges_of_stability() -> None:
    """h |lambda| = 5.97 on the imaginary axis, 6.4 on the real one; the decay below it is the one stated."""
    assert growth("dop853", 5.96, 0.0) < 1.0 < growth("dop853", 5.98, 0.0)
    assert 1.0 - growth("dop853", 2.0, 0.0) == pytest.approx(2.7e-5, rel=0.02)
    assert 1.0 - growth("dop853", 2.02, 0.0) != pytest.approx(2.7e-5, rel=0.02)
    assert 1.0 - growth("dop853", 1.0, 0.0) == pytest.approx(2.4e-8, rel=0.02)
    assert growth("dop853", 6.38, 1.0) < 1.0 < growth("dop853", 6.42, 1.0)


@uncompiled
def test_gauss_takes_nothing_off() -> None:
    """|R| = 1 to rounding for any step, as far as the iteration goes: below h |lambda| = 6; a step back undoes it."""
    for step in (0.1, 0.7, 1.5, 2.5):
        assert growth("gauss", step, 0.0) == pytest.approx(1.0, abs=2e-15)
    assert growth("gauss", 2.5, 1e-6) != pytest.approx(1.0, abs=2e-15)
    scheme = SCHEMES["gauss"].make(kepler, strict, SIZE)
    _, there, _ = steps_of(kepler, scheme, START, 0.5)
    _, back, _ = steps_of(kepler, scheme, there, -0.5)
    assert back == pytest.approx(START, abs=2e-15)
    # an explicit scheme undoes its step to its error only
    other = SCHEMES["dop853"].make(kepler, strict, SIZE)
    _, there, _ = steps_of(kepler, other, START, 0.5)
    assert steps_of(kepler, other, there, -0.5)[1] != pytest.approx(START, abs=1e-12)


@uncompiled
def test_gauss_iteration() -> None:
    """It finds its stages below h |lambda| = 6, at a rate of 0.166 h |lambda| a sweep; otherwise it says so."""
    matrix = gauss._A.reshape(4, 4)
    rate = max(abs(np.linalg.eigvals(matrix)))
    assert rate == pytest.approx(0.1654, abs=1e-4)
    small = SCHEMES["gauss"].make(oscillator, squared, 2)
    for step, found in ((1.5, True), (3.0, True), (6.3, False)):
        _, end, stages = steps_of(oscillator, small, np.array([1.0, 0.0]), step)
        error = small.error(np.zeros(1), end, step, stages, np.zeros(2), np.zeros(2))
        assert math.isfinite(error) == found
    assert small.shorter_step(1.0, error) == 0.2
    assert small.reach(0.0) == small.reach(5.0) == 1.5  # a quarter is left by each sweep
    assert rate * small.reach(0.0) < 0.25 < rate * 1.02 * small.reach(0.0)


@uncompiled
def test_radau_damps_what_is_stiff() -> None:
    """R(-inf) = 0 and |R| <= 1 on the axes; near zero the damping of what nothing else damps is the one stated."""
    for step in (0.3, 3.0, 30.0, 300.0):
        assert growth("radau", step, 0.0) < 1.0
    for step, off in ((0.5, 2.14e-6), (1.0, 1.307e-4)):
        assert 1.0 - growth("radau", step, 0.0) == pytest.approx(off, rel=0.01)
        assert 1.0 - growth("radau", 1.02 * step, 0.0) != pytest.approx(off, rel=0.01)
    # of an overdamped swing the slow rate is followed; of the fast one 3/(h |lambda|) is left after one step
    zeta, start = 1e4, np.array([0.0, 1.0])
    small, context = SCHEMES["radau"].make(oscillator, strict, 2), np.array([zeta])
    once = steps_of(oscillator, small, start, 1.0, 1, context)[1]
    assert abs(once[1]) == pytest.approx(1.5 / zeta, rel=1e-2)
    later = steps_of(oscillator, small, start, 1.0, 9, context)[1]
    slow = expm(9.0 * np.array([[0.0, 1.0], [-1.0, -2.0 * zeta]])) @ start
    assert later == pytest.approx(slow, rel=1e-6)
    explicit = SCHEMES["dop853"].make(oscillator, strict, 2)
    assert abs(steps_of(oscillator, explicit, start, 1.0, 1, context)[1][1]) > 1e10


def test_coefficients_of_radau() -> None:
    """T turns the inverse of a into the eigenvalues; a is that of the collocation at (4 -+ sqrt 6)/10 and 1."""
    root = math.sqrt(6.0)
    expected = [
        [(88 - 7 * root) / 360, (296 - 169 * root) / 1800, (-2 + 3 * root) / 225],
        [(296 + 169 * root) / 1800, (88 + 7 * root) / 360, (-2 - 3 * root) / 225],
        [(16 - root) / 36, (16 + root) / 36, 1 / 9],
    ]
    assert pytest.approx(np.ravel(expected), abs=1e-16) == radau._A
    turned = radau.T_INVERSE.reshape(3, 3) @ np.linalg.inv(expected) @ radau.T.reshape(3, 3)
    pair = [[radau.REAL, 0, 0], [0, radau.PAIR, -radau.TURN], [0, radau.TURN, radau.PAIR]]
    assert turned == pytest.approx(np.array(pair), abs=1e-13)


def test_coefficients_of_gauss() -> None:
    """Nodes and weights are numpy's, and a is symplectic: b_i a_ij + b_j a_ji = b_i b_j."""
    nodes, weights = np.polynomial.legendre.leggauss(4)
    assert pytest.approx(0.5 + 0.5 * nodes, abs=2e-16) == gauss._CF
    assert pytest.approx(0.5 * weights, abs=3e-16) == gauss._B
    crossed = gauss._B[:, None] * gauss._A.reshape(4, 4)
    assert crossed + crossed.T == pytest.approx(np.outer(gauss._B, gauss._B), abs=1e-16)
    assert collocation.difference([0, 1, 3]) == pytest.approx([1 / 3, -1 / 2, 1 / 6])


@uncompiled
def test_elimination() -> None:
    """Against numpy, with pivots that have to change places."""
    random = np.random.default_rng(3)
    for size in (1, 2, 7):
        real, imaginary = random.normal(size=(2, size, size))
        real[0, 0] = imaginary[0, 0] = 0.0 if size > 1 else 1.0
        right, beside = random.normal(size=(2, size))
        factors, pivots, found = real.ravel().copy(), np.zeros(size), right.copy()
        elimination.factor(factors, pivots, size)
        elimination.solve(factors, pivots, size, found)
        assert found == pytest.approx(np.linalg.solve(real, right), rel=1e-11)
        parts = [real.ravel().copy(), imaginary.ravel().copy(), pivots]
        found, other = right.copy(), beside.copy()
        elimination.factor_complex(*parts, size)
        elimination.solve_complex(*parts, size, found, other)
        expected = np.linalg.solve(real + 1j * imaginary, right + 1j * beside)
        assert found + 1j * other == pytest.approx(expected, rel=1e-11)
        assert found + 1j * other != pytest.approx(np.linalg.solve(real - 1j * imaginary, right + 1j * beside))


@pytest.mark.parametrize("name", ["gauss", "radau"])
def test_compiled_kernels_give_the_same(name: str, request: pytest.FixtureRequest) -> None:
    """As plain Python does; that of dop853 is compiled with every removal."""

    def once() -> Any:
        scheme = SCHEMES[name].make(oscillator, squared, 2)
        context, dense, out = np.array([0.3]), np.zeros(scheme.dense), np.zeros(2)
        state, end, stages = steps_of(oscillator, scheme, np.array([0.1, 1.0]), 0.4, context=context)
        error = scheme.error(context, end, 0.4, stages, np.zeros(2), np.zeros(2))
        scheme.prepare_dense(context, state, end, 0.4, stages, dense, np.zeros(2))
        scheme.dense_value(state, dense, 0.3, 0, 2, out)
        return np.array([*end, *out, error, scheme.next_step(1.0, error, error)])

    compiled = once()
    request.getfixturevalue("plain")
    assert compiled == pytest.approx(once(), rel=1e-14)


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
