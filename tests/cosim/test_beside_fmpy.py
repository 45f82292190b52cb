"""Our components in a process where somebody else uses fmpy too, which keeps one logger for all."""

from __future__ import annotations

import subprocess
import sys

import pytest

from dcone_cosim import build

SCRIPT = """
import gc, sys
from pathlib import Path
import fmpy
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.fmu.component import Component

path = sys.argv[1]
with Archive(Path(path)) as archive, Component(archive, "ours") as component:
    for _ in range(3):
        said = []
        fmpy.simulate_fmu(path, stop_time=60.0, output_interval=60.0, debug_logging=True,
                          logger=lambda *row: said.append(row[-1]))
        del said
        gc.collect()
    component.initialise(0.0)
    print(component._messages.words())
    component.step(0.0, 60.0)
"""


@pytest.mark.slow
def test_a_logger_of_somebody_else_takes_nothing_away() -> None:
    """The FMU's own words reach us, and not a function that is gone."""
    (path,) = build.ensure([("tethered_deorbit", {"reel": "locked", "thrust": "along_track"})], lambda _: None)
    done = subprocess.run(
        [sys.executable, "-X", "faulthandler", "-c", SCRIPT, str(path)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-2000:]
    assert "initialised at 0 s" in done.stdout
