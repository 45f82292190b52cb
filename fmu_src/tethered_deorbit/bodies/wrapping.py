"""The line round a convex body: the shortest way from where it is made fast, over edges, to where it leaves.

The body is a polyhedron of faces n . x <= h and edges o + t d, in body axes. A line that is pulled taut runs from the
attachment x_0 over points x_i = o_i + t_i d_i of some edges to the other body at x_(k+1), and its length

    L = min over 0 <= t_i <= l_i of  sum |x_(i+1) - x_i|

is a convex function, whose gradient by the far end is the direction in which the line leaves the last edge: the line
slides without friction, and pulls the body where it leaves it. (A length on the body counts as
sqrt(|..|^2 + e^2), e a millionth of the body, so that it stays smooth where two edges meet at a corner.) Over a step of
the integrator the edges stay as they are, and the length is a smooth function of the state. The step ends where they no
longer hold: where the line would pull on an edge, pass through the body, or has slid to a corner. Then an edge on which
it pulls is left; where it passes through the body it is led round, over the edge between the face it enters by and the
one it leaves by; and off a corner it slips to the other side, where it is shorter at once. So turns are counted.

Source   convex minimisation; Newton's method for a tridiagonal Hessian
Checked  tests/tethered_deorbit/test_wrapping.py
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.tethered_deorbit.body_rows import CORNER_EDGES
from fmu_src.tethered_deorbit.interface import BODIES_MET, TOO_MANY_TURNS
from orbital.kernel import kernel
from orbital.vectors import Array, add_scaled, cross, distance, dot, unit

PULL = 1e-11
"""Bend of the line away from the body [rad] from which on it pulls."""
DEPTH = 1e-10
"""Depth below the faces, as a share of the body's size, from which on a line passes through the body."""
ROUNDS, ITERATIONS, HALVINGS = 400, 40, 8
DIRECTIONS = 16
"""In which a line sets out round the body at the start, of which the shortest is taken."""
CLOSE = 4.0 * 2.220446049250313e-16
SOFT, TOGETHER = 1e-6, 1e-5
"""Shares of the body's size: length by which lengths on it are softened, and within which points are at one corner."""
APART = 0.02
"""Share of an edge from which on the way over it is sought."""
OPPOSITE = 0.01
"""Square of the sum of two faces' normals below which they count as opposite."""
NONE = -1


class Wrapping(NamedTuple):
    """Kernels of the line round a body; `point` is where it ends at the other body, in axes of this one [m] (3,).

    start(record, point)             the shortest way, to be followed from then on
    follow(record, point)            the way over the edges that are held: fills `state.departure` and `state.wrapped`,
                                     the length on the body [m], and what the others ask
    holds(record)                    whether the edges hold for the way last followed
    renew(record, point)             the edges that do, to be held from then on; fault: `state.way_fault`
    retry(record, point)             the same where none that hold had been found: whether they are now
    keep(record)                     the way last followed is where the next is sought from
    sliding(record, across) -> t'    how fast the line slides along the last edge [m/s], for a velocity across it of the
                                     far end, body axes [m/s] (3,)
    relief(record, across) -> l''    and what that takes off the second derivative of its length [m/s^2]
    publish(record)                  outputs of the way
    differentiate(record, along, across)   and their rates, for the parts of the velocity along the line and across it
    """

    start: Callable[..., Any]
    follow: Callable[..., Any]
    holds: Callable[..., Any]
    renew: Callable[..., Any]
    retry: Callable[..., Any]
    keep: Callable[..., Any]
    sliding: Callable[..., Any]
    relief: Callable[..., Any]
    publish: Callable[..., Any]
    differentiate: Callable[..., Any]


def make_wrapping(faces: int, edges: int, capacity: int) -> Wrapping:
    """The kernels for a body of so many faces and edges, and ways over so many edges."""

    @kernel
    def at_edge(record: Any, out: Array, edge: int, along: float) -> None:
        """out = point of an edge [m] at a distance along it.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        row = record[0].state_edges[edge]
        for i in range(3):
            out[i] = row[i] + along * row[3 + i]

    @kernel
    def measure(record: Any, count: int) -> float:
        """Length of the way [m]; fills its points, directions and lengths. What lies on the body is softened.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        points, ways, lengths = r.path_points, r.path_ways, r.path_lengths
        total = 0.0
        for k in range(count):
            at_edge(record, points[k + 1], r.path_edges[k], r.path_along[k])
        for k in range(count + 1):
            square = 0.0
            for i in range(3):
                ways[k][i] = points[k + 1][i] - points[k][i]
                square += ways[k][i] * ways[k][i]
            soft = SOFT * r.state_extent if k < count else 0.0
            lengths[k] = max(math.sqrt(square + soft * soft), 1.0e-12 * r.state_extent)
            for i in range(3):
                ways[k][i] /= lengths[k]
            total += lengths[k]
        return total

    @kernel
    def tighten(record: Any, count: int) -> float:
        """Shortest length [m] of a way over its edges, by Newton's method held within the edges.

        Checked  tests/tethered_deorbit/test_wrapping.py, against scipy
        """
        r = record[0]
        ways, lengths = r.path_ways, r.path_lengths
        diagonal, beside, change = r.path_diagonal, r.path_beside, r.path_change
        total = measure(record, count)
        for _ in range(ITERATIONS):
            for k in range(count):
                direction = r.state_edges[r.path_edges[k]][3:6]
                into, out = dot(direction, ways[k]), dot(direction, ways[k + 1])
                gradient = into - out
                diagonal[k] = (1.0 - into * into) / lengths[k] + (1.0 - out * out) / lengths[k + 1]
                beside[k] = 0.0
                along, end = r.path_along[k], r.state_edges[r.path_edges[k]][6]
                held = (along <= 0.0 and gradient > 0.0) or (along >= end and gradient < 0.0)
                r.path_held[k] = 1 if held else 0
                change[k] = 0.0 if held else -gradient
                if held:
                    diagonal[k] = 1.0
                elif k > 0 and r.path_held[k - 1] == 0:
                    before = r.state_edges[r.path_edges[k - 1]][3:6]
                    beside[k] = (dot(before, ways[k]) * into - dot(before, direction)) / lengths[k]
            for k in range(count):
                if k > 0:
                    factor = beside[k] / diagonal[k - 1]
                    diagonal[k] -= factor * beside[k]
                    change[k] -= factor * change[k - 1]
                diagonal[k] = max(diagonal[k], 1.0e-9 / lengths[k])
            largest = 0.0
            for j in range(count):
                k = count - 1 - j
                following = beside[k + 1] * change[k + 1] if k + 1 < count else 0.0
                change[k] = (change[k] - following) / diagonal[k]
            share = 1.0
            for k in range(count):
                r.path_before[k] = r.path_along[k]
            for _ in range(HALVINGS):
                largest = 0.0
                for k in range(count):
                    end = r.state_edges[r.path_edges[k]][6]
                    moved = min(end, max(0.0, r.path_before[k] + share * change[k]))
                    largest = max(largest, abs(moved - r.path_before[k]))
                    r.path_along[k] = moved
                shorter = measure(record, count)
                if shorter <= total * (1.0 + CLOSE):
                    break
                share *= 0.25
            total = shorter
            if largest <= CLOSE * r.state_extent:
                break
        return total

    @kernel
    def outward(record: Any, out: Array, point: Array) -> None:
        """out = sum of the normals of the faces that meet at a point [-].

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        for i in range(3):
            out[i] = 0.0
        for f in range(faces):
            face = r.state_faces[f]
            if abs(dot(face[0:3], point) - face[3]) <= TOGETHER * r.state_extent:
                for i in range(3):
                    out[i] += face[i]

    @kernel
    def pulling(record: Any, count: int) -> int:
        """Place of the edge on which the line pulls most and does not press, or from which it turns back; or -1.

            (u_(i+1) - u_i) . (n_a + n_b + ..) < 0,   n the normals of the faces that meet there, u the directions
                                                      before and after a corner as a whole

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        worst, most, normal = NONE, PULL, r.path_room[0]
        for k in range(1, count):
            here, next_edge = r.path_edges[k], r.path_edges[min(k + 1, count - 1)]
            if here == r.path_edges[k - 1] or (k + 1 < count and next_edge == r.path_edges[k - 1]):
                return k
        for k in range(count):
            before, after = k, k + 1
            while before > 0 and r.path_lengths[before] <= TOGETHER * r.state_extent:
                before -= 1
            while after < count and r.path_lengths[after] <= TOGETHER * r.state_extent:
                after += 1
            outward(record, normal, r.path_points[k + 1])
            pull = 0.0
            for i in range(3):
                pull += (r.path_ways[after][i] - r.path_ways[before][i]) * normal[i]
            if pull > most:
                worst, most = k, pull
        return worst

    @kernel
    def leave(record: Any, count: int) -> int:
        """Number of edges once the one on which the line pulls most is left; -1 if it presses on all.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        worst = pulling(record, count)
        if worst == NONE:
            return NONE
        for k in range(worst, count - 1):
            r.path_edges[k] = r.path_edges[k + 1]
            r.path_along[k] = r.path_along[k + 1]
        return count - 1

    @kernel
    def on_both(record: Any, first: int, second: int) -> bool:
        """Whether two edges have a face in common: between them the line lies on it.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        sides = record[0].state_sides
        a, b, c, d = sides[first][0], sides[first][1], sides[second][0], sides[second][1]
        return bool(a in (c, d) or b in (c, d))

    @kernel
    def face_beyond(record: Any, edge: int, way: Array, sign: float) -> int:
        """The face of an edge over which a line goes on that comes to it along a way, or, sign -1, has come from.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        a, b = r.state_sides[edge][0], r.state_sides[edge][1]
        return int(a if sign * (dot(way, r.state_faces[a][0:3]) - dot(way, r.state_faces[b][0:3])) > 0.0 else b)

    @kernel
    def passes(record: Any, first: Array, last: Array) -> tuple[bool, int, int, float, float]:
        """Whether a straight line passes through the body, the faces by which it enters and leaves, and where.

        Returns (it does, face, face, fraction, fraction); a point within the body enters by the face that is nearest.

        Source   clipping by half-spaces: Cyrus and Beck, Computers and Graphics 3 (1978) 23
        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        begin, end, face_in, face_out = 0.0, 1.0, NONE, NONE
        nearest, height = 0, -math.inf
        depth = DEPTH * r.state_extent
        for f in range(faces):
            face = r.state_faces[f]
            above = dot(face[0:3], first) - face[3]
            slope = dot(face[0:3], last) - face[3] - above
            if above > height:
                nearest, height = f, above
            above += depth
            if slope < 0.0:
                where = -above / slope
                if where > begin:
                    begin, face_in = where, f
            elif slope > 0.0:
                where = -above / slope
                if where < end:
                    end, face_out = where, f
            elif above > 0.0:
                return False, NONE, NONE, 0.0, 0.0
        if face_in == NONE:
            face_in = nearest
        return bool(begin < end and face_out != NONE), face_in, face_out, begin, end

    @kernel
    def other_side(record: Any, edge: int, face: int) -> int:
        """The face of an edge that is not this one.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        sides = record[0].state_sides[edge]
        return int(sides[0] if sides[1] == face else sides[1])

    @kernel
    def between(record: Any, first: int, second: int) -> int:
        """The edge between two faces, or -1.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        sides = record[0].state_sides
        for e in range(edges):
            if (sides[e][0] == first and sides[e][1] == second) or (sides[e][0] == second and sides[e][1] == first):
                return e
        return NONE

    @kernel
    def insert(record: Any, count: int, place: int, edge: int, along: float) -> None:
        """Put an edge into the way, before the one at `place`.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        for j in range(count - place):
            k = count - j
            r.path_edges[k] = r.path_edges[k - 1]
            r.path_along[k] = r.path_along[k - 1]
        r.path_edges[place] = edge
        r.path_along[place] = min(r.state_edges[edge][6], max(0.0, along))

    @kernel
    def nearest_to(record: Any, edge: int, first: Array, last: Array) -> float:
        """Where along an edge [m] a straight line between two points comes nearest to it.

        Source   common perpendicular of two lines
        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        row = record[0].state_edges[edge]
        aa, ab, ac, bc = 0.0, 0.0, 0.0, 0.0
        for i in range(3):
            way, off = last[i] - first[i], row[i] - first[i]
            aa += way * way
            ab += way * row[3 + i]
            ac += way * off
            bc += row[3 + i] * off
        divisor = aa - ab * ab
        return (ab * ac - aa * bc) / divisor if divisor > 1.0e-12 * aa else 0.5 * row[6]

    @kernel
    def crossing(record: Any, edge: int, normal: Array, through: Array) -> float:
        """Where along an edge [m] a plane through a point crosses it, or -1.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        row = r.state_edges[edge]
        low, slope = 0.0, 0.0
        for i in range(3):
            low += normal[i] * (row[i] - through[i])
            slope += normal[i] * row[3 + i]
        high = low + slope * row[6]
        if (low > 0.0) == (high > 0.0):
            return -1.0
        return -low / slope

    @kernel
    def round_by(
        record: Any, count: int, place: int, face: int, goal: int, normal: Array, forth: bool, put: bool
    ) -> tuple[float, int]:
        """Length [m] of the way over the faces that a plane cuts, from one face to another, and its number of edges.

        forth         which way round
        put           put its edges into the way, before `place`

        Returns infinity where there is no such way.

        Checked  tests/tethered_deorbit/test_wrapping.py: an attachment behind the body
        """
        r = record[0]
        last, length, found, came = r.path_points[place], 0.0, 0, NONE
        here = r.path_room[0]
        for i in range(3):
            here[i] = last[i]
        for _ in range(faces):
            step, along = NONE, -1.0
            for e in range(edges):
                if e == came or not (r.state_sides[e][0] == face or r.state_sides[e][1] == face):
                    continue
                where = crossing(record, e, normal, last)
                if where < 0.0:
                    continue
                if came == NONE:
                    # the first of the two edges of this face: by the side of the middle on which it lies
                    row, side = r.state_edges[e], 0.0
                    for i in range(3):
                        side += r.path_room[1][i] * (row[i] + where * row[3 + i] - last[i])
                    if (side > 0.0) != forth:
                        continue
                step, along = e, where
                break
            if step == NONE or (put and count + found >= capacity):
                return math.inf, 0
            square = 0.0
            for i in range(3):
                next_to = r.state_edges[step][i] + along * r.state_edges[step][3 + i]
                square += (next_to - here[i]) * (next_to - here[i])
                here[i] = next_to
            length += math.sqrt(square)
            if put:
                insert(record, count + found, place + found, step, along)
            found += 1
            came = step
            face = other_side(record, step, face)
            if face == goal:
                square = 0.0
                for i in range(3):
                    square += (r.path_room[2][i] - here[i]) * (r.path_room[2][i] - here[i])
                return length + math.sqrt(square), found
        return math.inf, 0

    @kernel
    def crosswise(out: Array, way: Array) -> None:
        """out = a direction [-] across another.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        thin = 0
        for i in range(3):
            if abs(way[i]) < abs(way[thin]):
                thin = i
        for i in range(3):
            out[i] = (1.0 if i == thin else 0.0) - way[thin] * way[i]
        unit(out, out)

    @kernel
    def lead_round(record: Any, count: int) -> int:
        """Number of edges once a stretch that passes through the body is led round it; -1 if none does, or there is no
        way, -2 if there is no room for it.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        points, ways = r.path_points, r.path_ways
        for k in range(count + 1):
            if 0 < k < count and on_both(record, r.path_edges[k - 1], r.path_edges[k]):
                continue
            through, face_in, face_out, _, _ = passes(record, points[k], points[k + 1])
            if not through:
                continue
            if k > 0:
                face_in = face_beyond(record, r.path_edges[k - 1], ways[k - 1], 1.0)
            if k < count:
                face_out = face_beyond(record, r.path_edges[k], ways[k + 1], -1.0)
            if face_in == face_out:
                continue
            if count >= capacity:
                return -2
            edge = between(record, face_in, face_out)
            if k > 0 and edge == r.path_edges[k - 1]:
                # back over the edge it has come by is no way round: on over its other face
                face_in = other_side(record, edge, face_in)
                edge = between(record, face_in, face_out)
            if k < count and edge == r.path_edges[k]:
                face_out = other_side(record, edge, face_out)
                edge = between(record, face_in, face_out)
            if face_in == face_out:
                continue
            if edge != NONE:
                insert(record, count, k, edge, nearest_to(record, edge, points[k], points[k + 1]))
                return count + 1
            # the plane of the line and of what is outward between the two faces; between opposite ones, from the middle
            normal, across, goal, way = r.path_room[3], r.path_room[1], r.path_room[2], ways[k]
            for i in range(3):
                goal[i] = points[k + 1][i]
                across[i] = r.state_faces[face_in][i] + r.state_faces[face_out][i]
            if dot(across, across) < OPPOSITE:
                for i in range(3):
                    across[i] = 0.5 * (points[k][i] + points[k + 1][i]) - r.state_middle[i]
            add_scaled(across, across, -dot(across, way), way)
            if not unit(across, across) > 0.0:
                crosswise(across, way)
            cross(normal, way, across)
            length, found = round_by(record, count, k, face_in, face_out, normal, True, False)
            forth = length < math.inf
            if not forth:
                length, found = round_by(record, count, k, face_in, face_out, normal, False, False)
            if not length < math.inf:
                continue
            if count + found > capacity:
                return -2
            round_by(record, count, k, face_in, face_out, normal, forth, True)
            return count + found
        return NONE

    @kernel
    def show_departure(record: Any, total: float) -> None:
        """Where the line leaves the body [m], and how much of its length [m] lies on it.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        for i in range(3):
            r.state_departure[i] = r.path_points[r.path_count][i]
        r.state_wrapped = total - r.path_lengths[r.path_count]

    @kernel
    def settle(record: Any, point: Array) -> None:
        """The shortest way to a point by the edges that hold, from those that are there.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        count = r.path_count
        for i in range(3):
            r.path_points[0][i] = r.target_attachment[i]
        total = 0.0
        for _ in range(ROUNDS):
            for i in range(3):
                r.path_points[count + 1][i] = point[i]
            total = tighten(record, count)
            fewer = leave(record, count)
            if fewer >= 0:
                count = fewer
                continue
            more = lead_round(record, count)
            if more == -2:
                r.state_way_fault = TOO_MANY_TURNS
                break
            if more < 0:
                break
            count = more
        r.path_count = count
        show_departure(record, total)

    @kernel
    def follow(record: Any, point: Array) -> None:
        """The way over the edges that are held: see `Wrapping`.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        r.path_count = r.held_count
        for k in range(r.held_count):
            r.path_edges[k] = r.held_edges[k]
            r.path_along[k] = r.held_along[k]
        for i in range(3):
            r.path_points[0][i] = r.target_attachment[i]
            r.path_points[r.held_count + 1][i] = point[i]
        show_departure(record, tighten(record, r.held_count))

    @kernel
    def keep(record: Any) -> None:
        """The way last followed becomes that of the step's begin.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        r.held_count = r.path_count
        for k in range(r.path_count):
            r.held_edges[k] = r.path_edges[k]
            r.held_along[k] = r.path_along[k]

    @kernel
    def start(record: Any, point: Array) -> None:
        """The shortest way to a point, of those that set out in `DIRECTIONS` round the straight line.

        Checked  tests/tethered_deorbit/test_wrapping.py: against a search over a graph
        """
        r = record[0]
        if met(record, point):
            r.state_way_fault = BODIES_MET
            return
        r.held_count = 0
        r.held_stuck = 0
        follow(record, point)
        settle(record, point)
        keep(record)
        if r.path_count == 0:
            return
        shortest = r.state_wrapped + r.path_lengths[r.path_count]
        for turn in range(DIRECTIONS):
            for i in range(3):
                r.path_points[1][i] = point[i]
                r.path_room[2][i] = point[i]
            tighten(record, 0)
            _, face_in, face_out, _, _ = passes(record, r.path_points[0], r.path_points[1])
            # two directions across the line, and the plane that it and a turn of them span
            way, normal, across = r.path_ways[0], r.path_room[3], r.path_room[1]
            crosswise(across, way)
            cross(normal, way, across)
            cosine, sine = math.cos(2.0 * math.pi * turn / DIRECTIONS), math.sin(2.0 * math.pi * turn / DIRECTIONS)
            for i in range(3):
                across[i] = cosine * across[i] + sine * normal[i]
            cross(normal, way, across)
            _, found = round_by(record, 0, 0, face_in, face_out, normal, True, True)
            if found == 0:
                continue
            r.path_count = found
            settle(record, point)
            length = r.state_wrapped + r.path_lengths[r.path_count]
            if length < shortest * (1.0 - 1.0e-12):
                shortest = length
                keep(record)
        follow(record, point)

    @kernel
    def sound(record: Any) -> bool:
        """Whether the line presses on all edges of the way last followed, and passes nowhere through the body.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        count = r.path_count
        if pulling(record, count) != NONE:
            return False
        for k in range(count + 1):
            if 0 < k < count and on_both(record, r.path_edges[k - 1], r.path_edges[k]):
                continue
            through, face_in, face_out, _, _ = passes(record, r.path_points[k], r.path_points[k + 1])
            if through and face_in != face_out:
                return False
        return True

    @kernel
    def run_at_corner(record: Any) -> tuple[int, int]:
        """First and last place in the way of the edges that it meets at one corner to which it has slid, or (-1, -1).

        Checked  tests/tethered_deorbit/test_wrapping.py: a line slips off a corner
        """
        r = record[0]
        near = TOGETHER * r.state_extent
        for k in range(r.path_count):
            last = k
            while last + 1 < r.path_count and r.path_lengths[last + 1] <= near:
                last += 1
            if last > k or r.path_held[k] == 1:
                return k, last
        return NONE, NONE

    @kernel
    def met(record: Any, point: Array) -> bool:
        """Whether the other body has come into this one, its attachment below all faces.

        Checked  tests/tethered_deorbit/test_wrapping.py: bodies that meet
        """
        r = record[0]
        for f in range(faces):
            face = r.state_faces[f]
            if dot(face[0:3], point) - face[3] >= 0.0:
                return False
        return True

    @kernel
    def holds(record: Any) -> bool:
        """Whether the edges hold for the way last followed; those that could not be renewed are held all the same.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        if met(record, r.path_points[r.path_count + 1]):
            return False
        if r.held_stuck == 1:
            return True
        return bool(sound(record) and run_at_corner(record)[0] == NONE)

    @kernel
    def at_corner(record: Any, edge: int, corner: Array) -> float:
        """Where along an edge [m] a corner lies, or -1.

        Checked  tests/tethered_deorbit/test_wrapping.py: a line slips off a corner
        """
        r = record[0]
        row, near = r.state_edges[edge], TOGETHER * r.state_extent
        for end in range(2):
            along, square = end * row[6], 0.0
            for i in range(3):
                off = row[i] + along * row[3 + i] - corner[i]
                square += off * off
            if square <= near * near:
                return float(along)
        return -1.0

    @kernel
    def relax(record: Any, count: int, point: Array) -> float:
        """Length [m] of the way to a point over as many edges, or fewer: those on which it presses.

        Checked  tests/tethered_deorbit/test_wrapping.py: a line slips off a corner
        """
        r = record[0]
        while True:
            for i in range(3):
                r.path_points[count + 1][i] = point[i]
            r.path_count = count
            length = tighten(record, count)
            fewer = leave(record, count)
            if fewer < 0:
                return float(length)
            count = fewer

    @kernel
    def round_corner(record: Any, first: int, last: int) -> int:
        """How many edges lead round a corner on the other side than a run of the way's edges; fills `corner`.

        Checked  tests/tethered_deorbit/test_wrapping.py: a line slips off a corner
        """
        r = record[0]
        edge, corner = r.path_edges[first], r.path_room[0]
        end = r.state_edges[edge][6]
        at_edge(record, corner, edge, 0.0 if r.path_along[first] < 0.5 * end else end)
        face = face_beyond(record, edge, r.path_ways[first], -1.0)
        goal = face_beyond(record, r.path_edges[last], r.path_ways[last + 1], 1.0)
        came, found = edge, 0
        while found < CORNER_EDGES and (face != goal or found == 0):
            step, along = NONE, -1.0
            for e in range(edges):
                if e != came and (r.state_sides[e][0] == face or r.state_sides[e][1] == face):
                    along = at_corner(record, e, corner)
                    if along >= 0.0:
                        step = e
                        break
            if step == NONE:
                break
            r.corner_edges[found] = step
            r.corner_along[found] = along + (APART if along == 0.0 else -APART) * r.state_edges[step][6]
            found += 1
            came, face = step, other_side(record, step, face)
        return found

    @kernel
    def slip(record: Any, point: Array) -> None:
        """The way last followed slips off a corner, if that makes it shorter.

        The edges that it meets there give place to none, to one of the others of that corner, or to all of them, over
        which it comes round on the other side: whatever makes it shortest.

        Checked  tests/tethered_deorbit/test_wrapping.py: a line slips off a corner
        """
        r = record[0]
        keep(record)
        first, last = run_at_corner(record)
        if first == NONE:
            return
        shortest = r.state_wrapped + r.path_lengths[r.path_count]
        behind, whole = r.path_count - last - 1, r.path_count
        others = round_corner(record, first, last)
        for k in range(whole):
            r.old_edges[k] = r.path_edges[k]
            r.old_along[k] = r.path_along[k]
        for attempt in range(-1, others + 1):
            # -1 none of them, then each, then all
            begin, end = (0, others) if attempt == others else (max(0, attempt), attempt + 1)
            count = first
            for k in range(first):
                r.path_edges[k] = r.old_edges[k]
                r.path_along[k] = r.old_along[k]
            if count + end - begin + behind > capacity:
                continue
            for k in range(begin, end):
                r.path_edges[count] = r.corner_edges[k]
                r.path_along[count] = r.corner_along[k]
                count += 1
            for k in range(behind):
                r.path_edges[count] = r.old_edges[last + 1 + k]
                r.path_along[count] = r.old_along[last + 1 + k]
                count += 1
            length = relax(record, count, point)
            # led round no further: it might come round by the other side of the body, and lose a turn
            if length < shortest - CLOSE * r.state_extent and sound(record):
                shortest = length
                keep(record)
        follow(record, point)

    @kernel
    def renew(record: Any, point: Array) -> None:
        """The edges that hold from here: see `Wrapping`.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        if met(record, point):
            r.state_way_fault = BODIES_MET
            return
        r.held_stuck = 0
        follow(record, point)
        settle(record, point)
        keep(record)
        slip(record, point)
        r.held_stuck = 0 if holds(record) else 1

    @kernel
    def retry(record: Any, point: Array) -> bool:
        """Renew edges that are held although they do not hold, if that can be done; else they are held on.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        count = r.held_count
        for k in range(count):
            r.kept_edges[k] = r.held_edges[k]
            r.kept_along[k] = r.held_along[k]
        renew(record, point)
        if r.held_stuck == 0:
            return True
        r.held_count = count
        for k in range(count):
            r.held_edges[k] = r.kept_edges[k]
            r.held_along[k] = r.kept_along[k]
        r.state_way_fault = 0
        follow(record, point)
        return False

    @kernel
    def sliding(record: Any, across: Array) -> float:
        """How fast the line slides along the last edge [m/s]: see `Wrapping`.

            t' = d . w/(l p),   d the last edge, p the last pivot of the Hessian, w across the line of length l

        Source   Schur complement of the Hessian of the length
        Checked  tests/tethered_deorbit/test_wrapping.py, against differences
        """
        r = record[0]
        last = r.path_count - 1
        if last < 0 or r.path_held[last] == 1:
            return 0.0
        direction = r.state_edges[r.path_edges[last]][3:6]
        return float(dot(direction, across) / (r.path_lengths[last + 1] * r.path_diagonal[last]))

    @kernel
    def relief(record: Any, across: Array) -> float:
        """What that takes off the second derivative of the length [m/s^2]: t'^2 p.

        Checked  tests/tethered_deorbit/test_wrapping.py, against differences
        """
        r = record[0]
        speed = sliding(record, across)
        return float(speed * speed * r.path_diagonal[max(0, r.path_count - 1)])

    @kernel
    def publish(record: Any) -> None:
        """Length on the body, straight distance of the attachments, and the number of edges; after `follow`.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        r.tether_wrapped = r.state_wrapped
        r.tether_bends = r.path_count
        r.tether_span = distance(r.path_points[r.path_count + 1], r.path_points[0])

    @kernel
    def differentiate(record: Any, along: Array, across: Array) -> None:
        """Their rates [m/s], from parts of the velocity of the far end as the body sees it; after `follow`.

            wrapped' = t' d . u,   span' = (w_along + w_across) . s/|s|,   s from the one attachment to the other

        Checked  tests/tethered_deorbit/test_wrapping.py, against differences
        """
        r = record[0]
        last = r.path_count - 1
        r.rate_wrapped = 0.0
        if last >= 0:
            direction = r.state_edges[r.path_edges[last]][3:6]
            r.rate_wrapped = sliding(record, across) * dot(direction, r.path_ways[last + 1])
        r.rate_span = 0.0
        size = distance(r.path_points[r.path_count + 1], r.path_points[0])
        if size > 0.0:
            for i in range(3):
                straight = (r.path_points[r.path_count + 1][i] - r.path_points[0][i]) / size
                r.rate_span += straight * (along[i] + across[i])

    return Wrapping(start, follow, holds, renew, retry, keep, sliding, relief, publish, differentiate)
