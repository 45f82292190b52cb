"""The same scene through the FMU, through its bare kernel, and through fmpy's own loop: the same bits."""

from __future__ import annotations

from dataclasses import replace

import fmpy
import numpy as np
import pytest

from dcone_cosim import build
from dcone_cosim.fmu.component import Steppable
from dcone_cosim.loading import load
from dcone_cosim.master import run_scene
from dcone_cosim.progress import Progress
from dcone_cosim.results import PhaseResult
from dcone_cosim.scene.data import Scene
from dcone_cosim.scene_fmus import SceneFmus
from fmu_src import instance
from tests.cosim.in_process import KernelComponent

pytestmark = pytest.mark.slow


def short(name: str, duration: float) -> Scene:
    """The first phase of a scene, cut short."""
    scene = load(name)
    return replace(scene, phases=(replace(scene.phases[0], duration=duration),))


@pytest.fixture(params=[("table2-deorbit", 7200.0), ("mission", 4.0)], ids=["removal", "capture"])
def run_by_fmu(request: pytest.FixtureRequest) -> tuple[Scene, PhaseResult]:
    scene = short(*request.param)
    with SceneFmus(scene, Progress()) as archives:
        return scene, run_scene(scene, archives.instantiate, Progress()).phases[scene.phases[0].name]


def test_kernel_and_fmu_give_the_same_bits(run_by_fmu: tuple[Scene, PhaseResult]) -> None:
    scene, by_fmu = run_by_fmu
    (phase,) = scene.phases

    def instantiate(_: str, name: str) -> Steppable:
        return KernelComponent(phase.name, name, phase.main.terms)

    by_kernel = run_scene(scene, instantiate, Progress()).phases[phase.name]
    assert len(by_fmu.recorder) > 100
    for name in by_fmu.recorder.names:
        np.testing.assert_array_equal(by_fmu.recorder[name], by_kernel.recorder[name], err_msg=name)
    for ours, theirs in zip(by_fmu.snapshots.nodes, by_kernel.snapshots.nodes, strict=True):
        np.testing.assert_array_equal(ours, theirs)


@pytest.mark.evidence
def test_a_kernel_compiled_in_this_process_gives_the_same_bits(
    run_by_fmu: tuple[Scene, PhaseResult], monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is left in the suite: tests/packaging/test_fmu.py, formulas that no compiler has seen."""
    monkeypatch.setattr(instance, "entry_of", instance.compiled)
    test_kernel_and_fmu_give_the_same_bits(run_by_fmu)


def test_fmpy_gives_the_masters_numbers(run_by_fmu: tuple[Scene, PhaseResult]) -> None:
    scene, ours = run_by_fmu
    (phase,) = scene.phases
    path = build.ensure([(phase.main.model, phase.main.terms)], lambda _: None)[0]
    names = [name for name in ours.recorder.names[1:] if ours.recorder.kinds[name] == "Real"]
    whole = {"Real": float, "Integer": int, "Boolean": bool}
    kinds = {v.name: v.type for v in fmpy.read_model_description(str(path)).modelVariables}
    theirs = fmpy.simulate_fmu(
        str(path),
        stop_time=phase.duration,
        output_interval=phase.macro_step,
        start_values={name: whole[kinds[name]](value) for name, value in phase.main.parameters.items()},
        output=names,
    )
    assert len(theirs) == len(ours.recorder)
    for name in names:
        np.testing.assert_allclose(theirs[name], ours.recorder[name], rtol=1e-9, atol=1e-12, err_msg=name)
