"""One choice of terms for what low orbits have: air by its table, a line that conducts, and one that is cut."""

from __future__ import annotations

from functools import cache
from typing import Any

import pytest

from fmu_src.instance import Instance
from fmu_src.tethered_deorbit import air_table
from fmu_src.tethered_deorbit.interface import MODEL

TERMS = {
    "reel": "locked",
    "thrust": "along_track",
    "release": "time",
    "air": "nrlmsis",
    "electrodynamic": "dipole",
}
EPOCH = 9574.6 * 86400.0
"""2026-03-20 02:24 UTC."""


@cache
def table() -> Any:
    pytest.importorskip("pymsis")
    return air_table.table(EPOCH, 150.0, 140.0, 12.0)


def tow(**values: Any) -> Instance:
    """On 5 km of line along the vertical, the thruster off."""
    told = {
        "thrust.level": 0.0, "orbit.epoch": EPOCH, "orbit.altitude": 500e3, "orbit.inclination": 0.9,
        "start.condition": 3, "start.relative_position[1]": 4990.0, "tether.rest_length": 5000.0, "release.at": 1e9,
    }  # fmt: skip
    told |= {name.replace("__", "."): value for name, value in values.items()}
    return Instance(MODEL, TERMS, told, tables={air_table.NAME: table()}).initialise()
