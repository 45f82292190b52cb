"""The variables of the two bodies as the line meets them: of a point, and of a body that turns; of its surface in
`surfaces`."""

from __future__ import annotations

from fmu_src.interface import Group, Term, Variable
from fmu_src.rows import choice, output, parameter, positive, rate, state, vector
from fmu_src.tethered_deorbit import stress
from fmu_src.tethered_deorbit.layout import state_layout

LARGEST = state_layout(2, wheels=True, spends=True, moved=2, gathered=2).size
"""Components of the largest state."""
RATE_FRAMES = ("inertial", "orbital", "line")
"""What a body rate that a scene gives is relative to."""
NOT_OF_A_BODY = (
    "no body has that inertia: its principal moments must be positive, none greater than the sum of the others"
)

POINT_TARGET = (
    parameter("target.attachment_distance", "m", "from the target's centre of mass to where the line is made fast",
              0.0, 0.0, 1e4),
)  # fmt: skip

ATTACHED = (
    state("state.line[#][#]", "1", "vector of the line, its rate, and room", shape=(4, 3)),
    state(
        "state.carried", "1", "whether the step holds the line's vector in place of that of the centres", kind="Integer"
    ),
    state("state.seen[#]", "1", "of a step, as it is: see `layout`", shape=(LARGEST,)),
    state("state.seen_rate[#]", "1", "and its rate", shape=(LARGEST,)),
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
        *(state(f"state.{role}_{name}[#]", unit, text, shape=shape) for name, unit, text, shape in (
            ("spin", "rad/s", "rate with which the attitude is carried along in a step, body axes", (3,)),
            ("point", "m", "of the body that is carried along, body axes", (3,)),
            ("turn", "1", "quaternion of its turn since the begin of the step", (4,)))),
        state(f"state.{role}_room[#][#]", "1", "that point from the centre of mass, and its rate", shape=(2, 3)),
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

APPENDAGE = Group(
    {
        "frozen": Term(
            "a hinged appendage of the target, which turned about its hinge and is held fast as the tow begins",
            (
                positive("appendage.mass", "kg", "part of the target's mass", 20.0, 1e6),
                parameter("appendage.inertia[#]", "kg.m2", "about its own centre of mass, body axes of the target, "
                          "as of target.inertia, which has it in it",
                          (10.0, 10.0, 10.0, 0.0, 0.0, 0.0), -1e12, 1e12, shape=(6,)),
                parameter("appendage.center[#]", "m", "its centre of mass where it is held, from that of the target, "
                          "body axes", (2.0, 0.0, 0.0), -1e4, 1e4, shape=(3,)),
                parameter("appendage.hinge[#]", "m", "a point of the hinge's axis, likewise", (1.0, 0.0, 0.0), -1e4,
                          1e4, shape=(3,)),
                parameter("appendage.axis[#]", "1", "direction of the hinge, body axes, of any length",
                          (0.0, 0.0, 1.0), -1e4, 1e4, shape=(3,)),
                parameter("appendage.rate", "rad/s", "at which it turned about the hinge relative to the rest of the "
                          "target, as it was held", 0.0, -100.0, 100.0, display_unit="deg/s"),
                vector("appendage.momentum", "N.m.s", "angular momentum of its motion relative to the rest, about the "
                       "target's centre of mass, body axes: it has become spin of the whole", nominal=10.0),
                output("appendage.energy", "J", "kinetic energy that was lost as the hinge stopped it", 1.0),
                state("state.appendage[#][#]", "1", "room for vectors", shape=(4, 3)),
                state("state.appendage_inertia[#][#]", "kg.m2", "matrix of its inertia", shape=(3, 3)),
            ),
            extremes=stress.APPENDAGE,
        ),
    },
    optional=True,
    follows=lambda terms, values: "frozen",
)  # fmt: skip
