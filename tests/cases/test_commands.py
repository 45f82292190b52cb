"""`dcone sweep` and `dcone run --ensemble`: what they leave, that they go on, and which codes they end with."""

from __future__ import annotations

import csv
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow.parquet
import pytest

from dcone_cosim.cases import commands
from dcone_cosim.cases.statistics import spread
from dcone_cosim.progress import Bar, Lines, Progress
from dcone_cosim.scratch import PREFIX
from tests.cases.conftest import put_scene
from tests.cosim.conftest import Dcone
from tests.cosim.fmus.build import build

VELOCITY = 'removal.start.relative_velocity=["0 m/s","1 mm/s","0 m/s"],["0 m/s","2 mm/s","0 m/s"]'
LENGTHS = "removal.tether.rest_length=13 m..15 m:3"
GRID = ("--vary", LENGTHS, "--vary", VELOCITY)
ROOT = str(Path(__file__).parents[2])
TABLES = ("table.parquet", "table.csv")


def tables(folder: Path) -> list[bytes]:
    return [(folder / name).read_bytes() for name in TABLES]


@pytest.fixture(scope="module")
def once(template: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sweep of six cases."""
    folder = tmp_path_factory.mktemp("sweep")
    done = commands.sweep(str(put_scene(folder / "scene", template)), GRID[1::2], folder / "out", Progress())
    assert done.exit_code == 0
    return done.folder


@pytest.fixture
def swept(once: Path, tmp_path: Path) -> Path:
    """A copy of it, to be worked on."""
    return shutil.copytree(once, tmp_path / "out")


def test_what_a_sweep_leaves(swept: Path) -> None:
    names = sorted(p.name for p in swept.iterdir())
    assert names == [
        *("fmus", "provenance.json", "rows", "scene.toml", "study.json", "summary.json", "sweep.png"),
        *("table.csv", "table.parquet", "timings.parquet"),
    ]
    table = pd.read_parquet(swept / "table.parquet")
    assert table["removal.tether.rest_length"].tolist() == [13.0, 13.0, 14.0, 14.0, 15.0, 15.0]
    assert table["given.removal.tether.rest_length"].tolist()[::2] == ["13 m", "14 m", "15 m"]
    assert table["given.removal.start.relative_velocity"][1] == '["0 m/s","2 mm/s","0 m/s"]'
    assert table["status"].tolist() == ["completed"] * 6
    assert table["exit_code"].tolist() == [0] * 6
    np.testing.assert_allclose(table["removal.separation"], [10.1, 10.2] * 3, rtol=1e-12)
    units = table.attrs["units"]
    assert (units["removal.tether.rest_length"], units["removal.separation"]) == ("m", "m")
    schema = pyarrow.parquet.read_schema(swept / "table.parquet")
    assert schema.field("removal.separation").metadata[b"unit"] == b"m"
    assert not [name for name in schema.names if "wall" in name or "cpu" in name]
    with (swept / "table.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert float(rows[3]["removal.separation [m]"]) == table["removal.separation"][3]
    timings = pd.read_parquet(swept / "timings.parquet")
    assert timings["key"].tolist() == table["key"].tolist()
    assert (timings["wall"] > 0.0).all()


def test_what_it_tells_of_itself(swept: Path) -> None:
    told = json.loads((swept / "provenance.json").read_text())
    assert told["varied"]["removal.tether.rest_length"] == ["13 m", "14 m", "15 m"]
    assert told["status"] == "6 of 6 cases succeeded"
    assert told["packages"]["numpy"] == np.__version__
    assert len(told["fmus"][0]["removal"]["fmu"]["sha256"]) == 64
    assert set(told["files"]) == {*TABLES, "timings.parquet", "summary.json", "sweep.png", "scene.toml",
                                  "fmus/my_removal.fmu"}  # fmt: skip
    summary = json.loads((swept / "summary.json").read_text())
    assert (summary["cases"], summary["succeeded"], summary["failures"]) == (6, 6, [])
    assert summary["title"].startswith("A pair that drifts (varied: removal.tether.rest_length, removal.start")


def test_it_goes_on_with_what_is_missing(swept: Path, dcone: Dcone, drift: Path, tmp_path: Path) -> None:
    """On one core, from another place, without its tables and half of its rows: the same bits."""
    before = tables(swept)
    rows = sorted((swept / "rows").iterdir())
    kept = {path: path.stat().st_mtime_ns for path in rows[3:]}
    for path in (*rows[:3], *(swept / name for name in TABLES)):
        path.unlink()
    elsewhere = shutil.copytree(drift.parent, tmp_path / "elsewhere")
    code, _, err = dcone("sweep", str(elsewhere / "drift.toml"), *GRID, "-o", "out", "-j", "1")
    assert (code, "3 of them there before" in err) == (0, True)
    assert tables(swept) == before
    assert {path: path.stat().st_mtime_ns for path in kept} == kept, "what was there is not written again"


def test_values_may_be_added(swept: Path, dcone: Dcone, drift: Path) -> None:
    more = LENGTHS.replace("15 m:3", "17 m:5")
    code, out, err = dcone(
        "sweep", str(drift), "--vary", more, "--vary", VELOCITY, "-o", "out", "--no-figures", "-j", "1"
    )
    assert "results in out" in out
    assert (code, "6 of them there before" in err) == (0, True)
    assert len(pd.read_parquet(swept / "table.parquet")) == 10


def test_a_case_by_itself_gives_what_the_sweep_says(swept: Path, dcone: Dcone, drift: Path) -> None:
    setting = 'removal.start.relative_velocity=["0 m/s","2 mm/s","0 m/s"]'
    assert dcone("run", str(drift), "--set", setting, "-o", "alone", "--no-figures")[0] == 0
    alone = json.loads(Path("alone/summary.json").read_text())["removal"]
    table = pd.read_parquet(swept / "table.parquet")
    assert table["removal.separation"][1] == alone["separation"]["value"]
    assert dcone("run", "out", "-o", "again", "--no-figures")[0] == 0, "the scene is kept in the folder"


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (
            ("--vary", LENGTHS),
            "holds a sweep over removal.tether.rest_length, removal.start.relative_velocity; this is",
        ),
        (
            (*GRID, "--set", "removal.duration=90 s"),
            "of 'drift' with other values in the scene, or with other settings",
        ),
    ],
)
def test_a_folder_of_another_sweep_is_not_touched(
    swept: Path, dcone: Dcone, drift: Path, arguments: tuple[str, ...], told: str
) -> None:
    before = {path: path.stat().st_mtime_ns for path in swept.rglob("*")}
    code, _, err = dcone("sweep", str(drift), *arguments, "-o", "out")
    assert (code, told in err) == (2, True)
    assert {path: path.stat().st_mtime_ns for path in swept.rglob("*")} == before


def test_another_fmu_is_another_sweep(swept: Path, dcone: Dcone, drift: Path, tmp_path: Path) -> None:
    other = build(tmp_path / "other", change=lambda xml: xml + "\n")
    (drift.parent / "my_removal.fmu").write_bytes(other.read_bytes())
    code, _, err = dcone("sweep", str(drift), *GRID, "-o", "out")
    assert (code, "with another FMU of the removal" in err) == (2, True)


def test_other_code_is_another_sweep(swept: Path, dcone: Dcone, drift: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(commands, "code", lambda: {"dcone-cosim": "9.9.9", "sources": "f" * 64})
    code, _, err = dcone("sweep", str(drift), *GRID, "-o", "out")
    assert (code, "holds a sweep made by other code" in err, "9.9.9" in err) == (2, True, True)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ((), "nothing is varied; give --vary"),
        (("--vary", "removal.tether.rest_lenght=1 m,2 m"), "did you mean 'tether.rest_length'?"),
        (("--vary", "title=one,two"), "title = one and = two come to the same"),
        ((*GRID, "-j", "2000"), "--jobs 2000: expected 1 to 1024 processes"),
    ],
)
def test_bad_input_leaves_nothing(dcone: Dcone, drift: Path, arguments: tuple[str, ...], told: str) -> None:
    code, _, err = dcone("sweep", str(drift), *arguments, "-o", "out")
    assert (code, told in err) == (2, True), err
    assert not Path("out").exists()


def test_failures_are_rows_and_the_exit_code_says_so(dcone: Dcone, drift: Path, tmp_path: Path) -> None:
    """One FMU of this scene crashes its worker, one case of three: told, and the rest is there."""
    crash = build(tmp_path / "crash", "removal", "CRASH", when=45.0)
    (drift.parent / "my_removal.fmu").write_bytes(crash.read_bytes())
    vary = ("--vary", "removal.duration=20 s,40 s,80 s")
    code, out, err = dcone("sweep", str(drift), *vary, "-o", "out", "--json")
    assert (code, json.loads(out)["statuses"]) == (7, {"completed": 2, "lost": 1})
    assert "removal.duration = 80 s: its worker was ended by SIGSEGV" in err
    assert "1 of 3 cases failed" in err
    table = pd.read_parquet("out/table.parquet")
    assert table["status"].tolist() == ["completed", "completed", "lost"]
    assert table["removal.separation"].isna().tolist() == [False, False, True]
    assert json.loads(Path("out/summary.json").read_text())["failures"][0]["removal.duration"] == "80 s"
    code, _, err = dcone("sweep", str(drift), *vary, "-o", "out", "--isolate")
    assert (code, "FMU failed" in err or "SIGSEGV" in err) == (7, True), "run again, and isolated it fails by itself"
    table = pd.read_parquet("out/table.parquet")
    assert table["status"].tolist() == ["completed", "completed", "FMU failed"]


def test_a_sweep_that_cannot_be_drawn_is_there_all_the_same(dcone: Dcone, drift: Path) -> None:
    three = ("--vary", "removal.chaser.mass=1 t,2 t")
    code, _, err = dcone("sweep", str(drift), *GRID, *three, "-o", "out", "-j", "1")
    assert (code, "no figure is drawn of 3 varied keys" in err) == (0, True)
    assert not Path("out/sweep.png").exists()
    code, _, err = dcone("sweep", str(drift), *three, "-o", "flat", "-j", "1")
    assert (code, "no figure of the summary is a number that changes" in err) == (0, True)


def started(*arguments: str, cwd: Path) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [sys.executable, "-m", "dcone_cosim.cli", *arguments],
        cwd=cwd, env=os.environ | {"PYTHONPATH": ROOT}, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip


def some_rows(folder: Path, count: int) -> None:
    end = time.monotonic() + 60.0
    while len(list((folder / "rows").glob("*.json"))) < count:
        assert time.monotonic() < end
        time.sleep(0.002)


def hidden(folder: Path) -> list[str]:
    return [path.name for path in folder.rglob("*") if path.name.startswith(PREFIX)]


MANY = ("--vary", "removal.tether.rest_length=13 m..20 m:40", "--set", "removal.macro_step=25 ms", "--no-figures")
"""Cases of some 30 ms."""


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_stopped_and_gone_on_with(dcone: Dcone, drift: Path, tmp_path: Path) -> None:
    """What is there is kept and nothing under a final name is half; in the end it is as if nobody had disturbed it."""
    cut, rows = tmp_path / "cut", 0
    for number, code in ((signal.SIGINT, 6), (signal.SIGKILL, -9)):
        process = started("sweep", str(drift), *MANY, "-o", "cut", cwd=tmp_path)
        some_rows(cut, rows + 2)
        process.send_signal(number)
        _, err = process.communicate(timeout=60)
        assert process.returncode == code, err
        before, rows = rows, len(list((cut / "rows").glob("*.json")))
        assert before + 2 <= rows < 40
        assert not (cut / "table.parquet").exists()
        if code == 6:
            assert f"{rows} of 40 cases done; they are kept in cut, and the same command goes on".encode() in err
            assert not hidden(cut)
    assert dcone("sweep", str(drift), *MANY, "-o", "cut")[0] == 0
    assert dcone("sweep", str(drift), *MANY, "-o", "whole", "-j", "1")[0] == 0
    assert tables(cut) == tables(tmp_path / "whole")
    assert not hidden(cut)


def rows_there(folder: Path) -> int:
    """How many rows there are, alone and in segments."""
    keys = {path.stem for path in (folder / "rows").glob("*.json")}
    for path in (folder / "rows").glob("many-*.parquet"):
        keys |= set(pyarrow.parquet.read_table(path)["key"].to_pylist())
    return len(keys)


@pytest.mark.evidence
@pytest.mark.parametrize("seed", [2026])
def test_killed_ten_times(dcone: Dcone, tmp_path: Path, seed: int, capfd: pytest.CaptureFixture[str]) -> None:
    """Table 2 on 120 lengths of tether, ten times killed with -9 at a random moment: the undisturbed table's bits."""
    sweep = ("sweep", "table2-deorbit", "--vary", "removal.tether.rest_length=12 m..100 m:120", "--no-figures")
    assert dcone(*sweep[:3], "removal.tether.rest_length=12 m,13 m", "-o", "warm")[0] == 0
    began = time.monotonic()
    assert dcone(*sweep, "-o", "whole")[0] == 0
    lasts, moments, done = time.monotonic() - began, random.Random(seed), []
    for kill in range(10):
        process = started(*sweep, "-o", "cut", cwd=tmp_path)
        if kill % 2 and rows_there(tmp_path / "cut") < 110:  # once it runs cases, every other time
            some_rows(tmp_path / "cut", rows_there(tmp_path / "cut") + 1)
            time.sleep(moments.uniform(0.0, 0.15) * lasts)
        else:
            time.sleep(moments.uniform(0.0, 0.6) * lasts)
        process.kill()
        process.communicate()
        done.append(rows_there(tmp_path / "cut"))
        assert done[-1] == 120 or not (tmp_path / "cut" / "table.parquet").exists()
    with capfd.disabled():
        print(f"{lasts:.1f} s undisturbed; rows of 120 after each kill: {done}")
    assert len(set(done)) >= 4, "most of them in the midst of it"
    assert dcone(*sweep, "-o", "cut")[0] == 0
    assert tables(tmp_path / "cut") == tables(tmp_path / "whole")
    assert len(pd.read_parquet(tmp_path / "cut" / "table.parquet")) == 120
    assert not hidden(tmp_path / "cut")


class TestEnsemble:
    SHORT = ("table2-deorbit", "--set", "removal.duration=1 h")

    def test_what_it_leaves(self, dcone: Dcone) -> None:
        code, out, err = dcone("run", *self.SHORT, "--ensemble", "4", "--seed", "7", "-o", "out")
        assert code == 0, err
        assert "4 runs: 4 completed (0.51 to 1)" in out
        table = pd.read_parquet("out/table.parquet")
        assert table["seed"].tolist() == [7, 8, 9, 10]
        told = json.loads(Path("out/summary.json").read_text())
        peak = told["figures"]["removal.first_tug"]
        values = table["removal.first_tug"].tolist()
        assert len(set(values)) == 4, "each begins otherwise"
        expected = spread(values, "s")
        assert (peak["mean"], peak["standard_deviation"], peak["count"]) == (expected.mean, expected.deviation, 4)
        assert peak["percentiles"]["50"] == expected.percentiles[50.0]
        assert 0.0 < peak["standard_deviation"] < 1e-3 * peak["mean"]
        assert told["statuses"]["completed"]["count"] == 4
        assert (told["ensemble"]["runs"], told["ensemble"]["first_seed"]) == (4, 7)
        assert told["ensemble"]["jitter"][0].startswith("removal.start.separation=9.9999993")
        before = tables(Path("out"))
        shutil.rmtree("out/rows")
        code, out, _ = dcone("run", *self.SHORT, "--ensemble", "4", "--seed", "7", "-o", "out", "--json", "-j", "1")
        assert (code, json.loads(out)["cases"]) == (0, 4)
        assert tables(Path("out")) == before, "the same seeds are the same starts"
        code, out, err = dcone("run", *self.SHORT, "--ensemble", "5", "--seed", "6", "-o", "out", "--json")
        assert (code, "4 of them there before" in err) == (0, True)

    @pytest.mark.parametrize(
        ("arguments", "told"),
        [
            (("table2-deorbit", "--ensemble", "1"), "--ensemble 1: expected 2 to 100,000 runs"),
            (("table2-deorbit", "--ensemble", "4", "--seed", "-1"), "--seed -1: expected a whole number"),
            (("table2-deorbit", "--ensemble", "4", "--force"), "--force: an ensemble goes on"),
            (("table2-deorbit", "--ensemble", "4", "--set", "removal.start.condition=handed_over"),
             "no ensemble of its removal: its FMU has neither solver.seed"),
        ],
    )  # fmt: skip
    def test_what_is_refused(self, dcone: Dcone, arguments: tuple[str, ...], told: str) -> None:
        code, _, err = dcone("run", *arguments, "-o", "out")
        assert (code, told in err) == (2, True), err
        assert not Path("out").exists()

    def test_an_fmu_without_a_jitter(self, dcone: Dcone, drift: Path) -> None:
        code, _, err = dcone("run", str(drift), "--ensemble", "4", "-o", "out")
        assert (code, "no ensemble of its removal" in err) == (2, True), err


def test_progress_tells_rate_and_time_to_go(capsys: pytest.CaptureFixture[str], monkeypatch: Any) -> None:
    monkeypatch.setattr("dcone_cosim.progress.REMINDER", 0.0)
    lines = Lines()
    lines.count("cases", 3, 10, "3 of 10, 2 per s, 4 s to go")
    lines.count("cases", 3, 10, "3 of 10, 2 per s, 4 s to go")
    lines.count("cases", 10, 10, "10 of 10, 2 per s")
    assert capsys.readouterr().err.splitlines() == ["cases: 3 of 10, 2 per s, 4 s to go", "cases: 10 of 10, 2 per s"]
    monkeypatch.setattr("dcone_cosim.progress.REMINDER", 100.0)
    lines.count("cases", 4, 10, "4 of 10")
    assert not capsys.readouterr().err, "a log is not filled with it"


def test_the_bar_counts_cases() -> None:
    import io

    from rich.console import Console

    screen = io.StringIO()
    bar = Bar(Console(file=screen, force_terminal=True, width=120))
    bar.count("cases", 3, 10, "3 of 10, 2 per s, 4 s to go")
    bar.count("cases", 10, 10, "10 of 10")
    bar.close()
    assert "10 of 10" in screen.getvalue()
