"""Scenes of shots that fail: each ends as the model's page says, with the exit code of a failed capture."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from dcone_cosim.errors import CAPTURE_FAILED
from dcone_cosim.loading import load, shipped
from dcone_cosim.phases.capture_report import findings
from dcone_cosim.recorder import Recorder
from dcone_cosim.results import PhaseResult, RunResult
from dcone_cosim.scene.data import Scene
from tests.cosim.conftest import Dcone

PAGE = Path(__file__).parents[2] / "fmu_src" / "net_capture" / "README.md"
OUTCOMES = dict(re.findall(r"\| `(failed-[\w-]+)` \|[^|]*\| ([\w ]+) \|", PAGE.read_text()))
"""Of each scene, as the page tells it."""


def test_the_page_tells_every_scene_that_fails() -> None:
    assert sorted(OUTCOMES) == [name for name in sorted(shipped()) if name.startswith("failed-")]
    assert {"missed", "slipped off", "not closed", "tether taut"} == set(OUTCOMES.values())
    for name, outcome in OUTCOMES.items():
        assert load(name).phases[0].options.hand_over == "captured"
        said = shipped()[name].read_text().splitlines()[:3]
        assert outcome in " ".join(line.removeprefix("# ") for line in said if line.startswith("#"))


@pytest.mark.parametrize(
    "name",
    [
        name if name == "failed-slipped-off" else pytest.param(name, marks=pytest.mark.evidence)
        for name in sorted(OUTCOMES)
    ],
)
def test_it_ends_as_the_page_says(dcone: Dcone, name: str) -> None:
    """One of them in every run of the tests, on an FMU that they have anyway."""
    code, out, err = dcone("run", name, "-o", "out", "--no-figures")
    assert code == CAPTURE_FAILED
    assert f"capture failed: {OUTCOMES[name]} at t = " in " ".join((out + err).split())


@pytest.mark.parametrize(("outcome", "told"), [("not_closed", {"closing.timeout": 20.0}), ("captured", {})])
def test_how_long_it_had_to_close_is_told(outcome: str, told: dict[str, float]) -> None:
    """A time that suits a net of 2 m, and is none of the winches' doing, ended captures of 25 m unseen."""
    result = PhaseResult("capture", 0.0, Recorder.of({"time": ("s", "Real", [0.0, 1.0])}), outcome=outcome)
    run = RunResult(scene=Scene("one", "", "", ()), parameters={"capture": {"closing.timeout": 20.0}})
    assert {one.key: one.value for one in findings(run, result) if one.key == "closing.timeout"} == told
