"""An FMU in a model's place: the scene is read against its variables, and every mistake is told with its line."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from dcone_cosim import cli
from dcone_cosim.coupling.wiring import mismatch
from dcone_cosim.errors import InputError
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.fmu.steppable import VariableInfo
from dcone_cosim.loading import find, load
from dcone_cosim.scene.data import Scene
from dcone_cosim.units import by_name
from tests.cosim.conftest import Dcone
from tests.cosim.fmus.build import build

SCENE = """
[orbit]
altitude = "700 km"

[removal]
fmu = "my_removal.fmu"
isolate = true
timeout = "30 s"
macro_step = "10 s"
duration = "100 s"

[removal.reel] # names a term of our model, and says nothing to an FMU
law = "locked"

[removal.tether]
rest_length = "13 m"

[removal.parameters]
"target.mass" = "1.1 t"
start.relative_position = ["0 m", "1 m", "0 m"]
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where a removal and a capture made of the template lie."""
    folder = tmp_path_factory.mktemp("fmus")
    for phase in ("removal", "capture"):
        build(folder / phase, phase).rename(folder / f"my_{phase}.fmu")
    return folder


def read(folder: Path, text: str = SCENE) -> Scene:
    (folder / "mine.toml").write_text(text)
    return load(str(folder / "mine.toml"))


def test_its_variables_are_the_keys(folder: Path) -> None:
    (phase,) = read(folder).phases
    main = phase.main
    assert (main.fmu, main.model, dict(main.terms)) == (folder / "my_removal.fmu", "", {})
    assert (main.isolate, main.timeout) == (True, 30.0)
    assert main.parameters["tether.rest_length"] == 13.0
    assert main.parameters["target.mass"] == 1100.0
    assert [main.parameters[f"start.relative_position[{i}]"] for i in (1, 2, 3)] == [0.0, 1.0, 0.0]
    assert main.parameters["orbit.altitude"] == 700e3
    assert main.defaults["chaser.mass"] == 2000.0
    assert phase.choice("start.condition", "handed_over") == 3.0


def test_the_text_kept_says_where_the_fmu_was(folder: Path, tmp_path: Path) -> None:
    """From another folder, the scene that is kept with the results is still the same one."""
    scene = read(folder)
    assert f'fmu = "{folder / "my_removal.fmu"}"' in scene.text
    assert "# names a term of our model" in scene.text
    (tmp_path / "scene.toml").write_text(scene.text)
    assert load(str(tmp_path / "scene.toml")).phases == scene.phases


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        (
            '"my_removal.fmu"',
            '"my_removel.fmu"',
            "fmu = \"my_removel.fmu\": no such file; did you mean 'my_removal.fmu'?",
        ),
        ('"my_removal.fmu"', '"."', "a folder; expected an FMU"),
        ('"my_removal.fmu"', '""', 'expected the path of an FMU, such as "my.fmu"'),
        ('"my_removal.fmu"', '"mine.toml"', "not a readable FMU: an FMU is a zip file"),
        ('"my_removal.fmu"', '"https://example.org/x.fmu"', "is an address: nothing is fetched"),
        ('"my_removal.fmu"', "3", 'expected the path of an FMU, such as "my.fmu"'),
        (
            "isolate = true\n",
            "isolate = false\n",
            'timeout = "30 s": only calls to an isolated FMU have a limit; add isolate = true',
        ),
        (
            "rest_length =",
            "rest_lenght =",
            "has no variable 'tether.rest_lenght' that can be set; did you mean 'tether.rest_length'",
        ),
        ('"13 m"', '"13 kg"', 'removal.tether.rest_length = "13 kg": is a mass; expected a length'),
        ('"13 m"', "13", "a bare number has no unit; expected a length with its unit"),
        ('"target.mass"', '"target.mas"', 'removal.parameters."target.mas" = "1.1 t": my_removal.fmu has'),
        ('"target.mass"', '"separation"', "'separation' of my_removal.fmu is an output: only parameters and inputs"),
        ('"target.mass"', '"tether.rest_length"', "is a mass"),
        ('["0 m", "1 m", "0 m"]', '["0 m", "1 m"]', "expected a list of 3"),
        ('law = "locked"', 'lawn = "locked"', "has no variable 'reel.lawn'"),
    ],
)
def test_a_mistake_in_what_is_said_of_an_fmu(folder: Path, old: str, new: str, told: str) -> None:
    assert SCENE.count(old) == 1
    text = SCENE.replace(old, new)
    with pytest.raises(InputError) as error:
        read(folder, text)
    message = str(error.value)
    assert told in message
    assert ": 1 mistake\n  line " in message, message


def test_a_value_given_twice(folder: Path) -> None:
    with pytest.raises(InputError, match=r"line \d+: .*is given twice: also as removal\.tether\.rest_length"):
        read(folder, SCENE.replace('"target.mass" = "1.1 t"', '"tether.rest_length" = "1 m"'))


def test_what_the_phase_needs_and_the_fmu_lacks(tmp_path: Path) -> None:
    """The contract is asked for when a capture hands over; alone, the removal may lack what only that needs."""
    fmu = build(tmp_path, change=lambda xml: xml.replace('name="start.condition"', 'name="start.conditions"'))
    assert read(tmp_path).phases
    (tmp_path / "both.toml").write_text(
        find("mission")
        .read_text()
        .replace("[removal]\n", f"[removal]\nfmu = '{fmu}'\n")
        .replace('youngs_modulus = "60 GPa"\ndamping_ratio = 0.05\n', "")
        .replace('diameter = "1 mm"\n', "")
    )
    with pytest.raises(InputError, match=r"removal\.fmu = .*start\.condition: missing; .*'start\.conditions'"):
        load(str(tmp_path / "both.toml"))


def test_units_of_its_own(tmp_path: Path) -> None:
    """A variable that the FMU counts in millimetres is written in any length, and becomes metres."""

    def in_millimetres(xml: str) -> str:
        xml = xml.replace(
            "<UnitDefinitions>", '<UnitDefinitions><Unit name="mm"><BaseUnit m="1" factor="0.001" /></Unit>', 1
        )
        changed = re.sub(
            r'(<ScalarVariable name="tether.rest_length".*?<Real unit=")m(" start=")[^"]*',
            r"\g<1>mm\g<2>12000",
            xml,
            flags=re.S,
        )
        assert changed != xml
        return changed

    build(tmp_path, change=in_millimetres)
    (phase,) = read(tmp_path).phases
    assert phase.main.parameters["tether.rest_length"] == 13.0
    assert phase.main.defaults["tether.rest_length"] == pytest.approx(12.0)
    with pytest.raises(InputError, match=r'expected a length with its unit, such as "12 m"'):
        read(tmp_path, SCENE.replace('"13 m"', "13"))


def test_components_from_files(folder: Path) -> None:
    """A component is any FMU; it is asked for no contract, and connected by its own names."""
    text = (
        SCENE + '[removal.components.other]\nfmu = "my_capture.fmu"\n[removal.components.other.chaser]\nmass = "3 t"\n'
    )
    text = text.replace("[removal]\n", '[removal]\nconnections = ["other.tether.paid_out -> removal.reel.length"]\n')
    with pytest.raises(InputError, match=r"removal has no input 'reel\.length'"):
        read(folder, text)
    (phase,) = read(folder, text.replace('connections = ["other.tether.paid_out -> removal.reel.length"]\n', "")).phases
    assert phase.others[0].parameters["chaser.mass"] == 3000.0


def test_a_fresh_scene_keeps_no_temporary_folder(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    assert read(folder).phases
    assert not list(tmp_path.iterdir())


def test_validate_opens_it_and_builds_nothing(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    read(folder)
    monkeypatch.setattr("dcone_cosim.build.ensure", lambda *_: pytest.fail("an FMU was built"))
    monkeypatch.setattr("sys.argv", ["dcone", "validate", str(folder / "mine.toml"), "mission", "--json"])
    with pytest.raises(SystemExit) as stop:
        cli.main()
    assert stop.value.code == 0
    assert [row["ok"] for row in json.loads(capsys.readouterr().out)] == [True, True]


def test_it_runs_alone_here_and_isolated_with_the_same_bits(dcone: Dcone, folder: Path, tmp_path: Path) -> None:
    read(folder)
    code, _, err = dcone("run", str(folder / "mine.toml"), "-o", "isolated", "--no-figures")
    assert code == 0, err
    here = ("--set", "removal.isolate=false")
    code, _, err = dcone("run", str(folder / "mine.toml"), "-o", "here", "--no-figures", *here)
    assert (code, "add isolate = true" in err) == (2, True)
    (folder / "here.toml").write_text(SCENE.replace('isolate = true\ntimeout = "30 s"\n', "isolate = false\n"))
    code, _, err = dcone("run", str(folder / "here.toml"), "-o", "here", "--no-figures")
    assert code == 0, err
    same = [(tmp_path / name / "removal.parquet").read_bytes() for name in ("isolated", "here")]
    assert same[0] == same[1]
    facts = json.loads((tmp_path / "isolated" / "provenance.json").read_text())["phases"]["removal"]["fmu"]
    assert facts["file"] == str(folder / "my_removal.fmu")
    assert (facts["ours"], facts["isolated"], len(facts["sha256"])) == (False, True, 64)


def test_inspect_tells_what_is_known_of_it(dcone: Dcone, folder: Path) -> None:
    read(folder)
    code, out, err = dcone("inspect", str(folder / "mine.toml"))
    assert code == 0, err
    assert "removal: my_removal, isolated" in out
    assert "its state can be saved: yes" in out
    assert "set by the scene, SI: orbit.altitude = 700000" in out


def test_error_control_needs_states_of_all(folder: Path, tmp_path: Path) -> None:
    """Told before anything runs; the twin can save its state and passes."""
    coupled = '[removal.components.other]\nfmu = "{}"\n[removal.coupling]\ncontrol = "error"\n'
    assert read(folder, SCENE + coupled.format("my_capture.fmu")).phases
    cannot = build(
        tmp_path / "cannot",
        "capture",
        change=lambda xml: xml.replace('GetAndSetFMUstate="true"', 'GetAndSetFMUstate="false"'),
    )
    with pytest.raises(InputError, match=r'control = "error": rolls steps back, but the FMU of other cannot save'):
        read(folder, SCENE + coupled.format(cannot))


def test_units_are_judged_as_in_a_run(tmp_path: Path) -> None:
    """A declared pure number is no force: told with the scene, in the words of the run; the twin in kN is one."""
    scene = """
[removal]
macro_step = "60 s"
duration = "1 h"
connections = ["other.catch.mass -> removal.reel.tension"]
[removal.reel]
law = "commanded"
[removal.components.other]
fmu = "{}"
"""
    fmus = {}
    for name, base in (("%", 'factor="0.01"'), ("kN", 'kg="1" m="1" s="-2" factor="1000"')):

        def in_it(xml: str, name: str = name, base: str = base) -> str:
            changed = xml.replace('<Unit name="kg">', f'<Unit name="{name}">').replace('unit="kg"', f'unit="{name}"')
            return changed.replace('<BaseUnit kg="1" />', f"<BaseUnit {base} />")

        fmus[name] = build(tmp_path / name.strip("%"), "capture", change=in_it)
    assert read(tmp_path, scene.format(fmus["kN"])).phases
    told = r"other\.catch\.mass is in %, removal\.reel\.tension in N: different dimensions"
    with pytest.raises(InputError, match=told):
        read(tmp_path, scene.format(fmus["%"]))
    reel = VariableInfo("reel.tension", 0, "Real", "N", "input", "", by_name("N"))
    for name, fits in (("kN", True), ("%", False)):
        with Archive(fmus[name]) as archive:
            why = mismatch("out", archive.variables["catch.mass"], "in", reel)
        assert why == ("" if fits else "out is in %, in in N: different dimensions")


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("", '[removal.coupling]\ncontrol = "error"\n', 'control = "error": makes steps of different lengths'),
        ("", '[removal.coupling]\nstep = "3 s"\n', 'step = "3 s": must divide the macro step of 10 s'),
        ('"100 s"', '"95 s"', 'duration = "95 s": must be a whole number of macro steps of 10 s'),
    ],
)
def test_steps_of_one_length(folder: Path, tmp_path: Path, old: str, new: str, told: str) -> None:
    """Told before anything runs; the twin, an FMU that takes any step, passes."""
    other = '[removal.components.other]\nfmu = "{}"\n'
    text = SCENE.replace(old, new) + other if old else SCENE + other + new
    even = build(
        tmp_path,
        "capture",
        change=lambda xml: xml.replace('VariableCommunicationStepSize="true"', 'VariableCommunicationStepSize="false"'),
    )
    assert read(folder, text.format("my_capture.fmu")).phases
    with pytest.raises(InputError, match="the FMU of other takes steps of one length") as error:
        read(folder, text.format(even))
    assert f"removal.{'' if old else 'coupling.'}{told}" in str(error.value)
    assert ": 1 mistake\n  line " in str(error.value)
    assert read(folder, (SCENE + other + '[removal.coupling]\nstep = "2.5 s"\n').format(even)).phases


def test_a_component_must_not_be_named_like_a_table_of_the_main_one(folder: Path) -> None:
    flat = build(folder / "flat", "capture", change=lambda xml: xml.replace('name="chaser.mass"', 'name="mass"'))
    text = f'{SCENE}[removal.components.chaser]\nfmu = "{flat}"\n'
    with pytest.raises(InputError, match=r"removal has a variable chaser\.mass too: expected another name"):
        read(folder, text)
