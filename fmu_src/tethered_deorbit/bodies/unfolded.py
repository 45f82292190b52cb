"""The shortest way over edges in closed form: the faces it crosses laid out in one plane, in which it is straight.

Turned about each edge into the plane of the next, the attachment comes to lie beside the last edge, at a along it and p
from it. With the far end at b along it and q from it, the line leaves the edge at

    t = (a q + b p)/(p + q),   L = sqrt((b - a)^2 + (p + q)^2)

What `path` finds in this place by Newton's method counts each length on the body as sqrt(|..|^2 + e^2). Over one edge
that is p in place of sqrt(p^2 + e^2); over several it is added to first order,

    L += c(t),   t -= c'(t)/L''(t),   c = e^2/2 sum 1/|x_(i+1) - x_i|

Valid    edges that have faces in common, one with the next; a way that meets none of them at a corner or near one
Source   the plane development of a polyhedron, and reflection
Checked  tests/tethered_deorbit/test_way.py, against `path`
"""

from __future__ import annotations

import math
from typing import Any

from fmu_src.tethered_deorbit.bodies.path import SOFT
from fmu_src.tethered_deorbit.bodies.polyhedron import at_edge, on_both
from orbital.kernel import kernel
from orbital.vectors import Array, dot

SHORT = 1e-3
"""Share of the body's size below which a length on it is left to `path`: what is left out is of fourth order in e."""
ASIDE = 1e-6
"""Share below which a point counts as lying on an edge."""


@kernel
def beside(record: Any, edge: int, point: Array, across: Array) -> tuple[float, float]:
    """A point along an edge [m] and its distance from it [m]; `across` becomes the way from the edge to it [m].

    Checked  tests/tethered_deorbit/test_way.py
    """
    row = record[0].state_edges[edge]
    along = 0.0
    for i in range(3):
        across[i] = point[i] - row[i]
        along += across[i] * row[3 + i]
    square = 0.0
    for i in range(3):
        across[i] -= along * row[3 + i]
        square += across[i] * across[i]
    return along, math.sqrt(square)


@kernel
def unfold(record: Any) -> None:
    """The attachment and all edges held but the last in the plane of the last, and between which points of that they
    let the way pass: what `follow_unfolded` needs, once for these edges.

    Checked  tests/tethered_deorbit/test_way.py
    """
    r = record[0]
    count, small = r.held_count, ASIDE * r.state_extent
    r.unfolded_usable = 0
    if count == 0:
        return
    ahead, back = r.path_room[0], r.path_room[1]
    along, off = beside(record, r.held_edges[0], r.target_attachment, ahead)
    ends = r.unfolded_ends
    for k in range(1, count):
        edge, next_edge = r.held_edges[k - 1], r.held_edges[k]
        if edge == next_edge or not on_both(record, edge, next_edge):
            return
        here, there = r.state_edges[edge], r.state_edges[next_edge]
        for i in range(2):
            ends[2 * k - 2 + i][0] = i * here[6]
            ends[2 * k - 2 + i][1] = 0.0
        # directions in their plane: across the one edge towards the middle of the other, across that from this one
        middle = r.path_room[2]
        for i in range(3):
            middle[i] = there[i] + 0.5 * there[6] * there[3 + i]
        _, towards = beside(record, edge, middle, ahead)
        for i in range(3):
            middle[i] = here[i] + 0.5 * here[6] * here[3 + i]
        _, beyond = beside(record, next_edge, middle, back)
        if not (towards > small and beyond > small):
            return
        first, second = 0.0, 0.0
        for i in range(3):
            ahead[i] /= towards
            back[i] /= -beyond
            first += (here[i] - there[i]) * there[3 + i]
            second += (here[i] - there[i]) * back[i]
        turn, lean = dot(here[3:6], there[3:6]), dot(ahead, there[3:6])
        rise, fall = dot(here[3:6], back), dot(ahead, back)
        along, off = first + along * turn - off * lean, off * fall - second - along * rise
        for j in range(2 * k):
            u, v = ends[j][0], ends[j][1]
            ends[j][0] = first + u * turn - v * lean
            ends[j][1] = v * fall - second - u * rise
    low, high = 0.0, r.state_edges[r.held_edges[count - 1]][6]
    for k in range(count - 1):
        one, other = ends[2 * k], ends[2 * k + 1]
        if not (off - one[1] > small and off - other[1] > small):
            return
        through = along + (one[0] - along) * off / (off - one[1])
        last = along + (other[0] - along) * off / (off - other[1])
        low, high = max(low, min(through, last)), min(high, max(through, last))
        across, down = other[0] - one[0], one[1] - other[1]
        r.unfolded_edges[k][0] = (one[0] - along) * down - (off - one[1]) * across
        r.unfolded_edges[k][1] = across
        r.unfolded_edges[k][2] = down
    soft = SOFT * r.state_extent
    r.unfolded_along = along
    r.unfolded_off = math.sqrt(off * off + soft * soft) if count == 1 else off
    r.unfolded_low = low
    r.unfolded_high = high
    r.unfolded_usable = 1 if off > 0.0 or count == 1 else 0


@kernel
def straight(record: Any) -> None:
    """The way to `path.far` over no edge.

    Checked  tests/tethered_deorbit/test_way.py
    """
    r = record[0]
    begin, far, way = r.target_attachment, r.path_far, r.path_ways[0]
    square = 0.0
    for i in range(3):
        way[i] = far[i] - begin[i]
        square += way[i] * way[i]
        r.path_points[0][i] = begin[i]
        r.path_points[1][i] = far[i]
        r.state_departure[i] = begin[i]
    length = max(math.sqrt(square), 1.0e-12 * r.state_extent)
    for i in range(3):
        way[i] /= length
    r.path_count = 0
    r.path_lengths[0] = length
    r.state_wrapped = 0.0


@kernel
def follow_unfolded(record: Any, whole: bool) -> bool:
    """The way to `path.far` over the edges held; false where it cannot be had so.

    whole    fill all that is asked of a way, over several edges but for its points on those before the last; else only
             where it leaves the body, and its length there

    Checked  tests/tethered_deorbit/test_way.py, against `path`
    """
    r = record[0]
    count = r.held_count
    if count == 0:
        if whole:
            straight(record)
        else:
            for i in range(3):
                r.state_departure[i] = r.target_attachment[i]
            r.state_wrapped = 0.0
        return True
    if r.unfolded_usable == 0:
        return False
    last = count - 1
    edge = r.held_edges[last]
    a, p = r.unfolded_along, r.unfolded_off
    far = r.path_points[count + 1]
    b, q = beside(record, edge, r.path_far, far)
    if not q > ASIDE * r.state_extent:
        return False
    t = (a * q + b * p) / (p + q)
    if not r.unfolded_low < t < r.unfolded_high:
        return False
    on_body, total = math.sqrt((t - a) * (t - a) + p * p), math.sqrt((b - a) * (b - a) + (p + q) * (p + q))
    free = math.sqrt((b - t) * (b - t) + q * q)
    into, out = (t - a) / on_body, (b - t) / free
    bend = (1.0 - into * into) / on_body + (1.0 - out * out) / free
    if count > 1:
        before, moved_before, inverses, slope = 0.0, 0.0, 0.0, 0.0
        for k in range(count):
            here, moved = 1.0, 0.0
            if k < last:
                row = r.unfolded_edges[k]
                inverse = 1.0 / ((t - a) * row[2] - p * row[1])
                here = row[0] * inverse
                moved = -here * row[2] * inverse
            length = (here - before) * on_body
            if not length > SHORT * r.state_extent:
                return False
            inverses += 1.0 / length
            slope -= ((moved - moved_before) * on_body + (here - before) * into) / (length * length)
            before, moved_before = here, moved
        soft = 0.5 * SOFT * SOFT * r.state_extent * r.state_extent
        total += soft * inverses
        t -= soft * slope / bend
        free = math.sqrt((b - t) * (b - t) + q * q)
    r.state_wrapped = total - free
    at_edge(record, r.state_departure, edge, t)
    if not whole:
        return True
    r.path_count = count
    r.path_edges[last] = edge
    r.path_along[last] = t
    r.path_held[last] = 0
    r.path_diagonal[last] = bend
    r.path_lengths[count] = free
    for i in range(3):
        r.path_points[count][i] = r.state_departure[i]
        r.path_points[0][i] = r.target_attachment[i]
        r.path_points[count + 1][i] = r.path_far[i]
        r.path_ways[count][i] = (r.path_far[i] - r.path_points[count][i]) / free
    if count == 1:
        r.path_lengths[0] = on_body
        for i in range(3):
            r.path_ways[0][i] = (r.path_points[1][i] - r.path_points[0][i]) / on_body
    return True
