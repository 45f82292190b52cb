"""What a body is, round which the line can wrap: a convex polyhedron, and the rows that all of them have.

Face f is n . x <= h, kept as (n, h); edge e is o + t d for 0 <= t <= l, kept as (o, d, l), between two faces. All in
body axes, from the centre of mass; the middle of the body stands at `target.center`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from fmu_src.interface import Variable
from fmu_src.rows import count, output, peak, rate, state, vector

NO_BODY = 33
"""Fault of a shape that is no body."""
CORNER_EDGES = 8
"""How many edges may meet at a corner beside those by which a line comes to it."""


class Surface(NamedTuple):
    """A kind of body.

    name        of the term
    called      what it is
    faces, edges  how many it has
    ways        over how many edges the line may run
    rows        its parameters
    lay_out(record) -> fault   kernel that writes faces, edges, the two faces of each edge, the middle and the size from
                them
    """

    name: str
    called: str
    faces: int
    edges: int
    ways: int
    rows: tuple[Variable, ...]
    lay_out: Callable[[Any], int]

    def variables(self) -> tuple[Variable, ...]:
        """Its parameters, and what every surface has."""
        return (
            *self.rows,
            vector("target.center", "m", "of the body's shape, from the centre of mass, body axes", "parameter",
                   minimum=-1e4, maximum=1e4),
            output("tether.span", "m", "straight distance of the two attachments", 10.0, "rate.span"),
            output("tether.wrapped", "m", "of the line's length on the target's surface", 10.0, "rate.wrapped"),
            count("tether.bends", "edges of the target over which the line runs"),
            peak("tether.slip_loss", "J", "energy that the taut line has lost by slipping off corners, since the start",
                 1.0),
            rate("span", "m/s"),
            rate("wrapped", "m/s"),
            state("state.faces[#][#]", "1", "normal and height of each face", shape=(self.faces, 4)),
            state("state.edges[#][#]", "1", "begin, direction and length of each edge", shape=(self.edges, 7)),
            state("state.sides[#][#]", "1", "the two faces of each edge", kind="Integer", shape=(self.edges, 2)),
            vector("state.middle", "m", "of the body's shape", "state"),
            state("state.extent", "m", "size of the body"),
            state("state.own_face", "1", "face on which the line is made fast", kind="Integer"),
            vector("state.departure", "m", "where the line leaves the body, body axes", "state"),
            vector("state.pivot", "m", "about which the line's far end turns, body axes", "state"),
            state("state.wrapped", "m", "length of the line on the body"),
            state("state.way_fault", "1", "fault of a way that could not be followed", kind="Integer"),
            state("held.stuck", "1", "they are held although they do not hold", kind="Integer"),
            state("held.count", "1", "edges of the way at the begin of the step", kind="Integer"),
            state("held.edges[#]", "1", "these edges", kind="Integer", shape=(self.ways,)),
            state("held.along[#]", "m", "where along them", shape=(self.ways,)),
            state("path.count", "1", "edges of the way last followed", kind="Integer"),
            state("path.edges[#]", "1", "these edges", kind="Integer", shape=(self.ways,)),
            state("path.held[#]", "1", "whether it is caught at a corner there", kind="Integer", shape=(self.ways,)),
            *(state(f"path.{name}[#]", "m", text, shape=(self.ways,)) for name, text in (
                ("along", "where along them"), ("before", "the same before a change"), ("change", "what changes it"))),
            *(state(f"path.{name}[#]", "1/m", "of the Hessian of the length", shape=(self.ways,))
              for name in ("diagonal", "beside")),
            vector("path.far", "m", "where the way ends at the other body, body axes", "state"),
            state("path.points[#][#]", "m", "of the way, its ends among them", shape=(self.ways + 2, 3)),
            state("path.ways[#][#]", "1", "directions between them", shape=(self.ways + 1, 3)),
            state("path.lengths[#]", "m", "lengths between them", shape=(self.ways + 1,)),
            state("unfolded.usable", "1", "the way over the edges held can be laid out flat", kind="Integer"),
            state("unfolded.along", "m", "of the attachment along the last edge, in the plane of that"),
            state("unfolded.off", "m", "and from it"),
            state("unfolded.low", "m", "along the last edge, from where on all other edges are met"),
            state("unfolded.high", "m", "and up to where"),
            state("unfolded.edges[#][#]", "1", "of the other edges: what the way's share up to each follows from",
                  shape=(self.ways, 3)),
            state("unfolded.ends[#][#]", "m", "where they begin and end in that plane", shape=(2 * self.ways, 2)),
            state("corner.edges[#]", "1", "other edges of a corner", kind="Integer", shape=(CORNER_EDGES,)),
            state("corner.along[#]", "m", "where along them", shape=(CORNER_EDGES,)),
            state("kept.edges[#]", "1", "edges held before a vain search", kind="Integer", shape=(self.ways,)),
            state("kept.along[#]", "m", "where along them", shape=(self.ways,)),
            state("old.edges[#]", "1", "edges of the way before it slips", kind="Integer", shape=(self.ways,)),
            state("old.along[#]", "m", "where along them", shape=(self.ways,)),
            state("path.room[#][#]", "1", "room for vectors", shape=(4, 3)),
        )  # fmt: skip
