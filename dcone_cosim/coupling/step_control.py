"""How long the coupling steps are between two communication points of a phase: fixed, or controlled by their error."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Protocol

from dcone_cosim.coupling.exchange import Exchange
from dcone_cosim.coupling.options import Coupling
from dcone_cosim.errors import FmuError
from dcone_cosim.fmu.component import CallError, Terminated

BEGIN = "coupling begin"
"""Key under which the begin of a fixed step is kept, for an FMU that ends itself within it."""
TRIAL = "coupling trial"
"""Key under which the begin of a controlled step is kept."""
SAFETY, MOST_SHRINK, LEAST_SHRINK, MOST_GROWTH = 0.9, 0.1, 0.8, 5.0
SMALLEST_SIZE = 1e-12
"""Added to the tolerated error of an output, SI, so that one that is zero all the time can be compared."""
FORCED_RUNNING = 100
"""So many forced steps one after the other are no jump: the coupling is unstable, or asks for too much."""


@dataclass
class Statistics:
    """What stepping has cost, and how far it had to go down.

    steps      coupling steps that count
    rejected   controlled steps that were rolled back, `discarded` of them since an FMU discarded
    forced     steps of the smallest size that were taken although their error was too large
    smallest, largest   coupling step that counts [s]
    """

    steps: int = 0
    rejected: int = 0
    discarded: int = 0
    forced: int = 0
    smallest: float = math.inf
    largest: float = 0.0

    def count(self, size: float) -> None:
        self.steps += 1
        self.smallest, self.largest = min(self.smallest, size), max(self.largest, size)

    def as_dict(self) -> dict[str, float]:
        found = asdict(self)
        return found if self.steps else found | {"smallest": 0.0}


class StepControl(Protocol):
    """Goes from one communication point to another; what it remembers can be kept and gone back to."""

    def advance(self, begin: float, end: float, macro_step: float) -> None: ...
    def save(self, key: str) -> None: ...
    def restore(self, key: str, time: float) -> None: ...
    def release(self, key: str) -> None: ...
    def as_kept(self) -> dict[str, Any]:
        """What it remembers, as plain data."""

    def take_up(self, kept: Mapping[str, Any]) -> None:
        """Remember what `as_kept` says."""


class FixedSteps:
    """Coupling steps of one length; the last one of a macro step may be shorter. Times come from integers.

    even       a component takes steps of one length: all are the same to the last bit, and fill the macro step
    can_meet   all can go back, and take a shorter step to the time at which one of them has ended itself. Each coupling
               step is kept for that alone, and none before it: an FMU may throw away what lies before a step
    """

    def __init__(
        self, exchange: Exchange, coupling: Coupling, statistics: Statistics, can_meet: bool, even: bool
    ) -> None:
        self.exchange, self.size, self.statistics = exchange, coupling.step, statistics
        self.can_meet, self.even = can_meet, even

    def advance(self, begin: float, end: float, macro_step: float) -> None:
        step = self.size or end - begin
        count = max(1, math.ceil((end - begin) / step - 1e-9))
        for k in range(count):
            time = begin + k * step
            # one step is the caller's own: the difference of two times may have lost its last bit
            size = macro_step if count == 1 else (end if k == count - 1 else begin + (k + 1) * step) - time
            if self.even:
                size = self.size or macro_step
            if self.can_meet:
                self.exchange.save(BEGIN)
            try:
                self.exchange.step(time, size)
            except Terminated as end_of_one:
                if self.can_meet:
                    self._meet(time, end_of_one)
                raise
            self.statistics.count(size)

    def _meet(self, begin: float, end: Terminated) -> None:
        """Bring all components to the time at which one of them has ended itself, in a step from `begin` [s]."""
        self.exchange.restore(BEGIN, begin)
        if end.time <= begin:
            return
        try:
            self.exchange.step(begin, end.time - begin)
            self.statistics.count(end.time - begin)
        except Terminated as again:
            self.exchange.restore(BEGIN, begin)
            end.reached = again.reached = begin

    def save(self, key: str) -> None:
        self.exchange.save(key)

    def restore(self, key: str, time: float) -> None:
        self.exchange.restore(key, time)

    def release(self, key: str) -> None:
        self.exchange.release(key)

    def as_kept(self) -> dict[str, Any]:
        return {}

    def take_up(self, kept: Mapping[str, Any]) -> None:
        """Steps of one length remember nothing."""


class ControlledSteps:
    """Coupling steps as long as their error allows, by comparing a whole step with two halves, which then count.

        error = max |y_1 - y_2| / (2^p - 1) / (tolerance |y|max + 1e-12 SI) * macro step / h

    over the connected outputs and those of components that only take, p the order of convergence, |y|max the largest
    size of that output so far, the very first trial included, since an output may begin at zero. The last factor makes
    the tolerance that of a macro step: the error reached goes with the tolerance, not with a power of it. A step with
    an error above 1 is rolled back and tried shorter, as is one that an FMU discards. Before the first, every FMU
    has to show that it goes back to where it was. With these steps all components stand together where one of them ends
    itself, within `smallest_step` before it.

    A jump of an output in the second half is seen by neither, for the inputs of both were set before it. So it is asked
    as well that what comes as a surprise, over the time it was unknown, stays within the tolerance of a macro step:

        sum over the halves |y - y expected| h / 2 <= (tolerance |y|max + 1e-12 SI) * macro step

    Where no step meets the tolerance, as at a jump in the first half, one of `smallest_step` is taken as it is and
    counted as forced.

    Source   step doubling as in Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I, section II.4;
             error per unit step
    Checked  tests/cosim/test_coupling_orders.py, tests/cosim/test_coupling_control.py
    """

    def __init__(self, exchange: Exchange, coupling: Coupling, statistics: Statistics) -> None:
        self.exchange, self.coupling, self.statistics = exchange, coupling, statistics
        self.power = coupling.convergence_order
        self._next = coupling.step or math.inf
        self._largest: list[float] = []
        self._forced = 0
        self._restores = False
        self._smallest = coupling.smallest_step
        self._kept: dict[str, tuple[float, list[float], int]] = {}

    def advance(self, begin: float, end: float, macro_step: float) -> None:
        time = begin
        self._next = macro_step if math.isinf(self._next) else self._next
        # No step is so short that adding it to the time does nothing.
        self._smallest = max(self.coupling.smallest_step, 16.0 * math.ulp(end))
        while time < end:
            left = end - time
            size = left if self._next >= left * (1.0 - 1e-9) else min(self._next, 0.5 * left)
            time = self._step(time, size, end, macro_step)

    def _step(self, time: float, size: float, end: float, macro_step: float) -> float:
        """Take one step of at most this size, and return where it ends."""
        self.exchange.save(TRIAL)
        planned = self._next
        rejected = False
        while True:
            until = end if end - time - size <= self._smallest else time + size
            smallest = size <= self._smallest
            try:
                if not self._restores:
                    self.exchange.check_restoring(time, until - time)
                    self._restores = True
                error, largest = self._try(time, until, macro_step)
            except CallError as refusal:
                if refusal.status != "Discard":
                    raise
                self.exchange.restore(TRIAL, time)
                if smallest:
                    refusal.reached = time
                    raise
                self.statistics.discarded += 1
                error = math.inf
            else:
                self._largest = self._largest or largest
                if error <= 1.0 or smallest:
                    break
                self.exchange.restore(TRIAL, time)
            rejected = True
            self.statistics.rejected += 1
            size = max(size * self._factor(error, LEAST_SHRINK), self._smallest)
        self._largest = largest
        self._count(time, until, error)
        growth = self._factor(error, 1.0 if rejected else MOST_GROWTH)
        # A step cut short by the communication point says nothing against the one planned.
        following = size * growth if rejected else max(size * growth, planned if size < planned else 0.0)
        self._next = max(following, self._smallest)
        return until

    def _try(self, time: float, until: float, macro_step: float) -> tuple[float, list[float]]:
        """A whole step and two halves: the error of the halves in tolerances, and the sizes it was measured by."""
        exchange = self.exchange
        exchange.step(time, until - time)
        whole = exchange.measured()
        exchange.restore(TRIAL, time)
        middle = time + 0.5 * (until - time)
        exchange.step(time, middle - time)
        unknown = [surprise * (middle - time) for surprise in exchange.surprise]
        exchange.step(middle, until - middle)
        unknown = [u + surprise * (until - middle) for u, surprise in zip(unknown, exchange.surprise, strict=True)]
        halves = exchange.measured()
        known = self._largest or [0.0] * len(halves)
        largest = [max(m, abs(y)) for m, y in zip(known, halves, strict=True)]
        allowed = [(self.coupling.tolerance * size + SMALLEST_SIZE) / macro_step for size in largest]
        share = (2.0**self.power - 1.0) * (until - time)
        errors = [abs(one - two) / (share * a) for one, two, a in zip(whole, halves, allowed, strict=True)]
        errors += [u / (macro_step**2 * a) for u, a in zip(unknown, allowed, strict=False)]
        return max(errors, default=0.0), largest

    def _factor(self, error: float, most: float) -> float:
        """By how much the next step may differ from the one with this error."""
        if error == 0.0:
            return most
        return min(most, max(MOST_SHRINK, SAFETY * math.pow(error, -1.0 / self.power)))

    def _count(self, time: float, until: float, error: float) -> None:
        half = 0.5 * (until - time)
        self.statistics.count(half)
        self.statistics.count(half)
        self._forced = self._forced + 1 if error > 1.0 else 0
        self.statistics.forced += error > 1.0
        if self._forced >= FORCED_RUNNING:
            raise FmuError(
                f"the coupling's error stays above tolerance = {self.coupling.tolerance:g} in {self._forced} steps of "
                f"smallest_step = {self.coupling.smallest_step:g} s, one after the other, up to t = {until:.9g} s "
                f"(now {error:.3g} times too large)\n  the coupled FMUs are unstable together, or the tolerance is "
                "finer than what they reach themselves; loosen it, or take smallest_step smaller"
            )

    def save(self, key: str) -> None:
        self.exchange.save(key)
        self._kept[key] = (self._next, list(self._largest), self._forced)

    def restore(self, key: str, time: float) -> None:
        self.exchange.restore(key, time)
        self._next, largest, self._forced = self._kept[key]
        self._largest = list(largest)

    def release(self, key: str) -> None:
        self.exchange.release(key)
        self._kept.pop(key, None)

    def as_kept(self) -> dict[str, Any]:
        return {"next": self._next, "largest": list(self._largest), "forced": self._forced, "restores": self._restores}

    def take_up(self, kept: Mapping[str, Any]) -> None:
        self._next, self._forced, self._restores = kept["next"], kept["forced"], kept["restores"]
        self._largest = list(kept["largest"])
