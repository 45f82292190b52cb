"""What the master asks of a component, whatever is behind it: an FMU, one in a child process, several coupled ones."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from dcone_cosim.errors import FmuError
from dcone_cosim.units import NO_UNIT, Unit

Row = npt.NDArray[np.float64]
NUMBERS = ("Real", "Integer", "Boolean")
"""Kinds of variable that a component reads and sets."""


@dataclass(frozen=True)
class VariableInfo:
    """What the model description says of one scalar variable; all values are SI.

    kind            Real, Integer or Boolean (an Enumeration is an Integer), or String
    unit            SI unit of what is read and set, "1" for a pure number
    own             unit the FMU itself counts in
    initial         exact, approx or calculated
    start           None when none is declared
    """

    name: str
    reference: int
    kind: str
    unit: str
    causality: str
    description: str
    own: Unit = NO_UNIT
    variability: str = ""
    initial: str = ""
    start: float | None = None
    minimum: float = -math.inf
    maximum: float = math.inf


class Readable(Protocol):
    """Fetches the same variables again and again; `values` is overwritten by each call."""

    names: tuple[str, ...]
    values: Row

    def __call__(self) -> Row: ...


class Steppable(Protocol):
    """What the master asks of a component. All values are SI.

    can_save          its state can be kept and restored, under several keys at a time
    can_vary_step     its steps may differ in length
    can_interpolate   it takes input derivatives
    """

    name: str
    variables: Mapping[str, VariableInfo]
    can_save: bool
    can_vary_step: bool
    can_interpolate: bool

    def set(self, values: Mapping[str, float]) -> None: ...
    def set_rates(self, rates: Mapping[str, float]) -> None: ...
    def get(self, names: Sequence[str]) -> dict[str, float]: ...
    def reader(self, names: Sequence[str]) -> Readable: ...
    def enter_initialisation(self, start: float, stop: float | None = None) -> None: ...
    def exit_initialisation(self) -> None: ...
    def step(self, time: float, size: float) -> None: ...
    def save(self, key: str = "") -> None: ...
    def restore(self, key: str = "") -> None: ...
    def release(self, key: str = "") -> None:
        """Nobody goes back to what was kept under this key any more; nothing may be kept."""

    def as_kept(self) -> dict[str, Any]:
        """The present state as plain data and bytes, for a component of another process; where FMUs can do that."""

    def take_up(self, kept: Mapping[str, Any]) -> None:
        """Be in a state that `as_kept` gave; the component must have begun with the same values."""

    def close(self) -> None: ...


def cpu_apart(component: Steppable) -> float:
    """CPU time that a component has used in processes of its own [s]."""
    told = getattr(component, "cpu_apart", None)
    return float(told()) if told is not None else 0.0


class CallError(FmuError):
    """A call that an FMU refused, or did not survive.

    said      the FMU's own words
    detail    the call, its status and the FMU's file
    status    Discard, Error, Fatal, Pending; Dead when its process is gone; "" when a call went well and gave nonsense
    reached   last time it reached in a step it discarded [s], None when it does not tell
    """

    def __init__(
        self, name: str, where: str, said: str, detail: str, status: str = "", reached: float | None = None
    ) -> None:
        super().__init__(f"{name}{where}:\n  {said}\n  ({detail})")
        self.name, self.where, self.said, self.detail = name, where, said, detail
        self.status, self.reached = status, reached

    @property
    def broken(self) -> bool:
        """Whether the FMU itself is at fault, whatever it was given: it refused nothing, it broke."""
        return self.status not in ("Discard", "Error")

    def __reduce__(self) -> tuple[type[CallError], tuple[object, ...]]:
        return type(self), (self.name, self.where, self.said, self.detail, self.status, self.reached)


class Terminated(CallError):
    """An FMU's own end, no failure: it discarded a step and says that it has terminated.

    time      it has reached [s]
    """

    @property
    def time(self) -> float:
        assert self.reached is not None
        return self.reached


def output_names(variables: Mapping[str, VariableInfo], without: Iterable[str] = ()) -> list[str]:
    """Names of all numeric outputs, save those that begin with one of the prefixes."""
    prefixes = tuple(without)
    return [
        v.name
        for v in variables.values()
        if v.causality == "output" and v.kind in NUMBERS and not v.name.startswith(prefixes or ("\0",))
    ]
