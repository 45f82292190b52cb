"""What acts on every body: gravity as seen in the frame, by the name a scene gives it."""

from __future__ import annotations

from typing import Any, NamedTuple


class Gravity(NamedTuple):
    """Kernels of one gravity. A kick takes velocities from half a substep before an instant to half a substep after it.

    bends                                       whether it acts on nodes that nothing pulls
    rate(p)                                     at which the frame turns about its third axis [rad/s]
    kick_body(p, place, velocity, pull, h)      kick a body under an acceleration of its own [m/s2] and gravity
    kick_group(reals, i, slots, h, n)           kick a group of nodes by forces and gravity, predict their velocities
                                                for the next instant and clear the forces; n as `rate`. Where gravity
                                                bends, drift them too; otherwise they have drifted at their old
                                                velocities, and what the kick adds is added
    coast_group(reals, i, slots, h, n)          velocities of a group of free nodes at the instant of their positions
    fly_group(reals, i, slots, flight, place, rate, back)
                                                free flight of a group into three planes each, from the planes of
                                                positions and velocities
    begin_flight(p, flight, steps)              what `fly_group` needs of so many substeps, (10,)
    stray(p, distance, speed, time)             bound of how far a free flight leaves the straight line [m]; of two
                                                nodes, with their distance and relative speed
    accelerate(p, out, position, velocity)      out = acceleration [m/s2] of a free node
    potential(p, position)                      potential energy per mass [J/kg]
    """

    bends: bool
    rate: Any
    kick_body: Any
    kick_group: Any
    coast_group: Any
    begin_flight: Any
    fly_group: Any
    stray: Any
    accelerate: Any
    potential: Any


def gravities() -> dict[str, Any]:
    """Every gravity's term, by name."""
    from fmu_src.net_capture.gravity import hill, none

    return {"none": none.PART, "hill": hill.PART}
