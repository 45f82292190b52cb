"""What a reel that winds by itself may see of the pair."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.tethered_deorbit.idle import never


class Sights(NamedTuple):
    """Where its own components lie, and kernels that look at a state.

    place                                       of what the reel moves, in the state
    spin                                        of the target's body rate in the state, -1 where the target is a point
    line(record, state) -> (separation, length, its rate)   as of `Bodies`
    frame(record, position, velocity) -> rate   as of `Environment`: its basis goes into the record
    parted(record) -> bool                      whether the line is broken or cut
    """

    place: int
    spin: int
    line: Callable[..., Any]
    frame: Callable[..., Any]
    parted: Callable[..., Any] = never
