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
    REMOVAL_SETS,
    Handoff,
    SpinCheck,
    check_spin,
    held_bodies,
    mean_motion,
    prepare,
    without_recoil,
)
from dcone_cosim.ledger import LedgerRow, ledger
from dcone_cosim.line import ATTACHMENT, LINE_HELD, REST_LENGTH, Line, line_of, line_parameters, line_rows
from dcone_cosim.phases import CaptureLoop, CapturePlan, PhaseResult, RemovalLoop, standing
from dcone_cosim.progress import Progress
from dcone_cosim.scenes.mistakes import places_named
from dcone_cosim.scenes.scene import PHASES, PhaseScene, Scene

Instantiate = Callable[[str, str], Steppable]
"""`instantiate(phase, name)` makes a component of that phase's FMU."""

CROSS_CHECK = 1e-4
"""Relative agreement asked of what the removal computes with what was handed over. It forms its outputs in the frame of
the pair's centre of mass, turned and turning a little differently: by the offset over the radius, 3e-6 for 20 m."""


@dataclass(frozen=True)
class Check:
    """A size the removal computes from what it was handed, against the same size before."""

    quantity: str
    given: float
    found: float
    tolerance: float
    unit: str


@dataclass
class HandoffRecord:
    """The transaction as it went: what was mapped, its ledger, the spin check, and why it failed if it did.

    time              of the hand-over, since the shot [s]
    line_parameters   what is set in the removal so that its line is the capture's
    """

    time: float
    located_by: str
    handed: Handoff
    line: Line
    spin: SpinCheck
    line_parameters: dict[str, float] = field(default_factory=dict)
    rows: list[LedgerRow] = field(default_factory=list)
    checks: list[Check] = field(default_factory=list)
    failure: str = ""


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
            line = line_of(handed, values.get(length, _setting(removal, REST_LENGTH)))
            run.handoff = HandoffRecord(result.located, result.located_by, handed, line, SpinCheck(0.0, 0.0, 0.0))
    finally:
        component.close()


def _words(name: str) -> str:
    return name.replace("_", " ")


def _setting(phase: PhaseScene, name: str) -> float | None:
    """What a parameter of the phase is in the scene, or by default; None when its FMU has none of that name."""
    return phase.main.parameters.get(name, phase.main.defaults.get(name))


def _altitude(removal: PhaseScene) -> float:
    altitude = _setting(removal, "orbit.altitude")
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
            _check_before(run, phase, record)
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
                _close_ledger(record, component)
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


def _check_before(run: RunResult, phase: PhaseScene, record: HandoffRecord) -> None:
    """Refuse a hand-off that the removal could not carry truthfully."""
    capture = run.parameters["capture"]
    size = np.array([capture[f"target.size[{i}]"] for i in (1, 2, 3)])
    tolerance = float(run.scene.handoff.get("spin_tolerance", 0.1))
    handed, line = record.handed, record.line
    elastic, commanded = _setting(phase, REST_LENGTH), _setting(phase, "reel.length")
    length = commanded if elastic is None else elastic
    slack = 0.0 if length is None else length + line.attachment - line.distance
    spin = check_spin(handed, size, slack, _setting(phase, "thrust.level") or 0.0, tolerance)
    record.spin = spin
    if elastic is not None and line.overrun:
        raise HandoffError(
            f"hand-off refused: at t = {record.time:.6g} s the chaser and the net's vertex are {line.reach:.6g} m "
            f"apart, the tether is {line.length:.6g} m long; give it more, or shoot from nearer"
        )
    if not spin.accepted:
        raise HandoffError(
            "hand-off refused: the removal's point target cannot carry the spin, and the spin would change the answer\n"
            f"  spin of target and net {float(np.linalg.norm(handed.joint.spin)):.4g} N m s "
            f"moves the tether's end at up to {spin.attachment_speed:.4g} m/s,\n"
            f"  {spin.share:.3g} times the {spin.tug_speed:.4g} m/s of the first tug; "
            f"handoff.spin_tolerance allows {spin.tolerance:g}\n"
            "  a removal whose target is a rigid body would carry it"
        )


def _close_ledger(record: HandoffRecord, component: Steppable) -> None:
    """Read back what the removal holds, fill the ledger, and compare what it computed from it."""
    missing = [name for name in REMOVAL_SETS if name not in component.variables]
    if missing:
        raise HandoffError(f"hand-off violated: the removal FMU lacks {', '.join(missing)}")
    held = component.get([*REMOVAL_SETS, *(name for name in LINE_HELD if name in component.variables)])
    chaser, target = held_bodies(held)
    apart = float(np.linalg.norm(target.position - chaser.position))
    record.rows = ledger(record.handed, held) + line_rows(record.line, record.line_parameters, held, apart)
    record.checks = _cross_check(record, component)
    broken = [
        f"{row.quantity}: before {row.before:.17g} {row.unit}, after {row.after:.17g} {row.unit}, "
        f"difference {row.difference:.3g} {row.unit} is {row.closure:.3g} of the sum of magnitudes"
        for row in record.rows
        if not row.closed
    ]
    broken += [
        f"{c.quantity}: handed over {c.given:.12g} {c.unit}, the removal computes {c.found:.12g} {c.unit}"
        for c in record.checks
        if not abs(c.found - c.given) <= c.tolerance
    ]
    if broken:
        raise HandoffError("hand-off violated: the ledger does not close\n  " + "\n  ".join(broken))


def _cross_check(record: HandoffRecord, component: Steppable) -> list[Check]:
    """Sizes that do not depend on the frame they are formed in, as far as the component gives the outputs for them."""
    handed, attachment = record.handed, record.line_parameters.get(ATTACHMENT)
    joint, chaser = handed.joint, handed.chaser
    relative, rate = joint.position - chaser.position, joint.velocity - chaser.velocity
    distance, speed = float(np.linalg.norm(relative)), float(np.linalg.norm(rate))
    turned = CROSS_CHECK * (speed + float(np.linalg.norm(handed.turning)) * distance)
    expected = [
        ("separation", ("separation",), distance, CROSS_CHECK * distance, "m"),
        ("size of relative.position", _elements("relative.position"), distance, CROSS_CHECK * distance, "m"),
        ("size of relative.velocity", _elements("relative.velocity"), speed, turned, "m/s"),
    ]
    if attachment is not None:
        length = abs(distance - attachment)
        expected.append(("size of tether.length", ("tether.length",), length, CROSS_CHECK * distance, "m"))
    checks = []
    for label, names, given, tolerance, unit in expected:
        if all(name in component.variables for name in names):
            found = component.get(names)
            checks.append(Check(label, given, float(np.linalg.norm([found[n] for n in names])), tolerance, unit))
    return checks


def _elements(name: str) -> tuple[str, ...]:
    return tuple(f"{name}[{i}]" for i in (1, 2, 3))


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
