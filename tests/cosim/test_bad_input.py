"""Bad input ends with exit code 2, one message that names key, value and expectation, and leaves nothing behind."""

from __future__ import annotations

from pathlib import Path

import pytest

from dcone_cosim import commands
from dcone_cosim.loading import find
from tests.cosim.conftest import Dcone


@pytest.fixture
def dcone(dcone: Dcone, monkeypatch: pytest.MonkeyPatch):
    """Run the command line in an empty folder; returns exit code and what it wrote to stderr. No FMU may be built."""

    def never(*_: object) -> None:
        raise AssertionError("bad input got as far as building an FMU")

    monkeypatch.setattr(commands.build, "ensure", never)
    monkeypatch.setattr(commands.build, "write_fmus", never)

    def run(*arguments: str) -> tuple[int, str]:
        code, _, err = dcone(*arguments)
        return code, err

    return run


def changed(scene: str, old: str, new: str) -> str:
    text = find(scene).read_text()
    assert text.count(old) == 1, f"{old!r} is not once in {scene}"
    return text.replace(old, new)


@pytest.mark.parametrize(
    ("scene", "old", "new", "named"),
    [
        # a negative mass, a bare number, a wrong dimension
        ("mission", 'mass = "0.84 kg"', 'mass = "-0.84 kg"', ["capture.net.mass", '"-0.84 kg"', "greater than 0 kg"]),
        ("mission", 'side = "12 m"', "side = 12", ["capture.net.side = 12", "bare number", "length", '"24 m"']),
        ("mission", 'side = "12 m"', 'side = "12 kg"', ["capture.net.side", "is a mass", "expected a length"]),
        ("mission", 'altitude = "800 km"', 'altitude = "800 s"', ["orbit.altitude", "is a time", "a length"]),
        ("mission", 'altitude = "800 km"', 'altitude = "-7000 km"', ["orbit.altitude", '"-7000 km"', "at least"]),
        ("mission", '["0 m", "-12 m", "0 m"]', '["0 m", -12, "0 m"]', ["chaser.start_position", "element 2"]),
        ("mission", '["0 m", "-12 m", "0 m"]', '["0 m", "-12 m"]', ["chaser.start_position", "list of 3"]),
        ("mission", "capacity = 625", "capacity = 0", ["capture.nodes.capacity = 0"]),
        ("mission", "capacity = 625", 'capacity = "many"', ['capture.nodes.capacity = "many"']),
        ("mission", "damping_ratio = 0.106", 'damping_ratio = "0.106 m"', ["net.damping_ratio", "bare number"]),
        ("mission", "damping_ratio = 0.106", "damping_ratio = nan", ["net.damping_ratio", "finite"]),
        ("mission", 'trigger = "time"', 'trigger = "tome"', ["closing.trigger", "time, first_contact"]),
        # unknown keys, tables, terms
        ("mission", 'side = "12 m"', 'sied = "12 m"', ["capture.net.sied", "unknown key", "'side'"]),
        ("detumbling", 'body = "box"', 'shape = "box"', ["target.shape", "body chooses", "point, rigid, box"]),
        ("mission", 'law = "locked"', 'law = "locked"\nbody = "x"', ["removal.reel.body", "law chooses", "linear"]),
        ("mission", "[capture.bullets]", "[capture.bulets]", ["capture.bulets", "'bullets'"]),
        ("mission", "[orbit]", "[orbti]", ["orbti", "'orbit'"]),
        ("mission", 'law = "hill"', 'law = "hil"', ["capture.gravity.law", '"hil"', "none, hill"]),
        ("mission", 'shape = "box"', 'shape = "bocks"', ["capture.target.shape", "box"]),
        ("mission", '[capture.gravity]\nlaw = "hill"\n', "", ["capture.gravity missing", "none, hill"]),
        ("mission", 'law = "locked"', 'law = "linear"', ["removal.tether", '[removal.reel] law = "locked"']),
        ("mission", "[handoff]", "[handoff]\nspin = 3", ["handoff.spin", "unknown key"]),
        ("mission", "[handoff]", "[handoff]\nspin_tolerance = 0.1", ["handoff.spin_tolerance", "point_tolerance"]),
        # what only makes sense together
        ("mission", "[handoff]", '[removal.chaser]\nmass = "1 kg"\n[handoff]', ["removal.chaser.mass", "hand-off"]),
        ("mission", "[handoff]", '[removal.start]\nseparation = "1 m"\n[handoff]', ["removal.start", "hand-off"]),
        ("mission", 'altitude = "800 km"', "eccentricity = 0.1", ["orbit.eccentricity = 0.1", "must be 0"]),
        ("mission", 'hand_over = "captured"', 'hand_over = "settled"', ["capture.hand_over", "[capture.settling]"]),
        ("mission", 'phases = ["capture", "removal"]', 'phases = ["captur"]', ["phases", "'captur'", "'capture'"]),
        ("mission", 'phases = ["capture", "removal"]', "phases = []", ["phases", "expected a list"]),
        ("table2-deorbit", "[removal]\n", '[removal]\nsteps = 3\n', ["removal.steps", "unknown key"]),
        ("table2-deorbit", 'macro_step = "60 s"', 'macro_step = "0 s"', ["removal.macro_step", "greater than 0 s"]),
        ("table2-deorbit", 'macro_step = "60 s"', "", ["removal.macro_step missing", '"60 s"']),
        ("table2-deorbit", "[removal.tether]", "[removal.tether]\n[removal.thrusts]", ["removal.thrusts", "'thrust'"]),
        # out of reach
        ("mission", '["0 m", "-12 m", "0 m"]', '["0 m", "-300 m", "0 m"]', ["capture.", "line"]),
    ],
)  # fmt: skip
def test_a_mistake_in_a_scene(dcone, tmp_path: Path, scene: str, old: str, new: str, named: list[str]) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(changed(scene, old, new))
    code, message = dcone("run", "mine.toml")
    assert code == 2, message
    for part in named:
        assert part in message
    assert "Traceback" not in message
    assert [p.name for p in tmp_path.iterdir()] == ["mine.toml"]


def test_all_mistakes_are_told_at_once_with_their_lines(dcone, tmp_path: Path) -> None:
    text = changed("table2-deorbit", 'mass = "2000 kg"', "mass = 2000").replace('"98 deg"', '"98 kg"')
    (tmp_path / "mine.toml").write_text(text)
    code, message = dcone("run", "mine.toml")
    assert code == 2
    assert "2 mistakes" in message
    first, second = (text.splitlines().index(line) + 1 for line in ("mass = 2000", 'inclination = "98 kg"'))
    assert f"line {first}: removal.chaser.mass" in message
    assert f"line {second}: orbit.inclination" in message


@pytest.mark.parametrize(
    ("content", "named"),
    [
        (b"", "empty"),
        (b"  \n\n", "empty"),
        (b'[capture]\nmacro_step = "0.0', "not valid TOML, or cut short"),
        (b"[capture\n", "not valid TOML, or cut short"),
        (b"\xff\xfe\x00", "cannot be read as text"),
        (b'title = "nothing else"\n', "holds no phase"),
        (b"capture = 3\n", "capture"),
        (b'[orbit]\naltitude = "800 km"\n', "no phase"),
    ],
)
def test_files_that_are_no_scene(dcone, tmp_path: Path, content: bytes, named: str) -> None:
    (tmp_path / "mine.toml").write_bytes(content)
    code, message = dcone("run", "mine.toml")
    assert code == 2
    assert named in message
    assert [p.name for p in tmp_path.iterdir()] == ["mine.toml"]


@pytest.mark.parametrize("cut", [0.3, 0.5, 0.7, 0.9])
def test_a_scene_cut_short_never_ends_in_a_traceback(dcone, tmp_path: Path, cut: float) -> None:
    text = find("mission").read_text()
    cut_at = text.rindex("=", 0, int(cut * len(text))) + 1
    (tmp_path / "mine.toml").write_text(text[:cut_at])
    code, message = dcone("run", "mine.toml")
    assert code == 2
    assert "cut short" in message


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (("run", "table1-captur"), "'table1-capture'"),
        (("run", "nowhere.toml"), "does not exist"),
        (("run", "."), "is a folder"),
        (("inspect", "misson"), "'mission'"),
        (("build", "misson", "-o", "fmus"), "'mission'"),
        (("run",), "Missing argument"),
        (("run", "mission", "--fast"), "--fast"),
    ],
)
def test_names_and_arguments(dcone, tmp_path: Path, arguments: tuple[str, ...], named: str) -> None:
    code, message = dcone(*arguments)
    assert code == 2
    assert named in message
    assert not list(tmp_path.iterdir())


def test_a_place_that_is_taken(dcone, tmp_path: Path) -> None:
    (tmp_path / "taken").mkdir()
    (tmp_path / "taken" / "thesis.tex").write_text("years of work")
    code, message = dcone("run", "mission", "-o", "taken")
    assert (code, "already exists" in message) == (2, True)
    code, message = dcone("run", "mission", "-o", "taken", "--force")
    assert (code, "not the folder of a run" in message) == (2, True)
    assert (tmp_path / "taken" / "thesis.tex").read_text() == "years of work"
    (tmp_path / "file").write_text("")
    code, message = dcone("run", "mission", "-o", "file/inside")
    assert (code, "cannot be written" in message) == (2, True)
