"""The loop: what a campaign comes to hangs on the rows in the order of their numbers, whoever ran them and when."""

from __future__ import annotations

import errno
import itertools
import os
import random
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dcone_cosim.campaign.cluster import DEATHS, Cluster, GivenUp, Persistent, SchedulerGone, _Dask
from dcone_cosim.campaign.commands import campaign
from dcone_cosim.campaign.engine import Engine
from dcone_cosim.campaign.inputs import Group as InputGroup
from dcone_cosim.campaign.inputs import Input, Inputs
from dcone_cosim.campaign.sampling import monte_carlo
from dcone_cosim.campaign.shots import Ground, Shot
from dcone_cosim.campaign.spec import Spec
from dcone_cosim.cases.rows import LOST, Row, lost, refused
from dcone_cosim.cases.runner import Memory
from dcone_cosim.cases.store import Store
from dcone_cosim.cases.workers import WorkerDied, Workers
from dcone_cosim.errors import InputError
from dcone_cosim.progress import Progress
from tests.campaign import fakes
from tests.campaign.conftest import spec_of

LIMIT = 'success = { figure = "removal.value", above = 0.1 }\n'
JUST = '[[dispersion]]\nkey = "removal.thrust.level"\ndistribution = "normal"\ndeviation = "5 %"\n'
UNTIL = 'title = "t"\nscene = "table2-deorbit"\nseed = 4\nuntil = "95 % within 5 %"\n'
ONE = Inputs((Input("value", lambda u: u),), (InputGroup((0,), lambda values: (f"removal.value={values[0]!r}",)),))
"""One number that is its own coordinate: it is above 0.1 with a probability of 0.9."""


class Shuffled(Executor):
    """Ends what it is given in an order of its own."""

    def __init__(self, seed: int) -> None:
        self._random, self._waiting = random.Random(seed), list[tuple[Future[Any], Any]]()

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        self._waiting.append((future, fn(*args)))
        if len(self._waiting) >= 7:
            self.flush()
        return future

    def flush(self) -> None:
        self._random.shuffle(self._waiting)
        while self._waiting:
            future, result = self._waiting.pop()
            future.set_result(result)


def points() -> Iterator[Any]:
    return (monte_carlo(4, number, 1) for number in itertools.count(1))


def engine(spec: Spec, executor: Executor, ahead: int, store: Any = None, work: Any = fakes.row_of) -> Engine:
    cluster = Cluster(executor, max(1, ahead // 3), "here")
    ground = Ground("", "", "", "")
    return Engine(spec, ONE, ground, "identity", store or Memory(), cluster, Progress(), work)


def test_it_ends_at_the_same_case_whoever_ran_it() -> None:
    spec = spec_of(LIMIT + JUST, UNTIL)
    ends = set()
    for workers in (1, 3):
        with ThreadPoolExecutor(workers) as pool:
            made = engine(spec, pool, 3 * workers).run(points(), None)
        ends.add((len(made), tuple(one.row.figures["removal.value"] for one in made)))
    for seed in range(3):
        shuffled = Shuffled(seed)
        one = engine(spec, shuffled, 9)
        one._cluster.check = shuffled.flush  # the last few, for which nobody waits in vain
        made = one.run(points(), None)
        ends.add((len(made), tuple(one.row.figures["removal.value"] for one in made)))
    ((count, values),) = ends
    assert 100 <= count <= 250
    assert values == tuple(float(monte_carlo(4, number, 1)[0]) for number in range(1, count + 1))


def test_it_ends_where_no_case_answers() -> None:
    with ThreadPoolExecutor(1) as pool:
        made = engine(spec_of(LIMIT + JUST, UNTIL), pool, 3, work=lambda shot: refused(shot.key, "no")).run(
            points(), None
        )
    assert len(made) == 100


def test_what_is_there_is_not_run_again() -> None:
    spec, store, ran = spec_of(LIMIT + JUST), Memory(), list[int]()

    def work(shot: Shot) -> Row:
        ran.append(shot.number)
        return fakes.row_of(shot)

    with ThreadPoolExecutor(2) as pool:
        first = engine(spec, pool, 6, store, work).run(points(), 10)
        again = engine(spec, pool, 6, store, work).run(points(), 25)
    assert again[:10] == first
    assert sorted(ran) == list(range(1, 26))
    with ThreadPoolExecutor(2) as pool:
        one = engine(spec, pool, 6, store, work)
        assert [made.number for made in one.batch([np.array([0.2]), np.array([0.7])])] == [1, 2]
        assert [made.number for made in one.batch([np.array([0.2])])] == [3]
    assert len(ran) == 27, "0.2 comes twice and is run once"


def test_the_same_values_twice_are_two_cases_and_one_run() -> None:
    with ThreadPoolExecutor(1) as pool:
        made = engine(spec_of(LIMIT + JUST), pool, 3).run(iter([np.array([0.3])] * 4), 4)
    assert [one.number for one in made] == [1, 2, 3, 4]
    assert len({one.row.key for one in made}) == 1


def test_a_case_is_given_to_another_worker() -> None:
    class Dying(Executor):
        def __init__(self, deaths: int) -> None:
            self.left, self.asked = deaths, 0

        def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
            future: Future[Any] = Future()
            self.asked += 1
            self.left -= 1
            if self.left >= 0:
                future.set_exception(WorkerDied("was ended by SIGKILL"))
            else:
                future.set_result(fn(*args))
            return future

    assert Persistent(Dying(DEATHS - 1)).submit(abs, -3).result() == 3
    deadly = Dying(10)
    with pytest.raises(WorkerDied):
        Persistent(deadly).submit(abs, -3).result()
    assert deadly.asked == DEATHS


def test_workers_that_die(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each seventh case kills its worker the first time: the rows are those of an undisturbed campaign. One that kills
    every worker is a row that says so, and no other case suffers for it."""
    monkeypatch.setenv(fakes.DEADLY, str(tmp_path))
    spec = spec_of(LIMIT + JUST)
    with Workers(2) as workers:
        made = engine(spec, Persistent(workers), 6, work=fakes.dies_once).run(points(), 12)
    assert len(list(tmp_path.iterdir())) == 2
    with ThreadPoolExecutor(1) as pool:
        assert made == engine(spec, pool, 3).run(points(), 12)
    with Workers(2) as workers:
        made = engine(spec, Persistent(workers), 6, work=fakes.always_dies).run(points(), 6)
    assert [one.row.status for one in made] == ["completed", "completed", LOST, *["completed"] * 3]
    assert "ended by SIGKILL" in made[2].row.message


def test_a_scheduler_that_is_gone() -> None:
    def check() -> None:
        raise SchedulerGone("the scheduler tcp://x is gone")

    with ThreadPoolExecutor(1) as pool:
        one = engine(spec_of(LIMIT + JUST), pool, 3)
        one._cluster.check = check
        with pytest.raises(SchedulerGone, match=r"is gone with . cases done; they are kept, and the same command"):
            one.run(points(), 10)


def test_what_is_told_on_the_way() -> None:
    with ThreadPoolExecutor(1) as pool:
        one = engine(spec_of(LIMIT + JUST), pool, 3)
        one.run(points(), 40)
    assert "40 of 40" in one.tally.told()
    assert "40 completed; 0.9" in one.tally.told()
    one.tally.count(lost("k", "died"), False)
    assert "1 lost" in one.tally.told()


class _Answer:
    """A future of dask that has come to an end."""

    def __init__(self, status: str, error: Exception | None) -> None:
        self.status, self._error = status, error

    def result(self) -> int:
        if self._error is not None:
            raise self._error
        return 3

    def add_done_callback(self, call: Callable[[Any], object]) -> None:
        call(self)


class _Client:
    def __init__(self, status: str, answers: list[_Answer]) -> None:
        self.status, self._answers = status, answers

    def submit(self, *arguments: Any, **more: Any) -> _Answer:
        return self._answers.pop(0)


def test_what_dask_says() -> None:
    """A result that goes with its worker is made again; what has killed many is given up; a scheduler may be gone."""
    distributed = pytest.importorskip("distributed")
    from concurrent.futures import CancelledError

    lost_result = _Answer("lost", CancelledError())
    killed = _Answer("error", distributed.scheduler.KilledWorker("case", None, 3))
    good = _Answer("finished", None)

    def asked(status: str, *answers: _Answer) -> Future[Any]:
        return Persistent(_Dask(_Client(status, list(answers)))).submit(abs, 3)

    assert asked("running", good).result() == 3
    assert asked("running", lost_result, lost_result, good).result() == 3
    for error, future in (
        (WorkerDied, asked("running", *[lost_result] * DEATHS)),
        (GivenUp, asked("running", killed, good)),
        (SchedulerGone, asked("closed", lost_result, good)),
        (ZeroDivisionError, asked("running", _Answer("error", ZeroDivisionError()), good)),
    ):
        assert type(future.exception()) is error


@pytest.mark.parametrize(
    ("address", "said"),
    [
        ("nonsense", "expected processes, or an address such as tcp://host:8786"),
        ("tcp://127.0.0.1", "expected processes, or an address"),
        ("tcp://127.0.0.1:1", "no scheduler there"),
        ("tcp://127.0.0.1:99999", "no scheduler there"),
    ],
)
def test_a_scheduler_that_is_not_there_is_told_before_anything_is_built(
    address: str, said: str, drift: Path, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=said):
        campaign(drift, tmp_path / "out", Progress(), scheduler=address)
    assert not (tmp_path / "out").exists()


def test_a_full_disk_says_that_the_cases_are_kept(drift: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """And the same command goes on once there is room."""
    put, left = Store.put_all, [30]

    def full(self: Store, rows: Any) -> None:
        if left[0] <= 0:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "row")
        left[0] -= len(rows)
        put(self, rows)

    monkeypatch.setattr(Store, "put_all", full)
    with pytest.raises(OSError, match="cases done; they are kept, and the same command goes on") as error:
        campaign(drift, tmp_path / "out", Progress(), scheduler="processes", jobs=1, with_figures=False)
    assert error.value.errno == errno.ENOSPC
    monkeypatch.undo()
    done = campaign(drift, tmp_path / "out", Progress(), scheduler="processes", jobs=1, with_figures=False)
    assert done.content["cases"] == 60
