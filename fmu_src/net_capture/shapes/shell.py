"""The open shell: a piece of a tube, as half of a fairing is; a piece of a union."""

from __future__ import annotations

import math

from fmu_src.net_capture.shapes.cylinder import of_prism
from orbital.kernel import kernel


@kernel
def shell_distance(normal, point, radius, length, thickness, angle):
    """Signed distance [m] of a point from the surface of a piece of a tube, negative inside; outward normal into
    `normal`.

    Across the axis it is that of an arc of a wall, with straight edges where it ends:

        |a - (r - t/2)| - t/2 between the edges, beside one the distance from it, both in a = sqrt(x2 + y2)

    and along the axis that of a cylinder: sqrt(max(d, 0)^2 + max(e, 0)^2) outside, max(d, e) inside, e = |z| - l/2.

    point        from the middle of the axis, piece's axes     [m]  (3,)
    normal       unit vector                                   [1]  (3,)
    radius       r, of the outside                             [m]
    thickness    t, of the wall                                [m]
    angle        of the piece about the third axis, half of it to each side of the first; a full turn has no edges [rad]

    Valid    any point; inside, distances from an edge are those from its plane, which is exact where no wall is nearer
    Checked  tests/net_capture/test_pieces.py
    """
    across = math.sqrt(point[0] * point[0] + point[1] * point[1])
    x = point[0] / across if across > 0.0 else 1.0
    y = point[1] / across if across > 0.0 else 0.0
    middle = radius - 0.5 * thickness
    side = 1.0 if across >= middle else -1.0
    flat = abs(across - middle) - 0.5 * thickness
    nx = side * x
    ny = side * y
    half = 0.5 * angle
    if half < math.pi:
        turn = 1.0 if point[1] >= 0.0 else -1.0
        ex, ey = math.cos(half), math.sin(half) * turn
        mx, my = -ey * turn, ex * turn
        along = point[0] * ex + point[1] * ey
        beyond = point[0] * mx + point[1] * my
        if math.atan2(abs(point[1]), point[0]) > half:
            out = max(abs(along - middle) - 0.5 * thickness, 0.0) * (1.0 if along >= middle else -1.0)
            flat = math.sqrt(out * out + beyond * beyond)
            nx = (out * ex + beyond * mx) / flat if flat > 0.0 else mx
            ny = (out * ey + beyond * my) / flat if flat > 0.0 else my
        elif flat < 0.0 and along > 0.0 and beyond > flat:
            flat = beyond
            nx = mx
            ny = my
    return of_prism(normal, flat, nx, ny, point[2], 0.5 * length)


def shell_center(radius: float, length: float, thickness: float, angle: float) -> float:
    """Distance of a shell's centre of mass from its axis, along its first axis [m].

        2 (r3 - q3) sin(b) / (3 b (r2 - q2)),   b = angle/2, q = r - t

    Checked  tests/net_capture/test_pieces.py
    """
    inner, half = radius - thickness, 0.5 * angle
    return 2.0 * (radius**3 - inner**3) * math.sin(half) / (3.0 * half * (radius**2 - inner**2))


def shell_squares(radius: float, length: float, thickness: float, angle: float) -> tuple[float, float, float]:
    """Mean squares of a shell's points about its centre of mass, along its axes [m2].

        x2, y2 = (r2 + q2)/4 (1 +- sin(2b)/(2b)),   z2 = l2/12

    Checked  tests/net_capture/test_pieces.py
    """
    inner = radius - thickness
    ring = 0.25 * (radius**2 + inner**2)
    skew = math.sin(angle) / angle
    center = shell_center(radius, length, thickness, angle)
    return ring * (1.0 + skew) - center**2, ring * (1.0 - skew), length**2 / 12.0
