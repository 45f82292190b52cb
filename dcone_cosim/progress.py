"""How a run shows what it is doing: a bar on a terminal, plain lines elsewhere, or nothing."""

from __future__ import annotations

import sys
import threading
import time as clock
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console

REMINDER = 8.0
"""Wall time between two lines that say that work is still going on [s]: ten at most, on a busy computer too."""
INTERVAL = 0.1
"""Least wall time between two updates of the bar [s]."""
NARROW = 100
"""Columns of a terminal below which the bar itself is left out [1]."""


class Progress:
    """Silent; the others show more."""

    def say(self, text: str) -> None:
        """One line about what begins now."""

    def begin(self, phase: str, start: float, stop: float) -> None:
        """A phase begins, from `start` to at most `stop` [s]."""

    def at(self, time: float) -> None:
        """The phase has reached this simulated time [s]."""

    def end(self) -> None:
        """The phase is over."""

    def count(self, what: str, done: int, total: int, state: str) -> None:
        """So many of `total` are done; `state` tells how fast, and how long the rest will take. May be told often."""

    @contextmanager
    def working(self, what: str) -> Iterator[None]:
        """Around work that may take long and tells nothing of its course, such as building."""
        yield

    def close(self) -> None:
        """Leave the terminal as it was."""


class _Reminder:
    """Says something now and then from a thread of its own, until it is stopped."""

    def __init__(self, remind: Callable[[], None]) -> None:
        self._remind, self._over = remind, threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self) -> None:
        while not self._over.wait(REMINDER):
            self._remind()

    def stop(self) -> None:
        self._over.set()
        self._thread.join()


class Lines(Progress):
    """Plain lines on stderr, for logs: where a phase is, now and then, and how long it took. A log that nobody reads
    any more does not end the run."""

    def __init__(self) -> None:
        self._phase = self._state = ""
        self._said = 0
        self._start = self._stop = self._reached = self._began = 0.0
        self._counted = clock.perf_counter()
        self._reminder: _Reminder | None = None

    def say(self, text: str) -> None:
        self._said += 1
        with suppress(OSError):
            print(text, file=sys.stderr, flush=True)

    @contextmanager
    def working(self, what: str) -> Iterator[None]:
        """A line now and then, once the work has said that it begins."""
        began, before = clock.perf_counter(), self._said

        def remind() -> None:
            if self._said > before:
                self.say(f"still {what}, {clock.perf_counter() - began:.0f} s so far")

        reminder = _Reminder(remind)
        try:
            yield
        finally:
            reminder.stop()

    def begin(self, phase: str, start: float, stop: float) -> None:
        self.close()
        self._phase, self._start, self._stop, self._reached = phase, start, stop, start
        self._began = clock.perf_counter()
        self._reminder = _Reminder(self._where)

    def _where(self) -> None:
        wall = clock.perf_counter() - self._began
        self.say(f"{self._phase}: {self._reached:.6g} of {self._stop:.6g} s, {wall:.0f} s so far")

    def at(self, time: float) -> None:
        self._reached = time

    def count(self, what: str, done: int, total: int, state: str) -> None:
        now = clock.perf_counter()
        if (done == total or now - self._counted >= REMINDER) and state != self._state:
            self._counted, self._state = now, state
            self.say(f"{what}: {state}")

    def end(self) -> None:
        self.close()
        wall = max(clock.perf_counter() - self._began, 1e-9)
        simulated = self._reached - self._start
        self.say(f"{self._phase}: {simulated:.6g} s simulated in {wall:.2f} s, {simulated / wall:.4g} times real time")

    def close(self) -> None:
        if self._reminder is not None:
            self._reminder.stop()
            self._reminder = None


class _Elapsed:
    """Time since it was made, as a text that is formed anew whenever it is shown."""

    def __init__(self) -> None:
        self._began = clock.perf_counter()

    def __format__(self, _: str) -> str:
        return f"{clock.perf_counter() - self._began:.0f} s"


class Bar(Progress):
    """A progress bar with phase, simulated time and speed."""

    def __init__(self, console: Console) -> None:
        from rich.progress import BarColumn, SpinnerColumn, TextColumn
        from rich.progress import Progress as RichProgress
        from rich.table import Column

        self._narrow = console.width < NARROW
        whole = Column(no_wrap=True, overflow="ellipsis")
        self._bar = RichProgress(
            SpinnerColumn(),
            TextColumn("{task.description}", markup=False, table_column=whole),
            *(() if self._narrow else (BarColumn(bar_width=24),)),
            TextColumn("{task.fields[state]}", markup=False, table_column=whole.copy()),
            console=console,
            transient=False,
        )
        self._bar.start()
        self._task: Any = None
        self._waiting: Any = None
        self._start = self._stop = self._began = self._shown = self._last = 0.0

    def say(self, text: str) -> None:
        """May be called from several threads: FMUs are built side by side."""
        self._bar.console.print(text, markup=False, highlight=False)
        if self._waiting is None:
            self._waiting = self._bar.add_task("working", total=None, state=_Elapsed())

    def _stop_waiting(self) -> None:
        if self._waiting is not None:
            self._bar.remove_task(self._waiting)
            self._waiting = None

    def begin(self, phase: str, start: float, stop: float) -> None:
        self._stop_waiting()
        self._start, self._stop = start, stop
        self._began = clock.perf_counter()
        self._shown = 0.0
        self._task = self._bar.add_task(phase, total=max(stop - start, 1e-12), state="")

    def at(self, time: float) -> None:
        now = clock.perf_counter()
        if now - self._shown >= INTERVAL:
            self._shown = now
            self._show(time, now)
        self._last = time

    def count(self, what: str, done: int, total: int, state: str) -> None:
        self._stop_waiting()
        if self._task is None:
            self._task = self._bar.add_task(what, total=total, state="")
        self._bar.update(self._task, completed=done, state=state)

    def _show(self, time: float, now: float) -> None:
        simulated = time - self._start
        speed = simulated / max(now - self._began, 1e-9)
        state = f"{time:,.1f} of {self._stop:,.0f} s, {speed:,.3g} times real time"
        if self._narrow:
            state = f"{time:,.0f} of {self._stop:,.0f} s, {speed:.3g} x"
        self._bar.update(self._task, completed=simulated, state=state)

    def end(self) -> None:
        now = clock.perf_counter()
        self._show(self._last, now)
        self._bar.update(self._task, total=max(self._last - self._start, 1e-12))

    def close(self) -> None:
        self._stop_waiting()
        self._bar.stop()
