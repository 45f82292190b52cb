"""What a run leaves: of each phase, of each hand-over, and of the whole."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

from dcone_cosim.contract import ENDED
from dcone_cosim.errors import SUCCESS, DconeError, Interrupted
from dcone_cosim.findings import Finding
from dcone_cosim.fmu.steppable import Steppable, Terminated
from dcone_cosim.frames import Frames
from dcone_cosim.ledger import LedgerRow
from dcone_cosim.recorder import Recorder, Snapshots, TugLog
from dcone_cosim.scene.data import PhaseScene, Scene
from dcone_cosim.states import KeptState

NO_SLACK = 1e-9
"""Way at the speed of the first tug since the start [m] up to which it is no tug: the line began at its length, and the
slack it took up is rounding."""


@dataclass
class PhaseResult:
    """What a phase leaves: its columns, and how it came out.

    start        of its own times [s]: 0 where they count from the begin of the phase
    origin       what these are counted from, in the time of its FMU [s]
    outcome      name of the outcome of a capture, or "completed"; "ended" when the FMU came to an end of its own
    located      instant of the hand-over [s] and how it was found, None when there was none
    cpu          time of the processors [s], that of FMUs in processes of their own included
    error        the failure, or the interrupt, that ended the phase early
    ended_by     what the FMU said as it came to its own end, "" when it did not; `ended_at` is when [s]
    coupling     steps of several coupled FMUs: how many, rejected, forced, smallest and largest [s]
    frames       of a net, for a replay, if that was asked
    passive      what becomes of a tow that stops at instants on the way, `phases.passive.Instant`, if that was asked
    """

    name: str
    start: float
    recorder: Recorder
    snapshots: Snapshots = field(default_factory=Snapshots)
    tugs: TugLog | None = None
    outcome: str = ""
    located: float | None = None
    located_by: str = ""
    steps: int = 0
    cpu: float = 0.0
    wall: float = 0.0
    error: DconeError | None = None
    coupling: Mapping[str, float] = field(default_factory=dict)
    ended_by: str = ""
    ended_at: float = math.nan
    origin: float = 0.0
    passive: Sequence[Any] = ()
    frames: Frames | None = None

    def ended(self, end: Terminated) -> None:
        """Note the FMU's own end, which is no failure. Unless it tells that its outputs are of that instant, the last
        row stays that of the communication point before."""
        self.outcome, self.ended_by, self.ended_at = ENDED, end.said, end.time - self.origin

    @property
    def end(self) -> float:
        return float(self.recorder["time"][-1]) if len(self.recorder) else self.start

    @property
    def is_taut_from_start(self) -> bool:
        """Whether the line carried tension as the phase began, or had less slack than counts: that pull is the first of
        the table of tugs and is counted by the FMU, and is no tug in what is told."""
        first = self.tugs.rows.get(1) if self.tugs is not None else None
        if first is not None and 0.0 <= first[0] * first[2] < NO_SLACK:
            return True
        return "tether.taut" in self.recorder and len(self.recorder) > 0 and bool(self.recorder["tether.taut"][0])


class Handover(Protocol):
    """What one phase took over from the one before it, and whether it holds that.

    time       of the hand-over, as the phase before counts it                                   [s]
    start      time that the FMU of the phase is told to begin at                                [s]
    phase      the phase that takes over, with the terms that what is handed over needs
    reach      how far the target reaches from its centre of mass, None where that is not known  [m]
    rows       of the ledger, once it is closed
    failure    why it failed, "" if it did not
    """

    time: float
    start: float
    phase: PhaseScene
    rows: list[LedgerRow]
    failure: str

    @property
    def reach(self) -> float | None: ...

    def parameters(self, component: Steppable) -> dict[str, float]:
        """What is set in the FMU of the phase, SI, beside what the scene says."""

    def close(self, component: Steppable) -> None:
        """Read back what the FMU holds and fill the ledger; `HandoffError` if it does not close."""

    def findings(self) -> Sequence[Finding]:
        """What the summary tells of it."""

    def told(self) -> dict[str, Any]:
        """What `ledger.json` holds of it."""

    def recall(self, told: Mapping[str, Any]) -> None:
        """Know again what was found as it was closed, from what `ledger.json` holds."""


@dataclass(frozen=True)
class Attained:
    """How exact a phase is, by runs of it in other ways.

    setting      with which it was computed
    error        estimated, of the quantity that errs most, and which that is              [1]
    scatter      standard deviation of one run, of the quantity that scatters most         [1]
    runs         that its figures are the means of; 1: it is a single run
    means        of each quantity that is one number: mean, standard deviation, unit; of several runs alone
    made         runs that the estimate took
    """

    asked: float
    setting: str
    error: float
    quantity: str
    scatter: float
    scattering: str
    runs: int = 1
    means: Mapping[str, tuple[str, float, float, str]] = field(default_factory=dict)
    made: int = 0


@dataclass
class RunResult:
    """All that a run leaves behind.

    parameters   every parameter of each phase as it stood when the phase began, SI
    inputs       every input likewise
    given        what the master set before that: what the scene says and what was handed over
    left         what the phase after asked for of each phase that hands over, as it ended, SI
    handovers    by the phase that took over
    comparisons  by phase, the same once more, had the shot given no momentum
    attained     by phase, where the scene asks for an accuracy
    states       that were kept on the way
    gone_on      of a run that went on from another: from where, and what was changed there
    """

    scene: Scene
    phases: dict[str, PhaseResult] = field(default_factory=dict)
    parameters: dict[str, dict[str, float]] = field(default_factory=dict)
    inputs: dict[str, dict[str, float]] = field(default_factory=dict)
    given: dict[str, dict[str, float]] = field(default_factory=dict)
    left: dict[str, dict[str, float]] = field(default_factory=dict)
    handovers: dict[str, Handover] = field(default_factory=dict)
    comparisons: dict[str, PhaseResult] = field(default_factory=dict)
    attained: Mapping[str, Attained] = field(default_factory=dict)
    status: str = "completed"
    message: str = ""
    exit_code: int = SUCCESS
    states: list[KeptState] = field(default_factory=list)
    gone_on: Mapping[str, Any] = field(default_factory=dict)

    def fail(self, status: str, message: str, exit_code: int) -> None:
        self.status, self.message, self.exit_code = status, message, exit_code

    def stop(self, error: DconeError) -> None:
        """Note what ended a phase early: an interrupt, or a failure of its FMU."""
        status = "interrupted" if isinstance(error, Interrupted) else "FMU failed"
        self.fail(status, str(error), error.exit_code)


@dataclass(frozen=True)
class Begun:
    """What a run goes on from.

    before    an earlier run
    over      phases of it that are over and stay as they are
    state     in which the phase after these was left, None where that begins anew
    changed   variables of its main FMU that have other values from there on, SI
    ledger    of what that phase took over when it began, as `Handover.told` has it; only with a state
    told      of it, for the provenance
    """

    before: RunResult
    over: Sequence[str]
    state: KeptState | None = None
    changed: Mapping[str, float] = field(default_factory=dict)
    ledger: Mapping[str, Any] = field(default_factory=dict)
    told: Mapping[str, Any] = field(default_factory=dict)

    def run_of(self, scene: Scene) -> RunResult:
        """The run that goes on, with the phases that are over; failed as the earlier one where the last did not hand
        over."""
        before, run = self.before, RunResult(scene, gone_on=self.told)
        for of in ("phases", "parameters", "inputs", "given", "left", "handovers", "comparisons", "attained"):
            setattr(run, of, {name: value for name, value in getattr(before, of).items() if name in self.over})
        for record in run.handovers.values():
            run.scene = run.scene.with_phase(record.phase)
        if self.over and self.over[-1] not in run.left:
            run.fail(before.status, before.message, before.exit_code)
        return run
