"""The loop between cases and rows: what is in the store is not run again, and what is run is in the store at once.

Who needs many rows gives the cases, from a list or from a generator that makes them as they are wanted. Who needs one
row to decide on the next case, as in finding a root, asks for it alone.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, wait
from typing import Any, Protocol

from dcone_cosim import interrupts
from dcone_cosim.cases.rows import FAULT, Row, lost
from dcone_cosim.cases.work import run_case
from dcone_cosim.cases.workers import WorkerDied
from dcone_cosim.errors import FAILED_AFTER, Interrupted

LOOK = 0.2
"""How often to see whether a signal has come [s]."""
CROWD = 64
"""Cases that are out at once from which on rows are kept together: each is on the disk within `LOOK`."""
AHEAD = 3
"""Tasks that are out for each worker."""
MOST_TOGETHER = 50
"""Cases of a task: what a worker that dies leaves undone stays small."""
TASKS = 100.0
"""Tasks a second [1/s] that one scheduler hands out with ease: shorter cases go out several to a task."""


class Keyed(Protocol):
    """A case, whatever else it is: all that the loop asks of it is the hash under which its row is kept."""

    @property
    def key(self) -> str: ...


class Rows(Protocol):
    """Where rows are kept, by the hash of their case: a `Store`, or `Memory`."""

    def get(self, key: str) -> Row | None: ...
    def put_all(self, rows: Sequence[Row]) -> None: ...


class Memory:
    """Rows that nobody asks for once this process has ended."""

    def __init__(self) -> None:
        self._rows: dict[str, Row] = {}

    def get(self, key: str) -> Row | None:
        return self._rows.get(key)

    def put_all(self, rows: Sequence[Row]) -> None:
        self._rows |= {row.key: row for row in rows}


class Runner:
    """Runs cases that the store has no row of.

    executor    anything with the `submit` of `concurrent.futures`: `Workers`, or a client of a cluster
    ahead       cases that are submitted at a time: enough that no worker waits for its next
    work        what makes a row of a case, a function of a module
    idle        called now and then while rows are waited for
    cost        what a case is expected to take, 0 where that is not known [s]

    Many cases at once, or short ones, go out several to a task, which a worker does one after the other; where one dies
    on it, they go out again one by one.
    """

    def __init__(
        self,
        store: Rows,
        executor: Executor,
        ahead: int,
        work: Callable[[Any], Row] = run_case,
        idle: Callable[[], object] = lambda: None,
        cost: float = 0.0,
    ) -> None:
        self._store, self._executor, self._ahead, self._work, self._idle = store, executor, ahead, work, idle
        self._bundles = Bundles(ahead, cost)

    def row(self, case: Keyed) -> Row:
        """The row of one case."""
        return next(row for row, _ in self.rows([case]))

    def rows(self, cases: Iterable[Keyed]) -> Iterator[tuple[Row, bool]]:
        """The row of each case, as they come, and whether it was there before; a case that comes twice has one.

        Raises `Interrupted` at a signal: what is in the store stays, what is being run is given up.
        """
        going: dict[Future[Any], list[Keyed]] = {}
        seen: set[str] = set()
        task: list[Keyed] = []
        for case in cases:
            self._heed()
            if case.key in seen:
                continue
            seen.add(case.key)
            there = self._store.get(case.key)
            if there is not None and there.lasting:
                yield there, True
                continue
            task.append(case)
            if len(task) >= self._bundles.together:
                self._give(task, going)
                task = []
            while len(going) >= self._ahead:
                yield from self._finished(going)
        self._give(task, going)
        while going:
            yield from self._finished(going)

    def _give(self, task: list[Keyed], going: dict[Future[Any], list[Keyed]]) -> None:
        if len(task) == 1:
            going[self._executor.submit(self._work, task[0])] = task
        elif task:
            going[self._executor.submit(several, (self._work, task))] = task

    def _finished(self, going: dict[Future[Any], list[Keyed]]) -> Iterator[tuple[Row, bool]]:
        """Keep what is done by now, after a short wait at most."""
        self._heed()
        done, _ = wait(going, LOOK, FIRST_COMPLETED)
        if done and len(going) >= CROWD:
            time.sleep(LOOK)
            done = {future for future in going if future.done()}
        rows: list[Row] = []
        for future in done:
            cases = going.pop(future)
            if len(cases) > 1 and isinstance(future.exception(), WorkerDied):
                for case in cases:
                    self._give([case], going)
                continue
            rows += _rows_of(future, [case.key for case in cases])
        self._bundles.look(rows)
        self._store.put_all(rows)
        yield from ((row, False) for row in rows)
        self._idle()

    @staticmethod
    def _heed() -> None:
        if interrupts.noted():
            raise Interrupted(f"interrupted by {interrupts.noted()}")


class Bundles:
    """How many cases go to a task: so many that those that are out at once do not come faster than `TASKS`.

    ahead    tasks that are out at once
    cost     what a case is expected to take, 0 where that is not known [s]

    Checked  tests/cases/test_runner.py
    """

    def __init__(self, ahead: int, cost: float = 0.0) -> None:
        self.together, self._ahead = 1, ahead
        self._cpu, self._cases = cost, int(cost > 0.0)
        self.look(())

    def look(self, rows: Sequence[Row]) -> None:
        """Take in what cases have cost."""
        known = [row.timings["cpu"] for row in rows if "cpu" in row.timings]
        self._cpu, self._cases = self._cpu + sum(known), self._cases + len(known)
        if self._cpu > 0.0:
            workers = self._ahead / AHEAD
            self.together = max(1, min(MOST_TOGETHER, math.ceil(workers * self._cases / (TASKS * self._cpu))))


def several(task: tuple[Callable[[Any], Row], Sequence[Any]]) -> list[Row]:
    """The rows of the cases of a task, one after the other; a fault of one is its row."""
    work, cases = task
    rows = []
    for case in cases:
        try:
            rows.append(work(case))
        except Exception as error:
            rows.append(_fault(case.key, error))
    return rows


def _rows_of(future: Future[Any], keys: Sequence[str]) -> list[Row]:
    """What came of the cases of a task, also when its worker died or its work went wrong."""
    try:
        found = future.result()
        return found if isinstance(found, list) else [found]
    except WorkerDied as error:
        return [lost(key, str(error)) for key in keys]
    except CancelledError:
        return [lost(key, "was sent home") for key in keys]
    except Exception as error:
        return [_fault(key, error) for key in keys]


def _fault(key: str, error: Exception) -> Row:
    return Row(key, FAULT, FAILED_AFTER, f"a fault of this program: {error}")
