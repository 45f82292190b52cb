"""The laws of the line's tension, by name: held by a locked reel, or given by a reel that is controlled."""

from __future__ import annotations

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit import brake, winch
from fmu_src.tethered_deorbit.brake import make_brake
from fmu_src.tethered_deorbit.controlled import make_commanded, make_linear
from fmu_src.tethered_deorbit.law import Reel
from fmu_src.tethered_deorbit.locked import make_locked
from fmu_src.tethered_deorbit.regulator import make_regulator
from fmu_src.tethered_deorbit.sights import Sights
from fmu_src.tethered_deorbit.winding import (
    make_constant_tension,
    make_detumble,
    make_libration,
    make_sampled_linear,
    make_schedule,
)

LAWS = {"locked": make_locked, "linear": make_linear, "regulator": make_regulator, "commanded": make_commanded}
WINCHES = {
    "constant_tension": make_constant_tension,
    "schedule": make_schedule,
    "libration": make_libration,
    "detumble": make_detumble,
    "sampled_linear": make_sampled_linear,
    "brake": make_brake,
}
"""Those that wind, and see the pair."""


def components(law: str) -> tuple[int, int]:
    """How many components a law has in the state: such as the equations depend on, and integrals."""
    if law == "brake":
        return brake.MOVED, brake.GATHERED
    return (winch.MOVED, winch.GATHERED) if law in WINCHES else (0, 0)


def make_reel(law: str, interface: Interface, sights: Sights) -> Reel:
    """The kernels of a law by its name, one of `LAWS` or `WINCHES`, for a record of this interface.

    sights        what a reel that winds may see of the pair
    """
    return WINCHES[law](interface, sights) if law in WINCHES else LAWS[law](interface)
