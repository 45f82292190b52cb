"""What a component tells of its last step, held over all the steps that a row of a table stands for.

A row may stand for many steps of an FMU: coupling steps, the halves by which an instant is located, pieces of a macro
step in which more tugs fell than a ring holds. `Held` sees every one of them, and forgets those that are rolled back,
since what it holds is saved and restored with the state.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol, runtime_checkable

from dcone_cosim.contract import EXTREMES, TUG_FIELDS, TUG_PREFIX
from dcone_cosim.errors import FmuError
from dcone_cosim.fmu.steppable import Readable, Row, Steppable, VariableInfo
from dcone_cosim.recorder import TugLog

PIECE = "held piece"
"""Key under which the begin of a step is kept, to be taken in pieces."""
SHORTEST = 1e-9
"""Shortest step that is halved [s]: tugs that still overflow the ring in it are lost, and counted as missed."""
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

    so_far     extremes over the steps of the row, by name; those of the component itself before the first step
    recorded   the row is complete: the next step begins another
    taut       the line was, after the last step
    """

    so_far: Mapping[str, float] = field(default_factory=dict)
    recorded: bool = True
    taut: bool = False
    count: int = 0
    latest: dict[int, tuple[float, float, float]] = field(default_factory=dict)


class Held:
    """A component, and what it has told since the last row.

    A step in which more tugs fall than its ring holds is taken back and taken again in halves, with the same inputs; a
    component that cannot do that loses the older ones, and its log says how many.

    Checked  tests/cosim/test_holding.py
    """

    def __init__(self, component: Steppable) -> None:
        self.component = component
        self.name = component.name
        self.variables: Mapping[str, VariableInfo] = component.variables
        self.can_save, self.can_vary_step = component.can_save, component.can_vary_step
        self.can_interpolate = component.can_interpolate
        self._state = _State()
        self._kept: dict[str, _State] = {}
        self._rates: dict[str, float] = {}
        self._extremes = [name for name in EXTREMES if name in self.variables]
        ring = 0
        while all(f"{TUG_PREFIX}{ring + 1}].{field}" in self.variables for field in TUG_FIELDS):
            ring += 1
        self.tugs = TugLog(ring) if ring and COUNT in self.variables else None
        watched = list(self._extremes)
        if self.tugs is not None:
            watched += [name for name in (COUNT, TAUT) if name in self.variables]
            names = [f"{TUG_PREFIX}{i}].{field}" for i in range(1, ring + 1) for field in TUG_FIELDS]
            self._read_ring = component.reader(names)
        self._read = component.reader(watched) if watched else None

    def set(self, values: Mapping[str, float]) -> None:
        self.component.set(values)

    def set_rates(self, rates: Mapping[str, float]) -> None:
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

    def begin_row(self) -> None:
        if self._state.recorded:  # the very first row: the line may be taut already
            self._gather(self._told())
        self._state.recorded = True

    def row(self, names: Sequence[str]) -> Readable:
        reader = self.component.reader(names)
        place = {name: i for i, name in enumerate(reader.names)}
        columns = [(place[name], name, place.get(EXTREMES[name].of)) for name in self._extremes if name in place]
        return _Row(self, reader, columns) if columns else reader

    @property
    def so_far(self) -> Mapping[str, float]:
        """Extremes over the steps of the row."""
        return self._state.so_far

    def step(self, time: float, size: float) -> None:
        rates, self._rates = self._rates, {}
        if self.tugs is None or not (self.can_save and self.can_vary_step):
            self._advance(time, size)
        else:
            self._in_pieces(time, size, self.tugs, rates)

    def _in_pieces(self, time: float, size: float, tugs: TugLog, rates: Mapping[str, float]) -> None:
        before = tugs.count
        self.save(PIECE)
        self._advance(time, size)
        if tugs.count - before <= tugs.ring or size <= SHORTEST:
            return
        self.restore(PIECE)
        found = int(self._told()[COUNT])
        if found != before:
            raise FmuError(
                f"{self.name}: its state does not restore: {COUNT} was {before} at t = {time:.9g} s, and is "
                f"{found} after going back there\n"
                "  (an FMU that cannot go back must say canGetAndSetFMUstate = false)"
            )
        middle, end = time + 0.5 * size, time + size
        for begin, until in ((time, middle), (middle, end)):
            if rates:
                self.component.set_rates(rates)
            self._in_pieces(begin, until - begin, tugs, rates)

    def _advance(self, time: float, size: float) -> None:
        """One step of the component, and what it tells of it."""
        state = self._state
        begins, state.recorded = state.recorded, False
        self.component.step(time, size)
        told = self._told()
        state.so_far = {
            name: told[name] if begins else EXTREMES[name].choose(state.so_far[name], told[name])
            for name in self._extremes
        }
        self._gather(told)

    def _told(self) -> Mapping[str, float]:
        return {} if self._read is None else dict(zip(self._read.names, self._read().tolist(), strict=True))

    def _gather(self, told: Mapping[str, float]) -> None:
        """Put down the tugs in the ring, where one is new or may have grown."""
        if self.tugs is None:
            return
        count, taut = int(told[COUNT]), bool(told.get(TAUT, True))
        if count and (count != self.tugs.count or taut or self._state.taut):
            self.tugs.update(count, self._read_ring().reshape(self.tugs.ring, len(TUG_FIELDS)))
        self._state.taut = taut

    def save(self, key: str = "") -> None:
        self.component.save(key)
        tugs = self.tugs
        kept = (0, {}) if tugs is None else (tugs.count, tugs.latest())
        self._kept[key] = replace(self._state, count=kept[0], latest=kept[1])

    def restore(self, key: str = "") -> None:
        self.component.restore(key)
        self._state = replace(self._kept[key])
        if self.tugs is not None:
            self.tugs.go_back(self._state.count, self._state.latest)

    def release(self, key: str = "") -> None:
        self.component.release(key)
        self._kept.pop(key, None)


class _Row:
    """A row of a component's reader with the extremes of all steps in it."""

    def __init__(self, held: Held, reader: Readable, columns: Sequence[tuple[int, str, int | None]]) -> None:
        """columns: place and name of an extreme, and the place of what it is the extreme of"""
        self._held, self._reader, self._columns = held, reader, columns
        self.names, self.values = reader.names, reader.values

    def __call__(self) -> Row:
        values, so_far = self._reader(), self._held.so_far
        for place, name, now in self._columns:
            values[place] = so_far.get(name, values[place])
            if now is not None:
                values[place] = EXTREMES[name].choose(values[place], values[now])
        return values
