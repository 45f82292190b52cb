"""The Earth's magnetic field by IGRF at the epoch, as a table that travels in the FMU: its coefficients to degree 10.

Checked  tests/tethered_deorbit/test_field.py
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from fmu_src.interface import Laid, Undesigned
from fmu_src.tables import Table

DEGREE = 10
"""What lies beyond is less than 0.3 % of the field above 500 km."""
NAME = "electrodynamic.coefficients"
TABLE = Table(NAME, "T", "g and h of polynomials that are not normalised, by degree and order", 3)


def table(epoch: float) -> npt.NDArray[np.float64]:
    """The coefficients (2, 11, 11) [T] at a time, UTC since 2000-01-01 12:00 [s]; between five years, straight.

    `Undesigned` without ppigrf, or at a time of which it knows nothing.
    """
    try:
        from ppigrf import ppigrf
    except ImportError:
        raise Undesigned("electrodynamic.field", "igrf", "needs ppigrf: pip install 'dcone-cosim[field]'") from None
    cosines, sines = ppigrf.read_shc()
    times = (cosines.index.to_numpy() - np.datetime64("2000-01-01T12:00:00")) / np.timedelta64(1, "s")
    if not times[0] <= epoch <= times[-1]:
        years = f"{cosines.index[0].year} to {cosines.index[-1].year}"
        raise Undesigned("orbit.epoch", f"{epoch:g} s", f"a time of which IGRF tells, {years}")
    found = np.zeros((2, DEGREE + 1, DEGREE + 1))
    for part, frame in enumerate((cosines, sines)):
        for n in range(1, DEGREE + 1):
            for m in range(n + 1):
                semi = math.sqrt((1 if m == 0 else 2) * math.factorial(n - m) / math.factorial(n + m))
                found[part, n, m] = 1e-9 * semi * np.interp(epoch, times, frame[n, m].to_numpy(dtype=float))
    return found


def lay(values: Mapping[str, float], sources: Mapping[str, Any]) -> Laid:
    """The table of the scene's epoch."""
    return Laid({NAME: table(values["orbit.epoch"])}, {})
