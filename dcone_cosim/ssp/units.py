"""Units of SSP and of FMI: base units with exponents, a factor and an offset."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

BASE = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


@dataclass(frozen=True)
class Unit:
    """SI value = factor * value + offset; `exponents` are those of `BASE`."""

    name: str
    exponents: tuple[int, ...] = (0,) * len(BASE)
    factor: float = 1.0
    offset: float = 0.0

    def to_si(self, value: float) -> float:
        """SI value; a unit that is SI leaves the bits alone."""
        return value if self.is_si else self.factor * value + self.offset

    def from_si(self, value: float) -> float:
        return value if self.is_si else (value - self.offset) / self.factor

    @property
    def is_si(self) -> bool:
        return self.factor == 1.0 and self.offset == 0.0

    def fits(self, other: Unit) -> bool:
        """Whether values can be converted; angles count as pure numbers, as in the base units of SI."""
        return self.exponents[:-1] == other.exponents[:-1]


def units_of(description: Any) -> dict[str, Unit]:
    """Units that a model description defines by base units, by name."""
    found = {}
    for row in description.unitDefinitions:
        base = row.baseUnit
        if base is not None:
            exponents = tuple(int(getattr(base, name) or 0) for name in BASE)
            found[row.name] = Unit(row.name, exponents, float(base.factor), float(base.offset))
    return found


def read_unit(name: str, attributes: Mapping[str, str]) -> Unit:
    """A unit from the attributes of its `BaseUnit` element."""
    exponents = tuple(int(attributes.get(base, 0)) for base in BASE)
    return Unit(name, exponents, float(attributes.get("factor", 1.0)), float(attributes.get("offset", 0.0)))
