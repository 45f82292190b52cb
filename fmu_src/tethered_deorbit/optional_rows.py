"""The variables of what a scene may add to a tow: burns, engine, plume, attitude control, ends, a line that breaks,
and how it is solved."""

from __future__ import annotations

import math
from collections.abc import Mapping

from fmu_src.interface import Group, Term, Variable
from fmu_src.rows import (
    angle,
    at_least_zero,
    choice,
    count,
    flag,
    output,
    parameter,
    peak,
    positive,
    rate,
    state,
    vector,
)
from fmu_src.tethered_deorbit import stress

NOWHERE, EVERYWHERE = -6378e3, 1e12
"""Altitudes that no orbit reaches: 137 m from the Earth's centre, and out of every reach [m]."""
REENTRY = 120e3
"""Altitude at which a re-entry is taken to begin, by convention [m]."""

ENDS = Group(
    {
        "watched": Term(
            "the run ends by itself: low or high enough, or where the bodies come too close",
            (
                parameter("ends.altitude", "m", "the run ends where the centre of mass comes down to it", REENTRY,
                          NOWHERE, EVERYWHERE, display_unit="km"),
                parameter("ends.perigee", "m", "the run ends where its osculating perigee comes down to it", NOWHERE,
                          NOWHERE, EVERYWHERE, display_unit="km"),
                parameter("ends.raised_perigee", "m", "the run ends where its osculating perigee has risen to it",
                          EVERYWHERE, NOWHERE, EVERYWHERE, display_unit="km"),
                at_least_zero("ends.chaser_extent", "m", "radius of the sphere about its centre of mass that holds the "
                              "chaser", 0.0, 1e4),
                at_least_zero("ends.target_extent", "m", "the same of the target; a box or a cylinder has its surface, "
                              "and this is not asked", 0.0, 1e4),
                at_least_zero("ends.clearance", "m", "the run ends where the two come nearer to each other", 0.0, 1e5),
                at_least_zero("ends.wrapped", "m", "the run ends where more of the line lies on a target that "
                              "has a surface", EVERYWHERE, EVERYWHERE),
                output("ends.time", "s", "when the run has ended itself, since the start; zero before", 1000.0),
            ),
        ),
    },
    optional=True,
    follows=lambda terms, values: "watched",
)  # fmt: skip

BREAKING = Group(
    {
        "breaks": Term(
            "the line breaks where its tension exceeds its strength",
            (
                positive("break.strength", "N", "tension at which the line breaks", 1000.0, 1e12),
                Variable("break.flies_on", "1", "parameter", "both ends fly on; else the run ends there", True,
                         kind="Boolean"),
                flag("break.broken", "the line is broken"),
                peak("break.time", "s", "when it broke, since the start of this instance; zero unless broken"),
                state("state.broken", "1", "the line is broken", kind="Integer"),
            ),
            extremes=stress.BREAKING,
        ),
    },
    optional=True,
    follows=lambda terms, values: "breaks",
)  # fmt: skip

_RELEASE = (
    Variable("release.stops_thrust", "1", "parameter", "the thruster stops as the line is cut", True, kind="Boolean"),
    flag("release.released", "the line is cut"),
    peak("release.time", "s", "when it was cut, since the start of this instance; zero before"),
    flag("release.returned", "since then the bodies have come nearer again, and passed"),
    peak("release.return_distance", "m", "least separation at such a pass; zero before one", 10.0),
    peak("release.return_time", "s", "when that was, since the start of this instance; zero before"),
    state("state.released", "1", "the line is cut", kind="Integer"),
    state("state.returned", "1", "they have passed, up to the begin of the step", kind="Integer"),
    state("state.return_distance", "m", "least separation at a pass, up to the begin of the step"),
    state("state.return_time", "s", "when that was"),
)

RELEASE = Group(
    {
        "time": Term(
            "the line is cut at a time, and both bodies fly on",
            (at_least_zero("release.at", "s", "when", 3600.0, 1e10), *_RELEASE),
            extremes=stress.RELEASE_AT,
        ),
        "altitude": Term(
            "the line is cut where the centre of mass comes down to an altitude, and both bodies fly on",
            (
                parameter("release.altitude", "m", "of the centre of mass, at which", 200e3, NOWHERE, EVERYWHERE,
                          display_unit="km"),
                *_RELEASE,
            ),
            extremes=stress.RELEASE_ALTITUDE,
        ),
        "perigee": Term(
            "the line is cut where the osculating perigee comes down to an altitude, and both bodies fly on",
            (
                parameter("release.perigee", "m", "altitude of the perigee of the centre of mass, at which", 120e3,
                          NOWHERE, EVERYWHERE, display_unit="km"),
                *_RELEASE,
            ),
            extremes=stress.RELEASE_PERIGEE,
        ),
    },
    selector="when",
    optional=True,
)  # fmt: skip

_FORCE = (
    output("thrust.force", "N", "in use, along the direction; negative against it", 0.01, "rate.thrust_force"),
    rate("thrust_force", "N/s"),
)
"""Of a thruster that does not simply give what is asked for."""

_BURN = (
    choice("burn.edge", "how the thrust comes and goes: at once, in a ramp, or with the line's own rate taken out",
           ("step", "ramp", "notch")),
    positive("burn.rise", "s", "how long a ramp takes", 1.0, 1e6),
    *_FORCE,
    state("state.burn", "1", "0 off, 1 on, 2 going", kind="Integer"),
    count("state.burns", "burns begun", "state"),
    state("state.burn_begun", "s", "when the last began"),
    state("state.burn_ended", "s", "when it was let go"),
    state("state.burn_due", "s", "when it changes next by the clock"),
    state("state.burn_rate", "rad/s", "of the pair on its line at the start"),
)  # fmt: skip

BURN = Group(
    {
        "timed": Term(
            "the thruster burns at times of its own: once, or pulse after pulse",
            (
                at_least_zero("burn.start", "s", "when the first begins", 0.0, 1e9),
                at_least_zero("burn.duration", "s", "of each; zero: one period of the pair on its line", 0.0, 1e9),
                at_least_zero("burn.interval", "s", "from one beginning to the next; zero: there is one", 0.0, 1e9),
                count("burn.count", "how many; zero: no end", "parameter"),
                *_BURN,
            ),
            needs=("thrust",),
            extremes=stress.BURNS,
        ),
        "arcs": Term(
            "the thruster burns on arcs about the apsides of the reference orbit",
            (
                choice("burn.about", "which apsides; on a circular orbit, the points named so by orbit.true_anomaly",
                       ("perigee", "apogee", "both")),
                angle("burn.half_width", "of each arc, by the angle of the centre of mass", math.radians(30.0), 1e-6,
                      math.pi),
                *_BURN,
                vector("state.perigee", "1", "direction of the reference orbit's, inertial", "state"),
            ),
            needs=("thrust",),
            extremes=stress.ARCS,
        ),
    },
    selector="when",
    optional=True,
)  # fmt: skip

_ENGINE = (
    positive("engine.propellant", "kg", "in the tank at the start, part of chaser.mass; the masses fall as it is used",
             50.0, 1e6),
    at_least_zero("engine.tank_radius", "m", "radius of gyration of the propellant about the chaser's centre of mass, "
                  "which it leaves where it is: by so much the inertia of a chaser that turns falls", 0.0, 1e3),
    output("engine.propellant_left", "kg", "in the tank", 10.0, "rate.propellant_left"),
    *_FORCE,
    vector("center.position", "m", "centre of mass of the pair, inertial; mass that leaves it at the chaser moves it "
           "besides center.velocity", nominal=7e6, rate="rate.center_position[#]"),
    rate("center_position", "m/s", (3,)),
    rate("propellant_left", "kg/s"),
    state("state.chaser_mass", "kg", "with what is left in the tank"),
    state("state.empty", "1", "the tank is empty", kind="Integer"),
)  # fmt: skip

ENGINES = Group(
    {
        "electric": Term(
            "thrust within the electric power there is; the masses fall",
            (
                *_ENGINE,
                positive("engine.power_limit", "W", "electric power that the thruster may draw", 1000.0, 1e7),
                parameter("engine.efficiency", "1", "power of the jet over that drawn", 0.6, 0.0, 1.0,
                          open_minimum=True),
                output("engine.power", "W", "drawn", 100.0, "rate.engine_power"),
                flag("engine.limited", "more thrust is asked for than the power allows"),
                rate("engine_power", "W/s"),
            ),
            needs=("thrust",),
            extremes=stress.ENGINES,
        ),
        "chemical": Term(
            "any thrust; the masses fall",
            _ENGINE,
            needs=("thrust",),
            extremes=stress.ENGINES,
        ),
    },
    selector="kind",
    optional=True,
)  # fmt: skip

PLUME = Group(
    {
        "beam": Term(
            "the thruster's beam: how much of it meets the target, and whether the line lies in it",
            (
                parameter("plume.half_angle", "rad", "within which 95 % of the beam lie", math.radians(15.0), 1e-3, 1.5,
                          display_unit="deg"),
                positive("plume.face", "m", "side of the square that the target shows the chaser", 4.0, 1e3),
                Variable("plume.pushes", "1", "parameter", "what meets the target pushes it; else it is only told",
                         True, kind="Boolean"),
                output("plume.share", "1", "of the beam on the target", 1.0),
                output("plume.force", "N", "of that share", 0.01),
                flag("plume.on_line", "the line of centres lies within the half-angle of the beam"),
            ),
            needs=("thrust",),
            extremes=stress.PLUME,
        ),
    },
    optional=True,
    follows=lambda terms, values: "beam",
)  # fmt: skip

AOCS = Group(
    {
        "wheels": Term(
            "reaction wheels hold the chaser's attitude, with the torque and the momentum they have",
            (
                choice("aocs.points", "what is held: the attitude of the start in the orbital frame, or the attachment "
                       "towards the line", ("orbital", "line")),
                positive("aocs.frequency", "rad/s", "of the closed loop", 0.05, 100.0),
                at_least_zero("aocs.damping_ratio", "1", "of the closed loop", 0.7, 10.0),
                positive("aocs.torque_limit", "N.m", "of all wheels together, about any axis", 0.2, 1e6),
                positive("aocs.momentum_limit", "N.m.s", "likewise", 50.0, 1e9),
                vector("aocs.torque", "N.m", "of the wheels on the chaser, body axes", nominal=0.1),
                vector("aocs.momentum", "N.m.s", "of the wheels, body axes", nominal=10.0,
                       rate="rate.aocs_momentum[#]"),
                output("aocs.deviation", "rad", "of the attitude from that to be held", 0.01, display_unit="deg"),
                flag("aocs.limited", "the wheels have not the torque or the momentum that is asked of them"),
                rate("aocs_momentum", "N.m", (3,)),
                state("state.aocs[#][#]", "1", "room for quaternions", shape=(2, 4)),
                state("state.aocs_held[#]", "1", "attitude to be held, body axes to orbital frame", shape=(4,)),
                state("state.aocs_off[#][#]", "1", "deviations, and room", shape=(4, 3)),
                vector("state.aocs_torque", "N.m", "of the wheels", "state"),
                state("state.aocs_asked", "N.m", "torque that the loop asks for"),
                state("state.aocs_full", "1", "the wheels take no more of it", kind="Integer"),
            ),
            extremes=stress.AOCS,
        ),
    },
    optional=True,
    follows=lambda terms, values: "wheels",
)  # fmt: skip

SCHEMES = Group(
    {
        "dop853": Term("Dormand-Prince 8(5,3), explicit: the fastest wherever nothing is stiff"),
        "gauss": Term("Gauss-Legendre of order 8, symplectic at steps of one size: for long undamped motion"),
        "radau": Term("Radau IIA of order 5, implicit and L-stable: for stiff lines that are damped hard"),
    },
    selector="scheme",
    default="dop853",
)

_SETTLED = (
    flag("level.settled", "the vibration of the line has died, and steps go over it"),
    peak("level.settled_since", "s", "from when on; zero while it is not so"),
    count("level.times_settled", "how often the line has settled"),
    state("state.settled", "1", "the line is held on its course", kind="Integer"),
    state("state.settled_since", "s", "when it last settled"),
    state("state.times_settled", "1", "how often it has", kind="Integer"),
    state("state.next_look", "s", "when it may have settled, at the earliest"),
    state("state.course[#]", "1", "stretch over a step, by powers of the time since its begin", shape=(6,)),
    state("state.course_span", "s", "over which that is drawn"),
    state("state.course_bend[#]", "1", "second to fourth derivative of the last course, where it ended", shape=(3,)),
    state("state.moved_mass", "kg", "that the line moves at the begin of a settled step"),
)  # fmt: skip

SETTLING_LAWS, SETTLING_SCHEMES = ("locked",), ("dop853",)
"""Laws of the line whose vibration can be stepped over once it has died, and schemes that do: `radau` needs not, and
`gauss` is there as a second opinion."""


def _now(last: int, named: str) -> Variable:
    """Which way of computing it is just now."""
    told = f"0: free flight; 1: every vibration followed; 2: vibrating in closed form; {named}"
    return Variable("level.now", "1", "output", told, 0, kind="Integer", minimum=0, maximum=last)


_MAPPED = (
    parameter("level.peak_error", "1", "bound of the relative error of a tug's peak and of its time, up to "
              "which tugs are in closed form", 1e-3, 0.0, 1.0),
    *_SETTLED,
    output("level.free", "s", "time in free flight, since the start", 1000.0),
    output("level.followed", "s", "time with every vibration followed", 1000.0),
    output("level.mapped", "s", "time with the vibration in closed form", 1000.0),
    output("level.dumbbell", "s", "time as a rigid dumbbell", 1000.0),
    peak("level.error", "1", "largest bound of a tug's relative error so far"),
    state("state.level_now", "1", "mode of the current step", kind="Integer"),
    state("state.level_times[#]", "s", "spent in each mode, up to the end of the step", shape=(5,)),
    state("state.level_error", "1", "largest bound so far"),
    state("state.vibration[#]", "1", "place [m] and rate [m/s] at the begin of the step", shape=(2,)),
    state("state.firmness", "N/m", "of the line, less what its load gains as it lengthens"),
    state("state.leverage[#]", "1/s2", "gain of the rate across the line over its lengthening for a time",
          shape=(3,)),
    state("state.bounces", "1", "the step ends where the line goes slack", kind="Integer"),
)  # fmt: skip

REVOLUTIONS = 3.0
"""Fewest between two communication points that the averaged level takes at once."""
POINTS_ONLY = ("event_map", "averaged")
"""Levels of two points: what else they cannot carry is refused."""
NO_BREAK = ("break", "release", "power", "electrodynamic")
NO_SWAY = (*NO_BREAK, "burn", "plume", "oblateness", "air", "third_bodies", "shadow", "sunlight")
"""Groups with which the one and the other do not go together."""


def not_mapped(terms: Mapping[str, str]) -> dict[str, str]:
    """What of a tow such a level cannot carry: group and term."""
    carried = {"target": "point", "chaser": "point"}
    if terms.get("level") == "averaged":
        carried |= {"thrust": "along_track", "environment": "central"}
    return {group: terms[group] for group, term in carried.items() if terms.get(group, term) != term}


LEVELS = Group(
    {
        "settled": Term(
            "every tug is resolved, and a damped line that has come to rest is held where the load has it: its "
            "vibration is stepped over once it has died",
            _SETTLED,
            extremes=stress.SETTLED,
        ),
        "event_map": Term(
            "free flight from tug to tug, every tug and every vibration in closed form, a rigid dumbbell once that has "
            "died; followed where the bound of its error is exceeded",
            (_now(3, "3: rigid dumbbell"), *_MAPPED),
            excludes=NO_BREAK,
            extremes=stress.MAPPED,
        ),
        "averaged": Term(
            "as event_map; and a rigid dumbbell that cannot go slack is carried over many revolutions at once, between "
            "communication points",
            (
                _now(4, "3: rigid dumbbell; 4: many revolutions at once"),
                *_MAPPED,
                parameter("level.average_tolerance", "1", "what a leap may err by, square of the angle across the "
                          "orbit's plane included, up to which there are leaps", 1e-3, 0.0, 0.1),
                output("level.averaged", "s", "time over which many revolutions were taken at once", 1000.0),
                peak("level.average_error", "1", "largest of that at a leap so far"),
                output("level.revolutions", "1", "so taken", 10.0),
                state("state.leapt_to", "s", "end of the last leap"),
                state("state.next_leap", "s", "before this no leap is tried"),
                state("state.average_error", "1", "largest so far"),
                state("state.revolutions", "1", "taken at once"),
                state("state.leap[#][#]", "1", "orbit and swing at three instants of a leap", shape=(3, 10)),
                state("state.leap_range[#]", "1", "tensions, error and revolutions of the last leap", shape=(4,)),
                state("state.swing[#]", "1", "see levels.libration", shape=(7,)),
                state("state.waves[#][#]", "1", "see levels.libration", shape=(2, 24)),
            ),
            excludes=NO_SWAY,
            extremes=stress.AVERAGED,
        ),
    },
    selector="detail",
    optional=True,
    follows=lambda terms, values: "settled",
)  # fmt: skip
