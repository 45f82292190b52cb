"""What `dcone build` writes is the scene: with nothing set, other tools get the numbers of `dcone run`."""

from __future__ import annotations

import json
import re
import shutil
import zipfile
from collections.abc import Callable, Iterator
from functools import reduce
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import numpy.typing as npt
import pandas as pd
import pytest

from dcone_cosim import build
from dcone_cosim.contract import EXTREMES
from dcone_cosim.errors import InputError
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.fmu.component import Component, FmuError
from dcone_cosim.loading import find
from fmu_src.interface import Model
from fmu_src.packaging import builds
from tests.cosim.conftest import Dcone
from tests.validating import validate_fmu

Columns = dict[str, npt.NDArray[np.float64]]
OFFSET = ("removal.thrust.offset=0.004 N", "removal.solver.tolerance_stretch=2 pm", "removal.duration=6 h")
"""Of the tow: an input that keeps its value, a tolerance, and the length of the run."""


def table(folder: Path, phase: str) -> Columns:
    frame = pd.read_parquet(folder / f"{phase}.parquet")
    return {name: frame[name].to_numpy(np.float64) for name in frame.columns}


def simulated(path: Path, origin: float = 0.0, until: float | None = None) -> Columns:
    """The FMU by fmpy, which is told nothing but the file, and perhaps when to stop; times from `origin` [s].

    Of the nodes every twelfth: fmpy takes seconds to write down all.
    """
    names = [v.name for v in fmpy.read_model_description(str(path)).modelVariables if v.causality == "output"]
    names = [name for name in names if (node := re.match(r"node\[(\d+)\]", name)) is None or int(node[1]) % 12 == 1]
    result = fmpy.simulate_fmu(str(path), output=names, stop_time=until)
    columns = {name: np.asarray(result[name], np.float64) for name in result.dtype.names}
    return columns | {"time": columns["time"] - origin}


def differing(run: Columns, elsewhere: Columns) -> set[str]:
    """Columns with other bits at a time that both have; an extreme over a step is that of all a longer step covers."""
    places = np.searchsorted(run["time"], elsewhere["time"] - 1e-6)
    both = np.flatnonzero(places < len(run["time"]))
    both = both[np.abs(run["time"][places[both]] - elsewhere["time"][both]) < 1e-6]
    assert len(both) > 100
    found = set()
    for name in run.keys() & elsewhere.keys() - {"time"}:
        ours, theirs = run[name][places[both]], elsewhere[name][both]
        if name in EXTREMES:
            begins = zip(places[both][:-1], places[both][1:], strict=True)
            ours = np.array([reduce(EXTREMES[name].choose, run[name][a + 1 : b + 1]) for a, b in begins])
            theirs = theirs[1:]
        if not np.array_equal(ours, theirs, equal_nan=True):
            found.add(name)
    assert len(run.keys() & elsewhere.keys()) > 20
    return found


def start(path: Path, name: str) -> str:
    (row,) = (v for v in fmpy.read_model_description(str(path)).modelVariables if v.name == name)
    return str(row.start)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scene", "phase", "settings", "other"),
    [
        ("table2-deorbit", "removal", (), "removal.thrust.level=-0.0100001 N"),
        ("table2-deorbit", "removal", OFFSET, "removal.thrust.offset=0.0040001 N"),
        ("table1-capture", "capture", ("capture.duration=16 s",), "capture.bullets.speed=3.0000001 m/s"),
    ],
)
def test_it_gives_the_numbers_of_a_run(
    dcone: Dcone, tmp_path: Path, scene: str, phase: str, settings: tuple[str, ...], other: str
) -> None:
    told = [word for setting in settings for word in ("--set", setting)]
    assert dcone("build", scene, "-o", "fmus", *told)[0] == 0
    assert dcone("run", scene, "-o", "run", "--no-figures", *told)[0] == 0
    (path,) = (tmp_path / "fmus").iterdir()
    assert path.name == f"{scene}-{phase}.fmu"
    assert validate_fmu(str(path)) == []
    run = table(tmp_path / "run", phase)
    assert differing(run, simulated(path)) == set()
    # the twin: another value is another file, and gives other numbers
    assert dcone("build", scene, "-o", "others", *told, "--set", other)[0] == 0
    (moved,) = (tmp_path / "others").iterdir()
    assert differing(run, simulated(moved, until=2.0 if phase == "capture" else None))


@pytest.fixture(scope="module")
def mission(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a run of the mission, and its FMUs for what was handed over there."""
    from dcone_cosim.commands import run_and_write, write_fmus
    from dcone_cosim.progress import Progress

    folder = tmp_path_factory.mktemp("mission")
    run_and_write("mission", folder / "run", Progress(), with_figures=False)
    paths, notes = write_fmus("mission", folder / "fmus", Progress(), from_run=folder / "run")
    assert [path.name for path in paths] == ["mission-capture.fmu", "mission-removal.fmu"]
    assert notes == []
    return folder


@pytest.mark.slow
def test_the_missions_fmu_holds_the_missions_net_and_line(mission: Path) -> None:
    """They used to be Table 1's net of 24 m and a line of 12 m."""
    capture, removal = mission / "fmus/mission-capture.fmu", mission / "fmus/mission-removal.fmu"
    assert [start(capture, name) for name in ("net.side", "bullets.mass", "tether.length")] == ["12.0", "1.27", "14.0"]
    assert start(removal, "tether.rest_length") == "14.0"
    for path, name, value in ((capture, "net.side", 12.0), (removal, "tether.rest_length", 14.0)):
        with Archive(path) as unpacked, Component(unpacked, "mission") as running:
            running.initialise(0.0)
            assert running.get([name]) == {name: value}


@pytest.mark.slow
def test_a_removal_after_a_hand_over_gives_the_numbers_of_its_run(mission: Path) -> None:
    path = mission / "fmus/mission-removal.fmu"
    assert validate_fmu(str(path)) == []
    experiment = fmpy.read_model_description(str(path)).defaultExperiment
    begin = float(experiment.startTime)
    handed = float(json.loads((mission / "run/ledger.json").read_text())["time"]["value"])
    assert (begin, float(experiment.stopTime), float(experiment.stepSize)) == (handed, handed + 6 * 3600.0, 10.0)
    assert begin > 1.0
    run = table(mission / "run", "removal")
    tow = simulated(path, begin)
    # fmpy's times are its own sums: at the last bits of a time the run has others
    worst = {n: np.max(np.abs(run[n][::4] - tow[n])) / np.max(np.abs(run[n])) for n in ("separation", "altitude")}
    assert max(worst.values()) < 1e-12
    assert tow["tether.tug_count"][-1] == run["tether.tug_count"][-1] > 3


@pytest.mark.slow
def test_a_capture_before_a_hand_over_gives_the_numbers_of_its_run(mission: Path) -> None:
    path = mission / "fmus/mission-capture.fmu"
    assert validate_fmu(str(path)) == []
    run = table(mission / "run", "capture")
    assert differing(run, simulated(path, until=run["time"][-1])) == set()


@pytest.mark.slow
def test_without_its_run_a_removal_after_a_hand_over_is_noted(mission: Path, dcone: Dcone, tmp_path: Path) -> None:
    code, out, said = dcone("build", "mission", "-o", "fmus")
    assert code == 0
    assert [Path(line).name for line in out.split()] == ["mission-capture.fmu", "mission-removal.fmu"]
    assert "note: the removal begins with what the capture hands over" in said
    assert "name its folder with --from-run" in said
    own, handed = tmp_path / "fmus/mission-removal.fmu", mission / "fmus/mission-removal.fmu"
    assert start(own, "tether.rest_length") == start(handed, "tether.rest_length") == "14.0"
    assert (start(own, "start.condition"), start(handed, "start.condition")) == ("0", "3")


@pytest.mark.slow
def test_a_run_of_another_scene_is_refused(mission: Path, dcone: Dcone, tmp_path: Path) -> None:
    setting = ("--set", 'capture.bullets.speed="3.1 m/s"')
    code, _, said = dcone("build", "mission", "-o", "fmus", "--from-run", str(mission / "run"), *setting)
    assert code == 2
    assert f"--from-run {mission / 'run'}: that run of 'mission' had other values" in said
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_a_damaged_run_is_refused_in_one_line(mission: Path, dcone: Dcone, tmp_path: Path) -> None:
    """A value that the model cannot have: key, value, what was expected, where."""
    run = Path(shutil.copytree(mission / "run", tmp_path / "run"))
    text = (run / "provenance.json").read_text()
    text, count = re.subn(r'"chaser\.mass": [\d.e+]+', '"chaser.mass": -1.0', text)
    assert count
    (run / "provenance.json").write_text(text)
    code, _, said = dcone("build", "mission", "-o", "fmus", "--from-run", str(run))
    assert code == 2
    assert (
        "mission-removal.fmu cannot start with the values it is to have: chaser.mass = -1 must be greater than 0"
        in said
    )
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


PAIR = """
[removal]
macro_step = "60 s"
duration = "2 h"
fmu = "fmus/reel-control-removal.fmu"
connections = [
    "removal.tether.length -> controller.length",
    "removal.tether.length_rate -> controller.length_rate",
    "controller.tension -> removal.reel.tension",
]
[removal.coupling]
method = "gauss_seidel"
step = "2 s"
extrapolation = "linear"
[removal.components.controller]
fmu = "fmus/reel-control-removal-controller.fmu"
"""
"""The scene reel-control without a single value of a model."""


@pytest.mark.slow
def test_a_pair_of_files_gives_the_numbers_of_its_scene(dcone: Dcone, tmp_path: Path) -> None:
    longer = ("--set", "removal.components.controller.reel.length=12.25 m")
    assert dcone("build", "reel-control", "-o", "fmus", *longer)[0] == 0
    (tmp_path / "pair.toml").write_text(PAIR)
    assert dcone("run", "reel-control", "-o", "one", "--no-figures", *longer)[0] == 0
    assert dcone("run", "pair.toml", "-o", "two", "--no-figures")[0] == 0
    assert differing(table(tmp_path / "one", "removal"), table(tmp_path / "two", "removal")) == set()
    for path in (tmp_path / "fmus").iterdir():
        assert validate_fmu(str(path)) == []
        assert len(simulated(path)["time"]) > 100
        assert fmpy.read_model_description(str(path)).defaultExperiment.stepSize == "2.0"
    # the twin: a controller with the model's own line
    shutil.copy(build.ensure([("reel_control", {"motor": "lag"})], print)[0], tmp_path / PAIR.split('"')[-2])
    assert dcone("run", "pair.toml", "-o", "three", "--no-figures")[0] == 0
    assert differing(table(tmp_path / "one", "removal"), table(tmp_path / "three", "removal"))


@pytest.mark.slow
def test_a_package_holds_fmus_with_the_scenes_values(dcone: Dcone, tmp_path: Path) -> None:
    assert dcone("export-ssp", "reel-control", "-o", "packages")[0] == 0
    assert dcone("build", "reel-control", "-o", "fmus")[0] == 0
    with zipfile.ZipFile(tmp_path / "packages/reel-control-removal.ssp") as package:
        for name, file in (("removal", "reel-control-removal"), ("controller", "reel-control-removal-controller")):
            assert package.read(f"resources/{name}.fmu") == (tmp_path / f"fmus/{file}.fmu").read_bytes()


@pytest.fixture
def pretended(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[str]:
    """An empty cache, and tools that only pretend; what they were called for."""
    called: list[str] = []

    def emit(model: Model, terms: Any, ir: Path, kept: Path) -> None:
        called.append(f"compile {model.name}")
        ir.write_text("; no kernels")

    def link(ir: Path, header: Path, library: Path, platform: Any) -> None:
        called.append(f"link {name_of(library)}")
        library.write_bytes(b"library")

    def name_of(library: Path) -> str:
        return library.stem

    monkeypatch.setattr(builds.compile, "emit", emit)
    monkeypatch.setattr(builds.link, "link", link)
    monkeypatch.setenv("DCONE_CACHE", str(tmp_path / "cache"))
    return called


def test_another_mass_costs_no_build(dcone: Dcone, tmp_path: Path, pretended: list[str]) -> None:
    said = {}
    for mass in ("2000 kg", "2001 kg"):
        code, _, said[mass] = dcone("build", "table2-deorbit", "-o", mass, "--set", f"removal.chaser.mass={mass}")
        assert code == 0
    assert pretended == ["compile tethered_deorbit", "link tethered_deorbit"]
    assert ("building" in said["2000 kg"], "building" in said["2001 kg"]) == (True, False)
    one, two = (tmp_path / mass / "table2-deorbit-removal.fmu" for mass in said)
    assert [start(path, "chaser.mass") for path in (one, two)] == ["2000.0", "2001.0"]
    guids = [fmpy.read_model_description(str(path)).guid for path in (one, two)]
    assert guids[0] != guids[1]
    assert len(list((tmp_path / "cache").glob("*.fmu"))) == 1


def test_the_same_scene_is_the_same_file(
    dcone: Dcone, tmp_path: Path, pretended: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """From another cache, into another folder, from a copy of the scene elsewhere."""
    assert dcone("build", "reel-control", "-o", "one")[0] == 0
    monkeypatch.setenv("DCONE_CACHE", str(tmp_path / "deeper/cache"))
    (tmp_path / "elsewhere").mkdir()
    shutil.copy(find("reel-control"), tmp_path / "elsewhere")
    assert dcone("build", "elsewhere/reel-control.toml", "-o", "deeper/two")[0] == 0
    files = sorted(path.name for path in (tmp_path / "one").iterdir())
    assert files == ["reel-control-removal-controller.fmu", "reel-control-removal.fmu"]
    for file in files:
        assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "deeper/two" / file).read_bytes()
        assert str(tmp_path).encode() not in b"".join(entries(tmp_path / "one" / file))


def entries(path: Path) -> Iterator[bytes]:
    with zipfile.ZipFile(path) as content:
        yield from (content.read(name) for name in content.namelist())


def test_the_page_names_the_scene_and_what_is_its_own(dcone: Dcone, tmp_path: Path, pretended: list[str]) -> None:
    assert dcone("build", "table2-deorbit", "-o", "fmus", "--set", "removal.chaser.mass=1234.5 kg")[0] == 0
    with zipfile.ZipFile(tmp_path / "fmus/table2-deorbit-removal.fmu") as content:
        page = content.read("documentation/index.html").decode()
    assert "those of the scene <code>table2-deorbit</code>" in page
    (row,) = re.findall(r"<tr>\s*<td><code>chaser.mass</code></td>\s*<td><strong>.*?</tr>", page, re.S)
    assert re.findall(r"[\d.]+|kg", re.sub("<.*?>", " ", row.partition("</td>")[2])) == ["1234.5", "kg", "2000.0"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("harm", "words"),
    [
        (lambda files: files.pop("resources/start-values.bin"), "No such file"),
        (lambda files: files.update({"resources/start-values.bin": b""}), "holds no start values"),
        (lambda files: flip(files, "resources/start-values.bin"), "check word does not fit"),
        (lambda files: rename(files), "is not that of this FMU"),
    ],
)
def test_an_archive_that_was_changed_is_refused_with_its_reason(
    dcone: Dcone, tmp_path: Path, harm: Callable[[dict[str, bytes]], None], words: str
) -> None:
    """As any tool sees it, by the log; nothing starts with other values."""
    assert dcone("build", "table2-deorbit", "-o", "fmus")[0] == 0
    path = tmp_path / "fmus/table2-deorbit-removal.fmu"
    with zipfile.ZipFile(path) as content:
        files = {name: content.read(name) for name in content.namelist()}
    harm(files)
    builds.pack(files, path)
    with Archive(path) as unpacked, pytest.raises(FmuError, match=words):
        Component(unpacked, "tow")


def flip(files: dict[str, bytes], name: str) -> None:
    data = files[name]
    files[name] = data[:400] + bytes([data[400] ^ 1]) + data[401:]


def rename(files: dict[str, bytes]) -> None:
    files["modelDescription.xml"] = re.sub(rb'guid="{.', b'guid="{x', files["modelDescription.xml"])


def test_values_that_a_model_cannot_have_are_bad_input(tmp_path: Path, pretended: list[str]) -> None:
    experiment = build.Experiment(0.0, 1.0, 0.1, "mine")
    wanted = build.Furnished("mine-control", "reel_control", {}, {"reel.length": -1.0}, experiment)
    with pytest.raises(InputError, match=r"mine-control\.fmu cannot start .*: reel\.length = -1 must be"):
        build.write_fmus([wanted], (), tmp_path, print)
    assert pretended == []
