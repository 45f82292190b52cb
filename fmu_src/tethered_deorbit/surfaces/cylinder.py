"""The surface of a cylinder about the third body axis, as a prism."""

from __future__ import annotations

import math
from typing import Any

from fmu_src.rows import positive
from fmu_src.tethered_deorbit.surfaces.surface import Surface
from orbital.kernel import kernel

SIDES = 24
"""Sides of the prism."""


@kernel
def lay_out(record: Any) -> int:
    """Write the faces and edges of a prism about the third body axis that is as far round as the cylinder.

        radius of its corners = r (pi/n)/sin(pi/n)

    Valid    lengths round it are exact by the turn, within 1.4e-3 r in between
    Checked  tests/tethered_deorbit/test_wrapping.py: a line round a cylinder
    """
    r = record[0]
    n = SIDES
    half = math.pi / n
    corner = r.target_cylinder_radius * half / math.sin(half)
    for i in range(3):
        r.state_middle[i] = r.target_center[i]
    for side in range(2):
        sign = 1.0 - 2.0 * side
        face = r.state_faces[n + side]
        face[0] = 0.0
        face[1] = 0.0
        face[2] = sign
        face[3] = sign * r.target_center[2] + 0.5 * r.target_cylinder_length
    for k in range(n):
        x, y = math.cos(2.0 * half * k), math.sin(2.0 * half * k)
        face = r.state_faces[k]
        face[0], face[1], face[2] = x, y, 0.0
        face[3] = x * r.target_center[0] + y * r.target_center[1] + corner * math.cos(half)
        # the edge between this face and the next, and those of this face with the ends
        up, up_sides = r.state_edges[k], r.state_sides[k]
        x, y = math.cos(half * (2 * k + 1)), math.sin(half * (2 * k + 1))
        back_x, back_y = math.cos(half * (2 * k - 1)), math.sin(half * (2 * k - 1))
        up[0] = r.target_center[0] + corner * x
        up[1] = r.target_center[1] + corner * y
        up[2] = r.target_center[2] - 0.5 * r.target_cylinder_length
        up[3], up[4], up[5], up[6] = 0.0, 0.0, 1.0, r.target_cylinder_length
        up_sides[0], up_sides[1] = k, (k + 1) % n
        chord = 2.0 * corner * math.sin(half)
        for side in range(2):
            rim, rim_sides = r.state_edges[n + 2 * k + side], r.state_sides[n + 2 * k + side]
            rim[0] = r.target_center[0] + corner * back_x
            rim[1] = r.target_center[1] + corner * back_y
            rim[2] = r.target_center[2] + (0.5 - side) * r.target_cylinder_length
            rim[3] = corner * (x - back_x) / chord
            rim[4] = corner * (y - back_y) / chord
            rim[5] = 0.0
            rim[6] = chord
            rim_sides[0], rim_sides[1] = k, n + side
    r.state_extent = math.sqrt(
        4.0 * r.target_cylinder_radius * r.target_cylinder_radius + r.target_cylinder_length * r.target_cylinder_length
    )
    return 0


CYLINDER = Surface(
    name="cylinder",
    called="a rigid body with the surface of a cylinder",
    faces=SIDES + 2,
    edges=3 * SIDES,
    ways=6 * SIDES,
    rows=(
        positive("target.cylinder_radius", "m", "of the cylinder about the third body axis", 1.0, 1e4),
        positive("target.cylinder_length", "m", "of the cylinder along it", 2.0, 1e4),
    ),
    lay_out=lay_out,
)
"""The way may go six times round."""
