"""A difference of temperature is no temperature: relativeQuantity, on a variable or on its declared type.

FMI 2.0.4, section 2.2.3: "10 degree Celsius = 10 Kelvin if relativeQuantity = true and not 283.15 Kelvin".
"""

from __future__ import annotations

from pathlib import Path

import pytest

from dcone_cosim.coupling.options import Connection
from dcone_cosim.coupling.wiring import wire
from dcone_cosim.errors import InputError
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.fmu.component import Component
from dcone_cosim.fmu.isolation import IsolatedComponent
from dcone_cosim.fmu.steppable import VariableInfo
from dcone_cosim.scene.expected import Unexpected
from dcone_cosim.scenes.fmus import offer
from dcone_cosim.ssp import matching
from dcone_cosim.ssp.values import Given
from dcone_cosim.units import TEMPERATURE, Unit
from tests.cosim.fmus.build import build
from tests.cosim.mock_components import MockComponent

TYPES = (
    "<TypeDefinitions>"
    '<SimpleType name="Rise"><Real unit="degC" relativeQuantity="true"/></SimpleType>'
    '<SimpleType name="Level"><Real unit="degC"/></SimpleType>'
    "</TypeDefinitions>"
)
CELSIUS = Unit("degC", TEMPERATURE, 1.0, 273.15)
REALS = {
    "start.relative_velocity[1]": '<Real unit="degC" start="7"/>',
    "start.relative_velocity[2]": '<Real unit="degC" relativeQuantity="true" start="7" min="1" max="90"/>',
    "start.relative_velocity[3]": '<Real declaredType="Rise" start="7"/>',
    "start.center_velocity[1]": '<Real declaredType="Rise" relativeQuantity="false" start="7"/>',
    "start.center_velocity[2]": '<Real declaredType="Level" start="7"/>',
}
DIFFERENCES = ("start.relative_velocity[2]", "start.relative_velocity[3]")


def warm(xml: str) -> str:
    """The template with some velocities for temperatures in degC, and some for differences of them."""
    unit = '<Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit></UnitDefinitions>'
    xml = xml.replace("</UnitDefinitions>", unit + TYPES)
    for name, real in REALS.items():
        head, _, tail = xml.partition(f'name="{name}"')
        old = '<Real unit="m/s" start="0.0" />'
        assert old in tail
        xml = f'{head}name="{name}"{tail.replace(old, real, 1)}'
    return xml


@pytest.fixture(scope="module")
def fmu(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build(tmp_path_factory.mktemp("warm"), change=warm)


def test_what_is_read_of_the_description(fmu: Path) -> None:
    with Archive(fmu) as archive:
        found = {name: archive.variables[name] for name in REALS}
    assert {name for name, info in found.items() if info.own.relative} == set(DIFFERENCES)
    assert {info.unit for info in found.values()} == {"K"}
    assert {info.own.name for info in found.values()} == {"degC"}
    assert {name: info.start for name, info in found.items()} == {
        name: 7.0 if name in DIFFERENCES else 280.15 for name in REALS
    }
    bounded = found["start.relative_velocity[2]"]
    assert (bounded.minimum, bounded.maximum) == (1.0, 90.0)


@pytest.mark.parametrize("isolate", [False, True], ids=["here", "isolated"])
def test_five_kelvin_are_five_degrees_of_difference(fmu: Path, isolate: bool) -> None:
    """The FMU adds m->time times its rate to a distance without a unit of temperature: it shows what was set there."""
    with Archive(fmu) as archive, IsolatedComponent(archive, "it") if isolate else Component(archive, "it") as it:
        it.set({name: 5.0 for name in DIFFERENCES} | {"start.relative_velocity[1]": 273.15 + 2.0})
        it.initialise(0.0)
        it.step(0.0, 1.0)
        assert it.get(DIFFERENCES) == dict.fromkeys(DIFFERENCES, 5.0)
        before = it.get([f"start.relative_position[{i}]" for i in (1, 2, 3)])
        after = it.get([f"relative.position[{i}]" for i in (1, 2, 3)])
        moved = [a - b for a, b in zip(after.values(), before.values(), strict=True)]
        assert moved == pytest.approx([2.0, 5.0, 5.0], rel=1e-12), "not 5 - 273.15 = -268.15"


@pytest.mark.parametrize(("given", "kelvin"), [("5 K", 5.0), ("5 deg_C", 5.0), ("5000 mK", 5.0)])
def test_in_a_scene(fmu: Path, given: str, kelvin: float) -> None:
    with Archive(fmu) as archive:
        keys = offer(archive.variables).keys
    assert keys["start.relative_velocity[2]"].expected.read(given) == kelvin
    assert keys["start.relative_velocity[3]"].expected.read(given) == kelvin
    level = keys["start.relative_velocity[1]"].expected.read(given)
    assert level == pytest.approx(278.15 if given.endswith("C") else kelvin)
    with pytest.raises(Unexpected, match="must be at most 90 deg_C"):
        keys["start.relative_velocity[2]"].expected.read("91 deg_C")


def of(name: str, causality: str, unit: Unit) -> VariableInfo:
    return VariableInfo(name, 0, "Real", "K", causality, "", unit)


@pytest.mark.parametrize(("out", "into"), [(CELSIUS, True), (Unit("K", TEMPERATURE), True), (CELSIUS, False)])
def test_in_connections(out: Unit, into: bool) -> None:
    """A temperature is no difference; two differences, in degC and in K, are one another's."""
    parts = [MockComponent("a"), MockComponent("b")]
    parts[0].variables = {"T": of("T", "output", out), "dT": of("dT", "output", Unit("K", TEMPERATURE, relative=True))}
    wanted = CELSIUS.of_differences() if into else CELSIUS
    parts[1].variables = {"in": of("in", "input", wanted)}
    names = ["a", "b"]
    wrong, right = ("T", "dT") if into else ("dT", "T")
    with pytest.raises(InputError, match=r"a difference of temperatures \(relativeQuantity\) is not a temperature"):
        wire("x", names, parts, [Connection("a", wrong, "b", "in")])
    assert len(wire("x", names, parts, [Connection("a", right, "b", "in")])) == 1


class TestInPackages:
    RISE, LEVEL = of("dT", "parameter", CELSIUS.of_differences()), of("T", "parameter", CELSIUS)

    @pytest.mark.parametrize("unit", [None, CELSIUS, Unit("C", TEMPERATURE, 1.0, 273.15), Unit("K", TEMPERATURE)])
    def test_values(self, unit: Unit | None) -> None:
        given = Given("a", "dT", "Real", 5.0, unit, "f", 1)
        assert matching._in_si(given, self.RISE) == 5.0
        celsius = unit is None or unit.offset != 0.0
        assert matching._in_si(given, self.LEVEL) == pytest.approx(278.15 if celsius else 5.0)

    def test_a_mapping_of_a_difference(self) -> None:
        given = Given("a", "dT", "Real", 5.0, Unit("C", TEMPERATURE, 1.0, 273.15), "f", 1, factor=2.0, offset=1.0)
        assert matching._in_si(given, self.RISE) == 11.0

    def test_a_connector_in_the_unit_by_another_name(self) -> None:
        units = {"C": Unit("C", TEMPERATURE, 1.0, 273.15), "K": Unit("K", TEMPERATURE)}
        for info in (self.RISE, self.LEVEL):
            assert not matching._other_unit("C", info.own, units)
