"""Two runs side by side: differences worked out by hand, and nothing told apart that is the same."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path

import pytest

from dcone_cosim.comparing.commands import compare
from dcone_cosim.comparing.pairs import Pair, figures, scene_keys
from dcone_cosim.comparing.show import cells
from dcone_cosim.loading import load
from dcone_cosim.run_reading import read_run
from tests.cosim.conftest import Dcone, dcone
from tests.runs import COARSE, put

__all__ = ["dcone"]


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A mission, the same with another tether from its hand-over on, and one with another shot."""
    place = tmp_path_factory.mktemp("compared")
    put("mission", place / "first", COARSE)
    put(place / "first", place / "thick", ("removal.tether.diameter=2 mm",), go_on="removal")
    put("mission", place / "fast", (*COARSE, "capture.bullets.speed=3.05 m/s"))
    return place


def summary(folder: Path) -> dict[str, dict[str, dict[str, float]]]:
    told: dict[str, dict[str, dict[str, float]]] = json.loads((folder / "summary.json").read_text())
    return told


def test_a_pair() -> None:
    """The difference is the second less the first, and relative to the size of the first."""
    assert (Pair("a", "", -4.0, -3.0, "N").difference, Pair("a", "", -4.0, -3.0, "N").percent) == (1.0, 25.0)
    assert Pair("a", "", 0.0, 2.0).percent is None
    assert Pair("a", "", "flying", "captured").difference is None
    assert Pair("a", "", None, 2.0).difference is None
    assert Pair("a", "", math.nan, math.nan).same
    assert not Pair("a", "", 1.0, math.nextafter(1.0, 2.0)).same
    assert cells(Pair("a", "", -4.0, -3.0, "N")) == ("-4", "-3", "+1", "+25", "N")
    assert cells(Pair("a", "", 4.0, None, "N")) == ("4", "-", "", "", "N")


def test_figures_against_the_summaries(runs: Path) -> None:
    first, second = summary(runs / "first"), summary(runs / "fast")
    found = {pair.name: pair for pair in figures(read_run(runs / "first"), read_run(runs / "fast"))}
    pair = found["capture.recoil"]
    values = [told["capture"]["recoil"]["value"] for told in (first, second)]
    assert (pair.one, pair.other, pair.unit) == (*values, "N s")
    assert pair.percent == pytest.approx(100.0 * (values[1] / values[0] - 1.0))
    assert pair.percent == pytest.approx(100.0 * 0.05 / 3.0, rel=0.05)
    assert pair.scatter == 0.0
    chaotic = first["capture"]["thread.tension_max"], second["capture"]["thread.tension_max"]
    scatter = math.hypot(*(row["value"] * row["spread"] for row in chaotic))
    assert found["capture.thread.tension_max"].scatter == pytest.approx(scatter)
    assert not any(name.endswith(".wall") for name in found)


def test_behind_one_capture_nothing_scatters(runs: Path) -> None:
    """Both tows have the same bits to begin with: their difference is the tether's, and none of the net's chaos."""
    found = compare(runs / "first", runs / "thick")
    assert found.tables["capture"]
    assert not found.tables["removal"]
    assert all(pair.scatter == 0.0 for pair in found.figures)
    assert [pair.name for pair in found.figures if not pair.same and pair.name.startswith("capture")] == []
    assert [(pair.key, pair.one, pair.other) for pair in found.keys] == [("removal.tether.diameter", "1 mm", "2 mm")]


def test_a_run_beside_itself(runs: Path) -> None:
    found = compare(runs / "first", runs / "first")
    assert all(pair.same for pair in found.figures)
    assert found.keys == []
    assert all(found.tables.values())
    assert found.names == (str(runs / "first"), str(runs / "first"))


def test_keys_of_scenes() -> None:
    one, other = load("mission"), load("mission", ["removal.thrust.offset=0.001 N", "capture.net.mesh=1 m"])
    assert [(pair.key, pair.one, pair.other) for pair in scene_keys(one, other)] == [
        ("capture.net.mesh", "0.5 m", "1 m"),
        ("removal.thrust.offset", "-", "0.001 N"),
    ]


def test_the_command(dcone: Dcone, runs: Path, tmp_path: Path) -> None:
    code, out, err = dcone("compare", str(runs / "first"), str(runs / "thick"), "-o", "both")
    assert code == 0, err
    assert "removal.tether.diameter" in out
    assert "tables with the same bits: capture, nodes" in out
    with (tmp_path / "both" / "compare.csv").open(newline="") as file:
        rows = {row["figure"]: row for row in csv.DictReader(file)}
    peak = rows["removal.first_tug_peak"]
    assert float(peak["second"]) - float(peak["first"]) == float(peak["difference"])
    assert peak["unit"] == "N"
    told = json.loads((tmp_path / "both" / "compare.json").read_text())
    assert told["same_tables"]["capture"]
    assert (tmp_path / "both" / "compare.png").read_bytes().startswith(b"\x89PNG")
    code, _, err = dcone("compare", str(runs / "first"), str(runs / "thick"), "-o", "both")
    assert code == 2
    assert "already exists" in err
    code, out, _ = dcone("compare", str(runs / "first"), str(runs / "fast"), "--json")
    assert code == 0
    assert json.loads(out)["scenes"] == [{"key": "capture.bullets.speed", "first": "3 m/s", "second": "3.05 m/s"}]
    code, _, err = dcone("compare", str(runs / "first"), "nowhere")
    assert code == 2
    assert "not the folder of a run" in err
