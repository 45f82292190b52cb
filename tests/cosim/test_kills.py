"""A process killed at any file event leaves nothing that the next does not clear, and no result is ever lost.

A child runs with a hook that counts what changes files (opening for writing, making, renaming, removing) and kills it
just before the n-th; n goes up until the child comes to its end.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import textwrap
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

from dcone_cosim import commands, running, scratch
from dcone_cosim.drafts import contents
from dcone_cosim.interface_kit import write_template
from dcone_cosim.loading import load
from dcone_cosim.progress import Progress
from dcone_cosim.run_folder import as_json
from dcone_cosim.scratch import PREFIX, Scratch, clear_left
from dcone_cosim.ssp.export import export_scene
from fmu_src.catalogue import MODELS
from fmu_src.packaging import builds, kept
from tests.cosim.mock_components import MockCapture

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="forks")
CHANGES = {"os.mkdir", "os.rename", "os.remove", "os.rmdir", "os.chmod", "os.link", "os.truncate"}
WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT
ROOT = str(Path(__file__).parents[2])


def kill_at(event: int) -> None:
    """Let this process be killed at its n-th file event from now on."""
    count = 0

    def hook(name: str, arguments: Any) -> None:
        nonlocal count
        if name in CHANGES or (name == "open" and arguments[2] & WRITING):
            count += 1
            if count == event:
                os.kill(os.getpid(), signal.SIGKILL)

    sys.addaudithook(hook)


def killed_everywhere(work: Callable[[], object]) -> Iterator[int]:
    """Do the work in a child that is killed at its first file event, at its second, and so on."""
    for event in range(1, 10_000):
        child = os.fork()
        if not child:
            try:
                kill_at(event)
                work()
            finally:
                os._exit(0)
        if os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0:
            return
        yield event


class Unpacking:
    """Stands in for the FMUs' archives, with something unpacked."""

    def __init__(self, *_: object) -> None:
        self.unpacked = Scratch.temporary()
        (self.unpacked.path / "modelDescription.xml").write_text("<fmi/>")

    def adopt(self, phase: object) -> None: ...

    def __enter__(self) -> Unpacking:
        return self

    def __exit__(self, *_: object) -> None:
        self.unpacked.remove()

    def instantiate(self, *_: object) -> MockCapture:
        return MockCapture()

    def facts(self) -> dict[str, object]:
        return {}


FILES = ["deep/b.parquet", "provenance.json", "scene.toml", "summary.json"]
made = 0
"""Number of the run; every file of its folder says it."""


def fill(folder: Path, *_: object) -> None:
    (folder / "deep").mkdir()
    for name in FILES:
        (folder / name).write_text(as_json({"run": made, "files": FILES}))


def whole(folder: Path) -> bool:
    return contents(folder) == FILES and len({(folder / name).read_text() for name in FILES}) == 1


@pytest.fixture
def place(tmp_path: Path, make_scene, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder to run in; another is the system's for what is temporary."""
    (tmp_path / "tmp").mkdir()
    (tmp_path / "runs").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "tmp"))
    monkeypatch.setattr(commands, "named", lambda *_: make_scene("capture"))
    monkeypatch.setattr(running, "SceneFmus", Unpacking)
    monkeypatch.setattr(commands, "fill", fill)
    monkeypatch.setattr(commands, "_load", lambda *_: None)
    return tmp_path / "runs"


def run(out: Path, force: bool = False) -> commands.Written:
    global made
    made += 1
    return commands.run_and_write("mock", out, Progress(), with_figures=False, force=force)


def names(folder: Path) -> list[str]:
    return sorted(p.name for p in folder.iterdir())


def test_a_new_run(place: Path) -> None:
    ends = set()
    for event in killed_everywhere(lambda: run(place / "first")):
        run(place / "next")
        assert not names(place.parent / "tmp"), f"killed at event {event}"
        assert names(place) in (["next"], ["first", "next"]), f"killed at event {event}"
        ends.add(len(names(place)))
        for name in names(place):
            assert whole(place / name), f"killed at event {event}"
            for path in sorted((place / name).rglob("*"), reverse=True):
                path.rmdir() if path.is_dir() else path.unlink()
            (place / name).rmdir()
    assert ends == {1, 2}, "killed before it took its name, and after"
    assert event > 15


def test_a_run_that_replaces_another(place: Path) -> None:
    """The one or the other is there in the end, whole."""
    run(place / "run")
    found = set()
    for event in killed_everywhere(lambda: run(place / "run", force=True)):
        clear_left(place)
        assert names(place) == ["run"], f"killed at event {event}"
        assert whole(place / "run"), f"killed at event {event}"
        found.add((place / "run" / "summary.json").read_text() == as_json({"run": made, "files": FILES}))
        assert [w.folder for w in [run(place / "run", force=True)]] == [place / "run"]
        assert names(place) == ["run"]
        assert not names(place.parent / "tmp"), f"killed at event {event}"
    assert found == {True, False}
    assert event > 20


def test_without_a_replacement_finished_the_old_run_comes_back(place: Path) -> None:
    """Killed between the two renames, with a draft that is gone."""
    run(place / "run")
    left = Scratch(place)
    left.name_place("run")
    (place / "run").rename(left.old)
    left.path.rmdir()
    assert left._lock is not None
    left._lock.release()
    assert clear_left(place) == 0
    assert (names(place), whole(place / "run")) == (["run"], True)


@pytest.fixture
def pretended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A compiler and a linker that only pretend, and a cache and a folder for what is temporary of their own."""
    monkeypatch.setattr(builds.compile, "emit", lambda name, terms, ir, kept: ir.write_text("; no kernels"))
    monkeypatch.setattr(builds.link, "link", lambda ir, header, library, platform: library.write_bytes(b"library"))
    monkeypatch.setattr(builds.picture, "png", lambda interface: b"picture")
    monkeypatch.setenv("DCONE_CACHE", str(tmp_path / "cache"))
    (tmp_path / "tmp").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "tmp"))


def build_files(folder: Path) -> None:
    commands.write_fmus("reel-control", folder / "out", Progress())


def export(folder: Path) -> None:
    export_scene(load("reel-control"), folder / "out", Progress())


def template(folder: Path) -> None:
    write_template("removal", "c", folder / "out")


def template_in_a_folder(folder: Path) -> None:
    (folder / "out").mkdir(exist_ok=True)
    write_template("capture", "pythonfmu", folder / "out")


WRITERS: dict[str, Callable[[Path], None]] = {
    "schema": lambda folder: commands.write_schema(folder / "out.json") and None,
    "new": lambda folder: commands.write_scene(str(folder / "out.toml"), "table2-deorbit") and None,
    "template": template,
    "template in a folder": template_in_a_folder,
    "build": build_files,
    "export-ssp": export,
}


def files_in(folder: Path) -> dict[str, bytes]:
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


REPLACING = ("schema", "build", "export-ssp")
CASES = [(what, again) for what in WRITERS for again in (False, True) if what in REPLACING or not again]
LONG = (("build", False), ("export-ssp", False), ("export-ssp", True))


@pytest.mark.usefixtures("pretended")
@pytest.mark.parametrize(
    ("what", "again"),
    [pytest.param(*case, marks=[pytest.mark.evidence] if case in LONG else []) for case in CASES],
)
def test_what_is_written_is_whole_or_not_there(tmp_path: Path, what: str, again: bool) -> None:
    """A file under its own name is what it should be; the next command in that place clears the rest, and succeeds.

    again     over what is there already
    """
    write, place, cache = WRITERS[what], tmp_path / "place", tmp_path / "cache"

    def clear() -> None:
        """What a user sees there goes; what the dead have left is for the next command."""
        for path in sorted(place.rglob("*"), reverse=True):
            if PREFIX not in str(path):
                with suppress(OSError):  # a folder with such in it
                    path.unlink() if path.is_file() else path.rmdir()

    place.mkdir()
    write(place)
    whole, found = files_in(place), set()
    if not again:
        clear()
        shutil.rmtree(cache, ignore_errors=True)
    for event in killed_everywhere(lambda: write(place)):
        clear_left(place)  # with which the next one begins; what had only to take its name does so
        there = {name: data for name, data in files_in(place).items() if PREFIX not in name}
        assert there.items() <= whole.items(), f"killed at event {event}"
        found.add(len(there))
        if what not in REPLACING:
            clear()
        write(place)
        assert files_in(place) == whole, f"killed at event {event}"
        assert not names(tmp_path / "tmp"), f"killed at event {event}"
        assert not cache.exists() or not [name for name in names(cache) if name.startswith(PREFIX)]
        if not again:
            clear()
            shutil.rmtree(cache, ignore_errors=True)
    assert found == {len(whole)} if again else found >= {0, len(whole)}
    assert event > 3


@pytest.mark.usefixtures("pretended")
def test_a_build(tmp_path: Path) -> None:
    """Nothing half-built is ever in the cache under its name."""
    interface = MODELS["reel_control"].interface({})
    cache = tmp_path / "cache"

    def build() -> Path:
        return builds.build(interface, cache, workplace=scratch.Scratch)

    for event in killed_everywhere(build):
        for path in cache.glob("*.fmu"):
            assert not kept.fault(path), f"killed at event {event}"
            path.unlink()
        path = build()
        assert names(cache) == [path.name], f"killed at event {event}"
        path.unlink()
    assert event > 6


def test_the_check_itself(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where nobody clears up, it finds what is left, in both places."""
    for module in (commands, scratch):
        monkeypatch.setattr(module, "clear_left", lambda _: 0)
    left = 0
    for _ in killed_everywhere(lambda: run(place / "first")):
        left |= bool(names(place)) | 2 * bool(names(place.parent / "tmp"))
    assert left == 3


PROGRAM = """
    import os, sys, tempfile
    sys.path.insert(0, {root!r})
    from dcone_cosim import cli, commands, running
    import pyarrow.parquet, fmpy, dcone_cosim.fmu.component
    from tests.cosim.conftest import scene_of
    from tests.cosim.mock_components import MockCapture, MockRemoval
    from tests.cosim.test_kills import Unpacking, kill_at
    Unpacking.instantiate = lambda self, phase, name: MockCapture() if phase == "capture" else MockRemoval(tugs=[])
    running.SceneFmus, commands.named = Unpacking, lambda *_: scene_of("capture", "removal")
    sys.argv = ["dcone", "run", "mock", "-o", "runs/out", "--csv", *sys.argv[2:]]
    kill_at(int({event}))
    cli.main()
"""


@pytest.mark.evidence
@pytest.mark.parametrize("more", [("--no-figures",), ("--no-figures", "--force"), (), ("--force",)])
def test_the_whole_command(tmp_path: Path, more: tuple[str, ...]) -> None:
    """`dcone run` with its own tables and figures, killed at each file event."""
    (tmp_path / "tmp").mkdir()
    (tmp_path / "runs").mkdir()

    def command(event: int, *arguments: str) -> int:
        program = textwrap.dedent(PROGRAM).format(root=ROOT, event=event)
        done = subprocess.run(
            [sys.executable, "-c", program, "-", *arguments],
            cwd=tmp_path, env=os.environ | {"TMPDIR": str(tmp_path / "tmp")},
            capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert done.returncode in (0, -signal.SIGKILL), done.stderr
        return done.returncode

    assert command(0, *(word for word in more if word == "--no-figures")) == 0
    lasting = contents(tmp_path / "runs/out")
    for event in range(1, 10_000):
        ended = command(event, *more) if "--force" in more else command(event, *more, "-o", f"runs/{event}")
        if ended == 0:
            break
        for place in ("runs", "tmp"):
            clear_left(tmp_path / place)  # with which the next one begins
        assert names(tmp_path / "tmp") == [], f"killed at event {event}"
        assert not [name for name in names(tmp_path / "runs") if name.startswith(".")], f"killed at event {event}"
        assert contents(tmp_path / "runs/out") == lasting
        assert all(contents(folder) == lasting for folder in (tmp_path / "runs").iterdir())
    assert event > 15
