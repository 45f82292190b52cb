"""What a component tells of its last step, held over all the steps that a row of a table stands for.

A row may stand for many steps of an FMU: coupling steps, the halves by which an instant is located, pieces of a macro
step in which more tugs fell than a ring holds. `Held` sees every one of them, and forgets those that are rolled back,
since what it holds is saved and restored with the state.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any, Protocol, runtime_checkable

import numpy as np

from dcone_cosim.contract import EXTREMES, TUG_FIELDS, TUG_PREFIX
from dcone_cosim.errors import FmuError
from dcone_cosim.fmu.steppable import Readable, Row, Steppable, VariableInfo, cpu_apart
from dcone_cosim.recorder import TugLog

PIECE = "held piece"
"""Key under which the begin of a step is kept, to be taken in pieces."""
SHORTEST = 1e-9
"""Shortest step that is halved [s]: tugs that still overflow the ring in it are lost, and counted as missed."""
APART = 16
"""So many steps between two saved states: one costs as much as a short step."""
COUNT, TAUT = "tether.tug_count", "tether.taut"


@runtime_checkable
class Holding(Steppable, Protocol):
    """A component of which rows can be recorded.

    tugs              every tug since the start, None when it tells of none
    """

    @property
    def tugs(self) -> TugLog | None: ...
    def begin_row(self) -> None:
        """A row has been recorded: the next step begins another."""

    def row(self, names: Sequence[str]) -> Readable:
        """Like `reader`, but for the whole time since the row before; `reader` is for the last step alone."""


def holding(component: Steppable) -> Holding:
    return component if isinstance(component, Holding) else Held(component)


@dataclass
class _State:
    """What is saved with the state of the component.

    so_far     extremes over the steps of the row, in the order of `Held.extremes`; empty before the first step
    recorded   the row is complete: the next step begins another
    taut       the line was, after the last step
    count, newest   number of tugs, and the last of them: time [s], peak [N], speed [m/s]
    """

    so_far: Sequence[float] = ()
    recorded: bool = True
    taut: bool = False
    count: int = 0
    newest: tuple[float, float, float] | None = None


class Held:
    """A component, and what it has told since the last row.

    What a step tells is taken in as late as can be, before the next or with the row itself, which reads it anyway. A
    step in which more tugs fall than the ring holds is then taken back and taken again in halves, with the same inputs;
    a component that cannot do that loses the older ones, and its log says how many.

    extremes   names of its outputs that are extremes of a step
    watched    these, and those that say whether there are tugs to be read
    newest     those of the latest tug, which may still grow

    Checked  tests/cosim/test_holding.py
    """

    def __init__(self, component: Steppable) -> None:
        self.component = component
        self.name = component.name
        self.variables: Mapping[str, VariableInfo] = component.variables
        self.can_save, self.can_vary_step = component.can_save, component.can_vary_step
        self.can_interpolate = component.can_interpolate
        self.extremes = [name for name in EXTREMES if name in self.variables]
        self._choose = [EXTREMES[name].choose for name in self.extremes]
        ring = 0
        while all(f"{TUG_PREFIX}{ring + 1}].{field}" in self.variables for field in TUG_FIELDS):
            ring += 1
        self._log = TugLog(ring) if ring and COUNT in self.variables else None
        self.newest: list[str] = []
        self.watched = list(self.extremes)
        if self._log is not None:
            self.watched += [name for name in (COUNT, TAUT) if name in self.variables]
            names = [f"{TUG_PREFIX}{i}].{field}" for i in range(1, ring + 1) for field in TUG_FIELDS]
            self._read_ring, self.newest = component.reader(names), names[: len(TUG_FIELDS)]
            self._read_newest = component.reader(self.newest)
        self._read = component.reader(self.watched) if self.watched else None
        self._state = _State()
        self._kept: dict[str, _State] = {}
        self._pending = False
        self._rewinds = self._log is not None and self.can_save and self.can_vary_step
        self._rates: dict[str, float] = {}
        self._moving: Mapping[str, float] = {}
        self._steps: list[tuple[float, float]] = []
        self._checkpoint = False

    @property
    def tugs(self) -> TugLog | None:
        self.settle()
        return self._log

    def set(self, values: Mapping[str, float]) -> None:
        self.settle()
        self._checkpoint = False
        self.component.set(values)

    def set_rates(self, rates: Mapping[str, float]) -> None:
        self.settle()
        self._checkpoint = False
        self._rates |= rates
        self.component.set_rates(rates)

    def get(self, names: Sequence[str]) -> dict[str, float]:
        return self.component.get(names)

    def reader(self, names: Sequence[str]) -> Readable:
        return self.component.reader(names)

    def enter_initialisation(self, start: float, stop: float | None = None) -> None:
        self.component.enter_initialisation(start, stop)

    def exit_initialisation(self) -> None:
        self.component.exit_initialisation()

    def close(self) -> None:
        self.component.close()

    def cpu_apart(self) -> float:
        return cpu_apart(self.component)

    def begin_row(self) -> None:
        if self._pending:
            self.settle()
        if self._state.recorded and self._log is not None:  # no step yet: the line may be taut already
            self._gather(self._log, self._told())
        self._state.recorded = True

    def row(self, names: Sequence[str]) -> Readable:
        return _Row(self, names) if self.watched else self.component.reader(names)

    @property
    def so_far(self) -> Sequence[float]:
        """Extremes over the steps of the row."""
        return self._state.so_far

    @property
    def pending(self) -> bool:
        """Whether what the last step tells is not taken in yet."""
        return self._pending

    def step(self, time: float, size: float) -> None:
        if self._pending:
            self.settle()
        if self._rewinds:
            if not self._checkpoint or len(self._steps) >= APART:
                self._keep()
            self._steps.append((time, size))
        self.component.step(time, size)
        self._pending = bool(self.watched)

    def _keep(self) -> None:
        """Save the state, now and then and whenever inputs have changed: from there all steps can be taken again."""
        self.component.save(PIECE)
        self._checkpoint = True
        self._steps = []
        self._moving, self._rates = self._rates, {}

    def settle(self) -> None:
        """Take in what the last step tells, unless that has been done."""
        if self._pending:
            self.take_in(self._told())

    def take_in(self, told: Sequence[float], newest: Sequence[float] = ()) -> bool:
        """The same, with the values of `watched` as read, and of `newest` if they were; true when the step was taken
        again in pieces."""
        self._pending = False
        if self._overflows(told) and self._checkpoint:
            self._again()
            return True
        self._fold(told, newest)
        return False

    def _overflows(self, told: Sequence[float]) -> bool:
        log = self._log
        return log is not None and told[len(self.extremes)] - log.count > log.ring

    def _fold(self, told: Sequence[float], newest: Sequence[float] = ()) -> None:
        state = self._state
        if state.recorded:
            state.so_far, state.recorded = told[: len(self.extremes)], False
        else:
            pairs = zip(self._choose, state.so_far, told, strict=False)
            state.so_far = [choose(before, now) for choose, before, now in pairs]
        if self._log is not None:
            self._gather(self._log, told, newest)

    def _again(self) -> None:
        """Go back to where the state was saved, take the steps up to the last again, and that one in pieces."""
        assert self._log is not None
        steps, rates = self._steps, self._moving
        self.component.restore(PIECE)
        for time, size in steps[:-1]:
            if rates:
                self.component.set_rates(rates)
            self.component.step(time, size)
            rates = {}
        time, size = steps[-1]
        found = int(self._told()[len(self.extremes)])
        if found != self._log.count:
            raise FmuError(
                f"{self.name}: its state does not restore: {COUNT} was {self._log.count} at t = {time:.9g} s, and is "
                f"{found} after going back there\n"
                "  (an FMU that cannot go back must say canGetAndSetFMUstate = false)"
            )
        self._halve(time, size, rates)
        self._checkpoint = False

    def _halve(self, time: float, size: float, rates: Mapping[str, float]) -> None:
        middle, end = time + 0.5 * size, time + size
        for begin, until in ((time, middle), (middle, end)):
            self.component.save(PIECE)
            if rates:
                self.component.set_rates(rates)
            self.component.step(begin, until - begin)
            told = self._told()
            if self._overflows(told) and until - begin > SHORTEST:
                self.component.restore(PIECE)
                self._halve(begin, until - begin, rates)
            else:
                self._fold(told)

    def _told(self) -> list[float]:
        """The values of `watched`."""
        if self._read is None:
            return []
        values: list[float] = self._read().tolist()
        return [values[self._read.names.index(name)] for name in self.watched]

    def _gather(self, log: TugLog, told: Sequence[float], newest: Sequence[float] = ()) -> None:
        """Put down the tugs in the ring, where one is new or may have grown; `newest` as read, none to be read."""
        count = int(told[len(self.extremes)])
        taut = len(told) == len(self.extremes) + 1 or bool(told[-1])
        if count and (count != log.count or taut or self._state.taut):
            if count != log.count:
                log.update(count, self._read_ring().reshape(-1, len(TUG_FIELDS)))
            else:
                log.grow(newest or self._read_newest().tolist())
        self._state.taut = taut

    def save(self, key: str = "") -> None:
        self.settle()
        self.component.save(key)
        kept = self._kept[key] = replace(self._state)
        if self._log is not None:
            kept.count, kept.newest = self._log.count, self._log.newest

    def restore(self, key: str = "") -> None:
        self.component.restore(key)
        self._pending = self._checkpoint = False
        self._rates = {}
        self._state = replace(self._kept[key])
        if self._log is not None:
            self._log.forget_after(self._state.count, self._state.newest)

    def release(self, key: str = "") -> None:
        self.component.release(key)
        self._kept.pop(key, None)

    def as_kept(self) -> dict[str, Any]:
        self.settle()
        log = self._log
        tugs = None if log is None else {"count": log.count, "rows": [[n, *row] for n, row in log.rows.items()]}
        return {"component": self.component.as_kept(), "row": asdict(self._state), "tugs": tugs}

    def take_up(self, kept: Mapping[str, Any]) -> None:
        self.component.take_up(kept["component"])
        self._pending = self._checkpoint = False
        self._rates = {}
        self._state = _State(**kept["row"])
        if self._log is not None:
            self._log.take_up(kept["tugs"]["count"], kept["tugs"]["rows"])


class _Row:
    """The outputs of these names with the extremes of all steps in the row.

    What is watched is read with them: a call to an FMU costs more than the numbers that it fetches.
    """

    def __init__(self, held: Held, names: Sequence[str]) -> None:
        self._held = held
        self._all_there = set(held.watched) <= set(names)
        newest = held.newest if self._all_there else []
        self._reader = held.component.reader([*newest, *names])
        place = {name: i for i, name in enumerate(self._reader.names)}
        self._newest = [place[name] for name in newest]
        self._watched = [place[name] for name in held.watched] if self._all_there else []
        own = [i for i, name in enumerate(self._reader.names) if name not in newest]
        self.names = tuple(self._reader.names[i] for i in own)
        together = own == list(range(own[0], own[0] + len(own)))
        self._own = slice(own[0], own[0] + len(own)) if together else np.array(own)
        column = {name: i for i, name in enumerate(self.names)}
        self._columns = [
            (column[name], i, EXTREMES[name].choose, column.get(EXTREMES[name].of, column[name]))
            for i, name in enumerate(held.extremes)
            if name in column
        ]
        self.values = self._reader.values[self._own]

    def __call__(self) -> Row:
        held = self._held
        if not self._all_there:
            held.settle()
        read = self._reader()
        if held.pending:
            told, newest = [read.item(i) for i in self._watched], [read.item(i) for i in self._newest]
            if held.take_in(told, newest):
                read = self._reader()
        values = self.values = read[self._own]
        so_far = held.so_far
        if so_far:
            for place, i, choose, now in self._columns:
                values[place] = choose(so_far[i], values.item(now))
        return values
