"""The variables of what a scene may add to a tow: ends of its own, a line that breaks."""

from __future__ import annotations

from fmu_src.interface import Group, Term, Variable
from fmu_src.rows import at_least_zero, flag, parameter, peak, positive, state
from orbital.constants import EARTH_EQUATORIAL_RADIUS

NOWHERE, EVERYWHERE = -EARTH_EQUATORIAL_RADIUS, 1e12
"""Altitudes that no orbit reaches, from below and from above [m]."""
REENTRY = 120e3
"""Altitude at which a re-entry is taken to begin, by convention [m]."""

ENDS = Group(
    {
        "watched": Term(
            "the run ends by itself: low or high enough, or where the bodies come too close",
            (
                parameter("ends.altitude", "m", "the run ends where the centre of mass comes down to it", REENTRY,
                          NOWHERE, EVERYWHERE, display_unit="km"),
                parameter("ends.perigee", "m", "the run ends where its osculating perigee comes down to it", NOWHERE,
                          NOWHERE, EVERYWHERE, display_unit="km"),
                parameter("ends.raised_perigee", "m", "the run ends where its osculating perigee has risen to it",
                          EVERYWHERE, NOWHERE, EVERYWHERE, display_unit="km"),
                at_least_zero("ends.chaser_extent", "m", "radius of the sphere about its centre of mass that holds the "
                              "chaser", 0.0, 1e4),
                at_least_zero("ends.target_extent", "m", "the same of the target; a box or a cylinder has its surface, "
                              "and this is not asked", 0.0, 1e4),
                at_least_zero("ends.clearance", "m", "the run ends where the two come nearer to each other", 0.0, 1e5),
                at_least_zero("ends.wrapped", "m", "the run ends where more of the line lies on a target that "
                              "has a surface", EVERYWHERE, EVERYWHERE),
            ),
        ),
    },
    optional=True,
    follows=lambda terms, values: "watched",
)  # fmt: skip

BREAKING = Group(
    {
        "breaks": Term(
            "the line breaks where its tension exceeds its strength",
            (
                positive("break.strength", "N", "tension at which the line breaks", 1000.0, 1e12),
                Variable("break.flies_on", "1", "parameter", "both ends fly on; else the run ends there", False,
                         kind="Boolean"),
                flag("break.broken", "the line is broken"),
                peak("break.time", "s", "when it broke, since the start of this instance; zero unless broken"),
                state("state.broken", "1", "the line is broken", kind="Integer"),
            ),
        ),
    },
    optional=True,
    follows=lambda terms, values: "breaks",
)  # fmt: skip
