"""A run read back from its folder is the run that left it: every bit, every figure, every picture."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from dcone_cosim.commands import run_and_write
from dcone_cosim.errors import InputError
from dcone_cosim.progress import Progress
from dcone_cosim.redrawing import draw_again
from dcone_cosim.reports import summary
from dcone_cosim.results import RunResult
from dcone_cosim.run_folder import as_json, tables_of
from dcone_cosim.run_reading import read_run
from tests.cosim.conftest import Dcone
from tests.runs import COARSE, put

Left = tuple[RunResult, Path]


@pytest.fixture(scope="module")
def mission(tmp_path_factory: pytest.TempPathFactory) -> Left:
    """A run with its figures, as the master left it, and its folder."""
    done = run_and_write("mission", tmp_path_factory.mktemp("read") / "run", Progress(), settings=COARSE)
    return done.result, done.folder


@pytest.fixture(scope="module")
def tows(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two tows, the first with passive safety."""
    settings = ("removal.duration=20 min", "second_tow.duration=10 min", "removal.safety_every=10 min")
    return put("two-tows", tmp_path_factory.mktemp("tows") / "run", settings)


def plain(run: RunResult) -> object:
    return json.loads(as_json(summary.as_dict(run)))


def test_the_tables(mission: Left) -> None:
    left, folder = mission
    before, after = dict(tables_of(left)), dict(tables_of(read_run(folder)))
    assert before.keys() == after.keys() >= {"capture", "nodes", "removal", "tugs"}
    for name, table in before.items():
        assert table.schema.equals(after[name].schema, check_metadata=True)
        assert table.equals(after[name])


def test_the_summary(mission: Left, tows: Path) -> None:
    for folder in (mission[1], tows):
        assert plain(read_run(folder)) == json.loads((folder / "summary.json").read_text())


def test_what_was_handed_over(mission: Left) -> None:
    left, folder = mission
    again = read_run(folder)
    assert again.left == left.left
    assert again.given == left.given
    assert again.parameters == left.parameters
    mine, read = left.handovers["removal"], again.handovers["removal"]
    assert mine.rows == read.rows
    assert json.loads(as_json(mine.told())) == json.loads(as_json(read.told()))


def test_the_figures_drawn_again(mission: Left, tmp_path: Path) -> None:
    """Byte for byte, there and elsewhere; nothing but the tables is asked, so without one there is a word."""
    _, folder = mission
    before = {path.name: path.read_bytes() for path in folder.glob("*.png")}
    assert len(before) == 4
    paths, _ = draw_again(folder, tmp_path / "there", Progress())
    assert {path.name: path.read_bytes() for path in paths} == before
    copy = shutil.copytree(folder, tmp_path / "copy")
    (copy / "removal.parquet").unlink()
    with pytest.raises(InputError, match=r"removal\.parquet cannot be read"):
        draw_again(copy, None, Progress())


def test_figures_in_their_own_folder_count_as_files_of_the_run(dcone: Dcone, mission: Left, tmp_path: Path) -> None:
    """So that the run may be replaced with --force all the same."""
    copy = shutil.copytree(mission[1], tmp_path / "copy", ignore=shutil.ignore_patterns("*.png"))
    told = json.loads((copy / "provenance.json").read_text())
    told["files"] = [name for name in told["files"] if not name.endswith(".png")]
    (copy / "provenance.json").write_text(json.dumps(told))
    code, out, err = dcone("plot", "copy")
    assert code == 0, err
    assert len(out.splitlines()) == 4
    assert {p.name for p in copy.glob("*.png")} <= set(json.loads((copy / "provenance.json").read_text())["files"])
    settings = [part for setting in COARSE for part in ("--set", setting)]
    code, _, err = dcone("run", "mission", "-o", "copy", "--force", "--no-figures", *settings)
    assert code == 0, err


def test_what_is_damaged_or_no_run(mission: Left, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="not the folder of a run"):
        read_run(tmp_path)
    copy = shutil.copytree(mission[1], tmp_path / "copy")
    for name in ("capture.parquet", "ledger.json", "nodes.parquet"):
        (copy / name).write_bytes(b"no table")
        with pytest.raises(InputError, match=name):
            read_run(copy)
        shutil.copy(mission[1] / name, copy / name)
    told = json.loads((copy / "provenance.json").read_text())
    del told["phases"]["capture"]["came_out"]
    (copy / "provenance.json").write_text(json.dumps(told))
    with pytest.raises(InputError, match="written by dcone-cosim"):
        read_run(copy)


def test_a_bit_that_is_another_shows(mission: Left, tmp_path: Path) -> None:
    """The twin: what is read is what is in the file."""
    import pyarrow as pa
    import pyarrow.parquet

    copy = shutil.copytree(mission[1], tmp_path / "copy")
    table = pyarrow.parquet.read_table(copy / "removal.parquet")
    values = table["separation"].to_numpy().copy()
    values[-1] = np.nextafter(values[-1], np.inf)
    place = table.schema.get_field_index("separation")
    pyarrow.parquet.write_table(
        table.set_column(place, table.schema.field(place), pa.array(values)), copy / "removal.parquet"
    )
    assert plain(read_run(copy)) != plain(read_run(mission[1]))
