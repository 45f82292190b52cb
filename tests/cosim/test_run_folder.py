"""The run folder is whole or not there, and its columns say their units."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest

from dcone_cosim.master import run_scene
from dcone_cosim.progress import Progress
from dcone_cosim.reports import summary
from dcone_cosim.results import RunResult
from dcone_cosim.scene.data import Scene
from tests.cosim.mock_components import MockCapture, MockRemoval
from tests.cosim.written import write


@pytest.fixture
def result(make_scene: Callable[..., Scene]) -> RunResult:
    def instantiate(phase: str, name: str):
        return MockCapture(reports=True) if phase == "capture" else MockRemoval(tugs=[(12.0, 5.0, 0.01)])

    return run_scene(make_scene("capture", "removal"), instantiate, Progress())


def put(result: RunResult, folder: Path, **more: object) -> None:
    write(result, folder, summary.as_dict(result), **more)


def test_what_is_in_the_folder(result: RunResult, tmp_path: Path) -> None:
    put(result, tmp_path / "run", with_csv=True)
    assert {p.name for p in (tmp_path / "run").iterdir()} == {
        *("capture.csv", "capture.parquet", "removal.csv", "removal.parquet", "tugs.csv", "tugs.parquet"),
        *("removal_without_recoil_tugs.csv", "removal_without_recoil_tugs.parquet"),
        *("ledger.csv", "ledger.json", "provenance.json", "scene.toml", "summary.json"),
    }
    assert (tmp_path / "run" / "scene.toml").read_text() == result.scene.text
    provenance = json.loads((tmp_path / "run" / "provenance.json").read_text())
    assert provenance["status"] == "completed"
    assert provenance["packages"]["numpy"] == np.__version__
    assert provenance["phases"]["removal"]["parameters"]["target.mass"] == 1006.0
    rows = json.loads((tmp_path / "run" / "ledger.json").read_text())["rows"]
    assert all(row["closed"] for row in rows)


def test_columns_come_back_with_units_and_types(result: RunResult, tmp_path: Path) -> None:
    put(result, tmp_path / "run", with_csv=True)
    table = pyarrow.parquet.read_table(tmp_path / "run" / "removal.parquet")
    assert table.schema.field("time").metadata[b"unit"] == b"s"
    recorder = result.phases["removal"].recorder
    for name in recorder.names:
        np.testing.assert_array_equal(table[name].to_numpy(), recorder.column(name))
    assert str(table.schema.field("tether.taut").type) == "bool"
    assert str(table.schema.field("tether.tug_count").type) == "int64"
    assert (tmp_path / "run" / "tugs.csv").read_text().startswith('"tug","time [s]","peak [N]","speed [m/s]"')


def test_a_crash_while_writing_leaves_nothing(result: RunResult, tmp_path: Path) -> None:
    def crash(draft: Path) -> None:
        assert (draft / "capture.parquet").exists()
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        put(result, tmp_path / "new" / "deep" / "run", draw=crash)
    assert not list(tmp_path.iterdir())


def test_a_crash_while_replacing_leaves_the_old_run(result: RunResult, tmp_path: Path) -> None:
    put(result, tmp_path / "run")
    before = {p.name: p.read_bytes() for p in (tmp_path / "run").iterdir()}

    def crash(draft: Path) -> None:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        put(result, tmp_path / "run", draw=crash, force=True)
    assert {p.name: p.read_bytes() for p in (tmp_path / "run").iterdir()} == before
    assert [p.name for p in tmp_path.iterdir()] == ["run"]


def test_replacing_leaves_only_the_new_run(result: RunResult, tmp_path: Path) -> None:
    put(result, tmp_path / "run", with_csv=True)
    put(result, tmp_path / "run", force=True)
    assert not (tmp_path / "run" / "capture.csv").exists()
    assert [p.name for p in tmp_path.iterdir()] == ["run"]


def test_every_number_of_the_summary_has_a_unit(result: RunResult) -> None:
    without = {row.key for row in summary.findings(result) if not isinstance(row.value, str | int) and not row.unit}
    assert without == {"ledger_closure", "point_bound_time", "point_bound_peak"}


def test_a_failed_run_is_kept_and_says_so(make_scene: Callable[..., Scene], tmp_path: Path) -> None:
    failed = run_scene(make_scene("capture"), lambda *_: MockCapture(outcome="missed"), Progress())
    put(failed, tmp_path / "run")
    provenance = json.loads((tmp_path / "run" / "provenance.json").read_text())
    assert provenance["status"] == "capture failed"
    assert provenance["exit_code"] == 3
    assert (tmp_path / "run" / "capture.parquet").exists()


def test_what_has_the_name_keeps_it(result: RunResult, tmp_path: Path) -> None:
    """A full folder, an empty one that appeared meanwhile, a file, a link to nowhere: the results go beside each."""
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "thesis.tex").write_text("years of work")
    (tmp_path / "file").write_text("x")
    (tmp_path / "link").symlink_to("nowhere")
    for name in ("full", "file", "link"):
        assert write(result, tmp_path / name, {}) == tmp_path / f"{name}-2"
        assert (tmp_path / f"{name}-2" / "summary.json").exists()
        assert write(result, tmp_path / name, {}, force=True) == tmp_path / f"{name}-3"
    assert (tmp_path / "full" / "thesis.tex").read_text() == "years of work"
    put(result, tmp_path / "late", draw=lambda _: (tmp_path / "late").mkdir())
    assert not list((tmp_path / "late").iterdir())
    assert (tmp_path / "late-2" / "summary.json").exists()
    assert not [p.name for p in tmp_path.iterdir() if p.name.startswith(".")]


def test_an_interrupt_while_swapping_brings_the_old_run_back(
    result: RunResult, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    put(result, tmp_path / "run")
    (tmp_path / "run" / "summary.json").write_text("old")
    rename = Path.rename

    def interrupted(self: Path, target: Path) -> Path:
        if target == tmp_path / "run" and self.suffix != ".old":
            raise KeyboardInterrupt
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", interrupted)
    with pytest.raises(KeyboardInterrupt):
        put(result, tmp_path / "run", force=True)
    assert (tmp_path / "run" / "summary.json").read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["run"]


def test_every_table_says_what_its_times_count_from(result: RunResult, tmp_path: Path) -> None:
    put(result, tmp_path / "run")
    tables = {path.stem: pyarrow.parquet.read_table(path) for path in (tmp_path / "run").glob("*.parquet")}
    clocks = {name: table.schema.field("time").metadata[b"clock"].decode() for name, table in tables.items()}
    instant = result.handovers["removal"].time
    shot, hand_over = "since the shot", f"since the hand-over, which was {instant!r} s after the shot"
    removal = dict.fromkeys(("removal", "tugs", "removal_without_recoil_tugs"), hand_over)
    assert clocks == {"capture": shot} | removal
    assert tables["capture"]["time"].to_pylist()[:: len(tables["capture"]) - 1] == [0.0, instant]
    assert tables["removal"]["time"].to_pylist() == [10.0 * i for i in range(11)]
    assert tables["tugs"]["time"].to_pylist() == [12.0]
