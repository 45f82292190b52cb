"""`dcone size` as a user runs it: what it leaves, what it says, and what it refuses."""

from __future__ import annotations

import json
import re
from html import unescape
from pathlib import Path

import pandas as pd
import pytest

from dcone_cosim.errors import InputError
from dcone_cosim.loading import load
from dcone_cosim.progress import Progress
from dcone_cosim.sizing import commands
from dcone_cosim.sizing.result import Sizing
from tests.cosim.conftest import dcone
from tests.sizing.conftest import SAFETY, SHORT

__all__ = ["dcone"]

PARTS = {
    "inputs",
    *("loads", "required", "governs", "tugs", "spectrum", "rainflow", "ranges", "sensitivities", "region"),
    *("reel", "attitude", "disposal", "closed"),
}
PICTURES = {"loads.png", "spectrum.png", "required.png", "sensitivities.png", "region.png"}


def test_what_it_leaves(done: Sizing) -> None:
    assert done.folder is not None
    assert {p.name for p in done.folder.iterdir()} == {
        *("provenance.json", "rows", "scene.toml", "study.json", "summary.json", "report.html", "table.csv"),
        *("table.parquet", *PICTURES, *(f"{part}.csv" for part in PARTS)),
    }
    assert set(done.keys()) == PARTS
    table = pd.read_parquet(done.folder / "table.parquet")
    assert table.attrs or set(table.columns) == {"part", "row", "quantity", "value", "unit"}
    assert set(table.unit) >= {"N", "m", "kg", "1", "N.m", "Pa"}
    told = json.loads((done.folder / "summary.json").read_text())
    assert told["said"] == done.said
    made = json.loads((done.folder / "provenance.json").read_text())["command"]
    assert made.startswith("dcone size table2-deorbit --set")
    assert "--fos 2.5" in made
    assert "--material Technora" in made


def test_the_page_stands_alone_and_every_column_has_its_unit(done: Sizing) -> None:
    assert done.folder is not None
    page = unescape((done.folder / "report.html").read_text())
    assert "http" not in re.sub(r"base64,[^\"]*", "", page)
    for section in done.sections:
        assert section.title in page
        assert len(section.purpose) > 40, "it says what it is for"
        for head in section.heads:
            assert head.title in page
    assert page.count("data:image/png") == len(PICTURES)


def test_columns_know_their_units(done: Sizing) -> None:
    required = done["required"]
    assert required.attrs["units"]["diameter"] == "m"
    assert list(required.material)[1:] == ["Technora yarn", "Vectran HT braid"]
    assert (required.margin >= 0.0).all()
    assert (required.margin < 0.02).all()


def test_the_answer_tells_factor_and_where_it_comes_from(done: Sizing) -> None:
    said = " ".join(done.said)
    assert f"factor of safety of {SAFETY:g} (given) on the highest tension" in said
    assert "a bound, not a prediction" in said
    assert "governs" in said


def test_the_same_command_goes_on(done: Sizing) -> None:
    """Nothing is run again: the rows are there, and the answer is the same to the last digit."""
    assert done.folder is not None
    before = sorted(p.name for p in (done.folder / "rows").iterdir())
    again = commands.size(
        "table2-deorbit", done.folder, Progress(), SHORT, quick=True, factor_of_safety=SAFETY, samples=2,
        ranges=("removal.thrust.level=-0.012 N..-0.008 N",), materials=("Technora", "Vectran braid"),
    )  # fmt: skip
    assert [one.cells() for one in again.sections] == [one.cells() for one in done.sections]
    assert sorted(p.name for p in (done.folder / "rows").iterdir()) == before


@pytest.mark.parametrize(
    ("name", "more", "said"),
    [
        ("table1-capture", {}, "sizing needs a tow, [removal]"),
        ("table2-deorbit", {"factor_of_safety": 0.5}, "--fos 0.5"),
        ("table2-deorbit", {"samples": -1}, "--samples -1"),
        ("table2-deorbit", {"ranges": ["removal.thrust.level"]}, "--range removal.thrust.level"),
        ("table2-deorbit", {"ranges": ["removal.thrust.lvl=-1 N..1 N"]}, "removal.thrust.lvl"),
        ("table2-deorbit", {"ranges": ["removal.thrust.level=1 m..2 m"]}, "is a length"),
        ("table2-deorbit", {"ranges": ["orbit.altitude=1 km..2 km"]}, "expected a key of [removal]"),
        ("table2-deorbit", {"materials": ["Kevler"]}, "Kevlar 29"),
        ("reel-control", {}, "a line that stretches"),
        ("table2-deorbit", {"settings": ["removal.duration=5 min"]}, "the line is never taut"),
    ],
)
def test_bad_input_leaves_nothing(tmp_path: Path, name: str, more: dict, said: str) -> None:
    with pytest.raises(InputError, match=re.escape(said)):
        commands.size(name, tmp_path / "out", Progress(), quick=True, **more)
    assert not (tmp_path / "out").exists()


def test_a_scene_says_what_it_is_sized_for(tmp_path: Path) -> None:
    text = (
        load("table2-deorbit").text
        + """
[sizing]
factor_of_safety = 3.0
least_breaking_load = "500 N"
mission_time = "2 yr"
flux_sizes = ["0.1 mm", "1 mm"]
flux_values = ["3e-2 /(m2 yr)", "1e-4 /(m2 yr)"]
[sizing.ranges]
"removal.thrust.level" = ["-0.02 N", "-0.005 N"]
"""
    )
    (tmp_path / "mine.toml").write_text(text)
    from dcone_cosim.sizing.options import options_of

    found = options_of(load(str(tmp_path / "mine.toml")))
    assert (found.factor_of_safety, found.least_breaking_load) == (3.0, 500.0)
    assert found.mission_time == pytest.approx(2 * 365.25 * 86400)
    assert found.flux.sizes == [1e-4, 1e-3]
    assert list(found.ranges["removal.thrust.level"]) == ["-0.02 N", "-0.005 N"]
    for wrong, said in (
        ("factor_of_safety = 0.5", "must be at least 1"),
        ('flux_sizes = ["1 mm", "0.1 mm"]', "the least first"),
        ('least_breaking_load = "5 m"', "is a length"),
        ('breaking = "5 N"', "unknown key"),
        ("flux_sizes = []\nflux_values = []", "two or more sizes"),
        ('flux_sizes = ["1 mm"]\nflux_values = ["1 /(m2 yr)"]', "two or more sizes"),
    ):
        (tmp_path / "wrong.toml").write_text(load("table2-deorbit").text + f"\n[sizing]\n{wrong}\n")
        with pytest.raises(InputError, match=said):
            load(str(tmp_path / "wrong.toml"))


def test_one_of_three(dcone) -> None:
    for arguments in ((), ("table2-deorbit", "--paper"), ("--paper", "--debris", "1 t, 4 m")):
        code, _, said = dcone("size", *arguments)
        assert code == 2
        assert "expected one of a SCENE, --debris or --paper" in said


def test_options_that_change_nothing_are_refused(dcone) -> None:
    """Rather than taken without a word."""
    for arguments, idle in (
        (("--debris", "1 t, 4 m", "--samples", "3", "--quick"), "--samples, --quick"),
        (("--debris", "1 t, 4 m", "--set", "removal.duration=1 h"), "--set"),
        (("--paper", "--fos", "3", "--material", "Technora"), "--material, --fos"),
    ):
        code, _, said = dcone("size", *arguments)
        assert code == 2
        assert f"{idle} would change nothing of it" in said
