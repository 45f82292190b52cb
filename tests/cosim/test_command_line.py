"""The command line on its way out: what goes to which stream, which exit code, and that nothing is lost or left."""

from __future__ import annotations

import errno
import json
import os
import re
import signal
import subprocess
import sys
import textwrap
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from dcone_cosim import cli, commands, drafts, interrupts, running
from dcone_cosim.progress import Bar, Lines, Progress
from dcone_cosim.scene.data import Scene
from tests.cosim.conftest import Dcone
from tests.cosim.mock_components import MockCapture, MockRemoval


class NoArchives:
    """Stands in for the FMUs' archives; `meanwhile` is done while the run goes on."""

    meanwhile: Callable[[], object] = staticmethod(lambda: None)

    def __init__(self, scene: Scene, progress: Progress) -> None:
        progress.say("building nothing")

    def instantiate(self, phase: str, name: str) -> object:
        type(self).meanwhile()
        return MockCapture(reports=True) if phase == "capture" else MockRemoval(tugs=[(12.0, 5.0, 0.01)])

    def adopt(self, phase: object) -> None:
        raise AssertionError("stand-ins have no levels")

    def facts(self) -> dict[str, dict[str, object]]:
        return {}

    def __enter__(self) -> NoArchives:
        return self

    def __exit__(self, *_: object) -> None:
        pass


@pytest.fixture
def stand_in(monkeypatch: pytest.MonkeyPatch, make_scene: Callable[..., Scene]) -> type[NoArchives]:
    """`dcone run mock` without FMUs; set `meanwhile` to do something during the run."""

    class SceneFmus(NoArchives):
        pass

    monkeypatch.setattr(running, "SceneFmus", SceneFmus)
    monkeypatch.setattr(commands, "named", lambda *_: make_scene("capture", "removal"))
    return SceneFmus


def raising(error: BaseException) -> Callable[[], object]:
    def now() -> object:
        raise error

    return now


def test_progress_goes_to_stderr_and_results_to_stdout(dcone: Dcone, stand_in: type[NoArchives]) -> None:
    code, out, err = dcone("run", "mock", "-o", "out")
    assert code == 0
    assert "building nothing" in err
    assert "building" not in out
    assert out.rstrip().endswith("results in out")
    code, out, _ = dcone("run", "mock", "-o", "out2", "--json")
    assert json.loads(out)["folder"] == "out2"


def test_a_folder_that_appears_meanwhile_is_not_touched(dcone: Dcone, stand_in: type[NoArchives]) -> None:
    def appear() -> None:
        Path("out").mkdir(exist_ok=True)
        Path("out/thesis.tex").write_text("years of work")

    stand_in.meanwhile = staticmethod(appear)
    code, out, err = dcone("run", "mock", "-o", "out", "--no-figures")
    assert code == 0
    assert "results in out-2" in out
    assert "out came to be while the scene ran" in err
    assert [p.name for p in Path("out").iterdir()] == ["thesis.tex"]
    assert Path("out-2/summary.json").exists()


@pytest.mark.parametrize(
    "notes", ["notes.txt", "fmus/notes.txt", "mine.parquet", "mine.png", "deep/er/notes.txt", "empty/"]
)
def test_force_replaces_its_own_files_alone(dcone: Dcone, stand_in: type[NoArchives], notes: str) -> None:
    assert dcone("run", "mock", "-o", "out", "--csv")[0] == 0
    mine = Path("out", notes)
    mine.parent.mkdir(parents=True, exist_ok=True)
    if notes.endswith("/"):
        mine.mkdir()
    else:
        mine.write_text("years of work")
    before = {p: p.read_bytes() for p in Path("out").rglob("*") if p.is_file()}
    code, _, err = dcone("run", "mock", "-o", "out", "--no-figures", "--force")
    assert code == 2
    assert f"out holds what no run wrote there: {notes.rstrip('/')}; --force replaces the files of a run alone" in err
    assert {p: p.read_bytes() for p in Path("out").rglob("*") if p.is_file()} == before
    mine.rename("moved")
    for folder in sorted(Path("out").rglob("*"), reverse=True):
        if folder.is_dir():
            folder.rmdir()
    Path("out/.DS_Store").touch()
    assert dcone("run", "mock", "-o", "out", "--no-figures", "--force")[0] == 0
    assert not [name for name in ("capture.csv", "tension.png", ".DS_Store") if Path("out", name).exists()]
    assert sorted(p.name for p in Path().iterdir()) == ["moved", "out"]


def test_notes_that_come_while_it_runs_stay(dcone: Dcone, stand_in: type[NoArchives]) -> None:
    assert dcone("run", "mock", "-o", "out", "--no-figures")[0] == 0
    stand_in.meanwhile = staticmethod(lambda: Path("out/notes.txt").write_text("years of work"))
    code, out, err = dcone("run", "mock", "-o", "out", "--no-figures", "--force")
    assert (code, "results in out-2" in out, "was not touched" in err) == (0, True, True)
    assert Path("out/notes.txt").read_text() == "years of work"
    assert Path("out/summary.json").exists()
    assert sorted(p.name for p in Path().iterdir()) == ["out", "out-2"]


def test_two_runs_within_a_second_keep_their_results(
    dcone: Dcone, stand_in: type[NoArchives], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(commands, "default_folder", lambda scene: Path("runs") / f"{scene}-now")
    stand_in.meanwhile = staticmethod(lambda: Path("runs/mock-now").mkdir(exist_ok=True))
    Path("runs").mkdir()
    code, out, err = dcone("run", "mock", "--no-figures")
    assert (code, "results in runs/mock-now-2" in out, "came to be" in err) == (0, True, False)
    assert not list(Path("runs/mock-now").iterdir())


def test_an_empty_folder_is_free(dcone: Dcone, stand_in: type[NoArchives]) -> None:
    Path("out").mkdir()
    code, out, _ = dcone("run", "mock", "-o", "out", "--no-figures")
    assert (code, "results in out\n" in out) == (0, True)
    assert Path("out/summary.json").exists()
    assert sorted(p.name for p in Path().iterdir()) == ["out"]


def test_a_figure_that_fails_costs_no_numbers(
    dcone: Dcone, stand_in: type[NoArchives], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("dcone_cosim.reports.figures.draw_all", lambda *_: 1 / 0)
    code, _, err = dcone("run", "mock", "-o", "out")
    assert code == 0
    assert "no figure could be drawn: ZeroDivisionError" in err
    assert Path("out/removal.parquet").exists()


@pytest.mark.parametrize(
    ("error", "code", "told"),
    [
        (OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "out/x.parquet"), 2, "out/x.parquet: No space left"),
        (PermissionError(errno.EACCES, os.strerror(errno.EACCES), "/cache/dcone"), 2, "/cache/dcone: Permission"),
        (KeyboardInterrupt(), 130, "interrupted; nothing was written"),
        (SystemExit(143), 143, "terminated; nothing was written"),
    ],
)
def test_one_line_and_nothing_left(
    dcone: Dcone, stand_in: type[NoArchives], error: BaseException, code: int, told: str
) -> None:
    stand_in.meanwhile = staticmethod(raising(error))
    given, out, err = dcone("run", "mock", "-o", "deep/out")
    assert given == code
    assert told in err
    assert "Traceback" not in err
    assert not out
    assert not list(Path().iterdir())


def test_a_fault_of_ours_keeps_its_traceback(stand_in: type[NoArchives], monkeypatch: pytest.MonkeyPatch) -> None:
    stand_in.meanwhile = staticmethod(raising(ZeroDivisionError()))
    monkeypatch.setattr("sys.argv", ["dcone", "run", "mock", "-o", "out"])
    with pytest.raises(ZeroDivisionError):
        cli.main()


def test_a_place_that_cannot_be_written_is_told_before_the_run(dcone: Dcone, stand_in: type[NoArchives]) -> None:
    stand_in.meanwhile = staticmethod(raising(AssertionError("the run began")))
    code, _, err = dcone("run", "mock", "-o", "/proc/out")
    assert code == 2
    assert "/proc" in err


@pytest.mark.parametrize("arguments", [("run", "misson"), ("run", "mission", "--fast"), ("run",), ("run", "")])
def test_bad_input_as_json(dcone: Dcone, arguments: tuple[str, ...]) -> None:
    code, out, err = dcone(*arguments, "--json")
    answer = json.loads(out)
    assert code == answer["exit_code"] == 2
    assert answer["error"] in err


def test_an_empty_name(dcone: Dcone) -> None:
    for command in (("run", ""), ("inspect", ""), ("build", "", "-o", "x")):
        code, _, err = dcone(*command)
        assert (code, "name of the scene is empty" in err) == (2, True)


def test_the_help_tells_the_default_folder(dcone: Dcone) -> None:
    code, out, _ = dcone("run", "--help")
    assert code == 0
    assert "runs/SCENE-TIME" in out


PROGRAM = """
    import sys, time
    from pathlib import Path
    sys.path.insert(0, {root!r})
    from dcone_cosim import cli, commands, running
    from tests.cosim.conftest import scene_of
    from tests.cosim.test_command_line import NoArchives
    running.SceneFmus, commands.named = NoArchives, lambda *_: scene_of("capture", "removal")
    NoArchives.meanwhile = staticmethod(lambda: {act})
    sys.argv = ["dcone", "run", "mock", "-o", "deep/out", "--no-figures"]
    cli.main()
"""


def start(tmp_path: Path, act: str) -> subprocess.Popen[bytes]:
    program = textwrap.dedent(PROGRAM).format(root=str(Path(__file__).parents[2]), act=act)
    return subprocess.Popen(
        [sys.executable, "-c", program], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_signals_leave_nothing(tmp_path: Path, number: int, code: int) -> None:
    with start(tmp_path, "(Path('running').touch(), time.sleep(30))") as process:
        until = time.monotonic() + 20.0
        while not (tmp_path / "running").exists() and time.monotonic() < until:
            time.sleep(0.02)
        process.send_signal(number)
        _, err = process.communicate(timeout=20)
    assert process.returncode == code
    assert len(err.decode().splitlines()) == 2  # what was being built, and the one line
    assert b"nothing was written" in err
    assert [p.name for p in tmp_path.iterdir()] == ["running"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
@pytest.mark.parametrize("more", ["", ', "--json"'])
def test_a_full_disk_behind_stdout_is_told_truthfully(tmp_path: Path, more: str) -> None:
    """The results stand, and so it is said."""
    program = textwrap.dedent(PROGRAM).format(root=str(Path(__file__).parents[2]), act="None")
    program = program.replace('"--no-figures"', '"--no-figures"' + more)
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [sys.executable, "-c", program], cwd=tmp_path, stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert done.returncode == 1
    last = done.stderr.splitlines()[-1]
    assert last == "dcone: No space left on device; written before that, and complete: deep/out"
    assert "Traceback" not in done.stderr
    assert "Exception" not in done.stderr
    assert (tmp_path / "deep/out/summary.json").exists()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
def test_a_full_disk_behind_an_answer(tmp_path: Path) -> None:
    program = "import sys; sys.argv = ['dcone', 'list']; from dcone_cosim import cli; cli.main()"
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [sys.executable, "-c", program], stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert (done.returncode, done.stderr) == (2, "dcone: No space left on device; nothing was written\n")


@pytest.mark.parametrize(
    ("error", "code", "told"),
    [
        (OSError(errno.EIO, os.strerror(errno.EIO)), 1, "dcone: Input/output error; "),
        (KeyboardInterrupt(), 130, "dcone: interrupted; "),
        (SystemExit(143), 143, "dcone: terminated; "),
    ],
)
def test_after_the_rename_nobody_says_that_nothing_was_written(
    dcone: Dcone,
    stand_in: type[NoArchives],
    monkeypatch: pytest.MonkeyPatch,
    error: BaseException,
    code: int,
    told: str,
) -> None:
    to_disk = drafts.to_disk

    def fails(path: Path) -> None:
        if path.name != "deep":
            return to_disk(path)
        raise error

    monkeypatch.setattr(drafts, "to_disk", fails)
    given, _, err = dcone("run", "mock", "-o", "deep/out", "--no-figures")
    assert given == code
    assert f"{told}written before that, and complete: deep/out" in err
    assert Path("deep/out/summary.json").exists()
    assert os.listdir("deep") == ["out"]


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_a_signal_in_the_rename_comes_after_it(
    dcone: Dcone, stand_in: type[NoArchives], monkeypatch: pytest.MonkeyPatch
) -> None:
    take = drafts._take_name

    def interrupted(*arguments: object) -> Path:
        os.kill(os.getpid(), signal.SIGINT)
        return take(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(interrupts, "arm", lambda: None)
    monkeypatch.setattr(drafts, "_take_name", interrupted)
    code, _, err = dcone("run", "mock", "-o", "out", "--no-figures")
    assert (code, "interrupted; written before that, and complete: out" in err) == (130, True)
    assert Path("out/summary.json").exists()


@pytest.mark.skipif(os.name == "nt", reason="pipes of POSIX")
def test_a_reader_that_leaves_disturbs_nothing(tmp_path: Path) -> None:
    with start(tmp_path, "None") as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        err = process.stderr.read()
        process.wait(timeout=20)
    assert process.returncode == 0
    assert b"Traceback" not in err
    assert b"Exception" not in err
    assert (tmp_path / "deep/out/summary.json").exists()


def test_a_log_that_nobody_reads_does_not_end_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    class Closed:
        def write(self, _: str) -> int:
            raise BrokenPipeError

        def flush(self) -> None:
            raise BrokenPipeError

    monkeypatch.setattr("sys.stderr", Closed())
    Lines().say("building")


@pytest.mark.parametrize("width", [60, 80, 120])
def test_the_bar_fits_its_terminal(width: int) -> None:
    import io

    from rich.console import Console

    console = Console(file=io.StringIO(), width=width, force_terminal=True, color_system=None)
    bar = Bar(console)
    bar.begin("removal without recoil", 8.14, 21608.14)
    bar.at(12345.6)
    bar.end()
    bar.close()
    text = console.file.getvalue()  # type: ignore[attr-defined]
    assert "removal without recoil" in text
    assert "…" not in text
    assert "12,346 of 21,608 s" in text or "12,345.6 of 21,608 s" in text
    bare = re.sub(r"\x1b\[[?0-9;]*[A-Za-z]", "", text)
    assert max(len(line) for line in bare.replace("\r", "\n").splitlines()) <= width


@pytest.mark.parametrize("closed", ["1", "2", "1 2"])
def test_streams_closed_from_the_start(closed: str) -> None:
    shut = " ".join(f"{stream}>&-" for stream in closed.split())
    program = f"{sys.executable} -c 'from dcone_cosim.cli import main; main()' list {shut}"
    assert subprocess.run(["bash", "-c", program], check=False).returncode == 0
