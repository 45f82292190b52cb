"""The dumbbell whose length changes, against Hill's equations in Cartesian coordinates and finite differences."""

import math

import numpy as np
import pytest

from orbital import dumbbell
from orbital.references import equilibrium_angle, equilibrium_tension

RATE, MASS, LENGTH, PUSH = 1.0381289e-3, 2000.0 / 3.0, 12.0, 5e-6
"""Table 2: 0.01 N backwards on 2000 kg give the target 5e-6 m/s2 along-track relative to the chaser."""
TABLE_2 = dumbbell.Pair(RATE, MASS, PUSH)


def accelerate(pair: dumbbell.Pair, x: list[float]) -> list[float]:
    """(l, l', phi, phi', T) by Hill's equations: x'' = 2 n y' + 3 n^2 x - T x/(m l), y'' = -2 n x' - T y/(m l) + q."""
    length, speed, angle, turn, tension = x
    radial, across = np.array([math.cos(angle), math.sin(angle)]), np.array([-math.sin(angle), math.cos(angle)])
    place, velocity = length * radial, speed * radial + length * turn * across
    n = pair.rate
    force = np.array([2 * n * velocity[1] + 3 * n * n * place[0], -2 * n * velocity[0] + pair.across])
    force += (pair.along - tension / pair.mass) * radial
    return [force @ radial + length * turn**2, (force @ across - 2 * speed * turn) / length]


@pytest.mark.parametrize("pair", [TABLE_2, dumbbell.Pair(RATE, MASS, -3e-5, 1e-5)])
def test_accelerations(pair: dumbbell.Pair) -> None:
    for x in ([12.0, 0.01, 0.3, 4e-4, 0.02], [30.0, -0.2, -2.5, -1e-3, 0.0]):
        assert dumbbell.accelerations(pair, *x) == pytest.approx(accelerate(pair, x), rel=1e-12)


def test_rests() -> None:
    angle = dumbbell.hanging_angle(TABLE_2, LENGTH)
    assert angle is not None
    assert math.degrees(angle) == pytest.approx(7.40452, abs=1e-4)
    assert angle == pytest.approx(equilibrium_angle(0.01, RATE, LENGTH, 2000.0), rel=1e-12)
    assert dumbbell.rest_tension(TABLE_2, LENGTH, angle) == pytest.approx(
        equilibrium_tension(RATE, LENGTH, MASS), rel=1e-12
    )
    assert dumbbell.rest_tension(TABLE_2, LENGTH, dumbbell.towing_angle(TABLE_2)) == pytest.approx(MASS * PUSH)
    assert dumbbell.hanging_angle(dumbbell.Pair(RATE, MASS, 4e-5), LENGTH) is None
    assert dumbbell.towing_angle(dumbbell.Pair(RATE, MASS, -PUSH)) == -0.5 * math.pi


@pytest.mark.parametrize("rest", ["hanging", "towing"])
@pytest.mark.parametrize("push", [PUSH, -PUSH])
def test_linearised_by_differences(rest: str, push: float) -> None:
    """Each column against the change of Hill's own equations, each side of the rest."""
    pair = dumbbell.Pair(RATE, MASS, push)
    angle = dumbbell.hanging_angle(pair, LENGTH) if rest == "hanging" else dumbbell.towing_angle(pair)
    assert angle is not None
    at = [LENGTH, 0.0, angle, 0.0, dumbbell.rest_tension(pair, LENGTH, angle)]
    assert accelerate(pair, at) == pytest.approx([0.0, 0.0], abs=1e-20)
    plant, drive = dumbbell.linearised(pair, LENGTH, angle)
    for k, size in enumerate((1e-2, 1e-5, 1e-4, 1e-7, 1e-4)):
        above, below = list(at), list(at)
        above[k] += size
        below[k] -= size
        slope = (np.array(accelerate(pair, above)) - np.array(accelerate(pair, below))) / (2 * size)
        column = plant[:, k] if k < 4 else drive[:, 0]
        assert column[[1, 3]] == pytest.approx(slope, rel=1e-6, abs=1e-12)
        assert list(column[[0, 2]]) == [float(k == 1), float(k == 3)]


def test_driven() -> None:
    """Winding at u is l'' = u; the angle feels the rate, -2 n l'/l, as before."""
    plant, _ = dumbbell.linearised(TABLE_2, LENGTH, 0.1)
    whole, drive = dumbbell.driven(plant)
    assert drive[:, 0].tolist() == [0.0, 1.0, 0.0, 0.0]
    assert whole[3] == pytest.approx([plant[3, 0], -2.0 * RATE / LENGTH, plant[3, 2], 0.0])
    assert whole[:3].tolist() == [[0, 1, 0, 0], [0, 0, 0, 0], [0, 0, 0, 1]]
    assert plant[1].any()
