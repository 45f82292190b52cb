"""An FMU counts in its own units, the master in SI: converted by the FMU's definitions, untouched where SI."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from dcone_cosim.errors import FmuError
from dcone_cosim.fmu.archive import Archive
from dcone_cosim.fmu.component import Component
from dcone_cosim.fmu.isolation import IsolatedComponent
from dcone_cosim.units import PURE, Unit, by_name, misfit, read_units, same_dimension, si_name
from tests.cosim.fmus.build import build

LENGTH = (0, 1, 0, 0, 0, 0, 0, 0)


@dataclass
class Base:
    """As fmpy gives a BaseUnit."""

    kg: Any = 0
    m: Any = 0
    s: Any = 0
    A: Any = 0
    K: Any = 0
    mol: Any = 0
    cd: Any = 0
    rad: Any = 0
    factor: Any = 1.0
    offset: Any = 0.0


@dataclass
class Given:
    name: str
    baseUnit: Base | None


def test_definitions_are_taken_at_their_word() -> None:
    units = read_units([Given("ft", Base(m="1", factor="0.3048")), Given("degC", Base(K=1, offset="273.15"))], "it")
    assert units["ft"] == Unit("ft", LENGTH, 0.3048)
    assert units["ft"].si_name == "m"
    assert units["degC"].offset == 273.15
    assert units["degC"].si_name == "K"


def test_a_definition_without_a_way_back_is_refused() -> None:
    for factor in ("0", "nan", "inf", "many"):
        with pytest.raises(FmuError, match=r"it\.fmu: its unit 'odd'"):
            read_units([Given("odd", Base(m=1, factor=factor))], "it.fmu")


@pytest.mark.parametrize(
    ("name", "si", "factor"),
    [
        ("N.s/m", "N.s/m", 1.0),
        ("kg.m2", "kg.m2", 1.0),
        ("rad/s", "rad/s", 1.0),
        ("mm", "m", 1e-3),
        ("km/h", "m/s", 1 / 3.6),
        ("deg", "rad", math.pi / 180),
        ("kN", "N", 1e3),
    ],
)
def test_a_unit_without_definition_goes_by_its_name(name: str, si: str, factor: float) -> None:
    unit = by_name(name)
    assert unit.si_name == si
    assert unit.factor == pytest.approx(factor, rel=1e-15)


def test_of_an_unknown_name_nothing_is_known() -> None:
    assert by_name("furlong per fortnight").dimension is None
    assert by_name("").dimension is None


def test_dimensions() -> None:
    metre, second = by_name("m").dimension, by_name("s").dimension
    assert same_dimension(by_name("mm").dimension, metre)
    assert not same_dimension(metre, second)
    assert same_dimension(metre, None)
    assert same_dimension(by_name("rad/s").dimension, by_name("1/s").dimension)
    assert by_name("s-").dimension is None
    assert si_name((1, -1, -3, 0, 0, 0, 0, 0)) == "kg/(m.s3)"
    assert si_name((0, 0, -1, 0, 0, 0, 0, 0)) == "1/s"
    assert si_name(PURE) == "1"


@pytest.mark.parametrize("turns", ["Hz", "kHz", "rpm", "rev/min"])
def test_turns_and_angles(turns: str) -> None:
    """The dimension alone would let a turn pass for a radian; a definition with rad, or 1/s, says what is meant."""
    per_second = (0, 0, -1, 0, 0, 0, 0, 0)
    counted = Unit(turns, per_second, 1 / 60)
    angles = by_name("rad/s"), by_name("deg/s")
    for angle in angles:
        assert f"{turns} counts turns, {angle.name} an angle" in misfit(counted, angle)
        assert misfit(angle, counted)
        assert misfit(by_name("1/s"), angle) == ""
        assert misfit(Unit(turns, angle.dimension, 2 * math.pi / 60), angle) == ""
    assert misfit(counted, by_name("1/s")) == misfit(counted, by_name("Hz")) == misfit(counted, by_name("odd")) == ""
    assert misfit(counted, by_name("m")) == "different dimensions"


def in_millimetres(xml: str) -> str:
    """The template with every length in millimetres, and a mass counted from 10 kg on."""
    xml = xml.replace('unit="m"', 'unit="mm"').replace('<Unit name="m">', '<Unit name="mm">')
    xml = xml.replace('<BaseUnit m="1" />', '<BaseUnit m="1" factor="0.001" />')
    return xml.replace('<BaseUnit kg="1" />', '<BaseUnit kg="1" factor="2" offset="10" />')


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build(tmp_path_factory.mktemp("fmu"), change=in_millimetres)


class TestComponent:
    @pytest.fixture(params=["here", "isolated"])
    def component(self, path: Path, request: pytest.FixtureRequest) -> Iterator[Component]:
        with Archive(path) as archive:
            make = Component if request.param == "here" else IsolatedComponent
            with make(archive, "it") as component:
                yield component  # type: ignore[misc]

    def test_what_is_set_and_read_is_si(self, component: Component) -> None:
        component.set({"start.relative_position[2]": 12.5, "start.relative_velocity[2]": 0.25, "chaser.mass": 500.0})
        component.initialise(100.0)
        component.step(100.0, 2.0)
        found = component.get(["separation", "start.relative_position[2]", "chaser.mass", "target.mass"])
        assert found["start.relative_position[2]"] == pytest.approx(12.5, rel=1e-15)
        assert found["chaser.mass"] == 500.0
        assert found["target.mass"] == 2 * 1000.0 + 10.0
        # its velocity is in m/s, and the example adds metres to its millimetres: 12500 + 2 * 0.25
        assert found["separation"] == pytest.approx(12.5005, rel=1e-15)

    def test_what_is_told_of_a_variable(self, component: Component) -> None:
        info = component.variables["tether.rest_length"]
        assert (info.unit, info.own) == ("m", Unit("mm", LENGTH, 0.001))
        assert component.variables["chaser.mass"].start == 2 * 2000.0 + 10.0
        assert (info.variability, info.initial) == ("fixed", "exact")


def test_rates_have_the_factor_and_no_offset(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with Archive(path) as archive, Component(archive, "it") as component:
        handed: list[Any] = []
        with monkeypatch.context() as patched:
            patched.setattr(component, "_call", lambda *arguments: handed.extend(arguments))
            component.set_rates({"start.relative_position[2]": 0.25, "chaser.mass": -3.0})
        assert handed[0] == "setRealInputDerivatives"
        assert handed[-1] == [250.0, -1.5]


def test_si_values_pass_untouched(tmp_path: Path) -> None:
    odd = 0.1 + 0.2
    with Archive(build(tmp_path)) as archive, Component(archive, "it") as component:
        component.set({"start.relative_position[1]": odd})
        component.initialise(0.0)
        assert component.get(["start.relative_position[1]"])["start.relative_position[1]"] == odd
        assert component.reader(list(component.variables))._to_si is None
