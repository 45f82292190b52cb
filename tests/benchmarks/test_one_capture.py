"""A hundred tows from one capture, beside three captures: two processes, everything but the start of the program."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import pytest

from dcone_cosim.cases import commands
from dcone_cosim.loading import load
from dcone_cosim.progress import Progress
from dcone_cosim.running import run_once

pytestmark = pytest.mark.bench
TOWS = "removal.tether.diameter=1 mm..2 mm:100"


def seconds(work: Callable[[], object]) -> float:
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin


def test_a_hundred_tows(tmp_path: Path) -> None:
    capture = load("mission", ['phases=["capture"]', "capture.after_capture=0 s"])
    captures = [seconds(lambda: run_once(capture, Progress())) for _ in range(3)]
    for duration in ("1 h", "6 h"):
        settings = (f"removal.duration={duration}",)
        out = tmp_path / duration
        took = seconds(lambda: commands.sweep("mission", (TOWS,), out, Progress(), settings, 2, False))  # noqa: B023
        captures += [seconds(lambda: run_once(capture, Progress())) for _ in range(3)]
        three = 3.0 * sum(captures) / len(captures)
        print(f"\n100 tows of {duration}: {took:.2f} s, {took / three:.2f} times three captures ({three:.2f} s)")
