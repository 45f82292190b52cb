"""The capture as a loop that ends in the instant of its hand-over, wherever between two communication points that lies.

Times count from the shot, whatever time the FMU is told to begin at.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dcone_cosim import interrupts
from dcone_cosim.contract import FAILED_OUTCOMES, NEVER, NODE_PREFIX, OUTCOMES, THREAD_PREFIX
from dcone_cosim.errors import FmuError
from dcone_cosim.fmu import restoring
from dcone_cosim.fmu.component import Readable, Row, Steppable, output_names
from dcone_cosim.frames import Frames, Whole
from dcone_cosim.holding import holding
from dcone_cosim.phases.stepping import carried_out, grid_steps, length_of, take_up
from dcone_cosim.progress import Progress
from dcone_cosim.recorder import Recorder, Snapshots
from dcone_cosim.results import PhaseResult
from dcone_cosim.states import Keeper, KeptState

COUNTS = ("net.nodes", "net.threads")
"""Outputs that tell how many of the others mean something."""
NODE_OF_THREAD = "].node["
LOCATED_TO = 1e-6
"""How closely the instant of a hand-over is located by halving [s]."""


@dataclass(frozen=True)
class CapturePlan:
    """What the capture loop is asked to do.

    hand_over      the trigger (see `contract.HAND_OVER`)
    stop_there     end at the trigger, since a removal follows; otherwise go on
    after_capture  go on for this long after the trigger [s]
    snapshots      when to keep node positions [s]; empty: evenly spread
    replay_every   time from frame to frame of a replay [s]; infinite: none is kept
    start          time the FMU is told to begin at [s]; all other times count from there, the shot
    """

    macro_step: float
    duration: float
    hand_over: str = "captured"
    stop_there: bool = False
    after_capture: float = math.inf
    snapshots: Sequence[float] = ()
    replay_every: float = math.inf
    start: float = 0.0


class CaptureLoop:
    """Steps a capture FMU until it has handed over, failed, or run out of time."""

    def __init__(self, component: Steppable, plan: CapturePlan, progress: Progress) -> None:
        self.component = holding(component)
        self.plan = plan
        self.progress = progress
        self.keeper: Keeper | None = None
        self._next = 0
        names = output_names(component.variables, without=(NODE_PREFIX, THREAD_PREFIX))
        self.read = self.component.row(names)
        self.place = {name: i for i, name in enumerate(self.read.names)}
        self.read_nodes = self._reader(NODE_PREFIX, "]")
        self.read_tensions = self._reader(THREAD_PREFIX, "].tension")
        self.can_locate = component.can_save and component.can_vary_step
        self._kept: Row = self.read.values
        self.tether_length = math.inf
        if plan.hand_over == "tether_taut":
            self._need("tether.paid_out")
            self.tether_length = component.get(["tether.length"])["tether.length"]
        if plan.hand_over != NEVER:
            self._need("settled" if plan.hand_over == "settled" else "captured")
        self.result = PhaseResult(
            component.name,
            0.0,
            Recorder(self.read.names, component.variables, grid_steps(plan.duration, plan.macro_step) + 3),
            Snapshots(plan.snapshots),
            origin=plan.start,
            frames=Frames(plan.replay_every) if math.isfinite(plan.replay_every) else None,
        )

    def _reader(self, prefix: str, ending: str) -> Readable | None:
        """Of all outputs with such names; None where there are none."""
        told = output_names(self.component.variables)
        names = [name for name in told if name.startswith(prefix) and name.endswith(ending)]
        return self.component.reader(names) if names else None

    def _need(self, name: str) -> None:
        if name not in self.place:
            raise FmuError(f"{self.component.name}: handing over when {self.plan.hand_over} needs the output {name}")

    def triggered(self) -> bool:
        """Whether the row read last says that it is time to hand over."""
        values = self.read.values
        if self.plan.hand_over == NEVER:
            return False
        if self.plan.hand_over == "settled":
            return bool(values[self.place["settled"]])
        captured = bool(values[self.place["captured"]])
        if self.plan.hand_over == "captured":
            return captured
        return captured and bool(values[self.place["tether.paid_out"]] >= self.tether_length)

    def outcome(self) -> str:
        if "outcome" not in self.place:
            place = self.place.get("captured")
            return "captured" if place is not None and bool(self.read.values[place]) else "flying"
        number = int(self.read.values[self.place["outcome"]])
        return OUTCOMES[number] if number in range(len(OUTCOMES)) else f"outcome {number}"

    def run(self) -> PhaseResult:
        return carried_out(self.result, self.component, self._run)

    def _step(self, begin: float, end: float) -> None:
        """Between two times since the shot."""
        origin = self.plan.start
        size = (origin + end) - (origin + begin)
        self.component.step(origin + begin, length_of(size, self.component, self.plan.macro_step))

    def _save(self) -> None:
        self._kept = restoring.save(self.component, self.read)

    def _restore(self, time: float) -> None:
        restoring.restore(self.component, self.read, self._kept, self.plan.start + time)

    def _record(self, time: float, force: bool = False) -> None:
        self.result.recorder.add(time, self.read())
        self.component.begin_row()
        if self.read_nodes is not None and (self.result.snapshots.due(time, 1e-9) or force):
            count = int(self.read.values[self.place["net.nodes"]]) if "net.nodes" in self.place else None
            positions = self.read_nodes().reshape(-1, 3)
            self.result.snapshots.add(time, positions[:count])
        frames = self.result.frames
        if frames is not None and (frames.due(time) or force):
            self._add_frame(frames, time)

    def _add_frame(self, frames: Frames, time: float) -> None:
        """The net as it is now; between which nodes its threads run is asked once."""
        count = {name: int(self.read.values[self.place[name]]) for name in COUNTS if name in self.place}
        if not frames.times and self.read_tensions is not None:
            frames.ends = self._ends(count.get("net.threads"))
        positions = self.read_nodes().reshape(-1, 3) if self.read_nodes is not None else np.zeros((0, 3))
        tensions = self.read_tensions() if self.read_tensions is not None else np.zeros(0)
        frames.add(time, positions[: count.get("net.nodes")], tensions)

    def _ends(self, count: int | None) -> Whole:
        """Numbers of the two nodes of each thread, (threads, 2)."""
        names = [name for name in output_names(self.component.variables) if name.startswith(THREAD_PREFIX)]
        told = self.component.get([name for name in names if NODE_OF_THREAD in name])
        return np.array(list(told.values()), dtype=np.int64).reshape(-1, 2)[:count]

    def _run(self) -> None:
        plan, result = self.plan, self.result
        if not len(result.recorder):
            self._record(0.0)
            self._offer(0, 0.0)
        interrupts.arm()
        last = plan.duration if result.located is None else min(plan.duration, result.located + plan.after_capture)
        for i in range(self._next, grid_steps(plan.duration, plan.macro_step)):
            begin, end = i * plan.macro_step, min((i + 1) * plan.macro_step, last)
            if begin >= last:
                break
            interrupts.check(result.name, begin)
            searching = result.located is None and plan.hand_over != NEVER
            if searching and self.can_locate:
                self._save()
            self._step(begin, end)
            result.steps += 1
            self.read()
            if searching and self.triggered():
                at = self._locate(begin, end)
                self.component.release()
                result.located = at
                last = min(plan.duration, at if plan.stop_there else at + plan.after_capture)
                self._record(at, force=True)
                self.progress.at(at)
                if plan.stop_there:
                    break
                end = min(end, last)
                if at < end:
                    self._step(at, end)
                    self._record(end)
            else:
                self._record(end)
            result.outcome = self.outcome()
            self.progress.at(end)
            if searching and result.outcome in FAILED_OUTCOMES and result.located is None:
                break
            if end == (i + 1) * plan.macro_step:
                self._offer(i + 1, end)
        self.read()
        result.outcome = self.outcome()

    def _offer(self, following: int, time: float) -> None:
        """The state here may be kept: it is on the grid of all captures with this macro step."""
        if self.keeper is not None:
            self.keeper.look(time, len(self.result.recorder), self.component, lambda: self._stand(following))

    def _stand(self, following: int) -> dict[str, Any]:
        result = self.result
        told = {name: getattr(result, name) for name in ("steps", "outcome", "located", "located_by")}
        frames = {} if result.frames is None else {"frames": result.frames.as_kept()}
        return {"next": following, "snapshots": result.snapshots.as_kept(), "result": told, **frames}

    def take_up(self, state: KeptState, earlier: PhaseResult, changed: Mapping[str, float]) -> None:
        """Go on from a kept state, with other values of some variables from there on, SI."""
        located = state.loop["result"]["located"]
        if located is not None and self.plan.stop_there:
            raise FmuError(
                f"{self.component.name}: it would have handed over at t = {located:.9g} s, before the state was kept; "
                "go on from an earlier one"
            )
        take_up(self.component, self.read, self.result, state, earlier)
        self._next = int(state.loop["next"])
        self.result.snapshots.take_up(state.loop["snapshots"])
        if self.result.frames is not None:
            self.result.frames.take_up(state.loop["frames"])
        vars(self.result).update(state.loop["result"])
        if changed:
            self.component.set(changed)

    def _locate(self, begin: float, end: float) -> float:
        """Instant of the trigger in the step just taken, since the shot; the component is left there.

        Goes to `t_capture` when the FMU reports it in the step, otherwise halves the step down to `LOCATED_TO`.
        """
        component, result = self.component, self.result
        place = self.place.get("t_capture")
        reported = (
            float(self.read.values[place]) if place is not None and self.plan.hand_over == "captured" else math.nan
        )
        if not self.can_locate:
            why = "takes only steps of one length" if component.can_save else "cannot save its state"
            result.located_by = f"end of the macro step of {end - begin:g} s: this FMU {why}"
            if begin < reported <= end:
                result.located_by += f" (it reports {reported:.9g} s)"
            return end
        low, high = begin, end
        origin = self.plan.start
        restoring.replay(component, self.read, self._kept, origin + begin, origin + end)
        if begin < reported < end:
            there = origin + reported
            if there - origin < reported:  # by rounding: an FMU that was not started at zero would not be there yet
                there = math.nextafter(there, math.inf)
            component.step(origin + begin, there - (origin + begin))
            self.read()
            if self.triggered():
                result.located_by = "the FMU's own t_capture, reached from its saved state"
                return reported
            low = reported
            self._save()
        elif reported == end:
            self._step(begin, end)
            result.located_by = "the FMU's own t_capture"
            return end
        while high - low > LOCATED_TO:
            middle = 0.5 * (low + high)
            self._step(low, middle)
            self.read()
            if self.triggered():
                high = middle
                self._restore(low)
            else:
                low = middle
                self._save()
        self._step(low, high)
        result.located_by = f"halving the macro step to {high - low:.2g} s"
        return high
