"""The loop between cases and rows: what is in the store is not run again, and what is run is in the store at once.

Who needs many rows gives the cases, from a list or from a generator that makes them as they are wanted. Who needs one
row to decide on the next case, as in finding a root, asks for it alone.
"""

from __future__ import annotations

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
    """

    def __init__(
        self,
        store: Rows,
        executor: Executor,
        ahead: int,
        work: Callable[[Any], Row] = run_case,
        idle: Callable[[], object] = lambda: None,
    ) -> None:
        self._store, self._executor, self._ahead, self._work, self._idle = store, executor, ahead, work, idle

    def row(self, case: Keyed) -> Row:
        """The row of one case."""
        return next(row for row, _ in self.rows([case]))

    def rows(self, cases: Iterable[Keyed]) -> Iterator[tuple[Row, bool]]:
        """The row of each case, as they come, and whether it was there before; a case that comes twice has one.

        Raises `Interrupted` at a signal: what is in the store stays, what is being run is given up.
        """
        going: dict[Future[Row], str] = {}
        seen: set[str] = set()
        for case in cases:
            self._heed()
            if case.key in seen:
                continue
            seen.add(case.key)
            there = self._store.get(case.key)
            if there is not None and there.lasting:
                yield there, True
                continue
            going[self._executor.submit(self._work, case)] = case.key
            while len(going) >= self._ahead:
                yield from self._finished(going)
        while going:
            yield from self._finished(going)

    def _finished(self, going: dict[Future[Row], str]) -> Iterator[tuple[Row, bool]]:
        """Keep what is done by now, after a short wait at most."""
        self._heed()
        done, _ = wait(going, LOOK, FIRST_COMPLETED)
        rows = [_row_of(future, going.pop(future)) for future in done]
        self._store.put_all(rows)
        yield from ((row, False) for row in rows)
        self._idle()

    @staticmethod
    def _heed() -> None:
        if interrupts.noted():
            raise Interrupted(f"interrupted by {interrupts.noted()}")


def _row_of(future: Future[Row], key: str) -> Row:
    """What came of a case, also when its worker died or its work went wrong."""
    try:
        return future.result()
    except WorkerDied as error:
        return lost(key, str(error))
    except CancelledError:
        return lost(key, "was sent home")
    except Exception as error:
        return Row(key, FAULT, FAILED_AFTER, f"a fault of this program: {error}")
