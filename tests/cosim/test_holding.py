"""What a row tells holds over all of it: peaks and tugs through coupling, rollback, halving and long macro steps."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest

from dcone_cosim.coupling.coupled import Coupled
from dcone_cosim.coupling.options import Coupling
from dcone_cosim.errors import FmuError
from dcone_cosim.fmu.component import CallError, Terminated
from dcone_cosim.holding import Held
from dcone_cosim.phases.capture_loop import CaptureLoop, CapturePlan
from dcone_cosim.phases.stepping import PhaseLoop
from dcone_cosim.progress import Progress
from dcone_cosim.results import PhaseResult
from tests.cosim.in_process import KernelComponent
from tests.cosim.mock_components import MockCapture, MockComponent, MockRemoval
from tests.cosim.reel_pair import CONNECTIONS, Law

PEAKS, LEASTS = ("tether.tension_peak", "thread.tension_peak", "cord.tension_peak"), ("tether.tension_least",)


def tension(time: float) -> float:
    return 2.0 + math.sin(1.7 * time) + 0.3 * time


def extremes(begin: float, end: float) -> tuple[float, float]:
    """Least and largest of it between two times, from its ends and where its slope is zero."""
    turn = math.acos(-0.3 / 1.7)
    inside = [(sign * turn + k * math.tau) / 1.7 for sign in (-1, 1) for k in range(-1, 40)]
    values = [tension(t) for t in (begin, end, *(t for t in inside if begin < t < end))]
    return min(values), max(values)


class Pulling(MockComponent):
    """Tells the extremes of a known tension over its last step; discards steps longer than `longest` [s]."""

    def __init__(self, name: str = "removal", longest: float = math.inf, ends_at: float = math.inf) -> None:
        super().__init__(name)
        self.longest, self.ends_at = longest, ends_at
        self.declare((*PEAKS, *LEASTS, "tether.tension"), "output", tension(0.0))

    def step(self, time: float, size: float) -> None:
        if size > self.longest:
            raise CallError(self.name, "", "too long", "mock", "Discard", time)
        if time + size > self.ends_at:
            raise Terminated(self.name, "", "over", "mock", "Discard", self.ends_at)
        super().step(time, size)
        least, largest = extremes(time - self.start, time + size - self.start)
        self.values |= dict.fromkeys(PEAKS, largest) | dict.fromkeys(LEASTS, least)
        self.values["tether.tension"] = tension(self.since)


def tow(component: object, macro_step: float, duration: float, start: float = 0.0) -> PhaseResult:
    component.enter_initialisation(start)  # type: ignore[attr-defined]
    component.exit_initialisation()  # type: ignore[attr-defined]
    return PhaseLoop(component, macro_step, start, duration, Progress(), origin=start).run()  # type: ignore[arg-type]


def check_rows(result: PhaseResult, prefix: str = "") -> None:
    recorder = result.recorder
    times = recorder["time"]
    assert len(times) > 2
    expected = np.array([extremes(a, b) for a, b in pairwise(times)])
    for names, column in ((LEASTS, expected[:, 0]), (PEAKS, expected[:, 1])):
        for name in names:
            if prefix + name in recorder:
                assert recorder[prefix + name][1:] == pytest.approx(column, rel=1e-12)


@pytest.mark.parametrize("method", ["jacobi", "gauss_seidel"])
@pytest.mark.parametrize(
    "coupling",
    [{"step": 0.5}, {"step": 0.7}, {}, {"control": "error", "step": 0.4}, {"control": "error"}],
    ids=["fixed", "uneven", "whole", "controlled", "rolled back"],
)
def test_rows_of_coupled_components(method: str, coupling: dict[str, object]) -> None:
    """Of the main component and of another, at every way to step; discarded and rejected trials do not count."""
    longest = 1.1 if coupling.get("control") else math.inf
    whole = Coupled(
        "removal", [Pulling(), Pulling("other", longest)], [], Coupling(method=method, **coupling), ["a", "b"]
    )
    result = tow(whole, 3.0, 15.0)
    assert result.error is None
    for prefix in ("", "b."):
        check_rows(result, prefix)
    assert (whole.statistics["rejected"] > 0) == ("control" in coupling)


def test_the_last_step_alone_is_not_the_row() -> None:
    """Twin: what a component tells of its last coupling step."""
    last = Pulling()
    whole = Coupled("removal", [last], [], Coupling(step=0.5), ["a"])
    result = tow(whole, 3.0, 3.0)
    assert last.values["tether.tension_peak"] != pytest.approx(result.recorder["tether.tension_peak"][-1], rel=1e-3)


def test_rows_before_an_fmu_ends_itself() -> None:
    whole = Coupled("removal", [Pulling(ends_at=7.3)], [], Coupling(step=0.5), ["a"])
    result = tow(whole, 3.0, 15.0)
    assert (result.outcome, result.ended_at, result.end) == ("ended", 7.3, 6.0)
    check_rows(result)


@pytest.mark.parametrize(
    ("every", "duration", "rows"), [(4, 24.0, [0.0, 12.0, 24.0]), (5, 33.0, [0.0, 15.0, 30.0, 33.0])]
)
def test_rows_that_are_thinned_keep_every_peak(every: int, duration: float, rows: list[float]) -> None:
    """A row for so many macro steps, and the last: with the extremes of all of them."""
    component = Pulling()
    component.enter_initialisation(0.0)
    component.exit_initialisation()
    loop = PhaseLoop(component, 3.0, 0.0, duration, Progress())  # type: ignore[arg-type]
    loop.thin(every)
    result = loop.run()
    assert result.recorder["time"].tolist() == rows
    assert result.steps == round(duration / 3.0)
    check_rows(result)
    whole = tow(Pulling(), 3.0, duration).recorder
    assert result.recorder[PEAKS[0]].max() == whole[PEAKS[0]].max()


class Telling(Pulling):
    """One that has the outputs of its end, and says so."""

    def __init__(self, ends_at: float, told: float) -> None:
        super().__init__(ends_at=ends_at)
        self.told = told
        self.declare(("ends.time",), "output", 0.0)

    def step(self, time: float, size: float) -> None:
        try:
            super().step(time, size)
        except Terminated:
            self.values["ends.time"], self.values["tether.tension"] = self.told, 77.0
            raise


def test_a_row_of_the_instant_at_which_an_fmu_ends_itself() -> None:
    """Where it says that its outputs are of that; at another time than 0 too, but not where it tells another time."""
    for start in (0.0, 100.0):
        result = tow(Telling(start + 7.3, 7.3), 3.0, 15.0, start)
        assert (result.outcome, result.end) == ("ended", result.ended_at)
        assert list(result.recorder["time"]) == pytest.approx([0.0, 3.0, 6.0, 7.3])
        assert result.recorder["tether.tension"][-1] == 77.0
    assert tow(Telling(7.3, 5.0), 3.0, 15.0).end == 6.0


@pytest.mark.parametrize("start", [0.0, 100.0, -50.0])
@pytest.mark.parametrize("reports", [True, False])
def test_rows_around_the_instant_of_capture(reports: bool, start: float) -> None:
    """The row at the instant stands for the time since the row before, the next for the rest of the macro step."""

    class Netted(MockCapture):
        def __init__(self) -> None:
            super().__init__(7.1234567, reports)
            self.declare(PEAKS, "output", tension(0.0))

        def step(self, time: float, size: float) -> None:
            super().step(time, size)
            self.values |= dict.fromkeys(PEAKS, extremes(time - start, time + size - start)[1])

    component = Netted()
    component.enter_initialisation(start)
    component.exit_initialisation()
    result = CaptureLoop(component, CapturePlan(2.0, 12.0, start=start), Progress()).run()
    assert result.error is None
    assert result.located == pytest.approx(7.1234567, abs=1e-6)
    assert result.recorder["time"].tolist() == [0.0, 2.0, 4.0, 6.0, result.located, 8.0, 10.0, 12.0]
    assert component.calls[0][0] == start
    expected = [
        extremes(a, b)[1] for a, b in zip(result.recorder["time"][:-1], result.recorder["time"][1:], strict=True)
    ]
    for name in PEAKS:
        assert result.recorder[name][1:] == pytest.approx(expected, rel=1e-9)


def table_2(macro_step: float, duration: float = 8000.0, start: float = 0.0) -> PhaseResult:
    component = KernelComponent("removal", "removal", {"reel": "locked", "thrust": "along_track"})
    return tow(component, macro_step, duration, start)


def test_every_tug_of_table_2_whatever_the_macro_step() -> None:
    """38 tugs, most of them in an hour, the ring holds 16: the same bits at every macro step and start."""
    runs = [table_2(step) for step in (1.0, 60.0, 3600.0, 8000.0)] + [table_2(60.0, start=100.0)]
    logs = [run.tugs for run in runs]
    assert [(log.count, log.missed, len(log.rows)) for log in logs] == [(38, 0, 38)] * 5
    assert all(log.rows == logs[0].rows for log in logs)
    # rows stay one per macro step, and their peaks are those of the short steps in them
    short, long = runs[1].recorder, runs[2].recorder
    assert long["time"].tolist() == [0.0, 3600.0, 7200.0, 8000.0]
    assert long["tether.tension_peak"][1] == pytest.approx(short["tether.tension_peak"][1:61].max(), rel=1e-12)
    assert long["separation"][1] == pytest.approx(short["separation"][60], rel=1e-12)
    lost = KernelComponent("removal", "removal", {"reel": "locked", "thrust": "along_track"})
    lost.can_save = False
    log = tow(lost, 8000.0, 8000.0).tugs
    assert (log.count, log.missed) == (38, 22)


def test_a_day_in_one_step() -> None:
    assert table_2(86400.0, 86400.0).tugs.rows == table_2(60.0, 86400.0).tugs.rows


TUGS = [(t, 5.0, 0.01) for t in (1.0, 2.0, 2.5, 3.0, 7.0, 7.1, 7.2, 7.3, 7.4, 19.0)]


def test_tugs_of_a_ring_of_two() -> None:
    component = MockRemoval(tugs=TUGS)
    result = tow(component, 10.0, 20.0)
    assert [result.tugs.rows[n] for n in sorted(result.tugs.rows)] == TUGS
    assert len(result.recorder) == 3


def test_a_component_that_does_not_go_back() -> None:
    class Forgetful(MockRemoval):
        def restore(self, key: str = "") -> None:
            pass

    result = tow(Forgetful(tugs=TUGS), 10.0, 20.0)
    assert isinstance(result.error, FmuError)
    assert "does not restore" in str(result.error)


def test_moving_inputs_go_on_moving_in_the_pieces() -> None:
    class Moving(MockRemoval):
        def __init__(self) -> None:
            super().__init__(tugs=TUGS)
            self.declare(["reel.tension"], "input")
            self.rate = 0.0

        def set_rates(self, rates: dict[str, float]) -> None:
            self.rate = rates["reel.tension"]

        def step(self, time: float, size: float) -> None:
            self.values["reel.tension"] += self.rate * size
            self.rate = 0.0
            super().step(time, size)

    component = Moving()
    held = Held(component)
    held.enter_initialisation(0.0)
    held.exit_initialisation()
    held.set_rates({"reel.tension": 0.5})
    held.step(0.0, 10.0)
    assert len(held.tugs.rows) == 9
    assert len(component.calls) > 9
    assert component.values["reel.tension"] == 5.0


@pytest.mark.slow
@pytest.mark.parametrize("coupling", [{}, {"extrapolation": "linear", "order": ("controller", "removal")}])
def test_peaks_of_a_removal_beside_its_controller(coupling: dict[str, object]) -> None:
    """One row of 60 s tells what six rows of 10 s tell, when the coupling steps are the same."""

    def fly(macro_step: float) -> PhaseResult:
        removal = KernelComponent("removal", "removal", {"reel": "commanded"})
        whole = Coupled("removal", [removal, Law()], CONNECTIONS, Coupling(step=10.0, **coupling))
        whole.set({"start.separation": 13.0})
        return tow(whole, macro_step, 600.0)

    long, short = fly(60.0).recorder, fly(10.0).recorder
    for name, choose in (("tether.tension_peak", np.max), ("tether.tension_least", np.min)):
        parts: Callable[..., np.ndarray] = choose
        assert long[name][1:].tolist() == parts(short[name][1:].reshape(-1, 6), axis=1).tolist()
        # also at the ends of a row, where the controller has just set another tension
        ends = np.array([long[name][1:], long["tether.tension"][1:], long["tether.tension"][:-1]])
        assert parts(ends, axis=0) == pytest.approx(long[name][1:], rel=1e-12)
    assert (long["tether.tension_peak"][1:] >= long["tether.tension"][:-1] * (1.0 - 1e-9)).all()
    assert (long["tether.tension_peak"][1:] > short["tether.tension_peak"][6::6]).any()


def test_tugs_of_steps_that_were_rolled_back_are_forgotten() -> None:
    """Also how one of them had grown, and though the tugs after going back are others."""
    component = MockRemoval(tugs=[(1.0, 6.0, 0.01), (4.0, 5.0, 0.02)], grows=2.0)
    held = Held(component)
    held.enter_initialisation(0.0)
    held.exit_initialisation()
    held.step(0.0, 2.0)
    assert held.tugs.rows == {1: (1.0, 3.0, 0.01)}
    held.save("then")
    held.step(2.0, 4.0)
    assert held.tugs.rows == {1: (1.0, 6.0, 0.01), 2: (4.0, 5.0, 0.02)}
    held.restore("then")
    assert (held.tugs.count, held.tugs.rows) == (1, {1: (1.0, 3.0, 0.01)})
    component.tugs[1] = (3.0, 4.0, 0.03)
    held.step(2.0, 4.0)
    assert held.tugs.rows == {1: (1.0, 6.0, 0.01), 2: (3.0, 4.0, 0.03)}


def test_steps_before_the_one_that_overflows_are_taken_again_as_they_were() -> None:
    component = MockRemoval(tugs=TUGS)
    held = Held(component)
    held.enter_initialisation(0.0)
    held.exit_initialisation()
    for begin, size in ((0.0, 0.5), (0.5, 0.5), (1.0, 9.0)):
        held.step(begin, size)
    held.settle()
    assert component.calls[3:5] == [(0.0, 0.5), (0.5, 0.5)]
    assert held.tugs.rows == dict(enumerate(TUGS[:9], start=1))


def test_a_step_that_overflows_after_going_back() -> None:
    """What was rolled back is not taken again."""
    component = MockRemoval(tugs=TUGS)
    held = Held(component)
    held.enter_initialisation(0.0)
    held.exit_initialisation()
    held.step(0.0, 0.5)
    held.save("then")
    held.step(0.5, 0.5)
    held.restore("then")
    held.step(0.5, 9.5)
    held.settle()
    assert held.tugs.rows == dict(enumerate(TUGS[:9], start=1))
    assert component.calls.count((0.5, 0.5)) == 1
