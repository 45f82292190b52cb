"""The start values an FMU carries in its resources: found however they are named, whole or refused; two identities."""

from __future__ import annotations

import os
import re
import shutil
import struct
import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path

import pytest

from fmu_src.catalogue import MODELS
from fmu_src.packaging import builds, kept, start_values
from fmu_src.packaging.description import Experiment
from orbital import kernel
from tests.conftest import FREE
from tests.packaging import toy
from tests.packaging.raw import ERROR, OK, Library

OTHER = {"gain": 7.0, "room": 9, "push": -2.5, "go": True, "end": 123.0}
"""Values of a scene: every kind, parameters and inputs."""


def given(raw):
    """What an instance starts with, by name; it is initialised for it."""
    assert raw.start() == OK, raw.last
    reals = dict(zip(("gain", "push", "end"), raw.get("gain", "push", "end"), strict=True))
    return reals | {"room": raw.get("room", kind="Integer"), "go": bool(raw.get("go", kind="Boolean"))}


@pytest.fixture
def folder(tmp_path):
    """An unpacked FMU of the toy's library, far from that, with other values."""
    place = tmp_path / "a b, 100% ü"
    toy.furnish(place, toy.INTERFACE.starting(OTHER))
    return place


@pytest.fixture
def at(folder):
    return str(folder / "resources").encode()


# ---- where they are -------------------------------------------------------------------------------------------------


def escaped(path, digits="%02X"):
    return re.sub(rb"[^/\w.-]", lambda m: b"".join(b"%" + (digits % c).encode() for c in m[0]), path, flags=re.A)


SPELLINGS = {
    "file:///path": lambda path: b"file://" + escaped(path),
    "file:/path": lambda path: b"file:" + escaped(path),
    "file://localhost/path": lambda path: b"file://localhost" + escaped(path),
    "in capitals": lambda path: b"FILE://LocalHost" + escaped(path),
    "in small digits": lambda path: b"file://" + escaped(path, "%02x"),
    "not encoded": lambda path: b"file://" + path,
    "with a slash at its end": lambda path: b"file://" + escaped(path) + b"/",
    "a plain path": lambda path: path,
    "a plain path with a slash": lambda path: path + b"/",
}


@pytest.mark.parametrize("spelling", SPELLINGS)
def test_the_location_may_be_spelt_as_tools_do(make, at, spelling):
    assert given(make(resources=SPELLINGS[spelling](at))) == OTHER


@pytest.mark.parametrize("nothing", [None, b""])
def test_without_a_location_they_are_those_beside_the_library(make, nothing):
    """The twin of the spellings: the toy's own values, which are others."""
    own = given(make(resources=nothing))
    assert own == {"gain": 3.0, "room": 4, "push": 0.0, "go": False, "end": 1e9}
    assert own != OTHER


@pytest.mark.parametrize(
    ("location", "words"),
    [
        (lambda at: b"file://" + escaped(at[:-1]), "can not be read from"),
        (lambda at: b"file://elsewhere" + at, "they are on another machine"),
        (lambda at: b"http://localhost" + at, "can not be read from"),
        (lambda at: b"file://" + b"x" * 5000, "the location is too long"),
        (lambda at: b"file://" + at + b"/" * (4090 - len(at)), "the location is too long"),
    ],
)
def test_a_location_that_leads_nowhere_is_told(make, at, location, words):
    raw = make(resources=location(at))
    assert not raw.component.value
    (message,) = raw.said
    assert message[:2] == (ERROR, "logStatusError")
    assert words in message[2]


def test_a_library_that_lies_alone_has_no_values(built_toy, tmp_path):
    """Taken out of its FMU and not told where that is: it starts with nothing rather than with something else."""
    alone = Path(shutil.copy(built_toy.library, tmp_path))
    raw = toy_at(alone, None)
    assert not raw.component.value
    assert "can not be read from" in raw.last
    toy.furnish(tmp_path)
    raw = toy_at(alone, str(tmp_path / "resources").encode())
    assert raw.component.value
    raw.free()


def toy_at(path, resources, guid=toy.GUID):
    from tests.packaging.raw import Raw

    return Raw(Library(path), guid, toy.INTERFACE.references, resources=resources)


# ---- what is wrong with them ----------------------------------------------------------------------------------------


def test_no_length_and_no_flipped_bit_is_taken_for_the_values(make, folder, at):
    """Nothing but the file as it was written gives an instance."""
    file = folder / start_values.PATH
    whole = file.read_bytes()
    assert len(whole) == 128 + 8 * 31
    damaged = [whole[:size] for size in range(len(whole))] + [whole + b"\0"]
    damaged += [whole[:k] + bytes([whole[k] ^ 1 << n]) + whole[k + 1 :] for k in range(len(whole)) for n in range(8)]
    for data in damaged:
        file.write_bytes(data)
        raw = make(resources=at)
        assert not raw.component.value
        assert len(raw.said) == 1
        assert file.name in raw.last
    file.write_bytes(whole)
    assert given(make(resources=at)) == OTHER


@pytest.mark.parametrize(
    ("harm", "words"),
    [
        (lambda file, whole: file.unlink(), "No such file"),
        (lambda file, whole: shutil.rmtree(file.parent), "No such file"),
        (lambda file, whole: (file.unlink(), file.mkdir()), "Is a directory"),
        (lambda file, whole: file.write_bytes(whole[:-8]), "cut short or too long: it must have 376 bytes"),
        (lambda file, whole: file.write_bytes(whole[:127]), "holds no start values"),
        (lambda file, whole: file.write_bytes(b"PK" + whole[2:]), "holds no start values"),
        (lambda file, whole: file.write_bytes(whole[:200] + b"\1" + whole[201:]), "check word does not fit"),
        (lambda file, whole: file.write_bytes(whole[:112] + b"\2" + whole[113:]), "version 2, expected 1"),
        (
            lambda file, whole: toy.furnish(file.parents[1], key="{another}"),
            "belongs to another library than this one, {library of the toy}",
        ),
        (
            lambda file, whole: toy.furnish(file.parents[1], MODELS["reel_control"].interface({}), "{reel}"),
            "belongs to another library",
        ),
        (
            lambda file, whole: toy.furnish(file.parents[1], guid="{other}"),
            "the GUID {toy} is not that of this FMU, {other}",
        ),
    ],
)
def test_what_is_wrong_with_them_is_told(make, folder, at, harm, words):
    file = folder / start_values.PATH
    harm(file, file.read_bytes())
    raw = make(resources=at)
    assert not raw.component.value
    (message,) = raw.said
    assert message[:2] == (ERROR, "logStatusError")
    assert words in message[2]


def test_another_guid_given_is_refused(make, at):
    for guid in ("{toy", "{toy}x", "", toy.KEY):
        raw = make(guid=guid, resources=at)
        assert not raw.component.value
        assert "is not that of this FMU, {toy}" in raw.last


def test_the_layout_is_what_the_module_says(folder):
    """By offsets and bytes alone: little-endian on every machine."""
    data = (folder / start_values.PATH).read_bytes()
    assert data[:8] == b"DCONEVAL"
    assert data[16:64] == toy.KEY.encode().ljust(48, b"\0")
    assert data[64:112] == b"{toy}".ljust(48, b"\0")
    assert struct.unpack_from("<qq", data, 112) == (1, 31)
    r = toy.INTERFACE.references
    assert struct.unpack_from("<d", data, 128 + 8 * r["push"]) == (-2.5,)
    assert struct.unpack_from("<q", data, 128 + 8 * r["room"]) == (9,)
    value = 0xCBF29CE484222325
    for k in range(16, len(data), 8):
        value = ((value ^ int.from_bytes(data[k : k + 8], "little")) * 0x100000001B3) % 2**64
        value ^= value >> 32
    assert int.from_bytes(data[8:16], "little") == value


# ---- an instance with them ------------------------------------------------------------------------------------------


def test_reset_returns_to_them_even_when_the_file_is_gone(make, folder, at):
    raw = make(resources=at)
    fresh = raw.serialise(raw.save())
    assert raw.start({"gain": 1.0, "go": False}) == OK
    shutil.rmtree(folder)
    assert raw.call("Reset") == OK
    assert raw.serialise(raw.save()) == fresh
    assert given(raw) == OTHER


def test_values_out_of_bounds_are_refused_when_they_are_used(make, folder, at):
    """As if they had been set: a file that was written by hand passes no check by."""
    file = folder / start_values.PATH
    data = file.read_bytes()
    place = 128 + 8 * toy.INTERFACE.references["gain"]
    body = data[16:place] + struct.pack("<d", -1.0) + data[place + 8 :]
    file.write_bytes(data[:8] + struct.pack("<Q", start_values.check_word(body)) + body)
    raw = make(resources=at)
    assert raw.start() == ERROR
    assert "gain = -1 1 is out of its bounds" in raw.last


def test_a_state_goes_between_fmus_of_one_library(make, at):
    """Saved with other start values than the instance has that goes on from it: it brings its own."""
    one, two = make(resources=at), make()
    assert one.start() == two.start() == OK
    assert one.step(0.0, 1.0) == OK
    status, state = two.deserialise(one.serialise(one.save()))
    assert status == OK
    assert two.restore(state) == OK
    assert two.get("gain", "x", "y") == one.get("gain", "x", "y") == [7.0, -2.5, -2.5 - 7.0 * 2.5]
    assert one.step(1.0, 1.0) == two.step(1.0, 1.0) == OK
    assert two.serialise(two.save()) == one.serialise(one.save())
    assert two.call("Reset") == OK
    assert given(two)["gain"] == 3.0, "but a reset goes back to the start values of the FMU it is"


def test_a_state_does_not_go_to_another_library(running, tmp_path):
    other = toy.build(tmp_path, "{another library}")
    raw = toy_at(other.library, None)
    status, state = raw.deserialise(running.serialise(running.save()))
    assert status == ERROR
    assert not state.value
    assert raw.last.endswith("belongs to another library than this one, {another library}")
    raw.free()


def test_a_state_that_is_freed_where_its_address_is_asked_for_hurts_nothing(running):
    """What a widespread tool does: the eight bytes a state begins with are then taken for what is to be freed."""
    state = running.save()
    assert running.serialise(state)[:8] == bytes(8)
    for _ in range(2):
        assert running.call("FreeFMUstate", state) == OK
    assert running.restore(state) == OK
    assert running.drop(state) == OK


# ---- the table ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"grain": 1.0}, "grain = 1: this toy has no parameter or input of that name"),
        ({"x": 1.0}, "x = 1: this toy has no parameter"),
        ({"gain": 0.0}, "gain = 0 must be greater than 0"),
        ({"room": 2.5}, "room = 2.5 must be a whole number"),
        ({"push": float("nan")}, "push = nan must be finite"),
    ],
)
def test_a_table_takes_no_value_that_it_cannot_have(values, words):
    with pytest.raises(ValueError, match=re.escape(words)):
        toy.INTERFACE.starting(values)


def test_other_values_change_nothing_else_of_a_table():
    other = toy.INTERFACE.starting(OTHER)
    assert other.dtype == toy.INTERFACE.dtype
    assert other.references == toy.INTERFACE.references
    changed = {name: start for name, _, _, start in other.scalars() if name in OTHER}
    assert changed == OTHER
    kept_as_they_were = [row for row in other.scalars() if row[0] not in OTHER]
    assert [r[3] for r in kept_as_they_were] == [r[3] for r in toy.INTERFACE.scalars() if r[0] not in OTHER]


# ---- the archive ----------------------------------------------------------------------------------------------------


@pytest.fixture
def build(monkeypatch, tmp_path):
    """Write a reel control's FMU with values; compiler and linker only pretend, and are counted."""
    called = []

    def emit(model, terms, ir, kept):
        called.append("compiled")
        ir.write_text("; no kernels")

    def link(ir, header, library, targets):
        called.append("linked")
        library.write_bytes(b"library")

    monkeypatch.setattr(builds.compile, "emit", emit)
    monkeypatch.setattr(builds.link, "link", link)
    plain = MODELS["reel_control"].interface({})

    def write(name, values, scene="tow", cache="cache", step=2.0):
        fmu = builds.build(plain, tmp_path / cache)
        path = tmp_path / name
        builds.furnish({fmu: ["linux64"]}, plain.starting(values), Experiment(1.5, 7.5, step, scene), path)
        with zipfile.ZipFile(path) as content:
            return path, {name: content.read(name) for name in content.namelist()}

    return write, called


def test_another_value_costs_neither_compiler_nor_linker(build):
    write, called = build
    _, one = write("one", {"reel.length": 12.0})
    _, two = write("two", {"reel.length": 12.5})
    assert called == ["compiled", "linked"]
    assert {name for name in one if one[name] != two[name]} == {
        "modelDescription.xml",
        "documentation/index.html",
        start_values.PATH,
    }


def test_the_guid_is_that_of_the_values_and_the_key_that_of_the_library(build):
    write, _ = build
    makings = [({"reel.length": 12.0},), ({"reel.length": 12.5},), ({"reel.length": 12.0}, "tug")]
    files = [write("a", *making)[1] for making in makings] + [write("b", {"reel.length": 12.0}, step=3.0)[1]]
    guids = [ET.fromstring(f["modelDescription.xml"]).get("guid") for f in files]
    assert len(set(guids)) == len(files)
    for guid, file in zip(guids, files, strict=True):
        assert file[start_values.PATH][64:112].rstrip(b"\0").decode() == guid
    (key,) = {start_values.library_of(f[start_values.PATH]) for f in files}
    assert key == kept.as_guid(builds.fingerprint(MODELS["reel_control"].interface({})))
    assert key not in guids
    assert f'DCONE_LIBRARY "{key}"'.encode() in files[0]["sources/model.h"]


def test_the_key_covers_every_file_of_the_model(monkeypatch, tmp_path):
    """Those of its parts too, each in a folder of its own: a changed part is another library."""
    folder = shutil.copytree(builds.SOURCES, tmp_path / "fmu_src", ignore=shutil.ignore_patterns("__pycache__"))
    interface = MODELS["net_capture"].interface(FREE)
    own = builds.fingerprint(interface)
    monkeypatch.setattr(builds, "SOURCES", folder)
    shutil.copytree(Path(kernel.__file__).parent, tmp_path / "orbital")
    assert builds.fingerprint(interface) == own
    for part in ("model.py", "nets/square.py", "contact/search.py"):
        with (folder / "net_capture" / part).open("a") as file:
            file.write("\n")
        assert builds.fingerprint(interface) != own, part
        own = builds.fingerprint(interface)


def test_the_bytes_depend_on_the_values_alone(build, monkeypatch, tmp_path):
    write, _ = build
    one, _ = write("one.fmu", {"reel.length": 12.0})
    (tmp_path / "deeper").mkdir()
    monkeypatch.chdir(tmp_path / "deeper")
    monkeypatch.setattr(os, "environ", {**os.environ, "PYTHONHASHSEED": "1"})
    two, _ = write("deeper/two.fmu", {"reel.length": 12.0}, cache="another/cache")
    three, _ = write("three.fmu", {"reel.length": 12.0000001})
    assert one.read_bytes() == two.read_bytes() != three.read_bytes()


def test_description_and_page_tell_the_values(build):
    write, _ = build
    _, files = write("one", {"reel.length": 12.25, "length_rate": -0.5})
    root = ET.fromstring(files["modelDescription.xml"])
    starts = {row.get("name"): row[0].get("start") for row in root.iter("ScalarVariable")}
    assert (starts["reel.length"], starts["length_rate"]) == ("12.25", "-0.5")
    assert root.find("DefaultExperiment").attrib == {"startTime": "1.5", "stopTime": "7.5", "stepSize": "2.0"}
    assert "Start values: those of the scene tow." in root.get("description")
    page = files["documentation/index.html"].decode()
    assert "those of the scene <code>tow</code>" in page
    section = page.partition("<h2>Values this FMU starts with</h2>")[2].partition("<h2>")[0]
    told = {
        name: [re.sub("<.*?>", "", cell) for cell in re.findall(r"<td>(.*?)</td>", rest, re.S)]
        for name, rest in re.findall(r"<td><code>([^<]*)</code></td>(.*?)</tr>", section, re.S)
    }
    interface = MODELS["reel_control"].interface({})
    settable = [n for n, _, v, _ in interface.scalars() if v.causality in ("parameter", "input")]
    assert list(told) == settable
    assert {name: row[0] for name, row in told.items()} == {name: starts[name] for name in settable}
    assert {name for name, row in told.items() if row[2]} == {"reel.length", "length_rate"}
    assert told["reel.length"][:2] == ["12.25", "m"]
    assert float(told["length_rate"][2]) == 0.0
