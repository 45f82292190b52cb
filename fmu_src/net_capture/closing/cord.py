"""A cord between neighbouring reels, which runs along the mouth's rim through rings: its way, and how it draws.

Reels stand at the bullets, or `closing.reels_at` stretches farther along the rim; a ring is then at each bullet.

Whatever shortens it: its length, and so its tension, is the drive's.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from fmu_src.net_capture.formulas import ring_radius
from fmu_src.net_capture.planes import FX, SHOWN, SHOWN_RATE, P, X
from orbital.kernel import kernel


class Cord(NamedTuple):
    """Kernels of the cord of pair i, from reel i to the next.

    pieces(p, work, i)               pieces of thread on the rim between the two [1]
    rouse(p, work)                   all nodes that it draws stand where they are now, and are kicked in this substep
    meet(p, work, i, slack)          how it lies round the target now, once in a substep; by how much it is shorter at
                                     once, less than 0: longer [m], see `CordBends`; None where it stays straight
    along, along_shown (p, work, i)  its way [m] and the rate of that [m/s], now and of what is shown
    draw, draw_shown (p, work, i, tension)   the same tension in every stretch: rings have no friction
    burden(p, work, i, stiffness, dashpot, tension, span)   what it brings to its knots; None where no pace asks
    """

    pieces: Any
    rouse: Any
    meet: Any
    along: Any
    along_shown: Any
    draw: Any
    draw_shown: Any
    burden: Any


@kernel
def stops(p):
    """Stretches of one pair's cord: from reel to ring to reel.

    Checked  tests/net_capture/test_closing.py
    """
    return p.closing_rings + 1


def make_cord(composition: Any) -> Cord:
    """Kernels of the cord along the rim of the composition's net."""
    memory, rouse_node = composition.memory, composition.rouse
    node_plane, rim, corners = memory.node_plane, memory.rim, memory.corners
    meets = composition.meeting is not None
    meet = composition.meeting.meet_both if meets else None
    bends = composition.cord_bends is not None
    lie, bent, reach, draw_bent = composition.cord_bends[1:] if bends else (None,) * 4

    @kernel
    def pieces(p, work, i):
        """Pieces of thread on the rim from bullet i to the next [1].

        Checked  tests/net_capture/test_closing.py
        """
        last = corners(p, work)[i + 1] if i + 1 < p.net_corners else p.rim_nodes
        return last - corners(p, work)[i]

    @kernel
    def cord_stop(p, work, i, stop):
        """Node at which a stretch of the i-th pair's cord begins: stop 0 is reel i, the last is the next reel.

        Checked  tests/net_capture/test_closing.py, tests/net_capture/test_springs.py
        """
        place = stop + p.closing_reels_at
        side = (i + place // stops(p)) % p.net_corners
        place %= stops(p)
        at = corners(p, work)[side] + (2 * place * pieces(p, work, side) + stops(p)) // (2 * stops(p))
        return rim(p, work)[at if at < p.rim_nodes else 0]

    @kernel
    def rouse(p, work):
        """Every node that the cord draws stands where it is now, and is kicked in this substep.

        Checked  tests/net_capture/test_sleep.py
        """
        for i in range(p.net_corners):
            for stop in range(stops(p)):
                rouse_node(p, work, cord_stop(p, work, i, stop))

    @kernel
    def meet_target(p, work, i, slack):
        """How the i-th pair's cord lies round the target now; by how much it is shorter at once [m], less
        than 0: longer.

        Checked  tests/net_capture/test_union_wrapping.py, tests/net_capture/test_slip_loss.py
        """
        fallen = 0.0
        for stop in range(stops(p)):
            a, b = cord_stop(p, work, i, stop), cord_stop(p, work, i, stop + 1)
            fallen += lie(p, work, i * stops(p) + stop, a, b, slack)
        return fallen

    def make_way(place: int, velocity: int) -> Any:
        """Kernel `along_cord` of the positions and velocities in the planes from these on."""

        @kernel
        def along_cord(p, work, i):
            """Way of the i-th pair's cord from bullet through the rings to bullet [m], and its rate [m/s].

                s = sum over the stretches of sqrt(d^2 + b^2)

            d  between two stops, b  how near to a ring's middle it passes: a stretch pulls with T d / sqrt(d^2 + b^2),
            so its direction does not jump where a ring meets the next.

            Checked  tests/net_capture/test_closing.py
            """
            radius = ring_radius(p.closing_lock_length, p.closing_rings)
            way = 0.0
            change = 0.0
            b = cord_stop(p, work, i, 0)
            for stop in range(stops(p)):
                a = b
                b = cord_stop(p, work, i, stop + 1)
                squared = radius * radius
                product = 0.0
                if bends:
                    if bent(p, work, i * stops(p) + stop):
                        d, going = reach(p, work, i * stops(p) + stop, a, b, place, velocity)
                        way += math.sqrt(squared + d * d)
                        change += d * going / math.sqrt(squared + d * d)
                        continue
                for axis in range(3):
                    at = node_plane(p, work, place + axis)
                    rate = node_plane(p, work, velocity + axis)
                    d = at[b] - at[a]
                    squared += d * d
                    product += d * (rate[b] - rate[a])
                root = math.sqrt(squared)
                way += root
                change += product / root if root > 0.0 else 0.0
            return way, change

        return along_cord

    def make_draw(place: int, now: bool) -> Any:
        """Kernel `draw_cord` at the positions in the planes from this on; in what is shown, `now` false, what bends
        pulls up to the middle of the last substep."""

        @kernel
        def draw_cord(p, work, i, tension):
            """The same tension in every stretch: rings have no friction.

            Checked  tests/net_capture/test_closing.py
            """
            radius = ring_radius(p.closing_lock_length, p.closing_rings)
            b = cord_stop(p, work, i, 0)
            for stop in range(stops(p)):
                a = b
                b = cord_stop(p, work, i, stop + 1)
                squared = radius * radius
                if bends:
                    if bent(p, work, i * stops(p) + stop):
                        if now:
                            d, _ = reach(p, work, i * stops(p) + stop, a, b, place, place)
                            pull = tension * d / math.sqrt(squared + d * d)
                            draw_bent(p, work, i * stops(p) + stop, a, b, place, pull)
                        continue
                for axis in range(3):
                    at = node_plane(p, work, place + axis)
                    d = at[b] - at[a]
                    squared += d * d
                share = tension / math.sqrt(squared)
                for axis in range(3):
                    at = node_plane(p, work, place + axis)
                    force = node_plane(p, work, FX + axis)
                    drawn = share * (at[b] - at[a])
                    force[a] += drawn
                    force[b] -= drawn

        return draw_cord

    @kernel
    def burden(p, work, i, stiffness, dashpot, tension, span):
        """What a cord brings to its knots: through n rings (n + 1) k at a bullet and twice that at a ring, and at
        both ends of each stretch of length d its turning, T / sqrt(d^2 + b^2), as in `formulas.substep_limits`.

        stiffness, dashpot   of the cord                             [N/m], [N s/m]
        tension              T, the largest it can have              [N]
        span                 in which stretches grow shorter         [s]

        Checked  tests/net_capture/test_following.py
        """
        radius = ring_radius(p.closing_lock_length, p.closing_rings)
        last = p.closing_rings
        b = cord_stop(p, work, i, 0)
        for stop in range(last + 1):
            a = b
            b = cord_stop(p, work, i, stop + 1)
            squared = 0.0
            closing = 0.0
            for axis in range(3):
                at = node_plane(p, work, SHOWN + axis)
                rate = node_plane(p, work, SHOWN_RATE + axis)
                squared += (at[b] - at[a]) * (at[b] - at[a])
                closing += (rate[b] - rate[a]) * (rate[b] - rate[a])
            shorter = max(math.sqrt(squared) - span * math.sqrt(closing), 0.0)
            turning = tension / math.sqrt(shorter * shorter + radius * radius) if last > 0 else 0.0
            # a ring has a share of both its stretches
            meet(p, work, a, (last + 1) * stiffness + turning, (last + 1) * dashpot)
            meet(p, work, b, (last + 1) * stiffness + turning, (last + 1) * dashpot)

    return Cord(
        pieces,
        rouse,
        meet_target if bends else None,
        make_way(X, P),
        make_way(SHOWN, SHOWN_RATE),
        make_draw(X, True),
        make_draw(SHOWN, False),
        burden if meets else None,
    )
