"""One figure that a run found: SI for machines, and as a person reads it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

SAMPLE = "~"
"""Before a figure that is one sample of many."""

PAGE = 4
"""Digits of a figure in a page."""
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")

SHOWN_IN = {
    "%": 1e-2,
    "MPa": 1e6,
    "mm/s": 1e-3,
    "mm": 1e-3,
    "km": 1e3,
    "\u00b5s": 1e-6,
    "m/day": 1.0 / 86400.0,
    "deg/s": math.pi / 180.0,
    "deg": math.pi / 180.0,
    "day": 86400.0,
    "yr": 365.25 * 86400.0,
}
"""Units that a person reads more easily, and how much of the SI unit each is."""
READ_IN = {"rad": "deg", "rad/s": "deg/s", "Pa": "MPa"}
"""Units in which a person reads any figure that has not one of its own."""
SMALL, FAR, SHORT = 1e-2, 1e4, 1e-3
"""Lengths below and from which a person reads mm and km [m], and times below which microseconds [s]."""


class Reading(NamedTuple):
    """A unit as a person reads it, "" for a pure number, and how much of the SI unit it is."""

    name: str
    factor: float = 1.0

    def from_si(self, value: float) -> float:
        return value / self.factor


def reading(unit: str, shown_in: str = "", size: float = math.nan) -> Reading:
    """In which unit a person reads a figure: the one rule of all summaries, tables, pages and pictures.

    unit        of the figure, SI
    shown_in    the figure's own, one of `SHOWN_IN`; "" for none
    size        of the figure in its unit; of several the mean, or the largest

    Checked  tests/cosim/test_readings.py
    """
    name, size = shown_in or READ_IN.get(unit, ""), abs(size)
    if not name and unit == "m" and (0.0 < size < SMALL or size >= FAR):
        name = "mm" if size < SMALL else "km"
    if not name and unit == "s" and 0.0 < size < SHORT:
        name = "\u00b5s"
    return Reading(name, SHOWN_IN[name]) if name else Reading("" if unit == "1" else unit)


@dataclass(frozen=True)
class Finding:
    """One line of the summary.

    phase       or "hand-off", under which it is told
    key         its name for machines
    value       SI, or a text
    unit        SI, "" for a pure number or a text
    spread      standard deviation over mean of one sample of a chaotic figure, 0 for any other   [1]
    shown_in    one of `SHOWN_IN`, in which a person reads it; "" for that of `reading`
    """

    phase: str
    key: str
    label: str
    value: float | int | str
    unit: str = ""
    spread: float = 0.0
    shown_in: str = ""

    def shown(self) -> str:
        """The figure with the digits that hold, and its unit."""
        if isinstance(self.value, str):
            return self.value
        if isinstance(self.value, int) and not self.spread:
            return f"{self.value:d} {self.unit}".rstrip()
        read = self.read
        return f"{SAMPLE if self.spread else ''}{digits(read.from_si(self.value), self.spread)} {read.name}".rstrip()

    @property
    def read(self) -> Reading:
        """The unit in which a person reads it, be it in a table of many."""
        if isinstance(self.value, str | int):
            return reading(self.unit, self.shown_in)
        return reading(self.unit, self.shown_in, self.value)


def spoken(value: float, spread: float = 0.0, most: int = PAGE) -> str:
    """A number as every page has it: `most` digits, or fewer where fewer hold, and then with `SAMPLE` before it.

    Thousands are parted from 10,000 on; powers of ten are told below 1e-4 and from 1e6 on alone. `spoken` of
    `templates/scripts/bytes.js` says the same.

    spread    as `Finding` has it

    Checked  tests/report/test_browser.py: both, against one another
    """
    if not math.isfinite(value):
        return "not known"
    if not value:
        return "0"
    mark = (SAMPLE if value > 0.0 else f"{SAMPLE}\u00a0") if spread else ""
    leading = math.floor(math.log10(abs(float(f"{value:.{most - 1}e}"))))
    place = leading - most + 1
    if spread:
        place = max(place, min(math.floor(math.log10(2.0 * spread * abs(value))), leading))
    if not -4 <= leading < 6:
        text = f"{value / 10.0**leading:.{leading - place}f}"
        text = text if spread or "." not in text else text.rstrip("0").rstrip(".")
        return f"{mark}{text} · 10{str(leading).translate(RAISED)}"
    rounded = round(value, -place)
    text = f"{rounded:{',' if leading >= 4 else ''}.{max(-place, 0)}f}"
    return f"{mark}{text if spread or '.' not in text else text.rstrip('0').rstrip('.')}"


def digits(value: float, spread: float, most: int = 6) -> str:
    """A number with the digits that hold: its last one is the first whose half unit is below the spread.

        unit = 10^n,   n = floor(log10(2 s |x|)), s the relative spread

    A zero before or behind the point that holds is kept: 10.0 is better known than 10.
    """
    if not (math.isfinite(value) and value and spread):
        return f"{value:.{most}g}"
    leading = math.floor(math.log10(abs(value)))
    place = min(math.floor(math.log10(2.0 * spread * abs(value))), leading)
    if leading - place >= most - 1:
        return f"{value:.{most}g}"
    if not 1e-4 <= abs(value) < 1e6:
        return f"{value:.{max(leading - place, 0)}e}"
    return f"{round(value, -place):.{max(-place, 0)}f}"
