"""What a user may not expect of a run: plain sentences, told before it where values alone say so, else after it.

Each model has a module `cautions` with two functions that yield `Caution`:

    before(values, given, terms)          from what the scene says
    after(values, given, terms, seen)     from what came out

    values    every parameter and input by FMI name, SI
    given     names of those that the scene gives; the others are at their defaults
    terms     terms the scene names, by group; none of an FMU from elsewhere
    seen      `seen(output)` is the `Range` it had, None for one that is not there
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple


class Caution(NamedTuple):
    """What it is about, the name of a variable, and the sentence."""

    about: str
    sentence: str


class Range(NamedTuple):
    """What an output was in a run."""

    least: float
    largest: float
    first: float
    last: float


Seen = Callable[[str], Range | None]

LOWEST_ORBIT = 120e3
"""Altitude [m] below which the air ends an orbit within a revolution; entry is reckoned from 400,000 ft, 122 km."""
HEAVY_DAMPING = 0.5
"""Damping ratio from which on the dashpot's jump is the peak of a snap (`orbital.oscillators.damped_snap_peak`)."""


def low(altitude: float) -> Iterator[str]:
    """What to say of an altitude [m] at which air would end the orbit."""
    if altitude < LOWEST_ORBIT:
        yield (
            f"{1e-3 * altitude:.6g} km is below {1e-3 * LOWEST_ORBIT:g} km, where the air ends an orbit within a "
            "revolution; no drag is computed"
        )


def heavily_damped(name: str, ratio: float | None, speed: str) -> Iterator[Caution]:
    """A damping ratio at which the peak is the dashpot's and not the spring's."""
    if ratio is not None and ratio > HEAVY_DAMPING and math.isfinite(ratio):
        yield Caution(
            name,
            f"{ratio:g} is above {HEAVY_DAMPING:g}: the largest tension of a snap is then the dashpot's jump as it "
            f"begins, 2 zeta v sqrt(k m) with v the speed of {speed}, not the spring's",
        )
