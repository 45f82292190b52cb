"""A phase as a loop over communication points on one component; what it leaves is a `PhaseResult`.

Every communication point is start + i * macro_step, from an integer, so nothing accumulates.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Mapping

import numpy as np

from dcone_cosim import interrupts
from dcone_cosim.contract import END_TIMES, NODE_PREFIX, THREAD_PREFIX, TUG_PREFIX
from dcone_cosim.errors import FmuError, Interrupted
from dcone_cosim.fmu.component import Readable, Steppable, Terminated, output_names
from dcone_cosim.fmu.restoring import differing
from dcone_cosim.fmu.steppable import cpu_apart
from dcone_cosim.holding import Holding, holding
from dcone_cosim.progress import Progress
from dcone_cosim.recorder import Recorder
from dcone_cosim.results import PhaseResult
from dcone_cosim.states import Keeper, KeptState

SAME = 1e-6
"""Relative difference up to which two steps are of one length: at t = 1e6 s a step of 1 ms has lost six digits."""

SAME_INSTANT = 1e-9
"""Relative difference up to which two tellings of an instant are of the same."""

COMPLETED = "completed"
"""Outcome of a phase that was stepped to its end."""


def coupling_of(component: Steppable) -> dict[str, float]:
    """What the coupling of several FMUs has cost; empty for one."""
    return dict(getattr(component, "statistics", {}))


class Stopwatch:
    """Notes in a result what its phase takes, on the clock and of the processors [s]."""

    def __init__(self, result: PhaseResult, component: Steppable) -> None:
        self.result, self.component = result, component

    def _cpu(self) -> float:
        return clock.process_time() + cpu_apart(self.component)

    def __enter__(self) -> None:
        self.cpu, self.wall = self._cpu(), clock.perf_counter()

    def __exit__(self, *_: object) -> None:
        self.result.cpu = self._cpu() - self.cpu
        self.result.wall = clock.perf_counter() - self.wall


def grid_steps(duration: float, macro_step: float) -> int:
    """Number of macro steps that cover the duration; the last one may be shorter."""
    return max(1, math.ceil(duration / macro_step - 1e-9))


def length_of(size: float, component: Steppable, macro_step: float) -> float:
    """Length of a step [s]. The difference of two times may have lost its last bits, and an FMU that takes steps of one
    length may compare them: it gets the macro step itself."""
    same = not component.can_vary_step and math.isclose(size, macro_step, rel_tol=SAME)
    return macro_step if same else size


def carried_out(result: PhaseResult, component: Steppable, steps: Callable[[], None]) -> PhaseResult:
    """The result of a phase once its steps are taken; the FMU's own end, a failure and an interrupt are noted in it."""
    with Stopwatch(result, component):
        try:
            steps()
        except Terminated as end:
            result.ended(end)
        except (FmuError, Interrupted) as error:
            result.error = interrupts.instead_of(error, result.name, result.end)
    result.coupling = coupling_of(component)
    return result


def take_up(component: Holding, read: Readable, result: PhaseResult, state: KeptState, earlier: PhaseResult) -> None:
    """Stand where a state was kept, with the rows up to it; `FmuError` where it does not fit them.

    earlier    the phase as it was run when the state was kept
    """
    name, rows = result.name, earlier.recorder
    if not 0 < state.rows <= len(rows) or rows["time"][state.rows - 1] != state.time:
        raise FmuError(
            f"{name}: row {state.rows} of its table is not at t = {state.time:.9g} s, where the state was kept"
        )
    if rows.names != result.recorder.names:
        raise FmuError(f"{name}: its table has other columns than the outputs of its FMU")
    component.take_up(state.component)
    result.recorder.take_up(rows, state.rows)
    last = result.recorder.last()
    found = differing(read.names, np.array(list(last.values())), read())
    if found is not None:
        output, before, after = found
        raise FmuError(
            f"{name}: the kept state does not fit its table: at t = {state.time:.9g} s the output {output} was "
            f"{before:.12g}, and is {after:.12g} in the state"
        )


class PhaseLoop:
    """Steps a component for the duration of a phase, records a row at every communication point, or at every so many of
    them, and gathers its tugs. A row has the extremes of all steps since the one before.

    start        time the FMU is told to begin at [s]
    origin       in that time, what the times of the result are counted from [s]
    """

    def __init__(
        self,
        component: Steppable,
        macro_step: float,
        start: float,
        duration: float,
        progress: Progress,
        origin: float = 0.0,
    ) -> None:
        self.component = holding(component)
        self.macro_step, self.duration = macro_step, duration
        self.progress = progress
        self.keeper: Keeper | None = None
        self._next = 0
        self._every = 1
        self._many, self._until = 1, 0
        self.read = self.component.row(
            output_names(component.variables, without=(NODE_PREFIX, THREAD_PREFIX, TUG_PREFIX))
        )
        self.result = PhaseResult(
            component.name,
            start - origin,
            Recorder(self.read.names, component.variables, grid_steps(duration, macro_step) + 1),
            tugs=self.component.tugs,
            origin=origin,
        )

    def run(self) -> PhaseResult:
        """Step to the end of the phase, or of its FMU; see `carried_out`."""
        result = carried_out(self.result, self.component, self._run)
        if result.error is not None:
            result.outcome = "stopped"
        return result

    def thin(self, every: int) -> None:
        """Record one row for so many steps, and the last."""
        self._every = every
        rows = grid_steps(self.duration, self.macro_step) // every + 2
        self.result.recorder = Recorder(self.read.names, self.component.variables, rows)

    def _record(self, time: float) -> None:
        self.result.recorder.add(time, self.read())
        self.component.begin_row()

    def _run(self) -> None:
        component, result = self.component, self.result
        start, origin = result.start, result.origin
        steps = grid_steps(self.duration, self.macro_step)
        if not len(result.recorder):
            self._record(start)
            self._offer(0, start)
        interrupts.arm()
        done = self._next
        while done < steps:
            i, done = done, done + (self._many if done < self._until else 1)
            try:
                interrupts.check(result.name, start + i * self.macro_step)
            except Interrupted:
                if i % self._every:
                    self._record(start + i * self.macro_step)
                raise
            end = start + (self.duration if done == steps else done * self.macro_step)
            begun = origin + (start + i * self.macro_step)
            try:
                component.step(begun, length_of((origin + end) - begun, component, self.macro_step))
            except Terminated as own:
                self._record_end(own.time)
                raise
            result.steps += done - i
            if done % self._every == 0 or done == steps:
                self._record(end)
                if end == start + done * self.macro_step:
                    self._offer(done, end)
            self.progress.at(end)
        result.outcome = COMPLETED

    def _record_end(self, time: float) -> None:
        """A row of the instant [s] at which the FMU has ended itself, if it says that its outputs are of that."""
        names = [name for name in END_TIMES if name in self.component.variables]
        result = self.result
        since = time - (result.origin + result.start)
        if since > result.end - result.start and any(
            math.isclose(told, since, rel_tol=SAME_INSTANT) for told in self.component.get(names).values()
        ):
            self._record(time - result.origin)

    def _offer(self, following: int, time: float) -> None:
        """The state here may be kept: it is on the grid of all runs with this macro step, however long they are."""
        if self.keeper is not None:
            rows = len(self.result.recorder)
            self.keeper.look(time, rows, self.component, lambda: {"next": following, "steps": self.result.steps})

    def take_up(self, state: KeptState, earlier: PhaseResult, changed: Mapping[str, float]) -> None:
        """Go on from a kept state, with other values of some variables from there on, SI."""
        take_up(self.component, self.read, self.result, state, earlier)
        self._next, self.result.steps = int(state.loop["next"]), int(state.loop["steps"])
        if changed:
            self.component.set(changed)
