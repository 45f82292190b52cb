"""One run of `mission` for all tests that want to see both of its phases."""

from __future__ import annotations

import pytest

from dcone_cosim.loading import load
from dcone_cosim.master import run_scene
from dcone_cosim.progress import Progress
from dcone_cosim.results import RunResult
from dcone_cosim.scene_fmus import SceneFmus
from tests.cases.conftest import template

__all__ = ["template"]
MISSION = ("removal.duration=20 min",)


@pytest.fixture(scope="session")
def mission() -> RunResult:
    scene = load("mission", MISSION)
    with SceneFmus(scene, Progress()) as fmus:
        return run_scene(scene, fmus.instantiate, Progress())
