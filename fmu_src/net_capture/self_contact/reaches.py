"""How far every node may go before the list of pairs is made anew, and the boxes in which threads may come by then."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from fmu_src.net_capture.planes import INVERSE_MASS, U, X
from orbital.kernel import kernel

KICK, NEW, HELD, BEFORE, RATE, PER_REACH, SPEED, PLANES = 0, 3, 6, 9, 12, 13, 14, 15
"""Node planes: change of velocity by contact in the last substep, and so far in this one [m/s], three each; what
dashpots hold back of the springs' force [N] and velocity before it acts [m/s], three each; stiffness over mass of what
touches [1/s2]; one over the reach [1/m]; square of the speed in the last substep [m2/s2]."""
FLOOR_STEPS = 4.0
"""Substeps of the fastest node, that any node may go at least."""
FLOOR_RADII = 0.25
"""Radii that any node may go at least."""


class Reaches(NamedTuple):
    """Kernels of the reaches.

    spread(p, work)              reach of every node and thread for `self_contact_life` substeps, and the boxes
    along(p, work) -> axis       along which boxes overlap least
    sort(p, work, axis)          threads in the order of where their boxes begin along it
    stride(p, work, store_them)  share of its reach that any node went in the last substep at most [1]
    """

    spread: Any
    along: Any
    sort: Any
    stride: Any


def make_reaches(composition: Any, room: Any) -> Reaches:
    """Kernels for the composition's nodes, and the memory of `make_room`."""
    memory, lanes, first_plane = composition.memory, composition.lanes, composition.self_contact_plane
    node_plane, reals_of = memory.node_plane, memory.reals
    load, store, splat, where, width, lane = (
        lanes.load,
        lanes.store,
        lanes.splat,
        lanes.where,
        lanes.width,
        lanes.lane,
    )
    ends, order, radii, boxes = room.ends, room.order, room.radii, room.boxes
    per_reach_plane, speed_plane = first_plane + PER_REACH, first_plane + SPEED

    @kernel
    def mean_velocity(p, work):
        """Mean velocity of all nodes into `self_contact_drift` [m/s].

        Checked  tests/net_capture/test_near_pairs.py
        """
        inverse = node_plane(p, work, INVERSE_MASS)
        for axis in range(3):
            total = 0.0
            found = 0
            plane = node_plane(p, work, U + axis)
            for node in range(p.node_slots):
                if inverse[node] > 0.0:
                    total += plane[node]
                    found += 1
            p.self_contact_drift[axis] = total / found

    @kernel
    def speeds(p, work):
        """Squares of the nodes' speeds against that [m2/s2] into their plane; the largest.

        Checked  tests/net_capture/test_near_pairs.py
        """
        speed, inverse = node_plane(p, work, speed_plane), node_plane(p, work, INVERSE_MASS)
        fastest = 0.0
        for node in range(p.node_slots):
            squared = 0.0
            if inverse[node] > 0.0:
                for axis in range(3):
                    going = node_plane(p, work, U + axis)[node] - p.self_contact_drift[axis]
                    squared += going * going
            speed[node] = squared
            fastest = max(fastest, squared)
        return fastest

    @kernel
    def spread(p, work):
        """Reach of every node and thread, and the boxes in which these may come.

        Checked  tests/net_capture/test_near_pairs.py
        """
        mean_velocity(p, work)
        fastest = math.sqrt(speeds(p, work))
        h = p.solver_substep
        size, at, box = radii(p, work), ends(p, work), boxes(p, work)
        speed, per_reach = node_plane(p, work, speed_plane), node_plane(p, work, per_reach_plane)
        inverse = node_plane(p, work, INVERSE_MASS)
        thickest = 0.0
        for i in range(p.self_contact_count):
            thickest = max(thickest, size[2 * i])
        floor = max(FLOOR_RADII * thickest, FLOOR_STEPS * h * fastest)
        for node in range(p.node_slots):
            reach = floor + p.self_contact_life * h * math.sqrt(speed[node])
            per_reach[node] = 1.0 / reach if inverse[node] > 0.0 else 0.0
        for i in range(p.self_contact_count):
            one, other = at[2 * i], at[2 * i + 1]
            reach = 1.0 / min(per_reach[one], per_reach[other])
            size[2 * i + 1] = reach
            for axis in range(3):
                plane = node_plane(p, work, X + axis)
                box[6 * i + axis] = min(plane[one], plane[other]) - size[2 * i] - reach
                box[6 * i + 3 + axis] = max(plane[one], plane[other]) + size[2 * i] + reach

    @kernel
    def along(p, work):
        """The axis along which boxes overlap least, for what they span together.

        Checked  tests/net_capture/test_near_pairs.py
        """
        box = boxes(p, work)
        best = 0
        least = math.inf
        for axis in range(3):
            low = math.inf
            high = -math.inf
            covered = 0.0
            for i in range(p.self_contact_count):
                low = min(low, box[6 * i + axis])
                high = max(high, box[6 * i + 3 + axis])
                covered += box[6 * i + 3 + axis] - box[6 * i + axis]
            if covered < least * (high - low):
                least = covered / (high - low)
                best = axis
        return best

    @kernel
    def sort(p, work, axis):
        """Threads in the order of where their boxes begin: Shell's sort, quick on what is nearly in order.

        Checked  tests/net_capture/test_near_pairs.py
        """
        row, box = order(p, work), boxes(p, work)
        gap = 1
        while gap < p.self_contact_count // 3:
            gap = 3 * gap + 1
        while gap > 0:
            for k in range(gap, p.self_contact_count):
                thread = row[k]
                value = box[6 * thread + axis]
                m = k
                while m >= gap and box[6 * row[m - gap] + axis] > value:
                    row[m] = row[m - gap]
                    m -= gap
                row[m] = thread
            gap //= 3

    @kernel
    def stride(p, work, store_them):
        """By how much the way goes on with the last substep [1]: largest of all speeds, before or after, over reach.

        store_them    whether speeds are kept for the next time

        Checked  tests/net_capture/test_near_pairs.py
        """
        reals, slots = reals_of(work), p.node_slots
        a, b, c = splat(p.self_contact_drift[0]), splat(p.self_contact_drift[1]), splat(p.self_contact_drift[2])
        most = splat(0.0)
        for i in range(0, slots, width):
            x, y, z = (
                load(reals, i + U * slots) - a,
                load(reals, i + (U + 1) * slots) - b,
                load(reals, i + (U + 2) * slots) - c,
            )
            speed = x * x + y * y + z * z
            before = load(reals, i + speed_plane * slots)
            larger = where(before < speed, speed, before)
            per_reach = load(reals, i + per_reach_plane * slots)
            ratio = larger * per_reach * per_reach
            most = where(most < ratio, ratio, most)
            if store_them:
                store(reals, i + speed_plane * slots, speed)
        largest = 0.0
        for i in range(width):
            largest = max(largest, lane(most, np.int64(i)))
        return p.solver_substep * math.sqrt(largest)

    return Reaches(spread, along, sort, stride)
