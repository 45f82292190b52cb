"""Flattening and drag: against the gradient of the potential, fifty digits, and plain vectors."""

from __future__ import annotations

from decimal import Decimal, getcontext
from typing import Any

import numpy as np
import pytest

from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_J2, EARTH_MU, EARTH_ROTATION_RATE
from orbital.perturbations import (
    differential_flattening,
    drag_acceleration,
    flattening_acceleration,
    flattening_energy,
)

STRENGTH = EARTH_J2 * EARTH_EQUATORIAL_RADIUS**2
POLE = np.array([0.0, 0.0, 1.0])
TILTED = np.array([0.6, 0.0, 0.8])
PLACES = (np.array([5e6, -4e6, 3e6]), np.array([7.2e6, 0.0, 0.0]), np.array([0.0, 1e4, 7.2e6]))


def acceleration(position: Any, pole: Any = POLE) -> Any:
    out = np.zeros(3)
    flattening_acceleration(out, position, pole, EARTH_MU, STRENGTH)
    return out


@pytest.mark.parametrize("pole", [POLE, TILTED])
@pytest.mark.parametrize("position", PLACES)
def test_flattening_is_the_gradient_of_its_potential(position: Any, pole: Any) -> None:
    step = 100.0
    slope = [
        (
            flattening_energy(position + step * axis, pole, EARTH_MU, STRENGTH)
            - flattening_energy(position - step * axis, pole, EARTH_MU, STRENGTH)
        )
        / (2.0 * step)
        for axis in np.eye(3)
    ]
    found = acceleration(position, pole)
    assert found == pytest.approx(-np.array(slope), rel=1e-7, abs=1e-8 * np.linalg.norm(found))
    assert found != pytest.approx(np.array(slope), rel=1e-2)


def exactly(r: list[Decimal]) -> list[Decimal]:
    square = sum((x * x for x in r), Decimal(0))
    factor = Decimal("-1.5") * Decimal(EARTH_MU) * Decimal(STRENGTH) / (square * square * square.sqrt())
    round_, up = 1 - 5 * r[2] * r[2] / square, 2 * r[2]
    return [factor * (round_ * x + (up if i == 2 else 0)) for i, x in enumerate(r)]


@pytest.mark.parametrize("offset", [(7.0, -3.0, 9.0), (0.0, 0.0, 12.0), (-4e3, 1e4, 2e3), (1e-3, 0.0, 0.0)])
@pytest.mark.parametrize("position", PLACES)
def test_difference_without_cancellation(position: Any, offset: Any) -> None:
    getcontext().prec = 50
    out = np.zeros(3)
    differential_flattening(out, position, np.array(offset), POLE, EARTH_MU, STRENGTH)
    start = [Decimal(float(x)) for x in position]
    there = [a + Decimal(float(x)) for a, x in zip(start, offset, strict=True)]
    expected = np.array([float(b - a) for a, b in zip(exactly(start), exactly(there), strict=True)])
    assert np.linalg.norm(out - expected) < 3e-15 * np.linalg.norm(expected)
    plainly = acceleration(position + np.array(offset)) - acceleration(position)
    assert max(map(abs, offset)) > 1e3 or np.linalg.norm(plainly - expected) > 1e-12 * np.linalg.norm(expected)


def test_drag_is_against_the_wind() -> None:
    position, velocity, out = PLACES[0], np.array([5e3, 5e3, -1e3]), np.zeros(3)
    speed = drag_acceleration(out, position, velocity, TILTED, EARTH_ROTATION_RATE, 1e-13)
    wind = velocity - np.cross(EARTH_ROTATION_RATE * TILTED, position)
    assert speed == pytest.approx(np.linalg.norm(wind), rel=1e-14)
    assert out == pytest.approx(-1e-13 * np.linalg.norm(wind) * wind, rel=1e-13)
    assert out != pytest.approx(-1e-13 * np.linalg.norm(velocity) * velocity, rel=1e-2)
