"""The variables of the reel control, what a scene may choose, and its faults."""

from __future__ import annotations

from fmu_src.interface import Fault, Group, Model, Term
from fmu_src.rows import at_least_zero, moving_input, output, partial, positive, rate, state
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU

STIFFNESS, DAMPING = 4.155e-3, 2.366
"""Default gains [N/m], [N s/m]: 5.7829 m_r n^2 and 3.4193 m_r n, those on length and rate of the quadratic regulator
about the equilibrium (unit weights, lengths in l_c, times in 1/n) for Table 2's pair at 800 km."""

FEED_FORWARD = 3.0 * EARTH_MU / (EARTH_EQUATORIAL_RADIUS + 800e3) ** 3 * (2000.0 * 1000.0 / 3000.0) * 12.0
"""Default tension at rest [N]: 3 n^2 m_r l_c of the same pair on a line of 12 m."""

NO_COMMAND, BAD_PARAMETER, NOT_FINITE = range(1, 4)

FAULTS = (
    Fault(NO_COMMAND, "error", "there is no such command of the kernel"),
    Fault(BAD_PARAMETER, "error", "a parameter is out of its bounds or not finite", True),
    Fault(NOT_FINITE, "error", "an input or the tension is not finite", True),
)

VARIABLES = (
    *moving_input("length", "m", "measured length of the line; zero: nothing asked, tension zero", 0.0, 1e6, 10.0),
    *moving_input("length_rate", "m/s", "measured rate of lengthening", -1e6, 1e6, 0.01),
    positive("reel.length", "m", "commanded length l_c", 12.0, 1e6),
    at_least_zero("gain.proportional", "N/m", "k_p; default of Table 2's pair", STIFFNESS, 1e6),
    at_least_zero("gain.derivative", "N.s/m", "k_d; default of Table 2's pair", DAMPING, 1e5),
    at_least_zero(
        "feed_forward", "N", "T_ff, the tension at rest; default of Table 2's pair on 12 m", FEED_FORWARD, 1e6
    ),
    output(
        "tension",
        "N",
        "to be given by the reel, never negative",
        1.0,
        "rate.tension",
        partials=(("length", "partial.length"), ("length_rate", "partial.length_rate")),
    ),
    rate("tension", "N/s"),
    partial("length", "N/m"),
    partial("length_rate", "N.s/m"),
    state("state.length", "m", "input as the last step left it"),
    state("state.length_rate", "m/s", "input as the last step left it"),
    state("state.drift[#]", "1", "rates of the two inputs in that step", shape=(2,)),
)

MOTORS = Group(
    {
        "lag": Term(
            "a motor behind the law: dT/dt = (asked - T) / time_constant",
            (positive("motor.time_constant", "s", "of the motor", 5.0, 1e6),),
            states=("tension",),
        ),
    },
    optional=True,
)

MODEL = Model(
    name="reel_control",
    summary="A linear law says which tension a reel is to give for a line's length and its rate.",
    base=VARIABLES,
    groups={"motor": MOTORS},
    faults=FAULTS,
    module="fmu_src.reel_control.model",
    stop_time=86400.0,
    macro_step=1.0,
    differentiable=True,
)
