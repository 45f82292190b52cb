"""What a page says of a run in words and tables: the answer first, the loads of each line, all figures, the ledger."""

from __future__ import annotations

import math
import shlex
from collections.abc import Iterator, Mapping
from typing import Any

from dcone_cosim import loads
from dcone_cosim.cases.rows import CLOCK
from dcone_cosim.contract import FAILED_OUTCOMES
from dcone_cosim.findings import SAMPLE, Finding, digits
from dcone_cosim.phases import kind_of
from dcone_cosim.reports import summary
from dcone_cosim.results import RunResult

CHIEF = (
    ("outcome", "capture"),
    ("t_capture", "captured at"),
    ("lasted", "did the catch last"),
    ("first_tug", "first tug"),
    ("first_tug_peak", "its peak"),
    ("largest_tug_peak", "largest tug"),
    ("lowered", "orbit lowered by"),
)
"""Figures that are told at the top of a page, as far as a run has them."""
DIAMETERS = (0.5, 1.0, 1.5, 2.0, 3.0)
"""Shares of the line's diameter for which a tug is reckoned anew."""


def cells(row: Finding) -> tuple[str, str]:
    """A figure and its unit, apart; a text has none."""
    shown, unit = row.shown(), "" if isinstance(row.value, str) else row.shown_in or row.unit
    return (shown.removesuffix(f" {unit}") if unit else shown), unit


def chief(run: RunResult) -> list[dict[str, str]]:
    """The answer, a few figures: label, value, unit, and when they are counted from."""
    rows = summary.findings(run)
    found = []
    for key, label in CHIEF:
        row = next((one for one in rows if one.key == key), None)
        if row is not None:
            value, unit = cells(row)
            since = (
                kind_of(row.phase).clock(run).partition(",")[0] if row.unit == "s" and row.phase in run.phases else ""
            )
            found.append({"label": label, "value": value, "unit": unit, "since": since})
    found += [tile for load in loads.of_run(run) if (tile := _asked(run, load)) is not None]
    governing = weakest(run)
    if governing is not None:
        margin = digits(governing.margin or 0.0, governing.spread, 3)
        mark = SAMPLE if governing.spread else ""
        text = f"{governing.phase}: {governing.line.label}"
        found.append({"label": "least margin of safety", "value": f"{mark}{margin}", "unit": "", "since": text})
    return found


def _asked(run: RunResult, load: loads.Load) -> dict[str, str] | None:
    """What a reader asks first of a line: did the net hold, what governs the line of the tow; None of the others."""
    mark = SAMPLE if load.spread else ""
    if load.line.name == "thread":
        lost = run.phases[load.phase].outcome in FAILED_OUTCOMES
        yes = "its threads did" if lost else "yes"
        held = "not known" if load.margin is None else f"{yes}, margin {mark}{digits(load.margin, load.spread, 3)}"
        if load.broke is not None:
            held = f"no: {load.broken} of its threads broke"
        elif load.overloaded:
            held = "no: its threads bore more than they can"
        since = "no strength is told of its threads" if load.margin is None else f"{load.phase}: {load.line.label}"
        return {"label": "did the net hold", "value": held, "unit": "", "since": since}
    if load.line.name == "line":
        value, comma, when = _governing(run, load).partition(", ")
        since = f"{load.phase}: {mark}{digits(load.tension, load.spread, 4)} N{comma}{when}"
        return {"label": "what governs the line", "value": value, "unit": "", "since": since}
    return None


def weakest(run: RunResult) -> loads.Load | None:
    """The line that is nearest to its strength; None where no strength is known."""
    known = [load for load in loads.of_run(run) if load.margin is not None]
    return min(known, key=lambda load: load.margin or 0.0, default=None)


def figures(run: RunResult) -> Iterator[dict[str, Any]]:
    """All figures of the summary, phase by phase."""
    rows = [row for row in summary.findings(run) if row.key not in CLOCK]
    for phase in dict.fromkeys(row.phase for row in rows):
        told = [(row.label, *cells(row), isinstance(row.value, str)) for row in rows if row.phase == phase]
        yield {"phase": phase, "rows": told}


def lines(run: RunResult) -> list[dict[str, Any]]:
    """What each line bore, at which strength, and what that came from; numbers with the digits that hold."""
    return [_line(run, load) for load in loads.of_run(run)]


def _line(run: RunResult, load: loads.Load) -> dict[str, Any]:
    mark = SAMPLE if load.spread else ""

    def shown(value: float | None, by: float = 1.0) -> str:
        return "" if value is None else f"{mark}{digits(value / by, load.spread, 4)}"

    return {
        "phase": load.phase,
        "line": load.line.label,
        "material": loads.made_of(load.scene) or "not named",
        "tension": shown(load.tension),
        "stress": shown(load.stress, 1e6),
        "strain": shown(load.strain, 0.01),
        "strength": "" if load.strength is None else f"{load.strength / 1e6:.4g}",
        "margin": shown(load.margin),
        "by": _governing(run, load),
        "bad": load.overloaded or load.broke is not None,
    }


def _governing(run: RunResult, load: loads.Load) -> str:
    """Which load is the largest of a line."""
    log = run.phases[load.phase].tugs
    if load.line.name != "line":
        return "largest of the phase"
    if log is None or not log.rows:
        return "largest tension of the phase"
    number, (time, peak, _) = max(log.rows.items(), key=lambda item: item[1][1])
    if peak < (1.0 - 1e-9) * load.tension:
        return "largest tension of the phase, not a tug"
    return f"tug {number} of {log.count}, at {time:.6g} s"


def diameters(run: RunResult, folder: str) -> dict[str, Any] | None:
    """What another diameter would do to the tow's line, by closed form; None where it has none, or no tug.

    folder    of the run, as a command names it

        T ~ v sqrt(k m) ~ d,   sigma = T / A ~ 1 / d,   MS = (sigma_max / sigma) - 1

    Valid    the tug is a snap of a line whose preload is small beside it, its speed that of this run
    Source   `orbital.oscillators.damped_snap_peak`: the peak goes with sqrt(k), and k with d^2
    Checked  tests/report/test_told.py
    """
    for load in loads.of_run(run):
        key = load.line.diameter
        given = run.parameters.get(load.phase, {}).get(key)
        log = run.phases[load.phase].tugs
        if load.line.name != "line" or not given or load.stress is None or log is None or not log.rows:
            continue
        rows = [
            {
                "diameter": f"{1e3 * given * share:.4g}",
                "tension": digits(load.tension * share, load.spread, 4),
                "stress": digits(load.stress / share / 1e6, load.spread, 4),
                "margin": "" if load.margin is None else digits((load.margin + 1.0) * share - 1.0, load.spread, 3),
                "own": math.isclose(share, 1.0),
            }
            for share in DIAMETERS
        ]
        command = f'dcone run {folder} --from {load.phase} --set {load.phase}.{key}="{2e3 * given:.4g} mm" -o thicker'
        return {"rows": rows, "command": command, "phase": load.phase, "mark": SAMPLE if load.spread else ""}
    return None


def handovers(run: RunResult) -> Iterator[dict[str, Any]]:
    """The ledger of every hand-over."""
    for name, handover in run.handovers.items():
        rows = [
            {
                "quantity": row.quantity,
                "unit": row.unit,
                "before": f"{row.before:.6g}",
                "after": f"{row.after:.6g}",
                "accounted": f"{row.accounted:.4g}" if row.accounted else "",
                "account": row.account,
                "closure": f"{row.closure:.1e}",
            }
            for row in handover.rows
        ]
        worst = max((row.closure for row in handover.rows), default=math.nan)
        yield {"to": name, "rows": rows, "failure": handover.failure, "worst": f"{worst:.1e}"}


def events(run: RunResult) -> Iterator[dict[str, Any]]:
    """What happened, tugs left out but for the first, by the clock of each phase."""
    for name, result in run.phases.items():
        kind = kind_of(name)
        found = [event for event in kind.events(run, result)]
        tugs = [event for event in found if event.peak == event.peak]
        told = [event for event in found if event not in tugs[1:]]
        rows = [
            (f"{event.time:.6g}", event.what, "" if event.peak != event.peak else f"{event.peak:.4g}") for event in told
        ]
        yield {"phase": name, "clock": kind.clock(run), "rows": rows, "more": max(len(tugs) - 1, 0)}


def trust(run: RunResult) -> list[str]:
    """How exact this run is, and what it was held against, in a sentence each."""
    said = [
        f"{name}: {one.asked:.2g} was asked, {one.setting} has it; estimated error {one.error:.2g}, of {one.quantity}"
        for name, one in run.attained.items()
    ]
    for name, result in run.phases.items():
        recorder = result.recorder
        if len(recorder) and {"energy.remainder", "energy.total"} <= set(recorder.names):
            left, size = abs(float(recorder["energy.remainder"][-1])), float(recorder["energy.total"].max())
            said.append(f"{name}: its energy book leaves {left:.2g} J of {size:.4g} J, the scheme's own error")
    for name, handover in run.handovers.items():
        if handover.rows:
            worst = max(row.closure for row in handover.rows)
            said.append(f"hand-over to the {name}: mass, momentum, angular momentum and energy close to {worst:.0e}")
    return said


def provenance(about: Mapping[str, Any], run: RunResult, folder: str) -> dict[str, Any]:
    """What made the run, and the commands that make it and the page again; `folder` as `diameters` has it."""
    scene = about["scene"]
    settings = [word for setting in about["settings"] for word in ("--set", setting)]
    return {
        "command": f"dcone run {folder}",
        "folder": folder,
        "origin": "" if run.gone_on else shlex.join(["dcone", "run", scene, *settings]),
        "started": about["started"],
        "python": about["python"],
        "platform": about["platform"],
        "packages": about["packages"],
        "scene_sha256": about["scene_sha256"],
        "cpu": " + ".join(f"{result.cpu:.3g} s {phase}" for phase, result in run.phases.items()),
        "fmus": [(phase, *fmu) for phase, told in about["phases"].items() for fmu in fmus_of(told)],
    }


def fmus_of(told: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """File and hash of each FMU of a phase."""
    for fmu in (told.get("fmu"), *(other["fmu"] for other in told.get("components", {}).values())):
        if fmu:
            yield fmu["file"], fmu["sha256"]
