"""The surface of the convex hull of a few corners."""

from __future__ import annotations

import math
from typing import Any

from fmu_src.interface import Variable
from fmu_src.rows import state
from fmu_src.tethered_deorbit.surfaces.surface import NO_BODY, Surface
from orbital.hull import hull
from orbital.kernel import kernel

CORNERS = 32
FACES, EDGES = 2 * CORNERS - 4, 3 * CORNERS - 6
"""Most that a convex body of so many corners has (Euler)."""
BEYOND = 1.0e30
"""Where what is not there lies [m]."""


@kernel
def lay_out(record: Any) -> int:
    """Write the faces and edges of the hull of the corners, and how large it is; a face or edge that it has not lies
    out of the way.

    Corners repeated at the end count once. Returns NO_BODY where they have no volume.

    Source   `orbital.hull.hull`
    Checked  tests/tethered_deorbit/test_hulls.py
    """
    r = record[0]
    corners = r.state_corners
    count = 0
    for i in range(CORNERS):
        corners[i][0] = r.target_corner_x[i] + r.target_center[0]
        corners[i][1] = r.target_corner_y[i] + r.target_center[1]
        corners[i][2] = r.target_corner_z[i] + r.target_center[2]
        if (
            i == 0
            or corners[i][0] != corners[i - 1][0]
            or corners[i][1] != corners[i - 1][1]
            or corners[i][2] != corners[i - 1][2]
        ):
            count = i + 1
    faces, edges = hull(corners[0:count], r.state_faces, r.state_edges, r.state_sides, r.path_room)
    if faces <= 0:
        return NO_BODY
    for f in range(faces, FACES):
        for a in range(3):
            r.state_faces[f][a] = 0.0
        r.state_faces[f][3] = BEYOND
    for e in range(edges, EDGES):
        for a in range(7):
            r.state_edges[e][a] = BEYOND if a < 3 else 0.0
        r.state_sides[e][0] = -1
        r.state_sides[e][1] = -1
    size = 0.0
    for a in range(3):
        low, high = math.inf, -math.inf
        for i in range(count):
            low, high = min(low, corners[i][a]), max(high, corners[i][a])
        r.state_middle[a] = 0.5 * (low + high)
        size += (high - low) * (high - low)
    r.state_extent = math.sqrt(size)
    return 0


HULL = Surface(
    name="hull",
    called="a rigid body with the surface of the convex hull of its corners",
    faces=FACES,
    edges=EDGES,
    ways=EDGES,
    rows=(
        *(
            Variable(f"target.corner_{axis}[#]", "m", "parameter", f"coordinate {i} of each corner, from target.center",
                     (*start, *start[-1:] * (CORNERS - 4)), shape=(CORNERS,), minimum=-1e4, maximum=1e4, fills=True)
            for i, (axis, start) in enumerate(
                (("x", (1.0, -1.0, 0.0, 0.0)), ("y", (-1.0, -1.0, 1.0, 0.0)), ("z", (-1.0, -1.0, -1.0, 1.0))), 1
            )
        ),
        state("state.corners[#][#]", "m", "from the centre of mass", shape=(CORNERS, 3)),
    ),
    lay_out=lay_out,
)  # fmt: skip
"""A list of fewer corners is filled up with its last; unless given, a tetrahedron."""
