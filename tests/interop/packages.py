"""Packages of scenes run by other tools, each in a process of its own, and by our own master."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from dcone_cosim import loading
from dcone_cosim.master import run_scene
from dcone_cosim.progress import Progress
from dcone_cosim.recorder import Recorder
from dcone_cosim.scene_fmus import SceneFmus

MODULES = {"ecos": "ecospy", "libcosim": "libcosimpy", "fmpy": "fmpy", "container": "fmu_manipulation_toolbox"}
ROOT = Path(__file__).parents[2]
Rows = dict[str, np.ndarray]
"""Outputs of a component by name, one value per communication point."""


def in_tool(tool: str, package: Path, component: str, step: float, steps: int, start: float = 0.0) -> Rows:
    """Outputs of a component in the tool, one row per communication point."""
    if importlib.util.find_spec(MODULES[tool]) is None:
        pytest.skip(f"{MODULES[tool]} is not installed")
    result = package.with_suffix(f".{tool}.npz")
    arguments = [tool, package, component, step, steps, start, result]
    done = subprocess.run(
        [sys.executable, "-m", "tests.interop.ssp_drivers", *map(str, arguments)],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    with np.load(result) as rows:
        return dict(rows)


def own(package: Path, *settings: str) -> Recorder:
    """The first phase of a package by our own master; the settings are those of `--set`."""
    scene = loading.load(str(package), settings)
    with SceneFmus(scene, Progress()) as archives:
        return run_scene(scene, archives.instantiate, Progress()).phases[scene.phases[0].name].recorder
