"""What a user may not expect of a run: what the scene tells beforehand, and what only the run shows.

They change neither the run nor its exit code.
"""

from __future__ import annotations

from collections.abc import Container
from functools import partial

import numpy as np

from dcone_cosim import build, loads, pulled
from dcone_cosim.phases import kind_of
from dcone_cosim.recorder import Recorder
from dcone_cosim.results import RunResult


def warnings(run: RunResult) -> list[str]:
    """All of a run, each once."""
    found = [*loads.headlines(run), *run.scene.cautions]
    phases = {phase.name: phase.main for phase in run.scene.phases}
    for name, result in run.phases.items():
        if len(result.recorder):
            main, recorder = phases[name], result.recorder
            values = {**run.parameters.get(name, {}), **run.inputs.get(name, {})}
            terms = main.terms if main.fmu is None else {}
            found += build.cautions_after(
                name,
                kind_of(name).model,
                values,
                main.parameters,
                terms,
                partial(_range, recorder, run.left.get(name, ())),
            )
        found += kind_of(name).warnings(run, result)
        found += loads.warnings(run, name)
    return list(dict.fromkeys(found))


def _range(recorder: Recorder, left: Container[str], output: str) -> build.Range | None:
    """None of what is not seen, nor of a test that came after the phase."""
    if output not in recorder or (output == pulled.STANDS and pulled.LEFT[0] in left):
        return None
    column = recorder[output]
    return build.Range(float(np.min(column)), float(np.max(column)), float(column[0]), float(column[-1]))
