"""A campaign as one page, pictures and tables in it, which opens without a network."""

from __future__ import annotations

import base64
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from dcone_cosim.campaign.answers import Answers
from dcone_cosim.campaign.explained import Explained
from dcone_cosim.campaign.inputs import Inputs, shown
from dcone_cosim.campaign.show import cases
from dcone_cosim.campaign.worst import Worth
from dcone_cosim.units import spoken

PAGE = "report.html"
AT = (0.025, 0.5, 0.975)
"""Where on its distribution a value is told."""


def write(
    title: str,
    said: Sequence[str],
    inputs: Inputs,
    found: Answers,
    spread: Explained,
    worth: Sequence[Worth],
    there: Collection[int],
    pictures: Sequence[tuple[str, str]],
    text: str,
    bounded: bool,
    notes: Sequence[str],
    about: Mapping[str, Any],
    folder: Path,
) -> None:
    """`report.html`, with the pictures that are in the folder.

    there     numbers of those worth looking at that have a page
    text      of the campaign's file
    bounded   whether percentiles have intervals
    """
    from dcone_cosim.reports import pages

    page = pages.render(
        "campaign.html",
        title=title,
        said=said,
        pictures=[(what, base64.b64encode((folder / name).read_bytes()).decode()) for name, what in pictures],
        inputs=[(one.name, [shown(one, one.value(u)) for u in AT]) for one in inputs.inputs],
        at=[f"{100.0 * u:g} %" for u in AT],
        confidence=f"{100.0 * found.confidence:g} %",
        figures=list(_figures(found, bounded)),
        bounded=bounded,
        indices=[(one.figure, one.samples, [_index(index) for index in one.inputs]) for one in spread.indices],
        surrogates=list(_surrogates(spread)),
        worth=worth,
        there=there,
        campaign=text,
        notes=notes,
        about=about,
    )
    (folder / PAGE).write_text(page, encoding="utf-8")


def _figures(found: Answers, bounded: bool) -> Iterator[dict[str, Any]]:
    for name, one in found.figures.items():
        unit = one.shown_in
        read = unit.from_si
        yield {
            "name": name,
            "unit": spoken(unit.name),
            "cases": cases(one.of, one.lacking),
            "mean": f"{read(one.mean):.5g}",
            "spread": f"{read(one.deviation):.3g}",
            "percentiles": [
                (f"{read(p.value):.5g}", " to ".join(_or_none(read(end)) for end in p.interval) if bounded else "")
                for p in one.percentiles
            ],
        }


def _or_none(value: float) -> str:
    return "?" if value != value else f"{value:.5g}"


def _index(one: Any) -> tuple[str, str, str]:
    return one.name, f"{one.first:.2f} ± {one.first_error:.2f}", f"{one.total:.2f} ± {one.total_error:.2f}"


def _surrogates(spread: Explained) -> Iterator[tuple[str, str, str, str]]:
    for name, fitted in spread.surrogates.items():
        for one in fitted:
            kind = f"{one.kind} of degree {one.degree}" if one.degree else one.kind
            yield name, kind, str(one.cases), f"{100.0 * one.error:.1f} %"
