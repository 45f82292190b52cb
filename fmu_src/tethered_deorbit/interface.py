"""The variables of the tethered removal, term by term, and what a scene may choose."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from fmu_src.interface import Fault, Group, Model, Term, Variable
from fmu_src.rows import (
    angle,
    choice,
    count,
    flag,
    moving,
    moving_input,
    output,
    parameter,
    peak,
    positive,
    rate,
    state,
    vector,
)
from fmu_src.tethered_deorbit import stress
from fmu_src.tethered_deorbit.body_rows import APPENDAGE, ATTACHED, NOT_OF_A_BODY, POINT_TARGET, THRUSTER, rigid_body
from fmu_src.tethered_deorbit.net_rows import SERIES
from fmu_src.tethered_deorbit.node_rows import NODES
from fmu_src.tethered_deorbit.optional_rows import AOCS, BREAKING, BURN, ENDS, ENGINES, LEVELS, PLUME, RELEASE, SCHEMES
from fmu_src.tethered_deorbit.orbit_rows import (
    AIR,
    ELECTRODYNAMIC,
    FRICTION,
    OBLATENESS,
    POWER,
    SHADOW,
    SUNLIGHT,
    THIRD_BODIES,
)
from fmu_src.tethered_deorbit.reel_rows import REELS
from fmu_src.tethered_deorbit.state_rows import STATE
from fmu_src.tethered_deorbit.surfaces import SURFACES
from fmu_src.tethered_deorbit.surfaces.surface import NO_BODY

CONDITIONS = ("same_orbit", "vbar", "equal_velocity", "handed_over")
SAME_ORBIT, VBAR, EQUAL_VELOCITY, HANDED_OVER = range(4)
LEADERS = ("target", "chaser")
TUGS = 16
"""Length of the ring of latest tugs: twelve may fall in one minute."""

NOT_FINITE, STEP_NOT_MET, TOO_MANY_EVENTS, TIME_GAP, GROUND = range(1, 6)
BAD_ORBIT, BAD_CHORD, START_STRETCHED, NO_LENGTH, NO_LINE, BAD_PARAMETER, NO_ORBIT = range(11, 18)
BAD_INERTIA, BAD_ATTITUDE, TOO_MANY_TURNS, BODIES_MET = 18, 19, 20, 21
CAME_DOWN, PERIGEE_LOW, PERIGEE_RAISED, CAME_CLOSE, WRAPPED_UP, BROKE, ENDS_AT_START, NO_ARCS, NO_ATTITUDE = range(
    22, 31
)
NO_VERTICAL, BAD_SCHEDULE, RELEASED_AT_START = 31, 32, 34

FAULTS = (
    Fault(NOT_FINITE, "error", "the state is no longer finite; look at the parameters and inputs last set"),
    Fault(STEP_NOT_MET, "error", "the tolerances cannot be met by any step; loosen solver.tolerance_*"),
    Fault(TOO_MANY_EVENTS, "error", "the line goes slack and taut too often in one macro step; take shorter ones"),
    Fault(TIME_GAP, "error", "the communication point does not follow the one before"),
    Fault(GROUND, "end", "the pair has come below the equatorial radius: the orbit has ended"),
    Fault(
        BAD_ORBIT,
        "error",
        "the perigee lies below the equatorial radius; raise orbit.altitude or lower eccentricity",
        True,
    ),
    Fault(BAD_CHORD, "error", "start.separation cannot be a chord of this orbit", True),
    Fault(
        START_STRETCHED,
        "error",
        "the ends of the line start farther apart than a locked line is long: it would start stretched",
        True,
    ),
    Fault(NO_LENGTH, "error", "the line's length with reel.length_offset is not positive", True),
    Fault(NO_LINE, "error", "start.relative_position is zero: the line has no direction", True),
    Fault(BAD_PARAMETER, "error", "a parameter or input is out of its bounds or not finite", True),
    Fault(
        NO_ORBIT, "error", "start.condition needs an orbit, and there is none; take equal_velocity or handed_over", True
    ),
    Fault(BAD_INERTIA, "error", NOT_OF_A_BODY, True),
    Fault(BAD_ATTITUDE, "error", "the attitude at the start must be a quaternion of unit length, or zero", True),
    Fault(
        BODIES_MET,
        "end",
        "the bodies have met: the chaser's end of the line has come to a distance of zero from the target, or into it",
    ),
    Fault(CAME_DOWN, "end", "the pair has come down to ends.altitude"),
    Fault(PERIGEE_LOW, "end", "the perigee has come down to ends.perigee"),
    Fault(PERIGEE_RAISED, "end", "the perigee has risen to ends.raised_perigee"),
    Fault(CAME_CLOSE, "end", "the bodies have come within ends.clearance of each other"),
    Fault(WRAPPED_UP, "end", "more of the line lies on the target than ends.wrapped"),
    Fault(BROKE, "end", "the line has broken: its tension exceeded break.strength"),
    Fault(ENDS_AT_START, "error", "the run would end as it begins: what ends it is met at the start", True),
    Fault(NO_ARCS, "error", "burn.when = arcs needs an orbit, and there is none; take timed"),
    Fault(NO_ATTITUDE, "error", "aocs needs a chaser that turns; name chaser.body = rigid"),
    Fault(
        TOO_MANY_TURNS,
        "error",
        "the line has wrapped round the target over more edges than are followed: "
        + ", ".join(f"{surface.ways} of a {name}" for name, surface in SURFACES.items()),
    ),
    Fault(NO_BODY, "error", "the corners of the target span no body: they lie in a plane, or are one"),
    Fault(NO_VERTICAL, "error", "gains on the angle need a local vertical, and there is no orbit", True),
    Fault(BAD_SCHEDULE, "error", "times of a schedule must increase", True),
    Fault(RELEASED_AT_START, "error", "the line would be cut as the tow begins: it is as low already", True),
)


TURN = 2.0 * math.pi

COMMANDS = ("reel.length_offset", "reel.tension")
"""The input of every law of the line: it settles whether and how hard the line pulls at the start."""

BODIES = (
    positive("chaser.mass", "kg", "chaser with thruster, reel and propellant; held constant", 2000.0, 1e6),
    positive("target.mass", "kg", "debris with the net that holds it", 1000.0, 1e6),
)  # fmt: skip

ORBIT = (
    parameter("orbit.altitude", "m", "semi-major axis less the equatorial radius, 6378.137 km", 800e3, 100e3, 1e8,
              display_unit="km"),
    parameter("orbit.eccentricity", "1", "of the reference orbit", 0.0, 0.0, 0.95),
    angle("orbit.inclination", "of the reference orbit to the equator", math.radians(98.0), 0.0, math.pi),
    angle("orbit.raan", "right ascension of its ascending node", 0.0, -TURN, TURN),
    angle("orbit.argument_of_perigee", "from the node", 0.0, -TURN, TURN),
    angle("orbit.true_anomaly", "of the reference orbit's point at the start", 0.0, -TURN, TURN),
)  # fmt: skip

START = (
    choice(
        "start.condition",
        "same_orbit: both on the reference orbit, the given chord apart, the point half-way in anomaly; vbar: straight "
        "offset along V-bar at rest in the orbital frame; equal_velocity: that offset, equal inertial velocities; "
        "handed_over: the states below",
        CONDITIONS,
    ),
    choice("start.leading", "the body that is ahead on the orbit (not for handed_over)", LEADERS),
    positive("start.separation", "m", "distance of the two centres of mass (not for handed_over)", 10.0, 1e5),
    vector("start.center_position", "m", "handed over: centre of mass less the orbit's point, its orbital frame",
           "parameter", minimum=-1e6, maximum=1e6),
    vector("start.center_velocity", "m/s", "handed over: its rate as seen in that turning frame",
           "parameter", minimum=-1e4, maximum=1e4),
    vector("start.relative_position", "m", "handed over: target minus chaser, the same frame",
           "parameter", minimum=-1e6, maximum=1e6),
    vector("start.relative_velocity", "m/s", "handed over: its rate as seen in that turning frame",
           "parameter", minimum=-1e4, maximum=1e4),
)  # fmt: skip

SOLVER = (
    parameter("solver.tolerance_orbit", "m", "error of the centre of mass in one step", 1e-7, 1e-9, 1e3),
    parameter("solver.tolerance_separation", "m", "error of the relative position in one step", 1e-10, 1e-14, 1.0),
    parameter("solver.tolerance_stretch", "m", "estimated error of the stretch in one step of a taut elastic line",
              1e-11, 1e-15, 1e-3),
)  # fmt: skip

OUTPUTS = (
    output("tether.tension", "N", "in the line, zero when slack", 1.0, "rate.tension",
           partials=(("reel.length_offset", "partial.tension"), ("reel.tension", "partial.tension"),
                     ("reel.brake_offset", "partial.tension"))),
    peak("tether.tension_peak", "N", "largest over the last macro step, also between its ends", 1.0,
         at_start=COMMANDS),
    peak("tether.tension_least", "N", "least over the last macro step, also between its ends", 1.0, at_start=COMMANDS),
    output("tether.impulse", "N.s", "integral of the tension over time, since the start of this instance", 1.0,
           "tether.tension"),
    output("tether.length", "m", "between its attachments: separation less target.attachment_distance", 10.0,
           "tether.length_rate"),
    output("tether.length_rate", "m/s", "its rate of change", 0.01, "rate.length_rate"),
    flag("tether.taut", "the line carries tension",
         partials=(("reel.length_offset", "partial.jump"), ("reel.tension", "partial.jump"))),
    count("tether.tug_count", "how often the line has gone taut and pulled; taut at the start counts",
          at_start=COMMANDS),
    output("tether.angle", "rad", "of the line chaser to target in the orbital plane, from the local vertical towards "
           "along-track", 1.0, "rate.angle", display_unit="deg"),
    peak("tug[#].time", "s", "when the tug began, newest first, since the start of this instance; zero when absent",
         shape=(TUGS,)),
    peak("tug[#].peak", "N", "its largest tension; grows until the line is slack again", shape=(TUGS,),
         at_start=COMMANDS),
    peak("tug[#].speed", "m/s", "rate of lengthening as it began", shape=(TUGS,), at_start=COMMANDS),
    output("separation", "m", "distance of the two centres of mass", 10.0, "rate.separation"),
    peak("approach.distance", "m", "least separation since the start of this instance", 10.0),
    peak("approach.time", "s", "when that was, since the start of this instance"),
    *moving("chaser", "inertial", "inertial", 7e6, 7e3, "rate.chaser_velocity[#]"),
    *moving("target", "inertial", "inertial", 7e6, 7e3, "rate.target_velocity[#]"),
    output("chaser.radius", "m", "distance from the Earth's centre", 7e6, "rate.chaser_radius", display_unit="km"),
    output("target.radius", "m", "distance from the Earth's centre", 7e6, "rate.target_radius", display_unit="km"),
    *moving("relative", "target minus chaser, orbital frame of the centre of mass",
            "its rate as seen in that turning frame", 10.0, 0.01, "rate.relative_velocity[#]"),
    *moving("center", "centre of mass of the pair, inertial", "centre of mass of the pair, inertial", 7e6, 7e3,
            "rate.center_velocity[#]"),
    output("center.semi_major_axis", "m", "osculating, of the centre of mass", 7e6, "rate.semi_major_axis",
           display_unit="km"),
    output("altitude", "m", "of the centre of mass over the equatorial radius", 8e5, "rate.altitude",
           display_unit="km"),
    output("energy.orbital", "J", "kinetic and potential energy of the pair's mass at its centre", 1e11,
           "rate.energy_orbital"),
    output("energy.relative", "J", "Jacobi integral of the relative motion with the line's elastic energy; constant "
           "without thrust and damping on a circular orbit, to first order in length over radius", 0.01,
           "rate.energy_relative", partials=(("reel.length_offset", "partial.energy"),)),
    count("solver.steps", "steps taken"),
    count("solver.rejected", "steps rejected by the error control"),
)  # fmt: skip

THRUST = (
    parameter("thrust.level", "N", "along the named direction; negative against it", -0.01, -1e4, 1e4),
    positive("thrust.specific_impulse", "s", "for the propellant used", 3000.0, 1e6),
    *moving_input("thrust.offset", "N", "added to the level; zero leaves it as the parameters say", -1e4, 1e4, 0.01),
    output("chaser.propellant", "kg", "used since the start of this instance; the masses stay constant", 0.1,
           "rate.propellant"),
    rate("propellant", "kg/s"),
    state("state.propellant", "kg", "used up to the last change of the thrust"),
    state("state.propellant_since", "s", "time of that change"),
)  # fmt: skip

THRUSTS = Group(
    {
        "along_track": Term("thrust along the chaser's own along-track, h x r", THRUST, extremes=stress.THRUST),
        "velocity": Term("thrust along the chaser's inertial velocity", THRUST, extremes=stress.THRUST),
        "tether": Term("thrust along the line, positive towards the target", THRUST, extremes=stress.THRUST),
    },
    selector="direction",
    optional=True,
)

BASE = BODIES + ORBIT + START + SOLVER + OUTPUTS + STATE


def _told(name: str, description: str, **changed: Any) -> Variable:
    """A row that every FMU has, under its name, with another description."""
    return replace(next(v for v in BASE if v.name == name), description=description, **changed)


ENVIRONMENTS = Group(
    {
        "central": Term("gravity of the Earth as a point mass, on each of the two bodies"),
        "none": Term(
            "no field: two free bodies in an inertial frame, for closed forms and the low-friction table",
            (
                _told("start.condition", "equal_velocity: the line along axis 2, both bodies at rest; handed_over: the "
                      "states below; the others need an orbit, and are refused", start=EQUAL_VELOCITY),
                _told("start.leading", "the body at the larger coordinate 2 (not for handed_over)"),
                _told("start.center_position[#]", "handed over: centre of mass, inertial"),
                _told("start.center_velocity[#]", "handed over: its velocity, inertial"),
                _told("start.relative_position[#]", "handed over: target minus chaser, inertial"),
                _told("start.relative_velocity[#]", "handed over: its rate"),
                _told("tether.angle", "of the line chaser to target in the plane of axes 1 and 2, from axis 1 towards "
                      "axis 2"),
                _told("relative.position[#]", "target minus chaser, inertial"),
                _told("relative.velocity[#]", "its rate"),
                _told("energy.relative", "kinetic energy of the relative motion with the line's elastic energy; "
                      "constant without thrust and damping"),
            ),
            lacks=(
                *(v.name for v in ORBIT),
                *("chaser.radius", "target.radius", "center.semi_major_axis", "altitude", "energy.orbital"),
            ),
        ),
    },
    selector="field",
    default="central",
)  # fmt: skip

_TURNING = (
    _told("tether.angle", "of the line of centres, chaser to target, in the orbital plane, from the local vertical "
          "towards along-track"),
    _told("energy.relative", "Jacobi integral of the relative motion, with that of the bodies' turning and the line's "
          "elastic energy; constant without thrust and damping on a circular orbit, to first order in length over "
          "radius"),
    *ATTACHED,
)  # fmt: skip

TARGETS = Group(
    {
        "point": Term("a point mass, the line made fast at a distance from it that turns with the line", POINT_TARGET),
        "rigid": Term(
            "a rigid body that turns, the line made fast where it says: full inertia, torques of the line and of the "
            "gravity gradient",
            (*rigid_body("target", (0.0, -1.0, 0.0)), *_TURNING),
            extremes=stress.TURNING,
        ),
        **{
            name: Term(
                f"{surface.called}, round which the line wraps",
                (*rigid_body("target", (0.0, -1.0, 0.0)), *_TURNING, *surface.variables()),
                extremes=stress.TURNING,
            )
            for name, surface in SURFACES.items()
        },
    },
    selector="body",
    default="point",
)

CHASERS = Group(
    {
        "point": Term("a point mass, the line made fast at it"),
        "rigid": Term(
            "a rigid body that turns, as of the target",
            (*rigid_body("chaser", (0.0, 1.0, 0.0)), *THRUSTER, *_TURNING),
            extremes=stress.CHASER_TURNING,
        ),
    },
    selector="body",
    default="point",
)

MODEL = Model(
    name="tethered_deorbit",
    summary="A chaser with a thruster and a reel tows a captured target on a tether.",
    base=BASE,
    groups={
        "reel": REELS,
        "thrust": THRUSTS,
        "burn": BURN,
        "engine": ENGINES,
        "plume": PLUME,
        "environment": ENVIRONMENTS,
        "friction": FRICTION,
        "oblateness": OBLATENESS,
        "air": AIR,
        "third_bodies": THIRD_BODIES,
        "shadow": SHADOW,
        "sunlight": SUNLIGHT,
        "power": POWER,
        "electrodynamic": ELECTRODYNAMIC,
        "target": TARGETS,
        "chaser": CHASERS,
        "appendage": APPENDAGE,
        "lumped": NODES,
        "net": SERIES,
        "aocs": AOCS,
        "ends": ENDS,
        "break": BREAKING,
        "release": RELEASE,
        "level": LEVELS,
        "solver": SCHEMES,
    },
    faults=FAULTS,
    module="fmu_src.tethered_deorbit.model",
    stop_time=86400.0,
    macro_step=60.0,
    differentiable=True,
)
