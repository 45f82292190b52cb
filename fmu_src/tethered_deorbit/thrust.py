"""The chaser's thruster: a signed force along one of three directions, and the propellant it takes."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.tethered_deorbit.interface import BAD_PARAMETER
from orbital.constants import STANDARD_GRAVITY
from orbital.kernel import kernel
from orbital.vectors import Array


class Thrust(NamedTuple):
    """Kernels of one direction.

    reset(record, time)               nothing used yet
    add(record, state, rate)          add the thrust to the rate of the state
    changed(record) -> bool           the input asks for another force than the one in force
    prepare(record, time) -> fault    put what the input asks for in force, from `time` on
    publish(record, time)             propellant used up to `time`
    """

    reset: Callable[..., Any]
    add: Callable[..., Any]
    changed: Callable[..., Any]
    prepare: Callable[..., Any]
    publish: Callable[..., Any]


def make_no_thrust() -> Thrust:
    """An FMU without a thruster: nothing of it is compiled."""

    @kernel
    def reset(record: Any, time: float) -> None:
        pass

    @kernel
    def add(record: Any, state: Array, rate: Array) -> None:
        pass

    @kernel
    def changed(record: Any) -> bool:
        return False

    @kernel
    def prepare(record: Any, time: float) -> int:
        return 0

    @kernel
    def publish(record: Any, time: float) -> None:
        pass

    return Thrust(reset, add, changed, prepare, publish)


@kernel
def _add_along(record: Any, rate: Array, x: float, y: float, z: float) -> None:
    """Add the thrust along a direction of any length to centre of mass and relative vector."""
    r = record[0]
    length = math.sqrt(x * x + y * y + z * z)
    if length > 0.0:
        on_center = r.state_thrust / (r.state_total_mass * length)
        on_chaser = r.state_thrust / (r.chaser_mass * length)
        rate[3] += on_center * x
        rate[4] += on_center * y
        rate[5] += on_center * z
        rate[9] -= on_chaser * x
        rate[10] -= on_chaser * y
        rate[11] -= on_chaser * z


@kernel
def _add_along_track(record: Any, state: Array, rate: Array) -> None:
    """Thrust along the chaser's along-track.

    u = (h x r)/|h x r| with h = r x v, so h x r = v (r.r) - r (r.v);   R'' += F u/M,   rho'' -= F u/m_c
    """
    share = record[0].state_target_share
    x, y, z = state[0] - share * state[6], state[1] - share * state[7], state[2] - share * state[8]
    u, v, w = state[3] - share * state[9], state[4] - share * state[10], state[5] - share * state[11]
    radial = (x * u + y * v + z * w) / (x * x + y * y + z * z)
    _add_along(record, rate, u - radial * x, v - radial * y, w - radial * z)


@kernel
def _add_along_velocity(record: Any, state: Array, rate: Array) -> None:
    """Thrust along the chaser's inertial velocity: u = v/|v|."""
    share = record[0].state_target_share
    _add_along(record, rate, state[3] - share * state[9], state[4] - share * state[10], state[5] - share * state[11])


@kernel
def _add_along_tether(record: Any, state: Array, rate: Array) -> None:
    """Thrust along the line, positive towards the target: u = rho/|rho|."""
    _add_along(record, rate, state[6], state[7], state[8])


def make_thrust(direction: str) -> Thrust:
    """A thruster on the chaser.

        R'' += F u/M,   rho'' -= F u/m_c,   F = level + offset,   propellant = integral of |F|/(Isp g0)

    Masses stay constant. The propellant of a tow from 800 to 200 km at 3000 s is 1.1 % of the pair's mass; keeping it
    aboard makes the tow 0.6 % longer than `orbital.references.spiral_time` with its exhaust speed says.

    direction     along_track, velocity or tether

    Valid    point masses: no torque, no plume on the target
    Source   physics.md, section 2
    Checked  tests/tethered_deorbit/test_terms.py
    """
    add = {"along_track": _add_along_track, "velocity": _add_along_velocity, "tether": _add_along_tether}[direction]

    @kernel
    def reset(record: Any, time: float) -> None:
        r = record[0]
        r.state_thrust = 0.0
        r.state_propellant = 0.0
        r.state_propellant_since = time

    @kernel
    def used(record: Any, time: float) -> float:
        r = record[0]
        flow = abs(r.state_thrust) / (r.thrust_specific_impulse * STANDARD_GRAVITY)
        mass: float = r.state_propellant + flow * (time - r.state_propellant_since)
        return mass

    @kernel
    def changed(record: Any) -> bool:
        r = record[0]
        return bool(r.thrust_level + r.thrust_offset != r.state_thrust)

    @kernel
    def prepare(record: Any, time: float) -> int:
        r = record[0]
        force = r.thrust_level + r.thrust_offset
        if not (math.isfinite(force) and r.thrust_specific_impulse > 0.0):
            return BAD_PARAMETER
        r.state_propellant = used(record, time)
        r.state_propellant_since = time
        r.state_thrust = force
        return 0

    @kernel
    def publish(record: Any, time: float) -> None:
        record[0].chaser_propellant = used(record, time)

    return Thrust(reset, add, changed, prepare, publish)
