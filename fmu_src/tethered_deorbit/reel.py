"""The laws of the line's tension, by name: held by a locked reel, or given by a reel that works."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fmu_src.tethered_deorbit.law import Reel
from fmu_src.tethered_deorbit.locked import make_locked
from fmu_src.tethered_deorbit.working import make_commanded, make_linear


def make_reel(law: str, elastic_stiffness: Callable[..., Any]) -> Reel:
    """The kernels of a law by its name, `locked`, `linear` or `commanded`; `elastic_stiffness` is that of `tether`."""
    if law == "locked":
        return make_locked(elastic_stiffness)
    return make_linear() if law == "linear" else make_commanded()
