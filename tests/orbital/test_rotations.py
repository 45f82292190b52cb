import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from orbital import rotations

# No turn, tiny ones down to underflow, either side of the switch to the series, and up to exactly half a turn.
ANGLES = [0.0, 1e-200, 1e-160, 1e-9, 0.999e-2, 1.001e-2, 0.3, math.pi / 2, 3.0, math.pi - 1e-9, math.pi]
AXES = [(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0), (0.6, 0.0, -0.8), (2 / 3, -1 / 3, 2 / 3)]
ROTATION_VECTORS = [angle * np.array(axis) for angle in ANGLES for axis in AXES]


def quaternion(rotation_vector):
    out = np.empty(4)
    rotations.from_rotation_vector(out, np.asarray(rotation_vector, dtype=float))
    return out


def peer(q):
    return Rotation.from_quat(q, scalar_first=True)


@pytest.mark.parametrize("vector", ROTATION_VECTORS)
def test_exponential_map_against_scipy_and_back(run, vector):
    q, back = np.empty(4), np.empty(3)
    run(rotations.from_rotation_vector)(q, vector)
    np.testing.assert_allclose(q, Rotation.from_rotvec(vector).as_quat(scalar_first=True), atol=2e-16)
    assert np.linalg.norm(q) == pytest.approx(1.0, abs=3e-16)
    angle = run(rotations.to_rotation_vector)(back, q)
    np.testing.assert_allclose(back, vector, rtol=4e-16 * 4, atol=5e-16 * angle)
    assert angle == pytest.approx(np.linalg.norm(vector), rel=1e-15, abs=1e-150)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.01, 0.3, 1.0, -1.0])
def test_an_even_turn_against_scipy(run, angle):
    """To rounding, up to a radian."""
    axis, time, q = np.array([2 / 3, -1 / 3, 2 / 3]), 2.5, np.empty(4)
    run(rotations.evenly_turned)(q, angle / time * axis, time)
    np.testing.assert_allclose(q, Rotation.from_rotvec(angle * axis).as_quat(scalar_first=True), rtol=0, atol=3e-16)


@pytest.mark.parametrize("angle", [0.0, 1e-7, 0.01, 0.3, -0.3])
def test_what_stands_still_turns_back_in_a_frame_that_turns(run, angle):
    """Vector and attitude alike, by the angle whose half has angle/2 as its tangent."""
    turned = Rotation.from_rotvec([0.0, 0.0, -2.0 * math.atan(0.5 * angle)])
    vector, attitude = np.array([3.0, -4.0, 5.0]), quaternion([0.4, 0.9, -1.3])
    start = vector.copy(), peer(attitude)
    run(rotations.turn_back)(vector, angle)
    run(rotations.turn_attitude_back)(attitude, angle)
    np.testing.assert_allclose(vector, turned.apply(start[0]), rtol=0, atol=2e-15)
    np.testing.assert_allclose(peer(attitude).as_matrix(), (turned * start[1]).as_matrix(), rtol=0, atol=1e-15)
    assert np.linalg.norm(attitude) == pytest.approx(1.0, abs=3e-16)


@pytest.mark.parametrize("length", [1.0, 0.3, 1e3, -2.0])
def test_matrix_of_a_quaternion_of_any_length(run, length):
    """Each of the nine elements is that of the direction alone."""
    for vector in ROTATION_VECTORS[::3]:
        matrix = np.empty((3, 3))
        run(rotations.to_matrix_of_any_length)(matrix, length * quaternion(vector))
        np.testing.assert_allclose(matrix, Rotation.from_rotvec(vector).as_matrix(), atol=1e-15)


def test_small_angle_series_meets_the_closed_form_in_extended_precision(run):
    for angle in (1e-3, 0.9999e-2, 1.0001e-2, 0.1):
        q = np.empty(4)
        run(rotations.from_rotation_vector)(q, np.array([0.0, angle, 0.0]))
        half = np.longdouble(angle) / 2
        assert abs(q[2] / np.sin(half) - 1) < 3e-16
        assert abs(q[0] - np.cos(half)) < 2e-16
        assert abs(angle / 2 / np.sin(half) - 1) > 3e-16, "the twin: the first term alone must not pass"


def test_the_longer_way_round_comes_back_as_the_shorter(run):
    out = np.empty(3)
    angle = run(rotations.to_rotation_vector)(out, -quaternion([0.0, 0.0, 0.4]))
    assert angle == pytest.approx(0.4, rel=1e-15)
    np.testing.assert_allclose(out, [0.0, 0.0, 0.4], rtol=1e-15)


def test_rotation_and_its_inverse_against_scipy(run, rng):
    out = np.empty(3)
    for rotation_vector, v in zip(rng.normal(size=(50, 3)), rng.normal(size=(50, 3)), strict=True):
        q = quaternion(rotation_vector)
        run(rotations.rotate)(out, q, v)
        np.testing.assert_allclose(out, peer(q).apply(v), atol=2e-15)
        assert not np.allclose(out, peer(q).inv().apply(v), atol=1e-3), "the twin: body and reference swapped"
        run(rotations.rotate_inverse)(out, q, out)
        np.testing.assert_allclose(out, v, atol=2e-15)


def test_a_quarter_turn_about_the_third_axis_takes_the_first_axis_to_the_second(run):
    out = np.empty(3)
    run(rotations.rotate)(out, quaternion([0.0, 0.0, math.pi / 2]), np.array([1.0, 0.0, 0.0]))
    np.testing.assert_allclose(out, [0.0, 1.0, 0.0], atol=1e-15)


def test_products_against_scipy_and_one_another(run, rng):
    for p_vector, q_vector in rng.normal(size=(50, 2, 3)):
        p, q, out = quaternion(p_vector), quaternion(q_vector), np.empty(4)
        run(rotations.multiply)(out, p, q)
        np.testing.assert_allclose((peer(p) * peer(q)).as_matrix(), peer(out).as_matrix(), atol=2e-15)
        run(rotations.multiply_inverse)(out, p, out)
        np.testing.assert_allclose(out, q, atol=5e-16)
        run(rotations.conjugate)(out, p)
        run(rotations.multiply)(out, out, p)
        np.testing.assert_allclose(out, [1.0, 0.0, 0.0, 0.0], atol=5e-16)


def test_matrix_there_and_back_through_every_branch(run):
    matrix, q = np.empty((3, 3)), np.empty(4)
    for vector in ROTATION_VECTORS:
        expected = quaternion(vector)
        run(rotations.to_matrix)(matrix, expected)
        np.testing.assert_allclose(matrix, peer(expected).as_matrix(), atol=1e-15)
        run(rotations.from_matrix)(q, matrix)
        assert q[0] >= 0.0
        np.testing.assert_allclose(abs(np.dot(q, expected)), 1.0, rtol=1e-15)
        run(rotations.from_matrix)(q, matrix.T.copy())
        if 1e-3 < np.linalg.norm(vector) < 3.1:
            assert abs(np.dot(q, expected)) < 1.0 - 1e-7, "the twin: the transposed matrix is another rotation"


def test_rate_is_the_derivative_of_the_attitude(run, rng):
    q0, rate, out = quaternion(rng.normal(size=3)), rng.normal(size=3), np.empty(4)
    run(rotations.quaternion_rate)(out, q0, rate)
    before, after = np.empty(4), np.empty(4)
    h = 1e-5
    rotations.multiply(after, q0, quaternion(h * rate))
    rotations.multiply(before, q0, quaternion(-h * rate))
    np.testing.assert_allclose(out, (after - before) / (2 * h), atol=1e-10)
    rotations.multiply(after, quaternion(h * rate), q0)
    rotations.multiply(before, quaternion(-h * rate), q0)
    assert not np.allclose(out, (after - before) / (2 * h), atol=1e-3), "the twin: a rate in reference axes"


def test_normalise(run):
    q = np.array([3.0, 0.0, -4.0, 0.0])
    assert run(rotations.normalise)(q, q) == 5.0
    np.testing.assert_array_equal(q, [0.6, 0.0, -0.8, 0.0])
    q = np.zeros(4)
    assert run(rotations.normalise)(q, q) == 0.0
    np.testing.assert_array_equal(q, [1.0, 0.0, 0.0, 0.0])
    q = np.array([1.0, math.nan, 0.0, 0.0])
    run(rotations.normalise)(q, q)
    assert np.isnan(q).any()
