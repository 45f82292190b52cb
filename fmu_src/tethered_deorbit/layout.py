"""Where things lie: the components of the state, and the work memory of an instance.

The state is one centre of mass and one relative vector (target minus chaser), inertial axes, and what they gather:

    0:3 R   centre of mass [m]      3:6 V   its velocity [m/s]      6:9 rho   relative [m]      9:12 its rate [m/s]
    12  J   impulse of the line [N s]: dJ/dt is the tension that the equations have in them
"""

from __future__ import annotations

from fmu_src.integrators import DOP853_DENSE_ROWS, DOP853_ROWS

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
DENSE = STAGES + DOP853_ROWS * SIZE
WORK = DENSE + DOP853_DENSE_ROWS * SIZE
"""Doubles of work memory in all."""
