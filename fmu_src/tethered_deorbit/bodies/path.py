"""The shortest way of a line over given edges of a body, from where it is made fast to the other body.

The way runs from the attachment x_0 over points x_i = o_i + t_i d_i of its edges to the other body at x_(k+1), and its
length

    L = min over 0 <= t_i <= l_i of  sum |x_(i+1) - x_i|

is a convex function, whose gradient by the far end is the direction in which the line leaves the last edge: the line
slides without friction, and pulls the body where it leaves it. (A length on the body counts as
sqrt(|..|^2 + e^2), e a millionth of the body, so that it stays smooth where two edges meet at a corner.) Which edges
they are is the business of `wrapping`.

Source   convex minimisation; Newton's method for a tridiagonal Hessian
Checked  tests/tethered_deorbit/test_wrapping.py
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.tethered_deorbit.bodies.polyhedron import NONE, TOGETHER, Polyhedron, at_edge, on_both
from orbital.kernel import kernel
from orbital.vectors import Array, distance, dot

PULL = 1e-11
"""Bend of the line away from the body [rad] from which on it pulls."""
ITERATIONS, HALVINGS = 40, 8
CLOSE = 4.0 * 2.220446049250313e-16
SOFT = 1e-6
"""Share of the body's size by which lengths on it are softened."""


class Path(NamedTuple):
    """Kernels of the way in the record's `path`: over `path.count` edges `path.edges`, at `path.along` on each.

    tighten(record, count) -> L      shortest length [m] over these edges
    leave(record, count) -> count    once the edge on which the line pulls most is left; -1 if it presses on all
    insert(record, count, place, edge, along)   put an edge into the way
    show(record, total)              where the line leaves the body, and how much of its length lies on it
    follow(record)                   the way to `path.far` over the edges that are held
    keep(record)                     hold the edges of this way
    sound(record) -> bool            whether the line presses on all its edges, and passes nowhere through the body
    The others as of `wrapping.Wrapping`.
    """

    tighten: Callable[..., Any]
    leave: Callable[..., Any]
    insert: Callable[..., Any]
    show: Callable[..., Any]
    follow: Callable[..., Any]
    keep: Callable[..., Any]
    sound: Callable[..., Any]
    relief: Callable[..., Any]
    pivot: Callable[..., Any]
    publish: Callable[..., Any]
    differentiate: Callable[..., Any]


def make_path(polyhedron: Polyhedron) -> Path:
    """The kernels for a way round this body."""
    outward, passes = polyhedron.outward, polyhedron.passes

    @kernel
    def measure(record: Any, count: int) -> float:
        """Length of the way [m]; fills its points, directions and lengths. What lies on the body is softened.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        points, ways, lengths = r.path_points, r.path_ways, r.path_lengths
        total = 0.0
        for k in range(count):
            at_edge(record, points[k + 1], r.path_edges[k], r.path_along[k])
        for k in range(count + 1):
            square = 0.0
            for i in range(3):
                ways[k][i] = points[k + 1][i] - points[k][i]
                square += ways[k][i] * ways[k][i]
            soft = SOFT * r.state_extent if k < count else 0.0
            lengths[k] = max(math.sqrt(square + soft * soft), 1.0e-12 * r.state_extent)
            for i in range(3):
                ways[k][i] /= lengths[k]
            total += lengths[k]
        return total

    @kernel
    def tighten(record: Any, count: int) -> float:
        """Shortest length [m] of a way over its edges, by Newton's method held within the edges.

        Checked  tests/tethered_deorbit/test_wrapping.py, against scipy
        """
        r = record[0]
        ways, lengths = r.path_ways, r.path_lengths
        diagonal, beside, change = r.path_diagonal, r.path_beside, r.path_change
        total = measure(record, count)
        if count == 0:
            return total
        for _ in range(ITERATIONS):
            for k in range(count):
                direction = r.state_edges[r.path_edges[k]][3:6]
                into, out = dot(direction, ways[k]), dot(direction, ways[k + 1])
                gradient = into - out
                diagonal[k] = (1.0 - into * into) / lengths[k] + (1.0 - out * out) / lengths[k + 1]
                beside[k] = 0.0
                along, end = r.path_along[k], r.state_edges[r.path_edges[k]][6]
                held = (along <= 0.0 and gradient > 0.0) or (along >= end and gradient < 0.0)
                r.path_held[k] = 1 if held else 0
                change[k] = 0.0 if held else -gradient
                if held:
                    diagonal[k] = 1.0
                elif k > 0 and r.path_held[k - 1] == 0:
                    before = r.state_edges[r.path_edges[k - 1]][3:6]
                    beside[k] = (dot(before, ways[k]) * into - dot(before, direction)) / lengths[k]
            for k in range(count):
                if k > 0:
                    factor = beside[k] / diagonal[k - 1]
                    diagonal[k] -= factor * beside[k]
                    change[k] -= factor * change[k - 1]
                diagonal[k] = max(diagonal[k], 1.0e-9 / lengths[k])
            largest = 0.0
            for j in range(count):
                k = count - 1 - j
                following = beside[k + 1] * change[k + 1] if k + 1 < count else 0.0
                change[k] = (change[k] - following) / diagonal[k]
            share = 1.0
            for k in range(count):
                r.path_before[k] = r.path_along[k]
            for _ in range(HALVINGS):
                largest = 0.0
                for k in range(count):
                    end = r.state_edges[r.path_edges[k]][6]
                    moved = min(end, max(0.0, r.path_before[k] + share * change[k]))
                    largest = max(largest, abs(moved - r.path_before[k]))
                    r.path_along[k] = moved
                shorter = measure(record, count)
                if shorter <= total * (1.0 + CLOSE):
                    break
                share *= 0.25
            total = shorter
            if largest <= CLOSE * r.state_extent:
                break
        return total

    @kernel
    def pulling(record: Any, count: int) -> int:
        """Place of the edge on which the line pulls most and does not press, or from which it turns back; or -1.

            (u_(i+1) - u_i) . (n_a + n_b + ..) < 0,   n the normals of the faces that meet there, u the directions
                                                      before and after a corner as a whole

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        worst, most, normal = NONE, PULL, r.path_room[0]
        for k in range(1, count):
            here, next_edge = r.path_edges[k], r.path_edges[min(k + 1, count - 1)]
            if here == r.path_edges[k - 1] or (k + 1 < count and next_edge == r.path_edges[k - 1]):
                return k
        for k in range(count):
            before, after = k, k + 1
            while before > 0 and r.path_lengths[before] <= TOGETHER * r.state_extent:
                before -= 1
            while after < count and r.path_lengths[after] <= TOGETHER * r.state_extent:
                after += 1
            outward(record, normal, r.path_points[k + 1])
            pull = 0.0
            for i in range(3):
                pull += (r.path_ways[after][i] - r.path_ways[before][i]) * normal[i]
            if pull > most:
                worst, most = k, pull
        return worst

    @kernel
    def leave(record: Any, count: int) -> int:
        """Number of edges once the one on which the line pulls most is left; -1 if it presses on all.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        worst = pulling(record, count)
        if worst == NONE:
            return NONE
        for k in range(worst, count - 1):
            r.path_edges[k] = r.path_edges[k + 1]
            r.path_along[k] = r.path_along[k + 1]
        return count - 1

    @kernel
    def insert(record: Any, count: int, place: int, edge: int, along: float) -> None:
        """Put an edge into the way, before the one at `place`.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        for j in range(count - place):
            k = count - j
            r.path_edges[k] = r.path_edges[k - 1]
            r.path_along[k] = r.path_along[k - 1]
        r.path_edges[place] = edge
        r.path_along[place] = min(r.state_edges[edge][6], max(0.0, along))

    @kernel
    def show(record: Any, total: float) -> None:
        """Where the line leaves the body [m], and how much of its length [m] lies on it.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        for i in range(3):
            r.state_departure[i] = r.path_points[r.path_count][i]
        r.state_wrapped = total - r.path_lengths[r.path_count]

    @kernel
    def follow(record: Any) -> None:
        """The way to the far end over the edges that are held.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        r.path_count = r.held_count
        for k in range(r.held_count):
            r.path_edges[k] = r.held_edges[k]
            r.path_along[k] = r.held_along[k]
        for i in range(3):
            r.path_points[0][i] = r.target_attachment[i]
            r.path_points[r.held_count + 1][i] = r.path_far[i]
        show(record, tighten(record, r.held_count))

    @kernel
    def keep(record: Any) -> None:
        """The way last followed becomes that of the step's begin.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        r.held_count = r.path_count
        for k in range(r.path_count):
            r.held_edges[k] = r.path_edges[k]
            r.held_along[k] = r.path_along[k]

    @kernel
    def sound(record: Any) -> bool:
        """Whether the line presses on all edges of the way last followed, and passes nowhere through the body.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        count = r.path_count
        if pulling(record, count) != NONE:
            return False
        for k in range(count + 1):
            if 0 < k < count and on_both(record, r.path_edges[k - 1], r.path_edges[k]):
                continue
            through, face_in, face_out, _, _ = passes(record, r.path_points[k], r.path_points[k + 1])
            if through and face_in != face_out:
                return False
        return True

    @kernel
    def sliding(record: Any, across: Array) -> float:
        """How fast the line slides along the last edge [m/s]: see `Wrapping`.

            t' = d . w/(l p),   d the last edge, p the last pivot of the Hessian, w across the line of length l

        Source   Schur complement of the Hessian of the length
        Checked  tests/tethered_deorbit/test_wrapping.py, against differences
        """
        r = record[0]
        last = r.path_count - 1
        if last < 0 or r.path_held[last] == 1:
            return 0.0
        direction = r.state_edges[r.path_edges[last]][3:6]
        return float(dot(direction, across) / (r.path_lengths[last + 1] * r.path_diagonal[last]))

    @kernel
    def relief(record: Any, across: Array) -> float:
        """What that takes off the second derivative of the length [m/s^2]: t'^2 p.

        Checked  tests/tethered_deorbit/test_wrapping.py, against differences
        """
        r = record[0]
        speed = sliding(record, across)
        return float(speed * speed * r.path_diagonal[max(0, r.path_count - 1)])

    @kernel
    def pivot(record: Any, across: Array) -> None:
        """The point, in `state.pivot`, about which the far end turns for the moment, as a straight line would have it.

            x = x_k - u (h - |x_(k+1) - x_k|),   h = w^2/(w^2/|x_(k+1) - x_k| - t'^2 p),   u the direction of the line

        A line that slides turns about a point behind that where it leaves the body: were it straight from there, its
        length would have the second derivative that it has. No farther behind than it is long.

        across        w      velocity of the far end across the line, body axes   [m/s]  (3,)

        Checked  tests/tethered_deorbit/test_wrapping.py: steps of a line that slides
        """
        r = record[0]
        last = r.path_count
        free, square = r.path_lengths[last], dot(across, across)
        behind = 0.0
        if square > 0.0 and last > 0:
            rest = max(square / free - relief(record, across), square / (free + r.state_wrapped))
            behind = square / rest - free
        for i in range(3):
            r.state_pivot[i] = r.path_points[last][i] - behind * r.path_ways[last][i]

    @kernel
    def publish(record: Any) -> None:
        """Length on the body, straight distance of the attachments, and the number of edges; after `follow`.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        r.tether_wrapped = r.state_wrapped
        r.tether_bends = r.path_count
        r.tether_span = distance(r.path_points[r.path_count + 1], r.path_points[0])

    @kernel
    def differentiate(record: Any, along: Array, across: Array) -> None:
        """Their rates [m/s], from parts of the velocity of the far end as the body sees it; after `follow`.

            wrapped' = t' d . u,   span' = (w_along + w_across) . s/|s|,   s from the one attachment to the other

        Checked  tests/tethered_deorbit/test_wrapping.py, against differences
        """
        r = record[0]
        last = r.path_count - 1
        r.rate_wrapped = 0.0
        if last >= 0:
            direction = r.state_edges[r.path_edges[last]][3:6]
            r.rate_wrapped = sliding(record, across) * dot(direction, r.path_ways[last + 1])
        r.rate_span = 0.0
        size = distance(r.path_points[r.path_count + 1], r.path_points[0])
        if size > 0.0:
            for i in range(3):
                straight = (r.path_points[r.path_count + 1][i] - r.path_points[0][i]) / size
                r.rate_span += straight * (along[i] + across[i])

    return Path(tighten, leave, insert, show, follow, keep, sound, relief, pivot, publish, differentiate)
