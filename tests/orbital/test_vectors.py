import math
from fractions import Fraction

import numpy as np
import pytest

from orbital import vectors

SAMPLES = [
    (0.0, 0.0, 0.0),
    (1.0, 0.0, 0.0),
    (0.3, -4.0, 12.0),
    (-1e-120, 2e-120, 3e-120),
    (7.178137e6, -3.1, 2e-9),
    (math.inf, 1.0, -2.0),
    (1.0, math.nan, 0.0),
]
PAIRS = [(np.array(a), np.array(b)) for a in SAMPLES for b in SAMPLES]


def exactly(a, b):
    np.testing.assert_array_equal(a, b)


@pytest.mark.filterwarnings("ignore:invalid value:RuntimeWarning")
def test_componentwise_operations_are_those_of_numpy(run):
    out = np.empty(3)
    for a, b in PAIRS:
        run(vectors.add)(out, a, b)
        exactly(out, a + b)
        run(vectors.subtract)(out, a, b)
        exactly(out, a - b)
        run(vectors.scale)(out, 3.5, a)
        exactly(out, 3.5 * a)
        run(vectors.add_scaled)(out, a, -0.3, b)
        exactly(out, a + -0.3 * b)
        run(vectors.copy)(out, a)
        exactly(out, a)
    run(vectors.fill)(out, 2.5)
    exactly(out, [2.5, 2.5, 2.5])


@pytest.mark.filterwarnings("ignore:invalid value:RuntimeWarning")
def test_products_are_those_of_numpy(run):
    out = np.empty(3)
    for a, b in PAIRS:
        exactly(run(vectors.dot)(a, b), a[0] * b[0] + a[1] * b[1] + a[2] * b[2])
        run(vectors.cross)(out, a, b)
        exactly(out, np.cross(a, b))
        exactly(run(vectors.norm)(a), math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]))
        exactly(run(vectors.distance)(a, b), run(vectors.norm)(a - b))


def test_out_may_be_an_operand(run, rng):
    a, b = rng.normal(size=(2, 3))
    matrix = rng.normal(size=(3, 3))
    for operation, expected in [
        (lambda out: run(vectors.cross)(out, out, b), np.cross(a, b)),
        (lambda out: run(vectors.add_scaled)(out, out, 2.0, b), a + 2.0 * b),
        (lambda out: run(vectors.matrix_vector)(out, matrix, out), matrix @ a),
        (lambda out: run(vectors.transposed_matrix_vector)(out, matrix, out), matrix.T @ a),
        (lambda out: run(vectors.unit)(out, out), a / np.linalg.norm(a)),
    ]:
        out = a.copy()
        operation(out)
        np.testing.assert_allclose(out, expected, rtol=1e-14)
    reversed_product = np.empty(3)
    run(vectors.cross)(reversed_product, b, a)
    assert not np.allclose(reversed_product, np.cross(a, b)), "the twin: a x b and b x a must differ"


def test_norm_against_exact_arithmetic(run, rng):
    for a in rng.normal(size=(50, 3)):
        exact = sum(Fraction(x) ** 2 for x in a.tolist())
        error = Fraction(run(vectors.norm)(a)) ** 2 / exact - 1
        assert abs(error) < 1e-15


def test_norm_outside_its_range_is_zero_or_infinite(run):
    assert run(vectors.norm)(np.array([1e-170, 0.0, 0.0])) == 0.0
    with np.errstate(over="ignore"):
        assert run(vectors.norm)(np.array([1e170, 0.0, 0.0])) == math.inf


def test_unit_of_nothing_is_nothing(run):
    out = np.full(3, 9.0)
    assert run(vectors.unit)(out, np.zeros(3)) == 0.0
    exactly(out, np.zeros(3))
    assert run(vectors.unit)(out, np.array([0.0, -5.0, 0.0])) == 5.0
    exactly(out, [0.0, -1.0, 0.0])
    assert math.isnan(run(vectors.unit)(out, np.array([math.nan, 0.0, 0.0])))


def test_finite(run):
    for sample in SAMPLES:
        assert run(vectors.is_finite)(np.array(sample)) == all(math.isfinite(x) for x in sample)
