"""Sobol indices and surrogates against the Ishigami function, whose indices are known in closed form."""

from __future__ import annotations

import math
from itertools import islice

import numpy as np
import numpy.typing as npt
import pytest

from dcone_cosim.campaign.explained import Explained, sentences
from dcone_cosim.campaign.sampling import hypercube, monte_carlo, saltelli
from dcone_cosim.campaign.sensitivity import Index, Indices, sobol_indices, surrogates

A, B = 7.0, 0.1
V1, V2, V13 = 0.5 * (1.0 + B * math.pi**4 / 5.0) ** 2, A**2 / 8.0, B**2 * math.pi**8 * 8.0 / 225.0
V = V1 + V2 + V13
FIRST, TOTAL = (V1 / V, V2 / V, 0.0), ((V1 + V13) / V, V2 / V, V13 / V)
NAMES = ("x", "y", "z")
Numbers = npt.NDArray[np.float64]


def ishigami(points: Numbers) -> Numbers:
    """sin x + A sin^2 y + B z^4 sin x, each from -pi to pi."""
    x, y, z = math.pi * (2.0 * points.T - 1.0)
    return np.asarray(np.sin(x) + A * np.sin(y) ** 2 + B * z**4 * np.sin(x))


def test_indices() -> None:
    pytest.importorskip("SALib")
    values = ishigami(np.array(list(saltelli(1, 1024, 3))))
    found = sobol_indices("f", NAMES, values, 0.95, 1)
    assert found is not None
    for place, one in enumerate(found.inputs):
        assert one.first == pytest.approx(FIRST[place], abs=0.03)
        assert one.total == pytest.approx(TOTAL[place], abs=0.03)
        assert abs(one.first - FIRST[place]) <= 1.5 * one.first_error
        assert abs(one.total - TOTAL[place]) <= 1.5 * one.total_error


def test_chaos_has_an_index_of_its_own() -> None:
    """Jitter as an input: noise of a third of the variance, without a pattern, takes part in a third of it."""
    pytest.importorskip("SALib")
    points = np.array(list(saltelli(2, 2048, 3)))
    noise = np.array([np.random.default_rng(int(u * 2**31)).normal() for u in points[:, 2]])
    found = sobol_indices("f", NAMES, points[:, 0] * math.sqrt(12.0) * math.sqrt(2.0) + noise, 0.95, 1)
    assert found is not None
    assert [one.total for one in found.inputs] == pytest.approx([2 / 3, 0.0, 1 / 3], abs=0.04)


def test_what_has_no_indices() -> None:
    pytest.importorskip("SALib")
    points = np.array(list(saltelli(1, 8, 3)))
    assert sobol_indices("f", NAMES, np.ones(len(points)), 0.95, 1) is None
    values = ishigami(points)
    values[7] = math.nan
    found = sobol_indices("f", NAMES, values, 0.95, 1)
    assert found is not None
    assert (found.samples, found.left_out) == (7, 1)


@pytest.mark.parametrize(
    ("cases", "off", "most"), [(150, 0.02, 0.2), pytest.param(400, 0.002, 0.1, marks=pytest.mark.evidence)]
)
def test_surrogates(cases: int, off: float, most: float) -> None:
    """The error that is told is that of cases it has not seen."""
    pytest.importorskip("openturns")
    points = hypercube(1, cases, 3)
    chaos, process = surrogates(NAMES, (False,) * 3, points, ishigami(points))
    assert chaos.error < off
    for place, name in enumerate(NAMES):
        assert chaos.indices[name] == pytest.approx((FIRST[place], TOTAL[place]), abs=off)
    assert process.error < most


def test_indices_that_say_nothing_are_told_so() -> None:
    """Of eight base samples "149 % of its variance (+- 321 %)" was told."""
    few, many = (
        Indices("t", n, 0, (Index("a", 0.2, 0.1, 1.2, error), Index("b", 0.1, 0.1, 0.3, 0.1)))
        for n, error in ((8, 3.21), (512, 0.04))
    )
    assert list(sentences(Explained([few]))) == ["t: 8 base samples are too few to tell what its variance comes from"]
    assert list(sentences(Explained([many]))) == ["t: a takes part in 120 % of its variance (+- 4 %)"]


def test_noise_is_not_explained() -> None:
    """A figure that is half noise: the error says so, and no polynomial is taken for an explanation."""
    pytest.importorskip("openturns")
    points = np.array([monte_carlo(3, number, 2) for number in range(1, 301)])
    noise = np.random.default_rng(1).normal(size=300) * math.sqrt(1.0 / 12.0)
    chaos, process = surrogates(("x", "y"), (False, False), points, points[:, 0] + noise)
    assert chaos.error == pytest.approx(0.5, abs=0.1)
    assert 0.45 < process.error < 1.2, "judged by what it was fitted to, it would explain all"
    few, _ = surrogates(("x", "y"), (False, False), points[:40], noise[:40])
    assert few.error > 0.95, "nothing but noise"
    assert chaos.indices["x"][1] > 0.9


def test_too_few() -> None:
    pytest.importorskip("openturns")
    points = np.array(list(islice((monte_carlo(1, n, 2) for n in range(1, 99)), 10)))
    assert surrogates(("x", "y"), (False, False), points, points[:, 0]) == []
