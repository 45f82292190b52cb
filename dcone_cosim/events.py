"""What happened in a phase, and when."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Event:
    """One thing that happened.

    time     by the phase's own time [s]
    peak     of a tug [N], NaN for anything else
    speed    at which the line came taut [m/s], NaN likewise
    """

    phase: str
    what: str
    time: float
    peak: float = math.nan
    speed: float = math.nan
