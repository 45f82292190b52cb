"""The parts of the report of a sizing: each number with its unit, what it is for, and the run or source that made
it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from dcone_cosim.sizing.chaser import Asked
from dcone_cosim.sizing.flux import YEAR
from dcone_cosim.sizing.headline import called
from dcone_cosim.sizing.region import LASTS
from dcone_cosim.sizing.section import ROW, Head, Section, text
from dcone_cosim.sizing.sensitivity import REACH
from dcone_cosim.sizing.spectrum import by_size, cycle_classes, cycles, turning_points
from dcone_cosim.sizing.study import Study
from dcone_cosim.sizing.uncertain import Sample
from orbital.materials import margin_of_safety

PICTURES = {"loads": "loads.png", "spectrum": "spectrum.png", "required": "required.png"}
PICTURES |= {"sensitivities": "sensitivities.png", "region": "region.png"}
LOST = 0.02
"""Share of a beam on the debris from which on it is warned of [1]."""
SHOWN = 12
"""Runs of the table of loads that are shown to a reader; the file has all."""


def sections(study: Study) -> list[Section]:
    """All parts, in the order in which a designer asks."""
    found = [
        _asked("inputs", "What is sized", "The tow as the scene has it: what all below follows from.", study.inputs()),
        _loads(study),
        _required(study),
        _closed(study),
        _governs(study),
        _tugs(study),
        _spectrum(study),
        _rainflow(study),
        _ranges(study),
        _slopes(study),
        _region(study),
        _net(study),
        _asked(
            "reel", "What the reel has to do",
            "Size drum, brake and motor by these: the largest of all runs of what is uncertain, force, rate and power "
            "each by itself. A debris that tumbles asks for more: see the admissible region.",
            study.reel,
        ),
        _asked(
            "attitude", "What the pull asks of the chaser's attitude control",
            "A line that pulls beside the centre of mass turns the chaser. Size wheels and thrusters by these, or move "
            "the line. The tug is the hardest of the scene as it is.", study.attitude,
        ),
        _ways(study),
    ]  # fmt: skip
    return [one for one in found if one.rows]


def _loads(study: Study) -> Section:
    factor = study.options.factor_of_safety
    first, *others = study.all
    rest = sorted(others, key=lambda one: -one[1].peak)
    rows = [
        (
            sample.label, run.peak, run.figure("tension_mean"), run.figure("tension_largest"), len(run.tugs),
            run.worst[2] if run.worst else None, margin_of_safety(study.bears(sample), run.peak, factor),
        )
        for sample, run in (first, (Sample("as it is, without damping", {}), study.bound), *rest)
    ]  # fmt: skip
    heads = (
        text("run", "run"), Head("peak", "peak tension", "N"), Head("mean", "mean, last orbit", "N"),
        Head("last", "largest, last orbit", "N"), Head("tugs", "tugs"),
        Head("speed", "speed of the hardest", "m/s", "mm/s"),
        Head("margin", "margin of safety"),
    )  # fmt: skip
    purpose = (
        "Peak and sustained tension of the line: the first sizes it, the last orbit's tell what it holds for "
        "months. Each row "
        "is a run; the margin is that of the line of that run, strength over (factor of safety x peak) less one."
    )
    return Section("loads", "Loads of the line", purpose, heads, rows, PICTURES["loads"])


def _required(study: Study) -> Section:
    rows = [
        (
            called(one.material), one.material.youngs_modulus, one.material.strength, one.closed, one.diameter,
            one.mass, one.peak, one.margin, one.fixed, one.note or f"{one.runs} diameters tried",
        )
        for one in study.needed
    ]  # fmt: skip
    heads = (
        text("material", "material"), Head("youngs_modulus", "E", "Pa", "GPa"),
        Head("strength", "strength", "Pa", "GPa"),
        Head("closed", "diameter, closed form", "m", "mm"), Head("diameter", "diameter, simulated", "m", "mm"),
        Head("mass", "mass of the line", "kg", "g"), Head("peak", "peak at that diameter", "N"),
        Head("margin", "margin left"),
        Head("wrong_from_peak", "from the highest peak at the scene's diameter (wrong)", "m", "mm"),
        text("note", "how"),
    )  # fmt: skip
    factor = study.options.factor_of_safety
    purpose = (
        f"The least diameter whose strength is {factor:g} times the peak tension of a line of that diameter. A "
        f"thicker line is "
        "stiffer and snaps harder, so it is a fixed point: A = (S g v / sigma)^2 E m_r / l + 2 S P / sigma in closed "
        "form, S the factor of safety, g the damped share of a snap, v the speed of the hardest tug, P the tension it "
        "meets, "
        f"and by simulation with the scene as it is and its {min(3, len(study.made))} hardest neighbours, verified "
        f"by the run "
        "at that diameter, whose margin is told. The column marked wrong takes the peak of the scene's own line for "
        "that of any other. Closed form and simulation differ as the bounces do. Diameters are of a solid round; a "
        "braid's figures count its gaps."
    )
    section = Section("required", "Required line", purpose, heads, rows, PICTURES["required"])
    sources = {f"{called(one.material)}: {src}" for one in study.needed[:1] for src in one.material.sources.values()}
    section.said = sorted(sources)
    return section


def _closed(study: Study) -> Section:
    own = next(one for one in study.needed if one.material == study.chief)
    strength = study.chief.strength or math.nan
    told = [] if own.snap is None else own.snap.told(study.options.factor_of_safety, strength)
    return _asked(
        "closed", "Numbers of the closed form",
        f"What the diameter of {called(study.chief)} in closed form is made of, to be worked out again by hand: of the "
        "runs that the line is made for, the one that asks most.", told,
    )  # fmt: skip


def _governs(study: Study) -> Section:
    options = study.options
    rows = [(one.load, one.size if math.isfinite(one.size) else None, one.diameter, one.how) for one in study.demands]
    if study.governing is not None:
        peak, margin = study.governing
        of = min(3, len(study.made))
        left = f"which leaves a margin of {margin:+.3g} with that factor"
        how = f"largest of the scene and its {of} hardest neighbours on that line, {left}"
        rows.append(("run at the diameter that governs", peak, study.demands[0].diameter, how))
    heads = (
        text("load", "load"), Head("size", "size", "N"), Head("diameter", "diameter it asks for", "m", "mm"),
        text("how", "how"),
    )  # fmt: skip
    purpose = (
        f"What each load by itself asks of a line of {called(study.chief)}; the largest governs. The line is out for "
        f"{study.time / YEAR:.3g} years: {study.time_from}."
    )
    section = Section("governs", "Which load governs", purpose, heads, rows)
    flux = options.flux
    diameter, length = study.ground.values["tether.diameter"], study.ground.values["tether.rest_length"]
    cuts = flux.cuts(diameter, length, study.time)
    section.said = [
        f"the scene's own line would be cut with a probability of {-math.expm1(-cuts):.3g} in that time, by "
        f"particles from a "
        f"third of its diameter; flux: {flux.source}"
    ]
    return section


def _tugs(study: Study) -> Section:
    rows = [(one.speed, one.peak, one.formula, one.difference) for one in study.tugs[:SHOWN]]
    heads = (
        Head("speed", "speed at impact", "m/s", "mm/s"), Head("peak", "peak, simulated", "N"),
        Head("formula", "peak, closed form", "N"), Head("difference", "difference", "1", "%"),
    )  # fmt: skip
    purpose = (
        "Whether the integration can be trusted: each hard tug, as they came, beside the closed form of a damped snap "
        "at its own speed, under the preload of tide and thrust at its own angle (without damping "
        "P + sqrt(P^2 + k m_r v^2))."
    )
    part = Section("tugs", "Tugs beside their closed form", purpose, heads, rows)
    if len(study.tugs) > SHOWN:
        part.said = [f"the first {SHOWN} of {len(study.tugs)} hard tugs are shown; soft ones are left out"]
    return part


def _spectrum(study: Study) -> Section:
    peaks = [tug[1] for tug in study.nominal.tugs]
    rows = by_size(peaks, study.nominal.peak) if peaks else []
    heads = (
        Head("from", "peak from", "N"), Head("to", "to", "N"), Head("tugs", "tugs"), Head("above", "as hard or harder"),
    )  # fmt: skip
    purpose = "Tugs of the scene as it is by size: what fatigue, knots and terminals see in its duration."
    section = Section("spectrum", "Load spectrum: tugs by size", purpose, heads, rows, PICTURES["spectrum"])
    if study.nominal.loads["missed"]:
        section.said = [
            f"{study.nominal.loads['missed']} tugs were not seen: more fell in a macro step than the FMU keeps"
        ]
    return section


def _rainflow(study: Study) -> Section:
    rows = cycle_classes(cycles(turning_points(study.nominal.loads)), study.nominal.peak)
    heads = (
        Head("from", "range from", "N"), Head("to", "to", "N"), Head("cycles", "cycles"),
        Head("mean", "their mean", "N"),
    )  # fmt: skip
    purpose = (
        "Cycles by range, counted by rainflow (ASTM E1049-85, package rainflow), for a fatigue curve. Turning points "
        "are slack, the tugs' own peaks, and of a line that stays taut the least and largest tension of every macro "
        "step; what swings more than once in such a step is counted once."
    )
    return Section("rainflow", "Load spectrum: cycles", purpose, heads, rows)


def _ranges(study: Study) -> Section:
    by_label = {sample.label: run for sample, run in study.made}
    rows = []
    for one in study.ranges:
        runs = [by_label.get(f"{one.label} {label}") for label in one.labels]
        peaks = [None if run is None or math.isnan(run.peak) else run.peak for run in runs]
        rows.append((one.label, *one.labels, *peaks, one.why))
    heads = (
        text("what", "value"), text("low", "least"), text("high", "largest"),
        Head("peak_low", "peak at the least", "N"),
        Head("peak_high", "peak at the largest", "N"), text("why", "from"),
    )  # fmt: skip
    count = study.options.samples
    purpose = (
        "How far each value may be off, and the peak at both ends, the others as they are; one run has each at its "
        f"worse end, {count} have all of them at random (Latin hypercube). Give your own ranges in [sizing.ranges] or "
        "with --range."
    )
    return Section("ranges", "What is uncertain", purpose, heads, rows)


def _slopes(study: Study) -> Section:
    rows = [(one.name, one.first, one.first_error, one.largest, one.largest_error) for one in study.slopes]
    heads = (
        text("what", "value"), Head("first", "first tug"), Head("first_error", "+-"), Head("largest", "largest tug"),
        Head("largest_error", "+-"),
    )  # fmt: skip
    purpose = (
        f"d ln peak / d ln x: by how many per cent the peak changes with one per cent of a value, by "
        f"{study.options.steps} runs "
        f"within {100 * REACH:g} % of it, and the standard error of that slope. A pure snap has 1 for the diameter, "
        f"0.5 for E, "
        "-0.5 for the length at the same speed; what makes the pair part faster counts beside. Where the error is "
        "as large as the slope the bounces are near chaos: only the error is known. None is told where a run so near "
        "could not begin."
    )
    part = Section("sensitivities", "Sensitivities", purpose, heads, rows, PICTURES["sensitivities"])
    part.said = [
        f"{name}: the peak falls and rises again over its range, so neither of its ends need be the worst"
        for name in _bent(study)
    ]
    return part


def _bent(study: Study) -> Iterator[str]:
    """Values over whose range the peak goes the other way than where the scene is."""
    by_label = {sample.label: run.peak for sample, run in study.made}
    slopes = {one.name: one for one in study.slopes}
    for one in study.ranges:
        slope = slopes.get(one.label)
        low, high = (by_label.get(f"{one.label} {label}", math.nan) for label in one.labels)
        if slope is not None and abs(slope.largest) > 2.0 * slope.largest_error and slope.largest * (high - low) < 0.0:
            yield one.label


def _region(study: Study) -> Section:
    found = study.region
    rows = [] if found is None else [(p.rate, p.offset, p.thrust, p.peak, p.wrapped, p.verdict) for p in found.points]
    heads = (
        Head("rate", "tumble rate", "rad/s", "deg/s"), Head("offset", "offset", "m"), Head("thrust", "thrust", "N"),
        Head("peak", "peak tension", "N"), Head("wrapped", "line on the debris", "m"), text("verdict", "verdict"),
    )  # fmt: skip
    body, half = ("", 0.0) if found is None else (found.body, found.half_round)
    purpose = (
        "Where the tow may be flown: tumble rate about an axis across the line, offset of the attachment from the "
        f"middle of the face, thrust; of {body}. Admissible: the peak is at most the scene's line's strength over the "
        f"factor of safety, and no more of the line lies on the debris than goes half way round it, {half:.3g} m, "
        f"within {LASTS / 60:g} min."
    )
    return Section("region", "Admissible region", purpose, heads, rows, PICTURES["region"])


def _net(study: Study) -> Section:
    rows = [
        (
            f"start {i // 2 + 1}",
            one.tug,
            one.drawn,
            one.thread,
            one.contact,
            one.slip,
            one.held,
            one.failure or one.outcome,
        )
        for i, one in enumerate(study.net)
    ]
    heads = (
        text("run", "run"), Head("tug", "tug at the vertex", "N"), Head("drawn", "thread, before it", "N"),
        Head("thread", "thread, in it", "N"), Head("contact", "force on the debris", "N"),
        Head("slip", "net slides by", "m"), Head("held", "debris inside, at the end", "1", "%"),
        text("outcome", "the net is then"),
    )  # fmt: skip
    purpose = (
        "What the tow's hardest tug does to threads and debris: the net, just closed, is drawn together by a light "
        "pull and then "
        "pulled by a half-wave of that height; each start once with the pulse and once without. Threads bear "
        "bullets that still "
        "swing as well, so only what a pulse adds is the tug's. The net is chaotic: the spread over the starts is "
        "its own."
    )
    section = Section("net", "From tug to thread", purpose, heads, rows)
    pulled = [one for one in study.net if one.tug > 0.0 and math.isfinite(one.thread)]
    calm = [one for one in study.net if one.tug == 0.0 and math.isfinite(one.thread)]
    if pulled and calm:
        with_it, without = max(one.thread for one in pulled), max(one.thread for one in calm)
        more = "more than" if with_it > without else "no more than"
        section.said = [
            f"threads bear {with_it:.3g} N at most with the pulse of {pulled[0].tug:.3g} N and {without:.3g} N "
            f"without: the tug "
            f"asks {more} what the net's own motion does"
        ]
        before = max(one.drawn for one in (*pulled, *calm))
        if before > with_it:
            section.said.append(
                f"the most that they bear, {before:.3g} N, comes before, while the net is drawn together"
            )
        off = [one for one in pulled if one.outcome not in ("captured", "settled")]
        section.said.append(
            f"in {len(off)} of {len(pulled)} runs the net slips off under the tug"
            if off
            else "the net stays on in every run"
        )
    return section


def _asked(key: str, title: str, purpose: str, found: Sequence[Asked]) -> Section:
    heads = (text("what", "what"), Head("value", "value", ROW), text("unit", "unit"), text("how", "from"))
    rows = [(one.what, one.value, one.unit, one.how) for one in found]
    return Section(key, title, purpose, heads, rows)


def _ways(study: Study) -> Section:
    rows = [
        (
            w.name, w.thrust, w.impulse, w.speed, w.propellant, w.time, w.power if math.isfinite(w.power) else None,
            w.tension, w.beam, w.how,
        )
        for w in study.ways
    ]  # fmt: skip
    heads = (
        text("way", "engine"), Head("thrust", "thrust", "N"), Head("impulse", "Isp", "s"), Head("speed", "dv", "m/s"),
        Head("propellant", "propellant", "kg"), Head("time", "time", "s", "day"), Head("power", "power", "W"),
        Head("tension", "steady tension", "N"), Head("beam", "beam lost on the debris", "1", "%"), text("how", "from"),
    )  # fmt: skip
    purpose = (
        "Electric beside chemical disposal of chaser and debris, in closed form: propellant, time, power, the "
        "tension that the "
        "thrust keeps in the line, and the share of a beam behind the chaser (95 % within 15 deg on a face of 4 m, "
        "unless the "
        "scene says otherwise) that meets the debris at the line's length and pushes it back."
    )
    part = Section("disposal", "Bringing it down", purpose, heads, rows)
    lost = max((way.beam for way in study.ways), default=0.0)
    if lost > LOST:
        part.said = [
            f"[removal.plume] is taken off: {100 * lost:.0f} % of a beam on the debris is lost, and pushes it back"
            if "plume" in study.ground.phase.main.terms
            else f"time, propellant and tension are those of the whole thrust. With {100 * lost:.0f} % of a beam on "
            f"the debris it would take {1.0 / (1.0 - lost):.2g} times as much of the first two: let the chaser lead, "
            "turn its thrusters aside, or name [removal.plume]"
        ]
    return part
