"""Bodies that the line can wrap round, as faces and edges: the box, and the cylinder as a prism.

Face f is n . x <= h, kept as (n, h); edge e is o + t d for 0 <= t <= l, kept as (o, d, l), between two faces. All in
body axes, from the centre of mass; the middle of the body stands at `target.center`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.tethered_deorbit.body_rows import CYLINDER_SIDES
from orbital.kernel import kernel
from orbital.vectors import norm


class Surface(NamedTuple):
    """A kind of body: how many faces and edges it has, and the kernel that writes them from the parameters."""

    faces: int
    edges: int
    lay_out: Callable[[Any], None]


@kernel
def lay_out_box(record: Any) -> None:
    """Write the faces and edges of a box with edges along the body axes, and how large it is.

    Checked  tests/tethered_deorbit/test_wrapping.py
    """
    r = record[0]
    for a in range(3):
        r.state_middle[a] = r.target_center[a]
        for side in range(2):
            sign = 1.0 - 2.0 * side
            face = r.state_faces[2 * a + side]
            for i in range(3):
                face[i] = sign if i == a else 0.0
            face[3] = sign * r.target_center[a] + 0.5 * r.target_size[a]
    for a in range(3):
        b, c = (a + 1) % 3, (a + 2) % 3
        for corner in range(4):
            on_b, on_c = corner % 2, corner // 2
            edge, sides = r.state_edges[4 * a + corner], r.state_sides[4 * a + corner]
            for i in range(3):
                edge[3 + i] = 1.0 if i == a else 0.0
            edge[a] = r.target_center[a] - 0.5 * r.target_size[a]
            edge[b] = r.target_center[b] + (0.5 - on_b) * r.target_size[b]
            edge[c] = r.target_center[c] + (0.5 - on_c) * r.target_size[c]
            edge[6] = r.target_size[a]
            sides[0] = 2 * b + on_b
            sides[1] = 2 * c + on_c
    r.state_extent = norm(r.target_size)


@kernel
def lay_out_cylinder(record: Any) -> None:
    """Write the faces and edges of a prism about the third body axis that is as far round as the cylinder.

        radius of its corners = r (pi/n)/sin(pi/n)

    Valid    lengths round it are exact by the turn, within 1.4e-3 r in between
    Checked  tests/tethered_deorbit/test_wrapping.py: a line round a cylinder
    """
    r = record[0]
    n = CYLINDER_SIDES
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


SURFACES = {
    "box": Surface(6, 12, lay_out_box),
    "cylinder": Surface(CYLINDER_SIDES + 2, 3 * CYLINDER_SIDES, lay_out_cylinder),
}
