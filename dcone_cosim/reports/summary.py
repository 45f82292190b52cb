"""What a run found, as rows of label, value and unit: printed as a table, and kept for machines."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from dcone_cosim.handoff import spin_energy
from dcone_cosim.line import OFFSET, SLACK
from dcone_cosim.master import RunResult
from dcone_cosim.phases import PhaseResult
from dcone_cosim.reports import chaos
from dcone_cosim.reports.tension import last_orbit, orbital_period
from dcone_cosim.reports.warnings import approach, warnings
from dcone_cosim.transaction import HandoffRecord

if TYPE_CHECKING:
    from rich.console import Console

DAY = 86400.0


SAMPLE = "~"
"""Before a figure that is one sample of many."""


@dataclass(frozen=True)
class Finding:
    """One line of the summary; `key` is its name for machines, `spread` that of one sample of a chaotic figure [1]."""

    phase: str
    key: str
    label: str
    value: float | int | str
    unit: str = ""
    spread: float = 0.0

    def shown(self) -> str:
        if isinstance(self.value, str):
            return self.value
        whole = isinstance(self.value, int) and not self.spread
        number = f"{self.value:d}" if whole else chaos.digits(self.value, self.spread)
        return f"{SAMPLE if self.spread else ''}{number} {self.unit}".rstrip()


def findings(run: RunResult) -> list[Finding]:
    rows: list[Finding] = []
    for name, result in run.phases.items():
        if name == "removal" and run.handoff is not None:
            rows += _of_handoff(run, run.handoff)
        of_phase = {"capture": _of_capture, "removal": _of_removal}.get(name, _of_plain)
        rows += of_phase(run, result)
        rows += _of_effort(name, result)
    if run.handoff is not None and "removal" not in run.phases:
        rows += _of_handoff(run, run.handoff)
    of = chaos.spreads(run)
    return [
        row if isinstance(row.value, str) else replace(row, spread=of.get((row.phase, row.key), 0.0)) for row in rows
    ]


def as_dict(run: RunResult) -> dict[str, Any]:
    """For machines: `{phase: {key: {value, unit}}}` beside the status; a text has no unit, a pure number the unit 1.

    Values have all their digits. `one_sample` says that they do not hold, and `spread` how far, relative to the value.
    """
    content: dict[str, Any] = {
        "scene": run.scene.name,
        "title": run.scene.title,
        "status": run.status,
        "message": run.message,
        "exit_code": run.exit_code,
        "warnings": warnings(run),
    }
    for row in findings(run):
        unit = {} if isinstance(row.value, str) else {"unit": row.unit or "1"}
        sample = {"one_sample": True, "spread": row.spread} if row.spread else {}
        content.setdefault(row.phase, {})[row.key] = {"value": row.value, **unit, **sample}
    return content


def show(run: RunResult, console: Console) -> None:
    from rich.table import Table
    from rich.text import Text

    title = Text(run.scene.title, style="table.title")
    table = Table(title=title, title_justify="left", show_header=False, box=None, pad_edge=False)
    table.add_column(style="bold")
    table.add_column()
    table.add_column(justify="right")
    previous = ""
    rows = findings(run)
    for row in rows:
        table.add_row(row.phase if row.phase != previous else "", Text(row.label), Text(row.shown()))
        previous = row.phase
    console.print(table)
    if any(row.spread for row in rows):
        console.print(f"{SAMPLE} one sample of a chaotic figure, with the digits that hold", highlight=False)


_CAPTURE_ROWS = (
    ("contact.first_time", "first touch of the target", "s"),
    ("mouth.t80", "mouth over 80 % of the net's area from", "s"),
    ("mouth.t_max", "mouth widest at", "s"),
    ("mouth.area_max", "largest mouth area", "m2"),
    ("thread.tension_max", "largest tension of a thread", "N"),
    ("cord.tension_max", "largest tension of the closing cord", "N"),
    ("closing.t_start", "winches started at", "s"),
    ("mouth.cord_length", "mouth cord still out at the end", "m"),
    ("mouth.girth", "girth it would have to pass", "m"),
    ("contact.loss", "energy lost in contact", "J"),
    ("closing.work", "work of the winches", "J"),
    ("thread.dissipated", "taken by the threads' dashpots", "J"),
    ("cord.dissipated", "taken by the cord's dashpots", "J"),
    ("energy.remainder", "left over in the energy book", "J"),
    ("tether.paid_out", "tether paid out", "m"),
    ("net.nodes", "nodes of the net", ""),
    ("net.threads", "threads of the net", ""),
)


def _of_capture(run: RunResult, result: PhaseResult) -> Iterator[Finding]:
    last = result.recorder.last() if len(result.recorder) else {}
    yield Finding("capture", "outcome", "outcome", result.outcome.replace("_", " "))
    yield from _of_end("capture", result)
    if result.located is not None:
        yield Finding("capture", "handed_over_at", "hand-over condition met at", result.located, "s")
        yield Finding("capture", "located_by", "found by", result.located_by)
    for name, label, unit in _CAPTURE_ROWS:
        if name in last and not (unit == "s" and last[name] < 0.0):  # an instant that has not come is told as -1
            whole = not unit and math.isfinite(last[name])
            value = int(last[name]) if whole else last[name]
            yield Finding("capture", name, label, value, unit)
    yield from _of_catch(last, result)
    parameters = run.parameters.get("capture", {})
    if "chaser.velocity[1]" in last and "chaser.mass" in parameters:
        recoil = result.recorder.vector("chaser.velocity")[0] - _vector(parameters, "chaser.start_velocity")
        size = float(np.linalg.norm(recoil))
        yield Finding("capture", "recoil", "momentum of the shot", size * parameters["chaser.mass"], "N s")


_CATCH_ROWS = (
    ("t_capture", "captured at", "s"),
    ("enclosure.at_capture", "share of the target inside by then", ""),
    ("mouth.margin_at_capture", "girth less mouth cord by then", "m"),
    ("enclosure.least", "least share inside since", ""),
)


def _of_catch(last: Mapping[str, float], result: PhaseResult) -> Iterator[Finding]:
    """When the target counted as caught, how that looked, and whether it lasted as long as the phase went on."""
    if not last.get("t_capture", -1.0) >= 0.0:
        return
    for name, label, unit in _CATCH_ROWS:
        if name in last:
            yield Finding("capture", name, label, last[name], unit)
    if "t_lost" not in last:
        return
    seen = result.end - result.start - last["t_capture"]
    if last["t_lost"] >= 0.0:
        text = f"no: the target was out again {last['t_lost'] - last['t_capture']:.3g} s later"
    elif seen > 1e-6:
        text = f"yes, for the {seen:.3g} s to the end of the phase"
    else:
        text = "not seen: the phase ends here"
    yield Finding("capture", "lasted", "did it last", text)


def _of_end(phase: str, result: PhaseResult) -> Iterator[Finding]:
    """What is told of a phase that its FMU ended itself."""
    if result.ended_by:
        yield Finding(phase, "ended_at", "the FMU ended at", result.ended_at, "s")
        yield Finding(phase, "ended_by", "it says", result.ended_by)


def _vector(values: dict[str, float], name: str) -> Any:
    return np.array([values.get(f"{name}[{i}]", 0.0) for i in (1, 2, 3)])


def _of_handoff(run: RunResult, record: HandoffRecord) -> Iterator[Finding]:
    handed, spin = record.handed, record.spin
    relative = handed.joint.velocity - handed.chaser.velocity
    distance = handed.joint.position - handed.chaser.position
    dropped, speed = float(np.linalg.norm(handed.joint.spin)), spin.attachment_speed
    yield Finding("hand-off", "time", "after the shot", record.time, "s")
    yield Finding("hand-off", "mass", "target and net", handed.joint.mass, "kg")
    yield Finding("hand-off", "distance", "distance chaser to target", float(np.linalg.norm(distance)), "m")
    yield Finding("hand-off", "relative_speed", "relative speed", 1e3 * float(np.linalg.norm(relative)), "mm/s")
    yield Finding("hand-off", "spin_dropped", "spin dropped (a point target has none)", dropped, "N m s")
    yield Finding("hand-off", "spin_energy_dropped", "energy of the dropped spin", spin_energy(handed.joint), "J")
    yield Finding("hand-off", "attachment_speed", "it moves the tether's end by at most", 1e3 * speed, "mm/s")
    yield Finding("hand-off", "tug_speed", "speed of the first tug, estimated", 1e3 * spin.tug_speed, "mm/s")
    yield from _of_line(record)
    if record.rows:
        worst = max(record.rows, key=lambda row: row.closure)
        yield Finding("hand-off", "ledger_closure", "ledger closes to", worst.closure)
        energy = next(row for row in record.rows if row.quantity == "kinetic energy")
        lost = energy.accounted - spin_energy(handed.joint)
        yield Finding("hand-off", "energy_lost", "energy lost as the net joins", lost, "J")


def _of_line(record: HandoffRecord) -> Iterator[Finding]:
    """Which line was handed over, and what is not as it was."""
    line = record.line
    if line.length is not None:
        yield Finding("hand-off", "line", "line, chaser to net's vertex", line.length, "m")
    yield Finding("hand-off", "attachment_distance", "vertex to centre of mass", line.attachment, "m")
    for row in record.rows:
        if row.quantity == SLACK:
            yield Finding("hand-off", "slack", "slack of the line", row.before, "m")
            yield Finding("hand-off", "slack_after", "slack in the removal", row.after, "m")
        if row.quantity == OFFSET and row.account:
            yield Finding("hand-off", "line_carried", "line", row.account)


MOST_OUTPUTS = 12
"""Outputs of a plain phase that the summary shows; all are in its columns."""


def _of_plain(run: RunResult, result: PhaseResult) -> Iterator[Finding]:
    """A phase that nothing is known of but its outputs."""
    name = next(name for name, its in run.phases.items() if its is result)
    yield Finding(name, "simulated", "simulated", result.end - result.start, "s")
    recorder = result.recorder
    if not len(recorder):
        return
    last = recorder.last()
    for output in [key for key in last if key != "time"][:MOST_OUTPUTS]:
        unit = recorder.units[output]
        yield Finding(name, output, f"{output} at the end", last[output], "" if unit == "1" else unit)


def _of_removal(run: RunResult, result: PhaseResult) -> Iterator[Finding]:
    recorder = result.recorder
    elapsed = result.end - result.start
    # what an FMU went on beyond its last whole step is not recorded
    told = "recorded, in whole steps" if result.ended_by else "simulated"
    yield Finding("removal", "simulated", told, elapsed, "s")
    yield from _of_end("removal", result)
    begin = " the hand-over" if run.handoff is not None else ""
    yield from _of_tugs(result, "", begin)
    if run.comparison is not None:
        yield from _of_tugs(run.comparison, "_without_recoil", begin)
    if not len(recorder):
        return
    yield from _of_tension(result)
    last = recorder.last()
    for name, label, unit, scale in (
        ("separation", "distance at the end", "m", 1.0),
        ("altitude", "altitude at the end", "km", 1e-3),
        ("chaser.propellant", "propellant used", "kg", 1.0),
    ):
        if name in last:
            yield Finding("removal", name, label, scale * last[name], unit)
    yield from _of_approach(result)
    yield from _of_lowering(result)


def _of_tension(result: PhaseResult) -> Iterator[Finding]:
    tension = last_orbit(result)
    if tension is None:
        return
    when, window = (
        ("last orbit", "that orbit, in whole steps") if tension.is_orbit else ("whole phase", "less than an orbit:")
    )
    for what, value in (("mean", tension.mean), ("least", tension.least), ("largest", tension.largest)):
        sampled = " (of rows)" if what in tension.sampled else ""
        told: float | str = "not reported: tugs fall between the rows" if value is None else value
        yield Finding("removal", f"tension_{what}", f"{what} tension, {when}{sampled}", told, "N")
    yield Finding("removal", "tension_window", window, tension.window, "s")


def _of_approach(result: PhaseResult) -> Iterator[Finding]:
    nearest = approach(result)
    if nearest is not None:
        recorded = " recorded" if nearest.recorded else ""
        yield Finding("removal", "approach", f"least distance{recorded}", nearest.distance, "m")
        yield Finding("removal", "approach_time", "that was at", nearest.time, "s")


NEAR = 1e-4
"""Largest distance of the pair over its radius up to which its centre of mass moves as one body does [1]."""


def _of_lowering(result: PhaseResult) -> Iterator[Finding]:
    """How far the semi-major axis of the pair fell, where that is an orbit's.

    Gravity on the pair is not that on its mass at the centre: it differs by (3/2) (s/r)^2 at most, and moves the
    osculating axis by some of that. What is smaller than this is not told, and nothing when the pair is far apart;
    a rate per day needs a whole revolution.
    """
    recorder = result.recorder
    if not {"center.semi_major_axis", "separation", "altitude"} <= set(recorder.names) or len(recorder) < 2:
        return
    axis = recorder["center.semi_major_axis"]
    share = float(np.max(recorder["separation"])) / float(np.min(axis))
    if not 0.0 <= share <= NEAR:
        text = f"not reported: chaser and target are up to {share:.2g} of the orbit's radius apart, more than {NEAR:g}"
        yield Finding("removal", "lowered", "orbit lowered by", text)
        return
    lowered, elapsed = float(axis[0] - axis[-1]), result.end - result.start
    if not abs(lowered) > (3.0 * share**2 + 1e-9) * float(axis[0]):
        yield Finding("removal", "lowered", "orbit lowered by", "too little to tell from the pair's own motion")
        return
    key, rate = ("lowered", "lowering_rate") if lowered > 0.0 else ("raised", "raising_rate")
    yield Finding("removal", key, f"orbit {key} by", abs(lowered), "m")
    if elapsed >= orbital_period(float(axis[0])):
        yield Finding("removal", rate, "that is", abs(lowered) / elapsed * DAY, "m/day")


def _of_tugs(result: PhaseResult, suffix: str, begin: str) -> Iterator[Finding]:
    """Of one removal; `begin` is what its times count from, "" where that needs no word."""
    tugs = result.tugs
    if tugs is None:
        return
    note = " (no recoil)" if suffix else ""
    taut = _is_taut_from_start(result)
    yield Finding("removal", f"tugs{suffix}", f"tugs{note}", tugs.count - taut)
    if taut:
        yield Finding("removal", f"taut_from_start{suffix}", f"line{note}", "taut from the start")
    if tugs.missed:
        label = f"of these not seen: more than {tugs.ring} in one macro step{note}"
        yield Finding("removal", f"tugs_missed{suffix}", label, tugs.missed)
    real = sorted(number for number in tugs.rows if not (taut and number == 1))
    if real:
        time, peak, speed = tugs.rows[real[0]]
        seen, mark = ("_seen", " seen") if real[0] > 1 + taut else ("", "")
        yield Finding("removal", f"first_tug{seen}{suffix}", f"first tug{mark} after{begin}{note}", time, "s")
        yield Finding("removal", f"first_tug{seen}_speed{suffix}", f"its speed{note}", 1e3 * speed, "mm/s")
        yield Finding("removal", f"first_tug{seen}_peak{suffix}", f"its peak{note}", peak, "N")
    recorder = result.recorder
    if tugs.missed and "tether.tension_peak" in recorder:
        largest = float(np.max(recorder["tether.tension_peak"]))
    elif tugs.rows:
        largest = max(peak for _, peak, _ in tugs.rows.values())
    else:
        return
    label = "largest tension" if taut else "largest tug"
    seen, mark = ("_seen", " seen") if tugs.missed and "tether.tension_peak" not in recorder else ("", "")
    yield Finding("removal", f"largest_tug{seen}_peak{suffix}", f"{label}{mark}{note}", largest, "N")


def _is_taut_from_start(result: PhaseResult) -> bool:
    """Whether the line carried tension as the phase began; the FMU counts that as its first tug."""
    recorder = result.recorder
    return "tether.taut" in recorder and len(recorder) > 0 and bool(recorder["tether.taut"][0])


def _of_coupling(name: str, counts: Mapping[str, float]) -> Iterator[Finding]:
    if not counts:
        return
    yield Finding(name, "coupling_steps", "coupling steps", int(counts["steps"]))
    yield Finding(name, "coupling_step_smallest", "shortest coupling step", counts["smallest"], "s")
    yield Finding(name, "coupling_step_largest", "longest coupling step", counts["largest"], "s")
    yield Finding(name, "coupling_rejected", "coupling steps rolled back", int(counts["rejected"]))
    if counts["forced"]:
        yield Finding(name, "coupling_forced", "coupling steps taken beyond the tolerance", int(counts["forced"]))


def _of_effort(name: str, result: PhaseResult) -> Iterator[Finding]:
    yield Finding(name, "steps", "macro steps", result.steps)
    yield from _of_coupling(name, result.coupling)
    yield Finding(name, "wall", "time taken", result.wall, "s")
