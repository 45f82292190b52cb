"""The shortest way over edges of a body, taken in order: each where it is crossed, by Newton's method.

    l = sum |r_(j+1) - r_j|,   r_j = P_j + tau_j e_j,   tau_j between both ends of its edge

l is convex in all tau together, and its second derivatives couple neighbours alone. A point at an end of its edge that
would go on stays there. Newton's step is halved where it would make the way longer, and where that does not help, one
point is moved after another.

Where edges meet at a corner that the way comes near, l has creases, across which all this goes to and fro. A way that
has not come to rest is sought again with pieces of sqrt(|r_(j+1) - r_j|^2 + soft^2), which have none, and soft is taken
back to nothing.

Checked  tests/net_capture/test_wrapping.py
"""

from __future__ import annotations

import math
from typing import Any

from orbital.kernel import kernel

STEPS, HALVES = 40, 4
"""Of Newton's method at most, and how often one is halved."""
SOFTEST, HARDER, HARDEST = 1e-2, 0.1, 1e-6
"""Metres at first, of this share the next time, and no less."""
AT_REST = 1e-11
"""Slope dl/dtau at which a way is the shortest: it is then too long by less than its square times the way."""
GAIN = 1e-12
"""Metres by which a way sought again is shorter, or the one before is kept."""
SHORT = 1e-7
"""Metres: a piece of the way no shorter than that, where it is divided by."""
TAU, LOW, HIGH, SLOPE = range(4)
"""Columns of `wrap_spans`: where the way crosses an edge, both its ends [m], and dl/dtau."""


@kernel
def along(p, piece, edge):
    """Cosine of the angle between a piece of the way and an edge.

    Checked  tests/net_capture/test_wrapping.py
    """
    u, e = p.wrap_pieces[piece], p.wrap_edges[edge]
    return u[0] * e[0] + u[1] * e[1] + u[2] * e[2]


def make_shortest() -> Any:
    """Kernel `settle(p, edges)` of a way over so many edges, from `wrap_bends[0]` to `wrap_bends[edges + 1]`.

    Checked  tests/net_capture/test_wrapping.py
    """

    @kernel
    def measure(p, edges):
        """Length of the way [m]; its points into `wrap_bends`, direction and length of every piece into `wrap_pieces`.

        Checked  tests/net_capture/test_wrapping.py
        """
        for j in range(edges):
            for i in range(3):
                p.wrap_bends[j + 1, i] = p.wrap_feet[j, i] + p.wrap_spans[j, TAU] * p.wrap_edges[j, i]
        total = 0.0
        for j in range(edges + 1):
            squared = p.wrap_soft * p.wrap_soft
            piece = p.wrap_pieces[j]
            for i in range(3):
                piece[i] = p.wrap_bends[j + 1, i] - p.wrap_bends[j, i]
                squared += piece[i] * piece[i]
            piece[3] = math.sqrt(squared)
            total += piece[3]
            for i in range(3):
                piece[i] /= max(piece[3], 1e-300)
        return total

    @kernel
    def step(p, edges):
        """Newton's step of every tau into `wrap_steps` [m]; the largest slope of those that are free.

        Checked  tests/net_capture/test_wrapping.py
        """
        steps, spans = p.wrap_steps, p.wrap_spans
        largest = 0.0
        for j in range(edges):
            before, after = along(p, j, j), along(p, j + 1, j)
            near, far = max(p.wrap_pieces[j, 3], SHORT), max(p.wrap_pieces[j + 1, 3], SHORT)
            slope = before - after
            spans[j, SLOPE] = slope
            steps[j, 1] = 0.0
            steps[j, 3] = 1.0
            if (spans[j, TAU] <= spans[j, LOW] and slope > 0.0) or (spans[j, TAU] >= spans[j, HIGH] and slope < 0.0):
                steps[j, 0] = 1.0
                steps[j, 2] = 0.0
                steps[j, 3] = 0.0
                continue
            largest = max(largest, abs(slope))
            steps[j, 0] = (1.0 - before * before) / near + (1.0 - after * after) / far + 1e-9
            steps[j, 2] = -slope
            if j + 1 < edges:
                e, f = p.wrap_edges[j], p.wrap_edges[j + 1]
                steps[j, 1] = (after * along(p, j + 1, j + 1) - e[0] * f[0] - e[1] * f[1] - e[2] * f[2]) / far
        for j in range(1, edges):
            if steps[j, 3] == 0.0 or steps[j - 1, 3] == 0.0:
                steps[j - 1, 1] = 0.0
            share = steps[j - 1, 1] / steps[j - 1, 0]
            steps[j, 0] = max(steps[j, 0] - share * steps[j - 1, 1], 1e-9)
            steps[j, 2] -= share * steps[j - 1, 2]
        for j in range(edges - 1, -1, -1):
            if j + 1 < edges:
                steps[j, 2] -= steps[j, 1] * steps[j + 1, 2]
            steps[j, 2] /= steps[j, 0]
        return largest

    @kernel
    def sweep(p, edges):
        """Put one point after another where the way between its neighbours is straight once laid flat; the length [m].

            tau = (t_a d_b + t_b d_a) / (d_a + d_b),   d the distances of both neighbours from the edge, t along it

        Never longer than before, and far from the shortest way, where Newton's step is useless, much shorter.

        Checked  tests/net_capture/test_wrapping.py
        """
        for j in range(edges):
            edge, foot, span = p.wrap_edges[j], p.wrap_feet[j], p.wrap_spans[j]
            at = 0.0
            off = 0.0
            for side in range(2):
                along_it = 0.0
                squared = 0.0
                for i in range(3):
                    away = p.wrap_bends[j + 2 * side, i] - foot[i]
                    along_it += away * edge[i]
                    squared += away * away
                across = math.sqrt(max(squared - along_it * along_it, 0.0))
                if side == 0:
                    before, near = along_it, across
                else:
                    at = before * across + along_it * near
                    off = near + across
            if off > 0.0:
                span[TAU] = min(max(at / off, span[LOW]), span[HIGH])
            for i in range(3):
                p.wrap_bends[j + 1, i] = foot[i] + span[TAU] * edge[i]
        return measure(p, edges)

    @kernel
    def newton(p, edges, length):
        """Take Newton's steps from a way of this length [m], with the slopes of where they end; whether it is at rest.

        Checked  tests/net_capture/test_wrapping.py
        """
        spans = p.wrap_spans
        for _ in range(STEPS):
            if step(p, edges) < AT_REST:
                return True
            for j in range(edges):
                p.wrap_steps[j, 1] = spans[j, TAU]
            share = 1.0
            now = length
            for _ in range(HALVES):
                for j in range(edges):
                    moved = p.wrap_steps[j, 1] + share * p.wrap_steps[j, 2]
                    spans[j, TAU] = min(max(moved, spans[j, LOW]), spans[j, HIGH])
                now = measure(p, edges)
                if now <= length:
                    break
                share *= 0.5
            if now >= length:
                for j in range(edges):
                    spans[j, TAU] = p.wrap_steps[j, 1]
                now = measure(p, edges)
                if p.wrap_soft == 0.0:
                    now = sweep(p, edges)
                if now >= length:
                    break
            length = now
        return step(p, edges) < AT_REST

    @kernel
    def settle(p, edges):
        """Put every point of the way where it is the shortest, between the ends of its edge; its length [m], and its
        slopes.

        Checked  tests/net_capture/test_wrapping.py
        """
        spans = p.wrap_spans
        p.wrap_soft = 0.0
        measure(p, edges)
        if newton(p, edges, sweep(p, edges)):
            return measure(p, edges)
        least = measure(p, edges)
        for j in range(edges):
            p.wrap_taken[j] = spans[j, TAU]
        soft = SOFTEST
        while soft >= HARDEST:
            p.wrap_soft = soft
            newton(p, edges, measure(p, edges))
            soft *= HARDER
        p.wrap_soft = 0.0
        newton(p, edges, measure(p, edges))
        way = measure(p, edges)
        if way > least - GAIN:
            for j in range(edges):
                spans[j, TAU] = p.wrap_taken[j]
            way = measure(p, edges)
        step(p, edges)
        return way

    return settle
