"""The sizing of a scene, from its runs to the numbers: peaks, spectrum, required lines, sensitivities, region, closed
net."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from dcone_cosim.cases.alone import Alone
from dcone_cosim.cases.runner import Runner
from dcone_cosim.errors import InputError
from dcone_cosim.progress import Progress
from dcone_cosim.sizing import chaser, closed_net, governs, region, required, sensitivity
from dcone_cosim.sizing.flux import YEAR
from dcone_cosim.sizing.ground import BREAK, Found, Ground, preload, reduced, steady, stiffness, why
from dcone_cosim.sizing.options import Options, of_name
from dcone_cosim.sizing.uncertain import Sample, Uncertain, at_random, ends, uncertain
from orbital import tethers
from orbital.materials import MATERIALS, Material, section
from orbital.oscillators import snap_duration

WORST = 3
"""Hardest of all runs that the required line is made for, beside the scene as it is."""
UNBREAKABLE = 1e12
"""Strength of a line that is to show its load, not to break [N]."""
INPUTS = (
    ("orbit.altitude", "altitude", "m"),
    ("chaser.mass", "chaser", "kg"),
    ("target.mass", "debris", "kg"),
    ("tether.rest_length", "line, unloaded", "m"),
    ("tether.diameter", "its diameter", "m"),
    ("tether.youngs_modulus", "its E", "Pa"),
    ("tether.damping_ratio", "its damping, of critical for two free bodies", "1"),
    ("start.separation", "separation at the start", "m"),
    ("thrust.level", "thrust", "N"),
)
AT_THE_START = tuple(f"start.relative_position[{i}]" for i in (1, 2, 3))
FAR_BELOW = 0.05
"""Share of the hardest tug below which a tug is not held against its closed form [1]."""


@dataclass(frozen=True)
class Held:
    """A tug beside its closed form: speed [m/s], peak [N], that of the formula [N]."""

    speed: float
    peak: float
    formula: float

    @property
    def difference(self) -> float:
        return self.peak / self.formula - 1.0


@dataclass
class Study:
    """All that was found.

    ground, options    the tow, and what was asked
    nominal            the scene as it is; bound   the same without damping
    ranges, made       what is uncertain, and the runs of it with their samples
    tugs               hard tugs beside their closed forms, where the target is a point
    needed             required line of each material
    demands            of the chief material: what each load asks of it
    governing          largest tension [N] of the hardest runs at the diameter that governs, and the margin it leaves
    steady             tension without tugs [N];  time   that the line is out [s], and from what that follows
    captures           runs begun by other shots: label, what they found
    failed             runs that came to nothing
    """

    ground: Ground
    options: Options
    nominal: Found
    bound: Found
    ranges: list[Uncertain]
    made: list[tuple[Sample, Found]]
    tugs: list[Held]
    needed: list[required.Required]
    chief: Material
    breaking: float
    demands: list[governs.Demand]
    governing: tuple[float, float] | None
    steady: float
    time: float
    time_from: str
    slopes: list[sensitivity.Slope]
    region: region.Region | None
    reel: list[chaser.Asked]
    attitude: list[chaser.Asked]
    ways: list[chaser.Way]
    net: list[closed_net.Borne]
    captures: list[tuple[Sample, Found]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    @property
    def all(self) -> list[tuple[Sample, Found]]:
        """The scene as it is, and every run of what is uncertain that came to its end."""
        runs = [(Sample("the scene as it is"), self.nominal), *self.made, *self.captures]
        return [(sample, run) for sample, run in runs if math.isfinite(run.peak)]

    def bears(self, sample: Sample) -> float:
        """Load at which the line of a run breaks [N]: another diameter bears as its section does."""
        own = self.ground.values["tether.diameter"]
        return self.breaking * (sample.values.get("tether.diameter", own) / own) ** 2

    def inputs(self) -> list[chaser.Asked]:
        """What is sized: the values of the scene from which all else follows, SI."""
        values = self.ground.values
        ends = self.nominal.figure("simulated")
        return [
            *asked_of(self.ground),
            chaser.Asked("stiffness of the line", stiffness(values), "N/m", "E A / l"),
            chaser.Asked("reduced mass", reduced(values), "kg", "of chaser and debris"),
            *([] if ends is None else [chaser.Asked("duration of a run", ends, "s", "of the scene")]),
        ]

    @property
    def worst(self) -> tuple[Sample, Found]:
        return max(self.all, key=lambda one: one[1].peak)


def asked_of(ground: Ground) -> list[chaser.Asked]:
    """What the scene asks for; of a tow that another phase hands over to, the distance that it begins at.

    Checked  tests/sizing/test_ground.py
    """
    values = ground.values
    told = [chaser.Asked(what, values[name], unit, name) for name, what, unit in INPUTS if name in values]
    apart = [values[name] for name in AT_THE_START if name in values]
    if not ground.handed_over or not apart:
        return told
    begun = chaser.Asked("separation at the start", math.hypot(*apart), "m", "the hand-over")
    return [begun if row.how == "start.separation" else row for row in told]


def study(
    ground: Ground,
    others: Sequence[tuple[str, Ground]],
    options: Options,
    runner: Runner,
    nets: Runner,
    progress: Progress,
) -> Study:
    """Run everything.

    others    the tow as other shots hand it over, each with what was different
    nets      runs captures that are pulled at
    """
    for one in (ground, *(other for _, other in others)):
        one.runner = runner
        if one.breaks_at is not None:  # a line that breaks does not tell what it would have had to bear
            one.pin({BREAK: UNBREAKABLE})
    nominal = ground.one(history=True)
    if math.isnan(nominal.peak):
        raise InputError(f"{ground.scene.source}: the tow does not come to its end: {why(nominal.row)}")
    if not nominal.peak > 0.0:
        raise InputError(f"{ground.scene.source}: the line is never taut: there is no load to size it for")
    bound = ground.one({"tether.damping_ratio": 0.0}, what="without damping")
    ranges = uncertain(ground, options.ranges)
    each = [(one, replace(sample, values=ground.fitted(sample.values))) for one, sample in ends(ranges)]
    found_each = list(ground.run([ground.case(sample.values) for _, sample in each], "uncertain values"))
    able = [one for one in ranges if not any(o is one and _lost(r) for (o, _), r in zip(each, found_each, strict=True))]
    drawn = [_corner(each, found_each, nominal), *at_random(able, options.samples)]
    wanted = [replace(one, values=ground.fitted(one.values)) for one in drawn]
    together = ground.run([ground.case(sample.values) for sample in wanted], "uncertain values together")
    made = [*zip((sample for _, sample in each), found_each, strict=True), *zip(wanted, together, strict=True)]
    captures = [(Sample(label, {}), other.one(what=label)) for label, other in others]
    notes = [f"{one.label}: left out: {why(run.row)}" for one, run in (*made, *captures) if math.isnan(run.peak)]
    chief, breaking = chief_material(ground)
    still = _still(ground, nominal)
    hardest = _hardest(nominal, made)
    needed = _needed(ground, hardest, options, still)
    down = chaser.time_down(ground)
    time, whence = _mission(options, down)
    own = next(one for one in needed if one.material == chief)
    length = ground.values["tether.rest_length"]
    demands = governs.demands(own, ground.values["tether.damping_ratio"], still, length, time, options)
    governing = [one.diameter for one in demands if math.isfinite(one.diameter)]
    samples = [sample.values for sample, _ in hardest]
    found = Study(
        ground,
        options,
        nominal,
        bound,
        ranges,
        made,
        held(ground, nominal),
        needed,
        chief,
        breaking,
        demands,
        required.at(ground, chief, governing[0], samples, options.factor_of_safety) if governing else None,
        still,
        time,
        whence,
        sensitivity.slopes(ground, ranges, options.steps),
        region.region(ground, breaking, options.factor_of_safety, options.quick),
        [],
        list(chaser.of_attitude(ground, nominal, still, options)),
        chaser.ways(ground),
        [],
        captures,
        notes,
    )
    found.reel = list(chaser.of_reel(ground, [run for _, run in found.all]))
    found.net = _net(ground.alone, found, options, nets, progress)
    return found


def _corner(each: Sequence[tuple[Uncertain, Sample]], runs: Sequence[Found], nominal: Found) -> Sample:
    """All values at once, each at the end at which the peak was larger, where that was larger than the scene's."""
    values: dict[str, float] = {}
    peaks: dict[str, float] = {}
    for (one, sample), run in zip(each, runs, strict=True):
        if run.peak > max(nominal.peak, peaks.get(one.label, 0.0)):
            peaks[one.label] = run.peak
            values |= sample.values
    return Sample("each at its worse end", values)


def _lost(run: Found) -> bool:
    return math.isnan(run.peak)


def chief_material(ground: Ground) -> tuple[Material, float]:
    """The scene's line as a material, and the load at which it breaks [N]; Kevlar 29 where the scene tells none.

    Stiffness and strength are those of the scene, where it says them; `break.strength` goes before all.
    """
    line, values = ground.phase.main.lines.get("tether"), ground.values
    material = line.material if line is not None and line.material is not None else MATERIALS["Kevlar 29"]
    area = section(values["tether.diameter"])
    strength = line.strength if line is not None and line.strength is not None else material.strength
    if ground.breaks_at is not None:
        strength = ground.breaks_at / area
    if strength is None:
        source, name = ground.scene.source, material.name
        raise InputError(
            f'{source}: the strength of {name} is not known; say it: {ground.name}.tether.strength = "2.9 GPa"'
        )
    own = replace(material, youngs_modulus=values["tether.youngs_modulus"], strength=strength)
    if own != material:
        own = replace(own, name=f"the scene's {material.name}")
    return own, strength * area


def materials(chief: Material, options: Options) -> list[Material]:
    """Those that a line is sized of: the scene's, and those asked for; else all yarns, and braids of them."""
    known = [one for yarn in MATERIALS.values() for one in (yarn, yarn.braided()) if one.strength is not None]
    if options.materials:
        known = [of_name(name) for name in options.materials]
    elif options.quick:
        known = [one for one in known if one.form == chief.form]
    return [chief, *(one for one in known if one != chief)]


def held(ground: Ground, run: Found) -> list[Held]:
    """Hard tugs of a target that is a point, each beside the closed form at its own speed and preload."""
    values, terms = ground.values, ground.phase.main.terms
    zeta, angles = values["tether.damping_ratio"], run.loads["angles"]
    plain = terms.get("target") == "point" and terms.get("reel") == "locked" and terms.get("thrust") == "along_track"
    if not plain or zeta >= 1.0 or "orbit.altitude" not in values or values["orbit.eccentricity"] > 0.0:
        return []
    k, m = stiffness(values), reduced(values)
    return [
        Held(speed, peak, tethers.preloaded_snap_peak(speed, k, m, zeta, preload(values, *angle)))
        for (_, peak, speed), angle in zip(run.tugs, angles, strict=False)
        if peak >= FAR_BELOW * run.peak and speed > 0.0
    ]


def _still(ground: Ground, run: Found) -> float:
    """Tension without tugs [N]: of the last orbit where that has none, or what thrust and tide keep in the line."""
    least = steady(ground.values)
    largest, last = run.figure("tension_largest"), run.figure("tension_window")
    ends = run.figure("simulated") or 0.0
    quiet = last is not None and not any(tug[0] > ends - last for tug in run.tugs)
    return max(least, largest) if quiet and largest is not None else least


def _hardest(nominal: Found, made: Sequence[tuple[Sample, Found]]) -> list[tuple[Sample, Found]]:
    """The scene as it is, and the hardest of all runs: those that a line is made for."""
    others = sorted((one for one in made if math.isfinite(one[1].peak)), key=lambda one: -one[1].peak)
    return [(Sample("the scene as it is"), nominal), *others[:WORST]]


def _needed(
    ground: Ground, runs: Sequence[tuple[Sample, Found]], options: Options, still: float
) -> list[required.Required]:
    """The required line of every material, for the hardest runs."""
    safety, length = options.factor_of_safety, ground.values["tether.rest_length"]
    chief, _ = chief_material(ground)
    chosen = materials(chief, options)
    closed, fixed = [], []
    for material in chosen:
        assert material.strength is not None
        snaps = [
            required.in_closed_form(ground.values, sample.values, run.worst, still, material, safety, sample.label)
            for sample, run in runs
            if run.worst is not None
        ]
        closed.append(max(snaps, key=lambda snap: snap.diameter, default=None))
        load = max(run.peak for _, run in runs)
        fixed.append(tethers.diameter_of(tethers.load_section(load, material.strength, safety)))
    begin = [(m, f if s is None else s.diameter) for m, s, f in zip(chosen, closed, fixed, strict=True)]
    searches = required.search(ground, begin, [sample.values for sample, _ in runs], safety)
    return [
        required.result(one, c, f, length, safety) for one, c, f in zip(searches, closed, fixed, strict=True)
    ]  # fmt: skip


def _mission(options: Options, down: float | None) -> tuple[float, str]:
    if options.mission_time is not None:
        return options.mission_time, "[sizing] mission_time"
    if down is not None:
        return down, "until the scene's thrust has brought the pair down, in closed form"
    return YEAR, "a year: the scene has no thrust that would bring the pair down"


def _net(alone: Alone, found: Study, options: Options, runner: Runner, progress: Progress) -> list[closed_net.Borne]:
    """What threads and target bear of the hardest tug of the scene."""
    values, worst = found.ground.values, found.nominal.worst
    if not found.ground.handed_over or worst is None:
        return []
    zeta = min(values["tether.damping_ratio"], 0.99)
    lasts = snap_duration(stiffness(values), reduced(values), zeta)
    count = closed_net.QUICK_RUNS if options.quick else closed_net.RUNS
    cases = closed_net.cases(alone, worst[1], lasts, count, progress)
    rows = {}
    for row, _ in runner.rows(cases):
        rows[row.key] = row
        progress.count("runs", len(rows), len(cases), f"closed net: {len(rows)} of {len(cases)}")
    return list(closed_net.borne(cases, rows))
