"""The third and the fourth zonal harmonic: against the gradient of their potential, and fifty digits."""

from __future__ import annotations

from decimal import Decimal, getcontext
from typing import Any

import numpy as np
import pytest
from scipy.special import eval_legendre

from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_J3, EARTH_J4, EARTH_MU
from orbital.zonals import differential_zonal, zonal_acceleration, zonal_energy

THIRD, FOURTH = EARTH_J3 * EARTH_EQUATORIAL_RADIUS**3, EARTH_J4 * EARTH_EQUATORIAL_RADIUS**4
POLE, TILTED = np.array([0.0, 0.0, 1.0]), np.array([0.6, 0.0, 0.8])
PLACES = (np.array([5e6, -4e6, 3e6]), np.array([7.2e6, 0.0, 0.0]), np.array([0.0, 1e4, 7.2e6]))


def energy(position: Any, pole: Any) -> float:
    """By scipy's polynomials."""
    radius = np.linalg.norm(position)
    sine = position @ pole / radius
    third = -2.5327e-6 * (6378137.0 / radius) ** 3 * eval_legendre(3, sine)
    return float(EARTH_MU / radius * (third - 1.6196e-6 * (6378137.0 / radius) ** 4 * eval_legendre(4, sine)))


@pytest.mark.parametrize("pole", [POLE, TILTED])
@pytest.mark.parametrize("position", PLACES)
def test_they_are_the_gradient_of_their_potential(position: Any, pole: Any) -> None:
    assert zonal_energy(position, pole, EARTH_MU, THIRD, FOURTH) == pytest.approx(energy(position, pole), rel=1e-4)
    step, found = 100.0, np.zeros(3)
    slope = [
        (energy(position + step * axis, pole) - energy(position - step * axis, pole)) / (2.0 * step)
        for axis in np.eye(3)
    ]
    zonal_acceleration(found, position, pole, EARTH_MU, THIRD, FOURTH)
    assert found == pytest.approx(-np.array(slope), rel=1e-4, abs=1e-4 * np.linalg.norm(found))


def exactly(r: list[Decimal], third: float, fourth: float) -> list[Decimal]:
    square = sum((x * x for x in r), Decimal(0))
    radius = square.sqrt()
    s = r[2] / radius
    k3 = Decimal(EARTH_MU) * Decimal(third) / radius**5
    k4 = Decimal(EARTH_MU) * Decimal(fourth) / radius**6
    along = k3 * (35 * s**3 - 15 * s) / 2 + k4 * (315 * s**4 - 210 * s**2 + 15) / 8
    axial = k3 * (15 * s**2 - 3) / 2 + k4 * (35 * s**3 - 15 * s) / 2
    return [along * x / radius - (axial if i == 2 else 0) for i, x in enumerate(r)]


@pytest.mark.parametrize(("third", "fourth"), [(THIRD, 0.0), (0.0, FOURTH)])
@pytest.mark.parametrize("offset", [(7.0, -3.0, 9.0), (0.0, 0.0, 12.0), (-4e3, 1e4, 2e3), (1e-3, 0.0, 0.0)])
@pytest.mark.parametrize("position", PLACES)
def test_difference_without_cancellation(position: Any, offset: Any, third: float, fourth: float) -> None:
    getcontext().prec = 50
    out = np.zeros(3)
    differential_zonal(out, position, np.array(offset), POLE, EARTH_MU, third, fourth)
    start = [Decimal(float(x)) for x in position]
    there = [a + Decimal(float(x)) for a, x in zip(start, offset, strict=True)]
    pairs = zip(exactly(start, third, fourth), exactly(there, third, fourth), strict=True)
    expected = np.array([float(b - a) for a, b in pairs])
    assert np.linalg.norm(out - expected) < 1e-14 * np.linalg.norm(expected)
