"""One coupling step of several components: what goes from outputs to inputs, and when.

At a communication point outputs and inputs agree: an output that depends directly on an input is read again after the
input was set, until nothing changes. Within a step the inputs are held, or move at a rate.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from dcone_cosim.coupling.wiring import Link
from dcone_cosim.errors import FmuError
from dcone_cosim.fmu import restoring
from dcone_cosim.fmu.component import CallError, Steppable
from dcone_cosim.fmu.restoring import RESTORED_TO

SWEEPS = 1000
"""Most rounds over all components in which outputs and inputs have to agree."""
AGREED = 1e-12
"""Change of an input, relative to the largest value it took on the way, below which an algebraic loop has settled."""
UNSET = math.nan
COUPLED_FIXED = 'couple it with control = "fixed"'

Values = tuple[list[float], list[float], list[float]]


def _reals(component: Steppable) -> list[str]:
    return [v.name for v in component.variables.values() if v.causality == "output" and v.kind == "Real"]


class Exchange:
    """The components of a phase and the values between them, one entry per link.

    order           places of the components in which Gauss-Seidel takes them
    gauss_seidel    otherwise Jacobi
    linear          inputs that can move do so
    out             connected outputs, as read last
    surprise        by how much each differed after the last step from what its input was expected to be

    Source   Kübler and Schiehlen, Two methods of simulator coupling, Math. Comput. Model. Dyn. Syst. 6 (2000) 93;
             linear extrapolation through FMI's input derivatives
    Checked  tests/cosim/test_coupling_orders.py, tests/cosim/test_coupling.py
    """

    def __init__(
        self,
        components: Sequence[Steppable],
        links: Sequence[Link],
        order: Sequence[int],
        gauss_seidel: bool,
        linear: bool,
    ) -> None:
        self.components, self.links, self.order = components, links, order
        self.gauss_seidel = gauss_seidel
        self.moving = [linear and link.moves for link in links]
        places = range(len(components))
        self._into = [[k for k, link in enumerate(links) if link.target == i] for i in places]
        names = [list(dict.fromkeys(link.output for link in links if link.source == i)) for i in places]
        self._readers = [
            component.reader(chosen) if chosen else None for component, chosen in zip(components, names, strict=True)
        ]
        self._from = [
            [
                (k, reader.names.index(link.output))
                for k, link in enumerate(links)
                if reader is not None and link.source == i
            ]
            for i, reader in enumerate(self._readers)
        ]
        taking = [i for i in places if self._into[i] and self._readers[i] is None]
        self._last = [components[i].reader(shown) for i in taking if (shown := _reals(components[i]))]
        self._all = [component.reader(shown) if (shown := _reals(component)) else None for component in components]
        self.out = [UNSET] * len(links)
        self._held = [UNSET] * len(links)
        self._rate = [0.0] * len(links)
        self.surprise = [0.0] * len(links)
        self._kept: dict[str, Values] = {}

    def read(self, place: int, time: float) -> None:
        """Fetch the connected outputs of one component."""
        reader = self._readers[place]
        if reader is None:
            return
        row = reader()
        for k, column in self._from[place]:
            value = float(row[column])
            if not math.isfinite(value):
                raise FmuError(f"{self.components[place].name}: {self.links[k].output} is {value} at t = {time:.9g} s")
            self.out[k] = value

    def settle(self, time: float) -> None:
        """Set inputs to the outputs they are connected to until they agree, at a communication point.

        Components without a loop of direct dependences agree after as many rounds as the longest chain has members.
        """
        for place in self.order:
            self.read(place, time)
        moved: dict[int, tuple[float, float]] = {}
        largest = [0.0] * len(self.links)
        for sweep in range(SWEEPS):
            before, moved = moved, {}
            for place in self.order:
                fresh = {}
                for k in self._into[place]:
                    value, held = self.links[k].carried(self.out[k]), self._held[k]
                    if value != held:
                        largest[k] = max(largest[k], abs(value))
                        if not abs(value - held) <= AGREED * largest[k]:
                            moved[k] = (held, value)
                        fresh[self.links[k].input] = self._held[k] = value
                if fresh:
                    self.components[place].set(fresh)
                    try:
                        self.read(place, time)
                    except FmuError as error:
                        # chains without a loop have settled after as many rounds as there are components
                        if sweep < len(self.components) or (isinstance(error, CallError) and error.status):
                            raise
                        raise self._loop(f"grow without bound, in {sweep + 1} rounds", time, before | moved) from None
            if not moved:
                return
        raise self._loop(f"do not settle in {SWEEPS} rounds", time, moved)

    def _loop(self, what: str, time: float, moved: Mapping[int, tuple[float, float]]) -> FmuError:
        rows = [
            f"{self.links[k].connection}: from {held:.9g} to {value:.9g} {self.links[k].unit}"
            for k, (held, value) in moved.items()
        ]
        return FmuError(
            f"algebraic loop: outputs that depend directly on inputs {what} "
            f"at t = {time:.9g} s\n  " + "\n  ".join(rows) + "\n  a component with a state in the loop would break it"
        )

    def measured(self) -> list[float]:
        """What an error of a step is seen by: the connected outputs, and all Real ones of components at an end."""
        return [*self.out, *(value for reader in self._last for value in reader().tolist())]

    def forget(self) -> None:
        """Begin anew: nothing is held, no rate is known."""
        for k in range(len(self.links)):
            self._held[k], self._rate[k] = UNSET, 0.0

    def step(self, time: float, size: float) -> None:
        """One coupling step of all components from `time` by `size` [s]."""
        before = list(self.out)
        reached: set[int] = set()
        for place in self.order:
            fresh, rates = {}, {}
            for k in self._into[place]:
                link = self.links[k]
                ahead = self.gauss_seidel and link.source in reached
                if self.moving[k]:
                    rate = (self.out[k] - before[k]) / size if ahead else self._rate[k]
                    rates[link.input] = link.connection.factor * rate
                    self._held[k] = UNSET  # the FMU may keep the value set or the one reached
                elif ahead and self._held[k] != link.carried(self.out[k]):
                    fresh[link.input] = self._held[k] = link.carried(self.out[k])
            component = self.components[place]
            if fresh:
                component.set(fresh)
            if rates:
                component.set_rates(rates)
            component.step(time, size)
            if self.gauss_seidel:
                self.read(place, time + size)
                reached.add(place)
        self.settle(time + size)
        self.surprise = [
            abs(now - was - (rate * size if moving else 0.0))
            for now, was, rate, moving in zip(self.out, before, self._rate, self.moving, strict=True)
        ]
        self._rate = [(now - was) / size for now, was in zip(self.out, before, strict=True)]

    def check_restoring(self, time: float, size: float) -> None:
        """Let every component take a step by itself twice, inputs held, and see that it comes to the same.

        A component that goes back by its outputs and not by what they come from shows only there; in the coupled
        result it would be taken for an error of the coupling. All are left at `time`. Raises `FmuError` that names the
        component and its output; a discarded step is passed on, with all at `time`.
        """
        end = time + size
        for component, read in zip(self.components, self._all, strict=True):
            if read is None:
                continue
            read()
            kept = restoring.save(component, read)
            try:
                component.step(time, end - time)
                read()
            except CallError as refusal:
                if refusal.status == "Discard":
                    restoring.restore(component, read, kept, time, COUPLED_FIXED)
                raise
            restoring.replay(component, read, kept, time, end, COUPLED_FIXED)
            component.release()

    def as_kept(self) -> dict[str, Any]:
        """What stands between the components, as plain data; they themselves are kept apart."""
        lists = {"out": self.out, "held": self._held, "rate": self._rate, "surprise": self.surprise}
        return {name: list(values) for name, values in lists.items()}

    def take_up(self, kept: Mapping[str, Any]) -> None:
        """Stand where `as_kept` says."""
        self.out, self._held = list(kept["out"]), list(kept["held"])
        self._rate, self.surprise = list(kept["rate"]), list(kept["surprise"])

    def save(self, key: str) -> None:
        """Save every component and what stands between them under a key."""
        for component in self.components:
            component.save(key)
        self._kept[key] = (list(self.out), list(self._held), list(self._rate))

    def release(self, key: str) -> None:
        """Nobody goes back to what was kept under the key any more."""
        for component in self.components:
            component.release(key)
        self._kept.pop(key, None)

    def restore(self, key: str, time: float) -> None:
        """Restore every component and what stands between them, and see that the connected outputs are as they were."""
        out, held, rate = self._kept[key]
        for component in self.components:
            component.restore(key)
        self.out, self._held, self._rate = list(out), list(held), list(rate)
        for place, component in enumerate(self.components):
            self.read(place, time)
            for k, _ in self._from[place]:
                if not abs(self.out[k] - out[k]) <= RESTORED_TO * max(abs(self.out[k]), abs(out[k])):
                    raise FmuError(
                        f"{component.name} does not restore its state: {self.links[k].output} was {out[k]:.17g} "
                        f"{self.links[k].unit} when saved at t = {time:.9g} s, and is {self.out[k]:.17g} after\n"
                        f"  {COUPLED_FIXED}"
                    )
        self.out = list(out)
