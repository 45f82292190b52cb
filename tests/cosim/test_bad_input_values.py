"""Values that are well formed and yet cannot work are refused before any build, with key, line and what would do."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from dcone_cosim.errors import CAPTURE_FAILED, SUCCESS, InputError
from dcone_cosim.fmu.component import CallError
from dcone_cosim.loading import find, load
from dcone_cosim.master import run_scene
from dcone_cosim.phases.capture import CaptureOptions
from dcone_cosim.progress import Progress
from dcone_cosim.scene.data import Scene
from dcone_cosim.scene.expected import Expected, Unexpected
from dcone_cosim.scenes.reading import parse
from fmu_src.net_capture.capacity import FAMILIES, MOST_NODES
from fmu_src.net_capture.interface import refusals
from fmu_src.net_capture.nets.grid import node_count
from tests.cosim.mock_components import MockCapture

MUZZLE = 'start_position = ["0 m", "-12 m", "0 m"]'
PHASES = 'phases = ["capture", "removal"]'
REST = 'rest_length = "14 m"'
PAID_OUT = 'state = "slack"\nlength = "14 m"'
CLOSING = (
    '[capture.closing]\ndrive = "winches"\ntrigger = "time"\ntime = "{}"\nspeed = "5 m/s"\nstall_force = "{}"\n'
    'rings = 1\nmaterial = "nylon 66"\naxial_stiffness = "903 N" # of 0.5 mm\n'
)
MISSION_CLOSING = CLOSING.format("6.4 s", "6 N")
TABLE_1_CLOSING = CLOSING.format("11.2 s", "5 N")


def changed(scene: str, *changes: tuple[str, str]) -> str:
    text = find(scene).read_text()
    for old, new in changes:
        assert text.count(old) == 1, f"{old!r} is not once in {scene}"
        text = text.replace(old, new)
    return text


def complaint(text: str) -> str:
    with pytest.raises(InputError) as error:
        parse(text, "mine", "mine.toml")
    return str(error.value)


@pytest.mark.parametrize(
    ("scene", "old", "new", "named"),
    [
        # numbers that are none
        ("mission", "damping_ratio = 0.106", f"damping_ratio = {'9' * 400}", ["net.damping_ratio", "too large"]),
        ("mission", 'side = "12 m"', 'side = "[1,2] m"', ['net.side = "[1,2] m"', "is not a number with a unit"]),
        ("mission", 'side = "12 m"', 'side = "1 99m"', ['net.side = "1 99m"', "is not a number with a unit"]),
        ("mission", MUZZLE, MUZZLE.replace("-12 m", "far"), ["element 2 is not a number with a unit"]),
        ("mission", "[handoff]", "[capture.solver]\nseed = 3000000000\n[handoff]", ["solver.seed", "2147483647"]),
        ("table1-capture", '"5.32 s"', "5", ["capture.snapshots", "element 2: a bare number"]),
        # bounds in the unit that was written
        ("mission", 'altitude = "800 km"', 'altitude = "50 km"', ["orbit.altitude", "must be at least 100 km"]),
        ("mission", 'angle = "40 deg"', 'angle = "95 deg"', ["bullets.angle", "must be at most 90 deg"]),
        ("table2-deorbit", 'diameter = "1 mm"', 'diameter = "2 km"', ["tether.diameter", "must be at most 0.001 km"]),
        # macro steps
        ("table2-deorbit", '"60 s"', '"1 us"', ['macro_step = "1 us"', 'removal.duration = "1 day"', "5,000,000"]),
        ("table2-deorbit", '"60 s"', '"2 day"', ['macro_step = "2 day"', 'removal.duration, "1 day"']),
        ("mission", '"0.02 s"', '"1 ns"', ['capture.macro_step = "1 ns"', "capture.duration"]),
        # the net
        ("mission", "capacity = 625", "capacity = -1", ["nodes.capacity = -1", "a whole number of nodes"]),
        ("mission", "capacity = 625", 'capacity = "625"', ['nodes.capacity = "625"', "a whole number of nodes"]),
        ("mission", "capacity = 625", "capacity = 9000000", ["nodes.capacity = 9000000", f"to {MOST_NODES}"]),
        ("mission", "capacity = 625", f"capacity = {'9' * 4000}", ["nodes.capacity", f"to {MOST_NODES}"]),
        ("mission", "capacity = 625", "capacity = 624", ["nodes.capacity = 624", "at least 625"]),
        ("mission", 'mesh = "0.5 m"', 'mesh = "0.5 m"\nsegments = 2', ["nodes.capacity = 625", "at least 1825"]),
        ("mission", 'mesh = "0.5 m"', 'mesh = "0.7 m"', ["net.side", "whole number of net.mesh, 0.7 m"]),
        ("mission", 'mesh = "0.5 m"', 'mesh = "1 cm"', ['net.mesh = "1 cm"', "1200 meshes", "at most 400"]),
        ("mission", 'fold_side = "0.4 m"', 'fold_side = "13 m"', ["net.fold_side", "than the mouth is wide, 12 m"]),
        # the target
        ("mission", "[capture.contact]", "start_attitude = [1, 1, 0, 0]\n[capture.contact]", ["unit length"]),
        (
            "mission",
            "[capture.contact]",
            'principal_inertia = ["1 kg m2", "1 kg m2", "3 kg m2"]\n[capture.contact]',
            ["target.principal_inertia", "sum of the other two"],
        ),
        # the shot
        ("mission", MUZZLE, MUZZLE.replace("-12", "-1.5"), ["chaser.start_position", "outside the target"]),
        ("mission", 'angle = "40 deg"', 'angle = "0 deg"', ["bullets.angle", "never open"]),
        ("mission", 'angle = "40 deg"', 'angle = "90 deg"', ["bullets.angle", "never arrives"]),
        ("mission", 'speed = "3 m/s"', 'speed = "0 m/s"', ["bullets.speed", "never arrives"]),
        ("mission", "[-0.006, 1.0, 0.0]", "[0, -1, 0]", ["shot.axis = [0, -1, 0]", "points away", "[0, 1, 0]"]),
        ("mission", "[-0.006, 1.0, 0.0]", "[1, 0.3, 0]", ["shot.axis", "11.49 m beside", "within 11.12 m"]),
        # the tow
        ("table2-deorbit", 'separation = "10 m"', 'separation = "13 m"', ["separation", "rest_length, 12 m"]),
        ("mission", REST, 'rest_length = "15 m"', ["removal.tether.rest_length", 'capture.tether.length = "14 m"']),
        # phases and titles
        ("mission", PHASES, 'phases = ["removal", "capture"]', ['["removal", "capture"]: the capture comes before']),
        ("mission", PHASES, 'phases = ["capture", "capture"]', ["a phase twice"]),
        ("mission", PHASES, 'phases = "capture"', ['phases = "capture": expected a list']),
        ("mission", PHASES, "phases = [1]", ["phases = [1]: expected a list"]),
        ("mission", "[orbit]", "[[orbit]]", ["orbit", "expected a table [orbit]"]),
        ("table2-deorbit", "[orbit]", "capture = 3\n[orbit]", ["capture = 3: expected a table [capture]"]),
        ("table2-deorbit", "[removal.reel]\n", "[[removal.reel]]\n", ["expected a table [removal.reel]"]),
        # handing over
        ("mission", 'hand_over = "captured"', 'hand_over = "none"', ["capture.hand_over", "a removal follows"]),
        ("mission", MISSION_CLOSING, "", ["capture.closing missing", "no capture is ever reported"]),
    ],
)  # fmt: skip
def test_one_mistake_is_one_message(scene: str, old: str, new: str, named: list[str]) -> None:
    message = complaint(changed(scene, (old, new)))
    assert message.startswith("mine.toml: 1 mistake\n  line "), message
    for part in named:
        assert part in message


def test_a_title_is_a_text() -> None:
    text = re.sub(r"title = .*", "title = 3", find("mission").read_text())
    assert "1 mistake\n  line 3: title = 3: expected a text" in complaint(text)


def test_a_line_shorter_than_the_way_is_refused_before_the_shot() -> None:
    """Whether the capture has a tether of its own or not; a chaser that closes in may have a shorter one."""
    both = complaint(changed("mission", (REST, 'rest_length = "5 m"')))
    # 12 m less half the diagonal of 2.5 x 3.9 x 2.5 m
    assert "must exceed 9.36799 m, the distance from the chaser to the target's nearest point" in both
    without = (f"[capture.tether]\n{PAID_OUT}\n", "")
    alone = complaint(changed("mission", without, (REST, 'rest_length = "5 m"')))
    assert 'removal.tether.rest_length = "5 m": must exceed 9.36799 m' in alone
    assert parse(changed("mission", without, (REST, 'rest_length = "9.4 m"')), "a", "a").phases
    assert "must exceed 9.36799 m" in complaint(changed("mission", without, (REST, 'rest_length = "9.3 m"')))
    nearing = (MUZZLE, MUZZLE + '\nstart_velocity = ["0 m/s", "1 m/s", "0 m/s"]')
    assert parse(changed("mission", without, (REST, 'rest_length = "5 m"'), nearing), "a", "a").phases


def test_the_line_is_told_once_or_alike() -> None:
    removal_only = parse(changed("mission", (PAID_OUT, 'state = "slack"')), "a", "a")
    assert removal_only.phases[0].main.parameters["tether.length"] == 14.0
    capture_only = parse(changed("mission", (REST, "")), "a", "a")
    assert capture_only.phases[1].main.parameters["tether.rest_length"] == 14.0
    assert parse(changed("mission", (REST, 'rest_length = "1400 cm"')), "a", "a").phases
    neither = complaint(changed("mission", (PAID_OUT, 'state = "slack"'), (REST, "")))
    assert "removal.tether.rest_length missing" in neither


def test_what_is_refused_is_close_to_what_is_not() -> None:
    """Twins of the refusals above: the nearest value that works is accepted."""
    for change in [
        ("capacity = 625", "capacity = 625"),
        ('fold_side = "0.4 m"', 'fold_side = "2 m"'),
        ("[-0.006, 1.0, 0.0]", "[0.8, 1.0, 0.0]"),
        ("[capture.contact]", "start_attitude = [1, 0, 0, 0]\n[capture.contact]"),
        ("[capture.contact]", 'principal_inertia = ["1 kg m2", "2 kg m2", "3 kg m2"]\n[capture.contact]'),
        (MUZZLE, MUZZLE.replace("-12", "-2.5")),
    ]:
        assert parse(changed("mission", change), "a", "a").phases
    assert parse(changed("table2-deorbit", ('separation = "10 m"', 'separation = "12 m"')), "a", "a").phases
    off_center = ("[removal.target]", '[removal.target]\nattachment_distance = "3 m"')
    for separation, told in (("14.9 m", ""), ("15.1 m", "attachment_distance, 15 m"), ("3 m", "must exceed")):
        text = changed("table2-deorbit", ('separation = "10 m"', f'separation = "{separation}"'), off_center)
        assert told in complaint(text) if told else parse(text, "a", "a").phases


def test_nodes_are_counted_as_the_kernel_counts_them() -> None:
    for meshes, segments, nodes in ((24, 1, 625), (24, 2, 625 + 2 * 25 * 24), (2, 3, 9 + 2 * 2 * 3 * 2)):
        assert node_count(meshes, meshes, segments) == nodes
    assert node_count(3, 2, 2) == 4 * 3 + 3 * 3 + 4 * 2


def test_a_muzzle_is_judged_in_the_targets_own_axes() -> None:
    """3 m along y lie within a box 8 m long, and outside the same box turned by a quarter about z."""
    phase = load("table1-capture").phases[0]
    values = {**phase.main.defaults, **phase.main.parameters, "chaser.start_position[2]": -3.0}
    assert [r.name for r in refusals(phase.main.terms, values)] == ["chaser.start_position"]
    turned = values | {f"target.start_attitude[{i}]": part for i, part in ((1, 0.5**0.5), (4, 0.5**0.5))}
    assert not refusals(phase.main.terms, turned)


@pytest.mark.parametrize("capacity", ["0", "-1", "²", "1.5", "", str(MOST_NODES + 1), "9" * 5000, 625])
def test_a_capacity_that_is_no_term(capacity: object) -> None:
    assert capacity not in FAMILIES["nodes"]


@pytest.mark.parametrize(
    "text",
    ["1 m**1e9", "1 mag", "- m", "1 m/", "1 \0", "1 m^(1/0)", "1e3 1e3 m", "1_000 m", "1,5 m", "1 {", "1 m" + 99 * "("],
)  # fmt: skip
def test_no_text_breaks_the_reading_of_units(text: str) -> None:
    with pytest.raises(Unexpected):
        Expected("m", example="1 m").read(text)


class TestFiles:
    def test_a_byte_order_mark_is_no_mistake(self, tmp_path: Path) -> None:
        (tmp_path / "mine.toml").write_bytes(b"\xef\xbb\xbf" + find("table2-deorbit").read_bytes())
        assert load(str(tmp_path / "mine.toml")).phases == load("table2-deorbit").phases

    @pytest.mark.parametrize(
        ("content", "named"),
        [
            ('title = "a"\n'.encode("utf-16"), "it is in UTF-16; save it as UTF-8"),
            ('\ntitle = "ä"\n'.encode("latin-1"), "byte 0xe4 in line 2; save it as UTF-8"),
            (b'[capture]\nmacro_step = "0.0', "line 2, at the end of the file"),
            (b"x = " + b"9" * 5000, "thousands of digits"),
            (b"x = " + b"[" * 100_000, "nested too deeply"),
        ],
    )
    def test_a_file_that_cannot_be_read_says_why(self, tmp_path: Path, content: bytes, named: str) -> None:
        (tmp_path / "mine.toml").write_bytes(content)
        with pytest.raises(InputError, match=re.escape(named)):
            load(str(tmp_path / "mine.toml"))

    def test_a_name_too_long_for_a_file(self) -> None:
        with pytest.raises(InputError, match="cannot be looked for"):
            load("a" * 5000)


class TestWithoutCapture:
    """A net shot at nothing, or never closed, is a study of its opening: it is flown to the end."""

    def free(self, *changes: tuple[str, str]) -> Scene:
        return parse(changed("table1-capture", (TABLE_1_CLOSING, ""), *changes), "free", "free.toml")

    def test_it_asks_for_no_capture_unless_told(self) -> None:
        asked_for = 'hand_over = "captured"'
        assert self.free((asked_for, "")).phases[0].options.hand_over == "none"
        assert self.free().phases[0].options.hand_over == "captured"
        too_short = ('duration = "30 s"', 'duration = "2 s"')
        assert self.free((asked_for, ""), too_short).phases[0].duration == 2.0
        with pytest.raises(InputError, match="raise duration"):
            self.free(too_short)
        closing = parse(changed("table1-capture", (asked_for, "")), "a", "a")
        assert closing.phases[0].options.hand_over == "captured"

    @pytest.mark.parametrize(
        ("hand_over", "ends_as", "outcome", "code"),
        [
            ("none", "captured", "flown", SUCCESS),
            ("none", "missed", "missed", SUCCESS),
            ("captured", "captured", "flying", CAPTURE_FAILED),
            ("captured", "missed", "missed", CAPTURE_FAILED),
        ],
    )
    def test_it_is_flown_to_its_end(self, make_scene, hand_over: str, ends_as: str, outcome: str, code: int) -> None:
        scene = make_scene("capture")
        scene = replace(scene, phases=(replace(scene.phases[0], options=CaptureOptions(hand_over)),))
        component = MockCapture(instant=1e9 if ends_as == "captured" else 7.0, outcome=ends_as)
        result = run_scene(scene, lambda phase, name: component, Progress())
        assert (result.exit_code, result.phases["capture"].outcome) == (code, outcome)
        assert (result.phases["capture"].end == 20.0) == (hand_over == "none" or ends_as == "captured")


class TestWhatOnlyAnFmuRefuses:
    def test_it_is_told_in_the_scenes_terms(self) -> None:
        class Refusing(MockCapture):
            def set(self, values: object) -> None:
                pass

            def enter_initialisation(self, start: float, stop: float | None = None) -> None:
                raise CallError(
                    "capture", "", "net.mass is too small", "x.fmu: fmi2ExitInitializationMode gave Error", "Error"
                )

        scene = parse(find("table1-capture").read_text(), "mine", "folder/mine.toml")
        line = scene.text.splitlines().index('mass = "0.33 kg"') + 1
        with pytest.raises(InputError) as error:
            run_scene(scene, lambda phase, name: Refusing(), Progress())
        first, words, detail = str(error.value).splitlines()
        assert first == "folder/mine.toml: the capture cannot begin"
        assert words == f"  line {line}: net.mass is too small"
        assert detail == "  (x.fmu: fmi2ExitInitializationMode gave Error)"
