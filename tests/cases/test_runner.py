"""The loop between cases and rows: nothing twice, nothing lost, whatever executor stands behind it."""

from __future__ import annotations

import math
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

from dcone_cosim import interrupts
from dcone_cosim.cases import pace
from dcone_cosim.cases.case import Case
from dcone_cosim.cases.pace import Pace
from dcone_cosim.cases.rows import FAULT, LOST, Row
from dcone_cosim.cases.runner import MOST_TOGETHER, TASKS, Bundles, Runner, several
from dcone_cosim.cases.store import Store
from dcone_cosim.cases.workers import WorkerDied, Workers
from dcone_cosim.errors import FAILED_AFTER, Interrupted
from tests.cases import fakes
from tests.cases.test_store import STUDY

Cases = Callable[[int], list[Case]]


class Here(Executor):
    """Does what it is given at once, and counts it."""

    def __init__(self) -> None:
        self.done: list[int | None] = []

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        self.done.append(args[0].seed)
        try:
            future.set_result(fn(*args))
        except Exception as error:
            future.set_exception(error)
        return future


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    with Store(tmp_path / "out", STUDY) as one:
        yield one


def run(store: Store, executor: Executor, cases: Any, work: Callable[[Case], Row] = fakes.row_of) -> dict[str, Row]:
    return {row.key: row for row, _ in Runner(store, executor, 4, work).rows(cases)}


def figures(rows: dict[str, Row]) -> dict[str, Any]:
    return {key: (row.status, dict(row.figures)) for key, row in rows.items()}


def test_nothing_is_run_twice(store: Store, cases: Cases) -> None:
    here = Here()
    first = run(store, here, cases(5))
    assert here.done == [0, 1, 2, 3, 4]
    again = run(store, here, [*cases(7), *cases(3)])
    assert here.done == [0, 1, 2, 3, 4, 5, 6]
    assert again.items() >= first.items()
    assert len(list(Runner(store, here, 4, fakes.row_of).rows([*cases(3), *cases(3)]))) == 3


def test_one_row_at_a_time(store: Store, cases: Cases) -> None:
    """As root finding asks for them: the next case hangs on the row before."""
    here, many = Here(), cases(20)
    runner = Runner(store, here, 4, fakes.row_of)
    low, high = 0, 19
    while high - low > 1:
        middle = (low + high) // 2
        value = runner.row(many[middle]).figures["removal.square"]
        assert isinstance(value, float)
        low, high = (middle, high) if value < 20.0 else (low, middle)
    assert (low, high) == (11, 12), "121 / 7 < 20 < 144 / 7"
    assert len(here.done) == 4


def test_cases_are_made_as_they_are_wanted(store: Store, cases: Cases) -> None:
    """A campaign of a million cases is never a list."""
    made = 0

    def endless() -> Iterator[Case]:
        nonlocal made
        for case in cases(100):
            made += 1
            yield case

    rows = Runner(store, Here(), 4, fakes.row_of).rows(endless())
    for _ in range(10):
        next(rows)
    assert made <= 16


@pytest.mark.parametrize("executor", [lambda: Here(), lambda: ThreadPoolExecutor(3), lambda: Workers(2)])
def test_any_executor_gives_the_same_rows(store: Store, cases: Cases, executor: Callable[[], Executor]) -> None:
    """What a cluster's client has to offer is what `concurrent.futures` says."""
    with executor() as behind:
        rows = run(store, behind, cases(9))
    assert figures(rows) == figures({case.key: fakes.row_of(case) for case in cases(9)})
    assert [store.get(case.key) for case in cases(9)] == [rows[case.key] for case in cases(9)]


@pytest.mark.parametrize(
    ("work", "status", "told"),
    [
        (fakes.crashes, LOST, "its worker was ended by SIGKILL; its last words: a bad pointer; the case is run again"),
        (fakes.raises, FAULT, "ZeroDivisionError: of all things"),
    ],
)
def test_a_case_that_is_lost_is_a_row_and_run_again(
    store: Store, cases: Cases, work: Callable[[Case], Row], status: str, told: str
) -> None:
    with Workers(2) as workers:
        rows = run(store, workers, cases(6), work)
    bad = rows[cases(6)[fakes.CRASHING].key]
    assert (bad.status, bad.exit_code) == (status, FAILED_AFTER)
    assert told in bad.message
    assert sum(row.succeeded for row in rows.values()) == 5
    here = Here()
    undisturbed = run(store, here, cases(6))
    assert here.done == [fakes.CRASHING]
    assert figures(undisturbed) == figures({case.key: fakes.row_of(case) for case in cases(6)})


def test_a_failure_that_would_come_again_is_not_run_again(store: Store, cases: Cases) -> None:
    def fails(case: Case) -> Row:
        return Row(case.key, "capture failed", 3, "missed")

    here = Here()
    assert run(store, here, cases(2), fails) == run(store, here, cases(2))
    assert here.done == [0, 1]


def test_a_signal_stops_it_and_keeps_what_is_there(store: Store, cases: Cases, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = Runner(store, Here(), 1, fakes.row_of).rows(cases(5))
    first = [next(rows)[0], next(rows)[0]]
    monkeypatch.setattr(interrupts, "_noted", signal.SIGINT)
    with pytest.raises(Interrupted, match=r"interrupted by Ctrl-C \(SIGINT\)"):
        next(rows)
    assert [store.get(row.key) for row in first] == first


def test_a_future_that_was_given_up_is_lost(store: Store, cases: Cases) -> None:
    class Away(Here):
        def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
            future: Future[Any] = Future()
            if args[0].seed:
                future.cancel()
                future.set_running_or_notify_cancel()
            else:
                future.set_exception(WorkerDied("was eaten"))
            return future

    told = {row.message.partition(";")[0] for row in run(store, Away(), cases(2)).values()}
    assert told == {"its worker was eaten", "its worker was sent home"}


class TestPace:
    def at(self, monkeypatch: pytest.MonkeyPatch, time: float) -> None:
        monkeypatch.setattr(pace.clock, "perf_counter", lambda: time)

    def test_rate_and_time_to_go(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """What was there before says nothing of how fast cases are run."""
        self.at(monkeypatch, 100.0)
        one = Pace(20)
        assert one.told() == "0 of 20"
        for number in range(8):
            one.count(number != 7, found=number < 4)
        self.at(monkeypatch, 102.0)
        assert one.rate == 2.0
        assert one.told() == "8 of 20, 2 per s, 6 s to go, 4 of them there before, 1 failed"
        self.at(monkeypatch, 500.0)
        assert one.told().startswith("8 of 20, 0.6 per min, 20 min to go")

    @pytest.mark.parametrize(
        ("seconds", "told"),
        [(0.4, "0 s"), (99.4, "99 s"), (300.0, "5 min"), (9000.0, "2.5 h"), (864000.0, "10.0 days")],
    )
    def test_words(self, seconds: float, told: str) -> None:
        assert pace.spoken(seconds) == told


@pytest.mark.parametrize(
    ("ahead", "cost", "together"),
    [(6, 1.6, 1), (3000, 1.6, 7), (3000, 1000.0, 1), (6, 1e-3, 20), (6, 1e-6, MOST_TOGETHER), (6, 0.0, 1)],
)
def test_how_many_cases_go_to_a_task(ahead: int, cost: float, together: int) -> None:
    """So many that a third of `ahead` workers ask for no more than `TASKS` a second; what cases really take counts."""
    found = Bundles(ahead, cost)
    assert found.together == together
    found.look([Row("k", "completed", 0, "", timings={"cpu": 6.0})] * 1000)
    assert found.together == max(1, math.ceil(ahead / 3 / (TASKS * 6.0)))


def test_cases_of_a_task_whose_worker_died_go_out_alone(store: Store, cases: Cases) -> None:
    """None is lost, none is counted twice, and one that goes wrong is a row among the others."""

    class Dies(Here):
        def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
            future: Future[Any] = Future()
            if fn is several:
                self.done.append(len(args[0][1]))
                future.set_exception(WorkerDied("died"))
                return future
            return super().submit(fn, *args, **kwargs)

    dies, wanted = Dies(), cases(20)
    rows = [row for row, _ in Runner(store, dies, 4, fakes.row_of, cost=1e-3).rows(wanted)]
    assert sorted(row.key for row in rows) == sorted(case.key for case in wanted)
    assert all(row.status == "completed" for row in rows)
    assert dies.done[0] == 14

    def wrong(case: Case) -> Row:
        if case.seed == 3:
            raise ValueError("three")
        return fakes.row_of(case)

    found = several((wrong, wanted))
    assert [row.status == FAULT for row in found] == [case.seed == 3 for case in wanted]
