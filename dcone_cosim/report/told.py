"""What a page says of a run in words and tables: the answer first, the loads of each line, all figures, the ledger."""

from __future__ import annotations

import math
import shlex
from collections.abc import Iterator, Mapping
from typing import Any

from dcone_cosim import build, loads
from dcone_cosim.cases.rows import CLOCK
from dcone_cosim.findings import spoken
from dcone_cosim.phases import kind_of
from dcone_cosim.report import tiles
from dcone_cosim.reports import summary
from dcone_cosim.results import RunResult

DIAMETERS = (0.5, 1.0, 1.5, 2.0, 3.0)
"""Shares of the line's diameter for which a tug is reckoned anew."""


def figures(run: RunResult) -> Iterator[dict[str, Any]]:
    """All figures of the summary, phase by phase."""
    rows = [row for row in summary.findings(run) if row.key not in CLOCK]
    for phase in dict.fromkeys(row.phase for row in rows):
        told = [(row.label, *tiles.cells(row), isinstance(row.value, str)) for row in rows if row.phase == phase]
        yield {"phase": tiles.spoken_phase(phase), "rows": told}


def lines(run: RunResult) -> list[dict[str, Any]]:
    """What each line bore, at which strength, and what that came from; numbers with the digits that hold."""
    return [_line(run, load) for load in loads.of_run(run)]


def _line(run: RunResult, load: loads.Load) -> dict[str, Any]:
    def shown(value: float | None, spread: float, by: float = 1.0) -> str:
        return "" if value is None else spoken(value / by, spread)

    margin = shown(load.margin, load.margin_spread)
    return {
        "phase": load.phase,
        "line": load.line.label,
        "material": loads.made_of(load.scene) or "not named",
        "tension": shown(load.tension, load.spread),
        "stress": shown(load.stress, load.spread, 1e6),
        "strain": shown(load.strain, load.spread, 0.01),
        "strength": shown(load.strength, 0.0, 1e6),
        "margin": f"{margin}: breaks" if load.failed else margin,
        "by": tiles.governing(run, load),
        "bad": load.failed,
    }


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
                "diameter": spoken(1e3 * given * share),
                "tension": spoken(load.tension * share, load.spread),
                "stress": spoken(load.stress / share / 1e6, load.spread),
                "margin": _margin_at(load, share),
                "own": math.isclose(share, 1.0),
            }
            for share in DIAMETERS
        ]
        command = f'dcone run {folder} --from {load.phase} --set {load.phase}.{key}="{2e3 * given:.4g} mm" -o thicker'
        return {"rows": rows, "command": command, "phase": load.phase}
    return None


def _margin_at(load: loads.Load, share: float) -> str:
    if load.margin is None:
        return ""
    margin = (load.margin + 1.0) * share - 1.0
    spread = load.spread * (1.0 + margin) / abs(margin) if margin else load.spread
    return f"{spoken(margin, spread)}{': breaks' if margin < 0.0 else ''}"


def handovers(run: RunResult) -> Iterator[dict[str, Any]]:
    """The ledger of every hand-over."""
    for name, handover in run.handovers.items():
        rows = [
            {
                "quantity": row.quantity,
                "unit": row.unit,
                "before": spoken(row.before, most=6),
                "after": spoken(row.after, most=6),
                "accounted": spoken(row.accounted) if row.accounted else "",
                "account": row.account,
                "closure": spoken(row.closure, most=2),
            }
            for row in handover.rows
        ]
        worst = max((row.closure for row in handover.rows), default=math.nan)
        left: dict[str, list[str]] = {}
        for row in rows:
            if row["account"]:
                left.setdefault(row["account"], []).append(f"{row['quantity']} {row['accounted']} {row['unit']}")
        yield {"to": name, "rows": rows, "failure": handover.failure, "worst": spoken(worst, most=2), "left": left}


def events(run: RunResult) -> Iterator[dict[str, Any]]:
    """What happened, tugs left out but for the first, by the clock of each phase."""
    spreads = {row.value: row.spread for row in summary.findings(run) if row.spread}
    for name, result in run.phases.items():
        kind = kind_of(name)
        found = [event for event in kind.events(run, result)]
        tugs = [event for event in found if event.peak == event.peak]
        told = [event for event in found if event not in tugs[1:]]
        rows = [
            (
                spoken(event.time, spreads.get(event.time, 0.0)),
                event.what,
                "" if event.peak != event.peak else spoken(event.peak, spreads.get(event.peak, 0.0)),
            )
            for event in told
        ]
        yield {"phase": name, "clock": kind.clock(run).partition(",")[0], "rows": rows, "more": max(len(tugs) - 1, 0)}


def trust(run: RunResult) -> list[str]:
    """How exact this run is, and what it was held against, in a sentence each."""
    said = [
        f"{name}: {one.asked:.2g} was asked, {one.setting} has it; estimated error {one.error:.2g}, of {one.quantity}"
        for name, one in run.attained.items()
    ]
    for name, result in run.phases.items():
        recorder = result.recorder
        if len(recorder) and {"energy.remainder", "energy.kinetic"} <= set(recorder.names):
            left, size = abs(float(recorder["energy.remainder"][-1])), float(build.energy_entered(recorder)[-1])
            said.append(
                f"{name}: its energy book leaves {spoken(left, most=2)} J of {spoken(size)} J open: its scheme's error"
            )
    for name, handover in run.handovers.items():
        if handover.rows:
            worst = max(row.closure for row in handover.rows)
            said.append(
                f"hand-over to the {name}: mass, momenta and energy agree within {spoken(worst, most=1)} of what enters"
            )
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
