"""Values of a scene: what a key expects, and how a text with a unit becomes an SI number.

A dimensional value is a string with its unit ("24 m", "5 deg/s"); a pure number is bare. A bare number for a length, or
a mass where a length belongs, is thus an error that can name what was expected.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import astropy.units as u

LARGEST_INTEGER = 2**31 - 1
"""An FMI Integer has 32 bits."""
_QUANTITY = re.compile(r"\s*([+-]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|nan|inf))\s*([^\d\s].*)?", re.DOTALL)
"""A number, and a unit that does not begin with another number."""

COMMON = (
    *("m", "mm", "cm", "km", "um", "AU", "s", "ms", "min", "h", "d", "wk", "yr", "kg", "g", "t", "K", "deg_C"),
    *("rad", "mrad", "deg", "arcmin", "arcsec", "m2", "cm2", "mm2", "m3", "l", "m/s", "mm/s", "cm/s", "km/s", "km/h"),
    *(
        "rad/s",
        "deg/s",
        "1/s",
        "Hz",
        "rad/s2",
        "deg/s2",
        "m/s2",
        "N",
        "mN",
        "kN",
        "MN",
        "Pa",
        "kPa",
        "MPa",
        "GPa",
        "bar",
    ),
    *("N/m", "mN/m", "kN/m", "N s/m", "kg/s", "N s", "kg m/s", "N m", "N m s", "J", "mJ", "kJ", "MJ", "W", "mW", "kW"),
    *("kg/m3", "g/cm3", "kg m2", "N/s", "A", "V", "ohm"),
)
"""Units that a message names as known, smallest words first."""
TEXT = "String"
"""Kind of a variable whose values are texts."""


class Unexpected(ValueError):
    """A value that does not fit; the text says what was expected."""


@lru_cache(maxsize=256)
def unit_of(fmi_unit: str) -> Any:
    """The astropy unit of an FMI unit name such as "N.s/m"."""
    return u.dimensionless_unscaled if fmi_unit == "1" else u.Unit(fmi_unit)


def is_unit(name: str, like: str) -> bool:
    """Whether a name is that of a unit of the same dimension as another, and as large."""
    try:
        return bool(unit_of(name) == unit_of(like))
    except (ValueError, TypeError):
        return False


def spoken(fmi_unit: str) -> str:
    """An FMI unit as a person writes it: "N.m.s" is "N m s"."""
    return fmi_unit.replace(".", " ").replace("1/s", "/s") if fmi_unit != "1" else ""


def dimension_of(unit: Any) -> str:
    """Name of the dimension, the shortest astropy knows: "length", "pressure"; the unit itself when it has no name."""
    if unit.is_equivalent(u.N / u.m):
        return "stiffness"  # astropy knows it as a spectral flux density
    if unit.is_equivalent(u.dimensionless_unscaled):
        return "pure number"
    names = [name for name in unit.physical_type if name != "unknown"]
    preferred = {"speed", "pressure", "torque", "energy", "angular speed", "momentum", "force", "mass density"}
    chosen = [name for name in names if name in preferred] or sorted(names, key=len)
    return chosen[0] if chosen else f"quantity in {unit}"


def _article(noun: str) -> str:
    return f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}"


ANY = -1
"""Size of a list that may have any number of elements."""


@dataclass(frozen=True)
class Expected:
    """What a key of a scene takes, and the way from there to SI.

    unit       FMI unit of the SI value, "1" for a pure number
    size       0 for a scalar, otherwise the number of elements of a list; `ANY` for a list of whatever length
    choices    names of an Integer's values
    example    a value as a scene would write it
    minimum    least permitted SI value; `open_minimum` excludes the bound itself
    relative   the value is a difference: 5 deg_C are 5 K
    refusal    why else an SI value is refused, or None
    display_unit  FMI unit in which a person would write it, "" for the unit itself
    """

    unit: str
    kind: str = "Real"
    size: int = 0
    choices: tuple[str, ...] = ()
    example: str = ""
    minimum: float = -math.inf
    maximum: float = math.inf
    open_minimum: bool = False
    refusal: Callable[[float], str | None] = lambda value: None
    display_unit: str = ""
    relative: bool = False

    def read(self, value: object) -> float | list[float]:
        """SI value, or text, or `Unexpected`."""
        if not self.size:
            return self._scalar(value)
        if not isinstance(value, list) or self.size not in (ANY, len(value)):
            count = "" if self.size == ANY else f" of {self.size}"
            raise Unexpected(f"expected a list{count}, each {self._wanted()}")
        return self.read_each(value)

    def read_each(self, values: Sequence[object]) -> list[float]:
        """SI value of every element, or `Unexpected` that says which one does not fit."""
        numbers = []
        for place, element in enumerate(values, start=1):
            try:
                numbers.append(self._scalar(element))
            except Unexpected as error:
                link = " " if str(error).startswith(("is ", "must ")) else ": "
                raise Unexpected(f"element {place}{link}{error}") from None
        return numbers

    def _wanted(self) -> str:
        if self.kind == TEXT:
            return "a text"
        if self.choices:
            return f"one of {', '.join(self.choices)}"
        if self.kind == "Boolean":
            return "true or false"
        if self.kind == "Integer":
            return f"a whole number, such as {self.example}"
        if self.unit == "1":
            return f"a bare number, such as {self.example}"
        return f'{_article(dimension_of(unit_of(self.unit)))} with its unit, such as "{self.example}"'

    def _scalar(self, value: object) -> float:
        if self.kind == TEXT:
            if not isinstance(value, str):
                raise Unexpected(f"expected {self._wanted()}, in quotes")
            if "\0" in value:
                raise Unexpected("is no text: it holds a NUL")
            return value  # type: ignore[return-value]  # who asks for a String knows it
        if self.choices:
            if value not in self.choices:
                raise Unexpected(f"expected {self._wanted()}")
            return float(self.choices.index(str(value)))
        if self.kind == "Boolean":
            if not isinstance(value, bool):
                raise Unexpected(f"expected {self._wanted()}")
            return float(value)
        number, unit = (self._bare(value), "") if self.unit == "1" else self._quantity(value)
        reason = self._out_of_bounds(number, unit) or self.refusal(number)
        if reason:
            raise Unexpected(f"{reason}; expected {self._wanted()}")
        return number

    def bounds(self) -> str:
        """The bounds in words, in the unit in which a person would write them; nothing when there are none."""
        found = []
        if self.choices or self.kind == "Boolean":
            return ""
        if math.isfinite(self.minimum):
            found.append(f"{'greater than' if self.open_minimum else 'at least'} {self._number(self.minimum)}")
        if math.isfinite(self.maximum):
            found.append(f"at most {self._number(self.maximum)}")
        return ", ".join(found)

    def _number(self, value: float) -> str:
        if self.unit == "1":
            return f"{value:.10g}"
        shown = self.display_unit or self.unit
        return f"{unit_of(self.unit).to(unit_of(shown), value):.10g} {spoken(shown)}"

    def written(self, values: Sequence[float]) -> str:
        """SI values as TOML; what is read back are the same values."""
        texts = [self._written(value) for value in values]
        return f"[{', '.join(texts)}]" if self.size else texts[0]

    def _written(self, value: float) -> str:
        if self.choices:
            return f'"{self.choices[int(value)]}"'
        if self.kind == "Boolean":
            return "true" if value else "false"
        if self.kind == "Integer":
            return str(int(value))
        if self.unit == "1":
            return repr(value)
        for shown in dict.fromkeys((self.display_unit or self.unit, self.unit)):
            scaled = float(unit_of(self.unit).to(unit_of(shown), value))
            for digits in (6, 9, 12, 15, 16, 17):
                text = f"{scaled:.{digits}g} {spoken(shown)}"
                if self._quantity(text)[0] == value:
                    return f'"{text}"'
        return f'"{value!r} {spoken(self.unit)}"'

    def _converted(self, value: float, of: Any, to: Any) -> float:
        """A value in another unit; a difference of so many degC is one of as many K."""
        if self.relative:
            of, to = (u.K if unit == u.deg_C else unit for unit in (of, to))
        return float(of.to(to, value, equivalencies=u.temperature()))

    def _known_units(self) -> str:
        """Units that would do, of those that are commonly written."""
        known = [name for name in COMMON if u.Unit(name).is_equivalent(unit_of(self.unit), u.temperature())]
        if not known:
            return f"expected {self._wanted()}"
        return f"known for {_article(dimension_of(unit_of(self.unit)))}: {', '.join(known)}"

    def _out_of_bounds(self, number: float, unit: str) -> str | None:
        """Why an SI value is out of bounds, told in the unit it was written with."""
        if not math.isfinite(number):
            return "must be finite"
        if number < self.minimum or (self.open_minimum and number == self.minimum):
            words, bound = "greater than" if self.open_minimum else "at least", self.minimum
        elif number > self.maximum:
            words, bound = "at most", self.maximum
        else:
            return None
        if unit:
            bound = self._converted(bound, unit_of(self.unit), u.Unit(unit))
        return f"must be {words} {bound:.10g}{unit and ' ' + unit}"

    def _bare(self, value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise Unexpected(f"expected {self._wanted()}")
        if self.kind == "Integer" and not isinstance(value, int):
            raise Unexpected(f"expected {self._wanted()}")
        if isinstance(value, int) and abs(value) > LARGEST_INTEGER and self.kind == "Integer":
            raise Unexpected(f"must be at most {LARGEST_INTEGER} in size; expected {self._wanted()}")
        try:
            return float(value)
        except OverflowError:
            raise Unexpected(f"is too large; expected {self._wanted()}") from None

    def _quantity(self, value: object) -> tuple[float, str]:
        """SI value, and the unit as written."""
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            raise Unexpected(f"expected {self._wanted()}")
        if not isinstance(value, str):
            raise Unexpected(f"a bare number has no unit; expected {self._wanted()}")
        match = _QUANTITY.fullmatch(value)
        if match is None:
            raise Unexpected(f"is no number with a unit; expected {self._wanted()}")
        if match[2] is None:
            raise Unexpected(f"a bare number has no unit; expected {self._wanted()}")
        written = match[2].strip()
        try:
            unit = u.Unit(written)
        except (TypeError, ValueError, ArithmeticError):
            raise Unexpected(f"has the unit {written!r}, which is not known; {self._known_units()}") from None
        try:
            number = self._converted(float(match[1]), unit, unit_of(self.unit))
        except u.UnitConversionError:
            raise Unexpected(f"is {_article(dimension_of(unit))}; expected {self._wanted()}") from None
        except (TypeError, ValueError, ArithmeticError):
            raise Unexpected(f"is no number with a unit; expected {self._wanted()}") from None
        return number, written


def example_of(start: float, unit: str, display_unit: str = "") -> str:
    """A start value as a scene would write it: 7e10 Pa with display unit GPa is "70 GPa"; zero is shown as 1."""
    if unit == "1":
        return f"{start:g}"
    shown = display_unit or unit
    value = (start or 1.0) * unit_of(unit).to(unit_of(shown)) if start else 1.0
    return f"{value:g} {spoken(shown)}"
