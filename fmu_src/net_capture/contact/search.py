"""Which nodes may have met the target: an envelope first, then the box around it.

Nodes have drifted already when they are looked at, so both levels follow their way through the whole substep, however
fast they are: no node passes unseen.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from fmu_src.net_capture.planes import FX, INVERSE_MASS, LANES, LONGEST_ROW, STRIP_WORDS, A, B, P, U
from orbital.kernel import kernel
from orbital.vectors import dot

HASTE = 0.05
"""Speed [m/s] that the target may gain before all rows are looked at again."""


class Search(NamedTuple):
    """Kernels of the search.

    near(p, reals, first, margin)         whether a node of a row may have been in the target's envelope, widened by a
                                          margin [m]
    close(p, reals, first, turn, margin)  nodes of a row whose way lies partly in the box round the target, so widened;
                                          a bit each
    largest_pull(p, work)                 acceleration that threads of 1 N may give the lightest node [1/kg]
    clear_steps, hurries                  as in `Contact`
    """

    near: Any
    close: Any
    largest_pull: Any
    clear_steps: Any
    hurries: Any


def make_search(composition: Any, longest: int) -> Search:
    """Kernels for lanes of the composition's precision; no row is left alone for more substeps than `longest`."""
    lanes, gravity, memory = composition.lanes, composition.gravity, composition.memory
    reals_of, node_plane, strips = memory.reals, memory.node_plane, memory.strips
    load, splat, where, bits, lane, width = (
        lanes.load,
        lanes.splat,
        lanes.where,
        lanes.bits,
        lanes.lane,
        lanes.width,
    )
    stray = gravity.stray
    has_closing, has_tether = "closing" in composition.terms, "tether" in composition.terms
    has_load, drags = "pull_off" in composition.terms, composition.terms.get("tether") == "dragging"
    has_self = "self_contact" in composition.terms

    @kernel
    def within_axis(turn, axis, half, sx, sy, sz, dx, dy, dz):
        """Whether ways of half-length s about their middles d come within half an edge of the middle of the box, along
        one of its axes.

        Checked  tests/net_capture/test_fast_nodes.py
        """
        zero = splat(0.0)
        a = splat(turn[0, axis])
        b = splat(turn[1, axis])
        c = splat(turn[2, axis])
        way = a * sx + b * sy + c * sz
        middle = a * dx + b * dy + c * dz
        way = where(way > zero, way, zero - way)
        middle = where(middle > zero, middle, zero - middle)
        return middle - way < splat(half)

    @kernel
    def near(p, reals, first, margin):
        """The way's middle is within radius + |h u|/2 if any of it is within the radius; (a + b)^2 <= 2 a^2 + 2 b^2
        spares the root.

        Checked  tests/net_capture/test_fast_nodes.py
        """
        slots = p.node_slots
        half = splat(0.5 * p.solver_substep)
        two = splat(2.0)
        radius = p.envelope_radius + margin
        within = splat(2.0 * radius * radius)
        cx = splat(p.target_place[0])
        cy = splat(p.target_place[1])
        cz = splat(p.target_place[2])
        found = np.uint64(0)
        for i in range(first, first + p.row_pitch, width):
            a = half * load(reals, i + U * slots)
            b = half * load(reals, i + (U + 1) * slots)
            c = half * load(reals, i + (U + 2) * slots)
            dx = load(reals, i) - a - cx
            dy = load(reals, i + slots) - b - cy
            dz = load(reals, i + 2 * slots) - c - cz
            found |= bits(dx * dx + dy * dy + dz * dz - two * (a * a + b * b + c * c) < within)
        return found != np.uint64(0)

    @kernel
    def close(p, reals, first, turn, margin):
        """The way's extent along each axis of the box counts, so a way past a corner may be taken for one through
        it.

        Checked  tests/net_capture/test_fast_nodes.py
        """
        slots = p.node_slots
        half = splat(0.5 * p.solver_substep)
        cx = splat(p.target_place[0])
        cy = splat(p.target_place[1])
        cz = splat(p.target_place[2])
        found = np.uint64(0)
        for j in range(0, p.row_pitch, width):
            i = first + j
            sx = half * load(reals, i + U * slots)
            sy = half * load(reals, i + (U + 1) * slots)
            sz = half * load(reals, i + (U + 2) * slots)
            dx = load(reals, i) - sx - cx
            dy = load(reals, i + slots) - sy - cy
            dz = load(reals, i + 2 * slots) - sz - cz
            inside = within_axis(turn, 0, p.half_size[0] + margin, sx, sy, sz, dx, dy, dz)
            inside = inside & within_axis(turn, 1, p.half_size[1] + margin, sx, sy, sz, dx, dy, dz)
            inside = inside & within_axis(turn, 2, p.half_size[2] + margin, sx, sy, sz, dx, dy, dz)
            found |= bits(inside) << np.uint64(j)
        return found

    @kernel
    def clear_steps(p, work, first, pulled):
        """The nearest node's distance from the envelope over the sum of the largest speeds.

            free = (v + v_target) t + 1/2 a t^2,   a = threads at a node, their largest tension over the lightest mass

        The tension is `contact_force`; what pulls besides threads has no bound, and then the answer is 0.

        Checked  tests/net_capture/test_sleep.py
        """
        if pulled and pulls_besides(p):
            return 0
        reals = reals_of(work)
        slots = p.node_slots
        zero = splat(0.0)
        nearest = splat(1e300)
        fastest = zero
        farthest = zero
        for i in range(first, first + p.row_pitch, width):
            x = load(reals, i)
            y = load(reals, i + slots)
            z = load(reals, i + 2 * slots)
            dx = x - splat(p.target_place[0])
            dy = y - splat(p.target_place[1])
            dz = z - splat(p.target_place[2])
            u = load(reals, i + P * slots)
            v = load(reals, i + (P + 1) * slots)
            w = load(reals, i + (P + 2) * slots)
            distance = dx * dx + dy * dy + dz * dz
            speed = u * u + v * v + w * w
            place = x * x + y * y + z * z
            nearest = where(distance < nearest, distance, nearest)
            fastest = where(speed > fastest, speed, fastest)
            farthest = where(place > farthest, place, farthest)
        squared = 1e300
        speed = 0.0
        place = 0.0
        for i in range(width):
            squared = min(squared, lane(nearest, np.int64(i)))
            speed = max(speed, lane(fastest, np.int64(i)))
            place = max(place, lane(farthest, np.int64(i)))
        speed = math.sqrt(speed)
        free = math.sqrt(squared) - p.envelope_radius - 1e-6
        free -= stray(p, math.sqrt(place), speed, longest * p.solver_substep)
        if free <= 0.0:
            return 0
        speed += p.contact_haste
        time = free / speed
        if pulled:
            pull = p.contact_pull * p.contact_force
            time = 2.0 * free / (speed + math.sqrt(speed * speed + 2.0 * pull * free))
        return max(int(min(time / p.solver_substep - 2.0, longest)), 0)

    @kernel
    def largest_pull(p, work):
        """How many threads meet at a node at most, over the least mass of one.

        Checked  tests/net_capture/test_sleep.py
        """
        inverse = node_plane(p, work, INVERSE_MASS)
        meeting = node_plane(p, work, FX)
        table = strips(p, work)
        for s in range(0, STRIP_WORDS * p.strips, STRIP_WORDS):
            for j in range(LONGEST_ROW):
                if (table[s + LANES] >> j) & 1:
                    meeting[table[s + A] + j] += 1.0
                    meeting[table[s + B] + j] += 1.0
        most = 0.0
        lightest = 0.0
        for i in range(p.node_slots):
            most = max(most, 1.0 * meeting[i])
            lightest = max(lightest, 1.0 * inverse[i])
            meeting[i] = 0.0
        return most * lightest

    @kernel
    def pulls_besides(p):
        """Whether anything but threads pulls nodes now.

        Checked  tests/net_capture/test_sleep.py
        """
        pulled = False
        if has_closing:
            pulled = p.closing_t_start >= 0.0
        if has_tether:
            pulled = pulled or p.tether_vertex_tension != 0.0
        if drags:
            pulled = pulled or p.tether_drag != 0.0
        if has_load:
            pulled = pulled or p.pull_off_t_start >= 0.0
        if has_self:
            pulled = pulled or p.self_contact_pairs > 0
        return pulled

    @kernel
    def hurries(p):
        """Whether the target has become faster, or a thread tauter, than rows were reckoned with, or something besides
        threads has begun to pull.

        Checked  tests/net_capture/test_search.py, tests/net_capture/test_sleep.py
        """
        besides = 1 if pulls_besides(p) else 0
        tauter = p.contact_force > p.contact_reckoned or besides > p.contact_besides
        p.contact_reckoned = p.contact_force
        p.contact_besides = besides
        speed = math.sqrt(dot(p.target_drift, p.target_drift))
        if speed > p.contact_haste:
            p.contact_haste = 1.5 * speed + HASTE
            return True
        return tauter

    return Search(near, close, largest_pull, clear_steps, hurries)


def make_largest_way(hinge: Any) -> Any:
    """Kernel `largest_way(p, h)` of a target, with the kernels of its appendage that swings, if any."""
    swings = hinge is not None
    reach = hinge.reach if swings else None

    @kernel
    def largest_way(p, h):
        """How far a point within the envelope moves with the target in a substep [m].

        Checked  tests/net_capture/test_contact.py
        """
        turning = math.sqrt(dot(p.target_omega, p.target_omega)) * p.envelope_radius
        if swings:
            turning += abs(p.hinge_speed) * reach(p)
        return h * (math.sqrt(dot(p.target_drift, p.target_drift)) + turning)

    return largest_way
