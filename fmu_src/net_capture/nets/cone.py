"""The conical net: a round mouth, walls that narrow towards a top, and there a floor, a point or an open end."""

from __future__ import annotations

import math

from fmu_src.interface import Term
from fmu_src.net_capture.nets.extremes import extremes
from fmu_src.net_capture.nets.ring_measures import Profile, make_checks
from fmu_src.net_capture.nets.rings import NO_NARROWER, ROWS, UNEVEN, make_refuses, make_rings
from fmu_src.net_capture.nets.weave import TOO_FINE
from fmu_src.rows import at_least_zero, choice, positive
from orbital.kernel import kernel

FLOORS = ("flat", "none")


@kernel
def rings(p):
    """Rings of knots [1]: of the wall, a whole number of meshes high, and of the floor; an open end has one more.

    Checked  tests/net_capture/test_rings.py
    """
    slant = math.sqrt(p.net_depth * p.net_depth + (p.net_radius - p.net_top_radius) ** 2)
    wall = max(round(slant / p.net_mesh), 1)
    if p.net_top_radius == 0.0:
        return wall
    return wall + 1 if p.net_floor == 1 else wall + max(round(p.net_top_radius / p.net_mesh), 1)


@kernel
def has_tip(p):
    """Whether the meridians meet in a knot: at the cone's point, or in the middle of its floor.

    Checked  tests/net_capture/test_rings.py
    """
    return p.net_top_radius == 0.0 or p.net_floor == 0


@kernel
def ring(p, i):
    """Radius of a ring, and how far it lies behind the mouth [m].

    Checked  tests/net_capture/test_rings.py
    """
    slant = math.sqrt(p.net_depth * p.net_depth + (p.net_radius - p.net_top_radius) ** 2)
    wall = max(round(slant / p.net_mesh), 1)
    if i <= wall:
        share = i / wall
        return p.net_radius + share * (p.net_top_radius - p.net_radius), share * p.net_depth
    floor = max(round(p.net_top_radius / p.net_mesh), 1)
    return p.net_top_radius * (1.0 - (i - wall) / floor), 1.0 * p.net_depth


PROFILE = Profile(rings, has_tip, ring)
CHECKS = make_checks(PROFILE)

PART = Term(
    "conical net: a round mouth, walls of rings and meridians, and a floor, a point or an open end at the top",
    (
        positive("net.radius", "m", "of the mouth", 12.0),
        at_least_zero("net.depth", "m", "from the mouth to the top", 12.0),
        at_least_zero(
            "net.top_radius", "m", "of the top, less than that of the mouth; 0: the walls meet in a point", 3.0
        ),
        choice("net.floor", "what closes the top, where that is no point", FLOORS),
        *ROWS,
    ),
    faults=(UNEVEN, NO_NARROWER, TOO_FINE),
    make=lambda composition: make_rings(composition, PROFILE),
    checks=CHECKS,
    refuses=make_refuses(PROFILE),
    extremes=extremes(CHECKS),
)
