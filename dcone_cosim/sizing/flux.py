"""Particles that cut a line: a power law, or a table, of how many are larger than a size.

Checked  tests/sizing/test_governs.py
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from orbital import tethers

YEAR = 365.25 * 86400.0
CUTS = 3.0
"""Diameter of a line over that of the least particle that cuts it [1]."""
SOURCE = (
    "1.05e-5 (d/cm)^-2.5 per m2 and year, the small particles of Kessler, Reynolds and Anz-Meador, NASA TM 100471 "
    "(1989), as others cite it (it could not be read), without its factors for altitude, inclination and year, each "
    "within 3 of one in low orbit; where this load governs, give the flux of ORDEM or MASTER for the orbit in "
    "[sizing]: ECSS-E-ST-10-04C, table J-3, has MASTER's at 800 km and 98 deg"
)
OFF = 27.0
"""Of the default: three factors left out, each within 3 of one."""
THINNEST, THICKEST = 1e-6, 1.0
"""Between which a diameter is sought in a table [m]."""


@dataclass(frozen=True)
class Flux:
    """Particles larger than a size, through a surface that turns at random, per its area and time.

        f(d) = value (d/size)^-exponent, or by the table, straight in logarithms between its points and beyond them

    off    the factor by which it may be off either way; 1 for one that a scene gives

    value [1/(m2 s)], size [m];  sizes [m], values [1/(m2 s)] of a table, empty for none
    """

    value: float = 1.05e-5 * 0.1**-2.5 / YEAR
    size: float = 1e-3
    exponent: float = 2.5
    sizes: Sequence[float] = ()
    values: Sequence[float] = ()
    source: str = SOURCE
    off: float = OFF

    def of(self, size: float) -> float:
        """f(d) [1/(m2 s)]."""
        if not self.sizes:
            return float(self.value * (size / self.size) ** -self.exponent)
        x, y = np.log(self.sizes), np.log(self.values)
        place = int(np.clip(np.searchsorted(x, math.log(size)), 1, len(x) - 1))
        slope = (y[place] - y[place - 1]) / (x[place] - x[place - 1])
        return float(np.exp(y[place] + slope * (math.log(size) - x[place])))

    def cuts(self, diameter: float, length: float, time: float) -> float:
        """How often a line is cut in a time, in the mean [1]."""
        return tethers.cut_rate(diameter, length, self.of(diameter / CUTS)) * time

    def diameter(self, probability: float, time: float, length: float) -> float:
        """Diameter [m] at which a line is cut in a time with this probability; NaN where none from 1 um to 1 m is."""
        if not self.sizes:
            return tethers.diameter_for_cuts(probability, time, length, self.value, self.size, self.exponent)
        from scipy.optimize import brentq

        allowed = -math.log1p(-probability)

        def surplus(logarithm: float) -> float:
            return math.log(self.cuts(math.exp(logarithm), length, time) / allowed)

        low, high = math.log(THINNEST), math.log(THICKEST)
        if surplus(low) * surplus(high) > 0.0:
            return math.nan
        return math.exp(float(brentq(surplus, low, high, xtol=1e-10)))
