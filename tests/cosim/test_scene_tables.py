"""A table in a scene: its file is read with the scene, goes into the FMU, is kept with the run, and told if bad."""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pandas as pd
import pytest

from dcone_cosim import build
from dcone_cosim.loading import load
from dcone_cosim.scene.mistakes import SceneError
from dcone_cosim.scenes.new import new_scene
from dcone_cosim.scenes.schema import _tables
from fmu_src.packaging import table_file
from tests.cosim.conftest import Dcone
from tests.packaging import lookup

ROOT = Path(__file__).parents[2]
SCENE = """
[removal]
macro_step = "10 s"
duration = "60 s"
connections = ["removal.tether.length -> winch.u", "winch.y -> removal.reel.tension"]
[removal.reel]
law = "commanded"
[removal.thrust]
direction = "along_track"
[removal.components.winch]
model = "lookup"
[removal.components.winch.curve]
law = "linear"
knots = "data/curve.csv" # pulls by the length of the line
"""
CURVE = "# m, N\n0.0, 0.0\n9.0 0.0\n\n10.0, 0.25 # soft\n14.0, 3.0\n"
KNOTS = [[0.0, 0.0], [9.0, 0.0], [10.0, 0.25], [14.0, 3.0]]
TABLE = "removal.components.winch.curve.knots"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a scene whose winch looks its tension up in a table; the lookup is a model of ours here."""
    monkeypatch.setitem(build.CATALOGUE, "lookup", lookup.MODEL)  # type: ignore[arg-type]
    monkeypatch.setenv("PYTHONPATH", f"{ROOT}{os.pathsep}{os.environ.get('PYTHONPATH', '')}")
    (tmp_path / "mine/data").mkdir(parents=True)
    (tmp_path / "mine/data/curve.csv").write_text(CURVE)
    (tmp_path / "mine/scene.toml").write_text(SCENE)
    return tmp_path / "mine"


def test_it_is_read_with_the_scene(folder: Path) -> None:
    scene = load(str(folder / "scene.toml"))
    (table,) = scene.tables
    assert table.numbers.tolist() == KNOTS
    assert table.file == folder / "data/curve.csv"
    assert table.sha256 == hashlib.sha256(CURVE.encode()).hexdigest()
    assert f'knots = "{folder / "data/curve.csv"}" # pulls by the length' in scene.text


def harm(text: str | bytes | None) -> Callable[[Path], None]:
    """What leaves the file with another text, or takes it away."""

    def change(file: Path) -> None:
        if text is None:
            file.unlink()
        elif isinstance(text, bytes):
            file.write_bytes(text)
        else:
            file.write_text(text)

    return change


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (harm(None), "cannot be read: No such file or directory; expected a file with rows of an input"),
        (lambda file: (file.unlink(), file.mkdir()), "cannot be read: Is a directory"),
        (lambda file: (file.unlink(), os.mkfifo(file)), "it is a pipe; expected a file"),
        (
            harm(CURVE.replace("10.0", "1O.0")),
            "curve.csv: line 5: expected numbers, found '1O.0, 0.25 # soft'; expected r",
        ),
        (harm(CURVE.replace("14.0,", "14.0, 1.0")), "curve.csv: line 6: 3 numbers, expected 2 as in the rows before"),
        (harm(CURVE.replace("3.0", "nan")), "curve.csv: number 4, 2 is nan, expected a finite one"),
        (harm("# nothing"), "curve.csv: it is empty"),
        (harm(b"\xff\xfe\0"), "curve.csv: is no text in UTF-8"),
    ],
)
def test_what_is_wrong_with_the_file_is_told(folder: Path, change: Callable[[Path], Any], words: str) -> None:
    change(folder / "data/curve.csv")
    with pytest.raises(SceneError) as error:
        load(str(folder / "scene.toml"))
    (mistake,) = error.value.mistakes
    told = f'scene.toml: 1 mistake\n  line 14: {TABLE} = "data/curve.csv": '
    assert told in str(error.value)
    assert words in mistake.expected


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("", f'{TABLE} missing: expected the path of a file, such as "my-table.csv": rows of an input'),
        ("knots = 4.0", '= 4.0: expected the path of a file, such as "my-table.csv"'),
        ('knots = " "', "expected the path of a file"),
        ('knots = "https://a.b/c.csv"', "is an address: nothing is fetched; download the file and give its path"),
        ("knots = { a = 1 }", "= a table: expected the path of a file"),
        ('knosts = "data/curve.csv"', "unknown key; did you mean 'knots'?"),
    ],
)
def test_what_is_no_path_is_told(folder: Path, line: str, words: str) -> None:
    text = re.sub("^knots.*$", line, SCENE, flags=re.M)
    (folder / "scene.toml").write_text(text)
    with pytest.raises(SceneError, match=re.escape(words)):
        load(str(folder / "scene.toml"))


def test_the_schema_of_scenes_knows_the_key() -> None:
    known = _tables(lookup.MODEL)["curve"]["properties"]["knots"]
    assert known["type"] == "string"
    assert "rows of an input" in known["description"]


def test_a_draft_has_the_key_whether_it_is_given_or_left_out(folder: Path) -> None:
    draft = new_scene(SCENE, "scene", "draft.toml")
    assert 'knots = "data/curve.csv"  # path of a file: rows of an input' in draft
    assert '# numbers = "my-table.csv"  # path of a file: numbers of a box' in draft
    (folder / "draft.toml").write_text(draft)
    assert [table.numbers.tolist() for table in load(str(folder / "draft.toml")).tables] == [KNOTS]


@pytest.mark.slow
def test_a_run_takes_it_and_can_be_made_again_wherever_it_is(dcone: Dcone, folder: Path, tmp_path: Path) -> None:
    """The tension is what the table says of the length; the twin is another table, which costs no build."""
    code, _, said = dcone("run", str(folder / "scene.toml"), "-o", "one", "--no-figures")
    assert code == 0, said
    rows = pd.read_parquet(tmp_path / "one/removal.parquet")
    lengths, tensions = rows["tether.length"].to_numpy(), rows["winch.y"].to_numpy()
    assert tensions[1:] == pytest.approx(np.interp(lengths, *np.transpose(KNOTS))[1:], rel=1e-12)
    assert tensions.max() > 0.2
    about = json.loads((tmp_path / "one/provenance.json").read_text())["phases"]["removal"]
    digest = hashlib.sha256(CURVE.encode()).hexdigest()
    assert about["components"]["winch"]["fmu"]["tables"] == {"curve.knots": {"file": "curve.csv", "sha256": digest}}
    assert about["fmu"]["tables"] == {}

    shutil.rmtree(folder)
    shutil.move(tmp_path / "one", tmp_path / "moved")
    assert dcone("run", "moved", "-o", "two", "--no-figures")[0] == 0
    assert pd.read_parquet(tmp_path / "two/removal.parquet").equals(rows)

    (tmp_path / "stiff.csv").write_text(CURVE.replace("0.25", "0.5"))
    code, _, said = dcone("run", "moved", "-o", "three", "--no-figures", "--set", f"{TABLE}={tmp_path}/stiff.csv")
    assert code == 0
    assert "building" not in said
    assert not pd.read_parquet(tmp_path / "three/removal.parquet")["winch.y"].equals(rows["winch.y"])


@pytest.mark.slow
def test_the_files_for_other_tools_carry_it(dcone: Dcone, folder: Path, tmp_path: Path) -> None:
    assert dcone("build", str(folder / "scene.toml"), "-o", "fmus")[0] == 0
    assert dcone("export-ssp", str(folder / "scene.toml"), "-o", "packages")[0] == 0
    written = tmp_path / "fmus/scene-removal-winch.fmu"
    with zipfile.ZipFile(written) as content:
        assert content.read(table_file.PATH).endswith(np.array(KNOTS).tobytes())
    with zipfile.ZipFile(tmp_path / "packages/scene-removal.ssp") as package:
        assert package.read("resources/winch.fmu") == written.read_bytes()
    result = fmpy.simulate_fmu(str(written), start_values={"u": 9.5}, output=["y"], stop_time=1.0)
    assert result["y"][-1] == 0.125
    assert dcone("inspect", str(folder / "scene.toml"))[0] == 0
