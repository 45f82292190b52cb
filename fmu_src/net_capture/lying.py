"""How a thread lies that bends round one convex body: its way, and how fast that gets longer."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from fmu_src.net_capture.contact.chain import KEPT, LOST, WOUND
from fmu_src.net_capture.contact.edges import make_way
from fmu_src.net_capture.contact.section import FACES, MOST
from fmu_src.net_capture.planes import STRIP_WORDS, A, B
from orbital.kernel import kernel
from orbital.rotations import rotate, rotate_inverse
from orbital.vectors import cross, distance

SHORT = 1e-12
"""Metres: a piece no shorter than that, where it is divided by."""


class Lie(NamedTuple):
    """Kernels of a thread between two nodes a and b, or whose strip and number in it are in `code`, by their places and
    rates in the planes from `place` and `rate` on.

    find(p, edges)                             see `contact.edges.make_way`
    ends(p, work, code)                        its nodes
    stand(p, work, a, b, place)                its ends into `wrap_a` and `wrap_b`, body axes
    reckon(p, work, a, b, place, rate, edges)  of its way over so many edges, which is in `wrap_bends`: as `look`
    look(p, work, code, place, rate, edges)    how many edges it bends over; length and rate of its way and of the
                                               straight one [m], [m/s]
    lose(p, before, edges, taut)               count a thread whose way could not go on, if that was so
    """

    find: Any
    ends: Any
    stand: Any
    reckon: Any
    look: Any
    lose: Any


def make_lie(composition: Any, remember: Any) -> Lie:
    """Kernels for the composition's net and target; `remember` of the capstan, None without friction."""
    memory = composition.memory
    node_plane, strips = memory.node_plane, memory.strips
    rubs = remember is not None
    find = make_way(composition.target.shape.hulls)

    @kernel
    def ends(p, work, code):
        """Its two nodes.

        Checked  tests/net_capture/test_wrapping.py
        """
        s = STRIP_WORDS * (code // 64)
        table = strips(p, work)
        return table[s + A] + code % 64, table[s + B] + code % 64

    @kernel
    def stand(p, work, a, b, place):
        """Both ends of a thread, body axes.

        Checked  tests/net_capture/test_wrapping.py
        """
        for axis in range(3):
            x = node_plane(p, work, place + axis)
            p.wrap_first[axis] = x[a] - p.target_place[axis]
            p.wrap_last[axis] = x[b] - p.target_place[axis]
        rotate_inverse(p.wrap_a, p.target_pose, p.wrap_first)
        rotate_inverse(p.wrap_b, p.target_pose, p.wrap_last)

    @kernel
    def reckon(p, work, a, b, place, rate, edges):
        """Directions from the first and last bend to its ends are in `wrap_first` and `wrap_last` then, and from end to
        end in `wrap_line`, frame axes.

        Checked  tests/net_capture/test_wrapping.py
        """
        first, last, line, turned = p.wrap_first, p.wrap_last, p.wrap_line, p.wrap_turned
        for axis in range(3):
            x = node_plane(p, work, place + axis)
            first[axis] = x[a] - p.target_place[axis]
            last[axis] = x[b] - p.target_place[axis]
        way = 0.0
        for j in range(edges + 1):
            way += p.wrap_pieces[j, 3]
        going = 0.0
        for end in range(2):
            before = going
            bend, out, node = (1, first, a) if end == 0 else (edges, last, b)
            rotate(turned, p.target_pose, p.wrap_bends[bend])
            cross(p.wrap_moving, p.target_omega, turned)
            squared = 0.0
            for axis in range(3):
                out[axis] -= turned[axis]
                squared += out[axis] * out[axis]
            for axis in range(3):
                out[axis] /= max(math.sqrt(squared), SHORT)
                v = node_plane(p, work, rate + axis)
                going += out[axis] * (v[node] - p.target_drift[axis] - p.wrap_moving[axis])
            if rubs:
                p.wrap_rates[end] = going - before
        squared = 0.0
        for axis in range(3):
            x = node_plane(p, work, place + axis)
            line[axis] = x[b] - x[a]
            squared += line[axis] * line[axis]
        straight = math.sqrt(squared)
        closing = 0.0
        for axis in range(3):
            line[axis] /= max(straight, SHORT)
            v = node_plane(p, work, rate + axis)
            closing += line[axis] * (v[b] - v[a])
        return edges, way, going, straight, closing

    @kernel
    def name(p, edges):
        """The edges of a way over the faces in `wrap_chain`, by these.

        Checked  tests/net_capture/test_capstan.py
        """
        for j in range(edges):
            p.wrap_names[j] = FACES * p.wrap_chain[j] + p.wrap_chain[j + 1]

    @kernel
    def look(p, work, code, place, rate, edges):
        """How a thread lies now that bent over so many edges before, between the faces in `wrap_chain`.

        Checked  tests/net_capture/test_wrapping.py
        """
        a, b = ends(p, work, code)
        stand(p, work, a, b, place)
        if rubs:
            name(p, edges)
            remember(p)
        edges = find(p, edges)
        if rubs:
            name(p, edges)
        if edges == 0:
            return 0, distance(p.wrap_a, p.wrap_b), 0.0, 0.0, 0.0
        return reckon(p, work, a, b, place, rate, edges)

    @kernel
    def lose(p, before, edges, taut):
        """Count a thread of which it is not known any more how it lies, or that has come to be wound over more edges
        than are kept.

        before, edges    over how many it bent, and bends
        taut             whether it was

        Checked  tests/net_capture/test_hooked_threads.py
        """
        if p.wrap_lost == KEPT or (p.wrap_lost == WOUND and before == MOST):
            return
        if p.wrap_lost == LOST and edges > 0 and taut:
            return
        if taut:
            p.wrap_passed += 1
        else:
            p.wrap_passed_slack += 1

    return Lie(find, ends, stand, reckon, look, lose)
