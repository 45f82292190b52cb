"""Several connected components as one: the phases step it like a single FMU."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from dcone_cosim.coupling.exchange import Exchange
from dcone_cosim.coupling.one_length import divides, one_length, uncontrolled
from dcone_cosim.coupling.options import Connection, Coupling
from dcone_cosim.coupling.step_control import ControlledSteps, FixedSteps, Statistics, StepControl
from dcone_cosim.coupling.wiring import order_of, wire
from dcone_cosim.errors import FmuError, InputError
from dcone_cosim.fmu.component import Readable, Row, Steppable, VariableInfo
from dcone_cosim.fmu.steppable import cpu_apart
from dcone_cosim.holding import Held
from dcone_cosim.names import did_you_mean
from dcone_cosim.recorder import TugLog

KEPT = "coupling kept "
"""Before the keys of those who save and restore the whole."""


class Coupled:
    """Components that step together, exchanging their values on the way; all values SI.

    The first component is the main one: its variables keep their names, those of the others are `instance.variable`.
    A step of the whole is a macro step, divided into coupling steps as `coupling` says. Call order of a `Component`.

    instances    names by which the connections know the components; their own names when empty
    statistics   steps, rejected, discarded, forced, smallest [s], largest [s]

    Raises `InputError` on construction for connections and couplings that cannot be, all mistakes at once. When a
    component ends itself (`Terminated`), all are left at the time of the end if all can save their states and
    vary their steps. Where one takes steps of one length, coupling steps that do not fill a macro step are refused.

    Checked  tests/cosim/test_coupling.py, tests/cosim/test_coupling_orders.py, tests/cosim/test_coupling_control.py
    """

    def __init__(
        self,
        name: str,
        components: Sequence[Steppable],
        connections: Sequence[Connection],
        coupling: Coupling,
        instances: Sequence[str] = (),
    ) -> None:
        self.name = name
        self.components = tuple(components)
        self._held = tuple(Held(component) for component in components)
        self.coupling = coupling
        self.can_save = all(component.can_save for component in components)
        self.can_vary_step = all(component.can_vary_step for component in components)
        self.can_interpolate = False
        names = list(instances) or [component.name for component in components]
        self._of: dict[str, tuple[int, str]] = {}
        self.variables: Mapping[str, VariableInfo] = self._gather(names)
        links = wire(name, names, self.components, connections)
        order = order_of(name, names, coupling)
        if coupling.control == "error":
            self._need_control(names)
        self._statistics = Statistics()
        self._exchange = Exchange(
            self._held, links, order, coupling.method == "gauss_seidel", coupling.extrapolation == "linear"
        )
        self._steps: StepControl
        if coupling.control == "error":
            self._steps = ControlledSteps(self._exchange, coupling, self._statistics)
        else:
            can_meet, even = self.can_save and self.can_vary_step, not self.can_vary_step
            self._steps = FixedSteps(self._exchange, coupling, self._statistics, can_meet, even)
        self._one_length = [n for n, c in zip(names, self.components, strict=True) if not c.can_vary_step]
        self._length = coupling.step
        self._times: dict[str, float] = {}
        self._time = 0.0
        self._stale = True

    @property
    def statistics(self) -> dict[str, float]:
        return self._statistics.as_dict()

    def _gather(self, instances: Sequence[str]) -> dict[str, VariableInfo]:
        """The variables of all under the names they have here."""
        variables: dict[str, VariableInfo] = {}
        for place, (instance, component) in enumerate(zip(instances, self.components, strict=True)):
            for own, info in component.variables.items():
                shown = own if place == 0 else f"{instance}.{own}"
                if shown in variables:
                    raise InputError(
                        f"{self.name}: {instances[0]} has a variable {shown!r}, as has the component {instance!r}; "
                        "give that component another name"
                    )
                variables[shown] = info if place == 0 else replace(info, name=shown)
                self._of[shown] = (place, own)
        return variables

    def _need_control(self, instances: Sequence[str]) -> None:
        """Refuse to control the steps of FMUs that cannot go back, or that take steps of one length."""
        of = list(zip(instances, self.components, strict=True))
        why = uncontrolled((n, c.can_save, c.can_vary_step) for n, c in of)
        if why:
            raise InputError(f'{self.name}: coupling.control = "error" {"; it ".join(why)}')

    def _need_whole_steps(self, time: float, size: float) -> None:
        """Refuse a macro step that steps of one length do not fill; without a coupling step the first tells it."""
        self._length = self._length or size
        if not divides(self._length, size):
            raise FmuError(
                f"{self.name}: the step of {size:.9g} s at t = {time:.9g} s is not a whole number of steps of "
                f"{self._length:.9g} s, and {one_length(self._one_length)}"
            )

    def _where(self, name: str) -> tuple[int, str]:
        try:
            return self._of[name]
        except KeyError:
            raise FmuError(f"{self.name}: no variable {name!r}{did_you_mean(name, self._of)}") from None

    def set(self, values: Mapping[str, float]) -> None:
        """Set variables by name; a connected input is overwritten by the output it is connected to."""
        shares: dict[int, dict[str, float]] = {}
        for name, value in values.items():
            place, own = self._where(name)
            shares.setdefault(place, {})[own] = value
        for place, share in shares.items():
            self._held[place].set(share)
        self._stale = True

    def set_rates(self, rates: Mapping[str, float]) -> None:
        """Refused: an input of the whole is held, since its components may take many steps in one of the whole."""
        raise FmuError(f"{self.name}: coupled components take no input derivatives from outside ({', '.join(rates)})")

    def get(self, names: Sequence[str]) -> dict[str, float]:
        reader = self.reader(names)
        found = dict(zip(reader.names, reader().tolist(), strict=True))
        return {name: found[name] for name in names}

    def reader(self, names: Sequence[str]) -> Readable:
        shares = self._shares(names)
        return self._as_one([(place, self._held[place].reader(share)) for place, share in shares])

    def row(self, names: Sequence[str]) -> Readable:
        """Like `reader`, with the extremes of all coupling steps since the last row."""
        shares = self._shares(names)
        return self._as_one([(place, self._held[place].row(share)) for place, share in shares])

    def begin_row(self) -> None:
        """A row has been recorded: the next step begins another."""
        for component in self._held:
            component.begin_row()

    @property
    def tugs(self) -> TugLog | None:
        """The tugs of the main component."""
        return self._held[0].tugs

    def _shares(self, names: Sequence[str]) -> list[tuple[int, list[str]]]:
        """The names by the place of the component that has them, as it knows them."""
        shares: dict[int, list[str]] = {}
        for name in names:
            place, own = self._where(name)
            shares.setdefault(place, []).append(own)
        return sorted(shares.items())

    def _as_one(self, readers: Sequence[tuple[int, Readable]]) -> Readable:
        shown = {where: name for name, where in self._of.items()}
        return _Readers([(reader, [shown[place, own] for own in reader.names]) for place, reader in readers])

    def enter_initialisation(self, start: float, stop: float | None = None) -> None:
        """Prepare all to begin at `start` [s], and exchange outputs and inputs until they agree."""
        for component in self._held:
            component.enter_initialisation(start, stop)
        self._exchange.forget()
        self._exchange.settle(start)
        self._time = start
        self._stale = True

    def exit_initialisation(self) -> None:
        """Begin, with what was set meanwhile."""
        if self._stale:
            self._exchange.settle(self._time)
        for component in self._held:
            component.exit_initialisation()
        self._exchange.settle(self._time)
        self._stale = False

    def step(self, time: float, size: float) -> None:
        """Advance all from `time` by `size` [s].

        What was set from outside since the last step is first passed on along the connections; then come the coupling
        steps that the step control makes of the step.
        """
        if size <= 0.0:
            return
        if self._stale:
            self._exchange.settle(time)
            self._stale = False
        if self._one_length:
            self._need_whole_steps(time, size)
        self._steps.advance(time, time + size, size)
        self._time = time + size

    def save(self, key: str = "") -> None:
        """Keep the present state of all and of what is between them under this key."""
        self._steps.save(KEPT + key)
        self._times[key] = self._time

    def restore(self, key: str = "") -> None:
        """Go back to what was kept last under this key."""
        self._time = self._times[key]
        self._steps.restore(KEPT + key, self._time)

    def release(self, key: str = "") -> None:
        """Nobody goes back to what was kept under this key any more."""
        self._steps.release(KEPT + key)

    def as_kept(self) -> dict[str, Any]:
        return {
            "components": [component.as_kept() for component in self._held],
            "exchange": self._exchange.as_kept(),
            "steps": self._steps.as_kept(),
            "statistics": vars(self._statistics).copy(),
            "length": self._length,
            "time": self._time,
            "stale": self._stale,
        }

    def take_up(self, kept: Mapping[str, Any]) -> None:
        for component, own in zip(self._held, kept["components"], strict=True):
            component.take_up(own)
        self._exchange.take_up(kept["exchange"])
        self._steps.take_up(kept["steps"])
        vars(self._statistics).update(kept["statistics"])
        self._length, self._time, self._stale = kept["length"], kept["time"], kept["stale"]

    def cpu_apart(self) -> float:
        """CPU time of those in processes of their own [s]."""
        return sum(cpu_apart(component) for component in self._held)

    def close(self) -> None:
        """Close every component; the first failure is raised once all have been."""
        failure: Exception | None = None
        for component in self._held:
            try:
                component.close()
            except Exception as error:
                failure = failure or error
        if failure is not None:
            raise failure


class _Readers:
    """Readers of several components as one row."""

    def __init__(self, parts: Sequence[tuple[Readable, Sequence[str]]]) -> None:
        self.names: tuple[str, ...] = tuple(name for _, names in parts for name in names)
        self.values: Row = np.zeros(len(self.names))
        self._parts: list[tuple[Readable, slice]] = []
        begin = 0
        for reader, names in parts:
            self._parts.append((reader, slice(begin, begin + len(names))))
            begin += len(names)

    def __call__(self) -> Row:
        for reader, part in self._parts:
            self.values[part] = reader()
        return self.values
