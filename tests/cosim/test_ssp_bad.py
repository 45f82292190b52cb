"""Packages that cannot be run: each is one clear error that names the element, its line and what was expected."""

from __future__ import annotations

import stat
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from dcone_cosim.errors import BAD_INPUT, InputError
from dcone_cosim.loading import load
from dcone_cosim.progress import Progress
from dcone_cosim.ssp import system
from dcone_cosim.ssp.export import export_scene
from dcone_cosim.ssp.markup import SSM
from tests.cosim.ssp_packages import STRUCTURE, changed, contents, packed
from tests.cosim.test_ssp_export import SHORT

TENSION = '<ssd:Connector name="tether.tension" kind="output">'
LEVEL = '<ssv:Parameter name="thrust.level">'
COMPONENT = '<ssd:Component name="removal"'
SYSTEM_END = "</ssd:Elements>"
CONNECTOR = f'{TENSION}\n            <ssc:Real unit="N"/>'
REAL = '<ssv:Real value="-0.01" unit="N"/>'
SET_END = "</ssd:ParameterValues>"
MAPPED = "<ssd:ParameterMapping>{}</ssd:ParameterMapping>"
LOOSE = (
    '<ssd:Connections><ssd:Connection startElement="{0}" startConnector="{1}" '
    'endElement="{2}" endConnector="{3}"/></ssd:Connections>'
)


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("ssp")
    (folder / "tow.toml").write_text(SHORT.format(duration="600 s"))
    (package,) = export_scene(load(str(folder / "tow.toml")), folder, Progress()).paths
    return package


def refusal(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        system.load(path)
    assert caught.value.exit_code == BAD_INPUT
    text = str(caught.value)
    assert str(path) in text
    assert "{http" not in text
    return text


def test_the_package_that_is_damaged_here_is_good(good: Path) -> None:
    """Without this, every test below could pass for another reason."""
    scene = system.load(good)
    assert scene.phases[0].name == "removal"
    assert scene.phases[0].main.parameters["thrust.level"] == -0.01


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (TENSION, TENSION.replace("tension", "tensoin"), ("'tether.tensoin'", "did you mean 'tether.tension'?")),
        (TENSION, TENSION.replace("output", "input"), ("kind = 'input'", "'output'")),
        (TENSION, TENSION.replace("output", "inout"), ("kind = 'inout'", "expected input")),
        (CONNECTOR, f"{TENSION}<ssc:Integer/>", ("is Integer", "as Real")),
        (CONNECTOR, f'{TENSION}<ssc:Real unit="m"/>', ("in 'm'", "in 'N'")),
        (
            CONNECTOR,
            f'{TENSION}<ssc:Enumeration name="e"/>',
            ("type Enumeration", "Real, Integer, Boolean or String"),
        ),
        (REAL, '<ssv:Binary value="00"/>', ("'thrust.level'", "type Binary", "Real, Integer, Boolean or String")),
        ("<ssd:ParameterBinding>", '<ssd:ParameterBinding type="text/plain">', ("'text/plain'", "x-ssp-parameter-set")),
        (
            "<ssd:ParameterBinding>",
            '<ssd:ParameterBinding source="x.ssv" sourceBase="component"/><ssd:ParameterBinding>',
            ("sourceBase = 'component'", "a file of the package"),
        ),
        (
            "<ssd:ParameterBinding>",
            "<ssd:ParameterBinding/><ssd:ParameterBinding>",
            ("neither a source nor a <ssv:ParameterSet>",),
        ),
        (
            "<ssd:ParameterBinding>",
            '<ssd:ParameterBinding source="SystemStructure.ssd"/><ssd:ParameterBinding>',
            ("<ssd:SystemStructureDescription> is not the <ssv:ParameterSet>",),
        ),
        (
            SYSTEM_END,
            '<ssd:Component name="removal" source="resources/removal.fmu"/></ssd:Elements>',
            ("<ssd:Component> 'removal': line", "has one of that name"),
        ),
        ('<ssc:BaseUnit m="1"/>', '<ssc:BaseUnit m="1" factor="0"/>', ("<ssc:Unit> 'm'", "factor 0")),
        (SET_END, SET_END + MAPPED.format(""), ("neither a source nor a <ssm:ParameterMapping>",)),
        (
            SET_END,
            SET_END + '<ssd:ParameterMapping type="text/plain" source="x.ssm"/>',
            ("'text/plain'", "x-ssp-parameter-mapping"),
        ),
        (SET_END, SET_END + '<ssd:ParameterMapping source="x.ssm"/>', ("ssd:ParameterMapping", "'x.ssm' is not in")),
        (
            SET_END,
            SET_END
            + MAPPED.format(
                f'<ssm:ParameterMapping xmlns:ssm="{SSM}" version="1.0"><ssm:MappingEntry source="a" target="b">'
                '<ssc:BooleanMappingTransformation><ssc:MapEntry source="true" target="false"/>'
                "</ssc:BooleanMappingTransformation></ssm:MappingEntry></ssm:ParameterMapping>"
            ),
            ("<ssc:BooleanMappingTransformation>", "only a linear transformation"),
        ),
        ('<ssv:ParameterSet version="1.0"', '<ssv:ParameterSet version="1.1"', ("'1.1'", "expected '1.0'")),
        ('<ssv:ParameterSet version="1.0"', "<ssv:ParameterSet", ("ssv:ParameterSet", "'version' is required")),
        (LEVEL, LEVEL.replace("thrust.level", "tether.tension"), ("cannot be set", "'output'")),
        (REAL, '<ssv:Boolean value="true"/>', ("given as Boolean", "as Real")),
        (REAL, '<ssv:Real value="-0.01" unit="m"/>', ("given in 'm'", "in 'N'")),
        (REAL, '<ssv:Real value="-0.01" unit="lb"/>', ("'lb'", "does not define")),
        (REAL, '<ssv:Real value="NaN"/>', ("must be finite",)),
        (REAL, '<ssv:Real value="much"/>', ("much", "xs:double")),
        (REAL, '<ssv:String value="much"/>', ("given as String", "as Real")),
        ('version="1.0" name="tow', 'version="2.0" name="tow', ("'2.0'", "expected '1.0'")),
        ('source="resources/removal.fmu"', 'source="resources/removl.fmu"', ("did you mean 'resources/removal.fmu'",)),
        ('source="resources/removal.fmu"', 'source="../removal.fmu"', ("not a file in the package",)),
        ('source="resources/removal.fmu"', 'source="https://host/removal.fmu"', ("not a file in the package",)),
        ('source="resources/removal.fmu"', 'source="resources/removal.ssv"', ("resources/removal.ssv",)),
        ("x-fmu-sharedlibrary", "x-ssp-package", ("expected an FMU",)),
        ("CoSimulation", "ModelExchange", ("expected co-simulation",)),
        (SYSTEM_END, '<ssd:System name="inner"/></ssd:Elements>', ("'inner'", "system within a system")),
        (
            SYSTEM_END,
            '<ssd:SignalDictionaryReference name="d" dictionary="x"/></ssd:Elements>',
            ("'d'", "signal dictionaries"),
        ),
        (
            "<ssd:Elements>",
            '<ssd:Connectors><ssd:Connector name="c" kind="input"><ssc:Real/></ssd:Connector></ssd:Connectors>'
            "<ssd:Elements>",
            ("'c'", "connector of the system"),
        ),
        (SYSTEM_END, SYSTEM_END + LOOSE.format("removal", "separation", "remove", "thrust.offset"), ("'remove'",)),
        (
            SYSTEM_END,
            SYSTEM_END + LOOSE.format("removal", "separation", "", "thrust.offset").replace('endElement="" ', ""),
            ("endConnector = 'thrust.offset' is one of the system", "endElement"),
        ),
        (
            SYSTEM_END,
            SYSTEM_END + LOOSE.format("", "separation", "removal", "thrust.offset").replace('startElement="" ', ""),
            ("startConnector = 'separation' is one of the system", "startElement"),
        ),
        (
            SYSTEM_END,
            SYSTEM_END + LOOSE.format("removal", "separation", "removal", "thrust.ofset"),
            ("no connector 'thrust.ofset'", "did you mean 'thrust.offset'?"),
        ),
        (
            SYSTEM_END,
            SYSTEM_END + LOOSE.format("removal", "separation", "removal", "thrust.offset"),
            ("'m' cannot be converted to 'N'",),
        ),
        (
            SYSTEM_END,
            SYSTEM_END + LOOSE.format("removal", "separation", "removal", "tether.length"),
            ("output to output",),
        ),
        ("<ssd:Elements>", "<ssd:Elemnts>", ("not well-formed", "Elemnts")),
        ("<ssd:Elements>", "<ssd:Elements><ssd:Compnent/>", ("ssd:Compnent", "not expected")),
        ("<ssd:SystemStructureDescription", "<!DOCTYPE x><ssd:SystemStructureDescription", ("document type",)),
        ('stopTime="600.0"', 'stopTime="-1.0"', ("stop must come after the start",)),
        ('baseStepSize="10.0"', 'baseStepSize="0.0"', ("must be positive",)),
        ('baseStepSize="10.0"', 'baseStepSize="1000.0"', ("1000 s is more than the 600 s",)),
        ('baseStepSize="10.0"', 'baseStepSize="1e-9"', ("steps; at most",)),
    ],
)
def test_one_fault_is_one_error_with_its_line(
    good: Path, tmp_path: Path, old: str, new: str, said: tuple[str, ...]
) -> None:
    text = refusal(changed(good, tmp_path / "bad.ssp", (old, new)))
    for part in said:
        assert part in text
    assert "1 mistake" in text or "not well-formed" in text
    assert STRUCTURE in text


def test_a_system_without_components(good: Path, tmp_path: Path) -> None:
    text = contents(good)[STRUCTURE].decode()
    elements = text[text.index("<ssd:Elements>") : text.index(SYSTEM_END) + len(SYSTEM_END)]
    assert "line 3: the system holds no component" in refusal(changed(good, tmp_path / "bad.ssp", (elements, "")))


def test_a_fault_is_told_with_the_line_it_stands_on(good: Path, tmp_path: Path) -> None:
    lines = contents(good)[STRUCTURE].decode().splitlines()
    number = next(i for i, line in enumerate(lines, start=1) if LEVEL in line)
    text = refusal(changed(good, tmp_path / "bad.ssp", (LEVEL, LEVEL.replace("thrust.level", "tether.tension"))))
    assert f"{STRUCTURE} line {number}: " in text
    moved = changed(good, tmp_path / "moved.ssp", ("<ssd:Elements>", "\n<ssd:Elements>"))
    text = refusal(changed(moved, tmp_path / "bad2.ssp", (LEVEL, LEVEL.replace("thrust.level", "tether.tension"))))
    assert f"{STRUCTURE} line {number + 1}: " in text


def test_all_faults_are_told_at_once(good: Path, tmp_path: Path) -> None:
    faults = [
        (TENSION, TENSION.replace("tension", "tensoin")),
        (LEVEL, LEVEL.replace("thrust.level", "tether.tension")),
    ]
    assert "2 mistakes" in refusal(changed(good, tmp_path / "bad.ssp", *faults))


def _escape(name: str) -> Callable[[zipfile.ZipFile], None]:
    return lambda archive: archive.writestr(name, b"x")


def _link(archive: zipfile.ZipFile) -> None:
    info = zipfile.ZipInfo("resources/link")
    info.external_attr = (stat.S_IFLNK | 0o777) << 16
    archive.writestr(info, "/etc/passwd")


@pytest.mark.parametrize(
    ("add", "said"),
    [
        (_escape("../evil"), "would leave the package"),
        (_escape("resources/../../evil"), "would leave the package"),
        (_escape("/evil"), "would leave the package"),
        (_escape("C:/evil"), "would leave the package"),
        (_escape("a\\..\\evil"), "would leave the package"),
        (_link, "symbolic link"),
    ],
)
def test_an_entry_that_would_leave_the_package_is_refused(
    good: Path, tmp_path: Path, add: Callable[[zipfile.ZipFile], None], said: str
) -> None:
    (tmp_path / "in").mkdir()
    path = packed(tmp_path / "in" / "bad.ssp", contents(good))
    with zipfile.ZipFile(path, "a") as archive:
        add(archive)
    assert said in refusal(path)
    assert [p.name for p in tmp_path.rglob("*")] == ["in", "bad.ssp"]


def test_files_that_are_no_packages(good: Path, tmp_path: Path) -> None:
    whole = good.read_bytes()
    for name, content, said in (
        ("empty.ssp", b"", "not an SSP package"),
        ("text.ssp", b"not a zip", "not an SSP package"),
        ("short.ssp", whole[: len(whole) // 2], "cut short"),
        ("flipped.ssp", whole.replace(b"tow_removal", b"tow_remuval", 1), "damaged"),
    ):
        path = tmp_path / name
        path.write_bytes(content)
        assert said in refusal(path)
    files = contents(good)
    del files[STRUCTURE]
    assert STRUCTURE in refusal(packed(tmp_path / "none.ssp", files))


def test_the_command_line_says_what_it_cannot_set(good: Path) -> None:
    for setting, said in (
        ("removal.thrust.levle=1 N", "did you mean 'thrust.level'"),
        ("removal.thrust.level=1 m", "expected a force"),
        ("removal.thrust.level=1", "removal.thrust.level: a bare number has no unit; expected a force"),
        ("removal.thrust.level=1", 'such as "-0.01 N"'),
        ("removl.thrust.level=1 N", "did you mean 'removal'"),
        ("zzz.thrust.level=1 N", "is not a variable of a component; known: removal"),
        ("removal.macro_step=0 s", "greater than 0"),
    ):
        with pytest.raises(InputError, match=r"^--set ") as caught:
            system.load(good, [setting])
        assert said in str(caught.value)
        assert "removal, removal" not in str(caught.value)
    assert system.load(good, ["removal.macro_step=20 s"]).phases[0].macro_step == 20.0
