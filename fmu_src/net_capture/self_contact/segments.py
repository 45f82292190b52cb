"""Two straight threads: their closest points, and whether they went through each other."""

from __future__ import annotations

import math

from orbital.kernel import kernel

PARALLEL = 1e-12
"""Square of the sine of their angle below which two threads count as parallel: their closest points are at an end."""
HALVINGS = 48
"""Of the time in which a tetrahedron turned inside out, to find when."""
MET = 1e-6
"""Square of a gap over that of what threads moved, below which their lines met."""


@kernel
def gap_at(s, t, ux, uy, uz, vx, vy, vz, wx, wy, wz):
    """Square of the distance between two points of two threads [m2]; arguments as for `closest`.

    Checked  tests/net_capture/test_segments.py
    """
    x = wx + s * ux - t * vx
    y = wy + s * uy - t * vy
    z = wz + s * uz - t * vz
    return x * x + y * y + z * z


@kernel
def clamped(value):
    """A share from 0 to 1 [1].

    Checked  tests/net_capture/test_segments.py
    """
    return min(max(value, 0.0), 1.0)


@kernel
def closest(ux, uy, uz, vx, vy, vz, wx, wy, wz):
    """Where two threads are nearest to one another: shares of both from their first ends [1], square of that gap [m2].

        least |w + s u - t v|^2 for 0 <= s, t <= 1

    u, v      from end to end of either                     [m]
    w         from the second's first end to the first's    [m]

    A convex function on a square is least where its gradient vanishes, if that is inside, and else on one of four
    sides. Of threads that are parallel a whole stretch is nearest; then one of its ends is told.

    Valid    threads of no length too
    Source   Ericson, Real-Time Collision Detection (2005), section 5.1.9; here all four sides are tried
    Checked  tests/net_capture/test_segments.py
    """
    a = ux * ux + uy * uy + uz * uz
    b = ux * vx + uy * vy + uz * vz
    e = vx * vx + vy * vy + vz * vz
    d = ux * wx + uy * wy + uz * wz
    q = vx * wx + vy * wy + vz * wz
    det = a * e - b * b
    if det > PARALLEL * a * e:
        s = (b * q - e * d) / det
        t = (a * q - b * d) / det
        if 0.0 < s < 1.0 and 0.0 < t < 1.0:
            return s, t, gap_at(s, t, ux, uy, uz, vx, vy, vz, wx, wy, wz)
    best_s = 0.0
    best_t = clamped(q / e) if e > 0.0 else 0.0
    least = gap_at(best_s, best_t, ux, uy, uz, vx, vy, vz, wx, wy, wz)
    for side in range(1, 4):
        if side == 1:
            s = 1.0
            t = clamped((q + b) / e) if e > 0.0 else 0.0
        else:
            t = 1.0 if side == 3 else 0.0
            s = clamped((b * t - d) / a) if a > 0.0 else 0.0
        found = gap_at(s, t, ux, uy, uz, vx, vy, vz, wx, wy, wz)
        if found < least:
            best_s = s
            best_t = t
            least = found
    return best_s, best_t, least


@kernel
def volume(ux, uy, uz, vx, vy, vz, wx, wy, wz):
    """Six times the signed volume of the tetrahedron of both threads' ends [m3]; arguments as for `closest`.

        w . (u x v)

    It changes its sign where the lines through both threads cross.

    Checked  tests/net_capture/test_segments.py
    """
    return wx * (uy * vz - uz * vy) + wy * (uz * vx - ux * vz) + wz * (ux * vy - uy * vx)


@kernel
def passes(ux, uy, uz, vx, vy, vz, wx, wy, wz, pu, pv, pw, qu, qv, qw, ru, rv, rw):
    """Whether two threads went through each other on the straight ways that led here: 1 or 0.

    u, v, w                       as for `closest`, now                       [m]
    pu, pv, pw; qu, qv, qw; ru, rv, rw    how far u, v and w have changed     [m]

    The tetrahedron of their ends turned inside out, and as it was flat the lines met, within both threads. It is flat
    as well where both are parallel, and then the lines are apart. Of threads that are parallel all the time it has no
    volume: these went through each other if their closest vector turned round.

    Valid    threads that cross once in that time
    Checked  tests/net_capture/test_segments.py
    """
    bx, by, bz, cx, cy, cz, dx, dy, dz = ux - pu, uy - pv, uz - pw, vx - qu, vy - qv, vz - qw, wx - ru, wy - rv, wz - rw
    before = volume(bx, by, bz, cx, cy, cz, dx, dy, dz)
    now = volume(ux, uy, uz, vx, vy, vz, wx, wy, wz)
    a = ux * ux + uy * uy + uz * uz
    b = ux * vx + uy * vy + uz * vz
    e = vx * vx + vy * vy + vz * vz
    if a * e - b * b <= PARALLEL * a * e:
        s, t, _ = closest(ux, uy, uz, vx, vy, vz, wx, wy, wz)
        i, j, _ = closest(bx, by, bz, cx, cy, cz, dx, dy, dz)
        x = (wx + s * ux - t * vx) * (dx + i * bx - j * cx)
        y = (wy + s * uy - t * vy) * (dy + i * by - j * cy)
        z = (wz + s * uz - t * vz) * (dz + i * bz - j * cz)
        return 1 if x + y + z < 0.0 else 0
    if (before < 0.0) == (now < 0.0):
        return 0
    early = 1.0
    late = 0.0
    for _ in range(HALVINGS):
        left = 0.5 * (early + late)
        bx, by, bz = ux - left * pu, uy - left * pv, uz - left * pw
        cx, cy, cz = vx - left * qu, vy - left * qv, vz - left * qw
        dx, dy, dz = wx - left * ru, wy - left * rv, wz - left * rw
        if (volume(bx, by, bz, cx, cy, cz, dx, dy, dz) < 0.0) == (now < 0.0):
            late = left
        else:
            early = left
    a = bx * bx + by * by + bz * bz
    b = bx * cx + by * cy + bz * cz
    e = cx * cx + cy * cy + cz * cz
    d = bx * dx + by * dy + bz * dz
    q = cx * dx + cy * dy + cz * dz
    det = a * e - b * b
    if det <= 0.0:
        return 0
    s = (b * q - e * d) / det
    t = (a * q - b * d) / det
    moved = pu * pu + pv * pv + pw * pw + qu * qu + qv * qv + qw * qw + ru * ru + rv * rv + rw * rw
    met = gap_at(s, t, bx, by, bz, cx, cy, cz, dx, dy, dz) <= MET * moved
    return 1 if met and 0.0 <= s <= 1.0 and 0.0 <= t <= 1.0 else 0


@kernel
def pair_mass(one, two, three, four):
    """Mass [kg] that two threads feel which meet in their middles: m = 4 / (1/m1 + 1/m2 + 1/m3 + 1/m4).

    one ... four    1/m of their ends   [1/kg]

    Checked  tests/net_capture/test_self_contact.py
    """
    return 4.0 / (one + two + three + four)


@kernel
def spring(mass, duration):
    """Stiffness [N/m] of a contact: c = m (pi / t)^2.

    mass      m    see `pair_mass`                          [kg]
    duration  t    of a contact without damping in the middle of both threads   [s]

    Checked  tests/net_capture/test_self_contact.py
    """
    return mass * (math.pi / duration) * (math.pi / duration)


@kernel
def stiffening(duration):
    """What one contact adds at a node at most, between threads of like nodes: half of its swing's square [1/s2], see
    `formulas.longest_step`.

        w^2 = c (1/m1 + 1/m3) = 2 (pi / t)^2 at their ends

    duration  t    see `spring`                             [s]

    Between unlike ones it may be up to twice that; what touches in truth is watched, `self_contact.margin_least`.

    Checked  tests/net_capture/test_self_contact.py
    """
    return (math.pi / duration) * (math.pi / duration)
