"""What a run leaves that was killed: nothing, once the next one has begun in the same place."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from dcone_cosim import commands, running, scratch
from dcone_cosim.drafts import atomic_folder
from dcone_cosim.progress import Progress
from tests.cosim.mock_components import MockCapture

ROOT = Path(__file__).parents[2]


def dying(place: Path, rest: str) -> subprocess.Popen[str]:
    """A process that has begun a draft and then does the rest."""
    program = f"""
        import ctypes, time
        from pathlib import Path
        from dcone_cosim.drafts import atomic_folder
        with atomic_folder(Path({str(place)!r})) as draft:
            (draft.path / "half.parquet").write_text("half")
            print(draft.path, flush=True)
            {rest}
    """
    return subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(program)],
        stdout=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
    )


def test_the_draft_of_a_crash_is_removed_by_the_next_run(tmp_path: Path) -> None:
    with dying(tmp_path / "run", "ctypes.string_at(0)") as process:
        assert process.stdout is not None
        left = Path(process.stdout.readline().strip())
        assert process.wait() < 0
    assert (left / "half.parquet").exists()
    with atomic_folder(tmp_path / "other") as draft:
        assert draft.removed == 1
        assert not left.exists()
    assert [p.name for p in tmp_path.iterdir()] == ["other"]
    assert not list((tmp_path / "other").iterdir())


def test_the_draft_of_a_living_run_stays(tmp_path: Path) -> None:
    with dying(tmp_path / "run", "time.sleep(60)") as process:
        assert process.stdout is not None
        left = Path(process.stdout.readline().strip())
        with atomic_folder(tmp_path / "other") as draft:
            assert draft.removed == 0
        assert (left / "half.parquet").exists()
        process.kill()
    with atomic_folder(tmp_path / "another") as draft:
        assert draft.removed == 1
    assert sorted(p.name for p in tmp_path.iterdir()) == ["another", "other"]


def test_hidden_folders_of_others_stay(tmp_path: Path) -> None:
    (tmp_path / ".git").mkdir()
    (tmp_path / ".dcone-mine").mkdir()
    (tmp_path / "mine").mkdir()
    (tmp_path / ".dcone-link.lock").symlink_to("mine")
    (tmp_path / ".dcone-link").symlink_to("mine")
    with atomic_folder(tmp_path / "run") as draft:
        assert draft.removed == 0
    assert sorted(p.name for p in tmp_path.iterdir()) == [
        *(".dcone-link", ".dcone-link.lock", ".dcone-mine", ".git", "mine", "run")
    ]


def test_without_locks_nothing_is_removed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Some network drives have none."""

    def none(*_: object) -> None:
        raise OSError

    monkeypatch.setattr(scratch.fcntl, "flock", none)
    with atomic_folder(tmp_path / "run") as draft:
        assert not list(draft.path.iterdir())
        (draft.path / "x").touch()
    assert [p.name for p in (tmp_path / "run").iterdir()] == ["x"]


def test_the_next_run_says_so(tmp_path: Path, make_scene, monkeypatch: pytest.MonkeyPatch) -> None:
    class NoArchives:
        def __init__(self, *_: object) -> None: ...
        def __enter__(self) -> NoArchives:
            return self

        def __exit__(self, *_: object) -> None: ...
        def instantiate(self, *_: object) -> MockCapture:
            return MockCapture()

        def adopt(self, *_: object) -> None: ...
        def facts(self) -> dict[str, object]:
            return {}

    monkeypatch.setattr(commands, "named", lambda *_: make_scene("capture"))
    monkeypatch.setattr(running, "SceneFmus", NoArchives)
    with dying(tmp_path / "run", "ctypes.string_at(0)") as process:
        process.communicate()
    notes = [
        commands.run_and_write("mock", tmp_path / name, Progress(), with_figures=False).notes for name in ("a", "b")
    ]
    assert [commands.LEFT_BEHIND in each for each in notes] == [True, False]
