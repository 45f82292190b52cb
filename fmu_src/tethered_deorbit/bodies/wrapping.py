"""Over which edges the line goes round a convex body: the shortest way from where it is made fast to where it leaves.

Over a step of the integrator the edges stay as they are, and the length of the `path` over them is a smooth function of
the state. The step ends where they no longer hold: where the line would pull on an edge, pass through the body, or has
slid to a corner. Then an edge on which it pulls is left; where it passes through the body it is led round, over the
edge between the face it enters by and the one it leaves by; and off a corner it slips to the other side, where it is
shorter at once. So turns are counted. A line that is broken or cut lies over no edge any more: what is told of it is
the straight way.

Checked  tests/tethered_deorbit/test_wrapping.py
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from fmu_src.tethered_deorbit.bodies.corners import make_corners
from fmu_src.tethered_deorbit.bodies.leading import make_leading
from fmu_src.tethered_deorbit.bodies.path import make_path
from fmu_src.tethered_deorbit.bodies.polyhedron import (
    DEPTH,
    NONE,
    make_polyhedron,
)
from fmu_src.tethered_deorbit.bodies.unfolded import follow_unfolded, unfold
from fmu_src.tethered_deorbit.idle import always, never, no_fault, nothing, zero
from fmu_src.tethered_deorbit.interface import BODIES_MET
from fmu_src.tethered_deorbit.parted import make_loose
from fmu_src.tethered_deorbit.surfaces.surface import Surface
from orbital.kernel import kernel
from orbital.vectors import Array, dot

FOLLOWED = 0.5
"""By how much body and line may turn in a step for the line's way to be followed [rad]."""


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
    rise(record) -> s                sine of the angle at which a straight line rises from the face on which it is made
                                     fast, of the whole way last followed; none where it goes over edges or starts
                                     elsewhere
    slides(record) -> bool           whether it runs over an edge, on which it could slide; fills what the others ask
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
    rise: Callable[..., Any] = zero
    slides: Callable[..., Any] = never
    relief: Callable[..., Any] = zero
    pivot: Callable[..., Any] = nothing
    publish: Callable[..., Any] = nothing
    differentiate: Callable[..., Any] = nothing
    leaving: str = ""
    on_body: str = "state_no_length"
    turning: float = math.inf


def make_wrapping(surface: Surface, terms: Mapping[str, str]) -> Wrapping:
    """The kernels for a body with this surface, in a scene with these terms."""
    loose = make_loose(terms)
    faces, lay_out = surface.faces, surface.lay_out
    polyhedron = make_polyhedron(faces, surface.edges)
    path = make_path(polyhedron)
    met, sound = polyhedron.met, path.sound
    follow_path, keep, show_way = path.follow, path.keep, path.publish
    run_at_corner, slip = make_corners(path, surface)
    settle, start = make_leading(path, polyhedron, surface, keep)

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
        if loose(record):
            return bool(r.held_count == 0)
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
        if loose(record):
            r.held_count = 0
        else:
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
    def slides(record: Any) -> bool:
        """Whether the line runs over an edge; fills what a way that was not followed as a whole has left out.

        Checked  tests/tethered_deorbit/test_settled_wrapped.py: a line that settles and slides
        """
        if record[0].held_count == 0:
            return False
        follow_unfolded(record, True)
        return True

    @kernel
    def rise(record: Any) -> float:
        """Sine of the angle at which the line rises from its face: see `Wrapping`.

        Checked  tests/tethered_deorbit/test_settled_wrapped.py: a step that would go over an edge and back
        """
        r = record[0]
        face = r.state_faces[r.state_own_face]
        if r.held_count > 0 or dot(face[0:3], r.target_attachment) - face[3] < -DEPTH * r.state_extent:
            return 0.0
        return dot(face[0:3], r.path_ways[0])

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
        rise=rise,
        slides=slides,
        relief=path.relief,
        pivot=path.pivot,
        publish=publish,
        differentiate=path.differentiate,
        leaving="state_departure",
        on_body="state_wrapped",
        turning=FOLLOWED,
    )
