"""A campaign's file: what it says, and every mistake with its line and the nearest name."""

from __future__ import annotations

import pytest

from dcone_cosim.campaign.reading import parse
from dcone_cosim.errors import InputError
from dcone_cosim.scene.mistakes import SceneError

GOOD = """
title = "t"
scene = "table2-deorbit"
until = "95 % within 1 %"
jitter = false
success = { figure = "removal.largest_tug_peak", below = "50 N" }
record = ["removal.largest_tug_peak"]
[set.removal]
duration = "1 h"
[set.removal.tether]
rest_length = "20 m"
[[dispersion]]
key = "removal.thrust.level"
distribution = "normal"
deviation = "5 %"
[[dispersion]]
key = "removal.tether.material"
distribution = "discrete"
values = ["Kevlar 29", "Dyneema SK75"]
weights = [3, 1]
"""


def test_what_it_says() -> None:
    spec = parse(GOOD, "t", "t.toml")
    assert spec.settings == ('removal.duration="1 h"', 'removal.tether.rest_length="20 m"')
    assert spec.until is not None
    assert (spec.until.confidence, spec.until.within) == (0.95, 0.01)
    assert (spec.success.bound, spec.success.margin(20.0), spec.success.margin(60.0)) == (50.0, 30.0, -10.0)
    one, two = spec.dispersions
    assert (one.told, two.values, two.weights) == ({"deviation": "5 %"}, ['"Kevlar 29"', '"Dyneema SK75"'], [3.0, 1.0])


@pytest.mark.parametrize(
    ("old", "new", "line", "told"),
    [
        ('until = "95 % within 1 %"', 'untill = "95 % within 1 %"', 4, "did you mean 'until'?"),
        ('until = "95 % within 1 %"', 'until = "within 1 %"', 4, "the confidence of an interval"),
        ('until = "95 % within 1 %"', 'sampler = "latin"\nn = 3', 4, "did you mean 'latin-hypercube'?"),
        ('until = "95 % within 1 %"', 'until = "95 % within 1 %"\nn = 3', 5, "expected one of n and until"),
        ("jitter = false", 'sampler = "sobol"', 4, "only independent cases may be stopped"),
        ('success = { figure = "removal.largest_tug_peak", below = "50 N" }', 'success = "capturd"', 6, "'captured'?"),
        ("jitter = false", "seed = -1", 5, "expected a whole number"),
        ("below", "beneath", 6, "known: above, below, figure"),
        ('distribution = "normal"', 'distribution = "gaussian"', 14, "expected a distribution"),
        ('deviation = "5 %"', 'deviaton = "5 %"', 15, "did you mean 'deviation'?"),
        ("weights = [3, 1]", "weights = [3]", 20, "expected a number for each value"),
        ('values = ["Kevlar 29", "Dyneema SK75"]', 'values = ["Kevlar 29"]', 19, "two values or more"),
        ("jitter = false", "factor_of_safety = -1", 5, "expected a number from 1 to 100"),
        ("jitter = false", "factor_of_safety = 0", 5, "expected a number from 1 to 100"),
        ("jitter = false", "factor_of_safety = 0.99", 5, "expected a number from 1 to 100"),
        ("jitter = false", "factor_of_safety = true", 5, "expected a number"),
        ('"50 N"', "inf", 6, "expected a finite number"),
        ('"50 N"', '"50 furlong-ish"', 6, "expected a finite number"),
        ('"50 N"', "true", 6, "expected a finite number"),
    ],
)
def test_mistakes(old: str, new: str, line: int, told: str) -> None:
    with pytest.raises(SceneError) as error:
        parse(GOOD.replace(old, new), "t", "t.toml")
    assert f"line {line}: " in str(error.value)
    assert told in str(error.value)
    assert str(error.value).startswith("t.toml: ")


def test_all_at_once() -> None:
    text = GOOD.replace("jitter = false", "jitter = 3").replace("[3, 1]", "[0, 0]").replace('"normal"', '"normle"')
    with pytest.raises(SceneError, match="3 mistakes"):
        parse(text, "t", "t.toml")


def test_a_distribution_that_there_is_not() -> None:
    """It is the one mistake: the dispersion is there, and no name is guessed that merely shares some letters."""
    one = '[[dispersion]]\nkey = "removal.thrust.level"\ndistribution = "WORD"\n'
    text = 'title = "t"\nscene = "table2-deorbit"\nn = 3\n' + one
    for word, said in (
        ("nosuch", "known: discrete, lognormal, normal, triangular, uniform"),
        ("weibul_min", "did you mean 'weibull_min'?"),
        ("gausian", "known: discrete"),
        ("unifrom", "did you mean 'uniform'?"),
    ):
        with pytest.raises(SceneError, match="1 mistake\n  line 6: dispersion") as error:
            parse(text.replace("WORD", word), "t", "t.toml")
        assert said in str(error.value)
    with pytest.raises(SceneError, match=r"expected at least one \[\[dispersion\]\]"):
        parse(text.partition("[[")[0], "t", "t.toml")


@pytest.mark.parametrize("text", ["scene = ", "a = 1\na = 2", "[[dispersion]"])
def test_what_is_no_toml(text: str) -> None:
    with pytest.raises(InputError, match=r"t\.toml is not valid TOML"):
        parse(text, "t", "t.toml")
