"""The instant of the hand-over is located, whatever the FMU offers for it."""

from __future__ import annotations

import pytest

from dcone_cosim.phases.capture_loop import CaptureLoop, CapturePlan
from dcone_cosim.phases.stepping import grid_steps
from dcone_cosim.progress import Progress
from dcone_cosim.results import PhaseResult
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
    assert 0.0 <= result.located - INSTANT <= 1e-6
    assert component.time == result.located
    assert component.values["captured"] == 1.0
    # 0.5 s halved nineteen times is below 1e-6 s
    assert result.located_by == "halving the macro step to 9.5e-07 s"
    # fifteen steps, the last once more to see that it is restored, the halves, and on to the upper end of the last
    assert len(component.calls) == 15 + 1 + 19 + 1


def test_takes_the_end_of_the_step_when_the_state_cannot_be_saved() -> None:
    result = run(MockCapture(INSTANT, can_save=False), stop_there=True)
    assert result.located == 7.5
    assert "cannot save" in result.located_by


def test_takes_the_end_of_the_step_when_steps_have_one_length() -> None:
    component = MockCapture(INSTANT)
    component.can_vary_step = False
    result = run(component, stop_there=True)
    assert result.located == 7.5
    assert result.located_by == "end of the macro step of 0.5 s: this FMU takes only steps of one length"
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


class Told(MockCapture):
    """Tells a `t_capture` of its own from then on, whatever its `captured` says, and settles later."""

    def __init__(self, tells: float, instant: float = INSTANT, settles: float = float("inf")) -> None:
        self.tells, self.settles = tells, settles
        super().__init__(instant)

    def refresh(self) -> None:
        super().refresh()
        self.values["t_capture"] = self.tells if self.time >= self.instant else -1.0
        self.values["settled"] = float(self.time >= self.settles)


@pytest.mark.parametrize("tells", [7.05, 7.0, 6.2, 0.0, 7.6, 8.0])
def test_an_instant_at_which_it_is_not_captured_is_not_believed(tells: float) -> None:
    """Too early within the step, at its begin, before it, or after it: the step is halved instead."""
    component = Told(tells)
    result = run(component, stop_there=True)
    assert result.located is not None
    assert 0.0 <= result.located - INSTANT <= 1e-6
    assert component.time == result.located
    assert result.located_by.startswith("halving")
    assert all(size > 0.0 for _, size in component.calls)


def test_an_instant_told_for_the_end_of_the_step() -> None:
    component = Told(7.5)
    result = run(component, stop_there=True)
    assert (result.located, component.time) == (7.5, 7.5)
    assert result.located_by == "the FMU's own t_capture"


def test_an_instant_told_too_late_within_the_step_is_taken_at_its_word() -> None:
    """It is captured by then; what the FMU says of itself counts."""
    result = run(Told(7.3), stop_there=True)
    assert result.located == 7.3
    assert result.located_by == "the FMU's own t_capture, reached from its saved state"


def test_settled_is_another_instant_than_captured() -> None:
    """`t_capture` lies in the step in which the net settles, before or after that, and is not gone to."""
    for tells in (INSTANT, 7.45, 7.5):
        component = Told(tells, settles=7.4)
        result = run(component, hand_over="settled", stop_there=True)
        assert result.located is not None
        assert 0.0 <= result.located - 7.4 <= 1e-6
        assert component.values["settled"] == 1.0
        assert result.located_by.startswith("halving")


@pytest.mark.parametrize("instant", [0.3, 0.7, 1.7, INSTANT])
def test_an_fmu_that_tells_no_instant(instant: float) -> None:
    component = MockCapture(instant)
    del component.values["t_capture"], component.variables["t_capture"]
    result = run(component, stop_there=True)
    assert result.located is not None
    assert 0.0 <= result.located - instant <= 1e-6
    assert result.located_by.startswith("halving")


@pytest.mark.parametrize(
    ("tells", "more"), [(7.3, " (it reports 7.3 s)"), (7.5, " (it reports 7.5 s)"), (7.0, ""), (7.6, ""), (-1.0, "")]
)
def test_what_it_reports_is_told_where_it_cannot_be_gone_to(tells: float, more: str) -> None:
    component = Told(tells)
    component.can_save = False
    result = run(component, stop_there=True)
    assert result.located == 7.5
    assert result.located_by == f"end of the macro step of 0.5 s: this FMU cannot save its state{more}"


def test_the_step_that_is_halved_begins_where_it_was_taken() -> None:
    """From the saved state: the step that went over it, the same again as proof, and the halves."""
    component = MockCapture(0.3)
    result = run(component, stop_there=True)
    halves = [(0.0, 0.25), (0.25, 0.125), (0.25, 0.0625), (0.25, 0.03125), (0.28125, 0.015625)]
    assert component.calls[:7] == [(0.0, 0.5), (0.0, 0.5), *halves]
    assert result.located is not None
    assert 0.0 <= result.located - 0.3 <= 1e-6


def test_a_step_of_a_millionth_of_a_second_is_not_halved() -> None:
    component = MockCapture(0.7e-6)
    component.enter_initialisation(0.0)
    component.exit_initialisation()
    result = CaptureLoop(component, CapturePlan(1e-6, 1e-5, stop_there=True), Progress()).run()
    assert result.located == 1e-6
    assert result.located_by == "halving the macro step to 1e-06 s"


def test_a_state_that_does_not_come_back_is_told_with_its_time() -> None:
    """After the first half of the step, which went too far: back to 7 s it should be."""

    class Forgetful(MockCapture):
        restored = 0

        def restore(self, key: str = "") -> None:
            super().restore(key)
            self.restored += 1
            self.values["chaser.position[2]"] += self.restored > 2

    result = run(Forgetful(INSTANT), stop_there=True)
    assert result.error is not None
    assert "at t = 7 s its output chaser.position[2] was -12.035 before, -11.035 after" in str(result.error)
