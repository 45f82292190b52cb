"""What a page reckons itself: another diameter, against a run with it; the line that governs; charts of two runs."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from dcone_cosim import loads
from dcone_cosim.commands import run_and_write
from dcone_cosim.comparing.commands import compare, write
from dcone_cosim.comparing.page import together
from dcone_cosim.comparing.show import as_dict
from dcone_cosim.errors import CAPTURE_FAILED, OVERLOADED
from dcone_cosim.findings import spoken
from dcone_cosim.progress import Progress
from dcone_cosim.report import tiles, told
from dcone_cosim.run_reading import read_run
from orbital.oscillators import damped_snap_peak
from tests.report.conftest import Page
from tests.report.test_packing import decoded
from tests.runs import COARSE, put


@pytest.fixture(scope="module")
def thick(bare: Path) -> Path:
    return put(bare, bare.parent / "thick", ("removal.tether.diameter=2 mm", "removal.duration=3 h"), go_on="removal")


def number(told: str) -> float:
    """A figure of a page that is one sample."""
    return float(told.removeprefix("~"))


def test_another_diameter_by_closed_form_and_by_a_run_with_it(bare: Path, thick: Path) -> None:
    """Of one tug: the first, which both runs begin with at one speed."""
    reckoned = told.diameters(read_run(bare), "./bare")
    assert reckoned is not None
    one, two = (next(row for row in reckoned["rows"] if row["diameter"] == d) for d in ("1", "2"))
    stiffness = 60e9 * np.pi / 4.0 * 1e-6 / 14.0
    peaks = [damped_snap_peak(0.02, k, 600.0, 0.05) for k in (stiffness, 4.0 * stiffness)]
    assert number(two["tension"]) / number(one["tension"]) == pytest.approx(peaks[1] / peaks[0], rel=1e-3)
    assert number(two["stress"]) / number(one["stress"]) == pytest.approx(0.5, rel=1e-3)
    assert number(two["margin"]) + 1.0 == pytest.approx(2.0 * (number(one["margin"]) + 1.0), rel=5e-3)
    first = [pd.read_parquet(run / "tugs.parquet")["peak"][0] for run in (bare, thick)]
    assert first[1] / first[0] == pytest.approx(2.0, rel=5e-3)


def test_the_line_with_the_least_margin_governs(bare: Path) -> None:
    run = read_run(bare)
    margins = {load.line.name: load.margin for load in loads.of_run(run)}
    weakest = tiles.weakest(run)
    assert weakest is not None
    assert weakest.line.name == min(margins, key=lambda name: margins[name])
    tile = tiles.chief(run)[-1]
    assert tile["since"].startswith(f"{weakest.line.label}, {weakest.phase}")


def test_what_a_reader_asks_first_stands_at_the_top(bare: Path, tmp_path: Path) -> None:
    """What governs the line, from the table of its tugs; whether the net held, of threads strong and weak."""
    shown = {tile["label"]: tile for tile in tiles.chief(read_run(bare))}
    tugs = pd.read_parquet(bare / "tugs.parquet")
    hardest = tugs.loc[tugs["peak"].idxmax()]
    tile = shown["hardest on the tether"]
    assert tile["value"] == f"tug {hardest['tug']:.0f} of {len(tugs)}"
    assert tile["since"].startswith(f"~{hardest['peak']:.4g} N, at {spoken(hardest['time'])} s; margin ~")
    assert shown["did the net hold"]["value"] == "yes"
    assert re.fullmatch(
        r"in the ~?[\d.]+ s of the capture; margin ~\d+ of a thread of the net, ~\d+ of the closing cord",
        shown["did the net hold"]["since"],
    )
    settings = (*COARSE, "capture.net.strength=1 MPa")
    weak = run_and_write("mission", tmp_path / "weak", Progress(), with_figures=False, settings=settings)
    assert weak.result.exit_code == OVERLOADED
    (tile,) = [one for one in tiles.chief(read_run(weak.folder)) if one["label"] == "did the net hold"]
    assert tile["value"] == "no: a thread of the net would have broken"
    missed = read_run(bare)
    missed.phases["capture"].outcome = "missed"
    (tile,) = [one for one in tiles.chief(missed) if one["label"] == "did the net hold"]
    assert tile["value"] == "nothing of it broke"
    assert "; margin ~" in tile["since"]


def test_the_tiles_of_a_run_do_not_contradict_one_another(bare: Path) -> None:
    """A cord that bore more than it can is named, however strong the threads; no margin below 0 is beside a yes."""
    run = read_run(bare)
    own = tiles.chief(run)
    assert [one for one in own if one["value"] == "yes"]
    assert tiles.badges(run) == ["completed"]
    main = run.scene.phases[0].main
    cord = replace(main.lines["closing"], strength=1e4)
    weak = replace(main, lines={**main.lines, "closing": cord})
    run.scene = run.scene.with_phase(replace(run.scene.phases[0], main=weak))
    run.fail("capture failed", "slipped off", CAPTURE_FAILED)
    shown = {tile["label"]: tile for tile in tiles.chief(run)}
    assert shown["did the net hold"]["value"] == "no: the closing cord would have broken"
    assert shown["least margin of safety"]["value"].startswith("~\N{NO-BREAK SPACE}-")
    assert shown["least margin of safety"]["since"].startswith("the closing cord, capture")
    assert tiles.badges(run) == ["capture failed", "overloaded"]
    assert any(one.startswith("OVERLOADED: capture: the closing cord") for one in tiles.said(run))
    row = next(row for row in told.lines(run) if row["line"] == "the closing cord")
    assert row["bad"]
    assert row["margin"].endswith(": breaks")


def test_a_figure_is_rounded_in_one_way_all_over_a_page(kept: Path, page: Page) -> None:
    """The largest tug on its tile, in the table of loads, among all figures, and for the page's own model."""
    tugs = pd.read_parquet(kept / "tugs.parquet")
    largest = spoken(tugs["peak"].max(), 3e-4)
    assert largest.startswith("~")
    tile = next(tile for tile in tiles.chief(read_run(kept)) if tile["label"] == "largest tug, peak")
    assert tile["value"] == largest
    assert page.row("removal: the tether")[1] == largest
    assert page.row("largest tug, peak")[1] == largest
    margin = page.row("removal: the tether")[2]
    assert page.row("margin of safety of the tether (factor 1)")[1] == margin
    hardest = next(tile for tile in tiles.chief(read_run(kept)) if tile["label"] == "hardest on the tether")
    assert hardest["since"].endswith(f"margin {margin}")


@pytest.mark.parametrize(
    ("value", "spread", "shown"),
    [
        (23.828, 9e-5, "~23.83"), (38.4957, 3e-4, "~38.50"), (61.47, 0.31, "~60"), (8.78, 0.05, "~8.8"),
        (-0.1068, 1.4, "~\N{NO-BREAK SPACE}-0.1"), (86400.0, 0.0, "86,400"), (360155.0, 0.0, "360,200"),
        (5.74155e-6, 0.0, "5.742 · 10⁻⁶"),
        (3.15576e7, 0.0, "3.156 · 10⁷"), (999.96, 0.0, "1000"), (0.0, 0.3, "0"), (12718.0, 0.0, "12,720"),
        (float("nan"), 0.0, "not known"), (14.0, 0.0, "14"), (100.0, 0.0, "100"), (123456.0, 0.3, "~120,000"),
    ],
)  # fmt: skip
def test_a_number_as_a_page_has_it(value: float, spread: float, shown: str) -> None:
    assert spoken(value, spread) == shown


def test_histories_of_two_runs_stand_on_one_clock(bare: Path, thick: Path, tmp_path: Path) -> None:
    """The first lasts half an hour and counts minutes, the second three hours and would count hours."""
    found = compare(bare, thick)
    charts = {chart.key: chart for _, chart in together(found)}
    tension = charts["tension"]
    assert tension.x_unit == "min"
    own, other = tension.series[:2]
    assert (own.x[-1], other.x[-1]) == pytest.approx((30.0, 180.0))
    assert (own.hue, other.hue, other.faint) == (0, 0, True)
    page = Page((write(found, tmp_path / "both", as_dict(found)) / "report.html").read_text())
    assert page.row("removal.tether.diameter") == ["removal.tether.diameter", "1 mm", "2 mm"]
    row = page.row("removal: first tug, peak")
    values = [
        json.loads((run / "summary.json").read_text())["removal"]["first_tug_peak"]["value"] for run in (bare, thick)
    ]
    assert [float(cell.strip("~").split(" ")[0]) for cell in row[1:4]] == pytest.approx(
        [*values, values[1] - values[0]], rel=1e-3
    )
    shown = next(chart for chart in page.data["charts"] if chart["key"] == "removal-distance")
    assert decoded(shown["series"][1]["x"])[-1] == pytest.approx(180.0)
    assert "dcone compare" in page.text
