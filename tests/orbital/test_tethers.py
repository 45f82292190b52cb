"""How thick a line has to be: each formula against an integration, a search, or a sum that does not know it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from orbital import tethers


def simulated(speed: float, stiffness: float, mass: float, zeta: float, preload: float) -> float:
    """Largest tension of a snap, integrated."""
    damping = 2.0 * zeta * math.sqrt(stiffness * mass)

    def rate(_: float, y: np.ndarray) -> list[float]:
        return [y[1], (preload - stiffness * y[0] - damping * y[1]) / mass]

    lasts = 2.0 * math.pi * math.sqrt(mass / stiffness)
    times = np.linspace(0.0, lasts, 20001)
    found = solve_ivp(rate, (0.0, lasts), [0.0, speed], method="DOP853", rtol=1e-12, atol=1e-15, t_eval=times)
    return float(np.max(stiffness * found.y[0] + damping * found.y[1]))


@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.3, 0.49, 0.7])
@pytest.mark.parametrize("preload", [0.0, 2.0, 30.0, -1.0])
def test_preloaded_snap(zeta: float, preload: float) -> None:
    expected = simulated(0.01, 4000.0, 600.0, zeta, preload)
    assert tethers.preloaded_snap_peak(0.01, 4000.0, 600.0, zeta, preload) == pytest.approx(expected, rel=1e-6)
    assert tethers.preloaded_snap_peak(0.0101, 4000.0, 600.0, zeta, preload) != pytest.approx(expected, rel=1e-4)


def test_share_of_an_impact() -> None:
    for zeta in (0.0, 0.05, 0.3, 1.5):
        expected = 2.0 * zeta if zeta > 1.0 else simulated(1.0, 1.0, 1.0, zeta, 0.0)
        assert tethers.impact_share(zeta) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(("preload", "share"), [(0.0, 1.0), (40.0, 1.0), (0.0, 0.8)])
def test_a_section_bears_its_own_snap(preload: float, share: float) -> None:
    """By a search for the section whose strength is the factor times its own peak, which it makes stiffer itself."""
    speed, mass, length, modulus, strength, safety = 0.05, 700.0, 30.0, 70e9, 2.9e9, 2.5

    def surplus(section: float) -> float:
        stiffness = modulus * section / length
        peak = preload + math.sqrt(preload**2 + stiffness * mass * (share * speed) ** 2)
        return strength * section - safety * peak

    sought = brentq(surplus, 1e-12, 1e-3, rtol=1e-14, xtol=1e-24)
    found = tethers.snap_section(speed, mass, length, modulus, strength, safety, preload, share)
    assert found == pytest.approx(sought, rel=1e-9)
    fixed = (
        safety * (preload + math.sqrt(preload**2 + modulus * 1e-6 / length * mass * (share * speed) ** 2)) / strength
    )
    assert fixed != pytest.approx(found, rel=0.1), "the peak of another line asks for another section"


def test_section_of_a_load() -> None:
    assert tethers.load_section(100.0, 2e9, 2.0) == pytest.approx(1e-7)
    assert tethers.diameter_of(math.pi) == pytest.approx(2.0)


def test_cuts_by_debris() -> None:
    """The diameter at which the particles that come, added up size by size, cut the line as often as is allowed."""
    flux, size, exponent, length, time, allowed = 1e-9, 1e-3, 2.5, 100.0, 1e8, 0.05
    diameter = tethers.diameter_for_cuts(allowed, time, length, flux, size, exponent)
    sizes = np.geomspace(diameter / 3.0, 1e4 * diameter, 200001)
    density = exponent * flux / size * (sizes / size) ** (-exponent - 1.0)
    through = float(np.trapezoid(density, sizes))
    rate = math.pi * diameter * length * through
    assert 1.0 - math.exp(-rate * time) == pytest.approx(allowed, rel=1e-4)
    assert tethers.cut_rate(diameter, length, through) == pytest.approx(rate)
    with pytest.raises(ValueError, match="exponent above 1"):
        tethers.diameter_for_cuts(allowed, time, length, flux, size, 0.9)
