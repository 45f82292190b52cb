"""Over which edges the line goes round a convex body: the shortest way from where it is made fast to where it leaves.

Over a step of the integrator the edges stay as they are, and the length of the `path` over them is a smooth function of
the state. The step ends where they no longer hold: where the line would pull on an edge, pass through the body, or has
slid to a corner. Then an edge on which it pulls is left; where it passes through the body it is led round, over the
edge between the face it enters by and the one it leaves by; and off a corner it slips to the other side, where it is
shorter at once. So turns are counted.

Checked  tests/tethered_deorbit/test_wrapping.py
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.tethered_deorbit.bodies.corners import make_corners
from fmu_src.tethered_deorbit.bodies.path import make_path
from fmu_src.tethered_deorbit.bodies.polyhedron import (
    DEPTH,
    NONE,
    crossing,
    crosswise,
    face_beyond,
    make_polyhedron,
    nearest_to,
    on_both,
    other_side,
)
from fmu_src.tethered_deorbit.bodies.unfolded import follow_unfolded, unfold
from fmu_src.tethered_deorbit.idle import always, never, no_fault, nothing, zero
from fmu_src.tethered_deorbit.interface import BODIES_MET, TOO_MANY_TURNS
from fmu_src.tethered_deorbit.surfaces.surface import Surface
from orbital.kernel import kernel
from orbital.vectors import Array, add_scaled, cross, dot, unit

FOLLOWED = 0.5
"""By how much body and line may turn in a step for the line's way to be followed [rad]."""
ROUNDS = 400
"""Most edges taken and left in one search."""
DIRECTIONS = 16
"""In which a line sets out round the body at the start, of which the shortest is taken."""
OPPOSITE = 0.01
"""Square of the sum of two faces' normals below which they count as opposite."""


class Wrapping(NamedTuple):
    """Kernels of the line round a body; as it stands, of one that goes straight to where it is made fast.

    follow(record, point, whole)     the way over the edges that are held, to where it ends at the other body, in axes
                                     of this one [m] (3,): fills `state.departure` and `state.wrapped`, the length on
                                     the body [m], and, if the whole is asked for, what all others ask
    begin(record) -> fault           faces and edges from the parameters; no edge is held
    start(record)                    the shortest way, to be followed from then on
    holds(record) -> bool            whether the edges hold for the way last followed
    renew(record)                    the edges that do, to be held from then on; fault: `state.way_fault`
    retry(record) -> bool            where none that hold had been found: whether they could be now
    keep(record)                     the way last followed is where the next is sought from
    trouble(record) -> fault
    book(record, energy)             what the line has lost by a change of its way [J]
    relief(record, across) -> l''    what the line's sliding takes off the second derivative of its length [m/s^2], for
                                     a velocity across it of the far end, body axes [m/s] (3,)
    pivot(record, across)            the point about which the far end turns, in `state.pivot`
    publish(record)                  outputs of the way
    differentiate(record, along, across)   and their rates, for the parts of the velocity along the line and across it
    leaving, on_body                 rows of the point where the line leaves the body, "" the attachment, and of its
                                     length on it
    turning                          by how much body and line may turn in a step for the way to be followed [rad]
    """

    follow: Callable[..., Any] = nothing
    begin: Callable[..., Any] = no_fault
    start: Callable[..., Any] = nothing
    holds: Callable[..., Any] = always
    renew: Callable[..., Any] = nothing
    retry: Callable[..., Any] = never
    keep: Callable[..., Any] = nothing
    trouble: Callable[..., Any] = no_fault
    book: Callable[..., Any] = nothing
    relief: Callable[..., Any] = zero
    pivot: Callable[..., Any] = nothing
    publish: Callable[..., Any] = nothing
    differentiate: Callable[..., Any] = nothing
    leaving: str = ""
    on_body: str = "state_no_length"
    turning: float = math.inf


def make_wrapping(surface: Surface) -> Wrapping:
    """The kernels for a body with this surface."""
    faces, edges, capacity, lay_out = surface.faces, surface.edges, surface.ways, surface.lay_out
    polyhedron = make_polyhedron(faces, edges)
    path = make_path(polyhedron)
    passes, between, met = polyhedron.passes, polyhedron.between, polyhedron.met
    tighten, leave, insert, sound = path.tighten, path.leave, path.insert, path.sound
    follow_path, keep, show, show_way = path.follow, path.keep, path.show, path.publish
    run_at_corner, slip = make_corners(path, surface)

    @kernel
    def begin(record: Any) -> int:
        """Faces and edges from the parameters; the line runs over none yet. Returns 0 or a fault.

        Checked  tests/tethered_deorbit/test_macro_step.py: nothing is left of an earlier run
        """
        r = record[0]
        r.held_count = 0
        r.unfolded_usable = 0
        r.state_way_fault = 0
        r.tether_slip_loss = 0.0
        fault = lay_out(record)
        r.state_own_face = 0
        highest = -math.inf
        for f in range(faces):
            height = dot(r.state_faces[f][0:3], r.target_attachment) - r.state_faces[f][3]
            if height > highest:
                highest = height
                r.state_own_face = f
        return int(fault)

    @kernel
    def trouble(record: Any) -> int:
        """Fault of a line that could not be followed, or 0.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        return int(record[0].state_way_fault)

    @kernel
    def follow(record: Any, point: Array, whole: bool) -> None:
        """The way to a point over the edges that are held: see `Wrapping`.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        for i in range(3):
            record[0].path_far[i] = point[i]
        if not follow_unfolded(record, whole):
            follow_path(record)

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
    def settle(record: Any) -> None:
        """The shortest way to the far end by the edges that hold, from those that are there.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        count = r.path_count
        for i in range(3):
            r.path_points[0][i] = r.target_attachment[i]
        total = 0.0
        for _ in range(ROUNDS):
            for i in range(3):
                r.path_points[count + 1][i] = r.path_far[i]
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
        show(record, total)

    @kernel
    def start(record: Any) -> None:
        """The shortest way, of those that set out in `DIRECTIONS` round the straight line.

        Checked  tests/tethered_deorbit/test_wrapping.py: against a search over a graph
        """
        r = record[0]
        if met(record, r.path_far):
            r.state_way_fault = BODIES_MET
            return
        r.held_count = 0
        r.held_stuck = 0
        follow_path(record)
        settle(record)
        keep(record)
        if r.path_count == 0:
            return
        shortest = r.state_wrapped + r.path_lengths[r.path_count]
        for turn in range(DIRECTIONS):
            for i in range(3):
                r.path_points[1][i] = r.path_far[i]
                r.path_room[2][i] = r.path_far[i]
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
            settle(record)
            length = r.state_wrapped + r.path_lengths[r.path_count]
            if length < shortest * (1.0 - 1.0e-12):
                shortest = length
                keep(record)
        unfold(record)
        follow_path(record)

    @kernel
    def complete(record: Any) -> None:
        """Points on all edges of the way last followed: over one edge or none they are there.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        if record[0].held_count > 1:
            follow_path(record)

    @kernel
    def beyond_its_face(record: Any) -> bool:
        """Whether the far end lies above the face on which the line is made fast: then a straight line meets no other.

        Checked  tests/tethered_deorbit/test_wrapping.py: against all faces
        """
        r = record[0]
        face = r.state_faces[r.state_own_face]
        depth = DEPTH * r.state_extent
        return bool(
            dot(face[0:3], r.target_attachment) - face[3] >= -depth and dot(face[0:3], r.path_far) - face[3] > 0.0
        )

    @kernel
    def hold_way(record: Any) -> None:
        """The way last followed becomes that from which others are followed, with its points on all edges.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        complete(record)
        keep(record)

    @kernel
    def publish(record: Any) -> None:
        """What is shown of the way last followed, with its points on all edges.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        complete(record)
        show_way(record)

    @kernel
    def holds(record: Any) -> bool:
        """Whether the edges hold for the way last followed; those that could not be renewed are held all the same.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        if r.held_count == 0 and beyond_its_face(record):
            return True
        if met(record, r.path_far):
            return False
        if r.held_stuck == 1:
            return True
        complete(record)
        return bool(sound(record) and run_at_corner(record)[0] == NONE)

    @kernel
    def renew(record: Any) -> None:
        """The edges that hold from here: see `Wrapping`.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        if met(record, r.path_far):
            r.state_way_fault = BODIES_MET
            return
        r.held_stuck = 0
        follow_path(record)
        settle(record)
        keep(record)
        slip(record)
        r.held_stuck = 0 if holds(record) else 1
        unfold(record)

    @kernel
    def retry(record: Any) -> bool:
        """Whether edges that are held although they do not hold could be renewed now; they are held on.

        Checked  tests/tethered_deorbit/test_wrapping.py
        """
        r = record[0]
        if r.held_stuck == 0:
            return False
        count = r.held_count
        for k in range(count):
            r.kept_edges[k] = r.held_edges[k]
            r.kept_along[k] = r.held_along[k]
        renew(record)
        found = bool(r.held_stuck == 0)
        r.held_stuck = 1
        r.held_count = count
        for k in range(count):
            r.held_edges[k] = r.kept_edges[k]
            r.held_along[k] = r.kept_along[k]
        r.state_way_fault = 0
        unfold(record)
        follow_path(record)
        return found

    @kernel
    def book(record: Any, energy: float) -> None:
        """Add what the line has lost by changing its way [J].

        Checked  tests/tethered_deorbit/test_wrapping.py: a taut line slips
        """
        record[0].tether_slip_loss += energy

    return Wrapping(
        follow=follow,
        begin=begin,
        start=start,
        holds=holds,
        renew=renew,
        retry=retry,
        keep=hold_way,
        trouble=trouble,
        book=book,
        relief=path.relief,
        pivot=path.pivot,
        publish=publish,
        differentiate=path.differentiate,
        leaving="state_departure",
        on_body="state_wrapped",
        turning=FOLLOWED,
    )
