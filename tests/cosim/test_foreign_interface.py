"""The interface of a phase's FMU: our own FMUs meet it, and what `dcone interface` writes can be swapped in."""

from __future__ import annotations

import io
import math
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import fmpy
import pytest
from rich.console import Console

from dcone_cosim import build as models
from dcone_cosim import cli
from dcone_cosim.contract import asked, check_contract
from dcone_cosim.errors import SUCCESS, InputError
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.fmu.component import Component
from dcone_cosim.fmu.isolation import IsolatedComponent
from dcone_cosim.interface_kit import show, write_template
from dcone_cosim.loading import load
from dcone_cosim.master import run_scene
from dcone_cosim.phases import kinds
from dcone_cosim.progress import Progress
from dcone_cosim.scene.data import Scene
from tests.cosim.fmus.build import build as build_fmu
from tests.cosim.mock_components import MockCapture
from tests.validating import validate_fmu

HANDS_OVER = kinds()["removal"].takes
"""What a capture hands over to a removal."""

Make = Callable[..., Scene]


@pytest.mark.slow
def test_our_own_fmus_meet_the_contract() -> None:
    phases = {phase.name: phase for phase in load("mission").phases}
    built = models.ensure([(phase.main.model, phase.main.terms) for phase in phases.values()], lambda _: None)
    paths = dict(zip(phases, built, strict=True))
    for name, path in paths.items():
        with Archive(path) as archive:
            assert check_contract(archive, kinds()[name], True, HANDS_OVER, hand_over="captured") == []
            other = "removal" if name == "capture" else "capture"
            assert len(check_contract(archive, kinds()[other], True, HANDS_OVER, hand_over="captured")) > 10


@pytest.mark.parametrize("phase", ["capture", "removal"])
def test_the_table_names_everything(phase: str) -> None:
    console = Console(file=io.StringIO(), width=200)
    show(phase, console)
    text = console.file.getvalue()  # type: ignore[attr-defined]
    for row in asked(kinds()[phase]):
        assert row.name.partition("[")[0] in text
        assert row.causality in text
    assert "N.m.s" in text or phase == "removal"


@pytest.fixture(scope="module")
def kits(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The C templates of both phases, built as a user would, without a single warning."""
    cmake = shutil.which("cmake", path=f"{Path(sys.executable).parent}:/usr/local/bin:/usr/bin:/bin")
    if cmake is None or not any(shutil.which(name) for name in ("cc", "gcc", "clang")):
        pytest.skip("needs CMake and a C compiler")
    made = {}
    for phase in ("capture", "removal"):
        folder = tmp_path_factory.mktemp("kit") / phase
        write_template(phase, "c", folder)
        work = folder / "build"
        for command in (
            [cmake, "-S", str(folder), "-B", str(work), f"-DPython3_EXECUTABLE={sys.executable}"],
            [cmake, "--build", str(work)],
        ):
            done = subprocess.run(command, capture_output=True, text=True)
            assert done.returncode == 0, done.stdout + done.stderr
            assert "warning" not in (done.stdout + done.stderr).lower()
        made[phase] = work / f"my_{phase}.fmu"
    return made


@pytest.mark.parametrize("phase", ["capture", "removal"])
def test_the_c_template_is_a_valid_fmu(kits: dict[str, Path], phase: str) -> None:
    assert validate_fmu(str(kits[phase])) == []
    with Archive(kits[phase]) as archive:
        assert check_contract(archive, kinds()[phase], True, HANDS_OVER, hand_over="tether_taut") == []
        assert check_contract(archive, kinds()[phase], True, HANDS_OVER, hand_over="settled") == []
    result = fmpy.simulate_fmu(str(kits[phase]), stop_time=10.0, output_interval=1.0)
    assert len(result) == 11


def test_nothing_is_left_to_fill_in_but_the_model(tmp_path: Path) -> None:
    for path in write_template("removal", "c", tmp_path / "kit"):
        assert not re.search("@[A-Z]+@", path.read_text())


def test_both_c_templates_fly_a_mission(kits: dict[str, Path], make_scene: Make) -> None:
    with Archive(kits["capture"]) as capture, Archive(kits["removal"]) as removal:
        for isolate in (False, True):

            def instantiate(phase: str, name: str, isolate: bool = isolate):
                archive = capture if phase == "capture" else removal
                return IsolatedComponent(archive, name) if isolate else Component(archive, name)

            scene = make_scene("capture", "removal", point_tolerance=math.inf)
            scene.phases[0].main.parameters["tether.length"] = 20.0  # type: ignore[index]
            result = run_scene(scene, instantiate, Progress())
            assert result.exit_code == SUCCESS, result.message
            assert result.handovers["removal"] is not None
            assert result.handovers["removal"].time == 16.0 / 3.0
            assert all(row.closed for row in result.handovers["removal"].rows)
            assert [check.quantity for check in result.handovers["removal"].checks] == [
                "separation",
                "size of relative.position",
                "size of relative.velocity",
            ]
            assert result.phases["removal"].outcome == "completed"


def test_a_rate_counted_in_turns_is_not_taken_for_one_in_radians(tmp_path: Path) -> None:
    """`rad/s` under the name Hz, once without its radians and once with them and the factor."""
    for base, fits in (('s="-1"', False), ('s="-1" rad="1" factor="6.283185307179586"', True)):

        def in_turns(xml: str, base: str = base) -> str:
            changed = xml.replace('unit="rad/s"', 'unit="Hz"').replace('<Unit name="rad/s">', '<Unit name="Hz">')
            changed = changed.replace('<BaseUnit s="-1" rad="1" />', f"<BaseUnit {base} />")
            assert base in changed
            return changed

        with Archive(build_fmu(tmp_path, "capture", change=in_turns)) as archive:
            faults = check_contract(archive, kinds()["capture"], True, HANDS_OVER)
        told = [fault for fault in faults if "its unit is Hz (1/s); expected rad/s" in fault]
        assert len(told) == (0 if fits else 3), faults


@pytest.mark.parametrize("isolate", [False, True])
def test_the_python_template_tows(tmp_path: Path, make_scene: Make, isolate: bool) -> None:
    pytest.importorskip("pythonfmu")
    (script,) = write_template("removal", "pythonfmu", tmp_path / "kit")
    built = subprocess.run(
        [sys.executable, "-m", "pythonfmu", "build", "-f", str(script), "-d", str(tmp_path)],
        capture_output=True,
        text=True,
    )
    assert built.returncode == 0, built.stderr
    with Archive(tmp_path / "MyRemoval.fmu") as archive:
        assert check_contract(archive, kinds()["removal"], True, HANDS_OVER) == []

        def instantiate(phase: str, name: str):
            if phase == "capture":
                return MockCapture(reports=True)
            return IsolatedComponent(archive, name) if isolate else Component(archive, name)

        result = run_scene(make_scene("capture", "removal"), instantiate, Progress())
    assert result.exit_code == SUCCESS, result.message
    assert result.phases["removal"].outcome == "completed"


def test_the_python_template_captures(tmp_path: Path, make_scene: Make) -> None:
    pytest.importorskip("pythonfmu")
    (script,) = write_template("capture", "pythonfmu", tmp_path / "kit")
    command = [sys.executable, "-m", "pythonfmu", "build", "-f", str(script), "-d", str(tmp_path)]
    subprocess.run(command, check=True, capture_output=True)
    with Archive(tmp_path / "MyCapture.fmu") as archive:
        assert check_contract(archive, kinds()["capture"], True, HANDS_OVER, hand_over="captured") == []
        result = run_scene(make_scene("capture"), lambda _, name: IsolatedComponent(archive, name), Progress())
    assert result.exit_code == SUCCESS, result.message
    assert result.phases["capture"].located == 5.5


def test_a_template_replaces_nothing(tmp_path: Path) -> None:
    (tmp_path / "mine.c").write_text("years of work")
    with pytest.raises(InputError, match="already exists"):
        write_template("removal", "c", tmp_path)
    assert [p.name for p in tmp_path.iterdir()] == ["mine.c"]
    with pytest.raises(InputError, match=r"no template named 'C'"):
        write_template("removal", "C", tmp_path / "new")
    with pytest.raises(InputError, match=r"no phase named 'captur'; did you mean 'capture'"):
        write_template("captur", "c", tmp_path / "new")


def test_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    for arguments, words in (
        (["capture"], "catch.inertia[1..6]"),
        (["removal", "--template", "c"], "my_removal/model.c"),
        (["removal", "--template", "pythonfmu", "-o", "here"], "here/my_removal.py"),
    ):
        monkeypatch.setattr("sys.argv", ["dcone", "interface", *arguments])
        with pytest.raises(SystemExit) as stop:
            cli.main()
        assert stop.value.code == 0
        assert words in capfd.readouterr().out
