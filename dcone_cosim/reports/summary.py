"""What a run found, as rows of label, value and unit: printed as a table, and kept for machines."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from dcone_cosim import loads
from dcone_cosim.findings import SAMPLE, Finding
from dcone_cosim.phases import kind_of
from dcone_cosim.reports.warnings import warnings
from dcone_cosim.results import Attained, PhaseResult, RunResult

if TYPE_CHECKING:
    from rich.console import Console


def findings(run: RunResult) -> list[Finding]:
    """All of a run, phase by phase, each after what was handed over to it."""
    rows: list[Finding] = []
    for phase in run.scene.phases:
        name, kind = phase.name, kind_of(phase.name)
        of_phase: list[Finding] = []
        if name in run.handovers:
            of_phase += _with_spreads(run.handovers[name].findings(), kind.handover_spreads())
        if name in run.phases:
            result = run.phases[name]
            of_phase += _with_spreads(kind.findings(run, result), kind.spreads(run, result))
            of_phase += loads.findings(run, name)
            of_phase += _of_accuracy(name, run.attained.get(name), name in run.handovers)
            of_phase += _of_effort(name, result)
        rows += of_phase
    return rows


def _with_spreads(rows: Iterable[Finding], spreads: Mapping[str, float]) -> Iterator[Finding]:
    for row in rows:
        yield row if isinstance(row.value, str) else replace(row, spread=spreads.get(row.key, 0.0))


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


def shown_in(run: RunResult) -> dict[str, str]:
    """Units in which a person reads figures that have one of their own, by PHASE.KEY."""
    return {f"{row.phase}.{row.key}": row.shown_in for row in findings(run) if row.shown_in}


def show(run: RunResult, console: Console) -> None:
    from rich.table import Table
    from rich.text import Text

    title = Text(run.scene.title, style="table.title")
    table = Table(title=title, title_justify="left", show_header=False, box=None, pad_edge=False)
    table.add_column(style="bold")
    table.add_column()
    table.add_column(justify="right")
    for line in loads.headlines(run):
        console.print(Text(line, style="bold red"), highlight=False, soft_wrap=True)
    previous = ""
    rows = findings(run)
    for row in rows:
        table.add_row(row.phase if row.phase != previous else "", Text(row.label), Text(row.shown()))
        previous = row.phase
    console.print(table)
    if any(row.spread for row in rows):
        console.print(f"{SAMPLE} one sample of a chaotic figure, with the digits that hold", highlight=False)


def _share(name: str, key: str, label: str, value: float) -> Finding:
    """An estimate has two digits."""
    return Finding(name, key, label, float(f"{value:.2g}"), shown_in="%")


def _of_accuracy(name: str, attained: Attained | None, taken_over: bool) -> Iterator[Finding]:
    """How it was computed for the accuracy asked, and how exact it is."""
    if attained is None:
        return
    yield _share(name, "accuracy.asked", "accuracy asked", attained.asked)
    yield Finding(name, "accuracy.setting", "computed with", attained.setting)
    given = ", for what was handed over" if taken_over else ""
    yield _share(name, "accuracy.error", f"estimated error, {attained.quantity}{given}", attained.error)
    if attained.scatter > 0.0:
        label = f"scatter of one run, {attained.scattering}"
        yield _share(name, "accuracy.scatter", label, attained.scatter)
    yield Finding(name, "accuracy.made", "runs made for the estimate", attained.made)
    for key, (label, mean, spread, unit) in attained.means.items():
        shown = "" if unit == "1" else unit
        yield Finding(name, f"mean.{key}", f"{label}, mean of {attained.runs} runs", mean, shown)
        yield Finding(name, f"spread.{key}", "their standard deviation", spread, shown)


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
    yield Finding(name, "steps", "communication steps", result.steps)
    yield from _of_coupling(name, result.coupling)
    yield Finding(name, "wall", "time that computing took", result.wall, "s")
