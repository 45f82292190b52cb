"""Makes the inputs of one dispersion: its distribution in SI, about what the scene has there, and how it is written."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from dcone_cosim import build
from dcone_cosim.campaign import distributions
from dcone_cosim.campaign.distributions import DISCRETE, Quantile, Unfit
from dcone_cosim.campaign.inputs import Input
from dcone_cosim.campaign.spec import Dispersion, Spec
from dcone_cosim.scene.data import SHARED, ComponentScene, Scene
from dcone_cosim.scene.expected import number_and_unit
from dcone_cosim.scene.mistakes import Mistake, unknown
from dcone_cosim.units import PURE, Unit, by_name, named, si_name, spoken

NORMAL = ("normal", "lognormal")
"""Distributions that are told best by their normal scores."""
WIDTHS = ("deviation", "scale", "within")
"""Parameters that are differences."""
_ELEMENT = re.compile(r"(.+)\[(\d+)\]")


class Wrong(Exception):
    """Mistakes in a dispersion."""

    def __init__(self, *mistakes: Mistake) -> None:
        super().__init__()
        self.mistakes = mistakes


class Maker:
    """Makes the inputs of one dispersion."""

    def __init__(self, spec: Spec, base: Scene, one: Dispersion) -> None:
        self.spec, self.base, self.one = spec, base, one
        match = _ELEMENT.fullmatch(one.key)
        self.key, self.element = (match[1], int(match[2])) if match else (one.key, 0)
        self.present, self.unit, self.display, self.given = standing(base, self.key)

    def made(self) -> tuple[list[Input], Callable[[Sequence[float]], tuple[str, ...]]]:
        one, size = self.one, len(self.present)
        if self.element and not 1 <= self.element <= size:
            text = f"{self.key} has {size} elements" if size else f"{self.base.name} has no vector of that name"
            raise Wrong(Mistake((*one.path, "key"), one.key, text))
        if self.element and self.unit == "1" and not self.given:
            text = (
                "the scene leaves this direction at its default, which is none that a single element can be set in; "
                f"give all of it first, in [set.{self.key.rpartition('.')[0]}]"
            )
            raise Wrong(Mistake((*one.path, "key"), one.key, text))
        if one.distribution == DISCRETE:
            return self._discrete()
        elements = [self.element] if self.element else list(range(1, size + 1)) if size else [0]
        found, unit = [], ""
        for element in elements:
            quantile, unit, shown_in = self._quantile(element)
            name = f"{self.key}[{element}]" if element else self.key
            found.append(Input(name, quantile, unit, (), _grid(one), one.distribution in NORMAL, shown_in))
        return found, self.writer(elements, unit)

    def _discrete(self) -> tuple[list[Input], Callable[[Sequence[float]], tuple[str, ...]]]:
        one = self.one
        if self.element:
            text = "a discrete distribution takes a whole key, not an element of it"
            raise Wrong(Mistake((*one.path, "key"), one.key, text))
        choose = distributions.chooser(one.weights)
        ends = np.cumsum([0.0, *one.weights]) / math.fsum(one.weights)
        points = tuple((0.5 * (ends[1:] + ends[:-1])).tolist())
        found = Input(one.key, lambda u: float(choose(u)), "1", tuple(one.values), points)
        return [found], lambda values: one.settings_of(int(values[0]))

    def writer(self, elements: Sequence[int], unit: str) -> Callable[[Sequence[float]], tuple[str, ...]]:
        """Settings from values, SI; `elements` of a vector, counted from 1, the others as the scene has them."""
        key, present = self.key, self.present

        def text(value: float) -> str:
            return repr(value) if unit == "1" else f'"{value!r} {spoken(unit)}"'

        if not any(elements):
            return lambda values: (f"{key}={text(values[0])}",)

        def write(values: Sequence[float]) -> tuple[str, ...]:
            whole = list(present)
            for element, value in zip(elements, values, strict=True):
                whole[element - 1] = value
            return (f"{key}=[{', '.join(text(value) for value in whole)}]",)

        return write

    def _quantile(self, element: int) -> tuple[Quantile, str, str]:
        """Quantile function of one number, SI, the FMI name of its unit, and that in which a person reads it."""
        one = self.one
        kind = distributions.KINDS.get(one.distribution) or distributions.of_scipy(one.distribution)
        assert kind is not None
        told = dict(one.told)
        here = self.present[element - 1] if element else self._alone()
        numbers: dict[str, float] = {}
        units: dict[str, Unit] = {}
        shares: dict[str, float] = {}
        if "within" in told:
            self._read("within", told.pop("within"), numbers, units, shares)
        for name, given in told.items():
            if name in kind.pure:
                if isinstance(given, bool) or not isinstance(given, int | float):
                    raise Wrong(Mistake((*one.path, name), given, "expected a bare number"))
                numbers[name] = float(given)
            else:
                self._read(name, given, numbers, units, shares)
        unit = self._one_unit(units)
        middle = numbers.get("mean", numbers.get("likeliest", here))
        for name, share in shares.items():
            if middle is None or math.isnan(middle):
                raise Wrong(self._without_value(name))
            scale = middle if name in ("least", "most", "mean", "likeliest", "loc") else abs(middle)
            numbers[name] = scale * share
        if "within" in numbers:
            numbers |= self._within(numbers.pop("within"), here, numbers)
        if "mean" in kind.needs and "mean" not in numbers and here is not None:
            numbers["mean"] = here
        for name in kind.needs:
            if name not in numbers:
                text = f"expected it: {one.distribution} needs {', '.join(kind.needs)}"
                raise Wrong(Mistake((*one.path, name), None, text))
        try:
            return kind.make(numbers), unit, self._shown_in(units)
        except Unfit as error:
            raise Wrong(Mistake((*one.path, error.name), one.told.get(error.name), str(error))) from None

    def _without_value(self, name: str) -> Mistake:
        """Of a share of what the scene does not tell: probably its key is misspelt."""
        known = _keys(self.base)
        if self.key not in known:
            path = (*self.one.path, "key")
            return unknown(path, self.one.key, f"{self.base.name} has no such key with a number", self.key, known)
        text = f"a share needs the value that it is of; {self.key} has none in the scene"
        return Mistake((*self.one.path, name), self.one.told.get(name), text)

    def _alone(self) -> float | None:
        """Value of a key that is no vector."""
        return _named(self.base, self.key)[0]

    def _within(self, half: float, here: float | None, numbers: Mapping[str, float]) -> dict[str, float]:
        """Ends of what lies within so much of the scene's value."""
        if here is None or not {"least", "most"}.isdisjoint(numbers):
            text = "expected least and most, or within about a value that the scene has"
            raise Wrong(Mistake((*self.one.path, "within"), self.one.told.get("within"), text))
        return {"least": here - half, "most": here + half}

    def _read(
        self, name: str, given: Any, numbers: dict[str, float], units: dict[str, Unit], shares: dict[str, float]
    ) -> None:
        path = (*self.one.path, name)
        if isinstance(given, int | float) and not isinstance(given, bool):
            numbers[name], units[name] = float(given), by_name("1")
            return
        number, word = (number_and_unit(given) if isinstance(given, str) else None) or (math.nan, "")
        if word == "%" and math.isfinite(number):
            shares[name] = number / 100.0
            return
        unit = named(word) if word else by_name("1")
        if not math.isfinite(number) or unit is None:
            raise Wrong(Mistake(path, given, 'expected a number with its unit such as "3 m/s", or a share "1 %"'))
        difference = unit.of_differences() if name in WIDTHS else unit
        numbers[name], units[name] = difference.to_si(number), unit

    def _shown_in(self, units: Mapping[str, Unit]) -> str:
        """The unit that the file writes its values in, of a width alone if there are no others; where all are shares,
        the one in which a person would write the key; "" for the SI unit."""
        written = {unit.name: name in WIDTHS for name, unit in units.items()}
        return min(written, key=lambda name: written[name]) if written else self.display

    def _one_unit(self, units: Mapping[str, Unit]) -> str:
        """FMI name of the SI unit that all are in."""
        found = {name: si_name(unit.dimension or PURE) for name, unit in units.items()}
        expected = self.unit or next(iter(found.values()), "1")
        for name, unit in found.items():
            if (by_name(unit).dimension or PURE) != (by_name(expected).dimension or PURE):
                told = spoken(expected) or "a pure number"
                text = f"is in {spoken(unit) or 'no unit'}; {self.key} is in {told}"
                raise Wrong(Mistake((*self.one.path, name), self.one.told.get(name), text))
        return expected


def _grid(one: Dispersion) -> tuple[float, ...]:
    """Coordinates of a grid's values: evenly spaced between the ends where there are such, at even shares elsewhere."""
    count = one.points
    if not count:
        return ()
    if one.distribution == "uniform":
        return tuple(np.linspace(0.0, 1.0, count).tolist())
    return tuple(((np.arange(count) + 0.5) / count).tolist())


def standing(base: Scene, key: str) -> tuple[list[float], str, str, bool]:
    """Elements [SI] of a vector of the scene by its key, none where it is none; the FMI name of its unit, "" where that
    is not known; that in which a person would write it, "" for the same; and whether the scene gives it."""
    found: list[float] = []
    unit, display, given = "", "", False
    while True:
        value, of, shown, there = _named(base, f"{key}[{len(found) + 1}]")
        if value is None:
            break
        found.append(value)
        unit, display, given = of, shown, given or there
    if not found:
        _, unit, display, given = _named(base, key)
    return found, unit, display, given


def _named(base: Scene, key: str) -> tuple[float | None, str, str, bool]:
    """Value [SI] of one number of the scene by its key, its units as `standing` has them, and whether the scene gives
    it."""
    head, _, rest = key.partition(".")
    for phase in base.phases:
        component: ComponentScene | None = phase.main
        name = key if head == SHARED else rest if phase.name == head else ""
        if name.startswith("components."):
            part, _, name = name.removeprefix("components.").partition(".")
            component = next((one for one in phase.others if one.name == part), None)
        if component is None or not name:
            continue
        value = component.values.get(name, component.asked.get(name))
        if isinstance(value, int | float):
            return float(value), *_units_of(component, name), name in component.parameters
    return None, "", "", False


def _keys(base: Scene) -> list[str]:
    """Keys of all numbers of the scene's own phases."""
    return [
        f"{phase.name}.{name.partition('[')[0]}" if not name.startswith(f"{SHARED}.") else name
        for phase in base.phases
        for name in phase.main.values
    ]


def _units_of(component: ComponentScene, name: str) -> tuple[str, str]:
    if not component.model:
        return "", ""
    known = build.known_variables(component.model) | build.asked_variables(component.model)
    return (known[name][0].unit, known[name][0].display_unit) if name in known else ("", "")
