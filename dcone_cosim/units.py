"""What a unit is, whoever names it: an FMU or a package of SSP by its own definition, a scene by its symbol.

FMI 2.0 says of each unit  SI value = factor * value + offset,  in products of powers of the SI base units. A unit that
is named without a definition is taken by its name where that is a known one; otherwise nothing is known of it.
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

_SCALED = """
    mm 1e-3 m; cm 1e-2 m; km 1e3 m; um 1e-6 m; AU 149597870700 m; l 1e-3 m3
    ms 1e-3 s; min 60 s; h 3600 s; d 86400 s; wk 604800 s; yr 31557600 s; day 86400 s; Hz 1 1/s; g 1e-3 kg; t 1e3 kg
    mrad 1e-3 rad; deg 0.017453292519943295 rad; arcmin 0.0002908882086657216 rad; arcsec 4.84813681109536e-06 rad
    N 1 kg.m/s2; mN 1e-3 N; kN 1e3 N; MN 1e6 N; Pa 1 N/m2; kPa 1e3 Pa; MPa 1e6 Pa; GPa 1e9 Pa; bar 1e5 Pa
    J 1 N.m; mJ 1e-3 J; kJ 1e3 J; MJ 1e6 J; W 1 J/s; mW 1e-3 W; kW 1e3 W; V 1 W/A; ohm 1 V/A; T 1 kg/A.s2; nT 1e-9 T
"""
"""Symbols with their factor and unit. astropy knows them and many more, but takes a fifth of a second to load."""

_PRODUCTS = """
    m2; cm2; mm2; m3; m/s; mm/s; cm/s; km/s; km/h; m/s2; rad/s; deg/s; rad/s2; deg/s2; 1/s; N/m; mN/m; kN/m; N/s
    N s/m; kg/s; N s; kg m/s; N m; N m s; kg/m3; g/cm3; kg m2
"""
"""What a message names as known beside the symbols."""

_NOUNS = """
    length m; area m2; volume m3; speed m/s; acceleration m/s2; mass kg; mass density kg/m3; moment of inertia kg.m2
    time s; frequency 1/s; angle rad; angular speed rad/s; angular acceleration rad/s2; temperature K; pure number 1
    force N; rate of force N/s; stiffness N/m; pressure Pa; energy J; power W; momentum N.s; angular momentum N.m.s
    electrical current A; electrical potential V; electrical resistance ohm; magnetic flux density T
"""
"""What a dimension is called, and a unit of it."""

_CELSIUS = ("degC", "\u00b0C")
"""How people write it, beside astropy's own names."""

_TURNS = re.compile(r"([a-zA-Z]?Hz|rp[ms]|(rev|revs|revolutions?|turns?|cycles?)\b)", re.ASCII)
"""Names of units that count turns."""


@dataclass(frozen=True)
class Unit:
    """One unit.

    dimension    None when nothing is known of it; then its values are taken as they are
    factor       SI value = factor * value + offset
    relative     its values are differences (relativeQuantity), to which no offset is added
    """

    name: str
    dimension: Dimension | None = None
    factor: float = 1.0
    offset: float = 0.0
    relative: bool = False

    @classmethod
    def defined(cls, name: str, base: Mapping[str, Any]) -> Unit:
        """The unit that a `BaseUnit` of FMI or SSP defines by these attributes.

        Raises `ValueError` for a factor that is zero or no number, which has no way back.
        """
        factor, offset = float(base.get("factor", 1.0)), float(base.get("offset", 0.0))
        if factor == 0.0 or not math.isfinite(factor) or not math.isfinite(offset):
            raise ValueError(f"it has the factor {factor:g} and the offset {offset:g} to SI")
        return cls(name, tuple(int(base.get(key, 0)) for key in BASE), factor, offset)

    @property
    def definition(self) -> dict[str, str]:
        """Attributes of the `BaseUnit` that defines it."""
        found = {key: str(power) for key, power in zip(BASE, self.dimension or PURE, strict=True) if power}
        if self.factor != 1.0:
            found["factor"] = repr(self.factor)
        if self.offset != 0.0:
            found["offset"] = repr(self.offset)
        return found

    def of_differences(self) -> Unit:
        """The same unit for differences: 10 degC are 10 K then, and not 283.15 K."""
        return replace(self, offset=0.0, relative=True)

    def to_si(self, value: float) -> float:
        return value if self.is_si else self.factor * value + self.offset

    def from_si(self, value: float) -> float:
        return value if self.is_si else (value - self.offset) / self.factor

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

    @property
    def noun(self) -> str:
        """What it measures, with its article: "a length", "an angle"; the unit where there is no word for that."""
        noun = _NOUN.get(self.dimension or PURE, f"quantity in {spoken(self.name)}")
        return f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}"


NO_UNIT = Unit("1")


_SYMBOLS: dict[str, tuple[float, Dimension]] = {
    "1": (1.0, PURE),
    **{name: (1.0, tuple(int(name == base) for base in BASE)) for name in BASE},
}
"""Factor and dimension of every symbol that `_product` knows."""


def _product(name: str) -> tuple[float, Dimension]:
    """Factor and dimension of a product of symbols such as "N.s/m" or "kg m2"; `ValueError` for any other name."""
    factor, dimension = 1.0, PURE
    over, *under = name.split("/")
    if len(under) > 1:
        raise ValueError(f"{name!r} has more than one slash")
    for sign, part in ((1, over or "1"), *((-1, part) for part in under)):
        for piece in re.split("[ .]", part.strip().removeprefix("(").removesuffix(")")):
            match = re.fullmatch(r"([A-Za-z]+|1)(-?\d)?", piece, re.ASCII)
            if match is None or match[1] not in _SYMBOLS:
                raise ValueError(f"{piece!r} is not a symbol with a power")
            power, (of, powers) = sign * int(match[2] or 1), _SYMBOLS[match[1]]
            factor *= of**power
            dimension = tuple(n + power * p for n, p in zip(dimension, powers, strict=True))
    if not 0.0 < factor < math.inf:
        raise ValueError(f"{name!r} is beyond all numbers")
    return factor, dimension


def _rows(table: str) -> list[list[str]]:
    """Rows of a table, each as what stands before its last word, and that word."""
    return [row.strip().rsplit(maxsplit=1) for row in re.split("[;\n]", table.strip())]


for _scaled, _of in _rows(_SCALED):
    _symbol, _number = _scaled.split()
    _factor, _dimension = _product(_of)
    _SYMBOLS[_symbol] = float(_number) * _factor, _dimension

_NOUN = {_product(name)[1]: noun for noun, name in _rows(_NOUNS)}
_SI_NAME = {_product(name)[1]: name for name in ("1", "N", "Pa", "W", "J", "N.s", "N/m")}


@lru_cache(maxsize=256)
def named(name: str) -> Unit | None:
    """The unit of a name such as "N.s/m", "km / h" or "deg_C", None for a name that is not known."""
    try:
        factor, dimension = _product(name)
    except ValueError:
        return _of_astropy(name)
    return Unit(name, dimension, factor)


def _of_astropy(name: str) -> Unit | None:
    from astropy import units

    if name in _CELSIUS:
        name = "deg_C"
    try:
        unit = units.Unit(name.replace(".", " ") if "(" not in name else name)
        if unit == units.deg_C:
            return Unit(name, TEMPERATURE, 1.0, 273.15)
        base = unit.decompose(bases=[getattr(units, b) for b in BASE])
    except (ValueError, TypeError, ArithmeticError, units.UnitConversionError):
        return None
    powers = {b.to_string(): p for b, p in zip(base.bases, base.powers, strict=True)}
    if not all(b in BASE and p == int(p) for b, p in powers.items()) or not 0.0 < base.scale < math.inf:
        return None
    factor = 1.0 if math.isclose(base.scale, 1.0, rel_tol=1e-14) else float(base.scale)
    return Unit(name, tuple(int(powers.get(b, 0)) for b in BASE), factor)


def by_name(name: str) -> Unit:
    """A unit that an FMU names and does not define, taken by its name; of an unknown name nothing is known."""
    return NO_UNIT if name in ("", "1", "-") else named(name) or Unit(name)


def like(unit: Unit) -> list[str]:
    """Names of the common units of the same dimension, for a message; its own if there are none."""
    known = (*_SYMBOLS, "deg_C", *(name.strip() for name in re.split("[;\n]", _PRODUCTS.strip())))
    found = [name for name in known if by_name(name).dimension == unit.dimension]
    return found or [spoken(unit.name)]


def spoken(name: str) -> str:
    """An FMI unit as a person writes it: "N.m.s" is "N m s", "1/s" is "/s", and "1" is nothing."""
    return name.replace(".", " ").removeprefix("1")


def si_name(dimension: Dimension) -> str:
    """FMI name of the SI unit of a dimension: "N", "kg.m2", "m/s2"."""
    if dimension in _SI_NAME:
        return _SI_NAME[dimension]
    powers = [(base, power) for base, power in zip(BASE, dimension, strict=True) if power]
    over, under = (
        [base if abs(power) == 1 else f"{base}{abs(power)}" for base, power in powers if sign * power > 0]
        for sign in (1, -1)
    )
    divided = f"/({'.'.join(under)})" if len(under) > 1 else "".join(f"/{name}" for name in under)
    return ".".join(over or ["1"]) + divided


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
        return "a difference of temperatures (relativeQuantity) is not a temperature"
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
    """The units an FMU defines, by name, from its `UnitDefinitions` as fmpy reads them."""
    units = {}
    for given in definitions:
        if given.baseUnit is None:
            units[given.name] = by_name(given.name)
            continue
        try:
            base = {key: getattr(given.baseUnit, key) for key in (*BASE, "factor", "offset")}
            units[given.name] = Unit.defined(given.name, base)
        except ValueError as error:
            raise FmuError(f"{file}: its unit {given.name!r} cannot be read: {error}") from None
    return units


def written(value: float, unit: str, digits: int = 6) -> str:
    """An SI value as a scene says it, with so many digits."""
    return f"{value:.{digits}g}" if unit == "1" else f"{value:.{digits}g} {spoken(unit)}"
