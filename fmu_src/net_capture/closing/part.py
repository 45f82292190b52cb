"""What every way of closing has: its rows, what it refuses, and its extremes."""

from __future__ import annotations

from collections.abc import Iterator

from fmu_src.extremes import Extreme, times
from fmu_src.interface import Variable
from fmu_src.net_capture.closing.triggers import BEYOND_TARGET, TRIGGER_DISTANCE, TRIGGER_TIME, TRIGGERS, WAYS
from fmu_src.net_capture.planes import MOST_BULLETS
from fmu_src.net_capture.refusal import Refusal, Scene
from fmu_src.rows import at_least_zero, choice, count, output, parameter, peak, positive, state

FASTEST = 100.0
"""Speed of a reel [m/s] up to which what it winds in a substep is little beside its cord."""
SLACK = ("taken_in", "wound")
"""What becomes of the cord that is loose as the reels start."""
TAKEN_IN, WOUND = range(2)


def rows(reels: str) -> tuple[Variable, ...]:
    """Rows that every way of closing has; `reels` is what draws, as a sentence names it."""
    return (
        choice("closing.trigger", f"what starts the {reels}; close.command always does", TRIGGERS),
        at_least_zero("closing.time", "s", f"when the {reels} start, since the shot, for trigger time", 11.2),
        choice(
            "closing.measured",
            "what trigger distance goes by: how far the rearmost bullet is beyond the target's centre of mass along "
            "the shot, how near the vertex is to it, or how far bullets (along the shot) or vertex are from the muzzle",
            WAYS,
        ),
        parameter("closing.distance", "m", f"that starts the {reels}, for trigger distance", 0.0),
        at_least_zero("closing.delay", "s", f"from the trigger to the start of the {reels}", 0.0),
        choice(
            "closing.slack",
            f"how the {reels} take what is loose of the cord as they start: at once, whatever their speed, or at their "
            "speed without load, as all other cord, so that it pulls once it is taut",
            SLACK,
        ),
        parameter(
            "closing.rings",
            "1",
            "on each side of the mouth, evenly spaced, through which the cord between two bullets runs without "
            "friction; without any the sides stay open loops",
            1,
            0,
            64,
            kind="Integer",
        ),
        parameter(
            "closing.reels_at",
            "1",
            "which of these places along the rim, counted from each bullet, its reel stands at: 0 is the bullet "
            "itself; at others a ring is at the bullet",
            0,
            0,
            64,
            kind="Integer",
        ),
        positive("closing.axial_stiffness", "N", "EA of the cord: 0.5 mm nylon", 903.0),
        at_least_zero("closing.damping_ratio", "1", "of the cord between two bullets", 0.106),
        positive("closing.lock_length", "m", "a pair is locked when its cord is shorter than this", 0.25),
        positive(
            "closing.timeout",
            "s",
            "after this long since the trigger a mouth that is not closed behind the target counts as not closed",
            20.0,
        ),
        Variable("close.command", "1", "input", f"start the {reels}", False, kind="Boolean"),
        output(
            "mouth.cord_length",
            "m",
            "length of cord still out: the way round the bullets can not be longer, the net's slack sides can",
        ),
        output("mouth.girth", "m", "smallest girth of the target, which the mouth would have to pass"),
        peak(
            "mouth.margin_at_capture",
            "m",
            "girth of the target less cord out, at the instant of capture; -1 before",
        ),
        peak(
            "enclosure.share",
            "1",
            "share of the target's sample points that net and mouth go round, at the last look; "
            "-1 until the cord is shorter than the girth",
        ),
        peak("enclosure.at_capture", "1", "that share at the instant of capture; -1 before"),
        peak("enclosure.least", "1", "least share since the capture; -1 before"),
        peak("t_lost", "s", "instant at which the target was out of the net again after a capture; -1 before"),
        state("enclosure_since", "s", "since when enough of the target to count as caught has been inside"),
        state("enclosure_last_in", "s", "when enough of the target was last inside"),
        count("mouth.locked_pairs", "pairs of bullets whose cord is shorter than the lock length"),
        peak("cord.tension_max", "N", "largest tension of the cord since the start"),
        peak("cord.tension_peak", "N", "largest tension of the cord over the last macro step"),
        output("closing.work", "J", f"work done by the {reels} so far"),
        output("cord.dissipated", "J", "taken by the cord's dashpots so far"),
        peak("closing.t_start", "s", f"when the {reels} started, since the shot; -1 before"),
        state("cord_length[#]", "m", "cord out between neighbouring bullets", shape=(MOST_BULLETS,)),
        state("cord_most[#]", "m", "the most that there can be", shape=(MOST_BULLETS,)),
        state("cord_rate[#]", "m/s", "rate of that length", shape=(MOST_BULLETS,)),
        state("cord_force[#]", "N", "what each reel works against per length wound", shape=(MOST_BULLETS,)),
        state("cord_mass", "kg", "that a pair's cord moves as it lengthens"),
        state("cord_power", "W", "what the cord's dashpots take now"),
        state("cord_loss", "J", "taken by the cord's dashpots up to half a substep back"),
        state("trigger_time", "s", "when the trigger fell, since the shot; -1 before"),
    )


def refuses(scene: Scene) -> Iterator[Refusal]:
    """More rings than the shortest side of the mouth has knots, reels beyond them, distances that nothing can reach."""
    most = scene.parts["net"].checks.knots(scene.values)
    if scene.values["closing.rings"] > most >= 1:
        expected = f"must be at most {most}: a side of this net has so many knots between its bullets"
        yield Refusal("closing.rings", f"{int(scene.values['closing.rings'])}", expected)
    if scene.values["closing.reels_at"] > scene.values["closing.rings"]:
        given, rings = int(scene.values["closing.reels_at"]), int(scene.values["closing.rings"])
        yield Refusal("closing.reels_at", f"{given}", f"must be at most {rings}, closing.rings")
    if scene.values["closing.trigger"] == TRIGGER_DISTANCE:
        way, distance = int(scene.values["closing.measured"]), scene.values["closing.distance"]
        if way != BEYOND_TARGET and distance <= 0.0:
            expected = f"must be greater than 0 m: trigger distance goes by {WAYS[way]}"
            yield Refusal("closing.distance", f"{distance:g} m", expected)
        if "target" not in scene.terms and "target" in WAYS[way]:
            expected = "needs the table [capture.target]; without a target: mouth_to_muzzle or vertex_to_muzzle"
            yield Refusal("closing.measured", WAYS[way], expected)


EXTREMES = (
    *(
        Extreme(
            f"cord {factor:g} times as stiff",
            "EA of the closing cord",
            "energy_gained",
            {"closing.axial_stiffness": times("closing.axial_stiffness", factor)},
            chief=factor == 1e2,
        )
        for factor in (1e-3, 1e2, 1e4)
    ),
    Extreme(
        "closing at the first instant",
        "the reels draw on a net that is still folded",
        "energy_gained",
        {"closing.trigger": TRIGGER_TIME, "closing.time": 0.0},
    ),
    Extreme(
        "slack of a folded net wound on a stiff cord",
        "the reels wind all that is loose of the cord, which then goes taut at their full speed",
        "energy_gained",
        {
            "closing.trigger": TRIGGER_TIME,
            "closing.time": 0.0,
            "closing.slack": 1,
            "closing.axial_stiffness": times("closing.axial_stiffness", 1e2),
        },
        chief=True,
    ),
)
