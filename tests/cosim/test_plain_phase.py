"""A phase that is neither capture nor removal: stepped from its start to its stop, and told by its own name."""

from __future__ import annotations

import pytest

from dcone_cosim.errors import FMU_FAILED, FmuError, InputError
from dcone_cosim.master import run_scene
from dcone_cosim.progress import Progress
from dcone_cosim.reports import summary
from dcone_cosim.scene.data import ComponentScene, PhaseScene, Scene
from tests.cosim.mock_components import MockComponent


class Ramp(MockComponent):
    """Its height is its slope times the time."""

    def __init__(self, fails_at: float = float("inf")) -> None:
        super().__init__("ramp")
        self.fails_at = fails_at
        self.declare(["slope"], "parameter", 1.0)
        self.declare(["height"], "output")

    def refresh(self) -> None:
        if self.time >= self.fails_at:
            raise FmuError("ramp: told to fail")
        self.values["height"] = self.values["slope"] * self.time


def crane(**parameters: float) -> Scene:
    phase = PhaseScene("crane", ComponentScene("ramp", parameters=parameters), 2.0, 5.0, start=10.0)
    return Scene("crane", "A crane", "", (phase,))


def test_it_runs_from_its_start_to_its_stop() -> None:
    run = run_scene(crane(slope=3.0), lambda phase, name: Ramp(), Progress())
    recorder = run.phases["crane"].recorder
    assert run.exit_code == 0
    assert recorder["time"].tolist() == [10.0, 12.0, 14.0, 15.0]
    assert recorder["height"].tolist() == [30.0, 36.0, 42.0, 45.0]
    assert run.parameters["crane"] == {"slope": 3.0}
    told = summary.as_dict(run)["crane"]
    assert told["simulated"]["value"] == 5.0
    assert told["height"]["value"] == 45.0
    assert "removal" not in summary.as_dict(run)


def test_what_fails_on_the_way_keeps_what_was_reached() -> None:
    run = run_scene(crane(), lambda phase, name: Ramp(fails_at=13.0), Progress())
    assert run.exit_code == FMU_FAILED
    assert run.phases["crane"].recorder["time"].tolist() == [10.0, 12.0]


def test_what_cannot_begin_is_bad_input() -> None:
    with pytest.raises(InputError, match="the crane cannot begin"):
        run_scene(crane(slpoe=1.0), lambda phase, name: Ramp(), Progress())
