"""What the tests of the master share: a scene made by hand for the stand-ins, and the command line."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from dcone_cosim import cli
from dcone_cosim.phases.capture import CaptureOptions
from dcone_cosim.scene.data import ComponentScene, HandoffOptions, PhaseScene, Scene

Dcone = Callable[..., tuple[int, str, str]]


def scene_of(*phases: str, **handoff: Any) -> Scene:
    """A scene for the stand-ins, of the named phases; a point is taken whatever it changes, unless a tolerance says."""
    known = {
        "capture": PhaseScene("capture", ComponentScene("capture", "mock"), 0.5, 20.0, CaptureOptions()),
        "removal": PhaseScene(
            "removal",
            ComponentScene(
                "removal",
                "mock",
                parameters={"tether.rest_length": 20.0, "thrust.level": -0.01, "orbit.altitude": 800e3},
                defaults={"tether.rest_length": 12.0, "target.attachment_distance": 0.0},
                choices={"start.condition": ("same_orbit", "handed_over")},
            ),
            10.0,
            100.0,
        ),
    }
    return Scene(
        "mock",
        "A scene of stand-ins",
        "title = 'mock'\n",
        tuple(known[p] for p in phases),
        HandoffOptions(**{"point_tolerance": math.inf, **handoff}),
    )


@pytest.fixture
def make_scene() -> Callable[..., Scene]:
    return scene_of


@pytest.fixture
def dcone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Dcone:
    """Run the command line in an empty folder; returns exit code, stdout and stderr."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments: str) -> tuple[int, str, str]:
        monkeypatch.setattr("sys.argv", ["dcone", *arguments])
        with pytest.raises(SystemExit) as stop:
            cli.main()
        written = capfd.readouterr()
        return int(stop.value.code or 0), written.out, written.err

    return run
