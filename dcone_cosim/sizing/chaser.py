"""What the tow asks of reel and chaser: rate, force and power of the line's end, torque of an offset pull, and what it
takes to bring the pair down, with an ion engine and with a chemical one.

Checked  tests/sizing/test_chaser.py
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from dcone_cosim.sizing.ground import Found, Ground, reduced, stiffness
from dcone_cosim.sizing.options import Options
from orbital import disposal
from orbital.constants import EARTH_EQUATORIAL_RADIUS, EARTH_MU
from orbital.oscillators import snap_duration, snap_restitution

LOW, PERIGEE = 200e3, 120e3
"""Altitude to which an ion engine spirals, and of the perigee that one burn reaches [m]: ends of `electric-tug` and
`chemical-tug`."""
ELECTRIC, CHEMICAL = (0.25, 3000.0, 0.6), (400.0, 300.0, 1.0)
"""Thrust [N], specific impulse [s] and efficiency [1] of these two scenes."""
HALF_ANGLE, FACE = math.radians(15.0), 4.0
"""Of the beam [rad], and of the target's face [m], where the scene has no plume."""


@dataclass(frozen=True)
class Asked:
    """One figure: what it is, its SI value and unit, and from what it follows."""

    what: str
    value: float
    unit: str
    how: str


def of_reel(ground: Ground, runs: Sequence[Found]) -> Iterator[Asked]:
    """What the line's end at the chaser has to do, over all runs."""
    tugs = [tug for run in runs for tug in run.tugs]
    peak = max(run.peak for run in runs)
    speed = max((abs(tug[2]) for tug in tugs), default=0.0)
    rates = _extremes(runs, "tether.length_rate")
    winch = _extremes(runs, "reel.rate")
    power = _extremes(runs, "reel.power")
    yield Asked("holding force", peak, "N", "largest tension of all runs: drum, brake and their mounting bear it")
    if winch:
        yield Asked("rate", max(map(abs, winch)), "m/s", "largest of the scene's reel, of rows")
    else:
        largest = max([speed, *map(abs, rates)])
        yield Asked("rate", largest, "m/s", "at which the line's ends part or near, at most: a reel that keeps it taut")
    if power:
        yield Asked("power", max(map(abs, power)), "W", "largest of the scene's reel, of rows")
    hardest = max(tugs, key=lambda tug: tug[1], default=(0.0, 0.0, 0.0))
    yield Asked("power of a brake", hardest[1] * abs(hardest[2]), "W", "hardest tug's peak times its speed")
    energy = 0.5 * reduced(ground.values) * speed**2
    yield Asked("energy of a tug", energy, "J", "m_r v^2/2 of the fastest: what a brake takes in one go")


def _extremes(runs: Sequence[Found], name: str) -> list[float]:
    found = [run.loads["extremes"][name] for run in runs if name in run.loads["extremes"]]
    return [value for least, _, most in found for value in (least, most)]


def of_attitude(ground: Ground, run: Found, still: float, options: Options) -> Iterator[Asked]:
    """Torque of the line's pull beside the chaser's centre of mass, against what its attitude control has.

    still    tension without tugs [N]
    """
    values = ground.values
    own = [values.get(f"chaser.attachment[{i}]", 0.0) for i in (1, 2, 3)]
    rigid = any(own)
    offset = math.hypot(own[0], own[2]) if rigid else options.offset
    whose = "the scene's attachment, across the line of sight" if rigid else "[sizing] offset"
    torque = values.get("aocs.torque_limit", options.torque)
    held = "the scene's aocs.torque_limit" if "aocs.torque_limit" in values else "[sizing] torque"
    yield Asked("offset of the pull", offset, "m", whose)
    yield Asked("authority", torque, "N.m", held)
    yield Asked("steady torque", still * offset, "N.m", "sustained tension, without tugs, times the offset")
    yield Asked(
        "share of the authority", still * offset / torque, "1", "steady torque over authority: below 1 it holds"
    )
    worst = run.worst
    if worst is not None:
        zeta = values["tether.damping_ratio"]
        k, m = stiffness(values), reduced(values)
        back = snap_restitution(zeta) if zeta < 1.0 else 0.0
        impulse = m * abs(worst[2]) * (1.0 + back)
        lasts = snap_duration(k, m, zeta) if zeta < 1.0 else math.pi * math.sqrt(m / k)
        yield Asked(
            "torque of the hardest tug", worst[1] * offset, "N.m", f"its peak times the offset, for {lasts:.3g} s"
        )
        yield Asked(
            "share of the authority, in it", worst[1] * offset / torque, "1",
            "above 1 the chaser turns while it lasts, and wheels take up the momentum after",
        )  # fmt: skip
        yield Asked(
            "momentum it leaves", impulse * offset, "N.m.s", "m_r v (1 + e) times the offset: wheels take it up"
        )
        recovers = impulse * offset / torque
        yield Asked("time to take that up", recovers, "s", "that momentum over the authority")
    if "orbit.altitude" in values:
        axis = EARTH_EQUATORIAL_RADIUS + values["orbit.altitude"]
        period = 2.0 * math.pi * math.sqrt(axis**3 / EARTH_MU)
        mean, window = run.figure("tension_mean"), run.figure("tension_window")
        whose = "mean tension of the last orbit"
        if mean is None or window is None or window < period:
            mean, whose = still, "sustained tension"  # the run is too short for a mean over an orbit
        text = f"{whose} times offset and period, were it all to one side"
        yield Asked("momentum per orbit", mean * offset * period, "N.m.s", text)
    if "aocs.deviation" in run.loads["extremes"]:
        most = run.loads["extremes"]["aocs.deviation"][2]
        yield Asked("attitude error", most, "rad", "largest of the scene's run, of rows")


@dataclass(frozen=True)
class Way:
    """One way to bring the pair down.

    thrust [N], impulse   specific [s], speed   change of it [m/s], propellant [kg], time [s], power [W]
    tension    that the thrust keeps in the line [N]
    beam       share of the beam on the target at the line's length, which is lost [1]: where the scene names a plume,
               it is taken off the thrust of the pair, and added to what the line has to bear
    """

    name: str
    thrust: float
    impulse: float
    speed: float
    propellant: float
    time: float
    power: float
    tension: float
    beam: float
    how: str


def ways(ground: Ground) -> list[Way]:
    """Electric beside chemical, and the scene's own, in closed form; none without an orbit."""
    values = ground.values
    if "orbit.altitude" not in values:
        return []
    engine = ground.phase.main.terms.get("engine")
    level, impulse = abs(values.get("thrust.level", 0.0)), values.get("thrust.specific_impulse", 0.0)
    found = []
    if level > 0.0 and impulse > 0.0:
        efficiency = values.get("engine.efficiency", ELECTRIC[2])
        slow = engine == "electric" or (engine is None and impulse > 1000.0)
        found.append(_way(ground, "the scene's own", (level, impulse, efficiency if slow else 1.0), slow))
    found.append(_way(ground, "electric, as `electric-tug`", ELECTRIC, True))
    found.append(_way(ground, "chemical, as `chemical-tug`", CHEMICAL, False))
    return found


def _way(ground: Ground, name: str, engine: tuple[float, float, float], slow: bool) -> Way:
    values = ground.values
    thrust, impulse, efficiency = engine
    radius = EARTH_EQUATORIAL_RADIUS + values["orbit.altitude"]
    mass = values["chaser.mass"] + values["target.mass"]
    if slow:
        speed = disposal.spiral_speed(radius, EARTH_EQUATORIAL_RADIUS + LOW, EARTH_MU)
        how = f"spiral to {1e-3 * LOW:g} km (Edelbaum), thrust all the time; power F Isp g0/(2 x {efficiency:g})"
    else:
        speed = disposal.burn_speed(radius, EARTH_EQUATORIAL_RADIUS + PERIGEE, EARTH_MU)
        how = f"one short burn to a perigee of {1e-3 * PERIGEE:g} km (vis-viva); a long one takes more"
    span = values["tether.rest_length"] + values.get("target.attachment_distance", 0.0)
    beam = disposal.beam_share(span, values.get("plume.half_angle", HALF_ANGLE), values.get("plume.face", FACE))
    # what of the thrust moves the pair: what meets the debris pushes it back, through the line
    lost = beam if "plume" in ground.phase.main.terms else 0.0
    need = speed / (1.0 - lost) if lost < 1.0 else math.inf
    return Way(
        name,
        thrust,
        impulse,
        speed,
        disposal.propellant(mass, need, impulse),
        disposal.thrust_time(mass, need, impulse, thrust),
        disposal.jet_power(thrust, impulse, efficiency) if slow else math.nan,
        thrust * ((1.0 - lost) * values["target.mass"] / mass + lost),
        beam,
        how,
    )


def time_down(ground: Ground) -> float | None:
    """Time [s] until the scene's own thrust has brought the pair down; None where it has none."""
    own = [way for way in ways(ground) if way.name == "the scene's own"]
    return own[0].time if own else None
