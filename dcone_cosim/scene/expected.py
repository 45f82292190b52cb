"""Values of a scene: what a key expects, and how a text with a unit becomes an SI number.

A dimensional value is a string with its unit ("24 m", "5 deg/s"); a pure number is bare. A bare number for a length, or
a mass where a length belongs, is thus an error that can name what was expected.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

from dcone_cosim.units import NO_UNIT, Unit, by_name, like, named, spoken

J2000 = datetime(2000, 1, 1, 12, tzinfo=UTC)
LARGEST_INTEGER = 2**31 - 1
"""An FMI Integer has 32 bits."""
_QUANTITY = re.compile(r"\s*([+-]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|nan|inf))\s*([^\d\s].*)?", re.DOTALL)
"""A number, and a unit that does not begin with another number."""

TEXT = "String"
"""Kind of a variable whose values are texts."""


def number_and_unit(text: str) -> tuple[float, str] | None:
    """A number and the name of the unit behind it, "" for none; None for any other text."""
    match = _QUANTITY.fullmatch(text)
    return None if match is None else (float(match[1]), (match[2] or "").strip())


class Unexpected(ValueError):
    """A value that does not fit; the text says what was expected."""


ANY = -1
"""Size of a list that may have any number of elements."""


@dataclass(frozen=True)
class Expected:
    """What a key of a scene takes, and the way from there to SI.

    unit       FMI unit of the SI value, "1" for a pure number
    size       0 for a scalar, otherwise the number of elements of a list; `ANY` for a list of whatever length
    fills      a shorter list will do: its last element is repeated
    choices    names of an Integer's values
    example    a value as a scene would write it
    minimum    least permitted SI value; `open_minimum` excludes the bound itself
    relative   the value is a difference: 5 deg_C are 5 K
    share      a pure number that may be told in per cent
    date       an instant that may be told as its date: the SI value counts from 2000-01-01 12:00 UTC, days of 86400 s
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
    share: bool = False
    fills: bool = False
    date: bool = False

    def read(self, value: object) -> float | list[float]:
        """SI value, or text, or `Unexpected`."""
        if not self.size:
            return self._scalar(value)
        shorter = isinstance(value, list) and self.fills and 0 < len(value) < self.size
        if not isinstance(value, list) or not (shorter or self.size in (ANY, len(value))):
            count = "" if self.size == ANY else f" of {'at most ' if self.fills else ''}{self.size}"
            raise Unexpected(f"expected a list{count}, each {self._wanted()}")
        found = self.read_each(value)
        return found + found[-1:] * (self.size - len(found)) if shorter else found

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
        if self.share:
            return f'a share, such as "{self.example}" or a bare number'
        if self.date:
            return 'a date in UTC, such as "2026-03-20 14:46"'
        if self.unit == "1":
            return f"a bare number, such as {self.example}"
        return f'{by_name(self.unit).noun} with its unit, such as "{self.example}"'

    def _scalar(self, value: object) -> float:
        if self.kind == TEXT:
            if not isinstance(value, str):
                raise Unexpected(f"expected {self._wanted()}, in quotes")
            if "\0" in value:
                raise Unexpected("is not a text: it holds a NUL")
            return value  # type: ignore[return-value]  # who asks for a String knows it
        if self.choices:
            if value not in self.choices:
                raise Unexpected(f"expected {self._wanted()}")
            return float(self.choices.index(str(value)))
        if self.kind == "Boolean":
            if not isinstance(value, bool):
                raise Unexpected(f"expected {self._wanted()}")
            return float(value)
        if self.date:
            number, unit = self._instant(value), NO_UNIT
        elif self.share and isinstance(value, str):
            number, unit = self._per_cent(value), NO_UNIT
        else:
            number, unit = (self._bare(value), NO_UNIT) if self.unit == "1" else self._quantity(value)
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
        if self.date:
            return self._date(value)
        if self.unit == "1":
            return f"{value:.10g}"
        shown = by_name(self.display_unit or self.unit)
        return f"{shown.from_si(value):.10g} {spoken(shown.name)}"

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
        if self.date:
            text = f'"{self._date(value)}"'
            return text if self._instant(text[1:-1]) == value else f'"{value!r} s"'
        if self.unit == "1":
            return repr(value)
        for shown in dict.fromkeys((self.display_unit or self.unit, self.unit)):
            scaled = by_name(shown).from_si(value)
            for digits in (6, 9, 12, 15, 16, 17):
                text = f"{scaled:.{digits}g} {spoken(shown)}"
                if self._quantity(text)[0] == value:
                    return f'"{text}"'
        return f'"{value!r} {spoken(self.unit)}"'

    @staticmethod
    def _date(value: float) -> str:
        """Seconds from J2000 as a date in UTC."""
        return (J2000 + timedelta(seconds=value)).strftime("%Y-%m-%d %H:%M:%S.%f").rstrip("0").rstrip(".")

    def _out_of_bounds(self, number: float, unit: Unit) -> str | None:
        """Why an SI value is out of bounds, told in the unit it was written with."""
        if not math.isfinite(number):
            return "must be finite"
        if number < self.minimum or (self.open_minimum and number == self.minimum):
            words, bound = "greater than" if self.open_minimum else "at least", self.minimum
        elif number > self.maximum:
            words, bound = "at most", self.maximum
        else:
            return None
        if self.date:
            return f"must be {words} {self._date(bound)}"
        return f"must be {words} {unit.from_si(bound):.10g}{'' if unit is NO_UNIT else f' {unit.name}'}"

    def _instant(self, value: object) -> float:
        """Seconds from J2000 to a date in UTC, or as they are told with a unit."""
        if isinstance(value, str):
            try:
                date = datetime.fromisoformat(value.strip())
            except ValueError:
                if (number_and_unit(value) or (0.0, ""))[1].isalpha():
                    return self._quantity(value)[0]
            else:
                return ((date if date.tzinfo else date.replace(tzinfo=UTC)) - J2000).total_seconds()
        raise Unexpected(f"expected {self._wanted()}, in quotes")

    def _per_cent(self, value: str) -> float:
        number, unit = number_and_unit(value) or (math.nan, "")
        if unit != "%":
            raise Unexpected(f"expected {self._wanted()}")
        return number / 100.0

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

    def _quantity(self, value: object) -> tuple[float, Unit]:
        """SI value, and the unit it was written with."""
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            raise Unexpected(f"expected {self._wanted()}")
        if not isinstance(value, str):
            raise Unexpected(f"a bare number has no unit; expected {self._wanted()}")
        parts = number_and_unit(value)
        if parts is None:
            raise Unexpected(f"is not a number with a unit; expected {self._wanted()}")
        number, name = parts
        if not name:
            raise Unexpected(f"a bare number has no unit; expected {self._wanted()}")
        unit, expected = named(name), by_name(self.unit)
        if unit is None:
            known = f"known for {expected.noun}: {', '.join(like(expected))}"
            raise Unexpected(f"has the unit {name!r}, which is not known; {known}")
        if unit.dimension != expected.dimension:
            raise Unexpected(f"is {unit.noun}; expected {self._wanted()}")
        if self.relative:
            unit = unit.of_differences()
        return unit.to_si(number), unit


def example_of(start: float, unit: str, display_unit: str = "") -> str:
    """A start value as a scene would write it: 7e10 Pa with display unit GPa is "70 GPa"; zero is shown as 1."""
    if unit == "1":
        return f"{start:g}"
    shown = by_name(display_unit or unit)
    return f"{shown.from_si(start) if start else 1.0:g} {spoken(shown.name)}"
