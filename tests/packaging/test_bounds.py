"""No kernel reads or writes beyond the arrays that it is handed: our models compiled with numba's check of every index.

The FMUs have no such check: a row that is declared a number too short lets a kernel write over the one behind it, and
nothing tells.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from dcone_cosim.loading import load, shipped

ROOT = Path(__file__).parents[2]
CODE = """
import sys
from dcone_cosim.loading import load
from fmu_src.catalogue import MODELS
from fmu_src.instance import Instance, ModelFault

scene, name, *settings = sys.argv[1:]
phase = next(one for one in load(scene, settings).phases if one.name == name)
main = phase.main
instance = Instance(MODELS[main.model], main.terms, main.parameters, main.numbers)
instance.initialise()
try:
    for _ in range(400):
        instance.step(phase.duration / 400.0)
except ModelFault as fault:
    print(fault)
"""
"""Of one phase, in four hundred steps, or up to where the model ends; one that another hands over to begins as its own
defaults say."""
OTHERS = (
    ("table2-deorbit", "removal", "removal.level.detail=averaged", "removal.duration=300 d"),
    ("table2-deorbit", "removal", "removal.level.detail=event_map", "removal.duration=12 h"),
    ("tumbling-target", "removal", "removal.level.detail=settled"),
    ("table1-capture", "capture", "capture.net.mesh=2 m", "capture.self_contact.thickness=1 cm"),
    ("conical-2m", "capture", "capture.folding.pattern=star", "capture.self_contact.duration=1 ms"),
    ("mission", "capture", "capture.gravity_gradient.kind=plain"),
    ("planar-2m", "capture", "capture.bending.rigidity=1e-5 N.m2", "capture.wall.friction=0.2"),
)
"""What no shipped scene has."""


def phases() -> list[tuple[str, ...]]:
    own = [(name, one.name) for name in sorted(shipped()) for one in load(name).phases if one.main.fmu is None]
    return [*own, *OTHERS]


@pytest.mark.evidence
@pytest.mark.parametrize("arguments", phases(), ids=" ".join)
def test_every_index_is_within_its_array(arguments: tuple[str, ...]) -> None:
    done = subprocess.run(
        [sys.executable, "-c", CODE, *arguments],
        capture_output=True,
        text=True,
        cwd=ROOT,
        env={"NUMBA_BOUNDSCHECK": "1", "PYTHONPATH": str(ROOT)},
    )
    assert "out of bounds" not in done.stderr
    assert done.returncode == 0, done.stderr
