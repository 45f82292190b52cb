"""The variables of the two bodies as the line meets them: of a point, and of a body that turns."""

from __future__ import annotations

from fmu_src.interface import Variable
from fmu_src.rows import choice, count, output, parameter, positive, rate, state, vector

RATE_FRAMES = ("inertial", "orbital", "line")
"""What a body rate that a scene gives is relative to."""

POINT_TARGET = (
    parameter("target.attachment_distance", "m", "from the target's centre of mass to where the line is made fast",
              0.0, 0.0, 1e4),
)  # fmt: skip

CYLINDER_SIDES = 24
"""Sides of the prism that stands for a cylinder."""
WAYS = {"box": 64, "cylinder": 6 * CYLINDER_SIDES}
"""Over how many edges the line may run: sixteen turns round a box, six round a cylinder."""

CORNER_EDGES = 8
"""How many edges may meet at a corner beside those by which a line comes to it."""

ATTACHED = (
    state("state.line[#][#]", "1", "vector of the line, its rate, and room", shape=(4, 3)),
    state("state.no_length", "m", "zero: the line ends where it is made fast"),
)
"""Of a pair of which a body turns."""


def rigid_body(role: str, attachment: tuple[float, float, float]) -> tuple[Variable, ...]:
    """Those of a body that turns.

    role          "target" or "chaser"
    attachment    where the line is made fast unless a scene says so [m]
    """
    return (
        parameter(f"{role}.inertia[#]", "kg.m2", "about the centre of mass, along body axes, with all it carries: I11, "
                  "I22, I33, I12, I13, I23, the elements of the matrix", (1000.0, 1000.0, 1000.0, 0.0, 0.0, 0.0),
                  -1e12, 1e12, shape=(6,)),
        parameter(f"{role}.attachment[#]", "m", "where the line is made fast, from the centre of mass, body axes",
                  attachment, -1e4, 1e4, shape=(3,)),
        parameter(f"{role}.start_attitude[#]", "1", "quaternion from body axes to the orbital frame of the orbit's "
                  "point at the start, scalar first; zero: aligned", 0.0, -1.0, 1.0, shape=(4,)),
        parameter(f"{role}.start_rate[#]", "rad/s", "body rate at the start, body axes", 0.0, -100.0, 100.0, shape=(3,),
                  display_unit="deg/s"),
        choice(f"{role}.rate_frame", "what start_rate is relative to: inertial space, the orbital frame, or the line "
               "of centres as it turns", RATE_FRAMES),
        Variable(f"{role}.gravity_gradient", "1", "parameter", "whether the gravity gradient turns the body", True,
                 kind="Boolean"),
        Variable(f"{role}.attitude[#]", "1", "output", "quaternion from body to inertial axes, scalar first",
                 shape=(4,), nominal=1.0, rate=f"rate.{role}_attitude[#]"),
        vector(f"{role}.rate", "rad/s", "body rate relative to inertial space, body axes", nominal=0.1,
               rate=f"rate.{role}_rate[#]", display_unit="deg/s"),
        vector(f"{role}.spin", "N.m.s", "angular momentum about the body's centre of mass, inertial axes",
               nominal=100.0, rate=f"rate.{role}_spin[#]"),
        output(f"{role}.spin_energy", "J", "kinetic energy of its turning relative to inertial space", 1.0,
               f"rate.{role}_spin_energy"),
        state(f"state.{role}_inertia[#][#]", "kg.m2", "matrix of inertia", shape=(3, 3)),
        state(f"state.{role}_inverse[#][#]", "1", "its inverse [1/(kg m2)]", shape=(3, 3)),
        state(f"state.{role}_turned[#][#]", "1", "matrix of the attitude last used", shape=(3, 3)),
        state(f"state.{role}_arms[#][#]", "1", "attachment from the centre of mass, its rate, and room", shape=(5, 3)),
        state(f"state.{role}_scale", "m", "by which errors of the attitude are weighed"),
        rate(f"{role}_attitude", "1/s", (4,)),
        rate(f"{role}_rate", "rad/s2", (3,)),
        rate(f"{role}_spin", "N.m", (3,)),
        rate(f"{role}_spin_energy", "W"),
    )  # fmt: skip


THRUSTER = (
    vector("chaser.thruster", "m", "where the thrust acts, from the centre of mass, body axes", "parameter",
           minimum=-1e4, maximum=1e4),
    state("state.push[#][#]", "1", "room for a force and its torque", shape=(2, 3)),
)  # fmt: skip
"""Of a chaser that turns."""


def surface(faces: int, edges: int, ways: int) -> tuple[Variable, ...]:
    """Those of a target that the line can wrap round, of so many faces and edges, and ways over so many edges."""
    return (
        vector("target.center", "m", "of the body's shape, from the centre of mass, body axes", "parameter",
               minimum=-1e4, maximum=1e4),
        output("tether.span", "m", "straight distance of the two attachments", 10.0, "rate.span"),
        output("tether.wrapped", "m", "of the line's length on the target's surface", 10.0, "rate.wrapped"),
        count("tether.bends", "edges of the target over which the line runs"),
        rate("span", "m/s"),
        rate("wrapped", "m/s"),
        state("state.faces[#][#]", "1", "normal and height of each face", shape=(faces, 4)),
        state("state.edges[#][#]", "1", "begin, direction and length of each edge", shape=(edges, 7)),
        state("state.sides[#][#]", "1", "the two faces of each edge", kind="Integer", shape=(edges, 2)),
        vector("state.middle", "m", "of the body's shape", "state"),
        state("state.extent", "m", "size of the body"),
        vector("state.departure", "m", "where the line leaves the body, body axes", "state"),
        state("state.wrapped", "m", "length of the line on the body"),
        state("state.way_fault", "1", "fault of a way that could not be followed", kind="Integer"),
        state("held.stuck", "1", "they are held although they do not hold", kind="Integer"),
        state("held.count", "1", "edges of the way at the begin of the step", kind="Integer"),
        state("held.edges[#]", "1", "these edges", kind="Integer", shape=(ways,)),
        state("held.along[#]", "m", "where along them", shape=(ways,)),
        state("path.count", "1", "edges of the way last followed", kind="Integer"),
        state("path.edges[#]", "1", "these edges", kind="Integer", shape=(ways,)),
        state("path.held[#]", "1", "whether it is caught at a corner there", kind="Integer", shape=(ways,)),
        *(state(f"path.{name}[#]", "m", text, shape=(ways,)) for name, text in (
            ("along", "where along them"), ("before", "the same before a change"), ("change", "what changes it"))),
        *(state(f"path.{name}[#]", "1/m", "of the Hessian of the length", shape=(ways,))
          for name in ("diagonal", "beside")),
        state("path.points[#][#]", "m", "of the way, its ends among them", shape=(ways + 2, 3)),
        state("path.ways[#][#]", "1", "directions between them", shape=(ways + 1, 3)),
        state("path.lengths[#]", "m", "lengths between them", shape=(ways + 1,)),
        state("corner.edges[#]", "1", "other edges of a corner", kind="Integer", shape=(CORNER_EDGES,)),
        state("corner.along[#]", "m", "where along them", shape=(CORNER_EDGES,)),
        state("kept.edges[#]", "1", "edges held before a vain search", kind="Integer", shape=(ways,)),
        state("kept.along[#]", "m", "where along them", shape=(ways,)),
        state("old.edges[#]", "1", "edges of the way before it slips", kind="Integer", shape=(ways,)),
        state("old.along[#]", "m", "where along them", shape=(ways,)),
        state("path.room[#][#]", "1", "room for vectors", shape=(4, 3)),
    )  # fmt: skip


BOX = (
    Variable("target.size[#]", "m", "parameter", "edges along the body axes", 2.0, shape=(3,), minimum=0.0, maximum=1e4,
             open_minimum=True),
    *surface(6, 12, WAYS["box"]),
)  # fmt: skip
CYLINDER = (
    positive("target.cylinder_radius", "m", "of the cylinder about the third body axis", 1.0, 1e4),
    positive("target.cylinder_length", "m", "of the cylinder along it", 2.0, 1e4),
    *surface(CYLINDER_SIDES + 2, 3 * CYLINDER_SIDES, WAYS["cylinder"]),
)
