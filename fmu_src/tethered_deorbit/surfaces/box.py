"""The surface of a box with edges along the body axes."""

from __future__ import annotations

from typing import Any

from fmu_src.interface import Variable
from fmu_src.tethered_deorbit.surfaces.surface import Surface
from orbital.kernel import kernel
from orbital.vectors import norm


@kernel
def lay_out(record: Any) -> int:
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
    return 0


BOX = Surface(
    name="box",
    called="a rigid body with the surface of a box",
    faces=6,
    edges=12,
    ways=64,
    rows=(
        Variable("target.size[#]", "m", "parameter", "edges along the body axes", 2.0, shape=(3,), minimum=0.0,
                 maximum=1e4, open_minimum=True),
    ),
    lay_out=lay_out,
)  # fmt: skip
"""Ways over 64 edges are sixteen turns."""
