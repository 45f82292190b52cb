"""A run is made again from its folder alone, wherever that has been moved, and leaves the same tables bit for bit."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pytest

from dcone_cosim import build
from dcone_cosim.loading import find, load
from dcone_cosim.progress import Progress
from dcone_cosim.ssp.export import export_scene
from tests.cosim.conftest import Dcone
from tests.runs import COARSE

SHORT = "removal.duration=1 h"


def tables(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.glob("*.parquet")}


def told(folder: Path) -> dict[str, Any]:
    content: dict[str, Any] = json.loads((folder / "provenance.json").read_text())
    return content


def again(dcone: Dcone, tmp_path: Path, scene: str, *settings: str, gone: Path | None = None) -> tuple[Path, Path]:
    """Run, move the folder away, take away what the scene was, and run from the folder; returns both folders."""
    arguments = [part for setting in settings for part in ("--set", setting)]
    code, _, err = dcone("run", scene, "-o", "first", "--no-figures", *arguments)
    assert code == 0, err
    (tmp_path / "elsewhere").mkdir()
    shutil.move("first", "elsewhere/moved")
    if gone is not None:
        shutil.rmtree(gone)
    code, _, err = dcone("run", "elsewhere/moved", "-o", "second", "--no-figures")
    assert code == 0, err
    assert "another FMU" not in err
    first, second = tmp_path / "elsewhere" / "moved", tmp_path / "second"
    assert tables(first)
    assert tables(first) == tables(second)
    for name in ("given", "parameters", "inputs", "handed_over"):
        for phase, facts in told(first)["phases"].items():
            assert facts[name] == told(second)["phases"][phase][name]
    titles = [json.loads((folder / "summary.json").read_text())["title"] for folder in (first, second)]
    assert titles[0] == titles[1]
    return first, second


@pytest.mark.parametrize(
    ("scene", "settings"),
    [
        ("table2-deorbit", ()),
        ("table2-deorbit", (SHORT, "removal.thrust.offset=0.005 N", "removal.start.leading=chaser")),
        ("table2-deorbit", (SHORT, 'removal.solver={tolerance_orbit = "1 mm"}', 'phases=["removal"]')),
        (
            "table2-deorbit",
            (SHORT, 'removal.start={condition="vbar", separation="9 m"}', "removal.solver.tolerance_stretch=1 pm"),
        ),
        ("table2-deorbit", ("title=mine", SHORT)),
        ("reel-control", (SHORT, "removal.components.controller.motor.time_constant=7 s", "removal.coupling.step=3 s")),
        ("reel-control", (SHORT, 'removal.connections=["controller.tension -> removal.reel.tension"]')),
    ],
)
def test_with_settings_of_every_kind(dcone: Dcone, tmp_path: Path, scene: str, settings: tuple[str, ...]) -> None:
    first, _ = again(dcone, tmp_path, scene, *settings)
    assert told(first)["settings"] == list(settings)


def test_another_scene_in_the_folder_leaves_other_tables(dcone: Dcone, tmp_path: Path) -> None:
    """The twin: the folder's scene is what is run, and the tables do tell runs apart."""
    first, _ = again(dcone, tmp_path, "table2-deorbit", SHORT)
    kept = first / "scene.toml"
    kept.write_text(kept.read_text().replace('level = "-0.01 N"', 'level = "-0.0100001 N"'))
    assert dcone("run", str(first), "-o", "third", "--no-figures")[0] == 0
    assert tables(first) != tables(tmp_path / "third")


@pytest.fixture
def fmu(tmp_path: Path) -> Path:
    """A scene of its own folder that names FMUs there, two of them by one name in different folders."""
    main = load("table2-deorbit").phases[0].main
    (path,) = build.ensure([(main.model, main.terms)], print)
    for folder in ("scenes", "scenes/other"):
        (tmp_path / folder).mkdir()
        shutil.copy(path, tmp_path / folder / "tow.fmu")
    text = find("table2-deorbit").read_text().replace('law = "locked"', "")
    text = text.replace("[removal]\n", '[removal]\nfmu = "tow.fmu"\n').replace("[removal.reel]", "")
    text = text.replace('direction = "along_track"', "").replace('"1 day"', '"1 h"')
    wire = 'connections = ["removal.tether.tension -> other.thrust.offset"]\n'
    text = text.replace('macro_step = "60 s"\n', f'macro_step = "60 s"\n{wire}')
    other = (
        '\n[removal.components.other]\nfmu = "other/tow.fmu"\n[removal.components.other.thrust]\nlevel = "-0.02 N"\n'
    )
    (tmp_path / "scenes" / "mine.toml").write_text(text + other)
    return tmp_path / "scenes"


def test_with_fmus_told_relative_to_the_scene(dcone: Dcone, tmp_path: Path, fmu: Path) -> None:
    first, second = again(dcone, tmp_path, "scenes/mine.toml", "removal.tether.damping_ratio=0.06", gone=fmu)
    assert sorted(path.name for path in (first / "fmus").iterdir()) == ["tow-2.fmu", "tow.fmu"]
    assert str(tmp_path) not in (first / "scene.toml").read_text()
    assert told(second)["scene"] == "mine"
    assert told(first)["phases"]["removal"]["components"]["other"]["given"]["thrust.level"] == -0.02


def test_another_fmu_in_the_folder_is_noted(dcone: Dcone, tmp_path: Path, fmu: Path) -> None:
    first, _ = again(dcone, tmp_path, "scenes/mine.toml")
    with (first / "fmus" / "tow.fmu").open("ab") as file:
        file.write(b"\0")
    code, _, err = dcone("run", str(first), "-o", "third", "--no-figures")
    assert code == 0, err
    assert "note: made again with another FMU of the removal: its SHA-256 is" in err
    assert "removal, other" not in err


def test_a_package_and_its_settings(dcone: Dcone, tmp_path: Path) -> None:
    (tmp_path / "packages").mkdir()
    (package,) = export_scene(load("table2-deorbit", [SHORT]), tmp_path / "packages", Progress()).paths
    first, second = again(dcone, tmp_path, str(package), "removal.thrust.offset=0.005 N", gone=tmp_path / "packages")
    assert told(first)["settings"] == told(second)["settings"] == ["removal.thrust.offset=0.005 N"]
    assert told(second)["phases"]["removal"]["inputs"]["thrust.offset"] == 0.005
    assert told(second)["scene"] == "table2-deorbit-removal"


@pytest.mark.slow
def test_a_mission_with_its_hand_over(dcone: Dcone, tmp_path: Path) -> None:
    """What the hand-over set is told apart from what the scene says, and is no input left at nan."""
    first, _ = again(dcone, tmp_path, "mission", *COARSE[:2], SHORT, "removal.thrust.offset=1 mN")
    removal = told(first)["phases"]["removal"]
    handed = json.loads((first / "ledger.json").read_text())["set_in_removal"]
    assert {name: removal["handed_over"][name] for name in handed} == handed
    assert {"start.condition", "orbit.true_anomaly"} <= removal["handed_over"].keys()
    assert "thrust.level" not in removal["handed_over"]
    at = json.loads((first / "ledger.json").read_text())["time"]
    assert told(first)["handed_over_at"] == {"removal": at}
    assert at["value"] == pytest.approx(8.78, abs=0.1)
    assert told(first)["phases"]["capture"]["options"]["hand_over"] == "captured"


@pytest.mark.parametrize("scene", ["table2-deorbit", "reel-control"])
def test_every_value_is_told_as_a_number(dcone: Dcone, tmp_path: Path, scene: str) -> None:
    """Inputs were once recorded as nan, whatever the scene gave them."""
    assert (
        dcone("run", scene, "-o", "out", "--no-figures", "--set", "removal.thrust.offset=0.005 N", "--set", SHORT)[0]
        == 0
    )
    phase = told(tmp_path / "out")["phases"]["removal"]
    assert phase["inputs"]["thrust.offset"] == phase["given"]["thrust.offset"] == 0.005
    assert "thrust.offset" not in phase["parameters"]
    assert phase["handed_over"] == {}
    values = [*phase["inputs"].values(), *phase["parameters"].values()]
    assert all(isinstance(value, int | float) for value in values)


def test_a_folder_whose_scene_is_gone_is_bad_input(dcone: Dcone, tmp_path: Path) -> None:
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "provenance.json").write_text('{"scene": "mission"}')
    code, _, err = dcone("run", "run", "-o", "out")
    assert code == 2
    assert "holds neither scene.toml nor system.ssp" in err


def test_the_title_everywhere_follows_the_settings(dcone: Dcone, tmp_path: Path) -> None:
    code, out, _ = dcone("run", "table2-deorbit", "-o", "out", "--no-figures", "--set", SHORT)
    assert code == 0
    assert "(changed: removal.duration = 1 h)" in " ".join(out.split())
    title = json.loads((tmp_path / "out" / "summary.json").read_text())["title"]
    assert (
        title == "Table 2: a 2000 kg chaser tows 1000 kg of debris on a 12 m tether (changed: removal.duration = 1 h)"
    )
    assert load(str(tmp_path / "out")).title == title
