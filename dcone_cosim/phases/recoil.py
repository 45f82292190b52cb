"""The same tow with the shot's momentum left out of what is handed over: what the recoil changes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dcone_cosim.errors import DconeError, FmuError, Interrupted
from dcone_cosim.handoff import without_recoil
from dcone_cosim.phases.hastened import COARSE
from dcone_cosim.phases.phase import Phase, Stage
from dcone_cosim.transaction import HandoffRecord


def compare(tow: Phase, stage: Stage, record: HandoffRecord) -> None:
    """Run it beside the tow, and keep it in `run.comparisons`; where it comes to no end, that is said."""
    run, phase = stage.run, stage.phase
    if stage.begun is not None and run.gone_on.get("changed"):
        stage.progress.say("the comparison without recoil is left out: values were changed where the tow went on")
        return
    assert stage.before is not None, "somebody handed over"
    capture = run.parameters[stage.before.name]
    velocity = np.array([capture[f"chaser.start_velocity[{i}]"] for i in (1, 2, 3)])
    name = f"{tow.name} without recoil"
    if phase.main.fmu is None and not phase.others:
        # of ours the tugs have the same bits whatever the macro step, and a step with too many of them is halved
        stage = replace(stage, phase=replace(phase, macro_step=COARSE * phase.macro_step), tables=True)
    try:
        component = stage.instantiate(tow.name, name)
        try:
            component.set(run.given[tow.name] | without_recoil(record.handed, velocity))
            component.enter_initialisation(record.start, record.start + phase.duration)
            component.exit_initialisation()
            loop = tow.loop(stage, component, record.start)
            stage.progress.begin(name, 0.0, phase.duration)
            beside = loop.run()
            stage.progress.end()
        finally:
            component.close()
        reason: DconeError | None = beside.error
    except FmuError as error:
        reason = error
    if reason is None:
        run.comparisons[tow.name] = beside
        return
    if isinstance(reason, Interrupted):
        run.stop(reason)
    stage.progress.say(f"the {name} is left out: {reason}")
