"""What never ends, or has no end of entries or parts, is refused at once: the program neither hangs nor runs on."""

from __future__ import annotations

import os
import tomllib
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from dcone_cosim.errors import FmuError, InputError
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.scenes.kept import kept_in, unlike
from dcone_cosim.scenes.scene import load, parse, read_text
from dcone_cosim.scenes.toml_lines import deep_key
from dcone_cosim.ssp.package import Package

SCENE = '[removal]\nfmu = "{}"\nmacro_step = "10 s"\nduration = "100 s"\n'
unix = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no named pipes")


def reads(tmp_path: Path) -> dict[str, Callable[[Path], object]]:
    def scene_of(fmu: Path) -> object:
        (tmp_path / "s.toml").write_text(SCENE.format(fmu))
        return load(str(tmp_path / "s.toml"))

    return {
        "scene": lambda path: load(str(path)),
        "text": read_text,
        "fmu": Archive,
        "fmu of a scene": scene_of,
        "package": Package,
    }


@unix
@pytest.mark.parametrize("of", ["scene", "text", "fmu", "fmu of a scene", "package"])
@pytest.mark.parametrize("suffix", [".toml", ".fmu", ".ssp"])
def test_a_pipe_is_refused_at_once(tmp_path: Path, of: str, suffix: str) -> None:
    """Nobody writes into it: whoever opened it would wait for ever."""
    os.mkfifo(tmp_path / f"it{suffix}")
    with pytest.raises((FmuError, InputError), match="is a pipe; expected a file"):
        reads(tmp_path)[of](tmp_path / f"it{suffix}")


@unix
@pytest.mark.parametrize("of", ["scene", "text", "fmu", "fmu of a scene", "package"])
def test_a_device_is_refused_at_once(tmp_path: Path, of: str) -> None:
    with pytest.raises((FmuError, InputError), match="is a device; expected a file"):
        reads(tmp_path)[of](Path("/dev/zero"))


@unix
def test_a_pipe_in_the_folder_of_a_run(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "provenance.json")
    assert kept_in(tmp_path) is None
    with pytest.raises(InputError, match="is a pipe"):
        unlike(tmp_path, {})


@pytest.mark.parametrize(("make", "refused"), [(Archive, FmuError), (Package, InputError)], ids=["fmu", "package"])
def test_entries_without_end(tmp_path: Path, make: Callable[[Path], object], refused: type[Exception]) -> None:
    path = tmp_path / "many.zip"
    with zipfile.ZipFile(path, "w") as archive:
        for i in range(20_001):
            archive.writestr(f"resources/{i}", "")
    with pytest.raises(refused, match="it has 20,001 entries; at most 20,000"):
        make(path)


DOTS = ".".join(["a"] * 20_001)


@pytest.mark.parametrize(
    "text",
    [
        f"{DOTS} = 1",
        f"[{DOTS}]\nb = 1",
        f"[[ {DOTS} ]]",
        f"x = {{ y.{DOTS} = 1 }}",
        " . ".join(['"a b"', "'c'", "d"] * 30) + " = 1",
    ],
    ids=["key", "table", "list", "inline", "quoted"],
)
def test_a_key_without_end(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is refused before it is parsed, which would take a time that goes with the square of its parts."""
    monkeypatch.setattr(tomllib, "loads", lambda _: pytest.fail("it was parsed"))
    with pytest.raises(InputError, match="mine line 2: a key of more than 64 parts"):
        parse(f'title = "one.two. three"\n{text}\n', "mine", "mine")


def test_a_setting_without_end() -> None:
    with pytest.raises(InputError, match=r"a key of more than 64 parts") as told:
        load("mission", [f"{DOTS}=1"])
    assert len(str(told.value)) < 400


def test_what_only_looks_like_one() -> None:
    """Twin: long texts, many dots and 64 parts are no such key, and to see it takes no time."""
    assert deep_key("x = '" + "word " * 100_000 + "'\n# " + "." * 100_000) is None
    assert deep_key("a" * 1_000_000) is None
    assert deep_key('"' * 100_000) is None
    assert deep_key(".".join(["a"] * 64) + " = 1") is None
    assert deep_key(".".join(["a"] * 65) + " = 1") == 1
