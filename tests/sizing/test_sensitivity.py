"""Slopes of known laws, with and without scatter, and those of a snap."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from dcone_cosim.sizing.result import Sizing
from dcone_cosim.sizing.sensitivity import moved, slope
from dcone_cosim.sizing.uncertain import Uncertain


def test_a_power_law_has_its_power_and_no_error() -> None:
    shares = [0.98, 0.99, 1.0, 1.01, 1.02]
    found, error = slope(shares, [7.0 * share**-1.5 for share in shares])
    assert found == pytest.approx(-1.5, rel=1e-12)
    assert error < 1e-10


def test_the_error_tells_the_scatter() -> None:
    """Slopes found in noise lie about the true one as far as the error says."""
    rng = np.random.default_rng(5)
    shares = np.linspace(0.98, 1.02, 7)
    found = [slope(shares, np.exp(0.5 * np.log(shares) + 0.02 * rng.normal(size=7))) for _ in range(500)]
    off = np.array([one - 0.5 for one, _ in found])
    assert float(np.mean(off)) == pytest.approx(0.0, abs=0.1)
    assert float(np.sqrt(np.mean([error**2 for _, error in found]))) == pytest.approx(float(np.std(off)), rel=0.1)


def test_values_are_moved_both_ways() -> None:
    """By two hundredths, about the scene's own; a choice is not, nor what is zero."""
    ground: Any = SimpleNamespace(values={"x": 5.0, "y": 0.0})
    numbers = [Uncertain(name, name, ({name: 0.0}, {name: 1.0}), ("", ""), "") for name in ("x", "y")]
    choice = Uncertain("c", "c", ({"x": 0.0}, {"x": 1.0}), ("", ""), "", smooth=False)
    found = moved(ground, [*numbers, choice], 3)
    assert list(found) == ["x"]
    assert [share for share, _ in found["x"]] == pytest.approx([0.98, 1.0, 1.02])
    assert [values["x"] for _, values in found["x"]] == pytest.approx([4.9, 5.0, 5.1])


def test_no_peak_no_slope() -> None:
    assert all(math.isnan(value) for value in slope([0.9, 1.0, 1.1], [1.0, 0.0, 1.0]))
    assert all(math.isnan(value) for value in slope([0.9, 1.1], [1.0, 1.0]))


def test_of_a_snap(done: Sizing) -> None:
    """The peak of a snap at a given speed goes with the diameter and with the root of E and of the reduced mass."""
    found = done["sensitivities"].set_index("what")
    assert found["first"]["line diameter"] == pytest.approx(1.0, abs=0.01)
    assert found["first"]["line stiffness E"] == pytest.approx(0.5, abs=0.01)
    assert found["first"]["debris mass"] == pytest.approx(1.0 / 3.0, abs=0.02), "m_r grows with m_c/(m_c + m_t)"
    assert (found["first_error"] >= 0.0).all()
