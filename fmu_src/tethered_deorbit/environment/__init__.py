"""What acts on both bodies and what their places are told by, by the name a scene gives it."""

from __future__ import annotations

from typing import Any, NamedTuple

from fmu_src.interface import Interface


class Environment(NamedTuple):
    """Kernels of one environment. The frame is the one in which starts are given and the pair is seen: axis 1 radial
    outward, 2 along-track, 3 cross-track, or three axes at rest where there is no orbit.

    begin(record)                                      mean motion of the orbit, and the pace by which the tolerance of
                                                       a velocity follows from that of a position [rad/s]
    check(record) -> fault                             of the start
    place(record, position, velocity) -> rate          origin of the frame at the start, inertial; its basis goes into
                                                       the record, and its rate about axis 3 is returned [rad/s]
    same_orbit(record, state) -> fault                 the state at the start, both on one orbit
    add_gravity(record, state, rate)                   rate of the state under gravity alone; writes all twelve
    gravity_apart(position, offset, out)               gravity at the end of an offset less that where it starts
    along_track(record, state) -> (x, y, z)            direction of the chaser's along-track, of any length
    gradient(position) -> 3 mu/r^5                     strength of its gradient at a place [1/(m2 s2)]
    fallen(position) -> radius                         of a centre of mass that has come down [m], or -1
    frame(record, position, velocity) -> rate          the frame in which the pair is seen: as `place`
    publish(record)                                    outputs of its own, from those of both bodies and the centre
    differentiate(record, state, rate, shed)           and their rates, as the pair's mass changes [kg/s]
    relative_rates(basis, position, velocity, acceleration, relative, out) -> (rate, its change)
                                                       rates of the relative state as seen, and of the frame
    """

    begin: Any
    check: Any
    place: Any
    same_orbit: Any
    add_gravity: Any
    gravity_apart: Any
    along_track: Any
    gradient: Any
    fallen: Any
    frame: Any
    publish: Any
    differentiate: Any
    relative_rates: Any


FIELDS = ("central", "none")


def make_environment(field: str, interface: Interface) -> Environment:
    """The kernels of a field by its name, `central` or `none`, for a record of this interface."""
    from fmu_src.tethered_deorbit.environment import central, none

    return {"central": central.make_central, "none": none.make_none}[field](interface)
