"""How much of the target is inside: the share of its sample points that net and mouth go round.

The net, closed by a cap over its mouth, is a closed surface; a point is inside when its winding number is not zero. The
cap joins every piece of the rim to the middle of the bullets.

Only knots touch the target, so a mesh may cut its edges and corners; but a mesh of side s whose knots are all outside a
box reaches no deeper than s / 2 below the faces at an edge and 0.535 s at a corner. The sample points lie deeper, so no
part of the net can pass them, and what tells one from another is the cap alone. All inside: the mouth is behind the
target. Some inside: the target stands in the mouth. None: it is out.
"""

from fmu_src.net_capture.topology import X, bullet_node, node_plane
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


@kernel
def knot_crossing(p, work, place, i, j, k):
    """Signed crossing of the triangle of three knots."""
    x = node_plane(p, work, X)
    y = node_plane(p, work, X + 1)
    z = node_plane(p, work, X + 2)
    return crossing(p, work, place, x[i], y[i], z[i], x[j], y[j], z[j], x[k], y[k], z[k])


@kernel
def cap_crossing(p, work, place, i, j, cx, cy, cz):
    """Signed crossing of the triangle of two knots of the rim and the middle of the mouth."""
    x = node_plane(p, work, X)
    y = node_plane(p, work, X + 1)
    z = node_plane(p, work, X + 2)
    return crossing(p, work, place, x[i], y[i], z[i], x[j], y[j], z[j], cx, cy, cz)


@kernel
def encloses(p, work, place):
    """Whether the net, closed by a cap over its mouth, goes round a point: winding number by signed crossings.

    The cap joins every piece of the rim to the middle of the bullets, so the surface is closed whatever its shape.

    Checked  tests/net_capture/test_enclosure.py
    """
    k = p.knots
    winding = 0
    for i in range(k - 1):
        for j in range(k - 1):
            n = i * k + j
            winding += knot_crossing(p, work, place, n, n + 1, n + k + 1)
            winding += knot_crossing(p, work, place, n, n + k + 1, n + k)
    cx = 0.0
    cy = 0.0
    cz = 0.0
    for corner in range(4):
        node = bullet_node(k, corner)
        cx += 0.25 * node_plane(p, work, X)[node]
        cy += 0.25 * node_plane(p, work, X + 1)[node]
        cz += 0.25 * node_plane(p, work, X + 2)[node]
    last = k * (k - 1)
    for j in range(k - 1):
        winding += cap_crossing(p, work, place, j + 1, j, cx, cy, cz)
        winding += cap_crossing(p, work, place, last + j, last + j + 1, cx, cy, cz)
        winding += cap_crossing(p, work, place, j * k, (j + 1) * k, cx, cy, cz)
        winding += cap_crossing(p, work, place, (j + 1) * k + k - 1, j * k + k - 1, cx, cy, cz)
    return winding != 0


def make_share(sample, samples):
    """Kernel `share_inside(p, work)`: share of the target's sample points that net and mouth go round [1].

    sample     kernel (p, out, number): out = one sample point of the target, in the frame
    samples    how many there are

    Checked  tests/net_capture/test_enclosure.py
    """

    @kernel
    def share_inside(p, work):
        point = p.scratch[0:3]
        inside = 0
        for number in range(samples):
            sample(p, point, number)
            inside += 1 if encloses(p, work, point) else 0
        return inside / samples

    return share_inside
