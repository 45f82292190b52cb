"""Stretches of the closing cord that bend round the bodies of a union, as threads do (`wrapping.py`).

The cord runs through rings without friction, and so it does round edges: its way is the sum of those of its
stretches, and its tension is the same in all. The target takes what is left of it at the first and last bend of each. A
stretch that slides over a corner makes it shorter at once; what it held beyond that is lost (`wrap.slip_loss`), and
what it gains by a step from body to body is taken from that. Before the reels run nothing is known of it, and as they
begin each stretch lies on the side of a body that is the nearest.

Checked  tests/net_capture/test_union_wrapping.py
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from fmu_src.net_capture import bodies
from fmu_src.net_capture.capstan import WITH_FRICTION
from fmu_src.net_capture.lying import SHORT, make_lie
from fmu_src.net_capture.near import BENT, FINE, FREE, JUMP, KEPT, SHARE, WAY, make_list_at
from fmu_src.net_capture.planes import FX
from orbital.kernel import kernel
from orbital.rotations import rotate
from orbital.vectors import cross


class CordBends(NamedTuple):
    """Kernels of stretch number n of the cord, between two nodes; places and rates in the planes from these on.

    stretches(p)                                  how many there are
    meet(p, work, n, a, b, slack) -> fall         how it lies now, and keep that; by how much it is shorter at once [m],
                                                  less than 0: longer. slack: however it lies, it may have
                                                  come to lie so
    bent(p, work, n)                              whether it bends
    reach(p, work, n, a, b, place, rate)          length of its way [m] and the rate of that [m/s]
    draw(p, work, n, a, b, place, tension)        a tension [N] in it, and what that gives the target in a substep
    """

    stretches: Any
    meet: Any
    bent: Any
    reach: Any
    draw: Any


def make_cord_bends(composition: Any) -> CordBends | None:
    """Kernels for the composition's target; None where the cord stays straight."""
    terms = composition.terms
    if "wrap" not in terms or "closing" not in terms or composition.target.shape.hulls is None:
        return None
    kept = WITH_FRICTION if terms["wrap"] == "friction" else KEPT
    memory, now = composition.memory, composition.clock.now
    own, node_plane = memory.own, memory.node_plane
    rounds = bodies.make_bodies(composition, kept, make_lie(composition, None), None)
    seek, again, list_at = rounds.seek, rounds.again, make_list_at(composition, kept + bodies.KEPT)
    begin_step, rate_of = composition.contact.begin_step, composition.gravity.rate

    @kernel
    def stretches(p):
        """How many there are.

        Checked  tests/net_capture/test_union_wrapping.py
        """
        return p.net_corners * (p.closing_rings + 1)

    @kernel
    def place_of(p, words, n):
        """Where the state of a stretch stands.

        Checked  tests/net_capture/test_union_wrapping.py
        """
        return list_at(p, words) + p.wrap_numbers + p.thread_numbers + n

    @kernel
    def meet(p, work, n, a, b, slack):
        """How a stretch lies now; what is kept of it goes on by a substep, so it is asked once in each.

        Checked  tests/net_capture/test_union_wrapping.py
        """
        words = own(p, work)
        at = place_of(p, words, n)
        if n == 0:
            begin_step(p, rate_of(p))
        before = words[at]
        expected = FINE * words[at + WAY * p.wrap_numbers]
        edges, way, going, _, _ = seek(p, work, words, at, a, b, 1e9 if slack else 0.0)
        words[at] = BENT if edges > 0 else FREE
        words[at + WAY * p.wrap_numbers] = np.int64((way + p.solver_substep * going) / FINE)
        if before == FREE or abs(way - expected) <= JUMP + SHARE * p.solver_substep * abs(going):
            return 0.0
        p.wrap_slipped += 1
        return expected - way

    @kernel
    def bent(p, work, n):
        """Whether a stretch bends.

        Checked  tests/net_capture/test_union_wrapping.py
        """
        words = own(p, work)
        return words[place_of(p, words, n)] == BENT

    @kernel
    def reach(p, work, n, a, b, place, rate):
        """Length of its way [m] and the rate of that [m/s].

        Checked  tests/net_capture/test_union_wrapping.py
        """
        words = own(p, work)
        edges, way, going, _, _ = again(p, work, words, place_of(p, words, n), a, b, place, rate)
        if edges == 0:
            for axis in range(3):
                v = node_plane(p, work, rate + axis)
                x = node_plane(p, work, place + axis)
                going += (x[b] - x[a]) / max(way, SHORT) * (v[b] - v[a])
        return way, going

    @kernel
    def draw(p, work, n, a, b, place, tension):
        """Draw both nodes along the way, and the target by what is left at its first and last bend.

        Checked  tests/net_capture/test_union_wrapping.py
        """
        words = own(p, work)
        edges, way, _, _, _ = again(p, work, words, place_of(p, words, n), a, b, place, place)
        if edges == 0:
            for axis in range(3):
                x = node_plane(p, work, place + axis)
                pull = tension / max(way, SHORT) * (x[b] - x[a])
                node_plane(p, work, FX + axis)[a] += pull
                node_plane(p, work, FX + axis)[b] -= pull
            return
        for axis in range(3):
            node_plane(p, work, FX + axis)[a] -= tension * p.wrap_first[axis]
            node_plane(p, work, FX + axis)[b] -= tension * p.wrap_last[axis]
            push = p.solver_substep * tension * (p.wrap_first[axis] + p.wrap_last[axis])
            p.target_drift[axis] += push / p.target_mass
            p.wrap_impulse += abs(push)
        for end in range(2):
            rotate(p.wrap_turned, p.target_pose, p.wrap_bends[1 if end == 0 else edges])
            cross(p.wrap_moving, p.wrap_turned, p.wrap_first if end == 0 else p.wrap_last)
            for axis in range(3):
                p.target_spin[axis] += p.solver_substep * tension * p.wrap_moving[axis]
        if p.contact_first_time < 0.0:
            p.contact_first_time = now(p)

    return CordBends(stretches, meet, bent, reach, draw)
