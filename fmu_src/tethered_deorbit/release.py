"""A line that is cut on the way: at a time, or as low as the scene says. Both bodies then fly on."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.acting import Acting, together
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.idle import always, no_end, nothing
from fmu_src.tethered_deorbit.interface import RELEASED_AT_START
from fmu_src.tethered_deorbit.kinematics import perigee_radius
from fmu_src.tethered_deorbit.law import Reel
from fmu_src.tethered_deorbit.parted import make_parted
from orbital.constants import EARTH_EQUATORIAL_RADIUS
from orbital.kernel import kernel
from orbital.vectors import Array, norm


def releasable(reel: Reel, terms: Mapping[str, str], interface: Interface, cut: Callable[..., Any] = nothing) -> Reel:
    """The law of a line that is cut, if the scene says so; else the law as it is.

    cut           kernel of `Parting`

    A line that is cut has no onset and is never taut, whatever the inputs; what it had stored is lost, as it is drawn
    out between two bodies that it no longer holds.

    Checked  tests/tethered_deorbit/test_release.py
    """
    if "release" not in terms:
        return reel
    when, thrusts = terms["release"], "thrust" in terms
    slot = interface.references[f"release.{'at' if when == 'time' else when}"]

    @kernel
    def height(record: Any, state: Array) -> float:
        """What counts: altitude of the centre of mass, or of its osculating perigee [m].

        Checked  tests/tethered_deorbit/test_release.py
        """
        if when == "perigee":
            return float(perigee_radius(record, state) - EARTH_EQUATORIAL_RADIUS)
        return float(norm(state[0:3]) - EARTH_EQUATORIAL_RADIUS)

    @kernel
    def least(record: Any) -> float:
        """How low that may be [m].

        Checked  tests/tethered_deorbit/test_release.py
        """
        return float(record[0].release_perigee if when == "perigee" else record[0].release_altitude)

    @kernel
    def begin(record: Any, state: Array) -> int:
        """A whole line; fault of one that would be cut as the tow begins.

        Checked  tests/tethered_deorbit/test_release.py
        """
        r = record[0]
        r.state_released = 0
        r.release_released = 0
        r.release_time = 0.0
        if when != "time" and height(record, state) <= least(record):
            return blame(record, RELEASED_AT_START, slot, least(record))
        return 0

    @kernel
    def due(record: Any) -> float:
        """When it is cut by the clock [s].

        Checked  tests/tethered_deorbit/test_release.py
        """
        return math.inf if record[0].state_released else float(record[0].release_at)

    @kernel
    def holds(record: Any, state: Array, since: float) -> bool:
        """Whether it is cut already, or need not be yet.

        Checked  tests/tethered_deorbit/test_release.py
        """
        return bool(record[0].state_released or height(record, state) > least(record))

    @kernel
    def act(record: Any, state: Array, time: float, by_state: bool) -> int:
        """Cut it.

        Checked  tests/tethered_deorbit/test_release.py
        """
        r = record[0]
        if r.state_released:
            return 0
        if when == "time":
            if not time >= r.release_at:
                return 0
        elif height(record, state) > least(record):
            return 0
        r.state_released = 1
        r.release_released = 1
        r.release_time = time
        cut(record, state)
        if r.release_stops_thrust:
            stop_thrust(record)
        return 0

    @kernel
    def stop_thrust(record: Any) -> None:
        """No force from now on: what has been spent is booked.

        Checked  tests/tethered_deorbit/test_release.py
        """
        if thrusts:
            record[0].state_thrust = 0.0
            record[0].state_thrust_rate = 0.0

    @kernel
    def parted(record: Any) -> bool:
        """Whether it is cut.

        Checked  tests/tethered_deorbit/test_release.py
        """
        return bool(record[0].state_released != 0)

    by_time = when == "time"
    cutting = Acting(begin=begin, due=due if by_time else no_end, holds=always if by_time else holds, act=act)
    return make_parted(reel, parted)._replace(acting=together((cutting, reel.acting)))
