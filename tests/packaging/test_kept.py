"""A cached FMU that is damaged or another's is never used: it is built again, and one line says so."""

from __future__ import annotations

import os
import random
import shutil
import time
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path

import pytest

from fmu_src.catalogue import MODELS
from fmu_src.packaging import builds, kept, platforms, start_values

KEY = "0123456789abcdef" * 4
LIBRARY = "binaries/linux64/net_capture.so"


def content(key: str = KEY) -> dict[str, bytes]:
    return {
        "modelDescription.xml": b"<fmiModelDescription/>",
        start_values.PATH: start_values.content(MODELS["reel_control"].interface({}), kept.as_guid(key), "{guid}"),
        LIBRARY: b"\x7fELF" + bytes(range(64)),
    }


def read(path: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(path) as file:
        return {name: file.read(name) for name in file.namelist()}


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / kept.file_name("net_capture", KEY, platforms.LINUX64)
    builds.pack(content(), path)
    return path


def test_what_was_written_is_whole(file: Path) -> None:
    assert kept.fault(file) == ""


def test_no_changed_byte_goes_unseen(file: Path) -> None:
    """Every byte, two changes each: what counts as whole has the content that was written, to the last byte."""
    whole, seen = file.read_bytes(), 0
    for place in range(len(whole)):
        for change in (0x01, 0xFF):
            file.write_bytes(whole[:place] + bytes([whole[place] ^ change]) + whole[place + 1 :])
            wrong = kept.fault(file)
            assert wrong or read(file) == content(), f"byte {place}"
            seen += bool(wrong)
    assert seen > len(whole), "times and attributes of the entries are all that may change"


@pytest.mark.evidence
def test_no_damage_of_any_kind_goes_unseen(file: Path) -> None:
    """Every bit, every length, and two thousand bursts."""
    whole, dice = file.read_bytes(), random.Random(1)
    damaged = [whole[:i] + bytes([whole[i] ^ 1 << n]) + whole[i + 1 :] for i in range(len(whole)) for n in range(8)]
    damaged += [whole[:length] for length in range(len(whole))]
    for _ in range(2000):
        start, length = dice.randrange(len(whole)), dice.randrange(1, 64)
        damaged.append(whole[:start] + dice.randbytes(length) + whole[start + length :])
    for data in damaged:
        file.write_bytes(data)
        assert kept.fault(file) or read(file) == content()


def test_what_is_not_what_its_name_says(file: Path) -> None:
    builds.pack(content("fedcba9876543210" * 4), file)
    assert "another's" in kept.fault(file)
    builds.pack({name: data for name, data in content().items() if name != LIBRARY}, file)
    assert "another's" in kept.fault(file)
    for name in content():
        builds.pack({other: data for other, data in content().items() if other != name}, file)
        assert "another's" in kept.fault(file)
    builds.pack(content(), file.with_name("net_capture-0123456789abcdef-amiga.fmu"))
    assert "name" in kept.fault(file.with_name("net_capture-0123456789abcdef-amiga.fmu"))


@pytest.mark.skipif(os.name == "nt", reason="pipes of POSIX")
def test_a_pipe_or_a_folder_is_no_fmu(file: Path) -> None:
    file.unlink()
    os.mkfifo(file)
    began = time.monotonic()
    assert kept.fault(file) == "no file"
    assert time.monotonic() - began < 5.0
    file.unlink()
    file.mkdir()
    assert kept.fault(file) == "no file"


def of_the_same_checksum(data: bytes) -> bytes:
    """Other bytes, as many, with the same CRC-32: it is affine, so bits of the last four mend what the first does."""
    other = bytes([data[0] ^ 0xFF]) + data[1:]
    wanted, place = zlib.crc32(data) ^ zlib.crc32(other), len(other) - 4
    rows = []
    for bit in range(32):
        mended = other[:place] + bytes(b ^ (1 << bit >> 8 * i & 0xFF) for i, b in enumerate(other[place:]))
        rows.append((zlib.crc32(mended) ^ zlib.crc32(other), 1 << bit))
    mend = 0
    for digit in reversed(range(32)):
        effect, bits = next(row for row in rows if row[0] >> digit == 1)
        rows = [(e ^ effect, b ^ bits) if e >> digit & 1 else (e, b) for e, b in rows if (e, b) != (effect, bits)]
        if wanted >> digit & 1:
            wanted, mend = wanted ^ effect, mend ^ bits
    return other[:place] + bytes(b ^ (mend >> 8 * i & 0xFF) for i, b in enumerate(other[place:]))


def test_a_binary_is_known_by_its_bytes(file: Path, tmp_path: Path) -> None:
    """Checksums can be had by anybody, and so can the names and the identity in the file around it."""
    library = tmp_path / "any_name.so"
    own = content()[LIBRARY]
    library.write_bytes(own)
    assert kept.holds(tmp_path, library)
    forged = of_the_same_checksum(own)
    assert (forged != own, len(forged), zlib.crc32(forged)) == (True, len(own), zlib.crc32(own))
    library.write_bytes(forged)
    assert not kept.holds(tmp_path, library)
    library.write_bytes(own)
    (tmp_path / "another.fmu").write_bytes(b"PK damaged")
    assert kept.holds(tmp_path, library)
    assert not kept.holds(tmp_path / "nowhere", library)


@pytest.fixture
def build(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Callable[[], tuple[Path, list[str]]]:
    """Build reel control for this machine with a compiler and a linker that only pretend; returns what it said."""
    monkeypatch.setattr(builds.compile, "emit", lambda model, terms, ir, common: ir.write_text("; no kernels"))
    monkeypatch.setattr(builds.link, "link", lambda ir, header, library, platform: library.write_bytes(b"library"))
    monkeypatch.setattr(builds.picture, "png", lambda interface: b"picture")

    def run() -> tuple[Path, list[str]]:
        said: list[str] = []
        model = MODELS["reel_control"]
        return builds.build(model.interface({}), tmp_path / "cache", said.append), said

    return run


def cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-30])


def flip_in_the_library(path: Path) -> None:
    """The case that zlib answers, not zipfile."""
    data = bytearray(path.read_bytes())
    with zipfile.ZipFile(path) as file:
        entry = file.getinfo("modelDescription.xml")
    start = entry.header_offset + 30 + len(entry.filename)
    data[start : start + 40] = b"\xff" * 40
    path.write_bytes(data)


def of_another(path: Path) -> None:
    builds.pack(content(), path)


def folder_there(path: Path) -> None:
    path.unlink()
    path.mkdir()
    (path / "x").touch()


@pytest.mark.parametrize("harm", [cut, flip_in_the_library, of_another, folder_there])
def test_what_is_wrong_is_built_again_with_one_line(build, harm: Callable[[Path], None]) -> None:
    path, said = build()
    whole = path.read_bytes()
    assert not [line for line in said if "again" in line]
    assert build() == (path, [])
    harm(path)
    again, said = build()
    told = [line for line in said if line.endswith("it is built again")]
    assert (again, again.read_bytes(), len(told)) == (path, whole, 1)
    assert told[0].startswith(f"{path} is ")
    assert build() == (path, []), "and then it is kept"
    assert [p.name for p in path.parent.iterdir()] == [path.name]


def test_kernels_of_another_are_not_taken(build, monkeypatch: pytest.MonkeyPatch) -> None:
    """The IR of a damaged file for another platform is worked out anew."""
    path, _ = build()
    other = path.with_name(path.name.replace(platforms.host().name, "win64"))
    shutil.copy(path, other)
    path.unlink()
    _, said = build()
    assert [line for line in said if line.startswith("building")], "a library for linux is no win64's FMU"
