"""Which load governs, and how often debris cuts a line."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from dcone_cosim.sizing.flux import YEAR, Flux
from dcone_cosim.sizing.governs import CUT, DASHPOT, HANDLING, SNAP, STEADY, demands
from dcone_cosim.sizing.options import Options
from dcone_cosim.sizing.required import Required
from orbital.materials import MATERIALS

KEVLAR = MATERIALS["Kevlar 29"]
NEEDED = Required(KEVLAR, 1e-4, 1e-4, 10.0, 1e-3, 0.0, 1e-4, 5)


def of(**changes: float) -> dict[str, float]:
    """Diameter [m] by load, the governing one first."""
    given = {"zeta": 0.05, "steady": 0.1, "length": 12.0, "time": 1.0, "handling": 0.0, **changes}
    options = replace(Options(), least_breaking_load=given["handling"])
    found = demands(NEEDED, given["zeta"], given["steady"], given["length"], given["time"], options)
    return {one.load: one.diameter for one in found}


def test_each_can_govern() -> None:
    assert next(iter(of())) == SNAP
    assert next(iter(of(zeta=0.6))) == DASHPOT
    assert next(iter(of(steady=500.0))) == STEADY
    assert next(iter(of(handling=500.0))) == HANDLING
    assert next(iter(of(time=3.0 * YEAR))) == CUT


def test_what_a_load_asks_for() -> None:
    assert KEVLAR.strength is not None
    found = of(steady=100.0, handling=100.0)
    assert KEVLAR.strength * math.pi * found[STEADY] ** 2 / 4.0 == pytest.approx(200.0), "with the factor of safety"
    assert KEVLAR.strength * math.pi * found[HANDLING] ** 2 / 4.0 == pytest.approx(100.0), "which handling has in it"


def test_default_flux() -> None:
    """1.05e-5 per m2 and year at 1 cm, 316 times that at 1 mm."""
    assert Flux().of(1e-2) == pytest.approx(1.05e-5 / YEAR)
    assert Flux().of(1e-3) == pytest.approx(1.05e-5 / YEAR * 10.0**2.5)


def test_a_year_is_julian() -> None:
    assert YEAR == 31_557_600.0


def test_a_table_that_is_a_power_law_says_the_same() -> None:
    law = Flux()
    sizes = [1e-4, 1e-3, 1e-2]
    table = Flux(sizes=sizes, values=[law.of(size) for size in sizes])
    for size in (2e-5, 3e-4, 5e-3, 0.1):
        assert table.of(size) == pytest.approx(law.of(size), rel=1e-9)
    assert table.diameter(0.01, YEAR, 100.0) == pytest.approx(law.diameter(0.01, YEAR, 100.0), rel=1e-6)
    steeper = Flux(sizes=sizes, values=[law.of(1e-4), law.of(1e-3), 0.1 * law.of(1e-2)])
    assert steeper.of(5e-3) < 0.5 * law.of(5e-3)


def test_a_line_of_that_diameter_is_cut_as_often_as_allowed() -> None:
    """Particles come at random: the share of lines that none has cut."""
    diameter = Flux().diameter(0.2, YEAR, 100.0)
    mean = math.pi * diameter * 100.0 * YEAR * Flux().of(diameter / 3.0)
    cuts = np.random.default_rng(1).poisson(mean, 200_000)
    assert float(np.mean(cuts > 0)) == pytest.approx(0.2, abs=5e-3)
