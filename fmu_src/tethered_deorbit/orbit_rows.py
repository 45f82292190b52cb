"""The variables of what disturbs an orbit: the Earth's field, the air, Sun and Moon, light and shadow."""

from __future__ import annotations

from fmu_src.interface import Group, Term
from fmu_src.rows import at_least_zero, count, output, parameter, positive, state, vector
from fmu_src.tethered_deorbit import air_table, field_table, stress

_ROOM = (
    vector("state.pole", "1", "the Earth's axis along the axes of the step", "state"),
    state("state.perturbing[#][#]", "1", "room for vectors", shape=(5, 3)),
)

FIFTY_YEARS = 50.0 * 365.25 * 86400.0
EPOCH = parameter(
    "orbit.epoch",
    "s",
    "when the instance begins: UTC since 2000-01-01 12:00, in days of 86400 s; a scene says a date, 1950 to "
    "2050-01-01. The axes are the mean equator and equinox of then",
    9496.5 * 86400.0,
    -FIFTY_YEARS,
    FIFTY_YEARS,
    date=True,
)
"""As it stands, 2026-01-01 00:00 UTC."""

SKY = (
    EPOCH,
    vector("state.sun", "m", "place of the Sun along the axes of the step", "state"),
    vector("state.moon", "m", "and of the Moon", "state"),
    state("state.sky[#][#]", "m", "places between which these are interpolated", shape=(8, 3)),
    state("state.sky_window", "1", "hour of the tow for which they are, from 0"),
)

OBLATENESS = Group(
    {
        "J2": Term(
            "the Earth is flattened: its second zonal harmonic acts on each of the two bodies",
            _ROOM,
            extremes=stress.OBLATENESS,
        ),
        "J4": Term(
            "the same, with the third and the fourth zonal harmonic",
            _ROOM,
            extremes=stress.OBLATENESS,
        ),
    },
    selector="zonal",
    optional=True,
    follows=lambda terms, values: "J2",
)

_DRAG = (
    at_least_zero("air.drag_coefficient", "1", "of both bodies", 2.2, 10.0),
    at_least_zero("air.chaser_area", "m2", "that the chaser shows the air", 10.0, 1e6),
    at_least_zero("air.target_area", "m2", "that the target shows the air", 10.0, 1e6),
    output("air.density", "kg/m3", "at the centre of mass", 1e-12),
    output("air.chaser_drag", "N", "on the chaser", 1e-4),
    output("air.target_drag", "N", "on the target", 1e-4),
)

AIR = Group(
    {
        "exponential": Term(
            "air whose density falls with altitude and that turns with the Earth drags each of the two bodies",
            (
                positive("air.base_density", "kg/m3", "at air.base_altitude; as it stands, of the standard atmosphere "
                         "at 400 km", 3.725e-12, 10.0),
                parameter("air.base_altitude", "m", "above the equatorial radius", 400e3, 0.0, 2e6, display_unit="km"),
                positive("air.scale_height", "m", "over which the density falls to 1/e", 58.515e3, 1e6,
                         display_unit="km"),
                *_DRAG,
                *_ROOM,
            ),
            extremes=stress.AIR,
        ),
        "nrlmsis": Term(
            "air by NRLMSIS 2.1 at the epoch, for the solar flux and the geomagnetic index that the scene says",
            (*_DRAG, *SKY, *_ROOM),
            tables=(air_table.TABLE,),
            asked=(
                positive("air.f107", "1", "flux of the Sun at 10.7 cm the day before, in 1e-22 W/(m2 Hz)", 150.0, 1e3),
                positive("air.f107_average", "1", "its mean over 81 days about the epoch", 150.0, 1e3),
                parameter("air.ap", "1", "planetary index of the Earth's magnetic field, of the day", 15.0, 0.0, 400.0),
            ),
            lay=air_table.lay,
            extremes=stress.MSIS,
        ),
    },
    selector="law",
    optional=True,
    follows=lambda terms, values: "exponential",
)  # fmt: skip

THIRD_BODIES = Group(
    {
        which: Term(
            f"the gravity of {who} acts on each of the two bodies", (*SKY, *_ROOM), extremes=stress.THIRD_BODIES
        )
        for which, who in (("sun_and_moon", "Sun and Moon"), ("sun", "the Sun"), ("moon", "the Moon"))
    },
    selector="which",
    optional=True,
    follows=lambda terms, values: "sun_and_moon",
)

_SHADOW = (
    *SKY,
    output("shadow.lit", "1", "share of the Sun's disc that is seen from the centre of mass", 1.0),
    output("shadow.time", "s", "in shadow, in part or whole, since the start of this instance", 1000.0),
    count("shadow.count", "how often the pair has been in shadow"),
    state("state.zone", "1", "0 light, 1 penumbra, 2 umbra", kind="Integer"),
    state("state.lit", "1", "share of the Sun's disc that is seen"),
    state("state.shadows", "1", "how often the pair has been in shadow", kind="Integer"),
    state("state.dark_since", "s", "when it last entered the shadow"),
    state("state.dark_time", "s", "in shadow, but for the present one"),
)

SHADOW = Group(
    {
        "cylinder": Term("the Earth's shadow is a cylinder", _SHADOW, extremes=stress.SHADOW),
        "cone": Term("the Earth's shadow has an umbra, and a penumbra in which part of the Sun is seen", _SHADOW,
                     extremes=stress.SHADOW),
    },
    selector="shape",
    optional=True,
    follows=lambda terms, values: "cone",
)  # fmt: skip

SUNLIGHT = Group(
    {
        "pressure": Term(
            "the Sun's light presses on each of the two bodies, as much of it as the Earth lets pass",
            (
                parameter("sunlight.coefficient", "1", "1 for a body that swallows all light, 2 for a mirror that "
                          "faces it", 1.3, 1.0, 2.0),
                at_least_zero("sunlight.chaser_area", "m2", "that the chaser shows the Sun", 10.0, 1e6),
                at_least_zero("sunlight.target_area", "m2", "that the target shows the Sun", 10.0, 1e6),
                output("sunlight.chaser_force", "N", "on the chaser, away from the Sun", 1e-4),
                output("sunlight.target_force", "N", "on the target, away from the Sun", 1e-4),
            ),
            needs=("shadow",),
            extremes=stress.SUNLIGHT,
        ),
    },
    selector="law",
    optional=True,
    follows=lambda terms, values: "pressure",
)  # fmt: skip

POWER = Group(
    {
        "solar": Term(
            "the thruster's power comes from the Sun: in shadow, penumbra included, there is what batteries give",
            (
                parameter("power.battery_share", "1", "of engine.power_limit that there is in shadow", 0.0, 0.0, 1.0),
            ),
            needs=("engine", "shadow"),
            extremes=stress.POWER,
        ),
    },
    selector="source",
    optional=True,
    follows=lambda terms, values: "solar",
)  # fmt: skip

_CONDUCTING = (
    EPOCH,
    positive("electrodynamic.resistance", "ohm", "of the line and its contactors", 100.0, 1e9),
    at_least_zero("electrodynamic.contactor_drop", "V", "voltage that both plasma contactors take", 30.0, 1e5),
    positive("electrodynamic.contactor_radius", "m", "of the sphere from which a contactor draws electrons", 10.0, 1e4),
    at_least_zero("electrodynamic.current_limit", "A", "that the line may carry", 2.0, 1e4),
    at_least_zero("electrodynamic.electron_density", "1/m3", "of the plasma; 1e9 to 1e12 by altitude, time of day and "
                  "Sun", 1e11, 1e14),
    positive("electrodynamic.electron_temperature", "K", "of the plasma", 1500.0, 1e6),
    output("electrodynamic.field", "T", "magnetic flux density at the middle of the line", 3e-5),
    output("electrodynamic.emf", "V", "induced between its ends, positive from the chaser to the target", 100.0),
    output("electrodynamic.current", "A", "through it, from the chaser to the target", 1.0),
    output("electrodynamic.power", "W", "voltage times current: what the air's frame, which turns, is given", 100.0),
    output("electrodynamic.orbit_power", "W", "that the force takes from the orbit", 100.0),
    output("electrodynamic.force", "N", "on it", 0.01),
    vector("state.field", "T", "where the line is", "state"),
)  # fmt: skip

ELECTRODYNAMIC = Group(
    {
        "dipole": Term(
            "the line conducts, and the Earth's field, a tilted dipole that turns with it, drives a current through it",
            (
                *_CONDUCTING,
                vector("state.dipole", "1", "direction of the dipole along the axes of the step", "state"),
                *_ROOM,
            ),
            extremes=stress.ELECTRODYNAMIC,
        ),
        "igrf": Term(
            "the line conducts, and the Earth's field by IGRF at the epoch drives a current through it",
            (
                *_CONDUCTING,
                vector("state.meridian", "1", "direction of Greenwich along the axes of the step", "state"),
                state("state.harmonics[#][#]", "1", "room for harmonics",
                      shape=(2 * field_table.DEGREE + 4, field_table.DEGREE + 2)),
                *_ROOM,
            ),
            tables=(field_table.TABLE,),
            lay=field_table.lay,
            extremes=stress.ELECTRODYNAMIC,
        ),
    },
    selector="field",
    optional=True,
    follows=lambda terms, values: "dipole",
)  # fmt: skip

FRICTION = Group(
    {
        "coulomb": Term(
            "a level table on which both bodies slide, and the nodes of a line that has any, with friction",
            (
                at_least_zero("friction.coefficient", "1", "of friction: ours, of air bearings", 1e-4, 10.0),
                at_least_zero("friction.gravity", "m/s2", "that presses them on the table", 9.80665, 1e3),
                positive("friction.creep", "m/s", "speed over which friction comes to its full value: what would stick "
                         "creeps, more slowly than this at 0.7 of it", 1e-4, 10.0),
                output("friction.chaser_force", "N", "on the chaser", 0.01),
                output("friction.target_force", "N", "on the target", 0.01),
                output("friction.loss", "J", "that friction has taken, since the start", 0.01),
                state("state.rubbing[#][#]", "1", "room for vectors", shape=(4, 3)),
            ),
            excludes=("level",),
            carries={"environment": ("none",), "target": ("point",), "chaser": ("point",)},
            extremes=stress.FRICTION,
        ),
    },
    optional=True,
    follows=lambda terms, values: "coulomb",
)  # fmt: skip
