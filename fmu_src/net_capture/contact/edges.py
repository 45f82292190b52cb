"""The shortest way of a thread between two nodes where the straight one cuts an edge of the target.

The straight way comes in at one point of the surface and goes out at another. The planes that touch the body there meet
in a line, of a polyhedron the edge itself, and the shortest way over it is straight once both planes are laid into one:

    t = (t_a d_b + t_b d_a) / (d_a + d_b),   l^2 = (t_b - t_a)^2 + (d_a + d_b)^2

with d the distances of the ends from that line and t along it. On a body without an edge there the line lies outside,
and the way goes over the point of the surface nearest to it: that falls short of the true way round, by a quarter of
what the straight one does.

Valid    convex bodies; over one edge: a body so thin that a thread lies round two of them it still cuts
Checked  tests/net_capture/test_wrapping.py
"""

from __future__ import annotations

import math
from typing import Any

from orbital.kernel import kernel
from orbital.vectors import cross, dot

SEARCHES = 12
"""Newton steps to the surface: along a line the distance from a convex body is convex, so they come from outside and
never go too far, and to a plane in one."""
AT_SURFACE = 1e-9
"""Metres."""
ALIKE = 1e-3
"""Sine of the angle of two planes that are one."""
OPPOSITE = -0.9
"""Cosine of the angle of two planes between which there lie two edges."""
NEAREST = 1e-4
"""Of the straight way, how near to one of its ends a bend may be: nearer, the end itself lies on the edge."""


def make_bend(composition: Any) -> Any:
    """Kernel `bend(p) -> found` for the composition's target: of the way from `wrap_a` to `wrap_b` in body axes, the
    point `wrap_bend` over which it goes [m].

    Checked  tests/net_capture/test_wrapping.py
    """
    distance_to = composition.target.shape.distance

    @kernel
    def reach(p, out, normal, start, end, length):
        """out = where a straight way comes to the surface, with the normal there; whether it does, and goes in.

        Checked  tests/net_capture/test_wrapping.py
        """
        share = 0.0
        for _ in range(SEARCHES):
            for i in range(3):
                out[i] = start[i] + share * (end[i] - start[i])
            gap = distance_to(p, normal, out)
            inward = (dot(normal, start) - dot(normal, end)) / length
            if inward <= 0.0:
                return False
            if gap <= AT_SURFACE:
                return True
            share += gap / (inward * length)
            if share >= 1.0:
                return False
        return True

    @kernel
    def bend(p):
        """Whether the way bends; then the point over which it goes is in `wrap_bend`, body axes [m].

        Checked  tests/net_capture/test_wrapping.py
        """
        a, b, out, line = p.wrap_a, p.wrap_b, p.wrap_bend, p.wrap_line
        first, last = p.wrap_first, p.wrap_last
        squared = 0.0
        for i in range(3):
            squared += (b[i] - a[i]) * (b[i] - a[i])
        length = math.sqrt(squared)
        if length == 0.0 or not reach(p, out, first, a, b, length):
            return False
        height = dot(first, out)
        if not reach(p, out, last, b, a, length):
            return False
        height_last = dot(last, out)
        alike = dot(first, last)
        cross(line, first, last)
        size = math.sqrt(dot(line, line))
        if size < ALIKE or alike < OPPOSITE:
            return False
        along_a = dot(line, a) / size
        along_b = dot(line, b) / size
        from_first = (height - alike * height_last) / (size * size)
        from_last = (height_last - alike * height) / (size * size)
        off_a = 0.0
        off_b = 0.0
        for i in range(3):
            out[i] = from_first * first[i] + from_last * last[i]
            line[i] /= size
            to_a = a[i] - out[i] - along_a * line[i]
            to_b = b[i] - out[i] - along_b * line[i]
            off_a += to_a * to_a
            off_b += to_b * to_b
        off_a = math.sqrt(off_a)
        off_b = math.sqrt(off_b)
        if min(off_a, off_b) < NEAREST * length:
            return False
        at = (along_a * off_b + along_b * off_a) / (off_a + off_b)
        for i in range(3):
            out[i] += at * line[i]
        gap = distance_to(p, first, out)
        for i in range(3):
            out[i] -= gap * first[i]
        return True

    return bend
