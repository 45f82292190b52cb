"""Formulas that are wanted both by kernels and where nothing is compiled: plain Python, which `twobody` and `rotations`
hand to the compiler.

The master and the refusals of a scene use them from here, and so start without numba.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from orbital.vectors import Array


def mean_motion(semi_major_axis: float, mu: float) -> float:
    """Mean angular rate of a closed orbit [rad/s].

        n = sqrt(mu / a^3)

    semi_major_axis  a   of the ellipse, the radius of a circle  [m]
    mu               mu  gravitational parameter                 [m^3/s^2]

    Valid    a > 0
    Source   Kepler's third law
    Checked  tests/orbital/test_twobody.py; 1.0381289e-3 rad/s at 800 km
    """
    return math.sqrt(mu / semi_major_axis) / semi_major_axis


def to_matrix(out: Array, q: Array) -> None:
    """out = the rotation matrix [-] (3, 3) of a unit quaternion: v_reference = R v_body.

    q                    body to reference, scalar first         [-]      (4,)

    Valid    unit quaternions
    Source   `rotations.rotate` applied to the three axes
    Checked  tests/orbital/test_rotations.py
    """
    w, x, y, z = q[0], q[1], q[2], q[3]
    out[0, 0] = 1.0 - 2.0 * (y * y + z * z)
    out[0, 1] = 2.0 * (x * y - w * z)
    out[0, 2] = 2.0 * (x * z + w * y)
    out[1, 0] = 2.0 * (x * y + w * z)
    out[1, 1] = 1.0 - 2.0 * (x * x + z * z)
    out[1, 2] = 2.0 * (y * z - w * x)
    out[2, 0] = 2.0 * (x * z - w * y)
    out[2, 1] = 2.0 * (y * z + w * x)
    out[2, 2] = 1.0 - 2.0 * (x * x + y * y)
