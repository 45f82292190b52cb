"""What acts on every body: gravity as seen in the frame, by the name a scene gives it."""

from __future__ import annotations

from typing import Any, NamedTuple

from fmu_src.net_capture.gravity import still


class Gravity(NamedTuple):
    """Kernels of one gravity; what it leaves out is that of none. A kick takes velocities from half a substep before an
    instant to half a substep after it.

    bends                                       whether it acts on nodes that nothing pulls
    start(p)                                    ready before anything moves
    renew(p)                                    the grid has gone on by a substep; None: nothing changes with time
    rate(p)                                     at which the frame turns about its third axis [rad/s]
    kick_chaser(p, place, velocity, pull, h)    kick the chaser under an acceleration of its own [m/s2] and gravity
    kick_target(p, place, velocity, pull, h)    the same of the target
    kick_group(p, reals, i, slots, h, n)        kick a group of nodes by forces and gravity, predict their velocities
                                                for the next instant and clear the forces; n as `rate`. Where gravity
                                                bends, drift them too; otherwise they have drifted at their old
                                                velocities, and what the kick adds is added
    coast_group(p, reals, i, slots, h, n)       velocities of a group of free nodes at the instant of their positions
    fly_group(reals, i, slots, flight, place, rate, back)
                                                free flight of a group into three planes each, from the planes of
                                                positions and velocities
    begin_flight(p, flight, first, steps)       what `fly_group` needs of so many substeps from the one of that number
                                                on, (10,)
    stray(p, distance, speed, time)             bound of how far a free flight leaves the straight line [m], from a
                                                distance from the origin, at a speed
    stray_apart(p, distance, speed, time)       the same of the way between two nodes, with their distance and
                                                relative speed
    accelerate(p, out, position, velocity)      out = acceleration [m/s2] of a free node
    potential(p, position)                      potential energy per mass [J/kg] of a node
    chaser_potential(p), target_potential(p)    potential energy of these bodies [J]
    gradient(p)                                 3 mu/r^3 [1/s2] of the orbit, whose first axis points away from the
                                                Earth; None: there is no orbit
    watch(p, work)                              a look at the net, whose nodes are placed; None: there is nothing to see
    given(p, work)                              energy that came in because the law itself changed with time [J], of the
                                                nodes as shown; None: it does not change
    """

    kick_group: Any
    coast_group: Any
    begin_flight: Any
    fly_group: Any
    bends: bool = False
    start: Any = still.start
    renew: Any = None
    rate: Any = still.rate
    kick_chaser: Any = still.kick_body
    kick_target: Any = still.kick_body
    stray: Any = still.stray
    stray_apart: Any = still.stray
    accelerate: Any = still.accelerate
    potential: Any = still.potential
    chaser_potential: Any = still.body_potential
    target_potential: Any = still.body_potential
    gradient: Any = None
    watch: Any = None
    given: Any = None

    @property
    def turns(self) -> bool:
        """Whether the frame turns."""
        return self.rate is not still.rate


def gravities() -> dict[str, Any]:
    """Every gravity's term, by name."""
    from fmu_src.net_capture.gravity import hill, history, none, uniform

    return {"none": none.PART, "hill": hill.PART, "uniform": uniform.PART, "history": history.PART}
