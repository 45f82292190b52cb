"""A hundred tows from one capture, beside three captures: the commands as they are typed, on two cores."""

from __future__ import annotations

import resource
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytestmark = pytest.mark.bench
TOWS = "removal.tether.diameter=1 mm..2 mm:100"
ROUNDS = 3
ONCE = "handoff.compare_without_recoil=false"
"""Without it `mission` tows twice: as it is, and as if the shot had had no recoil."""


def spent(*command: str) -> tuple[float, float]:
    """Time on the clock, and of all processors [s], of `dcone` with these words."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    begin = time.perf_counter()
    subprocess.run([sys.executable, "-m", "dcone_cosim.cli", *command], check=True, capture_output=True)
    wall = time.perf_counter() - begin
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def capture(folder: Path) -> tuple[float, float]:
    only = ("--set", 'phases=["capture"]', "--set", "capture.after_capture=0 s")
    return spent("run", "mission", *only, "--no-figures", "-o", str(folder))


def tows(folder: Path, *settings: str) -> tuple[float, float]:
    given = [word for setting in settings for word in ("--set", setting)]
    return spent("sweep", "mission", "--vary", TOWS, "--jobs", "2", "--no-figures", "-o", str(folder), *given)


@pytest.mark.parametrize("settings", [("removal.duration=1 h", ONCE), (ONCE,), ()], ids=["1 h", "6 h", "6 h, twice"])
def test_a_hundred_tows(settings: tuple[str, ...], tmp_path: Path) -> None:
    """Rounds alternate, so that what else the machine does falls on both; the least of each counts."""
    capture(tmp_path / "ready")
    captures, sweeps = [], []
    for turn in range(ROUNDS):
        captures += [capture(tmp_path / f"capture-{turn}-{i}") for i in range(3)]
        sweeps.append(tows(tmp_path / f"tows-{turn}", *settings))
    wall, cpu = (min(one[i] for one in sweeps) for i in (0, 1))
    of_three, cpu_of_three = (3.0 * min(one[i] for one in captures) for i in (0, 1))
    ratio, least = wall / of_three, cpu / 2.0 / cpu_of_three
    print(f"\n100 tows, {', '.join(settings)}: {wall:.2f} s, {ratio:.2f} times three captures ({of_three:.2f} s)")
    print(f"{cpu:.2f} CPU-s on two cores beside {cpu_of_three:.2f} on one: at least {least:.2f} times")
