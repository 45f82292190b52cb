"""The capture: a net is shot, opens, wraps the target and closes; it may hand over, or be flown to its end."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

from dcone_cosim import build
from dcone_cosim.contract import ENDED, FAILED_OUTCOMES, FLOWN, HAND_OVER, NEVER, OUTCOMES
from dcone_cosim.criteria import Criterion, Evidence
from dcone_cosim.errors import CAPTURE_FAILED
from dcone_cosim.events import Event
from dcone_cosim.findings import Finding
from dcone_cosim.fmu.component import Steppable
from dcone_cosim.handoff import CAPTURE_OUTPUTS, CAPTURE_PARAMETERS
from dcone_cosim.phases import capture_clip, capture_criteria, capture_quantities, capture_report, chaos, swinging
from dcone_cosim.phases.capture_loop import CaptureLoop, CapturePlan
from dcone_cosim.phases.phase import Document, Figure, Loop, Main, Phase, Stage, failed
from dcone_cosim.quantities import Quantity
from dcone_cosim.results import PhaseResult, RunResult
from dcone_cosim.scene.data import PhaseScene, Scene
from dcone_cosim.scene.expected import ANY, Expected
from dcone_cosim.scene.mistakes import Mistake
from dcone_cosim.scenery import Chart, Clip

OPENING = "shot.opening"
"""Key of how far bullets fly until they alone would have spread the net."""
NEEDED = ("target", "closing")
"""Tables of a scene without which no capture can ever be reported."""
NEEDED_FOR = {"settled": "settling", "tether_taut": "tether"}
"""Table of a scene without which a condition for handing over never comes true."""


@dataclass(frozen=True)
class CaptureOptions:
    """What concerns the master of a capture.

    hand_over      one of `contract.HAND_OVER`
    after_capture  go on for this long after the capture, when no phase follows [s]
    snapshots      when to keep the positions of the nodes [s]; empty: evenly spread
    replay_every   from frame to frame of a replay [s]; infinite: none is kept
    """

    hand_over: str = "captured"
    after_capture: float = math.inf
    snapshots: Sequence[float] = ()
    replay_every: float = math.inf


class Capture(Phase):
    name = "capture"
    model = "net_capture"
    keys: Mapping[str, Expected] = {
        "hand_over": Expected("1", choices=HAND_OVER),
        "after_capture": Expected("s", example="1 s", minimum=0.0),
        "snapshots": Expected("s", example="5.32 s", minimum=0.0, size=ANY),
        "replay_every": Expected("s", example="40 ms", minimum=1e-6),
    }
    examples = ("0.02 s", "30 s")
    begins_at_zero = True
    keeps_nodes = True
    chaotic = True
    judged_by = capture_quantities.NAMES
    own_clock = True
    to_its_end = ("hand_over=none", "snapshots=[]")
    wanted = (
        ("captured", ("captured",)),
        ("settled", ("settled",)),
        ("tether_taut", ("tether.length", "tether.paid_out")),
        ("hand-over", (*CAPTURE_OUTPUTS, *CAPTURE_PARAMETERS)),
        ("optional", ("t_capture", "outcome", "net.nodes", "net.threads", "contact.first_time", "contact.loss")),
        ("optional", ("mouth.t80", "mouth.t_max", "mouth.area_max", "mouth.cord_length", "mouth.girth")),
        ("optional", ("thread.tension_max", "cord.tension_max", "closing.t_start", "closing.work")),
    )

    recognised_by = ("captured", *CAPTURE_OUTPUTS)

    def options(self, found: Mapping[str, Any], main: Main | None) -> CaptureOptions:
        """As told; without a word it hands over at capture, or never where no capture can be reported."""
        told = dict(found)
        if "hand_over" in told:
            told["hand_over"] = HAND_OVER[int(told["hand_over"])]
        elif main is not None and not _can_capture(main):
            told["hand_over"] = NEVER
        return CaptureOptions(**told)

    def hand_over(self, options: CaptureOptions) -> str:
        return options.hand_over

    def faults(self, document: Document) -> Iterator[Mistake]:
        """A condition for handing over that no term of the scene can report, or none although a phase follows."""
        part, given, path = (
            document.mains["capture"],
            document.tables["capture"].get("hand_over"),
            ("capture", "hand_over"),
        )
        group = NEEDED_FOR.get(given) if isinstance(given, str) else None
        if part.fmu is None and group is not None and group not in part.terms:
            yield Mistake(path, given, f"needs the table [capture.{group}], which this scene lacks")
        yield from swinging.faults(document, self.name)
        every = document.tables["capture"].get("replay_every")
        if every is not None and part.fmu is None and "nodes" not in part.terms:
            yield Mistake(("capture", "replay_every"), every, "needs the table [capture.nodes], which this scene lacks")
        following = document.after("capture")
        if not following:
            return
        if given == NEVER:
            yield Mistake(path, given, f"a {following} follows: expected one of {', '.join(HAND_OVER[:-1])}")
        text = f"expected this table: a {following} follows, and without it no capture is ever reported"
        if part.fmu is None:
            yield from (Mistake(("capture", name), None, text) for name in NEEDED if name not in part.terms)

    def by_itself(self, own: PhaseScene) -> PhaseScene:
        """Ended at the hand-over, as in the mission; alone, a capture goes on for `after_capture`."""
        return replace(own, options=replace(own.options, after_capture=0.0))

    def loop(self, stage: Stage, component: Steppable, start: float) -> Loop:
        phase = stage.phase
        told = {one.name: getattr(phase.options, one.name) for one in fields(CaptureOptions)}
        plan = CapturePlan(phase.macro_step, phase.duration, stop_there=stage.after is not None, start=start, **told)
        return CaptureLoop(component, plan, stage.progress)

    def judge(self, stage: Stage, result: PhaseResult) -> None:
        """Whether the net came to the condition for handing over; one that is flown to its end always does."""
        hand_over = stage.phase.options.hand_over
        if hand_over == NEVER:
            result.outcome = FLOWN if result.outcome == OUTCOMES[0] else result.outcome
            return
        if result.located is not None or (failed(result) and stage.next_of(result) is not None):
            return
        waited, stands = hand_over.replace("_", " "), result.outcome.replace("_", " ")
        if result.outcome == ENDED:
            text = f"its FMU ended at t = {result.ended_at:.6g} s, not {waited}\n  {result.ended_by}"
        elif result.outcome in FAILED_OUTCOMES:
            text = f"{stands} at t = {result.end:.6g} s"
        else:
            text = f"still {stands}, not {waited}, at the end of the phase, t = {result.end:.6g} s"
        stage.run.fail("capture failed", f"capture failed: {text}", CAPTURE_FAILED)

    def clock(self, run: RunResult) -> str:
        return "since the shot"

    def findings(self, run: RunResult, result: PhaseResult) -> Iterator[Finding]:
        return capture_report.findings(run, result)

    def own_events(self, result: PhaseResult) -> Iterator[Event]:
        return capture_report.own_events(result)

    def quantities(self, run: RunResult, result: PhaseResult, instants: Sequence[float]) -> Iterator[Quantity]:
        return capture_quantities.quantities(result, run.parameters.get(self.name, {}), instants)

    def criteria(self, evidence: Evidence) -> Iterator[Criterion]:
        return capture_criteria.criteria(evidence)

    def laden(self, phase: PhaseScene) -> tuple[Mapping[str, float], float] | None:
        """Flat from the start: folded, most threads sleep, and a beginning tells nothing of what an open net costs."""
        values = phase.main.values
        sides = build.mouth_sides(values, phase.main.terms)
        if not sides or "net.fold_side" not in values:
            return None
        rows = build.implied("net_capture", values, phase.main.terms)
        way = next((row.value for row in rows if row.key == OPENING), math.inf)
        speed = values["bullets.speed"] * math.cos(values["bullets.angle"])
        return {"net.fold_side": (1.0 - 1e-9) * min(sides)}, way / speed if speed > 0.0 else math.inf

    def rounding(self, phase: PhaseScene) -> float | None:
        return capture_criteria.BOOKED.get(phase.main.terms.get("precision", "double"))

    def spreads(self, run: RunResult, result: PhaseResult) -> Mapping[str, float]:
        return chaos.CAPTURE

    def figures(self, run: RunResult, result: PhaseResult) -> Iterator[Figure]:
        phase = next(phase for phase in run.scene.phases if phase.name == result.name)
        yield from ((f"{self.prefix}{file}", draw) for file, draw in capture_report.figures(run, phase, result))

    def clip(self, run: RunResult, result: PhaseResult) -> Clip | None:
        phase = next(phase for phase in run.scene.phases if phase.name == result.name)
        return capture_clip.clip(run, phase, result, self.marks(result))

    def charts(self, run: RunResult, result: PhaseResult) -> Iterator[Chart]:
        return capture_clip.charts(result, self.marks(result))

    def without_figure(self, scene: Scene, result: PhaseResult) -> Iterator[str]:
        if not result.snapshots.times:
            why = "the capture's FMU has no outputs for the nodes of a net"
            if next(phase for phase in scene.phases if phase.name == self.name).main.fmu is None:
                why = "the scene has no table [capture.nodes], which brings their positions into the FMU"
            yield f"no picture of the net in space: {why}"


def _can_capture(main: Main) -> bool:
    return all(group in main.terms for group in NEEDED) if main.fmu is None else "captured" in main.slots


PHASE = Capture()
