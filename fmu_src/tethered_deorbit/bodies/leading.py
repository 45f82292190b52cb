"""How the line is led round a convex body where it would pass through it, and the shortest way where it begins."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from fmu_src.tethered_deorbit.bodies.path import Path
from fmu_src.tethered_deorbit.bodies.polyhedron import (
    NONE,
    Polyhedron,
    crossing,
    crosswise,
    face_beyond,
    nearest_to,
    on_both,
    other_side,
)
from fmu_src.tethered_deorbit.bodies.unfolded import unfold
from fmu_src.tethered_deorbit.interface import BODIES_MET, TOO_MANY_TURNS
from fmu_src.tethered_deorbit.surfaces.surface import Surface
from orbital.kernel import kernel
from orbital.vectors import Array, add_scaled, cross, dot, unit

ROUNDS = 400
"""Most edges taken and left in one search."""
DIRECTIONS = 16
"""In which a line sets out round the body at the start, of which the shortest is taken."""
OPPOSITE = 0.01
"""Square of the sum of two faces' normals below which they count as opposite."""


def make_leading(
    path: Path, polyhedron: Polyhedron, surface: Surface, keep: Callable[..., Any]
) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """The kernels `settle(record)` and `start(record)` for a body with this surface.

    keep(record)     the way last followed is where the next is sought from

    Checked  tests/tethered_deorbit/test_way.py
    """
    faces, edges, capacity = surface.faces, surface.edges, surface.ways
    passes, between, met = polyhedron.passes, polyhedron.between, polyhedron.met
    tighten, leave, insert, show, follow_path = path.tighten, path.leave, path.insert, path.show, path.follow

    @kernel
    def round_by(
        record: Any, count: int, place: int, face: int, goal: int, normal: Array, forth: bool, put: bool
    ) -> tuple[float, int]:
        """Length [m] of the way over the faces that a plane cuts, from one face to another, and its number of edges.

        forth         which way round
        put           put its edges into the way, before `place`

        Returns infinity where there is no such way.

        Checked  tests/tethered_deorbit/test_way.py: an attachment behind the body
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

        Checked  tests/tethered_deorbit/test_way.py
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

        Checked  tests/tethered_deorbit/test_way.py
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

        Checked  tests/tethered_deorbit/test_way.py: against a search over a graph
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

    return settle, start
