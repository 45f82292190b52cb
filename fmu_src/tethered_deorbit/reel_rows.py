"""The laws of the line's tension: what each adds, its variables, and what a scene may ask of its gains."""

from __future__ import annotations

import math
from collections.abc import Mapping

from fmu_src.interface import Group, Term, Variable
from fmu_src.rows import at_least_zero, count, moving_input, output, parameter, peak, positive, rate, state
from fmu_src.tethered_deorbit import stress
from fmu_src.tethered_deorbit.asked import asked_rows

REEL_STIFFNESS, REEL_DAMPING = 4.155e-3, 2.366
"""Default gains [N/m], [N s/m]: 5.7829 m_r n^2 and 3.4193 m_r n, the gains on length and rate of the quadratic
regulator about the equilibrium (unit weights, lengths in l0, times in 1/n) for Table 2's pair at 800 km. The length is
held only while k_p > 3 n^2 m_r, here 2.2e-3 N/m: farther out the tide pulls harder."""

SAMPLED_GAINS = ((1.2122e-6, -1e6, 1e6), (2.8164e-3, -1e6, 1e6), (1.1724e-5, -1e6, 1e6), (-1.2805e-2, -1e6, 1e6))
TABLE_2_ANGLE = math.radians(7.40452)
"""Default gains of a sampled linear law with their bounds, and the angle they are about: those of the quadratic
regulator about the equilibrium of Table 2's pair, unit weights, a sample each second (`design`)."""

FOLLOWING_LAWS = ("constant_tension", "detumble")
"""Which control the tension by winding."""

LENGTH_OFFSET = moving_input(
    "reel.length_offset", "m", "added to the line's length; zero leaves it as the parameters say", -1e6, 1e6, 1.0
)
COMMAND = moving_input(
    "reel.tension", "N", "tension the reel is to give; zero or less leaves the line slack", -1e6, 1e6, 1.0
)

LINE = (
    positive("tether.rest_length", "m", "unloaded length", 12.0, 1e6),
    positive("tether.diameter", "m", "of the load-bearing section", 1e-3, 1.0, display_unit="mm"),
    positive("tether.youngs_modulus", "Pa", "of the line", 60e9, 1e14, display_unit="GPa"),
    parameter("tether.damping_ratio", "1", "c / (2 sqrt(k m_r)), m_r the pair's reduced mass",
              0.05, 0.0, 10.0),
)  # fmt: skip
LINEAR = (
    positive("reel.length", "m", "commanded length l_c", 12.0, 1e6),
    parameter("reel.proportional_gain", "N/m", "k_p; default of Table 2's pair", REEL_STIFFNESS, 0.0, 1e6),
    parameter("reel.derivative_gain", "N.s/m", "k_d; default of Table 2's pair", REEL_DAMPING, 0.0, 1e5),
    *LENGTH_OFFSET,
)  # fmt: skip
REGULATOR = (
    positive("reel.length", "m", "commanded length l_c", 12.0, 1e6),
    parameter("reel.proportional_gain", "N/m", "k_p; below zero where the motion along the track asks for it",
              REEL_STIFFNESS, -1e6, 1e6),
    parameter("reel.derivative_gain", "N.s/m", "k_d; default of Table 2's pair", REEL_DAMPING, -1e5, 1e5),
    *LENGTH_OFFSET,
    parameter("reel.angle_gain", "N", "k_a, per radian of the line's angle from reel.angle", 0.0, -1e9, 1e9),
    parameter("reel.angle_rate_gain", "N.s", "k_r, on the rate of that angle in the orbital frame", 0.0, -1e9, 1e9),
    parameter("reel.angle", "rad", "at which the gain on the angle pulls nothing, counted as tether.angle",
              TABLE_2_ANGLE, -math.pi, math.pi, display_unit="deg"),
    parameter("reel.bias", "N", "added to the feed-forward, which is that about the vertical", 0.0, -1e6, 1e6),
    state("state.angle", "rad", "of the line from reel.angle, as last seen"),
    state("state.angle_rate", "rad/s", "its rate"),
    state("state.angle_acceleration", "rad/s2", "and the rate of that"),
)  # fmt: skip


WINDING = (
    positive("reel.sample_time", "s", "from one sample of the controller to the next, by the clock of this instance",
             1.0, 1e6),
    positive("reel.rate_limit", "m/s", "fastest winding, either way", 0.5, 1e3),
    positive("reel.acceleration_limit", "m/s2", "by which the rate of winding changes at most", 0.1, 1e3),
    positive("reel.force_limit", "N", "against which the motor hauls in at most; above it stalls", 100.0, 1e7),
    positive("reel.power_limit", "W", "of the motor, either way; above it stalls", 50.0, 1e9),
    positive("reel.length_least", "m", "that the motor leaves wound out", 1.0, 1e6),
    positive("reel.length_most", "m", "that can be wound out", 1000.0, 1e6),
    output("reel.rate", "m/s", "of winding, positive while paying out", 0.01, "rate.reel_rate"),
    output("reel.power", "W", "that the motor gives to pair and line; negative while it is driven by them", 0.01,
           "rate.reel_power"),
    output("reel.work", "J", "integral of that power, since the start of this instance", 1.0, "reel.power"),
    count("reel.limited", "how often a limit has changed what the control asked for, or stalled the motor"),
    state("state.winding_rate", "m/s2", "rate of that, until the next sample"),
    state("state.fastest", "m/s", "fastest winding until the next sample"),
    state("state.hauling", "1", "whether the motor hauls in before the next sample", kind="Integer"),
    state("state.sample", "1", "number of the next sample", kind="Integer"),
    state("state.cut", "m/s", "what the limits took off the rate asked for at the last sample"),
    rate("reel_power", "W/s"),
)  # fmt: skip
"""Of a motor that winds."""
WOUND = (
    *LINE,
    output("reel.paid_out", "m", "rest length of the line that is wound out", 10.0, "reel.rate"),
    output("tether.heat", "J", "taken by the dashpot of the line, since the start of this instance", 0.01,
           "rate.tether_heat"),
    state("state.rest", "m", "rest length wound out, as last seen"),
    state("state.winding", "m/s", "its rate, as last seen"),
    rate("reel_rate", "m/s2"),
    rate("tether_heat", "W"),
)  # fmt: skip
"""Of an elastic line that is wound out or slips."""
FOLLOWING = (
    positive("reel.take_up", "m/s", "rate at which a slack line is taken in; it goes taut with a snap of about this "
             "times sqrt(k m_r)", 1e-3, 1e3),
    *moving_input("reel.tension_offset", "N", "added to what is asked for; zero leaves it as the parameters say",
                  -1e6, 1e6, 1.0),
    state("state.added", "N", "errors of the tension, added up"),
)  # fmt: skip
"""Of a control of the tension."""
LENGTH = (positive("reel.length", "m", "commanded length l_c", 12.0, 1e6), *LENGTH_OFFSET)
SCHEDULE_POINTS = 16
CONSTANT_TENSION = (
    positive("reel.held_tension", "N", "that is held", 0.05, 1e6),
    *FOLLOWING,
)  # fmt: skip
SCHEDULE = (
    parameter("reel.schedule_time[#]", "s", "since the start of this instance; a last point may be repeated",
              0.0, 0.0, 1e10, shape=(SCHEDULE_POINTS,), fills=True),
    parameter("reel.schedule_length[#]", "m", "to be wound out then; linear in between, constant before and after",
              12.0, 0.0, 1e6, shape=(SCHEDULE_POINTS,), open_minimum=True, fills=True),
    *LENGTH_OFFSET,
    state("state.points", "1", "of the schedule", kind="Integer"),
)  # fmt: skip
LIBRATION = (
    at_least_zero("reel.swing_gain", "1", "g, the rate asked for over length and rate of the angle", 0.5, 1e3),
    at_least_zero("reel.return_gain", "1/s", "r, the rate asked for over the length that is off", 1e-4, 1e3),
    *LENGTH,
)  # fmt: skip
DETUMBLE = (
    positive("reel.tension_receding", "N", "while the line lengthens", 2.0, 1e6),
    positive("reel.tension_nearing", "N", "while it shortens", 0.5, 1e6),
    positive("reel.spin_goal", "rad/s", "rate of the target, relative to inertial space, below which it is calmed",
             math.radians(0.5), 100.0, display_unit="deg/s"),
    *FOLLOWING,
    positive("reel.blend_rate", "m/s", "of the line, within which the tension is between the two", 0.02, 1e3),
    peak("reel.calmed", "s", "since when the target's rate is below reel.spin_goal, from the start of this instance; "
         "zero while it is not"),
    state("state.calmed", "1", "whether it is", kind="Integer"),
)  # fmt: skip
SAMPLED_LINEAR = (
    *LENGTH,
    parameter("reel.winding_length_gain", "1/s2", "k_1, on the length wound out", *SAMPLED_GAINS[0]),
    parameter("reel.winding_rate_gain", "1/s", "k_2, on its rate", *SAMPLED_GAINS[1]),
    parameter("reel.winding_angle_gain", "m/s2", "k_3, per radian of the line's angle from reel.angle",
              *SAMPLED_GAINS[2]),
    parameter("reel.winding_angle_rate_gain", "m/s", "k_4, on the rate of that angle in the orbital frame",
              *SAMPLED_GAINS[3]),
    parameter("reel.angle", "rad", "at which the gain on the angle asks for nothing, counted as tether.angle",
              TABLE_2_ANGLE, -math.pi, math.pi, display_unit="deg"),
)  # fmt: skip
BRAKE = (
    positive("reel.brake_force", "N", "friction against which the line slips out", 10.0, 1e6),
    Variable("reel.brake_offset", "N", "input", "added to that friction, which is never below zero; zero leaves it",
             minimum=-1e6, maximum=1e6, nominal=1.0),
    positive("reel.length_most", "m", "with which all of the line is paid out", 1000.0, 1e6),
    output("reel.rate", "m/s", "at which the line slips out", 0.01, "rate.reel_rate"),
    output("reel.heat", "J", "taken by the brake, since the start of this instance", 1.0, "rate.reel_heat"),
    state("state.friction", "N", "in force"),
    state("state.stuck", "N", "with which it has stuck"),
    state("state.slipping", "1", "the line slips", kind="Integer"),
    state("state.winding_rate", "m/s2", "zero: no motor winds"),
    rate("reel_heat", "W"),
)  # fmt: skip
INPUTS = ("reel.tension", "reel.length_offset", "reel.tension_offset", "reel.brake_offset")
"""The input of a law, of which each has one."""
LIMITED_OF_REELS = (
    "reel.sample_time", "reel.rate_limit", "reel.acceleration_limit", "reel.force_limit", "reel.power_limit",
    "reel.length_least", "reel.length_most", "reel.take_up", "reel.held_tension", "reel.swing_gain",
    "reel.return_gain", "reel.tension_receding", "reel.tension_nearing", "reel.spin_goal", "reel.blend_rate",
    "reel.brake_force",
)  # fmt: skip
"""Parameters of reels whose limits the kernel minds too."""


def _designed(values: Mapping[str, float], asked: Mapping[str, float], terms: Mapping[str, str]) -> dict[str, float]:
    """The parameters that follow from what is asked; see `design`."""
    from fmu_src.tethered_deorbit.design import designed  # and with it python-control

    return designed(values, asked, terms)


REELS = Group(
    {
        "locked": Term(
            "an elastic line between two fixed ends: T = k (l - l0) + c dl/dt while stretched and pulling",
            (*LINE, *LENGTH_OFFSET),
            extremes=stress.LOCKED,
        ),
        "linear": Term(
            "a reel that controls tension: T = max(0, T_ff + k_p (l - l_c) + k_d dl/dt)",
            LINEAR,
            extremes=stress.LINEAR,
        ),
        "regulator": Term(
            "a reel that controls tension by length, angle and their rates: T = max(0, T_ff + T_b + k_p (l - l_c) + "
            "k_d dl/dt + k_a (phi - phi_c) + k_r dphi/dt)",
            REGULATOR,
            extremes=stress.REGULATOR,
            asked=asked_rows("the tension, in m_r reel.length n^2"),
            design=_designed,
        ),
        "commanded": Term(
            "a reel that gives the tension it is told: T = max(0, command)", COMMAND, extremes=stress.COMMANDED
        ),
        "constant_tension": Term(
            "a winch that holds a tension: an elastic line wound by a sampled motor with limits",
            (*WOUND, *WINDING, *CONSTANT_TENSION),
            extremes=stress.WINCH,
        ),
        "schedule": Term(
            "a winch that keeps to a table of lengths against time",
            (*WOUND, *WINDING, *SCHEDULE),
            extremes=stress.WINCH,
        ),
        "libration": Term(
            "a winch that damps the libration: it pays out while the line swings ahead, hauls in while it swings back",
            (*WOUND, *WINDING, *LIBRATION),
            extremes=stress.WINCH,
        ),
        "detumble": Term(
            "a winch that calms the target: a harder pull while the line lengthens than while it shortens",
            (*WOUND, *WINDING, *DETUMBLE),
            extremes=stress.WINCH,
        ),
        "sampled_linear": Term(
            "a winch by a linear law of length, angle and their rates, sampled",
            (*WOUND, *WINDING, *SAMPLED_LINEAR),
            extremes=stress.WINCH,
            asked=asked_rows("the acceleration of winding, in reel.length n^2"),
            design=_designed,
        ),
        "brake": Term(
            "an elastic line that slips out of its drum against a friction",
            (*WOUND, *BRAKE),
            extremes=stress.BRAKE,
        ),
    }
)
