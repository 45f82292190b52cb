"""Workers: processes that each do one thing at a time, so that a crash loses that one and names it.

An executor as `concurrent.futures` has them. Its own pool of processes will not do here: when one of them dies, it
gives up all that was to be done and cannot say whose fault it was.
"""

from __future__ import annotations

import os
import pickle
import queue
import subprocess
import threading
from collections.abc import Callable
from concurrent.futures import Executor, Future
from contextlib import suppress
from types import TracebackType
from typing import Any, TypeVar

from dcone_cosim import child

T = TypeVar("T")
CHILD = "dcone_cosim.cases.worker"
ONE_CORE = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
"""Each worker is to have one core."""
LAST_WORDS = 2000
"""Bytes kept of what a worker writes, for when it dies."""
FAREWELL = 5.0
"""How long a worker may take to end, and to be found dead [s]."""


class WorkerDied(Exception):
    """The process that did this died on it; the text says how, in words that follow "its worker"."""


def cores() -> int:
    """How many processes of ours can run at once."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class Workers(Executor):
    """So many processes, each started when it has something to do, and again after it has died.

    Leaving its block by an exception kills them; otherwise what was submitted is done first.
    """

    def __init__(self, count: int) -> None:
        self._tasks: queue.SimpleQueue[tuple[Future[Any], Callable[[Any], Any], Any] | None] = queue.SimpleQueue()
        self._over = False
        self._workers = [_Worker(self._tasks) for _ in range(count)]

    def submit(self, fn: Callable[..., T], /, *args: Any, **kwargs: Any) -> Future[T]:
        """`fn` of one argument, a function of a module, so that a worker can find it."""
        (argument,) = args
        assert not kwargs
        if self._over:
            raise RuntimeError("the workers have been sent home")
        future: Future[T] = Future()
        self._tasks.put((future, fn, argument))
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """No more is taken; `cancel_futures` leaves undone what has not begun."""
        self._over = True
        if cancel_futures:
            with suppress(queue.Empty):
                while (task := self._tasks.get_nowait()) is not None:
                    task[0].cancel()
        for _ in self._workers:
            self._tasks.put(None)
        if wait:
            for worker in self._workers:
                worker.thread.join()

    def kill(self) -> None:
        """End at once, with all that is being done."""
        self.shutdown(wait=False, cancel_futures=True)
        for worker in self._workers:
            worker.kill()
        for worker in self._workers:
            worker.thread.join()

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        if kind is None:
            self.shutdown()
        else:
            self.kill()


class _Worker:
    """One process, and the thread that gives it its tasks."""

    def __init__(self, tasks: queue.SimpleQueue[Any]) -> None:
        self._tasks = tasks
        self._child: subprocess.Popen[bytes] | None = None
        self._killed = False
        self._lock = threading.Lock()
        self._words = b""
        self._listener: threading.Thread | None = None
        self.thread = threading.Thread(target=self._serve, daemon=True)
        self.thread.start()

    def _serve(self) -> None:
        while (task := self._tasks.get()) is not None:
            future, work, argument = task
            if future.set_running_or_notify_cancel():
                try:
                    future.set_result(self._ask(work, argument))
                except BaseException as error:
                    future.set_exception(error)
        self._dismiss()

    def _ask(self, work: Callable[[Any], Any], argument: Any) -> Any:
        process = self._process()
        try:
            pickle.dump((work, argument), process.stdin)  # type: ignore[arg-type]
            process.stdin.flush()  # type: ignore[union-attr]
            done, answer = pickle.load(process.stdout)  # type: ignore[arg-type]
        except (OSError, EOFError, pickle.UnpicklingError):
            raise WorkerDied(self._died(process)) from None
        if not done:
            raise RuntimeError(answer)
        return answer

    def _process(self) -> subprocess.Popen[bytes]:
        with self._lock:
            if self._killed:
                raise WorkerDied("was sent home")
            if self._child is None or self._child.poll() is not None:
                self._child = child.start(CHILD, {name: os.environ.get(name, one) for name, one in ONE_CORE.items()})
                self._listener = threading.Thread(target=self._listen, args=(self._child,), daemon=True)
                self._listener.start()
            return self._child

    def _listen(self, process: subprocess.Popen[bytes]) -> None:
        """Keep the last of what the worker, or an FMU in it, writes."""
        assert process.stderr is not None
        self._words = b""
        with process.stderr as stream:
            while data := os.read(stream.fileno(), 65536):
                self._words = (self._words + data)[-LAST_WORDS:]

    def _died(self, process: subprocess.Popen[bytes]) -> str:
        with suppress(subprocess.TimeoutExpired):
            process.wait(FAREWELL)
        self._end(process)
        if self._listener is not None:
            self._listener.join(FAREWELL)  # something else may still hold the other end
        lines = [line.strip() for line in self._words.decode("utf-8", "replace").splitlines() if line.strip()]
        said = f"; its last words: {'; '.join(lines[-3:])}" if lines else ""
        return child.how_it_ended(process.returncode) + said

    def kill(self) -> None:
        with self._lock:
            self._killed = True
            if self._child is not None:
                child.kill(self._child)

    def _dismiss(self) -> None:
        """Let the process end by itself, so that it clears away what it has unpacked."""
        process = self._child
        if process is None:
            return
        with suppress(OSError, subprocess.TimeoutExpired):
            process.stdin.close()  # type: ignore[union-attr]
            process.wait(FAREWELL)
        self._end(process)

    @staticmethod
    def _end(process: subprocess.Popen[bytes]) -> None:
        child.kill(process)
        process.wait()
        for stream in (process.stdin, process.stdout):
            with suppress(OSError):
                stream.close()  # type: ignore[union-attr]
