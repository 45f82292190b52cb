"""The makers of rows that the models share."""

import math

import pytest

from fmu_src.interface import Fault, Model
from fmu_src.limits import make_limits
from fmu_src.packaging.dependence import rates
from fmu_src.rows import (
    at_least_zero,
    choice,
    count,
    moving,
    moving_input,
    parameter,
    per_second,
    positive,
    rate,
    vector,
)


@pytest.mark.parametrize(("unit", "expected"), [("m", "m/s"), ("m/s", "m/s2"), ("N", "N/s"), ("N.s/m", "N.s/m/s")])
def test_unit_of_a_rate(unit: str, expected: str) -> None:
    assert per_second(unit) == expected


def test_what_moves_finds_its_rate() -> None:
    """Names made by `moving_input`, `moving` and `rate` fit one another: the table is accepted, and each rate found."""
    rows = (
        *moving_input("reel.push", "m/s", "speed", -1.0, 1.0, 0.1),
        *moving("body", "place", "its rate", rate="rate.body[#]"),
        rate("body", "m/s2", (3,)),
    )
    model = Model("m", "", rows, {}, (Fault(1, "error", "no"),), "", 1.0, 1.0)
    found = rates(model.interface({}))
    assert [r.is_input for r in found] == [True] + 6 * [False]
    assert rows[1].name == "rate.reel_push"
    assert rows[1].unit == "m/s2"
    with pytest.raises(ValueError, match="names"):
        rates(Model("m", "", (vector("x", "m", "", rate="rate.nobody[#]"),), {}, (), "", 1.0, 1.0).interface({}))


def test_bounds() -> None:
    assert positive("p", "m", "", 1.0).refusal(0.0) == "must be greater than 0 m"
    assert count("n", "").refusal(-1) == "must be at least 0"


@pytest.mark.parametrize("compiled", [True, False])
def test_kernel_of_the_limits_is_the_table(compiled: bool) -> None:
    """It finds the first of the values that their rows refuse, and no other."""
    rows = (
        positive("p", "m", "", 1.0, 5.0),
        at_least_zero("q", "m", "", 1.0),
        parameter("r", "m", "", 0.0, -2.0, 2.0),
        choice("s", "", ("this", "that")),
        parameter("left_out", "m", "", 0.0, 1.0),
    )
    interface = Model("m", "", rows, {}, (), "", 1.0, 1.0).interface({})
    limits = make_limits(interface, "p", "q", "no_such_row", "r", "s")
    record = interface.make_record()
    found = limits if compiled else limits.py_func
    assert found(record) == (-1, 0.0)
    for v in rows[:4]:
        whole = v.kind == "Integer"
        for value in (-3, -1, 0, 1, 2, 3, 6) if whole else (-3.0, -0.0, 1e-300, 1.0, 5.5, math.inf, -math.inf):
            record[v.field] = value
            expected = (-1, 0.0) if v.refusal(value) is None else (interface.references[v.name], value)
            assert found(record) == expected, (v.name, value)
        record[v.field] = v.start
    record["q"] = math.nan
    assert found(record)[0] == interface.references["q"]
    record["p"] = 0.0
    assert found(record) == (interface.references["p"], 0.0)
