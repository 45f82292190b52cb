"""Units of an FMU, by its own unit definitions: the way to SI and the dimension.

FMI 2.0 says of each unit  SI value = factor * value + offset,  in products of powers of the SI base units. A unit that
an FMU names without defining it is taken by its name where that is a known one; otherwise nothing is known of it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

from dcone_cosim.errors import FmuError

BASE = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
"""SI base units of FMI 2.0, in the order of a `Dimension`."""

Dimension = tuple[int, ...]
"""Exponent of every unit of `BASE`."""

PURE: Dimension = (0,) * len(BASE)

TEMPERATURE: Dimension = tuple(int(name == "K") for name in BASE)

_NAMED: Mapping[Dimension, str] = {
    PURE: "1",
    (1, 1, -2, 0, 0, 0, 0, 0): "N",
    (1, -1, -2, 0, 0, 0, 0, 0): "Pa",
    (1, 2, -3, 0, 0, 0, 0, 0): "W",
    (1, 2, -2, 0, 0, 0, 0, 0): "J",
    (1, 1, -1, 0, 0, 0, 0, 0): "N.s",
    (1, 0, -2, 0, 0, 0, 0, 0): "N/m",
}


_SYMBOLS: Mapping[str, Dimension] = {
    **{name: tuple(int(name == base) for base in BASE) for name in BASE},
    **{name: dimension for dimension, name in _NAMED.items() if name.isalnum()},
    "Hz": (0, 0, -1, 0, 0, 0, 0, 0),
}
"""Unit symbols that need no factor."""

_TURNS = re.compile(r"([a-zA-Z]?Hz|rp[ms]|(rev|revs|revolutions?|turns?|cycles?)\b)", re.ASCII)
"""Names of units that count turns."""


@dataclass(frozen=True)
class Unit:
    """A unit as an FMU declares it.

    dimension    None when nothing is known of it; then its values are taken as they are
    factor       SI value = factor * value + offset
    relative     its values are differences (relativeQuantity), to which no offset is added
    """

    name: str
    dimension: Dimension | None = None
    factor: float = 1.0
    offset: float = 0.0
    relative: bool = False

    def of_differences(self) -> Unit:
        """The same unit for differences: 10 degC are 10 K then, and not 283.15 K."""
        return replace(self, offset=0.0, relative=True)

    @property
    def is_si(self) -> bool:
        """Whether its values are SI values already."""
        return self.factor == 1.0 and self.offset == 0.0

    @property
    def counts_turns(self) -> bool:
        """Whether it is a frequency by its name, with no angle in its dimension."""
        return self.dimension is not None and self.dimension[-1] == 0 and _TURNS.match(self.name) is not None

    @property
    def si_name(self) -> str:
        """Name of the SI unit its values are converted to; its own name when it is one."""
        return self.name if self.is_si or self.dimension is None else si_name(self.dimension)


NO_UNIT = Unit("1")


def si_name(dimension: Dimension) -> str:
    """FMI name of the SI unit of a dimension: "N", "kg.m2", "m/s2"."""
    if dimension in _NAMED:
        return _NAMED[dimension]
    over = ".".join(_power(base, power) for base, power in zip(BASE, dimension, strict=True) if power > 0)
    under = [_power(base, -power) for base, power in zip(BASE, dimension, strict=True) if power < 0]
    if not under:
        return over
    return f"{over or 1}/{under[0]}" if len(under) == 1 else f"{over or 1}/({'.'.join(under)})"


def _power(base: str, power: int) -> str:
    return base if power == 1 else f"{base}{power}"


def same_dimension(one: Dimension | None, other: Dimension | None) -> bool:
    """Whether values of the two can be one another's; a dimension that is not known fits all. An angle is a number."""
    return one is None or other is None or one[:-1] == other[:-1]


def misfit(one: Unit, other: Unit) -> str:
    """Why values of the one unit cannot be those of the other, or "".

    A unit that counts turns, such as Hz, fits no angular speed unless it is defined with its radians: a turn taken for
    a radian is off by 2 pi, and by the dimension alone the two are the same.
    """
    if not same_dimension(one.dimension, other.dimension):
        return "different dimensions"
    if TEMPERATURE == one.dimension == other.dimension and one.relative != other.relative:
        return "a difference of temperature (relativeQuantity) is no temperature"
    for turns, angle in ((one, other), (other, one)):
        if turns.counts_turns and angle.dimension is not None and angle.dimension[-1] != 0:
            return (
                f"{turns.name} counts turns, {angle.name} an angle, 2 pi for each turn; "
                f"expected a unit {turns.name} that its FMU defines with rad and with a factor, or a gain between them"
            )
    return ""


def spoken_dimension(dimension: Dimension | None) -> str:
    """A dimension for a message: "m/s", "a pure number"."""
    if dimension is None:
        return "not known"
    return "a pure number" if dimension == PURE else si_name(dimension)


def read_units(definitions: Iterable[Any], file: str) -> dict[str, Unit]:
    """The units an FMU defines, by name, from its `UnitDefinitions` as fmpy reads them.

    Raises `FmuError` for a factor that is zero or no number, which has no way back.
    """
    units = {}
    for given in definitions:
        base = given.baseUnit
        if base is None:
            units[given.name] = by_name(given.name)
            continue
        try:
            factor, offset = float(base.factor), float(base.offset)
            dimension = tuple(int(getattr(base, name)) for name in BASE)
        except ValueError as error:
            raise FmuError(f"{file}: its unit {given.name!r} cannot be read ({error})") from None
        if factor == 0.0 or not math.isfinite(factor) or not math.isfinite(offset):
            raise FmuError(f"{file}: its unit {given.name!r} has the factor {factor:g} and the offset {offset:g} to SI")
        units[given.name] = Unit(given.name, dimension, factor, offset)
    return units


def _of_symbols(name: str) -> Dimension | None:
    """Dimension of a product of SI symbols such as "N.s/m" or "kg.m2", None for any other name."""
    found = list(PURE)
    over, *under = name.split("/")
    if len(under) > 1:
        return None
    for sign, part in ((1, over), *((-1, part) for part in under)):
        for piece in part.strip("()").split("."):
            match = re.fullmatch(r"([A-Za-z]+|1)(-?\d+)?", piece)
            if match is None or match[1] not in _SYMBOLS:
                return None
            power = sign * int(match[2] or 1)
            found = [n + power * p for n, p in zip(found, _SYMBOLS[match[1]], strict=True)]
    return tuple(found)


@lru_cache(maxsize=256)
def by_name(name: str) -> Unit:
    """A unit that an FMU names and does not define, taken by its name; of an unknown name nothing is known."""
    if name in ("", "1", "-"):
        return NO_UNIT
    dimension = _of_symbols(name)
    if dimension is not None:
        return Unit(name, dimension)
    from astropy import units  # slow to load, and only an FMU without unit definitions needs it

    try:
        unit = units.Unit(name.replace(".", " ") if "(" not in name else name)
        base = unit.decompose(bases=[getattr(units, b) for b in BASE])
    except (ValueError, TypeError, units.UnitConversionError):
        return Unit(name)
    exponents = {b.to_string(): p for b, p in zip(base.bases, base.powers, strict=True)}
    if not all(b in BASE and p == int(p) for b, p in exponents.items()):
        return Unit(name)
    factor = 1.0 if math.isclose(base.scale, 1.0, rel_tol=1e-14) else float(base.scale)
    return Unit(name, tuple(int(exponents.get(b, 0)) for b in BASE), factor)
