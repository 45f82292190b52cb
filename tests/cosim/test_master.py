"""The master with stand-ins: phases, the transaction between them, outcomes and their exit codes."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from dcone_cosim.errors import CAPTURE_FAILED, FMU_FAILED, HANDOFF_FAILED, SUCCESS, FmuError, InputError
from dcone_cosim.handoff import mean_motion
from dcone_cosim.master import run_scene
from dcone_cosim.progress import Progress
from dcone_cosim.results import RunResult
from dcone_cosim.scene.data import Scene
from dcone_cosim.transaction import advanced
from tests.cosim.mock_components import MockCapture, MockComponent, MockRemoval

Make = Callable[..., Scene]


def run(scene: Scene, capture: MockComponent | None = None, removal: Callable[[], MockComponent] = MockRemoval):
    made: list[MockComponent] = []

    def instantiate(phase: str, name: str) -> MockComponent:
        component = capture if phase == "capture" and capture is not None else removal()
        component.name = name
        made.append(component)
        return component

    result = run_scene(scene, instantiate, Progress())
    assert all(component.closed for component in made)
    return result, made


def test_two_phases_and_a_closed_ledger(make_scene: Make) -> None:
    result, made = run(make_scene("capture", "removal"), MockCapture(reports=True))
    assert result.exit_code == SUCCESS
    assert result.handovers["removal"] is not None
    assert result.handovers["removal"].rows
    assert all(row.closed for row in result.handovers["removal"].rows)
    assert [component.name for component in made] == ["capture", "removal", "removal without recoil"]
    assert made[1].calls[0][0] == result.handovers["removal"].time
    removal = result.phases["removal"]
    assert (removal.origin, removal.start, removal.end) == (result.handovers["removal"].time, 0.0, 100.0)


def test_the_removal_begins_where_the_capture_ended(make_scene: Make) -> None:
    result, made = run(make_scene("capture", "removal"), MockCapture(reports=True))
    given, instant = made[1].values, result.handovers["removal"].time
    assert given["start.condition"] == 1.0
    assert given["target.mass"] == 1006.0
    assert given["orbit.true_anomaly"] == pytest.approx(mean_motion(800e3) * instant, rel=1e-12)
    chaser = -12.0 - 0.005 * instant
    joint = 6.0 * (-12.0 + 5.0 / 3.0 * instant) / 1006.0
    assert given["start.relative_position[2]"] == pytest.approx(joint - chaser, rel=1e-12)
    assert given["start.relative_velocity[2]"] == pytest.approx(10.0 / 1006.0 + 0.005, rel=1e-12)


def test_the_comparison_is_at_rest(make_scene: Make) -> None:
    _, made = run(make_scene("capture", "removal"), MockCapture(reports=True))
    assert all(made[2].values[f"start.relative_velocity[{i}]"] == 0.0 for i in (1, 2, 3))


def test_the_comparison_can_be_left_out(make_scene: Make) -> None:
    result, made = run(make_scene("capture", "removal", compare_without_recoil=False), MockCapture())
    assert len(made) == 2
    assert result.comparisons.get("removal") is None


@pytest.mark.parametrize("when", ["made", "stepped", "never"])
def test_a_comparison_that_fails_says_why_and_fails_nothing(make_scene: Make, when: str) -> None:
    class Listening(Progress):
        def say(self, text: str) -> None:
            said.append(text)

    class Jammed(MockRemoval):
        def step(self, time: float, size: float) -> None:
            raise FmuError("the winch jammed")

    def instantiate(phase: str, name: str) -> MockComponent:
        if name == "removal without recoil" and when == "made":
            raise FmuError("the winch jammed")
        if name == "removal without recoil" and when == "stepped":
            return Jammed()
        return MockCapture(reports=True) if phase == "capture" else MockRemoval()

    said: list[str] = []
    result = run_scene(make_scene("capture", "removal"), instantiate, Listening())
    assert result.exit_code == SUCCESS
    assert (result.comparisons.get("removal") is None) == (when != "never")
    told = ["the removal without recoil is left out: the winch jammed"] if when != "never" else []
    assert [text for text in said if "left out" in text] == told


@pytest.mark.parametrize("tampered", [{"target.mass": 1.01}, {"start.relative_velocity[2]": -1.0}])
def test_a_removal_that_changes_what_it_is_given_is_caught(make_scene: Make, tampered: dict[str, float]) -> None:
    result, _ = run(make_scene("capture", "removal"), MockCapture(), lambda: MockRemoval(tampered))
    assert result.exit_code == HANDOFF_FAILED
    assert "does not close" in result.message
    assert any(unit in result.message for unit in (" kg,", " N s,"))
    assert "capture" in result.phases


def test_a_spin_that_matters_is_refused(make_scene: Make) -> None:
    result, made = run(make_scene("capture", "removal", point_tolerance=0.01), MockCapture(spin=100.0))
    assert result.exit_code == HANDOFF_FAILED
    assert "N m s" in result.message
    assert "point_tolerance" in result.message
    assert "a removal FMU with target.inertia" in result.message
    assert len(made) == 1
    accepted, _ = run(make_scene("capture", "removal", point_tolerance=math.inf), MockCapture(spin=100.0))
    assert accepted.exit_code == SUCCESS


def test_a_tether_too_short_is_refused(make_scene: Make) -> None:
    scene = make_scene("capture", "removal")
    scene.phases[1].main.parameters["tether.rest_length"] = 5.0  # type: ignore[index]
    result, _ = run(scene, MockCapture())
    assert result.exit_code == HANDOFF_FAILED
    assert "apart" in result.message


@pytest.mark.parametrize("outcome", ["missed", "slipped_off", "not_closed", "tether_taut"])
def test_a_failed_capture_is_an_outcome(make_scene: Make, outcome: str) -> None:
    result, made = run(make_scene("capture", "removal"), MockCapture(outcome=outcome))
    assert result.exit_code == CAPTURE_FAILED
    assert f"capture failed: {outcome.replace('_', ' ')} at t = " in result.message
    assert len(result.phases["capture"].recorder) > 1
    assert len(made) == 1


def test_still_flying_at_the_end_is_a_failed_capture(make_scene: Make) -> None:
    result, _ = run(make_scene("capture"), MockCapture(instant=1e9))
    assert result.exit_code == CAPTURE_FAILED
    assert "flying" in result.message


def test_an_fmu_that_fails_leaves_what_was_reached(make_scene: Make) -> None:
    result, _ = run(make_scene("capture"), MockCapture(fails_at=3.0))
    assert result.exit_code == FMU_FAILED
    assert "told to fail" in result.message
    assert len(result.phases["capture"].recorder) == 6


def test_parameters_an_fmu_refuses_are_bad_input(make_scene: Make) -> None:
    class Refusing(MockCapture):
        def exit_initialisation(self) -> None:
            raise FmuError("net.side must be a whole number of net.mesh")

    with pytest.raises(InputError, match="whole number"):
        run(make_scene("capture"), Refusing())


def test_tugs_are_gathered_once_each(make_scene: Make) -> None:
    tugs = [(12.0, 5.0, 0.01), (19.9, 4.0, 0.02), (33.0, 3.0, 0.03), (95.0, 2.0, 0.01)]
    result, _ = run(make_scene("removal"), removal=lambda: MockRemoval(tugs=tugs, grows=5.0))
    found = result.phases["removal"].tugs
    assert found is not None
    assert [found.rows[i] for i in sorted(found.rows)] == tugs


def test_the_anomaly_stays_within_a_turn() -> None:
    assert advanced(6.2, 0.2) == pytest.approx(6.4 - 2 * np.pi)


def test_a_result_knows_when_it_failed(make_scene: Make) -> None:
    result = RunResult(make_scene("capture"))
    result.fail("hand-off refused", "because", HANDOFF_FAILED)
    assert (result.status, result.exit_code) == ("hand-off refused", 4)
