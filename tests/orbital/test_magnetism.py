"""The dipole against the gradient of its potential, and a current against Ohm and a count of electrons."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from orbital.magnetism import dipole_field, dipole_north, harmonic_field, tether_current

A = 6371.2e3


def potential(x: Any) -> float:
    """a (a/r)^2 (g10 cos + (g11 cos lon + h11 sin lon) sin), IGRF-13 at 2020, in axes that turn with the Earth."""
    r = np.linalg.norm(x)
    return float(A**3 / r**3 * (-29404.8e-9 * x[2] - 1450.9e-9 * x[0] + 4652.5e-9 * x[1]))


@pytest.mark.parametrize("place", [(7e6, 0.0, 0.0), (-3e6, 4e6, 5e6), (1e5, 0.0, -7e6)])
@pytest.mark.parametrize("greenwich", [0.0, 1.1])
def test_the_field_is_the_gradient_of_its_potential(place: Any, greenwich: float) -> None:
    x, north, out = np.array(place), np.zeros(3), np.zeros(3)
    turn = Rotation.from_euler("z", greenwich)
    slope = [(potential(x + 100.0 * e) - potential(x - 100.0 * e)) / 200.0 for e in np.eye(3)]
    dipole_north(north, greenwich)
    dipole_field(out, turn.apply(x), north)
    assert turn.inv().apply(out) == pytest.approx(-np.array(slope), rel=1e-7, abs=1e-12)
    assert np.linalg.norm(north) == pytest.approx(1.0, rel=1e-12)


def test_poles() -> None:
    """80.6 N, 72.7 W at 2020 (IGRF-13); northwards over the equator, down into the pole in the north."""
    north, out = np.zeros(3), np.zeros(3)
    dipole_north(north, 0.0)
    assert math.degrees(math.asin(north[2])) == pytest.approx(80.6, abs=0.05)
    assert math.degrees(math.atan2(north[1], north[0])) == pytest.approx(-72.7, abs=0.05)
    dipole_field(out, A * north, north)
    assert out == pytest.approx(-2.0 * 29.81e-6 * north, rel=1e-3)


def test_current() -> None:
    plenty = 1e13, 1500.0, 10.0
    assert tether_current(230.0, 100.0, 30.0, 5.0, *plenty) == pytest.approx(2.0)
    assert tether_current(-230.0, 100.0, 30.0, 5.0, *plenty) == pytest.approx(-2.0)
    assert tether_current(29.0, 100.0, 30.0, 5.0, *plenty) == 0.0
    assert tether_current(1030.0, 100.0, 30.0, 5.0, *plenty) == 5.0
    # n <v>/4 over a sphere of 10 m, <v> = sqrt(8 k T/(pi m))
    speed = math.sqrt(8.0 * 1.380649e-23 * 1500.0 / (math.pi * 9.109e-31))
    expected = 1.602e-19 * 1e11 * speed / 4.0 * 4.0 * math.pi * 100.0
    assert tether_current(1030.0, 100.0, 30.0, 5.0, 1e11, 1500.0, 10.0) == pytest.approx(expected, rel=1e-3)
    assert expected == pytest.approx(1.21, abs=0.01)


def test_harmonics_are_the_gradient_of_their_potential() -> None:
    """Degree 1 is the dipole; a term of degree 3 and order 2, against differences of its potential written out."""
    x, out, room = np.array([4e6, -3e6, 5e6]), np.zeros(3), np.zeros((10, 5))
    rows = np.zeros((2, 4, 4))
    rows[0, 1, :2], rows[1, 1, 1] = (-29404.8e-9, -1450.9e-9), 4652.5e-9
    harmonic_field(out, x, rows, room, 3)
    slope = [(potential(x + 100.0 * e) - potential(x - 100.0 * e)) / 200.0 for e in np.eye(3)]
    assert out == pytest.approx(-np.array(slope), rel=1e-7)

    def sectorial(x: Any) -> float:
        """P_32 = 15 sin(lat) cos^2(lat), at twice the longitude."""
        r = np.linalg.norm(x)
        return float(
            A * (A / r) ** 4 * 15.0 * x[2] / r**3 * (2e-9 * (x[0] ** 2 - x[1] ** 2) + 3e-9 * 2.0 * x[0] * x[1])
        )

    rows[:] = 0.0
    rows[0, 3, 2], rows[1, 3, 2] = 2e-9, 3e-9
    harmonic_field(out, x, rows, room, 3)
    slope = [(sectorial(x + 100.0 * e) - sectorial(x - 100.0 * e)) / 200.0 for e in np.eye(3)]
    assert out == pytest.approx(-np.array(slope), rel=1e-6)
