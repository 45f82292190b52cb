"""An FMU is told with each step whether anybody may go back to before it; some go wrong over either answer.

FMI 2.0.4, section 4.2.2: noSetFMUStatePriorToCurrentPoint is true if no state of a time before the begin of the step
will be set in this run. An FMU may then throw its past away, as FLUSHES does, which refuses to go there; and one that
keeps a history to go back by may begin anew when it hears false, as REWINDS does.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from dcone_cosim.coupling.coupled import Coupled
from dcone_cosim.coupling.options import Coupling
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.fmu.component import Component, Terminated
from dcone_cosim.fmu.isolation import IsolatedComponent
from dcone_cosim.phases.capture_loop import CaptureLoop, CapturePlan
from dcone_cosim.phases.stepping import PhaseLoop
from dcone_cosim.progress import Progress
from tests.cosim.fmus.build import build
from tests.cosim.mock_components import MockRemoval

ARRIVAL = 16.0 / 3.0
"""Instant of capture of the template's FMU: 16 m at 3 m/s [s]."""


def unreported(xml: str) -> str:
    """Without the instant it reports, the step has to be halved."""
    assert '"t_capture"' in xml
    return xml.replace('"t_capture"', '"t_of_something"')


def told(component: Component) -> list[tuple[float, bool]]:
    """The begin of every step, and the word that nobody goes back to before it."""
    words: list[tuple[float, bool]] = []
    call = component._do_step

    def step(time: float, size: float, no_return: int) -> int:
        words.append((time, bool(no_return)))
        return call(time, size, no_return)

    component._do_step = step
    return words


@pytest.mark.parametrize("isolate", [False, True], ids=["here", "isolated"])
def test_a_removal_that_rewinds_is_towed_as_any_other(tmp_path: Path, isolate: bool) -> None:
    """It drifts at 0.5 m/s from 20 m: 60 s later the distance is sqrt(20^2 + 30^2) m."""
    with Archive(build(tmp_path, "removal", "REWINDS")) as archive:
        component = IsolatedComponent(archive, "tow") if isolate else Component(archive, "tow")
        with component:
            component.set({"start.relative_position[1]": 20.0, "start.relative_velocity[1]": 0.0})
            component.set({"start.relative_position[2]": 0.0, "start.relative_velocity[2]": 0.5})
            component.set({"start.relative_position[3]": 0.0, "start.relative_velocity[3]": 0.0})
            component.initialise(0.0)
            result = PhaseLoop(component, 10.0, 0.0, 60.0, Progress()).run()
            assert result.error is None
            assert result.recorder["separation"][-1] == pytest.approx(np.hypot(20.0, 30.0), rel=1e-15)


@pytest.mark.parametrize("switch", ["REWINDS", "FLUSHES"])
@pytest.mark.parametrize("change", [lambda xml: xml, unreported], ids=["reported", "halved"])
@pytest.mark.parametrize("then", [True, False], ids=["stop", "go on"])
def test_a_capture_is_located(tmp_path: Path, switch: str, change: Callable[[str], str], then: bool) -> None:
    """Every state that is gone back to is that of the begin of the last step, even while the step is halved."""
    with Archive(build(tmp_path, "capture", switch, change=change)) as archive, Component(archive, "shot") as shot:
        shot.initialise(0.0)
        words = told(shot)
        result = CaptureLoop(shot, CapturePlan(0.5, 8.0, stop_there=then), Progress()).run()
        assert result.error is None
        assert result.located == pytest.approx(ARRIVAL, abs=1e-6)
        assert all(no_return for _, no_return in words)
        assert len(words) > 10


def twice(tmp_path: Path, switch: str, **coupling: object) -> tuple[Coupled, list[list[tuple[float, bool]]], Archive]:
    archives = [Archive(build(tmp_path / name, "removal", switch)) for name in ("one", "other")]
    components = [Component(archive, archive.path.parent.name) for archive in archives]
    for component in components:
        component.set({"start.relative_position[1]": 20.0, "start.relative_velocity[1]": 0.5})
        component.set({f"start.relative_{of}[{i}]": 0.0 for of in ("position", "velocity") for i in (2, 3)})
    whole = Coupled("pair", components, [], Coupling(**coupling))  # type: ignore[arg-type]
    whole.enter_initialisation(0.0)
    whole.exit_initialisation()
    return whole, [told(component) for component in components], archives


@pytest.fixture
def pair(tmp_path: Path):
    opened = []

    def make(switch: str, **coupling: object):
        whole, words, archives = twice(tmp_path, switch, **coupling)
        opened.extend([whole, *archives])
        return whole, words

    yield make
    for one in opened:
        one.close()


def test_coupling_steps_of_one_length_never_go_back_further(pair: Callable[..., tuple]) -> None:
    """Four in a macro step: were its begin kept for an FMU that may end itself, three of four would hear false."""
    whole, words = pair("REWINDS", step=0.25)
    for i in range(3):
        whole.step(float(i), 1.0)
    assert whole.get(["separation", "other.separation"]) == {"separation": 21.5, "other.separation": 21.5}
    assert [w for of in words for w in of] == [(0.25 * k, True) for k in range(12)] * 2


@pytest.mark.parametrize("switch", ["REWINDS", "FLUSHES"])
def test_one_that_ends_itself_is_met_from_its_last_step(pair: Callable[..., tuple], switch: str) -> None:
    whole, _ = pair(switch, step=0.25)
    first, other = whole.components
    step = other.step

    def ending(time: float, size: float) -> None:
        if time + size > 2.6 + 1e-12:
            raise Terminated("other", " ended", "", "", "Discard", 2.6)
        step(time, size)

    other.step = ending
    whole.step(0.0, 2.0)
    with pytest.raises(Terminated) as caught:
        whole.step(2.0, 1.0)
    assert caught.value.time == first.time == other.time == 2.6
    assert first.get(["separation"])["separation"] == pytest.approx(20.0 + 0.5 * 2.6, rel=1e-14)


def test_controlled_steps_say_where_they_may_go_back(pair: Callable[..., tuple]) -> None:
    """Of a whole step and two halves only the second half begins after what may be gone back to."""
    whole, (words, _) = pair("FLUSHES", control="error", step=1.0)
    whole.step(0.0, 1.0)
    # twice by itself to see that it restores, then whole, half and half
    assert words == [(0.0, True), (0.0, True), (0.0, True), (0.0, True), (0.5, False)]
    whole.step(1.0, 1.0)
    assert words[5:] == [(1.0, True), (1.0, True), (1.5, False)]


def test_a_kept_state_is_told_of_until_it_is_released(tmp_path: Path) -> None:
    with Archive(build(tmp_path, "removal", "FLUSHES")) as archive, Component(archive, "tow") as tow:
        tow.initialise(0.0)
        words = told(tow)
        tow.save("begin")
        tow.step(0.0, 1.0)
        tow.step(1.0, 1.0)
        tow.restore("begin")
        tow.step(0.0, 1.0)
        tow.step(1.0, 1.0)
        tow.release("begin")
        tow.release("begin")
        tow.step(2.0, 1.0)
        tow.state_size()
        tow.step(3.0, 1.0)
        assert words == [(0.0, True), (1.0, False), (0.0, True), (1.0, False), (2.0, True), (3.0, True)]


def test_pieces_of_a_step_go_back_to_their_own_begin_alone() -> None:
    """Seven tugs in a ring of two: the step is halved again and again, and no half leaves a state before it behind."""

    class Kept(MockRemoval):
        def step(self, time: float, size: float) -> None:
            assert all(of >= time for of, _ in self._kept.values())
            super().step(time, size)

    component = Kept(tugs=[(0.3 + 1.3 * i, 10.0, 0.1) for i in range(7)])
    component.enter_initialisation(0.0)
    component.exit_initialisation()
    result = PhaseLoop(component, 10.0, 0.0, 20.0, Progress()).run()
    assert result.error is None
    assert result.tugs is not None
    assert len(component.calls) > 6
