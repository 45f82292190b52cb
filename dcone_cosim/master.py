"""The master: runs the phases of a scene one after the other, and hands over between them.

    build (elsewhere) -> FMU of a phase -> hand-off as a transaction -> FMU of the next

What a phase is about, its kind says (see `phases`); here is what is the same for all. Failures on the way do not throw
away what was reached: they end up in the `RunResult`, whose `exit_code` says what happened.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

from dcone_cosim.errors import FMU_FAILED, HANDOFF_FAILED, SUCCESS, FmuError, HandoffError, InputError
from dcone_cosim.fmu.component import NUMBERS, CallError, Steppable
from dcone_cosim.phases import kind_of
from dcone_cosim.phases.phase import Adopt, Instantiate, Loop, Stage, failed
from dcone_cosim.progress import Progress
from dcone_cosim.results import Begun, Handover, PhaseResult, RunResult
from dcone_cosim.scene.data import PhaseScene, Scene
from dcone_cosim.scene.mistakes import places_named
from dcone_cosim.states import Keeper


def adopt_nothing(phase: PhaseScene) -> None:
    """For FMUs that are the same whatever is handed over."""


def run_scene(
    scene: Scene,
    instantiate: Instantiate,
    progress: Progress,
    adopt: Adopt = adopt_nothing,
    begun: Begun | None = None,
    keep: Mapping[str, Sequence[float]] = MappingProxyType({}),
    until: str = "",
    tables: bool = True,
) -> RunResult:
    """Run every phase of the scene; a fault of an FMU before its first step is an `InputError`, since it is the
    parameters that it refuses, unless a phase before has handed them over.

    begun    what the run goes on from, None for one from its beginning
    keep     instants at which the state of a phase is kept, by the phase's own time [s]
    until    name of the phase that is not run any more; "" to run all
    tables   whether the rows of its phases are kept; without that it may have fewer, of which the summary is the same
    """
    run, phases = RunResult(scene) if begun is None else begun.run_of(scene), scene.phases
    before: PhaseScene | None = None
    for place, phase in enumerate(phases):
        if run.exit_code != SUCCESS or phase.name == until:
            break
        if phase.name in run.phases:
            before = phase
            continue
        if before is not None and kind_of(phase.name).retries != failed(run.phases[before.name]):
            continue
        later = phases[place + 1 :]
        after = later[0] if later else None
        keeper = Keeper(phase.name, keep[phase.name]) if phase.name in keep else None
        here = begun if begun is not None and begun.state is not None and begun.state.phase == phase.name else None
        _run(Stage(run, phase, before, after, instantiate, progress, keeper, here, later, tables), adopt)
        before = phase
        if keeper is not None:
            run.states += keeper.kept
    return run


def _run(stage: Stage, adopt: Adopt) -> None:
    """One phase from the hand-over before it to the one after it."""
    run, name, kind = stage.run, stage.phase.name, kind_of(stage.phase.name)
    try:
        handover = kind.take_over(stage)
    except HandoffError as error:
        run.handovers[name].failure = str(error)
        run.fail("hand-off refused", str(error), HANDOFF_FAILED)
        return
    try:
        if handover is not None and handover.phase is not stage.phase:
            stage = replace(stage, phase=handover.phase)
            run.scene = run.scene.with_phase(stage.phase)
            adopt(stage.phase)
        component = stage.instantiate(name, name)
    except FmuError as error:
        if handover is None:
            raise
        run.fail("FMU failed", str(error), FMU_FAILED)
        return
    try:
        loop = _begun(stage, component, handover)
        if loop is None:
            return
        begin = loop.result.start
        stage.progress.begin(name, begin, begin + stage.phase.duration)
        result = run.phases[name] = loop.run()
        stage.progress.end()
        if result.error is not None:
            run.stop(result.error)
        else:
            kind.judge(stage, result)
        following = stage.next_of(result)
        if run.exit_code == SUCCESS and following is not None:
            _leave(stage, component, following, result)
    finally:
        component.close()
    if run.exit_code == SUCCESS:
        kind.afterwards(stage, result)


def _begun(stage: Stage, component: Steppable, handover: Handover | None) -> Loop | None:
    """The phase's component with its values, initialised, and what steps it; None when the run has failed in this."""
    run, phase = stage.run, stage.phase
    values, start = dict(phase.main.parameters), phase.start
    if handover is not None:
        values |= handover.parameters(component)
        start = handover.start
    if stage.begun is not None:
        return _gone_on(stage, stage.begun, component, handover, start)
    try:
        _initialise(stage, component, values, start)
        loop = kind_of(phase.name).loop(stage, component, start)
        loop.keeper = stage.keeper
    except FmuError as error:
        if handover is None:
            raise cannot_begin(run.scene, phase.name, error) from error
        if isinstance(error, CallError) and error.broken:
            run.fail("FMU failed", str(error), FMU_FAILED)
        else:
            handover.failure = str(error)
            text = f"the {phase.name} does not accept what is handed over\n  {error}"
            run.fail("hand-off violated", text, HANDOFF_FAILED)
        return None
    try:
        if handover is not None:
            handover.close(component)
    except HandoffError as error:
        assert handover is not None
        handover.failure = str(error)
        run.fail("hand-off violated", str(error), HANDOFF_FAILED)
        return None
    except FmuError as error:
        run.fail("FMU failed", str(error), FMU_FAILED)
        return None
    return loop


def _gone_on(stage: Stage, begun: Begun, component: Steppable, handover: Handover | None, start: float) -> Loop:
    """The component in a state that an earlier run kept, and what steps it on; `InputError` where it does not take
    that."""
    run, name, before = stage.run, stage.phase.name, begun.before
    assert begun.state is not None
    for of in (before.given, before.parameters, before.inputs):
        if name not in of:
            raise InputError(f"the kept state of the {name} cannot be gone on from: that run does not tell its values")
    run.given[name], run.parameters[name], run.inputs[name] = (
        dict(of[name]) for of in (before.given, before.parameters, before.inputs)
    )
    if handover is not None:
        handover.recall(begun.ledger)
    try:
        component.set(run.given[name])
        component.enter_initialisation(start, None)
        component.exit_initialisation()
        loop = kind_of(name).loop(stage, component, start)
        loop.keeper = stage.keeper
        loop.take_up(begun.state, before.phases[name], begun.changed)
    except FmuError as error:
        raise InputError(f"the kept state of the {name} cannot be gone on from\n  {error}") from error
    return loop


def _initialise(stage: Stage, component: Steppable, values: Mapping[str, float], start: float) -> None:
    """Set the values, begin at `start` [s], and keep what then stands."""
    run, name = stage.run, stage.phase.name
    run.given[name] = dict(values)
    component.set(values)
    # a state that is kept may be gone on from for longer: no end is told where one is to be kept
    stop = None if stage.keeper is not None else start + stage.phase.duration
    component.enter_initialisation(start, stop)
    component.exit_initialisation()
    run.parameters[name] = standing(component, "parameter")
    run.inputs[name] = standing(component, "input")


def _leave(stage: Stage, component: Steppable, following: PhaseScene, result: PhaseResult) -> None:
    """Read what the next phase takes over, while there is somebody to ask."""
    run, phase = stage.run, stage.phase
    next_kind = kind_of(following.name)
    missing = [name for name in next_kind.takes if name not in component.variables]
    if missing:
        text = f"the {phase.name} FMU lacks what a hand-off reads: {', '.join(missing)}"
        run.fail("hand-off refused", text, HANDOFF_FAILED)
        return
    there = [name for name in next_kind.takes_too if name in component.variables]
    try:
        left = component.get([*next_kind.takes, *there])
        run.left[phase.name] = kind_of(phase.name).leaves(run, phase, left)
        run.left[phase.name] |= next_kind.probe(stage, component, result)
    except HandoffError as error:
        run.fail("hand-off refused", str(error), HANDOFF_FAILED)
    except FmuError as error:
        run.fail("FMU failed", str(error), FMU_FAILED)


def standing(component: Steppable, causality: str) -> dict[str, float]:
    """Every parameter, or every input, of the component as it now stands, whether it was given or left at its start."""
    names = [v.name for v in component.variables.values() if v.causality == causality and v.kind in NUMBERS]
    present = component.get(names) if names else {}
    return {name: present[name] for name in names}


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
