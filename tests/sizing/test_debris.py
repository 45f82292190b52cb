"""A debris as a command line says it, and what is wrong with one that cannot be read."""

from __future__ import annotations

import pytest

from dcone_cosim.errors import InputError
from dcone_cosim.sizing.debris import read


@pytest.mark.parametrize(
    ("text", "mass", "size"),
    [
        ("1000 kg, 3.9 m", 1000.0, (3.9, 2.5, 2.5)),
        ("1 t, 390 cm", 1000.0, (3.9, 2.5, 2.5)),
        ("8000 kg, 25 x 10 x 5 m", 8000.0, (25.0, 10.0, 5.0)),
        ("8000 kg, 5 m x 25 m x 10 m", 8000.0, (25.0, 10.0, 5.0)),
        ("2e2kg,2.3m", 200.0, (2.3, 2.3 * 2.5 / 3.9, 2.3 * 2.5 / 3.9)),
    ],
)
def test_read(text: str, mass: float, size: tuple[float, float, float]) -> None:
    found = read(text)
    assert found.mass == pytest.approx(mass)
    assert found.size == pytest.approx(size)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "expected a mass and a length"),
        ("1000 kg", "expected a mass and a length"),
        ("1000 kg 3.9 m", "expected a mass and a length"),
        ("3.9 m, 1000 kg", "'3.9 m' is a length, not a mass"),
        ("1000, 3.9 m", "'1000' has no unit"),
        ("1000 kg, 3.9", "has no unit"),
        ("1000 kg, 3 x 2 m", "has 2 lengths, not 1 or 3"),
        ("-5 kg, 2 m", "is not a mass from 1 to 1e+06 kg"),
        ("5 kg, nan m", "not a length"),
        ("5 kg, 3 wibble", "the unit 'wibble', which is not known"),
        ("five kg, 3 m", "'five kg' is not a mass with its unit"),
    ],
)
def test_what_cannot_be_read_is_named(text: str, said: str) -> None:
    with pytest.raises(InputError) as error:
        read(text)
    assert said in str(error.value)
    assert "--debris" in str(error.value)
