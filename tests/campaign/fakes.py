"""Work for workers that needs no FMU: functions of a module, as a worker asks for them."""

from __future__ import annotations

import os
import re
import signal
import time
from pathlib import Path

from dcone_cosim.campaign.shots import Shot
from dcone_cosim.cases.rows import Row, refused

DEADLY = "DCONE_TEST_DEADLY"
"""Name of the environment variable that names a folder: the first time that a case of it comes, its worker dies."""


def row_of(shot: Shot) -> Row:
    """A row that follows from the settings alone."""
    told = re.findall(r"-?\d[\d.e-]*", shot.settings[0].partition("=")[2]) if shot.settings else ["0.05"]
    value = sum(map(float, told))
    figures = {"removal.value": value, "removal.square": value**2}
    return Row(shot.key, "completed", 0, "", figures, {"removal.value": "1"}, {"cpu": 1e-3})


def slow(shot: Shot) -> Row:
    time.sleep(0.03)
    return row_of(shot)


def dies_once(shot: Shot) -> Row:
    """Every seventh case kills its worker the first time that it comes."""
    mark = Path(os.environ[DEADLY]) / shot.key
    if shot.number % 7 == 3 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return row_of(shot)


def always_dies(shot: Shot) -> Row:
    if shot.number == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return row_of(shot)


def refuses(shot: Shot) -> Row:
    """Every twentieth case cannot begin."""
    if shot.number and shot.number % 20 == 0:
        return refused(shot.key, "values that do not go together")
    figures = {"removal.separation": row_of(shot).figures["removal.value"]}
    return Row(shot.key, "completed", 0, "", figures, {"removal.separation": "m"})
