"""The laws of the line's tension, by name: held by a locked reel, or given by a reel that is controlled."""

from __future__ import annotations

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.controlled import make_commanded, make_linear
from fmu_src.tethered_deorbit.law import Reel
from fmu_src.tethered_deorbit.locked import make_locked

LAWS = {"locked": make_locked, "linear": make_linear, "commanded": make_commanded}


def make_reel(law: str, interface: Interface) -> Reel:
    """The kernels of a law by its name, `locked`, `linear` or `commanded`, for a record of this interface."""
    return LAWS[law](interface)
