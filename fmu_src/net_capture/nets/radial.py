"""The radial net: flat and round, threads along rings and from the rim to the middle."""

from __future__ import annotations

from fmu_src.interface import Term
from fmu_src.net_capture.nets.extremes import extremes
from fmu_src.net_capture.nets.ring_measures import Profile, make_checks
from fmu_src.net_capture.nets.rings import ROWS, UNEVEN, make_refuses, make_rings
from fmu_src.net_capture.nets.weave import TOO_FINE
from fmu_src.rows import positive
from orbital.kernel import kernel


@kernel
def rings(p):
    """Rings of knots [1], as many as meshes from rim to middle.

    Checked  tests/net_capture/test_rings.py
    """
    return max(round(p.net_radius / p.net_mesh), 1)


@kernel
def has_tip(p):
    """All meridians meet in the middle."""
    return True


@kernel
def ring(p, i):
    """Radius of a ring, and how far it lies behind the mouth [m].

    Checked  tests/net_capture/test_rings.py
    """
    return p.net_radius * (1.0 - i / max(round(p.net_radius / p.net_mesh), 1)), 0.0


PROFILE = Profile(rings, has_tip, ring)
CHECKS = make_checks(PROFILE)

PART = Term(
    "radial net: flat and round, of rings and of meridians that meet in its middle",
    (positive("net.radius", "m", "of the mouth", 12.0), *ROWS),
    faults=(UNEVEN, TOO_FINE),
    make=lambda composition: make_rings(composition, PROFILE),
    checks=CHECKS,
    refuses=make_refuses(PROFILE),
    extremes=extremes(CHECKS),
)
