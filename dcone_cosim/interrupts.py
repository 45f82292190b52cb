"""Ctrl-C and SIGTERM while a run goes on: it ends at its next communication point, and what it has reached is kept.

Signals belong to the process, and so does what is known here. From the first communication point on, a signal is noted
instead of raised: a call to an FMU is never cut in two, and no callback can swallow the signal. A second one acts as it
does before that point: at once, and nothing is kept.
"""

from __future__ import annotations

import os
import signal
import time as clock
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

from dcone_cosim.errors import DconeError, Interrupted

SIGNALS = (signal.SIGINT, signal.SIGTERM)
NAMES = {signal.SIGINT: "Ctrl-C (SIGINT)", signal.SIGTERM: "SIGTERM"}
STDERR = 2
PATIENCE = 4.0
"""How long after a signal an FMU in a process of its own may still take for its step [s]; then it is killed."""
TOLD = (
    b"dcone: interrupted; what was reached is kept as soon as the step ends (once more: leave at once, keep nothing)\n"
)

_heeding = False
_told = TOLD
_noted: int = 0
_since = 0.0
_before: dict[int, Any] = {}


@contextmanager
def heeded(told: bytes = TOLD) -> Iterator[None]:
    """Around a run and the writing of its results: from `arm` on, the first signal is noted, and `told` is said."""
    global _heeding, _noted, _told
    _heeding, _noted, _told = True, 0, told
    try:
        yield
    finally:
        _disarm()
        _heeding, _noted = False, 0


def arm() -> None:
    """There is something to keep from now on. Nothing happens outside `heeded`, or in a thread, where none can be."""
    if not _heeding or _before or _noted:
        return
    with suppress(ValueError):
        for number in SIGNALS:
            _before[number] = signal.signal(number, _note)


def _disarm() -> None:
    for number in list(_before):
        signal.signal(number, _before.pop(number))


def _note(number: int, _: object) -> None:
    global _noted, _since
    _noted, _since = number, clock.monotonic()
    _disarm()
    with suppress(OSError):
        os.write(STDERR, _told)


def noted() -> str:
    """Name of the signal that has come, "" for none."""
    return NAMES[signal.Signals(_noted)] if _noted else ""


def overdue() -> bool:
    """Whether a signal came so long ago that no call should be waited for any more."""
    return bool(_noted) and clock.monotonic() > _since + PATIENCE


def check(phase: str, time: float) -> None:
    """Raise `Interrupted` if a signal has come before this time of the phase [s]."""
    if _noted:
        raise _interrupted(phase, time)


def instead_of(error: DconeError, phase: str, time: float) -> DconeError:
    """What ended the phase at this time [s]: an FMU that was killed since a signal had come did not fail."""
    return _interrupted(phase, time) if overdue() and not isinstance(error, Interrupted) else error


def _interrupted(phase: str, time: float) -> Interrupted:
    return Interrupted(f"interrupted by {noted()} at t = {time:.6g} s of the {phase}; what was reached is kept")


@contextmanager
def postponed() -> Iterator[None]:
    """Around what must not be cut in two, such as a rename and the note of it: signals come after it."""
    come: list[int] = []
    before: dict[int, Any] = {}
    with suppress(ValueError):  # in a thread, where none comes
        for number in SIGNALS:
            before[number] = signal.signal(number, lambda come_now, _: come.append(come_now))
    try:
        yield
    finally:
        for caught, handler in before.items():
            signal.signal(caught, handler if handler is not None else signal.SIG_DFL)
        if come:
            signal.raise_signal(come[0])
