"""What a user may not expect of a tow."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping

from fmu_src.cautions import Caution, Seen, heavily_damped, low
from fmu_src.tethered_deorbit.asked import LINEAR_LAWS
from fmu_src.tethered_deorbit.nodes.cost import cost
from fmu_src.tethered_deorbit.powered import most_thrust
from fmu_src.tethered_deorbit.reel_rows import FOLLOWING_LAWS
from orbital.constants import EARTH_EQUATORIAL_RADIUS

PROPELLANT = 0.02
"""Share of the pair's mass [1] above which keeping the masses constant is told: an orbit's rate of fall and a snap's
peak are then wrong by about as much, more than any other error of this model."""

MEANT = "ends.raised_perigee"
"""Who gives this wants the orbit raised."""
QUARTER = 0.25 * math.pi
STABLE_SAMPLE = 2.0
"""Longest sample of a control of the tension, in radians of the line's vibration: see `winding.RESPONSE`."""

MANY_STEPS = 1e7
"""Of an hour, from which on it is told what they cost."""

Values = Mapping[str, float]


def before(values: Values, given: Collection[str], terms: Mapping[str, str]) -> Iterator[Caution]:
    """From what the scene says."""
    if "orbit.altitude" in values:
        axis = EARTH_EQUATORIAL_RADIUS + values["orbit.altitude"]
        for sentence in low(axis * (1.0 - values["orbit.eccentricity"]) - EARTH_EQUATORIAL_RADIUS):
            yield Caution("orbit.altitude", f"the perigee at {sentence}" if values["orbit.eccentricity"] else sentence)
    if "orbit.epoch" in values and "orbit.epoch" not in given:
        yield Caution("orbit.epoch", "not given; Sun, Moon and the Earth's turning are those from 2026-01-01 00:00 UTC")
    yield from _unstable(values, terms)
    if "lumped" in terms:
        told = cost(values)
        if told.steps > MANY_STEPS:
            yield Caution(
                "lumped.nodes",
                f"an hour of this line, taut, takes {told.steps:.2g} steps and about {told.seconds / 60.0:.2g} min of "
                "processor time; fewer or heavier nodes, or lumped.damped_as = node, take fewer",
            )
    yield from heavily_damped("tether.damping_ratio", values.get("tether.damping_ratio"), "the line's going taut")
    if "thrust" not in terms:
        return
    force = _force(values)
    if _raises(values, terms) and MEANT not in given:
        yield Caution("thrust.level", f"{force:g} N in the direction {terms['thrust']} raises the orbit")
    most = most_thrust(values, terms)
    if abs(force) > most * (1.0 + 1e-9):
        yield Caution("thrust.level", f"{force:g} N is more than the power allows: {most:.4g} N by engine.power_limit")
    if force != 0.0 and "thrust.specific_impulse" not in given:
        isp = values["thrust.specific_impulse"]
        yield Caution("thrust.specific_impulse", f"not given; the propellant is that of {isp:g} s, an ion engine's")


def after(values: Values, given: Collection[str], terms: Mapping[str, str], seen: Seen) -> Iterator[Caution]:
    """From what came out."""
    propellant, altitude, axis = seen("chaser.propellant"), seen("altitude"), seen("center.semi_major_axis")
    mass = values.get("chaser.mass", math.nan) + values.get("target.mass", math.nan)
    if "engine" not in terms and propellant is not None and propellant.largest > PROPELLANT * mass:
        yield Caution(
            "chaser.propellant",
            f"{propellant.largest:.3g} kg were used, {100 * propellant.largest / mass:.2g} % of the pair's mass, "
            "and yet the masses are held constant: towards the end the pair would be that much lighter; with an engine "
            "they fall",
        )
    limited, off = seen("aocs.limited"), seen("aocs.deviation")
    if limited is not None and off is not None and limited.largest > 0.0:
        most = 180.0 / math.pi * off.largest
        yield Caution(
            "aocs.limited",
            "the wheels had not the torque or the momentum that was asked of them; the attitude was off by up to "
            f"{most:.3g} deg. Nothing desaturates them: once they are full, a pull beside the centre of mass turns the "
            "chaser",
        )
    if altitude is not None and not any(low(altitude.first)):
        for sentence in low(altitude.least):
            yield Caution("altitude", f"the pair came down: {sentence}")
    separation = seen("separation")
    meant = MEANT in given or _raises(values, terms)
    if axis is not None and separation is not None and not meant and _force(values) != 0.0:
        # what the pair's own motion moves the osculating axis by
        noise = (3.0 * (separation.largest / axis.least) ** 2 + 1e-9) * axis.first
        if axis.last - axis.first > noise:
            yield Caution("thrust.level", f"the orbit was raised, by {axis.last - axis.first:.3g} m")


def _unstable(values: Values, terms: Mapping[str, str]) -> Iterator[Caution]:
    """A reel whose loop does not die out, and a winch that samples too seldom for its line."""
    if terms.get("reel") in LINEAR_LAWS:
        from fmu_src.tethered_deorbit import design  # and with it scipy

        loop = design.loop_of(values, terms)
        if loop is not None and not loop.slowest() < 0.0:
            rest = "along the track" if abs(loop.plant.angle) > QUARTER else "near the vertical"
            yield Caution(
                design.GAIN_NAMES[terms["reel"]][0],
                f"with these gains the pair leaves its rest {rest}: a pole of the loop lies at {loop.slowest():.3g} /s",
            )
    if terms.get("reel") in FOLLOWING_LAWS:
        mass = values["chaser.mass"] * values["target.mass"] / (values["chaser.mass"] + values["target.mass"])
        section = math.pi * values["tether.diameter"] ** 2 / 4.0
        frequency = math.sqrt(values["tether.youngs_modulus"] * section / values["tether.rest_length"] / mass)
        turned = frequency * values["reel.sample_time"]
        if turned > STABLE_SAMPLE:
            yield Caution(
                "reel.sample_time",
                f"{values['reel.sample_time']:g} s are {turned:.3g} radians of the pair's vibration on its line; the "
                f"control of the tension is stable up to {STABLE_SAMPLE:g}",
            )


def _force(values: Values) -> float:
    """Thrust [N] along its direction, as the scene gives it."""
    return values.get("thrust.level", 0.0) + values.get("thrust.offset", 0.0)


def _raises(values: Values, terms: Mapping[str, str]) -> bool:
    """Whether the thrust is sure to raise the orbit."""
    on_orbit = terms.get("environment") != "none"
    return on_orbit and terms.get("thrust") in ("along_track", "velocity") and _force(values) > 0.0
