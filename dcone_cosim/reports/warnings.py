"""What a user may not expect of a run: what the scene tells beforehand, and what only the run shows.

They change neither the run nor its exit code.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial
from typing import NamedTuple

import numpy as np

from dcone_cosim import build
from dcone_cosim.master import RunResult
from dcone_cosim.phases import PhaseResult
from dcone_cosim.recorder import Recorder

UNKNOWN_EXTENT = 1.0
"""How far a body of which nothing is known is taken to reach from its centre of mass [m]."""


def warnings(run: RunResult) -> list[str]:
    """All of a run, each once."""
    found = list(run.scene.cautions)
    phases = {phase.name: phase.main for phase in run.scene.phases}
    for name, result in run.phases.items():
        if name in build.CAUTIONS and len(result.recorder):
            main, recorder = phases[name], result.recorder
            values = {**run.parameters.get(name, {}), **run.inputs.get(name, {})}
            terms = main.terms if main.fmu is None else {}
            found += build.cautions_after(name, values, main.parameters, terms, partial(_range, recorder))
    if "removal" in run.phases:
        found += _of_meeting(run, run.phases["removal"])
    return list(dict.fromkeys(found))


def _range(recorder: Recorder, output: str) -> build.Range | None:
    if output not in recorder:
        return None
    column = recorder[output]
    return build.Range(float(np.min(column)), float(np.max(column)), float(column[0]), float(column[-1]))


class Approach(NamedTuple):
    """Least distance of the two centres of mass [m], when since the phase began [s], and whether from rows alone."""

    distance: float
    time: float
    recorded: bool


def approach(result: PhaseResult) -> Approach | None:
    """How near the two bodies came, by the FMU's own watch or, without that, by the rows there are."""
    recorder = result.recorder
    if not len(recorder):
        return None
    if {"approach.distance", "approach.time"} <= set(recorder.names):
        last = recorder.last()
        return Approach(last["approach.distance"], last["approach.time"], False)
    if "separation" not in recorder:
        return None
    row = int(np.argmin(recorder["separation"]))
    time = recorder["time"]
    return Approach(float(recorder["separation"][row]), float(time[row] - time[0]), True)


def _reach(run: RunResult) -> float | None:
    """How far the target reaches from its centre [m], as handed over or by its shape; None where neither is known."""
    if run.handoff is not None:
        return run.handoff.handed.reach
    terms = next((phase.main.terms for phase in run.scene.phases if phase.name == "capture"), {})
    surface = build.target_surface(run.parameters.get("capture", {}), terms)
    return None if surface is None else max(math.hypot(*corner) for corner in surface[0])


def _of_meeting(run: RunResult, result: PhaseResult) -> Iterator[str]:
    """Whether the bodies would meet, by what is known of how far they reach from their centres of mass.

    A target reaches as far as its farthest corner at most, so a pass that is told may still be a miss; none that is not
    told is a hit, as far as the chaser reaches no farther than is assumed.
    """
    nearest = approach(result)
    if nearest is None:
        return
    reach = _reach(run)
    if reach is None:
        reach, assumed = (
            UNKNOWN_EXTENT,
            f"each is taken to reach {UNKNOWN_EXTENT:g} m from its centre, as no size is known",
        )
    else:
        assumed = (
            f"the target reaches {reach:.3g} m from its centre, "
            f"and the chaser is taken to reach {UNKNOWN_EXTENT:g} m from its own"
        )
    if nearest.distance < reach + UNKNOWN_EXTENT:
        recorded = ", by the rows recorded" if nearest.recorded else ""
        yield (
            f"removal: the bodies may meet: their centres came within {nearest.distance:.3g} m, {nearest.time:.6g} s "
            f"after the removal began{recorded}; {assumed}, and no contact is computed"
        )
