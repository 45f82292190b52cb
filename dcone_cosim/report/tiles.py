"""The answer at the top of a page, and on a card of the index: a few figures, of which none contradicts another."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from types import MappingProxyType

import numpy as np

from dcone_cosim import loads
from dcone_cosim.contract import FAILED_OUTCOMES, FLOWN
from dcone_cosim.findings import Finding, spoken
from dcone_cosim.phases import kind_of
from dcone_cosim.plots.style import time_axis
from dcone_cosim.report.knobs import THRUST, signed
from dcone_cosim.reports import summary
from dcone_cosim.results import RunResult

CHIEF = ("outcome", "t_capture", "lasted", "pull_off", "first_tug", "first_tug_peak", "largest_tug_peak", "lowered")
"""Figures that are told at the top of a page, as far as a run has them."""
LABELS = {"outcome": "capture", "first_tug": "first tug"}
"""What they are called there, where that is not their label in the summary."""
OUTCOMES = {
    "flying": "not captured: still flying at the end",
    FLOWN: "flown to the end of its time, as the scene asks",
    "ended": "ended by its FMU",
}
"""Outcomes of a capture that need more words than their names."""
BOUNDS = {"first_tug": "point_bound_time", "first_tug_peak": "point_bound_peak"}
"""What tells how far a target that is taken for a point may be off in a figure."""
ALONG = "lumped.peak_tension"
"""Output that tells the largest tension along a tether that has nodes."""
TETHER = "line"
"""Name of the line of a tow in the table of lines; all others are of a net."""
SHOWN_AS = {"m2": "m²", "m3": "m³"}
"""Units as a page writes them."""
COUNTED = 1000
"""Below which a count that is one sample of many is told in full: half a tug is none."""
MARGIN = "strength over stress, less 1; breaks below 0"
"""What a margin is."""
Tile = dict[str, str]


def cells(row: Finding) -> tuple[str, str]:
    """A figure and its unit, apart; a text has none."""
    if isinstance(row.value, str):
        return row.value, ""
    read = row.read
    unit, value = read.name, read.from_si(row.value)
    if isinstance(row.value, int):
        digits = f"{row.value:,}" if abs(row.value) >= 10000 else str(row.value)
        if not row.spread:
            return digits, unit
        if abs(row.value) < COUNTED:
            return f"~{digits}", unit
    return spoken(value, row.spread), SHOWN_AS.get(unit, unit)


def chief(run: RunResult, pointed: Mapping[str, float] = MappingProxyType({})) -> list[Tile]:
    """The answer: label, value, unit, and in small what it counts from or comes with.

    pointed    by key of a figure, how far a target that is taken for a point is off in it, where that was computed [1]
    """
    rows = summary.findings(run)
    known = {row.key: row for row in rows}
    phases = list(dict.fromkeys(row.phase for row in rows))

    def order(row: Finding) -> tuple[int, int]:
        return phases.index(row.phase), CHIEF.index(row.key) if row.key in CHIEF else 0

    counts = Counter(row.key for row in rows)
    found = [
        _tile(run, row, known, counts[row.key] > 1, pointed) for row in sorted(rows, key=order) if row.key in CHIEF
    ]
    held = [load for load in loads.of_run(run) if load.line.name != TETHER]
    for phase in dict.fromkeys(load.phase for load in held):
        found.append(_held(run, phase, [load for load in held if load.phase == phase]))
    for load in loads.of_run(run):
        if load.line.name == TETHER:
            found.append(_hardest(run, load))
    governing = weakest(run)
    if governing is not None:
        value = spoken(governing.margin or 0.0, governing.margin_spread)
        text = f"{governing.line.label}, {spoken_phase(governing.phase)}"
        found.append({"label": "least margin of safety", "value": value, "unit": "", "since": text, "more": MARGIN})
    return found


def spoken_phase(name: str) -> str:
    """Name of a phase, or of what is told between two, as a page says it."""
    return name.replace("_", " ").replace("hand-off", "hand-over")


def _tile(
    run: RunResult, row: Finding, known: Mapping[str, Finding], several: bool, pointed: Mapping[str, float]
) -> Tile:
    value, unit = cells(row)
    label = LABELS.get(row.key, row.label)
    since = ""
    if row.key == "outcome":
        value = OUTCOMES.get(value, value)
    elif row.key == "lasted":
        value, colon, more = value.partition(": ") if ": " in value else value.partition(", ")
        since = more if colon else ""
    elif row.key == "lowered" and row.phase in run.phases:
        result = run.phases[row.phase]
        divisor, unit_of_time = time_axis(result.end - result.start)
        since = f"in {spoken((result.end - result.start) / divisor)} {unit_of_time}"
    elif row.unit == "s" and row.phase in run.phases:
        since = kind_of(row.phase).clock(run).partition(",")[0]
    bound = known.get(BOUNDS.get(row.key, ""))
    if bound is not None and bound.phase == "hand-off" and _is_point(known):
        share = spoken(100.0 * float(bound.value), most=2)
        off = pointed.get(row.key)
        by = f"at most {share} %" if off is None else f"{spoken(100.0 * abs(off), most=2)} %, bounded by {share} %"
        since += f"{'; ' if since else ''}off by {by}, as the target is a point"
    if several:
        since = f"{spoken_phase(row.phase)}{', ' + since if since else ''}"
    return {"label": label, "value": value, "unit": unit, "since": since}


def _is_point(known: Mapping[str, Finding]) -> bool:
    target = known.get("target")
    return target is not None and target.value == "point"


def _held(run: RunResult, phase: str, held: list[loads.Load]) -> Tile:
    """Whether all of the net held, threads, cord and ropes: the part that did not is named."""
    failed = [load for load in held if load.failed]
    known = [load for load in held if load.margin is not None]
    if failed:
        worst = min(failed, key=lambda load: load.margin if load.margin is not None else 0.0)
        value = "no: " + " and ".join(_broke(load) for load in failed)
        since = f"{worst.line.label} bore {bore(worst)}"
    elif not known:
        value, since = "not known", "no strength is told of its threads"
    else:
        lost = run.phases[phase].outcome in FAILED_OUTCOMES
        value = "nothing of it broke" if lost else "yes"
        told = (f"{spoken(load.margin or 0.0, load.margin_spread)} of {load.line.label}" for load in known)
        unknown = ", ".join(load.line.label for load in held if load.breaks_at is None)
        result = run.phases[phase]
        lasted = result.end - result.start
        spread = next((row.spread for row in summary.findings(run) if row.value == lasted), 0.0)
        since = f"in the {spoken(lasted, spread)} s of the {spoken_phase(phase)}; margin {', '.join(told)}"
        since += f"; not known of {unknown}" if unknown else ""
    return {"label": "did the net hold", "value": value, "unit": "", "since": since}


def _broke(load: loads.Load) -> str:
    if load.broke is not None:
        return f"{load.broken} of its threads broke" if load.line.name == "thread" else f"{load.line.label} broke"
    return f"{load.line.label} would have broken"


def bore(load: loads.Load) -> str:
    """What a line bore, and of how much."""
    of = "" if load.breaks_at is None else f", and breaks at {spoken(load.breaks_at)} N"
    return f"{spoken(load.tension, load.spread)} N{of}"


def _hardest(run: RunResult, load: loads.Load) -> Tile:
    value, comma, when = governing(run, load).partition(", ")
    of = "" if len([one for one in run.phases if kind_of(one).model == kind_of(load.phase).model]) < 2 else ", "
    label = f"hardest on the tether{of}{spoken_phase(load.phase) if of else ''}"
    margin = "" if load.margin is None else f"; margin {spoken(load.margin, load.margin_spread)}"
    since = f"{spoken(load.tension, load.spread)} N{comma}{when}{margin}"
    if load.failed:
        value = f"{'it broke' if load.broke is not None else 'it would have broken'}: {value}"
    return {"label": label, "value": value, "unit": "", "since": since}


def governing(run: RunResult, load: loads.Load) -> str:
    """Which load is the largest of a line."""
    log = run.phases[load.phase].tugs
    if load.line.name != TETHER:
        return "largest of the phase"
    if log is None or not log.rows:
        return "largest tension of the phase"
    number, (time, peak, _) = max(log.rows.items(), key=lambda item: item[1][1])
    recorder = run.phases[load.phase].recorder
    if ALONG in recorder and peak < load.tension:
        at = float(recorder["time"][int(np.argmax(recorder[ALONG]))])
        return f"largest along its nodes, in the step up to {spoken(at)} s"
    if peak < (1.0 - 1e-9) * load.tension:
        return "largest tension of the phase, not a tug"
    taut = run.phases[load.phase].is_taut_from_start
    if taut and number == 1:
        return "taut from the start"
    return f"tug {number - taut} of {log.count - taut}, at {spoken(time)} s"


def weakest(run: RunResult) -> loads.Load | None:
    """The line that is nearest to its strength; None where no strength is known."""
    known = [load for load in loads.of_run(run) if load.margin is not None]
    return min(known, key=lambda load: load.margin or 0.0, default=None)


def badges(run: RunResult) -> list[str]:
    """The status, and beside a capture that failed what its lines bore: "capture failed", "overloaded"."""
    found = [run.status]
    borne = loads.of_run(run)
    if any(load.overloaded for load in borne):
        found.append(loads.STATUS_OVERLOADED)
    if any(load.broke is not None for load in borne):
        found.append(loads.STATUS_BROKEN)
    return list(dict.fromkeys(found))


def said(run: RunResult) -> list[str]:
    """The message of the run, and what is said of its lines beside it."""
    found = [one for one in run.message.split("\n") if one]
    return list(dict.fromkeys([*found, *loads.headlines(run)]))


def inputs(run: RunResult) -> Iterator[tuple[str, str]]:
    """What the run was given, a few of its values: label, and value with unit."""
    for phase in run.scene.phases:
        values = run.parameters.get(phase.name, {})
        for name, label, unit, factor in INPUTS:
            value = values.get(name)
            if value is not None and (value or name == THRUST):
                told = f"{label}, {signed(phase.main.terms)}" if name == THRUST else label
                if name == MASS and phase.name in run.handovers:
                    told = TOGETHER
                yield f"{spoken_phase(phase.name)}: {told}", f"{spoken(value / factor)} {unit}".strip()


MASS, TOGETHER = "target.mass", "mass of target and net together"
"""Parameter of the target's mass, and what it is of a tow that a net was handed over to."""
INPUTS = (
    ("chaser.mass", "mass of the chaser", "kg", 1.0),
    (MASS, "mass of the target", "kg", 1.0),
    ("orbit.altitude", "altitude of the orbit", "km", 1e3),
    ("net.side", "side of the net", "m", 1.0),
    ("net.mesh", "mesh of the net", "m", 1.0),
    ("net.mass", "mass of the net", "kg", 1.0),
    ("bullets.mass", "mass of a bullet", "kg", 1.0),
    ("bullets.speed", "speed of the bullets", "m/s", 1.0),
    (THRUST, "thrust", "N", 1.0),
    ("tether.rest_length", "length of the tether", "m", 1.0),
    ("tether.diameter", "diameter of the tether", "mm", 1e-3),
    ("tether.youngs_modulus", "Young's modulus of the tether", "GPa", 1e9),
    ("tether.damping_ratio", "damping ratio of the tether", "", 1.0),
)
"""Values that a reader asks for first: FMI name, label, unit shown, SI value of that unit."""
