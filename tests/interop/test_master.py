"""A run by the whole master, and the same by fmpy alone: every column of the recorder has the same bits."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from dcone_cosim.fmu.component import Archive, Component
from dcone_cosim.loading import load
from dcone_cosim.master import run_scene
from dcone_cosim.phases.capture import CaptureOptions
from dcone_cosim.progress import Progress
from dcone_cosim.recorder import Recorder
from dcone_cosim.scene.data import Scene
from tests.interop.cases import CAPTURE, CASES, Case
from tests.interop.children import run_tool
from tests.interop.job import Job, Value

pytestmark = [pytest.mark.interop, pytest.mark.slow]


def plain(case: Case) -> tuple[Scene, Job]:
    """The run of a case without its command, which a scene can not give, as a scene of one phase and as a job."""
    job = case.job("decimal")
    changes: Mapping[str, Value] = {**case.changes, **({"closing.trigger": 0} if case is CAPTURE else {})}
    scene = load(case.scene)
    phase = next(p for p in scene.phases if p.name == case.phase)
    parameters = {**phase.main.parameters, **{name: float(value) for name, value in changes.items()}}
    phase = replace(
        phase,
        main=replace(phase.main, parameters=parameters),
        macro_step=job.step,
        duration=job.steps * job.step,
        options=CaptureOptions("none") if phase.name == "capture" else phase.options,
    )
    every = list(range(1, job.steps + 1))
    return replace(scene, phases=(phase,)), replace(
        job, commands=[], looks=every, parameters={**job.parameters, **changes}
    )


def recorded(case: Case, scene: Scene) -> Recorder:
    with Archive(Path(case.path)) as archive:
        result = run_scene(scene, lambda _, name: Component(archive, name), Progress())
    assert result.exit_code == 0, result.message
    return result.phases[case.phase].recorder


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_the_masters_columns_are_fmpys(case: Case) -> None:
    scene, job = plain(case)
    recorder = recorded(case, scene)
    found = run_tool("fmpy_tool", [job, replace(job, step=job.step * (1 + 1e-6))])
    names = recorder.names[1:]
    assert {recorder.kinds[name] for name in names} == {"Real", "Integer", "Boolean"}
    assert len(recorder) == job.steps + 1
    theirs, other = (np.array([[float(row[name]) for name in names] for row in rows]) for rows in found.rows)
    ours = np.array([recorder[name][1:] for name in names]).T
    np.testing.assert_array_equal(ours.view(np.int64), theirs.view(np.int64))
    assert np.any(ours != other)
