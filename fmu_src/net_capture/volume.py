"""How much the net holds: the volume between it and its mouth, and its surface, mesh by mesh.

    V = | sum over the faces of (a - c) . ((b - c) x (d - c)) / 6 |,   S = sum of | (b - a) x (d - a) | / 2

with a, b, d the corners of a triangle and c the middle of the mouth: the cone over the rim closes the surface.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from fmu_src.interface import Term
from fmu_src.net_capture.planes import FACE_WORDS, SHOWN
from fmu_src.rows import output, peak, state
from orbital.kernel import kernel


class Volume(NamedTuple):
    """Kernels of the volume.

    start(p)          nothing measured yet
    watch(p, work)    volume and surface of what is shown, and the largest volume so far
    """

    start: Any
    watch: Any


def make(composition: Any) -> Volume:
    """Kernels for the composition's net."""
    memory = composition.memory
    node_plane, faces, rim, corners = memory.node_plane, memory.faces, memory.rim, memory.corners

    @kernel
    def triangle(p, work, i, j, k):
        """Six times the volume under a triangle of three nodes, seen from the middle of the mouth, and twice its area.

        Checked  tests/net_capture/test_volume.py
        """
        x = node_plane(p, work, SHOWN)
        y = node_plane(p, work, SHOWN + 1)
        z = node_plane(p, work, SHOWN + 2)
        ax, ay, az = x[i] - p.volume_middle[0], y[i] - p.volume_middle[1], z[i] - p.volume_middle[2]
        bx, by, bz = x[j] - x[i], y[j] - y[i], z[j] - z[i]
        dx, dy, dz = x[k] - x[i], y[k] - y[i], z[k] - z[i]
        cx = by * dz - bz * dy
        cy = bz * dx - bx * dz
        cz = bx * dy - by * dx
        return ax * cx + ay * cy + az * cz, math.sqrt(cx * cx + cy * cy + cz * cz)

    @kernel
    def watch(p, work):
        """Volume [m3] and surface [m2] of what is shown.

        Checked  tests/net_capture/test_volume.py
        """
        for axis in range(3):
            p.volume_middle[axis] = 0.0
            for corner in range(p.net_corners):
                node = rim(p, work)[corners(p, work)[corner]]
                p.volume_middle[axis] += node_plane(p, work, SHOWN + axis)[node] / p.net_corners
        face = faces(p, work)
        held = 0.0
        surface = 0.0
        for f in range(0, FACE_WORDS * p.net_faces, FACE_WORDS):
            volume, area = triangle(p, work, face[f], face[f + 1], face[f + 2])
            held += volume
            surface += area
            if face[f + 3] != face[f + 2]:
                volume, area = triangle(p, work, face[f], face[f + 2], face[f + 3])
                held += volume
                surface += area
        p.net_volume = abs(held) / 6.0
        p.net_surface = 0.5 * surface
        p.net_volume_max = max(p.net_volume_max, p.net_volume)

    @kernel
    def start(p):
        """Nothing measured yet.

        Checked  tests/net_capture/test_volume.py
        """
        p.net_volume_max = 0.0

    return Volume(start, watch)


PART = Term(
    "volume between net and mouth, and the net's surface",
    (
        output("net.volume", "m3", "between the net and its mouth"),
        peak("net.volume_max", "m3", "largest so far, looked at every 10 ms"),
        output("net.surface", "m2", "of the net, spanned over its meshes"),
        state("volume_middle[#]", "m", "middle of the mouth", shape=(3,)),
    ),
    make=make,
)
