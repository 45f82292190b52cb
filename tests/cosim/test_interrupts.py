"""Ctrl-C or SIGTERM in a run: what was reached is kept, marked, with an exit code of its own; and how a log follows."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import textwrap
import time
from collections.abc import Callable
from pathlib import Path

import pyarrow.parquet
import pytest

from dcone_cosim import commands, interrupts, progress, running
from dcone_cosim.phases import recoil
from dcone_cosim.progress import Lines, Progress
from dcone_cosim.scene.data import Scene
from tests.cosim.conftest import Dcone
from tests.cosim.mock_components import MockCapture, MockRemoval
from tests.cosim.test_command_line import NoArchives

pytestmark = pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
ROOT = str(Path(__file__).parents[2])


def signalled(kind: type, at: float, number: int, times: int = 1) -> type:
    """A stand-in that gets a signal in the step that ends at this time since its start [s]."""

    class Signalled(kind):  # type: ignore[misc]
        def step(self, time: float, size: float) -> None:
            super().step(time, size)
            if abs(self.since - at) < 1e-9:
                for _ in range(times):
                    os.kill(os.getpid(), number)

    return Signalled


@pytest.fixture
def stand_ins(monkeypatch: pytest.MonkeyPatch, make_scene: Callable[..., Scene]) -> Callable[..., None]:
    """`dcone run mock` with these stand-ins; `after_runs` comes after so many removals."""

    def use(capture: type = MockCapture, *removals: type) -> None:
        coming = list(removals)

        class SceneFmus(NoArchives):
            def instantiate(self, phase: str, name: str) -> object:
                if phase == "capture":
                    return capture(reports=True)
                return (coming.pop(0) if coming else MockRemoval)(tugs=[(12.0, 5.0, 0.01)])

        monkeypatch.setattr(running, "SceneFmus", SceneFmus)
        monkeypatch.setattr(commands, "named", lambda *_: make_scene("capture", "removal"))

    return use


def rows(name: str) -> list[float]:
    return list(pyarrow.parquet.read_table(f"out/{name}.parquet")["time"].to_pylist())


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_what_was_reached_is_kept(dcone: Dcone, stand_ins, number: int) -> None:
    before = [signal.getsignal(n) for n in interrupts.SIGNALS]
    stand_ins(MockCapture, signalled(MockRemoval, 40.0, number))
    code, out, err = dcone("run", "mock", "-o", "out")
    told = json.loads(Path("out/provenance.json").read_text())
    assert (code, told["exit_code"], told["status"]) == (6, 6, "interrupted")
    assert "at t = 40 s of the removal; what was reached is kept" in told["message"]
    assert told["message"] in err
    assert "nothing was written" not in err
    assert "results in out" in out
    assert "no figure was drawn" in err
    assert rows("removal") == [0.0, 10.0, 20.0, 30.0, 40.0]
    assert rows("capture")[-1] == pytest.approx(7.1234567)
    assert json.loads(Path("out/summary.json").read_text())["status"] == "interrupted"
    assert [p.name for p in Path().iterdir()] == ["out"]
    assert [signal.getsignal(n) for n in interrupts.SIGNALS] == before


def test_in_the_capture_no_removal_follows(dcone: Dcone, stand_ins) -> None:
    stand_ins(signalled(MockCapture, 3.0, signal.SIGINT))
    code, _, err = dcone("run", "mock", "-o", "out", "--json")
    assert code == 6
    assert "at t = 3 s of the capture" in err
    assert rows("capture") == pytest.approx([0.5 * i for i in range(7)])
    assert not Path("out/removal.parquet").exists()


def test_in_the_comparison_the_removal_is_whole(dcone: Dcone, stand_ins, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(recoil, "COARSE", 2)
    stand_ins(MockCapture, MockRemoval, signalled(MockRemoval, 20.0, signal.SIGTERM))
    assert dcone("run", "mock", "-o", "out")[0] == 6
    assert rows("removal")[-1] == 100.0


def test_twice_keeps_nothing(dcone: Dcone, stand_ins) -> None:
    stand_ins(MockCapture, signalled(MockRemoval, 40.0, signal.SIGINT, times=2))
    code, _, err = dcone("run", "mock", "-o", "out")
    assert (code, "interrupted; nothing was written" in err) == (130, True)
    assert not list(Path().iterdir())


def test_while_results_are_written_they_are_finished(dcone: Dcone, stand_ins, monkeypatch: pytest.MonkeyPatch) -> None:
    stand_ins()
    write = commands.fill

    def fill(*arguments: object) -> None:
        os.kill(os.getpid(), signal.SIGINT)
        write(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(commands, "fill", fill)
    code, out, _ = dcone("run", "mock", "-o", "out")
    assert (code, "results in out" in out) == (0, True), "the run itself was over"
    assert rows("removal")[-1] == 100.0


def test_only_the_command_takes_signals(make_scene: Callable[..., Scene]) -> None:
    """`run_scene` in somebody's own program leaves signals alone."""
    before = [signal.getsignal(n) for n in interrupts.SIGNALS]
    interrupts.arm()
    assert [signal.getsignal(n) for n in interrupts.SIGNALS] == before
    assert not interrupts.noted()


SLOW = """
    import sys, time
    sys.path.insert(0, {root!r})
    from dcone_cosim import cli, commands, progress, running
    from tests.cosim.conftest import scene_of
    from tests.cosim.mock_components import MockCapture, MockRemoval
    from tests.cosim.test_command_line import NoArchives
    class Slow(MockRemoval):
        def step(self, at, size):
            print("stepping", flush=True)
            time.sleep({pause})
            super().step(at, size)
    NoArchives.instantiate = lambda self, phase, name: MockCapture() if phase == "capture" else Slow(tugs=[])
    running.SceneFmus, commands.named = NoArchives, lambda *_: scene_of("capture", "removal")
    progress.REMINDER = {reminder}
    sys.argv = ["dcone", "run", "mock", "-o", "out", "--no-figures"]
    cli.main()
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_from_outside(tmp_path: Path, number: int) -> None:
    program = textwrap.dedent(SLOW).format(root=ROOT, pause=0.4, reminder=0.1)
    pipe = subprocess.PIPE
    with subprocess.Popen([sys.executable, "-c", program], cwd=tmp_path, stdout=pipe, stderr=pipe) as process:
        assert process.stderr is not None
        for line in process.stderr:  # what the FMU prints goes there
            if line == b"stepping\n":
                break
        time.sleep(0.5)
        process.send_signal(number)
        _, err = process.communicate(timeout=20)
    assert process.returncode == 6
    assert b"removal: 0 of 100 s, 0 s so far" in err, "and meanwhile it has told where it was"
    table = pyarrow.parquet.read_table(tmp_path / "out" / "removal.parquet")
    assert 2 <= len(table) <= 5


def test_at_least_every_ten_seconds(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    assert progress.REMINDER <= 9.0
    monkeypatch.setattr(progress, "REMINDER", 0.05)
    lines = Lines()
    lines.begin("removal", 0.0, 21600.0)
    lines.at(1234.5)
    time.sleep(0.3)
    lines.end()
    said = capsys.readouterr().err.splitlines()
    assert said[0] == "removal: 1234.5 of 21600 s, 0 s so far"
    assert len(said) >= 3
    assert said[-1].startswith("removal: 1234.5 s simulated in")
    time.sleep(0.15)
    assert not capsys.readouterr().err, "once a phase is over nothing more is said of it"


class TestPlaces:
    def test_a_name_that_is_no_text(self, dcone: Dcone, stand_ins) -> None:
        stand_ins(type("Never", (), {"__init__": lambda *_, **__: pytest.fail("the run began")}))
        for place in (os.fsdecode(b"\xff"), os.fsdecode(b"deep/\xe4/out")):
            code, out, err = dcone("run", "mock", "-o", place)
            assert (code, out) == (2, "")
            assert "this name is not UTF-8" in err
            assert "Traceback" not in err
            with pytest.raises(commands.InputError, match="not UTF-8"):
                commands.run_and_write("mock", Path(place), Progress())
        assert not list(Path().iterdir())

    @pytest.mark.parametrize("place", ["x" * 256, "\u5b87" * 86, "a/" + "y" * 300 + "/out"])
    def test_a_name_that_is_too_long(self, dcone: Dcone, stand_ins, place: str) -> None:
        stand_ins(type("Never", (), {"__init__": lambda *_, **__: pytest.fail("the run began")}))
        code, _, err = dcone("run", "mock", "-o", place)
        assert (code, "cannot be written: File name too long" in err) == (2, True)
        assert not list(Path().iterdir())

    @pytest.mark.parametrize("command", ["build", "export-ssp"])
    @pytest.mark.parametrize("place", ["x" * 256, "/proc/out", os.fsdecode(b"\xff"), "file", "file/out"])
    def test_files_for_others_too(
        self, dcone: Dcone, monkeypatch: pytest.MonkeyPatch, command: str, place: str
    ) -> None:
        monkeypatch.setattr("dcone_cosim.ours.fmus._built", lambda *_: pytest.fail("the build began"))
        Path("file").touch()
        code, _, err = dcone(command, "table2-deorbit", "-o", place)
        assert (code, len(err.splitlines())) == (2, 1)
        assert [p.name for p in Path().iterdir()] == ["file"]

    @pytest.mark.parametrize("place", ["y" * 255, "\u5b87" * 85])
    def test_the_longest_name_works(self, dcone: Dcone, stand_ins, place: str) -> None:
        stand_ins()
        assert dcone("run", "mock", "-o", place, "--no-figures")[0] == 0
        assert [p.name for p in Path().iterdir()] == [place]
