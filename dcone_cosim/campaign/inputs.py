"""The numbers that are drawn for a case, and the settings that give a case its values."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from dcone_cosim.cases.case import Value
from dcone_cosim.units import by_name, spoken

JITTER = "jitter"
"""Name of the input that is the solver's jitter."""
Point = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Input:
    """One number that is drawn.

    name       its key, with the element of a vector behind it
    value      of a coordinate of the unit cube, SI; of a discrete one the place among its texts
    unit       SI, FMI name
    texts      of a discrete one
    points     coordinates of a grid
    normal     whether its normal score tells it best
    shown_in   unit in which a person reads it, that of the campaign's file; "" for the SI unit
    """

    name: str
    value: Callable[[float], float]
    unit: str = "1"
    texts: tuple[str, ...] = ()
    points: tuple[float, ...] = ()
    normal: bool = False
    shown_in: str = ""

    def told(self, value: float) -> Value:
        """As a table has it."""
        if self.texts:
            return _as_value(self.texts[int(value)])
        text = f"{value!r} {spoken(self.unit)}".rstrip() if self.unit != "1" else repr(value)
        return Value(text, value, self.unit)

    def read(self, value: float) -> float:
        """An SI value in the unit that it is shown in."""
        return by_name(self.shown_in or self.unit).from_si(value)

    @property
    def label(self) -> str:
        """Its name, with the unit that it is shown in behind it."""
        unit = spoken(self.shown_in or self.unit)
        return f"{self.name} [{unit}]" if unit else self.name


@dataclass(frozen=True)
class Group:
    """The inputs of one dispersion, and the settings that give a case its values.

    places    of these inputs among all
    write     settings from their values, SI
    """

    places: tuple[int, ...]
    write: Callable[[Sequence[float]], tuple[str, ...]]


@dataclass(frozen=True)
class Inputs:
    """All that is drawn for a case.

    factor    lower triangular (d, d) matrix of the correlated normal scores; None where none are
    """

    inputs: tuple[Input, ...]
    groups: tuple[Group, ...]
    factor: npt.NDArray[np.float64] | None = field(default=None, compare=False)

    @property
    def names(self) -> list[str]:
        return [one.name for one in self.inputs]

    def values(self, point: Point) -> list[float]:
        """Values of a point of the unit cube, (d,), each strictly between 0 and 1, SI.

        Correlated by a Gaussian copula: z = L Phi^-1(u), u' = Phi(z), with L L^T the matrix of coefficients.

        Checked  tests/campaign/test_inputs.py
        """
        if self.factor is not None:
            from scipy.special import ndtr, ndtri

            point = ndtr(self.factor @ ndtri(point))
        return [one.value(float(u)) for one, u in zip(self.inputs, point, strict=True)]

    def settings(self, values: Sequence[float]) -> tuple[str, ...]:
        """What a command line would set to run this case alone."""
        return tuple(text for group in self.groups for text in group.write([values[place] for place in group.places]))


def shown(one: Input, value: float) -> str:
    """An SI value as a person reads it.

    Checked  tests/campaign/test_inputs.py
    """
    if one.texts:
        return one.texts[int(value)]
    return f"{one.read(value):.5g} {spoken(one.shown_in or one.unit)}".rstrip()


def _as_value(given: str) -> Value:
    from dcone_cosim.cases.vary import in_si

    return in_si(given)
