"""The net's mass from the diameter of its thread; without it, the diameter follows from the mass."""

from __future__ import annotations

import math
from collections.abc import Mapping

from fmu_src.extremes import Extreme
from fmu_src.interface import Term
from fmu_src.net_capture.nets import nets
from fmu_src.rows import positive

OF_FILES = "table"
"""The net whose file says how thick each thread is."""


def net_mass(values: Mapping[str, float], asked: Mapping[str, float], terms: Mapping[str, str]) -> dict[str, float]:
    """Mass of all threads [kg], solid and round: m = rho pi/4 d^2 L.

    values    of the net: sides and mesh, and rho, `net.density` [kg/m3], from which L, the length of all threads
    asked     d, `section.diameter` [m]

    Checked  tests/net_capture/test_section.py
    """
    length = nets()[terms["net"]].checks.total(values)
    return {"net.mass": values["net.density"] * 0.25 * math.pi * asked["section.diameter"] ** 2 * length}


PART = Term(
    "the net's mass is that of threads of a diameter",
    carries={"net": tuple(name for name in nets() if name != OF_FILES)},
    asked=(positive("section.diameter", "m", "of the net's thread, solid and round", 5e-4, display_unit="mm"),),
    design=net_mass,
    extremes=tuple(
        Extreme(
            f"thread of {1e3 * diameter:g} mm",
            "from a single filament to a rope: the net's mass follows with the square",
            "energy_gained",
            {"section.diameter": diameter},
        )
        for diameter in (5e-5, 5e-3)
    ),
)
