"""How much of the target is inside: the share of its sample points that net and mouth go round.

The net, closed by a cap over its mouth, is a closed surface; a point is inside when its winding number is not zero. The
cap joins every piece of the rim to the middle of the bullets.

Only knots touch the target, so a mesh may cut its edges and corners; but a mesh of side s whose knots are all outside a
box reaches no deeper than s / 2 below the faces at an edge and 0.535 s at a corner. The sample points lie deeper, so no
part of the net can pass them, and what tells one from another is the cap alone. All inside: the mouth is behind the
target. Some inside: the target stands in the mouth. None: it is out.
"""

from __future__ import annotations

from typing import Any

from fmu_src.net_capture.planes import FACE_WORDS, SHOWN
from orbital.kernel import kernel


@kernel
def crossing(p, work, place, ax, ay, az, bx, by, bz, cx, cy, cz):
    """Signed crossing of a triangle by the ray from a point along a fixed oblique direction: 1, -1 or 0.

    Source   Moeller and Trumbore, Journal of Graphics Tools 2 (1997) 21, with the sign of the determinant kept
    Checked  tests/net_capture/test_enclosure.py
    """
    dx = 0.3128
    dy = 0.5417
    dz = 0.7801
    ax -= place[0]
    ay -= place[1]
    az -= place[2]
    e1x = bx - place[0] - ax
    e1y = by - place[1] - ay
    e1z = bz - place[2] - az
    e2x = cx - place[0] - ax
    e2y = cy - place[1] - ay
    e2z = cz - place[2] - az
    hx = dy * e2z - dz * e2y
    hy = dz * e2x - dx * e2z
    hz = dx * e2y - dy * e2x
    det = e1x * hx + e1y * hy + e1z * hz
    if det == 0.0:
        return 0
    u = -(ax * hx + ay * hy + az * hz) / det
    if u < 0.0 or u >= 1.0:
        return 0
    qx = -(ay * e1z - az * e1y)
    qy = -(az * e1x - ax * e1z)
    qz = -(ax * e1y - ay * e1x)
    v = (dx * qx + dy * qy + dz * qz) / det
    if v < 0.0 or u + v >= 1.0:
        return 0
    t = (e2x * qx + e2y * qy + e2z * qz) / det
    if t <= 0.0:
        return 0
    return 1 if det > 0.0 else -1


def make_share(composition: Any) -> Any:
    """Kernel `share_inside(p, work)`: share of the target's sample points that net and mouth go round [1].

    Checked  tests/net_capture/test_enclosure.py
    """
    sample, samples = composition.target.sample, composition.target.shape.samples
    encloses = make_encloses(composition.memory)

    @kernel
    def share_inside(p, work):
        """Share of the target's sample points that net and mouth go round [1].

        Checked  tests/net_capture/test_enclosure.py
        """
        point = p.enclosure_point
        inside = 0
        for number in range(samples):
            sample(p, point, number)
            inside += 1 if encloses(p, work, point) else 0
        return inside / samples

    return share_inside


def make_encloses(memory: Any) -> Any:
    """Kernel `encloses(p, work, place)`: whether the net, closed by a cap over its mouth, goes round a point.

    By the winding number, in signed crossings. The cap joins every piece of the rim to the middle of the bullets, so
    the surface is closed whatever its shape; faces and rim turn the same way round.

    Checked  tests/net_capture/test_enclosure.py
    """
    node_plane, faces, rim, corners = memory.node_plane, memory.faces, memory.rim, memory.corners

    @kernel
    def node_crossing(p, work, place, i, j, k):
        """Signed crossing of the triangle of three nodes.

        Checked  tests/net_capture/test_enclosure.py
        """
        x = node_plane(p, work, SHOWN)
        y = node_plane(p, work, SHOWN + 1)
        z = node_plane(p, work, SHOWN + 2)
        return crossing(p, work, place, x[i], y[i], z[i], x[j], y[j], z[j], x[k], y[k], z[k])

    @kernel
    def encloses(p, work, place):
        """Whether the net, closed by a cap over its mouth, goes round a point.

        Checked  tests/net_capture/test_enclosure.py
        """
        x = node_plane(p, work, SHOWN)
        y = node_plane(p, work, SHOWN + 1)
        z = node_plane(p, work, SHOWN + 2)
        face = faces(p, work)
        edge = rim(p, work)
        winding = 0
        for f in range(0, FACE_WORDS * p.net_faces, FACE_WORDS):
            winding += node_crossing(p, work, place, face[f], face[f + 1], face[f + 2])
            if face[f + 3] != face[f + 2]:
                winding += node_crossing(p, work, place, face[f], face[f + 2], face[f + 3])
        cx = 0.0
        cy = 0.0
        cz = 0.0
        for corner in range(p.net_corners):
            node = edge[corners(p, work)[corner]]
            cx += x[node] / p.net_corners
            cy += y[node] / p.net_corners
            cz += z[node] / p.net_corners
        for n in range(p.rim_nodes):
            i = edge[n + 1 if n + 1 < p.rim_nodes else 0]
            j = edge[n]
            winding += crossing(p, work, place, x[i], y[i], z[i], x[j], y[j], z[j], cx, cy, cz)
        return winding != 0

    return encloses
