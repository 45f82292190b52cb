"""One figure that a run found: SI for machines, and as a person reads it."""

from __future__ import annotations

import math
from dataclasses import dataclass

SAMPLE = "~"
"""Before a figure that is one sample of many."""

PAGE = 4
"""Digits of a figure in a page."""
RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")

SHOWN_IN = {
    "%": 1e-2,
    "MPa": 1e6,
    "mm/s": 1e-3,
    "km": 1e3,
    "m/day": 1.0 / 86400.0,
    "deg/s": math.pi / 180.0,
    "deg": math.pi / 180.0,
    "day": 86400.0,
    "yr": 365.25 * 86400.0,
}
"""Units that a person reads more easily, and how much of the SI unit each is."""


@dataclass(frozen=True)
class Finding:
    """One line of the summary.

    phase       or "hand-off", under which it is told
    key         its name for machines
    value       SI, or a text
    unit        SI, "" for a pure number or a text
    spread      standard deviation over mean of one sample of a chaotic figure, 0 for any other   [1]
    shown_in    one of `SHOWN_IN`, in which a person reads it; "" for the SI unit
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
            number = f"{self.value:d}"
        else:
            number = digits(self.value / (SHOWN_IN[self.shown_in] if self.shown_in else 1.0), self.spread)
        return f"{SAMPLE if self.spread else ''}{number} {self.shown_in or self.unit}".rstrip()


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
