"""The parts of the report of a sizing: each number with its unit, what it is for, and the run or source that made
it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from dcone_cosim.sizing.chaser import Asked
from dcone_cosim.sizing.flux import YEAR
from dcone_cosim.sizing.ground import Found
from dcone_cosim.sizing.region import LASTS
from dcone_cosim.sizing.section import ROW, Head, Section, text
from dcone_cosim.sizing.sensitivity import REACH
from dcone_cosim.sizing.spectrum import by_size, cycle_classes, cycles, turning_points
from dcone_cosim.sizing.study import Study
from orbital.materials import margin_of_safety
from orbital.tethers import DASHPOT_GOVERNS

PICTURES = {"loads": "loads.png", "spectrum": "spectrum.png", "required": "required.png"}
PICTURES |= {"sensitivities": "sensitivities.png", "region": "region.png"}
SHOWN = 12
"""Runs of the table of loads that are shown to a reader; the file has all."""


def sections(study: Study) -> list[Section]:
    """All parts, in the order in which a designer asks."""
    found = [
        _loads(study),
        _required(study),
        _governs(study),
        _tugs(study),
        _spectrum(study),
        _rainflow(study),
        _ranges(study),
        _slopes(study),
        _region(study),
        _net(study),
        _asked(
            "reel", "What the reel has to do", "Size drum, brake and motor by these, the largest of all runs.",
            study.reel,
        ),
        _asked(
            "attitude", "What the pull asks of the chaser's attitude control",
            "A line that pulls beside the centre of mass turns the chaser. Size wheels and thrusters by these, or move "
            "the line.", study.attitude,
        ),
        _ways(study),
    ]  # fmt: skip
    return [one for one in found if one.rows]


def headline(study: Study) -> list[str]:
    """The answer in sentences."""
    sample, worst = study.worst
    own = study.needed[0]
    factor = study.options.factor_of_safety
    whose = "given" if "factor_of_safety" in study.options.told else "by default"
    line = 1e3 * study.ground.values["tether.diameter"]
    margin = margin_of_safety(study.breaking, worst.peak, factor)
    said = [
        f"peak tension {study.nominal.peak:.4g} N in the scene as it is; {worst.peak:.4g} N at most over "
        f"{len(study.all)} "
        f"runs of what is uncertain ({sample.label})",
        f"sustained tension {study.steady:.4g} N, without tugs",
        f"the scene's line, {line:.4g} mm of {_name(study.chief)}, breaks at {study.breaking:.4g} N: margin of safety "
        f"{margin:+.3g} with a factor of safety of {factor:g} ({whose}) on the highest tension"
        + (": TOO WEAK" if margin < 0.0 else ""),
    ]
    governing = study.demands[0]
    if math.isfinite(own.diameter):
        said.append(
            f"its peak asks for {1e3 * own.diameter:.4g} mm of {_name(own.material)} ({own.mass:.3g} kg), at the "
            f"fixed point, by "
            f"simulation; {1e3 * own.closed:.4g} mm in closed form"
        )
    said.append(
        f"{governing.load} governs: {1e3 * governing.diameter:.4g} mm ({governing.how})"
        if math.isfinite(governing.diameter)
        else "no load governs"
    )
    said += _about_damping(study)
    return said


def _about_damping(study: Study) -> Iterator[str]:
    zeta = study.ground.values["tether.damping_ratio"]
    if zeta == 0.0:
        yield "the scene has no damping: its tugs never die out, and its peaks are bounds, not predictions"
    else:
        yield f"without damping the peak would be {study.bound.peak:.4g} N: a bound, not a prediction"
    if zeta >= DASHPOT_GOVERNS:
        yield (
            f"with a damping ratio of {zeta:g}, above {DASHPOT_GOVERNS:g}, the largest tension is the dashpot's jump "
            f"as the "
            "line goes taut: that is the model's, which damps by the rate of stretch, and no line's"
        )


def _name(material: object) -> str:
    name, form = getattr(material, "name", ""), getattr(material, "form", "")
    return f"{name} {form}".strip()


def _loads(study: Study) -> Section:
    factor = study.options.factor_of_safety
    runs: list[tuple[str, Found]] = [(sample.label, run) for sample, run in study.all]
    first, rest = runs[0], sorted(runs[1:], key=lambda one: -one[1].peak)
    rows = [
        (
            label, run.peak, run.figure("tension_mean"), run.figure("tension_largest"), len(run.tugs),
            run.worst[2] if run.worst else None, margin_of_safety(study.breaking, run.peak, factor),
        )
        for label, run in (first, ("without damping, a bound", study.bound), *rest)
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
        "is a run; the margin is that of the scene's own line, strength over (factor of safety x peak) less one."
    )
    return Section("loads", "Loads of the line", purpose, heads, rows, PICTURES["loads"])


def _required(study: Study) -> Section:
    rows = [
        (
            _name(one.material), one.material.youngs_modulus, one.material.strength, one.closed, one.diameter, one.mass,
            one.peak, one.margin, one.fixed, one.note or f"{one.runs} diameters tried",
        )
        for one in study.needed
    ]  # fmt: skip
    heads = (
        text("material", "material"), Head("youngs_modulus", "E", "Pa", "GPa"),
        Head("strength", "strength", "Pa", "GPa"),
        Head("closed", "diameter, closed form", "m", "mm"), Head("diameter", "diameter, simulated", "m", "mm"),
        Head("mass", "mass of the line", "kg"), Head("peak", "peak at that diameter", "N"),
        Head("margin", "margin left"),
        Head("fixed", "from the scene's peak (wrong)", "m", "mm"), text("note", "how"),
    )  # fmt: skip
    factor = study.options.factor_of_safety
    purpose = (
        f"The least diameter whose strength is {factor:g} times the peak tension of a line of that diameter. A "
        f"thicker line is "
        "stiffer and snaps harder, so it is a fixed point: A = F^2 g^2 v^2 E m / (l sigma^2) + 2 F P / sigma in "
        "closed form, "
        f"and by simulation with the scene as it is and its {min(3, len(study.made))} hardest neighbours, verified "
        f"by the run "
        "at that diameter, whose margin is told. The column marked wrong takes the peak of the scene's own line for "
        "that of "
        "any other. Diameters are of a solid round; a braid's figures count its gaps."
    )
    section = Section("required", "Required line", purpose, heads, rows, PICTURES["required"])
    sources = {f"{_name(one.material)}: {src}" for one in study.needed[:1] for src in one.material.sources.values()}
    section.said = sorted(sources)
    return section


def _governs(study: Study) -> Section:
    options = study.options
    rows = [(one.load, one.size if math.isfinite(one.size) else None, one.diameter, one.how) for one in study.demands]
    heads = (
        text("load", "load"), Head("size", "size", "N"), Head("diameter", "diameter it asks for", "m", "mm"),
        text("how", "how"),
    )  # fmt: skip
    purpose = (
        f"What each load by itself asks of a line of {_name(study.chief)}; the largest governs. The line is out for "
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
        "Whether the simulated peaks can be trusted: each hard tug beside the closed form of a damped snap at its "
        "own speed, under the preload of tide and thrust at its own angle (without damping P + sqrt(P^2 + k m_r v^2))."
    )
    return Section("tugs", "Tugs beside their closed form", purpose, heads, rows)


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
    return Section("sensitivities", "Sensitivities", purpose, heads, rows, PICTURES["sensitivities"])


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
        (f"start {i // 2 + 1}", one.tug, one.drawn, one.thread, one.contact, one.held, one.failure or one.outcome)
        for i, one in enumerate(study.net)
    ]
    heads = (
        text("run", "run"), Head("tug", "tug at the vertex", "N"), Head("drawn", "thread, before it", "N"),
        Head("thread", "thread, in it", "N"), Head("contact", "force on the debris", "N"),
        Head("held", "debris inside, at the end", "1", "%"), text("outcome", "the net is then"),
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
    return Section("disposal", "Bringing it down", purpose, heads, rows)
