"""Two runs side by side as one page: keys in which their scenes differ, histories of both, every figure."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from dataclasses import replace

from dcone_cosim.comparing.comparison import Comparison
from dcone_cosim.comparing.show import cells
from dcone_cosim.phases import kind_of
from dcone_cosim.report import packing
from dcone_cosim.report.page import packed
from dcone_cosim.reports import pages
from dcone_cosim.scenery import Chart, Series


def text_of(found: Comparison, packages: dict[str, str]) -> str:
    """The page; versions are those that compare, not those that ran."""
    charts = [{**packing.chart(chart), "key": f"{phase}-{chart.key}"} for phase, chart in together(found)]
    rows = [(row.label, row.name, *cells(row)) for row in found.figures if not row.same]
    folders = [str(folder) for folder in found.folders if folder is not None]
    return pages.render(
        "compare.html",
        title=found.title,
        names=found.names,
        titles=[run.scene.title for run in found.runs],
        keys=found.keys,
        rows=rows,
        same=len(found.figures) - len(rows),
        samples=any(row.scatter and not row.same for row in found.figures),
        tables=[name for name, equal in found.tables.items() if equal],
        charts=[{"key": chart["key"], "title": f"{chart['title']}, {chart['phase']}"} for chart in _named(charts)],
        notes=found.notes,
        about={"command": shlex.join(["dcone", "compare", *folders]), "packages": packages},
        **packed({"clips": [], "charts": charts, "colours": []}),
    )


def _named(charts: list[dict[str, object]]) -> Iterator[dict[str, object]]:
    yield from ({**chart, "phase": str(chart["key"]).partition("-")[0].replace("_", " ")} for chart in charts)


def together(found: Comparison) -> Iterator[tuple[str, Chart]]:
    """Charts that both runs have, in one: every curve of the first with that of the second, by the clock of the first.

    Checked  tests/report/test_told.py
    """
    one, other = found.runs
    for name in one.phases:
        if name not in other.phases:
            continue
        kind = kind_of(name)
        seconds = {chart.key: chart for chart in kind.charts(other, other.phases[name])}
        for first in kind.charts(one, one.phases[name]):
            second = seconds.get(first.key)
            if second is None:
                continue
            by = SECONDS[second.x_unit] / SECONDS[first.x_unit]
            own = [row for row in first.series if not row.faint]
            named = {row.name: row for row in second.series}
            series = [
                row for hue, one_of in enumerate(own) for row in _pair(found, one_of, named.get(one_of.name), by, hue)
            ]
            yield name, replace(first, series=series, marks=())


SECONDS = {"s": 1.0, "min": 60.0, "h": 3600.0, "day": 86400.0}
"""Of a unit of time [s]."""


def _pair(found: Comparison, one: Series, other: Series | None, by: float, hue: int) -> Iterator[Series]:
    """A curve of the first run and that of the second, in one colour, the second dashed."""
    yield replace(one, name=f"{one.name}: {found.names[0]}", hue=hue)
    if other is not None:
        yield replace(other, name=f"{other.name}: {found.names[1]}", x=other.x * by, faint=True, hue=hue)
