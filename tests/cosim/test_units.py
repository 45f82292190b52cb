"""A value of a scene is a number with its unit; anything else is told what was expected."""

from __future__ import annotations

import math
import subprocess
import sys

import pytest
from astropy import units

from dcone_cosim.build import CATALOGUE, defaults
from dcone_cosim.phases import kinds
from dcone_cosim.scene.expected import Expected, Unexpected, example_of
from dcone_cosim.scenes.keys import expected_of
from dcone_cosim.units import _PRODUCTS, _SYMBOLS, BASE, Unit, like, named, spoken

LENGTH = Expected("m", example="24 m", refusal=lambda v: None if v > 0 else "must be greater than 0 m")


@pytest.mark.parametrize(
    ("unit", "text", "value"),
    [
        ("m", "24 m", 24.0),
        ("m", "800 km", 800e3),
        ("m", "1 mm", 1e-3),
        ("rad/s", "5 deg/s", math.radians(5.0)),
        ("Pa", "70 GPa", 70e9),
        ("N", "-0.01 N", -0.01),
        ("s", "1 day", 86400.0),
        ("s", "6 h", 21600.0),
        ("kg/m3", "1440 kg/m3", 1440.0),
        ("kg/m3", "1.44 g/cm3", 1440.0),
        ("kg.m2", "3 kg m2", 3.0),
        ("N.s/m", "2 N s/m", 2.0),
        ("rad", "98 deg", math.radians(98.0)),
    ],
)
def test_units_are_converted(unit: str, text: str, value: float) -> None:
    assert Expected(unit).read(text) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    ("value", "reason"),
    [
        (24, "bare number"),
        (24.0, "bare number"),
        ("24", "bare number"),
        ("3 kg", "is a mass"),
        ("2 m2", "is an area"),
        ("-1 m", "greater than 0 m"),
        ("0 m", "greater than 0 m"),
        ("nan m", "finite"),
        ("1e999 m", "finite"),
        ("twelve m", "not a number with a unit"),
        ("", "not a number with a unit"),
        (True, "expected a length"),
        (["1 m"], "expected a length"),
    ],
)
def test_what_does_not_fit_is_refused(value: object, reason: str) -> None:
    with pytest.raises(Unexpected, match=reason) as error:
        LENGTH.read(value)
    assert "expected a length" in str(error.value)
    assert '"24 m"' in str(error.value)


def test_a_unit_that_is_not_known_is_answered_with_those_that_are() -> None:
    with pytest.raises(Unexpected, match="has the unit 'furlongs', which is not known; known for a length: m, mm, cm"):
        LENGTH.read("1 furlongs")


@pytest.mark.parametrize(
    ("expected", "good", "bad"),
    [
        (Expected("1", kind="Integer", example="3"), 3, [3.5, "3", True]),
        (Expected("1", example="0.1"), 0.1, ["0.1", "5 %", False]),
        (Expected("1", kind="Boolean"), True, [1, "true"]),
        (Expected("1", choices=("none", "hill")), "hill", ["hil", 1]),
        (Expected("m", size=3, example="1 m"), ["1 m", "2 km", "0 m"], [["1 m"], "1 m", ["1 m", "1 m", 1]]),
    ],
)
def test_other_kinds_of_values(expected: Expected, good: object, bad: list[object]) -> None:
    assert expected.read(good) is not None
    for value in bad:
        with pytest.raises(Unexpected):
            expected.read(value)


@pytest.mark.parametrize("phase", ["capture", "removal"])
def test_every_unit_of_the_models_is_understood(phase: str) -> None:
    """And the example a message gives for a key is itself accepted by the key."""
    model = CATALOGUE[kinds()[phase].model]
    rows = [*model.base]
    for group in model.groups.values():
        for term in group.terms:
            rows += group.terms[term].variables if term in group.terms else ()
    for row in rows:
        if row.causality == "parameter":
            assert named(row.unit) is not None
            expected = expected_of(row)
            if row.kind == "Real" and row.unit != "1":
                scalar = Expected(expected.unit, example=expected.example, refusal=expected.refusal)
                scalar.read(expected.example)


@pytest.mark.parametrize(
    "name", [*sorted(_SYMBOLS.keys() - {"1"}), *_PRODUCTS.replace("\n", ";").split(";"), "mm-2 s2", "km / h"]
)
def test_symbols_are_those_of_astropy(name: str) -> None:
    """To the last bit, but for the litre, where astropy has 1.0000000000000002e-3 m3."""
    unit = named(name.strip())
    assert unit is not None
    assert unit.dimension is not None
    si = math.prod(
        (getattr(units, base) ** power for base, power in zip(BASE, unit.dimension, strict=True)), start=units.one
    )
    for value in (1.0, 0.1, 24.0, 1234.56789, 7e10):
        told = units.Unit(name.strip()).to(si, value)
        assert unit.to_si(value) == (pytest.approx(told, rel=1e-15) if name == "l" else told)


@pytest.mark.parametrize(
    ("name", "factor", "offset", "like"),
    [("deg_C", 1.0, 273.15, "K"), ("uN", 1e-6, 0.0, "N"), ("Mm^2", 1e12, 0.0, "m2")],
)
def test_astropy_knows_the_rest(name: str, factor: float, offset: float, like: str) -> None:
    assert named(name) == Unit(name, named(like).dimension, pytest.approx(factor, rel=1e-15), offset)


@pytest.mark.parametrize("name", ["furlongs", "m0.5", "m^0.5", "pix", "km9 km9 km9 " * 20 + "km9", "GPa-9 " * 40 + "m"])
def test_what_is_not_a_unit(name: str) -> None:
    assert named(name) is None


def test_words_for_units() -> None:
    assert [named(n).noun for n in ("m", "rad", "deg/s2", "N m", "1/kg")] == [
        "a length",
        "an angle",
        "an angular acceleration",
        "an energy",
        "a quantity in /kg",
    ]
    assert [spoken(n) for n in ("1", "1/s", "N.s/m", "m")] == ["", "/s", "N s/m", "m"]
    assert like(Unit("K", named("K").dimension)) == ["K", "deg_C"]
    assert like(named("1/kg")) == ["/kg"]


def test_a_rate_is_read_as_it_is_written() -> None:
    for unit in ("1/s", "1/kg", "1/(kg.m)"):
        text = Expected(unit).written([0.25]).strip('"')
        assert Expected(unit).read(text) == 0.25


def test_no_scene_of_ours_needs_astropy() -> None:
    program = (
        "import sys; from dcone_cosim.loading import load, shipped\n"
        "for name in shipped():\n    load(name)\n"
        "sys.exit('astropy' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0


def test_examples_use_the_display_unit() -> None:
    assert example_of(70e9, "Pa", "GPa") == "70 GPa"
    assert example_of(0.0, "m") == "1 m"


def test_defaults_are_the_start_values() -> None:
    values = defaults(CATALOGUE["net_capture"].interface({"net": "square", "gravity": "none", "target": "box"}))
    assert values["target.size[2]"] == 8.0
    assert values["chaser.start_position[2]"] == -20.0
