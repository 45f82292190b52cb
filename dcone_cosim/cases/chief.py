"""Which figures of a sweep are shown: those that an engineer asks for first, as far as they change."""

from __future__ import annotations

import math
from collections.abc import Sequence

from dcone_cosim.cases.table import Column

ASKED_FIRST = (
    "removal.largest_tug_peak",
    "removal.first_tug_peak",
    "removal.tension_mean",
    "removal.tension_largest",
    "removal.tugs",
    "removal.separation",
    "removal.approach",
    "removal.lowering_rate",
    "removal.lowered",
    "capture.t_capture",
    "capture.mouth.area_max",
    "capture.mouth.t80",
    "capture.thread.tension_max",
    "capture.cord.tension_max",
    "capture.enclosure.least",
    "hand-off.slack",
    "hand-off.relative_speed",
    "hand-off.tug_speed",
)
EFFORT = (".steps", ".simulated", ".coupling_steps", ".coupling_rejected")
"""What is told of how a phase was computed."""


def chief(columns: Sequence[Column], most: int) -> list[Column]:
    """So many figures at most that are numbers and differ between cases."""
    begin = next((i for i, column in enumerate(columns) if column.name == "message"), -1) + 1
    changing = [column for column in columns[begin:] if _changes(column) and not column.name.endswith(EFFORT)]
    first = [column for name in ASKED_FIRST for column in changing if column.name == name]
    return [*first, *(column for column in changing if column not in first)][:most]


def _changes(column: Column) -> bool:
    if any(isinstance(value, str) for value in column.values):
        return False
    numbers = {value for value in column.values if value is not None and math.isfinite(value)}
    return len(numbers) > 1
