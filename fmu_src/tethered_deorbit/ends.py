"""Where a run ends by itself: low or high enough, or where the bodies come too close to each other."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from fmu_src.interface import Interface
from fmu_src.tethered_deorbit.acting import IDLE, Acting
from fmu_src.tethered_deorbit.faults import blame
from fmu_src.tethered_deorbit.interface import (
    BROKE,
    CAME_CLOSE,
    CAME_DOWN,
    ENDS_AT_START,
    PERIGEE_LOW,
    PERIGEE_RAISED,
    WRAPPED_UP,
)
from fmu_src.tethered_deorbit.kinematics import perigee_radius
from fmu_src.tethered_deorbit.layout import PAIR
from orbital.constants import EARTH_EQUATORIAL_RADIUS
from orbital.kernel import kernel
from orbital.rotations import rotate_inverse
from orbital.vectors import Array, dot, norm

ENDS = (CAME_DOWN, PERIGEE_LOW, PERIGEE_RAISED, CAME_CLOSE, WRAPPED_UP, BROKE)
"""Faults with which a part ends a run: the outputs are then those of that instant."""
FLAT = 1e-12
"""Share of a body's size within which a point lies in a face."""
CLOSEST_LOOK = 0.02
"""Share of the room the bodies take by which they may come nearer in a step, where they nearly meet: less than that of
a pass is not seen."""


@kernel
def sphere_gap(record: Any, state: Array) -> float:
    """Distance [m] from the chaser's centre of mass to the sphere that holds the target.

    Checked  tests/tethered_deorbit/test_ends.py
    """
    distance: float = norm(state[6:9]) - record[0].ends_target_extent
    return distance


@kernel
def chaser_place(record: Any, state: Array) -> None:
    """The chaser's centre of mass in the target's axes, from the middle of its shape [m], in `state.vector[0]`.

    Checked  tests/tethered_deorbit/test_ends.py
    """
    r = record[0]
    place, away = r.state_vector[0], r.state_vector[1]
    for i in range(3):
        away[i] = -state[6 + i]
    rotate_inverse(place, state[PAIR : PAIR + 4], away)
    for i in range(3):
        place[i] -= r.target_center[i]


@kernel
def box_gap(record: Any, state: Array) -> float:
    """Distance [m] from the chaser's centre of mass to a box, zero inside.

    Checked  tests/tethered_deorbit/test_ends.py
    """
    r = record[0]
    chaser_place(record, state)
    square = 0.0
    for i in range(3):
        beyond = max(0.0, abs(r.state_vector[0][i]) - 0.5 * r.target_size[i])
        square += beyond * beyond
    return math.sqrt(square)


@kernel
def cylinder_gap(record: Any, state: Array) -> float:
    """Distance [m] from the chaser's centre of mass to a cylinder about the third body axis, zero inside.

    Checked  tests/tethered_deorbit/test_ends.py
    """
    r = record[0]
    chaser_place(record, state)
    x, y, z = r.state_vector[0][0], r.state_vector[0][1], r.state_vector[0][2]
    out = max(0.0, math.sqrt(x * x + y * y) - r.target_cylinder_radius)
    along = max(0.0, abs(z) - 0.5 * r.target_cylinder_length)
    return math.sqrt(out * out + along * along)


@kernel
def hull_gap(record: Any, state: Array) -> float:
    """Distance [m] from the chaser's centre of mass to a convex hull, zero inside.

    The nearest point lies in a face, where the chaser is above that face, or on an edge.

    Checked  tests/tethered_deorbit/test_hulls.py
    """
    r = record[0]
    chaser_place(record, state)
    place, foot = r.state_vector[0], r.state_vector[1]
    for i in range(3):
        place[i] += r.target_center[i]
    nearest, inside = math.inf, True
    for f in range(r.state_faces.shape[0]):
        above = dot(r.state_faces[f][0:3], place) - r.state_faces[f][3]
        if not above > 0.0:
            continue
        inside = False
        for i in range(3):
            foot[i] = place[i] - above * r.state_faces[f][i]
        in_face = True
        for g in range(r.state_faces.shape[0]):
            beyond = dot(r.state_faces[g][0:3], foot) - r.state_faces[g][3]
            in_face = in_face and beyond <= FLAT * r.state_extent
        if in_face:
            nearest = min(nearest, above)
    if inside:
        return 0.0
    for e in range(r.state_edges.shape[0]):
        edge = r.state_edges[e]
        along = 0.0
        for i in range(3):
            along += (place[i] - edge[i]) * edge[3 + i]
        along = min(edge[6], max(0.0, along))
        square = 0.0
        for i in range(3):
            off = place[i] - edge[i] - along * edge[3 + i]
            square += off * off
        nearest = min(nearest, math.sqrt(square))
    return nearest


GAPS = {"box": box_gap, "cylinder": cylinder_gap, "hull": hull_gap}
"""Distance to a target with a surface, by its kind; to others, that to a sphere."""


def make_ends(terms: Mapping[str, str], line: Callable[..., Any], interface: Interface) -> Acting:
    """What ends a run, for a record of this interface; IDLE where the scene has none.

    line          kernel of the bodies, which finds how much of the line lies on the target

    Each is a condition of the state, so that the instant is found within the step. One that is met at the start
    is refused.
    Without an orbit the bodies' approach alone counts.

    Valid    bodies that approach faster than they accelerate: in a step they come nearer by no more than the room
             between them, or a fiftieth of what they take
    Source   ours; the perigee is a (1 - e) = p/(1 + e), p = h^2/mu
    Checked  tests/tethered_deorbit/test_ends.py
    """
    if "ends" not in terms:
        return IDLE
    gap_to_target = GAPS.get(terms["target"], sphere_gap)
    has_surface, orbits = terms["target"] in GAPS, terms["environment"] == "central"
    slots = interface.references
    altitude_slot, perigee_slot, raised_slot = (
        slots["ends.altitude"], slots["ends.perigee"], slots["ends.raised_perigee"]
    )  # fmt: skip
    clearance_slot, wrapped_slot = slots["ends.clearance"], slots["ends.wrapped"]

    @kernel
    def gap(record: Any, state: Array) -> float:
        """Room between the two [m], negative where they overlap.

        Checked  tests/tethered_deorbit/test_ends.py
        """
        return float(gap_to_target(record, state) - record[0].ends_chaser_extent)

    @kernel
    def met(record: Any, state: Array) -> tuple[int, int, float]:
        """What has been met, by its fault or 0; the value reference that says where; how it stands, SI.

        Checked  tests/tethered_deorbit/test_ends.py
        """
        r = record[0]
        if orbits:
            altitude = norm(state[0:3]) - EARTH_EQUATORIAL_RADIUS
            if altitude <= r.ends_altitude:
                return CAME_DOWN, altitude_slot, altitude
            lowest = perigee_radius(record, state) - EARTH_EQUATORIAL_RADIUS
            if lowest <= r.ends_perigee:
                return PERIGEE_LOW, perigee_slot, lowest
            if lowest >= r.ends_raised_perigee:
                return PERIGEE_RAISED, raised_slot, lowest
        room = gap(record, state)
        if room <= r.ends_clearance:
            return CAME_CLOSE, clearance_slot, room
        if has_surface:
            line(record, state)
            if r.state_wrapped > r.ends_wrapped:
                return WRAPPED_UP, wrapped_slot, r.state_wrapped
        return 0, 0, 0.0

    @kernel
    def begin(record: Any, state: Array) -> int:
        """A run that would end as it begins is refused.

        Checked  tests/tethered_deorbit/test_ends.py
        """
        record[0].ends_time = 0.0
        fault, slot, value = met(record, state)
        return blame(record, ENDS_AT_START, slot, value) if fault != 0 else 0

    @kernel
    def longest(record: Any, state: Array) -> float:
        """Longest step [s]: the bodies come no nearer than the room that is left.

        Checked  tests/tethered_deorbit/test_ends.py: two bodies that pass
        """
        r = record[0]
        speed = norm(state[9:12])
        takes = r.ends_chaser_extent + r.ends_target_extent + r.ends_clearance
        if has_surface:
            takes += r.state_extent
            speed += norm(state[PAIR + 4 : PAIR + 7]) * r.state_extent
        if not (takes > 0.0 and speed > 0.0):
            return math.inf
        step: float = max(gap(record, state) - r.ends_clearance, CLOSEST_LOOK * takes) / speed
        return step

    @kernel
    def holds(record: Any, state: Array, since: float) -> bool:
        """Whether the run goes on.

        Checked  tests/tethered_deorbit/test_ends.py
        """
        fault, _, _ = met(record, state)
        return fault == 0

    @kernel
    def act(record: Any, state: Array, time: float, by_state: bool) -> int:
        """End it.

        Checked  tests/tethered_deorbit/test_ends.py
        """
        fault, _, value = met(record, state)
        if fault == 0:
            return 0
        record[0].ends_time = time
        return blame(record, fault, 0, value)

    return Acting(begin=begin, longest=longest, holds=holds, act=act)
