"""A debris as a command line says it, "1000 kg, 3.9 m" or "8000 kg, 25 x 10 x 5 m", and what is proposed for it."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from dcone_cosim.errors import InputError
from dcone_cosim.scene.expected import number_and_unit
from dcone_cosim.units import named

FORM = 'expected a mass and a length, or a mass and three lengths, such as "1000 kg, 3.9 m" or "8000 kg, 25 x 10 x 5 m"'
SLENDER = 2.5 / 3.9
"""Width and depth of a debris of which the length alone is told, over that length [1]: those of the scene `mission`."""
MASSES, LENGTHS = (1.0, 1e6), (0.1, 1e3)
"""Least and largest mass [kg] and length [m] for which anything is proposed."""
_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"


@dataclass(frozen=True)
class Debris:
    """Mass [kg], and size [m], the greatest length first; `shaped` when all three were told."""

    mass: float
    size: tuple[float, float, float]
    shaped: bool

    @property
    def length(self) -> float:
        return self.size[0]

    @property
    def text(self) -> str:
        size = " x ".join(f"{length:g}" for length in (self.size if self.shaped else self.size[:1]))
        return f"{self.mass:g} kg, {size} m"


def read(text: str) -> Debris:
    """The debris of a text, or `InputError` that says what is wrong with which part of it."""
    parts = [part.strip() for part in text.split(",")]
    if len(parts) != 2 or not all(parts):
        raise InputError(f"--debris {text!r}: {FORM}")
    mass = _quantity(text, parts[0], "kg", "a mass", *MASSES)
    sizes = [piece.strip() for piece in re.split(rf"(?<=[\d.\sa-z])x(?=\s*{_NUMBER})", parts[1])]
    if len(sizes) not in (1, 3):
        raise InputError(f"--debris {text!r}: {parts[1]!r} has {len(sizes)} lengths, not 1 or 3; {FORM}")
    unit = (number_and_unit(sizes[-1]) or (0.0, ""))[1]
    lengths = [
        _quantity(text, s if (number_and_unit(s) or (0, ""))[1] else f"{s} {unit}", "m", "a length", *LENGTHS)
        for s in sizes
    ]
    if len(lengths) == 1:
        (length,) = lengths
        return Debris(mass, (length, SLENDER * length, SLENDER * length), False)
    first, second, third = sorted(lengths, reverse=True)
    return Debris(mass, (first, second, third), True)


def _quantity(whole: str, text: str, unit: str, what: str, least: float, most: float) -> float:
    number, name = number_and_unit(text) or (math.nan, "")
    if math.isnan(number):
        raise InputError(f"--debris {whole!r}: {text!r} is not {what} with its unit; {FORM}")
    if not name:
        raise InputError(f"--debris {whole!r}: {text!r} has no unit; {FORM}")
    known, wanted = named(name), named(unit)
    assert wanted is not None
    if known is None:
        raise InputError(f"--debris {whole!r}: {text!r} has the unit {name!r}, which is not known; {FORM}")
    if known.dimension != wanted.dimension:
        raise InputError(f"--debris {whole!r}: {text!r} is {known.noun}, not {what}; {FORM}")
    value = known.to_si(number)
    if not least <= value <= most:
        raise InputError(f"--debris {whole!r}: {text!r} is not {what} from {least:g} to {most:g} {unit}; {FORM}")
    return value
