"""A row of a model's table of variables, as its FMU, the scenes and the documentation have it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

Kind = Literal["Real", "Integer", "Boolean"]
Causality = Literal["parameter", "input", "output", "state"]
Value = float | int | bool
INDEX = "[#]"


@dataclass(frozen=True)
class Variable:
    """One row of a model's table: a scalar or a small array of fixed shape.

    name         FMI structured name; every `[#]` stands for an index counted from 1, in the order of `shape`
    unit         FMI unit name of the SI value, "1" for a pure number
    causality    parameter (fixed before the start), input, output, or state (in the record, not at the interface)
    start        one value for all elements, or one per element in C order; parameters and inputs only
    minimum      least permitted value; `open_minimum` excludes the bound itself
    choices      for an Integer choice: name of each permitted value, as a scene writes it
    nominal      a typical size, 0 when none is told
    rate         variable or state of the same shape that holds the time derivative: of an output, filled by the kernel;
                 of an input, filled by the shim with what the importer says, for the next step only
    partials     of an output that depends directly on inputs: input and the state that holds the derivative by it (of
                 the same shape; zero for what changes by jumps, as a Boolean does). An interface shows only those of
                 its own inputs
    at_start     of an output: inputs that its value at the start depends on, beside those of `partials`
    fills        a scene may give fewer elements: the last one is repeated
    date         an instant: the value counts from 2000-01-01 12:00 UTC [s], and a scene may say the date
    beside       of a state: group and term of it, beside which alone its part has this row; None: beside all
    """

    name: str
    unit: str
    causality: Causality
    description: str
    start: Value | Sequence[Value] = 0.0
    kind: Kind = "Real"
    shape: tuple[int, ...] = ()
    minimum: float = -math.inf
    maximum: float = math.inf
    open_minimum: bool = False
    display_unit: str = ""
    choices: tuple[str, ...] = ()
    discrete: bool = False
    nominal: float = 0.0
    rate: str = ""
    partials: tuple[tuple[str, str], ...] = ()
    at_start: tuple[str, ...] = ()
    fills: bool = False
    date: bool = False
    beside: tuple[str, str] | None = None

    def __post_init__(self) -> None:
        if self.name.count(INDEX) != len(self.shape):
            raise ValueError(f"{self.name}: shape {self.shape} needs as many {INDEX}")
        if self.beside is not None and self.causality != "state":
            raise ValueError(f"{self.name}: a tool sees it, it cannot hang on the choice of {self.beside[0]}")

    @property
    def field(self) -> str:
        """Name of the record's field: `bullet[#].position[#]` is `bullet_position`."""
        return self.name.replace(INDEX, "").replace(".", "_")

    @property
    def section(self) -> str:
        """First part of the name: the table of a scene that sets it."""
        return self.name.partition(".")[0]

    @property
    def key(self) -> str:
        """Rest of the name: the key in that table."""
        return self.name.partition(".")[2].replace(INDEX, "")

    @property
    def size(self) -> int:
        return math.prod(self.shape)

    @property
    def at_interface(self) -> bool:
        return self.causality != "state"

    def starts(self) -> list[Value]:
        """Start value of each element."""
        if isinstance(self.start, Sequence):
            if len(self.start) != self.size:
                raise ValueError(f"{self.name}: {self.size} start values needed, {len(self.start)} given")
            return list(self.start)
        return [self.start] * self.size

    def element_names(self) -> list[str]:
        """FMI name of each element, in C order."""
        names = []
        for index in itertools.product(*(range(1, n + 1) for n in self.shape)):
            name = self.name
            for i in index:
                name = name.replace(INDEX, f"[{i}]", 1)
            names.append(name)
        return names

    def typed(self, name: str, value: Value) -> Value:
        """A value in the type of this row; ValueError, which calls it `name`, if it cannot have it."""
        reason = self.refusal(float(value))
        if reason is None and self.kind != "Real" and float(value) != int(value):
            reason = "must be a whole number"
        if reason is not None:
            raise ValueError(f"{name} = {value:g} {reason}")
        return float(value) if self.kind == "Real" else bool(value) if self.kind == "Boolean" else int(value)

    def refusal(self, value: float) -> str | None:
        """Why a value is out of bounds, or None."""
        unit = "" if self.unit == "1" else f" {self.unit}"
        if not math.isfinite(value):
            return "must be finite"
        if value < self.minimum or (self.open_minimum and value == self.minimum):
            return f"must be {'greater than' if self.open_minimum else 'at least'} {self.minimum:g}{unit}"
        if value > self.maximum:
            return f"must be at most {self.maximum:g}{unit}"
        return None
