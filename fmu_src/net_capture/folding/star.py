"""The net folded into a star, the arms of which are wound up side by side, into a cylindrical canister.

Each of the N bullets has a sector of the net. Midway between two bullets the net is drawn in to the shot's axis, so
that every sector becomes an arm of two plies with its bullet at the tip; across the arm the plies are folded to and fro
over the canister's depth, and all arms are wound one way round the axis, in N spirals r = c phi:

    w = zigzag(b),   s(phi) = a,   r = c phi,    a = r0 sin(pi/N - d),   b = r0 cos(pi/N - d)

with r0 the distance of a node from the axis in the net as meant, d its angle from the middle of its sector, and s the
length of the spiral. So the bullets lie outermost, evenly round the axis, and arms unwind from their tips inwards. The
map (a, b) is a sheet of paper folded along lines through its middle, and stretches nothing; nor does the weighted mean
of it and of the net itself, shrunk:

    place = (1 - f) (folded) + f (as meant)

which parts the plies: f spreads the net over 0.45 of the distance from one arm to the next.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from fmu_src.implied import formula
from fmu_src.interface import Term, fault
from fmu_src.net_capture.folding import Checks, Folding
from fmu_src.net_capture.folding.spiral import CANISTER, KEPT, RADIUS, turned, volume
from fmu_src.net_capture.folding.zigzag import DEPTH, TOO_DEEP, extremes, fold_width, zigzag
from fmu_src.net_capture.planes import MASS, SHOWN, X
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.net_capture.release import BOOKED
from orbital.kernel import kernel

SPREAD = 0.45
"""Of the distance from one arm to the next that the plies of an arm take to either side."""
TOO_SHORT = fault("too_short", RADIUS, "the canister is so wide for this net that arms would not go round its axis")


@kernel
def widest(narrowest, arms):
    """Radius below which arms go about once round, or more often [m]: R = w sin(pi/N) / 2 pi.

    An arm of length a = w/2 sin(pi/N) covers the area of the canister, a P = pi R^2, in turns P apart: R/P of them.

    narrowest   w    of the mouth's widths     [m]
    arms        N    as many as bullets        [1]

    Checked  tests/net_capture/test_star.py
    """
    return narrowest * math.sin(math.pi / arms) / (2.0 * math.pi)


@kernel
def wrapped(angle):
    """The same angle between -pi and pi [rad].

    Checked  tests/net_capture/test_star.py
    """
    return angle - 2.0 * math.pi * math.floor(angle / (2.0 * math.pi) + 0.5)


def make(composition: Any) -> Folding:
    """Kernels for the composition's net."""
    memory = composition.memory
    node_plane, bullets = memory.node_plane, memory.bullets
    too_deep, too_short = composition.code(TOO_DEEP.name), composition.code(TOO_SHORT.name)

    @kernel
    def check(p):
        """See `Folding`.

        Checked  tests/net_capture/test_star.py
        """
        narrowest = min(p.mouth_width[0], p.mouth_width[1])
        if p.canister_depth >= 0.5 * narrowest:
            p.fault_value = p.canister_depth
            return too_deep
        if p.canister_radius >= widest(narrowest, p.net_corners):
            p.fault_value = p.canister_radius
            return too_short
        return 0

    @kernel
    def bearing(p, work, node):
        """Angle of a node round the shot's axis in the net as meant [rad].

        Checked  tests/net_capture/test_star.py
        """
        return math.atan2(1.0 * node_plane(p, work, SHOWN + 1)[node], 1.0 * node_plane(p, work, SHOWN)[node])

    @kernel
    def first_arm(p, work):
        """Angle of the first arm [rad]: all together are turned to where bullets are nearest, in the mean.

        Checked  tests/net_capture/test_star.py
        """
        first = bearing(p, work, bullets(p, work)[0])
        beside = 0.0
        for k in range(1, p.net_corners):
            there = bearing(p, work, bullets(p, work)[k])
            beside += wrapped(there - first - 2.0 * math.pi * k / p.net_corners)
        return first + beside / p.net_corners

    @kernel
    def sector(p, angle, first):
        """The arm to which a node belongs, and its angle from the nearer edge of that sector [rad].

        Checked  tests/net_capture/test_star.py
        """
        share = 2.0 * math.pi / p.net_corners
        arm = math.floor((angle - first) / share + 0.5)
        return arm, 0.5 * share - abs(angle - first - arm * share)

    @kernel
    def fold(p, work):
        """Every node on its arm, the middle of the net at the bottom, the bullets at the tips.

        Checked  tests/net_capture/test_star.py
        """
        mass, first = node_plane(p, work, MASS), first_arm(p, work)
        longest = 0.0
        farthest = 0.0
        for i in range(p.node_slots):
            if mass[i] > 0.0:
                radius = math.hypot(1.0 * node_plane(p, work, SHOWN)[i], 1.0 * node_plane(p, work, SHOWN + 1)[i])
                _, within = sector(p, bearing(p, work, i), first)
                longest = max(longest, radius * math.sin(within))
                farthest = max(farthest, radius)
        share = SPREAD * math.pi * p.canister_radius * p.canister_radius / (longest * p.net_corners * farthest)
        kept = KEPT * (1.0 - share)
        outermost = p.canister_radius - share * farthest
        c = 0.5 * outermost * outermost / (kept * longest)
        last = turned(kept * longest / c)
        width = fold_width(p.canister_depth, kept * p.rim_mesh)
        for i in range(p.node_slots):
            x = 1.0 * node_plane(p, work, SHOWN)[i]
            y = 1.0 * node_plane(p, work, SHOWN + 1)[i]
            radius = math.hypot(x, y)
            arm, within = sector(p, bearing(p, work, i), first)
            way = turned(kept * radius * max(math.sin(within), 0.0) / c)
            angle = first + 2.0 * math.pi * arm / p.net_corners + way - last
            u = c * way * math.cos(angle) + share * x
            v = c * way * math.sin(angle) + share * y
            w = zigzag(kept * radius * math.cos(within), width) - 0.5 * p.canister_depth
            for axis in range(3):
                at = p.muzzle[axis] + u * p.axes[axis] + v * p.axes[3 + axis] + w * p.axes[6 + axis]
                node_plane(p, work, X + axis)[i] = at

    return Folding(check, fold)


def refuses(scene: Scene) -> Iterator[Refusal]:
    """A canister that is none for this net, and a net whose bullets do not share it among them."""
    values, net = scene.values, scene.parts["net"].checks
    width, arms, uneven = min(net.widths(values)), net.bullets(values), net.uneven(values)
    most = float(formula(widest)(width, arms))
    if values[DEPTH] >= 0.5 * width:
        yield Refusal(DEPTH, f"{values[DEPTH]:g} m", f"must be less than half of the mouth's width, {width:g} m")
    elif values[RADIUS] >= most:
        expected = f"must be less than {most:.4g} m: in a wider canister {arms} arms of this net would not go round"
        yield Refusal(RADIUS, f"{values[RADIUS]:g} m", expected)
    if uneven >= 1.0:
        half = 180.0 / arms
        expected = (
            f"needs a bullet in each of {arms} equal sectors round the shot's axis: at most {half:.3g} deg beside its "
            f"middle; the corners of this net stand up to {uneven * half:.3g} deg beside it"
        )
        yield Refusal("folding.pattern", '"star"', expected)


PART = Term(
    "drawn into a star with a bullet at the tip of each arm, which are wound up together, into a cylindrical canister",
    (*CANISTER, *BOOKED),
    faults=(TOO_DEEP, TOO_SHORT),
    make=make,
    checks=Checks(lambda values, net: values[RADIUS], volume),
    refuses=refuses,
    extremes=extremes(RADIUS),
)
