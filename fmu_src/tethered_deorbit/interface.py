"""The variables of the tethered removal, term by term, and what a scene may choose."""

from __future__ import annotations

import math
from typing import Any

from fmu_src.interface import Fault, Group, Kind, Model, Term, Variable

CONDITIONS = ("same_orbit", "vbar", "equal_velocity", "handed_over")
SAME_ORBIT, VBAR, EQUAL_VELOCITY, HANDED_OVER = range(4)
LEADERS = ("target", "chaser")
TUGS = 16
"""Length of the ring of latest tugs: twelve may fall in one minute."""

REEL_STIFFNESS, REEL_DAMPING = 4.155e-3, 2.366
"""Default gains [N/m], [N s/m]: 5.7829 m_r n^2 and 3.4193 m_r n, the gains on length and rate of the quadratic
regulator about the equilibrium (unit weights, lengths in l0, times in 1/n) for Table 2's pair at 800 km. The length is
held only while k_p > 3 n^2 m_r, here 2.2e-3 N/m: farther out the tide pulls harder."""

NOT_FINITE, STEP_NOT_MET, TOO_MANY_EVENTS, TIME_GAP, GROUND = range(1, 6)
BAD_ORBIT, BAD_CHORD, START_STRETCHED, NO_LENGTH, NO_LINE, BAD_PARAMETER = range(11, 17)

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
        "start.separation exceeds the line and target.attachment_distance: a locked line would start stretched",
        True,
    ),
    Fault(NO_LENGTH, "error", "the line's length with reel.length_offset is not positive", True),
    Fault(NO_LINE, "error", "start.relative_position is zero: the line has no direction", True),
    Fault(BAD_PARAMETER, "error", "a parameter or input is out of its bounds or not finite", True),
)


def _parameter(name: str, unit: str, description: str, start: float, low: float, high: float, **more: str) -> Variable:
    return Variable(name, unit, "parameter", description, start, minimum=low, maximum=high, **more)  # type: ignore[arg-type]


def _positive(name: str, unit: str, description: str, start: float, high: float, **more: str) -> Variable:
    return Variable(
        name,
        unit,
        "parameter",
        description,
        start,
        minimum=0.0,
        open_minimum=True,
        maximum=high,
        **more,  # type: ignore[arg-type]
    )


def _angle(
    name: str, description: str, start: float, low: float = -2.0 * math.pi, high: float = 2.0 * math.pi
) -> Variable:
    return _parameter(name, "rad", description, start, low, high, display_unit="deg")


def _choice(name: str, description: str, choices: tuple[str, ...]) -> Variable:
    return Variable(
        name, "1", "parameter", description, 0, "Integer", minimum=0, maximum=len(choices) - 1, choices=choices
    )


def _out(name: str, unit: str, description: str, nominal: float = 0.0, rate: str = "", **more: Any) -> Variable:
    return Variable(name, unit, "output", description, nominal=nominal, rate=rate, **more)


def _count(name: str, description: str, **more: Any) -> Variable:
    return Variable(name, "1", "output", description, kind="Integer", discrete=True, **more)


def _vector(name: str, unit: str, description: str, nominal: float, rate: str = "") -> Variable:
    """Output of three components."""
    return _out(f"{name}[#]", unit, description, nominal, rate and f"{rate}[#]", shape=(3,))


def _start(name: str, unit: str, description: str, high: float) -> Variable:
    """Parameter of three components."""
    return Variable(f"{name}[#]", unit, "parameter", description, shape=(3,), minimum=-high, maximum=high)


def _state(name: str, unit: str, description: str, kind: Kind = "Real") -> Variable:
    return Variable(f"state.{name}", unit, "state", description, kind=kind)


def _rate(name: str, unit: str, shape: tuple[int, ...] = ()) -> Variable:
    """Where the time derivative of an input or output is kept."""
    return Variable(f"rate.{name}{'[#]' * len(shape)}", unit, "state", "time derivative", shape=shape)


def _partial(name: str, unit: str) -> Variable:
    """Where the derivative of an output by an input is kept."""
    return Variable(f"partial.{name}", unit, "state", "direct derivative")


def _ring(name: str, unit: str, description: str, **more: Any) -> Variable:
    return Variable(f"tug[#].{name}", unit, "output", description, shape=(TUGS,), discrete=True, **more)


COMMANDS = ("reel.length_offset", "reel.tension")
"""The input of every law of the line: it settles whether and how hard the line pulls at the start."""

BODIES = (
    _positive("chaser.mass", "kg", "chaser with thruster, reel and propellant; held constant", 2000.0, 1e6),
    _positive("target.mass", "kg", "debris with the net that holds it", 1000.0, 1e6),
    _parameter("target.attachment_distance", "m", "from the target's centre of mass to where the line is made fast",
               0.0, 0.0, 1e4),
)  # fmt: skip

ORBIT = (
    _parameter("orbit.altitude", "m", "semi-major axis less the equatorial radius, 6378.137 km", 800e3, 100e3, 1e8,
               display_unit="km"),
    _parameter("orbit.eccentricity", "1", "of the reference orbit", 0.0, 0.0, 0.95),
    _angle("orbit.inclination", "of the reference orbit to the equator", math.radians(98.0), 0.0, math.pi),
    _angle("orbit.raan", "right ascension of its ascending node", 0.0),
    _angle("orbit.argument_of_perigee", "from the node", 0.0),
    _angle("orbit.true_anomaly", "of the reference orbit's point at the start", 0.0),
)  # fmt: skip

START = (
    _choice(
        "start.condition",
        "same_orbit: both on the reference orbit, the given chord apart, the point half-way in anomaly; vbar: straight "
        "offset along V-bar at rest in the orbital frame; equal_velocity: that offset, equal inertial velocities; "
        "handed_over: the states below",
        CONDITIONS,
    ),
    _choice("start.leading", "the body that is ahead on the orbit (not for handed_over)", LEADERS),
    _positive("start.separation", "m", "distance of the two centres of mass (not for handed_over)", 10.0, 1e5),
    _start("start.center_position", "m", "handed over: centre of mass less the orbit's point, its orbital frame", 1e6),
    _start("start.center_velocity", "m/s", "handed over: its rate as seen in that turning frame", 1e4),
    _start("start.relative_position", "m", "handed over: target minus chaser, the same frame", 1e6),
    _start("start.relative_velocity", "m/s", "handed over: its rate as seen in that turning frame", 1e4),
)

SOLVER = (
    _parameter("solver.tolerance_orbit", "m", "error of the centre of mass in one step", 1e-7, 1e-9, 1e3),
    _parameter("solver.tolerance_separation", "m", "error of the relative position in one step", 1e-10, 1e-14, 1.0),
    _parameter("solver.tolerance_stretch", "m", "estimated error of the stretch in one step of a taut elastic line",
               1e-11, 1e-15, 1e-3),
)  # fmt: skip

OUTPUTS = (
    _out("tether.tension", "N", "in the line, zero when slack", 1.0, "rate.tension",
         partials=(("reel.length_offset", "partial.tension"), ("reel.tension", "partial.tension"))),
    _out("tether.tension_peak", "N", "largest over the last macro step, also between its ends", 1.0, discrete=True,
         at_start=COMMANDS),
    _out("tether.tension_least", "N", "least over the last macro step, also between its ends", 1.0, discrete=True,
         at_start=COMMANDS),
    _out("tether.impulse", "N.s", "integral of the tension over time, since the start of this instance", 1.0,
         "tether.tension"),
    _out("tether.length", "m", "between its attachments: separation less target.attachment_distance", 10.0,
         "tether.length_rate"),
    _out("tether.length_rate", "m/s", "its rate of change", 0.01, "rate.length_rate"),
    _out("tether.taut", "1", "the line carries tension", kind="Boolean", discrete=True,
         partials=(("reel.length_offset", "partial.jump"), ("reel.tension", "partial.jump"))),
    _count("tether.tug_count", "how often the line has gone taut and pulled; taut at the start counts",
           at_start=COMMANDS),
    _out("tether.angle", "rad", "of the line chaser to target in the orbital plane, from the local vertical towards "
         "along-track", 1.0, "rate.angle", display_unit="deg"),
    _ring("time", "s", "when the tug began, newest first, since the start of this instance; zero when absent"),
    _ring("peak", "N", "its largest tension; grows until the line is slack again", at_start=COMMANDS),
    _ring("speed", "m/s", "rate of lengthening as it began", at_start=COMMANDS),
    _out("separation", "m", "distance of the two centres of mass", 10.0, "tether.length_rate"),
    _out("approach.distance", "m", "least separation since the start of this instance", 10.0, discrete=True),
    _out("approach.time", "s", "when that was, since the start of this instance", discrete=True),
    _vector("chaser.position", "m", "inertial", 7e6, "chaser.velocity"),
    _vector("chaser.velocity", "m/s", "inertial", 7e3, "rate.chaser_velocity"),
    _vector("target.position", "m", "inertial", 7e6, "target.velocity"),
    _vector("target.velocity", "m/s", "inertial", 7e3, "rate.target_velocity"),
    _out("chaser.radius", "m", "distance from the Earth's centre", 7e6, "rate.chaser_radius", display_unit="km"),
    _out("target.radius", "m", "distance from the Earth's centre", 7e6, "rate.target_radius", display_unit="km"),
    _vector("relative.position", "m", "target minus chaser, orbital frame of the centre of mass", 10.0,
            "relative.velocity"),
    _vector("relative.velocity", "m/s", "its rate as seen in that turning frame", 0.01, "rate.relative_velocity"),
    _vector("center.position", "m", "centre of mass of the pair, inertial", 7e6, "center.velocity"),
    _vector("center.velocity", "m/s", "centre of mass of the pair, inertial", 7e3, "rate.center_velocity"),
    _out("center.semi_major_axis", "m", "osculating, of the centre of mass", 7e6, "rate.semi_major_axis",
         display_unit="km"),
    _out("altitude", "m", "of the centre of mass over the equatorial radius", 8e5, "rate.altitude",
         display_unit="km"),
    _out("energy.orbital", "J", "kinetic and potential energy of the pair's mass at its centre", 1e11,
         "rate.energy_orbital"),
    _out("energy.relative", "J", "Jacobi integral of the relative motion with the line's elastic energy; constant "
         "without thrust and damping on a circular orbit, to first order in length over radius", 0.01,
         "rate.energy_relative", partials=(("reel.length_offset", "partial.energy"),)),
    _count("solver.steps", "steps taken"),
    _count("solver.rejected", "steps rejected by the error control"),
)  # fmt: skip

STATE = (
    _state("taut", "1", "0 slack, 1 taut", "Integer"),
    _state("event", "1", "the current step ends in a change between slack and taut", "Integer"),
    _state("fresh", "1", "the derivative at the end of the step is yet to be computed", "Integer"),
    _state("dense_ready", "1", "the dense output of the current step is in the work memory", "Integer"),
    _state("start", "s", "time of the importer at which this instance began; all others count from there"),
    _state("begin", "s", "begin of the current step"),
    _state("end", "s", "end of the current step, at or past the communication point"),
    _state("step", "s", "its exact size"),
    _state("next_step", "s", "size to try next"),
    _state("error", "1", "error of the last step, in tolerances"),
    _state("published", "s", "latest communication point"),
    _state("changes", "1", "between slack and taut in the current macro step", "Integer"),
    _state("peak", "N", "largest tension of the current macro step so far"),
    _state("least", "N", "least tension of the current macro step so far"),
    _state("approach_distance", "m", "least separation up to the begin of the step"),
    _state("approach_time", "s", "when that was"),
    _state("tug_begun", "1", "the line has gone taut and not pulled yet", "Integer"),
    _state("tug_time", "s", "when it last went taut"),
    _state("tug_speed", "m/s", "its rate of lengthening then"),
    _state("tug_peak", "N", "largest tension of the current tug up to the begin of the step"),
    _state("total_mass", "kg", "of the pair"),
    _state("reduced_mass", "kg", "of the pair"),
    _state("chaser_share", "1", "chaser's part of the mass"),
    _state("target_share", "1", "target's part of the mass"),
    _state("mean_motion", "rad/s", "of the reference orbit"),
    _state("thrust", "N", "in force"),
    _state("since", "s", "from when the inputs in force began to move to the begin of the current step"),
    _state("command", "1", "the reel's input in force, as the step began [m] or [N]"),
    _state("command_rate", "1", "its rate in force [m/s] or [N/s]"),
    _state("thrust_rate", "N/s", "of the thrust in force"),
    _state("length", "m", "at which the line's tension vanishes at rest, or the commanded one"),
    _state("stiffness", "N/m", "of the line, or gain of the reel"),
    _state("damping", "N.s/m", "of the line, or gain of the reel"),
    _state("feed_forward", "N", "of a working reel"),
    _state("frequency", "rad/s", "of the fastest motion while taut"),
    _state("taut_tolerance", "m", "of the stretch while taut"),
    _rate("tension", "N/s"),
    _rate("length_rate", "m/s2"),
    _rate("angle", "rad/s"),
    _rate("chaser_velocity", "m/s2", (3,)),
    _rate("target_velocity", "m/s2", (3,)),
    _rate("chaser_radius", "m/s"),
    _rate("target_radius", "m/s"),
    _rate("relative_velocity", "m/s2", (3,)),
    _rate("center_velocity", "m/s2", (3,)),
    _rate("semi_major_axis", "m/s"),
    _rate("altitude", "m/s"),
    _rate("energy_orbital", "W"),
    _rate("energy_relative", "W"),
    _partial("tension", "1"),
    _partial("energy", "N"),
    _partial("jump", "1"),
    Variable("state.turning[#]", "rad/s", "state", "rate of the axes of the current step", shape=(3,)),
    Variable("state.basis[#][#]", "1", "state", "room for a rotation", shape=(3, 3)),
    Variable("state.vector[#][#]", "1", "state", "room for vectors", shape=(4, 3)),
)

LENGTH_OFFSET = (
    Variable("reel.length_offset", "m", "input", "added to the line's length; zero leaves it as the parameters say",
             minimum=-1e6, maximum=1e6, nominal=1.0, rate="rate.reel_length_offset"),
    _rate("reel_length_offset", "m/s"),
)  # fmt: skip

COMMAND = (
    Variable("reel.tension", "N", "input", "tension the reel is to give; zero or less leaves the line slack",
             minimum=-1e6, maximum=1e6, nominal=1.0, rate="rate.reel_tension"),
    _rate("reel_tension", "N/s"),
)  # fmt: skip

REELS = Group(
    {
        "locked": Term(
            "an elastic line between two fixed ends: T = k (l - l0) + c dl/dt while stretched and pulling",
            (
                _positive("tether.rest_length", "m", "unloaded length", 12.0, 1e6),
                _positive("tether.diameter", "m", "of the load-bearing section", 1e-3, 1.0, display_unit="mm"),
                _positive("tether.youngs_modulus", "Pa", "of the line", 60e9, 1e14, display_unit="GPa"),
                _parameter("tether.damping_ratio", "1", "c / (2 sqrt(k m_r)), m_r the pair's reduced mass",
                           0.05, 0.0, 10.0),
                *LENGTH_OFFSET,
            ),
        ),
        "linear": Term(
            "a reel that controls tension: T = max(0, T_ff + k_p (l - l_c) + k_d dl/dt)",
            (
                _positive("reel.length", "m", "commanded length l_c", 12.0, 1e6),
                _parameter("reel.proportional_gain", "N/m", "k_p; default of Table 2's pair", REEL_STIFFNESS, 0.0, 1e6),
                _parameter("reel.derivative_gain", "N.s/m", "k_d; default of Table 2's pair", REEL_DAMPING, 0.0, 1e5),
                *LENGTH_OFFSET,
            ),
        ),
        "commanded": Term("a reel that gives the tension it is told: T = max(0, command)", COMMAND),
    }
)  # fmt: skip

THRUST = (
    _parameter("thrust.level", "N", "along the named direction; negative against it", -0.01, -1e4, 1e4),
    _positive("thrust.specific_impulse", "s", "for the propellant used", 3000.0, 1e6),
    Variable("thrust.offset", "N", "input", "added to the level; zero leaves it as the parameters say",
             minimum=-1e4, maximum=1e4, nominal=0.01, rate="rate.thrust_offset"),
    _out("chaser.propellant", "kg", "used since the start of this instance; the masses stay constant", 0.1,
         "rate.propellant"),
    _rate("thrust_offset", "N/s"),
    _rate("propellant", "kg/s"),
    _state("propellant", "kg", "used up to the last change of the thrust"),
    _state("propellant_since", "s", "time of that change"),
)  # fmt: skip

THRUSTS = Group(
    {
        "along_track": Term("thrust along the chaser's own along-track, h x r", THRUST),
        "velocity": Term("thrust along the chaser's inertial velocity", THRUST),
        "tether": Term("thrust along the line, positive towards the target", THRUST),
    },
    selector="direction",
    optional=True,
)

MODEL = Model(
    name="tethered_deorbit",
    summary="A chaser with a thruster and a reel tows a captured target on a tether.",
    base=BODIES + ORBIT + START + SOLVER + OUTPUTS + STATE,
    groups={"reel": REELS, "thrust": THRUSTS},
    faults=FAULTS,
    module="fmu_src.tethered_deorbit.model",
    stop_time=86400.0,
    macro_step=60.0,
    differentiable=True,
)
