"""What runs the cases: dask, here or elsewhere, or plain processes. Each is an executor of `concurrent.futures`.

    a local cluster     of dask, a process per core, where the extra `campaign` is installed: the default
    tcp://...           a scheduler of dask that is there already, with its workers
    processes           `cases.workers`; also the default without dask

The rows are the same with each. A worker that dies takes no case with it: the case is given to another one, and only
one on which `DEATHS` workers have died is a row that says so. dask is imported only here, and only when it is used.
"""

from __future__ import annotations

import re
import socket
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from contextlib import contextmanager, suppress
from importlib import import_module
from importlib.util import find_spec
from typing import Any, TypeVar

from dcone_cosim.cases.runner import AHEAD
from dcone_cosim.cases.workers import ONE_CORE, WorkerDied, Workers, cores
from dcone_cosim.errors import DconeError, InputError

T = TypeVar("T")
PROCESSES = "processes"
DEATHS = 3
"""Workers that may die on a case."""
RUNNING = ("running", "newly-created")
"""What a client of dask says of itself while its scheduler is there."""
ADDRESS = re.compile(r"(?:tcp|tls)://(\[[0-9a-fA-F:.]+\]|[^:/\s]+):(\d{1,5})")
KNOCK = 5.0
"""How long to wait for somebody at its address [s]."""
PATIENCE = "20 s"
"""How long to wait for a scheduler."""


class SchedulerGone(DconeError):
    """The scheduler of the cluster has ended or cannot be reached."""

    exit_code = 6


class GivenUp(WorkerDied):
    """So many workers have died on this that no other is tried."""


class Cluster:
    """What runs cases, and how many at a time."""

    def __init__(self, executor: Executor, count: int, what: str, check: Callable[[], None] = lambda: None) -> None:
        self.executor, self.count, self.what, self.check = executor, count, what, check

    @property
    def ahead(self) -> int:
        return AHEAD * self.count


class Persistent(Executor):
    """An executor that gives a task again to another worker when one has died on it."""

    def __init__(self, behind: Executor, deaths: int = DEATHS) -> None:
        self._behind, self._deaths = behind, deaths

    def submit(self, fn: Callable[..., T], /, *args: Any, **kwargs: Any) -> Future[T]:
        outer: Future[T] = Future()
        self._give(outer, 1, fn, args, kwargs)
        return outer

    def _give(self, outer: Future[T], attempt: int, fn: Callable[..., T], args: Any, kwargs: Any) -> None:
        def done(inner: Future[T]) -> None:
            try:
                result = inner.result()
            except GivenUp as error:
                outer.set_exception(error)
            except WorkerDied as error:
                if attempt < self._deaths:
                    with suppress(RuntimeError):  # all are being sent home
                        self._give(outer, attempt + 1, fn, args, kwargs)
                        return
                outer.set_exception(error)
            except BaseException as error:
                outer.set_exception(error)
            else:
                outer.set_result(result)

        self._behind.submit(fn, *args, **kwargs).add_done_callback(done)


class _Dask(Executor):
    """A client of dask as an executor; a task is under a name of its own, so that none is taken for another."""

    def __init__(self, client: Any) -> None:
        self._client, self._number = client, 0

    def submit(self, fn: Callable[..., T], /, *args: Any, **kwargs: Any) -> Future[T]:
        outer: Future[T] = Future()
        outer.set_running_or_notify_cancel()
        self._number += 1
        inner = self._client.submit(fn, *args, key=f"case-{id(self)}-{self._number}", pure=False, **kwargs)

        def done(finished: Any) -> None:
            """Whatever happens, `outer` comes to an end: a result may be lost with its worker after it was there."""
            try:
                result = finished.result()
            except Exception as error:
                outer.set_exception(self._said(finished, error))
            else:
                outer.set_result(result)

        inner.add_done_callback(done)
        return outer

    def _said(self, finished: Any, error: Exception) -> Exception:
        """What went wrong, in our terms."""
        from distributed.scheduler import KilledWorker

        if isinstance(error, KilledWorker):
            return GivenUp("died on it, and so did those that it was given to after it")
        if self._client.status not in RUNNING:
            return SchedulerGone("the scheduler is gone")
        return error if finished.status == "error" else WorkerDied("died with its result")


def has_dask() -> bool:
    return find_spec("distributed") is not None


def check(scheduler: str | None) -> None:
    """`InputError` for an address at which nobody answers, before anything is built.

    Checked  tests/campaign/test_engine.py
    """
    if not scheduler or scheduler == PROCESSES:
        return
    if not has_dask():
        raise InputError(f"--scheduler {scheduler}: needs dask; pip install 'dcone-cosim[campaign]'")
    match = ADDRESS.fullmatch(scheduler)
    if match is None:
        raise InputError(f"--scheduler {scheduler}: expected {PROCESSES}, or an address such as tcp://host:8786")
    try:
        socket.create_connection((match[1].strip("[]"), int(match[2])), timeout=KNOCK).close()
    except (OSError, OverflowError) as error:
        raise InputError(f"--scheduler {scheduler}: no scheduler there: {error}") from None


@contextmanager
def opened(scheduler: str | None, jobs: int | None) -> Iterator[Cluster]:
    """What runs the cases, for as long as they are run.

    scheduler   "" or None for the default, `processes`, or the address of a scheduler
    jobs        processes here, one per core for None; of a scheduler that is there already it is its own affair
    """
    count = jobs or cores()
    if scheduler and scheduler != PROCESSES:
        with _elsewhere(scheduler) as cluster:
            yield cluster
    elif scheduler == PROCESSES or not has_dask():
        with Workers(count) as workers:
            yield Cluster(Persistent(workers), count, f"{count} processes")
    else:
        with _here(count) as cluster:
            yield cluster


@contextmanager
def _here(count: int) -> Iterator[Cluster]:
    import logging

    dask: Any = import_module("dask")
    distributed: Any = import_module("distributed")

    options = {
        "distributed.scheduler.allowed-failures": DEATHS - 1,
        "distributed.worker.memory.target": False,
        "distributed.worker.memory.spill": False,
        "distributed.worker.memory.pause": False,
        "distributed.worker.memory.terminate": False,
        "distributed.nanny.environ": dict(ONE_CORE),
    }
    for name in ("distributed.nanny", "distributed.worker", "distributed.scheduler", "distributed.core"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    with (
        dask.config.set(options),
        distributed.LocalCluster(
            n_workers=count, threads_per_worker=1, processes=True, dashboard_address="127.0.0.1:0", memory_limit=0,
            host="127.0.0.1", silence_logs=logging.CRITICAL,
        ) as local,
        distributed.Client(local, set_as_default=False) as client,
    ):  # fmt: skip
        yield Cluster(
            Persistent(_Dask(client)), count, f"a local cluster of {count} processes", lambda: _need(client, "local")
        )


@contextmanager
def _elsewhere(address: str) -> Iterator[Cluster]:
    distributed: Any = import_module("distributed")

    try:
        client = distributed.Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError) as error:
        raise InputError(f"--scheduler {address}: no scheduler there: {error}") from None
    with client:
        count = sum(client.nthreads().values())
        if not count:
            raise InputError(f"--scheduler {address}: it has no workers yet; start some, and give the command again")
        yield Cluster(Persistent(_Dask(client)), count, f"{count} workers of {address}", lambda: _need(client, address))


def _need(client: Any, address: str) -> None:
    if client.status not in RUNNING:
        raise SchedulerGone(f"the scheduler {address} is gone")
