"""The ends of a tow's range: lines, masses, thrusts, orbits, and starts on the edge between slack and taut."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from fmu_src.extremes import Extreme, Given, Values
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU

HOUR, DAY, YEAR = 3600.0, 86400.0, 365.25 * 86400.0
PERIGEE = 800e3
"""Altitude of the perigee of eccentric orbits [m]."""
GEOSTATIONARY = 35786e3
HANDED_OVER = 3
"""Number of the start that takes given states, see `interface.CONDITIONS`."""
FREE = {"environment": "none"}
"""Without a field nothing draws a pair apart that is not pushed."""
HELD = 1.8
"""Stiffness over the tide's [1]: at 1 the tide has it, and the pair drifts apart until its orbit ends."""


GRAZES = "its tension comes back to zero at no speed, and which of these touches are tugs hangs on the last digit"


def _axis_less_radius(eccentricity: float) -> float:
    return (EARTH_EQUATORIAL_RADIUS + PERIGEE) / (1.0 - eccentricity) - EARTH_EQUATORIAL_RADIUS


def _soft(values: Values) -> float:
    """Young's modulus [Pa] of a line HELD times as stiff as the tide at perigee pulls its pair apart, 3 n^2 m_r."""
    chaser, target = values["chaser.mass"], values["target.mass"]
    perigee = EARTH_EQUATORIAL_RADIUS + values.get("orbit.altitude", PERIGEE)
    perigee *= 1.0 - values.get("orbit.eccentricity", 0.0)
    tide = 3.0 * EARTH_MU / perigee**3 * chaser * target / (chaser + target)
    return HELD * tide * values["tether.rest_length"] / (0.25 * math.pi * values["tether.diameter"] ** 2)


def _length(values: Values) -> float:
    return values["tether.rest_length"]


def _begun(length: float) -> Callable[[Values], float]:
    """Separation at the start [m] on a line so long: five sixths of it in an orbit, which takes up the slack. Without a
    field a push has to: there it is the scene's own slack."""

    def separation(values: Values) -> float:
        slack = max(values["tether.rest_length"] - values.get("start.separation", 0.0), 0.0)
        return 5.0 / 6.0 * length if "orbit.altitude" in values or slack >= length else length - slack

    return separation


LOCKED = (
    *(
        Extreme(
            f"line of {length:g} m",
            "from a leash to the longest tether flown",
            "longer",
            {"tether.rest_length": length, "start.separation": _begun(length)},
            chief=length == 20e3,
        )
        for length in (1.0, 100.0, 1e3, 20e3)
    ),
    *(
        Extreme(f"line of {modulus:g} Pa", "from rubber to carbon nanotubes", "longer",
                {"tether.youngs_modulus": modulus})
        for modulus in (1e6, 1e9, 1e12)
    ),
    *(
        Extreme(f"line's damping ratio {ratio:g}", "dashpots from none to ten times critical", "snap",
                {"tether.damping_ratio": ratio}, chief=ratio in (0.0, 10.0))
        for ratio in (0.0, 1e-3, 0.5, 1.0, 10.0)
    ),
    Extreme("undamped without thrust", "what the pair has it keeps: the Jacobi integral", "jacobi",
            {"tether.damping_ratio": 0.0, "thrust.level": 0.0}, needs=("thrust",), idle=FREE),
    Extreme("damped without thrust", "the Jacobi integral only falls", "jacobi",
            {"thrust.level": 0.0}, needs=("thrust",), idle=FREE),
    Extreme("separation as long as the line", "begins on the edge between slack and taut", "longer",
            {"start.separation": _length}, chief=True),
    Extreme("chatter: at rest on the edge, radial", "exactly as long as the line at no speed, the tide pulls", "longer",
            {"start.condition": HANDED_OVER, "start.relative_position": (12.0, 0.0, 0.0), "tether.rest_length": 12.0,
             "tether.damping_ratio": 0.0}, scatters=GRAZES),
    Extreme("chatter: at rest on the edge, along-track", "the same where no tide pulls, only the thrust", "longer",
            {"start.condition": HANDED_OVER, "start.relative_position": (0.0, 12.0, 0.0), "tether.rest_length": 12.0,
             "tether.damping_ratio": 0.0}, scatters=GRAZES),
    Extreme("bodies a nanometre apart", "the line has hardly a direction", "longer", {"start.separation": 1e-9},
            {"ends": None}),
    Extreme("coincident bodies", "the line has no direction: it is to be refused", "refused",
            {"start.condition": HANDED_OVER, "start.relative_position": (0.0, 0.0, 0.0)}),
    Extreme("ten years", "of a stiff line, in the orbit as it is", "longer", {"thrust.level": 0.0},
            needs=("thrust",), idle=FREE, duration=10.0 * YEAR, macro_step=DAY),
    Extreme("ten years on a soft line", "of a line as soft as a reel keeps it", "longer",
            {"thrust.level": 0.0, "tether.youngs_modulus": _soft}, needs=("thrust",), idle=FREE,
            duration=10.0 * YEAR, macro_step=DAY),
)  # fmt: skip
"""Of the elastic line between fixed ends."""

WINCH = (
    *(
        Extreme(f"a sample each {step:g} s", "from a motor's own controller to one looked at once an hour", "longer",
                {"reel.sample_time": step}, duration=duration, chief=step == 0.01)
        for step, duration in ((0.01, 300.0), (1.0, HOUR), (3600.0, DAY))
    ),
    Extreme("a motor that hardly moves", "a nanometre per second", "longer",
            {"reel.rate_limit": 1e-9, "reel.acceleration_limit": 1e-9}),
    Extreme("a motor that hardly pulls", "it stalls at every tug", "longer",
            {"reel.force_limit": 1e-3, "reel.power_limit": 1e-6}, chief=True),
    Extreme("no room to wind", "the drum holds just what is wound out", "longer",
            {"reel.length_least": _length, "reel.length_most": _length}),
    Extreme("a line of 1 MPa on a winch", "soft as rubber", "longer", {"tether.youngs_modulus": 1e6}),
    *(
        Extreme(f"a winch's line with damping ratio {ratio:g}", "dashpots from none to ten times critical", "longer",
                {"tether.damping_ratio": ratio}, duration=2.0 * HOUR)
        for ratio in (0.0, 1.0, 10.0)
    ),
)  # fmt: skip
"""Of a winch."""

BRAKE = (
    *(
        Extreme(f"friction of {force:g} N", "from a free drum to one that never slips", "longer",
                {"reel.brake_force": force}, chief=force == 1e-6)
        for force in (1e-6, 1e-2, 1e6)
    ),
    *(
        Extreme(f"a braked line with damping ratio {ratio:g}", "it leaps above the friction as it goes taut", "longer",
                {"tether.damping_ratio": ratio, "reel.brake_force": 1.0})
        for ratio in (0.0, 10.0)
    ),
    Extreme("no line left on the drum", "it is held from the first", "longer", {"reel.length_most": _length}),
)  # fmt: skip
"""Of a line that slips."""

LINEAR = (
    Extreme("gains a thousand times larger", "a reel that is stiff and damped hard", "impulse",
            {"reel.proportional_gain": 4.0, "reel.derivative_gain": 2000.0}, chief=True),
    Extreme("gains that let the pair go", "below 3 n^2 m_r the tide pulls harder than the reel", "impulse",
            {"reel.proportional_gain": 1e-4, "reel.derivative_gain": 0.0}, duration=2.0 * HOUR),
)  # fmt: skip
"""Of a law of length and rate."""

COMMANDED = (
    Extreme("a pull of a micronewton", "hardly there", "impulse", {"reel.tension": 1e-6}, chief=True),
    Extreme("a pull of 10 kN", "it draws both together within a second", "impulse", {"reel.tension": 1e4},
            duration=0.5, macro_step=0.1),
)  # fmt: skip
"""Of a reel that pulls as it is told."""

AS_TOLD = {"reel.gains": 0}
"""Gains as they are told, also where the scene has them designed."""

REGULATOR = (
    Extreme("gains a thousand times larger", "a reel that is stiff and damped hard", "impulse",
            {**AS_TOLD, "reel.proportional_gain": 4.0, "reel.derivative_gain": 2000.0, "reel.angle_gain": -25.0,
             "reel.angle_rate_gain": 1800.0}),
    Extreme("gains that let the pair go", "below 3 n^2 m_r the tide pulls harder than the reel", "impulse",
            {**AS_TOLD, "reel.proportional_gain": 1e-4, "reel.derivative_gain": 0.0}, duration=2.0 * HOUR, chief=True),
    Extreme("a reel by the angle alone", "slack as often as taut", "impulse",
            {**AS_TOLD, "reel.angle_gain": 1.0, "reel.angle_rate_gain": 0.0}, duration=2.0 * HOUR),
)  # fmt: skip
"""Of a law of the whole state."""

THRUST = tuple(
    Extreme(f"thrust of {-level:g} N", "from a trickle of ions to a main engine", "orbit", {"thrust.level": level},
            duration=duration, chief=level == -1e4)
    for level, duration in ((-1e-6, 0.0), (-1.0, 0.0), (-1e2, 0.25 * DAY), (-1e4, 600.0))
)  # fmt: skip

TURNING = (
    Extreme("target at 60 deg/s", "the line is wound up ten times a minute", "longer",
            {"target.start_rate": (0.3, 0.6, 0.8)}, duration=600.0, chief=True),
    Extreme("target at 60 deg/s about its line", "it spins where nothing winds", "longer",
            {"target.start_rate": (0.0, 1.047, 0.0)}, duration=600.0),
    Extreme("target of hardly any inertia", "the line turns it at once", "longer",
            {"target.inertia": (1.0, 1.0, 1.0, 0.0, 0.0, 0.0)}, duration=HOUR),
    Extreme("target like a needle", "moments a thousand times apart", "longer",
            {"target.inertia": (10.0, 1e4, 1e4, 0.0, 0.0, 0.0)}, duration=HOUR),
    Extreme("line made fast behind the target", "it begins wrapped, or passes by the centre", "longer",
            {"target.attachment": (0.0, 1.0, 0.0)}, duration=HOUR),
)  # fmt: skip
"""Of a target that turns."""

CHASER_TURNING = (
    Extreme("chaser at 60 deg/s", "the line is wound round its point ten times a minute", "longer",
            {"chaser.start_rate": (0.3, 0.6, 0.8)}, duration=600.0, chief=True),
    Extreme("chaser of hardly any inertia", "the line turns it at once", "longer",
            {"chaser.inertia": (1.0, 1.0, 1.0, 0.0, 0.0, 0.0)}, duration=HOUR),
)  # fmt: skip
"""Of a chaser that turns."""

APPENDAGE = (
    Extreme("an appendage stopped from 60 deg/s", "what it had becomes spin of the whole", "longer",
            {"appendage.rate": 1.047}, duration=600.0),
    Extreme("an appendage of a gramme", "hardly there, at the end of a long boom", "longer",
            {"appendage.mass": 1e-3, "appendage.inertia": (1e-6, 1e-6, 1e-6, 0.0, 0.0, 0.0),
             "appendage.center": (30.0, 0.0, 0.0), "appendage.rate": 0.1}, duration=HOUR),
    Extreme("an appendage that outweighs the rest", "nine tenths of the target's mass hang on its hinge", "longer",
            {"appendage.mass": lambda values: 0.9 * values["target.mass"], "appendage.center": (0.1, 0.0, 0.0),
             "appendage.hinge": (0.0, 0.0, 0.0), "appendage.rate": 0.1}, duration=HOUR),
)  # fmt: skip
"""Of an appendage that is held fast."""

OBLATENESS = (
    Extreme("flattened, over the poles", "what the flattening's potential gives the orbit has to come back", "longer",
            {"orbit.inclination": 0.5 * math.pi}),
)  # fmt: skip
AIR = (
    Extreme("air at 180 km", "it comes down within the hour", "longer",
            {"orbit.altitude": 180e3, "air.base_density": 5.464e-10, "air.base_altitude": 180e3,
             "air.scale_height": 29.74e3}, duration=0.5 * HOUR),
    Extreme("one body as thin as air", "it is blown away from the other", "longer",
            {"orbit.altitude": 400e3, "air.target_area": 1e4}, duration=HOUR),
)  # fmt: skip
SLEDS_APART: Mapping[str, Given] = {
    "start.condition": HANDED_OVER, "tether.rest_length": 2.0, "start.relative_position": (0.0, 1.99, 0.0),
    "start.relative_velocity": (0.0, 1.0, 0.0), "tether.damping_ratio": 0.0,
}  # fmt: skip
"""Two sleds that part at 1 m/s, a centimetre before their line is taut, which damps nothing."""
FRICTION = (
    Extreme("friction of rubber", "a tug, and both stop within a hand's width, and creep", "work",
            {**SLEDS_APART, "friction.coefficient": 1.0}, duration=2.0, macro_step=0.02, chief=True),
    Extreme("friction that leaps", "it comes to its full value over a micrometre per second", "work",
            {**SLEDS_APART, "friction.coefficient": 0.1, "friction.creep": 1e-6}, duration=2.0, macro_step=0.02),
    Extreme("a table without friction", "what the thrust gives, the pair has", "work",
            {**SLEDS_APART, "friction.coefficient": 0.0}),
)  # fmt: skip
MSIS = (
    Extreme("below the table of the air", "at 95 km, for a moment", "longer",
            {"orbit.altitude": 101e3, "air.chaser_area": 100.0}, duration=60.0, macro_step=5.0),
    Extreme("above the table of the air", "where hardly any is left", "longer", {"orbit.altitude": 5e6},
            duration=HOUR),
)  # fmt: skip
THIRD_BODIES = (
    Extreme("a quarter of the way to the Moon", "it disturbs the orbit by a hundredth of the Earth's pull", "longer",
            {"orbit.altitude": 95e6, "orbit.inclination": math.radians(28.6)}, duration=5.0 * DAY, macro_step=600.0),
)  # fmt: skip
SHADOW = (
    Extreme("a shadow that is grazed", "the Sun just touches the Earth's rim, orbit after orbit", "longer",
            {"orbit.inclination": math.radians(62.0), "orbit.raan": math.radians(-90.0)}),
)  # fmt: skip
SUNLIGHT = (
    Extreme("a sail of a square kilometre", "light as strong as the tide", "longer", {"sunlight.target_area": 1e6}),
)  # fmt: skip
ELECTRODYNAMIC = (
    Extreme("a short circuit", "a milliohm, and nothing that limits the current but the plasma", "longer",
            {"electrodynamic.resistance": 1e-3, "electrodynamic.current_limit": 1e4,
             "electrodynamic.electron_density": 1e13}, duration=HOUR),
    Extreme("no plasma", "no electrons, no current", "longer", {"electrodynamic.electron_density": 0.0}, duration=HOUR),
)  # fmt: skip
POWER = (
    Extreme("no battery", "the thrust stops and comes back at once, at every edge of the shadow", "longer",
            {"power.battery_share": 0.0, "thrust.level": -0.1}, needs=("thrust",)),
)  # fmt: skip
"""Of what disturbs an orbit, and of what hangs on light."""

BURNS = (
    Extreme("pulses of a millisecond", "a thousand times shorter than what they shake", "orbit",
            {"burn.start": 0.0, "burn.duration": 1e-3, "burn.interval": 10.0}, duration=HOUR),
    Extreme("one pulse of a microsecond", "shorter than any step", "longer",
            {"burn.start": 1.0, "burn.duration": 1e-6, "burn.count": 1}, duration=HOUR),
)  # fmt: skip
ARCS = (
    Extreme("arcs of a thousandth of a degree", "passed within two hundredths of a second", "orbit",
            {"burn.half_width": 1e-5}, duration=6.0 * HOUR),
    Extreme("arcs all round", "it never stops", "orbit", {"burn.half_width": math.pi}, duration=HOUR),
)  # fmt: skip
ENGINES = (
    Extreme("a tank that is empty at once", "a gramme of propellant", "orbit", {"engine.propellant": 1e-3}),
    Extreme("a chaser that is nearly all tank", "it may lose all but a kilogramme", "longer",
            {"engine.propellant": lambda values: values["chaser.mass"] - 1.0}, duration=HOUR),
)  # fmt: skip
PLUME = (
    Extreme("a beam like a hair", "a milliradian", "orbit", {"plume.half_angle": 1e-3}),
    Extreme("a target like a wall", "all of the beam meets it, and nothing is left to tow with", "orbit",
            {"plume.face": 1e3}),
)  # fmt: skip
BREAKING = (
    Extreme("a line as weak as a cobweb", "it breaks as soon as it is taut", "pushes",
            {"break.strength": 1e-9, "break.flies_on": True}),
)  # fmt: skip
RELEASE_AT = (
    Extreme("cut as it begins", "a line that is never there", "pushes", {"release.at": 0.0}, duration=HOUR),
    Extreme("cut in the middle of a tug", "what it had stored is gone", "pushes", {"release.at": 1119.5},
            duration=HOUR),
)  # fmt: skip
RELEASE_ALTITUDE, RELEASE_PERIGEE = (
    (
        Extreme("cut a hundred metres down", "within its first tugs", "pushes",
                {name: lambda values: values["orbit.altitude"] - 100.0}),
        Extreme("never cut", "it would be below the ground", "pushes", {name: -1e6}, duration=HOUR),
    )
    for name in ("release.altitude", "release.perigee")
)  # fmt: skip
SETTLED = (
    Extreme("a line that settles at once", "ten times critical", "longer", {"tether.damping_ratio": 10.0}),
    Extreme("a line that never settles", "without damping", "longer", {"tether.damping_ratio": 0.0}),
    Extreme("a soft line that settles", "as soft as the orbit is quick", "longer",
            {"tether.youngs_modulus": 1e6, "tether.damping_ratio": 0.5}),
)  # fmt: skip
MAPPED = (
    Extreme("tugs that are followed all the same", "a bound that no tug keeps", "longer", {"level.peak_error": 0.0}),
    Extreme("tugs on a line as soft as the orbit is quick", "a bound that every tug keeps", "longer",
            {"level.peak_error": 1.0, "tether.youngs_modulus": 1e7}),
    Extreme("ten days of tugs that never stop", "each takes its bit of the energy, or gives it", "longer",
            {"tether.damping_ratio": 0.0}, duration=10.0 * DAY, scatters="after half a day the times of undamped tugs "
            "hang on the last digit"),
)  # fmt: skip
AVERAGED = (
    *MAPPED,
    Extreme("a hundred days in ten", "each carried over at once", "orbit", duration=100.0 * DAY, macro_step=10.0 * DAY),
    Extreme("leaps on an ellipse", "none: its bound is exceeded", "longer",
            {"orbit.eccentricity": 0.1, "orbit.altitude": _axis_less_radius(0.1)}, duration=10.0 * DAY, macro_step=DAY),
)  # fmt: skip
"""Of levels of detail."""
AOCS = (
    Extreme("a loop of 10 rad/s", "quicker than most lines", "longer",
            {"aocs.frequency": 10.0, "aocs.torque_limit": 1e5, "aocs.momentum_limit": 1e7}, duration=0.25 * HOUR),
    Extreme("wheels of a newton metre second", "full after a moment", "longer",
            {"aocs.torque_limit": 1.0, "aocs.momentum_limit": 1.0}, duration=HOUR),
)  # fmt: skip
"""Of what a scene may add."""

EXTREMES = (
    *(
        Extreme(f"target {ratio:g} times the chaser's mass", "a reduced mass far from both", "longer",
                {"chaser.mass": chaser, "target.mass": ratio * chaser}, duration=2.0 * HOUR)
        for ratio, chaser in ((1e-6, 2000.0), (1e-3, 2000.0), (1e3, 100.0), (1e6, 1.0))
    ),
    *(
        Extreme(f"eccentricity {eccentricity:g}", "perigee at 800 km", "orbit",
                {"orbit.eccentricity": eccentricity, "orbit.altitude": _axis_less_radius(eccentricity)},
                chief=eccentricity == 0.9)
        for eccentricity in (0.1, 0.5, 0.9)
    ),
    Extreme("geostationary orbit", "the tide is two hundred times weaker than in low orbit", "orbit",
            {"orbit.altitude": GEOSTATIONARY}, duration=10.0 * DAY),
    *(
        Extreme(f"macro steps of {step:g} s", "what comes out hangs on no step of the master", "same",
                macro_step=step, duration=duration)
        for step, duration in ((1e-6, 0.01), (1.0, 2.0 * HOUR), (100.0, 0.0), (1e4, 0.0))
    ),
)  # fmt: skip
"""Of every pair."""

SERIES = (
    *(
        Extreme(f"a net of {compliance:g} m/N", "from a plate to a rubber band", "longer",
                {"net.compliance": compliance}, chief=compliance == 1.0)
        for compliance in (0.0, 1e-6, 1.0)
    ),
    Extreme("a net that gives, damped ten times critically", "a dashpot faster than its spring", "longer",
            {"net.compliance": 0.1, "tether.damping_ratio": 10.0}),
)  # fmt: skip
"""Of a net in series with the line."""

AS_PAIR, AS_NODE = range(2)
"""Numbers of what the damping ratio of a line of nodes is a share of, see `node_rows.DAMPED_AS`."""

NODES = (
    *(
        Extreme(f"a line of {count} nodes", "from one to as many as there is room for", "jacobi",
                {"lumped.nodes": count}, duration=60.0, macro_step=1.0, chief=count == 32)
        for count in (1, 32)
    ),
    *(
        Extreme(f"a line of {density:g} kg/m3", "from a balloon's skin to depleted uranium", "jacobi",
                {"lumped.density": density}, duration=20.0, macro_step=1.0)
        for density in (10.0, 19e3)
    ),
    Extreme("nodes damped ten times critically", "a dashpot faster than its spring", "jacobi",
            {"tether.damping_ratio": 10.0, "lumped.damped_as": AS_NODE}, duration=20.0, macro_step=1.0),
    Extreme("nodes with the dashpot of the pair", "the stiffest line there is", "jacobi",
            {"lumped.damped_as": AS_PAIR, "tether.damping_ratio": 0.05}, duration=2.0, macro_step=0.1),
    Extreme("a toe of a tenth", "a line that is soft at first", "jacobi", {"lumped.toe_strain": 0.1}, duration=60.0,
            macro_step=1.0),
    Extreme("a net that gives way", "a metre per newton in series", "jacobi", {"lumped.end_compliance": 1.0},
            duration=60.0, macro_step=1.0),
)  # fmt: skip
"""Of a line of nodes."""
