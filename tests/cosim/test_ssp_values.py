"""Values of a package: where they may stand, which of them counts, and what mappings and units make of them."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from lxml import etree

from dcone_cosim.coupling.options import Connection
from dcone_cosim.errors import InputError
from dcone_cosim.fmu.steppable import VariableInfo
from dcone_cosim.ssp import export, matching, system
from dcone_cosim.ssp.values import Given
from dcone_cosim.units import TEMPERATURE, Unit
from tests.cosim.ssp_packages import STRUCTURE, changed, contents, packed
from tests.cosim.test_ssp_bad import good

__all__ = ["good"]

VALUE = '<ssv:Parameter name="{name}"><ssv:Real value="{value}"{unit}/></ssv:Parameter>'
SET = '<ssv:ParameterSet version="1.0" name="more"><ssv:Parameters>{values}</ssv:Parameters>{units}</ssv:ParameterSet>'
NAMESPACES = (
    'xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues" '
    'xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon" '
    'xmlns:ssm="http://ssp-standard.org/SSP1/SystemStructureParameterMapping"'
)
MILLI = '<ssv:Units><ssc:Unit name="mN"><ssc:BaseUnit kg="1" m="1" s="-2" factor="0.001"/></ssc:Unit></ssv:Units>'
MAPPING = '<ssm:ParameterMapping version="1.0" {namespaces}>{entries}</ssm:ParameterMapping>'
LENGTH = (0, 1, 0, 0, 0, 0, 0, 0)
METRE, MM = Unit("m", LENGTH), Unit("mm", LENGTH, 1e-3)
KELVIN, CELSIUS = Unit("K", TEMPERATURE), Unit("degC", TEMPERATURE, 1.0, 273.15)
ENTRY = '<ssm:MappingEntry source="push" target="thrust.level"><ssc:LinearTransformation {how}/></ssm:MappingEntry>'


def one(name: str, value: float, unit: str = "") -> str:
    return VALUE.format(name=name, value=value, unit=f' unit="{unit}"' if unit else "")


def inline(values: str, units: str = "", mapping: str = "", attributes: str = "") -> str:
    inner = SET.format(values=values, units=units)
    mapped = f"<ssd:ParameterMapping>{mapping}</ssd:ParameterMapping>" if mapping else ""
    inside = f"<ssd:ParameterValues>{inner}</ssd:ParameterValues>{mapped}"
    return f"<ssd:ParameterBinding{attributes}>{inside}</ssd:ParameterBinding>"


def level(package: Path) -> float:
    return system.load(package).phases[0].main.parameters["thrust.level"]


def of_component(package: Path, target: Path, binding: str) -> Path:
    return changed(package, target, ("</ssd:ParameterBindings>", f"{binding}</ssd:ParameterBindings>"))


def of_system(package: Path, target: Path, binding: str) -> Path:
    bindings = f"<ssd:ParameterBindings>{binding}</ssd:ParameterBindings>"
    return changed(package, target, ("<ssd:Elements>", f"{bindings}<ssd:Elements>"))


def test_a_later_binding_counts(good: Path, tmp_path: Path) -> None:
    assert level(good) == -0.01
    assert level(of_component(good, tmp_path / "x.ssp", inline(one("thrust.level", -0.02)))) == -0.02


def test_a_binding_of_the_system_counts_more_than_one_of_the_component(good: Path, tmp_path: Path) -> None:
    assert level(of_system(good, tmp_path / "x.ssp", inline(one("removal.thrust.level", -0.03)))) == -0.03
    prefixed = inline(one("thrust.level", -0.04), attributes=' prefix="removal."')
    assert level(of_system(good, tmp_path / "y.ssp", prefixed)) == -0.04
    scene = system.load(of_system(good, tmp_path / "z.ssp", inline(one("thrust.level", -0.03))))
    assert scene.phases[0].main.parameters["thrust.level"] == -0.01
    (note,) = scene.notes
    assert "expected COMPONENT.NAME" in note


def test_a_value_in_another_unit_is_converted(good: Path, tmp_path: Path) -> None:
    package = of_component(good, tmp_path / "x.ssp", inline(one("thrust.level", -20.0, "mN"), MILLI))
    assert level(package) == pytest.approx(-0.02, rel=1e-15)


def test_an_ssv_file_is_read(good: Path, tmp_path: Path) -> None:
    binding = '<ssd:ParameterBinding source="resources/more%20.ssv"/>'
    files = contents(of_component(good, tmp_path / "x.ssp", binding))
    content = SET.format(values=one("thrust.level", -0.05), units="")
    files["resources/more .ssv"] = content.replace("<ssv:ParameterSet ", f"<ssv:ParameterSet {NAMESPACES} ", 1).encode()
    assert level(packed(tmp_path / "y.ssp", files)) == -0.05
    files["resources/more .ssv"] = files["resources/more .ssv"].replace(b"thrust.level", b"thrust.levle")
    scene = system.load(packed(tmp_path / "z.ssp", files))
    assert scene.phases[0].main.parameters["thrust.level"] == -0.01
    (note,) = scene.notes
    assert re.fullmatch(r"resources/more \.ssv line 1: .*did you mean 'thrust.level'\?; it is ignored", note)


def test_a_mapping_renames_and_transforms_and_drops_the_rest(good: Path, tmp_path: Path) -> None:
    mapping = MAPPING.format(namespaces=NAMESPACES, entries=ENTRY.format(how='factor="2" offset="0.001"'))
    values = one("push", -0.01) + one("not.known", 1.0)
    assert level(of_component(good, tmp_path / "x.ssp", inline(values, mapping=mapping))) == 2 * -0.01 + 0.001
    (note,) = system.load(tmp_path / "x.ssp").notes
    assert note.endswith("parameter 'not.known' has no entry in its mapping; it is ignored")
    nowhere = mapping.replace("thrust.level", "thrust.levle")
    with pytest.raises(InputError, match=r"did you mean 'thrust\.level'"):
        system.load(of_component(good, tmp_path / "w.ssp", inline(values, mapping=nowhere)))
    twice = MAPPING.format(namespaces=NAMESPACES, entries=2 * ENTRY.format(how='factor="2"'))
    with pytest.raises(InputError, match="mapped to in line"):
        system.load(of_component(good, tmp_path / "y.ssp", inline(values, mapping=twice)))


def test_a_mapping_takes_values_that_are_in_the_variables_unit_already(good: Path, tmp_path: Path) -> None:
    """SSP: the unit is converted first, then the transformation applied; or not converted when that is suppressed."""
    values = one("push", -10.0, "mN")
    entry = ENTRY.format(how='factor="3"')
    converted = MAPPING.format(namespaces=NAMESPACES, entries=entry)
    assert level(of_component(good, tmp_path / "x.ssp", inline(values, MILLI, converted))) == pytest.approx(-0.03)
    as_it_is = converted.replace("<ssm:MappingEntry ", '<ssm:MappingEntry suppressUnitConversion="true" ')
    assert level(of_component(good, tmp_path / "y.ssp", inline(values, MILLI, as_it_is))) == -30.0


def test_the_step_and_the_stop_come_from_the_structure(good: Path, tmp_path: Path) -> None:
    steps = changed(good, tmp_path / "x.ssp", ('baseStepSize="10.0"', 'baseStepSize="20.0"'))
    assert system.load(steps).phases[0].macro_step == 20.0
    later = changed(good, tmp_path / "y.ssp", ('startTime="0.0" stopTime="600.0"', 'startTime="5.0" stopTime="105.0"'))
    phase = system.load(later).phases[0]
    assert (phase.start, phase.duration) == (5.0, 100.0)
    text = contents(good)[STRUCTURE].decode()
    assert 'baseStepSize="10.0"' in text


def ends(out: Unit, into: Unit) -> tuple[VariableInfo, VariableInfo]:
    return VariableInfo("out", 0, "Real", "m", "output", "", out), VariableInfo("in", 1, "Real", "m", "input", "", into)


@pytest.mark.parametrize(
    ("out", "into", "attributes", "linear", "value", "expected"),
    [
        (MM, METRE, "", "", 5.0, 5.0),
        (MM, METRE, "", 'factor="2" offset="1"', 5.0, 2 * 5.0 + 1.0),
        (METRE, MM, "", 'factor="2" offset="1"', 5.0, 2 * 5.0 + 0.001),
        (MM, METRE, 'suppressUnitConversion="true"', 'factor="2" offset="1"', 5.0, 2 * 5000.0 + 1.0),
        (METRE, MM, 'suppressUnitConversion="true"', 'factor="2" offset="1"', 5.0, (2 * 5.0 + 1.0) / 1000.0),
        (CELSIUS, KELVIN, "", 'factor="2" offset="1"', 300.0, 2 * 300.0 + 1.0),
        (KELVIN, CELSIUS, "", 'factor="2" offset="1"', 300.0, 2 * (300.0 - 273.15) + 1.0 + 273.15),
        (CELSIUS, KELVIN, 'suppressUnitConversion="true"', 'factor="2"', 300.0, 2 * (300.0 - 273.15)),
    ],
)
def test_a_connection_transforms_values_in_the_unit_of_its_target(
    out: Unit, into: Unit, attributes: str, linear: str, value: float, expected: float
) -> None:
    """SSP: the unit is converted first, then the transformation applied; between SI values that is one factor."""
    inner = f"<ssc:LinearTransformation {linear}/>" if linear else ""
    row = etree.XML(f"<Connection {NAMESPACES} {attributes}>{inner}</Connection>")
    factor, offset = matching._si_transformation(row, *ends(out, into))
    assert factor * value + offset == pytest.approx(expected, rel=1e-12)
    written = export._wire(Connection("a", "out", "b", "in", factor, offset), *ends(out, into))
    of = out.from_si(value)
    assert into.to_si(written.factor * of + written.offset) == pytest.approx(expected, rel=1e-12)


def test_a_mapping_transforms_in_the_unit_of_its_target() -> None:
    given = Given("a", "in", "Real", 2.0, METRE, "f", 1, factor=3.0, offset=500.0)
    assert matching._in_si(given, ends(METRE, MM)[1]) == pytest.approx((3.0 * 2000.0 + 500.0) / 1000.0, rel=1e-15)


LOOP = '<ssd:Connection startElement="removal" startConnector="{0}" endElement="removal" endConnector="{1}"/>'


def connected(good: Path, target: Path, *ends: tuple[str, str]) -> Path:
    """The tether's tension, a force, set as an offset of the thrust, by connections that name these ends."""
    rows = "".join(LOOP.format(*pair) for pair in ends)
    return changed(good, target, ("</ssd:Elements>", f"</ssd:Elements><ssd:Connections>{rows}</ssd:Connections>"))


def test_a_connection_has_its_direction_from_its_connectors(good: Path, tmp_path: Path) -> None:
    there, back = ("tether.tension", "thrust.offset"), ("thrust.offset", "tether.tension")
    for pair in (there, back):
        (made,) = system.load(connected(good, tmp_path / "x.ssp", pair)).phases[0].connections
        assert (made.output, made.input, made.factor, made.offset) == (*there, 1.0, 0.0)
    with pytest.raises(InputError, match=r"line \d+: connection .*: the input is connected in line \d+ already"):
        system.load(connected(good, tmp_path / "y.ssp", there, back))


def test_a_linear_transformation_is_for_real(good: Path, tmp_path: Path) -> None:
    flags = [VariableInfo(name, 0, "Boolean", "1", name, "") for name in ("output", "input")]
    plain, scaled = (
        etree.XML(f"<Connection {NAMESPACES}>{inner}</Connection>")
        for inner in ("", '<ssc:LinearTransformation factor="2"/>')
    )
    assert matching._mismatch(plain, *flags) == ""
    assert matching._mismatch(scaled, *flags) == "both are Boolean; a linear transformation is for Real"
    mapping = MAPPING.format(namespaces=NAMESPACES, entries=ENTRY.format(how='factor="2"'))
    value = '<ssv:Parameter name="push"><ssv:Integer value="1"/></ssv:Parameter>'
    with pytest.raises(InputError, match="'push' is Integer: a linear transformation is for Real"):
        system.load(of_component(good, tmp_path / "x.ssp", inline(value, mapping=mapping)))
