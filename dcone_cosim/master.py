"""The master: runs the phases of a scene one after the other, and hands over between them.

    build (elsewhere) -> capture FMU -> hand-off as a transaction -> removal FMU

It knows the FMUs by the names of `contract` and `handoff` alone. Failures on the way do not throw away what was
reached: they end up in the `RunResult`, whose `exit_code` says what happened.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from dcone_cosim.contract import ENDED, FAILED_OUTCOMES, FLOWN, HANDED_OVER, LINE, NEVER, OUTCOMES
from dcone_cosim.errors import (
    CAPTURE_FAILED,
    FMU_FAILED,
    HANDOFF_FAILED,
    SUCCESS,
    DconeError,
    FmuError,
    HandoffError,
    InputError,
    Interrupted,
)
from dcone_cosim.fmu.component import CallError, Steppable
from dcone_cosim.handoff import (
    CAPTURE_OUTPUTS,
    CAPTURE_PARAMETERS,
    SpinCheck,
    mean_motion,
    prepare,
    without_recoil,
)
from dcone_cosim.line import REST_LENGTH, line_of, line_parameters
from dcone_cosim.phases import CaptureLoop, CapturePlan, PhaseResult, RemovalLoop, standing
from dcone_cosim.progress import Progress
from dcone_cosim.scenes.mistakes import places_named
from dcone_cosim.scenes.scene import PHASES, PhaseScene, Scene
from dcone_cosim.transaction import HandoffRecord, check_before, close_ledger

Instantiate = Callable[[str, str], Steppable]
"""`instantiate(phase, name)` makes a component of that phase's FMU."""


@dataclass
class RunResult:
    """All that a run leaves behind.

    parameters   every parameter of each phase as it stood when the phase began, SI
    inputs       every input likewise
    given        what the master set before that: what the scene says and what was handed over
    """

    scene: Scene
    phases: dict[str, PhaseResult] = field(default_factory=dict)
    parameters: dict[str, dict[str, float]] = field(default_factory=dict)
    inputs: dict[str, dict[str, float]] = field(default_factory=dict)
    given: dict[str, dict[str, float]] = field(default_factory=dict)
    handoff: HandoffRecord | None = None
    comparison: PhaseResult | None = None
    status: str = "completed"
    message: str = ""
    exit_code: int = SUCCESS

    def fail(self, status: str, message: str, exit_code: int) -> None:
        self.status, self.message, self.exit_code = status, message, exit_code

    def stop(self, error: DconeError) -> None:
        """Note what ended a phase early: an interrupt, or a failure of its FMU."""
        status = "interrupted" if isinstance(error, Interrupted) else "FMU failed"
        self.fail(status, str(error), error.exit_code)

    def begin(self, phase: PhaseScene, component: Steppable, values: Mapping[str, float], start: float) -> None:
        """Set the values, initialise the phase's component at `start` [s], and keep what then stands."""
        self.given[phase.name] = dict(values)
        _start(component, values, start, phase.duration)
        self.parameters[phase.name] = standing(component, "parameter")
        self.inputs[phase.name] = standing(component, "input")


def run_scene(scene: Scene, instantiate: Instantiate, progress: Progress) -> RunResult:
    """Run every phase of the scene; a fault of an FMU before its first step is an `InputError`, since it is the
    parameters that it refuses."""
    run = RunResult(scene)
    phases = {phase.name: phase for phase in scene.phases}
    if "capture" in phases:
        _run_capture(run, phases["capture"], instantiate, progress, then_removal="removal" in phases)
        if run.exit_code != SUCCESS:
            return run
    if "removal" in phases:
        _run_removal(run, phases["removal"], instantiate, progress)
    for name in phases.keys() - PHASES:
        _run_plain(run, phases[name], instantiate, progress)
    return run


def _start(component: Steppable, values: Mapping[str, float], start: float, duration: float) -> None:
    """Set parameters and inputs, and initialise."""
    component.set(values)
    component.enter_initialisation(start, start + duration)
    component.exit_initialisation()


def cannot_begin(scene: Scene, phase: str, error: FmuError) -> FmuError | InputError:
    """An FMU's refusal of its parameters, in the scene's terms: the file, the lines, the FMU's words. What broke
    instead of refusing stays what it is."""
    if isinstance(error, CallError) and error.broken:
        return error
    source = scene.source or scene.name
    if not isinstance(error, CallError):
        return InputError(f"{source}: the {phase} cannot begin\n  {error}")
    where = places_named(error.said, scene.places, phase)
    return InputError(f"{source}: the {phase} cannot begin\n  {where}{error.said}\n  ({error.detail})")


def _run_capture(
    run: RunResult, phase: PhaseScene, instantiate: Instantiate, progress: Progress, then_removal: bool
) -> None:
    component = instantiate("capture", "capture")
    try:
        try:
            run.begin(phase, component, phase.main.parameters, phase.start)
            plan = CapturePlan(
                phase.macro_step,
                phase.duration,
                str(phase.options.get("hand_over", "captured")),
                then_removal,
                float(phase.options.get("after_capture", np.inf)),
                phase.options.get("snapshots", ()),
                phase.start,
            )
            loop = CaptureLoop(component, plan, progress)
        except FmuError as error:
            raise cannot_begin(run.scene, "capture", error) from error
        progress.begin("capture", 0.0, phase.duration)
        result = loop.run()
        progress.end()
        run.phases["capture"] = result
        if result.error is not None:
            run.stop(result.error)
        elif plan.hand_over == NEVER:
            result.outcome = FLOWN if result.outcome == OUTCOMES[0] else result.outcome
        elif result.located is None:
            if result.outcome == ENDED:
                waited = _words(plan.hand_over)
                text = (
                    f"capture failed: its FMU ended at t = {result.ended_at:.6g} s, not {waited}\n  {result.ended_by}"
                )
            elif result.outcome in FAILED_OUTCOMES:
                text = f"capture failed: {_words(result.outcome)} at t = {result.end:.6g} s"
            else:
                waited, stands = _words(plan.hand_over), _words(result.outcome)
                text = f"capture failed: still {stands}, not {waited}, at the end of the phase, t = {result.end:.6g} s"
            run.fail("capture failed", text, CAPTURE_FAILED)
        elif then_removal:
            names = [n for n in (*CAPTURE_OUTPUTS, *CAPTURE_PARAMETERS) if n in component.variables]
            missing = [n for n in (*CAPTURE_OUTPUTS, *CAPTURE_PARAMETERS) if n not in component.variables]
            if missing:
                text = f"the capture FMU lacks what a hand-off reads: {', '.join(missing)}"
                run.fail("hand-off refused", text, HANDOFF_FAILED)
                return
            removal = next(p for p in run.scene.phases if p.name == "removal")
            length = LINE["capture"]
            try:
                values = component.get([*names, length] if length in component.variables else names)
            except FmuError as error:
                run.fail("FMU failed", str(error), FMU_FAILED)
                return
            handed = prepare(values, mean_motion(_altitude(removal)))
            line = line_of(handed, values.get(length, removal.setting(REST_LENGTH)))
            run.handoff = HandoffRecord(result.located, result.located_by, handed, line, SpinCheck(0.0, 0.0, 0.0))
    finally:
        component.close()


def _words(name: str) -> str:
    return name.replace("_", " ")


def _altitude(removal: PhaseScene) -> float:
    altitude = removal.setting("orbit.altitude")
    assert altitude is not None, "the contract asks for it"
    return altitude


def _run_removal(run: RunResult, phase: PhaseScene, instantiate: Instantiate, progress: Progress) -> None:
    parameters, start = dict(phase.main.parameters), phase.start
    record = run.handoff
    if record is not None:
        start = run.phases["capture"].origin + record.time
        parameters |= record.handed.parameters
        anomaly = parameters.get("orbit.true_anomaly", phase.main.defaults.get("orbit.true_anomaly", 0.0))
        parameters["orbit.true_anomaly"] = advanced(anomaly, record.handed.turning[2] * record.time)
        parameters["start.condition"] = phase.choice("start.condition", HANDED_OVER)
        try:
            check_before(record, phase, float(run.scene.handoff.get("spin_tolerance", 0.1)))
        except HandoffError as error:
            record.failure = str(error)
            run.fail("hand-off refused", str(error), HANDOFF_FAILED)
            return
    try:
        component = instantiate("removal", "removal")
    except FmuError as error:
        if record is None:
            raise
        run.fail("FMU failed", str(error), FMU_FAILED)
        return
    if record is not None:
        record.line_parameters = line_parameters(record.line, component.variables)
        parameters |= record.line_parameters
    try:
        try:
            run.begin(phase, component, parameters, start)
            loop = RemovalLoop(component, phase.macro_step, start, phase.duration, progress, origin=start)
        except FmuError as error:
            if record is None:
                raise cannot_begin(run.scene, "removal", error) from error
            if isinstance(error, CallError) and error.broken:
                run.fail("FMU failed", str(error), FMU_FAILED)
                return
            record.failure = str(error)
            run.fail("hand-off violated", f"the removal does not accept what is handed over\n  {error}", HANDOFF_FAILED)
            return
        if record is not None:
            try:
                close_ledger(record, component)
            except HandoffError as error:
                record.failure = str(error)
                run.fail("hand-off violated", str(error), HANDOFF_FAILED)
                return
            except FmuError as error:
                run.fail("FMU failed", str(error), FMU_FAILED)
                return
        progress.begin("removal", 0.0, phase.duration)
        result = loop.run()
        progress.end()
    finally:
        component.close()
    run.phases["removal"] = result
    if result.error is not None:
        run.stop(result.error)
    elif record is not None and run.scene.handoff.get("compare_without_recoil", True):
        run.comparison = _compare(run, phase, parameters, start, instantiate, progress)


def _run_plain(run: RunResult, phase: PhaseScene, instantiate: Instantiate, progress: Progress) -> None:
    """A phase that is neither capture nor removal: stepped from its start to its stop, its outputs recorded."""
    component = instantiate(phase.name, phase.name)
    try:
        try:
            run.begin(phase, component, phase.main.parameters, phase.start)
            loop = RemovalLoop(component, phase.macro_step, phase.start, phase.duration, progress)
        except FmuError as error:
            raise cannot_begin(run.scene, phase.name, error) from error
        progress.begin(phase.name, phase.start, phase.start + phase.duration)
        result = loop.run()
        progress.end()
    finally:
        component.close()
    run.phases[phase.name] = result
    if result.error is not None:
        run.stop(result.error)


def advanced(anomaly: float, by: float) -> float:
    """True anomaly on a circular orbit moved on [rad], kept within one turn, as the removal's bounds ask."""
    return float(np.remainder(anomaly + by, 2.0 * np.pi))


def _compare(
    run: RunResult,
    phase: PhaseScene,
    parameters: dict[str, Any],
    start: float,
    instantiate: Instantiate,
    progress: Progress,
) -> PhaseResult | None:
    """The same removal with the shot's momentum left out: what the recoil changes."""
    record = run.handoff
    assert record is not None
    capture = run.parameters["capture"]
    velocity = np.array([capture[f"chaser.start_velocity[{i}]"] for i in (1, 2, 3)])
    try:
        component = instantiate("removal", "removal without recoil")
        try:
            _start(component, parameters | without_recoil(record.handed, velocity), start, phase.duration)
            loop = RemovalLoop(component, phase.macro_step, start, phase.duration, progress, origin=start)
            progress.begin("removal without recoil", 0.0, phase.duration)
            result = loop.run()
            progress.end()
        finally:
            component.close()
        reason: DconeError | None = result.error
    except FmuError as error:
        reason = error
    if reason is None:
        return result
    if isinstance(reason, Interrupted):
        run.stop(reason)
    progress.say(f"the removal without recoil is left out: {reason}")
    return None
