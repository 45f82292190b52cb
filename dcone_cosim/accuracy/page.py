"""The report as one page, pictures and tables in it, which opens without a network."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from dcone_cosim.accuracy import show
from dcone_cosim.accuracy.judge import Report, front, own


def write(reports: Sequence[Report], notes: Sequence[str], about: Mapping[str, Any], folder: Path) -> None:
    """`report.html`, with the pictures that are in the folder."""
    from dcone_cosim.reports import pages

    phases = [_phase(report, folder) for report in reports if report.axes]
    text = pages.render("accuracy.html", title=reports[0].plan.title, phases=phases, notes=notes, about=about)
    (folder / "report.html").write_text(text, encoding="utf-8")


def _phase(report: Report, folder: Path) -> dict[str, Any]:
    picture = folder / f"{report.plan.phase}_accuracy.png"
    return {
        "name": report.plan.phase,
        "sentences": list(show.sentences(report)),
        "picture": base64.b64encode(picture.read_bytes()).decode(),
        "quantities": list(report.quantities.items()),
        "axes": [
            {
                "name": axis.name,
                "points": [
                    {
                        "label": point.setting.label,
                        "best": point in front(own(axis.points)) and axis is report.numerics,
                        "worst": point.sample.failed or show.told(point.worst, point.floor),
                        "errors": [
                            show.percent(point.errors[k]) if k in point.errors else "" for k in report.quantities
                        ],
                        "cpu": show.seconds(point.sample.cpu),
                        "changes": " ".join(f"--set '{change}'" for change in point.setting.changes),
                    }
                    for point in axis.points
                ],
            }
            for axis in report.axes
        ],
    }
