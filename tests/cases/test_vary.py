"""`--vary`: how it is read, which grid it makes, and what it refuses in which words."""

from __future__ import annotations

import numpy as np
import pytest

from dcone_cosim.cases import vary
from dcone_cosim.cases.vary import Varied, grid, in_si, read
from dcone_cosim.errors import InputError
from dcone_cosim.scene.mistakes import SceneError

KEY = "removal.tether.rest_length"


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("50 m,100 m, 200 m", ["50 m", "100 m", "200 m"]),
        ('"50 m","100 m"', ['"50 m"', '"100 m"']),
        ('"50 m,100 m"', ["50 m", "100 m"]),
        ('["1 m", "2 m"],["3 m", "4 m"]', ['["1 m", "2 m"]', '["3 m", "4 m"]']),
        ('["a]", "b"],["c"]', ['["a]", "b"]', '["c"]']),
        ("locked,linear", ["locked", "linear"]),
        ("10 m..50 m:5", ["10 m", "20 m", "30 m", "40 m", "50 m"]),
        ("10..50 m:3", ["10 m", "30 m", "50 m"]),
        ("0.1..0.5:5", ["0.1", "0.2", "0.3", "0.4", "0.5"]),
        ("1 m..2 m:2,12 m", ["1 m", "2 m", "12 m"]),
        ("-1 mN..-1000 mN:4:log", ["-1 mN", "-10 mN", "-100 mN", "-1000 mN"]),
        ("1 kg/m3..3 kg/m3:3:lin", ["1 kg/m3", "2 kg/m3", "3 kg/m3"]),
        ("5 N s..7 N s:3", ["5 N s", "6 N s", "7 N s"]),
    ],
)
def test_values(text: str, values: list[str]) -> None:
    assert read([f"{KEY}={text}"]) == [Varied(KEY, tuple(values))]


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ([], "nothing is varied"),
        ([KEY], f"--vary {KEY}: expected KEY=VALUE,VALUE"),
        ([f"{KEY}="], "expected KEY=VALUE,VALUE"),
        (["=1,2"], "expected KEY=VALUE,VALUE"),
        ([f"{KEY}=5 m"], "one value; expected two at least"),
        ([f"{KEY}=5 m,,6 m"], "a value is empty"),
        ([f"{KEY}=5 m,"], "a value is empty"),
        ([f'{KEY}=["5 m","6 m"'], "a ] is missing"),
        ([f'{KEY}="5 m,6 m'], 'a " is missing'),
        ([f"{KEY}=5 m,6 m", f"{KEY}=7 m,8 m"], "varied twice"),
        ([f"{KEY}=1 m..2 m"], "does not say how many values; expected two or more: 1 m..2 m:10"),
        ([f"{KEY}=1 m..2 m:1"], "does not say how many values"),
        ([f"{KEY}=1 m..2 m:x"], "does not say how many values"),
        ([f"{KEY}=1 m..2 m:2000000"], "2,000,000 values; expected 100,000 at most"),
        ([f"{KEY}=1 m..2 km:5"], "a range from m to km; expected one unit"),
        ([f"{KEY}=a..b:5"], "is no range; expected FIRST..LAST:COUNT"),
        ([f"{KEY}=1 m..2 m:5:cubic"], "'cubic' is no spread"),
        ([f"{KEY}=0 m..2 m:5:log"], "a logarithmic range from 0 to 2"),
        ([f"{KEY}=-1 m..2 m:5:log"], "a logarithmic range from -1 to 2"),
        (["a=1..2:1000", "b=1..2:1000"], "a grid of 1,000,000 cases"),
    ],
)
def test_what_is_refused(arguments: list[str], told: str) -> None:
    with pytest.raises(InputError) as caught:
        read(arguments)
    assert told in str(caught.value)


def test_what_is_set_is_not_varied() -> None:
    with pytest.raises(InputError, match="is given by --set too"):
        read([f"{KEY}=1 m,2 m"], [f"{KEY} = 3 m"])
    assert read([f"{KEY}=1 m,2 m"], ["removal.duration=1 h"])


@pytest.mark.parametrize(
    ("given", "number", "unit"),
    [
        ("50 m", 50.0, "m"),
        ('"60 GPa"', 60e9, "Pa"),
        ("-10 mN", -0.01, "N"),
        ("180 deg", np.pi, "rad"),
        ("1 day", 86400.0, "s"),
        ("1.44 g/cm3", 1440.0, "kg/m3"),
        ("5 N s/m", 5.0, "kg/s"),
        ("0.05", 0.05, "1"),
        ("3", 3.0, "1"),
        ("locked", None, ""),
        ("true", None, ""),
        ('["1 m"]', None, ""),
    ],
)
def test_si(given: str, number: float | None, unit: str) -> None:
    value = in_si(given)
    assert value.unit == unit
    assert value.number == (number if number is None else pytest.approx(number, rel=1e-14))


def test_the_grid_is_every_value_with_every_other() -> None:
    keys = read([f"{KEY}=12 m,13 m", "removal.thrust.level=-1 mN,-2 mN,-3 mN"])
    found = grid("table2-deorbit", keys)
    told = [tuple(value.given for value in c.values.values()) for c in found]
    assert told == [(length, f"-{n} mN") for length in ("12 m", "13 m") for n in (1, 2, 3)]
    for combination in found:
        assert combination.scene is not None
        parameters = combination.scene.phases[0].main.parameters
        assert parameters["tether.rest_length"] == combination.values[KEY].number
        assert parameters["thrust.level"] == combination.values["removal.thrust.level"].number


@pytest.mark.parametrize(
    ("argument", "told"),
    [
        ("title=one,two", "title = one and = two"),
        ("removal.isolate=true,false", "removal.isolate = true and = false"),
        (f"{KEY}=12 m,1200 cm", f"{KEY} = 12 m and = 1200 cm"),
        (f"{KEY}=12 m,13 m,12 m", f"{KEY} = 12 m and = 12 m"),
    ],
)
def test_a_key_without_effect(argument: str, told: str) -> None:
    with pytest.raises(InputError) as caught:
        grid("table2-deorbit", read([argument]))
    assert told in str(caught.value)
    assert "come to the same in table2-deorbit" in str(caught.value)


def test_a_key_without_effect_among_others() -> None:
    with pytest.raises(InputError, match="title = one and = two come to the same"):
        grid("table2-deorbit", read([f"{KEY}=12 m,13 m", "title=one,two"]))


@pytest.mark.parametrize(
    ("argument", "told"),
    [
        ("removal.tether.rest_lenght=12 m,13 m", "did you mean 'rest_length'?"),
        (f"{KEY}=12 m,13", "a bare number has no unit; expected a length"),
        (f"{KEY}=12 kg,13 kg", "is a mass; expected a length"),
        ("removal.reel.law=locked,loose", "expected locked, linear, regulator, commanded"),
        (f"{KEY}=8 m,12 m", "must be at most tether.rest_length"),
    ],
)
def test_a_mistake_is_that_of_the_scene(argument: str, told: str) -> None:
    """Also when only one of the values is wrong: it works in no case."""
    with pytest.raises(InputError) as caught:
        grid("table2-deorbit", read([argument]))
    assert told in str(caught.value)
    assert str(caught.value).startswith("--vary removal.")
    assert "--set" not in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1


def test_a_value_that_is_at_fault_elsewhere_is_named() -> None:
    """The separation of the scene is refused, and the length that was given with --vary is why."""
    with pytest.raises(InputError) as caught:
        grid("table2-deorbit", read([f"{KEY}=8 m,12 m"]))
    assert str(caught.value).startswith(f"--vary {KEY}=8 m: it works in no case: line 22: removal.start.separation")


def test_values_that_do_not_go_together_are_a_case_that_is_refused() -> None:
    found = grid("table2-deorbit", read([f"{KEY}=12 m,30 m", "removal.start.separation=10 m,20 m"]))
    refused = [c for c in found if c.scene is None]
    assert [tuple(v.given for v in c.values.values()) for c in refused] == [("12 m", "20 m")]
    assert refused[0].refusal.startswith(
        '--vary removal.start.separation=20 m: removal.start.separation = "20 m": must'
    )


def test_the_scene_itself_is_checked_first() -> None:
    with pytest.raises(InputError, match="no scene named"):
        grid("table3", read([f"{KEY}=12 m,13 m"]))
    assert issubclass(SceneError, InputError)


def test_many_cases_are_told_of(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = vary.load("table2-deorbit")
    monkeypatch.setattr(vary, "load", lambda *_: scene)
    monkeypatch.setattr(vary, "_need_effects", lambda *_: None)
    said: list[str] = []
    grid("table2-deorbit", read([f"{KEY}=1 m..2 m:1001"]), said=said.append)
    assert said == ["checking 1,001 cases"]
