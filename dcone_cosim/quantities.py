"""What a phase is judged by when the same phase is computed in another way: numbers, curves, the first few tugs.

Each kind of phase declares its own (`phases.phase.Phase.quantities`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dcone_cosim.recorder import Recorder

Array = npt.NDArray[np.float64]

BOUND = "level_bound"
"""Key of what a run may err by in all others, by a bound that it keeps itself [1]."""
CLOSE = 1e-6
"""Share of the least distance of two instants by which a row may miss one."""


@dataclass(frozen=True)
class Quantity:
    """One of them, as a run has it.

    key         its name for machines
    values      one number, or several that belong together; NaN where the run has none
    scale       what an error is relative to, in `unit`; 0: each value's own size
    relative_to the same in words
    meant       whether the accuracy of a phase means this one too
    resolution  what each value is told to at best, however it is computed: an instant, to the time between two looks
    """

    key: str
    label: str
    values: Sequence[float]
    unit: str
    scale: float = 0.0
    relative_to: str = "itself"
    meant: bool = True
    resolution: float = 0.0


def at(recorder: Recorder, name: str, instants: Sequence[float]) -> Array:
    """A column at these instants, NaN where no row is at one.

    instants    by the phase's own times, rising [s]
    """
    time, wanted = recorder["time"], np.asarray(instants, dtype=float)
    least = np.diff(wanted).min() if len(wanted) > 1 else 1.0
    place = np.clip(np.searchsorted(time, wanted - CLOSE * least), 0, len(time) - 1)
    there = np.abs(time[place] - wanted) <= CLOSE * least
    return np.where(there, recorder[name][place], np.nan)


def spread_instants(start: float, duration: float, macro_step: float, most: int) -> tuple[float, ...]:
    """Communication points at which curves are compared: so many at most, evenly spread, the last one among them."""
    steps = max(1, int(duration / macro_step + 1e-9))
    stride = -(-steps // most)
    return tuple(start + macro_step * i for i in range(steps, 0, -stride))[::-1]
