"""Where things lie: the components of the state, and the work memory of an instance.

The state is one centre of mass and one relative vector (target minus chaser), inertial axes, and what they gather:

    0:3 R   centre of mass [m]      3:6 V   its velocity [m/s]      6:9 rho   relative [m]      9:12 its rate [m/s]
    12  J   impulse of the line [N s]: dJ/dt is the tension that the equations have in them
"""

from __future__ import annotations

from typing import NamedTuple

from fmu_src.integrators.scheme import AdaptiveScheme

VECTORS = 12
"""Components that the equations depend on, four vectors."""
IMPULSE = 12
SIZE = 13

BEGIN = 0
"""State at the begin of the current step."""
END = BEGIN + SIZE
"""State at its end."""
HERE = END + SIZE
"""State at the point last asked of the dense output."""
SLOPE = HERE + SIZE
"""Rate of that state."""
LOW = SLOPE + SIZE
HIGH = LOW + SIZE
STAGES = HIGH + SIZE
"""Stage memory of the scheme, as long as it wants; behind it its dense output."""


class Places(NamedTuple):
    """What lies behind STAGES, where the sizes are the scheme's.

    last    derivative at the end of the current step
    dense   dense output of that step
    end     of the work memory: doubles in all
    """

    last: int
    dense: int
    end: int


def places_of(scheme: AdaptiveScheme) -> Places:
    """The places for one scheme."""
    dense = STAGES + scheme.stages
    return Places(STAGES + scheme.last, dense, dense + scheme.dense)
