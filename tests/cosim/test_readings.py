"""In which unit a person reads a figure: one rule, so that a run, tables of many and pages say the same."""

from __future__ import annotations

import io
import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from rich.console import Console

from dcone_cosim import loads
from dcone_cosim.campaign import show as of_campaigns
from dcone_cosim.campaign.answers import distribution
from dcone_cosim.cases import show as of_ensembles
from dcone_cosim.cases.case import Value
from dcone_cosim.cases.rows import Row, of_summary, unit_of
from dcone_cosim.cases.statistics import summarise
from dcone_cosim.cases.table import Entry, columns
from dcone_cosim.cases.work import tell_summary
from dcone_cosim.comparing.pairs import Pair
from dcone_cosim.comparing.show import cells
from dcone_cosim.findings import Finding, reading
from dcone_cosim.report import tiles
from dcone_cosim.reports import summary
from dcone_cosim.units import by_name

FIGURES = {
    "hinge.angle_max": (0.2, "rad", "deg", "11.459 deg"),
    "rate": (0.2, "rad/s", "", "11.459 deg/s"),
    "stress": (3.2e8, "Pa", "MPa", "320 MPa"),
    "speed": (3e-3, "m/s", "mm/s", "3 mm/s"),
    "share": (0.25, "", "%", "25 %"),
    "perigee": (2e5, "m", "km", "200 km"),
    "far": (2e5, "m", "", "200 km"),
    "thick": (2e-3, "m", "", "2 mm"),
    "long": (2.5, "m", "", "2.5 m"),
    "touch": (2e-5, "s", "", "20 \u00b5s"),
    "time": (2.5, "s", "", "2.5 s"),
    "peak": (2.5, "N", "", "2.5 N"),
    "ratio": (2.5, "", "", "2.5"),
}
"""By key: value and unit, its own unit for reading, and how a person reads it."""


def finding(key: str) -> Finding:
    value, unit, shown_in, _ = FIGURES[key]
    return Finding("capture", key, key, value, unit, shown_in=shown_in)


def row(factor: float = 1.0) -> Row:
    found = [finding(key) for key in FIGURES]
    told = {one.key: {"value": factor * one.value, "unit": one.unit or "1"} for one in found}  # type: ignore[operator]
    shown_in = {f"capture.{one.key}": one.shown_in for one in found if one.shown_in}
    summary = {"status": "completed", "exit_code": 0, "message": "", "capture": told}
    return of_summary("k", summary, {}, shown_in)


def printed(show: object, *given: object) -> str:
    out = io.StringIO()
    show(*given, Console(file=out, width=200))  # type: ignore[operator]
    return out.getvalue()


@pytest.mark.parametrize("key", FIGURES)
def test_run_and_page_of_it(key: str) -> None:
    said = FIGURES[key][-1]
    number, _, unit = finding(key).shown().partition(" ")
    assert f"{float(number):.5g} {unit}".rstrip() == said
    number, unit = tiles.cells(finding(key))
    assert (float(f"{float(number):.4g}"), unit) == (float(f"{float(said.split()[0]):.4g}"), said.partition(" ")[2])


@pytest.mark.parametrize("key", FIGURES)
def test_tables_of_many(key: str) -> None:
    """Ensemble, sweep, campaign and comparison, of cases that differ by 1 % from one another and not at all."""
    number, _, unit = FIGURES[key][-1].partition(" ")
    (line,) = (
        one
        for one in printed(of_ensembles.show_ensemble, summarise([row(), row()]), "t").splitlines()
        if one.startswith(f"  {key} ")
    )
    assert line.split()[1:] == [number, *([unit] if unit else [])]
    (column,) = (one for one in columns([Entry(row())]) if one.name == f"capture.{key}")
    assert f"{column.read_at(0):.5g} {column.read.name}".rstrip() == FIGURES[key][-1]
    assert column.values == [FIGURES[key][0]], "the table for machines stays SI"
    one = distribution([FIGURES[key][0]] * 2, *told(key), 0.95)
    one = replace(one, own_unit=FIGURES[key][2])
    table = {"capture.one": of_campaigns._distribution(one) | {"standard_deviation": 1.0}}
    _, line = printed(of_campaigns.show, "t", [], table).splitlines()[1:]
    assert line.startswith(f"capture.one [{unit}] " if unit else "capture.one  ")
    assert f" {float(number):.4g} " in line
    value = FIGURES[key][0]
    pair = Pair("capture.one", "one", value, 1.5 * value, FIGURES[key][1], 0.0, FIGURES[key][2])
    assert (float(f"{float(cells(pair)[0]):.5g}"), cells(pair)[-1]) == (float(number), unit)


def told(key: str) -> tuple[str, int]:
    return FIGURES[key][1] or "1", 0


def test_a_sweep_names_it() -> None:
    """One unit for a column, that of the largest."""
    entries = [Entry(row(factor), {"a": Value(str(factor), factor, "1")}) for factor in (1.0, 2.0)]
    chosen = [one for one in columns(entries) if one.name == "capture.hinge.angle_max"]
    out = printed(of_ensembles.show_sweep, entries, [*columns(entries)[:2], *chosen], "t")
    assert "[deg]" in out
    assert "11.4592" in out
    assert "22.9183" in out


def test_one_rule_of_the_size_of_all() -> None:
    assert reading("m", "", 9.99e-3).name == "mm"
    assert reading("m", "", -9.99e-3).name == "mm"
    assert reading("m", "", 1.01e-2).name == "m"
    assert reading("m", "", 9999.0).name == "m"
    assert reading("m", "", 1e4).name == "km"
    assert reading("m", "", 0.0).name == reading("m").name == "m"
    assert reading("s", "", 1e-3).name == "s"
    assert reading("rad", "", math.nan).from_si(math.pi) == 180.0


def test_units_that_a_person_reads_are_those_of_all_units() -> None:
    for key, (value, unit, shown_in, _) in FIGURES.items():
        read = reading(unit, shown_in, value)
        assert by_name(read.name).from_si(value) == pytest.approx(read.from_si(value), rel=1e-12), key


def test_a_row_of_before_is_read_by_its_unit() -> None:
    """Stored without one of its own."""
    old = Row.from_text('{"key": "k", "status": "completed", "figures": {"a.b": 0.2}, "units": {"a.b": "rad"}}')
    assert unit_of([old], "a.b") == ("rad", "")
    assert summarise([old]).figures["a.b"].read.name == "deg"
    assert unit_of([Row("k", "lost"), row()], "capture.speed") == ("m/s", "mm/s")


def test_a_case_carries_the_units_of_its_summary(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(summary, "findings", lambda run: [finding(key) for key in FIGURES])
    monkeypatch.setattr(summary, "warnings", lambda run: [])
    monkeypatch.setattr(loads, "judge", lambda run: None)
    scene = SimpleNamespace(name="s", title="t")
    run: Any = SimpleNamespace(scene=scene, status="completed", message="", exit_code=0)
    case: Any = SimpleNamespace(key="k")
    made = tell_summary(case, run, {})
    assert made.shown_in == row().shown_in
    assert made.figures == row().figures
