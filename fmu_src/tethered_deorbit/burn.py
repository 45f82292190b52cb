"""When the thruster burns: at times of its own, or on arcs of the orbit; and how its thrust comes and goes."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.acting import IDLE, Acting
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.interface import BAD_PARAMETER, NO_ARCS
from fmu_src.tethered_deorbit.turning import turn_vectors_back
from orbital.kernel import kernel
from orbital.vectors import Array, norm

STEP, RAMP, NOTCH = range(3)
OFF, ON, FALLING = range(3)
NOTCHED = 40.0
"""Radians of the line's motion after which a notched edge is over: 2 x exp(-x) is then below 1e-15."""
LOOK = 0.25
"""Part of an arc, or of the way between two, over which a step may go."""


class Burn(NamedTuple):
    """Kernels of one way to burn.

    share(record, now) -> (share, rate)   of the level that the thruster gives [-], and how fast that changes [1/s]
    acting                                when it burns
    """

    share: Callable[..., Any]
    acting: Acting


@kernel
def whole(record: Any, now: float) -> tuple[float, float]:
    """All of it, at all times."""
    return 1.0, 0.0


STEADY = Burn(whole, IDLE)


@kernel
def edge_time(record: Any) -> float:
    """How long the thrust takes to come, and to go [s].

    Checked  tests/tethered_deorbit/test_burn.py
    """
    r = record[0]
    if r.burn_edge == RAMP:
        rise: float = r.burn_rise
        return rise
    return NOTCHED / r.state_burn_rate if r.burn_edge == NOTCH else 0.0


@kernel
def edge(record: Any, since: float) -> tuple[float, float]:
    """Share of the level [-] that has come since the edge began [s], and its rate [1/s].

        step   1          ramp   t/rise          notch   1 - 2 w t exp(-w t)

    w the line's own rate: the notch is what (s^2 + w^2)/(s + w)^2 leaves of a step, and shakes the line no more.

    Source   a critically damped notch filter; thrust profiles of tethered tugs: Jasper and Schaub, Acta Astronautica 96
             (2014) 128
    Checked  tests/tethered_deorbit/test_burn.py: no vibration is left behind a notched edge
    """
    r = record[0]
    if since >= edge_time(record):
        return 1.0, 0.0
    if r.burn_edge == RAMP:
        return since / r.burn_rise, 1.0 / r.burn_rise
    x = r.state_burn_rate * since
    fade = 2.0 * math.exp(-x)
    return 1.0 - x * fade, r.state_burn_rate * (x - 1.0) * fade


@kernel
def share(record: Any, now: float) -> tuple[float, float]:
    """Share of the level at a time [s], and its rate: the edge by which it came, less that by which it goes.

    So a burn has the impulse of its duration, whatever its edges. A notched one that is let go within some radians of
    the line's motion would have to push backwards for it: it stops at zero.

    Checked  tests/tethered_deorbit/test_burn.py
    """
    r = record[0]
    if r.state_burn == OFF:
        return 0.0, 0.0
    come, come_rate = edge(record, now - r.state_burn_begun)
    if r.state_burn == ON:
        return come, come_rate
    gone, gone_rate = edge(record, now - r.state_burn_ended)
    return (come - gone, come_rate - gone_rate) if come > gone else (0.0, 0.0)


def make_burn(terms: Mapping[str, str], place: Callable[..., Any], interface: Interface) -> Burn:
    """The kernels of the scene's way to burn; STEADY where it names none.

    place         kernel of the environment: where the orbit's point is at the start

    timed    from `start` on for `duration`, every `interval`, `count` times; no duration stands for one period of the
             pair on its line, 2 pi sqrt(m_r/k), and no count for no end
    arcs     within `half_width` of the perigee or the apogee of the reference orbit, or of both, by the angle of the
             centre of mass

    Valid    lines that have a stiffness, where a period or a notch is asked for
    Checked  tests/tethered_deorbit/test_burn.py
    """
    if "burn" not in terms:
        return STEADY
    timed, orbits = terms["burn"] == "timed", terms["environment"] != "none"
    slots = interface.references
    edge_slot = slots["burn.edge"]
    duration_slot = slots["burn.duration"] if timed else edge_slot
    interval_slot = slots["burn.interval"] if timed else edge_slot

    @kernel
    def duration(record: Any) -> float:
        """How long a burn lasts [s].

        Checked  tests/tethered_deorbit/test_burn.py: a pulse of one period
        """
        r = record[0]
        if r.burn_duration > 0.0:
            told: float = r.burn_duration
            return told
        period: float = 2.0 * math.pi / r.state_burn_rate
        return period

    @kernel
    def next_begin(record: Any) -> float:
        """When the next burn begins [s], infinite after the last.

        Checked  tests/tethered_deorbit/test_burn.py
        """
        r = record[0]
        if (r.burn_count > 0 and r.state_burns >= r.burn_count) or (r.state_burns > 0 and r.burn_interval == 0.0):
            return math.inf
        begin: float = r.burn_start + r.state_burns * r.burn_interval
        return begin

    @kernel
    def inside(record: Any, state: Array, elapsed: float) -> bool:
        """Whether the centre of mass is on an arc.

            cos(angle from the perigee) >= cos(half-width), or <= -cos(half-width), or either

        elapsed       since the begin of the step, along whose axes the state stands [s]

        Checked  tests/tethered_deorbit/test_burn.py
        """
        r = record[0]
        place = r.state_vector[0]
        for i in range(3):
            place[i] = state[i]
        turn_vectors_back(record, elapsed, place, 3)
        along = (place[0] * r.state_perigee[0] + place[1] * r.state_perigee[1] + place[2] * r.state_perigee[2]) / norm(
            place
        )
        least = math.cos(r.burn_half_width)
        return bool((r.burn_about != 1 and along >= least) or (r.burn_about != 0 and along <= -least))

    @kernel
    def schedule(record: Any, time: float) -> None:
        """When the burn changes next by the clock, from a time on [s].

        Checked  tests/tethered_deorbit/test_burn.py
        """
        r = record[0]
        due = math.inf
        if r.state_burn == FALLING:
            due = r.state_burn_ended + edge_time(record)
        elif r.state_burn == ON and timed:
            due = r.state_burn_begun + duration(record)
        elif r.state_burn == OFF and timed:
            due = next_begin(record)
        come = r.state_burn_begun + edge_time(record)
        if r.state_burn != OFF and come > time:
            due = min(due, come)
        r.state_burn_due = due

    @kernel
    def change(record: Any, time: float, wanted: bool) -> None:
        """Begin a burn, let it go, or be done with it, at a time [s].

        wanted        it ought to burn

        Checked  tests/tethered_deorbit/test_burn.py
        """
        r = record[0]
        if r.state_burn == FALLING and (wanted or time >= r.state_burn_ended + edge_time(record)):
            r.state_burn = OFF
        if r.state_burn == ON and not wanted:
            r.state_burn = FALLING if edge_time(record) > 0.0 else OFF
            r.state_burn_ended = time
        elif r.state_burn == OFF and wanted:
            r.state_burn = ON
            r.state_burn_begun = time
            r.state_burns += 1
        schedule(record, time)

    @kernel
    def wanted(record: Any, state: Array, time: float) -> bool:
        """Whether it ought to burn at a time [s], in a state along inertial axes.

        Checked  tests/tethered_deorbit/test_burn.py
        """
        r = record[0]
        if not timed:
            return bool(inside(record, state, 0.0))
        if r.state_burn == ON:
            return bool(time < r.state_burn_begun + duration(record))
        return bool(time >= next_begin(record))

    @kernel
    def find_perigee(record: Any) -> None:
        """Direction of the reference orbit's perigee, inertial: the point's own, turned back by its true anomaly.

        Checked  tests/tethered_deorbit/test_burn.py
        """
        r = record[0]
        place(record, r.state_vector[0], r.state_vector[1])
        c, s = math.cos(r.orbit_true_anomaly), math.sin(r.orbit_true_anomaly)
        for i in range(3):
            r.state_perigee[i] = c * r.state_basis[0][i] - s * r.state_basis[1][i]

    @kernel
    def begin(record: Any, state: Array) -> int:
        """No burn has been; the first may begin at once. Fault of burns that cannot be.

        Checked  tests/tethered_deorbit/test_burn.py
        """
        r = record[0]
        r.state_burn = OFF
        r.state_burns = 0
        r.state_burn_begun = 0.0
        r.state_burn_ended = 0.0
        r.state_burn_rate = math.sqrt(r.state_stiffness / r.state_reduced_mass)
        if r.burn_edge == NOTCH and r.state_burn_rate == 0.0:
            return blame(record, BAD_PARAMETER, edge_slot, float(r.burn_edge))
        if not timed:
            if not orbits:
                return blame(record, NO_ARCS, 0, 0.0)
            find_perigee(record)
        else:
            if r.burn_duration == 0.0 and r.state_burn_rate == 0.0:
                return blame(record, BAD_PARAMETER, duration_slot, 0.0)
            takes = duration(record) + edge_time(record)
            if 0.0 < r.burn_interval <= takes and r.burn_count != 1:
                return blame(record, BAD_PARAMETER, interval_slot, r.burn_interval)
        change(record, 0.0, wanted(record, state, 0.0))
        return 0

    @kernel
    def due(record: Any) -> float:
        """When it changes next by the clock [s].

        Checked  tests/tethered_deorbit/test_burn.py
        """
        instant: float = record[0].state_burn_due
        return instant

    @kernel
    def longest(record: Any, state: Array) -> float:
        """Longest step [s]: a quarter of an arc, or of what lies between.

        Checked  tests/tethered_deorbit/test_burn.py
        """
        r = record[0]
        width = r.burn_half_width
        rest = 0.5 * math.pi - width if r.burn_about == 2 else math.pi - width
        angle = min(width, rest) if rest > 0.0 else width
        rate = norm(state[3:6]) / norm(state[0:3])
        return float(2.0 * LOOK * angle / rate)

    @kernel
    def holds(record: Any, state: Array, since: float) -> bool:
        """Whether it burns on the arcs and not beside them.

        Checked  tests/tethered_deorbit/test_burn.py
        """
        r = record[0]
        return bool(inside(record, state, since - r.state_since) == (r.state_burn == ON))

    @kernel
    def act(record: Any, state: Array, time: float, by_state: bool) -> int:
        """What is due.

        Checked  tests/tethered_deorbit/test_burn.py
        """
        change(record, time, wanted(record, state, time))
        return 0

    if timed:
        return Burn(share, Acting(begin=begin, due=due, act=act))
    return Burn(share, Acting(begin=begin, due=due, longest=longest, holds=holds, act=act))
