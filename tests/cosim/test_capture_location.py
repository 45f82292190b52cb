"""The instant of the hand-over is located, whatever the FMU offers for it."""

from __future__ import annotations

import pytest

from dcone_cosim.phases import LOCATED_TO, CaptureLoop, CapturePlan, PhaseResult, grid_steps
from dcone_cosim.progress import Progress
from tests.cosim.mock_components import MockCapture

INSTANT = 7.1234567


def run(component: MockCapture, **plan: object) -> PhaseResult:
    component.enter_initialisation(0.0)
    component.exit_initialisation()
    return CaptureLoop(component, CapturePlan(0.5, 20.0, **plan), Progress()).run()  # type: ignore[arg-type]


def test_goes_to_the_instant_the_fmu_reports() -> None:
    component = MockCapture(INSTANT, reports=True)
    result = run(component, stop_there=True)
    assert result.located == INSTANT
    assert component.time == INSTANT
    assert "t_capture" in result.located_by


def test_halves_the_step_when_nothing_is_reported() -> None:
    component = MockCapture(INSTANT)
    result = run(component, stop_there=True)
    assert result.located is not None
    assert 0.0 <= result.located - INSTANT <= LOCATED_TO
    assert component.values["captured"] == 1.0
    assert "halving" in result.located_by


def test_takes_the_end_of_the_step_when_the_state_cannot_be_saved() -> None:
    result = run(MockCapture(INSTANT, can_save=False), stop_there=True)
    assert result.located == 7.5
    assert "cannot save" in result.located_by


def test_takes_the_end_of_the_step_when_steps_have_one_length() -> None:
    component = MockCapture(INSTANT)
    component.can_vary_step = False
    result = run(component, stop_there=True)
    assert result.located == 7.5
    assert "takes only steps of one length" in result.located_by
    assert {size for _, size in component.calls} == {0.5}


@pytest.mark.parametrize("instant", [7.0, 7.5])
def test_an_instant_on_a_communication_point(instant: float) -> None:
    result = run(MockCapture(instant, reports=True), stop_there=True)
    assert result.located == instant


def test_goes_on_for_the_time_asked() -> None:
    component = MockCapture(INSTANT)
    result = run(component, after_capture=2.0)
    assert result.located is not None
    assert component.time == pytest.approx(result.located + 2.0, abs=1e-12)
    assert result.end == component.time
    assert result.outcome == "captured"


def test_a_failed_capture_ends_the_phase_at_once() -> None:
    component = MockCapture(INSTANT, outcome="missed")
    result = run(component)
    assert result.located is None
    assert result.outcome == "missed"
    assert component.time == 7.5


def test_communication_points_do_not_accumulate() -> None:
    component = MockCapture(1e9)
    component.enter_initialisation(0.0)
    component.exit_initialisation()
    CaptureLoop(component, CapturePlan(0.1, 100.0), Progress()).run()
    assert [time for time, _ in component.calls] == [i * 0.1 for i in range(1000)]


def test_the_last_step_is_shortened_to_the_duration() -> None:
    assert grid_steps(1.0, 0.3) == 4
    assert grid_steps(0.9, 0.3) == 3
    component = MockCapture(1e9)
    component.enter_initialisation(0.0)
    component.exit_initialisation()
    assert CaptureLoop(component, CapturePlan(0.3, 1.0), Progress()).run().end == 1.0
