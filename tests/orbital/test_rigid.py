"""The turning of a rigid body, against numpy, mass points and Jacobi's elliptic functions."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from scipy.special import ellipj, ellipk

from orbital.constants import EARTH_MU
from orbital.rigid import (
    euler,
    extreme_moments,
    gradient_torque,
    inertia_matrix,
    invert_symmetric,
    point_acceleration,
    point_velocity,
)

MOMENTS = np.array([300.0, 500.0, 650.0, 20.0, -35.0, 12.0])


def matrix() -> np.ndarray:
    out = np.zeros((3, 3))
    inertia_matrix(out, MOMENTS)
    return out


def test_the_matrix_and_its_inverse() -> None:
    full, inverse = matrix(), np.zeros((3, 3))
    expected = [[300.0, 20.0, -35.0], [20.0, 500.0, 12.0], [-35.0, 12.0, 650.0]]
    assert full.tolist() == expected
    determinant = invert_symmetric(inverse, full)
    assert determinant == pytest.approx(np.linalg.det(full), rel=1e-13)
    assert inverse == pytest.approx(np.linalg.inv(full), rel=1e-13)
    assert invert_symmetric(inverse, np.ones((3, 3))) == 0.0


@pytest.mark.parametrize("scale", [1.0, 1e-6, 1e6])
def test_principal_moments(scale: float) -> None:
    for given in (matrix() * scale, np.diag([4.0, 1.0, 4.0]) * scale, np.eye(3) * scale):
        least, greatest = extreme_moments(given)
        expected = np.linalg.eigvalsh(given)
        assert (least, greatest) == pytest.approx((expected[0], expected[-1]), rel=1e-12)


def test_torque_of_a_field_is_that_on_mass_points() -> None:
    """Six masses on three axes have the inertia wanted; the rest of the series is of the order of their size over r."""
    size = np.array([0.3, 0.5, 0.8])
    places = np.vstack([np.diag(size), -np.diag(size)])
    moments = 2.0 * np.array([size[1] ** 2 + size[2] ** 2, size[2] ** 2 + size[0] ** 2, size[0] ** 2 + size[1] ** 2])
    center = np.array([4e3, -5e3, 3e3])
    r = np.linalg.norm(center)
    whole = sum(np.cross(d, -EARTH_MU * (center + d) / np.linalg.norm(center + d) ** 3) for d in places)
    out = np.zeros(3)
    gradient_torque(out, np.diag(moments), center, 3.0 * EARTH_MU / r**5)
    assert out == pytest.approx(whole, rel=1e-6)
    assert float(np.linalg.norm(out)) > 0.0


def test_free_tumbling_is_jacobis() -> None:
    """w = (a cn, b sn, c dn) of a body that turns mostly about its greatest axis; Landau, Mechanics, section 37."""
    i1, i2, i3 = 300.0, 500.0, 650.0
    inertia, inverse = np.diag([i1, i2, i3]), np.diag([1.0 / i1, 1.0 / i2, 1.0 / i3])
    start = np.array([0.05, 0.0, 0.08])
    energy = float(start @ inertia @ start)
    momentum = float((inertia @ start) @ (inertia @ start))
    assert momentum > energy * i2
    pace = math.sqrt((i3 - i2) * (momentum - energy * i1) / (i1 * i2 * i3))
    m = (i2 - i1) * (energy * i3 - momentum) / ((i3 - i2) * (momentum - energy * i1))
    period = 4.0 * ellipk(m) / pace

    def rate(_: float, w: np.ndarray) -> np.ndarray:
        out = np.zeros(3)
        euler(out, inertia, inverse, w, np.zeros(3))
        return out

    times = np.linspace(0.0, 2.0 * period, 41)
    found = solve_ivp(rate, (0.0, times[-1]), start, "DOP853", times, rtol=1e-12, atol=1e-15).y
    sn, cn, dn, _ = ellipj(pace * times, m)
    a = math.sqrt((energy * i3 - momentum) / (i1 * (i3 - i1)))
    b = math.sqrt((energy * i3 - momentum) / (i2 * (i3 - i2)))
    c = math.sqrt((momentum - energy * i1) / (i3 * (i3 - i1)))
    assert found == pytest.approx(np.array([a * cn, b * sn, c * dn]), abs=1e-11)


def test_torque_turns_about_its_axis() -> None:
    full, inverse = matrix(), np.linalg.inv(matrix())
    out, torque = np.zeros(3), np.array([1.0, -2.0, 0.5])
    euler(out, full, inverse, np.zeros(3), torque)
    assert full @ out == pytest.approx(torque, rel=1e-13)


def test_a_point_of_a_turning_body() -> None:
    """Velocity and acceleration of a point against differences of its place, of a body that turns ever faster."""
    axis, rate, change, point = np.array([0.6, 0.0, -0.8]), 0.3, 0.05, np.array([1.5, -0.4, 0.9])
    start = Rotation.from_euler("xyz", (0.3, -1.0, 0.7))

    def place(time: float) -> np.ndarray:
        turned = start * Rotation.from_rotvec((rate * time + 0.5 * change * time**2) * axis)
        return np.asarray(turned.apply(point))

    step, velocity, acceleration = 1e-2, np.zeros(3), np.zeros(3)
    at = [place(k * step) for k in (-2, -1, 0, 1, 2)]
    point_velocity(velocity, start.as_matrix(), rate * axis, point)
    point_acceleration(acceleration, start.as_matrix(), rate * axis, change * axis, point)
    assert velocity == pytest.approx((at[0] - 8.0 * at[1] + 8.0 * at[3] - at[4]) / (12.0 * step), abs=1e-10)
    second = (-at[0] + 16.0 * at[1] - 30.0 * at[2] + 16.0 * at[3] - at[4]) / (12.0 * step**2)
    assert acceleration == pytest.approx(second, abs=1e-9)
    assert np.linalg.norm(acceleration) > 0.1
