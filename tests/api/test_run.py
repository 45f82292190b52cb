"""A run in Python: the same numbers as the command line's, with their units, whether it is fresh or read back."""

from __future__ import annotations

import warnings
from pathlib import Path

import pandas as pd
import pytest
from astropy import units

import dcone_cosim as dc
from dcone_cosim.api.showing import Cell
from dcone_cosim.errors import InputError
from tests.runs import COARSE, put, tables


@pytest.fixture(scope="module")
def scene() -> dc.Scene:
    return dc.Scene("mission", COARSE)


@pytest.fixture(scope="module")
def run(scene: dc.Scene) -> dc.Run:
    return dc.run(scene, save_at="removal:10 min")


@pytest.fixture(scope="module")
def saved(run: dc.Run, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return run.save(tmp_path_factory.mktemp("saved") / "run")


def test_the_numbers_are_those_of_the_command_line(saved: Path, tmp_path: Path) -> None:
    assert tables(saved) == tables(put("mission", tmp_path / "run", COARSE))


def test_columns_know_their_units(run: dc.Run, saved: Path) -> None:
    tension = run["removal"]["tether.tension"]
    assert tension.attrs["units"]["tether.tension"] == "N"
    assert run.unit("removal", "center.semi_major_axis") == "m"
    altitude = run.quantity("removal", "altitude")
    assert altitude[0].to_value(units.km) == pytest.approx(800.0, abs=0.1)
    speed = run.quantity("tugs", "speed")
    assert speed.unit == units.m / units.s
    assert run.quantity("removal", "tether.taut").unit == units.dimensionless_unscaled
    pd.testing.assert_frame_equal(run["removal"], pd.read_parquet(saved / "removal.parquet"))
    assert run["removal"].attrs["units"] == pd.read_parquet(saved / "removal.parquet").attrs["units"]
    with pytest.raises(KeyError, match="did you mean 'removal'"):
        run["remove"]
    with pytest.raises(KeyError, match=r"did you mean 'tether\.tension'"):
        run.unit("removal", "tether.tensoin")


def test_the_summary(run: dc.Run) -> None:
    peak = run.summary["removal.first_tug_peak"]
    assert peak.unit == "N"
    assert float(peak) == run["tugs"]["peak"][0]
    assert peak.quantity == run["tugs"]["peak"][0] * units.N
    assert str(peak).startswith("~")
    assert run.summary.frame().loc["capture.outcome", "value"] == "captured"
    with pytest.raises(KeyError, match="did you mean"):
        run.summary["removal.first_tug_peek"]


def test_the_events(run: dc.Run) -> None:
    events = run.events
    assert events.attrs["units"]["time"] == "s"
    whats = events.groupby("phase")["what"].apply(list)
    assert whats["capture"][0] == "begins"
    assert whats["capture"][-1] == "ends"
    assert {"first touch", "captured", "hand-over condition met"} <= set(whats["capture"])
    tugs = events[events["what"].str.startswith("tug ")]
    assert tugs["time"].tolist() == run["tugs"]["time"].tolist()
    assert tugs["peak"].tolist() == run["tugs"]["peak"].tolist()
    assert events[events["phase"] == "removal"]["time"].is_monotonic_increasing


def test_the_ledger(run: dc.Run) -> None:
    ledger = run.ledger
    assert ledger["closed"].all()
    assert set(ledger["handed_to"]) == {"removal"}
    assert {"mass, all", "kinetic energy"} <= set(ledger["quantity"])


def test_read_back_it_is_the_same(run: dc.Run, saved: Path) -> None:
    again = dc.load_run(saved)
    assert list(again) == list(run)
    for name in run:
        pd.testing.assert_frame_equal(again[name], run[name])
    pd.testing.assert_frame_equal(again.events, run.events)
    pd.testing.assert_frame_equal(again.ledger, run.ledger)
    assert repr(again.summary) == repr(run.summary)
    assert [picture.png for picture in again.figures()] == [picture.png for picture in run.figures()]
    with pytest.raises(InputError, match="not the folder of a run"):
        dc.load_run(saved.parent)


def test_pictures_are_those_of_the_folder(run: dc.Run, saved: Path, tmp_path: Path) -> None:
    pictures = run.figures()
    assert {p.name: p.png for p in pictures} == {p.name: p.read_bytes() for p in saved.glob("*.png")}
    assert pictures["tether_tension"]._repr_png_() == (saved / "tether_tension.png").read_bytes()
    assert pictures["tether_tension"].save(tmp_path / "one.png").read_bytes() == pictures["tether_tension"].png
    assert pictures._repr_html_().count("data:image/png;base64,") == 4
    with pytest.raises(KeyError, match="did you mean 'tether_tension'"):
        pictures["tether_tensions"]


def test_what_a_notebook_shows(run: dc.Run, scene: dc.Scene) -> None:
    for shown in (run._repr_html_(), run.summary._repr_html_(), scene._repr_html_()):
        assert "<table>" in shown
    assert "first tug" in run._repr_html_()


def test_a_place_that_is_taken(run: dc.Run, saved: Path) -> None:
    before = tables(saved)
    with pytest.raises(InputError, match="already exists"):
        run.save(saved)
    assert tables(saved) == before


def test_gone_on(run: dc.Run, saved: Path, scene: dc.Scene) -> None:
    """From the kept state for longer, from the hand-over with another tether; one in no folder has nothing on disk."""
    longer = dc.go_on(saved, "removal:10 min", removal={"duration": "40 min"})
    rows = len(run["removal"])
    pd.testing.assert_frame_equal(longer["removal"][:rows], run["removal"])
    assert len(longer["removal"]) > rows
    other = dc.go_on(saved, "removal", {"removal.tether.diameter": "2 mm"})
    assert float(other.summary["removal.first_tug_peak"]) > 1.5 * float(run.summary["removal.first_tug_peak"])
    with pytest.raises(InputError, match="save it first"):
        dc.go_on(longer, "removal")
    compared = dc.compare(saved, other)
    assert compared.scenes.loc["removal.tether.diameter"].tolist() == ["1 mm", "2 mm"]
    row = compared.figures.loc["removal.first_tug_peak"]
    assert row["difference"] == row["second"] - row["first"]
    assert {"capture", "nodes"} <= set(compared.same_tables)
    assert "removal" not in compared.same_tables
    assert compared.picture().png.startswith(b"\x89PNG")
    assert "2 mm" in compared._repr_html_()


def test_a_run_that_fails_comes_back_with_what_it_reached(scene: dc.Scene) -> None:
    with pytest.warns(UserWarning, match="capture failed"):
        failed = dc.run(scene.with_({"capture.duration": "7 s"}))
    assert not failed.succeeded
    assert list(failed) == ["capture", "nodes"]
    assert failed["capture"]["time"].iloc[-1] == 7.0
    assert "capture failed" in failed._repr_html_()


def test_nobody_is_told_unless_there_is_somebody(scene: dc.Scene, capfd: pytest.CaptureFixture[str]) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        dc.run(scene)
    assert capfd.readouterr() == ("", "")
    dc.run(scene, progress=True)
    assert "removal: 1800 s simulated" in capfd.readouterr().err


def test_progress_in_a_notebook() -> None:
    """A stand-in for IPython's display: one line, written anew, empty at the end."""
    written: list[str] = []

    class Handle:
        def update(self, html: str) -> None:
            written.append(html)

    cell = Cell(lambda html, display_id: Handle(), lambda text: text)
    cell.begin("removal", 0.0, 100.0)
    cell.count("cases", 5, 5, "5 of 5")
    cell.say("<b>")
    cell.close()
    assert written[0] == '<progress value="0.0000"></progress> <code>removal</code>'
    assert written[1].endswith("<code>cases: 5 of 5</code>")
    assert "&lt;b&gt;" in written[2]
    assert written[-1] == ""
