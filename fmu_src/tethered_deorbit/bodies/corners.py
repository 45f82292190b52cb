"""How a line slips off a corner of the body to which it has slid."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fmu_src.tethered_deorbit.bodies.path import CLOSE, Path
from fmu_src.tethered_deorbit.bodies.polyhedron import NONE, TOGETHER, at_corner, at_edge, face_beyond, other_side
from fmu_src.tethered_deorbit.surfaces.surface import CORNER_EDGES, Surface
from orbital.kernel import kernel

APART = 0.02
"""Share of an edge from which on the way over it is sought."""


def make_corners(path: Path, surface: Surface) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """The kernels `run_at_corner(record) -> (first, last)` and `slip(record)` for the way round a body.

    Checked  tests/tethered_deorbit/test_way.py: a line slips off a corner
    """
    edges, capacity = surface.edges, surface.ways
    tighten, leave, sound, follow, keep = path.tighten, path.leave, path.sound, path.follow, path.keep

    @kernel
    def run_at_corner(record: Any) -> tuple[int, int]:
        """First and last place in the way of the edges that it meets at one corner to which it has slid, or (-1, -1).

        Checked  tests/tethered_deorbit/test_way.py: a line slips off a corner
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
    def relax(record: Any, count: int) -> float:
        """Length [m] of the way over as many edges, or fewer: those on which it presses.

        Checked  tests/tethered_deorbit/test_way.py: a line slips off a corner
        """
        r = record[0]
        while True:
            for i in range(3):
                r.path_points[count + 1][i] = r.path_far[i]
            r.path_count = count
            length = tighten(record, count)
            fewer = leave(record, count)
            if fewer < 0:
                return float(length)
            count = fewer

    @kernel
    def round_corner(record: Any, first: int, last: int) -> int:
        """How many edges lead round a corner on the other side than a run of the way's edges; fills `corner`.

        Checked  tests/tethered_deorbit/test_way.py: a line slips off a corner
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
    def slip(record: Any) -> None:
        """The way last followed slips off a corner, if that makes it shorter.

        The edges that it meets there give place to none, to one of the others of that corner, or to all of them, over
        which it comes round on the other side: whatever makes it shortest.

        Checked  tests/tethered_deorbit/test_way.py: a line slips off a corner
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
            length = relax(record, count)
            # led round no further: it might come round by the other side of the body, and lose a turn
            if length < shortest - CLOSE * r.state_extent and sound(record):
                shortest = length
                keep(record)
        follow(record)

    return run_at_corner, slip
