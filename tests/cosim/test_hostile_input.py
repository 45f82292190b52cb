"""What never ends, or has no end of entries or parts, is refused at once: the program neither hangs nor runs on."""

from __future__ import annotations

import os
import random
import time
import tomllib
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from dcone_cosim import names
from dcone_cosim.errors import FmuError, InputError
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.fmu.isolation import IsolatedComponent
from dcone_cosim.loading import find, load
from dcone_cosim.scene.mistakes import SceneError
from dcone_cosim.scene.toml_lines import deep_key
from dcone_cosim.scenes.kept import kept_in, unlike
from dcone_cosim.scenes.reading import parse, read_text
from dcone_cosim.ssp import system
from dcone_cosim.ssp.package import Package
from tests.cosim.fmus.build import build
from tests.cosim.ssp_packages import STRUCTURE, contents, packed
from tests.cosim.test_isolated_by_default import SYSTEM
from tests.cosim.test_ssp_values import MAPPING, NAMESPACES, SET, one

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


MISSION = find("mission").read_text()


def keys(count: int) -> str:
    return "".join(f"speeed{i} = {i}\n" for i in range(count))


def under(header: str) -> Callable[[int], str]:
    def text(count: int) -> str:
        assert f"{header}\n" in MISSION
        return MISSION.replace(f"{header}\n", f"{header}\n{keys(count)}", 1)

    return text


def of_foreign(more: str) -> Callable[[int], str]:
    return lambda count: SCENE.format("my_removal.fmu") + more + keys(count)


def tables(name: str, inside: str) -> Callable[[int], str]:
    return lambda count: MISSION + "".join(f"[{name}{i}]\n{inside}\n" for i in range(count))


def wires(count: int) -> str:
    listed = ",".join(f"'removal.tether.lenght{i} -> x.y'" for i in range(count))
    return MISSION.replace("[removal]\n", f"[removal]\nconnections = [{listed}]\n", 1)


SCENES: dict[str, Callable[[int], str]] = {
    "top": lambda count: keys(count) + MISSION,
    "phase": under("[capture]"),
    "table": under("[capture.bullets]"),
    "orbit": under("[orbit]"),
    "handoff": under("[handoff]"),
    "parameters": lambda count: f"{MISSION}[capture.parameters]\n{keys(count)}",
    "tables": tables("capture.tabel", "a = 1"),
    "components": tables("capture.components.c", "modl = 1"),
    "models": tables("capture.components.c", 'model = "reel_contrl"'),
    "connections": wires,
    "foreign": of_foreign(""),
    "foreign parameters": of_foreign("[removal.parameters]\n"),
}


@pytest.fixture
def looked_for(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names for which a likely one was looked for, each of which takes some milliseconds."""
    found: list[str] = []
    own = names.difflib.get_close_matches
    monkeypatch.setattr(
        names.difflib, "get_close_matches", lambda name, *more, **named: found.append(name) or own(name, *more, **named)
    )
    return found


def is_bounded(text: str, folder: Path, looked_for: list[str]) -> None:
    began = time.monotonic()
    with pytest.raises(InputError) as told:
        parse(text, "mine", "mine.toml", folder)
    lines = str(told.value).splitlines()
    assert len(lines) == 22
    assert lines[0].startswith("mine.toml: ")
    assert all(line.startswith("  line ") for line in lines[1:21])
    assert lines[21].startswith("  and ")
    assert lines[21].endswith(" more")
    assert len(str(told.value)) < 12_000
    error = told.value
    assert isinstance(error, SceneError)
    assert (len(error.rows()), f"  and {error.more} more") == (20, lines[21])
    assert len(looked_for) <= 80
    assert time.monotonic() - began < 60.0


@pytest.mark.parametrize("kind", ["top", "table", "foreign parameters"])
def test_thousands_of_unknown_keys(tmp_path: Path, kind: str, looked_for: list[str]) -> None:
    """The first are told with what was probably meant, the rest are counted."""
    build(tmp_path)
    is_bounded(SCENES[kind](3000), tmp_path, looked_for)


@pytest.mark.evidence
@pytest.mark.parametrize("kind", SCENES)
def test_tens_of_thousands_of_unknown_keys_anywhere(tmp_path: Path, kind: str, looked_for: list[str]) -> None:
    build(tmp_path)
    is_bounded(SCENES[kind](20_000), tmp_path, looked_for)


def test_a_few_are_all_told(looked_for: list[str]) -> None:
    """The twin: of 20 none is left out, and each has the likely name."""
    with pytest.raises(InputError) as told:
        parse(under("[capture.bullets]")(20), "mine", "mine.toml")
    assert len(str(told.value).splitlines()) == 21
    assert str(told.value).count("did you mean 'speed'?") == 20


@pytest.mark.parametrize("length", [10_000, pytest.param(1_000_000, marks=pytest.mark.evidence)])
def test_a_name_without_end(length: int, looked_for: list[str]) -> None:
    with pytest.raises(InputError) as told:
        parse(f"{MISSION}[capture.parameters]\n{'a' * length} = 1\n", "mine", "mine.toml")
    assert len(str(told.value)) < 2000
    assert not looked_for


def a_package(folder: Path, values: str, mapping: str = "") -> Path:
    """A package of one FMU with these values in a parameter set."""
    fmu = build(folder)
    inner = SET.format(values=values, units="").replace("<ssv:ParameterSet", f"<ssv:ParameterSet {NAMESPACES}", 1)
    mapped = f"<ssd:ParameterMapping>{mapping}</ssd:ParameterMapping>" if mapping else ""
    binding = f'<ssd:ParameterBindings><ssd:ParameterBinding source="v.ssv">{mapped}</ssd:ParameterBinding>'
    text = SYSTEM.replace('sharedlibrary"/>', f'sharedlibrary">{binding}</ssd:ParameterBindings></ssd:Component>', 1)
    files = {STRUCTURE: text.encode(), "resources/it.fmu": fmu.read_bytes(), "v.ssv": inner.encode()}
    return packed(folder / "it.ssp", files)


@pytest.mark.parametrize("count", [2000, pytest.param(50_000, marks=pytest.mark.evidence)])
def test_thousands_of_names_in_a_parameter_set(tmp_path: Path, count: int, looked_for: list[str]) -> None:
    """Ignored by the rules of SSP, with a bounded note; with a mapping they are mistakes, told likewise."""
    began = time.monotonic()
    values = "".join(one(f"tether.rest_lenght{i}", 1.0) for i in range(count))
    scene = system.load(a_package(tmp_path, values), ["removal.macro_step=10 s"])
    assert len(scene.notes) == 21
    assert scene.notes[0].endswith("did you mean 'tether.rest_length'?; it is ignored")
    assert scene.notes[20].endswith(f": {count - 20} more are ignored like these")
    entries = "".join(f'<ssm:MappingEntry source="tether.rest_lenght{i}" target="nothing{i}"/>' for i in range(count))
    mapping = MAPPING.format(namespaces=NAMESPACES, entries=entries)
    with pytest.raises(InputError) as told:
        system.load(a_package(tmp_path, values, mapping), ["removal.macro_step=10 s"])
    lines = str(told.value).splitlines()
    assert (len(lines), lines[-1]) == (22, f"  and {count - 20} more")
    assert len(looked_for) <= 40
    assert time.monotonic() - began < 60.0


def damages(data: bytes, count: int) -> list[bytes]:
    """Cut short, with bytes changed, with pieces doubled and left out; the same ones every time."""
    dice, made = random.Random(5), []
    for _ in range(count):
        start, length = dice.randrange(len(data)), dice.randrange(1, 200)
        piece = data[start : start + length]
        made += [
            data[:start],
            data[:start] + bytes(byte ^ 1 << dice.randrange(8) for byte in piece) + data[start + length :],
            data[:start] + piece + data[start:],
            data[:start] + data[start + length :],
        ]
    return made


def refusal(work: Callable[[], object]) -> str:
    """What is said against it, "" for nothing; any other end is not caught."""
    try:
        work()
    except (FmuError, InputError) as error:
        return str(error)
    return ""


@pytest.mark.parametrize("count", [9, pytest.param(400, marks=pytest.mark.evidence)])
def test_a_damaged_archive_is_one_error_or_none(tmp_path: Path, count: int) -> None:
    """The file, its description, and a package around it: whole, or refused; never anything else."""
    fmu = build(tmp_path)
    whole, ends = contents(fmu), set()
    path = tmp_path / "damaged.fmu"
    package = packed(tmp_path / "whole.ssp", {STRUCTURE: SYSTEM.encode(), "resources/it.fmu": fmu.read_bytes()})
    parts = contents(package)

    def opens(path: Path) -> object:
        return Archive(path).close()

    def loads(path: Path) -> object:
        return system.load(path, ["removal.macro_step=10 s"])

    def tried(open_it: Callable[[Path], object], path: Path) -> None:
        said = refusal(lambda: open_it(path))
        assert not said or said.startswith(str(path))
        assert len(said) < 5000
        ends.add(bool(said))

    for data in damages(fmu.read_bytes(), count):
        path.write_bytes(data)
        tried(opens, path)
    for data in damages(whole["modelDescription.xml"], count):
        tried(opens, packed(path, whole | {"modelDescription.xml": data}))
    for data in damages(package.read_bytes(), count):
        path.with_suffix(".ssp").write_bytes(data)
        tried(loads, path.with_suffix(".ssp"))
    for data in damages(parts[STRUCTURE], count):
        tried(loads, packed(path.with_suffix(".ssp"), parts | {STRUCTURE: data}))
    assert ends == {True, False}


def steps(archive: Archive) -> None:
    with IsolatedComponent(archive, "it", timeout=10.0) as component:
        component.initialise(0.0)
        component.step(0.0, 10.0)


@unix
@pytest.mark.parametrize("count", [1, pytest.param(40, marks=pytest.mark.evidence)])
def test_a_damaged_binary_ends_nothing_else(tmp_path: Path, count: int) -> None:
    """Isolated, whatever it does as it is loaded and stepped; many a loader dies of such a file."""
    fmu = build(tmp_path)
    whole = contents(fmu)
    binary = next(name for name in whole if name.startswith("binaries/"))
    for data in [b"", b"text", whole[binary][:4096], *damages(whole[binary], count)]:
        with Archive(packed(tmp_path / "damaged.fmu", whole | {binary: data})) as archive:
            said = refusal(lambda archive=archive: steps(archive))
            assert not said or "damaged.fmu" in said


@pytest.mark.parametrize("count", [20, pytest.param(2000, marks=pytest.mark.evidence)])
def test_a_damaged_scene_is_one_error_or_none(tmp_path: Path, count: int) -> None:
    path = tmp_path / "mine.toml"
    for data in damages(MISSION.encode(), count):
        path.write_bytes(data)
        said = refusal(lambda: load(str(path)))
        assert not said or said.startswith(str(path))
        assert len(said) < 12_000
