"""The state of a phase at a communication point, kept so that the phase can go on from there in another process.

It is all that the steps after it hang on: the state of each FMU, what the master holds beside it (extremes of the row,
tugs, what is between coupled FMUs, step control), and where its loop stands. The rows up to it are those of the run's
own table.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol


@dataclass(frozen=True)
class KeptState:
    """A phase at one of its communication points.

    asked       instant for which it was kept, by the phase's own time [s]
    time        of the communication point, the first at or after that [s]
    rows        of the phase's table up to it, its own included
    loop        where the loop stands, plain data and bytes
    component   what the FMUs and those who watch them hold, plain data and bytes
    """

    phase: str
    asked: float
    time: float
    rows: int
    loop: Mapping[str, Any]
    component: Mapping[str, Any]


class Keepable(Protocol):
    """A component, as far as its state is kept."""

    def as_kept(self) -> dict[str, Any]: ...


class Keeper:
    """Keeps the state of a phase at the first communication point at or after each of some instants.

    instants    by the phase's own time [s]
    kept        those that have come
    waiting     instants that have not, the earliest first
    """

    def __init__(self, phase: str, instants: Sequence[float]) -> None:
        self.phase = phase
        self.waiting = sorted(set(instants))
        self.kept: list[KeptState] = []

    def look(self, time: float, rows: int, component: Keepable, loop: Callable[[], Mapping[str, Any]]) -> None:
        """At a communication point: keep the state if one is due."""
        due = [instant for instant in self.waiting if instant <= time]
        self.waiting = self.waiting[len(due) :]
        if due:
            self.kept.append(KeptState(self.phase, due[-1], time, rows, loop(), component.as_kept()))
