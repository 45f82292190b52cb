"""The convex hull of points by an incremental algorithm, without allocation: its volume and surface.

A tetrahedron of far points is grown point by point: the faces that a point sees give way to the cone from it over the
edge of what it sees. Points that lie in a plane are the base of a pyramid with a point of our own, which tells their
area.

Nodes that lie on a face of the target, or on top of one another, are in no general position, and rounding would decide
which faces they see. So each coordinate is moved by up to a millionth of the size of all, by its number: that is what
volume and area are off by, and rounding is far below it. Where a point is nevertheless found outside afterwards, all is
done again with other movements.

Source   the beneath-beyond method; e.g. de Berg and others, Computational Geometry (2008), chapter 11; joggled
         as Qhull does on request (Barber and others, ACM Transactions on Mathematical Software 22 (1996) 469)
Checked  tests/net_capture/test_hull.py, against scipy's Qhull
"""

from __future__ import annotations

import math
from typing import Any

from orbital.kernel import kernel, view

SEEN = 1e-12
"""Distance from a face, in the points' own size, from which a point sees it."""
FLAT = 1e-9
"""Distance from a plane, in the same, below which all points count as in it."""
JOGGLE = 1e-6
"""By which each coordinate is moved at most, in the same: the square of it is far above rounding, 1e-16."""
POINT_WORDS, FACE_WORDS = 3, 10
"""Numbers of scratch for a point: its place; for a face: corners, plane, whether it is seen, an edge of the gap."""
ATTEMPTS = 8
"""To find a hull that no point is outside of."""
DIRECTIONS = 13
"""Along which the farthest points both ways are taken first: others are then mostly inside."""


@view
def _part(scratch, at, size):
    """So many numbers of the scratch, from there on.

    Checked  tests/net_capture/test_hull.py
    """
    return scratch[at : at + size]


@kernel
def room(scratch_size, most):
    """Faces for which a scratch of that size has room beside `most` points and one of our own [1].

    Checked  tests/net_capture/test_hull.py
    """
    return (scratch_size - POINT_WORDS * (most + 1)) // FACE_WORDS


@kernel
def lay_face(points, faces, planes, most, face, a, b, c):
    """Write a face of three corners, and its plane, outward to the side from which they turn left.

    Checked  tests/net_capture/test_hull.py
    """
    faces[3 * face] = a
    faces[3 * face + 1] = b
    faces[3 * face + 2] = c
    ux, uy, uz = (
        points[3 * b] - points[3 * a],
        points[3 * b + 1] - points[3 * a + 1],
        points[3 * b + 2] - points[3 * a + 2],
    )
    vx, vy, vz = (
        points[3 * c] - points[3 * a],
        points[3 * c + 1] - points[3 * a + 1],
        points[3 * c + 2] - points[3 * a + 2],
    )
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    size = math.sqrt(nx * nx + ny * ny + nz * nz)
    share = 1.0 / size if size > 0.0 else 0.0
    planes[face] = nx * share
    planes[most + face] = ny * share
    planes[2 * most + face] = nz * share
    planes[3 * most + face] = share * (nx * points[3 * a] + ny * points[3 * a + 1] + nz * points[3 * a + 2])


@kernel
def look_out(planes, seen, most, count, x, y, z):
    """Faces that a point sees, their numbers into `seen`; how many.

    Checked  tests/net_capture/test_hull.py
    """
    found = 0
    for face in range(count):
        above = planes[face] * x + planes[most + face] * y + planes[2 * most + face] * z - planes[3 * most + face]
        if above > SEEN:
            seen[found] = face
            found += 1
    return found


@kernel
def is_inner(faces, seen, found, a, b):
    """Whether the edge from a to b of a seen face is one of another seen face too.

    Checked  tests/net_capture/test_hull.py
    """
    for other in range(found):
        f = 3 * seen[other]
        for k in range(3):
            if faces[f + k] == b and faces[f + (k + 1) % 3] == a:
                return True
    return False


@kernel
def take_in(points, faces, planes, seen, edges, most, count, point):
    """Grow the hull by a point; how many faces it then has, or -1 where there is no room for them.

    Checked  tests/net_capture/test_hull.py
    """
    found = look_out(planes, seen, most, count, points[3 * point], points[3 * point + 1], points[3 * point + 2])
    if found == 0:
        return count
    gap = 0
    for k in range(found):
        f = 3 * seen[k]
        for corner in range(3):
            a = faces[f + corner]
            b = faces[f + (corner + 1) % 3]
            if not is_inner(faces, seen, found, a, b):
                if gap == most:
                    return -1
                edges[2 * gap] = a
                edges[2 * gap + 1] = b
                gap += 1
    if count - found + gap > most:
        return -1
    for k in range(gap):
        face = seen[k] if k < found else count + k - found
        lay_face(points, faces, planes, most, face, edges[2 * k], edges[2 * k + 1], point)
    count += gap - found
    # faces that have left more holes than there are new ones: the last of all fill them
    for k in range(found - 1, gap - 1, -1):
        last = count + k - gap
        if seen[k] != last:
            f = 3 * last
            lay_face(points, faces, planes, most, seen[k], faces[f], faces[f + 1], faces[f + 2])
    return count


@kernel
def farthest(points, number, x, y, z):
    """The point farthest along a direction.

    Checked  tests/net_capture/test_hull.py
    """
    best = 0
    reach = -math.inf
    for i in range(number):
        along = x * points[3 * i] + y * points[3 * i + 1] + z * points[3 * i + 2]
        if along > reach:
            reach = along
            best = i
    return best


@kernel
def begin(points, faces, planes, most, number):
    """Lay a tetrahedron of far points: its faces, 0 where all lie on a line, and whether all lie in a plane.

    Then its last corner is a point of our own, number `number`, one size of the points above the plane.

    Checked  tests/net_capture/test_hull.py
    """
    a = farthest(points, number, 1.0, 0.0, 0.0)
    b = a
    reach = 0.0
    for i in range(number):
        x, y, z = (
            points[3 * i] - points[3 * a],
            points[3 * i + 1] - points[3 * a + 1],
            points[3 * i + 2] - points[3 * a + 2],
        )
        squared = x * x + y * y + z * z
        if squared > reach:
            reach = squared
            b = i
    length = math.sqrt(reach)
    if length <= FLAT:
        return 0, True
    ux, uy, uz = (
        (points[3 * b] - points[3 * a]) / length,
        (points[3 * b + 1] - points[3 * a + 1]) / length,
        (points[3 * b + 2] - points[3 * a + 2]) / length,
    )
    c = a
    reach = 0.0
    nx = ny = nz = 0.0
    for i in range(number):
        x, y, z = (
            points[3 * i] - points[3 * a],
            points[3 * i + 1] - points[3 * a + 1],
            points[3 * i + 2] - points[3 * a + 2],
        )
        px, py, pz = uy * z - uz * y, uz * x - ux * z, ux * y - uy * x
        squared = px * px + py * py + pz * pz
        if squared > reach:
            reach = squared
            c = i
            nx, ny, nz = px, py, pz
    size = math.sqrt(reach)
    if size <= FLAT:
        return 0, True
    nx, ny, nz = nx / size, ny / size, nz / size
    top = farthest(points, number, nx, ny, nz)
    bottom = farthest(points, number, -nx, -ny, -nz)
    base = nx * points[3 * a] + ny * points[3 * a + 1] + nz * points[3 * a + 2]
    above = nx * points[3 * top] + ny * points[3 * top + 1] + nz * points[3 * top + 2] - base
    below = base - nx * points[3 * bottom] - ny * points[3 * bottom + 1] - nz * points[3 * bottom + 2]
    flat = max(above, below) <= FLAT
    d = top if above >= below else bottom
    if flat:
        d = number
        points[3 * d] = points[3 * a] + nx
        points[3 * d + 1] = points[3 * a + 1] + ny
        points[3 * d + 2] = points[3 * a + 2] + nz
    if flat or above >= below:
        b, c = c, b
    lay_face(points, faces, planes, most, 0, a, b, c)
    lay_face(points, faces, planes, most, 1, a, c, d)
    lay_face(points, faces, planes, most, 2, c, b, d)
    lay_face(points, faces, planes, most, 3, b, a, d)
    return 4, flat


@kernel
def measure(points, faces, count):
    """Six times the volume within the faces, and twice their area.

    Checked  tests/net_capture/test_hull.py
    """
    volume = 0.0
    area = 0.0
    for f in range(0, 3 * count, 3):
        a, b, c = 3 * faces[f], 3 * faces[f + 1], 3 * faces[f + 2]
        ux, uy, uz = points[b] - points[a], points[b + 1] - points[a + 1], points[b + 2] - points[a + 2]
        vx, vy, vz = points[c] - points[a], points[c + 1] - points[a + 1], points[c + 2] - points[a + 2]
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        volume += points[a] * nx + points[a + 1] * ny + points[a + 2] * nz
        area += math.sqrt(nx * nx + ny * ny + nz * nz)
    return volume, area


@kernel
def shrink(points, number):
    """Move points to their mean and divide them by their size, which is returned [m].

    Checked  tests/net_capture/test_hull.py
    """
    for axis in range(3):
        mean = 0.0
        for i in range(number):
            mean += points[3 * i + axis]
        mean /= number
        for i in range(number):
            points[3 * i + axis] -= mean
    size = 0.0
    for i in range(3 * number):
        size = max(size, abs(points[i]))
    if size > 0.0:
        for i in range(3 * number):
            points[i] /= size
    return size


@kernel
def scatter(number):
    """A number from -1 to 1 that follows from a whole number, and has nothing of its order.

    Source   the last steps of MurmurHash3 (Appleby), on 32 bits
    Checked  tests/net_capture/test_hull.py
    """
    h = (number + 1) & 0xFFFFFFFF
    h ^= h >> 16
    h = (h * 0x85EBCA6B) & 0xFFFFFFFF
    h ^= h >> 13
    h = (h * 0xC2B2AE35) & 0xFFFFFFFF
    h ^= h >> 16
    return h / 2147483648.0 - 1.0


@kernel
def joggle(points, number, attempt):
    """Move every coordinate by its own little, another one at each attempt.

    Checked  tests/net_capture/test_hull.py
    """
    for i in range(3 * number):
        points[i] += JOGGLE * scatter(attempt * 3 * number + i)


@kernel
def farthest_first(points, number):
    """Put the farthest points of some directions first: others are then mostly inside, and seen by no face.

    Checked  tests/net_capture/test_hull.py
    """
    for direction in range(min(2 * DIRECTIONS, number)):
        code = direction if direction < DIRECTIONS else direction + 1
        x, y, z = code % 3 - 1.0, code // 3 % 3 - 1.0, code // 9 - 1.0
        best = direction
        reach = -math.inf
        for i in range(direction, number):
            along = x * points[3 * i] + y * points[3 * i + 1] + z * points[3 * i + 2]
            if along > reach:
                reach = along
                best = i
        for axis in range(3):
            kept = points[3 * direction + axis]
            points[3 * direction + axis] = points[3 * best + axis]
            points[3 * best + axis] = kept


@kernel
def outside(points, planes, most, count, number):
    """How far the farthest point is outside of a face, in the points' own size.

    Checked  tests/net_capture/test_hull.py
    """
    worst = 0.0
    for face in range(count):
        x, y, z, base = planes[face], planes[most + face], planes[2 * most + face], planes[3 * most + face]
        for i in range(number):
            above = x * points[3 * i] + y * points[3 * i + 1] + z * points[3 * i + 2] - base
            worst = max(worst, above)
    return worst


def make_hull() -> Any:
    """Kernel `hull(scratch, number) -> volume [m3], area [m2]` of so many points at the begin of the scratch, which it
    moves; volume -1 where there is no room.

    Points of no volume count as what they are: a flat hull has both its sides as area.
    """
    from fmu_src.lanes import whole

    @kernel
    def hull(scratch, number):
        """Volume [m3] and area [m2] of the convex hull.

        scratch    three coordinates of each point first                [m]
        number     of points, at least 1                                [1]

        Checked  tests/net_capture/test_hull.py
        """
        most = room(scratch.size, number)
        at = POINT_WORDS * (number + 1)
        points = _part(scratch, 0, at)
        words = whole(scratch)
        faces, planes = _part(words, at, 3 * most), _part(scratch, at + 3 * most, 4 * most)
        seen, edges = _part(words, at + 7 * most, most), _part(words, at + 8 * most, 2 * most)
        size = shrink(points, number)
        if size == 0.0 or most < 4:
            return 0.0 if size == 0.0 else -1.0, 0.0
        farthest_first(points, number)
        for attempt in range(ATTEMPTS):
            count, flat = begin(points, faces, planes, most, number)
            if count == 0:
                return 0.0, 0.0
            a, b, c, d = faces[0], faces[1], faces[2], faces[5]
            joggle(points, number, attempt)
            for face in range(4):
                f = 3 * face
                lay_face(points, faces, planes, most, face, faces[f], faces[f + 1], faces[f + 2])
            for i in range(number):
                if count > 0 and i not in (a, b, c, d):
                    count = take_in(points, faces, planes, seen, edges, most, count, i)
            if count > 0 and outside(points, planes, most, count, number) < 10.0 * JOGGLE:
                break
            count = -1
        if count < 0:
            return -1.0, 0.0
        volume, area = measure(points, faces, count)
        if flat:
            # six times that of a pyramid of height one: its base, from both sides
            return 0.0, volume * size * size
        return volume * size * size * size / 6.0, 0.5 * area * size * size

    return hull
