"""What is wrong with an FMU's file is one message that names the file and the fault."""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Mapping
from pathlib import Path

import fmpy
import pytest

from dcone_cosim.errors import FmuError
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.fmu.component import Component
from dcone_cosim.fmu.isolation import IsolatedComponent
from dcone_cosim.interface_kit import write_template

XML = "modelDescription.xml"
BINARY = f"binaries/{fmpy.platform}/my_removal{fmpy.sharedLibraryExtension}"


@pytest.fixture(scope="module")
def description(tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = tmp_path_factory.mktemp("kit") / "c"
    write_template("removal", "c", folder)
    return (folder / XML).read_text()


def zipped(content: Mapping[str, str]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in content.items():
            archive.writestr(name, text)
    return buffer.getvalue()


def refusal(path: Path) -> str:
    with pytest.raises(FmuError) as caught:
        Archive(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert "Traceback" not in message
    return message


def refused(tmp_path: Path, content: Mapping[str, str] | bytes) -> str:
    path = tmp_path / "it.fmu"
    path.write_bytes(content if isinstance(content, bytes) else zipped(content))
    return refusal(path)


def test_a_sound_one_is_taken(tmp_path: Path, description: str) -> None:
    path = tmp_path / "it.fmu"
    path.write_bytes(zipped({XML: description, BINARY: ""}))
    with Archive(path) as archive:
        folder = archive.folder
        assert archive.identifier == "my_removal"
        assert archive.can_save
        assert archive.variables["start.condition"].kind == "Integer"
        assert archive.variables["target.mass"].start == 1000.0
        assert folder is not None
        assert folder.exists()
    assert not folder.exists()


def test_no_such_file_names_the_nearest(tmp_path: Path) -> None:
    (tmp_path / "controller.fmu").touch()
    assert "no such file; did you mean 'controller.fmu'?" in refusal(tmp_path / "controler.fmu")


def test_a_folder_an_empty_file_and_a_text(tmp_path: Path) -> None:
    assert "a folder" in refusal(tmp_path)
    assert "empty" in refused(tmp_path, b"")
    assert "is a zip file, and this is not one" in refused(tmp_path, b"<html>not found</html>")


@pytest.mark.parametrize("share", [0.3, 0.7, 0.99])
def test_one_cut_short(tmp_path: Path, description: str, share: float) -> None:
    whole = zipped({XML: description, BINARY: "x" * 10000})
    assert "cut short" in refused(tmp_path, whole[: int(share * len(whole))])


def test_one_changed_on_its_way(tmp_path: Path, description: str) -> None:
    whole = bytearray(zipped({XML: description, BINARY: ""}))
    whole[200] ^= 0x55
    assert "damaged" in refused(tmp_path, bytes(whole))


def test_no_model_description(tmp_path: Path, description: str) -> None:
    assert "it has no modelDescription.xml" in refused(tmp_path, {BINARY: ""})
    assert "there is inner/modelDescription.xml" in refused(tmp_path, {f"inner/{XML}": description, BINARY: ""})


def test_broken_xml(tmp_path: Path, description: str) -> None:
    cut = description[: len(description) // 2]
    assert re.search(r"not valid XML \(.*line \d+", refused(tmp_path, {XML: cut, BINARY: ""}))
    assert "is not that of an FMU: it begins with <html>" in refused(tmp_path, {XML: "<html/>", BINARY: ""})
    odd = description.replace('valueReference="0"', 'valueReference="zero"', 1)
    assert "does not follow FMI 2.0" in refused(tmp_path, {XML: odd, BINARY: ""})


@pytest.mark.parametrize("version", ["1.0", "3.0"])
def test_another_fmi(tmp_path: Path, description: str, version: str) -> None:
    other = description.replace('fmiVersion="2.0"', f'fmiVersion="{version}"')
    message = refused(tmp_path, {XML: other, BINARY: ""})
    assert f"this is FMI {version}; expected FMI 2.0 co-simulation" in message


def test_model_exchange_only(tmp_path: Path, description: str) -> None:
    other = re.sub(r"<CoSimulation [^>]*>", '<ModelExchange modelIdentifier="my_removal"/>', description)
    message = refused(tmp_path, {XML: other, BINARY: ""})
    assert "for model exchange only; expected FMI 2.0 co-simulation" in message


def test_no_binary_for_this_platform(tmp_path: Path, description: str) -> None:
    content = {XML: description, "binaries/win64/my_removal.dll": "", "binaries/darwin32/my_removal.dylib": ""}
    message = refused(tmp_path, content)
    assert f"no binary for {fmpy.platform}, this computer; it has binaries for darwin32, win64" in message
    assert "C sources" in refused(tmp_path, {XML: description, "sources/fmu.c": ""})
    assert "no binary at all" in refused(tmp_path, {XML: description})


def test_a_binary_of_another_name(tmp_path: Path, description: str) -> None:
    content = {XML: description, BINARY.replace("my_removal", "theirs"): ""}
    assert re.search(r"has no my_removal\S+, the name .* it has theirs", refused(tmp_path, content))


@pytest.mark.parametrize("name", ["../evil.txt", "/tmp/evil.txt", "a/../../evil.txt", "C:/evil.txt", "..\\evil.txt"])
def test_an_entry_that_escapes(tmp_path: Path, description: str, name: str) -> None:
    content = {XML: description, BINARY: "", name: "evil"}
    assert f"its entry {name!r} would be written outside its own folder" in refused(tmp_path, content)
    assert not list(tmp_path.parent.rglob("evil*"))


@pytest.mark.parametrize("name", ["../../evil", "/tmp/evil", "a/b", "..", "a\\b", "C:evil"])
def test_an_identifier_that_is_a_path(tmp_path: Path, description: str, name: str) -> None:
    """It would name a library elsewhere to be loaded."""
    changed = description.replace('modelIdentifier="my_removal"', f'modelIdentifier="{name}"')
    assert changed != description
    told = refused(tmp_path, {XML: changed, BINARY: ""})
    assert f"refused: its modelIdentifier {name!r} is a path; expected a name" in told


def test_two_of_a_name_are_refused_and_aliases_are_not(tmp_path: Path, description: str) -> None:
    twice = description.replace('name="target.mass"', 'name="chaser.mass"')
    assert "two variables named 'chaser.mass'" in refused(tmp_path, {XML: twice, BINARY: ""})
    path = tmp_path / "alias.fmu"
    path.write_bytes(zipped({XML: description.replace('valueReference="1"', 'valueReference="0"'), BINARY: ""}))
    with Archive(path) as archive:
        assert archive.variables["target.mass"].reference == archive.variables["chaser.mass"].reference


def test_a_binary_that_does_not_load_in_the_loaders_words(tmp_path: Path, description: str) -> None:
    path = tmp_path / "it.fmu"
    path.write_bytes(zipped({XML: description, BINARY: "no machine code"}))
    with Archive(path) as archive:
        for make in (Component, IsolatedComponent):
            before = Path.cwd()
            with pytest.raises(FmuError, match=r"towing: the binary of it\.fmu cannot be used\n.*(invalid|too short)"):
                make(archive, "towing")
            assert Path.cwd() == before


def test_nothing_stays_unpacked_after_a_refusal(
    tmp_path: Path, description: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    places = tmp_path / "temporary"
    places.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(places))
    refused(tmp_path, {XML: description})
    refused(tmp_path, {XML: "<broken", BINARY: ""})
    assert not list(places.iterdir())


def test_one_that_unpacks_to_too_much(tmp_path: Path, description: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A small file may hold terabytes of zeros; the limit is the one for an FMU in an SSP package."""
    zeros = "0" * 1_000_000
    fmu = tmp_path / "bomb.fmu"
    fmu.write_bytes(zipped({XML: description, BINARY: "", "resources/zeros": zeros}))
    size = len(description.encode()) + len(zeros)
    assert fmu.stat().st_size < size / 20
    monkeypatch.setattr("dcone_cosim.fmu.archive.LARGEST", size - 1)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "nowhere"))
    assert refusal(fmu) == f"{fmu}: unpacked it has {size:,} bytes; at most {size - 1:,} are unpacked"
    monkeypatch.undo()
    with Archive(fmu) as archive:
        assert archive.folder is not None
