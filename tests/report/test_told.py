"""What a page reckons itself: another diameter, against a run with it; the line that governs; charts of two runs."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from dcone_cosim import loads
from dcone_cosim.commands import run_and_write
from dcone_cosim.comparing.commands import compare, write
from dcone_cosim.comparing.page import together
from dcone_cosim.comparing.show import as_dict
from dcone_cosim.errors import OVERLOADED
from dcone_cosim.progress import Progress
from dcone_cosim.report import told
from dcone_cosim.run_reading import read_run
from orbital.oscillators import damped_snap_peak
from tests.report.conftest import Page
from tests.report.test_packing import decoded
from tests.runs import COARSE, put


@pytest.fixture(scope="module")
def thick(bare: Path) -> Path:
    return put(bare, bare.parent / "thick", ("removal.tether.diameter=2 mm", "removal.duration=3 h"), go_on="removal")


def test_another_diameter_by_closed_form_and_by_a_run_with_it(bare: Path, thick: Path) -> None:
    """Of one tug: the first, which both runs begin with at one speed."""
    reckoned = told.diameters(read_run(bare), "./bare")
    assert reckoned is not None
    one, two = (next(row for row in reckoned["rows"] if row["diameter"] == d) for d in ("1", "2"))
    stiffness = 60e9 * np.pi / 4.0 * 1e-6 / 14.0
    peaks = [damped_snap_peak(0.02, k, 600.0, 0.05) for k in (stiffness, 4.0 * stiffness)]
    assert float(two["tension"]) / float(one["tension"]) == pytest.approx(peaks[1] / peaks[0], rel=1e-3)
    assert float(two["stress"]) / float(one["stress"]) == pytest.approx(0.5, rel=1e-3)
    assert float(two["margin"]) + 1.0 == pytest.approx(2.0 * (float(one["margin"]) + 1.0), rel=5e-3)
    first = [pd.read_parquet(run / "tugs.parquet")["peak"][0] for run in (bare, thick)]
    assert first[1] / first[0] == pytest.approx(2.0, rel=5e-3)


def test_the_line_with_the_least_margin_governs(bare: Path) -> None:
    run = read_run(bare)
    margins = {load.line.name: load.margin for load in loads.of_run(run)}
    weakest = told.weakest(run)
    assert weakest is not None
    assert weakest.line.name == min(margins, key=lambda name: margins[name])
    tile = told.chief(run)[-1]
    assert tile["since"] == f"{weakest.phase}: {weakest.line.label}"


def test_what_a_reader_asks_first_stands_at_the_top(bare: Path, tmp_path: Path) -> None:
    """What governs the line, from the table of its tugs; whether the net held, of threads strong and weak."""
    tiles = {tile["label"]: tile for tile in told.chief(read_run(bare))}
    tugs = pd.read_parquet(bare / "tugs.parquet")
    hardest = tugs.loc[tugs["peak"].idxmax()]
    tile = tiles["what governs the line"]
    assert tile["value"] == f"tug {hardest['tug']:.0f} of {len(tugs)}"
    assert tile["since"] == f"removal: ~{hardest['peak']:.4g} N, at {hardest['time']:.6g} s"
    assert tiles["did the net hold"]["value"].startswith("yes, margin ~")
    assert tiles["did the net hold"]["since"] == "capture: a thread of the net"
    settings = (*COARSE, "capture.net.strength=1 MPa")
    weak = run_and_write("mission", tmp_path / "weak", Progress(), with_figures=False, settings=settings)
    assert weak.result.exit_code == OVERLOADED
    (tile,) = [one for one in told.chief(read_run(weak.folder)) if one["label"] == "did the net hold"]
    assert tile["value"] == "no: its threads bore more than they can"
    missed = read_run(bare)
    missed.phases["capture"].outcome = "missed"
    (tile,) = [one for one in told.chief(missed) if one["label"] == "did the net hold"]
    assert tile["value"].startswith("its threads did, margin ~")


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
    row = page.row("removal: its peak")
    values = [
        json.loads((run / "summary.json").read_text())["removal"]["first_tug_peak"]["value"] for run in (bare, thick)
    ]
    assert [float(cell.strip("~").split(" ")[0]) for cell in row[1:4]] == pytest.approx(
        [*values, values[1] - values[0]], rel=1e-3
    )
    shown = next(chart for chart in page.data["charts"] if chart["key"] == "removal-distance")
    assert decoded(shown["series"][1]["x"])[-1] == pytest.approx(180.0)
    assert "dcone compare" in page.text
