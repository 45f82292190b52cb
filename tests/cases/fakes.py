"""Work for workers that needs no FMU: functions of a module, as a worker asks for them."""

from __future__ import annotations

import os
import signal
import sys
import time
from pathlib import Path

from dcone_cosim.cases.case import Case
from dcone_cosim.cases.rows import Row

CRASHING = 3
"""Seed of the case on which a worker dies."""


def row_of(case: Case) -> Row:
    """A row that follows from the seed alone."""
    assert case.seed is not None
    figures = {"removal.square": case.seed**2 / 7.0, "removal.outcome": "odd" if case.seed % 2 else "even"}
    return Row(case.key, "completed", 0, "", figures, {"removal.square": "m2"}, {"cpu": time.process_time()})


def crashes(case: Case) -> Row:
    """On one of the cases a signal that no process survives."""
    if case.seed == CRASHING:
        print("a bad pointer", file=sys.stderr, flush=True)
        os.kill(os.getpid(), signal.SIGKILL)
    return row_of(case)


def leaves(case: Case) -> Row:
    """An exit from within, as an FMU may call it."""
    if case.seed == CRASHING:
        os._exit(0)
    return row_of(case)


def raises(case: Case) -> Row:
    if case.seed == CRASHING:
        raise ZeroDivisionError("of all things")
    return row_of(case)


def prints(case: Case) -> Row:
    """What a binary writes to its first stream is not for us."""
    os.write(1, b"noise\n")
    return row_of(case)


def slow(case: Case) -> Row:
    time.sleep(0.05)
    return row_of(case)


def endless(case: Case) -> Row:
    time.sleep(600.0)
    return row_of(case)


def process(case: Case) -> int:
    """Which process it is done in."""
    time.sleep(0.05)
    return os.getpid()


def threads(case: Case) -> str:
    return os.environ["OMP_NUM_THREADS"]


def told(folder: str) -> None:
    """Say in a file which process this is, and hang."""
    (Path(folder) / f"{os.getpid()}").touch()
    time.sleep(600.0)
