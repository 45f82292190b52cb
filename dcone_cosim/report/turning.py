"""What taking the target for a point does to the first tug: its bound, and what it is beside a body that turns."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from dcone_cosim.errors import DconeError
from dcone_cosim.findings import spoken
from dcone_cosim.level import GROUP, carrying
from dcone_cosim.progress import Progress
from dcone_cosim.report.tiles import spoken_phase
from dcone_cosim.results import PhaseResult, RunResult
from dcone_cosim.resume.begin import Origin
from dcone_cosim.running import run_once
from dcone_cosim.transaction import HandoffRecord

LONGER = 1.5
"""How long the other tow goes on, over the first tug of the run's own [1]."""


@dataclass(frozen=True)
class Pointed:
    """A tow whose target is taken for a point.

    phase          which
    bound_peak     by how much that may change the peak of its first tug at most, and bound_time its time   [1]
    body           as what it was towed beside, "" for not at all;  failure  why not
    time, peak     of the first tug of the run, and other_time, other_peak of that other tow                  [s, N]
    """

    phase: str
    bound_peak: float
    bound_time: float
    time: float
    peak: float
    body: str = ""
    other_time: float = math.nan
    other_peak: float = math.nan
    failure: str = ""

    @property
    def share(self) -> dict[str, float]:
        """By how much the point is off beside the body that turns, by name of the figure [1]; empty: not computed."""
        if not self.body:
            return {}
        found = {"first_tug": self.time / self.other_time, "first_tug_peak": self.peak / self.other_peak}
        return {name: ratio - 1.0 for name, ratio in found.items()}

    @property
    def said(self) -> str:
        """Both in one sentence, each with its name and where it is from."""
        bounds = f"{spoken(100.0 * self.bound_peak, most=2)} % and {spoken(100.0 * self.bound_time, most=2)} %"
        text = (
            f"{spoken_phase(self.phase)}: the target is taken for a point. How far that may at most be off is bounded "
            f"at the hand-over, for the worst way in which the body may turn until the first tug: that tug's peak and "
            f"time by {bounds}. "
        )
        if self.failure:
            return f"{text}How far it is off was not computed: {self.failure}"
        if not self.body:
            return f"{text}How far it is off was not computed for this page"
        off = self.share
        return (
            f"{text}How far it is off was computed for this page, by towing the same hand-over with one that turns "
            f'(body = "{self.body}"): its first tug is {spoken(self.other_peak)} N at {spoken(self.other_time)} s, so '
            f"that the point's peak is {_aside(off['first_tug_peak'], 'high', 'low')} and its time "
            f"{_aside(off['first_tug'], 'late', 'early')}"
        )


def of_run(folder: Path, run: RunResult, progress: Progress | None) -> Pointed | None:
    """Of the first tow of a run that a point was handed over to; None where there is none, or it had no tug.

    progress    is told of what is built and run; None: the other tow is left out

    Checked  tests/report/test_turning.py
    """
    for number, phase in enumerate(run.scene.phases):
        record, result = run.handovers.get(phase.name), run.phases.get(phase.name)
        if not isinstance(record, HandoffRecord) or result is None or number == 0:
            continue
        first = first_tug(result)
        if record.turns or first is None or not math.isfinite(record.bound.largest):
            return None
        found = Pointed(phase.name, record.bound.peak, record.bound.time, *first)
        if progress is None or phase.main.fmu is not None or phase.others:
            return found
        body = carrying(phase.main, run.scene.phases[number - 1].main.terms.get(GROUP, ""))
        try:
            other = _towed(folder, found, body, progress)
        except DconeError as error:
            return Pointed(*_plain(found), failure=str(error).splitlines()[0])
        if other is None:
            return Pointed(*_plain(found), failure=f"as a {body} it has no tug in {LONGER:g} times the time")
        return Pointed(*_plain(found), body, *other)
    return None


def first_tug(result: PhaseResult) -> tuple[float, float] | None:
    """Time [s] and peak [N] of the first tug; None where there is none, or the line is taut from the start."""
    if result.tugs is None or not result.tugs.rows or result.is_taut_from_start:
        return None
    time, peak, _ = result.tugs.rows[min(result.tugs.rows)]
    return time, peak


def _towed(folder: Path, point: Pointed, body: str, progress: Progress) -> tuple[float, float] | None:
    name = point.phase
    settings = [f'{name}.target.body="{body}"', f"{name}.duration={LONGER * point.time!r} s"]
    origin = Origin(folder, name, [*settings, "handoff.compare_without_recoil=false"])
    progress.say(f"towing it as a {body} up to the first tug")
    return first_tug(run_once(origin.scene, progress, origin.begun).result.phases[name])


def _plain(one: Pointed) -> tuple[str, float, float, float, float]:
    return one.phase, one.bound_peak, one.bound_time, one.time, one.peak


def _aside(share: float, above: str, below: str) -> str:
    return f"{spoken(100.0 * abs(share), most=2)} % too {above if share > 0.0 else below}"
