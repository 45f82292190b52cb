"""What cannot be gone on from is refused, with what is wrong and why, and nothing is left behind."""

from __future__ import annotations

import hashlib
import json
import shutil
import zipfile
from collections.abc import Callable
from pathlib import Path

import pyarrow.parquet
import pytest

from dcone_cosim.errors import InputError
from dcone_cosim.fmu.steppable import VariableInfo
from dcone_cosim.resume.begin import Origin
from dcone_cosim.resume.differences import Difference
from dcone_cosim.resume.instants import Place
from tests.cases.conftest import SCENE
from tests.cosim.fmus.build import build
from tests.resume.conftest import Kept
from tests.runs import COARSE, put, tables


@pytest.fixture
def copy(mission: Kept, tmp_path: Path) -> Path:
    """A copy of the mission's run, to be spoiled."""
    return shutil.copytree(mission.folder, tmp_path / "copy")


def refused(folder: Path, place: str, *settings: str, out: str = "out") -> str:
    """The refusal; nothing is written."""
    place_of = folder.parent / out
    with pytest.raises(InputError) as error:
        put(folder, place_of, settings, go_on=place)
    assert not place_of.exists()
    return str(error.value)


@pytest.mark.parametrize(
    ("place", "setting", "told"),
    [
        (
            "removal:10 min",
            "removal.tether.diameter=2 mm",
            ("removal.tether.diameter: was 0.001, is 0.002", "fixed parameter"),
        ),
        ("removal:10 min", "removal.macro_step=10 s", ("removal.macro_step: was 20, is 10", "cannot change any more")),
        ("removal:10 min", "removal.reel.law=commanded", ("removal",)),
        (
            "removal:10 min",
            "capture.bullets.speed=4 m/s",
            ("capture.bullets.speed: was 3, is 4", "the capture is over"),
        ),
        ("removal:10 min", "handoff.point_tolerance=0.02", ("handoff.point_tolerance", "the hand-over is over")),
        ("removal", "orbit.altitude=700 km", ("capture.orbit.altitude: was 800000, is 700000", "the capture is over")),
        ("capture:3 s", "capture.hand_over=none", ("hand_over",)),
        ("capture:3 s", "capture.net.side=14 m", ("capture.net.side: was 12, is 14", "fixed parameter")),
    ],
)
def test_what_is_over_cannot_change(copy: Path, place: str, setting: str, told: tuple[str, ...]) -> None:
    said = refused(copy, place, setting)
    for text in told:
        assert text in said


def test_the_length_of_the_one_line_belongs_to_the_capture(copy: Path) -> None:
    """Whichever phase it is said in: the key looks like one of the removal alone."""
    said = refused(copy, "removal", "removal.tether.rest_length=15 m", "capture.tether.length=15 m")
    assert "capture.tether.length: was 14, is 15" in said


@pytest.mark.parametrize(
    ("place", "told"),
    [
        ("capture", "takes over from no other phase"),
        ("removal:11 min", "kept: 600 s, 1200 s, 1800 s"),
        ("capture:4 s", "kept: 3 s, 7 s"),
        ("rem:10 min", "no phase 'rem'; did you mean 'removal'?"),
        ("10 min", "of which phase?"),
        ("removal:10", "expected one with its unit"),
        ("removal:10 m", "is no time"),
        ("soon", "expected a phase"),
    ],
)
def test_places_that_are_none(copy: Path, place: str, told: str) -> None:
    assert told in refused(copy, place)


def test_what_is_no_run(tmp_path: Path) -> None:
    assert "not the folder of a run" in refused(tmp_path / "nothing", "removal")


def spoil(folder: Path, change: Callable[[dict[str, bytes]], None], name: str = "removal-600s.state") -> None:
    """Change the members of a state's file, and have the provenance believe it."""
    path = folder / "states" / name
    with zipfile.ZipFile(path) as archive:
        members = {member: archive.read(member) for member in archive.namelist()}
    change(members)
    with zipfile.ZipFile(path, "w") as archive:
        for member, data in members.items():
            archive.writestr(member, data)
    told = json.loads((folder / "provenance.json").read_text())
    for row in told["states"]:
        if row["file"].endswith(name):
            row["sha256"] = hashlib.sha256(path.read_bytes()).hexdigest()
    (folder / "provenance.json").write_text(json.dumps(told))


def text(change: Callable[[str], str]) -> Callable[[dict[str, bytes]], None]:
    def of(members: dict[str, bytes]) -> None:
        before = members["state.json"].decode()
        after = change(before)
        assert after != before
        members["state.json"] = after.encode()

    return of


def test_a_file_that_is_not_the_one_that_was_written(copy: Path) -> None:
    path = copy / "states" / "removal-600s.state"
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(bytes(data))
    assert "its SHA-256 is another" in refused(copy, "removal:10 min")
    path.unlink()
    assert "cannot be read" in refused(copy, "removal:10 min")


def test_a_state_whose_fmu_was_changed(copy: Path) -> None:
    """One bit of what the FMU gave: its own check word finds it."""

    def flip(members: dict[str, bytes]) -> None:
        data = bytearray(members["0.bin"])
        data[-9] ^= 4
        members["0.bin"] = bytes(data)

    spoil(copy, flip)
    assert "check word" in refused(copy, "removal:10 min")


def test_a_state_of_another_time(copy: Path) -> None:
    """The state of 1200 s under the name of that of 600 s, and one that says another row of the table."""
    shutil.copy(copy / "states" / "removal-1200s.state", copy / "states" / "removal-600s.state")
    spoil(copy, lambda members: None)
    assert "is not the state of t = 600 s" in refused(copy, "removal:10 min")


def test_a_state_that_does_not_fit_its_table(copy: Path) -> None:
    """The FMU of 1200 s in the state of 600 s: it is good by itself, and its outputs are not those of the row."""
    with zipfile.ZipFile(copy / "states" / "removal-1200s.state") as archive:
        later = archive.read("0.bin")

    def swap(members: dict[str, bytes]) -> None:
        members["0.bin"] = later

    spoil(copy, swap)
    assert "does not fit its table" in refused(copy, "removal:10 min")


def test_a_table_that_was_changed(copy: Path) -> None:
    path = copy / "removal.parquet"
    table = pyarrow.parquet.read_table(path)
    pyarrow.parquet.write_table(table.slice(1), path)
    assert "is not at t = 600 s" in refused(copy, "removal:10 min")
    pyarrow.parquet.write_table(table.slice(0, 20), path)
    assert "is not at t = 600 s" in refused(copy, "removal:10 min")


def test_what_is_no_state(copy: Path) -> None:
    spoil(copy, text(lambda content: content.replace('"format": 1', '"format": 2')))
    assert "another format" in refused(copy, "removal:10 min")
    spoil(copy, lambda members: members.pop("state.json"), "removal-1200s.state")
    assert "is not a kept state" in refused(copy, "removal:1200 s")


def test_another_fmu(copy: Path) -> None:
    path = copy / "provenance.json"
    told = json.loads(path.read_text())
    told["phases"]["removal"]["fmu"]["guid"] = "{of-another-build}"
    told["packages"]["dcone-cosim"] = "0.9.9"
    path.write_text(json.dumps(told))
    said = refused(copy, "removal:10 min")
    assert "{of-another-build}" in said
    assert "0.9.9" in said


def test_a_capture_that_handed_nothing_over(copy: Path) -> None:
    path = copy / "provenance.json"
    told = json.loads(path.read_text())
    told["phases"]["capture"]["left"] = {}
    path.write_text(json.dumps(told | {"message": "capture failed: missed"}))
    assert "left nothing to take over: capture failed: missed" in refused(copy, "removal")


@pytest.mark.parametrize(
    ("save_at", "told"),
    [
        ("capture:31 s", "the capture goes from 0 s to 30 s"),
        ("removal:-1 s", "the removal goes from 0 s"),
        ("removal", "expected a time with its unit"),
        ("1 h", "of which phase?"),
        ("tow:1 h", "no phase 'tow'"),
    ],
)
def test_instants_that_cannot_come(mission: Kept, tmp_path: Path, save_at: str, told: str) -> None:
    with pytest.raises(InputError, match=told):
        put("mission", tmp_path / "out", mission.settings, (save_at,))
    assert list(tmp_path.iterdir()) == []


def test_an_fmu_that_cannot_write_its_state(tmp_path: Path) -> None:
    """The template's can; one that does not say so is refused before anything is run."""
    for flag, works in (("true", True), ("false", False)):
        folder = tmp_path / flag
        folder.mkdir()
        build(
            folder, change=lambda xml, flag=flag: xml.replace('SerializeFMUstate="true"', f'SerializeFMUstate="{flag}"')
        )
        (folder / "drift.toml").write_text(SCENE)
        if works:
            kept = put(folder / "drift.toml", folder / "out", save_at=("50 s",))
            on = put(kept, folder / "on", go_on="50 s")
            assert (on / "removal.parquet").read_bytes() == (kept / "removal.parquet").read_bytes()
            continue
        with pytest.raises(InputError, match="does not say canSerializeFMUstate = true"):
            put(folder / "drift.toml", folder / "out", save_at=("50 s",))
        assert not (folder / "out").exists()


def test_an_end_before_the_state(copy: Path) -> None:
    assert "removal.duration = 300 s ends before that" in refused(copy, "removal:10 min", "removal.duration=5 min")


def test_a_capture_that_would_have_handed_over_before(tmp_path: Path) -> None:
    """Flown on for a second after its capture, it is no longer what a removal would have taken over; the twin from
    before the capture is, and comes to the mission's own hand-over."""
    alone = (*COARSE, 'phases=["capture"]', "capture.after_capture=1 s")
    kept = put("mission", tmp_path / "alone", alone, ("capture:9 s", "capture:7 s"))
    both = ('phases=["capture", "removal"]',)
    assert "would have handed over at t = 8.8" in refused(kept, "capture:9 s", *both)
    on = put(kept, tmp_path / "on", both, go_on="capture:7 s")
    whole = put("mission", tmp_path / "whole", (*COARSE, "capture.after_capture=1 s"))
    assert tables(on) == tables(whole)


def test_what_an_fmu_lets_be_changed_on_its_way() -> None:
    """Inputs and tunable parameters of any FMU, by what its description says of them; a fixed one is refused, and what
    may change is told."""
    origin = Origin.__new__(Origin)
    origin.option, origin.place = "--from RUN", Place("removal", 600.0)
    variables = {
        name: VariableInfo(name, at, "Real", "1", causality, "", variability=variability)
        for at, (name, causality, variability) in enumerate(
            [("push", "input", "continuous"), ("drag", "parameter", "tunable"), ("mass", "parameter", "fixed")]
        )
    }
    tunable = [Difference("removal", "parameters", name, 1.0, 2.0) for name in ("push", "drag")]
    longer = Difference("removal", "", "duration", 1.0, 2.0)
    assert origin._changed([*tunable, longer], variables) == {"push": 2.0, "drag": 2.0}
    with pytest.raises(InputError, match=r"removal\.mass: was 1, is 2.*fixed parameter.*What may change: drag, push"):
        origin._changed([Difference("removal", "parameters", "mass", 1.0, 2.0)], variables)
